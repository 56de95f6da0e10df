"""Events of plain blocks: S, and the M codes of spindle and coolant, for which the path comes to rest."""

from __future__ import annotations

from polycnc.kernel import AxisLimits, Paths, Segments, append_wait, close_line, compiled
from polycnc.nc.fast._carried import IS_LASER, NONE, S_COLUMN, events_of
from polycnc.nc.fast._work import EVENTS, FIRST_EVENT, SAYS_SENSE, SEEN, FastWork

_NO_EVENT = -1


@compiled
def put_events(seg: Segments, paths: Paths, g: int, limits: AxisLimits, work: FastWork, tag: int) -> bool:
    """Put the events of the block in `work`, and the time they take, into the queue; tell whether it has any."""
    alone, code, time_s = events_of(work.said[SEEN], work.said[SAYS_SENSE], work.value, work.carried)
    if alone < 0.0 and code < 0.0:
        return False
    if paths.row[g]["merged"] > 0:
        close_line(seg, paths, g, limits)
    if alone >= 0.0:
        _put(seg, paths, g, work, alone, NONE, tag)
    if code >= 0.0:
        beside = NONE
        if alone < 0.0 and work.said[SEEN] & 1 << S_COLUMN and work.carried[IS_LASER] == 0.0:
            beside = work.value[S_COLUMN]
        _put(seg, paths, g, work, beside, code, tag)
        if time_s > 0.0:
            append_wait(seg, paths, g, time_s, _NO_EVENT, tag, 0)
    return True


@compiled
def _put(seg: Segments, paths: Paths, g: int, work: FastWork, speed: float, code: float, tag: int) -> None:
    made = work.said[EVENTS]
    work.events[made, 0], work.events[made, 1], work.event_tags[made] = speed, code, tag
    append_wait(seg, paths, g, 0.0, work.said[FIRST_EVENT] + made, tag, 1)
    work.said[EVENTS] = made + 1
