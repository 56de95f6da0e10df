"""Hand entries to the axes' queues; a straight line in one call, because contours are many short lines."""

from __future__ import annotations

import math

from polycnc.controllers.apci.core._look_ahead import look_ahead
from polycnc.controllers.apci.core._motion import position_at
from polycnc.controllers.apci.core._registers import ErrorReg, ModeReg
from polycnc.controllers.apci.core._spool import bytes_of, free_entry
from polycnc.controllers.apci.core._state import (
    BY_SYSTEM,
    JOG,
    MOVE,
    SPECIAL,
    SPOOL_BYTES,
    SPOOL_ENTRIES,
    TABLE,
    BoardState,
    Floats,
    Whole,
)
from polycnc.kernel import LINE, VELOCITY, compiled, entry, profile_at, set_line

HARDLY_ANY = 1e-9  # path units: a distance or a radius below it is none

_OVERRUN = int(ErrorReg.errSpoolerOverrun)
_LOAD_ERROR = int(ErrorReg.SpoolerLoadError)
_ZERO_PROFILE = int(ErrorReg.ZeroProfile)
_TOO_LESS = int(ErrorReg.SpoolerDeepTooLess)
_LOOK_AHEAD = int(ModeReg.lookahead)
_MAX_CHECK = int(ModeReg.maxcheck)


@entry
def new_entry(b: BoardState) -> int:
    """Take an entry from the free list; -1, with the reason in the error register, if there is none."""
    board = b.board[0]
    if board["free"] <= 0:
        board["error_register"] |= _OVERRUN
        return -1
    board["free"] -= 1
    e = int(b.free[board["free"]])
    row = b.entry[e]
    row["started"] = -1
    row["index"] = -1
    row["out"] = math.nan
    row["join"] = 0.0
    row["begun"] = 0
    row["points"] = 0
    return e


@entry
def give_back(b: BoardState, e: int) -> None:
    """Return an entry that was not used."""
    free_entry(b, e)


@compiled
def rest_position(b: BoardState, base: Floats, i: int) -> float:
    """Return the machine position at which axis `i` comes to rest; the present one if it does not by itself."""
    row, phases = b.axis[i], b.phases[i]
    moves = row["motion"] == JOG or row["motion"] == MOVE
    if not moves or phases[row["phases"], VELOCITY] != 0.0 or not math.isfinite(row["duration"]):
        return float(base[i])
    place, _, _ = profile_at(phases, row["phases"], row["duration"])
    return position_at(b, i, place)


@entry
def queued_position(b: BoardState, base: Floats, i: int) -> float:
    """Return the machine position of axis `i` after everything it has queued; `base[n]` are those they have now."""
    row = b.axis[i]
    for count in range(row["tail"] - 1, row["head"] - 1, -1):
        e = int(b.ring[i, count % SPOOL_ENTRIES])
        if e == row["entry"] and row["direct"] == 0 and row["stopping"] != 0:
            break
        if b.entry[e]["kind"] == MOVE:
            return float(b.seg.end[e, i] / b.weight[e, i])
        if b.entry[e]["kind"] == TABLE:
            return float(b.entry[e]["value"])
    return rest_position(b, base, i)


@compiled
def _refusal(b: BoardState, e: int) -> int:
    """Return the error that keeps entry `e` out of the queues of its axes, -1 for an open loop, 0 for none."""
    mask = b.entry[e]["mask"]
    for i in range(b.axis.shape[0]):
        row = b.axis[i]
        if mask >> i & 1 == 0:
            continue
        if row["closed"] == 0:
            return -1
        if row["stopping"] == BY_SYSTEM:
            return _LOAD_ERROR
        if row["tail"] - row["head"] >= SPOOL_ENTRIES or row["used"] + bytes_of(b, e) > SPOOL_BYTES:
            return _OVERRUN
    return 0


@entry
def queue_entry(b: BoardState, e: int, velocity_unit: float) -> bool:
    """Put entry `e` at the end of the queues of its axes; False, with nothing queued, if one does not take it."""
    board, this = b.board[0], b.entry[e]
    refusal = _refusal(b, e)
    if refusal != 0:
        if refusal > 0:
            board["error_register"] |= refusal
        free_entry(b, e)
        return False
    for i in range(b.axis.shape[0]):
        if this["mask"] >> i & 1:
            row = b.axis[i]
            b.ring[i, row["tail"] % SPOOL_ENTRIES] = e
            row["tail"] += 1
            row["used"] += bytes_of(b, e)
            row["points"] += this["points"]
    if this["kind"] != SPECIAL and board["mode_register"] & _LOOK_AHEAD:
        look_again(b, this["mask"], velocity_unit)
    return True


