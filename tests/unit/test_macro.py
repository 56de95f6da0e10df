"""Custom macros: variables, expressions, flow, calls and system variables, against figures made by hand."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.macro import MacroCalls, MacroError, MacroLanguage, MacroVariables


def run(
    text: str, language: MacroLanguage | None = None, dialect: str = "fanuc", **options: object
) -> tuple[ProgramRun, MacroVariables]:
    """Run a program to its end."""
    language = language or MacroLanguage()
    language.longest_loop_pauses = 20
    machine = Machine(load_machine(None))
    program = ProgramText.from_text(text, "macro.tap")
    made = ProgramRun(
        machine,
        program,
        load_dialect(dialect),
        language=language,
        options=RunOptions(stands_at_stops=False, **options),  # type: ignore[arg-type]
    )
    made.start()
    while made.active:
        made.advance(1_000_000)
    return made, language.variables


def value(expression: str, before: str = "") -> float | None:
    """Return what an expression gives."""
    made, variables = run(f"{before}#100={expression}\nM30\n")
    assert made.error is None, str(made.error)
    return variables.get(100)


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("2+3*4", 14.0),
        ("[2+3]*4", 20.0),
        ("10/4-2", 0.5),
        ("7-2-3", 2.0),
        ("-[3-5]", 2.0),
        ("SIN[30]", 0.5),
        ("COS[60]", 0.5),
        ("TAN[135]", -1.0),
        ("ASIN[0.5]", 30.0),
        ("ASIN[-0.5]", 330.0),
        ("ACOS[-0.5]", 120.0),
        ("ATAN[1]", 45.0),
        ("ATAN[1]/[-1]", 135.0),
        ("ATAN[-1]/[-1]", 225.0),
        ("ATAN[-3,4]", 360.0 - math.degrees(math.atan(0.75))),
        ("ATAN[6]/2", math.degrees(math.atan(6.0)) / 2.0),
        ("SQRT[2.25]", 1.5),
        ("ABS[-7.5]", 7.5),
        ("ROUND[2.5]", 3.0),
        ("ROUND[-2.5]", -3.0),
        ("FIX[-2.7]", -2.0),
        ("FUP[2.1]", 3.0),
        ("FUP[-2.1]", -3.0),
        ("BIN[18]", 12.0),
        ("BCD[12]", 18.0),
        ("LN[EXP[2]]", 2.0),
        ("POW[3,4]", 81.0),
        ("12 AND 10", 8.0),
        ("12 OR 3", 15.0),
        ("12 XOR 10", 6.0),
        ("17 MOD 5", 2.0),
        ("-17 MOD 5", -2.0),
        ("2+12 AND 10", 10.0),
        ("3*7 MOD 4", 1.0),
        ("#0", None),
        ("#0+0", 0.0),
        ("-#0*5", 0.0),
    ],
)
def test_expressions_give_what_the_control_calculates(expression: str, expected: float | None) -> None:
    found = value(expression)
    if expected is None:
        assert found is None
    else:
        assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("#1 EQ #0", True),
        ("#1 EQ 0", False),
        ("#1 NE #0", False),
        ("#1 NE 0", True),
        ("#1 GE #0", True),
        ("#1 GE 0", True),
        ("#1 GT 0", False),
        ("#1 LE 0", True),
        ("#1 LT 0.5", True),
        ("[2 GT 1] AND [3 GT 4]", False),
        ("[2 GT 1] OR [3 GT 4]", True),
        ("[2 GT 1] XOR [3 LT 4]", False),
    ],
)
def test_a_vacant_variable_is_equal_to_vacant_only_and_counts_as_zero_else(
    condition: str, expected: bool
) -> None:
    _, variables = run(f"#100=5\nIF [{condition}] THEN #100=6\nM30\n")
    assert variables.get(100) == (6.0 if expected else 5.0)


def test_loops_and_jumps() -> None:
    text = (
        "#100=0\n#1=0\nWHILE [1 EQ 1] DO1\n#2=0\nWHILE [#2 LT 5] DO2\nIF [#1*5+#2 EQ 13] GOTO 9\n"
        "#100=#100+1\n#2=#2+1\nEND2\n#1=#1+1\nEND1\n#101=99\nN9 #102=#1*10+#2\n"
        "#3=40\nGOTO #3\nN30 #103=3\nN40 #104=4\nGOTO[#3+10]\n#105=7\nN50 M30\n"
    )
    made, variables = run(text)
    assert made.error is None
    assert [variables.get(n) for n in range(100, 106)] == [13.0, None, 23.0, None, 4.0, None]


def test_a_goto_finds_the_next_block_of_a_number_before_the_first() -> None:
    _, variables = run("N5 #100=#100+1\nIF [#100 GT 3] GOTO 6\nGOTO 5\nN6 #101=8\nGOTO 7\nN7 M30\n")
    assert (variables.get(100), variables.get(101)) == (4.0, 8.0)


def test_a_semicolon_ends_a_block_at_the_end_of_its_line() -> None:
    _, variables = run("O1; \n#100=0;\nN60;\n#100=#100+1 ;\nIF [#100 LT 3] GOTO 60;\n#101=7 ;\t\nM30;")
    assert (variables.get(100), variables.get(101)) == (3.0, 7.0)
    made, _ = run("G90 G0 X5; \t(out; there) (far)\nY2;(up)\nM30;\n")
    assert made.reading.position == pytest.approx({"X": 5.0, "Y": 2.0, "Z": 0.0}, abs=1e-9)
    made, _ = run("G0 X5; Y2\nM30\n")
    assert made.error is not None
    assert "write what follows into a line of its own" in made.error.hint


def test_words_may_be_written_by_their_first_two_letters() -> None:
    made, variables = run(
        "WH[#100 LT 4]DO1\n#100=#100+SI[90]\nEN1\nIF[#100EQ4]TH#101=RO[2.6]+FU [0.1]\nM30\n"
    )
    assert made.error is None, str(made.error)
    assert (variables.get(100), variables.get(101)) == (4.0, 4.0)
    made, _ = run("GO10\nN10 M30\n")  # which is G1 with a slip
    assert made.error is not None


def test_a_statement_may_stand_right_behind_its_block_number() -> None:
    made, variables = run(
        "N10GOTO20\n#100=1\nN20DO1\n#101=#101+1\nIF[#101 GE 3]GOTO30\nN25END1\nN30WHILE[#102 LT 4]DO2\n"
        "#102=#102+2\nN35END2\nM30\n"
    )
    assert made.error is None
    assert [variables.get(n) for n in (100, 101, 102)] == [None, 3.0, 4.0]


def test_a_sign_before_a_calculated_word_keeps_or_turns_it() -> None:
    made, _ = run("#1=7.5\n#2=3\nG0 X+#1 Y-#2 Z+[#1-#2]\nX+#9\nM30\n")
    assert made.reading.position == pytest.approx({"X": 7.5, "Y": -3.0, "Z": 4.5}, abs=1e-9)


def test_blocks_between_statements_are_run_with_calculated_words() -> None:
    made, _ = run("#1=12.3456\nG1 X#1 Y-[#1*2] F[600+400]\nX#2 Z-#2\nX[1/3]\nM30\n")
    assert made.reading.position == pytest.approx({"X": 0.333, "Y": -24.691, "Z": 0.0}, abs=1e-9)
    assert made.error is None


def test_plain_text_is_not_taken_by_the_language() -> None:
    language = MacroLanguage()
    run("G0 X5 (#1=5 [IGNORED])\nG1 X7 F500\nM30\n", language)
    text = ProgramText.from_text("G0 X5 (#1 GOTO 5)\nM30\n")
    assert language.source(text, 0, 1, None) is None


# ------------------------------------------------------------------ calls


def test_arguments_of_the_first_form_go_to_their_variables() -> None:
    letters = {"A": 1, "B": 2, "C": 3, "D": 7, "E": 8, "F": 9, "H": 11, "I": 4, "J": 5, "K": 6, "M": 13}
    letters |= {"Q": 17, "R": 18, "S": 19, "T": 20, "U": 21, "V": 22, "W": 23, "X": 24, "Y": 25, "Z": 26}
    words = " ".join(f"{letter}{number + 0.25}" for letter, number in letters.items())
    copies = "".join(f"#{500 + number}=#{number}\n" for number in letters.values())
    made, variables = run(f"G65 P9000 {words}\nM30\nO9000\n{copies}M99\n")
    assert made.error is None
    for number in letters.values():
        assert variables.get(500 + number) == number + 0.25


def test_arguments_of_the_second_form_repeat_i_j_k_and_the_later_of_two_counts() -> None:
    made, variables = run(
        "G65 P9000 A1 B2 I3 J4 K5 I6 K7 D8 I9\nM30\nO9000\n#100=#4\n#101=#7\n#102=#8\n#103=#9\n#104=#10\nM99\n"
    )
    assert made.error is None
    assert [variables.get(n) for n in range(100, 105)] == [3.0, 8.0, None, 7.0, 9.0]
    words = " ".join(
        f"{letter}{7 * row + place + 2.5}" for row in range(10) for place, letter in enumerate("IJK")
    )
    copies = "".join(f"#{500 + number}=#{number}\n" for number in range(1, 34))
    _, variables = run(f"G65 P9000 {words} C5.5\nM30\nO9000\n{copies}M99\n")
    found = [variables.get(500 + number) for number in range(1, 34)]
    assert found == [None, None, 5.5, *(7 * row + place + 2.5 for row in range(10) for place in range(3))]
    _, variables = run(f"G65 P9000 I2 K3 J4 J5\nM30\nO9000\n{copies}M99\n")
    assert [number for number in range(1, 34) if variables.get(500 + number) is not None] == [4, 6, 8, 11]


def test_each_call_has_its_own_local_variables_and_a_sub_program_shares_them() -> None:
    text = (
        "#1=5\nG65 P9000 A2 L3\nM98 P9001\nM30\n"
        "O9000\n#100=#100+#1\n#1=77\nG65 P9002 A[#1+1]\n#101=#1\nM99\n"
        "O9001\n#102=#1\n#1=6\nM99\nO9002\n#103=#1\n#104=#2\nM99\n"
    )
    made, variables = run(text)
    assert made.error is None
    assert [variables.get(n) for n in range(100, 105)] == [6.0, 77.0, 5.0, 78.0, None]
    assert variables.get(1) == 6.0
    assert variables.level == 0


def test_a_modal_call_follows_every_move_until_g67() -> None:
    text = "#100=0\nG66 P9000 A2\nG0 X1\nX#100 Y2\nG4 P10\nM98 P9001\nG67\nX4\nM30\n"
    text += "O9000\n#100=#100+#1\nM99\nO9001\nX3\nM99\n"
    made, variables = run(text)
    assert made.error is None
    assert variables.get(100) == 6.0


@pytest.mark.parametrize(
    "block",
    ["G4 X.1", "G10 L2 P2 X3", "G28 X2", "G30 P2 X2", "G52 X3", "G68 X0 Y0 R20", "G51 X0 Y0 P500", "G50", "G92 X5",
     "G51.1 X2", "G50.1 X2", "M8", "T3", "F300"],
)  # fmt: skip
def test_what_is_no_move_calls_nothing(block: str) -> None:
    text = f"#100=0\nG66 P9000\n{block}\nG67\nM30\nO9000\n#100=#100+1\nM99\n"
    made, variables = run(text)
    assert made.error is None, str(made.error)
    assert variables.get(100) == 0.0
    _, variables = run(text.replace(block, f"{block}\nY3"))
    assert variables.get(100) == 1.0


def test_values_in_addresses_are_what_their_functions_give() -> None:
    made, _ = run("G90 G0 X[ABS[-2.3456]] Y[FIX[-7.9]+ROUND[1.23456]] Z[FUP[3.2]]\nM30\n")
    assert made.error is None
    # ROUND in an address is to the least increment; elsewhere to a whole number.
    assert made.reading.position == {
        "X": pytest.approx(2.346),
        "Y": pytest.approx(-5.765),
        "Z": pytest.approx(4.0),
    }
    _, variables = run("G1 X1 F[1000/3]\n#100=#4109\nF[50/7]\n#101=#4109\nM30\n")
    assert [variables.get(n) for n in (100, 101)] == pytest.approx([333.3333, 7.1429], abs=1e-9)


def test_a_condition_of_a_loop_is_reckoned_anew_in_every_round() -> None:
    text = "#1=0\n#101=5\n#102=4\n#103=2\n#104=9\n"
    text += "WHILE[#[101+#1]GT3]DO1\n#1=#1+1\n#110=#110+#[100+#1]\nEND1\nM30\n"
    made, variables = run(text)
    assert made.error is None
    assert (variables.get(1), variables.get(110)) == (2.0, 9.0)
    text = "#1=5\nWHILE[#[5040+#2+1]LT7.5]DO1\nG91 G1 X2 F5000\n#1=#1+1\nEND1\nM30\n"  # where the axis stands
    made, variables = run(text)
    assert made.error is None
    assert variables.get(1) == 9.0


@pytest.mark.parametrize(("degree", "sine"), [
    (0, 0.0), (30, 0.5), (90, 1.0), (150, 0.5), (180, 0.0), (210, -0.5), (270, -1.0), (330, -0.5), (360, 0.0),
    (-30, -0.5),
    (390, 0.5), (-150, -0.5), (720, 0.0),
])  # fmt: skip
def test_sines_that_are_whole_or_half_are_exact(degree: int, sine: float) -> None:
    assert value(f"SIN[{degree}]") == sine
    assert value(f"COS[{90 - degree}]") == sine


def test_a_return_to_a_block_goes_on_there() -> None:
    _, variables = run(
        "M98 P9000\n#100=1\nN50 #101=2\nM98 P9000\nM30\nO9000\n#102=#102+1\nIF[#102 EQ 1]GOTO 1\nM99\nN1 M99 P50\n"
    )
    assert [variables.get(n) for n in (100, 101, 102)] == [None, 2.0, 2.0]


def test_codes_call_programs_by_table_and_are_ordinary_inside() -> None:
    calls = MacroCalls(g={81.5: 9010}, m={50: 9020}, m_sub={51: 9001}, t=9000)
    text = (
        "G81.5 X5 Z-2\nM50 A3.5\n#1=7\nM51\nT12\nM30\n"
        "O9010\n#100=#24\nM50\nM99\nO9020\n#101=#1\nM99\nO9001\n#102=#1\nM99\nO9000\n#103=#149\nM99\n"
    )
    made, variables = run(text, MacroLanguage(calls=calls))
    assert made.error is None
    assert [variables.get(n) for n in range(100, 104)] == [5.0, 3.5, 7.0, 12.0]


def test_words_beside_codes_that_call_are_moved_before_or_handed_over() -> None:
    calls = MacroCalls(g={81.5: 9010}, m={50: 9020}, m_sub={51: 9001}, t=9000)
    text = (
        "G90 G0\nX4 G81.5 Y7.5 Z-2 L3\nM50 A3.5 L2\nM51 Z6 L4\nT12 X9\nM30\n"
        "O9010\n#100=#100+#25\n#101=#24\n#102=#5001\nM99\nO9020\n#103=#103+#1\nM99\n"
        "O9001\n#104=#104+#5003\nM99\nO9000\n#105=#149+#5001\nM99\n"
    )
    made, variables = run(text, MacroLanguage(calls=calls))
    assert made.error is None, str(made.error)
    assert [variables.get(n) for n in range(100, 106)] == [22.5, None, 4.0, 7.0, 24.0, 21.0]
    assert made.reading.position == {"X": 9.0, "Y": 0.0, "Z": 6.0}
    for block in ("X1 M50 A2", "G81.5 X2 X3", "G81.5 N3 X2"):
        made, _ = run(f"#1=2\n{block}\nM30\nO9010\nM99\nO9020\nM99\n", MacroLanguage(calls=calls))
        assert made.error is not None, block
        assert made.error.position is not None
        assert made.error.position.line == 2


def test_macros_nest_four_deep() -> None:
    made, variables = run("G65 P9000\nM30\nO9000\n#100=#100+1\nG65 P9000\nM99\n")
    assert variables.get(100) == 4.0
    assert made.error is not None
    assert made.error.code == "PS0122"


def test_m99_in_a_main_program_ends_or_repeats_it() -> None:
    made, variables = run("#100=#100+1\nM99\n")
    assert variables.get(100) == 1.0
    assert made.error is None
    repeating = MacroLanguage(main_repeats=True)
    _, variables = run("#100=#100+1\nIF [#100 EQ 4] GOTO 8\nM99\nN8 M30\n", repeating)
    assert variables.get(100) == 4.0


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("TAN[30]", math.tan(math.radians(30.0))), ("TAN[-45]", -1.0), ("COS[780]", 0.5), ("ATAN[2]", 63.4349488229),
        ("ACOS[1.0000000005]", 0.0), ("ASIN[-1.0000000005]", 270.0), ("ROUND[0]", 0.0), ("ROUND[-0.4]", 0.0),
        ("FIX[2.9999999999]", 3.0), ("FIX[7.75]", 7.0), ("FUP[3.0000000001]", 3.0), ("FUP[-7.25]", -8.0),
        ("EXP[0.7]", math.exp(0.7)), ("LN[0.4]", math.log(0.4)), ("BIN[295]", 127.0), ("BCD[99999999]", 0x99999999),
        ("2147483647 AND 6", 6.0), ("-6 OR 3", -5.0), ("-6 XOR 3", -7.0), ("7.6 MOD 2.5", 2.0), ("POW[2,-3]", 0.125),
        ("POW[-8,3]", -512.0), ("POW[2,158]*1.5", 1.5 * 2.0**158), ("[[[[[7]]]]]*3", 21.0), ("SQR[2.25]", 1.5),
    ],
)  # fmt: skip
def test_functions_near_their_limits(expression: str, expected: float) -> None:
    assert value(expression) == pytest.approx(expected, rel=1e-11, abs=1e-11)


@pytest.mark.parametrize(
    ("expression", "code"),
    [
        ("TAN[90]", "PS0119"), ("TAN[-270]", "PS0119"), ("ACOS[-1.00001]", "PS0119"), ("ATAN[0]/[0]", "PS0119"),
        ("LN[-2]", "PS0119"), ("SQRT[-0.25]", "PS0119"), ("POW[-8,0.5]", "PS0119"), ("BIN[-5]", "PS0119"),
        ("BCD[-1]", "PS0119"), ("BCD[100000000]", "PS0119"), ("2147483648 OR 1", "PS0119"), ("EXP[720]", "PS0111"),
        ("EXP[400]", "PS0111"), ("POW[10,48]", "PS0111"), ("-[#2*2]", "PS0111"), ("#2+#2", "PS0111"),
        ("#2*2", "PS0111"), ("ABS[#2*2]", "PS0111"), ("#2-[-#2]", "PS0111"), ("5 MOD 0.3", "PS0112"),
    ],
)  # fmt: skip
def test_what_cannot_be_calculated_leaves_the_variable_as_it_was(expression: str, code: str) -> None:
    for target in ("#100", "#[#3]"):
        made, variables = run(f"#2=POW[2,158]\n#3=100\n#100=7.5\n{target}={expression}\nM30\n")
        assert made.error is not None
        assert made.error.position is not None
        assert (made.error.code, made.error.position.line, variables.get(100)) == (code, 4, 7.5)


def test_angles_may_be_those_of_the_other_half() -> None:
    language = MacroLanguage(nat=True)
    _, variables = run("#100=ASIN[-0.5]\n#101=ATAN[-1]/[-1]\n#102=ATAN[-3,4]\nM30\n", language)
    found = [variables.get(number) for number in (100, 101, 102)]
    assert found == pytest.approx([-30.0, -135.0, -math.degrees(math.atan(0.75))], abs=1e-9)


def test_half_an_increment_is_rounded_away_from_zero_as_its_digits_say() -> None:
    made, _ = run("#1=1.0005\n#2=-2.0015\nG0 X#1 Y#2 Z-#1\nM30\n")  # in binary both are a little less
    assert made.reading.position == pytest.approx({"X": 1.001, "Y": -2.002, "Z": -1.001}, abs=1e-9)


@pytest.mark.parametrize("fourth", ["20", "#120", "[#120]"])
def test_jumps_lead_out_of_one_two_and_three_loops(fourth: str) -> None:
    text = (
        "#120=20\nN1 #1=#1+1\nDO1\n#2=#2+1\nN20 #110=#110+1\nDO2\n#3=#3+1\nN30 #111=#111+1\nDO3\n#4=#4+1\n"
        f"IF[#4EQ2]GOTO30\nIF[#4EQ5]GOTO20\nIF[#4EQ7]GOTO1\nIF[#4EQ8]GOTO{fourth}\nIF[#4EQ11]GOTO90\n"
        "END3\n#112=1\nEND2\n#113=1\nEND1\n#114=1\nN90 M30\n"
    )
    made, variables = run(text)
    assert made.error is None, str(made.error)
    assert [variables.get(n) for n in (1, 2, 3, 4, 110, 111)] == [2.0, 2.0, 4.0, 11.0, 4.0, 5.0]
    assert [variables.get(n) for n in (112, 113, 114)] == [None, None, None]


@pytest.mark.parametrize(
    ("text", "line", "rounds"),
    [
        ("#2=5\nN5 #100=#100+1\nGOTO#2\n", 3, 21 * 6),  # a number that is looked for counts ten
        ("G0 X2\nN5 #100=#100+1\nGOTO5\n", 3, 21 * 51),
        ("#1=3\n#100=#100+1\nM99\n", 3, 21 * 51),
        ("#1=3\nDO2\n#100=#100+1\nEND2\n", 2, 21 * 51),
        ("#1=3\nWHILE[#1EQ3]DO2\n#100=#100+1\nEND2\n", 2, 21 * 51),
    ],
)
def test_a_loop_without_a_block_ends_after_its_pauses(text: str, line: int, rounds: int) -> None:
    language = MacroLanguage(pause_jumps=50, main_repeats=True)
    made, variables = run(text, language)
    assert made.error is not None
    assert made.error.position is not None
    assert (made.error.what, made.error.position.line) == ("this loop goes on without end", line)
    assert variables.get(100) == rounds


def test_a_block_in_a_long_loop_lets_it_go_on() -> None:
    inner = "#2=0\nWHILE[#2LT800]DO2\n#2=#2+1\nEND2\n"
    made, variables = run(
        f"WHILE[#1LT4]DO1\n#1=#1+1\n{inner}G0 X#1\nEND1\nM30\n", MacroLanguage(pause_jumps=50)
    )
    assert made.error is None, str(made.error)
    assert (variables.get(1), made.reading.position["X"]) == (4.0, 4.0)


@pytest.mark.parametrize(
    ("text", "place", "code"),
    [
        ("GOTO20\nG0 X1\nX2\nN20 X4\nX5\nX6 G999\nM30\n", (6, 4), ""),
        ("G0 X1\nN10 X2\nX3\nN20 X4\nX5\n#1=1/#0\nGOTO20\n", (6, 1), "PS0112"),
        ("%\n(HEAD)\nO0001 (MAIN)\nG0 X1\nG65 P2 A3\nM30\nO0002\nX2\n  #1=1/#0\nM99\n%\n", (9, 3), "PS0112"),
        ("#1=2\r\nG0 X3\r\nY4\r\n#2=1/#0\r\nM30\r\n", (4, 1), "PS0112"),
        ("G1 Y2 X1,5 Z#1\n", (1, 7), "PS0114"),
        ("#1=2\nN100000000 #1=1\n", (2, 2), "PS0128"),
        ("GOTO 1.5\n", (1, 6), "PS0128"),
        ("#1.5=2\n", (1, 2), "PS0115"),
        ("#1=ADP[#34]\n", (1, 4), "PS0114"),
        ("#1=ADP[#0]\n", (1, 4), "PS0114"),
        ("#1=POW[2]\n", (1, 9), "PS0114"),
        ("/DO1\nEND1\n", (1, 2), "PS0125"),
        ("DO1\n/3 END1\n", (2, 4), "PS0125"),
        ("M98 P9\nM30\nO9\nX1 M99 P5\nN5\n", (4, 1), "PS0125"),
        ("X1 G65 P9\n", (1, 1), "PS0125"),
        ("#1=100000000\nG65 P#1\n", (2, 1), "PS0076"),
        ("#1=10000\nG65 P9 L#1\nM30\nO9\nM99\n", (2, 1), "PS0119"),
        ("IF #1 EQ 2 GOTO 5\n", (1, 4), "PS0125"),
        ("WHILE[#1EQ2]\n", (1, 13), "PS0125"),
        ("#1=PRM[3]\n", (1, 4), "PS0114"),
        ("#1=100000000\nGOTO#1\n", (2, 1), "PS0128"),
        ("G65 P9 N3\n", (1, 8), "PS0119"),
        ("SETVN 499[A,B]\n", (1, 1), "PS0115"),
        ("SETVN 998[A,B,C]\n", (1, 1), "PS0115"),
        ("#3000=1000.5(X)\n", (1, 1), "PS0119"),
    ],
)
def test_an_error_is_told_where_it_stands(text: str, place: tuple[int, int], code: str) -> None:
    made, _ = run(text)
    assert made.error is not None
    assert made.error.position is not None
    at = made.error.position
    assert (at.line, at.column, made.error.code) == (*place, code), str(made.error)


def test_what_is_skipped_is_skipped_before_and_behind_its_block_number() -> None:
    text = "#1=4.5\n/3 G0 X#1\nN8 /3 #101=2\n/3 N9 #102=3\n/2 Y#1\nN10 /2 #103=5\n/ #104=6\nM30\n"
    made, variables = run(text, block_delete=frozenset({3}))
    assert made.reading.position == {"X": 0.0, "Y": 4.5, "Z": 0.0}
    assert [variables.get(n) for n in (101, 102, 103, 104)] == [None, None, 5.0, 6.0]
    made, variables = run(text, block_delete=frozenset({1, 2}))
    assert made.reading.position == {"X": 4.5, "Y": 0.0, "Z": 0.0}
    assert [variables.get(n) for n in (101, 102, 103, 104)] == [2.0, 3.0, None, None]


def test_the_last_block_number_may_stand_long_before() -> None:
    words = "(A REMARK WITHOUT A NUMBER)\n" * 200
    _, variables = run(f"N3 G0 X1\nN7 Y2\n{words}#100=#4114\nN8 X2\n#101=#4114\nM30\n")
    assert (variables.get(100), variables.get(101)) == (7.0, 8.0)


def test_a_statement_behind_much_plain_text_is_found() -> None:
    language = MacroLanguage()
    run("M30\n", language)
    filled = "(" + 61 * "A" + ")\n"
    text = ProgramText.from_text(f"{filled * 16_385}GOTO7\nN7 M30\n")  # the first line after a piece
    assert language.source(text, 0, 1, None) is not None
    text = ProgramText.from_text(f"{filled * 16_385}N7 M30\n")
    assert language.source(text, 0, 1, None) is None


# ------------------------------------------------------------------ system variables


def test_end_points_are_read_ahead_and_positions_when_they_are_reached() -> None:
    made, variables = run(
        "G90 G0 X10 Y5\n#100=#5001\n#101=#5042\n#102=#5021\n#103=#4001\nG91 G1 X2.5 F300\n"
        "#104=#5041\n#105=#4003\n#106=#4109\nG4 P500\n#3001=0\nG4 P250\n#107=#3001\nM30\n"
    )
    assert made.error is None
    assert [variables.get(n) for n in range(100, 107)] == [10.0, 5.0, 10.0, 0.0, 12.5, 91.0, 300.0]
    assert variables.get(107) == pytest.approx(250.0, abs=2.0)


def test_offsets_are_variables() -> None:
    made, variables = run(
        "#5221=33\n#100=#2501\nG54 G0 X#100\n#101=#5001\n#102=#5021\n"
        "#11003=12.5\nG43 H3 Z1\n#103=#5083\n#104=#5023\nM30\n"
    )
    assert made.error is None
    assert [variables.get(n) for n in range(100, 105)] == [33.0, 33.0, 66.0, 12.5, 13.5]


@pytest.mark.parametrize(
    ("variable", "name", "axis"),
    [
        (5203, "EXT", 2), (5222, "G54", 1), (5301, "G58", 0), (5323, "G59", 2), (2500, "EXT", 0), (2703, "G56", 2),
        (7002, "G54.P1", 1), (7063, "G54.P4", 2), (7941, "G54.P48", 0), (14001, "G54.P1", 0), (19983, "G54.P300", 2),
    ],
)  # fmt: skip
def test_each_number_of_an_offset_is_that_of_its_group_and_axis(variable: int, name: str, axis: int) -> None:
    made, variables = run(f"#{variable}=-7.25\n#100=#{variable}\nM30\n")
    assert made.error is None, str(made.error)
    assert variables.get(100) == -7.25
    offset = made.channel.state.tables.work_offset(name)
    assert [place for place, value in enumerate(offset) if value == -7.25] == [axis]


@pytest.mark.parametrize("code", [73, 74, 76, 81, 82, 83, 84, 85, 86, 87, 88, 89])
def test_a_cycle_is_the_modal_code_of_its_group(code: int) -> None:
    turn, levels = "M4" if code == 74 else "M3", "Z4 R-1" if code == 87 else "Z-4 R1"
    made, variables = run(
        f"G0 Z10\n{turn} S500\nG{code} X2 Y3 {levels} Q.5 P100 F500\n#101=#4009\nG80\n#102=#4009\nM5\nM30\n"
    )
    assert made.error is None, str(made.error)
    assert [variables.get(n) for n in (101, 102)] == [code, 80.0]


def test_a_control_with_other_codes_of_cycles_tells_its_own() -> None:
    cycles = (
        "G87 X2 Y3 Z-4 R1 F500\n#101=#4009\nG80\nG88 X5 Z-4 R1\n#102=#4009\nG77 Z4 R-1 Q.5\n#103=#4009\nG80\n"
    )
    made, variables = run(f"G0 Z10\nM3 S500\n{cycles}M5\nM30\n", dialect="haas")
    assert made.error is None, str(made.error)
    assert [variables.get(n) for n in (101, 102, 103)] == [87.0, 88.0, 77.0]


def test_mirrored_axes_are_bits() -> None:
    made, variables = run(
        "#100=#3007\nG51.1 X4\n#101=#3007\nG51.1 Z2\n#102=#3007\nG50.1 X0\n#103=#3007\nG50.1 Z0\nM30\n"
    )
    assert made.error is None, str(made.error)
    assert [variables.get(n) for n in range(100, 104)] == [0.0, 1.0, 5.0, 4.0]


def test_an_alarm_comes_when_the_blocks_before_have_been_run() -> None:
    made, _ = run("G1 X20 F6000\n#3000=5(TOOL IS WORN)\nX30\nM30\n")
    assert made.error is not None
    assert str(made.error).splitlines()[0] == "macro.tap:2:1: TOOL IS WORN [MC3005]"
    assert made.reading.position["X"] == pytest.approx(20.0)


def test_a_message_stop_is_a_program_stop_with_its_text() -> None:
    made, _ = run("G0 X1\n#3006=1(TURN THE PART)\nG0 X2\nM30\n")
    assert made.error is None
    assert any("TURN THE PART" in message.text for message in made.channel.messages.all())


def test_a_skipped_statement_is_skipped_with_its_level_only() -> None:
    text = "/ #100=1\n/2 #101=2\nM30\n"
    _, variables = run(text, block_delete=frozenset({2}))
    assert (variables.get(100), variables.get(101)) == (1.0, None)


# ------------------------------------------------------------------ variables


def test_variables_know_their_ranges() -> None:
    small = MacroVariables("a")
    small.set(531, 2.5)
    assert small.permanent() == {531: 2.5}
    for number in (34, 99, 150, 532, 1000, -1):
        with pytest.raises(MacroError) as caught:
            small.set(number, 1.0)
        assert caught.value.code == "PS0115"
    with pytest.raises(MacroError) as caught:
        small.set(0, 1.0)
    assert caught.value.code == "PS0116"
    with pytest.raises(MacroError) as caught:
        small.set(100, 1e48)
    assert caught.value.code == "PS0111"
    other = MacroVariables("a")
    other.set(500, 7.0)
    other.restore(small.permanent())
    assert (other.get(500), other.get(531)) == (None, 2.5)


def test_only_variables_of_the_same_size_are_gone_back_to() -> None:
    variables = MacroVariables("b")
    for level in range(4):
        variables.enter({7: level + 2.5})
    saved = variables.saved(lasting=True)
    assert variables.fits(saved)
    assert not variables.fits(saved._replace(levels=(*saved.levels, saved.levels[2])))
    assert not variables.fits(saved._replace(levels=(saved.levels[3], saved.levels[2][:-1])))
    assert not variables.fits(saved._replace(common=saved.common[1:]))
    assert saved.lasting is not None
    assert not variables.fits(saved._replace(lasting=saved.lasting[1:]))
    assert variables.fits(saved._replace(lasting=None))
    assert [variables.locals_of(level)[7] for level in range(5)] == [None, 2.5, 3.5, 4.5, 5.5]
    assert [variables.level_of(variables.locals_of(level)) for level in (3, 1)] == [3, 1]


# ------------------------------------------------------------------ wrong programs


@pytest.mark.parametrize(("sign", "hint"), [("<", "LT or LE"), (">", "GT or GE")])
def test_signs_of_other_languages_are_named_by_their_words(sign: str, hint: str) -> None:
    made, _ = run(f"#1=2\nIF[#1{sign}3]GOTO5\nN5\n")
    assert made.error is not None
    assert made.error.hint is not None
    assert hint in made.error.hint


ERRORS = Path(__file__).parent.parent / "golden" / "macro_errors"


@pytest.mark.parametrize("path", sorted(ERRORS.glob("*.tap")), ids=lambda path: path.stem)
def test_a_wrong_program_is_refused_with_the_error_in_its_first_line(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    expected = text.splitlines()[0].removeprefix("(").removesuffix(")")
    made, _ = run(text)
    assert made.error is not None
    assert made.error.position is not None
    at = made.error.position
    assert f"{at.line}:{at.column} {made.error.code} {made.error.what}" == expected
    assert made.error.hint


NEVER = [
    "GOTO 9",
    "GOTO 20",
    "#0=1",
    "#1000=#2",
    "#2=#1000",
    "X5 Y#1000",
    "WHILE[#1000 EQ 1]DO1",
    "END2",
    "DO3",
]


def test_what_cannot_be_executed_is_an_alarm_only_where_it_is_executed() -> None:
    *alone, loop, end, unended = NEVER
    text = ["GOTO 30", *alone, loop, "N20 X3", "END1", end, "N30 #100=7", "GOTO 40", unended, "N40 #101=8"]
    made, variables = run("\n".join(text))
    assert made.error is None, str(made.error)
    assert (variables.get(100), variables.get(101)) == (7.0, 8.0)
    found = {message.line: message.text for message in made.channel.messages.all()}
    assert sorted(found) == [2, 3, 4, 5, 11, 14]  # each text once, #1000 where it stands first
    assert found[2] == "there is no block N9 in this program, which is an alarm where it is executed"


@pytest.mark.parametrize("line", [*NEVER[:6], NEVER[6] + "\nN20\nEND1", *NEVER[7:]])
def test_what_cannot_be_executed_leaves_what_was_executed_before_it(line: str) -> None:
    made, variables = run(f"#100=7\nIF[#100 EQ 6] THEN #100=8\n{line}\n#101=1\nM30\n")
    assert made.error is not None
    assert made.error.position is not None
    assert (made.error.position.line, variables.get(100), variables.get(101)) == (3, 7.0, None)


def test_program_and_block_number_are_those_of_the_program_that_runs() -> None:
    made, variables = run(
        "O1234\nN5 G0X2\nG0Y3\n#100=#4114\nN20 #101=#4114\n#102=#4114\nG65 P57\n#106=#4114\n#107=#4115\n"
        "N40 IF[1 EQ 1] THEN #103=#4114\nN45 WHILE[#1 LT 2]DO1\n#104=#4314\nN50 #1=#1+1\nEND1\nM30\n"
        "O57\nN7 X1\n(N9 is no block)\n#105=#4114\n#108=#4115\nM99\n"
    )
    assert made.error is None, str(made.error)
    assert [variables.get(n) for n in range(100, 109)] == [5, 5, 20, 40, 45, 7, 7, 1234, 57]
