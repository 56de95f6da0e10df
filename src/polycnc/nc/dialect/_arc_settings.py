"""How exact an arc of a program must be."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from polycnc.machine import StrictModel
from polycnc.nc.modal._modal import (
    ARC_INCH_TOLERANCE,
    ARC_MOST,
    ARC_RELATIVE,
    ARC_SHORT_RADIUS,
    ARC_TOLERANCE,
    Modal,
)


class Arcs(StrictModel):
    """How exact an arc must be."""

    tolerance_mm: Annotated[float, Field(ge=0)] = Field(
        default=0.01, description="How far the end point may lie off the circle."
    )
    relative_tolerance: Annotated[float, Field(ge=0, lt=0.1)] = Field(
        default=0.001, description="The same as a part of the radius; the larger of both counts."
    )
    inch_tolerance_mm: Annotated[float, Field(ge=0)] | None = Field(
        default=None,
        description="The same as `tolerance_mm` where G20 is in force; without it, `tolerance_mm`.",
    )
    most_tolerances: Annotated[float, Field(ge=1)] | None = Field(
        default=None, description="How many tolerances the end point may lie off however large the radius is."
    )
    radius_tolerance_mm: Annotated[float, Field(ge=0)] | None = Field(
        default=None,
        description="How far R may be too short to reach the end point; without it, `tolerance_mm`.",
    )
    turns: bool = Field(default=True, description="P says how many turns an arc makes.")
    no_center: Literal["line", "error"] = Field(
        default="error",
        description='An arc with neither centre nor radius: "line" goes straight, "error" refuses it.',
    )

    def put_in_force(self, modal: Modal) -> None:
        """Put the tolerances in force."""
        least, inch, radius = self.tolerance_mm, self.inch_tolerance_mm, self.radius_tolerance_mm
        modal.real[ARC_TOLERANCE] = least
        modal.real[ARC_INCH_TOLERANCE] = least if inch is None else inch
        modal.real[ARC_SHORT_RADIUS] = least if radius is None else radius
        modal.real[ARC_RELATIVE] = self.relative_tolerance
        modal.real[ARC_MOST] = math.inf if self.most_tolerances is None else self.most_tolerances
