"""What programs of CPL's language do on a living control, written down in `tests/golden/cpl_a/NAME.txt`.

A file holds the programs and what comes of them: variables, errors with their places and numbers, messages, files,
screen, ends of motions. What is there has been read against Manual 003; after a wanted change: `--update-goldens`, and
read the difference. A file claims the rows of all words that its programs use, and those that it names.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from support.cpl_rows import rows_of
from support.cpl_scenes_a import Bench
from support.cpl_scenes_a_text import rewritten

RECORDED = Path(__file__).resolve().parents[1] / "golden" / "cpl_a"


def claimed(path: Path) -> list[str]:
    """Return the rows that a file shows."""
    text = path.read_text(encoding="utf-8")
    programs = re.sub(r"(?m)^(->|#[ \n]|rows:).*|=> .*", "", text)
    named = [row for line in re.findall(r"(?m)^rows: (.*)", text) for row in line.split()]
    return list(dict.fromkeys([*(f"cpl.{row}" for row in named), *rows_of(programs)]))


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=pytest.mark.covers(*claimed(path)))
        for path in sorted(RECORDED.glob("*.txt"))
    ],
)
def test_a_program_does_what_is_written_down(
    path: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    bench = Bench(tmp_path)
    text = path.read_text(encoding="utf-8")
    found = rewritten(text, bench)
    bench.close()
    if request.config.getoption("update_goldens"):
        path.write_text(found, encoding="utf-8")
    assert found.split("\n") == path.read_text(encoding="utf-8").split("\n")
