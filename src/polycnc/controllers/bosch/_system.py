"""What the channels of a control share: its root, tables, interface, errors, drives, and what it shows."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np

from polycnc.cnc import RunState
from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.controllers.bosch._channel_data import ChannelData
from polycnc.controllers.bosch._channel_ports import AttachedRuns, ChannelPorts
from polycnc.controllers.bosch._kept_tables import KeptTables
from polycnc.controllers.bosch._link_files import LinkFiles
from polycnc.controllers.bosch._live_tables import LiveOffsets, LiveTools, fill_from_machine
from polycnc.controllers.bosch._memory import KeptVariables
from polycnc.controllers.bosch._parameters import (
    BASIC_SETTING,
    FILE,
    FIRST_MODULE,
    LANGUAGE,
    LINK_FOLDER,
    MODULES,
    SEARCH_PATH,
    TABLE_UNIT,
    macoda,
)
from polycnc.controllers.bosch._permanence import Permanence
from polycnc.controllers.bosch._positions import Positions
from polycnc.controllers.bosch._present_alarms import PresentAlarms
from polycnc.controllers.bosch._shown import Programs, Shown
from polycnc.controllers.bosch._table_files import TableFiles
from polycnc.controllers.bosch.files import Directory, StoredFile
from polycnc.controllers.bosch.ncs import Clients
from polycnc.controllers.bosch.system import (
    ALL_CHANNELS,
    RESET_EXECUTED,
    Category,
    Column,
    Drives,
    ErrorList,
    Ident,
    Interface,
    Parameter,
    PlcData,
    PlcRange,
    ToolCompensations,
    ToolDatabase,
    ZeroShifts,
    clock_ms,
    date_text,
    time_text,
)
from polycnc.machine import Clock, MachineConfig, Store
from polycnc.nc import Channel
from polycnc.nc.cpl import Fault

_NUMBERS = {"following_error": 1856}
_CATEGORIES = {1970: Category.UNKNOWN}  # the example of GETERR does not count it among part program errors
_MEMORY_FULL = "1869"
_SPINDLES = 8
_SECTORS, _PLACES = 9, 999
_PLC_BYTES, _PLC_MODULES, _MODULE_BYTES, _COUNTERS = 256, 256, 512, 256
_COUNTED = (PlcRange.TIMER, PlcRange.COUNTER, PlcRange.DATA_WORD)
_INCREMENTS = 10_000
_DRIVE_LISTS = (17, 187)


class BoschSystem:
    """The part of a control that is there once, with `axes` of a machine; permanent things lie under `root`.

    `store` is the durable memory of a device; without one, programs own the root one after the other (`permanence`).
    """

    def __init__(
        self,
        root: str | Path,
        clock: Clock,
        config: MachineConfig,
        channels: ChannelPorts | None = None,
        *,
        axes: SystemAxes | None = None,
        store: Store | None = None,
    ) -> None:
        self.config = config
        self.clock = clock
        self.axes = axes or SystemAxes(config.axis_names)
        self.directory = Directory(root)
        self.channels: ChannelPorts = channels or AttachedRuns()
        self.clients = Clients()
        self.open_files: dict[Path, StoredFile] = {}
        self.programs: dict[int, Programs] = {}
        """What the programs of each channel wait for."""
        self.running_files: list[Callable[[], set[Path]]] = []
        """What tells the files of the programs that run, of each channel."""
        self._noted: dict[int, tuple[Channel, int]] = {}
        self.kept = KeptVariables(self.directory)
        text = self.directory.own_text(FILE)
        self._macoda = {number: macoda(config, self.axes, number, text) for number in self.axes.channels}
        errors = [*self.kept.errors, *next(iter(self._macoda.values()))[1]]
        self.errors_of_files = [each for each in errors if each.code != _MEMORY_FULL]
        self.not_installed = [each for each in errors if each.code == _MEMORY_FULL]
        """Declared variables for which there is no memory: programs run without them."""
        self.links = LinkFiles(self.directory, str(self.parameter(LINK_FOLDER)), self.search_path)
        self.interface = Interface(len(self.axes.channels), 64, _SPINDLES)
        self.errors = ErrorList(len(self.axes.channels))
        self._alarms = PresentAlarms(self.errors, _NUMBERS)
        for each in self.not_installed:
            self.note_error(ALL_CHANNELS, each.code, Category.MINOR_SYSTEM, each.what)
        self.plc = self._new_plc()
        self.tool_data = ToolDatabase(dict.fromkeys(range(1, _SECTORS + 1), _PLACES))
        files = TableFiles(self.directory)
        inch = bool(self.parameter(TABLE_UNIT))
        columns = [Column(axis.name, rotary=axis.unit == "deg") for axis in config.axes]
        self.shifts = ZeroShifts(1, columns, self._channel_names(), files=files, new_inch=inch)
        self.tools = ToolCompensations(read_file=files.read_tools, write_file=files.write_tools)
        fill_from_machine(self.shifts, self.tools, config)
        tables = KeptTables(self.shifts, self.tools, self.tool_data)
        self.permanence = Permanence(self.directory.root, self.kept, tables, store)
        self.offsets = LiveOffsets(self.shifts, at_start="G54" in config.offsets)
        self.live_tools = LiveTools(self.tools)
        self.drives = Drives(self.axes.physical, self._drive, self._write_lines)
        self.data = {
            number: ChannelData(self.axes, number, self.channels, int(str(self.parameter(LANGUAGE))))
            for number in self.axes.channels
        }
        self.shown = Shown(self.axes, self.channels, lambda: (self.shifts, self.tools), self.programs)

    # ------------------------------------------------------------------ functions of a channel

    def functions(self, number: int) -> dict[str, Callable[..., object]]:
        """Return what programs of a channel can call."""
        return {
            **Positions(self.axes, number, self.channels.run).functions,
            **self.data[number].functions,
            "MCA": self._macoda[number][0].mca,
            "SCS": self.drives.scs,
            "SCSL": self.drives.scsl,
            "PLC": self.plc.read,
            "CLOCK": partial(clock_ms, self.clock),
            "DATE": partial(date_text, self.clock),
            "TIME": partial(time_text, self.clock),
            "IC": partial(self.interface.read, number),
            "GETERR": self._get_errors,
            "TDA": self.tool_data.read,
            "TC": lambda *place: self._tools_for(number).read(*place),
            "FXC": lambda *place: self._shifts_for(number).fxc(*place),
            "FXCR": lambda *table: self._shifts_for(number).fxcr(*table),
            "FXDEL": lambda *column: self._shifts_for(number).fxdel(*column),
            "FXINS": lambda *column: self._shifts_for(number).fxins(*column),
        }

    def setters(self, number: int) -> dict[str, Callable[..., None]]:
        """Return what an assignment to a system value does in a channel."""
        return {
            "IC": lambda value, *place: self.interface.write(value, number, *place),
            "PLC": self.plc.write,
            "TDA": self.tool_data.write,
            "TC": lambda value, *place: self._tools_for(number).write(value, *place),
            "FXC": lambda value, *place: self._shifts_for(number).set_fxc(value, *place),
        }

    def live_config(self) -> MachineConfig:
        """Return the machine file with the tables that change while programs run."""
        return self.config.model_copy(update={"offsets": self.offsets, "tools": self.live_tools})

    def parameter(self, number: int) -> object:
        """Return the first value of a MACODA parameter."""
        return self.parameters(number)[0]

    def parameters(self, number: int) -> Sequence[object]:
        """Return all values of a MACODA parameter."""
        channel, (found, _) = next(iter(self._macoda.items()))
        return found.parameters.get((number, channel)) or found.parameters[number, BASIC_SETTING]

    def all_parameters(self) -> dict[str, object]:
        """Return the values of all MACODA parameters by number; those of a channel are named like `701000010.2`."""
        _, (found, _) = next(iter(self._macoda.items()))
        return {
            str(number) if channel == BASIC_SETTING else f"{number}.{channel}": values
            for (number, channel), values in sorted(found.parameters.items())
        }

    @property
    def search_path(self) -> tuple[str, ...]:
        """The folders of the root that programs are searched for in, without / at their ends."""
        return tuple(str(each).strip("/") for each in self.parameters(SEARCH_PATH))

    def program_of(self, name: str) -> tuple[str, str] | None:
        """Return file and text of a program by its name or number: 999 lies in P999 or 999."""
        names = (f"P{name}", name) if name[:1].isdigit() else (name,)
        return next((found for each in names if (found := self.program(each))), None)

    def program(self, name: str) -> tuple[str, str] | None:
        """Return file and text of a program: a name without a folder is searched for along the search path."""
        for folder in ("",) if "/" in name else self.search_path:
            file = f"{folder}/{name}" if folder else name
            with suppress(Fault):
                text = self.directory.text(file)
                if text is not None:
                    return file, text
        return None

    # ------------------------------------------------------------------ errors and memory

    def note_error(self, channel: int, code: str, category: Category, text: str = "") -> None:
        """Put an error into what GETERR reads; one without a number of its own is 0."""
        number = int(code) if code.isdigit() else _NUMBERS.get(code, 0)
        self.errors.add(number, channel, _CATEGORIES.get(number, category), text, self.clock.now)

    def reset_signal(self, channel: int, value: bool) -> None:
        """Set the signal of a channel that says that its reset was executed."""
        group, bit = RESET_EXECUTED
        self.interface.set_bit(group, channel, bit, value)

    def note_errors(self) -> None:
        """Note what has gone wrong in the channels since."""
        for number in self.axes.channels:
            run = self.channels.run(number)
            if run is None:
                continue
            found = []  # of blocks that the program has got to, not of those that are prepared ahead
            if run.state is RunState.ALARM and run.alarm is None:
                found = [(each.code, Category.PART_PROGRAM, each.what) for each in run.channel.errors]
            elif run.alarm is not None:
                found.append((run.alarm.code, Category.CONTROL_OR_DRIVE, run.alarm.text))
            known = self._noted.get(number)
            count = known[1] if known is not None and known[0] is run.channel else 0
            for code, category, text in found[count:]:
                self.note_error(number, code, category, text)
            self._noted[number] = run.channel, len(found)
        runs = {number: self.channels.run(number) for number in self.axes.channels}
        by_runs = {
            (run.alarm.code, number - 1)
            for number, run in runs.items()
            if run is not None and run.alarm is not None
        }
        self._alarms.note(self.channels.alarms(), by_runs, self.clock.now)

    def forget_errors(self, channel: int) -> None:
        """Forget the errors of a channel: it was reset."""
        self.note_errors()
        self.errors.clear(channel)

    def _get_errors(self, *arguments: object) -> int:
        self.note_errors()
        return self.errors.read(*arguments)

    # ------------------------------------------------------------------ within

    def _shifts_for(self, number: int) -> ZeroShifts:
        """Return the tables as channel `number` sees them: its unit, and what is in force there."""
        shifts = self.shifts
        shifts.channel = number
        shifts.channels = self._channel_names()
        run = self.channels.run(number)
        if run is not None:
            state = run.channel.state
            shifts.inch = bool(self.data[number].programmed().inch)
            codes = (*state.coordinates.work, *state.coordinates.external)
            shifts.functions = frozenset(int(name[1:]) for name in codes if name[1:].isdigit())
        return shifts

    def _tools_for(self, number: int) -> ToolCompensations:
        tools = self.tools
        run = self.channels.run(number)
        if run is not None:
            state = run.channel.state
            codes = state.placement.compensations
            tools.inch = bool(self.data[number].programmed().inch)
            tools.groups = {
                "length": state.length_tool,
                "radius": state.compensation_tool or 0 if state.side else 0,
                "external": next((code for code in codes if code % 100 == 45), 0),
                "general": next((code for code in codes if code % 100 != 45), 0),
            }
        return tools

    def _channel_names(self) -> Mapping[int, tuple[str, ...]]:
        axes = self.axes
        return {number: tuple(map(axes.physical_name, own)) for number, own in axes.channels.items()}

    def _new_plc(self) -> PlcData:
        ranges = {each: bytearray(_PLC_BYTES) for each in PlcRange if each not in _COUNTED}
        return PlcData(
            ranges,
            {number: bytearray(_MODULE_BYTES) for number in range(_PLC_MODULES)},
            dict.fromkeys(range(_COUNTERS), 0),
            dict.fromkeys(range(_COUNTERS), 0),
            first_writable=int(str(self.parameter(FIRST_MODULE))),
            writable=int(str(self.parameter(MODULES))),
        )

    def _drive(self, physical: int, ident: Ident) -> Parameter | None:
        """Return a parameter of a simulated drive: position, speed, following distance, names, lists of numbers."""
        if ident[0] != "S":
            return None
        index, machine = self.axes.index(physical), self.channels.machine
        axis = self.shown.renew().axes[physical]
        match ident[1]:
            case 30 | 140 | 141:
                return {30: axis.drive.version, 140: axis.drive.controller, 141: axis.drive.motor}[ident[1]]
            case 40:
                return int(np.rint(float(machine.state.velocity[index]) * 60.0))
            case 47:
                return round(axis.setpoint * _INCREMENTS)
            case 51:
                return round(axis.actual * _INCREMENTS)
            case 189:
                return round((axis.lag or 0.0) * _INCREMENTS)
            case number if number in _DRIVE_LISTS:
                return [17, 30, 40, 47, 51, 140, 141, 187, 189] if number == 17 else [40, 51]
            case _:
                return None

    def _write_lines(self, name: str, lines: Sequence[str]) -> None:
        TableFiles.write_lines(self.directory, name, lines)
