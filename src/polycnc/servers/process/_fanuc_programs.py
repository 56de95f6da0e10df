"""The programs of a Power Mate as doors change them: what its function library refuses is refused here too."""

from __future__ import annotations

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.fanuc import PowerMate
from polycnc.servers.focas import number_in, unframed
from polycnc.servers.machines import MemoryPrograms

_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


class FanucPrograms(MemoryPrograms):
    """The program memory with its key, the parameters that protect numbers, and O words that are the names."""

    def __init__(self, mate: PowerMate) -> None:
        super().__init__(lambda: mate.control)
        self._mate = mate

    def put(self, name: str, content: bytes) -> bool:
        """Put a program in as the control keeps it: from its O word on, which it gets where it has none."""
        self._check_protection(name)
        text = unframed(content)
        number = number_in(text)
        if content.startswith(_UTF_16):
            text = content  # the memory refuses it
        elif number is None:
            text = f"{name}\n".encode() + text.removeprefix(b"\n")
        elif f"O{number:04d}" != name:
            raise ControlError(
                Refusal.DATA,
                f"the text is that of O{number:04d}",
                hint="Put it in by that name, or change its O word.",
            )
        return super().put(name, text)

    def delete(self, name: str) -> None:
        """Delete a program that is neither protected nor selected."""
        self._check_protection(name)
        programs = self._mate.programs
        is_selected = programs.selected and name == f"O{programs.selected:04d}"
        if is_selected and name not in programs.memory.running:  # whose refusal says more
            raise ControlError(Refusal.IN_USE, f"program '{name}' is selected", hint="Select another one.")
        super().delete(name)

    def _check_protection(self, name: str) -> None:
        programs = self._mate.programs
        if programs.key_protects:
            raise ControlError(
                Refusal.PROTECTED, "the key protects all programs", hint="Turn it on the panel (G46)."
            )
        if programs.parameter_protects(self._number(name)):
            raise ControlError(
                Refusal.PROTECTED,
                f"parameters protect program '{name}'",
                hint="See parameters 3202, 3210 and 3211.",
            )

    @staticmethod
    def _number(name: str) -> int:
        return number_in(name.encode()) or 0
