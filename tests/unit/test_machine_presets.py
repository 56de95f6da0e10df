import json
import math
import re
from pathlib import Path

import pytest

from polycnc.errors import ConfigurationError, UsageError
from polycnc.machine._config import MachineConfig
from polycnc.machine._config_axis import LinearAxis
from polycnc.machine._describe import (
    AXIS_COLUMNS,
    axis_rows,
    describe_machine,
    machine_file_reference,
    machine_row,
)
from polycnc.machine._presets import PRESETS, load_machine, preset_text
from polycnc.machine._toml import parse_toml, validate

DOCS = Path(__file__).parents[2] / "docs"
ENDLESS = (-math.inf, math.inf)


# --- finding a machine


@pytest.mark.parametrize("name", PRESETS)
def test_a_preset_carries_its_name_and_says_what_it_is(name: str) -> None:
    config = load_machine(name)
    assert config.name == name
    assert config.description
    assert preset_text(name).startswith("# ")


def test_presets_are_all_there_is_in_the_folder() -> None:
    folder = Path(__file__).parents[2] / "src" / "polycnc" / "machine" / "presets"
    assert sorted(path.stem for path in folder.glob("*.toml")) == list(PRESETS)


def test_the_default_machine_has_three_fast_axes_and_no_limits() -> None:
    config = load_machine()
    assert config == load_machine(None) == load_machine("mill3")
    assert [(axis.name, axis.vmax, axis.amax) for axis in config.axes] == [
        ("X", 500.0, 5000.0),
        ("Y", 500.0, 5000.0),
        ("Z", 333.0, 4000.0),
    ]
    for axis in config.axes:
        assert axis.soft_limits == axis.limit_switches == ENDLESS
        assert axis.servo.kind == "ideal"
    assert config.tools == {}
    assert config.offsets == {}
    assert config.times.tool_change_s == 0.0


def test_the_other_presets_have_their_axes() -> None:
    assert load_machine("mill5").axis_names == ("X", "Y", "Z", "A", "C")
    assert [axis.kind for axis in load_machine("mill5").axes] == ["linear"] * 3 + ["rotary"] * 2
    assert [axis.modulo for axis in load_machine("mill5").axes] == [False] * 4 + [True]
    assert load_machine("lathe2").axis_names == ("X", "Z")
    card = load_machine("card6")
    assert card.axis_names == ("X", "Y", "Z", "U", "V", "W")
    for axis in card.axes:
        assert axis.servo.kind == "pidf"
        assert axis.resolution == 0.001
        low, high = axis.limit_switches
        assert axis.reference_switch is not None
        assert axis.index_pulse is not None
        assert low < axis.reference_switch < axis.index_pulse < high


def test_a_machine_is_found_by_its_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(preset_text("lathe2").replace('name = "lathe2"', 'name = "mine"'), encoding="utf-8")
    assert load_machine(path).name == "mine"
    assert load_machine(str(path)).name == "mine"
    monkeypatch.chdir(tmp_path)
    assert load_machine("mine.toml").name == "mine"
    assert load_machine(Path("mine.toml")) == load_machine("./mine.toml")


def test_a_configuration_is_returned_as_it_is() -> None:
    config = MachineConfig(name="m", axis=(LinearAxis(name="X", vmax_mm_s=1, amax_mm_s2=1),))
    assert load_machine(config) is config


def test_a_wrong_name_lists_the_presets() -> None:
    with pytest.raises(UsageError) as caught:
        load_machine("mil5")
    assert not isinstance(caught.value, ConfigurationError)
    assert str(caught.value) == (
        "there is no machine 'mil5'\n"
        "did you mean 'mill5'? presets: card6, lathe2, mill3, mill5, vmc3; a machine file is named by its path, "
        "like ./mine.toml"
    )
    with pytest.raises(UsageError, match="there is no preset 'robot'\npresets: card6, lathe2, mill3, mill5"):
        preset_text("robot")


def test_a_missing_or_wrong_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"cannot read '.*none\.toml'"):
        load_machine(tmp_path / "none.toml")
    path = tmp_path / "wrong.toml"
    path.write_text('name = "w"\n', encoding="utf-8")
    with pytest.raises(ConfigurationError) as caught:
        load_machine(path)
    assert str(caught.value).startswith(f"{path}:1:1: the file has no 'axis'")


