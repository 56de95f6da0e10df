"""The macro language beyond its worked cases: every function and operator, words, formats, numbers, errors."""

from __future__ import annotations

import json
import math

import pytest

from polycnc.errors import ConfigurationError, ProgramError, UsageError
from polycnc.post import ControlFile
from support.post_cases import TABLES, blocks_of, control_with


def _value(expression: str, setup: str = "") -> float:
    """Return what an expression gives, written with nine decimals."""
    tables = TABLES.replace('T = { format = "T%02d" }', 'T = { format = "%.9f" }')
    control = control_with({"RAPID": f"{setup}<T={expression}>$T$"}, tables=tables)
    written: list[str] = []
    control.start(written.append).call("RAPID")
    return float(written[0])


def _is_true(condition: str) -> bool:
    return blocks_of(f"IF({condition})\nYES\nELSE\nNO\nENDIF") == ["YES"]


def _error(macro: str) -> ConfigurationError:
    with pytest.raises(ConfigurationError) as error:
        control_with({"RAPID": macro})
    return error.value


FUNCTIONS = [
    ("DABS(-0.123456789)", 0.123456789),
    ("SIN(0.5)", 0.479425539),
    ("COS(0.5)", 0.877582562),
    ("TAN(0.5)", 0.546302490),
    ("ASIN(0.5)", 0.523598776),
    ("ACOS(0.5)", 1.047197551),
    ("ATAN(1)", 0.785398163),
    ("DEG(1)", 57.295779513),
    ("RAD(180)", math.pi),
    ("SQRT(2)", 1.414213562),
    ("EXP(1)", 2.718281828),
    ("LOG10(1000)", 3.0),
    ("LOG(10)", 2.302585093),
    ("DABS(-2.5)", 2.5),
    ("DMS(30.2625)", 30.1545),
    ("ADMS(30.1545)", 30.2625),
    # Below zero, in other quadrants, over a turn: worked out from their series.
    ("SIN(-2.5)", -0.5984721441040),
    ("SIN(4.75)", -0.9992927889754),
    ("COS(-2.5)", -0.8011436155469),
    ("COS(4.75)", 0.03760215288798),
    ("TAN(-0.5)", -0.5463024898438),
    ("TAN(2)", -2.185039863262),
    ("SIN(-40)", -0.7451131604793),
    ("COS(40)", -0.6669380616523),
    ("TAN(40)", -1.1172149309239),
    ("ASIN(-0.75)", -0.8480620789815),
    ("ACOS(-0.75)", 2.418858405776),
    ("ATAN(-3)", -1.249045772398),
    ("ATAN(0.2)", 0.1973955598499),
    ("DEG(-4)", -229.1831180523),
    ("DEG(10)", 572.957795131),
    ("RAD(-540)", -9.424777960769),
    ("RAD(725.5)", 12.66236372322),
    ("SQRT(1234.5)", 35.13545218152),
    ("EXP(-2.5)", 0.08208499862390),
    ("EXP(12)", 162754.791419004),
    ("LOG10(0.02)", -1.698970004336),
    ("LOG10(2500)", 3.397940008672),
    ("LOG(0.02)", -3.912023005428),
    ("DABS(7.25)", 7.25),
    ("DABS(-0.25)", 0.25),
    ("DABS(-0.0004)", 0.0004),
    ("DMS(-12.5)", -12.3),
    ("DMS(400.01)", 400.0036),
    ("DMS(7.0001)", 7.0000360),
    ("DMS(-0.5)", -0.3),
    ("DMS(-0.01)", -0.0036),
    ("ADMS(-0.3)", -0.5),
    ("DMS(7.000123456)", 7.0000444442),
    ("DMS(0.0833333333)", 0.05),
    ("ADMS(7.00305)", 7.00847222222),
    ("ADMS(0.57)", 0.95),
    ("ADMS(-1.13)", -1.2166666666667),
    ("ADMS(-12.3)", -12.5),
    ("ADMS(400.0036)", 400.01),
    # At the ends of what they take, and far out.
    ("SIN(0)", 0.0),
    ("COS(0)", 1.0),
    ("ASIN(1)", math.pi / 2),
    ("ASIN(-1)", -math.pi / 2),
    ("ACOS(1)", 0.0),
    ("ACOS(-1)", math.pi),
    ("ACOS(0)", math.pi / 2),
    ("ATAN(1000)", 1.569796327128),
    ("ATAN(-250)", -1.566796348128),
    ("DEG(0.00001)", 0.000572957795),
    ("RAD(0.01)", 0.000174532925),
    ("SQRT(0)", 0.0),
    ("SQRT(0.00000625)", 0.0025),
    ("EXP(0)", 1.0),
    ("EXP(-15)", 0.000000305902),
    ("LOG10(1.0)", 0.0),
    ("LOG10(0.00001)", -5.0),
    ("LOG(1)", 0.0),
    ("LOG(0.0001)", -9.210340371976),
    ("LOG(1000000)", 13.815510557964),
    ("DABS(0)", 0.0),
    ("DABS(-123456.75)", 123456.75),
    ("DMS(-400.01)", -400.0036),
    ("ADMS(-400.0036)", -400.01),
]


