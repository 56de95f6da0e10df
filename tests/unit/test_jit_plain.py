"""Small work is left to the interpreter: what counts, when it ends, and what Python gets back."""

from __future__ import annotations

import importlib
import os
import pkgutil
import subprocess
import sys
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import pytest

import polycnc
from polycnc.cli._warmup import _JOBS, warmup_command
from polycnc.jit._entry import entries
from polycnc.jit._marks import Mark
from polycnc.jit._plain import ALLOWANCE, ALLOWED_STEPS, UNASKED_STEPS, Allowance, Entry, PlainFunctions
from support.command import environment

# Entries that tell from their arguments how long they take, and one that does not.
MODULE = """
import math
import numpy as np
from polycnc.jit import compiled, entry

@compiled
def share(part, whole):
    return part / whole

@entry(steps=lambda values, n, offset=0.5: 1000 * n, spared=lambda sum, values, n, offset=0.5: 1000 * (n - 2))
def add_up(values: np.ndarray, n: int, offset: float = 0.5) -> float:
    total = 0
    for k in range(2):
        total += values[k]
    values[0] += 1.0
    return total + offset

@entry
def shares(values: np.ndarray) -> tuple[float, int, bool]:
    return share(values[0], values[1]), int(values[0]), values[0] > 0.0

@entry
def whole(values: np.ndarray, much: bool) -> float:
    return 3 if much else values[0]
"""
BEGIN = """
import sys, logging
logging.basicConfig(format="%(message)s")
sys.path.insert(0, sys.argv[1])
import numpy as np
from steps import add_up, shares, whole
from polycnc.jit import compile_at_once

def made(entry):
    return sum(entry.stats.cache_misses.values()), sum(entry.stats.cache_hits.values())
"""
COMPILED, LOADED, PLAIN = (1, 0), (0, 1), (0, 0)

pytestmark = pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")


