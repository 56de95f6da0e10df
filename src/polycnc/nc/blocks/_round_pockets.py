"""Circular pockets, milled from their centre outwards: G12 and G13.

Source: Haas mill operator's manual, "G12/G13 Circular Pocket Milling". Half circles lead out and back, and make the
spiral between the first circle and the last.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.nc.blocks import _feeds as feeds
from polycnc.nc.blocks import _limits as limits
from polycnc.nc.blocks import _motion as motion
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._handlers import carries_out, refuse_compensation
from polycnc.nc.blocks._moves import Arc, Line, Point
from polycnc.nc.blocks._tool_offsets import tool_data
from polycnc.nc.blocks._words import GWord, whole_number
from polycnc.nc.modal._actions import Action
from polycnc.nc.modal._modal import ABSOLUTE, MOTION, MOTION_RAPID, PLANE, PLANE_XY, length_scale

_MOST_HALVES = 20_000
_MOST_LAYERS = 1_000


@carries_out(Action.POCKET_CW, Action.POCKET_CCW)
def round_pocket(block: BlockContext, g: GWord) -> list[Line | Arc]:
    """Mill a circular pocket about the tool, or about X and Y, which ends in its centre at the depth.

    Raises:
        ProgramError: words are missing or do not fit each other, or something turns or offsets the path.
    """
    refuse_compensation(block, g)
    if int(block.after.modal.whole[PLANE]) != PLANE_XY or block.after.frame.active:
        raise block.problem(
            f"G{g.code} in another plane than XY, or while positions are turned or scaled",
            "Select G17, and cancel G16, G51, G68 and G101 first.",
            g.word,
        )
    radii = _radii(block, g)
    layers = _layers(block, g)
    values = motion.axis_words(block)
    in_plane = {axis: value for axis, value in values.items() if axis in block.after.plane[:2]}
    depth = {axis: value for axis, value in values.items() if axis not in in_plane}
    center = motion.target(block, in_plane)
    found: list[Line | Arc] = []
    at = block.start
    if center != at:
        found.append(motion.line(block, center, bool(block.after.modal.whole[MOTION] == MOTION_RAPID)))
        at = center
    for _ in range(layers):
        bottom = _at_depth(block, at, depth)
        if bottom != at:
            limits.check(block, bottom)
            found.append(Line(at, bottom, feeds.feed(block, at, bottom), False, block.exact_stop, block.line))
        found += _circles(block, bottom, radii, clockwise=g.action is Action.POCKET_CW)
        at = bottom
    return found


def _at_depth(block: BlockContext, at: Point, values: dict[int, float]) -> Point:
    """Return the point at the depth of axis words; ways add to where the tool is."""
    point = list(at)
    for axis, value in values.items():
        absolute = bool(block.after.modal.whole[ABSOLUTE])
        point[axis] = value + float(block.after.modal.offset[axis]) if absolute else point[axis] + value
    return tuple(point)


def _radii(block: BlockContext, g: GWord) -> list[float]:
    """Return the radii that the centre of the tool goes to, half a turn for each but the last."""
    scale = length_scale(block.after.modal)
    first, last, step = (
        None if value is None else value * scale for value in map(block.words.length, ("I", "K", "Q"))
    )
    state = block.after
    data = tool_data(block, state.tool if state.compensation_tool is None else state.compensation_tool)
    offset = data.radius_mm + data.wear_radius_mm
    if first is None or first - offset <= 0.0:
        what = "without I" if first is None else "with I not above the radius of the tool"
        raise block.problem(
            f"G{g.code} {what}", "I is the radius of the first circle.", block.words.first("I") or g.word
        )
    if (last is None) != (step is None):
        raise block.problem(
            f"G{g.code} with one of K and Q", "K is the last radius, Q what each turn adds.", g.word
        )
    found = [first - offset]
    if last is not None and step is not None:
        if step <= 0.0 or last < first or (last - first) / step > _MOST_HALVES / 2:
            raise block.problem(
                f"G{g.code}: Q does not lead from I to K",
                "Give Q above 0 and K not below I.",
                block.words.first("Q"),
            )
        halves = math.ceil((last - first) / (step / 2.0) - 1e-9)
        found += [min(first + step / 2.0 * each, last) - offset for each in range(1, halves + 1)]
    return found


def _layers(block: BlockContext, g: GWord) -> int:
    word = block.words.take("L")
    if word is None:
        return 1
    if block.after.modal.whole[ABSOLUTE]:
        raise block.problem(
            f"G{g.code} with L and absolute positions", "Select G91: each time is deeper by Z.", word
        )
    return whole_number(word, "a number of layers", block.problem, _MOST_LAYERS)


def _circles(block: BlockContext, center: Point, radii: list[float], *, clockwise: bool) -> Iterator[Arc]:
    p, q, r = block.after.plane
    turn = -math.pi if clockwise else math.pi

    def at(radius: float) -> Point:
        point = list(center)
        point[p] += radius
        return tuple(point)

    def arc(begin: float, end: float, middle: float, sweep: float) -> Arc:
        start, goal = at(begin), at(end)
        feed = feeds.feed(block, start, goal, straight=False)
        made = Arc(
            start, goal, (center[p] + middle, center[q]), sweep, (p, q, r), feed, block.exact_stop, block.line
        )
        for passed, what in limits.points(made):
            limits.check(block, passed, what)
        return made

    place, side = 0.0, 1.0
    for radius in radii:
        goal = side * radius
        yield arc(place, goal, (place + goal) / 2.0, turn)
        place, side = goal, -side
    yield arc(place, place, 0.0, 2.0 * turn)
    yield arc(place, 0.0, place / 2.0, turn)