@pytest.mark.parametrize(
    ("call", "value"),
    [
        pytest.param(*row, marks=pytest.mark.covers(f"post.fn.{row[0].partition('(')[0]}"))
        for row in FUNCTIONS
    ],
)
def test_functions_take_radians_and_any_case(call: str, value: float) -> None:
    assert _value(call) == pytest.approx(value, abs=1e-9)  # as it is written, with nine decimals
    assert _value(call.lower()) == _value(call)
    inner = call[call.index("(") + 1 : -1]
    assert _value(call.replace(inner, f"({inner})*V1+0"), "<V1=1>") == _value(call)


@pytest.mark.covers("post.fn.DMS", "post.fn.ADMS")
def test_degrees_minutes_seconds_carry_and_keep_the_sign() -> None:
    assert _value("DMS(-12.5)") == pytest.approx(-12.3)
    assert _value("DMS(0.1+0.2-0.3+29.999999999999)") == pytest.approx(30.0)
    for degrees in (0.0, 0.01, 359.99, -7.123):
        assert _value(f"ADMS(DMS({degrees}))") == pytest.approx(degrees, abs=1e-9)


@pytest.mark.covers("post.op.plus", "post.op.minus", "post.op.mul", "post.op.div", "post.expr.number")
def test_arithmetic_has_the_usual_precedence() -> None:
    assert _value("1+2*3-8/4") == 5.0
    assert _value("(1+2)*(3-8)/4") == -3.75
    assert _value("8/4/2") == 1.0
    assert _value("2*-3--1") == -5.0
    assert _value(".5 + 1. + 0.25") == 1.75
    assert _value("10-3-4.5") == 2.5  # from the left
    assert _value("+2.5-+1*(+3)") == -0.5
    assert _value("7-10*0.125-(2-5)/4") == 6.5
    assert _value("12.0625") == 12.0625
    assert _value("-2.5*-V1 - -V1", "<V1=3.5>") == 12.25


@pytest.mark.covers("post.op.assign", "post.expr.assign", "post.expr.newvar", "post.expr.undefined")
def test_an_assignment_gives_a_new_value_made_of_the_old_one() -> None:
    assert _value("V1", "<V1=100+1>\n<V1=-V1*2+W>\n<W=V1-1>\n<V1=V1-W*2>") == 204.0
    assert _value("V2-V1", "<V2=3>\n<V1=V2>\n<V2=0>\n<V3=5>") == -3.0
    assert _value("V1*3000000", "<V1=1/3>\n<V2=V1>\n<V1=V2>") == 1_000_000.0


@pytest.mark.covers("post.macro.line_is_block")
def test_only_a_line_feed_ends_a_line() -> None:
    assert blocks_of("A\u2028B\x85C\u2029\nD") == ["A\u2028B\x85C\u2029", "D"]
    assert blocks_of(" A \n\n B \t") == [" A ", " B \t"]


@pytest.mark.covers("post.op.assign", "post.expr.newvar", "post.expr.case")
def test_names_of_any_length_are_told_apart_but_not_by_their_case() -> None:
    long = "A" + "1234567890_B" * 6
    names = (
        "DEPTH",
        "DEPTH1",
        "DEPTH_1",
        "DE",
        "D",
        "A1234567890B",
        "A1234567890C",
        long,
        f"{long}1",
        f"{long}2",
    )
    macro = "\n".join(f"<{name.lower()}={place}.5>" for place, name in enumerate(names, 1))
    for place, name in enumerate(names, 1):
        assert _value(name, macro) == _value(name.title(), macro) == place + 0.5


@pytest.mark.covers(
    "post.cond.equal",
    "post.cond.not_equal",
    "post.cond.less",
    "post.cond.less_or_equal",
    "post.cond.greater",
    "post.cond.greater_or_equal",
    "post.cond.tolerance",
)
@pytest.mark.parametrize(
    ("difference", "holds"),
    [
        (-0.0002, {"!=", "<", "<="}),
        (-0.00009, {"==", "<=", ">="}),
        (0.0, {"==", "<=", ">="}),
        (0.00009, {"==", "<=", ">="}),
        (0.0002, {"!=", ">", ">="}),
    ],
)
def test_comparisons_know_their_tolerance(difference: float, holds: set[str]) -> None:
    for operator in ("==", "!=", "<", "<=", ">", ">="):
        assert _is_true(f"5+({difference:.5f}){operator}5") == (operator in holds), operator


