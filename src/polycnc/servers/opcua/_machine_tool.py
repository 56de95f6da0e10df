"""The types of the monitoring and production view (OPC 40501-1, version 1.02) and what their members show."""

from __future__ import annotations

from polycnc import __version__
from polycnc.servers.opcua import _moment as words
from polycnc.servers.opcua._cnc import VENDOR
from polycnc.servers.opcua._model import DI, MACHINE_TOOL, MACHINERY, Enumeration, Member, Type
from polycnc.servers.opcua._moment import PRODUCTION_STATES, At, Of
from polycnc.servers.plant import asset_id

ENUMERATIONS = (
    Enumeration("MachineOperationMode", MACHINE_TOOL, 65, words.MACHINE_MODES),
    Enumeration("ChannelMode", MACHINE_TOOL, 67, words.CHANNEL_MODES),
    Enumeration("ChannelState", MACHINE_TOOL, 64, words.CHANNEL_STATES),
    Enumeration("ToolManagement", MACHINE_TOOL, 69, words.TOOL_MANAGEMENT),
    Enumeration("ToolLocked", MACHINE_TOOL, 66, words.TOOL_LOCKED),
)
_HOUR_S = 3600


def _version(at: At) -> str:
    return str(at.versions.get(at.name, 0))


def _description(at: At) -> str:
    """Return what the tool table says of a tool; nothing while it is being taken out of the list."""
    tool = at.seen.inventory.tools.get(int(at.name))
    return "" if tool is None else tool.description


GROUP = Type("FunctionalGroupType", DI, 1005, 61)
ITEM_IDENTIFICATION = Type("MachineryItemIdentificationType", MACHINERY, 1004, GROUP, (
    Member("Manufacturer", "LocalizedText", lambda at: VENDOR, 6002, prop=True, space=DI),
    Member("Model", "LocalizedText", lambda at: at.fixed.name, 6008, prop=True, space=DI, optional=True),
    Member("SerialNumber", "String", lambda at: at.fixed.serial_number, 6003, prop=True, space=DI),
    Member("SoftwareRevision", "String", lambda at: __version__, 6011, prop=True, space=DI, optional=True),
))  # fmt: skip
MACHINE_IDENTIFICATION = Type("MachineIdentificationType", MACHINERY, 1012, ITEM_IDENTIFICATION, (
    Member("ProductInstanceUri", "String", lambda at: f"urn:{VENDOR}:{at.fixed.name}", 6015, prop=True, space=DI),
))  # fmt: skip
IDENTIFICATION = Type("MachineToolIdentificationType", MACHINE_TOOL, 11, MACHINE_IDENTIFICATION)

