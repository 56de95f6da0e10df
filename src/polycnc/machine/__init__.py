"""The simulated machine: configuration and presets, kernel state, I/O image, clock, durable memory."""

from polycnc.machine._clock import Advance, Clock, Free, Pacer, Poll, RealTime, Step, Way
from polycnc.machine._config import (
    IoConfig,
    MachineConfig,
    PathConfig,
    SpindleConfig,
    TimesConfig,
    ToolConfig,
)
from polycnc.machine._config_axis import AxisConfig, LinearAxis, LinearServo, RotaryAxis, RotaryServo
from polycnc.machine._describe import (
    AXIS_COLUMNS,
    axis_rows,
    describe_machine,
    machine_file_reference,
    machine_row,
)
from polycnc.machine._io import IoBits, IoImage, scan_edges
from polycnc.machine._machine import Machine, Reason, Snapshot
from polycnc.machine._presets import DEFAULT_MACHINE, PRESETS, load_machine, preset_text
from polycnc.machine._store import Area, Entry, History, Store
from polycnc.machine._toml import StrictModel, load_toml, parse_toml, problem, validate
from polycnc.machine._toml_locator import KeyPath, Locator

__all__ = [
    "AXIS_COLUMNS",
    "DEFAULT_MACHINE",
    "PRESETS",
    "Advance",
    "Area",
    "AxisConfig",
    "Clock",
    "Entry",
    "Free",
    "History",
    "IoBits",
    "IoConfig",
    "IoImage",
    "KeyPath",
    "LinearAxis",
    "LinearServo",
    "Locator",
    "Machine",
    "MachineConfig",
    "Pacer",
    "PathConfig",
    "Poll",
    "RealTime",
    "Reason",
    "RotaryAxis",
    "RotaryServo",
    "Snapshot",
    "SpindleConfig",
    "Step",
    "Store",
    "StrictModel",
    "TimesConfig",
    "ToolConfig",
    "Way",
    "axis_rows",
    "describe_machine",
    "load_machine",
    "load_toml",
    "machine_file_reference",
    "machine_row",
    "parse_toml",
    "preset_text",
    "problem",
    "scan_edges",
    "validate",
]
