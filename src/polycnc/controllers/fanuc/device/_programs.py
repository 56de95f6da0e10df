"""The program memory as a Power Mate sees it: numbers O1 to O9999, protection, who uses what."""

from __future__ import annotations

import re
from contextlib import AbstractContextManager
from dataclasses import dataclass

from polycnc.cnc import MemoryData, ProgramEdit, ProgramMemory, RunState
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.controllers.fanuc.device._power import Power
from polycnc.machine import Store
from polycnc.units import whole

FIRST, LAST = 1, 9999
COMMENT_MOST = 48
_NAME = re.compile(r"O([0-9]{4})")
_COMMENT = re.compile(rb"O[0-9]+ *\(([^)\n]*)\)")
_IN_OPERATION = frozenset(
    {RunState.ACTIVE, RunState.HOLD, RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP}
)


def name_of(number: int) -> str:
    """Return the name under which the memory keeps a program."""
    return f"O{number:04d}"


def number_of(name: str | None) -> int:
    """Return the number of a program by its name, 0 for another text, as that of MDI."""
    found = None if name is None else _NAME.match(name)
    return 0 if found is None else whole(found[1])


def comment_of(content: bytes) -> str:
    """Return the comment after the program number."""
    found = _COMMENT.match(content)
    return found[1].decode("latin-1") if found else ""


def memory_data(characters: int, programs: int) -> MemoryData:
    """Return what the memory takes."""
    return MemoryData(
        names=r"O(?!0000)[0-9]{4}",
        names_hint="Programs are O0001 to O9999.",
        capacity_bytes=characters,
        most_programs=programs,
        comment_of=comment_of,
    )


@dataclass(frozen=True, slots=True)
class Listed:
    """A line of the directory: number, comment, characters."""

    number: int
    comment: str
    characters: int


class Programs:
    """The programs of a Power Mate, and which is selected."""

    def __init__(self, store: Store, power: Power, parameters: Parameters, state: DeviceState) -> None:
        self._store = store
        self._power = power
        self._parameters = parameters
        self._state = state
        self._area = store.area("fanuc.state", int)
        self._edits: list[ProgramEdit] = []

    @property
    def memory(self) -> ProgramMemory:
        """The memory itself."""
        return self._power.control.programs

    def __contains__(self, number: object) -> bool:
        return isinstance(number, int) and FIRST <= number <= LAST and name_of(number) in self.memory

    def __len__(self) -> int:
        return len(self.memory)

    def read(self, number: int) -> bytes:
        """Return the text of a program, from its O word to the end of its last block.

        Raises:
            ControlError: There is no such program.
        """
        return self.memory.read(name_of(number))

    def directory(self, first: int = FIRST, last: int = LAST) -> tuple[Listed, ...]:
        """Return the programs in a range of numbers, ascending."""
        listed = (
            Listed(number_of(each.name), each.comment[:COMMENT_MOST], each.size_bytes)
            for each in self.memory.directory()
        )
        return tuple(
            sorted((each for each in listed if first <= each.number <= last), key=lambda each: each.number)
        )

    def register(self, number: int, content: str | bytes) -> None:
        """Put a program in, in place of one of this number; as the operator does it, for a machine that shall have it.

        Raises:
            ControlError: The memory is protected or full, or the program is in use.
        """
        put = self.memory.write if number in self else self.memory.create
        put(name_of(number), content)

    def parameter_protects(self, number: int) -> bool:
        """Whether parameters keep a program from being changed: 3202 by its thousand, 3210 as a password."""
        parameters = self._parameters
        if 8000 <= number <= 8999:
            return parameters.bit(3202, 0)
        if 9000 <= number <= 9999:
            password = parameters.value(3210)
            return parameters.bit(3202, 4) or (password != 0 and password != parameters.value(3211))
        return False

    @property
    def key_protects(self) -> bool:
        """Whether the key that protects programs is on (3290#7 says which one it is)."""
        key = 1 if self._parameters.bit(3290, 7) else 3
        return key in self._state.protection_keys

    def transaction(self) -> AbstractContextManager[object]:
        """Return within what changes of several programs are one."""
        return self._store.transaction()

    def delete(self, number: int) -> None:
        """Delete a program.

        Raises:
            ControlError: There is none, or it is in use or protected.
        """
        self.memory.delete(name_of(number))

    def delete_unprotected(self) -> int:
        """Delete every program that no parameter protects; return how many were kept.

        Raises:
            ControlError: One is in use; none is deleted.
        """
        numbers = [each.number for each in self.directory()]
        doomed = [number for number in numbers if not self.parameter_protects(number)]
        with self.transaction():
            for number in doomed:
                self.delete(number)
        if self.selected in doomed:
            self.unselect()
        return len(numbers) - len(doomed)

    # ------------------------------------------------------------------ who uses what

    @property
    def selected(self) -> int:
        """The number of the selected program, 0 for none."""
        return self._area.get("selected", 0)

    def select(self, number: int) -> None:
        """Select a program for MEM and EDIT.

        Raises:
            ControlError: There is no such program, or one is being executed or interrupted.
        """
        self._power.control.select_program(name_of(number))
        self._area["selected"] = number
        self._state.cursor = 0

    def unselect(self) -> None:
        """Have no program selected."""
        self._area["selected"] = 0
        self._state.cursor = 0
        self._power.control.channels[0].select(None)

    def edit(self, number: int, *, background: bool = False) -> ProgramEdit:
        """Open a program on the screen of the control; `close` ends it.

        Raises:
            ControlError: Not in EDIT (in the background: in any mode), or the program is not there or in use.
        """
        edit = self._power.control.edit(name_of(number), background=background)
        self._edits = [*(each for each in self._edits if each.is_open), edit]
        return edit

    @property
    def background_edit(self) -> bool:
        """Whether a program is being edited in the background."""
        return any(each.is_open and each.background for each in self._edits)

    @property
    def editing(self) -> bool:
        """Whether a program is being edited."""
        return any(each.is_open for each in self._edits)

    @property
    def in_operation(self) -> bool:
        """The OP signal: automatic operation has begun and has not ended."""
        return self._power.control.channels[0].run_state in _IN_OPERATION
