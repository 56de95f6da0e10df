"""The system functions of a control with one channel: signals, time, errors, tables, by their CPL names."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from polycnc.cnc import ProgramRun
from polycnc.controllers.bosch.system import (
    Column,
    ErrorList,
    Interface,
    ToolCompensations,
    ToolDatabase,
    ZeroShifts,
    clock_ms,
    date_text,
    time_text,
)
from polycnc.machine import Clock

_CHANNEL = 1
_AXES, _SPINDLES = 64, 8
_SECTORS, _PLACES = 9, 999


class SystemFunctions:
    """What IC, CLOCK, DATE, TIME, GETERR, TDA, TC and FXC to FXINS do in channel 1; tables are empty at first."""

    def __init__(self, clock: Clock, run: Callable[[], ProgramRun]) -> None:
        self.interface = Interface(_CHANNEL, _AXES, _SPINDLES, pnc=False)
        self.errors = ErrorList(_CHANNEL)
        self.tool_data = ToolDatabase(dict.fromkeys(range(1, _SECTORS + 1), _PLACES))
        self._tools = ToolCompensations()
        self._shifts: ZeroShifts | None = None
        self._run = run
        self.functions: Mapping[str, Callable[..., object]] = {
            "CLOCK": partial(clock_ms, clock),
            "DATE": partial(date_text, clock),
            "TIME": partial(time_text, clock),
            "IC": partial(self.interface.read, _CHANNEL),
            "GETERR": self.errors.read,
            "TDA": self.tool_data.read,
            "TC": lambda *place: self.tools.read(*place),
            "FXC": lambda *place: self.shifts.fxc(*place),
            "FXCR": lambda *table: self.shifts.fxcr(*table),
            "FXDEL": lambda *column: self.shifts.fxdel(*column),
            "FXINS": lambda *column: self.shifts.fxins(*column),
        }
        self.setters: Mapping[str, Callable[..., None]] = {
            "IC": lambda value, *place: self.interface.write(value, _CHANNEL, *place),
            "TDA": self.tool_data.write,
            "TC": lambda value, *place: self.tools.write(value, *place),
            "FXC": lambda value, *place: self.shifts.set_fxc(value, *place),
        }

    @property
    def tools(self) -> ToolCompensations:
        """Return the tool tables, with the unit that is active now."""
        self._tools.inch = self._inch()
        return self._tools

    @property
    def shifts(self) -> ZeroShifts:
        """Return the zero shift tables, with a column for each axis of the machine, and the unit that is active now."""
        if self._shifts is None:
            config = self._run().machine.config
            axes = [Column(axis.name, rotary=axis.unit == "deg") for axis in config.axes]
            self._shifts = ZeroShifts(_CHANNEL, axes, {_CHANNEL: tuple(config.axis_names)})
        self._shifts.inch = self._inch()
        return self._shifts

    def _inch(self) -> bool:
        return bool(max(self._run().channel.state.modal.scale) > 1.0)
