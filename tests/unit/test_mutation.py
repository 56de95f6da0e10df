"""The script that changes modules: which changes it makes, and what it says of tests that notice them and do not."""

from __future__ import annotations

import gc
from pathlib import Path
from typing import Any

import pytest

from support.mutation import Reach, Session, candidate_tests, mutants_of
from support.mutation._exchange import exchange

MODULE = b'''"""A module."""

LARGEST = 7


def share(part: float, whole: float) -> tuple[float, bool]:
    """Return what `part` is of `whole`, and whether it is all of it."""
    if part < 0.25 and (whole > 3):
        part += 1
    return (part + 2.0) / -whole, part == LARGEST


def silent(values: list[int]) -> None:
    values.insert(2, max(3, 5))
'''
TESTS = """
from demo.thing import LARGEST, share


def test_share():
    assert LARGEST == 7
    assert share(6.0, -4.0) == (2.0, False)
    assert share(7.0, 3.0)[1]


def test_broken():
    assert share(6.0, -4.0) == (2.5, False)


def test_slow():
    while share(6.0, -4.0):
        pass
"""

# As if the package had a plugin for pytest, which imports those in its own way; and as our own suite does.
CONFTEST = """
import gc

import pytest

pytest.register_assert_rewrite("demo")


def pytest_collection_finish():
    gc.freeze()
"""


def test_every_kind_of_change_is_made_and_nothing_else_is_touched() -> None:
    assert [(each.kind, each.lines[0], each.new.decode()) for each in mutants_of(MODULE)] == [
        ("constant", 3, "8"),
        ("condition", 8, "not (part < 0.25 and (whole > 3))"),
        ("comparison", 8, "<="),
        ("constant", 8, "-0.75"),
        ("logic", 8, "or"),
        ("comparison", 8, ">="),
        ("constant", 8, "2"),
        ("dropped", 9, "pass"),
        ("constant", 9, "0"),
        ("return", 10, "part == LARGEST, (part + 2.0) / -whole"),
        ("arithmetic", 10, "-"),
        ("constant", 10, "3.0"),
        ("arithmetic", 10, "*"),
        ("sign", 10, "whole"),
        ("comparison", 10, "!="),
        ("dropped", 14, "pass"),
        ("constant", 14, "3"),
        ("arguments", 14, "max(3, 5), 2"),
        ("constant", 14, "2"),
        ("constant", 14, "6"),
    ]


def test_an_index_becomes_that_of_the_first() -> None:
    source = b"def f(rows, i, name):\n    return rows[i] + rows[i, 2][name]\n"
    found = [
        each.applied(source).decode().splitlines()[1] for each in mutants_of(source) if each.kind == "index"
    ]
    assert found == ["    return rows[0] + rows[i, 2][name]", "    return rows[i] + rows[0, 2][name]"]


def test_a_changed_module_still_is_one_and_differs_in_one_line() -> None:
    for each in mutants_of(MODULE):
        compile(each.applied(MODULE), "module.py", "exec")
        removed, added = each.diff(MODULE).splitlines()
        assert (removed[0], added[0]) == ("-", "+")


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """Return a small repository with a module and the test of it."""
    root = tmp_path / "demo"
    for name, text in (
        ("src/demo/__init__.py", ""),
        ("src/demo/thing.py", MODULE.decode()),
        ("tests/unit/test_thing.py", TESTS),
        ("tests/unit/test_other.py", "def test_other():\n    pass\n"),
        ("tests/conftest.py", CONFTEST),
        ("pyproject.toml", "[tool.pytest.ini_options]\npythonpath = ['src']\n"),
    ):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return root


def test_functions_that_the_collector_has_frozen_are_exchanged(tmp_path: Path) -> None:
    file = tmp_path / "frozen.py"
    file.write_bytes(MODULE)
    names: dict[str, Any] = {}
    exec(compile(MODULE, str(file), "exec"), names)
    gc.freeze()
    try:
        exchange(str(file), MODULE, MODULE.replace(b"2.0", b"5.0"))
        assert names["share"](1.0, 1.0) == (-6.0, False)
    finally:
        gc.freeze()


def test_where_time_is_short_those_that_run_what_others_do_not_come_first() -> None:
    lines = {3: ["", "a::1", "a::2", "b::3"], 5: ["a::1", "a::2", "b::3"], 7: ["a::2"], 9: ["b::3", "c::4"]}
    times_s = {"a::1": 0.5, "a::2": 1.0, "b::3": 2.5, "c::4": 1.5}
    reach = Reach(times_s, {"m.py": lines}, [], 9.0)
    assert reach.of("m.py", range(5, 6)) == ["a::1", "a::2", "b::3"]
    assert Reach(times_s, {"m.py": lines}, [], 3.0).of("m.py", range(5, 6)) == ["a::2", "b::3"]
    assert reach.of("m.py", range(7, 10)) == ["a::2", "c::4", "b::3"]
    assert reach.of("m.py", range(5, 6))[0] == "a::1"
    reach.note("m.py", "b::3")
    assert reach.of("m.py", range(5, 6)) == ["b::3", "a::1", "a::2"]  # it told of another change
    assert reach.imported("m.py", range(3, 4))
    assert not reach.imported("m.py", range(4, 10))


def test_the_file_of_the_module_comes_first() -> None:
    times_s = {"test_other::1": 0.1, "test_arcs::2": 3.0}
    reach = Reach(times_s, {"src/_arcs.py": {4: list(times_s)}}, [], 9.0)
    assert reach.of("src/_arcs.py", range(4, 5)) == ["test_arcs::2", "test_other::1"]


def test_survivors_are_the_changes_that_no_test_notices(repository: Path) -> None:
    module = repository / "src" / "demo" / "thing.py"
    tests = candidate_tests(repository, [module])
    assert [path.name for path in tests] == ["test_thing.py"]
    chosen = {
        ("constant", 3): "killed",
        ("return", 10): "killed",
        ("logic", 8): "survived",  # the test has no part below a quarter of a small whole
        ("dropped", 9): "unreached",
        ("dropped", 14): "unreached",
    }
    with Session(repository) as session:
        reach = session.reach([module], tests, slowest_s=0.5)
        assert reach.failed == [f"tests/unit/test_thing.py::test_{each}" for each in ("broken", "slow")]
        verdicts = {
            place: session.outcome(module, each, reach).verdict
            for each in mutants_of(MODULE)
            if (place := (each.kind, each.lines[0])) in chosen
        }
        assert session.source(module) == MODULE == module.read_bytes()
    assert verdicts == chosen
