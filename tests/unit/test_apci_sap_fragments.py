"""What Part 1 of the manual prints of rw_SymPas works as printed, and reaches the board as it should."""

from __future__ import annotations

import pytest

from polycnc.controllers.apci import sap
from polycnc.errors import ProgramError
from support.sap_board import FakeBoard, run_text

PATH: dict[tuple[str, int | None], float] = {
    ("trac", None): 500.0,
    ("trvl", None): 40.0,
    ("trtvl", None): 5.0,
}


@pytest.mark.covers(
    "sap.scope",
    "sap.assignment",
    "sap.comment",
    "sap.named_axis_args",
    "sap.mlr",
)
def test_the_pipe_example_as_printed() -> None:
    board = run_text(
        "PU := 0;           // Position Unit = mm\n"
        "C.effradius := 100; // Enter radius\n"
        "mlr (X := 25, C := 60);\n",
        system=PATH | {("pu", None): 3},
    )
    assert board.system["pu", None] == 0
    assert board.qualifiers == {(3, "effradius", None): 100.0}
    assert board.calls == [sap.Call("mlr", axes=(0, 3), values=(25.0, 60.0), path=(500.0, 40.0, 5.0))]
    assert board.tasks.rdcncts(0).errnum == 0


@pytest.mark.covers("sap.comment", "sap.scope")
def test_a_comment_reaches_to_the_end_of_its_line_whatever_stands_in_it() -> None:
    board = run_text(
        "CI0 := 1; // CI0 := 2; { it's (* not // finished\n"
        "CI1 := 3; {CI1 := 4; // }\n CI2 := 5; (* CI2 := 6;\n*) CI3 := 7 // ; CI3 := 8\n ; CI4 := 9;"
    )
    assert [board.ci(k) for k in range(5)] == [1, 3, 5, 7, 9]
    assert run_text("CI0 := 1; // a file may end here").ci(0) == 1
    assert run_text("//\n//;\r\n///\nCI0 := 1//").ci(0) == 1


def test_application_variables_as_printed() -> None:
    board = FakeBoard()
    board.system["sysvarint", 1] = 77
    board.qualifiers[2, "varint", 1] = -5
    board.start("CI0 := SysVarInt[1];\nCI1 := A3.varint[1];\n")
    board.advance()
    assert (board.ci(0), board.ci(1)) == (77, -5)


def test_double_application_variables_take_an_index() -> None:
    board = run_text(
        "SysVarDbl[4] := 1.25; A1.vardbl[2] := SysVarDbl[4] * 2; A2.vardbl[0] := A1.vardbl[1 + 1];"
    )
    assert board.system["sysvardbl", 4] == 1.25
    assert board.qualifiers == {(0, "vardbl", 2): 2.5, (1, "vardbl", 0): 2.5}


def test_spool_functions_as_printed() -> None:
    board = run_text(
        "ssf(A1, 125, 999);  // Write CI125 with the value 999\n"
        "ssf(A1, 1001, 1); // Set output O1 at axis 1\n"
        "ssf (A1, 1002, 4);\n"
    )
    assert [(call.name, call.axes, call.numbers) for call in board.calls] == [
        ("ssf", (0,), (125, 999.0)),
        ("ssf", (0,), (1001, 1.0)),
        ("ssf", (0,), (1002, 4.0)),
    ]


@pytest.mark.covers("sap.scope", "sap.qualifier_access")
def test_names_are_the_same_in_either_case() -> None:
    board = run_text("begin Mlr (x := 1); MLR (X := 1); a1.EFFRADIUS := 3; ci5 := Ci5 + 1 end.", system=PATH)
    assert board.calls[0] == board.calls[1]
    assert board.qualifiers == {(0, "effradius", None): 3.0}
    assert board.ci(5) == 1


