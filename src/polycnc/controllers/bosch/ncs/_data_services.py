"""The data services of the NCS coupling, one row each: what MCODS reads and when it is new (Manual 003, 4.14.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

from polycnc.controllers.bosch.ncs._codes import NcsCode, NcsError
from polycnc.controllers.bosch.ncs._image import Axis, Channel, Coordinate, Image, Mode, Unit, Wait

Refresh: TypeAlias = Literal["Z", "S", "E", "I", "R"]
"""When data are new: each cycle, with each block, when they change, at any time, never."""
Scope: TypeAlias = Literal["system", "channel", "either"]
"""Whose data: of the whole system, of one channel, or of all (-1) or one."""
Values: TypeAlias = Sequence[float] | str

LONGEST_DRIVE_TEXT = 40
LONGEST_MESSAGE = 80
NAME_BYTES = 8
NOT_IN_TELEGRAM = -2147483648
LARGEST_CUSTOMER_SELECTION = 65535


class Asked(NamedTuple):
    """What a data service is asked for: a channel and the values after the size, None where left out."""

    image: Image
    channel: int
    extra: tuple[int | None, ...] = ()

    @property
    def shown(self) -> Channel:
        """Return the channel that is asked for."""
        return self.image.channels[self.channel]


@dataclass(frozen=True, slots=True)
class DataService:
    """A data service; `kind` of its elements is I, R, D, S, or X where the data decide.

    `fill` stands for elements of the buffer after the last value, None if they keep theirs.
    """

    number: int
    name: str
    kind: Literal["I", "R", "D", "S", "X"]
    refresh: Refresh
    scope: Scope
    read: Callable[[Asked], Values]
    fill: float | None = None
    versioned: bool = True


def _feed(value: Callable[[Axis], float]) -> Callable[[Asked], Values]:
    return lambda asked: [value(axis) for axis in asked.image.feed_axes()]


def _physical(value: Callable[[Axis], float], gap: float = 0.0) -> Callable[[Asked], Values]:
    return lambda asked: [gap if axis is None else value(axis) for axis in asked.image.physical()]


def _chosen(value: Callable[[Axis], float], gap: float) -> Callable[[Asked], Values]:
    return lambda asked: [
        gap if axis is None else value(axis) for axis in asked.image.selected(asked.channel)
    ]


def _axes_of(value: Callable[[Axis], float]) -> Callable[[Asked], Values]:
    return lambda asked: [
        value(axis)
        for axis in (
            asked.image.feed_axes() if asked.channel < 0 else asked.image.channel_axes(asked.channel)
        )
    ]


def _coordinates(value: Callable[[Coordinate], float]) -> Callable[[Asked], Values]:
    return lambda asked: [value(each) for each in asked.shown.in_order]


def _signals(value: Callable[[Axis], bool]) -> Callable[[Asked], Values]:
    return lambda asked: [
        int(all(value(asked.image.axes[number]) for number in each.axes)) for each in asked.shown.in_order
    ]


def _spindles(name: str) -> Callable[[Asked], Values]:
    def read(asked: Asked) -> Values:
        spindles = asked.image.spindles
        return [
            getattr(spindles[place], name) if place in spindles else 0
            for place in range(1, max(spindles, default=0) + 1)
        ]

    return read


def _shown(*names: str) -> Callable[[Asked], Values]:
    return lambda asked: [getattr(asked.shown, name) for name in names]


def _all_of(name: str) -> Callable[[Asked], Values]:
    return lambda asked: [*map(float, getattr(asked.shown, name))]


def _pair(name: str) -> Callable[[Asked], Values]:
    return lambda asked: [*map(int, getattr(asked.shown, name))]


def _text(name: str, nothing: str = "") -> Callable[[Asked], Values]:
    return lambda asked: getattr(asked.shown, name) or nothing


def padded(names: Iterable[str | None]) -> str:
    """Return names as fields of 9 characters: 8 of the name and its blanks, a zero; zeros only for None."""
    return "".join(
        "\0" * (NAME_BYTES + 1) if name is None else f"{name[:NAME_BYTES]:<{NAME_BYTES}}\0" for name in names
    )


def _names(name: Callable[[Axis], str]) -> Callable[[Asked], Values]:
    def read(asked: Asked) -> Values:
        axes: Sequence[Axis | None] = (
            asked.image.physical() if asked.channel < 0 else asked.image.channel_axes(asked.channel)
        )
        return padded(None if axis is None else name(axis) for axis in axes)

    return read


def _drive(name: str) -> Callable[[Asked], Values]:
    def read(asked: Asked) -> Values:
        number = asked.extra[0] if asked.extra else None
        if number is None:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        axes = asked.image.axes
        axis = axes.get(min(axes, default=0) if number == 0 else number)
        if axis is None:
            raise NcsError(NcsCode.NO_AXIS)
        text: str = getattr(axis.drive, name)
        return text[:LONGEST_DRIVE_TEXT]

    return read


def _telegram(asked: Asked) -> Values:
    ident = asked.extra[1] if len(asked.extra) > 1 else None
    if ident is None:
        raise NcsError(NcsCode.UNKNOWN_SYNTAX)
    return [
        NOT_IN_TELEGRAM if axis is None else axis.drive.telegram.get(ident, NOT_IN_TELEGRAM)
        for axis in asked.image.physical()
    ]


def _customer(asked: Asked) -> Values:
    selection = next((each for each in asked.extra if each is not None), None)
    if selection is None or not 0 <= selection <= LARGEST_CUSTOMER_SELECTION:
        raise NcsError(NcsCode.UNKNOWN_SYNTAX)
    if (asked.channel, selection) not in asked.image.customer:
        raise NcsError(NcsCode.NOT_AVAILABLE)
    return asked.image.customer[asked.channel, selection]


def _reserved(asked: Asked) -> Values:
    raise NcsError(NcsCode.NOT_AVAILABLE)


def _by_group(asked: Asked) -> Values:
    axes = asked.image.channel_axes(asked.channel)
    return [axis.shifts[group] for group in range(3) for axis in axes]


def _external_shifts(asked: Asked) -> Values:
    values = [axis.external_shift for axis in asked.image.channel_axes(asked.channel)]
    return (values + [0.0] * 8)[:8]


def _general_tool(asked: Asked) -> Values:
    tool = asked.shown.tool
    return [
        tool.radius, tool.length_3, tool.length_1, tool.length_2, tool.orientation, float(tool.kind),
    ]  # fmt: skip


def _assignment(default: bool) -> Callable[[Axis], float]:
    def read(axis: Axis) -> float:
        if axis.kind == "spindle":
            return -2
        channel = axis.default_channel if default else axis.channel
        return -1 if channel is None else channel

    return read


def _programming(asked: Asked) -> Values:
    kinds = {axis.kind for axis in asked.image.channel_axes(asked.channel)}
    if not kinds:
        return [Unit.NONE]
    if "linear" not in kinds:
        return [Unit.DEGREE]
    return [Unit.INCH if asked.shown.inch else Unit.METRIC]


def _potentiometers(asked: Asked) -> Values:
    if asked.channel < 0:
        return _physical(lambda axis: axis.potentiometer)(asked)
    return [
        axis.potentiometer if axis is None or axis.channel is None else asked.shown.potentiometer
        for axis in asked.image.selected(asked.channel)
        if axis is not None
    ]


def _modes(asked: Asked) -> Values:
    channels = asked.image.channels
    return [
        Mode.NONE
        if axis is None
        else channels[axis.channel].mode
        if axis.channel in channels and axis.kind != "spindle"
        else axis.mode
        for axis in asked.image.selected(asked.channel)
    ]


_BY_HAND = (Mode.JOG, Mode.REFERENCE)
_FIXED_UNITS = {"rotary": Unit.DEGREE, "spindle": Unit.DEGREE, "hirth": Unit.HIRTH}


def _unit(image: Image, axis: Axis | None) -> Unit:
    if axis is None:
        return Unit.NONE
    if axis.kind in _FIXED_UNITS:
        return _FIXED_UNITS[axis.kind]
    if axis.channel is None:
        return axis.interface_unit if axis.mode in _BY_HAND else Unit.METRIC
    channel = image.channels[axis.channel]
    if channel.mode in _BY_HAND:
        return axis.interface_unit
    return Unit.INCH if channel.inch else Unit.METRIC


def _units(asked: Asked) -> Values:
    return [_unit(asked.image, axis) for axis in asked.image.selected(asked.channel)]


def _default_unit(image: Image, axis: Axis | None) -> Unit:
    if axis is None:
        return Unit.NONE
    if axis.kind in _FIXED_UNITS:
        return _FIXED_UNITS[axis.kind]
    inch = axis.default_channel is not None and image.channels[axis.default_channel].inch_at_power_up
    return Unit.INCH if inch else Unit.METRIC


def _default_units(asked: Asked) -> Values:
    image = asked.image
    axes = image.physical() if asked.channel < 0 else image.channel_axes(asked.channel)
    return [_default_unit(image, axis) for axis in axes]


def _counts(asked: Asked) -> Values:
    return [len(asked.image.channels), asked.image.interface_channels, asked.image.all_channels]


def _coordinate_counts(asked: Asked) -> Values:
    coordinates = asked.shown.coordinates
    pseudo = sum(not each.working_range for each in coordinates)
    return [len(asked.image.channel_axes(asked.channel)), len(coordinates), pseudo]


def _waits(asked: Asked) -> Values:
    shown = asked.shown
    flags = shown.other_waits
    axes = asked.image.channel_axes(asked.channel)
    for present, flag in (
        (shown.dwell, Wait.DWELL),
        (shown.auxiliary_waits, Wait.AUXILIARY),
        (shown.transfer_inhibit, Wait.TRANSFER_INHIBIT),
        (shown.potentiometer == 0, Wait.FEED_ZERO),
        (shown.feed_inhibit or any(axis.feed_inhibit for axis in axes), Wait.FEED_INHIBIT),
    ):
        if present:
            flags |= flag
    return [flags.value]


_S = DataService
# fmt: off
_ROWS = (
    _S(1, "commanded positions", "D", "Z", "system", _feed(lambda a: a.setpoint + a.preset)),
    _S(2, "commanded positions in 0.0001", "I", "Z", "system",
      _feed(lambda a: round((a.setpoint + a.preset) * 1e4))),
    _S(3, "path feeds", "R", "Z", "channel", _all_of("feeds")),
    _S(4, "lag", "R", "Z", "system", _physical(lambda a: a.lag or 0.0)),
    _S(5, "commanded spindle speeds", "R", "Z", "system", _spindles("commanded"), fill=0.0),
    _S(6, "in position", "I", "Z", "system", _feed(lambda a: int(a.in_position))),
    _S(7, "feed potentiometer", "R", "Z", "channel", _shown("potentiometer")),
    _S(8, "spindle potentiometers", "R", "Z", "system", _spindles("potentiometer")),
    _S(9, "length compensation number", "I", "S", "channel", _shown("length_number")),
    _S(10, "length compensation", "R", "S", "channel", _shown("length")),
    _S(11, "radius compensation number", "I", "S", "channel", _shown("radius_number")),
    _S(12, "radius compensation", "R", "S", "channel", _shown("radius")),
    _S(13, "tool compensation table", "S", "S", "channel", _text("tool_table", "   ")),
    _S(14, "zero shift table", "S", "S", "channel", _text("shift_table", "   ")),
    _S(15, "zero shifts by group", "R", "S", "channel", _by_group),
    _S(16, "end positions with shifts", "R", "S", "system", _feed(lambda a: a.end + a.shift)),
    _S(18, "type of programming", "I", "S", "channel", _programming),
    _S(19, "highest spindle speeds", "R", "S", "system", _spindles("highest"), fill=0.0),
    _S(20, "lowest spindle speeds", "R", "S", "system", _spindles("lowest"), fill=0.0),
    _S(23, "end positions", "R", "S", "system", _feed(lambda a: a.end)),
    _S(24, "programmed path feed", "R", "S", "channel", _shown("programmed_feed")),
    _S(25, "programmed spindle speeds", "R", "S", "system", _spindles("programmed"), fill=0.0),
    _S(26, "referenced", "I", "E", "system", _feed(lambda a: int(a.referenced))),
    _S(27, "jog speeds", "R", "E", "system", _feed(lambda a: a.jog_speed)),
    _S(28, "message", "S", "E", "channel", lambda asked: asked.shown.message[:LONGEST_MESSAGE]),
    _S(29, "test mode", "I", "E", "system", lambda asked: [int(asked.image.test_mode)]),
    _S(30, "main program", "S", "E", "channel", _text("program"), versioned=False),
    _S(31, "mode of the channel", "I", "E", "channel", _shown("mode")),
    _S(32, "SAV and IPO states", "I", "E", "channel", _shown("sav", "ipo")),
    _S(33, "axis names", "S", "R", "either", _names(lambda a: a.name)),
    _S(34, "reserved", "I", "R", "system", _reserved),
    _S(35, "actual positions", "R", "Z", "system", _feed(lambda a: a.actual)),
    _S(36, "actual spindle speeds", "R", "Z", "system", _spindles("actual"), fill=0.0),
    _S(37, "program values", "D", "Z", "system", _feed(lambda a: a.setpoint - sum(a.shifts))),
    _S(38, "Cartesian actual values", "D", "Z", "system",
      _feed(lambda a: a.actual if a.cartesian is None else a.cartesian)),
    _S(39, "dwell", "I", "E", "channel", lambda asked: [int(asked.shown.dwell)]),
    _S(40, "auxiliary function waits", "I", "E", "channel", lambda asked: [int(asked.shown.auxiliary_waits)]),
    _S(41, "block transfer inhibit", "I", "E", "channel", lambda asked: [int(asked.shown.transfer_inhibit)]),
    _S(42, "customer-specific data", "X", "E", "channel", _customer),
    _S(43, "channels of the axes", "I", "E", "system", _physical(_assignment(False), -3), fill=-3),
    _S(44, "number of channels", "I", "R", "system", _counts),
    _S(45, "number of axes", "I", "R", "system", lambda asked: [asked.image.drives, len(asked.image.axes)]),
    _S(46, "return to path", "I", "E", "channel",
      lambda asked: [asked.shown.return_how, asked.shown.return_where, int(asked.shown.recording)]),
    _S(47, "travel command", "I", "Z", "either", _chosen(lambda a: int(a.travel), 0)),
    _S(48, "modes of the axes", "I", "E", "either", _modes),
    _S(49, "feed inhibit", "I", "E", "either", _chosen(lambda a: int(a.feed_inhibit), 0)),
    _S(50, "axis potentiometers", "R", "E", "either", _potentiometers),
    _S(51, "external tool compensation", "R", "S", "channel", _all_of("external_tool")),
    _S(52, "external zero shifts", "R", "S", "channel", _external_shifts),
    _S(53, "units of the axes", "I", "E", "either", _units, fill=3),
    _S(54, "general tool compensation", "R", "S", "channel", _general_tool),
    _S(55, "version of the drive", "S", "R", "system", _drive("version")),
    _S(56, "type of the drive", "S", "R", "system", _drive("controller")),
    _S(57, "type of the motor", "S", "R", "system", _drive("motor")),
    _S(58, "default channels of the axes", "I", "R", "system", _physical(_assignment(True), -3), fill=-3),
    _S(59, "logical axis names", "S", "E", "either", _names(lambda a: a.logical_name or a.name)),
    _S(60, "default logical axis names", "S", "R", "either", _names(lambda a: a.default_logical_name or a.name)),
    _S(61, "default units of the axes", "I", "R", "either", _default_units, fill=3),
    _S(62, "value of the cyclic telegram", "I", "Z", "system", _telegram),
    _S(63, "movements of the spindles", "I", "E", "system", _spindles("motion"), fill=0),
    _S(64, "gear ranges", "I", "E", "system", _spindles("gear_range")),
    _S(65, "groups of the spindles", "I", "E", "system", _spindles("group")),
    _S(66, "automatic gear selection", "I", "E", "system", _spindles("automatic_gear")),
    _S(67, "gear switching", "I", "E", "system", _spindles("gear_switching")),
    _S(68, "skip block", "I", "E", "channel", _pair("skip")),
    _S(69, "optional stop", "I", "E", "channel", _pair("optional_stop")),
    _S(70, "program re-selection", "I", "I", "channel", lambda asked: [int(asked.shown.reselection)]),
    _S(71, "workpiece coordinates", "R", "Z", "channel", _coordinates(lambda c: c.workpiece)),
    _S(72, "basis coordinates", "R", "Z", "channel", _coordinates(lambda c: c.basis)),
    _S(73, "axis coordinates", "R", "Z", "either", _axes_of(lambda a: a.axis_coordinate)),
    _S(74, "machine coordinates", "R", "Z", "either", _axes_of(lambda a: a.machine_coordinate)),
    _S(75, "actual basis coordinates", "R", "Z", "channel", _coordinates(lambda c: c.basis_actual)),
    _S(76, "end points", "R", "S", "channel", _coordinates(lambda c: c.end)),
    _S(77, "end points with shifts", "R", "S", "channel", _coordinates(lambda c: c.end_shifted)),
    _S(78, "coordinate names", "S", "E", "channel",
      lambda asked: padded(each.name for each in asked.shown.in_order)),
    _S(79, "coordinates in position", "I", "Z", "channel", _signals(lambda a: a.in_position)),
    _S(80, "coordinates referenced", "I", "E", "channel", _signals(lambda a: a.referenced)),
    _S(81, "units of the coordinates", "I", "E", "channel", _coordinates(lambda c: c.unit), fill=3),
    _S(82, "number of coordinates", "I", "E", "channel", _coordinate_counts),
    _S(83, "distance to go", "R", "Z", "channel", _coordinates(lambda c: c.to_go)),
    _S(87, "waiting states", "I", "E", "channel", _waits),
    _S(89, "online correction", "R", "E", "channel", _coordinates(lambda c: c.correction)),
    _S(90, "online correction active", "I", "E", "channel", _coordinates(lambda c: int(c.correction_active))),
)
# fmt: on

DATA_SERVICES: dict[int, DataService] = {service.number: service for service in _ROWS}
"""Every data service by its number; 17, 21, 22, 84 to 86 and 88 are none."""

OVERVIEW: dict[str, tuple[int, ...]] = {
    "Positions": (1, 2, 35, 38, 4, 37, 16, 23),
    "Speed and spindle speed": (3, 24, 27, 5, 36, 19, 20, 25),
    "States": (6, 29, 26, 39, 40, 41, 47, 49, 32),
    "Potentiometers": (7, 8, 50),
    "Compensations": (9, 10, 11, 12, 13, 14, 15, 51, 52, 54),
    "Operation modes": (31, 48),
    "System structure": (34, 44, 45, 33, 59, 60, 43, 58, 62),
    "Units of measurement": (61, 53, 18),
    "Spindles": (63, 64, 65, 66, 67),
    "Drive": (55, 56, 57),
    "Coordinates": (71, 72, 73, 74, 75, 76, 77, 78, 79, 80, 81, 82, 83, 89, 90),
    "Miscellaneous": (28, 46, 42, 68, 69, 70, 30, 87),
}
"""The data services by what they are about, as the manual lists them (the coordinates are not in its list)."""
