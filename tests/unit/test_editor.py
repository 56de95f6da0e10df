"""What an editor shows of a text: findings with their range, what codes do, completion, the outline."""

from __future__ import annotations

import asyncio
import builtins
import threading
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest

from polycnc import runner
from polycnc.cli._lsp import lsp_command
from polycnc.editor import completions, findings, hover, outline, serve_editor
from polycnc.editor._document import Document
from polycnc.editor._newest import GoOn, Newest
from polycnc.errors import UsageError
from polycnc.nc import DIALECTS, ProgramText, load_dialect

DIN, FANUC, LINUXCNC, BOSCH = map(load_dialect, ("din", "fanuc", "linuxcnc", "bosch"))
WRONG = "T1 M6\nS900 M3\n  G1 X10\nG1 X25.5 F300\nG0 X3 G777\n"


def test_an_error_has_the_range_of_its_word_and_its_hint(tmp_path: Path) -> None:
    found = findings(Document(WRONG), str(tmp_path / "part.nc"))
    feed = next(each for each in found if "without a feed" in each.text)
    assert (feed.span.line, feed.span.begin, feed.span.end) == (2, 2, 4)
    assert feed.is_error
    assert feed.text.splitlines()[-1] == "Program F in this or an earlier block."
    code = next(each for each in found if "777" in each.text)
    assert (code.span.line, WRONG.splitlines()[4][code.span.begin : code.span.end]) == (4, "G777")


@pytest.mark.parametrize(
    "text",
    [
        WRONG,
        "",
        "\n\n",
        "G1 X7 F30\r\nG777\rG1 Y3\n",
        "G1 X (open\n",
        "BEGIN PGM 7 MM\n",
        "10 A%=\nG1 X2 F5\n",
        "10 IF A%=3 THEN\nN5 G1 X7 F90\n",
        "O7\nM98 P4321\nM30\n",
        "(\u00e4\U0001f600) G999 \u2028 X3\n",
        "#1=[3/0]\nG1 X#1 F2\nM30\n",
    ],
)
def test_it_says_what_check_says_within_the_text(text: str, tmp_path: Path) -> None:
    name = str(tmp_path / "part.nc")
    report = runner.inspect(ProgramText.from_text(text, name), root=tmp_path)
    found = findings(Document(text), name)
    said = [each.what for each in report.errors] + [each.text for each in report.remarks]
    assert len(found) == len(said)
    assert all(what in each.text for each, what in zip(found, said, strict=True))
    places = [each.position for each in report.errors] + [each.position for each in report.remarks]
    assert [each.span.line for each in found] == [at.line - 1 if at else 0 for at in places]
    assert all(each.span.begin < each.span.end for each in found)


def test_an_error_in_another_file_is_told_in_the_first_line_with_its_place(tmp_path: Path) -> None:
    (tmp_path / "SUB7").write_text("N1 G1 X5 F100\n20 B%=(3\nM30\n")
    found = findings(Document("N1 G1 X7 F90\n30 CALL SUB7\nN9 M30\n"), str(tmp_path / "MAIN"), dialect=BOSCH)
    elsewhere = [each for each in found if "SUB7:2:" in each.text]
    assert elsewhere
    assert {each.span.line for each in elsewhere} == {0}


def test_every_code_of_every_dialect_tells_its_sentence_and_group() -> None:
    for name in DIALECTS:
        dialect = load_dialect(name)
        for code, action in dialect.g_codes().items():
            found = hover([f"N7 G{code:g} X3"], 0, 4, dialect)
            assert found is not None
            rounds = code != 1 or dialect.corner_words
            assert (action.sentence if rounds else "Straight at feed  \n") in found[0]
            assert ("rounds or chamfers" in found[0]) == (code == 1 and rounds)
            assert f"Group: {action.group}" in found[0]
            assert f"({name})" in found[0]
        for m in dialect.m:
            found = hover([f"M{m}"], 0, 0, dialect)
            assert found is not None
            assert dialect.m[m].replace("_", " ") in found[0]


@pytest.mark.parametrize(
    ("line", "character"),
    [
        ("(G1) X3", 1),
        ("X3 ; G2", 6),
        ("G1 X3", 2),
        ("G1 X3", 5),
        ("G1 X3", 99),
        ("10 G1%=3", 3),
        ("#<g2> = 7", 2),
    ],
)
def test_where_no_code_stands_nothing_is_told(line: str, character: int) -> None:
    dialect = {"1": BOSCH, "#": LINUXCNC}.get(line[0], DIN)
    assert hover([line], 0, character, dialect) is None
    assert hover([line], 3, character, dialect) is None