@pytest.mark.covers("post.cond.tolerance")
def test_a_difference_of_the_tolerance_itself_is_not_equal() -> None:
    assert not _is_true("0.0001==0")
    assert _is_true("0.0001>0")
    assert _is_true("0-0.0001<0")


@pytest.mark.covers("post.logic.and", "post.logic.or", "post.if.condition")
def test_and_binds_closer_than_or() -> None:
    assert _is_true("1==1 || 1==1 && 1==2")
    assert not _is_true("1==2 && 1==1 || 1==2")
    assert _is_true("1==2 && 1==2 || 1==1")
    assert _is_true("V1==0 || 1/V1>2")  # decided before the division


@pytest.mark.covers("post.if.operands")
def test_conditions_take_words_constants_and_arithmetic() -> None:
    macro = "IF(PATHNUMBER*2+1==7 && F/100>=5)\nA\nELSE IF(OUTPUTORDER==1)\nB\nENDIF"
    assert blocks_of(macro, words={"PATHNUMBER": 3, "F": 500.0}) == ["A"]
    assert blocks_of(f"<OUTPUTORDER=1>\n{macro}", words={"PATHNUMBER": 2, "F": 500.0}) == ["B"]
    for condition in ("F-490==4+12/2", "4+12/2==F-490", "7==PATHNUMBER+2*(F-498)-0", "-F<1-500", "1-F<2-500"):
        assert blocks_of(f"IF({condition})\nA\nENDIF", words={"PATHNUMBER": 3, "F": 500.0}) == ["A"]
        assert blocks_of(f"IF({condition})\nA\nENDIF", words={"PATHNUMBER": 9, "F": 495.0}) == []


@pytest.mark.covers("post.if.statement", "post.if.else_if")
def test_only_the_first_branch_that_holds_runs() -> None:
    macro = "IF(V1==1)\nA\nELSE IF(V1==2)\nB\nELSE IF(V1<=3)\nC\nELSE\nD\nENDIF"
    for each in (macro, macro.replace("ELSE IF", "ELSEIF"), macro.lower().replace("else if", "else \t if")):
        written = [blocks_of(f"<V1={value}>\n{each}") for value in (1, 2, 3, 4)]
        assert [block for [block] in written] == list("ABCD" if each.isupper() else "abcd")


@pytest.mark.covers("post.if.nesting")
def test_ifs_side_by_side_are_not_nested() -> None:
    assert blocks_of("IF(1==1)\nA\nENDIF\n" * 12) == ["A"] * 12


@pytest.mark.covers("post.if.endif", "post.if.else")
@pytest.mark.parametrize(
    ("macro", "what"),
    [
        ("ENDIF", "ENDIF has no IF before it"),
        ("IF(1==1)\nELSE\nELSE\nENDIF", "an ELSE came before"),
        ("IF(1==1)\nELSE\nELSE IF(1==1)\nENDIF", "an ELSE came before"),
        ("IF(1==1)\nELSE A\nENDIF", "ELSE needs a line of its own"),
        ("IF(1==1)\nA\nENDIF B\nENDIF", "ENDIF needs a line of its own"),
        ("IF(1==1) A\nENDIF", "the condition does not go on with 'A'"),
        ("IF 1==1\nENDIF", "'(' is missing before '1'"),
        ("IF(1==1 2==2)\nENDIF", "')' is missing before '2'"),
        ("IF(1)\nENDIF", "a comparison is missing before ')'"),
        ("IF(1==)\nENDIF", "a number or a variable is missing before ')'"),
        ("IF(1==1||)\nENDIF", "a number or a variable is missing before ')'"),
        ("IF(G90==1)\nENDIF", "G90 is a code and has no value"),
        ("IF(COMMENT==1)\nENDIF", "COMMENT is a text"),
    ],
)
def test_what_no_if_may_look_like(macro: str, what: str) -> None:
    assert _error(macro).what.endswith(what)


def test_words_that_only_begin_like_if_are_text() -> None:
    assert blocks_of('IFFY\nIF[#1EQ1]GOTO5\nENDIFS\n"ELSE"\nELSEWHERE') == [
        "IFFY",
        "IF[#1EQ1]GOTO5",
        "ENDIFS",
        "ELSE",
        "ELSEWHERE",
    ]


