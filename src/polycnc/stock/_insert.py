"""Turning tools: inserts by their ISO designation, grooving and threading tools."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.stock._tool import LARGEST_MM

_ANGLES_DEG = {
    "A": 85.0, "B": 82.0, "C": 80.0, "D": 55.0, "E": 75.0, "H": 120.0, "K": 55.0, "L": 90.0, "M": 86.0,
    "O": 135.0, "P": 108.0, "S": 90.0, "T": 60.0, "V": 35.0, "W": 80.0,
}  # fmt: skip
"""Angle of the corner by the first letter. Source: ISO 1832."""
_ISO = re.compile(r"\b([A-Z])[A-Z]{3}[ -]?(\d{2})(\d{2})(\d{2})\b")
_HALF_TURN, _RIGHT = 180.0, 90.0
_ROUND_STEPS = 6
APPROACH_DEG = 95.0
"""Angle of the main edge to the way of the feed, where it is not said."""


class InsertKind(StrEnum):
    """What a turning tool is for."""

    TURNING = "turning"
    GROOVING = "grooving"
    THREADING = "threading"


@dataclass(frozen=True, slots=True)
class Insert:
    """Describe a turning tool by its outline in the plane of X and Z (mm, degree), cutting towards the axis.

    The end is `flat_mm` wide between two corners of radius `nose_mm`; the flanks rise from it with `left_deg` towards
    -Z and `right_deg` towards +Z, both from the axis, and are `edge_mm` long. `reach_mm` is how deep it can be in the
    material. An `inside` tool cuts away from the axis. `tip` is the way from the middle between the corners to the
    point that programs guide, along X and Z, each -1, 0 or 1 half widths.

    Raises:
        UsageError: a size that no tool has.
    """

    kind: InsertKind
    nose_mm: float
    left_deg: float
    right_deg: float
    edge_mm: float
    flat_mm: float = 0.0
    reach_mm: float = math.inf
    inside: bool = False
    tip: tuple[float, float] = (0.0, 0.0)
    left_hand: bool = field(default=False)

    def __post_init__(self) -> None:
        if not (0.0 <= self.nose_mm <= LARGEST_MM and 0.0 <= self.flat_mm <= LARGEST_MM):
            raise UsageError(
                f"a {self.kind} tool with a nose of {self.nose_mm:g} mm, {self.flat_mm:g} mm wide",
                hint=f"Sizes of tools are at most {LARGEST_MM:g} mm.",
            )
        if not (0.0 < self.edge_mm <= LARGEST_MM and self.reach_mm > 0.0):
            raise UsageError(
                f"a {self.kind} tool with an edge of {self.edge_mm:g} mm", hint="Give what is above 0 mm."
            )
        for angle in (self.left_deg, self.right_deg):
            if not 0.0 < angle <= _RIGHT:
                raise UsageError(
                    f"a {self.kind} tool with a flank of {angle:g} degrees",
                    hint="Flanks rise with more than 0 and at most 90 degrees from the axis.",
                )

    def outline(self) -> npt.NDArray[np.float64]:
        """Return half the flat, the radius, and of both flanks the angle (radian) and how far they reach along Z."""
        found = [0.5 * self.flat_mm, self.nose_mm]
        for angle in (self.left_deg, self.right_deg):
            radians = math.radians(min(angle, _RIGHT))
            steep = angle >= _RIGHT
            reach = self.nose_mm * (1.0 if steep else math.sin(radians))
            found += [radians, reach + (0.0 if steep else self.edge_mm * math.cos(radians))]
        return np.array(found)

    def middle(self) -> tuple[float, float]:
        """Return the way from the tip to the middle between the corners, along X and Z (mm)."""
        return -self.tip[0] * self.nose_mm, -self.tip[1] * (self.nose_mm + 0.5 * self.flat_mm)

    def plate(self, longest_mm: float) -> list[tuple[float, float]]:
        """Return the corners of its face, along X and Z from the tip (mm), with edges of at most `longest_mm`."""
        edge, (x, z), down = min(self.edge_mm, longest_mm), self.middle(), -1.0 if self.inside else 1.0
        found = []
        for side, angle_deg in ((1.0, self.right_deg), (-1.0, self.left_deg)):
            angle = math.radians(angle_deg)
            corner = z + side * 0.5 * self.flat_mm
            flank = [
                (
                    edge * math.sin(angle) - self.nose_mm * math.cos(angle),
                    corner + side * (edge * math.cos(angle) + self.nose_mm * math.sin(angle)),
                )
            ]
            turns = [angle * step / _ROUND_STEPS for step in range(_ROUND_STEPS, -1, -1)]
            flank += [
                (-self.nose_mm * math.cos(turn), corner + side * self.nose_mm * math.sin(turn))
                for turn in turns
            ]
            found += flank if side > 0.0 else flank[::-1]
        return [(x + down * up, along) for up, along in found]


def iso_insert(
    text: str,
    approach_deg: float = APPROACH_DEG,
    *,
    inside: bool = False,
    tip: tuple[float, float] = (0.0, 0.0),
) -> Insert | None:
    """Return the turning insert of an ISO designation in a text, like CNMG120408; None if there is none.

    The first letter is the angle of the corner, the numbers are edge length, thickness and nose radius (0.1 mm). Its
    main edge cuts towards -Z.

    Raises:
        UsageError: the angles leave no edge behind the corner.
    """
    found = _ISO.search(text.upper())
    if found is None:
        return None
    edge, nose = float(found[2]), 0.1 * float(found[4])
    if found[1] == "R":  # its length is its diameter
        return Insert(InsertKind.TURNING, 0.5 * edge, _RIGHT, _RIGHT, edge, inside=inside, tip=tip)
    angle = _ANGLES_DEG.get(found[1])
    if angle is None:
        return None
    right = _HALF_TURN - approach_deg - angle
    if not right > 0.0:
        raise UsageError(
            f"an insert {found[0]} with an approach of {approach_deg:g} degrees",
            hint=f"Its corner of {angle:g} degrees leaves no room behind: at most {_HALF_TURN - angle:g}.",
        )
    left = min(approach_deg, _RIGHT)
    return Insert(InsertKind.TURNING, nose, left, min(right, _RIGHT), edge, inside=inside, tip=tip)


def grooving_tool(
    width_mm: float,
    nose_mm: float = 0.0,
    reach_mm: float = math.inf,
    *,
    inside: bool = False,
    tip: tuple[float, float] = (0.0, 0.0),
) -> Insert:
    """Return a grooving or parting tool.

    Raises:
        UsageError: corners that are wider than the tool.
    """
    if not 0.0 <= 2.0 * nose_mm <= width_mm:
        raise UsageError(
            f"a grooving tool {width_mm:g} mm wide with corners of {nose_mm:g} mm",
            hint="Two corners fit into the width.",
        )
    edge = min(reach_mm, LARGEST_MM)
    flat = width_mm - 2.0 * nose_mm
    return Insert(InsertKind.GROOVING, nose_mm, _RIGHT, _RIGHT, edge, flat, reach_mm, inside, tip)


def threading_tool(
    angle_deg: float = 60.0,
    nose_mm: float = 0.0,
    edge_mm: float = 16.0,
    *,
    inside: bool = False,
    tip: tuple[float, float] = (0.0, 0.0),
) -> Insert:
    """Return a threading tool whose flanks include an angle.

    Raises:
        UsageError: a size that no tool has.
    """
    flank = _RIGHT - 0.5 * angle_deg
    return Insert(InsertKind.THREADING, nose_mm, flank, flank, edge_mm, inside=inside, tip=tip)
