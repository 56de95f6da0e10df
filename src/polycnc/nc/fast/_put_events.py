"""Events of plain blocks: S, M codes of spindle and coolant, for which the path comes to rest, outputs in step."""

from __future__ import annotations

from polycnc.kernel import AxisLimits, Paths, Segments, append_wait, close_line, compiled
from polycnc.nc.fast._carried import (
    FUNCTIONS,
    IS_LASER,
    M_COLUMN,
    NONE,
    Q_COLUMN,
    S_COLUMN,
    events_of,
    is_output,
    is_power,
    output_of,
    words_fit,
)
from polycnc.nc.fast._work import EVENTS, FIRST_EVENT, SAYS_SENSE, SEEN, FastWork
from polycnc.nc.modal._actions import OUTPUT_VALUE

_NO_EVENT = -1


@compiled
def fits(paths: Paths, g: int, work: FastWork) -> bool:
    """Tell whether functions of a block are plain; the value of an output that is a laser's power becomes S."""
    seen, sense = work.said[SEEN], int(work.said[SAYS_SENSE])
    if not words_fit(seen, sense, work.value, work.carried):
        return False
    if not is_output(seen, sense):  # else its event would come before those that wait for a motion
        return bool(paths.row[g]["next_events"] == 0 or seen & FUNCTIONS == 0)
    if sense == OUTPUT_VALUE and is_power(work.value, work.carried):
        work.value[S_COLUMN] = work.value[Q_COLUMN]
        work.said[SEEN] = seen | 1 << S_COLUMN
    return True


@compiled
def put_events(seg: Segments, paths: Paths, g: int, limits: AxisLimits, work: FastWork, tag: int) -> bool:
    """Put the events of the block in `work`, and the time they take, into the queue; tell whether it has any."""
    seen, sense, value = work.said[SEEN], int(work.said[SAYS_SENSE]), work.value
    if is_output(seen, sense):
        _put_output(seg, paths, g, limits, work, tag)
        return False
    alone, code, time_s = events_of(seen, sense, value, work.carried)
    if alone < 0.0 and code < 0.0:
        return False
    if paths.row[g]["merged"] > 0:
        close_line(seg, paths, g, limits)
    if alone >= 0.0:
        _put(seg, paths, g, work, alone, NONE, tag)
    if code >= 0.0:
        beside = NONE
        if alone < 0.0 and seen & 1 << S_COLUMN and work.carried[IS_LASER] == 0.0:
            beside = value[S_COLUMN]
        _put(seg, paths, g, work, beside, code, tag)
        if time_s > 0.0:
            append_wait(seg, paths, g, time_s, _NO_EVENT, tag, 0)
    return True


@compiled
def _put(seg: Segments, paths: Paths, g: int, work: FastWork, speed: float, code: float, tag: int) -> None:
    append_wait(seg, paths, g, 0.0, work.said[FIRST_EVENT] + work.said[EVENTS], tag, 1)
    _note(work, speed, code, NONE, tag)


@compiled
def _note(work: FastWork, value: float, code: float, number: float, tag: int) -> None:
    made = work.said[EVENTS]
    work.events[made, 0], work.events[made, 1], work.events[made, 2] = value, code, number
    work.event_tags[made] = tag
    work.said[EVENTS] = made + 1


@compiled
def _put_output(seg: Segments, paths: Paths, g: int, limits: AxisLimits, work: FastWork, tag: int) -> None:
    """Let the output of the block come with the next motion; the power of a laser is S, which nobody is told."""
    if work.said[SEEN] & 1 << S_COLUMN:
        return
    number, value = output_of(work.said[SAYS_SENSE], work.value)
    path = paths.row[g]
    if path["merged"] > 0:
        close_line(seg, paths, g, limits)
    if path["next_events"] == 0:
        path["next_event"] = work.said[FIRST_EVENT] + work.said[EVENTS]
    path["next_events"] += 1
    _note(work, value, work.value[M_COLUMN], number, tag)
