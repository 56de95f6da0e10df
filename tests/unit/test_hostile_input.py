"""What a damaged or hostile file or call can say: always a typed error with its place, never a traceback."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
import zlib
from collections.abc import Mapping
from pathlib import Path

import pytest
from typer.testing import CliRunner

from polycnc import runner
from polycnc.cli import _errors
from polycnc.cli._app import app
from polycnc.controllers.apci import Board, pcap, sap
from polycnc.controllers.imc import parse_card
from polycnc.errors import ConfigurationError, PolycncError, ProgramError, UsageError
from polycnc.jit._files import Files
from polycnc.machine import load_machine, parse_toml
from polycnc.nc import ProgramText
from support.sap_board import FakeBoard

DIGITS = "7" * 5000

TOML = {
    "digits": (f'name = "m"\ncycle_s = {DIGITS}\n', 2),
    "digits in an array": (f'name = "m"\nx = [1,\n{DIGITS}]\n', 3),
    "arrays": ('name = "m"\nx = ' + "[" * 5000 + "]" * 5000 + "\n", 2),
    "tables": ('name = "m"\nx = ' + "{a=" * 5000 + "1" + "}" * 5000 + "\n", 2),
    "dotted": ('name = "m"\nx' + ".a" * 5000 + " = 1\n", 2),
    "dotted, quoted": ('name = "m"\n\n"x"' + " . 'a'" * 5000 + " = 1\n", 3),
    "header": ('name = "m"\n[x' + ".a" * 5000 + "]\nb = 1\n", 2),
    "header of an array": ("[[x" + ".a" * 33 + "]]\nb = 1\n", 1),
}


@pytest.mark.parametrize("case", TOML)
def test_toml_beyond_reason_is_refused_at_its_line(case: str) -> None:
    text, line = TOML[case]
    with pytest.raises(ConfigurationError) as refused:
        parse_toml(text, "m.toml")
    assert refused.value.position is not None
    assert refused.value.position.line == line
    assert len(str(refused.value)) < 1000


def test_a_key_of_a_million_parts_takes_no_hours() -> None:
    with pytest.raises(ConfigurationError, match="nested more than 32 deep"):
        parse_toml("x" + ".a" * 1_000_000 + " = 1\n", "m.toml")


def test_dots_in_texts_and_nesting_within_reason_pass() -> None:
    data, _ = parse_toml('x = "' + "a." * 200 + '"\ny = ' + "[" * 30 + "]" * 30 + "\n", "m.toml")
    assert data["x"] == "a." * 200


@pytest.mark.parametrize("piece", ["M99", "(", "G65", "P1", "N1"])
def test_a_line_of_many_words_takes_no_hours(piece: str) -> None:
    assert not runner.run(f"G0 X3\n{piece * 60_000}\nM30\n", None, "fanuc", check=False).ok


@pytest.mark.parametrize("name", ["a\0b.toml", "\ud800.toml"])
def test_names_of_no_file_are_refused(name: str) -> None:
    for read in (load_machine, runner.run, lambda each: runner.post_file(each, "din")):
        with pytest.raises(UsageError):
            read(name)


JSON = {
    "digits": '{"path": [{"do": "rapid", "to": [' + DIGITS + ", 2, 3]}]}",
    "infinity": '{"path": [{"do": "rapid", "to": [1e400, 2, 3]}]}',
    "lists": "[" * 5000 + "]" * 5000,
    "open lists": "[" * 100_000,
    "objects": '{"path": ' * 5000 + "1" + "}" * 5000,
    "deep in the path": '{"path": [' + "[" * 400 + "]" * 400 + "]}",
}


@pytest.mark.parametrize("case", JSON)
def test_json_beyond_reason_is_refused(case: str, tmp_path: Path) -> None:
    (tmp_path / "p.json").write_text(JSON[case])
    with pytest.raises(ProgramError) as refused:
        runner.post_file(tmp_path / "p.json", "din")
    assert refused.value.position is not None


@pytest.mark.parametrize("statement", ["LOADTL/1e400", "TOOLNO/1e400", "LOADTL/-1", "LOADTL/2.5"])
def test_a_tool_number_that_is_none_is_refused(statement: str, tmp_path: Path) -> None:
    (tmp_path / "p.cls").write_text(f"FROM/0,0,9\n{statement}\nGOTO/1,2,3\nFINI\n")
    with pytest.raises(ProgramError, match=r"must be a whole number|beyond all others"):
        runner.post_file(tmp_path / "p.cls", "din")


@pytest.mark.parametrize("word", ["M", "T", "D", "H", "G2 X3 Y0 I1.5 F100 P", "G10 L2 P", "M98 P", "G54.1 P"])
@pytest.mark.parametrize("dialect", ["din", "fanuc", "bosch"])
def test_words_beyond_float64_are_refused(word: str, dialect: str) -> None:
    errors = runner.check(f"{word}{'9' * 400}\nM30\n", dialect=dialect)
    assert errors
    assert errors[0].position is not None


def test_infinities_of_a_card_file_are_refused() -> None:
    for number in ("inf", "-inf", "nan", "1e400"):
        with pytest.raises(ConfigurationError):
            parse_card(f"[parameters]\nclkdiv = {number}\n[[axis]]\n[axis.parameters]\nmaxvel = {number}\n")


SOURCE = """program p;
var a: array[1..5] of integer; i: integer; x: double;
event e on a[2] = 7; begin a[3] := 1; end;
begin
  for i := 1 to 3 do a[i] := i * 2;
  x := 1.5;
  writeln('n', i:4, x:7:2);
  wt(3);
