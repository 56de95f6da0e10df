"""Cutter radius compensation (G40, G41, G42): a stage between interpreter and queue that shifts the path.

The interpreter stays with programmed positions. A plane move can only be emitted when the next one is
known, since the corner between them decides where it ends; so the stage holds back one plane move, and in
order after it whatever does not move in the plane.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from enum import Enum, IntEnum
from typing import Literal, NamedTuple

from polycnc.errors import ConfigurationError
from polycnc.nc.blocks._compensation_errors import refusal
from polycnc.nc.blocks._moves import Arc, Feed, Line, Move, Point, QueueItem, Spline, Wait
from polycnc.nc.blocks._offset_geometry import (
    COLLAPSED_MM,
    RETRACE,
    XY,
    Joint,
    Leg,
    arc_leg,
    bent_arc,
    chamfer,
    collapses,
    end_offset,
    join,
    leg_length,
    line_leg,
    offset_sweep,
    round_joint,
    smallest_offset_radius,
    start_offset,
    turn_cosine,
    turns_inside,
)

# A compensated move may come out this much shorter than nothing by rounding before it counts as reversed.
_ROUNDING_MM = 1e-10


class Side(IntEnum):
    """Where the tool goes, seen along the direction of travel."""

    LEFT = 1
    RIGHT = -1


class _Mode(Enum):
    OFF = "off"
    ENTERING = "entering"
    ON = "on"
    LEAVING = "leaving"


class Leads(NamedTuple):
    """Say how compensation begins and ends.

    The lead-in may be an arc; any straight move after the cancellation is the lead-out; a straight lead-in ends
    beside its own end, and the corner after it is one like others. A rapid move goes straight across an outside corner.
    A corner whose turn is a half one but for this sine is a path traced back.
    """

    by_arc: bool = False
    leaves_at_once: bool = False
    beside_itself: bool = False
    rapids_across: bool = False
    retrace: float = RETRACE


_STRAIGHT = Leads()


class SavedCompensation(NamedTuple):
    """Hold a stage that is active: what it does, and what it holds back."""

    mode: str
    plane: tuple[int, int, int]
    offset: float
    hold: tuple[Move | Wait, ...]
    move: Move | None
    leg: Leg | None
    pending: bool
    lead_in: bool
    at: XY | None
    leads: Leads


class _Plane(NamedTuple):
    """The axes of the plane that is compensated, and moves in it at compensated places."""

    p: int
    q: int
    normal: int

    def leg(self, item: Move | Wait) -> Leg | None:
        """Return the way of an item in the plane; None if it does not move there."""
        if isinstance(item, Wait):
            return None
        i, j, _ = self
        start, end = item.start, item.end
        if isinstance(item, Line):
            return line_leg(start[i], start[j], end[i], end[j])
        if item.plane != self:
            raise refusal("plane_change", item.line)
        return arc_leg(start[i], start[j], end[i], end[j], *item.center, item.sweep_rad)

    def end(self, item: Move) -> XY:
        """Return where an item ends in the plane."""
        return item.end[self.p], item.end[self.q]

    def line(self, item: Move, start: XY, end: XY) -> Line:
        """Return a straight move between two places, otherwise like an item."""
        first, last = self.point(item.start, start), self.point(item.end, end)
        return Line(first, last, item.feed, _is_rapid(item), item.exact_stop, item.line, item.tag)

    def arc(self, item: Arc, start: XY, end: XY, sweep: float) -> Arc:
        """Return an arc about the same centre between two places."""
        return replace(
            item, start=self.point(item.start, start), end=self.point(item.end, end), sweep_rad=sweep
        )

    def placed(self, item: Move | Wait, at: XY) -> QueueItem:
        """Return an item without plane motion at a place."""
        return item if isinstance(item, Wait) else self.line(item, at, at)

    def point(self, point: Point, at: XY) -> Point:
        """Return a point moved to a place in the plane."""
        values = list(point)
        values[self.p], values[self.q] = at
        return tuple(values)


class RadiusCompensation:
    """Shift plane moves by the tool radius, one stream of queue items in, one out.

    `outer` chooses outside corners: an arc about the corner, or the intersection of the offset curves (an arc
    still where the turn exceeds 90 degrees). Turns below `shallow_deg` always meet by intersection. `lead`
    names the shape of lead-in and lead-out; there is one: a straight move to the point beside the start of
    the contour, and one back from the point beside its end.
    """

    def __init__(
        self,
        *,
        outer: Literal["arc", "intersection"] = "arc",
        lead: Literal["tangent_perpendicular"] = "tangent_perpendicular",
        shallow_deg: float = 1.0,
    ) -> None:
        _check_settings(outer, lead, shallow_deg)
        self._shallow_cosine = math.cos(math.radians(shallow_deg))
        self._meet_cosine = self._shallow_cosine if outer == "arc" else 0.0
        self._plane = _Plane(0, 1, 2)
        self._offset = 0.0
        self._hold: list[Move | Wait] = []
        self.reset()

    def reset(self) -> None:
        """Drop everything held back and switch off, as a reset or the end of a program does."""
        self._mode = _Mode.OFF
        self.active = (
            False  # whether items must go through this stage: from `start` to the end of the lead-out
        )
        self._hold.clear()
        self._move: Move | None = None  # the last plane move, programmed
        self._leg: Leg | None = None
        self._pending = False  # that move has not been emitted yet
        self._lead_in = False  # that move is the lead-in
        self._leads = Leads()
        self._at: XY | None = None  # compensated place where the pending move starts or all motion has ended

    def copy(self) -> RadiusCompensation:
        """Return a stage in the same state, to go back to when a block is refused."""
        other = copy.copy(self)
        other._hold = self._hold.copy()
        return other

    def saved(self) -> SavedCompensation:
        """Return what this stage does and holds back."""
        return SavedCompensation(
            self._mode.value,
            self._plane,
            self._offset,
            tuple(self._hold),
            self._move,
            self._leg,
            self._pending,
            self._lead_in,
            self._at,
            self._leads,
        )

    @classmethod
    def of(cls, saved: SavedCompensation) -> RadiusCompensation:
        """Return a stage that does and holds back what one did."""
        made = cls()
        made._mode = _Mode(saved.mode)
        made.active = made._mode is not _Mode.OFF
        made._plane, made._offset = _Plane(*saved.plane), saved.offset
        made._hold = list(saved.hold)
        made._move, made._leg = saved.move, saved.leg
        made._pending, made._lead_in, made._at = saved.pending, saved.lead_in, saved.at
        made._leads = saved.leads
        return made

    def start(
        self,
        side: Side,
        radius_mm: float,
        plane: tuple[int, int, int],
        line: int = 0,
        leads: Leads = _STRAIGHT,
    ) -> None:
        """Start compensation (G41, G42); the next plane move is the lead-in.

        A negative radius is the other side. Repeating the words in force changes nothing; anything else while
        active is refused.

        Raises:
            CompensationError: another side, radius or plane while active, or a start before the lead-out.
        """
        if not math.isfinite(radius_mm):
            raise refusal("radius", line)
        offset = float(side * radius_mm)
        if self._mode in (_Mode.OFF, _Mode.ENTERING):
            self._plane = _Plane(*plane)
            self._offset = offset
            self._mode = _Mode.ENTERING
            self._leads = leads
            self.active = True
            return
        if plane != self._plane:
            raise refusal("plane_change", line)
        if self._mode is _Mode.LEAVING:
            raise refusal("no_lead_out", line)
        if offset * self._offset < 0.0:
            raise refusal("side_change", line)
        if offset != self._offset:
            raise refusal("radius_change", line)

    def cancel(self) -> None:
        """Cancel compensation (G40); the next plane move is the lead-out.

        Before the lead-in there is nothing to lead out of: it just switches off.
        """
        if self._mode is _Mode.ENTERING:
            self.reset()
        elif self._mode is _Mode.ON:
            self._mode = _Mode.LEAVING

    def beside(self, point: Sequence[float]) -> list[float]:
        """Return a programmed position moved beside the end of the last plane move, where there is one."""
        found = list(point)
        if self._leg is not None and self._mode in (_Mode.ON, _Mode.LEAVING):
            found[self._plane.p], found[self._plane.q] = end_offset(self._leg, self._offset)
        return found

    def flush(self) -> list[QueueItem]:
        """Give out everything held back; the last plane move ends beside its own end point. Stays active.

        Raises:
            CompensationError: the last move is too short for the tool (reason "interference").
        """
        if not self._pending or self._leg is None:
            return []
        out: list[QueueItem] = []
        self._emit_pending(end_offset(self._leg, self._offset), out)
        return out

    def push(self, item: QueueItem) -> list[QueueItem]:
        """Take one programmed item and return those whose compensated path is now known.

        Raises:
            CompensationError: the path cannot be followed (see docs/explanation/radius-compensation.md).
        """
        if self._mode is _Mode.OFF:
            return [item]
        if isinstance(item, Spline):
            raise refusal("spline", item.line)
        leg = self._plane.leg(item)
        if self._leads.leaves_at_once and self._mode is _Mode.LEAVING and isinstance(item, Line):
            return self._leave(item, self._plane.end(item))
        if leg is None or isinstance(item, Wait):
            if self._mode is _Mode.ENTERING:
                _check_level(item, self._leads, self._offset)
            if self._pending:
                self._hold.append(item)
                return []
            return [item if self._at is None else self._plane.placed(item, self._at)]
        if self._mode is _Mode.ENTERING:
            return self._enter(item, leg)
        if self._mode is _Mode.LEAVING:
            return self._leave(item, (leg.x1, leg.y1))
        if self._offset == 0.0:
            return [item]
        return self._follow(item, leg)

    def _enter(self, item: Move, leg: Leg) -> list[QueueItem]:
        if isinstance(item, Arc) and not self._leads.by_arc:
            raise refusal("lead_in_arc", item.line)
        if isinstance(item, Arc) and self._offset != 0.0:
            self._enter_by_arc(item, leg)
            return []
        self._mode = _Mode.ON
        if self._offset == 0.0:
            return [item]
        beside = self._leads.beside_itself
        if beside and leg_length(leg) <= abs(self._offset):
            raise refusal("lead_in_short", item.line, tool=abs(self._offset))
        self._move, self._leg, self._pending, self._lead_in = item, leg, True, not beside
        self._at = leg.x0, leg.y0
        return []

    def _enter_by_arc(self, item: Arc, leg: Leg) -> None:
        """Begin with an arc from where the tool is to beside the end of an arc, in its direction there."""
        at = leg.x0, leg.y0
        bent = _bent(leg, at, self._offset, item.line)
        self._mode, self._at = _Mode.ON, at
        self._move = replace(item, center=(bent.cx, bent.cy), sweep_rad=bent.sweep_rad)
        self._leg, self._pending, self._lead_in = bent, True, False

    def _leave(self, item: Move, end: XY) -> list[QueueItem]:
        if isinstance(item, Arc):
            raise refusal("lead_out_arc", item.line)
        if self._offset == 0.0 or self._at is None:
            self.reset()
            return [item]
        out = self.flush()
        out.append(self._plane.line(item, self._at, end))
        self.reset()
        return out

    def _follow(self, item: Move, leg: Leg) -> list[QueueItem]:
        if leg.sense and smallest_offset_radius(leg, self._offset) < -COLLAPSED_MM:
            radius = min(leg.radius0, leg.radius1)
            raise refusal("arc_too_small", item.line, arc=radius, tool=abs(self._offset))
        out: list[QueueItem] = []
        if self._pending and self._lead_in:
            self._emit_pending(start_offset(leg, self._offset), out)
        elif self._leg is not None and self._move is not None:
            turn = self._corner if self._pending else self._resume
            turn(self._move, self._leg, item, leg, out)
        self._move, self._leg, self._pending, self._lead_in = item, leg, True, False
        return out

    def _corner(self, before: Move, leg: Leg, after: Move, next_leg: Leg, out: list[QueueItem]) -> None:
        """Emit the pending move up to the corner, then what the corner itself needs."""
        rapid, across = _rapid_corner(before, after, self._leads)
        meet = min(self._meet_cosine, 0.0) if rapid else self._meet_cosine
        joint = join(leg, next_leg, self._offset, meet, self._leads.retrace)
        if joint is None:
            raise refusal("no_intersection", after.line, tool=abs(self._offset))
        if joint.sweep_rad == 0.0:
            self._emit_pending(joint.end, out)
        elif rapid or across:
            joint = chamfer(leg, next_leg, joint) if rapid else joint
            self._emit_pending(joint.end, out)
            self._straight(after, joint.start, out)
        else:
            self._emit_pending(joint.end, out)
            self._round(before, leg, after, next_leg, joint, out)

    def _resume(self, before: Move, leg: Leg, after: Move, next_leg: Leg, out: list[QueueItem]) -> None:
        """Go on from the point beside the last move's end, where a flush has left the tool."""
        if turn_cosine(leg, next_leg) >= self._shallow_cosine:
            self._straight(after, start_offset(next_leg, self._offset), out)
            return
        if turns_inside(leg, next_leg, self._offset, self._leads.retrace):
            raise refusal("stopped_inside", after.line)
        joint = round_joint(leg, next_leg, self._offset)
        if _is_rapid(before) and _is_rapid(after):
            joint = chamfer(leg, next_leg, joint)
            self._straight(after, joint.end, out)
            self._straight(after, joint.start, out)
        else:
            self._round(before, leg, after, next_leg, joint, out)

    def _emit_pending(self, end: XY, out: list[QueueItem]) -> None:
        """Emit the pending move, ending at `end`, and what is held after it."""
        item, leg, start = self._move, self._leg, self._at
        assert item is not None
        assert leg is not None
        assert start is not None
        if isinstance(item, Arc) and not collapses(leg, self._offset):
            sweep = offset_sweep(leg, start, end)
            radius = leg.radius0 - leg.sense * self._offset
            if _vanishes(sweep * leg.sense * radius, item.line):
                end = start
                out.append(self._plane.line(item, start, end))
            else:
                out.append(self._plane.arc(item, start, end, sweep))
        else:
            if isinstance(item, Line) and not self._lead_in:
                travel = (end[0] - start[0]) * leg.tx0 + (end[1] - start[1]) * leg.ty0
                end = start if _vanishes(travel, item.line) else end
            out.append(self._plane.line(item, start, end))
        self._at = end
        self._pending = False
        if self._hold:
            out.extend(self._plane.placed(held, end) for held in self._hold)
            self._hold.clear()

    def _round(
        self, before: Move, leg: Leg, after: Move, next_leg: Leg, joint: Joint, out: list[QueueItem]
    ) -> None:
        """Go round an outside corner on an arc, at the next move's feed (the last one's if that is rapid)."""
        assert self._at is not None
        feed = _path_feed(before, leg) if _is_rapid(after) else _path_feed(after, next_leg)
        out.append(
            Arc(
                start=self._plane.point(after.start, self._at),
                end=self._plane.point(after.start, joint.start),
                center=(next_leg.x0, next_leg.y0),
                sweep_rad=joint.sweep_rad,
                plane=self._plane,
                feed=feed,
                exact_stop=before.exact_stop and after.exact_stop,
                line=after.line,
                tag=after.tag,
            )
        )
        self._at = joint.start

    def _straight(self, after: Move, end: XY, out: list[QueueItem]) -> None:
        """Go straight to a point that the next move starts from, in that move's manner."""
        start = self._at
        assert start is not None
        if math.hypot(end[0] - start[0], end[1] - start[1]) <= _ROUNDING_MM:
            return
        first, last = self._plane.point(after.start, start), self._plane.point(after.start, end)
        out.append(Line(first, last, after.feed, _is_rapid(after), False, after.line, after.tag))
        self._at = end