@pytest.mark.covers("post.seq.output")
@pytest.mark.covers("post.macro.elements", "post.macro.line_is_block")
def test_all_kinds_of_elements_in_one_macro() -> None:
    macro = "IF(T==3)\n@1@(TOOL )!M06!$TOOLCHANGE$<S=50*2>\"<>\"'/,-200'$S$\n@0@&S&$S$\nENDIF"
    words: dict[str, float | str] = {"TOOLCHANGE": "T03", "T": 3.0}
    assert blocks_of(macro, words=words, sequence_place=2) == ["N10(TOOL )M06T03<>/S100", "S100"]
    off = [each.removeprefix("N10") for each in blocks_of(macro, words=words, sequence_place=2)]
    assert blocks_of(macro, words=words, sequence_place=0) == off  # not where nothing is numbered
    more = f"{macro}\nEND"  # where every block is numbered, that of @0@ is not, and does not count
    assert blocks_of(more, words=words, sequence_place=1) == ["N10(TOOL )M06T03<>/S100", "S100", "N20END"]


@pytest.mark.covers("post.string.order_default", "post.string.literal", "post.string.dquote")
def test_text_without_an_order_has_order_0() -> None:
    assert blocks_of("<OUTPUTORDER=1>'B,0'a\"b\"'C,-1''D,1'") == ["CBabD"]


@pytest.mark.covers(
    "post.expr.string_value", "post.word.STARTOFLINE", "post.word.ENDOFLINE", "post.op.assign"
)
def test_texts_around_lines_keep_their_blanks_and_marks_until_others_come() -> None:
    macro = '<STARTOFLINE=" /!$@&< ">A\n<ENDOFLINE=" {;}  ">B\n<STARTOFLINE="">C'
    assert blocks_of(macro) == [" /!$@&< A", " /!$@&< B {;}  ", "C {;}  "]
    for name in ("V1", "X", "COMMENT", "OUTPUTORDER"):
        assert _error(f'<{name}="5">').what.endswith(f"{name} does not take a text")
    assert "takes a text in double quotes" in _error("<STARTOFLINE=5>").what


@pytest.mark.covers("post.string.literal", "post.string.special_chars", "post.string.dquote")
def test_text_keeps_every_character() -> None:
    assert blocks_of('  a B\t{x} \\ %d {{}} "\'"^~ #1=[2]') == ["  a B\t{x} \\ %d {{}} '^~ #1=[2]"]
    assert blocks_of('"!$@&<>"') == ["!$@&<>"]
    assert blocks_of('"  a b "c" \'d e\' "') == ["  a b c 'd e' "]
    for mark in "!$@&<>":
        assert _error(f"A{mark}").position is not None
    assert blocks_of("工具 交換") == ["工具 交換"]


@pytest.mark.covers("post.code.combined")
@pytest.mark.parametrize(
    "code", ["!*-G91!", "!-*G91!", "!--G91!", "!!", "! G91!", "!-!", "!+G91!", "!- G91!"]
)
def test_a_code_has_one_prefix(code: str) -> None:
    error = _error(f"ABC{code}")
    assert "is not the search key of a code" in error.what
    assert error.position is not None
    assert error.position.column == 4


@pytest.mark.covers("post.code.search_key", "post.sec.nc_code")
def test_a_code_is_changed_in_one_place() -> None:
    tables = TABLES.replace("G90 = { order = 20 }", 'G90 = { code = "G190", order = 20 }')
    written: list[str] = []
    run = control_with({"RAPID": "!G90!!-G91!!-G90!\n<OUTPUTORDER=1>ABC!G90!"}, tables=tables).start(
        written.append
    )
    run.call("RAPID")
    assert written == ["G190G91G190\n", "ABCG190\n"]


@pytest.mark.covers("post.code.minus", "post.code.modal_state")
def test_groups_of_g_and_m_codes_are_apart() -> None:
    tables = TABLES.replace('M08 = { group = "coolant" }', 'M08 = { group = "motion" }')
    written: list[str] = []
    run = control_with({"RAPID": "!-G00!!-M08!\n!-G00!!-M08!A"}, tables=tables).start(written.append)
    run.call("RAPID")
    assert written == ["G00M08\n", "A\n"]


