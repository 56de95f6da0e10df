"""Events in step with motion: they come when the motion that they were put before begins, and stop nothing."""

from __future__ import annotations

from polycnc.kernel._jit import compiled
from polycnc.kernel._path import (
    FEED_S,
    HELD,
    MOST_PASSED,
    PASSED_AT_ONCE,
    PASSED_COUNT,
    PASSED_CYCLE,
    PASSED_EVENT,
    PASSED_FEED_S,
    PASSED_RAPID_S,
    RAPID_S,
    RUNNING,
    Paths,
    slot,
)
from polycnc.kernel._segments import Segments


@compiled
def note_begun(seg: Segments, paths: Paths, g: int, now: int) -> bool:
    """Note in `passed` the events of motions that have begun by cycle `now`; tell whether somebody has to look at them.

    That is at once where nobody lets events pass, else before `passed` is full. What finds no room comes with the last.
    """
    path = paths.row[g]
    begun = path["head"] + (1 if path["state"] == RUNNING or path["state"] == HELD else 0)
    noted = False
    while path["in_step"] > 0 and path["looked_at"] < begun:
        row = seg.row[slot(paths, g, path["looked_at"])]
        path["looked_at"] += 1
        if row["events"] > 0:
            path["in_step"] -= 1
            _note(paths, g, int(row["event"]), int(row["events"]), now)
            row["events"] = 0
            noted = True
    return bool(noted and (path["passes"] == 0 or 2 * path["passed"] >= MOST_PASSED))


@compiled
def _note(paths: Paths, g: int, event: int, events: int, now: int) -> None:
    path, totals = paths.row[g], paths.totals[g]
    if path["passed"] >= MOST_PASSED:
        paths.passed[g, MOST_PASSED - 1, PASSED_COUNT] += events
        return
    row = paths.passed[g, path["passed"]]
    row[PASSED_EVENT], row[PASSED_CYCLE], row[PASSED_AT_ONCE], row[PASSED_COUNT] = event, now, 0.0, events
    row[PASSED_FEED_S], row[PASSED_RAPID_S] = totals[FEED_S], totals[RAPID_S]
    path["passed"] += 1