# --- describing a machine


@pytest.mark.parametrize("name", PRESETS)
def test_a_description_is_json_and_gives_every_number_a_unit(name: str) -> None:
    config = load_machine(name)
    description = describe_machine(config)
    assert json.loads(json.dumps(description, allow_nan=False)) == description
    assert (description["name"], description["cycle_s"]) == (name, 0.001)
    for axis, told in zip(config.axes, description["axes"], strict=True):
        assert (told["name"], told["kind"], told["unit"]) == (axis.name, axis.kind, axis.unit)
        assert (told["vmax"], told["vmax_unit"]) == (axis.vmax, f"{axis.unit}/s")
        assert (told["amax"], told["amax_unit"]) == (axis.amax, f"{axis.unit}/s2")
        for key, value in told.items():
            if isinstance(value, float | list):
                assert told[f"{key}_unit"].startswith(axis.unit)


def test_a_description_tells_limits_and_null_for_none() -> None:
    axes = {axis["name"]: axis for axis in describe_machine(load_machine("mill5"))["axes"]}
    assert axes["X"]["soft_limits"] is None
    assert (axes["A"]["soft_limits"], axes["A"]["soft_limits_unit"]) == ([-120.0, 120.0], "deg")
    assert axes["C"]["modulo"] is True
    assert axes["X"]["servo"]["following_error_limit"] is None
    card = describe_machine(load_machine("card6"))["axes"][0]
    assert card["limit_switches"] == [-500.0, 500.0]
    assert card["servo"]["kp"] == 50.0
    assert (card["servo"]["in_position"], card["servo"]["in_position_unit"]) == (0.01, "mm")


def test_rows_for_people() -> None:
    rows = axis_rows(load_machine("mill5"))
    assert all(len(row) == len(AXIS_COLUMNS) for row in rows)
    assert rows[0] == ("X", "linear", "500 mm/s", "5000 mm/s²", "none", "0 mm", "ideal")
    assert rows[3] == ("A", "rotary", "180 deg/s", "1200 deg/s²", "-120 to 120 deg", "0 deg", "ideal")
    assert rows[4][1] == "rotary, repeats"
    assert machine_row(load_machine("lathe2")) == ("lathe2", "X Z", "Two-axis turning machine with a turret")


# --- the pages


def test_the_reference_page_is_up_to_date() -> None:
    page = (DOCS / "reference" / "machine-file.md").read_text(encoding="utf-8")
    assert page == machine_file_reference(), "write it again with scripts/reference"


def test_the_reference_page_explains_every_key() -> None:
    rows = [line.split(" | ") for line in machine_file_reference().splitlines() if line.startswith("| `")]
    assert len(rows) > 50
    for _, value, _, default, meaning in rows:
        assert value
        assert default
        assert meaning.strip(" |").endswith((".", "`."))
    keys = {key for cells in rows for key in re.findall(r"`([a-z0-9_]+)`", cells[0])}
    assert {
        "vmax_mm_s",
        "vmax_deg_s",
        "modulo",
        "jerkrel",
        "kfca",
        "wear_radius_mm",
        "points",
        "epoch",
    } <= keys


def test_the_machines_of_the_how_to_page_load() -> None:
    page = (DOCS / "how-to" / "describe-a-machine.md").read_text(encoding="utf-8")
    texts = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    assert len(texts) == 5
    for text in texts:
        data, locator = parse_toml(text, "shop.toml")
        assert validate(MachineConfig, data, locator).axes


def test_the_message_on_the_how_to_page_is_the_real_one() -> None:
    page = (DOCS / "how-to" / "describe-a-machine.md").read_text(encoding="utf-8")
    first = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)[0]
    text = re.sub(r"vmax_mm_s = 400 .*", "vmax_mm_min = 24000", first, count=1)
    data, locator = parse_toml(text, "shop.toml")
    with pytest.raises(ConfigurationError) as caught:
        validate(MachineConfig, data, locator)
    assert f"```text\n{caught.value}\n```" in page
