"""Turns in the compiled scan: random programs do bit by bit what they do when Python gives them every turn."""

from __future__ import annotations

import random

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._jog_commands import jr
from polycnc.controllers.apci.board._move_commands import Speeds, mlr
from polycnc.controllers.apci.board._spool_commands import ssms
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.sap._board_host import BoardTasks
from support.often import often
from support.sap_on_board import TWO_AXES

HEAD = """
VAR i, j: INTEGER; x, y: DOUBLE; f: BOOLEAN; a: ARRAY [-2..3] OF INTEGER; d: ARRAY [1..4] OF DOUBLE;
FUNCTION g (n: INTEGER; z: DOUBLE): DOUBLE;
VAR k: INTEGER;
BEGIN FOR k := 1 TO n MOD 3 DO z := z * 1.5; g := z - n END;
PROCEDURE poll (limit: DOUBLE);
VAR k: INTEGER;
BEGIN k := 0; WHILE (A1.rp < limit) AND (CI7 <> 6) DO k := k; CI30 := CI30 + 1 END;
"""

WHOLE = (
    *("A1.axst", "A2.digi", "A1.digo", "A1.MCiS", "A1.lsm", "A1.PcapIndex", "A2.varint[CI7]", "SYSVARINT[3]"),
    *("CI7", "CI[CI7 + 2]", "ErrorReg", "PU", "i", "j", "a[CI7 - 3]", "RDCBI (8)", "RDCBB (12)", "TRUNC (x)"),
    *("ROUND (A1.rp * 3.7)", "A1.GCR", "NFRAX"),
)
REAL = (
    *(
        "A1.rp",
        "A1.dp",
        "A1.rv",
        "A1.dv",
        "A1.PosErr",
        "A1.tp",
        "A2.rp",
        "A1.lpndx",
        "A1.jovr",
        "A1.jvl",
        "A2.kp",
    ),
    *(
        "A1.vardbl[4]",
        "SYSVARDBL[CI7]",
        "CD4",
        "CD[CI7]",
        "x",
        "y",
        "d[3]",
        "g (CI7, A1.rp)",
        "RDCBD (16)",
        "2.75",
    ),
    *("SQRT (ABS (A1.rp))", "SQR (A1.dp)", "TRAC", "trovr"),
    *(
        "SIN (A1.rp)",
        "COS (CD4)",
        "TAN (A2.dp)",
        "ARCTAN (y)",
        "LN (ABS (A1.rp) + 0.1)",
        "EXP (SIN (A1.rv) * 9.0)",
    ),
)


