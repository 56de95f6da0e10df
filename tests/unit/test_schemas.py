"""The JSON schemas hold what the commands really print, and refuse what they would not."""

from __future__ import annotations

import json
import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

import pytest

import polycnc
from polycnc.cli._output import _plain
from polycnc.errors import UsageError
from polycnc.machine import PRESETS, preset_text
from polycnc.runner import SCHEMAS, json_schema
from polycnc.runner.batches import ProgramReport
from support.command import polycnc as command

jsonschema = pytest.importorskip("jsonschema")

PART = "T4 M6\nG0 X3 Y2 Z5\nG1 Z-1.5 F300\nX43 F1700\nM30\n"
CPL = "10 LET A%=5 : IF A%>3 THEN\n20 LET @7=8.5\n30 ENDIF\nN40 G1 X7 F600\nM30\n"


def _validate(name: str, data: Any) -> None:
    jsonschema.validate(json.loads(json.dumps(_plain(data))), json_schema(name))


@pytest.mark.parametrize("name", SCHEMAS)
def test_a_schema_is_one(name: str) -> None:
    schema = json_schema(name)
    jsonschema.Draft202012Validator.check_schema(schema)
    json.dumps(schema, allow_nan=False)


@pytest.mark.parametrize(
    "program", [PART, PART.replace("M30", "G1 X10 Q"), "M30\n", PART.replace("X43", "X43000")]
)
def test_results(program: str) -> None:
    _validate("run", polycnc.run(program, check=False).as_dict())


def test_a_result_with_variables(tmp_path: Path) -> None:
    (tmp_path / "a.npg").write_text(CPL)
    _validate("run", polycnc.run(tmp_path / "a.npg", check=False).as_dict())


def test_comparisons() -> None:
    for other in (
        PART,
        PART.replace("X43", "X44"),
        "M30\n",
        PART.replace("T4", "T5"),
        PART.replace("M30", "G1 Q"),
    ):
        _validate("compare", polycnc.compare(PART, other).as_dict())
    result = polycnc.run(PART, trace=True)
    assert result.trace is not None
    _validate("compare", polycnc.compare(PART, result.trace).as_dict())


def test_what_the_commands_print(tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_text(PART)
    (tmp_path / "b.nc").write_text(PART.replace("M30", "G1 X10 Q"))
    for words, status in (
        ("run a.nc --json", 0),
        ("check a.nc b.nc --json", 1),
        ("compare a.nc b.nc --json", 1),
    ):
        data = json.loads(command(*words.split(), cwd=tmp_path, status=status).stdout)
        jsonschema.validate(data, json_schema(words.split()[0]))
    data = json.loads(command("batch", ".", "-j", "1", "--json", cwd=tmp_path, status=1).stdout)
    jsonschema.validate(data, json_schema("batch"))
    assert [report["status"] for report in data["reports"]] == ["ok", "error"]
    assert json.loads(command("schema", "run").stdout) == json_schema("run")


def test_a_report_has_what_the_schema_says() -> None:
    names = set(ProgramReport("a.nc", "mill3").as_dict()) - {"thumbnail"}
    assert names == set(json_schema("batch")["properties"]["reports"]["items"]["properties"])


@pytest.mark.parametrize("preset", PRESETS)
def test_machine_files(preset: str) -> None:
    data = tomllib.loads(preset_text(preset))
    jsonschema.validate(data, json_schema("machine"))
    data["axis"][0]["vmax"] = 7.0
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(data, json_schema("machine"))


def test_the_example_machine_file() -> None:
    text = (Path(__file__).parents[2] / "examples" / "my_machine.toml").read_text("utf-8")
    data = json.loads(json.dumps(tomllib.loads(text), default=str))
    jsonschema.validate(data, json_schema("machine"))


@pytest.mark.parametrize("name", ["din", "fanuc", "bosch"])
def test_dialect_files(name: str) -> None:
    text = (resources.files("polycnc.nc") / "dialects" / f"{name}.toml").read_text("utf-8")
    jsonschema.validate(tomllib.loads(text), json_schema("dialect"))


def test_another_key_is_refused() -> None:
    data = polycnc.run(PART).as_dict()
    data["time_min"] = 1.0
    with pytest.raises(jsonschema.ValidationError):
        _validate("run", data)
    with pytest.raises(UsageError, match="no schema 'report'"):
        json_schema("report")
