"""The page of the data items: what plants read of a machine, from the tables of facts and of MTConnect."""

from polycnc.servers.mtconnect import CONDITIONS, ROWS, VERSIONS, Code, Row
from polycnc.servers.plant import FACTS

_HEAD = """# Data items

What a served machine tells a plant, in one table for all doors. The door `mtconnect` is an agent of its own
(port 5000), the door `shdr` an adapter for an agent of yours (port 7878). Both serve `plain`, `fanuc` and
`bosch` machines. The [tutorial](../tutorials/a-machine-for-your-collector.md) reads one, [a
guide](../how-to/read-a-machine-with-your-agent.md) connects an agent of yours.

`{}` stands for the name of an axis, and from the second channel on for the number of the channel. Keys are the
names of data items and what SHDR sends. Lengths are mm, angles degree, speeds per second, whatever the program
is written in. A value that there is not (no program selected, a stopped spindle's direction) is `UNAVAILABLE`.

| key | what | type | subtype | unit | versions |
| --- | --- | --- | --- | --- | --- |
"""
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
otherwise, and before every answer. What differs from the last look is an observation with the machine's date
and time, and a number. Numbers begin at 1 and never skip; the last 65,536 are held for all devices of a
process. The same machine and the same requests at the same cycles give the same documents; only `instanceId` is
new with each start.

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
`InvalidParameterValue` then. MTConnect reads: nothing here commands a machine.

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


def page() -> str:
    """Return the page."""
    text = _HEAD
    for row in ROWS:
        fact = FACTS[row.fact]
        unit = row.units(row.only) if row.sample else "%" if str(fact.unit) == "%" else ""
        text += f"| `{row.key}` | {fact.what} | {row.type} | {row.subtype} | {unit} | {_versions(row)} |\n"
    text += _MIDDLE
    text += "".join(f"| `{row.key}` | {_ABOUT[row.key]} | {row.type} |\n" for row in CONDITIONS)
    text += _TAIL
    text += "".join(f"| {code.name} | {code.status} | {_ERRORS[code]} |\n" for code in Code)
    return text + _END
