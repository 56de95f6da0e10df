"""What a tool is: its length and radius for compensation, and its shape for what it cuts."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from polycnc.machine._config_axis import NotNegative
from polycnc.machine._toml import StrictModel

Size: TypeAlias = Annotated[float, Field(gt=0, le=1000)]


class ToolConfig(StrictModel):
    """Describe one tool."""

    length_mm: float = Field(default=0.0, description="Length of the tool.")
    radius_mm: NotNegative = Field(default=0.0, description="Radius of the tool.")
    wear_length_mm: float = Field(default=0.0, description="Added to the length.")
    wear_radius_mm: float = Field(default=0.0, description="Added to the radius.")
    tip: Annotated[int, Field(ge=0, le=9)] = Field(
        default=0,
        description="Where the tip of a turning tool lies, as FANUC controls number it; 0 and 9: its middle.",
    )
    x_mm: float = Field(default=0.0, description="Offset of a turning tool along X, a radius.")
    y_mm: float = Field(default=0.0, description="Offset along Y, in LinuxCNC's language.")
    z_mm: float = Field(default=0.0, description="Offset of a turning tool along Z.")
    wear_x_mm: float = Field(default=0.0, description="Added to the offset along X.")
    wear_z_mm: float = Field(default=0.0, description="Added to the offset along Z.")
    description: str = Field(default="", description="Any text.")
    shape: Literal["flat", "ball", "bull", "drill", "chamfer", "taper", "boring", "form"] | None = Field(
        default=None, description="What its lower end looks like, where stock is cut; absent: as remarks say."
    )
    corner_mm: NotNegative = Field(default=0.0, description="Radius at the end of a `bull` tool.")
    angle_deg: NotNegative = Field(
        default=0.0,
        description="Included angle of a point (`drill`, `chamfer`); `taper`: of a flank to the axis.",
    )
    tip_diameter_mm: NotNegative = Field(
        default=0.0, description="Flat diameter at the end of a `chamfer` or `taper` tool."
    )
    outline: tuple[tuple[NotNegative, NotNegative], ...] = Field(
        default=(),
        max_length=1000,
        description="Of a `form` tool: radii and heights (mm) from its middle out and up, and back to a neck where it "
        "undercuts: `[[0, 0], [10, 0], [10, 6], [4, 6]]` is a T-slot mill.",
    )
    flute_mm: Size | None = Field(default=None, description="How far up it cuts; absent: all the way.")
    shank: tuple[tuple[Size, Size], ...] = Field(
        default=(),
        description="Above what cuts, must touch nothing: pairs of height above the tip and diameter (mm), from below.",
    )
    holder: tuple[tuple[Size, Size], ...] = Field(
        default=(), description="What holds it, in the same way: `[[45, 20], [70, 32]]`."
    )
    insert: str = Field(
        default="", max_length=40, description="The insert of a turning tool by ISO 1832, like `CNMG120408`."
    )
    approach_deg: Annotated[float, Field(gt=0, lt=180)] = Field(
        default=95.0, description="Angle of the main edge of an insert to the axis."
    )
    width_mm: NotNegative = Field(
        default=0.0, description="Width of a grooving tool, whose tip is its corner towards -Z."
    )
    thread_deg: Annotated[float, Field(ge=0, lt=180)] = Field(
        default=0.0, description="Angle between the flanks of a threading tool."
    )
    teeth: Annotated[int, Field(ge=0, le=200)] = Field(
        default=0, description="How many edges cut in a turn, for the thickness of chips; 0: as remarks say."
    )
    left_hand: bool = Field(default=False, description="It cuts with M4.")
