"""A control under a debugger: its programs stop at CPL lines, and tell their variables."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from polycnc.cnc import Control
from polycnc.controllers.bosch._memory import plain_variable
from polycnc.controllers.bosch._pnc import Pnc
from polycnc.machine import MachineConfig
from polycnc.nc.cpl import Fault


class DebuggedPnc:
    """One channel with all axes of a machine; `root` is the control's directory."""

    def __init__(self, root: str | Path, machine: MachineConfig) -> None:
        self._pnc = Pnc(root, machine, stepping=True)
        self._language = self._pnc.hosts[0].language

    @property
    def control(self) -> Control:
        """The control."""
        return self._pnc.control

    @property
    def depth(self) -> int:
        """How deep the program that runs is nested; 0 is the main program."""
        return max(len(self._language.running) - 1, 0)

    def stand_at(self, stands: Callable[[str, int, int], bool]) -> None:
        """Let preparation wait before lines that `stands` names: file, line, depth of nesting."""
        self._language.at_line = lambda file, line: stands(file, line, self.depth)

    def variables(self) -> dict[str, object]:
        """Return local variables of the program that runs, then global ones, then permanent ones that have a value."""
        running = self._language.running
        local = running[-1].execution.local_variables() if running else {}
        shared = {**local, **self._language.globals}
        kept = {name: value for name, value in self._pnc.system.kept.values().items() if _is_set(value)}
        return {**{name: _plain(value) for name, value in shared.items()}, **kept}


def _plain(value: object) -> object:
    try:
        return plain_variable(value)
    except Fault:
        return None


def _is_set(value: object) -> bool:
    return any(map(_is_set, value)) if isinstance(value, list) else value is not None