class Programs:
    """Make random programs that end never."""

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)

    def one(self, *texts: str) -> str:
        """Return one of the texts."""
        return self.rng.choice(texts)

    def whole(self, depth: int = 2) -> str:
        """Return an integer."""
        if depth == 0 or self.rng.random() < 0.4:
            return self.one(*WHOLE, str(self.rng.randrange(9)))
        sign = self.one("+", "-", "*", "AND", "OR", "XOR", "SHL", "SHR")
        if self.rng.random() < 0.2:
            return f"({self.whole(depth - 1)} {self.one('DIV', 'MOD')} 7)"
        if self.rng.random() < 0.2:
            return self.one("-", "NOT ", "ABS ", "SQR ") + f"({self.whole(depth - 1)})"
        return f"({self.whole(depth - 1)} {sign} {self.whole(depth - 1)})"

    def real(self, depth: int = 2) -> str:
        """Return a double."""
        if depth == 0 or self.rng.random() < 0.4:
            return self.one(*REAL)
        if self.rng.random() < 0.2:
            return f"({self.real(depth - 1)} / 3.0)"
        left, right = self.real(depth - 1), self.rng.choice((self.real, self.whole))(depth - 1)
        return f"({left} {self.one('+', '-', '*')} {right})"

    def truth(self, depth: int = 2) -> str:
        """Return a condition."""
        if depth and self.rng.random() < 0.4:
            return f"({self.truth(depth - 1)} {self.one('AND', 'OR', 'XOR')} {self.truth(depth - 1)})"
        if self.rng.random() < 0.15:
            return self.one("f", "NOT f", "ODD (CI7)")
        sides = (self.real, self.whole)
        left, right = self.rng.choice(sides)(1), self.rng.choice(sides)(1)
        return f"({left} {self.one('<', '<=', '>', '>=', '=', '<>')} {right})"

    def statement(self, depth: int = 2) -> str:
        """Return a statement."""
        simple = (
            f"i := {self.whole()}",
            f"x := {self.real()}",
            f"f := {self.truth()}",
            f"a[{self.rng.randrange(-2, 4)}] := {self.whole()}",
            f"d[{self.rng.randrange(1, 5)}] := {self.real()}",
            f"CI{self.rng.randrange(20, 24)} := {self.whole()}",
            f"CD[{self.rng.randrange(20, 24)}] := {self.real()}",
            f"wt ({self.rng.uniform(0.0, 9.0):.2f})",
            self.one(
                "wt (A1)", "poll (1.75)", "A1.digo := CI7", "y := A1.lp", "WRITE (CI7)", "x := LN (A1.rp)"
            ),
        )
        if depth == 0 or self.rng.random() < 0.5:
            return self.rng.choice(simple)
        body = "; ".join(self.statement(depth - 1) for _ in range(self.rng.randrange(3)))
        return self.rng.choice(
            (
                f"REPEAT {body} UNTIL {self.truth()}",
                f"WHILE {self.truth()} DO BEGIN {body} END",
                f"IF {self.truth()} THEN BEGIN {body} END ELSE {self.statement(0)}",
                f"FOR j := 1 TO {self.rng.randrange(40)} DO BEGIN {body} END",
                f"CASE CI7 OF 1, 3: {self.statement(0)}; 4..6: {self.statement(0)} ELSE {self.statement(0)} END",
            )
        )

    def program(self) -> str:
        """Return a program: a loop without end, now and then with an event."""
        event = ""
        if self.rng.random() < 0.4:
            event = (
                f"EVENT e ON {self.truth().replace('g (CI7, A1.rp)', 'A1.rp')}; BEGIN CI31 := CI31 + 1 END;\n"
            )
        body = ";\n".join(self.statement() for _ in range(self.rng.randrange(1, 5)))
        return f"{HEAD}{event}BEGIN WHILE TRUE DO BEGIN {body} END END."


