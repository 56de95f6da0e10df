"""`polycnc lsp` as editors start it: a process of its own, spoken to by the Language Server Protocol."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from support.editor_client import Editor, span

pytest.importorskip("pygls", reason="pip install 'polycnc[editor]'")

WRONG = "T1 M6\nS900 M3\n(\U0001f600) G1 X10\nG1 X25.5 F300\nM30\n"


@pytest.fixture(scope="module")
def editor(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Editor]:
    with Editor(cwd=tmp_path_factory.mktemp("editor")) as editor:
        begun = editor.begin()
        assert begun["serverInfo"]["name"] == "polycnc"
        assert begun["capabilities"]["textDocumentSync"]["change"] == 2
        yield editor
        assert editor.end() == (0, "")


def test_an_editor_sees_an_error_mends_it_and_asks_what_a_code_does(editor: Editor, tmp_path: Path) -> None:
    uri = (tmp_path / "part.nc").as_uri()
    told = editor.open(uri, WRONG)
    error = next(each for each in told if "without a feed" in each["message"])
    assert error["range"] == span(2, 5, 7)  # the face counts two units in the protocol
    assert error["severity"] == 1
    assert error["message"].endswith("Program F in this or an earlier block.")

    editor.change(uri, {"range": span(2, 11, 11), "text": " F200"})
    assert editor.diagnostics(uri) == []
    about = editor.ask_at("textDocument/hover", uri, 2, 6)
    assert "Group: motion" in about["contents"]["value"]
    assert about["range"] == span(2, 5, 7)
    outline = editor.ask("textDocument/documentSymbol", {"textDocument": {"uri": uri}})
    assert [each["name"] for each in outline] == ["T1"]


def test_changes_within_a_text_act_at_their_utf_16_places(editor: Editor, tmp_path: Path) -> None:
    uri = (tmp_path / "part.nc").as_uri()
    # Neither a form feed nor U+2028 ends a line in the protocol; a carriage return alone does.
    editor.open(uri, "(\u2028\x0c\U0001f600) G1 X3 F70\rG1 X5\r\nG1 Z7\nM30\n")
    editor.change(
        uri,
        {"range": span(0, 7, 9), "text": "G777"},
        {"range": {"start": {"line": 1, "character": 5}, "end": {"line": 2, "character": 4}}, "text": " Y"},
        {"range": span(1, 99, 99), "text": " G778"},
    )
    told = editor.diagnostics(uri)
    found = {each["message"].partition("\n")[0]: each["range"] for each in told if "77" in each["message"]}
    assert sorted(found.values(), key=str) == sorted([span(0, 7, 11), span(1, 9, 13)], key=str), told
    editor.notify("textDocument/didClose", {"textDocument": {"uri": uri}})


PART = (
    "O1234\nT1 M6\nS900 M3\n(POCKET)\nG1 X10 F600\nG91 X5 F100 M8\nG90\nM98 P77 L3\nG20 T4 M6\nG1 X2.5 F90\nM30\n"
    "O77\nG1 Y3\nG1 Y0\nM99\n"
)


def test_a_word_tells_what_holds_before_its_line_and_how_long_that_takes(
    editor: Editor, tmp_path: Path
) -> None:
    uri = (tmp_path / "part.nc").as_uri()
    editor.open(uri, PART)
    outline = editor.ask("textDocument/documentSymbol", {"textDocument": {"uri": uri}})
    assert [each["name"] for each in outline] == ["O1234", "O77"]
    operations = outline[0]["children"]
    assert [each["name"] for each in operations] == ["T1", "POCKET", "T4"]
    assert "cuts" in operations[1]["detail"]

    def told(line: int, character: int) -> str:
        text: str = editor.ask_at("textDocument/hover", uri, line, character)["contents"]["value"]
        return text

    code = told(5, 1)
    assert "Axis words are ways" in code
    assert "tool T1; F600 mm/min; S900 rpm, clockwise" in code
    assert "at X10 " in code
    assert "This line takes 3." in code
    assert "Feed, inch/min" in told(9, 8)
    assert "Axis X, position in inch" in told(9, 4)
    assert "in 3 rounds" in told(12, 0)
    assert "Before this line" not in told(12, 0)  # the main program does not come to it


def test_names_are_found_changed_and_numbered_by_the_editor(editor: Editor, tmp_path: Path) -> None:
    uri, other = ((tmp_path / name).as_uri() for name in ("part.nc", "O0088.nc"))
    (tmp_path / "O0088.nc").write_text("O88\nM99\n")
    (tmp_path / "part.nc").write_text("")
    editor.open(uri, "(\U0001f600)#101=3\nN7G1X#101F90\nIF[#101GT5]GOTO 7\nM98 P88\nM30\n")
    [given] = editor.ask_at("textDocument/definition", uri, 1, 7)
    assert given == {"uri": uri, "range": span(0, 4, 8)}
    [beside] = editor.ask_at("textDocument/definition", uri, 3, 5)
    assert (beside["uri"], beside["range"]["start"]["line"]) == (other, 0)
    places = editor.ask_at("textDocument/references", uri, 2, 5, context={"includeDeclaration": False})
    assert [each["range"] for each in places] == [span(1, 5, 9), span(2, 3, 7)]
    assert editor.ask_at("textDocument/prepareRename", uri, 0, 5) == span(0, 4, 8)
    edit = editor.ask_at("textDocument/rename", uri, 0, 5, newName="#150")
    assert {each["newText"] for each in edit["changes"][uri]} == {"#150"}
    assert len(edit["changes"][uri]) == 3
    refused = editor.refused("textDocument/rename", uri, 0, 5, newName="#5001")
    assert refused == "#5001 is in use already\nChoose another name."
    options = {"tabSize": 4, "insertSpaces": True}
    edits = editor.ask("textDocument/formatting", {"textDocument": {"uri": uri}, "options": options})
    assert [each["newText"] for each in edits] == ["N10G1X#101F90", "IF[#101GT5]GOTO 10"]
