"""State that is copied, put back in place, compared and described by one walk."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.machine import copied, described, is_same, load_machine, restore_state


class Colour(StrEnum):
    RED = "r"
    BLUE = "b"


@dataclass(frozen=True)
class Order:
    axes: tuple[int, ...]
    due: int = 3


@dataclass
class Part:
    place: Any
    waiting: deque[Order] = field(default_factory=deque)
    buffer: bytearray = field(default_factory=lambda: bytearray(3))


@dataclass
class Whole:
    part: Part
    given: dict[Any, Any]
    colour: Colour = Colour.RED
    codes: frozenset[str] = frozenset()
    rows: list[Any] = field(default_factory=list)


VALUES = st.one_of(
    st.none(), st.booleans(), st.integers(-9, 9), st.floats(allow_nan=True), st.text(max_size=3), st.binary()
)
ORDERS = st.builds(Order, st.tuples(st.integers(0, 7), st.integers(0, 7)), st.integers(0, 99))
PARTS = st.builds(
    Part,
    st.lists(st.floats(allow_nan=False), min_size=4, max_size=4).map(np.array),
    st.lists(ORDERS, max_size=3).map(deque),
    st.binary(max_size=4).map(bytearray),
)
WHOLES = st.builds(
    Whole,
    PARTS,
    st.dictionaries(st.integers(0, 5) | st.sampled_from(Colour), VALUES | PARTS, max_size=4),
    st.sampled_from(Colour),
    st.frozensets(st.text(max_size=3), max_size=4),
    st.lists(VALUES | PARTS, max_size=3),
)


@given(WHOLES)
def test_a_copy_is_the_same_and_shares_nothing(state: Whole) -> None:
    kept = copied(state)
    assert is_same(kept, state)
    before = described(kept)
    state.part.place[2] = 41.7
    state.part.buffer.append(7)
    state.part.waiting.append(Order((5,)))
    state.given["new"] = 1
    state.rows.append("new")
    assert described(kept) == before
    assert not is_same(kept, state)


@given(WHOLES, WHOLES)
def test_any_state_is_brought_back_to_any_copy_in_place(state: Whole, other: Whole) -> None:
    held = (state.part, state.part.place, state.part.waiting, state.part.buffer, state.given, state.rows)
    saved = copied(other)
    assert restore_state(state, saved) is state
    assert is_same(state, other)
    now = (state.part, state.part.place, state.part.waiting, state.part.buffer, state.given, state.rows)
    assert all(one is another for one, another in zip(held, now, strict=True))
    state.part.place[0] += 2.5
    assert is_same(saved, other)  # what was put back shares nothing with the copy


@given(WHOLES, WHOLES)
def test_a_description_tells_states_apart_and_does_not_depend_on_order(state: Whole, other: Whole) -> None:
    turned = replace(state, given=dict(reversed(state.given.items())))
    assert described(turned) == described(state)
    if described(state) == described(other):
        assert repr(state) == repr(replace(other, given={key: other.given[key] for key in state.given}))


def test_numbers_are_told_apart_by_kind_and_sign() -> None:
    texts = [
        described(each) for each in (0, 0.0, -0.0, False, "0", b"0", None, np.zeros(1), np.zeros(1, int))
    ]
    assert len(set(texts)) == len(texts)


def test_a_function_and_a_model_count_by_what_they_are() -> None:
    assert described(load_machine) == "polycnc.machine._presets.load_machine"
    assert described(load_machine("mill3")) == described(load_machine("mill3"))
    assert described(load_machine("mill3")) != described(load_machine("lathe2"))


def test_what_shows_only_its_address_is_refused() -> None:
    with pytest.raises(TypeError, match="object has no text"):
        described(object())
