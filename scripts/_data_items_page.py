"""The page of the data items: what doors say of a machine, from the tables of facts, of MTConnect and of OPC UA."""

from typing import Any

from polycnc.servers.mtconnect import CONDITIONS, ROWS, VERSIONS, Code, Row
from polycnc.servers.opcua import CNC_TYPES, MACHINE_TOOL_TYPES
from polycnc.servers.plant import FACTS

_HEAD = """# Data items

What a served machine tells, in one table for all doors: the plant doors `mtconnect` (port 5000), `shdr` (7878) and
`opcua` (4840), which read it; `focas`, HTTP and the page, and `grbl`, which have their own protocols' places for the
same facts. The plant doors serve `plain`, `fanuc` and `bosch` machines. The
[tutorial](../tutorials/a-machine-for-your-collector.md) reads one, [a
guide](../how-to/read-a-machine-with-your-agent.md) connects an agent of yours.

A fact is of the machine, of a channel, of an axis or of the spindle. `status` is the document of
`/api/machines/{machine}/status`, where an axis `X` is `axes.X`. Lengths are mm, angles degree, whatever the program is
written in. At one cycle all doors say the same; the scales differ: MTConnect has speeds per second, FOCAS has integers
with decimals.

| fact | of | what | unit | MTConnect, SHDR | OPC 40502 | OPC 40501-1 | `status` | FOCAS | grbl |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""
_MTCONNECT = """
## MTConnect and SHDR

