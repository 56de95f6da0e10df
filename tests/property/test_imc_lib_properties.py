"""Whatever numbers a call gets: it answers with a status, and when it refuses, no word of the card has changed."""

from __future__ import annotations

import inspect
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.library import Pointer
from support.imc_network import opened
from support.often import share

FUNCTIONS = [
    name
    for name in lib.__all__
    if name.startswith("IMC_")
    and inspect.isfunction(getattr(lib, name))
    and "Handle" in inspect.signature(getattr(lib, name)).parameters
    and name not in ("IMC_Close", "IMC_ClearFIFO")
]

small = st.integers(-2, 6)
addresses = st.one_of(st.integers(0, 1023), st.sampled_from([12, 23, 152, 175, 218, 225, 307, 500, 562]))
numbers = st.one_of(
    small, small, addresses, st.sampled_from([-1, 2**15, 2**16, 2**31, -(2**31), 2**32, 2**48])
)
words = st.integers(0, 65535)

descriptions = st.lists(
    st.builds(lib.WR_MUL_DES.of, addresses, st.integers(0, 5), st.integers(0, 4), words), max_size=4
)
segments = st.builds(
    lambda memory, count: (
        lib.PFIFOSegData.of(*memory, direction=count) if count else lib.PFIFOSegData(datanum=17)
    ),
    st.lists(st.integers(-(2**31), 2**31 - 1), max_size=6),
    small,
)
events = st.lists(
    st.builds(
        lambda memory: lib.EventInfo.unpack(memory),
        st.builds(
            lambda command, kind, at, axis, rest, dest: (
                bytes([command, 0, kind, 0]) + at.to_bytes(2, "little") + bytes([axis, 0]) + rest + dest
            ),
            st.integers(0, 36),
            st.integers(0, 16),
            addresses,
            st.integers(0, 5),
            st.binary(min_size=8, max_size=8),
            st.sampled_from([bytes(8), (307).to_bytes(8, "little"), (225).to_bytes(8, "little")]),
        ),
    ),
    max_size=3,
)
POINTERS: dict[str, st.SearchStrategy[Any]] = {
    "pWR_MUL_DES": descriptions,
    "PEventInfo": events,
    "short *": st.lists(st.integers(-40000, 40000), max_size=8),
    "PFIFOSegData *": segments,
    "PFIFOSegInfo *": st.builds(lib.PFIFOSegInfo.of, st.just(65536), st.just(0), segments),
}


def arguments(name: str) -> st.SearchStrategy[tuple[Any, ...]]:
    """Return the arguments of a function after its handle."""
    made: list[st.SearchStrategy[Any]] = []
    for each in lib.FUNCTIONS[getattr(lib, name).__name__].passed[1:]:  # some have two names
        if isinstance(each.type, Pointer):
            made.append(st.one_of(st.none(), POINTERS[each.c], POINTERS[each.c]))
        elif each.c == "IMCFLOAT":
            made.append(st.floats(width=64))
        else:
            made.append(numbers if each.name != "fifoSel" else small)
    return st.tuples(*made)


CALLS = st.sampled_from(FUNCTIONS).flatmap(lambda name: st.tuples(st.just(name), arguments(name)))


@settings(max_examples=share(100))
@given(st.lists(CALLS, min_size=1, max_size=30))
def test_calls_answer_and_refused_ones_change_nothing(calls: list[tuple[str, tuple[Any, ...]]]) -> None:
    card = Card()
    handle = opened(card, clock=None)
    for name, given_arguments in calls:
        memory, fifo = card.state.memory.copy(), card.state.fifo.copy()
        answer = getattr(lib, name)(handle, *given_arguments)
        status = answer[0] if isinstance(answer, tuple) else answer
        assert isinstance(status, lib.IMC_STATUS)
        if status != lib.IMC_OK:
            assert (card.state.memory == memory).all(), name
            assert (card.state.fifo == fifo).all(), name
    lib.detach()


def test_all_functions_with_a_handle_are_tried() -> None:
    assert (
        len(set(FUNCTIONS)) == 53 - 6 + 8
    )  # FindNetCard, three to open, Close, ClearFIFO; eight other names
