"""The reconstructed Pascal core: statements, types, routines, and what is said about mistakes."""

from __future__ import annotations

import pytest

from polycnc.controllers.apci import sap
from polycnc.errors import ProgramError, UsageError
from support.sap_board import run_text


def results(text: str, count: int = 1) -> list[int]:
    """Run a program and return CI0, CI1 ..."""
    board = run_text(text, 500)
    assert board.tasks.each[0].error == ""
    assert board.tasks.rdcncts(0).running == 0
    return [board.ci(index) for index in range(count)]


def written(expression: str) -> str:
    """Return what WRITE makes of an expression."""
    board = run_text(f"WRITE ({expression});")
    assert board.tasks.each[0].error == ""
    return board.tasks.gettskstr(0)


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("2 + 3 * 4", "14"),
        ("(2 + 3) * 4", "20"),
        ("-7 DIV 2", "-3"),
        ("-7 MOD 3", "-1"),
        ("7 MOD -3", "1"),
        ("7 / 2", "3.5"),
        ("-7 AND 3", "-3"),  # the sign stands before the whole term
        ("(-7) AND 3", "1"),
        ("1 OR 6 AND 3", "3"),
        ("6 XOR 3", "5"),
        ("NOT 0", "-1"),
        ("1 SHL 4 + 1", "17"),
        ("-1 SHR 28 = -(1 SHR 28)", "TRUE"),
        ("(-1) SHR 28", "15"),
        ("$1F", "31"),
        ("$FFFFFFFF", "-1"),
        ("$7FFFFFFF + 1", "-2147483648"),
        ("65536 * 65536 + 5", "5"),
        ("1 SHL 33", "2"),
        ("2 * -3", "-6"),
        ("1.5e2", "150"),
        ("0.1 + 0.2", "0.3"),
        ("1 < 2", "TRUE"),
        ("NOT (1 = 1.0)", "FALSE"),
        ("TRUE XOR TRUE", "FALSE"),
        ("TRUE = FALSE", "FALSE"),
        ("ABS (-3)", "3"),
        ("ABS (-3.5)", "3.5"),
        ("SQR (12)", "144"),
        ("SQRT (2)", "1.4142135623731"),
        ("SIN (PI / 6)", "0.5"),
        ("ARCTAN (1) * 4 = PI", "TRUE"),
        ("LN (EXP (2))", "2"),
        ("TRUNC (-2.9)", "-2"),
        ("ROUND (2.5)", "3"),
        ("ROUND (-2.5)", "-3"),
        ("ROUND (0.49999999999999994)", "0"),
        ("ODD (-3)", "TRUE"),
        ("3.14159 : 8 : 2", "    3.14"),
        ("42 : 5", "   42"),
        ("TRUE : 6", "  TRUE"),
        ("'it''s ', 1, ' axis'", "it's 1 axis"),
    ],
)
def test_expressions(expression: str, value: str) -> None:
    if value == "1.4142135623731":
        assert written(expression).startswith(value[:-1])
    else:
        assert written(expression) == value


def test_and_and_or_leave_out_what_cannot_matter() -> None:
    assert results(
        """
        VAR i : INTEGER; a : ARRAY [1..3] OF INTEGER;
        FUNCTION touched : BOOLEAN; BEGIN i := i + 1; touched := TRUE END;
        BEGIN
          i := 4;
          IF (i <= 3) AND (a[i] = 0) THEN CI0 := 9;
          IF (i > 3) OR touched THEN CI0 := CI0 + 1;
          IF (i > 3) AND touched THEN CI0 := CI0 + 10;
          CI1 := i
        END.
        """,
        2,
    ) == [11, 5]


