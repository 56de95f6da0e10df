"""Living controls with channels, gaps among their axes and an asynchronous one, and what they answer to MCODS."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from polycnc.cnc import RunState, Script
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import DATA_SERVICES, Coupling
from polycnc.nc.cpl import Box, CharacterField, Field

AXIS = '[[axis]]\nname = "{}"\nvmax_mm_s = {}\namax_mm_s2 = 5000\n'
ROTARY = '[[axis]]\nname = "{}"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 400\n'
SERVO = '[axis.servo]\nkind = "pidf"\nkp = {}\nin_position_mm = 0.01\nfollowing_error_limit_mm = 20\n'
MACHINE = (
    'name = "six"\n' + AXIS.format("X", 500) + AXIS.format("Z", 400) + ROTARY.format("C") + AXIS.format("X2", 300)
    + AXIS.format("U", 200) + "[spindle]\nmax_rpm = 4000\n[tools.3]\nlength_mm = 42.5\nradius_mm = 6.25\n"
)  # fmt: skip
LAGGING = MACHINE.replace("amax_mm_s2 = 5000\n", "amax_mm_s2 = 5000\n" + SERVO.format(40), 1).replace(
    "vmax_mm_s = 400\namax_mm_s2 = 5000\n", "vmax_mm_s = 400\namax_mm_s2 = 5000\n" + SERVO.format(25)
)
"""The same with position loops that lag: X by a 40th of its speed, Z by a 25th."""
ZERO = "\0"


class Living:
    """A control on a machine file's text; `start` executes a program, `read` and `ask` are MCODS from outside."""

    def __init__(
        self, folder: Path, machine: str, channels: Sequence[Sequence[str]] = (), numbers: Sequence[int] = (),
        *, script: Script | None = None, servo: bool = False, references: bool = False,
    ) -> None:  # fmt: skip
        self.folder = folder
        (folder / "machine.toml").write_text(machine)
        self.pnc = Pnc(
            folder, folder / "machine.toml", channels=channels, numbers=numbers, script=script, servo=servo,
            references=references,
        )  # fmt: skip
        self.coupling = Coupling(self.pnc.ncs, None, 1)
        self.version = Box("V", "R", 0.0)

    def start(self, program: str, cycles: int = 700, channel: int = 1) -> None:
        """Execute a program for some cycles; nothing may go wrong."""
        self.write(f"main{channel}", program)
        self.pnc.select_program(f"main{channel}", channel=channel)
        self.pnc.cycle_start(channel=channel)
        self.pnc.advance(cycles)
        assert not self.pnc.status().alarms

    def write(self, name: str, program: str) -> None:
        """Put a program into the root."""
        (self.folder / name).write_text(program)

    def until_over(self, channel: int = 1, cycles: int = 30_000) -> None:
        """Let time pass until a channel does not execute anything."""
        self.pnc.advance(cycles, until=lambda: self.pnc.run_state(channel) is not RunState.ACTIVE)
        assert self.pnc.run_state(channel) is not RunState.ACTIVE

    def ask(self, number: int, channel: int, size: int, *extra: int) -> Any:
        """Return what a service writes: a text, a list of elements, or the code that it answers."""
        kind = DATA_SERVICES[number].kind
        buffer = CharacterField(size) if kind == "S" else Field("R" if kind == "X" else kind, (size,))
        answer = self.coupling.mcods(number, channel, self.version, buffer, size, *extra)
        if answer != 0:
            return answer
        if isinstance(buffer, CharacterField):
            return buffer.text
        return [buffer.get(index) for index in range(1, size + 1)]

    def read(self, number: int, channel: int = 1, size: int = 1, *extra: int) -> Any:
        """Return the same at once, whatever was read before."""
        self.version.value = 0.0
        return self.ask(number, channel, size, *extra)

    def glance(self, number: int, channel: int = 1, size: int = 1, *extra: int) -> Any:
        """Return the same, and wait for no change of it: time passes faster."""
        found = self.read(number, channel, size, *extra)
        self.pnc.ncs.ledger.unchanged.clear()
        return found


def six(folder: Path, machine: str = MACHINE, *, script: Script | None = None, servo: bool = False) -> Living:
    """Return X, Z and C in channel 1, X2 in channel 2, U in none; numbers 3 and 6 are no axes."""
    made = Living(
        folder, machine, [("X", "Z", "C"), ("X2", "U")], (1, 2, 4, 5, 7), script=script, servo=servo
    )
    made.pnc.transfer_axis("U", None)
    return made


def padded(*names: str) -> str:
    """Return the names of axes as MCODS writes them."""
    return "".join(f"{name:<8}{ZERO}" if name else ZERO * 9 for name in names)
