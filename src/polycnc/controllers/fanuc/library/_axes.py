"""Functions about the controlled axes: positions, delays, feed (Manual 000, controlled axes)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated

from polycnc.controllers.fanuc.device._positions import AxisPositions
from polycnc.controllers.fanuc.library._call import call, check_axis, check_length
from polycnc.controllers.fanuc.library._codes import ALL_AXES, EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import IDBWRR, ODBACT, ODBAXIS, ODBDY, ODBDY_D
from polycnc.controllers.library import IN, SHORT, LengthOf, Out, Refused

MOST_POSITION = 99_999_999
_HEADER = 4
_DYNAMIC_HEADER = 22

_MAX_AXIS_D = 2


@call
def cnc_actf(link: Link) -> tuple[EW, Annotated[ODBACT, Out("actualfeed")]]:
    """Read the actual feed, mm/min; with inch input 0.01 inch/min (Manual 000, cnc_actf)."""
    return EW.EW_OK, ODBACT(data=link.read("cnc_actf").positions.feed())


def _axis_data(
    link: Link, name: str, axis: int, length: int, value: Callable[[AxisPositions], int]
) -> tuple[EW, ODBAXIS]:
    """Return one value of one axis, or of all controlled axes."""
    axes = link.device.axes
    check_length(length, _HEADER + 4 * (axes if axis == ALL_AXES else 1))
    check_axis(axis, axes)
    read = link.read(name, axis).positions.read()
    return EW.EW_OK, _filled(axis, [value(each) for each in read])


def _filled(axis: int, values: Sequence[int]) -> ODBAXIS:
    data = ODBAXIS(type=axis)
    for k, value in enumerate(values if axis == ALL_AXES else values[axis - 1 : axis]):
        data.data[k] = value
    return data


@call
def cnc_absolute(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("absolute")]
) -> tuple[EW, Annotated[ODBAXIS, Out("absolute")]]:
    """Read absolute positions, in the input unit, with tool length compensation (Manual 000, cnc_absolute)."""
    return _axis_data(link, "cnc_absolute", axis, length, lambda each: each.absolute)


@call
def cnc_machine(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("machine")]
) -> tuple[EW, Annotated[ODBAXIS, Out("machine")]]:
    """Read machine positions, in the output unit (Manual 000, cnc_machine)."""
    return _axis_data(link, "cnc_machine", axis, length, lambda each: each.machine)


@call
def cnc_relative(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("relative")]
) -> tuple[EW, Annotated[ODBAXIS, Out("relative")]]:
    """Read relative positions, which `cnc_wrrelpos` presets (Manual 000, cnc_relative)."""
    return _axis_data(link, "cnc_relative", axis, length, lambda each: each.relative)


@call
def cnc_distance(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("distance")]
) -> tuple[EW, Annotated[ODBAXIS, Out("distance")]]:
    """Read distances to go: twice what they are, as this control does it (Manual 000, cnc_distance)."""
    return _axis_data(link, "cnc_distance", axis, length, lambda each: 2 * each.distance)


@call
def cnc_skip(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("skip")]
) -> tuple[EW, Annotated[ODBAXIS, Out("skip")]]:
    """Read where the axes were when the skip signal came (Manual 000, cnc_skip)."""
    check_length(length, _HEADER + 4 * (link.device.axes if axis == ALL_AXES else 1))
    check_axis(axis, link.device.axes)
    return EW.EW_OK, _filled(axis, link.read("cnc_skip", axis).skip.positions)


@call
def cnc_srvdelay(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("srvdelay")]
) -> tuple[EW, Annotated[ODBAXIS, Out("srvdelay")]]:
    """Read by how much the servos lag behind (Manual 000, cnc_srvdelay)."""
    return _axis_data(link, "cnc_srvdelay", axis, length, lambda each: each.servo_delay)


@call
def cnc_accdecdly(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("accdecdly")]
) -> tuple[EW, Annotated[ODBAXIS, Out("accdecdly")]]:
    """Read by how much acceleration delays the axes (Manual 000, cnc_accdecdly).

    Ruling: 0, as this control accelerates before it interpolates.
    """
    return _axis_data(link, "cnc_accdecdly", axis, length, lambda each: each.acceleration_delay)


@call
def cnc_rddynamic(
    link: Link, axis: SHORT, length: Annotated[SHORT, LengthOf("rddynamic")]
) -> tuple[EW, Annotated[ODBDY, Out("rddynamic")]]:
    """Read alarms, programs, sequence number, feed and positions of one moment (Manual 000, cnc_rddynamic).

    On a Power Mate-D the arrays of the structure have 2 elements.
    """
    most = link.device.max_axis
    check_length(length, _DYNAMIC_HEADER + 16 * (most if axis == ALL_AXES else 1))
    check_axis(axis, link.device.axes)
    device = link.read("cnc_rddynamic", axis)
    data = ODBDY() if device.max_axis > _MAX_AXIS_D else ODBDY_D()
    data.axis = axis
    data.alarm = int(device.power.alarm_bits)
    data.prgnum, data.prgmnum = device.execution.numbers
    data.seqnum = device.execution.sequence
    data.actf = device.positions.feed()
    places = device.positions.read()
    if axis == ALL_AXES:
        every, count = data.pos.faxis, len(places)
        every.absolute[:count] = [each.absolute for each in places]
        every.machine[:count] = [each.machine for each in places]
        every.relative[:count] = [each.relative for each in places]
        every.distance[:count] = [2 * each.distance for each in places]
    else:
        one, place = data.pos.oaxis, places[axis - 1]
        one.absolute, one.machine = place.absolute, place.machine
        one.relative, one.distance = place.relative, 2 * place.distance
    return EW.EW_OK, data  # type: ignore[return-value]


@call
def cnc_wrrelpos(
    link: Link, length: Annotated[SHORT, LengthOf("wrrelpos")], wrrelpos: Annotated[IDBWRR, IN]
) -> EW:
    """Preset relative positions: of the axis `type`, or of all (Manual 000, cnc_wrrelpos)."""
    axes, axis = link.device.axes, wrrelpos.type
    check_length(length, _HEADER + 4 * (axes if axis == ALL_AXES else 1))
    check_axis(axis, axes)
    values = (
        {k + 1: int(wrrelpos.data[k]) for k in range(axes)}
        if axis == ALL_AXES
        else {axis: int(wrrelpos.data[0])}
    )
    if any(abs(value) > MOST_POSITION for value in values.values()):
        raise Refused(EW.EW_DATA)
    link.command().positions.preset_relative(values)
    return EW.EW_OK


__all__ = [
    "cnc_absolute",
    "cnc_accdecdly",
    "cnc_actf",
    "cnc_distance",
    "cnc_machine",
    "cnc_rddynamic",
    "cnc_relative",
    "cnc_skip",
    "cnc_srvdelay",
    "cnc_wrrelpos",
]