def test_loops_and_branches() -> None:
    text = """
    PROGRAM Loops;
    CONST N = 5; LIMIT = N * 2 - 1;
    VAR i, j, sum : INTEGER;
    BEGIN
      FOR i := 1 TO N DO sum := sum + i;             { 15 }
      FOR i := N DOWNTO 1 DO sum := sum * 2;         (* 480 *)
      FOR i := 3 TO 2 DO sum := 0;
      CI0 := sum;
      i := 0;
      WHILE i < LIMIT DO BEGIN i := i + 1; IF ODD (i) THEN j := j + 1 END;
      CI1 := j;
      REPEAT i := i - 2 UNTIL i <= 0;
      CI2 := i;
      FOR i := 0 TO 9 DO
        CASE i OF
          0, 1: CI3 := CI3 + 1;
          2..4: BEGIN CI4 := CI4 + 1 END;
          -1: ;
        ELSE CI5 := CI5 + 1;
        END;
      IF FALSE THEN CI6 := 1 ELSE IF FALSE THEN CI6 := 2 ELSE CI6 := 3;
      CASE 7 OF 1: CI6 := 0 END
    END.
    """
    assert results(text, 7) == [480, 5, -1, 2, 3, 5, 3]


def test_for_ends_at_the_largest_integer() -> None:
    text = (
        "VAR i, n : INTEGER; BEGIN FOR i := 2147483646 TO 2147483647 DO n := n + 1; CI0 := n; CI1 := i END."
    )
    assert results(text, 2) == [2, 2147483647]


def test_routines_have_parameters_locals_and_recursion() -> None:
    text = """
    VAR total : INTEGER;
    FUNCTION fib (n : INTEGER) : INTEGER;
    BEGIN IF n < 2 THEN fib := n ELSE fib := fib (n - 1) + fib (n - 2) END;
    FUNCTION odd1 (n : INTEGER) : BOOLEAN; BEGIN IF n = 0 THEN odd1 := FALSE ELSE odd1 := even1 (n - 1) END;
    FUNCTION even1 (n : INTEGER) : BOOLEAN; BEGIN IF n = 0 THEN even1 := TRUE ELSE even1 := odd1 (n - 1) END;
    PROCEDURE add (n : INTEGER; weight : DOUBLE);
    CONST twice = 2;
    VAR i : INTEGER; a : ARRAY [-1..1] OF INTEGER;
    BEGIN
      FOR i := -1 TO 1 DO a[i] := i * n;
      n := a[1] * twice;
      total := total + n + ROUND (weight);
    END;
    BEGIN
      CI0 := fib (10);
      IF odd1 (7) AND NOT even1 (7) THEN CI1 := 1;
      add (5, 1); add (6, 2.5);
      CI2 := total;
      fib (3);
    END.
    """
    assert results(text, 3) == [55, 1, 26]


def test_arrays_keep_their_elements_apart() -> None:
    text = """
    VAR before : INTEGER; a : ARRAY [3..5] OF DOUBLE; flags : ARRAY [0..1] OF BOOLEAN; after, i : INTEGER;
    BEGIN
      before := 1; after := 2;
      FOR i := 3 TO 5 DO a[i] := i / 2;
      flags[1] := TRUE;
      CI0 := TRUNC (a[3] * 10); CI1 := TRUNC (a[5] * 10); CI2 := before * 10 + after;
      IF flags[1] AND NOT flags[0] THEN CI3 := 1;
    END.
    """
    assert results(text, 4) == [15, 25, 12, 1]


@pytest.mark.parametrize(
    ("statement", "number"),
    [
        ("x := 1 / z", 1),
        ("n := 1 DIV n", 1),
        ("n := 1 MOD n", 1),
        ("a[n] := 1", 2),
        ("n := a[4]", 2),
        ("n := TRUNC (1e10)", 3),
        ("x := EXP (1000)", 3),
        ("wt (1e300)", 3),
        ("wt (1e300 * 1e300 - 1e300 * 1e300)", 3),
        ("x := SQRT (-1)", 4),
        ("x := LN (0)", 4),
        ("deep (1)", 5),
        ("js (Q)", 6),
        ("n := Q.axst", 6),
        ("wt (Q)", 6),
        ("azo (1)", 7),
        ("n := RDCBI (997)", 8),
        ("WRCBD (-1, 0)", 8),
        ("STARTCNCT (4)", 9),
    ],
)
@pytest.mark.covers("sap.errors", "apci.CNCTS.errnum", "apci.CNCTS.errline")
def test_a_runtime_error_stops_the_task_with_number_and_line(statement: str, number: int) -> None:
    text = (
        "VAR n : INTEGER; x, z : DOUBLE; a : ARRAY [1..3] OF INTEGER;\n"
        "PROCEDURE deep (n : INTEGER); BEGIN deep (n + 1) END;\n"
        "BEGIN\n"
        "  CI0 := 1;\n"
        f"  {statement};\n"
        "  CI0 := 2;\n"
        "END.\n"
    )
    board = run_text(text, 1000)
    status = board.tasks.rdcncts(0)
    assert status.errnum == number
    assert status.errline == (2 if number == 5 else 5)
    assert status.running == 0
    assert board.ci(0) == 1
    assert board.tasks.each[0].error != ""
    board.tasks.contcnct(0)
    board.advance(10)
    assert board.ci(0) == 1  # not to be continued
    board.tasks.startcnct(0)
    assert board.tasks.rdcncts(0).errnum == 0  # but restarted


