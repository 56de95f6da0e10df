"""The process services of the NCS coupling, one row each: what MCOPS has a control do (Manual 003, 4.14.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import IntFlag
from typing import Literal, Protocol, TypeAlias

from polycnc.controllers.bosch.ncs._image import Mode


class Selection(IntFlag):
    """How a program or a manual block is selected (MCOPS 4); the numbers add up."""

    LINK = 1
    WHEN_READY = 2
    MANUAL_BLOCK = 32
    EXIT_BEFORE = 64
    START_AT_ONCE = 128
    JOG = 256
    REFERENCE = 512
    MACHINE_FUNCTION = 1024
    REPLACE = 2048
    BUFFERED = 4096


WITHOUT_RESELECTION = 2
"""Type of a control reset or exit that keeps the automatic program re-selection from acting."""
WHOLE_SYSTEM = -2
"""Channel of a control reset of all channels."""
MODES = frozenset(Mode) - {Mode.NONE}
AUTOMATIC = frozenset((Mode.AUTOMATIC, Mode.PROGRAM_BLOCK, Mode.SINGLE_STEP, Mode.SINGLE_BLOCK))
"""The modes that change among each other while a program is selected."""


Done: TypeAlias = Iterator[None] | None
"""Nothing if a service is done, else what is to be asked once a cycle until it is."""


class ProcessServices(Protocol):
    """A control that does what other channels ask of it; each method may raise an NcsError."""

    def cancel_distance(self, channel: int) -> None:
        """Throw prepared blocks and the rest of the current one away and prepare them anew."""

    def control_reset(self, channel: int, kind: int) -> Done:
        """Reset a channel, or all (-2)."""

    def search_block(self, channel: int, start: str, end: str) -> None:
        """Set where the selected program begins and ends."""

    def select(
        self, client: object, channel: int, text: str, start: str, end: str, how: Selection
    ) -> Iterator[None]:
        """Select a program or manual blocks; yields while it cannot be answered yet."""

    def exit_program(self, channel: int, kind: int) -> Done:
        """Leave the selected program or block."""

    def start(self, channel: int) -> None:
        """Start the selected program or block."""

    def set_mode(self, channel: int, mode: int) -> None:
        """Switch the operation mode."""

    def set_return_strategy(self, channel: int, how: int, where: int) -> None:
        """Set how and to which point the axes return to the path."""

    def stop_recording(self, channel: int) -> None:
        """Record no more jog movements for the return to path."""


Parameter: TypeAlias = tuple[Literal["I", "S"], int | str | None]
"""Type of a parameter, and what stands for one left out; None: it must not be left out."""


@dataclass(frozen=True, slots=True)
class ProcessService:
    """A process service; `do` gets the control, the calling client, the channel and the parameters."""

    number: int
    name: str
    parameters: tuple[Parameter, ...]
    do: Callable[..., Done]
    ends: Callable[[Sequence[int | str]], bool] = lambda _values: False
    """Whether it ends the program of the channel that it is for."""


_TEXT: Parameter = ("S", "")
_KIND: Parameter = ("I", 0)
_NUMBER: Parameter = ("I", None)


def _rows() -> list[ProcessService]:
    s = ProcessService
    # fmt: off
    return [
        s(1, "cancel distance to go", (), lambda to, _by, channel: to.cancel_distance(channel)),
        s(2, "control reset", (_KIND,), lambda to, _by, channel, kind: to.control_reset(channel, kind),
          lambda _values: True),
        s(3, "search block", (_TEXT, _TEXT), lambda to, _by, channel, *ends: to.search_block(channel, *ends)),
        s(4, "select program or manual block", (_TEXT, _TEXT, _TEXT, _KIND),
          lambda to, by, channel, text, start, end, how: to.select(by, channel, text, start, end, Selection(how)),
          lambda values: bool(int(values[3]) & (Selection.EXIT_BEFORE | Selection.REPLACE))),
        s(5, "exit program", (_KIND,), lambda to, _by, channel, kind: to.exit_program(channel, kind),
          lambda _values: True),
        s(6, "start program", (), lambda to, _by, channel: to.start(channel)),
        s(7, "operation mode", (_NUMBER,), lambda to, _by, channel, mode: to.set_mode(channel, mode)),
        s(8, "return to path strategy", (_NUMBER, _NUMBER),
          lambda to, _by, channel, how, where: to.set_return_strategy(channel, how, where)),
        s(9, "stop return to path recording", (), lambda to, _by, channel: to.stop_recording(channel)),
    ]
    # fmt: on


PROCESS_SERVICES: dict[int, ProcessService] = {service.number: service for service in _rows()}
"""Every process service by its number."""
