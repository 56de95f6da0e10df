"""What the guides for those who extend polycnc say is all that it takes: done in a copy."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import polycnc
from support.pages import REPOSITORY, fences

_PREPARES = """
import json, sys
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ProgramText, load_dialect
found = []
for text in sys.argv[2:]:
    channel = Channel(ProgramText.from_text(text), load_dialect(sys.argv[1]), Machine(load_machine("mill3")))
    channel.fill()
    seg, tail = channel.machine.state.seg, int(channel.machine.state.paths.row[0]["tail"])
    found.append([seg.end[:tail].tolist(), str(channel.error or "")])
print(json.dumps(found))
"""


def _prepared(source: Path, dialect: Path, *programs: str) -> list[tuple[list[list[float]], str]]:
    """Return the end points of the moves, and the error, of programs prepared by a copy of the package."""
    run = subprocess.run(
        [sys.executable, "-c", _PREPARES, str(dialect), *programs],
        env={**os.environ, "PYTHONPATH": str(source)},
        capture_output=True,
        text=True,
        check=True,
    )
    return [(ends, error) for ends, error in json.loads(run.stdout)]


def test_a_g_code_is_one_row_and_one_function(tmp_path: Path) -> None:
    package = tmp_path / "polycnc"
    shutil.copytree(
        Path(polycnc.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__", "front")
    )
    row, function, dialect = (
        each for each in fences(REPOSITORY / "docs" / "how-to" / "add-a-g-code.md") if each.title
    )
    actions, module, own = package / row.title, package / function.title, tmp_path / dialect.title
    mark = "    # fmt: on\n"
    text = actions.read_text(encoding="utf-8")
    assert text.count(mark) == 1
    actions.write_text(text.replace(mark, row.text + mark), encoding="utf-8")
    with module.open("a", encoding="utf-8") as file:
        file.write(f"\n\n{function.text}")
    own.write_text(dialect.text, encoding="utf-8")

    (ends, error), (_, refused), (_, unused) = _prepared(
        tmp_path,
        own,
        "G90 G0 X3 Y4 Z5\nG31.7 X23 Y14 Z2 R17\n",
        "G31.7 X23\n",
        "G31.7 X23 R17 Q3\n",
    )
    assert error == ""
    assert ends == [[3, 4, 5], [3, 4, 17], [23, 14, 17], [23, 14, 2]]
    assert "1:1" in refused
    assert "G31.7 without a level" in refused
    assert "Add R." in refused
    assert "'Q' has no meaning in this block" in unused