end.
"""
FORGED: tuple[object, ...] = (
    None,
    -1,
    10**9,
    2**70,
    1e300,
    "x",
    [],
    [1],
    [1, 2, 3],
    {},
    True,
    ["A1", "nothing", "i", False],
)


def _forged(body: Mapping[str, object]) -> bytes:
    data = json.dumps(body, separators=(",", ":")).encode()
    return b"POLYCNC-SAP 1 task=0 crc32=%08x size=%d\n" % (zlib.crc32(data), len(data)) + data


def test_forged_instructions_end_their_task_and_nothing_else() -> None:
    """Every argument of every instruction of a program is replaced by what no compiler writes; the board goes on."""
    program = sap.compile_program(SOURCE, "p.sap")
    body = json.loads(sap.write_cnc(program).split(b"\n", 1)[1])
    refused, ended = 0, set()
    for number in range(len(body["code"])):
        for forged in FORGED:
            code = [list(each) for each in body["code"]]
            code[number][1] = forged
            try:
                changed = sap.read_cnc(_forged({**body, "code": code}))
            except PolycncError:
                refused += 1
                continue
            board = FakeBoard()
            board.tasks.load(changed)
            board.tasks.startcnct(0)
            for _ in range(12):
                board.scan += 1
                board.run_scan()
            ended.add(board.tasks.rdcncts(0).errnum)
    assert refused > 10
    assert {0, 10} <= ended <= {0, *sap.FAULTS}


def test_a_condition_without_end_ends_its_task() -> None:
    """The function of an event's condition loops for ever: the task stops with an error, the board lives."""
    board = FakeBoard()
    program = sap.compile_program(SOURCE, "p.sap")
    body = json.loads(sap.write_cnc(program).split(b"\n", 1)[1])
    condition = body["events"][0][0]
    body["code"][condition] = ["jump", condition, 3]
    board.tasks.load(sap.read_cnc(_forged(body)))
    board.tasks.startcnct(0)
    board.run_scan()
    status = board.tasks.rdcncts(0)
    assert (status.errnum, status.errline, status.running) == (10, 3, 0)
    assert board.tasks.each[0].error == "an instruction that no compiler writes: a condition without end"


