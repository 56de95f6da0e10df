"""Files beside part programs in an editor: machine, dialect and control files, stand-alone programs, hostile texts."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.controllers.apci import sap
from polycnc.editor import findings
from polycnc.editor._codes import completions
from polycnc.editor._document import Document, characters, units
from polycnc.editor._kinds import Kind, kind_of
from polycnc.editor._names import Role, givers, name_at, same
from polycnc.editor._rename import CONTROL, STAND_ALONE, check_renaming, renamed
from polycnc.editor._stand_alone import sap_completions, sap_hover, sap_names, sap_outline
from polycnc.editor._tables import control_names, key_completions, key_hover, table_outline
from polycnc.errors import UsageError
from polycnc.machine import PRESETS, preset_text
from polycnc.nc import load_dialect
from polycnc.post import CONTROLS, shipped_text

FANUC, LINUXCNC, BOSCH = map(load_dialect, ("fanuc", "linuxcnc", "bosch"))
MACHINE = (
    'name = "saw"\ncycle_s = 0.002\n[[axis]]\nname = "X"\nkind = "linear"\nvmax_mm_s = 70\namax_mm_s2 = 900\n'
    "[path]\n[times]\nauxiliary_s = 0.3\n"
)
FEED = "PROGRAM Feed;\nVAR i : INTEGER;\nPROCEDURE Go;\nBEGIN\n  I := 3;\n  js (X, C);\nEND;\nBEGIN\n  go;\nEND.\n"


def test_a_text_is_what_its_keys_say_finished_or_not() -> None:
    for name in PRESETS:
        assert kind_of("shop.toml", preset_text(name)) is Kind.MACHINE
    for name in CONTROLS:
        assert kind_of("shop.TOML", shipped_text(name)) is Kind.CONTROL
    assert kind_of("a.toml", 'name = "x"\n[g]\n0 = "rapid"\n[m]\n3 = ') is Kind.DIALECT
    assert kind_of("a.toml", "[[axis]]\nname = ") is Kind.MACHINE
    assert kind_of("pyproject.toml", '[project]\nname = "x"\n[tool.ruff]\n') is Kind.UNKNOWN
    assert kind_of("a.toml", "") is Kind.UNKNOWN
    assert kind_of("feed.SAP", "") is Kind.STAND_ALONE
    assert kind_of("part.nc", "[[axis]]") is Kind.PROGRAM


def test_each_wrong_key_of_a_file_is_told_at_its_place() -> None:
    text = MACHINE.replace("[path]", "[path]\nwhat = 7", 1) + "\n[spindle2]\n"
    found = findings(Document(text), "shop.toml")
    lines = text.split("\n")
    assert [lines[each.span.line] for each in found] == ["what = 7", "[spindle2]"]
    assert all("unknown key" in each.text for each in found)
    macro = shipped_text("din").replace("PROGRAM_END = '''", "PROGRAM_END = '''\nIF (\nNOPE! }\n", 1)
    assert len(findings(Document(macro), "din.toml")) > 1
    assert findings(Document(shipped_text("din")), "din.toml") == []
    assert findings(Document("[tool.other]\nx = "), "other.toml") == []


def test_a_key_tells_its_meaning_and_range() -> None:
    lines = MACHINE.split("\n")
    row = next(number for number, line in enumerate(lines) if line.startswith("cycle_s"))
    found = key_hover(lines, row, 2, Kind.MACHINE)
    assert found is not None
    assert "cycle_s <= 1" in found[0]
    axis = next(number for number, line in enumerate(lines) if line.startswith("vmax_mm_s"))
    assert key_hover(lines, axis, 2, Kind.MACHINE) is not None  # in [[axis]], whose kinds differ
    assert key_hover(lines, row, 99, Kind.MACHINE) is None
    assert key_hover(["[path]", "what = 7"], 1, 1, Kind.MACHINE) is None


def test_the_keys_of_a_table_and_the_values_of_a_key_are_completed() -> None:
    path = {each.label for each in key_completions(["[path]", "t"], 1, 1, Kind.MACHINE)}
    assert "corner_share" in path
    assert "cycle_s" not in path
    assert {"kind", "vmax_mm_s", "vmax_deg_s"} <= {
        each.label for each in key_completions(["[[axis]]", ""], 1, 0, Kind.MACHINE)
    }
    assert {"path", "axis"} <= {each.label for each in key_completions(["["], 0, 1, Kind.MACHINE)}
    values = [each.label for each in key_completions(["[arcs]", "no_center = "], 1, 12, Kind.DIALECT)]
    assert values == ['"line"', '"error"']
    inside = [*shipped_text("din").split("\n")[:110], ""]
    assert inside[108 - 1].endswith("'''")
    assert {"X", "SEQUENCE_NUMBER"} <= {each.label for each in key_completions(inside, 110, 0, Kind.CONTROL)}


def test_a_symbol_of_a_control_file_is_given_by_its_table_and_keeps_its_name() -> None:
    text = "[function_variables]\nX = { format = 'X%.3f' }\n[nc_macros]\nRAPID = '''\nX\n'''\n"
    names = control_names(text.split("\n"))
    found = name_at(names, 4, 0)
    assert found is not None
    assert [each.span.line for each in givers(names, found)] == [1]
    with pytest.raises(UsageError, match="what tool paths say"):
        check_renaming(names, found, CONTROL)
    outline = table_outline(text.split("\n"))
    assert [(each.name, each.line, each.last) for each in outline] == [
        ("function_variables", 0, 1),
        ("nc_macros", 2, 6),
    ]


def test_a_stand_alone_program_is_checked_explained_and_renamed() -> None:
    wrong = FEED.replace("I := 3", "I := ")
    said = [each.what for each in sap.check(wrong, "feed.sap")[1]]
    assert said
    found = findings(Document(wrong), "feed.sap")
    assert [each.text.split("\n")[0] for each in found] == said
    lines = FEED.split("\n")
    about = sap_hover(lines, 5, 3)
    assert about is not None
    assert about[0].startswith("**js**: command of the board")
    assert sap_hover(lines, 5, 0) is None
    offered = {each.label for each in sap_completions(FEED)}
    assert {"js", "procedure", "go", "i"} <= offered
    assert [(each.name, each.line) for each in sap_outline(FEED, len(lines))] == [("PROCEDURE Go", 2)]
    names = sap_names(FEED)
    variable = name_at(names, 4, 2)
    assert variable is not None
    assert [(each.span.line, each.role) for each in same(names, variable)] == [
        (1, Role.GIVEN),
        (4, Role.USED),
    ]
    assert len(renamed(names, lines, variable, "count", STAND_ALONE)) == 2
    for new in ("js", "begin", "go", "3x", "a b"):
        with pytest.raises(UsageError):
            renamed(names, lines, variable, new, STAND_ALONE)


def test_functions_of_the_languages_are_completed_with_what_they_do() -> None:
    macro = {each.label: each.detail for each in completions(["#1=[SI"], 0, 6, FANUC)}
    assert macro["SIN"]
    assert "MOD" in macro
    assert "SQRT" in {each.label for each in completions(["G1 X[S"], 0, 6, LINUXCNC)}
    assert "_feed" in {each.label for each in completions(["#1=#<_f"], 0, 7, LINUXCNC)}
    cpl = {each.label: each.detail for each in completions(["20 A%=M"], 0, 7, BOSCH)}
    assert cpl["MID$"].startswith("MID$(")
    assert "REPEAT" in cpl
    assert completions(["(S"], 0, 2, FANUC) == []


HOSTILE = [
    "G1 X" + "9" * 100_000,
    "(" * 50_000,
    "G1 X1 " * 300_000,
    "\0\0G1\0 X3\0\n\0",
    "G1 X\ud800 (\udfff\ud83d)\nN\ud8001",
    "\ufeffG777\n",
    "[" * 5_000 + "\n",
    "#1=" + "[" * 5_000 + "\n",
    "10 A%=" + "(" * 5_000 + "\n",
    "a.b." * 5_000 + " = 1\n[axis",
    '[[axis]]\nname = """x\n',
    "[path]\n\"\\uD800\" = '''\n",
    "{" * 5_000,
    "O<" * 5_000,
    "\r\r\n\n\r",
]