def test_an_error_about_axes_names_them() -> None:
    assert run_text("js (A1, Q, W);").tasks.each[0].error == "the board has no axis of this name: Q, W"
    assert run_text("wt (-1e300 * 1e300); CI0 := 1;").ci(0) == 1  # no wait at all


@pytest.mark.parametrize(
    ("text", "at", "what"),
    [
        ("BEGIN x := 1 END.", (1, 7), "unknown name 'x'"),
        ("PROGRAM p; BEGIN CI0 := 1 END", (1, 30), "'.' expected, not end of file"),
        ("BEGIN CI0 := 1", (1, 15), "'END' expected, not end of file"),
        ("BEGIN END. CI0 := 1;", (1, 12), "'CI0' after the end of the program"),
        ("CI0 := 1\nCI1 := 2;", (2, 1), "';' expected, not 'CI1'"),
        ("CI0 := (1;", (1, 10), "')' expected, not ';'"),
        ("CI0 = 1;", (1, 5), "';' expected, not '='"),
        ("IF CI0 THEN CI0 := 1;", (1, 4), "the condition must be BOOLEAN, not INTEGER"),
        ("IF CI0 = 1 CI0 := 1;", (1, 12), "'THEN' expected, not 'CI0'"),
        ("CI0 := 99999999999;", (1, 8), "99999999999 is too large"),
        ("CI0 := 2147483648;", (1, 8), "2147483648 is too large"),
        ("CD0 := 1e999;", (1, 8), "1e999 is too large"),
        ("CI0 := 1 ? 2;", (1, 10), "unexpected character '?'"),
        ("WRITE ('abc);", (1, 8), "text without an end"),
        ("CI0 := 1; { never closed", (1, 11), "comment without an end"),
        ("CI0 := 1; (* never closed", (1, 11), "comment without an end"),
        ("CI0 := $;", (1, 8), "'$' without hexadecimal digits"),
        ("VAR a : INTEGER; A : DOUBLE; BEGIN END.", (1, 18), "'A' is declared twice"),
        ("VAR wt : INTEGER; BEGIN END.", (1, 5), "'wt' is a word of the board"),
        ("VAR CI5 : INTEGER; BEGIN END.", (1, 5), "'CI5' is a word of the board"),
        ("VAR a, b : INTEGER; on : BOOLEAN; BEGIN END.", (1, 21), "a name expected, not 'on'"),
        ("VAR a : WORD; BEGIN END.", (1, 9), "a type expected, not 'WORD'"),
        ("VAR a : ARRAY [5..4] OF INTEGER; BEGIN END.", (1, 5), "array 'a' has wrong bounds"),
        ("VAR a : ARRAY [1..70000] OF INTEGER; BEGIN END.", (1, 5), "no memory for 'a'"),
        ("VAR a : ARRAY [1..2] OF INTEGER; BEGIN a := 1 END.", (1, 40), "'a' is an array"),
        ("VAR a : INTEGER; BEGIN a[1] := 1 END.", (1, 24), "'a' is no array"),
        ("VAR a : INTEGER; BEGIN a.rp := 1 END.", (1, 24), "'a' is a variable, not an axis"),
        ("CONST c = 1 DIV 0; BEGIN END.", (1, 13), "no constant: division by zero"),
        ("VAR v : INTEGER; CONST c = v; BEGIN END.", (1, 28), "unknown name 'v'"),
        ("CONST c = 1; BEGIN c := 2 END.", (1, 20), "'c' cannot be assigned to"),
        ("CASE CI0 OF CI1: END;", (1, 13), "a constant expected"),
        ("FOR CI0 := 1 TO 2 DO ;", (1, 5), "'CI0' is no INTEGER variable"),
        ("CI0 := 'a';", (1, 8), "text has no value here"),
        ("CI0 := 1 AND TRUE;", (1, 10), "AND cannot take INTEGER and BOOLEAN"),
        ("IF CI0 > 1 AND CI1 > 1 THEN ;", (1, 20), "a second comparison, '>'"),
        ("IF NOT 1.5 THEN ;", (1, 4), "NOT cannot take DOUBLE"),
        ("CI0 := nothing (1);", (1, 8), "unknown function 'nothing'"),
        ("PROCEDURE p; BEGIN END; BEGIN CI0 := p END.", (1, 38), "'p' returns nothing"),
        ("PROCEDURE p (a : INTEGER); BEGIN END; BEGIN p END.", (1, 45), "'p' takes 1 argument, not 0"),
        (
            "PROCEDURE p (a : INTEGER); BEGIN END; BEGIN p (1.5) END.",
            (1, 48),
            "'a' must be INTEGER, not DOUBLE",
        ),
        (
            "PROCEDURE p; PROCEDURE q; BEGIN END; BEGIN END; BEGIN END.",
            (1, 14),
            "'PROCEDURE' inside another routine",
        ),
        (
            "FUNCTION f : BOOLEAN; BEGIN END; EVENT e ON f; BEGIN END; BEGIN END.",
            (1, 45),
            "a condition of an EVENT",
        ),
        ("WRITE (1 : 2 : 3);", (1, 8), "only a DOUBLE has decimals"),
        ("ERRORREG := 0;", (1, 1), "'errorreg' can only be read"),
        ("(1);", (1, 1), "a statement expected, not '('"),
        ("BEGIN SIN (1) := 2 END.", (1, 7), "'SIN (...)' cannot be assigned to"),
        ("CI0 := " + "(" * 60 + "1" + ")" * 60 + ";", (1, 48), "nested too deeply"),
    ],
)
def test_mistakes_are_found_where_they_are(text: str, at: tuple[int, int], what: str) -> None:
    program, errors = sap.check(text)
    assert program is None
    position = errors[0].position
    assert position is not None
    assert errors[0].what.startswith(what) or what in errors[0].what
    assert (position.line, position.column) == at
    assert errors[0].hint.endswith((".", "?"))


