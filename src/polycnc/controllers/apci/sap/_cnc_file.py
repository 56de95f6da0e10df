"""The compiled program as a file (``.CNC``): a header line with task number and checksum, then JSON.

::

    POLYCNC-SAP 1 task=0 crc32=1c291ca3 size=123
    {"name": ..., "variables": [...], "code": [...], "routines": [...], "events": [...]}

The board's own autocode is not described in Part 1 of the manual; this layout is polycnc's.
"""

from __future__ import annotations

import json
import re
import zlib
from typing import Any

from polycnc.controllers.apci.core._turn_state import TASKS
from polycnc.controllers.apci.sap._linker import OPERATIONS
from polycnc.controllers.apci.sap._program import Entry, Program
from polycnc.errors import ConfigurationError

MAX_BYTES = 1 << 20
"""Ruling: the memory that a task has for its program, 1 MByte."""

TOO_LARGE, INVALID_TYPE, INVALID_TASK = 21, 22, 24

_HEADER = re.compile(rb"POLYCNC-SAP 1 task=(\d{1,9}) crc32=([0-9a-f]{8}) size=(\d{1,9})\n")
_KINDS = ("i", "d", "b")
_JUMPS = ("jump", "jumpfalse", "unless", "when")


class CncFileError(ConfigurationError):
    """A file that cannot be loaded into a task; `code` is what txbf2 returns for it (21, 22 or 24)."""

    def __init__(self, code: int, what: str) -> None:
        super().__init__(what, hint="Compile the source again: polycnc sap compile FILE.")
        self.code = code


def write_cnc(program: Program) -> bytes:
    """Return a program as the contents of a .CNC file.

    Raises:
        CncFileError: It does not fit into the program memory of a task.
    """
    body = json.dumps(
        {
            "name": program.name,
            "variables": program.variables,
            "code": program.code,
            "routines": [(entry.start, entry.parameters, entry.cells) for entry in program.routines],
            "events": program.events,
        },
        separators=(",", ":"),
    ).encode()
    data = b"POLYCNC-SAP 1 task=%d crc32=%08x size=%d\n" % (program.task, zlib.crc32(body), len(body)) + body
    _check_size(data)
    return data


def read_cnc(data: bytes) -> Program:
    """Return the program in the contents of a .CNC file.

    Raises:
        CncFileError: Too large, no .CNC file or a damaged one, or a task that does not exist.
    """
    header = _HEADER.match(data)
    if header is None:
        raise CncFileError(INVALID_TYPE, "no compiled SAP program")
    _check_size(data)
    task = int(header[1])
    if task >= TASKS:
        raise CncFileError(INVALID_TASK, f"compiled for task {task}, but tasks are 0 to {TASKS - 1}")
    body = data[header.end() :]
    if len(body) != int(header[3]) or zlib.crc32(body) != int(header[2], 16):
        raise CncFileError(INVALID_TYPE, "damaged: size or checksum is wrong")
    try:
        return _program(json.loads(body), task)
    except (ValueError, TypeError, LookupError, AttributeError, OverflowError, RecursionError):
        raise CncFileError(INVALID_TYPE, "damaged: not a program") from None


def _check_size(data: bytes) -> None:
    if len(data) > MAX_BYTES:
        raise CncFileError(TOO_LARGE, f"{len(data)} bytes; the program memory of a task has {MAX_BYTES}")


def _program(read: dict[str, Any], task: int) -> Program:
    code = tuple((str(operation), argument, int(line)) for operation, argument, line in read["code"])
    routines = tuple(Entry(int(start), int(count), _cells(cells)) for start, count, cells in read["routines"])
    events = tuple((int(condition), int(handler)) for condition, handler in read["events"])
    program = Program(str(read["name"]), task, _cells(read["variables"]), code, routines, events)
    targets = [argument for operation, argument, _ in code if operation in _JUMPS]
    targets += [argument[2] for operation, argument, _ in code if operation == "within"]
    targets += [entry.start for entry in routines] + [condition for condition, _ in events]
    calls = [argument for operation, argument, _ in code if operation == "call"] + [
        handler for _, handler in events
    ]
    if not (
        code
        and all(operation in OPERATIONS for operation, _, _ in code)
        and all(type(target) is int and 0 <= target < len(code) for target in targets)
        and all(type(call) is int and 0 <= call < len(routines) for call in calls)
    ):
        raise ValueError
    return program


def _cells(read: Any) -> tuple[tuple[str, int], ...]:
    cells = tuple((str(kind), int(count)) for kind, count in read)
    if any(kind not in _KINDS or not 0 <= count <= 1 << 16 for kind, count in cells):
        raise ValueError
    if sum(count for _, count in cells) > MAX_BYTES:
        raise ValueError
    return cells