@pytest.mark.covers(
    "post.word.X", "post.word.Y", "post.word.Z", "post.init.xyz", "post.concept.machining_origin"
)
@pytest.mark.parametrize(("axis", "origin"), [("X", 5.0), ("Y", -2.5), ("Z", 100.0)])
def test_initialised_axes_go_to_the_machining_origin(axis: str, origin: float) -> None:
    tables = TABLES.replace("X = 0.0, Y = 0.0, Z = 100.0", "X = 5.0, Y = -2.5, Z = 100.0")
    written: list[str] = []
    run = control_with({"RAPID": f"${axis}$", "LINEAR": f"&{axis}&\n${axis}$"}, tables=tables).start(
        written.append
    )
    run.call("RAPID", {axis: 77.0})
    run.call("LINEAR")
    run.call("RAPID")
    assert written == [f"{axis}77.000\n", f"{axis}{origin:.3f}\n"]


@pytest.mark.covers("post.init.value")
def test_an_initial_value_is_an_expression() -> None:
    assert blocks_of("<X=3>$X$", "&X*X*2+1&$X$") == ["X3.000", "X7.000"]
    assert blocks_of("<X=3>$X$", "&X*-X*2.5+0.125&$X$", "&X*X&$X$") == ["X3.000", "X-7.375", "X-7.375"]
    assert _error("&G91*5&").what.endswith("G91 is a code and has no value")


@pytest.mark.covers("post.init.key")
def test_all_kinds_of_keys_can_be_initialised() -> None:
    assert blocks_of("!M03!<S=5>$S$", "&M03&&S&&G28&!-M03!$S$") == ["M03S5", "M03S5"]
    assert _error("&V1&").what.endswith("there is no code or function variable V1")


@pytest.mark.covers("post.macro.tool_change", "post.concept.multi_path", "post.word.F")
def test_the_tool_change_macro_brings_the_feed_of_the_next_path() -> None:
    macros = {"TOOL_CHANGE": "&F&\n!M06!", "LINEAR": "!-G01!$X$$F$"}
    plain = {**macros, "TOOL_CHANGE": "!M06!"}
    programs = []
    for each in (macros, plain):
        written: list[str] = []
        run = control_with(each).start(written.append)
        for x in (1.0, 2.0, 11.0, 12.0):
            if x == 11.0:
                run.call("TOOL_CHANGE")
            run.call("LINEAR", {"X": x, "F": 500.0})
        programs.append("".join(written).split())
    assert programs[0] == ["G01X1.000F500", "X2.000", "M06", "X11.000F500", "X12.000"]
    assert programs[1] == ["G01X1.000F500", "X2.000", "M06", "X11.000", "X12.000"]


@pytest.mark.covers("post.word.reserved", "post.word.expand", "post.word.TOOLCHANGE")
def test_reserved_words_expand_to_texts_and_numbers() -> None:
    macro = "($PARTNAME$ $PATHNUMBER$ $DWELL$)$TOOLCHANGE$"
    assert blocks_of(macro, words={"PARTNAME": "A & B", "PATHNUMBER": 2, "DWELL": 0.25}) == [
        "(A & B 2 0.25)T00"
    ]
    words: dict[str, float | str] = {"PARTNAME": "  A  ", "PATHNUMBER": -2, "DWELL": -0.125}
    assert blocks_of(macro, words=words) == ["(  A   -2 -0.125)T00"]
    assert blocks_of("$TOOLCHANGE$", words={"T": 7}) == ["T07"]  # a system that gives no text
    assert blocks_of("$TOOLCHANGE$", words={"T": 7, "TOOLCHANGE": "T7"}) == ["T7"]
    assert blocks_of("$OUTPUTORDER$<OUTPUTORDER=1>") == ["0"]
    for dwell, text in ((1.234567, "1.234567"), (-0.000001, "-0.000001"), (98765.4, "98765.4")):
        assert blocks_of("$DWELL$", words={"DWELL": dwell}) == [text]


@pytest.mark.parametrize("word", ["V1", "H", "G90", "1X"])
def test_words_without_a_format_are_refused(word: str) -> None:
    assert _error(f"<V1=1>${word}$").position is not None


def test_reserved_words_cannot_be_used_for_something_else() -> None:
    assert _error("<COMMENT=5>").what.endswith("COMMENT is a text")
    assert _error('<COMMENT="A">').what.endswith("COMMENT does not take a text")
    assert _error('<V1="A">').what.endswith("V1 does not take a text")
    assert _error("<SIN=5>").position is not None
    assert _error("<G90=5>").what.endswith("G90 is a code and has no value")
    assert _error("<STARTOFLINE=5>").what.endswith("STARTOFLINE takes a text in double quotes")


@pytest.mark.covers("post.word.STARTOFLINE", "post.word.ENDOFLINE")
def test_line_texts_hold_in_the_macros_that_follow() -> None:
    assert blocks_of('<STARTOFLINE="{/}"><ENDOFLINE=" ;">', "!G00!", "!*G00!", "A") == ["{/}G00 ;", "{/}A ;"]