@pytest.mark.covers("sap.CI", "sap.CD", "apci.const.cncount")
def test_common_variables_are_a_thousand_each_and_the_same_for_tasks_and_pc() -> None:
    board = FakeBoard()
    board.system["ci", 7] = 41  # what the PC has written
    board.start("CI999 := CI7 + 1; CD0 := 0.5; CD999 := CD0; CI[3] := 9; CD[CI[3] - 1] := 2;")
    board.advance()
    assert (board.ci(999), board.ci(3)) == (42, 9)
    assert (board.system["cd", 999], board.system["cd", 8]) == (0.5, 2.0)
    board.start("CI8 := CI999 + 1;", task=3)
    board.advance()
    assert board.ci(8) == 43
    for text in ("CI1000 := 1;", "CD1000 := 1;"):
        with pytest.raises(ProgramError, match="1000' does not exist"):
            sap.compile_program(text)
    assert run_text("CI[999 + 1] := 1;").tasks.rdcncts(0).errnum == 2


@pytest.mark.covers("sap.TRAC", "sap.TRVL", "sap.TRTVL")
@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("TU", 1),
        ("TRAC", 1000.5),
        ("TRVL", 20.5),
        ("TRTVL", 0.25),
        ("TROVR", 0.5),
        ("TROVRST", 2.5),
        ("IRQPC", 1),
        ("LEDGN", 1),
        ("LEDRD", 1),
        ("LEDYL", 1),
    ],
)
def test_system_variables_are_shared_with_the_pc(name: str, value: float) -> None:
    board = FakeBoard()
    key = (name.lower(), None)
    board.system[key] = value
    board.start(f"CD1 := {name}; {name} := 2; mla (X := 1);")
    board.advance()
    assert board.system["cd", 1] == value
    assert board.system[key] == 2
    part = {"TRAC": 0, "TRVL": 1, "TRTVL": 2}.get(name)
    if part is not None:  # these are what moves use
        path = board.calls[0].path
        assert path is not None
        assert path[part] == 2.0


@pytest.mark.covers("sap.axis.jerkrel", "sap.axis.dpoffset", "sap.axis.dvoffset", "sap.axis.slsp")
@pytest.mark.parametrize("name", ["jerkrel", "dpoffset", "dvoffset", "slsp"])
def test_axis_qualifiers_are_read_and_written(name: str) -> None:
    board = FakeBoard()
    board.qualifiers[2, name, None] = 0.75
    board.start(f"CD1 := A3.{name.upper()}; a3.{name} := 0.5;")
    board.advance()
    assert board.system["cd", 1] == 0.75
    assert board.qualifiers[2, name, None] == 0.5


@pytest.mark.parametrize("name", ["digi", "ifs"])
def test_status_words_are_read_bit_by_bit_and_cannot_be_written(name: str) -> None:
    board = FakeBoard()
    board.qualifiers[1, name, None] = 0b1001
    board.start(f"IF (A2.{name} AND $8) <> 0 THEN CI1 := 1; IF (A2.{name} AND 2) <> 0 THEN CI1 := 2;")
    board.advance()
    assert board.ci(1) == 1
    with pytest.raises(ProgramError, match=f"'{name}' can only be read"):
        sap.compile_program(f"A2.{name} := 0;")


_ARGUMENTS = {
    "i": "3",
    "d": "4.5",
    "t": "points",
}


@pytest.mark.parametrize("name", list(sap.COMMANDS))
def test_every_command_of_the_table_reaches_the_board(name: str) -> None:
    command = sap.COMMANDS[name]
    count = min(command.most, max(command.least, 3))
    axes = ["A1", "A2", "A3"][:count]
    shape = command.axes.name
    named = [f"{axis} := {10 + at}" for at, axis in enumerate(axes)]
    written = {"NONE": [], "ONE": axes[:1], "LIST": axes, "NAMED": named}[shape]
    written += [_ARGUMENTS[kind] for _, kind in command.numbers]
    arguments = f" ({', '.join(written)})" if written else ""
    text = f"VAR points : ARRAY [1..5] OF DOUBLE; BEGIN points[2] := 8; {command.name}{arguments}; END."
    board = run_text(text, system=PATH)
    (call,) = board.calls
    assert call.name == command.name
    assert call.axes == (() if shape == "NONE" else (0,) if shape == "ONE" else tuple(range(count)))
    assert call.values == (tuple(10.0 + at for at in range(count)) if shape == "NAMED" else ())
    expected = {"i": 3, "d": 4.5, "t": (0.0, 8.0, 0.0)}
    assert call.numbers == tuple(expected[kind] for _, kind in command.numbers)
    assert call.path == ((500.0, 40.0, 5.0) if command.path else None)


