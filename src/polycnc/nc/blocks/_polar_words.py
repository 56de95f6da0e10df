"""Positions by radius and angle, `@` and `^`: from the zero of the work coordinates, in the plane of X and Y.

Source: LinuxCNC G-code manual, "Polar Coordinates".
"""

from __future__ import annotations

import math

from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.modal._actions import Group
from polycnc.nc.modal._modal import ABSOLUTE, NO_AXIS, PLANE, PLANE_XY, length_scale

POLAR_LETTERS = "@^"


def polar_words(block: BlockContext) -> dict[int, float]:
    """Take radius and angle, and return what X and Y words in their place would say (mm).

    What is not said of the two is as it is where the tool stands; with ways both count from there.

    Raises:
        ProgramError: they have no meaning here.
    """
    state, modal, words = block.after, block.after.modal, block.words
    word = words.first(*POLAR_LETTERS)
    if code := words.g.get(Group.NON_MODAL):
        raise block.problem(f"a polar position beside G{code.code}", "It belongs to a motion.", word)
    x, y = state.axis("X"), state.axis("Y")
    if modal.whole[PLANE] != PLANE_XY or NO_AXIS in (x, y):
        raise block.problem("a polar position outside the plane of X and Y", "Select G17 first.", word)
    if axis := words.first("X", "Y"):
        raise block.problem(f"a polar position and {axis.letter} in one block", "Write one of them.", axis)
    radius, angle_deg = words.value("@"), words.value("^")
    here = state.frame.back(state.here)
    old_radius = math.hypot(here[x], here[y])
    old_deg = math.degrees(math.atan2(here[y], here[x]))
    scale = length_scale(modal)
    absolute = bool(modal.whole[ABSOLUTE])
    if old_radius == 0.0 and (not absolute or angle_deg is None):
        raise block.problem("the tool is at zero, which has no angle", "Write @ and ^ with G90.", word)
    if absolute:
        to = old_radius if radius is None else radius * scale
        to_deg = old_deg if angle_deg is None else angle_deg
    else:
        to = old_radius + (radius or 0.0) * scale
        to_deg = old_deg + (angle_deg or 0.0)
    point = to * math.cos(math.radians(to_deg)), to * math.sin(math.radians(to_deg))
    if absolute:
        return {x: point[0], y: point[1]}
    return {x: point[0] - here[x], y: point[1] - here[y]}


def further_polar_places(block: BlockContext, count: int) -> tuple[tuple[float, float], ...]:
    """Return where the holes of a row after its first are (machine mm): each further out and further round.

    There are none where the block holds positions, or no polar ones; the words are not taken.
    """
    modal, words = block.after.modal, block.words
    x, y = block.after.axis("X"), block.after.axis("Y")
    if modal.whole[ABSOLUTE] or words.first(*POLAR_LETTERS) is None or NO_AXIS in (x, y):
        return ()
    out, turn = (words.by_letter[each].value if each in words.by_letter else 0.0 for each in POLAR_LETTERS)
    zero = float(modal.offset[x]), float(modal.offset[y])
    here = float(modal.position[x]) - zero[0], float(modal.position[y]) - zero[1]
    radius, angle = math.hypot(*here), math.atan2(here[1], here[0])
    scale = length_scale(modal)
    return tuple(
        (
            zero[0] + (radius + number * out * scale) * math.cos(angle + math.radians(number * turn)),
            zero[1] + (radius + number * out * scale) * math.sin(angle + math.radians(number * turn)),
        )
        for number in range(2, count + 1)
    )
