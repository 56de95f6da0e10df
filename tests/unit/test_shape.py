"""The shape of the code: how long its pieces are, how many ways lead through one, how far a call goes through files."""

from __future__ import annotations

import ast
import os
import sys
from collections.abc import Callable, Iterator
from functools import partial
from itertools import groupby
from pathlib import Path
from types import FrameType
from typing import NamedTuple

import pytest

from polycnc.cnc import Control, Mode
from polycnc.jit._plain import Entry
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ProgramText, load_dialect

PACKAGE = Path(__file__).resolve().parents[2] / "src" / "polycnc"
MODULE_LINES, CLASS_LINES, FUNCTION_LINES, BRANCHES = 500, 300, 60, 20
_BRANCHES = (ast.If, ast.For, ast.While, ast.ExceptHandler, ast.IfExp, ast.comprehension, ast.Assert)
_Function = ast.FunctionDef | ast.AsyncFunctionDef


class Large(NamedTuple):
    """What is larger than it should be: `place` is a file, or file and name."""

    place: str
    what: str


EXCEPTIONS: dict[str, tuple[str, ...]] = {
    "compiled code: a call for each word, segment or cycle costs more than it explains": (
        "kernel/_blend_arcs.py _round",
        "kernel/_limits.py",
        "kernel/_limits.py limit_junction",
        "kernel/_limits.py _junction_by_share",
        "kernel/_limits.py _give_way",
        "kernel/_profile.py plan_profile",
        "nc/fast/_plain_blocks.py _run",
        "nc/text/_scan.py",
        "nc/text/_scan.py _scan_easy_blocks",
        "nc/text/_scan.py _scan_block",
        "runner/comparison/_distance.py farthest",
        "runner/comparison/_distance.py in_one_order",
    ),
    "one course of motion, in which each record changes what the next one means": (
        "post/macros/_rows.py write_rows",
        "post/output/_motion.py Motion",
        "post/output/_program.py",
        "post/output/_program.py _Driver",
    ),
    "one branch for each word of a format of tool paths": (
        "post/tool_path/_cl_cycles.py read_cycle",
        "post/tool_path/_cl_reader.py read_cl",
        "post/tool_path/_cl_words.py",
    ),
}
"""What is larger, by the reason why: a file, or file and name. It only shrinks."""


def ways(function: ast.AST) -> int:
    """Return the number of ways through a function (McCabe's), functions within it included."""
    count = 1
    for node in ast.walk(function):
        if isinstance(node, _BRANCHES):
            count += 1
        elif isinstance(node, ast.BoolOp):
            count += len(node.values) - 1
        elif isinstance(node, ast.match_case):
            count += 1
    return count


def lines(node: ast.ClassDef | _Function) -> int:
    """Return the number of lines of a class or function; those of a function's docstring do not count."""
    count = (node.end_lineno or 0) - node.lineno + 1
    if not isinstance(node, ast.ClassDef) and ast.get_docstring(node) is not None:
        count -= (node.body[0].end_lineno or 0) - node.body[0].lineno + 1
    return count