ELEMENT = Type("ElementMonitoringType", MACHINE_TOOL, 23, 58, (
    Member("Name", "String", lambda at: at.name, prop=True),
), abstract=True)  # fmt: skip
WORKING_UNIT = Type("WorkingUnitMonitoringType", MACHINE_TOOL, 41, ELEMENT, abstract=True)
CHANNEL_MODIFIERS = Type("ChannelModifierType", MACHINE_TOOL, 33, 58, (
    Member("BlockSkip", "Boolean", Of("block_delete", bool), 383, optional=True),
    Member("DryRun", "Boolean", Of("dry_run", bool), 361),
    Member("OptionalStop", "Boolean", Of("optional_stop", bool), 364),
    Member("SingleStep", "Boolean", Of("single_block", bool), 367),
    Member("TestMode", "Boolean", Of("machine_lock", bool), 366, optional=True),
))  # fmt: skip
CHANNEL = Type("ChannelMonitoringType", MACHINE_TOOL, 16, ELEMENT, (
    Member("ChannelMode", "ChannelMode", Of("mode", words.channel_mode), 249),
    Member("ChannelState", "ChannelState", Of("channel_state", words.word_of(words.CHANNEL_STATES)), 332),
    Member("FeedOverride", "Double", Of("feed_override"), 276, "%", "feed override"),
    Member("RapidOverride", "Double", Of("rapid_override"), 287, "%", "rapid override",
        optional=True),
))  # fmt: skip
SPINDLE = Type("SpindleMonitoringType", MACHINE_TOOL, 22, WORKING_UNIT, (
    Member("IsRotating", "Boolean", Of("spindle_speed", bool), 247),
    Member("Override", "Double", Of("spindle_override"), 241, "%", "spindle override",
        optional=True),
))  # fmt: skip
OPERATION = Type("MachineOperationMonitoringType", MACHINE_TOOL, 26, 58, (
    Member("OperationMode", "MachineOperationMode", Of("mode", words.machine_mode), 225),
    Member("FeedOverride", "Double", Of("feed_override"), 233, "%", "feed override",
        optional=True),
    Member("PowerOnDuration", "UInt32", Of("powered_s", lambda powered_s: powered_s // _HOUR_S), 261,
        optional=True),
))  # fmt: skip
MONITORING = Type("MonitoringType", MACHINE_TOOL, 14)


def _state(fact: str, machine: str) -> tuple[Member, ...]:
    """Return what a state machine shows of a fact that is one of the production states."""
    return (
        Member("CurrentState", "LocalizedText", Of(fact, str.capitalize), space=""),
        Member("CurrentState/Id", "NodeId", lambda at: at.fixed.nodes[f"{machine} {at.read(fact).capitalize()}"],
            prop=True, space=""),
        Member("CurrentState/Number", "UInt32", Of(fact, words.word_of(PRODUCTION_STATES)), prop=True, space=""),
    )  # fmt: skip


PRODUCTION_MACHINE = Type("ProductionStateMachineType", MACHINE_TOOL, 24, 2771)
PRODUCTION_STATE = Type("ProductionProgramStateMachineType", MACHINE_TOOL, 15, PRODUCTION_MACHINE,
    _state("production", "program"))  # fmt: skip
JOB_STATE = Type("ProductionJobStateMachineType", MACHINE_TOOL, 28, PRODUCTION_MACHINE, _state("job", "job"))
STATE_NODES = {
    PRODUCTION_MACHINE: (135, 138, 140, 139, 141), PRODUCTION_STATE: (5039, 5041, 5038, 5040, 5037),
    JOB_STATE: (5015, 5017, 5014, 5016, 5013),
}  # fmt: skip
"""The nodes of the states of each state machine, in the order of their numbers."""
PROGRAM = Type("ProductionProgramType", MACHINE_TOOL, 59, 58, (
    Member("Name", "String", Of("program", otherwise=""), 193, prop=True),
    Member("NumberInList", "UInt16", lambda at: 0, 230, prop=True, space=""),
))  # fmt: skip
ACTIVE_PROGRAM = Type("ProductionActiveProgramType", MACHINE_TOOL, 32, PROGRAM, (
    Member("JobIdentifier", "String", Of("program", otherwise=""), 384, optional=True),
    Member("JobNodeId", "NodeId", lambda at: at.fixed.nodes["job" if at.read("program") else "none"], 382,
        optional=True),
))  # fmt: skip
JOB = Type("ProductionJobType", MACHINE_TOOL, 29, 58, (
    Member("Identifier", "String", Of("program", otherwise=""), 189, prop=True),
    Member("NumberInList", "UInt16", lambda at: 0, 196, prop=True, space=""),
    Member("RunsPlanned", "UInt32", Of("parts_wanted"), 192),
    Member("RunsPlanned/IsValid", "Boolean", Of("parts_wanted", bool), prop=True),
    Member("RunsCompleted", "UInt32", Of("parts"), 191),
))  # fmt: skip
ORDERED_LIST = 23518
"""The list of OPC 10000-5 that others stand on."""
JOBS = Type("ProductionJobListType", MACHINE_TOOL, 30, ORDERED_LIST, (
    Member("NodeVersion", "String", _version, prop=True, space="", optional=True),
))  # fmt: skip
PROGRAMS = Type("OrderedListType", "", ORDERED_LIST)
STATISTICS = Type("ProductionStatisticsType", MACHINE_TOOL, 20, 58, (
    Member("PartsProducedInLifetime", "UInt32", Of("parts_total"), 236, optional=True),
))  # fmt: skip
PRODUCTION = Type("ProductionType", MACHINE_TOOL, 21)
BASE_TOOL = Type("BaseToolType", MACHINE_TOOL, 49, 58, (
    Member("Identifier", "String", lambda at: asset_id(at.fixed.name, int(at.name)), 316, prop=True, optional=True),
    Member("Name", "String", _description, 176, prop=True, optional=True),
), abstract=True)  # fmt: skip
TOOL = Type("ToolType", MACHINE_TOOL, 50, BASE_TOOL, (
    Member("ControlIdentifier1", "UInt32", lambda at: int(at.name), 178),
    Member("ControlIdentifierInterpretation", "ToolManagement", lambda at: 0, 296),
    Member("Locked", "Boolean", lambda at: False, 321),
    Member("Locked/ReasonForLocking", "ToolLocked", lambda at: 0, prop=True),
))  # fmt: skip
TOOLS = Type("ToolListType", MACHINE_TOOL, 44, 58, (
    Member("NodeVersion", "String", _version, 213, prop=True, space="", optional=True),
))  # fmt: skip
EQUIPMENT = Type("EquipmentType", MACHINE_TOOL, 12)
MESSAGES = Type("MessagesType", MACHINE_TOOL, 38)
NOTIFICATION = Type("NotificationType", MACHINE_TOOL, 7)
ALERT = Type("AlertType", MACHINE_TOOL, 39, 2915, (Member("ErrorCode", "String", None, 231, prop=True),))
MACHINE = Type("MachineToolType", MACHINE_TOOL, 13)
MACHINES_NUMBER = 1001
"""The folder of all machines, in the namespace of Machinery."""
TYPES = (
    GROUP, ITEM_IDENTIFICATION, MACHINE_IDENTIFICATION, IDENTIFICATION, ELEMENT, WORKING_UNIT, CHANNEL_MODIFIERS,
    CHANNEL, SPINDLE, OPERATION, MONITORING, PRODUCTION_MACHINE, PRODUCTION_STATE, JOB_STATE, PROGRAM, ACTIVE_PROGRAM,
    JOB, JOBS, STATISTICS, PRODUCTION, BASE_TOOL, TOOL, TOOLS, EQUIPMENT, MESSAGES, NOTIFICATION, ALERT, MACHINE,
)  # fmt: skip
"""All of them, each after its base."""
