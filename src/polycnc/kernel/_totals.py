"""What a path has traversed so far: its times, lengths and highest speed, segment by segment."""

from __future__ import annotations

from polycnc.kernel._jit import compiled, entry
from polycnc.kernel._path import (
    FEED_LENGTH,
    FEED_S,
    RAPID_LENGTH,
    RAPID_S,
    RUNNING,
    SEGMENTS,
    SPEED_PEAK,
    TOP_SPEED,
    WAIT_S,
    Paths,
    slot,
)
from polycnc.kernel._segments import RAPID, TURN, WAIT, Segments


@compiled
def account_time(seg: Segments, paths: Paths, g: int, passed_s: float) -> None:
    """Add time spent in the segment at `head`, and its highest speed, to the totals."""
    totals = paths.totals[g]
    row = seg.row[slot(paths, g, paths.row[g]["head"])]
    if row["kind"] == WAIT:
        totals[WAIT_S] += passed_s
    elif row["flags"] & RAPID:
        totals[RAPID_S] += passed_s
    else:
        totals[FEED_S] += passed_s
        if not row["flags"] & TURN:
            totals[TOP_SPEED] = max(totals[TOP_SPEED], paths.ramps[g, SPEED_PEAK])


@entry
def feed_time_s(seg: Segments, paths: Paths, dt: float) -> float:
    """Return how long all paths have moved at feed so far, the part of the running segment included."""
    total = 0.0
    for g in range(len(paths.row)):
        path = paths.row[g]
        total += paths.totals[g, FEED_S]
        if path["state"] == RUNNING:
            row = seg.row[slot(paths, g, path["head"])]
            if row["kind"] != WAIT and not row["flags"] & RAPID:
                total += path["lead"] + path["cycles"] * dt
    return float(total)


@compiled
def leave_segment(seg: Segments, paths: Paths, g: int, passed_s: float) -> None:
    """Go on to the next segment after `passed_s` in this one."""
    path, totals = paths.row[g], paths.totals[g]
    row = seg.row[slot(paths, g, path["head"])]
    account_time(seg, paths, g, passed_s)
    totals[SEGMENTS] += 1.0
    if not row["flags"] & TURN:  # degrees are no path length
        totals[RAPID_LENGTH if row["flags"] & RAPID else FEED_LENGTH] += row["length"]
    path["entry_share"] = 0.0
    path["entry_zone"] = 0.0
    path["head"] += 1
    if path["head"] >= path["tail"] or seg.row[slot(paths, g, path["head"])]["tag"] != row["tag"]:
        path["blocks"] += 1