def named(tree: ast.AST, within: str = "") -> Iterator[tuple[str, ast.ClassDef | _Function]]:
    """Yield classes and functions by their qualified names; functions within functions belong to these."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef | _Function):
            yield within + node.name, node
        if isinstance(node, ast.ClassDef):
            yield from named(node, f"{within}{node.name}.")
        elif not isinstance(node, _Function):
            yield from named(node, within)


def large_in(name: str, text: str) -> Iterator[Large]:
    """Yield what is too large in a module."""
    if text.count("\n") > MODULE_LINES:
        yield Large(name, f"{text.count(chr(10))} lines")
    for qualified, node in named(ast.parse(text)):
        most = CLASS_LINES if isinstance(node, ast.ClassDef) else FUNCTION_LINES
        if lines(node) > most:
            yield Large(f"{name} {qualified}", f"{lines(node)} lines")
        if not isinstance(node, ast.ClassDef) and ways(node) > BRANCHES:
            yield Large(f"{name} {qualified}", f"{ways(node)} ways")


def all_large() -> list[Large]:
    """Return what is too large in the package."""
    return [
        large
        for path in sorted(PACKAGE.rglob("*.py"))
        for large in large_in(path.relative_to(PACKAGE).as_posix(), path.read_text("utf-8"))
    ]


@pytest.fixture(scope="module")
def found() -> list[Large]:
    """What is too large now."""
    return all_large()


def test_nothing_is_too_large_without_a_reason(found: list[Large]) -> None:
    known = {place for places in EXCEPTIONS.values() for place in places}
    assert [large for large in found if large.place not in known] == [], "split it, or say why it cannot be"


def test_an_exception_that_is_no_longer_needed_goes(found: list[Large]) -> None:
    known = {place for places in EXCEPTIONS.values() for place in places}
    assert known - {large.place for large in found} == set(), (
        "these are small enough: take them out of the table"
    )


def test_what_is_measured() -> None:
    text = (
        "class A:\n"
        "    def f(self, a):\n"
        '        """Say something.\n\n        Raises:\n            E: sometimes.\n        """\n'
        "        return [b or 7 for b in a if b] if a and a[3] else None\n"
        "    def g(self, a):\n"
        "        match a:\n"
        "            case 3:\n"
        "                return 4\n"
        "            case _:\n"
        "                def h(b):\n"
        "                    return b if b else 8\n"
        "                return h\n"
    )
    (_, whole), (_, f), (_, g) = named(ast.parse(text))
    assert (lines(whole), lines(f), lines(g)) == (16, 2, 8)
    assert (ways(f), ways(g)) == (5, 4)


def test_large_modules_classes_and_functions_are_found() -> None:
    body = "        x = 1\n"
    fits = "class A:\n    def f(self):\n" + body * 59
    assert list(large_in("a.py", fits)) == []
    assert list(large_in("a.py", fits + body)) == [Large("a.py A.f", "61 lines")]
    many = "class A:\n" + "".join(f"    def f{n}(self):\n{body * 29}" for n in range(10))
    assert [large.place for large in large_in("a.py", many + "    y = 2\n")] == ["a.py A"]
    branches = "def f(a):\n" + "".join(f"    if a == {n}:\n        return {n}\n" for n in range(19))
    assert list(large_in("a.py", branches)) == []
    assert list(large_in("a.py", branches + "    return a or 5\n")) == [Large("a.py f", "21 ways")]
    assert list(large_in("a.py", "x = 1\n" * 501)) == [Large("a.py", "501 lines")]


# ---------------------------------------------------------------------- the way of one call


def way(call: Callable[[], object]) -> tuple[int, int, int]:
    """Return how many files a call enters, how often it changes the file, and how often it comes back to one."""
    visits: list[str] = []
    root = f"{PACKAGE}{os.sep}"

    def counts(frame: FrameType) -> bool:
        return frame.f_code.co_filename.startswith(root)

    def look(frame: FrameType | None, event: str, _: object) -> None:
        if event == "return" and frame is not None and counts(frame):
            frame = frame.f_back
            while frame is not None and not counts(frame):
                frame = frame.f_back
        elif event != "call":
            return
        if frame is not None and counts(frame):
            visits.append(frame.f_code.co_filename)

    before = sys.getprofile()
    sys.setprofile(look)
    try:
        call()
    finally:
        sys.setprofile(before)
    stops = [name for name, _ in groupby(visits)]
    return len(set(stops)), len(stops) - 1, len(stops) - len(set(stops))


def of_a_block(text: str) -> Callable[[], object]:
    """Return what prepares one block after a short program."""
    lines = ("G21 G90 G94 G54", "G1 X10 F600", text, "M30")
    program = ProgramText.from_text("\n".join(lines) + "\n")
    channel = Channel(program, load_dialect("fanuc"), Machine(load_machine("mill3")))
    channel.fill(2)
    return lambda: channel.fill(1)


def of_a_status() -> Callable[[], object]:
    """Return what reads the status of a control in the midst of a program."""
    control = Control("mill3", dialect="fanuc")
    control.select_program(ProgramText.from_text("G21 G90 G94\nG1 X100 F600\nG1 X200\nM30\n", "a.nc"))
    control.select_mode(Mode.AUTO)
    control.cycle_start()
    control.advance(100)
    return control.status


WAYS = [
    pytest.param(partial(of_a_block, "G1 X20 F500"), (16, 60, 45), id="a plain block"),
    pytest.param(of_a_status, (10, 50, 40), id="a status"),
]


@pytest.mark.parametrize(("made", "most"), WAYS)
def test_the_way_of_a_call_is_short(
    made: Callable[[], Callable[[], object]], most: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    # As where nothing has been compiled: the kernel is Python too.
    monkeypatch.setattr(Entry, "__call__", lambda self, *given: self.plainly(self._values(given, {})))
    made()()
    found = way(made())
    assert all(count <= limit for count, limit in zip(found, most, strict=True)), found
