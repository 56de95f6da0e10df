"""The MDI program: at most 199 characters, put in at once, executed from any of its blocks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from polycnc.controllers.fanuc.device._transfer import Fault, ProgramStream, TransferError

if TYPE_CHECKING:
    from polycnc.controllers.fanuc.device._power_mate import PowerMate


def _anything(_: object) -> None:
    """Refuse nothing: MDI programs are not registered."""


@dataclass(slots=True)
class MdiState:
    """The blocks that were put in, and the one that execution begins at."""

    blocks: tuple[str, ...] = ()
    start: int = 0


class MdiProgram:
    """The program of MDI operation; its blocks count from 0, without the O word."""

    def __init__(self, power_mate: PowerMate, state: MdiState) -> None:
        self._power_mate = power_mate
        self.state = state

    def __bool__(self) -> bool:
        return bool(self.state.blocks)

    def clear(self) -> None:
        """Forget the program."""
        self.state.blocks, self.state.start = (), 0

    def put(self, data: bytes) -> None:
        """Put a program in, as a stream like that of a download.

        Raises:
            TransferError: The stream is refused; the program that was there stays.
            ControlError: Not in MDI, or a program is being executed or interrupted.
        """
        stream = ProgramStream(
            tv_check=self._power_mate.parameters.bit(0, 0),
            ends_at_m=False,
            on_program=_anything,
            on_block=_anything,
        )
        stream.take(data)
        if not stream.ended:
            raise TransferError(Fault.UNFINISHED)
        if len(stream.programs) != 1 or len(stream.programs[0][1]) < 2:
            raise TransferError(Fault.NUMBER)
        blocks = tuple(block.decode("ascii") for block in stream.programs[0][1][1:])
        self._hand_over(blocks)
        self.state.blocks, self.state.start = blocks, 0

    def set_start(self, block: int) -> None:
        """Let execution begin at a block; KeyError if there is none of this number.

        Raises:
            ControlError: Not in MDI, or a program is being executed or interrupted.
        """
        if not 0 <= block < len(self.state.blocks):
            raise KeyError(block)
        self._hand_over(self.state.blocks)
        self.state.start = block

    def _hand_over(self, blocks: tuple[str, ...]) -> None:
        self._power_mate.control.set_mdi("\n".join(blocks) + "\n")
