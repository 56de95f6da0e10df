"""The simulated machine: configuration and presets, kernel state, I/O image, clock, durable memory.

A run needs no store and no host: what a device needs besides is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from polycnc.machine._bounds import LARGEST_POSITION, LEAST_OVERRIDE, LONGEST_BLOCK_S, PIECE_CYCLES
from polycnc.machine._clock import Clock
from polycnc.machine._config import (
    IoConfig,
    MachineConfig,
    PathConfig,
    SpindleConfig,
    TimesConfig,
)
from polycnc.machine._config_axis import AnyAxis, AxisConfig, LinearAxis, LinearServo, RotaryAxis, RotaryServo
from polycnc.machine._config_probe import SurfaceConfig, first_contact
from polycnc.machine._config_stock import FixtureConfig, StockConfig
from polycnc.machine._config_tool import ToolConfig
from polycnc.machine._io import IoBits, IoImage, scan_edges
from polycnc.machine._machine import AxisState, Machine, MachineStatus, Reason
from polycnc.machine._presets import (
    ADDED_AXES,
    DEFAULT_MACHINE,
    PRESETS,
    load_machine,
    parse_machine,
    preset_text,
)
from polycnc.machine._snapshot import Array, Plain, Snapshot, SnapshotError, arrays_of, damaged_snapshot
from polycnc.machine._state_walk import copied, described, is_same, restore_state
from polycnc.machine._toml import (
    MOST_NESTING,
    StrictModel,
    is_nested_beyond,
    load_toml,
    parse_toml,
    problem,
    range_text,
    validate,
)
from polycnc.machine._toml_locator import KeyPath, Locator
from polycnc.machine._values import Form, Values
from polycnc.on_demand import names_on_demand

if TYPE_CHECKING:
    from polycnc.machine._async_host import AsyncHost
    from polycnc.machine._describe import (
        AXIS_COLUMNS,
        axis_rows,
        describe_machine,
        machine_file_reference,
        machine_row,
    )
    from polycnc.machine._device import Device, Timed
    from polycnc.machine._host import Host, HostError
    from polycnc.machine._pace import Pace, Pacer, Wall
    from polycnc.machine._polling import Polling
    from polycnc.machine._store import Area, Entry, History, Store
    from polycnc.machine._store_file import StoreError
    from polycnc.machine._ways import Condition, Elapsed, Free, Poll, RealTime, Step, Way, wait

__all__ = [
    "ADDED_AXES",
    "AXIS_COLUMNS",
    "DEFAULT_MACHINE",
    "LARGEST_POSITION",
    "LEAST_OVERRIDE",
    "LONGEST_BLOCK_S",
    "MOST_NESTING",
    "PIECE_CYCLES",
    "PRESETS",
    "AnyAxis",
    "Area",
    "Array",
    "AsyncHost",
    "AxisConfig",
    "AxisState",
    "Clock",
    "Condition",
    "Device",
    "Elapsed",
    "Entry",
    "FixtureConfig",
    "Form",
    "Free",
    "History",
    "Host",
    "HostError",
    "IoBits",
    "IoConfig",
    "IoImage",
    "KeyPath",
    "LinearAxis",
    "LinearServo",
    "Locator",
    "Machine",
    "MachineConfig",
    "MachineStatus",
    "Pace",
    "Pacer",
    "PathConfig",
    "Plain",
    "Poll",
    "Polling",
    "RealTime",
    "Reason",
    "RotaryAxis",
    "RotaryServo",
    "Snapshot",
    "SnapshotError",
    "SpindleConfig",
    "Step",
    "StockConfig",
    "Store",
    "StoreError",
    "StrictModel",
    "SurfaceConfig",
    "Timed",
    "TimesConfig",
    "ToolConfig",
    "Values",
    "Wall",
    "Way",
    "arrays_of",
    "axis_rows",
    "copied",
    "damaged_snapshot",
    "describe_machine",
    "described",
    "first_contact",
    "is_nested_beyond",
    "is_same",
    "load_machine",
    "load_toml",
    "machine_file_reference",
    "machine_row",
    "parse_machine",
    "parse_toml",
    "preset_text",
    "problem",
    "range_text",
    "restore_state",
    "scan_edges",
    "validate",
    "wait",
]

__getattr__ = names_on_demand(__name__)
