"""The parameters of RS274/NGC: numbered ones, global names, and what the control says under numbers and names."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

from polycnc.machine import Machine
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._tables import WORK_SYSTEMS
from polycnc.nc.blocks._tool_offsets import TURNED_TIPS, offsets_of
from polycnc.nc.modal._modal import length_scale
from polycnc.nc.rs274._functions import NumberError
from polycnc.nc.rs274._inputs import ANSWER
from polycnc.nc.rs274._known_names import KNOWN_NAMES
from polycnc.nc.rs274._line import bare
from polycnc.nc.rs274._parameter_file import parameters_text, read_parameters
from polycnc.units import MM_PER_INCH

AXES = "XYZABCUVW"
LAST_LOCAL = 30
LAST_COMMON = 5000
_LAST = 5602
_OF_MACHINE = re.compile(r"_ini\[([^\]]*)\](.*)|_hal\[([^\]]*)\]")
DEBUGS = 5599
"""The parameter that DEBUG shows nothing without."""
_REFERENCES = {5160 // 20: 1, 5180 // 20: 2}
"""Which reference position the parameters from #5161 and #5181 are."""


class Parameters:
    """Hold what programs set, and read the rest from the state of a channel.

    Positions are in the units of the program. Offsets, reference positions and tools are in those of the machine, as
    in the parameter file, whatever G20 and G21 say (LinuxCNC G-code manual, "G28": native machine units).
    """

    def __init__(self) -> None:
        self.common = [0.0] * (LAST_COMMON + 1)
        self.names: dict[str, float] = {"_value": 0.0, "_value_returned": 0.0}
        self.level = 0
        self._others: dict[int, float] = {DEBUGS: 1.0}
        self._state: ChannelState | None = None
        self._machine: Machine | None = None
        self._length_mm = 1.0
        self.filed: tuple[int, ...] = ()
        """The numbers in the file that the programs began with."""

    def saved(self) -> tuple[dict[int, float], dict[int, float]]:
        """Return what programs have set by number: common parameters, and further ones."""
        return {n: value for n, value in enumerate(self.common) if value}, dict(self._others)

    def restore_state(
        self, common: dict[int, float], others: dict[int, float], names: dict[str, float]
    ) -> None:
        """Go back to what programs had set."""
        self.common[:] = [common.get(n, 0.0) for n in range(len(self.common))]
        self._others, self.names = dict(others), dict(names)

    def attach(self, state: ChannelState, machine: Machine) -> None:
        """Read from the state of a channel, and from its machine."""
        first, self._state, self._machine = self._machine is None, state, machine
        self._length_mm = MM_PER_INCH if machine.config.programs.parameters_inch else 1.0
        if first and (file := machine.config.programs.parameter_file) is not None:
            self.load(read_parameters(file))

    def load(self, values: Mapping[int, float]) -> None:
        """Begin with the parameters of a file.

        Work offsets, the reference positions, the shift of G92 and the work offset in force are taken over too.
        """
        self.filed = tuple(values)
        state = self.state
        for index, value in values.items():
            if index <= LAST_LOCAL or 5400 <= index <= 5428 or index in (5210, 5220):
                continue
            self.put(index, value, [])
        coordinates = replace(state.coordinates, selected=None)
        if values.get(5210):
            coordinates = replace(coordinates, shifted=True)
        system = round(values.get(5220, 1.0))
        if 1 < system <= len(WORK_SYSTEMS):
            coordinates = coordinates.with_work_offset(0, WORK_SYSTEMS[system - 1])
        state.place_zero(coordinates)

    def file_text(self) -> str:
        """Return the text of a file with the parameters of that one and all offsets."""
        return parameters_text(self.filed, lambda index: 0.0 if index <= LAST_LOCAL else self.get(index, []))

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
            self._set_system(index, value)

    def _set_system(self, index: int, value: float) -> None:
        """Take over a parameter that stands for a work offset, a kept shift or a reference position."""
        state = self.state
        system, place = divmod(index - 5221, 20)
        if 0 <= system < len(WORK_SYSTEMS) and place == len(AXES):
            state.tables.set_turn(WORK_SYSTEMS[system], value)
        elif 0 <= system < len(WORK_SYSTEMS) and (at := self._axis_of(place)) is not None:
            name = WORK_SYSTEMS[system]
            if name == state.coordinates.work[0]:  # counts when it is selected anew
                kept = state.coordinates.first_offset(state.tables)
                state.coordinates = replace(state.coordinates, selected=kept)
            state.tables.set_offset(name, {at: value * self._own_unit(at)})
        elif 5211 <= index <= 5219 and (at := self._axis_of(index - 5211)) is not None:
            if state.coordinates.shifted:
                raise NumberError(f"#{index} while its shift is in force", "Suspend it with G92.2 first.")
            state.coordinates = state.coordinates.keeping_shift({at: value * self._own_unit(at)})
        elif number := _REFERENCES.get(index // 20):
            point = list(state.reference(number))
            if (at := self._axis_of((index - 1) % 20)) is not None:
                point[at] = value * self._own_unit(at)
            first, second = state.references
            state.references = (tuple(point), second) if number == 1 else (first, tuple(point))

    def answer(self, value: float) -> None:
        """Keep how the input of the last M66 was."""
        self._others[ANSWER] = value

    def named(self, name: str) -> float:
        """Return a global name: one that a program has set, or that the control knows."""
        if (found := self.names.get(name)) is not None:
            return found
        if (known := KNOWN_NAMES.get(name)) is not None:
            return float(known(self))
        if name.startswith(("_ini[", "_hal[")):
            if (value := self._of_machine(name)) is not None:
                return value
            table = "settings" if name.startswith("_ini[") else "pins"
            raise NumberError(
                f"#<{name}> is not there", f"Name it in [programs] {table} of the machine file."
            )
        raise NumberError(f"#<{name}> has no value", "Set it first, or ask with EXISTS.")

    def name(self, name: str, value: float) -> None:
        """Set a global name."""
        if name in KNOWN_NAMES or name.startswith(("_ini[", "_hal[")):
            raise NumberError(f"#<{name}> can only be read")
        self.names[name] = value

    def exists(self, name: str, frame: dict[str, float]) -> float:
        """Tell whether a name has a value."""
        known = name in frame or name in self.names or name in KNOWN_NAMES
        return 1.0 if known or self._of_machine(name) is not None else 0.0

    @staticmethod
    def exists_number(number: float) -> float:
        """Tell whether there is a parameter of a number."""
        return float(0.5 <= number < _LAST - 0.5)

    def _of_machine(self, name: str) -> float | None:
        """Return what the machine has under a name like `_ini[section]name` or `_hal[pin]`, None if nothing."""
        if self._machine is None or (found := _OF_MACHINE.fullmatch(name)) is None:
            return None
        programs = self._machine.config.programs
        if found[1] is not None:
            sections = [values for section, values in programs.settings.items() if bare(section) == found[1]]
            return next(
                (value for values in sections for key, value in values.items() if bare(key) == found[2]),
                None,
            )
        for point in self._machine.config.io.points:
            if bare(point) == found[3]:
                return float(self._machine.io[point])
        return next((value for pin, value in programs.pins.items() if bare(pin) == found[3]), None)

    def _system(self, index: int) -> float:
        state = self.state
        shifts = state.coordinates
        if 5221 <= index <= 5400 - 10:
            system, axis = divmod(index - 5221, 20)
            if axis < len(AXES):
                return self._own(axis, state.tables.work_offset(WORK_SYSTEMS[system]))
            if axis == len(AXES):
                return state.tables.turn_of(WORK_SYSTEMS[system])
        elif 5211 <= index <= 5219:
            return self._own(index - 5211, shifts.shift.tolist())
        elif index == 5210:
            return float(shifts.shifted)
        elif index == 5220:
            return WORK_SYSTEMS.index(shifts.work[0]) + 1.0 if shifts.work[0] in WORK_SYSTEMS else 1.0
        elif (number := _REFERENCES.get(index // 20)) and (index - 1) % 20 < len(AXES):
            return self._own((index - 1) % 20, state.reference(number))
        elif 5400 <= index <= 5413:
            return self._tool(index)
        elif 5420 <= index <= 5428:
            return self.position(index - 5420)
        elif 5061 <= index <= 5070:
            return self._probed(index - 5061)
        return self._others.get(index, 0.0)

    def _tool(self, index: int) -> float:
        """Return what the tool in the spindle has: its number, offsets, diameter, where its tip lies."""
        state = self.state
        tool = state.tables.tool(state.tool)
        if index == 5400:
            return float(state.tool)
        if index == 5410:
            return 2.0 * tool.radius_mm / self._length_mm
        if index == 5413:
            return float(TURNED_TIPS[tool.tip])
        shifts = offsets_of(state, tool)
        at = self._axis_of(index - 5401) if index < 5410 else None
        return 0.0 if at is None else shifts.get(at, 0.0) / self._own_unit(at)

    def _probed(self, place: int) -> float:
        """Return where the last probing move met something, by axis, or whether it did."""
        probe = self.state.probe
        met = None if probe is None else probe.position
        if place == len(AXES):
            return float(met is not None)
        if probe is None:
            return self._others.get(5061 + place, 0.0)
        modal = self.state.modal
        found = modal.position.tolist() if met is None else list(met)
        return self._axis(place, self.programmed(found))

    def programmed(self, position: list[float]) -> list[float]:
        """Return a machine position in the coordinates in force."""
        modal = self.state.modal
        return self.state.frame.back(
            [at - shift for at, shift in zip(position, modal.offset.tolist(), strict=True)]
        )

    def position(self, axis: int, *, machine: bool = False) -> float:
        """Return the position of an axis, in the coordinates in force or in those of the machine.

        With radius compensation it is the place beside the end of the last move (LinuxCNC `interp_namedparams.cc`).
        """
        found = self.state.compensation.beside(self.state.modal.position.tolist())
        return self._axis(axis, found if machine else self.programmed(found))

    def unit(self, axis: int) -> float:
        """Return what 1 counts along an axis, mm or degree: radii, whatever X words are."""
        modal = self.state.modal
        return 1.0 if modal.rotary[axis] else length_scale(modal)

    def _own_unit(self, axis: int) -> float:
        """Return what 1 counts along an axis in the units of the machine, mm or degree."""
        return 1.0 if self.state.modal.rotary[axis] else self._length_mm

    def _own(self, place: int, vector: Sequence[float]) -> float:
        at = self._axis_of(place)
        return 0.0 if at is None else float(vector[at]) / self._own_unit(at)

    def _axis_of(self, place: int) -> int | None:
        if not 0 <= place < len(AXES):
            return None
        names = list(self.state.axis_names)
        return names.index(AXES[place]) if AXES[place] in names else None

    def _axis(self, place: int, vector: Sequence[float]) -> float:
        at = self._axis_of(place)
        return 0.0 if at is None else float(vector[at]) / self.unit(at)


def _index(number: float) -> int:
    index = round(number)
    if abs(number - index) > 0.0001:
        raise NumberError(f"#{number:g} is no whole number")
    if not 0 < index < _LAST:
        raise NumberError(f"there is no parameter #{index}", f"Numbers are 1 to {_LAST - 1}.")
    return index
