"""CPL: blocks, jumps, loops, branches, sub-programs, WAIT (Manual 003, chapters 2 to 4)."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.nc import load_dialect
from polycnc.nc.cpl import (
    BLOCKED,
    OMITTED,
    PAUSE,
    BlockWord,
    CodeCalls,
    Lines,
    Linker,
    NcValues,
    Run,
    Step,
    Waiting,
    compile_program,
    holds_cpl,
)
from support.cpl_host import Ran, RecordingHost


def errors(text: str, programs: dict[str, str] | None = None) -> list[str]:
    """Return what the link step says, without excerpts."""
    found = Linker(RecordingHost(programs=programs).program).link(text, "main.cpl")[1]
    return [
        f"{error.position.line}:{error.position.column} {error.what}" for error in found if error.position
    ]


def at_run_time(text: str, host: RecordingHost | None = None) -> ProgramError:
    with pytest.raises(ProgramError) as caught:
        Ran(text, host)
    return caught.value


# Blocks


def test_a_number_of_many_digits_is_gone_through_once() -> None:
    """It is followed by what makes it none: every part of it was tried once, and every part of that."""
    assert errors(f"10 #A=1\nN20 G1 Y[#A] X{'9' * 20_000}]") == ["2:14 the number of 'X' is too large"]


@pytest.mark.covers("cpl.ncblock", "cpl.ex.353", "cpl.program")
def test_nc_blocks_and_cpl_blocks_mix() -> None:
    ran = Ran("N100 G1 X150 Y100.525\nG1 X150 Y100.525\n10 #A=2.5\nN20 X[#A]\nM30")
    assert ran.events == [
        Lines(1, 2),
        NcValues(4, 20, 0, (BlockWord("X", None, 2.5, 5),), ""),
        Lines(5, 5),
    ]
    assert Ran("N10 G1 X5\nM30").events == [Lines(1, 2)]
    assert Ran("10 #A=1\n20 #B=2").events == []


def test_a_program_of_plain_blocks_needs_no_cpl() -> None:
    assert not holds_cpl(b"%\nN10 G1 X10 (remark) Y.5\nG4 F2\n M30\n")
    for line in (b"10 X=1", b"N10 X[A]", b"  20 WAIT", b"N20 WAIT", b"N30 P SP", b"N10 (DIN)"):
        assert holds_cpl(b"N1 G1\r\n" + line + b"\r\n"), line


@pytest.mark.covers("cpl.AXP", "cpl.COS")
@pytest.mark.covers("cpl.bracket", "cpl.ex.361")
def test_brackets_hold_expressions_of_nc_words() -> None:
    host = RecordingHost(
        programs={
            "SP": "5 XVALUE=P1 : FEED=P2 : COMPTAB=P3 : M3=3\n"
            "N10 G1 X[XVALUE]F[ FEED*2+1000]M[M3]\nN20 G22 K[COMPTAB]\nM30"
        }
    )
    ran = Ran("1 CALL SP [10,500,4]", host)
    assert ran.blocks == ["G1 X10 F2000 M3", "G22 K4", "M30"]
    assert Ran("1 R=12.5 : W%=60\nN5 G1 X[R*COS(W%)] (no [remark]) Y2=[R] Z1=3.5").blocks == [
        "G1 X6.25 Y2=12.5 Z1=3.5"
    ]
    text = RecordingHost({"AXP": lambda axis, value: ("XYZ"[axis - 1], None, value)})
    assert Ran('1 DIM A$(4) : A$="G91" : A%=2\nN80 [A$] [AXP(A%,2.5)] [AXP(1,0)]', text).blocks == [
        "G91 Y2.5 X0"
    ]
    assert errors("N[5] X[5]")[0].startswith("1:1 ")
    assert errors("N10 P[5]") == ["1:5 the address P takes no expression"]
    assert errors('N10 X["A"]') == ["1:5 the address X takes a number, not a string"]
    assert errors("N10 X[A") == ["1:8 ']' is missing before the end"]
    assert errors("N10 X[2] %") == ["1:10 '%' belongs at the beginning of a block"]
    assert at_run_time("1 A=1\nN10 X[B]").position.line == 2  # type: ignore[union-attr]


def test_values_in_brackets_are_frozen_when_the_block_is_prepared() -> None:
    host = RecordingHost()
    linker = Linker(host.program)
    main, _ = linker.link("1 POS=10\nN5 X[POS]\n2 POS=20\nN6 X[POS]", "main.cpl")
    assert main is not None
    run = Run(main, linker, host)
    first = run.step()
    assert run.step() == NcValues(4, 6, 0, (BlockWord("X", None, 20.0, 4),), "")
    assert first == NcValues(2, 5, 0, (BlockWord("X", None, 10.0, 4),), "")


def test_a_block_with_a_message_and_a_skip_level() -> None:
    assert Ran("1 A=3\n/2 N5 X[A] (MSG,at [A])").events == [
        NcValues(2, 5, 2, (BlockWord("X", None, 3.0, 7),), "at [A]")
    ]


@pytest.mark.covers("cpl.cplblock", "cpl.op.colon", "cpl.linefeed", "cpl.ex.379", "cpl.REM", "cpl.ex.1055")
def test_a_colon_goes_on_with_a_block_and_rem_ends_it() -> None:
    host = RecordingHost({"MPOS": lambda axis: axis * 2.5})
    text = (
        "20 X%=3\n30 IF X%=3 THEN GOTO 50 ENDIF:\nREM JUMP DESTINATION1\n35 #WRONG=1\n"
        "40 IF X%=4 THEN GOTO 200 ENDIF : REM JUMP : #WRONG=1 \" ' ?\n50 WAIT\n"
        "60 XPOS=MPOS(1) : YPOS=MPOS(2) : ZPOS=MPOS(3)\nN100 G90\nN110 G1 X[XPOS] Y[YPOS] Z[ZPOS]\n"
        "115 REM Travel at G1\nN120 G0 X0 Y0 Z0\n200 REM *** SP TO DEMASK THE STATUS WORD ***"
    )
    ran = Ran(text, host)
    assert ran.events[0] == Waiting(6, None, None)
    assert ran.blocks == ["N100 G90", "G1 X2.5 Y5 Z7.5", "N120 G0 X0 Y0 Z0"]
    assert ran["#WRONG"] is None
    assert Ran("10 #A=1 :\n#B=2 :\n\n#C=3\nN5 X1").run.globals == {"#A": 1.0, "#B": 2.0, "#C": 3.0}
    assert Ran("10 #A=1\r\n20 #B=2\r\nN5 X1").blocks == ["N5 X1"]
    assert errors("10 #A=1 :\nN20 X5") == ["2:5 = MISSING"]
    assert errors("10 #A=1 :\n?") == ["2:1 '?' has no meaning here"]


@pytest.mark.covers("cpl.remark.nc", "cpl.nc.MSG_text")
@pytest.mark.parametrize("remark", ["", "(a)", "(to hole) (b)"])
@pytest.mark.parametrize("gap", ["", " ", "\t"])
def test_no_word_beside_a_message_is_lost(gap: str, remark: str) -> None:
    message = "(MSG, GO, [A] on)"
    words = ["G1", "F1000", "X[A*10]", "Y2=[A]", "Z-3.5", "M[A+1]"]
    for place in range(len(words) + 1):
        line = gap.join([*words[:place], message, *words[place:], remark])
        (block,) = Ran(f"1 A=3\nN5 {line}").events
        assert isinstance(block, NcValues)
        assert block.message == "GO, [A] on"
        assert [(each.address, each.extension, each.value) for each in block.words] == [
            ("G", None, 1), ("F", None, 1000), ("X", None, 30), ("Y", 2, 3), ("Z", None, -3.5), ("M", None, 4),
        ]  # fmt: skip


def test_calls_keep_their_messages_and_their_skip_marks() -> None:
    host = RecordingHost(programs={"SP": "1 #A=P1", "999": "1 #B%=P1%"})
    for line in ("N5 P SP[2.5] (MSG,GO) (on)", "P SP [2.5](a)(MSG,GO)"):
        ran = Ran(line, host)
        assert ran.events == [NcValues(1, None, 0, (), "GO")]
        assert ran["#A"] == 2.5
    assert Ran("/ WAIT\n1 A=1", host).events == [Waiting(1, None, None, 1)]
    assert Ran("P999 [4]", host).run.globals["#B%"] == 4
    assert Ran("1 A=2\nG1 X[A]").blocks == ["G1 X2"]


def test_what_brackets_do_not_take_is_refused_where_it_stands() -> None:
    assert errors("N10 G1 X-[2]") == ["1:9 a sign belongs inside the brackets"]
    assert errors("N10 X[2]5") == ["1:9 '5' begins no word"]
    assert errors("N10 X[2] .5") == ["1:10 '.' begins no word"]
    assert errors("N10 X[2] Y") == ["1:10 'Y' has no number"]
    assert errors("N10 X[2] (\xe4) \xe4") == ["1:14 'byte 0xC3' is not allowed in a block"]
    assert errors("N10 (\xe4) X[2] AB=3") == ["1:14 'A' begins no word"]
    assert errors("N10 (\xe4) X[2] ]") == ["1:14 ']' begins no word"]


LOST = [
    "B%=2", "#B$=A$", "@7=1", "DIM A$(3)", "GOTO 10", "IF B%=2 THEN", "ENDIF", "FOR I%=1 TO 3", "NEXT", "CALL SP",
    "AB=2", "OPENW(1)", "CLS", "REM x", "A$(1)=A$", '"A"',
]  # fmt: skip


@pytest.mark.covers("cpl.cplblock")
@pytest.mark.parametrize("head", ["", "  ", "N20 "])
@pytest.mark.parametrize("statement", LOST)
def test_a_block_that_has_lost_its_number_is_refused_where_it_stands(statement: str, head: str) -> None:
    linker = Linker(RecordingHost().program, codes=CodeCalls(rules=load_dialect("bosch").text))
    _, found = linker.link(f"10 A%=1\nN15 X5 (A=B) Y1=3\n{head}{statement}\n30 A%=3", "main.cpl")
    (error,) = found
    assert error.position is not None
    assert (error.position.line, error.position.column) == (3, len(head) + 1)
    assert error.what.endswith("is no NC block, and has no number")


def test_remarks_of_nc_blocks_stay_with_the_control() -> None:
    assert Ran("N10 (MSG,Position [x] reached)\n(remark)\n1 A=1").events == [Lines(1, 2)]


# Jumps


@pytest.mark.covers("cpl.GOTO", "cpl.label", "cpl.ex.992")
def test_jumps_reach_blocks_lines_and_labels() -> None:
    text = (
        "10 GOTO N20\n11 #WRONG=1\nN020 X100\n30 GOTO 120\n31 #WRONG=2\n0120 GOTO .TARG1\n"
        "121 #WRONG=3\n150 .TARG1 : #A=7"
    )
    ran = Ran(text)
    assert (ran.blocks, ran["#A"], ran["#WRONG"]) == (["N020 X100"], 7.0, None)
    assert errors("10 GOTO .NONE\n20 GOTO 7\n30 GOTO N7") == [
        "1:9 there is no jump destination .NONE",
        "2:9 there is no jump destination 7",
        "3:9 there is no jump destination N7",
    ]
    assert errors("10 GOTO .A\n20 .A\n30 .A") == ["1:9 2 jump destinations are called .A"]
    assert errors("10 GOTO X%") == ["1:9 'X%' is no jump destination"]
    assert errors("10 .A\n20 .A\n10 #B=1") == []


@pytest.mark.covers("cpl.ex.1024")
def test_a_loop_of_jumps() -> None:
    text = (
        "10 #X=1\n20 .START\n30 IF #X>=100 THEN\n40 GOTO .END\n50 ELSE #X=#X+2.75 : #N%=#N%+1\n"
        "60 GOTO .START\n70 ENDIF\n90 .END"
    )
    ran = Ran("5 #N%=0\n" + text)
    assert (ran["#X"], ran["#N%"]) == (100.0, 36)


def test_jumps_out_of_loops_and_into_structures() -> None:
    text = (
        "10 #N%=0\n20 FOR I%=1 TO 5\n30 FOR K%=1 TO 5\n40 #N%=#N%+1\n50 IF I%*K%=6 THEN GOTO .OUT ENDIF\n"
        "60 NEXT\n70 NEXT\n"
        "80 #N%=-1\n90 .OUT : #I%=I% : #K%=K%"
    )
    assert Ran(text).run.globals == {"#N%": 8, "#I%": 2, "#K%": 3}
    into = (
        "10 #N%=0 : I%=3\n20 GOTO .IN\n30 WHILE I%<5 DO\n35 #N%=#N%+10\n40 .IN : #N%=#N%+1 : I%=I%+1\n50 END\n"
        "60 IF #N%<100 THEN\n70 #N%=#N%+100 : GOTO .ELSE\n80 ELSE\n90 #N%=-1\n95 .ELSE : #N%=#N%+1000\n100 ENDIF"
    )
    assert Ran(into)["#N%"] == 1 + 11 + 100 + 1000
    case = (
        "10 A%=2\n20 CASE A% OF\n30 LABEL 1 : #N%=1\n35 .TWO : #N%=#N%+5\n"
        "40 LABEL 2 : #N%=2 : A%=3 : GOTO .TWO\n50 OTHERWISE #N%=9\n60 ENDCASE"
    )
    assert Ran(case)["#N%"] == 7
    repeat = "10 #N%=0\n20 REPEAT\n30 #N%=#N%+1\n40 IF #N%=3 THEN GOTO .END ENDIF\n50 UNTIL #N%=9\n60 .END"
    assert Ran(repeat)["#N%"] == 3


def test_a_hundred_jump_destinations_are_reached_in_any_order() -> None:
    order = [(7 * index) % 100 for index in range(100)]
    lines = [f"10 #N%=0 : GOTO {1000 + order[0]}"]
    nexts: dict[int, int] = dict(itertools.pairwise(order))
    for index in range(100):
        goto = f"GOTO {1000 + nexts[index]}" if index in nexts else "GOTO .END"
        lines.append(f"{1000 + index} #N%=#N%*3+{index} : #N%=#N%-INT(#N%/9973)*9973 : {goto}")
    expected = 0
    for index in order:
        expected = (expected * 3 + index) % 9973
    assert Ran("\n".join([*lines, "5 .END"]))["#N%"] == expected


def test_deep_structures_run_although_python_has_no_room_for_them() -> None:
    for opening, closing in (
        ("WHILE #N%<1 DO", "END"),
        ("IF #N%<1 THEN", "ENDIF"),
        ("FOR I{}%=1 TO 1", "NEXT"),
    ):
        heads = [f"{level} {opening.format(level)}" for level in range(1, 91)]
        tails = [f"{level} {closing}" for level in range(101, 191)]
        assert Ran("\n".join(["1 #N%=0", *heads, "95 #N%=#N%+1", *tails]))["#N%"] == 1, opening
    deep = "\n".join(f"{level} IF TRUE THEN" for level in range(1, 5001))
    assert errors(deep)[0].endswith("NESTING TOO DEEP")


# Loops and branches


@pytest.mark.covers("cpl.FOR", "cpl.ex.930", "cpl.kw.NEXT", "cpl.kw.STEP", "cpl.kw.TO")
def test_for_counts_and_leaves_its_variable_behind_the_end() -> None:
    ran = Ran("5 DIM #X(18)\n10 FOR #I%=0 TO 18\n20 #X(#I%)=SIN(#I%*10)\n30 NEXT #I%")
    assert ran["#I%"] == 19
    assert ran["#X"][9] == 1.0  # type: ignore[index]
    assert ran["#X"][18] == 0.0  # type: ignore[index]
    assert Ran("10 #N%=0\n20 FOR #I%=5 TO 4\n30 #N%=1\n40 NEXT").run.globals == {"#N%": 0, "#I%": 5}
    assert Ran("10 #N%=0\n20 FOR #I%=9 STEP -4 TO 0\n30 #N%=#N%*10+#I%\n40 NEXT").run.globals == {
        "#N%": 951,
        "#I%": -3,
    }
    assert Ran("10 #N=0\n20 FOR #R=0.5 STEP 0.25 TO 1.25\n30 #N=#N+#R\n40 NEXT").run.globals == {
        "#N": 3.5,
        "#R": 1.5,
    }
    assert Ran("10 #N%=0 : E%=3\n20 FOR I%=1 TO E%\n30 #N%=#N%+1 : E%=5\n40 NEXT")["#N%"] == 5
    assert errors("10 FOR I%=1 TO 3 STEP 2\n20 NEXT")[0].startswith("1:18 ")
    assert errors("10 FOR I%=1 TO 3\n20 NEXT K%") == ["2:9 this NEXT ends the FOR of I%"]
    assert errors("10 FOR I%=1 TO 3") == ["1:4 the FOR has no NEXT"]
    assert errors("10 NEXT") == ["1:4 NEXT without its FOR"]
    assert at_run_time("10 FOR I%=1 STEP 0.5 TO 3\n20 NEXT").what == "INVALID ASSIGNMENT"


@pytest.mark.covers("cpl.ex.940")
def test_the_step_of_for_is_read_again_in_every_pass() -> None:
    printed: list[str] = []
    host = RecordingHost(
        {
            "PRN#": lambda number, *items: printed.append(
                f"{number}" + "".join(f"{item.value}" for item in items)
            ),
            "OPENW": lambda *arguments: None,
            "CLOSE": lambda number: None,
            "NJUST": lambda: None,
        }
    )
    text = (
        '10 OPENW(1,"P222",130)\n20 STEP%=2 : START%=1 : END%=3500 : NJUST\n'
        "30 FOR COUNTER%=START% STEP STEP% TO END%\n40 STEP%=ROUND(STEP%*SQRT(STEP%))\n"
        '50 PRN#(1,"COUNTER: ",COUNTER%," STEP SIZE: ",STEP%)\n60 NEXT\n70 CLOSE(1)'
    )
    Ran(text, host)
    counters, steps = (1, 4, 9, 20, 56, 272, 3447), (3, 5, 11, 36, 216, 3175, 178902)
    assert printed == [
        f"1COUNTER: {counter} STEP SIZE: {step}" for counter, step in zip(counters, steps, strict=True)
    ]


@pytest.mark.covers("cpl.REPEAT", "cpl.ex.968", "cpl.kw.UNTIL")
def test_repeat_tests_behind() -> None:
    assert Ran("20 #X=97.0\n30 REPEAT\n40 #X=#X+1\n50 UNTIL #X=100")["#X"] == 100.0
    assert Ran("20 #X=200\n30 REPEAT #X=#X+1 UNTIL #X>100")["#X"] == 201.0
    assert errors("30 REPEAT\n40 X=1") == ["1:4 the REPEAT has no UNTIL"]


@pytest.mark.covers("cpl.WHILE", "cpl.ex.982", "cpl.kw.DO", "cpl.kw.END")
def test_while_tests_before() -> None:
    states = iter((0, 0, 0, 1))
    host = RecordingHost({"SD": lambda group: next(states)})
    assert Ran("20 #I=0\n30 WHILE SD(9)=0\n40 #I=#I+1\n50 END", host)["#I"] == 3.0
    assert Ran("20 #I=0\n30 WHILE #I<0 DO #I=#I+1 END")["#I"] == 0.0
    assert errors("30 WHILE TRUE THEN\n40 END") == ["1:15 'DO' is missing before 'THEN'"]


@pytest.mark.covers("cpl.IF", "cpl.kw.THEN", "cpl.kw.ELSE", "cpl.kw.ENDIF")
def test_if_has_one_of_two_ways() -> None:
    for number, expected in ((1, 1.0), (5, 2.0), (9, 3.0)):
        text = f"10 N%={number}\n20 IF N%<3 THEN #A=1\n30 ELSE IF N%<7 THEN\n40 #A=2\n50 ELSE #A=3 ENDIF\n60 ENDIF"
        assert Ran(text)["#A"] == expected
    assert Ran("10 IF 2>3 THEN ELSE #A=1 ENDIF")["#A"] == 1.0
    assert Ran("10 IF 2>3 THEN\nN10 X1\n20 ELSE\nN20 X2\n30 ENDIF").blocks == ["N20 X2"]
    assert errors("10 IF TRUE\n20 THEN #A=1 ENDIF")[0] == "1:11 'THEN' is missing before the end"
    assert errors("10 IF TRUE THEN #A=1") == ["1:4 the IF has no ENDIF"]
    assert errors("10 ELSE") == ["1:4 ELSE without its IF"]
    assert errors("10 IF TRUE THEN ELSE ELSE ENDIF") == ["1:22 a second ELSE"]
    assert errors("10 WHILE TRUE DO\n20 ENDIF") == [
        "2:4 ENDIF without its IF; open is WHILE",
    ]


@pytest.mark.covers(
    "cpl.CASE", "cpl.ex.1044", "cpl.kw.OF", "cpl.kw.LABEL", "cpl.kw.OTHERWISE", "cpl.kw.ENDCASE",
)  # fmt: skip
@pytest.mark.parametrize(
    ("number", "y", "z"), [(0, 1.0, 5.0), (2, 9.0, 5.0), (4, 81.0, 9.0), (9, 0.0, 5.0), (-4, 0.0, 5.0)]
)
def test_case_takes_the_first_fitting_label_and_no_other(number: int, y: float, z: float) -> None:
    text = (
        f"5 A%={number} : #Y=3 : #Z=5\n10 CASE A% OF\n20 LABEL 0 : #Y=1\n"
        f"30 LABEL 2\n40 #Y=#Y*#Y\n50 LABEL 4 : #Z=#Y*#Y\n"
        "60 #Y=#Z*#Z\n70 OTHERWISE #Y=0\n80 ENDCASE"
    )
    assert Ran(text).run.globals == {"#Y": y, "#Z": z}


@pytest.mark.covers("cpl.ex.1044b")
@pytest.mark.parametrize(("number", "mark"), [(1, 1), (3, 1), (4, 2), (6, 2), (7, 3)])
def test_case_of_a_field_jumps(number: int, mark: int) -> None:
    text = (
        f"5 DIM INTFIELD%(1,2) : INTFIELD%(1,2)={number}\n10 CASE INTFIELD%(1,2) OF\n20 LABEL 1,2,3 : GOTO .MARK1\n"
        "30 LABEL 4,5,6 : GOTO .MARK2\n40 OTHERWISE GOTO .END\n50 ENDCASE\n60 .MARK1 : #N%=1 : GOTO .OUT\n"
        "70 .MARK2 : #N%=2 : GOTO .OUT\n80 .END : #N%=3\n90 .OUT"
    )
    assert Ran(text)["#N%"] == mark


@pytest.mark.covers("cpl.ex.1045")
@pytest.mark.parametrize(
    ("c", "x", "y"), [(-1, 1, 2), (0, 1, 2), (2, 2, 4), (6, 2, 4), (-2, 0, 1), (5, 0, 0)]
)
def test_case_of_an_expression(c: int, x: int, y: int) -> None:
    text = (
        f"5 X=9 : Y=4 : C%={c}\n10 CASE (INT(X/Y)+C%) OF\n20 LABEL 1,2 : #X=1 : #Y=2\n30 LABEL 4,8\n40 #X=2 : #Y=4\n"
        "50 LABEL 0\n60 #X=0 : #Y=1\n70 OTHERWISE #X=0 : #Y=0\n80 ENDCASE"
    )
    assert Ran(text).run.globals == {"#X": x, "#Y": y}


def test_what_is_no_case_is_refused() -> None:
    assert errors("10 CASE 1 OF\n20 #A=1\n30 LABEL 1\n40 ENDCASE") == [
        "2:4 an instruction between CASE and its first LABEL"
    ]
    assert errors("10 CASE 1 OF\n20 OTHERWISE\n30 LABEL 1\n40 ENDCASE") == ["3:4 LABEL after OTHERWISE"]
    assert errors("10 CASE 1 OF\n20 LABEL X%\n40 ENDCASE") == [
        "2:10 an INTEGER constant is missing before 'X%'"
    ]
    nested = [f"{level} CASE 1 OF\n{level} LABEL 1" for level in range(1, 12)]
    assert errors("\n".join(nested))[0] == "21:4 NESTING TOO DEEP"
    ten = "\n".join([*nested[:10], "50 #A=7", *("60 ENDCASE" for _ in range(10))])
    assert Ran(ten)["#A"] == 7.0
    assert at_run_time("10 CASE A% OF\n20 LABEL 1\n30 ENDCASE").what.startswith("INVALID VARIABLE")


@pytest.mark.covers("cpl.loop.endless")
def test_an_endless_loop_lets_time_pass_and_never_ends() -> None:
    for text in (
        "10 GOTO 10",
        "10 WHILE TRUE DO\n20 END",
        "10 REPEAT\n20 UNTIL FALSE",
        "10 FOR I%=1 STEP 0 TO 2\n20 NEXT",
    ):
        host = RecordingHost()
        linker = Linker(host.program)
        main, _ = linker.link(text, "main.cpl")
        assert main is not None
        run = Run(main, linker, host)
        assert [run.step() for _ in range(3)] == [PAUSE, PAUSE, PAUSE]
        run.stop()
        assert run.step() is None


# Sub-programs


@pytest.mark.covers("cpl.CALL", "cpl.ex.1089", "cpl.ex.1132", "cpl.param.Pn")
def test_a_sub_program_gets_its_parameters_by_value() -> None:
    sub = (
        "1 FACTOR=P1 : XVALUE%=P2% : COMPTAB%=P3%\nN1 G1 X[XVALUE%*FACTOR]\n"
        "N2 G22 K[COMPTAB%]\n3 P2%=99 : #P=P1TEST*P02XYZ"
    )
    host = RecordingHost(programs={"P999": sub})
    ran = Ran("10 X%=4 : A%=1\n50 IF A% = 1 THEN\n51 CALL P999 [2.75, X%, 0]\n52 ENDIF\n60 #X%=X%\nM30", host)
    assert ran.blocks == ["G1 X11", "G22 K0", "M30"]
    assert (ran["#X%"], ran["#P"]) == (4, 11.0)
    host.programs["P999"] = "1 #A%=P1% : #B=P4 : #C$=P2$ : #D?=P3?"
    values = Ran('10 CALL P999 [7.0,"AB"+"C",2>1]', host).run.globals
    assert values == {"#A%": 7, "#B": None, "#C$": "ABC", "#D?": True}
    assert at_run_time("10 CALL P999 [7.5]", host).what == "INVALID ASSIGNMENT"


def test_sub_programs_are_called_from_nc_blocks() -> None:
    host = RecordingHost(programs={"SP": "1 #A=#A+P1", "G81": "1 #A=#A*P1"})
    ran = Ran("1 #A=2\nN10 P SP[3.5]\nN20 G81[10] (remark)\nN30 X[#A]\nN40 G81", host)
    assert ran.blocks == ["X55", "N40 G81"]
    assert errors("N10 P SP X5", host.programs) == ["1:10 a sub-program call needs a block of its own"]
    assert errors("N10 P NONE[5]", host.programs) == ["1:5 there is no sub-program NONE"]


@pytest.mark.covers("cpl.structure.nesting")
def test_sub_programs_are_nested_seven_deep() -> None:
    programs = {f"S{depth}": f"1 #N%={depth}\n2 CALL S{depth + 1}" for depth in range(1, 8)}
    host = RecordingHost(programs={**programs, "S7": "1 #N%=7"})
    assert Ran("10 CALL S1\n20 #M%=#N%", host)["#M%"] == 7
    deeper = {**programs, "S8": "1 #N%=8"}
    assert errors("10 CALL S1", deeper) == ["2:3 sub-programs are nested more than 7 deep"]
    error = at_run_time("N1 (DIN)\nN2 P S1", RecordingHost(programs=deeper))
    assert error.what == "sub-programs are nested more than 7 deep"


@pytest.mark.covers("cpl.sub")
def test_a_program_does_not_call_itself() -> None:
    programs = {"A": "1 CALL B", "B": "1 CALL A"}
    assert errors("10 CALL A", programs) == ["1:3 A calls itself"]
    unlinked = RecordingHost(programs={"A": "1 B=1\n2 CALL A"})
    assert at_run_time("(DIN)\nN1 P A", unlinked).what == "A calls itself"


def test_calls_stand_alone_in_their_blocks() -> None:
    programs = {"P9": "1 #A=1"}
    for text in ("10 #A=1 : CALL P9", "10 CALL P9 : #A=1", "10 IF TRUE THEN CALL P9 ENDIF"):
        assert errors(text, programs)[0].endswith("CALL needs a block of its own"), text
    assert errors("10 CALL P9 [1,,2]", programs) == ["1:11 an argument of a sub-program is missing"]
    assert errors("10 CALL") == ["1:8 the name of a program is missing before the end"]
    assert errors("10 CALL NONE") == ["1:4 there is no sub-program NONE"]


def test_linking_checks_sub_programs_and_finds_everything_at_once() -> None:
    programs = {"GOOD": "1 #A=1", "BAD": "1 #A=\n2 GOTO .NONE"}
    linker = Linker(RecordingHost(programs=programs).program)
    main, found = linker.link("10 CALL GOOD\n20 CALL BAD\n30 CALL NONE\n40 CALL BAD", "main.cpl")
    assert main is None
    assert [str(error).split("\n")[0] for error in found] == [
        "BAD:1:6: a value is missing before the end",
        "BAD:2:8: there is no jump destination .NONE",
        "main.cpl:3:4: there is no sub-program NONE",
    ] or [error.position.file for error in found if error.position] == [
        "BAD",
        "BAD",
        "main.cpl",
        "BAD",
        "BAD",
    ]


@pytest.mark.covers("cpl.option.DIN", "cpl.ex.1106", "cpl.ex.1115", "cpl.err.RUNTIME_CPL_IN_DIN")
def test_din_takes_a_sub_program_out_of_linking() -> None:
    broken = {"P999": "1 A=\nN10 X1"}
    assert errors("51 CALL P999 DIN", broken) == []
    assert errors("51 CALL P999", {"P999": "N10 (DIN)\n1 A="}) == []
    assert errors("51 CALL P999", broken) == ["1:5 a value is missing before the end"]
    assert Ran("51 CALL P999 DIN\nM30", RecordingHost(programs={"P999": "N10 X1\nN20 Y2"})).blocks == [
        "N10 X1",
        "N20 Y2",
        "M30",
    ]
    for text, sub in (("51 CALL P999 DIN", "N10 X1\n20 A=1"), ("51 CALL P999", "N10 (DIN)\n20 A=1")):
        error = at_run_time(f"50 #B=1\n{text}", RecordingHost(programs={"P999": sub}))
        assert error.what == "CPL elements in a sub-program excluded from linking"
        assert error.position is not None
        assert error.position.line == 2


@pytest.mark.covers("cpl.LEN")
@pytest.mark.covers("cpl.PDIM", "cpl.ex.1161", "cpl.err.INVALID_VARIABLE")
def test_pdim_makes_room_for_a_text_of_an_unlinked_program() -> None:
    def run(sub: str, first: str = "N10 (DIN)") -> Ran:
        return Ran(f'{first}\nN50 P SP["TEST"]\nM30', RecordingHost(programs={"SP": sub}))

    assert run("10 PDIM P1$(4)\n20 @1=LEN(P1$) : #A$=P1$").host.permanent["@1"] == 4
    assert run('10 PDIM P1$(9)\n20 #E?=P1$="TEST"')["#E?"] is True
    assert run("20 @1=LEN(P1$)", "N10 X1").host.permanent["@1"] == 4
    for sub in ("20 @1=LEN(P1$)", "10 PDIM P1$(3)\n20 @1=LEN(P1$)"):
        with pytest.raises(ProgramError) as caught:
            run(sub)
        assert caught.value.what == "invalid variable"
    assert errors("10 PDIM A$(4)") == ["1:9 PDIM takes a parameter like P1$, DIM other variables"]


def test_a_level_can_be_left_from_outside() -> None:
    host = RecordingHost(programs={"SP": "N1 X1\nN2 M30\n3 #A=1"})
    linker = Linker(host.program)
    main, _ = linker.link("1 B=2\n10 CALL SP\nN5 X[B]", "main.cpl")
    assert main is not None
    run = Run(main, linker, host)
    assert run.step() == Lines(1, 2)
    assert [(level.program.file, level.line) for level in run.stack] == [("main.cpl", 2), ("SP", 1)]
    assert run.leave()
    assert isinstance(run.step(), NcValues)
    assert run.local_variables() == {"B": 2.0}
    assert run.globals == {"#A": None}
    assert run.step() is None
    assert not run.leave()


# WAIT and functions of the control


@pytest.mark.covers("cpl.WAIT.nc", "cpl.WAIT")
def test_wait_in_cpl_and_nc_blocks() -> None:
    assert Ran("20 WAIT\nN20 WAIT\nWAIT").events == [Waiting(line, None, None) for line in (1, 2, 3)]
    assert errors("N20 WAIT(,1000)") == ["1:5 WAIT needs an NC block of its own"]
    assert errors("20 WAIT : #A=1") == ["1:4 a block with WAIT has no colon"]
    assert errors("20 #A=1 : WAIT") == ["1:11 a block with WAIT has no colon"]


@pytest.mark.covers("cpl.ex.1235", "cpl.ex.1236", "cpl.ex.1237", "cpl.ex.1238")
@pytest.mark.parametrize(
    ("text", "asked", "met", "duration"),
    [
        ("WAIT(,1000,#E%)", None, None, 1000),
        ("WAIT(,TIME%)", None, None, 250),
        ("WAIT(IC(1,1,1)=TRUE)", (1, 1, 1), True, None),
        ("WAIT(IC(2,0,2)=(E1? OR E2?))", (2, 0, 2), True, None),
        ("WAIT(NOT IC(3,2,1),,#E%)", (3, 2, 1), False, None),
        ("WAIT(IC(4,4,1)=E7?,250,#E%)", (4, 4, 1), True, 250),
        ("WAIT(NOT (IC(4)))", (4,), False, None),
    ],
)
def test_wait_names_its_condition_duration_and_result(
    text: str, asked: tuple[int, ...] | None, met: bool | None, duration: int | None
) -> None:
    state = [True]
    calls: list[tuple[int, ...]] = []

    def ic(*arguments: int) -> bool:
        calls.append(arguments)
        return state[0]

    host = RecordingHost({"IC": ic})
    ran = Ran(f"5 TIME%=250 : E1?=FALSE : E2?=TRUE : E7?=TRUE\n10 {text}", host, wait=2)
    event = ran.events[0]
    assert isinstance(event, Waiting)
    assert event.duration_ms == duration
    assert (event.condition is None) == (asked is None)
    if event.condition is not None:
        assert event.condition() is met
        state[0] = False
        assert event.condition() is not met
        assert calls == [asked, asked]
    assert ran.run.globals == ({"#E%": 2} if "#E%" in text else {})


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("WAIT(,-5)", "INVALID PARAMETER"),
        ("WAIT(,T%)", "INVALID PARAMETER"),
        ("WAIT(IC(1),T%,E%)", "INVALID PARAMETER"),
        ("WAIT(,N%)", "INVALID VARIABLE: N% has no value (NUL)"),
        ("WAIT(,2.5)", "INVALID ASSIGNMENT"),
    ],
)
def test_wait_takes_no_time_below_zero_and_none_without_a_value(text: str, what: str) -> None:
    error = at_run_time(f"5 T%=-1\n10 {text}", RecordingHost({"IC": lambda bit: True}))
    assert error.what == what
    assert error.position is not None
    assert (error.position.line, error.position.column) == (2, 4)
    assert Ran("10 WAIT(,0)").events == [Waiting(1, None, 0)]


@pytest.mark.parametrize(
    "text", ["MID$(A$,1,N%)", "MID$(A$,N%,1)", 'INSTR("B",A$,N%)', "TRIM$(A$,N$)", 'MID$(A$,1,N%)="X"']
)
def test_a_place_without_a_value_is_none_that_was_left_out(text: str) -> None:
    target = "" if text.endswith('"X"') else "#X%=" if text.startswith("INSTR") else "#X$="
    error = at_run_time(f'5 DIM A$(9) : A$="ABC"\n10 {target}{text}')
    name = "N$" if "N$" in text else "N%"
    assert error.what in (f"INVALID VARIABLE: {name} has no value (NUL)", "INVALID PARAMETER")
    assert error.position is not None
    assert error.position.line == 2


@pytest.mark.covers("cpl.APOS")
def test_functions_of_the_control_get_their_arguments_and_set_variables() -> None:
    seen: list[tuple[object, ...]] = []

    def scs(*arguments: object) -> int:
        seen.append(arguments[:3])
        arguments[3].value = 1  # type: ignore[attr-defined]
        return 7

    def getterr(channel: int, category: object, field: dict[object, object], number: int) -> int:
        seen.append((channel, category, number))
        field[1, 1] = 1938
        return 2

    host = RecordingHost({"SCS": scs, "GETERR": getterr})
    ran = Ran(
        '10 POSITION%=SCS(1,"S",51,#ERROR%)\n20 DIM #E%(3,2) : #N%=GETERR(2,,#E%,1)\n30 #P%=POSITION%\n'
        '35 DIM L%(2) : #Q%=SCS(2,"P",52,L%(2)) : #L%=L%(2)\n40 IC(80,0,1)=TRUE : FXC(2,54,1)=80',
        host,
    )
    assert seen == [(1, "S", 51), (2, OMITTED, 1), (2, "P", 52)]
    assert (ran["#ERROR%"], ran["#P%"], ran["#N%"], ran["#L%"], ran["#E%"][1, 1]) == (1, 7, 2, 1, 1938)  # type: ignore[index]
    assert host.set == [("IC", True, 80, 0, 1), ("FXC", 80, 2, 54, 1)]
    assert at_run_time("10 #A=APOS(1)").what == "the control has no APOS"


@pytest.mark.parametrize(
    ("statement", "happened"),
    [
        ("P UP[GETERR(1,6,#A%)+5,8]", "UP 12.0 1938"),
        ("20 CALL UP[GETERR(1,6,#A%)]", "UP 7.0 1938"),
        ("20 WAIT(,GETERR(1,6,#A%)*100)", 700),
        ("20 IC(5,GETERR(1,6,#A%),3)=TRUE", ("IC", True, 5, 7, 3)),
        ('20 MID$(T$,GETERR(1,6,#A%),2)="xy"', "ABCDEFxyI"),
        ("20 F(GETERR(1,6,#A%)-4)=41", 41),
        ("20 F(GETERR(1,6,#A%)-4)=GETERR(1,6,#B%)*3", 21),
    ],
)
def test_a_function_sets_a_variable_wherever_it_stands(statement: str, happened: object) -> None:
    def geterr(channel: int, category: int, found: Any) -> int:
        found.value = 1938
        return 7

    host = RecordingHost({"GETERR": geterr, "IC": lambda *_: True}, {"UP": "1 #P=P1 : #SEEN%=#A%"})
    ran = Ran(
        f'10 DIM F(5) : DIM T$(9) : T$="ABCDEFGHI"\n{statement}\n30 #F=F(3) : DIM #T$(9) : #T$=T$', host
    )
    assert ran["#A%"] == 1938
    waits = [event.duration_ms for event in ran.events if isinstance(event, Waiting)]
    called = f"UP {ran.run.globals.get('#P')} {ran.run.globals.get('#SEEN%')}"
    assert happened in (called, *waits, *host.set, ran["#T$"].text, ran["#F"])  # type: ignore[attr-defined]


def test_the_index_of_a_variable_that_is_set_sets_no_other_one() -> None:
    found = errors("10 DIM F(5)\n20 A%=GETERR(1,6,F(GETERR(1,6,B%)))")
    assert found == ["2:18 the index of a variable that is set sets another one"]


def test_a_choice_of_many_branches_and_a_sum_of_many_texts_are_not_too_long() -> None:
    labels = "\n".join(f"{label} LABEL {label} : #F%={label * 3}" for label in range(20, 3020))
    ran = Ran(f"10 X%=2917\n15 CASE X% OF\n{labels}\n4000 OTHERWISE #F%=-1\n4010 ENDCASE\n4020 #G%=#F%+1")
    assert (ran["#F%"], ran["#G%"]) == (8751, 8752)
    texts = "+".join(f'"{number % 7}"' for number in range(500))
    ran = Ran(f"10 DIM #A$(600) : #A$={texts}")
    assert ran["#A$"].text == "".join(str(number % 7) for number in range(500))  # type: ignore[attr-defined]


def test_an_expression_has_500_operands_and_one_longer_is_refused_where_it_goes_on() -> None:
    whole = np.float32(0.0)
    for _ in range(500):
        whole = np.float32(whole + np.float32(0.1))
    terms = "+".join(["B"] * 500)
    ran = Ran(
        f"10 B=0.1\n20 #A={terms}\n30 #C=2*({terms})\nN40 X[{terms}]\n50 #D={'*'.join(['1.0'] * 499)}*B\n"
        f"60 #E?=1=1{'=TRUE' * 498}"
    )
    assert (ran["#A"], ran["#C"], ran["#D"], ran["#E?"]) == (whole, 2 * whole, np.float32(0.1), True)
    assert ran.blocks == [f"X{whole:g}"]
    for operands in (501, 5000):
        assert errors(f"20 A={'+'.join(['B'] * operands)}") == ["1:1005 more than 500 operands in a row"]
    for opening in ("(", "SIN(", "A("):
        (error,) = errors(f"20 B={opening * 5000}1{')' * 5000}")
        assert error.endswith(("NESTING TOO DEEP", "more than 40 brackets inside each other"))


def test_what_is_too_deep_for_python_is_refused_where_it_stands() -> None:
    text = f"10 B=2.5\n20 A={'SIN(' * 39}B{'+B+B+B+B+B+B+B+B)' * 39}\n30 C=B"
    assert errors(text) == ["2:4 one expression or statement is too long or nested too deeply"]


def test_names_in_messages_are_not_longer_than_a_line() -> None:
    assert errors(f"10 GOTO .{'A' * 5000}") == [f"1:9 there is no jump destination .{'A' * 29}..."]
    assert errors(f"10 CALL {'B' * 5000}") == [f"1:4 there is no sub-program {'B' * 100}..."]


def test_a_function_that_waits_lets_time_pass() -> None:
    answers = iter((BLOCKED, BLOCKED, 0))
    host = RecordingHost({"MCOPS": lambda *arguments: next(answers)})
    linker = Linker(host.program)
    main, _ = linker.link("10 #R%=MCOPS(2,2)+5", "main.cpl")
    assert main is not None
    run = Run(main, linker, host)
    assert [run.step(), run.step(), run.step()] == [PAUSE, PAUSE, None]
    assert run.globals == {"#R%": 5}


def test_a_condition_whose_function_sets_a_variable_sees_it_set() -> None:
    def mcods(kind: int, channel: int, version: object, buffer: dict[int, int], size: int) -> int:
        version.value = 5  # type: ignore[attr-defined]
        buffer[1] = (buffer[1] or 0) + 1
        return 0

    text = (
        "10 DIM #BUF%(2) : #V=0\n20 WHILE MCODS(32,2,#V,#BUF%,2)=0 AND 1 DO\n"
        "30 IF #BUF%(1)=3 THEN GOTO .END ENDIF\n40 END\n50 .END"
    )
    host = RecordingHost({"MCODS": mcods})
    error = errors(text.replace("=0 AND 1", "=TRUE"))
    assert error == ["2:10 INTEGER is not compared with BOOLEAN"] or "compared" in error[0]
    ran = Ran(text.replace("=0 AND 1", "=0"), host)
    assert (ran["#BUF%"][1], ran["#V"]) == (3, 5.0)  # type: ignore[index]


def test_stepping_names_every_line_before_it_runs() -> None:
    ran = Ran("10 #A=1 : #B=2\nN10 X1\nN20 X2\n20 IF #A=1 THEN\n30 #B=3\n40 ENDIF", stepping=True)
    assert ran.events == [Step(1), Step(2), Lines(2, 2), Step(3), Lines(3, 3), Step(4), Step(5)]


def test_an_error_names_its_program_line_and_column_and_stops_all() -> None:
    host = RecordingHost(programs={"SP": "1 A=2\n2  B=A/0"})
    with pytest.raises(ProgramError) as caught:
        Ran("1 @1=7\n2 CALL SP\n3 @2=8", host)
    assert (
        str(caught.value)
        == "SP:2:4: division by zero\n    2  B=A/0\n       ^\ntest the divisor with IF before"
    )
    assert (host.permanent["@1"], host.permanent["@2"]) == (7, None)


def test_code_of_a_program_cannot_reach_python() -> None:
    assert compile_program('10 A$="\x017\x01{0}\\\'"', "x")[1] == []
    assert Ran('10 #A$="\x017\x01{0}\\\'" : GOTO .A\n20 .A')["#A$"] == "\x017\x01{0}\\'"
    assert errors("10 __import__=1") == []
    assert (
        Ran(
            "10 #A=0\n20 EXEC=2 : RETURN=3 : G=4 : HOST=5 : F=6 : T=7 : M=8 : PC=9\n30 #A=EXEC+RETURN+G+HOST+F+T+M+PC"
        )["#A"]
        == 44.0
    )
