"""What a machine is: axes, path, times, tools, offsets and I/O, as one frozen, fully checked value.

A key that nothing reads does not exist here, so a file cannot hold a setting without effect.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from datetime import datetime
from typing import Annotated, Literal, TypeAlias

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from polycnc.errors import UsageError
from polycnc.machine._bounds import LARGEST_POSITION, LONGEST_BLOCK_S, SHORTEST_CYCLE_S
from polycnc.machine._config_axis import AnyAxis, NotNegative, Position, Rate, Share
from polycnc.machine._config_probe import SurfaceConfig, surface_problems
from polycnc.machine._config_programs import ProgramsConfig
from polycnc.machine._config_stock import FixtureConfig, StockConfig
from polycnc.machine._config_tool import ToolConfig
from polycnc.machine._toml import StrictModel, problem
from polycnc.machine._toml_locator import KeyPath
from polycnc.units import whole

EPOCH = datetime(2000, 1, 1)
WORK_OFFSET = re.compile(r"G[12]?5[4-9]|G59\.[1-3]")
IO_ADDRESS = re.compile(r"(IW|OW|I|O)(0|[1-9][0-9]*)")
Deviation: TypeAlias = Annotated[float, Field(ge=1e-9, le=LARGEST_POSITION)]
CornerShare: TypeAlias = Annotated[float, Field(gt=0, le=0.5)]
RoundingShare: TypeAlias = Annotated[float, Field(ge=0.1, le=0.5)]
RampShare: TypeAlias = Annotated[float, Field(ge=0.5, le=0.9)]
CORNER_RULES = ("junction_deviation_mm", "square_corner_mm_s", "corner_share")
Duration: TypeAlias = Annotated[float, Field(ge=0, le=LONGEST_BLOCK_S)]
Count: TypeAlias = Annotated[int, Field(ge=0, le=65536)]


def _number_key(value: object) -> object:
    """Turn the key of a numbered table, which TOML reads as text, into its number."""
    if isinstance(value, str):
        if not re.fullmatch(r"0|[1-9][0-9]*", value):
            raise problem(
                f"'{value}' is not a number", hint="write the number of the tool, for example [tools.12]"
            )
        return whole(value)
    return value


def _local(value: datetime) -> datetime:
    if value.tzinfo is not None:
        raise problem(
            "the machine's date and time have no time zone", hint="write it like 2000-01-01T00:00:00"
        )
    return value


def _look_ahead(value: object) -> object:
    if value == "unlimited" or (isinstance(value, int) and not isinstance(value, bool) and value >= 2):
        return value
    raise problem("'look_ahead_blocks' must be a whole number from 2 up", hint='or write "unlimited"')


def _path_tolerance(value: object) -> object:
    if value == "free":
        return value
    if isinstance(value, int | float) and not isinstance(value, bool) and 0.0 <= value <= LARGEST_POSITION:
        return value
    raise problem("'path_tolerance_mm' must be a number from 0 up", hint='or write "free"')


def _some_axes(value: tuple[AnyAxis, ...]) -> tuple[AnyAxis, ...]:
    if not value:
        raise problem("the machine has no axis", hint="add a table [[axis]] for each axis")
    return value


class PathConfig(StrictModel):
    """Describe how blocks are joined to a path."""

    look_ahead_blocks: Annotated[int | Literal["unlimited"], BeforeValidator(_look_ahead)] = Field(
        default="unlimited", description='How many blocks the look-ahead sees: 2 or more, or "unlimited".'
    )
    path_tolerance_mm: Annotated[float | Literal["free"], BeforeValidator(_path_tolerance)] = Field(
        default=0.0,
        description='How far the path may leave a corner, mm: 0 or more, or "free", a quarter of the shorter move.',
    )
    merge_mm: NotNegative = Field(
        default=0.0,
        description="Lines at one feed become one while the points between lie within this distance of it, mm; "
        "0: none. Only where corners are rounded.",
    )
    jerkrel: Share = Field(
        default=0.0,
        description="Share of each ramp that is S-shaped; 0 is a trapezoid. The mean acceleration stays.",
    )

    jerk_mm_s3: Rate | None = Field(
        default=None,
        description="Highest jerk along the path, which then goes in S-shaped ramps of up to seven phases; "
        "absent: any jerk.",
    )
    speed_limit_mm_s: Rate | None = Field(
        default=None, description="Highest speed along the path; absent: what its axes allow."
    )
    acceleration_limit_mm_s2: Rate | None = Field(
        default=None, description="Highest acceleration along the path; absent: what its axes allow."
    )
    junction_deviation_mm: Deviation | None = Field(
        default=None,
        description="Corners are passed, with a step in velocity, as fast as an arc that leaves them by this much; "
        "absent: as fast as the axes keep their acceleration in every cycle.",
    )
    square_corner_mm_s: Rate | None = Field(
        default=None,
        description="The same by the speed through a right angle, sharper corners slower and blunter ones faster.",
    )
    corner_share: CornerShare | None = Field(
        default=None,
        description="Corners that are not rounded take this part of what the axes' acceleration gives in a cycle, "
        "all along the lines beside them; those that an exact path rests in take it too.",
    )
    rounding_share: RoundingShare | None = Field(
        default=None,
        description="Part of the acceleration that ramps have on arcs that round corners, which need the rest to turn; "
        "absent: what the arc leaves them.",
    )
    last_share: RampShare | None = Field(
        default=None,
        description="Part of the acceleration that the last line has before a path with rounded corners rests; "
        "absent: all.",
    )
    rounding_gap_s: Annotated[float, Field(ge=0, le=1)] = Field(
        default=0.0,
        description="What is left of a line before such an arc has its share too, if it takes less than this.",
    )
    free_overlaps: bool = Field(
        default=False,
        description="In corners of helices the next motion begins as early, and speeds up as fast, as both ramps let "
        "it, even if that leaves the tolerance or passes the feed.",
    )
    minimum_cruise_share: Annotated[float, Field(ge=0, lt=1)] = Field(
        default=0.0,
        description="Part of the acceleration that is not counted on for the speeds between corners that are close "
        "together, so that ramps leave a part of the way; with one of the two rules above.",
    )

    @model_validator(mode="after")
    def _one_corner_rule(self) -> PathConfig:
        rules = [name for name in CORNER_RULES if getattr(self, name) is not None]
        if len(rules) > 1:
            raise problem(
                f"'{rules[0]}' and '{rules[1]}' are two rules for the same corners",
                hint="keep one of them",
                at=(rules[1],),
            )
        by_angle = self.junction_deviation_mm is not None or self.square_corner_mm_s is not None
        if self.minimum_cruise_share > 0.0 and not by_angle:
            raise problem(
                "'minimum_cruise_share' needs corners that are passed by their angle",
                hint="add 'square_corner_mm_s' or 'junction_deviation_mm'",
                at=("minimum_cruise_share",),
            )
        for name in ("rounding_share", "last_share", "rounding_gap_s", "free_overlaps"):
            if getattr(self, name) and self.corner_share is None:
                raise problem(f"'{name}' needs 'corner_share'", hint="add 'corner_share'", at=(name,))
        if self.corner_share is not None and (self.jerkrel > 0.0 or self.jerk_mm_s3 is not None):
            raise problem(
                "'corner_share' holds for ramps of even acceleration",
                hint="leave 'jerkrel' and 'jerk_mm_s3' out",
                at=("corner_share",),
            )
        return self

    @model_validator(mode="after")
    def _one_shape_of_ramps(self) -> PathConfig:
        if self.jerk_mm_s3 is not None and self.jerkrel > 0.0:
            raise problem(
                "'jerkrel' and 'jerk_mm_s3' are two shapes for the same ramps",
                hint="keep one of them",
                at=("jerkrel",),
            )
        return self

    @property
    def tolerance_mm(self) -> float:
        """Return how far the path may leave a corner, mm; inf if it is free."""
        return math.inf if self.path_tolerance_mm == "free" else self.path_tolerance_mm

    @property
    def look_ahead_limit(self) -> int | None:
        """Return the number of blocks the look-ahead sees, None if unlimited."""
        return None if self.look_ahead_blocks == "unlimited" else self.look_ahead_blocks


class TimesConfig(StrictModel):
    """Say how long the functions take that are not motion."""

    tool_change_s: Duration = Field(default=0.0, description="Time of a tool change, s.")
    spindle_start_s: Duration = Field(default=0.0, description="Time the spindle takes to start or stop, s.")
    auxiliary_s: Duration = Field(default=0.0, description="Time of any other auxiliary function, s.")


class SpindleConfig(StrictModel):
    """Describe the spindle."""

    max_rpm: Rate = Field(default=24000.0, description="Highest spindle speed, revolutions per minute.")
    acceleration_rpm_s: Rate | None = Field(
        default=None,
        description="Change of the spindle speed in a second; absent: every change takes `times.spindle_start_s`.",
    )
    reached_share: Share = Field(
        default=0.0,
        description="Deviation from the commanded speed that counts as reached, as a share of it.",
    )
    orientation_rpm: Rate = Field(
        default=60.0, description="Speed at which the spindle is brought to an angle."
    )
    orientation_deg: float = Field(default=0.0, description="Angle at which an oriented spindle stops.")
    laser: bool = Field(
        default=False,
        description="S is the power of a laser: S, M3, M4 and M5 act without a stop, where the next move begins.",
    )

    @model_validator(mode="after")
    def _lasers_do_not_turn(self) -> SpindleConfig:
        if self.laser and self.acceleration_rpm_s is not None:
            raise problem(
                "'acceleration_rpm_s' has no meaning for a laser",
                hint="leave it out, or take 'laser' out",
                at=("acceleration_rpm_s",),
            )
        return self


class IoConfig(StrictModel):
    """Size the I/O image and name points of it."""

    inputs: Count = Field(default=64, description="Number of input bits.")
    outputs: Count = Field(default=64, description="Number of output bits.")
    input_words: Count = Field(default=16, description="Number of input words.")
    output_words: Count = Field(default=16, description="Number of output words.")
    points: dict[str, str] = Field(
        default={}, description='Name of a point = its address: "I3", "O5" (bits), "IW2", "OW1" (words).'
    )

    @model_validator(mode="after")
    def _points_exist(self) -> IoConfig:
        sizes = {"I": self.inputs, "O": self.outputs, "IW": self.input_words, "OW": self.output_words}
        for name, address in self.points.items():
            found = IO_ADDRESS.fullmatch(address)
            if found is None:
                raise problem(
                    f"'{address}' is not an address",
                    hint='write it like "I3", "O5", "IW2" or "OW1"',
                    at=("points", name),
                )
            if whole(found[2]) >= sizes[found[1]]:
                raise problem(
                    f"'{address}' does not exist: there are {sizes[found[1]]} of this sort",
                    hint="numbers start at 0; raise the size in [io] or use a lower number",
                    at=("points", name),
                )
            if IO_ADDRESS.fullmatch(name):
                raise problem(
                    f"'{name}' is an address, not a name", hint="use another name", at=("points", name)
                )
        return self


class MachineConfig(StrictModel):
    """Describe a machine completely; see docs/reference/machine-file.md for the keys."""

    name: str = Field(min_length=1, description="Name of the machine.")
    description: str = Field(default="", description="Any text.")
    cycle_s: Annotated[float, Field(ge=SHORTEST_CYCLE_S, le=1)] = Field(
        default=0.001, description="Length of a control cycle, s."
    )
    epoch: Annotated[datetime, AfterValidator(_local)] = Field(
        default=EPOCH, description="Date and time of the machine's clock at cycle 0."
    )
    axes: Annotated[tuple[AnyAxis, ...], AfterValidator(_some_axes)] = Field(
        alias="axis", description="The axes, see `[[axis]]`."
    )
    path: PathConfig = Field(default=PathConfig(), description="How blocks are joined, see `[path]`.")
    times: TimesConfig = Field(default=TimesConfig(), description="Times of functions, see `[times]`.")
    spindle: SpindleConfig = Field(default=SpindleConfig(), description="The spindle, see `[spindle]`.")
    tools: dict[Annotated[int, BeforeValidator(_number_key)], ToolConfig] = Field(
        default={}, description="The tools by number, see `[tools.N]`."
    )
    offsets: dict[str, dict[str, Position]] = Field(
        default={},
        description="Work offsets G54 to G59, G59.1 to 3, G154 to 9, G254 to 9, like `G54 = { X = 10, Y = 0 }`.",
    )
    start: dict[str, Position] = Field(
        default={}, description="Position of each axis at cycle 0, like `X = 10`; absent: its home position."
    )
    io: IoConfig = Field(default=IoConfig(), description="The I/O image, see `[io]`.")
    programs: ProgramsConfig = Field(
        default=ProgramsConfig(), description="What programs find beside them, see `[programs]`."
    )
    surfaces: tuple[SurfaceConfig, ...] = Field(
        default=(), alias="surface", description="What a probe meets, see `[[surface]]`."
    )
    stock: StockConfig | None = Field(default=None, description="What programs cut, see `[stock]`.")
    fixtures: tuple[FixtureConfig, ...] = Field(
        default=(), alias="fixture", description="What tools must not touch, see `[[fixture]]`."
    )

    @model_validator(mode="after")
    def _fits_together(self) -> MachineConfig:
        problems = self._axis_problems, self._offset_problems, self._start_problems
        for error in (error for find in problems for error in find()):
            raise error
        for error in surface_problems(self.surfaces, self.axis_names):
            raise error
        return self

    def _axis_problems(self) -> Iterator[Exception]:
        for index, name in enumerate(self.axis_names):
            if name in self.axis_names[:index]:
                yield problem(f"there are two axes '{name}'", hint="rename one", at=("axis", index, "name"))

    def _offset_problems(self) -> Iterator[Exception]:
        for name, offset in self.offsets.items():
            if not WORK_OFFSET.fullmatch(name):
                yield problem(
                    f"'{name}' is not a work offset",
                    hint="use G54 to G59, G59.1 to G59.3, G154 to G159 or G254 to G259",
                    at=("offsets", name),
                )
            yield from self._unknown_axes(offset, ("offsets", name))

    def _start_problems(self) -> Iterator[Exception]:
        yield from self._unknown_axes(self.start, ("start",))
        for index, axis in enumerate(self.axes):
            low, high = axis.soft_limits
            position = self.start.get(axis.name, axis.home)
            if not low <= position <= high:
                home_key = f"home_{axis.unit}"
                has_home = home_key in axis.model_fields_set
                yield problem(
                    f"axis '{axis.name}' would start at {position}, outside its soft limits [{low}, {high}]",
                    hint=f"set {home_key}, or {axis.name} in [start], to a position inside",
                    at=("start", axis.name)
                    if axis.name in self.start
                    else ("axis", index, home_key if has_home else f"soft_limits_{axis.unit}"),
                )

    def _unknown_axes(self, names: Iterable[str], at: KeyPath) -> Iterator[Exception]:
        for name in names:
            if name not in self.axis_names:
                yield problem(
                    f"there is no axis '{name}'",
                    hint=f"the axes are {', '.join(self.axis_names)}",
                    at=(*at, name),
                )

    def _repr_html_(self) -> str:
        """Return the axes as a table, for notebooks."""
        from polycnc.web import html_table

        rows = [
            (axis.name, axis.kind, f"{axis.vmax:g} {axis.unit}/s", f"{axis.amax:g} {axis.unit}/s²")
            for axis in self.axes
        ]
        caption = f"{self.name}: {self.description}".rstrip(": ")
        return html_table(caption, ("axis", "kind", "vmax", "amax"), rows)

    @property
    def axis_names(self) -> tuple[str, ...]:
        """Return the names of the axes, in their order."""
        return tuple(axis.name for axis in self.axes)

    @property
    def start_positions(self) -> tuple[float, ...]:
        """Return where each axis is at cycle 0 (mm or deg), in the order of the axes."""
        return tuple(self.start.get(axis.name, axis.home) for axis in self.axes)

    def axis_index(self, name: str) -> int:
        """Return the place of the axis called `name`, from 0.

        Raises:
            UsageError: There is no such axis.
        """
        if name not in self.axis_names:
            raise UsageError(f"there is no axis '{name}'", hint=f"the axes are {', '.join(self.axis_names)}")
        return self.axis_names.index(name)

    def work_offset(self, name: str) -> tuple[float, ...]:
        """Return a work offset as one value per axis (mm or deg); zeros if it is not configured."""
        offset = self.offsets.get(name, {})
        return tuple(offset.get(axis.name, 0.0) for axis in self.axes)
