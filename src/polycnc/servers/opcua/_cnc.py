"""The types of OPC 40502 (computerized numerical control systems), version 1.0, and what their members show."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from polycnc import __version__
from polycnc.cnc import ControlError, Refusal
from polycnc.servers.opcua import _moment as words
from polycnc.servers.opcua._model import CNC, OF_AXIS, PERCENT, Enumeration, Member, Type
from polycnc.servers.opcua._moment import At, Of, Several

Position = tuple[float, float, float]
"""Actual and commanded position and the rest of the way."""
POSITION = "CncPositionDataType"
POSITION_NUMBERS = {"type": 2001, "data": 3007, "binary": 5001, "ActPos": 6046, "CmdPos": 6044, "RemDist": 6050,
                    "EngineeringUnits": 6829, "EURange": 6881}  # fmt: skip
VENDOR = "polycnc"

ENUMERATIONS = (
    Enumeration("CncAxisStatus", CNC, 3004, words.AXIS_STATES),
    Enumeration("CncChannelProgramStatus", CNC, 3002, words.PROGRAM_STATES),
    Enumeration("CncChannelStatus", CNC, 3003, words.CHANNEL_STATES),
    Enumeration("CncOperationMode", CNC, 3006, words.OPERATION_MODES),
    Enumeration("CncSpindleStatus", CNC, 3005, words.SPINDLE_STATES),
    Enumeration("CncSpindleTurnDirection", CNC, 3001, words.TURNS),
)


def _work_offset(name: str) -> int:
    """Return the code of a work offset; 40502 has no place for those without a whole number."""
    code = name.lstrip("G")
    return int(code) if code.isascii() and code.isdigit() else 0


def _work_position(work: float, setpoint: float, machine: float, to_go: float) -> Position:
    return work, work + setpoint - machine, to_go


def _turn(direction: int) -> int:
    return words.TURNS.index({1: "CW", -1: "CCW"}.get(direction, "None"))


_MACHINE_POSITION = "machine_position", "setpoint", "to_go"
_WORK_POSITION = "work_position", "setpoint", "machine_position", "to_go"


# ---------------------------------------------------------------------- what may be written


def set_feed_override(at: At, percent: float) -> Mapping[str, Any]:
    """Return the command of a feed override (%)."""
    return {"command": "set_overrides", "feed": percent / 100.0, "channel": at.number}


def set_spindle_override(_: At, percent: float) -> Mapping[str, Any]:
    """Return the command of a spindle override (%)."""
    return {"command": "set_overrides", "spindle": percent / 100.0}


def set_mode(at: At, mode: int) -> Mapping[str, Any]:
    """Return the command of an operation mode; the manual one is jogging."""
    return {"command": "select_mode", "mode": ("jog", "mdi", "auto")[mode], "channel": at.number}


def set_feed_hold(at: At, on: bool) -> Mapping[str, Any] | None:
    """Return the command that holds the feed, or goes on where it is held; None where nothing is to do.

    Raises:
        ControlError: There is no program whose feed could be held.
    """
    held = at.read("hold")
    if on and not held:
        if not at.seen.status.channels[at.number].active:
            raise ControlError(Refusal.IDLE, "no program is being executed", hint="Start one.")
        return {"command": "feed_hold", "channel": at.number}
    if on:
        return None
    return {"command": "cycle_start", "channel": at.number} if held else None


# ---------------------------------------------------------------------- types

_MODE = "CncOperationMode"
COMPONENT = Type("CncComponentType", CNC, 1001, abstract=True)
CHANNEL = Type("CncChannelType", CNC, 1002, COMPONENT, (
    Member("Id", "UInt32", lambda at: at.number + 1, 6016, prop=True),
    Member("ActOperationMode", _MODE, Of("mode", words.operation_mode), 6055),
    Member("CmdOperationMode", _MODE, Of("mode", words.operation_mode), 6543, write=set_mode),
    Member("ActStatus", "CncChannelStatus", Of("channel_state", words.word_of(words.CHANNEL_STATES)), 6048),
    Member("ActProgramStatus", "CncChannelProgramStatus",
        Of("program_state", words.word_of(words.PROGRAM_STATES)), 6023),
    Member("ActProgramName", "String", Of("block_program", otherwise=""), 6030),
    Member("ActProgramFile", "String", Of("block_program", otherwise=""), 6034),
    Member("ActProgramLine", "String", Of("line", str, ""), 6047, optional=True),
    Member("ActProgramFileOffset", "UInt32", Of("offset", otherwise=0), 6032, optional=True),
    Member("ActProgramBlock", "String", Of("block", lambda text: [text], ()), 6033, array=True),
    Member("ActMainProgramName", "String", Of("main_program", otherwise=""), 6031),
    Member("ActMainProgramFile", "String", Of("main_program", otherwise=""), 6682),
    Member("ActGFunctions", "UInt32", Of("g_codes", list), 6028, array=True),
    Member("ActMFunctions", "UInt32", Of("m_codes", list), 6177, array=True),
    Member("ActModalOffsetFunction", "UInt32", Of("work_offset", _work_offset, 0), 6029),
    Member("ActFeedrate", "Double", Of("feed"), 6005, "mm/min", "feed"),
    Member("CmdFeedrate", "Double", Of("commanded_feed"), 6007, "mm/min", "feed"),
    Member("ActOverride", "Double", Of("feed_override"), 6001, "%", "feed override"),
    Member("CmdOverride", "Double", Of("feed_override"), 6003, "%", "feed override",
        write=set_feed_override),
    Member("DryRunFeed", "Double", lambda at: at.fixed.dry_run_mm_min, 6024, "mm/min", "feed"),
    Member("ActJogIncrement", "Double", Of("jog_increment"), 6026, "mm", (0.0, 1000.0)),
    Member("FeedHold", "Boolean", Of("hold", bool), 6009, write=set_feed_hold),
    Member("BlockMode", "Boolean", Of("single_block", bool), 6049),
    Member("ToolId", "UInt32", Of("tool"), 6056),
    *(Member(f"PosTcpBcs{axis}", POSITION, Several(_MACHINE_POSITION, axis=axis), number, f"{OF_AXIS} {axis}",
            f"{OF_AXIS} {axis}")
        for axis, number in zip("ABCXYZ", (6037, 6159, 6166, 6168, 6172, 6183), strict=True)),
    *(Member(f"PosTcpWcs{axis}", POSITION, Several(_WORK_POSITION, _work_position, axis), number, f"{OF_AXIS} {axis}")
        for axis, number in zip("ABCXYZ", (6175, 6176, 6201, 6140, 6173, 6174), strict=True)),
))  # fmt: skip
DRIVE = Type("CncDriveType", CNC, 1003, COMPONENT, (
    Member("ActChannel", "NodeId", lambda at: at.fixed.nodes[f"channel {at.number}"], 6059),
    Member("ActLoad", "Double", Of("load"), 6060, "%", PERCENT),
    Member("ActPower", "Double", None, 6062, "W"),
    Member("ActTorque", "Double", None, 6064, "N·m"),
    Member("CmdTorque", "Double", None, 6066, "N·m"),
    Member("IsInactive", "Boolean", lambda at: False, 6200),
    Member("IsVirtual", "Boolean", lambda at: False, 6189),
), abstract=True)  # fmt: skip
AXIS = Type("CncAxisType", CNC, 1004, DRIVE, (
    Member("ActStatus", "CncAxisStatus", Of("moving"), 6102),
    Member("IsReferenced", "Boolean", Of("referenced", bool), 6182),
    Member("IsRotational", "Boolean", lambda at: at.fixed.units.get(at.name) == "deg", 6211),
    Member("PosDirect", POSITION, Several(_MACHINE_POSITION), 6041, OF_AXIS, OF_AXIS),
    Member("PosIndirect", POSITION, Several(_MACHINE_POSITION), 6039, OF_AXIS, OF_AXIS),
    Member("ZeroOffset", "Double", Of("zero_offset"), 6100, OF_AXIS),
))  # fmt: skip
SPINDLE = Type("CncSpindleType", CNC, 1005, DRIVE, (
    Member("ActGear", "UInt32", None, 6128),
    Member("CmdGear", "UInt32", None, 6130),
    Member("ActSpeed", "Double", Of("spindle_speed"), 6120, "rpm", "spindle"),
    Member("CmdSpeed", "Double", Of("commanded_spindle_speed"), 6122, "rpm", "spindle"),
    Member("ActOverride", "Double", Of("spindle_override"), 6700, "%", "spindle override"),
    Member("CmdOverride", "Double", Of("spindle_override"), 6702, "%", "spindle override",
        write=set_spindle_override),
    Member("ActStatus", "CncSpindleStatus", Of("spindle_state", words.word_of(words.SPINDLE_STATES)), 6135),
    Member("ActTurnDirection", "CncSpindleTurnDirection", Of("spindle_turn", _turn), 6132),
    Member("AnglePos", POSITION, Of("spindle_angle", lambda angle: (angle, angle, 0.0)), 6072, "deg", (0.0, 360.0)),
))  # fmt: skip
AXES = Type("CncAxisListType", CNC, 1008)
SPINDLES = Type("CncSpindleListType", CNC, 1009)
CHANNELS = Type("CncChannelListType", CNC, 1010)
INTERFACE = Type("CncInterfaceType", CNC, 1007, 58, (
    Member("VendorName", "String", lambda at: VENDOR, 6620, prop=True),
    Member("VendorRevision", "String", lambda at: __version__, 6621, prop=True),
    Member("Version", "String", lambda at: "1.0", 6616, prop=True),
    Member("CncTypeName", "String", lambda at: at.fixed.name, 6092, prop=True, optional=True),
))  # fmt: skip
ALARM = Type("CncAlarmType", CNC, 1006, 10523, (
    Member("AlarmIdentifier", "String", None, 6865, prop=True),
    Member("AuxParameters", "String", None, 6862, prop=True, array=True, optional=True),
    Member("HelpSource", "String", None, 6854, prop=True, optional=True),
))  # fmt: skip
MESSAGE = Type("CncMessageType", CNC, 1011, 2041)
TYPES = (COMPONENT, CHANNEL, DRIVE, AXIS, SPINDLE, AXES, SPINDLES, CHANNELS, INTERFACE, ALARM, MESSAGE)
"""All of them, each after its base."""
