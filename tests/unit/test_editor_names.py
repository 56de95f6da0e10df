"""Names of programs in an editor: where they are given and used, renamed, and blocks numbered anew."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc import runner
from polycnc.editor._about import about_name
from polycnc.editor._codes import completions
from polycnc.editor._format import formatted
from polycnc.editor._names import Name, Role, givers, name_at, names_of, program_file, same
from polycnc.editor._place import Span
from polycnc.editor._rename import renamed
from polycnc.errors import UsageError
from polycnc.nc import Dialect, load_dialect

FANUC, LATHE, LINUXCNC, BOSCH = map(load_dialect, ("fanuc", "fanuc-lathe", "linuxcnc", "bosch"))

MACRO = "O7\n#101=3 (#101)\nN20 IF[#101GT5]GOTO 30\n#0102=#101+#500\nN030 G65 P77 A#101\nM98 P50077\nM30\nO77\nM99"
NGC = (
    "o<Hole> sub\n#<depth> = 5\no100 if [#<depth> gt 3]\n"
    "G0 Z#<dep th>\no100 endif\no<hole> endsub\n#3=1\no<hole> call\nM2"
)
CPL = (
    "10 A%=3\n20 .AGAIN\n30 A%=A%+1: REM A%\n"
    "N7 X[A%*2] F90\n40 IF A%<9 THEN GOTO .AGAIN ENDIF\n50 GOTO N7\n60 CALL POCKET(A%)\n70 GOTO 20"
)
TURNING = "N5 G0 X3\nN7 G71 P9 Q11 U1 F0.2\nN9 G0 X1\nN11 G1 Z3\n"


def _names(text: str, dialect: Dialect) -> tuple[list[str], list[Name]]:
    lines = text.split("\n")
    return lines, list(names_of(lines, dialect))


def _at(text: str, word: str, dialect: Dialect, number: int = 0) -> tuple[list[str], list[Name], Name]:
    """Return lines, names, and the name where a word stands for the nth time."""
    lines, names = _names(text, dialect)
    places = [(row, line.find(word)) for row, line in enumerate(lines) if word in line]
    row, column = places[number]
    found = name_at(names, row, column)
    assert found is not None
    return lines, names, found


@pytest.mark.parametrize(
    ("text", "dialect", "word", "number", "given", "used"),
    [
        (MACRO, FANUC, "#101", 0, [1], [2, 3, 4]),  # that in the comment is none
        (MACRO, FANUC, "N030", 0, [4], [2]),
        (MACRO, FANUC, "#0102", 0, [3], []),
        (MACRO, FANUC, "P77", 0, [7], [4, 5]),  # five digits: 5 times program 77
        (TURNING, LATHE, "N9", 0, [2], [1]),
        (TURNING, LATHE, "Q11", 0, [3], [1]),
        (NGC, LINUXCNC, "#<depth>", 0, [1], [2, 3]),  # blanks and capitals do not count
        (NGC, LINUXCNC, "Hole", 0, [0], [5, 7]),
        (NGC, LINUXCNC, "100", 0, [2], [4]),
        (CPL, BOSCH, "A%", 0, [0, 2], [2, 3, 4, 6]),
        (CPL, BOSCH, ".AGAIN", 0, [1], [4]),
        (CPL, BOSCH, "N7", 0, [3], [5]),
        (CPL, BOSCH, "20", 0, [1], [7]),
    ],
)
def test_a_name_knows_where_it_is_given_and_where_it_is_used(
    text: str, dialect: Dialect, word: str, number: int, given: list[int], used: list[int]
) -> None:
    _, names, found = _at(text, word, dialect, number)
    assert [each.span.line for each in givers(names, found)] == given
    assert [each.span.line for each in same(names, found) if each.role is Role.USED] == used


def test_a_sub_program_in_another_file_is_found_as_a_run_finds_it(tmp_path: Path) -> None:
    (tmp_path / "O0088.nc").write_text("(A)\nO88\nM99\n")
    (tmp_path / "hole.ngc").write_text("o<hole> sub\no<hole> endsub\n")
    (tmp_path / "POCKET").write_text("N1 G1 X3 F7\n")
    main = tmp_path / "part.nc"
    main.write_text("M98 P88\n")
    assert program_file("88", "M98 P88\n", str(main), FANUC) == (tmp_path / "O0088.nc", 0)
    assert program_file("89", "M98 P89\n", str(main), FANUC) is None
    assert program_file("hole", "", str(tmp_path / "part.ngc"), LINUXCNC) == (tmp_path / "hole.ngc", 0)
    assert program_file("POCKET", "", str(tmp_path / "MAIN"), BOSCH) == (tmp_path / "POCKET", 0)
    assert program_file("hole/../x", "", str(tmp_path / "part.ngc"), LINUXCNC) is None


def _changed(lines: list[str], changes: list[tuple[Span, str]]) -> str:
    result = list(lines)
    for span, text in sorted(changes, key=lambda each: -each[0].begin):
        line = result[span.line]
        result[span.line] = line[: span.begin] + text + line[span.end :]
    return "\n".join(result)


@pytest.mark.parametrize(
    ("text", "dialect", "word", "new", "expected"),
    [
        (MACRO, FANUC, "#101", "#150", MACRO.replace("#101", "#150").replace("(#150)", "(#101)")),
        (MACRO, FANUC, "N030", "N45", MACRO.replace("N030", "N45").replace("GOTO 30", "GOTO 45")),
        (NGC, LINUXCNC, "#<depth>", "deep", NGC.replace("<depth>", "<deep>").replace("<dep th>", "<deep>")),
        (NGC, LINUXCNC, "Hole", "bore", NGC.replace("Hole", "bore").replace("hole", "bore")),
        (NGC, LINUXCNC, "100", "7", NGC.replace("100", "7")),
        (CPL, BOSCH, "A%", "SUM%", CPL.replace("A%", "SUM%").replace("REM SUM%", "REM A%")),
        (CPL, BOSCH, ".AGAIN", "next2", CPL.replace(".AGAIN", ".NEXT2")),
        (CPL, BOSCH, "N7", "N12", CPL.replace("N7", "N12")),
    ],
)
def test_a_name_is_changed_wherever_it_stands_and_nowhere_else(
    text: str, dialect: Dialect, word: str, new: str, expected: str
) -> None:
    lines, names, found = _at(text, word, dialect)
    assert _changed(lines, renamed(names, lines, found, new, dialect.language)) == expected


@pytest.mark.parametrize(
    ("text", "dialect", "word", "new", "said"),
    [
        (MACRO, FANUC, "#101", "#500", "in use"),
        (MACRO, FANUC, "#101", "#3001", "in use"),
        (MACRO, FANUC, "#101", "A", "no name"),
        (MACRO, FANUC, "P77", "78", "other files"),
        ("#5001=7", FANUC, "#5001", "#7", "belongs to the control"),
        ("#<_feed>=7", LINUXCNC, "#<_feed>", "_fed", "belongs to the control"),
        (NGC, LINUXCNC, "#<depth>", "_x", "no name"),
        (CPL, BOSCH, "A%", "B$", "no name"),
        (CPL, BOSCH, "A%", "IF", "no name"),
        (CPL, BOSCH, "20", "25", "keep their order"),
    ],
)
def test_a_new_name_that_would_mean_something_else_is_refused(
    text: str, dialect: Dialect, word: str, new: str, said: str
) -> None:
    lines, names, found = _at(text, word, dialect)
    with pytest.raises(UsageError, match=said):
        renamed(names, lines, found, new, dialect.language)


def test_blocks_are_numbered_anew_with_the_jumps_to_them() -> None:
    text = "N3G1X3F90(A  B)\n N7 Y-2  Z+.5\nIF[#1EQ2]GOTO 3\nGOTO7\nG0   X1"
    assert "\n".join(formatted(text.split("\n"), FANUC)) == (
        "N10 G1 X3 F90 (A  B)\nN20 Y-2 Z+.5\nIF[#1EQ2]GOTO 10\nGOTO20\nG0 X1"
    )
    assert formatted(TURNING.split("\n"), LATHE)[1] == "N20 G71 P30 Q40 U1 F0.2"
    cpl = "10 A%=3\nN7 X3 F90\n35 GOTO N7\n36 GOTO 10"
    assert "\n".join(formatted(cpl.split("\n"), BOSCH)) == "10 A%=3\nN20 X3 F90\n30 GOTO N20\n40 GOTO 10"


@pytest.mark.parametrize(
    "text", ["N3 GOTO#7\nN4", "N3 X1\nGOTO 99", "N3\nN3\nGOTO 3", "N3\nM99 P3", "N3 M97 P3"]
)
def test_numbers_stay_where_a_jump_could_lead_elsewhere(text: str) -> None:
    lines = text.split("\n")
    assert [line.split(" ")[0] for line in formatted(lines, FANUC)] == [line.split(" ")[0] for line in lines]


_BLOCKS = st.lists(
    st.sampled_from(
        ["N4G1X3F90", "N9 G0  Y7", "G2X1 Y2R9", "(A) X3", "/2 N6 Z-1", "G4 P300", "X.5Y-1.25 ;T", "#1=3", "GOTO9",
         "IF[#1GT2]GOTO 4", "X#1", "X1 0", "M98P4", "%", "G43.4", "o5 repeat [2]", "X[1 + 2]", "T1M6S500M3"]
    ),
    max_size=8,
)  # fmt: skip


@settings(max_examples=8, deadline=None)
@given(_BLOCKS, st.sampled_from((FANUC, LINUXCNC, BOSCH)))
def test_a_formatted_text_says_the_same_and_stays_as_it_is(lines: list[str], dialect: Dialect) -> None:
    after = formatted(lines, dialect)
    assert formatted(after, dialect) == after
    plain = [line for line in lines if "GOTO" not in line]  # which may loop for ever
    before, then = ("\n".join([*each, "M30"]) + "\n" for each in (plain, formatted(plain, dialect)))
    wrong = [
        [each.position.line for each in runner.check(text, None, dialect) if each.position]
        for text in (before, then)
    ]
    assert wrong[0] == wrong[1]


ABOUT = [
    "#<_safe> = 5 (mm)",
    "o<hole> sub",
    "#<deep> = #1 (how deep)",
    "#<x> = [#2]",
    "o101 while [#<deep> gt 0]",
    "#<deep> = [#<deep> - 1]",
    "G1 Z-#<deep> X#3",
    "o101 endwhile",
    "o102 if [#<_x> gt 3]",
    "o102 endif",
    "o<hole> endsub",
    "o5 do",
    "o5 while [#7 lt 3]",
    "o<hole> call [2] [3]",
    "G0 Z#<_safe>",
    "o<far> call",
]


@pytest.mark.parametrize(
    ("line", "word", "said"),
    [
        (14, "#<_safe>", "**#<_safe>**: common parameter|Set in line 1 to 5"),
        (6, "#<deep>", "**#<deep>**: local parameter|Set in lines 3, 6"),
        (8, "#<_x>", "**#<_x>**: value of the control"),
        (3, "#<x>", "**#<x>**: local parameter|Set in line 4: `#<x> = [#2]`"),
        (12, "#7", "**#7**: local variable: an argument of a call, or set here"),
        (
            13,
            "hole",
            "**O<hole>**: sub-program in lines 2 to 11, called once here|Arguments: #1 deep, #2 x, #3",
        ),
        (15, "far", "**O<far>**: sub-program in far.ngc"),
        (7, "101", "**O101**: loop in lines 5 to 8: `o101 while [#<deep> gt 0]`"),
        (9, "102", "**O102**: condition in lines 9 to 10: `o102 if [#<_x> gt 3]`"),
        (12, "5", "**O5**: loop in lines 12 to 13: `o5 do`"),
    ],
)
def test_a_name_says_what_it_is(line: int, word: str, said: str) -> None:
    names = list(names_of(ABOUT, LINUXCNC))
    found = name_at(names, line, ABOUT[line].index(word) + 1)
    assert found is not None
    file = Path("x/far.ngc") if word == "far" else None
    assert about_name(names, ABOUT, found, LINUXCNC, file).split("  \n") == said.split("|")


@pytest.mark.parametrize(
    ("written", "first"),
    [
        ("G0 X#<", ["_safe", "deep", "x", "_x"]),
        ("o<", ["hole", "far"]),
        ("o<hole> c", ["sub", "endsub", "call"]),
        ("N3 O7 e", ["sub", "endsub", "call"]),
    ],
)
def test_names_of_the_text_are_completed(written: str, first: list[str]) -> None:
    lines = [*ABOUT, written]
    found = completions(lines, len(lines) - 1, len(written), LINUXCNC, list(names_of(lines, LINUXCNC)))
    assert [each.label for each in found][: len(first)] == first