@pytest.mark.covers("post.block.sequence_number", "post.sec.parameter")
def test_sequence_numbers_step_and_begin_again() -> None:
    written_form = "N%04d:"
    blocks = blocks_of("A\nB\n\n!*G00!\nC", sequence_place=1, sequence_format=written_form)
    assert blocks == ["N0010:A", "N0020:B", "N0030:C"]
    tables = TABLES.replace(
        "sequence_start = 10\nsequence_step = 10", "sequence_start = 8\nsequence_step = 3"
    )
    control = control_with({"RAPID": "A\nB\nC\nD"}, tables=tables, sequence_place=1, sequence_highest=14)
    written: list[str] = []
    control.start(written.append).call("RAPID")
    assert "".join(written).split() == ["N8A", "N11B", "N14C", "N8D"]


@pytest.mark.covers("post.block.empty", "post.string.dquote")
def test_lines_of_blanks_and_of_empty_texts_are_no_blocks() -> None:
    assert blocks_of('\n  \n""\n&X&\n@1@\n\',5\'\n"  "', sequence_place=1) == ["N10  "]
    assert blocks_of(" <V1=2> \t&X&  @1@ <V2=V1>\t\n A <V1=3> \nB \t", sequence_place=1) == [
        "N10 A  ",
        "N20B \t",
    ]


@pytest.mark.covers("post.string.literal")
@pytest.mark.parametrize(
    ("macro", "block"),
    [
        ("ABC   ", "ABC   "),
        ("$F$   ", "F2   "),
        ("!G90! \t", "G90 \t"),
        ("  A  B <V1=1>  &F&  ", "  A  B     "),
        ('AB"   "', "AB   "),
        ("($COMMENT$)  @1@ ", "(C)   "),
    ],
)
def test_blanks_are_written_as_they_stand_wherever_something_is(macro: str, block: str) -> None:
    words: dict[str, float | str] = {"F": 2.0, "COMMENT": "C"}
    assert blocks_of(macro, words=words) == [block]
    assert blocks_of('<ENDOFLINE=";">' + macro, words=words) == [f"{block};"]
    assert blocks_of(f"$F$\n$F$   \n  !-G90!  $F$\n  !-G90!  $F$  \n{macro[:0]}", words=words) == [
        "F2",
        "  G90  ",
    ]


@pytest.mark.covers("post.order.sort", "post.word.OUTPUTORDER", "post.string.squote", "post.order.written")
def test_order_of_all_kinds_of_elements() -> None:
    macro = "<OUTPUTORDER=1>@1@'Z,99'$F$!M06!!G90!'A,-200'$X$!G00!'B, +31'($COMMENT$)"
    words: dict[str, float | str] = {"X": 1.0, "F": 2.0, "COMMENT": "C"}
    expected = ["AN10(C)G00G90X1.000BF2M06Z"]
    assert blocks_of(macro, words=words, sequence_place=2) == expected
    # The sequence number has its place among the others, and is the first of its own order.
    assert blocks_of("<OUTPUTORDER=1>@1@'P,-100''Q,-101''R,-99'", sequence_place=2) == ["QN10PR"]
    assert blocks_of(macro.replace("=1", "=2"), words=words, sequence_place=2) == [
        "N10ZF2M06G90AX1.000G00B(C)"
    ]


FORMATS = [
    ('format = "X%.3f"', {1.5: "X1.500", -0.0004: "X0.000", 0.0005001: "X0.001", 1e6: "X1000000.000"}),
    ('format = "X%+.2f"', {1.5: "X+1.50", -0.001: "X+0.00", -2.0: "X-2.00"}),
    ('format = "X%.3f", zeros = "point"', {10.0: "X10.", -0.0001: "X0.", 0.25: "X0.25", 100.0: "X100."}),
    ('format = "X%.3f", zeros = "trim"', {10.0: "X10", -0.0001: "X0", 0.25: "X0.25", 0.0: "X0"}),
    ('format = "X[%.1f]", zeros = "trim"', {10.0: "X[10]", -0.01: "X[0]", 0.25: "X[0.2]"}),
    ('format = "X%d", scale = 1000.0', {10.0: "X10000", -0.0001: "X0", 0.0006: "X1", -12.5: "X-12500"}),
    ('format = "X%05d"', {10.0: "X00010", -7.0: "X-0007"}),
    (
        'format = "X%g"',
        {500.0: "X500", 0.15: "X0.15", 1234567.0: "X1234570", 0.00001: "X0.00001", -0.0: "X0"},
    ),
    ('format = "{%6.1f}"', {10.0: "{  10.0}", -0.01: "{   0.0}"}),
]


