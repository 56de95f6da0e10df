"""What a board keeps while it is switched off, in a store: its EEPROM, environment strings and task programs."""

from __future__ import annotations

from collections.abc import Mapping

from polycnc.machine import Store

_CYCLES = "cycles"


class BoardMemory:
    """The durable memory of the board in slot `number`; several boards share one store."""

    def __init__(self, store: Store, number: int) -> None:
        area = f"apci.board{number}"
        self._eeprom = store.area(f"{area}.eeprom", int)
        self._environment = store.area(f"{area}.environment", str)
        self._tasks = store.area(f"{area}.tasks", bytes)

    @property
    def programming_cycles(self) -> int:
        """How often the EEPROM has been programmed."""
        return self._eeprom.get(_CYCLES, 0)

    @programming_cycles.setter
    def programming_cycles(self, count: int) -> None:
        self._eeprom[_CYCLES] = count

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment strings that have been written."""
        return {str(name): value for name, value in self._environment.load().items()}

    def write_environment(self, name: str, value: str) -> None:
        """Keep an environment string."""
        self._environment[name] = value

    @property
    def programs(self) -> Mapping[int | str, bytes]:
        """The contents of the CNC files in the tasks, by task."""
        return self._tasks.load()

    def keep_program(self, task: int, content: bytes) -> None:
        """Keep what has been loaded into a task."""
        self._tasks[task] = content
