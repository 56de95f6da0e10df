"""Names of RS274/NGC that the control knows. Source: LinuxCNC G-code manual, "Predefined Named Parameters"."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_ABSOLUTE,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_NUMBER,
    FEED_PER_MINUTE,
    FEED_PER_REVOLUTION,
    INCH,
    MOTION,
    NO_AXIS,
    PLANE,
    length_scale,
)
from polycnc.units import MM_PER_INCH

AXES = "XYZABCUVW"
_MOTIONS = {-1: 800.0, 0: 0.0, 1: 10.0, 2: 20.0, 3: 30.0, 4: 50.0, 5: 51.0, 6: 52.0}
_TURNING = {"synchronized": 330.0, "tap_and_back": 331.0, "threading": 760.0}
_PLANES = {0: 170.0, 1: 180.0, 2: 190.0}
_M_PER_FOOT = 12.0 * MM_PER_INCH / 1000.0


class Known(Protocol):
    """What the values are read from."""

    level: int

    @property
    def state(self) -> ChannelState:
        """The state of the channel."""
        ...

    def position(self, axis: int, *, machine: bool = False) -> float:
        """Return the programmed position of an axis."""
        ...


Value = Callable[[Known], float]


def _mode(column: int, value: int) -> Value:
    return lambda of: float(of.state.modal.whole[column] == value)


def _at(axis: int, machine: bool) -> Value:
    return lambda of: of.position(axis, machine=machine)


def _motion(of: Known) -> float:
    state = of.state
    if state.cycle.action:
        return 10.0 * state.cycle.code
    return _TURNING.get(state.turning.motion) or _MOTIONS[int(state.modal.whole[MOTION])]


def has_diameters(state: ChannelState) -> bool:
    """Tell whether X words are diameters."""
    axis = state.axis("X")
    return axis != NO_AXIS and float(state.modal.scale[axis]) != length_scale(state.modal)


def _speed_word(of: Known) -> float:
    """Return the last S: revolutions, or a cutting speed in m/min or feet/min."""
    feet = of.state.spindle.surface_speed and of.state.modal.whole[INCH]
    return float(of.state.spindle.speed) / (_M_PER_FOOT if feet else 1.0)


KNOWN_NAMES: dict[str, Value] = {
    **{f"_{letter.lower()}": _at(axis, False) for axis, letter in enumerate(AXES)},
    **{f"_abs_{letter.lower()}": _at(axis, True) for axis, letter in enumerate(AXES)},
    "_feed": lambda of: float(of.state.modal.real[FEED_NUMBER]),
    "_rpm": _speed_word,
    "_selected_tool": lambda of: float(of.state.selected_tool),
    "_current_tool": lambda of: float(of.state.tool),
    "_current_pocket": lambda of: float(of.state.tool),
    "_selected_pocket": lambda of: float(of.state.selected_tool),
    "_metric": _mode(INCH, 0),
    "_imperial": _mode(INCH, 1),
    "_absolute": _mode(ABSOLUTE, 1),
    "_incremental": _mode(ABSOLUTE, 0),
    "_inverse_time": _mode(FEED_MODE, FEED_INVERSE_TIME),
    "_units_per_minute": _mode(FEED_MODE, FEED_PER_MINUTE),
    "_units_per_rev": _mode(FEED_MODE, FEED_PER_REVOLUTION),
    "_plane": lambda of: _PLANES[int(of.state.modal.whole[PLANE])],
    "_motion_mode": _motion,
    "_coord_system": lambda of: round(10.0 * float((of.state.coordinates.work[0] or "G54")[1:])) * 1.0,
    "_tool_offset": lambda of: float(of.state.coordinates.length_sign != 0),
    "_retract_r_plane": lambda of: float(not of.state.cycle.retract_to_initial),
    "_retract_old_z": lambda of: float(of.state.cycle.retract_to_initial),
    "_spindle_rpm_mode": lambda of: float(not of.state.spindle.surface_speed),
    "_spindle_css_mode": lambda of: float(of.state.spindle.surface_speed),
    "_ijk_absolute_mode": _mode(ARC_ABSOLUTE, 1),
    "_lathe_diameter_mode": lambda of: float(has_diameters(of.state)),
    "_lathe_radius_mode": lambda of: float(not has_diameters(of.state)),
    "_spindle_on": lambda of: float(of.state.spindle.direction != 0),
    "_spindle_cw": lambda of: float(of.state.spindle.direction == 1),
    "_mist": lambda of: float(7 in of.state.spindle.coolant),
    "_flood": lambda of: float(8 in of.state.spindle.coolant),
    "_call_level": lambda of: float(of.level),
    "_ccomp": lambda of: {0: 400.0, 1: 410.0, -1: 420.0}[of.state.side],
    "_speed_override": lambda _: 1.0,  # M48 to M53 are functions for others: these never change
    "_feed_override": lambda _: 1.0,
    "_adaptive_feed": lambda _: 0.0,
    "_feed_hold": lambda _: 1.0,
    "_line": lambda _: 0.0,  # the translation puts the number of the line in its place
    "_vmajor": lambda _: 2.9,
    "_vminor": lambda _: 0.0,
    "_task": lambda _: 0.0,
    "_remap_level": lambda _: 0.0,
}
"""What the value of each name is; positions and feed are in the units of the program."""
