"""Find a block in the text of a program, for a search before the start."""

from __future__ import annotations

import re

from polycnc.errors import UsageError
from polycnc.kernel import drop_queue, give_to_path
from polycnc.machine import Machine
from polycnc.nc import Channel, ProgramText

_SEQUENCE = rb"(?:\A|(?<=[\r\n]))[ \t]*(?:/[1-9]?)?[ \t]*[Nn][ \t]*0*%d(?![0-9.])"


def block_line(program: ProgramText, line: int, sequence: int | None) -> int:
    """Return the line of the block on `line`, or of the first one with a sequence number if that is given.

    Raises:
        UsageError: the program has no such line or block.
    """
    if sequence is None:
        lines = len(program.content.splitlines())
        if not 1 <= line <= lines:
            raise UsageError(f"{program.name} has no line {line}", hint=f"Its lines are 1 to {lines}.")
        return line
    match = re.search(_SEQUENCE % sequence, program.content) if sequence >= 0 else None
    if match is None:
        raise UsageError(
            f"{program.name} has no block N{sequence}", hint="Give the number of a block in the main program."
        )
    return program.position(match.start()).line


def calculate_to(machine: Machine, channel: Channel, line: int) -> None:
    """Carry out what stands before `line` without moving; the channel's position is where that block begins.

    Raises:
        UsageError: the program ends before, or cannot be calculated.
    """
    state, path = machine.state, channel.path
    row = state.paths.row[path]

    def skip_queue() -> None:
        for name in ("head", "prepared", "planned"):
            row[name] = row["tail"]

    give_to_path(state, path)
    channel.state.modal.position[:] = state.paths.position[path]
    try:
        if not channel.calculate_to(line, skip_queue):
            hint = "Search a block that is executed." if channel.error is None else str(channel.error)
            raise UsageError(f"the program ends before line {line}", hint=hint)
    finally:
        drop_queue(state.seg, state.paths, path)