def test_a_stack_that_a_forged_loop_fills_ends_its_task() -> None:
    board = FakeBoard()
    code = [["const", 1, 1], ["jump", 0, 2]]
    board.tasks.load(
        sap.read_cnc(_forged({"name": "p", "variables": [], "code": code, "routines": [], "events": []}))
    )
    board.tasks.startcnct(0)
    for _ in range(400):
        board.run_scan()
    assert board.tasks.rdcncts(0).errnum == 5


def test_cells_of_a_forged_program_do_not_fill_the_memory() -> None:
    body = {
        "name": "p",
        "variables": [["d", 65536]] * 20_000,
        "code": [["end", None, 1]],
        "routines": [],
        "events": [],
    }
    with pytest.raises(sap.CncFileError):
        sap.read_cnc(_forged(body))


def _mistake(*_: object) -> None:
    raise ZeroDivisionError("of our own\nsecond line")


def test_what_is_left_is_told_as_our_mistake(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("polycnc.machine.load_machine", _mistake)
    monkeypatch.setattr(sys, "argv", ["polycnc", "machine", "a b"])
    told = CliRunner().invoke(app, ["machine", "a b"])
    assert told.exit_code == 70
    assert "Traceback" not in told.output
    lines = told.stderr.splitlines()
    assert lines[0] == "error: internal error, the mistake is not yours: ZeroDivisionError: of our own"
    (file,) = tmp_path.iterdir()
    assert str(file) in lines[1]
    written = file.read_text()
    for part in (
        "polycnc ",
        "Python ",
        "numba ",
        "command: polycnc machine 'a b'",
        "in _mistake",
        "second line",
    ):
        assert part in written
    assert file.stat().st_mode & 0o077 == 0


def test_a_report_that_cannot_be_written_is_printed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "none"))
    monkeypatch.setattr("polycnc.machine.load_machine", _mistake)
    told = CliRunner().invoke(app, ["machine"])
    assert told.exit_code == _errors.INTERNAL == 70
    assert "in _mistake" in told.stderr


