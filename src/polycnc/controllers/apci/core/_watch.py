"""What polling programs look at, watched in the scan: the scan ends as soon as one of the values changes.

Only what a scan can change has a kind here; the rest changes by commands, between two calls of compiled code.
"""

from __future__ import annotations

import math

from polycnc.controllers.apci.core._motion import axis_velocity
from polycnc.controllers.apci.core._state import LEFT, RIGHT, WATCHES, BoardState
from polycnc.kernel import KernelState, compiled, entry

CI, CD, STATUS, SIGNALS, PROFILE_ENDED, ACTUAL, SETPOINT, ACTUAL_VELOCITY, VELOCITY = range(9)
ERRORS, OUTPUTS, USED, HEAD, TAIL, POINT, DIFFERENCE, TARGET, JOG_OVERRIDE, AT_INDEX = range(9, 19)

_LIMITS = LEFT | RIGHT


@compiled
def _status(b: BoardState, i: int) -> int:
    """Return a number that changes when the status word of axis `i` does."""
    row, plan, inputs = b.axis[i], b.plan[i], b.board[0]["inputs"]
    word = inputs & (plan["EO"] | plan["DR"] | plan["UI"] | plan["REF"])
    word = word << 4 | (row["hard_limit"] & _LIMITS) << 2 | (row["soft_limit"] & _LIMITS)
    for value in (row["position_error"], row["dhef"], row["cef"], row["pe"], row["closed"]):
        word = word << 1 | (1 if value != 0 else 0)
    for value in (row["in_position"], row["lpsf"], row["referenced"], row["saf"]):
        word = word << 1 | (1 if value != 0 else 0)
    return int(word)


@compiled
def _signals(b: BoardState, i: int) -> int:
    """Return a number that changes when the digital inputs of axis `i` do."""
    row = b.axis[i]
    word = b.board[0]["inputs"]
    for value in (row["index_now"], row["encoder_error"], row["index_seen"], row["strobe_seen"]):
        word = word << 1 | (1 if value != 0 else 0)
    return int(word)


@compiled
def _of_axis(b: BoardState, state: KernelState, kind: int, i: int) -> float:
    row = b.axis[i]
    if kind == STATUS:
        return float(_status(b, i))
    if kind == SIGNALS:
        return float(_signals(b, i))
    if kind == PROFILE_ENDED:
        return float(row["pe"])
    if kind == ACTUAL:
        return float(state.servo.actual[i] - row["shift"])
    if kind == SETPOINT:
        return float(state.setpoint[i] - row["shift"])
    if kind == ACTUAL_VELOCITY:
        return float(row["rv"])
    if kind == VELOCITY:
        return float(axis_velocity(b, i))
    if kind == USED:
        return float(row["used"])
    if kind == HEAD:
        return float(row["head"])
    if kind == TAIL:
        return float(row["tail"])
    if kind == POINT:
        return float(row["pcap_index"])
    if kind == DIFFERENCE:
        return float(state.servo.row[i]["following_error"])
    if kind == TARGET:
        return float(row["tp"])
    return float(row["jovr"] if kind == JOG_OVERRIDE else row["lpndx"])


@compiled
def _value(b: BoardState, state: KernelState, kind: int, i: int) -> float:
    board = b.board[0]
    if kind == CI:
        return float(b.ci[i])
    if kind == CD:
        return float(b.cd[i])
    if kind == ERRORS:
        return float(board["error_register"])
    if kind == OUTPUTS:
        return float(board["outputs"])
    return _of_axis(b, state, kind, i)


@entry
def note_watched(b: BoardState, state: KernelState, count: int) -> None:
    """Watch the first `count` rows of `watch` for another value than they have now."""
    b.board[0]["watched"] = min(count, WATCHES)
    for k in range(b.board[0]["watched"]):
        b.watched[k] = _value(b, state, b.watch[k, 0], b.watch[k, 1])


@compiled
def has_changed(b: BoardState, state: KernelState) -> bool:
    """Tell whether something that is watched has another value, be it the sign of a zero."""
    for k in range(b.board[0]["watched"]):
        now, before = _value(b, state, b.watch[k, 0], b.watch[k, 1]), b.watched[k]
        if now != before or math.copysign(1.0, now) != math.copysign(1.0, before):
            return True
    return False
