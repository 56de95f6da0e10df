"""Compiled functions with states: by reference where they are handed on, the same numbers as plain Python."""

from __future__ import annotations

import logging
import os
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt
import pytest

from polycnc.jit import allocating, call_at, compile_entries, compiled, detached, entry
from polycnc.jit._pipeline import KNOWN as KNOWN_NUMBA
from polycnc.kernel import make_state as make_kernel_state

Floats = npt.NDArray[np.float64]


class Inner(NamedTuple):
    first: Floats
    second: Floats


class State(NamedTuple):
    counts: npt.NDArray[np.int64]
    inner: Inner
    last: Floats


class Pair(NamedTuple):
    low: float
    high: float


def make_state() -> State:
    return State(
        np.array([3, 5]), Inner(np.array([2.5, -7.25]), np.array([1.5])), np.array([0.125, 11.0, -4.0])
    )


@compiled
def _ordered(a: float, b: float) -> Pair:
    return Pair(min(a, b), max(a, b))


@compiled
def _of_inner(inner: Inner, i: int) -> float:
    inner.first[i] += inner.second[0]
    pair = _ordered(inner.first[i], inner.second[0])
    return float(pair.high - 2.0 * pair.low)


@allocating
def _sum_of_copies(values: Floats) -> float:
    copy = values + 1.0
    return float(copy.sum())


@entry
def work(state: State, turns: int = 2, scale: float = 0.5) -> float:
    """Go through everything that compiled code does with a state."""
    total = 0.0
    for k in range(turns):
        total += scale * _of_inner(state.inner, k % 2)
        state.counts[1] += k
    return total + _sum_of_copies(state.last)


@entry
def work_twice(state: State) -> float:
    """Call an entry from an entry."""
    return work(state, 3) + work(state, turns=1, scale=0.25)


def test_states_by_reference_give_what_plain_python_gives() -> None:
    """Hand: first = 2.5, -7.25, second 1.5. Turn 0: 4.0 - 3 = 1.0; turn 1: -5.75, so 1.5 + 11.5 = 13.0; halves: 7.0."""
    state = make_state()
    assert work(state) == 7.0 + (0.125 + 11.0 - 4.0 + 3.0)
    assert state.inner.first.tolist() == [4.0, -5.75]
    assert state.counts.tolist() == [3, 6]


def test_an_entry_takes_keywords_and_is_called_by_another_entry() -> None:
    one, other = make_state(), make_state()
    expected = work(one, turns=3) + work(one, 1, scale=0.25)
    assert work_twice(other) == expected
    assert [member.tolist() for member in other.inner] == [member.tolist() for member in one.inner]


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")
def test_python_reaches_an_internal_function_through_an_entry_of_its_own() -> None:
    state = make_state()
    assert _of_inner(state.inner, 1) == 1.5 + 2.0 * 5.75
    assert _of_inner.py_func(make_state().inner, 0) == 4.0 - 2.0 * 1.5  # type: ignore[attr-defined]


def test_numba_is_one_for_which_the_shortened_way_was_tried() -> None:
    """When this fails: try `jit/_pipeline.py` with the new numba (all tests), then add its version to KNOWN there."""
    assert numba.__version__.startswith(KNOWN_NUMBA)


@pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="nothing is compiled")
def test_entries_are_compiled_beforehand_for_what_their_annotations_say(
    caplog: pytest.LogCaptureFixture,
) -> None:
    seen: list[str] = []
    with caplog.at_level(logging.WARNING):
        left_out = compile_entries(__name__, [make_state()], lambda name, part: seen.append(f"{name} {part}"))
    assert (left_out, seen) == (0, ["_shift_twice 0.0", "_shifted 0.25", "work 0.5", "work_twice 0.75"])
    assert len(work_twice.signatures) == 1  # type: ignore[attr-defined]
    # The kernel's own ones all: what were left out would be compiled for nothing, at each warm-up, and at first use.
    assert compile_entries("polycnc.kernel", [make_kernel_state(3)], lambda name, part: None) == 0


@compiled
def _shifted(state: State, by: int, index: int) -> int:
    state.counts[index] += by
    return int(state.counts[index]) * 10


SHIFTED = detached(_shifted)


@entry(steps=lambda numbers, by: 1 << 60)
def _shift_twice(numbers: npt.NDArray[np.int64], by: int) -> int:
    return call_at(numbers[0], (numbers[1],), (by, 1)) + call_at(numbers[0], (numbers[1],), (2 * by, 0))


def test_a_detached_function_is_called_with_the_places_of_its_states() -> None:
    state = make_state()
    before = state.counts.tolist()
    ready = SHIFTED.ready(state, numbers=2)
    assert _shift_twice(ready.numbers, 7) == 10 * (before[1] + 7) + 10 * (before[0] + 14)
    assert state.counts.tolist() == [before[0] + 14, before[1] + 7]
    with pytest.raises(TypeError, match="arrays only"):
        SHIFTED.ready((3, "no array"), numbers=2)
