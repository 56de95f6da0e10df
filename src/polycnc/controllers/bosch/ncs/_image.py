"""What a control shows across the NCS coupling: its axes, spindles and channels as plain data.

The control that is asked keeps an `Image` up to date; the table of data services reads nothing else. Lengths are mm,
angles deg, feeds mm/min, speeds rev/min and potentiometers 0.01 % throughout, as the services answer them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag
from typing import Literal

AxisKind = Literal["linear", "rotary", "hirth", "spindle"]


class Unit(IntEnum):
    """Units of axes and coordinates (MCODS 18, 53, 61, 81)."""

    INCH = 0
    METRIC = 1
    DEGREE = 2
    NONE = 3
    HIRTH = 4


class Mode(IntEnum):
    """Operation modes of channels and axes (MCODS 31 and 48, MCOPS 7)."""

    NONE = 0
    JOG = 1
    REFERENCE = 2
    MDI = 4
    AUTOMATIC = 5
    PROGRAM_BLOCK = 6
    SINGLE_STEP = 7
    SINGLE_BLOCK = 10
    RETURN_TO_PATH = 11
    DEBUG_BLOCK = 12
    DEBUG_AUTOMATIC = 13
    JOG_WORKPIECE = 14


class Sav(IntEnum):
    """States of block preparation (MCODS 32, first element)."""

    INACTIVE = 1
    READY = 2
    ACTIVE = 3
    ERROR = 6
    RESET = 8
    PREPARING = 9
    CANCELLING = 10
    AT_START = 11
    BUFFER_EMPTY = 12


class Ipo(IntEnum):
    """States of the interpolator (MCODS 32, second element)."""

    RUNNING = 1
    RUNNING_DOWN = 2
    STOPPED = 3


class Wait(IntFlag):
    """Reasons why a channel waits (MCODS 87)."""

    DWELL = 1 << 0
    AUXILIARY = 1 << 1
    TRANSFER_INHIBIT = 1 << 2
    FEED_ZERO = 1 << 3
    PROGRAM_STOP = 1 << 4
    FEED_HOLD = 1 << 5
    FEED_INHIBIT = 1 << 6
    CUSTOMER_INHIBIT = 1 << 7
    SYNCHRONOUS_STOP = 1 << 8
    AXIS_EXCHANGE = 1 << 9
    PERMANENT_VARIABLE = 1 << 10
    SIGNAL_ACTIVE = 1 << 11
    SIGNAL_OR_TIME = 1 << 12
    DATA_SERVICE = 1 << 13


class SpindleMotion(IntEnum):
    """What a spindle does (MCODS 63)."""

    NONE = 0
    CLOCKWISE = 1
    CLOCKWISE_COOLANT = 2
    COUNTER_CLOCKWISE = 3
    COUNTER_CLOCKWISE_COOLANT = 4
    STOP = 5
    ORIENTATION = 6


@dataclass(slots=True)
class Drive:
    """A drive: its identification (SERCOS S-0-0030, S-0-0140, S-0-0141) and cyclic telegram by ID number."""

    version: str = ""
    controller: str = ""
    motor: str = ""
    telegram: Mapping[int, int] = field(default_factory=dict)


@dataclass(slots=True)
class Axis:
    """A physical axis; positions in mm or deg, `jog_speed` in mm/min or rev/min.

    `setpoint` and `actual` are machine positions without `preset`, what "set actual value" (G92) adds to those
    shown. `channel` is None of an asynchronous axis; `interface_unit` holds while jogging.
    """

    number: int
    name: str
    kind: AxisKind = "linear"
    channel: int | None = 1
    default_channel: int | None = 1
    logical_name: str = ""
    default_logical_name: str = ""
    setpoint: float = 0.0
    actual: float = 0.0
    preset: float = 0.0
    lag: float | None = 0.0
    shifts: tuple[float, float, float] = (0.0, 0.0, 0.0)
    external_shift: float = 0.0
    end: float = 0.0
    cartesian: float | None = None
    axis_coordinate: float = 0.0
    machine_coordinate: float = 0.0
    in_window: bool = True
    travel: bool = False
    referenced: bool = False
    jog_speed: float = 0.0
    mode: Mode = Mode.NONE
    feed_inhibit: bool = False
    potentiometer: float = 10000.0
    interface_unit: Unit = Unit.METRIC
    drive: Drive = field(default_factory=Drive)

    @property
    def shift(self) -> float:
        """Return the sum of its zero shifts."""
        return sum(self.shifts) + self.external_shift

    @property
    def in_position(self) -> bool:
        """Return whether it is in its window and nothing moves it."""
        return self.in_window and not self.travel


@dataclass(slots=True)
class Spindle:
    """A spindle; speeds rev/min, `cutting_m_min` while G196 holds, else None."""

    programmed: float = 0.0
    actual: float = 0.0
    cutting_m_min: float | None = None
    potentiometer: float = 10000.0
    limits: tuple[float, float] = (0.0, 1e9)
    gear_limits: tuple[float, float] = (0.0, 1e9)
    motion: SpindleMotion = SpindleMotion.STOP
    gear_range: int = 40
    group: int = 0
    automatic_gear: bool = True
    gear_switching: bool = False

    @property
    def lowest(self) -> float:
        """Return the lowest speed that the limits of program and gear permit."""
        return max(self.limits[0], self.gear_limits[0])

    @property
    def highest(self) -> float:
        """Return the highest speed that the limits of program and gear permit."""
        return min(self.limits[1], self.gear_limits[1])

    @property
    def commanded(self) -> float:
        """Return the speed that is commanded, with potentiometer and limits; m/min while G196 holds."""
        share = self.potentiometer / 10000.0
        if self.cutting_m_min is not None:
            return self.cutting_m_min * share
        if not self.programmed:
            return 0.0
        return min(max(self.programmed * share, self.lowest), self.highest)


@dataclass(slots=True)
class Coordinate:
    """A coordinate of a channel; a working range coordinate moves all its `axes`, a pseudo one is one axis."""

    name: str
    axes: tuple[int, ...]
    working_range: bool = False
    unit: Unit = Unit.METRIC
    workpiece: float = 0.0
    basis: float = 0.0
    basis_actual: float = 0.0
    end: float = 0.0
    end_shifted: float = 0.0
    to_go: float = 0.0
    correction: float = 0.0
    correction_active: bool = False


@dataclass(slots=True)
class ToolCompensation:
    """The general tool compensation: `kind` 0 none, 1 drill, 2 milling, 3 lathe, 4 anglehead."""

    radius: float = 0.0
    length_3: float = 0.0
    length_1: float = 0.0
    length_2: float = 0.0
    orientation: float = 0.0
    kind: int = 0


@dataclass(slots=True)
class Channel:
    """A channel; pairs are (output, input) signals. `blocks` counts the switches from one block to the next."""

    number: int
    mode: Mode = Mode.NONE
    sav: Sav = Sav.INACTIVE
    ipo: Ipo = Ipo.STOPPED
    blocks: int = 0
    inch: bool = False
    inch_at_power_up: bool = False
    program: str = ""
    message: str = ""
    feeds: tuple[float, float, float] = (0.0, 0.0, 0.0)
    programmed_feed: float = 0.0
    potentiometer: float = 10000.0
    length_number: int = -1
    length: float = 0.0
    radius_number: int = -1
    radius: float = 0.0
    tool_table: str = ""
    shift_table: str = ""
    tool: ToolCompensation = field(default_factory=ToolCompensation)
    external_tool: tuple[float, float] = (0.0, 0.0)
    dwell: bool = False
    auxiliary_waits: bool = False
    transfer_inhibit: bool = False
    feed_inhibit: bool = False
    return_how: int = 1
    return_where: int = 1
    recording: bool = False
    skip: tuple[bool, bool] = (False, False)
    optional_stop: tuple[bool, bool] = (False, False)
    reselection: bool = False
    other_waits: Wait = field(default_factory=lambda: Wait(0))
    coordinates: Sequence[Coordinate] = ()

    @property
    def is_ready(self) -> bool:
        """Whether a start would begin or go on (NC ready, NC-O 16.0)."""
        return self.sav in (Sav.READY, Sav.AT_START)

    @property
    def in_order(self) -> list[Coordinate]:
        """Return the working range coordinates, after them the pseudo coordinates."""
        return sorted(self.coordinates, key=lambda coordinate: not coordinate.working_range)


@dataclass(slots=True)
class Image:
    """Everything that the data services read, in one control cycle; spindles by their place, S or S1 first."""

    axes: dict[int, Axis] = field(default_factory=dict)
    spindles: dict[int, Spindle] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    cycle: int = 0
    drives: int = 0
    interface_channels: int = 0
    all_channels: int = 0
    test_mode: bool = False
    customer: dict[tuple[int, int], tuple[float, ...] | str] = field(default_factory=dict)

    def feed_axes(self) -> list[Axis]:
        """Return all feed and auxiliary axes, ascending."""
        return [axis for axis in self.physical() if axis is not None and axis.kind != "spindle"]

    def physical(self) -> list[Axis | None]:
        """Return every place of a physical axis from 1 on, None where there is none."""
        return [self.axes.get(number) for number in range(1, max(self.axes, default=0) + 1)]

    def channel_axes(self, number: int) -> list[Axis]:
        """Return the axes of a channel, ascending."""
        return [axis for axis in self.feed_axes() if axis.channel == number]

    def selected(self, number: int) -> list[Axis | None]:
        """Return all physical axes (-1), or those of a channel and after them the asynchronous ones."""
        if number < 0:
            return self.physical()
        return [*self.channel_axes(number), *(axis for axis in self.feed_axes() if axis.channel is None)]
