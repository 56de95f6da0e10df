"""Fill an entry of the spooler with a path, and hand it to the axes' queues."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from polycnc.controllers.apci._motion import axis_velocity, keep_going, override_changed, plan_motion
from polycnc.controllers.apci._spool import drop_entries, give_up, leave_and_brake, start_move
from polycnc.controllers.apci._state import JOG, MOVE, BoardState, Floats
from polycnc.kernel import (
    SHORT_JUMP,
    KernelState,
    Segments,
    entry,
    set_arc,
    set_circle3d,
    set_line,
    stop_profile,
)

Mask = npt.NDArray[np.uint8]


@entry
def fill_line(seg: Segments, e: int, feed_axis: Mask, start: Floats, end: Floats) -> float:
    """Make entry `e` a straight line; return its length, 0 if there is none."""
    if not set_line(seg.row, seg.start, seg.end, e, feed_axis, start, end, 0.0, 0, 0):
        return 0.0
    return float(seg.row[e]["length"])


@entry
def fill_arc(
    seg: Segments,
    e: int,
    feed_axis: Mask,
    start: Floats,
    end: Floats,
    axis_p: int,
    axis_q: int,
    center_p: float,
    center_q: float,
    sweep: float,
) -> float:
    """Make entry `e` an arc or a helix through `sweep` rad; return its length, 0 if there is none."""
    if not set_arc(seg, e, feed_axis, start, end, axis_p, axis_q, center_p, center_q, sweep, 0.0, 0, 0):
        return 0.0
    return float(seg.row[e]["length"])


@entry
def fill_circle3d(
    seg: Segments,
    e: int,
    start: Floats,
    axis_p: int,
    axis_q: int,
    axis_r: int,
    center: Floats,
    normal: Floats,
    sweep_deg: float,
) -> float:
    """Make entry `e` a circle in space; return its length, 0 if there is none."""
    if not set_circle3d(seg, e, start, axis_p, axis_q, axis_r, center, normal, sweep_deg, 0.0, 0, 0):
        return 0.0
    return float(seg.row[e]["length"])


@entry
def begin_move(b: BoardState, state: KernelState, e: int, speed: float) -> None:
    """Let the axes of entry `e` leave what they do and go along it, entered with path speed `speed`."""
    mask = b.entry[e]["mask"]
    for i in range(b.axis.shape[0]):
        if mask >> i & 1:
            give_up(b, i)
            b.axis[i]["direct"] = 1
            start_move(b, i, e, speed, 0.0)


@entry
def begin_jog(
    b: BoardState,
    state: KernelState,
    i: int,
    search: int,
    endless: bool,
    target: float,
    tvl: float,
    vl: float,
    ac: float,
    dec: float,
) -> None:
    """Let axis `i` leave what it does and run a profile of its own from its present position and velocity."""
    row = b.axis[i]
    velocity = axis_velocity(b, state, i)
    give_up(b, i)
    row["motion"] = JOG
    row["search"] = search
    row["stopping"] = 0
    row["endless"] = 1 if endless else 0
    row["target"] = target
    row["tvl"] = tvl
    row["vl"] = vl
    row["ac"] = ac
    row["dec"] = dec
    row["policy"] = SHORT_JUMP
    row["pe"] = 0
    plan_motion(b, i, state.base[i], velocity, 0.0)


@entry
def go_on_with(b: BoardState, i: int, position: float, velocity: float) -> None:
    """Let axis `i` go on from `position` with `velocity`, past the end of any profile."""
    b.axis[i]["pe"] = 1
    keep_going(b, i, position, velocity, 0.0)


@entry
def reject_queue(b: BoardState, i: int, keep_running: bool) -> None:
    """Empty axis `i`'s queue; with `keep_running` the entry that is carried out stays."""
    row = b.axis[i]
    busy = row["direct"] == 0 and row["entry"] >= 0
    drop_entries(b, i, 1 if keep_running and busy else 0)
    if not keep_running:
        give_up(b, i)


@entry
def brake_axis(b: BoardState, state: KernelState, i: int, rate: float) -> None:
    """Let axis `i` leave what it does, and brake it to rest by itself."""
    leave_and_brake(b, state, i, rate)


@entry
def brake_on_path(b: BoardState, i: int, rate: float) -> None:
    """Brake axis `i` to rest along its path, and reject what its queue holds behind that."""
    row = b.axis[i]
    if row["motion"] == MOVE and row["direct"] == 0:
        drop_entries(b, i, 1)
    row["running"] = 0
    row["stopping"] = 1
    row["endless"] = 0
    count = stop_profile(b.phases[i], row["place"], row["speed"], rate, row["jerkrel"])
    row["phases"] = count
    row["lead"] = 0.0
    row["cycles"] = 0
    row["duration"] = 0.0
    for phase in range(count):
        row["duration"] += b.phases[i, phase, 0]


@entry
def change_override(b: BoardState, i: int, value: float) -> None:
    """Give axis `i` another jog override, at once."""
    row = b.axis[i]
    row["jovr"] = value
    if row["motion"] == JOG:
        override_changed(b, i)
