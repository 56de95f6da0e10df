"""Which objects a machine has in both views, from its channels and axes."""

from __future__ import annotations

from collections.abc import Iterator

from polycnc.servers.opcua import _cnc as cnc
from polycnc.servers.opcua import _machine_tool as tool
from polycnc.servers.opcua._model import (
    ADD_IN,
    CNC,
    DI,
    MACHINE_TOOL,
    OF_AXIS,
    ORDERED,
    UNITS,
    UNLIMITED,
    Item,
    Listing,
    Member,
    Unit,
)
from polycnc.servers.opcua._moment import Fixed
from polycnc.servers.plant import Seen

MESSAGES = "Notification/Messages"
PLAN, TOOLS = "Production/ProductionPlan", "Equipment/Tools"
JOB = f"{PLAN}/Job1"
MOST_TOOLS = 500


def channel_path(number: int) -> str:
    """Return the place of a channel within its interface."""
    return f"CncChannelList/Channel{number + 1}"


def interface_items(fixed: Fixed) -> Iterator[Item]:
    """Give the objects of the interface of OPC 40502, each after what it hangs on."""
    yield Item("", cnc.INTERFACE)
    yield Item("CncAxisList", cnc.AXES, space=CNC)
    for axis in fixed.units:
        owner = next((at for at, axes in enumerate(fixed.channels) if axis in axes), 0)
        yield Item(f"CncAxisList/{axis}", cnc.AXIS, owner, axis)
    yield Item("CncChannelList", cnc.CHANNELS, space=CNC)
    for number in range(len(fixed.channels)):
        yield Item(channel_path(number), cnc.CHANNEL, number)
    yield Item("CncSpindleList", cnc.SPINDLES, space=CNC)
    yield Item("CncSpindleList/Spindle1", cnc.SPINDLE)


def machine_tool_items(fixed: Fixed) -> Iterator[Item]:
    """Give the objects of the view of OPC 40501-1, each after what it hangs on."""
    own = MACHINE_TOOL
    yield Item("", tool.MACHINE)
    yield Item("Identification", tool.IDENTIFICATION, space=DI, by=ADD_IN)
    yield Item("Monitoring", tool.MONITORING, space=own)
    yield Item("Monitoring/MachineTool", tool.OPERATION, space=own)
    for number in range(len(fixed.channels)):
        name = f"Channel{number + 1}"
        yield Item(f"Monitoring/{name}", tool.CHANNEL, number, name)
        yield Item(f"Monitoring/{name}/ChannelModifiers", tool.CHANNEL_MODIFIERS, number, space=own)
    yield Item("Monitoring/Spindle1", tool.SPINDLE, 0, "Spindle1")
    yield Item("Production", tool.PRODUCTION, space=own)
    yield Item("Production/ActiveProgram", tool.ACTIVE_PROGRAM, space=own)
    yield Item("Production/ActiveProgram/State", tool.PRODUCTION_STATE, space=own)
    yield Item("Production/Statistics", tool.STATISTICS, space=own)
    yield Item(PLAN, tool.JOBS, 0, PLAN, space=own)
    yield Item("Equipment", tool.EQUIPMENT, space=own)
    yield Item(TOOLS, tool.TOOLS, 0, TOOLS, space=own)
    yield Item("Notification", tool.NOTIFICATION, space=own)
    yield Item(MESSAGES, tool.MESSAGES, space=own)


def _job_items(name: str) -> tuple[Item, ...]:
    """Return the objects of a job: the selected program, which runs for each part of the lot."""
    programs = f"{PLAN}/{name}/ProductionPrograms"
    return (
        Item(f"{PLAN}/{name}", tool.JOB, by=ORDERED),
        Item(f"{PLAN}/{name}/State", tool.JOB_STATE, space=MACHINE_TOOL),
        Item(programs, tool.PROGRAMS, space=MACHINE_TOOL),
        Item(f"{programs}/Program1", tool.PROGRAM, by=ORDERED),
    )


def _tool_names(seen: Seen) -> tuple[str, ...]:
    return tuple(map(str, sorted(seen.inventory.tools)[:MOST_TOOLS]))


LISTINGS = (
    Listing(PLAN, lambda seen: ("Job1",) if seen.status.channels[0].program else (), _job_items),
    Listing(TOOLS, _tool_names, lambda name: (Item(f"{TOOLS}/Tool{name}", tool.TOOL, 0, name),)),
)
"""The lists of a machine that objects come to and go from."""


def unit_of(member: Member, item: Item, fixed: Fixed) -> Unit | None:
    """Return the unit of a member of an object; None for what has none."""
    if not member.unit.startswith(OF_AXIS):
        return UNITS.get(member.unit)
    axis = member.unit.removeprefix(OF_AXIS).strip() or item.about
    return UNITS[fixed.units.get(axis, "deg" if axis in "ABC" else "mm")]


def span_of(member: Member, item: Item, fixed: Fixed) -> tuple[float, float]:
    """Return the range of a member of an object."""
    if not isinstance(member.span, str):
        return member.span
    name = f"{OF_AXIS} {item.about}" if member.span == OF_AXIS else member.span
    return fixed.spans.get(name, UNLIMITED)