@pytest.mark.covers("post.word.function_var", "post.sec.function_var")
@pytest.mark.parametrize(("entry", "numbers"), FORMATS)
@pytest.mark.parametrize("lead", ["", " "])
def test_formats(entry: str, numbers: dict[float, str], lead: str) -> None:
    tables = TABLES.replace('X = { format = "X%.3f" }', f"X = {{ {entry}, modal = false }}")
    control = control_with({"RAPID": "A$X$"}, tables=tables, separator=lead)
    written: list[str] = []
    run = control.start(written.append)
    for value, text in numbers.items():
        run.call("RAPID", {"X": value})
        assert written.pop() == f"A{lead}{text}\n"
        assert run.formatted("X", value) == text


@pytest.mark.covers("post.sec.function_var")
def test_omission_goes_by_what_is_written() -> None:
    written: list[str] = []
    run = control_with({"RAPID": "$X$"}).start(written.append)
    for x in (1.0, 1.0004, 0.9996, 1.0006, 1.0, -0.0001, 0.0001):
        run.call("RAPID", {"X": x})
    assert "".join(written).split() == ["X1.000", "X1.001", "X1.000", "X0.000"]


@pytest.mark.parametrize(
    ("macro", "numbered", "plain"),
    [
        ("!-G00!$X$$Y$", ["N10 G00 X0.000 Y0.000"], ["G00 X0.000 Y0.000"]),
        ("!*G00!\n!-G00!$X$", ["N10 X0.000"], ["X0.000"]),
        ("(A)!-G00!", ["N10 (A) G00"], ["(A) G00"]),
        ("!*G00!\n!-G00!(A)$X$", ["N10 (A) X0.000"], ["(A) X0.000"]),
        ("$COMMENT$$X$\n$COMMENT$$X$A", ["N10 X0.000", "N20 A"], ["X0.000", "A"]),
        ("<OUTPUTORDER=1>'/,-200'$X$!G00!", ["/ N10 G00 X0.000"], ["/ G00 X0.000"]),
        ("<OUTPUTORDER=1>A$COMMENT$'B,-101'!-G28!", ["B N10 A G28"], ["BA G28"]),
        ("<OUTPUTORDER=1>$X$!-G00!", ["N10 G00 X0.000"], ["G00 X0.000"]),
    ],
)
def test_a_separator_stands_before_words(macro: str, numbered: list[str], plain: list[str]) -> None:
    assert blocks_of(macro, separator=" ", sequence_place=1) == numbered
    assert blocks_of(macro, separator=" ") == plain
    assert blocks_of(macro) == [block.replace(" ", "") for block in plain]


@pytest.mark.parametrize(
    ("macro", "block"),
    [
        ("!G90!$X$$Y$!-G00!", "G90X0.000 Y0.000G00"),
        ("!-G00!!G00!!G90!", "G00G00 G90"),
        ("$COMMENT$$X$$Y$", "X0.000 Y0.000"),
        ("<OUTPUTORDER=1>$Y$!G00!", "G00 Y0.000"),
    ],
)
def test_single_codes_and_variables_go_without_a_separator(macro: str, block: str) -> None:
    tables = TABLES
    for key in ("G00", "X"):
        entry = f"\n{key} = {{ order"
        assert tables.count(entry) == 1
        tables = tables.replace(entry, f"\n{key} = {{ separator = false, order")
    written: list[str] = []
    control_with({"RAPID": macro}, tables=tables, separator=" ").start(written.append).call("RAPID")
    assert written == [f"{block}\n"]


def test_only_what_has_a_separator_goes_without_one() -> None:
    tables = TABLES.replace("[g_code]", "[nc_code.TOOLCHANGE]\nseparator = false\n\n[g_code]", 1)
    with pytest.raises(ConfigurationError, match="there is no separator before 'TOOLCHANGE'"):
        control_with({"RAPID": "!G00!"}, tables=tables, separator=" ")