def test_interruptions_and_readers_that_leave_keep_their_status(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("polycnc.machine.load_machine", interrupt)
    told = CliRunner().invoke(app, ["machine"])
    assert (told.exit_code, told.stderr) == (130, "error: interrupted\n")


def test_files_in_passing_of_killed_processes_are_swept_from_the_cache(tmp_path: Path) -> None:
    left, passing = tmp_path / "other-1.abc.tmp", tmp_path / "other-2.abc.tmp"
    left.write_bytes(b"half")
    passing.write_bytes(b"half")
    files = Files(tmp_path)
    os.utime(left, (1e9, 1e9))
    files.write("one-1", "one", b"content")
    assert not left.exists()
    assert passing.exists()
    assert files.read("one-1") == b"content"


@pytest.mark.parametrize("dialect", ["din", "fanuc"])
@pytest.mark.parametrize("words", ["X1 ", "".join(f"M{code} " for code in range(100, 1100))])
def test_a_line_without_end_is_one_error(words: str, dialect: str) -> None:
    """Forty thousand words on a line: one look at each, not one at every pair."""
    text = words * (40_000 // words.count(" "))
    errors = runner.check(f"G1 X3 F100\n{text}\nM30\n", dialect=dialect)
    assert errors[0].what == "a block with 40000 words"
    position = errors[0].position
    assert position is not None
    assert (position.line, text[: position.column - 1].count(" ")) == (2, 1000)


def test_arrays_and_routines_of_a_library_are_what_they_are_said_to_be() -> None:
    pcap.attach(Board(), clock=None)
    try:
        pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
        for wrong in (7, "records", None, [1, 2], pcap.TSRP(), object()):
            with pytest.raises(UsageError):
                pcap.jhi(pcap.AS.of(0), wrong)  # type: ignore[arg-type]
        for wrong in (7, "f", None):
            with pytest.raises(UsageError, match="outine"):
                pcap.MCUG3_SetBoardIntRoutine(wrong)  # type: ignore[arg-type]
        with pytest.raises(UsageError):
            pcap.rdSysVarInt(2**2000)
    finally:
        pcap.detach()


def test_calls_from_several_threads_are_carried_out_one_by_one() -> None:
    """Direct commands wait in one list on the board; threads that command and read find it whole."""
    board = Board()
    pcap.attach(board)
    records, rosi = pcap.tsrp_array(), pcap.ROSI()
    failed: list[BaseException] = []

    def work(axis: int) -> None:
        chosen = pcap.AS.of(axis)
        mine = pcap.tsrp_array()
        for number in range(40):
            try:
                mine[axis].tp = float(number + axis)
                pcap.ja(chosen, mine)
                pcap.rdrp(mine[axis])
                pcap.rdaxst(mine[axis])
                pcap.jhi(chosen, mine)
                pcap.ra(chosen)
            except Exception as error:
                failed.append(error)
                return

    try:
        pcap.InitMcuSystem3(records, rosi, 0, "system.dat")
        pcap.cl(pcap.AS.of(0, 1))
        threads = [threading.Thread(target=work, args=(number % 2,)) for number in range(4)]
        before = sys.getswitchinterval()
        sys.setswitchinterval(1e-6)
        try:
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
        finally:
            sys.setswitchinterval(before)
    finally:
        pcap.detach()
    assert failed == []
    assert not board.pending or board.clock.cycles > 0


LONG_NUMBERS = {
    "label": ("fanuc", f"M98 P7\nM30\nO{DIGITS}\nM99\nO7\nM99\n"),
    "skip level": ("din", f"/{DIGITS} G1 X3 F100\nM30\n"),
    "goto": ("fanuc", f"GOTO {DIGITS}\nN{DIGITS} M30\n"),
    "variable": ("fanuc", f"#{DIGITS}=1\nM30\n"),
    "macro call": ("fanuc", f"G65 P{DIGITS}\nM30\n"),
    "cpl label": ("bosch", f"10 GOTO N{DIGITS}\nN{DIGITS} X3\nM30\n"),
    "cpl number": ("bosch", f"{DIGITS} A=1\nM30\n"),
    "cpl variable": ("bosch", f"10 P{DIGITS}=1\n20 A=#P{DIGITS}\nG1 X{DIGITS}={DIGITS} F{DIGITS}\nM30\n"),
}


@pytest.mark.parametrize("case", LONG_NUMBERS)
def test_numbers_of_five_thousand_digits_are_numbers_or_errors(case: str, tmp_path: Path) -> None:
    dialect, text = LONG_NUMBERS[case]
    errors = runner.check(text, dialect=dialect, root=tmp_path)
    result = runner.run(text, dialect=dialect, check=False, root=tmp_path)
    assert all(error.position is not None for error in errors)
    assert all(alarm.text for alarm in result.alarms)
    assert errors or case not in ("goto", "variable", "macro call")


@pytest.mark.parametrize("dialect", ["din", "fanuc", "bosch", "linuxcnc"])
@pytest.mark.parametrize("piece", ["Q", "E5 ", "X1=", "[#1", "(x"])
def test_ten_million_characters_without_a_newline_are_refused_at_once(piece: str, dialect: str) -> None:
    text = ProgramText.from_text(f"G1 X3 F100\nG1 X4 {piece * (10_000_000 // len(piece))}\nM30\n", "long.nc")
    runner.check("G1 X3 F100\n", dialect=dialect)  # what is loaded once
    before = time.process_time()
    errors = runner.check(text, dialect=dialect)
    seconds = time.process_time() - before
    assert errors[0].what == "a line with more than 262144 characters"
    assert errors[0].position is not None
    assert (errors[0].position.line, errors[0].position.column) == (2, 1)
    assert len(str(errors[0])) < 1000
    assert seconds < 1.0
