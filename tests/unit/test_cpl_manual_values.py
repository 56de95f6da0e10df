"""Values, texts, branches and loops of CPL, each by several programs whose results are worked out by hand (Manual 003).

A program claims the rows of all words that it uses: what it leaves behind is told to the last digit.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from polycnc.errors import ProgramError
from polycnc.nc.cpl import PermanentMemory
from support.cpl_host import Ran, RecordingHost
from support.cpl_rows import rows_of
from support.cpl_runs import Root
from support.cpl_screens import Shown


def single(value: float) -> float:
    return float(np.float32(value))


def numbered(text: str) -> str:
    return "\n".join(
        line if re.match(r"N?[0-9]", line) else f"{10 * place} {line}"
        for place, line in enumerate(text.split("\n"), 1)
    )


GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "cpl" / "values.txt"


def cases() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the programs of the table with the values that they leave behind."""
    for part in GOLDEN.read_text(encoding="utf-8").split("\n\n")[1:]:
        lines = part.strip().split("\n")
        words = [word for line in lines if line.startswith("-> ") for word in line.split()[1:]]
        wanted = {name: known(name, text) for name, _, text in (word.partition("=") for word in words)}
        yield "\n".join(line for line in lines if not line.startswith("-> ")), wanted


def known(name: str, text: str) -> object:
    """Return a value of the table as its variable has it."""
    if name.endswith("?"):
        return {"TRUE": True, "FALSE": False}[text]
    return int(text) if name.endswith("%") else float(text) if name.endswith("!") else single(float(text))


@pytest.mark.parametrize(
    ("program", "wanted"),
    [
        pytest.param(*each, id=str(place), marks=pytest.mark.covers(*rows_of(each[0])))
        for place, each in enumerate(cases(), 1)
    ],
)
def test_a_program_leaves_behind_what_its_words_say(program: str, wanted: dict[str, Any]) -> None:
    run = Ran(numbered(program))
    found = {name: run[name] for name in wanted}
    for name, value in wanted.items():
        assert type(found[name]) is type(value), name
        assert found[name] == (pytest.approx(value, rel=1e-14) if name.endswith("!") else value), name


