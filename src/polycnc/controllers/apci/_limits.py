"""Limit switches and software limits, with their three ways to act (Manual 002, 2.4).

TOM takes the drive away towards the limit, SMA holds the setpoint while the profile runs on, SMD brakes the axis and
lets it move only out again.
"""

from __future__ import annotations

from polycnc.controllers.apci._motion import axis_velocity, brake, rest
from polycnc.controllers.apci._spool import give_up
from polycnc.controllers.apci._state import (
    IDLE,
    LEFT,
    NO_LIMIT,
    RIGHT,
    SMA,
    SMD,
    TOM,
    WAITING,
    BoardState,
)
from polycnc.kernel import KernelState, compiled


@compiled
def _hard_function(b: BoardState, i: int, side: int) -> int:
    """Return how an active limit switch on this side of axis `i` acts."""
    plan, inputs = b.plan[i], b.board[0]["inputs"]
    if side == LEFT:
        tom, sma, smd = plan["LSL_TOM"], plan["LSL_SMA"], plan["LSL_SMD"]
    else:
        tom, sma, smd = plan["LSR_TOM"], plan["LSR_SMA"], plan["LSR_SMD"]
    if inputs & smd:
        return SMD
    if inputs & sma:
        return SMA
    return TOM if inputs & tom else NO_LIMIT


@compiled
def _soft_function(b: BoardState, state: KernelState, i: int, side: int) -> int:
    """Return how the software limit on this side of axis `i` acts, if the setpoint is beyond it."""
    row = b.axis[i]
    if row["referenced"] == 0:
        return NO_LIMIT
    at = state.setpoint[i] - row["zero"]
    if side == LEFT:
        return int(row["soft_left"]) if at < row["sll"] else NO_LIMIT
    return int(row["soft_right"]) if at > row["slr"] else NO_LIMIT


@compiled
def limits_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Let the limits of axis `i` act on its new setpoint, before the servo sees it."""
    row = b.axis[i]
    last = state.work[0, i]
    if row["held"] != 0 and (state.setpoint[i] - row["held_at"]) * row["held"] <= 0.0:
        row["held"] = 0  # the profile is back inside
    blocked = 0
    hard = 0
    soft = 0
    for side in (LEFT, RIGHT):
        sign = -1 if side == LEFT else 1
        by_switch = _hard_function(b, i, side)
        by_software = _soft_function(b, state, i, side)
        hard |= side if by_switch != NO_LIMIT else 0
        soft |= side if by_software != NO_LIMIT else 0
        if row["closed"] == 0:
            continue
        into = (state.setpoint[i] - last) * sign > 0.0
        if TOM in (by_switch, by_software):
            blocked = sign
        if SMA in (by_switch, by_software) and into and row["held"] == 0:
            row["held"] = sign
            row["held_at"] = last
        if SMD in (by_switch, by_software) and into and row["stopping"] == 0:
            known = (row["hard_limit"] | row["soft_limit"]) & side
            _decelerate(b, state, i, known != 0)
    row["hard_limit"] = hard
    row["soft_limit"] = soft
    if row["held"] != 0:
        state.setpoint[i] = row["held_at"]
    state.servo.row[i]["blocked"] = blocked


@compiled
def _decelerate(b: BoardState, state: KernelState, i: int, refuse: bool) -> None:
    """Brake an axis that has come to its limit; an axis that stood there and was sent on does not move at all."""
    row = b.axis[i]
    moves = row["motion"] != IDLE and row["motion"] != WAITING
    velocity = axis_velocity(b, state, i)
    give_up(b, i)
    if not moves:
        return
    if refuse:
        last = state.work[0, i]
        state.base[i] -= state.setpoint[i] - last
        state.setpoint[i] = last
        rest(b, i)
    else:
        brake(b, i, state.base[i], velocity, row["sdec"])
