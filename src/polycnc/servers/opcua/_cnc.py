"""The types of OPC 40502 (computerized numerical control systems), version 1.0, and what their members show."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from polycnc import __version__
from polycnc.cnc import RunState
from polycnc.servers.opcua import _moment as words
from polycnc.servers.opcua._model import CNC, OF_AXIS, PERCENT, Enumeration, Member, Type
from polycnc.servers.opcua._moment import At

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


def codes(written: object) -> list[int]:
    """Return the codes of words like `G54`, `54` or `M3` that are whole numbers; 40502 has no place for others."""
    found = []
    for word in written if isinstance(written, list | tuple) else ():
        text = str(word).lstrip("GMgm")
        if text.isascii() and text.isdigit():
            found.append(int(text))
    return found


# ---------------------------------------------------------------------- readings


def _program(at: At) -> str:
    block = at.channel.block
    return block.program if block is not None else at.channel.program or ""


def _main_program(at: At) -> str:
    stack = at.channel.stack
    return stack[0] if stack else at.channel.program or ""


def _block(read: Callable[[Any], Any], otherwise: Any) -> Callable[[At], Any]:
    return lambda at: otherwise if at.channel.block is None else read(at.channel.block)


def _modal(read: Callable[[Any], Any], otherwise: Any) -> Callable[[At], Any]:
    return lambda at: otherwise if at.channel.modal is None else read(at.channel.modal)


def _work_offset(at: At) -> int:
    names = [each.name for each in at.channel.offsets]
    return next(iter(codes(names)), 0)


def _machine_position(at: At) -> Position | None:
    axis = at.axis
    return None if axis is None else (axis.machine, axis.setpoint, axis.to_go)


def _work_position(at: At) -> Position | None:
    axis = at.axis
    return None if axis is None else (axis.work, axis.work + axis.setpoint - axis.actual, axis.to_go)


def _of_axis(read: Callable[[Any], Any]) -> Callable[[At], Any]:
    return lambda at: None if at.axis is None else read(at.axis)


def _named(axis: str, read: Callable[[At], Position | None]) -> Callable[[At], Position | None]:
    return lambda at: read(At(at.status, at.fixed, at.number, axis))


def _angle(at: At) -> Position:
    angle = at.status.spindle.angle_deg
    return angle, angle, 0.0


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
    """Return the command that holds the feed, or goes on where it is held; None where nothing is to do."""
    held = at.channel.run_state is RunState.HOLD
    if on:
        return None if held else {"command": "feed_hold", "channel": at.number}
    return {"command": "cycle_start", "channel": at.number} if held else None


# ---------------------------------------------------------------------- types

_MODE = "CncOperationMode"
COMPONENT = Type("CncComponentType", CNC, 1001, abstract=True)
CHANNEL = Type("CncChannelType", CNC, 1002, COMPONENT, (
    Member("Id", "UInt32", lambda at: at.number + 1, 6016, prop=True),
    Member("ActOperationMode", _MODE, lambda at: at.operation_mode, 6055),
    Member("CmdOperationMode", _MODE, lambda at: at.operation_mode, 6543, write=set_mode),
    Member("ActStatus", "CncChannelStatus", lambda at: at.channel_state, 6048),
    Member("ActProgramStatus", "CncChannelProgramStatus", lambda at: at.program_state, 6023),
    Member("ActProgramName", "String", _program, 6030),
    Member("ActProgramFile", "String", _program, 6034),
    Member("ActProgramLine", "String", _block(lambda block: str(block.line), ""), 6047, optional=True),
    Member("ActProgramFileOffset", "UInt32", _block(lambda block: block.offset, 0), 6032, optional=True),
    Member("ActProgramBlock", "String", _block(lambda block: [block.text], []), 6033, array=True),
    Member("ActMainProgramName", "String", _main_program, 6031),
    Member("ActMainProgramFile", "String", _main_program, 6682),
    Member("ActGFunctions", "UInt32", _modal(lambda modal: codes(list(modal.g.values())), []), 6028, array=True),
    Member("ActMFunctions", "UInt32", _modal(lambda modal: list(modal.m), []), 6177, array=True),
    Member("ActModalOffsetFunction", "UInt32", _work_offset, 6029),
    Member("ActFeedrate", "Double", lambda at: at.channel.feed.actual, 6005, "mm/min", "feed"),
    Member("CmdFeedrate", "Double", lambda at: at.channel.feed.commanded, 6007, "mm/min", "feed"),
    Member("ActOverride", "Double", lambda at: 100.0 * at.channel.overrides.feed, 6001, "%", "feed override"),
    Member("CmdOverride", "Double", lambda at: 100.0 * at.channel.overrides.feed, 6003, "%", "feed override",
        write=set_feed_override),
    Member("DryRunFeed", "Double", lambda at: at.fixed.dry_run_mm_min, 6024, "mm/min", "feed"),
    Member("ActJogIncrement", "Double", lambda at: at.status.wheel.size, 6026, "mm", (0.0, 1000.0)),
    Member("FeedHold", "Boolean", lambda at: at.channel.run_state is RunState.HOLD, 6009, write=set_feed_hold),
    Member("BlockMode", "Boolean", lambda at: at.channel.switches.single_block, 6049),
    Member("ToolId", "UInt32", lambda at: at.channel.tool.number, 6056),
    *(Member(f"PosTcpBcs{axis}", POSITION, _named(axis, _machine_position), number, f"{OF_AXIS} {axis}",
            f"{OF_AXIS} {axis}")
        for axis, number in zip("ABCXYZ", (6037, 6159, 6166, 6168, 6172, 6183), strict=True)),
    *(Member(f"PosTcpWcs{axis}", POSITION, _named(axis, _work_position), number, f"{OF_AXIS} {axis}")
        for axis, number in zip("ABCXYZ", (6175, 6176, 6201, 6140, 6173, 6174), strict=True)),
))  # fmt: skip
DRIVE = Type("CncDriveType", CNC, 1003, COMPONENT, (
    Member("ActChannel", "NodeId", lambda at: at.fixed.nodes[f"channel {at.number}"], 6059),
    Member("ActLoad", "Double", _of_axis(lambda axis: axis.load_percent), 6060, "%", PERCENT),
    Member("ActPower", "Double", None, 6062, "W"),
    Member("ActTorque", "Double", None, 6064, "N·m"),
    Member("CmdTorque", "Double", None, 6066, "N·m"),
    Member("IsInactive", "Boolean", lambda at: False, 6200),
    Member("IsVirtual", "Boolean", lambda at: False, 6189),
), abstract=True)  # fmt: skip
AXIS = Type("CncAxisType", CNC, 1004, DRIVE, (
    Member("ActStatus", "CncAxisStatus", _of_axis(lambda axis: int(axis.moving)), 6102),
    Member("IsReferenced", "Boolean", _of_axis(lambda axis: axis.referenced), 6182),
    Member("IsRotational", "Boolean", _of_axis(lambda axis: axis.unit == "deg"), 6211),
    Member("PosDirect", POSITION, _machine_position, 6041, OF_AXIS, OF_AXIS),
    Member("PosIndirect", POSITION, _machine_position, 6039, OF_AXIS, OF_AXIS),
    Member("ZeroOffset", "Double", _of_axis(lambda axis: axis.machine - axis.work), 6100, OF_AXIS),
))  # fmt: skip
SPINDLE = Type("CncSpindleType", CNC, 1005, DRIVE, (
    Member("ActGear", "UInt32", None, 6128),
    Member("CmdGear", "UInt32", None, 6130),
    Member("ActSpeed", "Double", lambda at: abs(at.status.spindle.actual_rpm), 6120, "rpm", "spindle"),
    Member("CmdSpeed", "Double", lambda at: abs(at.status.spindle.commanded_rpm), 6122, "rpm", "spindle"),
    Member("ActOverride", "Double", lambda at: 100.0 * at.status.spindle.override, 6700, "%", "spindle override"),
    Member("CmdOverride", "Double", lambda at: 100.0 * at.status.spindle.override, 6702, "%", "spindle override",
        write=set_spindle_override),
    Member("ActStatus", "CncSpindleStatus", lambda at: at.spindle_state, 6135),
    Member("ActTurnDirection", "CncSpindleTurnDirection", lambda at: at.turn, 6132),
    Member("AnglePos", POSITION, _angle, 6072, "deg", (0.0, 360.0)),
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