@pytest.mark.covers(
    "post.op.div",
    "post.fn.SQRT",
    "post.fn.LOG",
    "post.fn.LOG10",
    "post.fn.ASIN",
    "post.fn.ACOS",
    "post.expr.assign",
    "post.fn.EXP",
)
@pytest.mark.parametrize(
    ("expression", "what"),
    [
        ("1/V1", "division by zero"),
        ("SQRT(0-1)", "a function has no value there"),
        ("LOG(0)", "a function has no value there"),
        ("LOG10(V1)", "a function has no value there"),
        ("ASIN(1.1)", "a function has no value there"),
        ("ACOS(2)", "a function has no value there"),
        ("EXP(1000)", "the number is not finite"),
        ("1" + "0" * 200 + "*1" + "0" * 200, "the number is not finite"),
    ],
)
def test_expressions_without_a_value(expression: str, what: str) -> None:
    with pytest.raises(ProgramError) as error:
        blocks_of(f"A\n  \nIF(1==1)\n <V2={expression}>\nENDIF")
    assert error.value.what.startswith(f"[nc_macros] PATH_START, line 4: {what}")
    position = error.value.position
    assert position is not None
    assert position.text == f" <V2={expression}>"
    assert position.column == 6
    assert str(error.value).splitlines()[2].endswith("^")
    with pytest.raises(ProgramError, match="PATH_START, line 1"):
        blocks_of(f"&X*{expression}&$X$")


@pytest.mark.covers("post.op.div")
def test_conditions_without_a_value() -> None:
    with pytest.raises(ProgramError, match="LINEAR, line 3: division by zero") as error:
        blocks_of("", "", "IF(V1==1)\nA\nELSE IF(1==1 && 2/V1==1)\nENDIF")
    assert error.value.position is not None
    assert error.value.position.column == 9


def test_numbers_must_be_finite() -> None:
    for value in (math.inf, math.nan):
        with pytest.raises(ProgramError, match="not finite"):
            blocks_of("A$X$", words={"X": value})


def test_calls_that_cannot_be_meant() -> None:
    control = control_with({"COMMENT": "($COMMENT$)", "RAPID": "$X$"})
    run = control.start(lambda block: None)
    with pytest.raises(UsageError, match="there is no macro 'RAPIT'"):
        run.call("RAPIT")
    with pytest.raises(UsageError, match="more than one line"):
        run.call("COMMENT", {"COMMENT": "A\nM30"})
    with pytest.raises(UsageError, match="the word COMMENT is a text"):
        run.call("COMMENT", {"COMMENT": 5.0})
    with pytest.raises(UsageError, match="the word X is a number"):
        run.call("RAPID", {"X": "5"})
    with pytest.raises(UsageError, match="'x' is not a word"):
        control.start(lambda block: None).call("RAPID", {"x": 5.0})
    with pytest.raises(UsageError, match="no function variable"):
        run.formatted("Q", 1.0)


def test_absent_macros_write_nothing_but_set_their_words() -> None:
    written: list[str] = []
    control = control_with({"LINEAR": "$X$"})
    assert (control.has("LINEAR"), control.has("RAPID")) == (True, False)
    run = control.start(written.append)
    run.call("RAPID", {"X": 4.0, "UNHEARD": 1.0})
    assert written == []
    run.call("LINEAR")
    assert written == ["X4.000\n"]


def test_errors_of_the_writer_stay_what_they_are() -> None:
    def fail(block: str) -> None:
        raise ValueError(f"disk full at {block!r}")

    with pytest.raises(ValueError, match="disk full at 'A"):
        control_with({"RAPID": "A"}).start(fail).call("RAPID")


def test_every_run_begins_anew() -> None:
    control: ControlFile = control_with({"RAPID": "!-G00!$X$<V1=V1+1><X=V1>"}, sequence_place=1)
    for _ in range(2):
        written: list[str] = []
        run = control.start(written.append)
        run.call("RAPID")
        run.call("RAPID")
        assert written == ["N10G00X0.000\n", "N20X1.000\n"]


@pytest.mark.parametrize(
    "macro",
    [
        "<V1=" + "(" * 51 + "1" + ")" * 51 + ">",
        "<V1=1" + "+1" * 20_000 + ">",
        "IF(1==1)\n" + "ELSE IF(1==2)\n" * 5000 + "ENDIF",
        "<V1=" + "9" * 400 + ">",
    ],
)
def test_monsters_are_refused_not_crashed_on(macro: str) -> None:
    assert _error(macro).position is not None


def test_python_in_macros_stays_text() -> None:
    for text in ("{values}", "{0}{{}}\\n", "%s%d", "__import__('os')", "f{1/0}", "\\"):
        assert blocks_of(f'"{text}"$X$') == [f"{text}X0.000"]
        tables = TABLES.replace("G90 = { order = 20 }", f"G90 = {{ code = {json.dumps(text)} }}")
        written: list[str] = []
        control_with({"RAPID": "!-G90!!G90!"}, tables=tables, separator="{}").start(written.append).call(
            "RAPID"
        )
        assert written == [f"{text}{{}}{text}\n"]
