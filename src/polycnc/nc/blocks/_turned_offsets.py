"""Offsets that follow from where the machine is (G10 L10, L11, L20), where a work offset turns the plane of X and Y.

An axis that is not named keeps its value in the turned coordinates. Source: LinuxCNC `interp_convert.cc`,
convert_setup and convert_setup_tool.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.modal._frame import Rotation


def other_frame(state: ChannelState) -> bool:
    """Tell whether positions are mirrored, scaled, turned by the program, or polar."""
    frame = state.frame
    return bool(frame.mirrors or frame.scales or frame.rotation or frame.polar)


def _turned(turn: Rotation | None, vector: Sequence[float], sign: float = 1.0) -> list[float]:
    found = list(vector)
    if turn is not None:
        found[turn.p], found[turn.q] = turn.turned(found[turn.p], found[turn.q], sign)
    return found


def _shift(state: ChannelState) -> list[float]:
    """Return what the program shifts by, in its own directions."""
    coordinates = state.coordinates
    own = coordinates.local + coordinates.inner
    found: list[float] = (own + coordinates.shift if coordinates.shifted else own).tolist()
    return found


def zero_that_reads(state: ChannelState, name: str, values: Mapping[int, float]) -> dict[int, float]:
    """Return the work offset with which the present position reads `values` (mm or degree)."""
    turn, shift = state.turn_of(name), _shift(state)
    within = _turned(state.coordinates.turn, shift)
    rest = state.modal.offset - state.coordinates.first_offset(state.tables) - within
    base = (state.modal.position - rest).tolist()
    axes = set(values) | ({turn.p, turn.q} if turn is not None and {turn.p, turn.q} & set(values) else set())
    old = state.tables.work_offset(name)
    here = _turned(turn, [at - zero for at, zero in zip(base, old, strict=True)], -1.0)
    read = [values[axis] + shift[axis] if axis in values else at for axis, at in enumerate(here)]
    there = _turned(turn, read)
    return {axis: base[axis] - there[axis] for axis in axes}


def tool_that_reads(
    state: ChannelState, name: str, values: Mapping[int, float], tool: Mapping[int, float], *, shifted: bool
) -> dict[int, float]:
    """Return what a tool shifts axes by (mm) when the present position reads `values` in a work offset.

    `tool` is what it shifts them by now; the shift of the program counts where it is `shifted`.
    """
    turn = state.turn_of(name)
    shift = _shift(state) if shifted else [0.0] * len(state.modal.position)
    zero: Sequence[float] = state.tables.work_offset(name)
    if name == state.coordinates.work[0]:
        zero = state.coordinates.first_offset(state.tables).tolist()
    here = _turned(turn, [at - of for at, of in zip(state.modal.position.tolist(), zero, strict=True)], -1.0)
    own = _turned(turn, [tool.get(axis, 0.0) for axis in range(len(here))], -1.0)
    wanted = [
        here[axis] - shift[axis] - values[axis] if axis in values else own[axis] for axis in range(len(here))
    ]
    axes = set(values) | ({turn.p, turn.q} if turn is not None and {turn.p, turn.q} & set(values) else set())
    found = _turned(turn, wanted)
    return {axis: found[axis] for axis in axes}