@pytest.mark.parametrize("name", ["part.nc", "part.ngc", "part.cpl", "feed.sap", "shop.toml"])
def test_no_text_is_too_strange(name: str, tmp_path: Path) -> None:
    for text in HOSTILE:
        document = Document(text)
        for each in findings(document, str(tmp_path / name)):
            assert 0 <= each.span.line < len(document.lines)
            assert each.text
        assert kind_of(name, text) is not None


def test_positions_count_units_of_utf_16_whatever_stands_in_a_line() -> None:
    for line in ("G1 X3", "(\u00e4)X", "\U0001f600X", "\ud83dX\ude00", "\ud800", ""):
        for count in range(len(line) + 1):
            assert characters(line, units(line[:count])) == count
        assert characters(line, 99) == len(line)
    assert characters("a\U0001f600b", 2) == 1  # in the middle of the face
    document = Document("\U0001f600G1\rX3\r\nY7")
    assert document.changed((0, 2), (2, 1), "Z").text == "\U0001f600Z7"
    assert document.changed((9, 9), (9, 9), "!").text == document.text + "!"
    assert document.changed((1, 5), (0, 99), "").text == "\U0001f600G1\r\nY7"
    assert [document.place(document.offset(row, 1)) for row in (1, 2)] == [(1, 1), (2, 1)]