def run(seed: int, programs: list[str], away: bool, monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """Return what programs do while axes move and values change."""
    board = Board(parse_system_file(TWO_AXES))
    tasks = BoardTasks(board)
    if not away:
        monkeypatch.setattr(tasks._turns, "_is_worth_it", lambda number: False)
    cl(board, (0, 1))
    board.axes[0].jac, board.axes[0].jvl = 60.0, 9.0
    board.axes[0].varint[:8] = board.axes[1].varint[:8] = range(3, 11)
    board.sysvardbl[:8] = [0.5 * n - 1.25 for n in range(8)]
    for number, text in enumerate(programs):
        tasks.load(sap.compile_program(text, task=number))
        tasks.startcnct(number)
    rng = random.Random(seed)
    seen: list[object] = []
    for _ in range(14):
        board.advance(rng.choice((1, 2, 7, 60, 130)))
        arrays = (
            board.state.axis,
            board.state.ci,
            board.state.cd,
            board.kernel.servo.actual,
            board.state.board,
        )
        seen.append([array.tobytes() for array in arrays])
        seen.append([tasks.rdcncts(number) for number in range(4)])
        seen.append([tasks.each[number].error for number in range(4)])
        if rng.random() < 0.3:
            seen.append(repr(tasks.save()))
        match rng.randrange(6):
            case 0 | 1:
                board.state.ci[7] = rng.randrange(8)
            case 2:
                jr(board, (0,), (rng.uniform(-3.0, 5.0),))
            case 3:
                board.set_input(3, rng.random() < 0.5)
                board.variables.buffers[rng.randrange(4)][:24] = rng.randbytes(24)
            case 4:
                mlr(board, (0, 1), (rng.uniform(-1.0, 1.0), 0.75), Speeds(40.0, 5.0, 0.0), spool=True)
                ssms(board, (0, 1))
            case 5:
                number = rng.randrange(4)
                rng.choice((tasks.stopcnct, tasks.contcnct, tasks.startcnct))(number)
    seen.append(repr(tasks.save()))
    return seen


@pytest.mark.parametrize("seed", often(range(24), 8))
def test_random_programs_do_the_same_in_the_compiled_scan(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    source = Programs(seed)
    programs = [source.program() for _ in range(4)]
    quick = run(seed, programs, True, monkeypatch)
    slow = run(seed, programs, False, monkeypatch)
    for k, (one, other) in enumerate(zip(quick, slow, strict=True)):
        assert one == other, (k, programs)


def test_a_program_that_only_changes_common_variables_needs_no_python(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    board = Board(parse_system_file(TWO_AXES))
    tasks = BoardTasks(board)
    tasks.load(sap.compile_program("BEGIN WHILE TRUE DO BEGIN CI3 := CI3 + 7; CD5 := CD5 + 0.25 END END."))
    tasks.startcnct(0)
    board.advance(1)
    monkeypatch.setattr(tasks.each[0], "run", None)
    board.advance(1300)
    passes = 1301 * 100 / 11  # the condition and its jump, four and four for the sums, the jump back
    assert int(board.state.ci[3]) == pytest.approx(7 * passes, abs=7)
    assert float(board.state.cd[5]) == pytest.approx(0.25 * passes, abs=0.25)


def test_a_program_too_large_for_the_compiled_scan_runs_all_the_same() -> None:
    board = Board(parse_system_file(TWO_AXES))
    tasks = BoardTasks(board)
    tasks.load(
        sap.compile_program(
            "VAR a: ARRAY [1..5000] OF INTEGER; i: INTEGER; BEGIN FOR i := 1 TO 7 DO BEGIN a[700 * i] := i; "
            "wt (256.0) END; CI3 := a[4900] + a[1400] END."
        )
    )
    tasks.startcnct(0)
    board.advance(1500)
    assert tasks.each[0].error == ""
    assert int(board.state.ci[3]) == 7 + 2


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("CI1 := 7 DIV CI2", 1),
        ("CD1 := 7.5 / CI2", 1),
        ("CI[CI3 + 990] := 5", 2),
        ("CD1 := A1.vardbl[CI3 * 5]", 2),
        ("CI1 := TRUNC (CD3 * 1.0e9)", 3),
        ("CD1 := SQRT (0.0 - CD3)", 4),
        ("CD1 := LN (4.5 - CD3)", 4),
        ("CD1 := EXP (CD3 * 200.0)", 3),
        ("CI1 := RDCBI (CI3 * 40)", 8),
    ],
)
def test_an_error_in_the_compiled_scan_stops_the_task_where_it_is(text: str, fault: int) -> None:
    board = Board(parse_system_file(TWO_AXES))
    tasks = BoardTasks(board)
    tasks.load(sap.compile_program(f"BEGIN\nREPEAT UNTIL CI9 = 4;\n{text};\nCI5 := 3\nEND."))
    tasks.startcnct(0)
    board.state.ci[3], board.state.cd[3] = 25, 4.5
    board.advance(50)
    board.state.ci[9] = 4
    board.advance(20)
    status = tasks.rdcncts(0)
    if fault == 2 and "vardbl" in text:
        fault = status.errnum
        assert fault in (2, 7)  # refused by the board
    assert (status.errnum, status.running, status.csrcline) == (fault, 0, 3)
    assert int(board.state.ci[5]) == 0