@pytest.mark.covers("sap.spoolnames")
def test_every_move_has_a_spool_command_with_the_same_arguments() -> None:
    moves = [name for name, command in sap.COMMANDS.items() if command.path and not name.startswith("s")]
    assert moves == ["mla", "mca", "mca3d", "mha", "mlr", "mcr", "mcr3d", "mhr"]
    named = "X := 1, Y := 2, Z := 3"
    arguments = {"ml": "X := 1", "mc": "X := 1, Y := 2, 90", "mh": f"{named}, phi := 90"}
    for name in moves:
        given = f"{named}, 0, 0, 1, 90" if name.endswith("3d") else arguments[name[:2]]
        board = run_text(f"{name} ({given}); s{name} ({given});", system=PATH)
        direct, spooled = board.calls
        assert spooled.name == f"s{direct.name}"
        assert (spooled.axes, spooled.values, spooled.numbers) == (direct.axes, direct.values, direct.numbers)
        assert spooled.path == direct.path == (500.0, 40.0, 5.0)


def test_numbers_of_a_command_may_be_named_and_optional_ones_left_out() -> None:
    board = run_text(
        "mca (X := 1, Y := 2, phi := -90); mha (X := 1, Y := 2, Z := 3, 0, 7, 8); spda (A1, 1, t);".join(
            ["VAR t : ARRAY [0..0] OF REAL; BEGIN ", " END."]
        )
    )
    assert [call.numbers for call in board.calls] == [(-90.0,), (0.0, 7.0, 8.0), (1, (0.0,))]


@pytest.mark.parametrize(
    ("text", "column", "what", "hint"),
    [
        ("jss (A1);", 1, "unknown command 'jss'", "Did you mean"),
        ("mlr (X := 1, x := 2);", 14, "axis 'x' twice", "Name each axis once."),
        ("wt (X, Y, x);", 11, "axis 'x' twice", "Name each axis once."),
        ("js (X, X);", 8, "axis 'X' twice", "Name each axis once."),
        ("mca (X := 1, 90);", 1, "needs exactly 2 axes, not 1", "Write mca (axis := value, ..., phi);"),
        ("ssf (A1, 1);", 1, "needs 2 numbers, not 1", "Write ssf (axis, command, value);"),
        ("js;", 1, "needs at least 1 axes, not 0", "Write js (axis, ...);"),
        ("js (CI0);", 5, "'CI0' is a value, not an axis", "name of an axis"),
        ("js (1);", 5, "an axis name expected", "names"),
        ("A1.axts := 1;", 4, "unknown axis qualifier 'axts'", "Did you mean axst?"),
        ("A1.varint := 1;", 4, "'varint' needs an index", "varint[index]"),
        ("A1.rp[1] := 1;", 4, "'rp' takes no index", "brackets"),
        ("spd (A1, 2, PU);", 13, "must be an array of DOUBLE", "ARRAY"),
        ("PU := TRAC;", 7, "'PU' must be INTEGER, not DOUBLE", "TRUNC or ROUND"),
    ],
)
def test_wrong_calls_say_where_and_what_to_do(text: str, column: int, what: str, hint: str) -> None:
    program, errors = sap.check(text, "a.sap")
    assert program is None
    (error,) = errors
    assert error.position is not None
    assert (error.position.line, error.position.column) == (1, column)
    assert what in error.what
    assert hint in error.hint
    assert str(error).splitlines()[:3] == [
        f"a.sap:1:{column}: {error.what}",
        f"    {text}",
        " " * (column + 3) + "^",
    ]
