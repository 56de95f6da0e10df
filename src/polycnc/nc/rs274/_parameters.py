"""The parameters of RS274/NGC: numbered ones, global names, and what the control says under numbers and names."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    FEED_INVERSE_TIME,
    FEED_MODE,
    FEED_NUMBER,
    FEED_PER_MINUTE,
    FEED_PER_REVOLUTION,
    INCH,
    MOTION,
    PLANE,
)
from polycnc.nc.rs274._functions import NumberError

AXES = "XYZABCUVW"
LAST_COMMON = 5000
_LAST = 5602
_SYSTEMS = (*(f"G{number}" for number in range(54, 60)), "G59.1", "G59.2", "G59.3")
_MOTIONS = {-1: 800.0, 0: 0.0, 1: 10.0, 2: 20.0, 3: 30.0, 4: 50.0, 5: 51.0, 6: 52.0}
_PLANES = {0: 170.0, 1: 180.0, 2: 190.0}


class Parameters:
    """Hold what programs set, and read the rest from the state of a channel; lengths are in the program's units."""

    def __init__(self) -> None:
        self.common = [0.0] * (LAST_COMMON + 1)
        self.names: dict[str, float] = {}
        self.level = 0
        self._others: dict[int, float] = {}
        self._state: ChannelState | None = None

    def attach(self, state: ChannelState) -> None:
        """Read from the state of a channel."""
        self._state = state

    @property
    def state(self) -> ChannelState:
        """The state of the channel."""
        assert self._state is not None
        return self._state

    def get(self, number: float, frame: list[float]) -> float:
        """Return a numbered parameter."""
        index = _index(number)
        if index <= 30:
            return frame[index]
        return self.common[index] if index <= LAST_COMMON else self._system(index)

    def put(self, number: float, value: float, frame: list[float]) -> None:
        """Set a numbered parameter."""
        index = _index(number)
        if index <= 30:
            frame[index] = value
        elif index <= LAST_COMMON:
            self.common[index] = value
        elif 5400 <= index <= 5428:
            raise NumberError(f"parameter #{index} can only be read")
        else:
            self._others[index] = value
            system, axis = divmod(index - 5221, 20)
            if 0 <= system < len(_SYSTEMS) and axis < len(AXES) and AXES[axis] in self.state.axis_names:
                at = list(self.state.axis_names).index(AXES[axis])
                self.state.tables.set_offset(
                    _SYSTEMS[system], {at: value * float(self.state.modal.scale[at])}
                )

    def named(self, name: str) -> float:
        """Return a global name: one that a program has set, or that the control knows."""
        if (found := self.names.get(name)) is not None:
            return found
        if (known := _NAMED.get(name)) is not None:
            return float(known(self))
        if name.startswith(("_ini[", "_hal[")):
            raise NumberError(f"#<{name}> is not there: no INI file and no HAL", "Set a parameter instead.")
        raise NumberError(f"#<{name}> has no value", "Set it first, or ask with EXISTS.")

    def name(self, name: str, value: float) -> None:
        """Set a global name."""
        if name in _NAMED:
            raise NumberError(f"#<{name}> can only be read")
        self.names[name] = value

    def exists(self, name: str, frame: dict[str, float]) -> float:
        """Tell whether a name has a value."""
        return 1.0 if name in frame or name in self.names or name in _NAMED else 0.0

    def _system(self, index: int) -> float:
        state = self.state
        if 5221 <= index <= 5389:
            system, axis = divmod(index - 5221, 20)
            if axis < len(AXES):
                return self._axis(axis, state.tables.work_offset(_SYSTEMS[system]))
        elif 5211 <= index <= 5219:
            return self._axis(index - 5211, state.coordinates.shift)
        elif index == 5220:
            return (
                _SYSTEMS.index(state.coordinates.work[0]) + 1.0
                if state.coordinates.work[0] in _SYSTEMS
                else 1.0
            )
        elif index == 5400:
            return float(state.tool)
        elif 5401 <= index <= 5409:
            return self._axis(index - 5401, state.coordinates.length)
        elif index == 5410:
            return 2.0 * state.tables.tool(state.tool).radius_mm / (25.4 if state.modal.whole[INCH] else 1.0)
        elif 5420 <= index <= 5428:
            return self.position(index - 5420)
        return self._others.get(index, 0.0)

    def position(self, axis: int, *, machine: bool = False) -> float:
        """Return the programmed position of an axis, in the coordinates in force or in those of the machine."""
        modal = self.state.modal
        return self._axis(axis, modal.position if machine else modal.position - modal.offset)

    def _axis(self, axis: int, vector: object) -> float:
        names = list(self.state.axis_names)
        if AXES[axis] not in names:
            return 0.0
        at = names.index(AXES[axis])
        return float(vector[at]) / float(self.state.modal.scale[at])  # type: ignore[index]


def _index(number: float) -> int:
    index = round(number)
    if abs(number - index) > 0.0001:
        raise NumberError(f"#{number:g} is no whole number")
    if not 0 < index < _LAST:
        raise NumberError(f"there is no parameter #{index}", f"Numbers are 1 to {_LAST - 1}.")
    return index


def _mode(column: int, value: int) -> Callable[[Parameters], float]:
    return lambda of: float(of.state.modal.whole[column] == value)


def _at(axis: int, machine: bool) -> Callable[[Parameters], float]:
    return lambda of: of.position(axis, machine=machine)


_NAMED: dict[str, Callable[[Parameters], float]] = {
    **{f"_{letter.lower()}": _at(axis, False) for axis, letter in enumerate(AXES)},
    **{f"_abs_{letter.lower()}": _at(axis, True) for axis, letter in enumerate(AXES)},
    "_feed": lambda of: float(of.state.modal.real[FEED_NUMBER]),
    "_rpm": lambda of: float(of.state.spindle.speed),
    "_selected_tool": lambda of: float(of.state.selected_tool),
    "_current_tool": lambda of: float(of.state.tool),
    "_metric": _mode(INCH, 0),
    "_imperial": _mode(INCH, 1),
    "_absolute": _mode(ABSOLUTE, 1),
    "_incremental": _mode(ABSOLUTE, 0),
    "_inverse_time": _mode(FEED_MODE, FEED_INVERSE_TIME),
    "_units_per_minute": _mode(FEED_MODE, FEED_PER_MINUTE),
    "_units_per_rev": _mode(FEED_MODE, FEED_PER_REVOLUTION),
    "_plane": lambda of: _PLANES[int(of.state.modal.whole[PLANE])],
    "_motion_mode": lambda of: _MOTIONS[int(of.state.modal.whole[MOTION])],
    "_coord_system": lambda of: 10.0 * float((of.state.coordinates.work[0] or "G54")[1:]),
    "_call_level": lambda of: float(of.level),
    "_ccomp": lambda of: {0: 400.0, 1: 410.0, -1: 420.0}[of.state.side],
    "_line": lambda _: 0.0,  # the translation puts the number of the line in its place
    "_vmajor": lambda _: 2.9,
    "_vminor": lambda _: 0.0,
    "_task": lambda _: 0.0,
    "_remap_level": lambda _: 0.0,
}
"""Names that the control knows. Source: LinuxCNC G-code manual, "Predefined Named Parameters"."""
