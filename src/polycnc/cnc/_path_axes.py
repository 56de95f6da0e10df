"""Give the axes of a path to it, or none while the machine is locked."""

from __future__ import annotations

from polycnc import kernel
from polycnc.machine import Machine


def give_axes(machine: Machine, path: int, *, locked: bool) -> None:
    """Let the axes follow the path from where they stand, or nothing while the machine is locked."""
    state = machine.state
    for column, axis in enumerate(state.paths.axis[path]):
        if axis < 0 or state.owner[axis] not in (path, kernel.OTHER_SOURCE):
            continue
        if state.owner[axis] == kernel.OTHER_SOURCE and not locked:  # the path went on without it
            state.paths.position[path, column] = state.paths.queued[path, column] = state.base[axis]
        state.owner[axis] = kernel.OTHER_SOURCE if locked else path
