"""The fenced blocks of documentation pages: what they are, and running them as a reader would.

A block with a title (``nc title="part.nc"``) is a file. ``console`` blocks hold commands after ``$`` and
what they print, where ``...`` stands for anything. ``text title="output"`` is what the Python block before it
prints. A page runs in one process of its own (`page_driver`), in a folder of its own.
"""

from __future__ import annotations

import json
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from support.command import COMMAND, script

REPOSITORY = Path(__file__).resolve().parents[2]
PAGES = sorted([*REPOSITORY.glob("*.md"), *REPOSITORY.glob("docs/**/*.md")])

_DRIVER = Path(__file__).with_name("page_driver.py")
_FENCE = re.compile(r'^```(\w+)(?: title="([^"]*)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)
_SAVE = re.compile(r"[Ss]ave this\s+as\s+`([^`]+)`")
_COMMAND = re.compile(r"^\$ (.*)\n((?:(?!\$ ).*\n)*)", re.MULTILINE)
_NOT_RUN = ("scripts/", "pip ", "git ", "mkdocs ")  # they change the checkout or need the network
_OUTPUT = "output"
PYTEST = (
    "env",
    "-u",
    "POLYCNC_COMPILE_AT_ONCE",
    "PYTEST_DISABLE_PLUGIN_AUTOLOAD=1",
    sys.executable,
    "-m",
    "pytest",
    "-p",
    "polycnc.testing",
)


@dataclass(frozen=True)
class Fence:
    """A fenced block: its language, title, text and the line of the page it begins at."""

    language: str
    title: str
    text: str
    line: int


@dataclass(frozen=True)
class Step:
    """Something a reader does: save a file, run a command or a piece of Python; and what is shown of it."""

    kind: str  # "file", "polycnc", "shell" or "python"
    what: str
    text: str
    shown: str
    where: str


def fences(page: Path) -> list[Fence]:
    """Return the fenced blocks of a page; the prose may name the file too ("Save this as `shop.toml`")."""
    text = page.read_text(encoding="utf-8")
    found = []
    end = 0
    for match in _FENCE.finditer(text):
        named = _SAVE.search(text, end, match.start())
        title = match[2] or (named[1] if named else "")
        found.append(Fence(match[1], title, match[3], text.count("\n", 0, match.start()) + 1))
        end = match.end()
    return found


def steps(page: Path) -> list[Step]:
    """Return what a reader of a page does, in order."""
    found = []
    blocks = fences(page)
    for index, fence in enumerate(blocks):
        following = blocks[index + 1] if index + 1 < len(blocks) else None
        where = f"{page.relative_to(REPOSITORY)}:{fence.line}"
        if fence.title and fence.language != "text":
            found.append(Step("file", fence.title, fence.text, "", where))
        if fence.language == "console":
            found += _commands(fence.text, where)
        elif fence.language == "python" and not _is_test(fence):
            shown = following.text if following is not None and following.title == _OUTPUT else ""
            found.append(Step("python", where, fence.text, shown, where))
    return found


def _is_test(fence: Fence) -> bool:
    """Return whether a block is a test, or shows how to write one."""
    return "@pytest" in fence.text or fence.title.startswith("test_")


def _commands(text: str, where: str) -> list[Step]:
    found = []
    for command, shown in _COMMAND.findall(text):
        if command.startswith(_NOT_RUN):
            continue
        words = command.partition(" #")[0].split()
        assert words[0] in ("polycnc", "pytest", "head", "cat"), (
            f"{where}: nobody said how to run '{command}'"
        )
        kind = "polycnc" if words[0] == "polycnc" else "shell"
        found.append(Step(kind, " ".join(words), "", shown, f"{where}: {command}"))
    return found


def run_page(page: Path, folder: Path) -> None:
    """Do in `folder` what a reader of the page does, and hold what is printed against what is shown."""
    tools = folder / ".bin"
    tools.mkdir()
    for name, words in {"polycnc": COMMAND, "pytest": PYTEST}.items():
        command = tools / name
        command.write_text(f'#!/bin/sh\nexec {" ".join(words)} "$@"\n', encoding="utf-8")
        command.chmod(0o755)
    todo = steps(page)
    given = json.dumps([(step.kind, step.what, step.text) for step in todo])
    done = script(_DRIVER, given, folder, PATH=f"{tools.resolve()}:{os.environ.get('PATH', '')}")
    assert done.returncode == 0, f"{page}\n{done.stdout}\n{done.stderr}"
    for step, (status, printed) in zip(todo, json.loads(done.stdout), strict=True):
        # A command that is to fail shows what it prints.
        assert status == 0 or (status == 1 and step.shown), f"{step.where}: exit status {status}\n{printed}"
        if step.shown:
            assert_like(printed, step.shown, step.where)


def assert_like(output: str, shown: str, where: str) -> None:
    """Hold output against what a page shows: blanks count as one, `...` stands for anything."""
    squeezed = "\n".join(" ".join(line.split()) for line in output.splitlines()).strip()
    wanted = "\n".join(" ".join(line.split()) for line in shown.splitlines()).strip()
    pattern = re.escape(wanted).replace(r"\.\.\.", "[\\s\\S]*")
    assert re.fullmatch(pattern, squeezed), f"{where} shows\n{wanted}\nbut it prints\n{squeezed}"