NO_ROOM = "inadmissible assignment to a non-dimensioned STRING variable"
REFUSED = [
    ("type.BOOLEAN", "#A?=1", "INVALID ASSIGNMENT"),
    ("type.BOOLEAN", "A$=TRUE", "a text is needed"),
    ("type.BOOLEAN TRUE", "#A%=TRUE", "INVALID ASSIGNMENT"),
    ("type.BOOLEAN FALSE", "#A=FALSE", "INVALID ASSIGNMENT"),
    ("type.BOOLEAN TRUE FALSE VAL", '#A?=VAL("1")', "INVALID ASSIGNMENT"),
    ("type.BOOLEAN", "DIM B?(2)\nB?(1)=2>1\nB?(2)=3", "INVALID ASSIGNMENT"),
    ("type.BOOLEAN op.lt", "#A?=TRUE<FALSE", "TRUE and FALSE are only compared by = and <>, not by <"),
    ("type.BOOLEAN op.ge", "#A?=B?>=TRUE", "TRUE and FALSE are only compared by = and <>, not by >="),
    ("type.BOOLEAN AND", "#A?=TRUE AND 1", "AND takes two BOOLEAN or two INTEGER values, not BOOLEAN and INTEGER"),
    ("type.INTEGER", "#A%=2.5", "INVALID ASSIGNMENT"),
    ("type.INTEGER", "#A%=4/2", "INVALID ASSIGNMENT"),
    ("type.INTEGER", "#A%=2147483647\n#A%=#A%+1", "the value is out of the range of its type"),
    ("type.INTEGER", "#A%=-2147483647\n#A%=#A%-2", "the value is out of the range of its type"),
    ("type.REAL", "#A=10000000000000000000.0\n#A=#A*#A*10", "the value is out of the range of its type"),
    ("type.ARRAY DIM", "DIM A(3)\nA(4)=1", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM", "DIM A%(2,3)\nA%(3,1)=1", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM", "DIM A%(2,3)\nA%(1,4)=1", "INVALID FIELD LIMIT"),
    ("type.CHARACTER DIM err.INVALID_FIELD_LIMIT", "DIM A$(1025)", "INVALID FIELD LIMIT"),
    ("type.CHARACTER DIM err.INVALID_FIELD_LIMIT", "DIM A$(0)", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM err.INVALID_FIELD_LIMIT", "DIM A(65537)", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM err.INVALID_FIELD_LIMIT", "DIM A%(256,257)", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM err.INVALID_FIELD_LIMIT", "DIM A%(0)", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM err.INVALID_FIELD_LIMIT", "DIM A%(3,0)", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM err.INVALID_FIELD_LIMIT", "DIM A$(3,1025)", "INVALID FIELD LIMIT"),
    ("type.ARRAY DIM err.INVALID_FIELD_LIMIT", "DIM A$(1025,3)", "INVALID FIELD LIMIT"),
    ("err.INVALID_VARIABLE type.ARRAY", "DIM A(3)\n#A=A(I%)", "INVALID VARIABLE"),
    ("err.INVALID_VARIABLE type.ARRAY", "DIM A(3,3)\n#A=A(1,I%)", "INVALID VARIABLE"),
    ("kw.OF CASE", "CASE 1", "'OF' is missing"),
    ("kw.THEN IF", "IF 1=1", "'THEN' is missing"),
    ("kw.TO FOR", "FOR I%=1", "'TO' is missing"),
    ("BCD", "#A%=BCD(80000000)", "INVALID PARAMETER"),
    ("ROUND", "#A%=ROUND(2147483648.0)", "the value is out of the range of its type"),
    ("VAL", '#A%=VAL("2147483648")', "the value is out of the range of its type"),
    ("VAL", '#A%=VAL("-2147483649")', "the value is out of the range of its type"),
    ("SQRT", "#A=SQRT(-1)", "INVALID PARAMETER"),
    ("TAN", "#A=TAN(90)", "INVALID PARAMETER"),
    ("BCD", "#A%=BCD(-1)", "INVALID PARAMETER"),
    ("BIN", "#A%=BIN(10)", "INVALID PARAMETER"),
    ("INT", "#A%=INT(3000000000.0)", "the value is out of the range of its type"),
    ("ROUND", "#A%=ROUND(-3000000000.0)", "the value is out of the range of its type"),
    ("CHR$", "A$=CHR$(256)", "INVALID PARAMETER"),
    ("CHR$", "A$=CHR$(-1)", "INVALID PARAMETER"),
    ("MID$ err.INVALID_PARAMETER", 'A$=MID$("ABC",0,1)', "INVALID PARAMETER"),
    ("MID$ err.INVALID_PARAMETER", 'A$=MID$("ABC",1025)', "INVALID PARAMETER"),
    ("MID$ err.INVALID_PARAMETER", 'A$=MID$("ABC",1,0)', "INVALID PARAMETER"),
    ("INSTR err.INVALID_PARAMETER", '#A%=INSTR("A","ABC",0)', "INVALID PARAMETER"),
    ("INSTR err.INVALID_PARAMETER", '#A%=INSTR("A","ABC",1025)', "INVALID PARAMETER"),
    ("TRIM$", 'A$=TRIM$("ABC","X")', "INVALID PARAMETER"),
    ("STR$", 'DIM A$(9)\nA$=STR$("XX",5)', "FORMAT NOT PERMITTED"),
    ("STR$", 'DIM A$(9)\nA$=STR$("#.#",55.5)', "FORMAT NOT PERMITTED"),
    ("STR$ err.INADMISSIBLE_STRING", "A$=STR$(5)", NO_ROOM),
    ("op.chain err.INADMISSIBLE_STRING", 'B$="1"\nA$=B$+B$', NO_ROOM),
    ("MID$ err.INADMISSIBLE_STRING", 'A$="AB"\nMID$(A$,1)="X"', NO_ROOM),
    ("MID$ err.CHARACTER_FIELD_NOT_ASSIGNED", 'DIM A$(9)\nA$="AB"\nMID$(A$,4)="X"', "CHARACTER FIELD NOT ASSIGNED"),
    ("MID$ err.CHARACTER_AREA_NOT_USED", 'DIM A$(9)\nMID$(A$,2,1)="X"', "CHARACTER FIELD NOT ASSIGNED"),
    ("err.2153 op.chain", 'DIM A$(9)\nA$="1"+("2"+("3"+("4"+("5"))))', "NESTING TOO DEEP"),
    ("NUL", "#A=B+1", "INVALID VARIABLE: B has no value (NUL)"),
    ("IF", "IF 1 THEN #A=1 ENDIF", "a condition is TRUE or FALSE, not INTEGER"),
    ("WHILE", "WHILE 1 DO\n#A=1\nEND", "a condition is TRUE or FALSE, not INTEGER"),
    ("REPEAT", "REPEAT\n#A=1\nUNTIL 2", "a condition is TRUE or FALSE, not INTEGER"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("program", "what"),
    [
        pytest.param(program, what, marks=pytest.mark.covers(*(f"cpl.{row}" for row in rows.split())))
        for rows, program, what in REFUSED
    ],
)
def test_a_program_that_the_manual_does_not_allow_is_refused_where_it_is_wrong(
    program: str, what: str
) -> None:
    with pytest.raises(ProgramError) as caught:
        Ran(numbered(program), RecordingHost())
    assert caught.value.position is not None
    assert caught.value.what.startswith(what)
    if not what.startswith("a condition"):
        assert caught.value.position.line == program.count("\n") + 1


@pytest.mark.covers("cpl.MID$.stmt", "cpl.MID$", "cpl.string.assign.fromfield")
def test_a_part_of_a_text_is_written_over_by_as_many_characters_as_it_has() -> None:
    run = Ran(
        numbered(
            'DIM A$(6) : DIM B$(6) : DIM C$(6)\nA$="ABCDEF" : B$=A$ : C$=A$ : D$=A$\nMID$(A$,2,2)="XYZ"\n'
            'MID$(B$,5)="UVW" : MID$(C$,3,9)="1"\n#A?=A$="AXYDEF" : #B?=B$="ABCDUV" : #C?=C$="AB1DEF"\n'
            '#D?=D$="AXYDEF" : MID$(A$,6,1)="" : #E?=A$="AXYDEF"'
        )
    )
    assert [run[f"#{each}?"] for each in "ABCDE"] == [True] * 5  # what refers to a field sees what is written


@pytest.fixture
def root(tmp_path: Path) -> Root:
    return Root(tmp_path)


WRITTEN = """
DIM T$(40) : DIM L?(2) : I%=-42 : R=2.5 : D!=0.1 : L?(1)=TRUE : L?(2)=FALSE : T$="TEXT"
OPENW(1,"OUT",500)
PRN#(1,L?(1),L?(2),T$,I%)
PRN#(1,R,"|",D!)
PRN#(1,"X###.## Y##",R,I%*-1)
PRN#(1,"A";)
PRN#(1,"B")
LJUST
PRN#(1,I%,"|",R,"|",D!,"|X###.##|",R)
NJUST
PRN#(1,"#",7,3>2)
CLOSE(1)
OPENR(2,"OUT")
#S%=FILESIZE(2) : #T%=FILESIZE(2,2) : #P%=FILEPOS(2)
INP#(2,A?,B?,T$)
#A?=A? : #B?=B? : #C?=T$="TEXT      -42"
INP#(2,#R,T$)
INP#(2,T$) : #D?=T$="X  2.50 Y42" : #Q%=FILEPOS(2)
INP#(2,T$) : #E?=T$="AB" : #F?=EOF(2)
SEEK(2,1)
INP#(2,A?;)
INP#(2,B?) : #G?=A? : #H?=B?
SEEK(2,0) : #I?=EOF(2)
CLOSE(2)
#K%=FILEACCESS("NONE") : #L%=ERASE("NONE") : #M%=FILEACCESS("OUT")
"""


@pytest.mark.covers(
    *rows_of(WRITTEN),
    "cpl.PRN#.n.1-9",
    "cpl.INP#.semicolon",
    "cpl.FILEACCESS.ret.-1",
    "cpl.file.seq",
    "cpl.PRN#",
    "cpl.INP#",
    "cpl.FILEACCESS",
)
@pytest.mark.covers(
    "cpl.FILESIZE.k.1", "cpl.FILESIZE.k.2", "cpl.FILEPOS.mode.1", "cpl.FILESIZE", "cpl.FILEPOS"
)
def test_values_of_all_types_are_written_and_read_again(root: Root) -> None:
    found = root.run(numbered(WRITTEN.strip())).variables
    lines = [
        "TRUEFALSETEXT      -42",
        "   2.500|        0.100000",
        "X  2.50 Y42",
        "AB",
        "-42|2.5|0.1|X2.50|",
        "7TRUE",
    ]
    assert root.read("OUT").decode("latin-1").split("\n") == [*lines, "\x03", ""]
    size = len(root.read("OUT")) - 2
    assert (found["#S%"], found["#T%"], found["#P%"]) == (size + 2, size, 1)
    assert found["#Q%"] == 1 + sum(len(each) + 1 for each in lines[:3])
    assert {name: found[f"#{name}?"] for name in "ABCDEFGHI"} == dict.fromkeys(
        "ACDEGI", True
    ) | dict.fromkeys("BFH", False)
    assert (found["#R"], found["#K%"], found["#L%"]) == (2.5, -1, 1)
    assert int(str(found["#M%"])) & 6 == 6


DRAWN = """
GWD(100,300,50,150) : MWD(-20,80,10,60) : COL(5)
LIN(-20,10,0,10) : LIN(80,10,80,60) : CIR(35,35,10)
COL(3) : LIN(0,20,20,20) : LIN(20,50) : LIN(0,50) : LIN(0,20)
COL(2) : LIN(4,30,16,30)
FIL(10,40,0,6,3)
FIL(35,35,0,4,5)
"""


@pytest.mark.covers("cpl.MWD", "cpl.GWD", "cpl.LIN", "cpl.CIR", "cpl.FIL", "cpl.COL", "cpl.COL.arg.graphics")
def test_coordinates_fit_the_window_and_what_a_contour_holds_is_filled(tmp_path: Path) -> None:
    """The window is 200 by 100 pixels, its coordinates are 100 by 50: two pixels each, from (-20, 10) on."""
    shown = Shown(numbered(DRAWN.strip()), tmp_path)

    def at(x: float, y: float) -> int:
        return shown.colour(100 + round(2 * (x + 20)), 50 + round(2 * (y - 10)))

    assert [at(-20, 10), at(0, 10), at(0.5, 10), at(80, 10), at(80, 60), at(79.5, 60)] == [5, 5, -1, 5, 5, -1]
    assert [at(45, 35), at(35, 45), at(35, 25), at(46, 35)] == [5, 5, 5, -1]
    assert [at(0, 20), at(20, 35), at(10, 50)] == [3, 3, 3]
    assert [at(10, 40), at(1, 21), at(19, 49), at(10, 30), at(10, 25)] == [6] * 5  # over the line within it
    assert [at(-1, 35), at(10, 19), at(10, 51)] == [-1] * 3
    assert [at(35, 35), at(43, 35), at(35, 44), at(35, 46)] == [4, 4, 4, -1]


BOOLEANS = """
DIM B?(2) : B?(1)=3>2 : B?(2)=NOT B?(1)
DSP(3,5,B?(1)," ",B?(2)," ##",7)
OPENW(1,"B") : PRN#(1,B?(1)) : PRN#(1,B?(2)) : PRN#(1,"  TRUEX") : PRN#(1,"YES") : CLOSE(1)
OPENR(1,"B") : INP#(1,#A?) : INP#(1,#B?) : INP#(1,#C?) : INP#(1,#D?) : #E?=EOF(1) : CLOSE(1)
"""


@pytest.mark.covers("cpl.TRUE", "cpl.FALSE", "cpl.type.BOOLEAN", "cpl.DSP", "cpl.PRN#", "cpl.INP#", "cpl.EOF")
def test_truth_is_written_and_read_as_a_word(tmp_path: Path) -> None:
    shown = Shown(numbered(BOOLEANS.strip()), tmp_path)
    assert shown[3] == "    TRUE FALSE  7"
    assert (tmp_path / "B").read_bytes() == b"TRUE\nFALSE\n  TRUEX\nYES\n\x03\n"
    assert [shown.globals[f"#{name}?"] for name in "ABCDE"] == [True, False, True, None, True]


@pytest.mark.parametrize(
    ("kind", "mark", "bytes_each"),
    [
        pytest.param(
            *each,
            marks=pytest.mark.covers(
                f"cpl.perm.DEF.{each[0]}", "cpl.perm.memory", "cpl.var.defperm", "cpl.var.@_R"
            ),
        )
        for each in (("INT", "%", 4), ("REAL", "", 4), ("DOUBLE", "!", 8), ("BOOL", "?", 1), ("CHAR", "$", 1))
    ],
)
def test_declared_variables_take_the_memory_of_their_types(kind: str, mark: str, bytes_each: int) -> None:
    memory = PermanentMemory()
    assert memory.free == 100_678
    assert memory.declare([("anwperm.dat", f"DEF {kind} @AB ; one\nDEF {kind} @LIST1(7) ; seven\n")]) == []
    assert memory.free == 100_678 - (3 + 20 + bytes_each) - (6 + 20 + 7 * bytes_each)
    simple, many = memory[f"@AB{mark}"], memory[f"@LIST1{mark}"]
    if kind == "CHAR":
        assert (simple.size, many.size) == (1, 7)
    else:
        assert simple is None
        assert (many.kind, many.sizes) == ({"INT": "I", "REAL": "R", "DOUBLE": "D", "BOOL": "B"}[kind], (7,))
    if kind == "DOUBLE":
        assert len(memory.declare([("anwperm.dat", f"DEF {kind} @BIG({100_678 // 8}) ;\n")])) == 1
        memory.declare([("anwperm.dat", "")])
        assert memory.declare([("anwperm.dat", f"DEF {kind} @BIG({(100_678 - 24) // 8}) ;\n")]) == []
    assert (memory["@_R"].kind, memory["@_R"].sizes) == ("D", (100,))


@pytest.mark.covers("cpl.var.@_R", "cpl.var.permanent", "cpl.var.overview")
def test_the_permanent_field_has_100_double_elements_and_numbers_are_integers(root: Root) -> None:
    first = (
        "1 @_R(1)=0.1 : @_R(100)=123456789.012345 : @7=-42 : @100LETTERS%=9\n2 #A!=@_R(1)*3 : #B?=@_R(50)=NUL"
    )
    found = root.run(first).variables
    assert (found["#A!"], found["#B?"]) == (0.1 * 3, True)
    again = root.run("1 #A!=@_R(1) : #B!=@_R(100) : #C%=@7 : #D%=@100").variables
    assert [again[name] for name in ("#A!", "#B!", "#C%", "#D%")] == [0.1, 123456789.012345, -42, 9]
    assert root.error("1 @_R(101)=1") == "1: INVALID FIELD LIMIT"
    assert root.error("1 @7=2.5") == "1: INVALID ASSIGNMENT"
    assert "there is no permanent variable @101" in root.error("1 @101=1")


@pytest.mark.covers(
    "cpl.err.INVALID_LOGICAL_NUMBER", "cpl.err.INVALID_FILE_NUMBER", "cpl.OPENW", "cpl.OPENR", "cpl.FILEPOS"
)
@pytest.mark.covers("cpl.PRN#.n.1-9", "cpl.FILESIZE", "cpl.SEEK", "cpl.CLOSE")
@pytest.mark.covers("cpl.PRN#")
def test_files_have_the_numbers_1_to_9(root: Root) -> None:
    lines = [f'1 OPENW({n},"F{n}") : PRN#({n},"{n * 11}")' for n in range(1, 10)]
    lines += [
        f'2 CLOSE({n})\n3 OPENR({n},"F{10 - n}")\n4 INP#({n},#A{n}%)\n5 #B{n}%=FILESIZE({n},2)'
        for n in (1, 9)
    ]
    found = root.run(
        "\n".join(
            line.replace("2 CLOSE(1)", "2 CLOSE(1) : CLOSE(9)").replace("2 CLOSE(9)\n", "") for line in lines
        )
    ).variables
    assert [found[name] for name in ("#A1%", "#B1%", "#A9%", "#B9%")] == [99, 3, 11, 3]
    for number in (0, 10, -1):
        assert root.error(f'1 OPENW({number},"P")') == "1: INVALID LOGICAL NUMBER"
        assert root.error(f'1 OPENR({number},"F1")') == "1: INVALID LOGICAL NUMBER"
        assert root.error(f"1 A%=FILEPOS({number})") == "1: INVALID FILE NUMBER"
        assert root.error(f"1 SEEK({number},1)") == "1: INVALID FILE NUMBER"