`{}` stands for the name of an axis, and from the second channel on for the number of the channel. Keys are the
names of data items and what SHDR sends. A value that there is not (no program selected, a stopped spindle's direction)
is `UNAVAILABLE`.

| key | what | type | subtype | unit | versions |
| --- | --- | --- | --- | --- | --- |
"""
STATUS = {
    "emergency": "emergency", "powered_s": "timers_s.power_on", "operating_s": "timers_s.operating",
    "cutting_s": "timers_s.cutting", "cycle_s": "timers_s.cycle", "mode": "channels.0.mode",
    "execution": "channels.0.run_state", "program": "channels.0.program", "main_program": "channels.0.stack.0",
    "active_program": "channels.0.stack.-1", "block": "channels.0.block.text", "line": "channels.0.block.line",
    "sequence": "channels.0.block.sequence", "offset": "channels.0.block.offset",
    "block_program": "channels.0.block.program", "feed": "channels.0.feed.actual",
    "commanded_feed": "channels.0.feed.commanded", "programmed_feed": "channels.0.feed.programmed",
    "feed_override": "channels.0.overrides.feed", "rapid_override": "channels.0.overrides.rapid",
    "tool": "channels.0.tool.number", "dry_run": "channels.0.switches.dry_run",
    "single_block": "channels.0.switches.single_block", "machine_lock": "channels.0.switches.machine_lock",
    "optional_stop": "channels.0.switches.optional_stop", "block_delete": "channels.0.switches.block_delete",
    "jog_increment": "wheel.size", "parts": "parts.made", "parts_wanted": "parts.required",
    "parts_total": "parts.total",
    "machine_position": "axes.X.machine", "setpoint": "axes.X.setpoint", "work_position": "axes.X.work",
    "to_go": "axes.X.to_go", "following_error": "axes.X.following_error", "velocity": "axes.X.velocity",
    "load": "axes.X.load_percent", "moving": "axes.X.moving", "referenced": "axes.X.referenced",
    "spindle_speed": "spindle.actual_rpm", "commanded_spindle_speed": "spindle.commanded_rpm",
    "programmed_spindle_speed": "spindle.programmed_rpm", "spindle_override": "spindle.override",
    "spindle_direction": "spindle.direction", "spindle_angle": "spindle.angle_deg",
}  # fmt: skip
"""Where the status has a fact, of the first channel or the axis X; a test looks there."""
_FOCAS = {
    "emergency": "statinfo emergency", "mode": "statinfo aut", "execution": "statinfo run", "program": "rdprgnum mdata",
    "active_program": "rdprgnum data, exeprgname", "block": "rdexecprog", "line": "rdexecprog", "sequence": "rdseqnum",
    "feed": "actf", "feed_override": "PMC G12 (255 - value)", "machine_position": "machine",
    "work_position": "absolute",
    "to_go": "distance", "spindle_speed": "acts", "tool": "modal 108", "powered_s": "parameter 6750",
    "operating_s": "parameters 6751, 6752", "cutting_s": "parameters 6753, 6754", "parts": "parameter 6711",
    "parts_total": "parameter 6712", "parts_wanted": "parameter 6713",
}  # fmt: skip
_GRBL = {
    "execution": "state", "machine_position": "MPos", "work_position": "MPos - WCO", "feed": "FS",
    "spindle_speed": "FS",
    "feed_override": "Ov", "rapid_override": "Ov", "spindle_override": "Ov",
}  # fmt: skip
_MIDDLE = """
Besides: `message` (MESSAGE, with the number of the message before 2.7), `tool_asset_id{}` (TOOL_ASSET_ID), `asset_chg`,
`asset_rem` and, from 2.0 on, `asset_count`. In 1.3 `execution` says PROGRAM_OPTIONAL_STOP where
later versions say OPTIONAL_STOP.

## Conditions

An alarm of the control is a FAULT, with the control's number and text. Several at once are reported one by one.

| key | what | type |
| --- | --- | --- |
"""
_ABOUT = {
    "system": "emergency stop, and what concerns the whole control",
    "logic": "the PLC: a function that failed or was not answered",
    "comms": "between door and machine; in one process it does not fail",
    "motion{}": "the program of a channel",
    "{}travel": "limits of an axis; the qualifier says LOW or HIGH",
    "{}servo": "the drive of an axis",
    "S1servo": "the spindle",
}
_TAIL = """
## What is observed, and when

A machine is looked at ten times a second of its own time while something is executed or moves, once a second
otherwise, and before every answer. While no client has asked for a `sample` of it for a minute of its time, once a
second is enough; in its first ten seconds it waits for one. The adapter of SHDR looks for agents that are connected.
What differs from the last look is an observation with the machine's date and time, and a number. Numbers begin at 1
and never skip; the last 65,536 are held for all devices of a process. The same machine and the same requests at the
same cycles give the same documents; only `instanceId` is new with each start.

## Requests

| request | parameters |
| --- | --- |
| `/probe` `/` `/DEVICE` | `deviceType` |
| `/current` | `at`, `path`, `interval` |
| `/sample` | `from`, `to`, `count` (negative: backwards), `path`, `interval`, `heartbeat` |
| `/assets` `/asset` | `type`, `count`, `removed` |
| `/assets/ID;ID` `/asset/ID` | |

Each of one device behind its name or uuid: `/DEVICE/current`. `path` is the part of XPath that clients write:
`/`, `//`, names, `*`, `|`, and conditions on attributes with `=`, `!=`, `and`, `or`, `not()`, `contains()`,
`starts-with()`; at most 1,024 characters, 24 steps and 24 conditions. With `interval` (ms) an answer is a
stream of parts (`multipart/x-mixed-replace`) that ends with an OUT_OF_RANGE error when its reader falls behind
the buffer. Tools of the tool table are assets (`CuttingTool`).

| error | HTTP status | when |
| --- | --- | --- |
"""
_END = """
From 2.6 on an error is an element of its own name (`OutOfRange`); a wrong value of a parameter is
`InvalidParameterValue` then. Clients
that accept JSON alone get the documents as JSON (version 1). MTConnect reads: nothing here commands a machine.

## SHDR

At first an agent gets every value, then what changes, at the latest after a tenth of a second:
`TIME|key|value|key|value`, conditions `TIME|key|FAULT|number||HIGH|text`, messages `TIME|key|number|text`,
tools as `@ASSET@` and `@REMOVE_ASSET@`. A value with a bar stands in quotes, its bars escaped. `* PING` is
answered with `* PONG 10000`. An agent that does not read is disconnected, 32 may be connected.
"""


_ERRORS = {
    Code.NO_DEVICE: "there is no such device",
    Code.INVALID_URI: "there is nothing at this place",
    Code.ASSET_NOT_FOUND: "there is no such asset",
    Code.OUT_OF_RANGE: "a number is outside of what is held or allowed",
    Code.INVALID_XPATH: "a path cannot be read, or reaches nothing",
    Code.QUERY_ERROR: "a parameter that there is not, or that is no number",
    Code.INVALID_REQUEST: "parameters that exclude each other, a request that is too long, another host",
    Code.UNSUPPORTED: "a method other than GET and HEAD",
    Code.TOO_MANY: "100 streams are open",
    Code.INTERNAL_ERROR: "the machine's time cannot pass any more",
}


def _versions(row: Row) -> str:
    known = [name for name, version in VERSIONS.items() if row.is_in(version)]
    return "all" if len(known) == len(VERSIONS) else ", ".join(known)


def _members(types: tuple[Any, ...]) -> dict[str, list[str]]:
    """Return the members that show a fact, by the fact."""
    found: dict[str, list[str]] = {}
    for row in types:
        for member in row.members:
            facts = getattr(member.read, "facts", (getattr(member.read, "fact", ""),))
            for fact in facts:
                names = found.setdefault(fact, [])
                name = member.name[:-1] + "..." if member.name.startswith("PosTcp") else member.name
                if name not in names:
                    names.append(name)
    return found


def _facts() -> str:
    """Return the rows of the table of all doors."""
    keys: dict[str, list[str]] = {}
    for row in ROWS:
        if row.key not in keys.setdefault(row.fact, []):
            keys[row.fact].append(row.key)
    cnc, tool = _members(CNC_TYPES), _members(MACHINE_TOOL_TYPES)
    text = ""
    for name, fact in FACTS.items():
        columns = (keys.get(name, []), cnc.get(name, []), tool.get(name, []))
        cells = [", ".join(f"`{each}`" for each in column) for column in columns]
        cells += [f"`{STATUS[name]}`" if name in STATUS else "", _FOCAS.get(name, ""), _GRBL.get(name, "")]
        text += f"| {name} | {fact.scope} | {fact.what} | {fact.unit} | {' | '.join(cells)} |\n"
    return text


def page() -> str:
    """Return the page."""
    text = _HEAD + _facts() + _MTCONNECT
    for row in ROWS:
        fact = FACTS[row.fact]
        unit = row.units(row.only) if row.sample else "%" if str(fact.unit) == "%" else ""
        text += f"| `{row.key}` | {fact.what} | {row.type} | {row.subtype} | {unit} | {_versions(row)} |\n"
    text += _MIDDLE
    text += "".join(f"| `{row.key}` | {_ABOUT[row.key]} | {row.type} |\n" for row in CONDITIONS)
    text += _TAIL
    text += "".join(f"| {code.name} | {code.status} | {_ERRORS[code]} |\n" for code in Code)
    return text + _END
