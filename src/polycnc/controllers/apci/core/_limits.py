"""Limit switches and software limits, with their three ways to act (Manual 002, 2.4).

TOM takes the drive away towards the limit, SMA holds the setpoint while the profile runs on, SMD brakes the axis and
lets it move only out again.
"""

from __future__ import annotations

import numpy as np

from polycnc.controllers.apci.core._motion import rest
from polycnc.controllers.apci.core._spool import give_up, leave_and_brake
from polycnc.controllers.apci.core._state import (
    BY_SYSTEM,
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
    at = state.setpoint[i] - row["shift"] - row["zero"]
    if side == LEFT:
        return int(row["soft_left"]) if at < row["sll"] else NO_LIMIT
    return int(row["soft_right"]) if at > row["slr"] else NO_LIMIT


@compiled
def limits_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Let the limits of axis `i` act on its new setpoint, before the servo sees it."""
    row = b.axis[i]
    last = state.work[0, i]
    blocked = 0
    hard = 0
    soft = 0
    for side in (LEFT, RIGHT):
        sign = -1 if side == LEFT else 1
        by_switch = _hard_function(b, i, side)
        by_software = _soft_function(b, state, i, side)
        hard |= side if by_switch != NO_LIMIT else 0
        soft |= side if by_software != NO_LIMIT else 0
        if by_switch == TOM or (by_software == TOM and row["closed"] != 0):
            blocked = sign
        if row["closed"] == 0:
            continue
        _let_go(state, row, i, sign, by_software == SMA)
        into = (state.setpoint[i] - last) * sign > 0.0
        if SMA in (by_switch, by_software) and into and row["held"] == 0:
            row["held"] = sign if by_switch == SMA else 2 * sign
            row["held_at"] = last
        if SMD in (by_switch, by_software) and into and row["stopping"] == 0:
            stood_there = (row["hard_limit"] | row["soft_limit"]) & side != 0
            _decelerate(b, state, i, stood_there and state.velocity[i] * sign <= 0.0)
    row["hard_limit"] = hard
    row["soft_limit"] = soft
    if row["held"] != 0 and row["closed"] != 0:
        state.setpoint[i] = row["held_at"]
    state.servo.row[i]["blocked"] = blocked


@compiled
def _let_go(state: KernelState, row: np.void, i: int, sign: int, by_software: bool) -> None:
    """End the hold on this side when the profile is back inside, or its software limit has been moved away."""
    if row["held"] * sign <= 0:
        return
    back = (state.setpoint[i] - row["held_at"]) * sign <= 0.0
    if back or (abs(row["held"]) == 2 and not by_software):
        row["held"] = 0


@compiled
def _decelerate(b: BoardState, state: KernelState, i: int, refuse: bool) -> None:
    """Brake an axis that has come to its limit; an axis that stood there and was sent on does not move at all."""
    row = b.axis[i]
    if refuse:
        moves = row["motion"] != IDLE and row["motion"] != WAITING
        give_up(b, i)
        rest(b, i)
        if moves:
            last = state.work[0, i]
            state.base[i] -= state.setpoint[i] - last
            state.setpoint[i] = last
    else:
        leave_and_brake(b, state, i, row["sdec"], BY_SYSTEM)