def test_every_mistake_of_a_file_is_reported_once() -> None:
    text = (
        "VAR i : INTEGER; j : REAL\n"  # no semicolon
        "BEGIN\n"
        "  FOR i := 1 TO 3 mlr (X := 25, C := i);\n"
        "  IF i = THEN j := 3 ELSE j := 4;\n"
        "  CASE i OF 1: i := ; 2: i := 3; END;\n"
        "  j := (3;\n"
        "  WHILE i < 3 DO BEGIN i := i + ; j := 2 END;\n"
        "END.\n"
    )
    _, errors = sap.check(text)
    assert [error.position.line for error in errors if error.position] == [2, 3, 4, 5, 6, 7]
    _, errors = sap.check("BEGIN CI0 := 1.5;\n CI1 := a;\n IF CI0 THEN js (1); j; END.")
    assert [error.position.line for error in errors if error.position] == [1, 2, 3, 3]


def test_a_long_sum_and_a_long_chain_of_branches_are_no_problem() -> None:
    assert results("CI0 := " + " + ".join(["1"] * 5000) + ";") == [5000]
    chain = " ELSE ".join(f"IF CI1 = {n + 1} THEN CI0 := {n}" for n in range(1000))
    assert results(f"{chain} ELSE CI0 := 7;") == [7]


def test_compile_raises_the_first_mistake_and_knows_four_tasks() -> None:
    with pytest.raises(ProgramError, match="unknown name 'x'"):
        sap.compile_program("x := 1; y := 2;")
    for task in (-1, 4):
        with pytest.raises(UsageError, match=f"no task {task}"):
            sap.compile_program("", task=task)
    assert sap.compile_program("", task=3).task == 3
