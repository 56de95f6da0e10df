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
