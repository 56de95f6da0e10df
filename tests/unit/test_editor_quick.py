"""The first answer to a change of a long program: right in the changed lines, and with the rest as it was."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from polycnc.editor._document import Document
from polycnc.editor._findings import findings
from polycnc.editor._quick import Checked, quick_findings
from polycnc.nc import load_dialect

FANUC = load_dialect("fanuc")


def _part(moves: int) -> str:
    head = "O1234\nT1 M6\nS900 M3\nG1 X1 Y1 F500\n"
    body = (f"G1 X{0.37 * (n % 90):.3f} Y{0.53 * (n % 70):.3f}" for n in range(moves))
    return head + "\n".join(body) + "\nM5\nG1 X3\nG777\nM30\n"


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> tuple[Checked, str]:
    name = str(tmp_path_factory.mktemp("quick") / "part.nc")
    document = Document(_part(3000))
    return Checked(document, findings(document, name, None, FANUC)), name


@pytest.mark.parametrize(
    ("line", "new"),
    [
        (2500, "G778 X1"),
        (2500, "G2 X3 Y4 R0.001"),
        (1900, "X1.2.3\nG1 X7\nY5 (open"),
        (1900, "G1 X7 F"),
        (700, "(nothing)"),
        (3, "G1 X1 Y1"),  # without the feed all below it is wrong, which the whole check finds
    ],
)
def test_changed_lines_say_at_once_what_the_whole_check_says_of_them(
    checked: tuple[Checked, str], line: int, new: str
) -> None:
    before, name = checked
    length = len(before.document.lines[line])
    after = before.document.changed((line, 0), (line, length), new)
    count = new.count("\n") + 1
    said = quick_findings(before, after, name, None, FANUC)
    assert said is not None
    whole = findings(after, name, None, FANUC)

    inside = [each for each in said if line <= each.span.line < line + count]
    assert inside == [each for each in whole if each.is_error and line <= each.span.line < line + count]
    last = [each for each in said if each.span.line >= line + count]
    assert [each.text for each in last] == [each.text for each in before.found if each.span.line > line]
    if line > 3:
        assert [each for each in whole if "777" in each.text] == [each for each in last if "777" in each.text]


def test_a_short_or_quite_another_text_is_left_to_the_whole_check(checked: tuple[Checked, str]) -> None:
    before, name = checked
    assert quick_findings(before, Document("G1 X3\n"), name, None, FANUC) is None
    assert quick_findings(before, Document("G777\n" * 3000), name, None, FANUC) is None


@pytest.mark.long
def test_a_change_of_100_000_lines_is_answered_within_0_3_s_of_computing(tmp_path: Path) -> None:
    name = str(tmp_path / "part.nc")
    document = Document(_part(100_000))
    before = Checked(document, findings(document, name, None, FANUC))
    for line in (70_000, 99_000):
        begin = time.thread_time()
        after = before.document.changed((line, 0), (line, 2), "G778")
        said = quick_findings(before, after, name, None, FANUC)
        assert time.thread_time() - begin < 0.3
        assert said is not None
        assert any(each.span.line == line and "778" in each.text for each in said)
