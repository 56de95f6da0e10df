"""What surrounds the motion: environment strings, lights, interface state, interrupts to the PC, messages."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from polycnc.controllers.apci.board._codes import boot_text, init_text, transfer_text
from polycnc.controllers.apci.board._declared import ENVIRONMENT_STRING_BYTES
from polycnc.controllers.apci.core._registers import BoardType, Ifs
from polycnc.errors import UsageError

InterruptRoutine: TypeAlias = Callable[[int], None]  # gets the bits of the interrupt lines
Show: TypeAlias = Callable[[str], None]

LED_PLACES = {  # on the board: green, yellow, red
    BoardType.APCI_8001: ("D29", "D30", "D31"),
    BoardType.APCI_8008: ("D53", "D55", "D56"),
}
_POWER_UP = int(Ifs.pfe | Ifs.scpfe)
_NO_ERRORS = int(Ifs.edv | Ifs.cncrdy)


SERIAL_NUMBER = "80010001"
"""Ruling: the serial number of a board that has been given none."""


class EnvironmentStrings:
    """Named texts that are stored on the board, for getEnvStr."""

    def __init__(self, strings: Mapping[str, str] | None = None) -> None:
        self._strings = {"SerialNumber": SERIAL_NUMBER}
        for name, value in (strings or {}).items():
            self.write(name, value)

    def write(self, name: str, value: str) -> None:
        """Set a string.

        Raises:
            UsageError: The text is longer than getEnvStr can give back.
        """
        if len(value) >= ENVIRONMENT_STRING_BYTES:
            raise UsageError(
                f"'{name}' has {len(value)} characters", hint=f"at most {ENVIRONMENT_STRING_BYTES - 1}"
            )
        self._strings[name] = value

    def read(self, name: str) -> tuple[int, str]:
        """Return the length and the value of a string; 0 and an empty text where there is none."""
        value = self._strings.get(name, "")
        return len(value), value


@dataclass(slots=True)
class Leds:
    """The three lights for diagnosis, each 1 (on) or 0."""

    green: int = 0
    yellow: int = 0
    red: int = 0

    def __setattr__(self, name: str, value: int) -> None:
        """Switch a light; anything but 0 is on."""
        object.__setattr__(self, name, int(value != 0))


class InterfaceStatus:
    """The register ifs: errors collect in the hardware, and starting the firmware takes them over, once."""

    def __init__(self) -> None:
        self.word = 0
        self.is_down = False  # an error has reset the inputs and outputs; only a boot brings them back
        self._hardware = _POWER_UP

    @property
    def bits(self) -> tuple[int, int, int]:
        """What the hardware has collected, the register, and whether inputs and outputs are down."""
        return int(self._hardware), int(self.word), int(self.is_down)

    @bits.setter
    def bits(self, bits: tuple[int, int, int]) -> None:
        self._hardware, self.word, down = bits
        self.is_down = bool(down)

    def start_firmware(self) -> None:
        """Take over what the hardware has collected and erase it there, as BootFile does."""
        self.word = Ifs.edv | Ifs.cncrdy | self._hardware
        self._hardware = 0
        self.is_down = False

    def report(self, bits: int) -> None:
        """Set bits of a fault, which stay; it resets inputs and outputs until the next boot (Manual 002, 4.4.70.1)."""
        self.word |= bits & Ifs.assigned()
        if bits & Ifs.assigned() & ~_NO_ERRORS:
            self.is_down = True

    def report_to_hardware(self, bits: int) -> None:
        """Keep bits of a fault that shows only after the next start of the firmware, such as a watchdog's."""
        self._hardware |= bits & Ifs.assigned()

    def reset_errors(self) -> None:
        """Clear what rifs clears."""
        self.word = Ifs.cleared(self.word, "rifs")


class InterruptLine:
    """The interrupt from the board to the PC, and the program's routine for it."""

    def __init__(self) -> None:
        self._routine: InterruptRoutine | None = None

    def set_routine(self, routine: InterruptRoutine) -> int:
        """Install the routine in place of any other; the value returned has no meaning."""
        self._routine = routine
        return 0

    def reset_routine(self) -> int:
        """Remove the routine; the value returned has no meaning."""
        self._routine = None
        return 0

    def raise_interrupt(self, lines: int) -> None:
        """Call the routine, if there is one, with the bits of the lines that are active."""
        if self._routine is not None:
            self._routine(lines)


class Messages:
    """What the library would show in message boxes, handed to `show` instead."""

    def __init__(self, show: Show) -> None:
        self._show = show
        self.enabled = True

    def msg_to_screen(self, enable: int) -> None:
        """Switch all messages on, or off with 0."""
        self.enabled = enable != 0

    def boot_error_report(self, filename: str, error: int) -> None:
        """Show what a code of BootFile means."""
        self._report(f"BootFile {filename}: {boot_text(error)} ({error})")

    def init_mcu_error_report(self, error: int) -> None:
        """Show what a code of InitMcuSystem, InitMcuSystem2 or InitMcuSystem3 means."""
        self._report(f"InitMcuSystem: {init_text(error)} ({error})")

    def txbf_error_report(self, filename: str, error: int) -> None:
        """Show what a code of txbf2 means."""
        self._report(f"txbf2 {filename}: {transfer_text(error)} ({error})")

    def _report(self, text: str) -> None:
        if self.enabled:
            self._show(text)