def _check_settings(outer: str, lead: str, shallow_deg: float) -> None:
    if outer not in ("arc", "intersection"):
        raise ConfigurationError(f"outer corners cannot be {outer!r}", hint="Use 'arc' or 'intersection'.")
    if lead != "tangent_perpendicular":
        raise ConfigurationError(f"unknown lead {lead!r}", hint="Use 'tangent_perpendicular'.")
    if not 0.0 <= shallow_deg <= 90.0:
        raise ConfigurationError(f"shallow_deg is {shallow_deg}", hint="Use an angle from 0 to 90 degrees.")


def _rapid_corner(before: Move, after: Move, leads: Leads) -> tuple[bool, bool]:
    """Tell whether a corner between rapid moves is cut off, and whether a rapid move goes straight across it."""
    across = leads.rapids_across and _is_rapid(after)
    return _is_rapid(before) and _is_rapid(after) and not across, across


def _check_level(item: QueueItem, leads: Leads, offset: float) -> None:
    """Refuse a lead-in without a way in the plane, where the lead-in ends beside itself."""
    if leads.beside_itself and offset != 0.0 and isinstance(item, Line):
        raise refusal("lead_in_short", item.line, tool=abs(offset))


def _vanishes(travel_mm: float, line: int) -> bool:
    """Tell whether nothing but rounding is left of a compensated move. Refuse a reversed one."""
    if travel_mm < -_ROUNDING_MM:
        raise refusal("interference", line)
    return travel_mm <= _ROUNDING_MM


def _bent(leg: Leg, at: XY, offset: float, line: int) -> Leg:
    """Return the arc whose parallel begins where the tool is. Refuse one that has no place for it."""
    if smallest_offset_radius(leg, offset) <= COLLAPSED_MM:
        raise refusal("arc_too_small", line, arc=min(leg.radius0, leg.radius1), tool=abs(offset))
    bent = bent_arc(leg, at, offset)
    if bent is None or smallest_offset_radius(bent, offset) <= COLLAPSED_MM:
        raise refusal("lead_in_bend", line)
    return bent


def _path_feed(move: Move, leg: Leg) -> Feed:
    """Return the feed of a move as a path speed, also where the program gives the time of the move."""
    feed = move.feed
    if feed.duration_s <= 0.0:
        return feed
    return Feed(speed_mm_s=leg_length(leg) / feed.duration_s)


def _is_rapid(move: Move) -> bool:
    return isinstance(move, Line) and move.rapid
