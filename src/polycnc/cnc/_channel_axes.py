"""The axes of a channel: which it has, which follow its path, and those lent to manual motion meanwhile."""

from __future__ import annotations

from collections.abc import Collection

from polycnc import kernel
from polycnc.kernel import OTHER_SOURCE, give_to_point_to_point
from polycnc.machine import Machine


class ChannelAxes:
    """Give a path its axes, lend them, and take them back.

    `names` are in the order of the machine. `taken` are lent axes and where they were, None where none are lent.
    """

    def __init__(self, machine: Machine, path: int, axes: Collection[str]) -> None:
        self._machine = machine
        self._path = path
        self.taken: tuple[tuple[int, float], ...] | None = None
        self.share(axes)

    def share(self, axes: Collection[str]) -> None:
        """Have these axes from now on; no program is being executed."""
        state, names = self._machine.state, self._machine.config.axis_names
        self.names = tuple(name for name in names if name in axes)
        for index, name in enumerate(names):
            if name not in axes and state.owner[index] == self._path:
                give_to_point_to_point(state, index)
            state.paths.axis[self._path, index] = index if name in axes else -1
        state.paths.position[self._path] = state.base
        state.paths.queued[self._path] = state.base

    def release(self, *, come_back: bool) -> None:
        """Give the axes to manual motion; with `come_back` they must be where they were before the program goes on."""
        state = self._machine.state
        taken = []
        for axis in (index for index in state.paths.axis[self._path].tolist() if index >= 0):
            if state.owner[axis] in (self._path, OTHER_SOURCE):
                give_to_point_to_point(state, axis)
                taken.append((axis, float(state.base[axis])))
        if come_back:
            self.taken = tuple(taken)

    def displaced(self) -> dict[str, float]:
        """Return where the axes that are elsewhere were when the program was interrupted."""
        if self.taken is None:
            return {}
        names, base = self._machine.config.axis_names, self._machine.state.base
        return {names[axis]: there for axis, there in self.taken if base[axis] != there}

    def take_back(self, *, locked: bool) -> None:
        """Take the axes back, which are where they were; with `locked` the path is executed without them."""
        for axis, _ in self.taken or ():
            self._machine.state.owner[axis] = OTHER_SOURCE if locked else self._path
        self.taken = None


def give_axes(machine: Machine, path: int, *, locked: bool) -> None:
    """Let the axes follow the path from where they stand, or nothing while the machine is locked."""
    state = machine.state
    for column, axis in enumerate(state.paths.axis[path]):
        if axis < 0 or state.owner[axis] not in (path, kernel.OTHER_SOURCE):
            continue
        if state.owner[axis] == kernel.OTHER_SOURCE and not locked:  # the path went on without it
            state.paths.position[path, column] = state.paths.queued[path, column] = state.base[axis]
        state.owner[axis] = kernel.OTHER_SOURCE if locked else path
