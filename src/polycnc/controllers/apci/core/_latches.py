"""Latched positions: every so many scans, by an input, by a strobe, by the encoder's index (Manual 002, 4.4.82)."""

from __future__ import annotations

from polycnc.controllers.apci.core._registers import Digi
from polycnc.controllers.apci.core._state import BoardState
from polycnc.kernel import KernelState, compiled

# Where a latched position came from, 0 for none; a higher one is kept until it is read.
BY_INPUT = 1
BY_SCAN = 2
BY_STROBE = 3

# Signals of the encoder.
INDEX, _INDEX_SEEN, _STROBE_SEEN = map(int, (Digi.index, Digi.index_latched, Digi.strobe_latched))


@compiled
def _latch(b: BoardState, i: int, position: float, source: int) -> None:
    row = b.axis[i]
    if source >= row["lp_source"]:
        row["lp"] = position
        row["lp_source"] = source
    if source != BY_STROBE:
        row["lpsf"] = 1


@compiled
def latches_cycle(b: BoardState, state: KernelState, i: int) -> None:
    """Look what axis `i` has latched in this scan, and whether its position error is too large."""
    row, plan, inputs = b.axis[i], b.plan[i], b.board[0]["inputs"]
    at = state.servo.actual[i] - row["shift"] - row["zero"]
    row["rv"] = state.servo.row[i]["actual_velocity"]
    if row["latch_scans"] > 0:
        row["latch_count"] += 1
        if row["latch_count"] >= row["latch_scans"]:
            row["latch_count"] = 0
            _latch(b, i, at, BY_SCAN)
    by_input = 1 if inputs & plan["LP"] else 0
    if by_input > row["lp_level"]:
        _latch(b, i, at, BY_INPUT)
    row["lp_level"] = by_input
    strobe = 1 if inputs & plan["strobe"] else 0
    if strobe > row["strobe_level"]:
        _latch(b, i, at, BY_STROBE)
        row["signals"] |= _STROBE_SEEN
    row["strobe_level"] = strobe
    marks = state.switches.marks[i]
    row["signals"] &= ~INDEX
    if marks["index_crossed"] != 0:
        row["lpndx"] = marks["index_position"] - row["shift"] - row["zero"]
        row["signals"] |= INDEX | _INDEX_SEEN
    error = abs(state.servo.row[i]["following_error"])
    row["position_error"] = 1 if row["mpe"] > 0.0 and row["closed"] != 0 and error > row["mpe"] else 0
    row["in_position"] = 1 if row["ipw"] > 0.0 and row["pe"] != 0 and error < row["ipw"] else 0
