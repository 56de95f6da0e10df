"""Let axes leave what they do and begin something else: a path, a profile of their own, a stop, another override."""

from __future__ import annotations

from polycnc.controllers.apci.core._motion import (
    axis_velocity,
    jerk_of,
    keep_going,
    override_changed,
    plan_motion,
    rest,
)
from polycnc.controllers.apci.core._spool import drop_entries, give_up, leave_and_brake, start_move
from polycnc.controllers.apci.core._spool_entries import fill_move
from polycnc.controllers.apci.core._state import (
    BY_COMMAND,
    IDLE,
    JOG,
    MOVE,
    WAITING,
    BoardState,
    Floats,
    Whole,
)
from polycnc.kernel import SHORT_JUMP, KernelState, entry, profile_duration, stop_profile


@entry
def begin_move(
    b: BoardState, e: int, axes: Whole, weight: Floats, ac: float, vl: float, tvl: float, speed: float
) -> None:
    """Make entry `e`, which has its path, a move of `axes`, and let them leave what they do and follow it."""
    fill_move(b, e, axes, weight, ac, vl, tvl)
    for k in range(axes.shape[0]):
        i = axes[k]
        give_up(b, i)
        b.axis[i]["direct"] = 1
        start_move(b, i, e, speed, 0.0)


@entry
def begin_jog(
    b: BoardState,
    base: Floats,
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
    velocity = axis_velocity(b, i)
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
    plan_motion(b, i, base[i], velocity, 0.0, False)


@entry
def go_on_with(b: BoardState, i: int, position: float, velocity: float) -> None:
    """Let axis `i` go on from `position` with `velocity`, past the end of any profile."""
    keep_going(b, i, position, velocity, 0.0)


@entry
def stand(b: BoardState, i: int) -> None:
    """Let axis `i` leave what it does, be at rest where it is, and have nothing queued."""
    give_up(b, i)
    rest(b, i)
    b.axis[i]["pe"] = 1


@entry
def reject_queue(b: BoardState, i: int) -> None:
    """Empty axis `i`'s queue, but for what is being carried out."""
    row = b.axis[i]
    busy = row["motion"] == WAITING or (row["direct"] == 0 and row["entry"] >= 0)
    drop_entries(b, i, 1 if busy else 0)


@entry
def brake_axis(b: BoardState, state: KernelState, i: int, rate: float) -> None:
    """Let axis `i` leave what it does, and brake it to rest by itself."""
    leave_and_brake(b, state, i, rate, BY_COMMAND)
    b.axis[i]["pe"] = 1 if b.axis[i]["motion"] == IDLE else 0


@entry
def brake_on_path(b: BoardState, i: int, rate: float) -> None:
    """Brake axis `i` to rest along its path, and reject what its queue holds after that."""
    row = b.axis[i]
    drop_entries(b, i, 1 if row["direct"] == 0 else 0)
    row["running"] = 0
    row["stopping"] = BY_COMMAND
    count = stop_profile(b.phases[i], row["place"], row["speed"], rate, jerk_of(b, i))
    row["phases"] = count
    row["lead"] = 0.0
    row["cycles"] = 0
    row["duration"] = profile_duration(b.phases[i], count)


@entry
def aim_at_velocity(b: BoardState, e: int, tvl: float) -> None:
    """Give entry `e` another target velocity, also where axes already follow it."""
    this = b.entry[e]
    this["tvl"] = min(tvl, this["vl"])
    this["join"] = max(this["tvl"], 0.0)
    for i in range(b.axis.shape[0]):
        row = b.axis[i]
        if row["motion"] == MOVE and row["entry"] == e and row["stopping"] == 0:
            row["tvl"] = this["tvl"]
            row["ends_at_speed"] = 1 if this["tvl"] != 0.0 else 0
            plan_motion(b, i, row["place"], row["speed"], 0.0, True)


@entry
def change_override(b: BoardState, i: int, value: float) -> None:
    """Give axis `i` another jog override, at once."""
    row = b.axis[i]
    row["jovr"] = value
    if row["motion"] == JOG:
        override_changed(b, i)
