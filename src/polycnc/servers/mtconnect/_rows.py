"""How MTConnect calls the facts of a machine: a row for each data item, with the versions that know it.

Names are those that adapters of controls have used for years, so that an existing Devices.xml works unchanged.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, TypeAlias

from polycnc.cnc import Emergency, Mode
from polycnc.servers.plant import FACTS, About, Execution, Scope, Unit

Version: TypeAlias = tuple[int, int]
VERSIONS: Mapping[str, Version] = MappingProxyType(
    {"2.7": (2, 7), "2.2": (2, 2), "1.8": (1, 8), "1.3": (1, 3)}
)
"""The versions that are served, the newest first."""
USUAL_VERSION = "2.7"
FIRST, LAST = (1, 0), (99, 0)

_UNITS = {
    (Unit.LENGTH, "mm"): "MILLIMETER", (Unit.LENGTH, "deg"): "DEGREE",
    (Unit.SPEED, "mm"): "MILLIMETER/SECOND", (Unit.SPEED, "deg"): "DEGREE/SECOND",
    (Unit.MM, ""): "MILLIMETER_3D", (Unit.MM_MIN, ""): "MILLIMETER/SECOND",
    (Unit.RPM, ""): "REVOLUTION/MINUTE", (Unit.SECOND, ""): "SECOND",
}  # fmt: skip

_SHARES = {Unit.MM_MIN: 1.0 / 60.0}
"""What values are multiplied by to have MTConnect's unit."""

_EXECUTION = {
    Execution.READY: "READY", Execution.ACTIVE: "ACTIVE", Execution.HOLD: "FEED_HOLD",
    Execution.INTERRUPTED: "INTERRUPTED", Execution.STOPPED: "STOPPED", Execution.PROGRAM_STOP: "PROGRAM_STOPPED",
    Execution.OPTIONAL_STOP: "OPTIONAL_STOP", Execution.COMPLETED: "PROGRAM_COMPLETED",
}  # fmt: skip
_MODE = {
    Mode.AUTO: "AUTOMATIC", Mode.MDI: "MANUAL_DATA_INPUT", Mode.JOG: "MANUAL", Mode.INC: "MANUAL",
    Mode.HANDLE: "MANUAL", Mode.REF: "MANUAL", Mode.EDIT: "EDIT",
}  # fmt: skip
_EMERGENCY = {Emergency.OFF: "ARMED", Emergency.RESET_NEEDED: "ARMED", Emergency.ON: "TRIGGERED"}
_OFF_ON = {0: "OFF", 1: "ON"}
_STATE = {"home": "HOME", "travel": "TRAVEL", "stopped": "STOPPED"}
_DIRECTION = {1: "CLOCKWISE", -1: "COUNTER_CLOCKWISE"}


@dataclass(frozen=True, slots=True)
class Row:
    """A data item: `key` is its name, with {} for the axis or, from the second channel on, the channel's number.

    `words` are what MTConnect calls the values, `older` what versions before `older_until` call them. `only` is the
    unit of the axes that have it. `since` is the first version with it, `until` the first without.
    """

    key: str
    fact: str
    type: str
    subtype: str = ""
    sample: bool = False
    words: Mapping[Any, str] | None = None
    older: Mapping[Any, str] = field(default_factory=dict)
    older_until: Version = FIRST
    system: str = ""
    only: str = ""
    since: Version = FIRST
    until: Version = LAST
    subtype_since: Version = FIRST

    def units(self, unit: str) -> str:
        """Return the units, of an axis that counts in `unit` ("" otherwise); "" for what has none."""
        return self.given_units or _UNITS.get((FACTS[self.fact].unit, unit), "")

    @property
    def share(self) -> float:
        """What a value of the fact is multiplied by."""
        return _SHARES.get(FACTS[self.fact].unit, 1.0)

    @property
    def given_units(self) -> str:
        """The units that do not depend on an axis."""
        return "PERCENT" if self.sample and FACTS[self.fact].unit is Unit.PERCENT else ""

    def is_in(self, version: Version) -> bool:
        """Tell whether a version has it."""
        return self.since <= version < self.until


