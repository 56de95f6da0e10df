"""What the pages for those who change polycnc name in code marks exists: files, folders, names."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from support.pages import PAGES, REPOSITORY

PACKAGE = REPOSITORY / "src" / "polycnc"
FOLDERS = (REPOSITORY, PACKAGE, PACKAGE / "controllers")
_FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
_MARKED = re.compile(r"`([^`\n]+)`")
_PATH = re.compile(r"[\w.-]+(?:/[\w.-]+)+/?")
_FILE = re.compile(r"(\w+)\.(?:py|h)")
_NAME = re.compile(r"(?:\w+\.)*(_\w+|[A-Z][a-z]+[A-Z]\w*|[a-z]+(?:_[a-z0-9]+)+)(?:\(.*\))?")
INSIDE = [
    page
    for page in PAGES
    if page.relative_to(REPOSITORY).parts[:2] in (("docs", "explanation"), ("docs", "how-to"))
    or page.name == "CONTRIBUTING.md"
]


def named(text: str) -> Iterator[tuple[str, bool]]:
    """Yield what the prose of a page has in code marks that is a path (True) or a name of code."""
    for marked in _MARKED.findall(_FENCE.sub("", text)):
        if _PATH.fullmatch(marked) and (marked.endswith(".py") or exists(marked.partition("/")[0])):
            yield marked, True
        elif found := _FILE.fullmatch(marked) or _NAME.fullmatch(marked):
            yield found[1], False


@cache
def words() -> frozenset[str]:
    """Return all words of the package, its tests and its scripts."""
    found: set[str] = set()
    for folder in ("src", "tests", "scripts", "benchmarks", "pyproject.toml"):
        root = REPOSITORY / folder
        for file in [root] if root.is_file() else root.rglob("*"):
            if file.suffix in ("", ".py", ".toml", ".h", ".pyi", ".js") and file.is_file():
                found.update(re.findall(r"\w+", file.read_text("utf-8")))
                found.add(file.stem)
    return frozenset(found)


def exists(path: str) -> bool:
    """Tell whether a path is one of the repository, or within the package."""
    return any((folder / path).exists() for folder in FOLDERS)


@pytest.mark.parametrize("page", INSIDE, ids=lambda page: page.stem)
def test_what_a_page_names_exists(page: Path) -> None:
    marked = set(named(page.read_text("utf-8")))
    assert sorted(path for path, is_path in marked if is_path and not exists(path)) == []
    assert sorted(name for name, is_path in marked if not is_path and name not in words()) == []


def test_paths_and_names_are_told_apart() -> None:
    shown = "`nc/blocks/_steps.py`, `nc/cpl/`, `kernel/_path`, `_limits`, `Bound.get_all(3)` `plain` `X20`"
    text = shown + " `du/ds` `_scan.py`\n```\n`_no`\n```\n"
    assert list(named(text)) == [
        ("nc/blocks/_steps.py", True),
        ("nc/cpl/", True),
        ("kernel/_path", True),
        ("_limits", False),
        ("get_all", False),
        ("_scan", False),
    ]
    assert exists("nc/blocks/_steps.py")
    assert not exists("nc/blocks/_step.py")
    assert {"limit_junction", "_scan"} <= words()
    assert "limit_" + "junctions" not in words()
