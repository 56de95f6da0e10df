"""Seeded fuzzing of every reader, the commands, and every function library: no traceback, no hang, no half file.

The ordinary run takes about a quarter of a minute, uncompiled. Longer ones::

    pytest tests/fuzz -m long --fuzz-cases 20000 --fuzz-campaign 7

say how many cases each target gets, and which ones. What failed is shown with its seed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from polycnc.errors import PolycncError
from support.fuzz_targets import BY_NAME, TARGETS
from support.fuzzing import LIMIT_S, Failure, Target, TookTooLong, failures

TESTS = Path(__file__).resolve().parents[1]


def campaign(number: int, count: int, seconds: int, *names: str, compiled: bool = False) -> dict[str, int]:
    """Run cases in a process of its own; return how many of each target, and fail with what failed."""
    environment = {**os.environ, "PYTHONPATH": str(TESTS)}
    if not compiled:
        environment["NUMBA_DISABLE_JIT"] = "1"
    arguments = [sys.executable, "-m", "support.fuzz_worker", *map(str, (number, 0, count, seconds)), *names]
    done = subprocess.run(
        arguments, env=environment, capture_output=True, text=True, check=False, timeout=3 * seconds + 300
    )
    told = [json.loads(line) for line in done.stdout.splitlines()]
    found = [Failure(**each) for line in told for each in line.get("failed", ())]
    assert not found, "\n\n".join(f"{each.target} {each.seed}\n{each.what}\n{each.shown}" for each in found)
    assert done.returncode == 0, f"ended in {told[-1:]}\n{done.stderr}"
    return {line["target"]: line["cases"] for line in told if "cases" in line}


def test_a_short_campaign() -> None:
    cases = campaign(20, 50, 8)
    assert set(cases) == {target.name for target in TARGETS}
    assert all(cases.values())


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("target", BY_NAME)
def test_a_long_campaign(target: str, request: pytest.FixtureRequest) -> None:
    count = int(request.config.getoption("--fuzz-cases"))
    number = int(request.config.getoption("--fuzz-campaign"))
    assert campaign(number, count, 36_000, target) == {target: count}


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("target", ["nc din", "nc fanuc", "macro", "pcap", "imclib", "fwlib"])
def test_a_long_campaign_of_compiled_code(target: str, request: pytest.FixtureRequest) -> None:
    count = int(request.config.getoption("--fuzz-cases"))
    number = int(request.config.getoption("--fuzz-campaign"))
    assert campaign(number, count, 36_000, target, compiled=True) == {target: count}


def _never(_: object) -> None:
    while True:
        pass


def _wrong(case: int) -> None:
    if case % 2:
        raise PolycncError("as it should be")
    raise ZeroDivisionError


@pytest.mark.parametrize(("run", "expected"), [(_never, "TookTooLong"), (_wrong, "ZeroDivisionError")])
def test_the_harness_finds_what_it_is_for(run: object, expected: str) -> None:
    assert not issubclass(TookTooLong, Exception)
    target = Target("harness", lambda chance: 2, run, limit_s=0.2)  # type: ignore[arg-type]
    (failure,) = failures(target, iter([11]))
    assert (failure.target, failure.seed, failure.shown) == ("harness", 11, "2")
    assert expected in failure.what
    assert LIMIT_S > 1.0
    assert not list(failures(Target("harness", lambda chance: 3, _wrong), iter([11])))


def test_cases_repeat_from_their_seeds() -> None:
    import random

    for target in TARGETS:
        first, second = (target.case(random.Random(f"{target.name} 5")) for _ in range(2))
        assert repr(first) == repr(second) or target.name == "trace", target.name