@dataclass(frozen=True, slots=True)
class ConditionRow:
    """A condition: what it is about, and where it stands."""

    key: str
    about: About
    type: str


# fmt: off
ROWS = (
    Row("avail", "available", "AVAILABILITY", words={"available": "AVAILABLE"}),
    Row("powered", "powered_s", "EQUIPMENT_TIMER", "POWERED", sample=True, since=(1, 4)),
    Row("operating", "operating_s", "EQUIPMENT_TIMER", "OPERATING", sample=True, since=(1, 4)),
    Row("cutting", "cutting_s", "EQUIPMENT_TIMER", "LOADED", sample=True, since=(1, 4)),
    Row("estop", "emergency", "EMERGENCY_STOP", words=_EMERGENCY),
    Row("part_count", "parts", "PART_COUNT", "ALL"),
    Row("part_target", "parts_wanted", "PART_COUNT", "TARGET"),
    Row("cycle_time", "cycle_s", "PROCESS_TIMER", "PROCESS", sample=True, since=(1, 4)),
    Row("mode{}", "mode", "CONTROLLER_MODE", words=_MODE),
    Row("execution{}", "execution", "EXECUTION", words=_EXECUTION,
        older=_EXECUTION | {Execution.OPTIONAL_STOP: "PROGRAM_OPTIONAL_STOP"}, older_until=(1, 4)),
    Row("program{}", "program", "PROGRAM"),
    Row("active_program{}", "active_program", "PROGRAM", "ACTIVE", since=(2, 0)),
    Row("program_comment{}", "program_comment", "PROGRAM_COMMENT"),
    Row("nest_level{}", "nest_level", "PROGRAM_NEST_LEVEL", since=(2, 0)),
    Row("block{}", "block", "BLOCK"),
    Row("line{}", "line", "LINE", until=(1, 4)),
    Row("line{}", "line", "LINE_NUMBER", "ABSOLUTE", since=(1, 4)),
    Row("sequenceNum{}", "sequence", "LINE_LABEL", since=(1, 4)),
    Row("path_feedrate{}", "feed", "PATH_FEEDRATE", "ACTUAL", sample=True),
    Row("f_command{}", "commanded_feed", "PATH_FEEDRATE", "COMMANDED", sample=True),
    Row("f_program{}", "programmed_feed", "PATH_FEEDRATE", "PROGRAMMED", sample=True),
    Row("Fovr{}", "feed_override", "PATH_FEEDRATE_OVERRIDE", "PROGRAMMED"),
    Row("Frapidovr{}", "rapid_override", "PATH_FEEDRATE_OVERRIDE", "RAPID"),
    Row("path_position{}", "path_position", "PATH_POSITION", "ACTUAL", sample=True, system="WORK"),
    Row("tool_id{}", "tool", "TOOL_NUMBER", since=(1, 4)),
    Row("tool_id{}", "tool", "TOOL_ID", until=(1, 4)),
    Row("tool_number{}", "tool", "TOOL_NUMBER", until=(1, 4)),
    Row("work_offset{}", "work_offset", "WORK_OFFSET", since=(1, 4)),
    Row("active_axes{}", "active_axes", "ACTIVE_AXES"),
    Row("dry_run{}", "dry_run", "CONTROLLER_MODE_OVERRIDE", "DRY_RUN", words=_OFF_ON, since=(1, 4)),
    Row("single_block{}", "single_block", "CONTROLLER_MODE_OVERRIDE", "SINGLE_BLOCK", words=_OFF_ON, since=(1, 4)),
    Row("machine_lock{}", "machine_lock", "CONTROLLER_MODE_OVERRIDE", "MACHINE_AXIS_LOCK", words=_OFF_ON, since=(1, 4)),
    Row("optional_stop{}", "optional_stop", "CONTROLLER_MODE_OVERRIDE", "OPTIONAL_STOP", words=_OFF_ON, since=(1, 4)),
    Row("{}act", "machine_position", "POSITION", "ACTUAL", sample=True, system="MACHINE", only="mm"),
    Row("{}com", "setpoint", "POSITION", "COMMANDED", sample=True, system="MACHINE", only="mm"),
    Row("{}work", "work_position", "POSITION", "ACTUAL", sample=True, system="WORK", only="mm"),
    Row("{}frt", "velocity", "AXIS_FEEDRATE", "ACTUAL", sample=True, only="mm"),
    Row("{}err", "following_error", "FOLLOWING_ERROR_LINEAR", "ACTUAL", sample=True, only="mm", since=(2, 7)),
    Row("{}act", "machine_position", "ANGLE", "ACTUAL", sample=True, system="MACHINE", only="deg"),
    Row("{}com", "setpoint", "ANGLE", "COMMANDED", sample=True, system="MACHINE", only="deg"),
    Row("{}work", "work_position", "ANGLE", "ACTUAL", sample=True, system="WORK", only="deg"),
    Row("{}frt", "velocity", "ANGULAR_VELOCITY", sample=True, only="deg"),
    Row("{}err", "following_error", "FOLLOWING_ERROR_ANGULAR", "ACTUAL", sample=True, only="deg", since=(2, 7)),
    Row("{}load", "load", "LOAD", sample=True),
    Row("{}state", "axis_state", "AXIS_STATE", words=_STATE),
    Row("S1speed", "spindle_speed", "ROTARY_VELOCITY", "ACTUAL", sample=True),
    Row("Srpm", "spindle_speed", "SPINDLE_SPEED", "ACTUAL", sample=True, until=(1, 4)),
    Row("S1cmd", "commanded_spindle_speed", "ROTARY_VELOCITY", "COMMANDED", sample=True),
    Row("S1prog", "programmed_spindle_speed", "ROTARY_VELOCITY", "PROGRAMMED", sample=True),
    Row("SspeedOvr", "spindle_override", "ROTARY_VELOCITY_OVERRIDE"),
    Row("S1dir", "spindle_direction", "DIRECTION", "ROTARY", words=_DIRECTION, subtype_since=(1, 8)),
    Row("S1mode", "spindle_mode", "ROTARY_MODE", words={"spindle": "SPINDLE"}),
)
CONDITIONS = (
    ConditionRow("system", About.SYSTEM, "SYSTEM"),
    ConditionRow("logic", About.LOGIC, "LOGIC_PROGRAM"),
    ConditionRow("comms", About.LINK, "COMMUNICATIONS"),
    ConditionRow("motion{}", About.MOTION, "MOTION_PROGRAM"),
    ConditionRow("{}travel", About.TRAVEL, "POSITION"),
    ConditionRow("{}servo", About.DRIVE, "ACTUATOR"),
    ConditionRow("S1servo", About.SPINDLE, "ACTUATOR"),
)
# fmt: on

CONDITION_SCOPES = {
    About.SYSTEM: Scope.MACHINE,
    About.LOGIC: Scope.MACHINE,
    About.LINK: Scope.MACHINE,
    About.MOTION: Scope.CHANNEL,
    About.TRAVEL: Scope.AXIS,
    About.DRIVE: Scope.AXIS,
    About.SPINDLE: Scope.SPINDLE,
}
"""What a condition is one of."""
ON_DEVICE = frozenset({"avail", "powered", "operating", "cutting"})
"""The keys of what stands on the device itself; other facts of the machine stand on its controller."""
ON_FIRST_PATH = frozenset({"part_count", "part_target", "cycle_time"})
"""The keys of facts of the machine that stand on its first path, where collectors look for them."""