@compiled
def look_again(b: BoardState, mask: int, velocity_unit: float) -> None:
    """Look ahead over the queues of these axes."""
    for i in range(b.axis.shape[0]):
        if mask >> i & 1 and look_ahead(b, i, velocity_unit):
            b.board[0]["error_register"] |= _TOO_LESS


@entry
def look_ahead_again(b: BoardState, mask: int, velocity_unit: float) -> None:
    """Look ahead over the queues of these axes, because something in them has changed."""
    if b.board[0]["mode_register"] & _LOOK_AHEAD:
        look_again(b, mask, velocity_unit)


@compiled
def fill_move(b: BoardState, e: int, axes: Whole, weight: Floats, ac: float, vl: float, tvl: float) -> None:
    """Make entry `e`, which has its path, a move of `axes`; numbers in path units."""
    this = b.entry[e]
    mask = 0
    for k in range(axes.shape[0]):
        mask |= 1 << axes[k]
    for i in range(b.axis.shape[0]):
        b.weight[e, i] = 1.0
    for k in range(axes.shape[0]):
        b.weight[e, axes[k]] = weight[k]
    this["kind"] = MOVE
    this["mask"] = mask
    this["refs"] = axes.shape[0]
    this["ac"] = ac
    this["vl"] = vl
    this["tvl"] = tvl


@compiled
def _keep_axis_limits(
    b: BoardState, e: int, axes: Whole, velocity_unit: float, acceleration_unit: float
) -> None:
    """Lower velocity and acceleration of a line to MaxVel and MaxAcc of its axes."""
    this, length = b.entry[e], b.seg.row[e]["length"]
    for k in range(axes.shape[0]):
        i = axes[k]
        part = abs(b.seg.end[e, i] - b.seg.start[e, i]) / length
        row = b.axis[i]
        if part > 0.0 and row["MaxVel"] > 0.0:
            most = row["MaxVel"] * velocity_unit / part
            this["vl"] = min(this["vl"], most)
            this["tvl"] = max(min(this["tvl"], most), -most)
        if part > 0.0 and row["MaxAcc"] > 0.0:
            this["ac"] = min(this["ac"], row["MaxAcc"] * acceleration_unit / part)


@entry
def spool_move(
    b: BoardState,
    e: int,
    axes: Whole,
    weight: Floats,
    ac: float,
    vl: float,
    tvl: float,
    velocity_unit: float,
    acceleration_unit: float,
) -> bool:
    """Make entry `e`, which has its path, a move of `axes` and put it into their queues."""
    fill_move(b, e, axes, weight, ac, vl, tvl)
    if b.seg.row[e]["kind"] == LINE and b.board[0]["mode_register"] & _MAX_CHECK:
        _keep_axis_limits(b, e, axes, velocity_unit, acceleration_unit)
    return queue_entry(b, e, velocity_unit)


@entry
def spool_line(
    b: BoardState,
    base: Floats,
    axes: Whole,
    weight: Floats,
    ends: Floats,
    relative: bool,
    ac: float,
    vl: float,
    tvl: float,
    velocity_unit: float,
    acceleration_unit: float,
    index: int,
) -> bool:
    """Queue a straight line of `axes` to `ends`, path units from the axes' origins or from where their queues end."""
    e = new_entry(b)
    if e < 0:
        return False
    start, end = b.work[0], b.work[1]
    for i in range(b.axis.shape[0]):
        start[i] = 0.0
        end[i] = 0.0
    for k in range(axes.shape[0]):
        i = axes[k]
        start[i] = queued_position(b, base, i) * weight[k]
        end[i] = ends[k] + (start[i] if relative else (b.axis[i]["zero"] + b.axis[i]["offset"]) * weight[k])
    if not line_between(b, e, start, end):
        give_back(b, e)
        return False
    b.entry[e]["index"] = index
    return spool_move(b, e, axes, weight, ac, vl, tvl, velocity_unit, acceleration_unit)


@compiled
def line_between(b: BoardState, e: int, start: Floats, end: Floats) -> bool:
    """Make entry `e` a straight line; False, with the reason in the error register, if there is none."""
    found = set_line(b.seg.row, b.seg.start, b.seg.end, e, b.feed_axis, start, end, 0.0, 0, 0)
    if not found or b.seg.row[e]["length"] < HARDLY_ANY:
        b.board[0]["error_register"] |= _ZERO_PROFILE
        return False
    return bool(math.isfinite(b.seg.row[e]["length"]))
