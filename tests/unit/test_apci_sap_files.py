"""Compiled programs as .CNC files, and the command that writes them."""

from __future__ import annotations

import re
import zlib
from pathlib import Path

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.sap._cnc_file import MAX_BYTES
from support.command import polycnc
from support.pages import REPOSITORY
from support.sap_board import FakeBoard

TEXT = """
CONST half = 0.1;
VAR a : ARRAY [1..4] OF DOUBLE; armed : BOOLEAN;
EVENT e ON armed; BEGIN armed := FALSE; CI1 := CI1 + 1 END;
FUNCTION f (x : DOUBLE) : DOUBLE; VAR k : INTEGER; BEGIN FOR k := 1 TO 3 DO f := x + k * half END;
BEGIN
  a[2] := f (1); armed := TRUE; wt (2);
  CASE CI1 OF 1: CD0 := a[2]; 2..5: CD0 := -1 END;
  mha (X := 1, Y := 2, Z := 3, phi := 90);
  spda (A1, 2, a, 7);
  WRITELN ('done: ', armed, ' \u00e4');
END.
"""


@pytest.mark.covers("apci.file.cnc")
def test_a_cnc_file_holds_the_task_and_the_whole_program() -> None:
    program = sap.compile_program(TEXT, task=2)
    data = sap.write_cnc(program)
    assert data.startswith(b"POLYCNC-SAP 1 task=2 ")
    board = FakeBoard()
    board.start("WHILE TRUE DO CI9 := CI9 + 1;", task=2)
    board.advance(3)
    read = sap.read_cnc(data)
    assert read == program
    board.tasks.load(read)
    count = board.ci(9)
    board.advance(3)
    assert board.ci(9) == count  # loading halts the task ...
    assert board.tasks.rdcncts(2).running == 0
    board.tasks.startcnct(2)
    board.advance(20)
    assert board.tasks.each[2].error == ""
    assert board.ci(9) == count  # ... and overwrites its program
    assert board.system["cd", 0] == pytest.approx(1.3)
    assert [call.numbers for call in board.calls] == [(90.0,), (2, (0.0, pytest.approx(1.3)), 7)]
    assert board.tasks.gettskstr(2) == "done: FALSE ä"


def _packed(body: bytes, task: int = 0) -> bytes:
    return b"POLYCNC-SAP 1 task=%d crc32=%08x size=%d\n" % (task, zlib.crc32(body), len(body)) + body


@pytest.mark.parametrize(
    ("data", "code", "what"),
    [
        (b"", 22, "no compiled SAP program"),
        (b"[SYSTEM]\n", 22, "no compiled SAP program"),
        (_packed(b"{}", task=4), 24, "compiled for task 4"),
        (_packed(b"{}")[:-1], 22, "damaged: size or checksum"),
        (_packed(b"{}").replace(b"{}", b"[]"), 22, "damaged: size or checksum"),
        (_packed(b"{}"), 22, "damaged: not a program"),
        (_packed(b"[]"), 22, "damaged: not a program"),
        (_packed(b"\xff\xfe"), 22, "damaged: not a program"),
        (
            _packed(b'{"name":"","variables":[],"code":[["fly",null,1]],"routines":[],"events":[]}'),
            22,
            "not a program",
        ),
        (
            _packed(b'{"name":"","variables":[],"code":[["jump",9,1]],"routines":[],"events":[]}'),
            22,
            "not a program",
        ),
        (
            _packed(b'{"name":"","variables":[],"code":[["call",0,1]],"routines":[],"events":[]}'),
            22,
            "not a program",
        ),
        (
            _packed(b'{"name":"","variables":[["x",1]],"code":[],"routines":[],"events":[]}'),
            22,
            "not a program",
        ),
        (_packed(b'{"name":' + b"[" * 100_000), 22, "not a program"),
        (
            _packed(b'{"name":"","variables":[],"code":[["end",null,1e999]],"routines":[],"events":[]}'),
            22,
            "not a program",
        ),
        (_packed(b" " * MAX_BYTES), 21, "the program memory of a task has 1048576"),
    ],
)
def test_other_files_are_refused_with_the_codes_of_txbf2(data: bytes, code: int, what: str) -> None:
    with pytest.raises(sap.CncFileError, match=what) as caught:
        sap.read_cnc(data)
    assert caught.value.code == code


def test_a_program_that_is_too_large_is_not_written() -> None:
    with pytest.raises(sap.CncFileError, match="the program memory of a task") as caught:
        sap.write_cnc(sap.compile_program("CI0 := CI1 + CI2;\n" * 9_000))
    assert caught.value.code == 21


@pytest.mark.covers("apci.tool.ncc")
def test_the_command_compiles_to_a_cnc_file(tmp_path: Path) -> None:
    (tmp_path / "part.sap").write_text("CI0 := 5;\n")
    done = polycnc("sap", "compile", "part.sap", cwd=tmp_path)
    assert re.fullmatch(r"wrote part\.CNC: task 0, \d+ instructions\n", done.stdout)
    assert sap.read_cnc((tmp_path / "part.CNC").read_bytes()) == sap.compile_program("CI0 := 5;\n")
    done = polycnc("sap", "compile", "part.sap", "-o", "x.bin", "--task", "3", cwd=tmp_path)
    assert done.stdout.startswith("wrote x.bin: task 3, ")
    assert sap.read_cnc((tmp_path / "x.bin").read_bytes()).task == 3


def test_the_command_reports_every_mistake_and_writes_nothing(tmp_path: Path) -> None:
    (tmp_path / "part.sap").write_text("CI0 := x;\n\njss (A1);\n")
    done = polycnc("sap", "compile", "part.sap", cwd=tmp_path, status=1)
    assert done.stdout.splitlines()[:3] == ["part.sap:1:8: unknown name 'x'", "    CI0 := x;", "           ^"]
    assert "part.sap:3:1: unknown command 'jss'" in done.stdout
    assert done.stdout.endswith("2 errors\n")
    assert [path.name for path in tmp_path.iterdir()] == ["part.sap"]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["none.sap"], "cannot read none.sap: No such file or directory"),
        (["part.sap", "--task", "4"], "Invalid value for '--task': '4' is not between 0 and 3"),
        (["part.sap", "-o", "part.sap"], "the command reads that file"),
    ],
)
def test_wrong_usage_ends_with_status_2(arguments: list[str], text: str, tmp_path: Path) -> None:
    (tmp_path / "part.sap").write_text("CI0 := 1;\n")
    done = polycnc("sap", "compile", *arguments, cwd=tmp_path, status=2)
    assert text in done.stderr
    assert (tmp_path / "part.sap").read_text() == "CI0 := 1;\n"


def test_the_reference_names_every_word_of_the_board_and_every_error() -> None:
    page = (REPOSITORY / "docs" / "reference" / "sap-language.md").read_text(encoding="utf-8")
    prose = re.sub(r"```.*?```", "", page, flags=re.DOTALL)
    words = {word.lower() for word in re.findall(r"[A-Za-z]\w*", " ".join(re.findall(r"`[^`]+`", prose)))}
    assert {*sap.COMMANDS, *sap.AXIS_QUALIFIERS, *sap.SYSTEM_VARIABLES} <= words
    for number, text in sap.FAULTS.items():
        assert f"| {number} | {text}" in page
    assert f"at most {SystemFile().rulings.instructions_per_scan} instructions" in page