def test_a_code_that_the_dialect_does_not_know_is_told_so() -> None:
    found = hover(["X3 g777"], 0, 5, FANUC)
    assert found is not None
    assert found[0] == "**G777**: no G code of dialect fanuc"
    assert (found[1].begin, found[1].end) == (3, 7)


def test_a_dwell_names_its_addresses_and_their_units() -> None:
    found = hover(["g04 p3"], 0, 0, FANUC)
    assert found is not None
    assert all(f"{address} ({unit})" in found[0] for address, unit in FANUC.dwell.items())


def test_a_begun_letter_is_completed_by_the_codes_of_the_dialect() -> None:
    offered = {each.label for each in completions(["N5 G"], 0, 4, DIN)}
    assert offered == {f"G{code:g}" for code in DIN.g_codes()}
    assert {f"M{int(code)}" for code in DIN.m} == {
        each.label for each in completions(["X3", "m3"], 1, 2, DIN)
    }
    assert completions(["X7"], 0, 2, DIN) == []
    assert completions(["(G"], 0, 2, DIN) == []


def test_the_outline_has_programs_and_their_tool_changes() -> None:
    text = "%\nO1234 (FLANGE)\nT7 M6 (MILL 12)\nG0 X3\n(M6 T9)\nT8 M06\nM30\nO77\nG1 X3\nM99\n%\n"
    main, sub = outline(text.splitlines(), FANUC)
    assert (main.name, main.detail, main.is_program, main.line, main.last) == ("O1234", "FLANGE", True, 1, 6)
    assert [(each.name, each.detail, each.line, each.last) for each in main.children] == [
        ("T7", "MILL 12", 2, 4),
        ("T8", "", 5, 6),
    ]
    assert (sub.name, sub.line, sub.children) == ("O77", 7, ())


def test_a_text_without_program_numbers_has_its_tool_changes_alone() -> None:
    assert outline([""], DIN) == []
    assert [(each.name, each.line, each.last) for each in outline(["X3", "T4 M6", "X7", "T5 M6"], DIN)] == [
        ("T4", 1, 2),
        ("T5", 3, 3),
    ]


def test_the_outline_of_linuxcnc_has_named_sub_programs() -> None:
    found = outline(["T3 M6", "o<hole> sub", "G0 Z3", "o<hole> endsub", "o<hole> call", "M2", ""], LINUXCNC)
    assert [(each.name, each.is_program) for each in found] == [("T3", False), ("O<hole>", True)]


def test_the_last_text_wins_and_those_between_are_not_looked_at() -> None:
    async def scene() -> None:
        newest, held = Newest(), threading.Event()
        done: list[int] = []

        def work(number: int, go_on: GoOn) -> int:
            if number == 3:
                held.wait(20.0)
            go_on()
            done.append(number)
            return number

        first = asyncio.create_task(newest.run("part.nc", partial(work, 3)))
        await asyncio.sleep(0)
        others = [asyncio.create_task(newest.run("part.nc", partial(work, number))) for number in (4, 5)]
        await asyncio.sleep(0)
        held.set()
        assert await asyncio.gather(first, *others) == [None, None, 5]
        assert done == [5]

    asyncio.run(scene())


def test_without_pygls_it_is_said_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    imported = builtins.__import__

    def without(name: str, *more: Any) -> Any:
        if name == "polycnc.editor._shell":
            raise ModuleNotFoundError("No module named 'pygls'", name="pygls.lsp.server")
        return imported(name, *more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(UsageError, match="needs pygls") as said:
        serve_editor()
    assert said.value.hint == "Install it: pip install 'polycnc[editor]'."


def test_an_editor_that_leaves_without_a_word_is_out_of_order(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pygls", reason="pip install 'polycnc[editor]'")
    from polycnc.editor._shell import editor_server

    server = editor_server(None, None)
    server.start_io(BytesIO(), BytesIO())
    assert not server.was_shut_down
    monkeypatch.setattr("polycnc.editor.serve_editor", lambda *_: server.was_shut_down)
    with pytest.raises(SystemExit) as left:
        lsp_command()
    assert left.value.code == 1