def _run(folder: Path, text: str, **more: str) -> list[str]:
    (folder / "steps.py").write_text(MODULE)
    variables = environment(
        POLYCNC_CACHE_DIR=str(folder / "cache"), **{"POLYCNC_COMPILE_AT_ONCE": "", **more}
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", BEGIN + text, str(folder)],
        env=variables,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


def test_little_work_is_done_plainly_with_the_results_of_compiled_code(tmp_path: Path) -> None:
    text = """
values = np.array([3.0, 0.0])
print(repr(shares(values)), repr(whole(values, True)), repr(whole(values, False)))
print(repr(add_up(values, 5)), repr(add_up(values, n=4, offset=-7.25)), values.tolist(), made(add_up), made(shares))
"""
    plain = _run(tmp_path, text)
    assert plain == [
        "(inf, 3, True) 3.0 3.0",
        f"3.5 -3.25 [5.0, 0.0] {PLAIN} {PLAIN}",
    ]
    assert not (tmp_path / "cache").exists()
    at_once = _run(tmp_path, text.replace("np.array", "compile_at_once() or np.array"))
    assert at_once == [plain[0], plain[1].replace(f"{PLAIN} {PLAIN}", f"(2, 0) {COMPILED}")]


def test_much_work_is_compiled_and_so_is_what_comes_when_the_steps_are_used_up(tmp_path: Path) -> None:
    left = ALLOWED_STEPS // 2000
    said = _run(
        tmp_path,
        f"""
values = np.array([2.5, 4.0])
for _ in range({left - 1}):
    add_up(values, 2, 0.5)
print(made(add_up), add_up(values, {left}, 0.5), made(add_up))
print(made(shares), shares(values)[1], made(shares))
""",
    )
    # 2,000 steps of each call are taken, so 2,000 are left: too few for the next one, enough for another entry.
    assert said == [f"{PLAIN} {2.5 + (left - 1) + 4.5} {COMPILED}", f"{PLAIN} {2 + left} {PLAIN}"]


def test_what_is_kept_is_loaded_for_much_work_and_what_follows_a_clock_or_asks_for_it_is_compiled(
    tmp_path: Path,
) -> None:
    text = "print(add_up(np.array([2.5, 4.0]), 7, 0.5), made(add_up))"
    clock = """
from polycnc.machine import Pace
class Wall:
    def now_s(self):
        return 3.0
Pace(Wall())
"""
    assert _run(tmp_path, f"{clock}\n{text}") == [f"7.0 {COMPILED}"]
    much = text.replace("7, 0.5", f"{UNASKED_STEPS // 1000 + 1}, 0.5")
    assert _run(tmp_path, much) == [f"7.0 {LOADED}"]
    assert _run(tmp_path, "print(add_up(np.array([2.5, 4.0]), 7, 0.5), 'numba' in sys.modules)") == [
        "7.0 False"
    ]
    # Once numba is there, what is kept is used for little work, too.
    assert _run(tmp_path, f"add_up(np.array([2.5, 4.0]), {UNASKED_STEPS}, 0.5)\n{text}") == [f"7.0 {(0, 1)}"]
    text = text.replace("add_up(np.array([2.5, 4.0]), 7, 0.5)", "whole(np.array([2.5]), False)")
    text = text.replace("add_up", "whole")
    assert _run(tmp_path, text, POLYCNC_COMPILE_AT_ONCE="1") == [f"2.5 {COMPILED}"]


def test_steps_that_were_spared_are_given_back_unless_all_is_compiled_by_now() -> None:
    allowance = Allowance()
    allowance.left = ALLOWED_STEPS
    assert not allowance.take_unasked(lambda: UNASKED_STEPS + 1)
    assert allowance.take_unasked(lambda: UNASKED_STEPS - 2)
    assert not allowance.take_unasked(lambda: 3)
    assert allowance.take_unasked(lambda: 2)
    assert allowance.left == ALLOWED_STEPS - UNASKED_STEPS
    allowance.left = 70
    assert not allowance.take(lambda: 71)
    assert allowance.take(lambda: 60)
    allowance.give_back(25)
    assert allowance.left == 35
    assert allowance.take(lambda: 35)
    allowance.give_back(35)
    assert not allowance.take(lambda: 2)


def _codes(code: CodeType) -> list[CodeType]:
    inner = [each for each in code.co_consts if isinstance(each, CodeType)]
    return [code, *(deeper for each in inner for deeper in _codes(each))]


def _names_compiled(plain: Any, seen: set[int]) -> list[str]:
    """Return where a plain function, or one that it calls, still reaches compiled code."""
    if id(plain) in seen:
        return []
    seen.add(id(plain))
    found = []
    names = {name for code in _codes(plain.__code__) for name in code.co_names}
    for name in sorted(names):
        value = plain.__globals__.get(name)
        parts = [value]
        if isinstance(value, ModuleType) and value.__name__.startswith("polycnc."):
            parts += [getattr(value, part, None) for part in names]
        found += [f"{plain.__name__}: {name}" for part in parts if isinstance(part, Mark)]
        if getattr(value, "__globals__", None) is not None and hasattr(value, "__code__"):
            found += _names_compiled(value, seen)
    cells = [cell.cell_contents for cell in plain.__closure__ or ()]
    return found + [f"{plain.__name__}: a cell" for each in cells if isinstance(each, Mark)]


def test_no_entry_reaches_compiled_code_when_it_is_plain() -> None:
    for each in pkgutil.walk_packages(polycnc.__path__, "polycnc."):
        if not each.name.startswith(("polycnc.cli", "polycnc.__main__")):
            importlib.import_module(each.name)
    functions, seen = PlainFunctions(), set[int]()
    # Detached functions are called by their address, from compiled code alone.
    ours = [each for name, each in entries() if name.startswith("polycnc.") and isinstance(each, Entry)]
    assert [found for each in ours for found in _names_compiled(functions.of(each), seen)] == []
    assert len(seen) > 300


def test_warming_up_leaves_nothing_to_the_interpreter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ALLOWANCE, "left", 5_000)
    left: list[int | None] = []
    monkeypatch.setattr("polycnc.cli._warmup._JOBS", {"run": lambda _: left.append(ALLOWANCE.left)})
    warmup_command("run")
    assert left == [0]


@pytest.mark.skipif(bool(os.environ.get("NUMBA_DISABLE_JIT")), reason="nothing is compiled")
def test_warming_up_makes_every_entry_of_stock_ready() -> None:
    _JOBS["stock"](lambda name, part: None)
    of_stock = {name: each for name, each in entries() if name.startswith("polycnc.stock.")}
    assert len(of_stock) >= 3
    assert [name for name, each in of_stock.items() if not each.compiled().signatures] == []
