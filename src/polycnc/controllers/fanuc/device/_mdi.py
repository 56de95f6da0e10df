"""The MDI program: at most 199 characters, put in at once, executed from any of its blocks."""

from __future__ import annotations

from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._device_state import MdiState
from polycnc.controllers.fanuc.device._power import Power
from polycnc.controllers.fanuc.device._transfer import Fault, ProgramStream, TransferError


def _anything(_: object) -> None:
    """Refuse nothing: MDI programs are not registered."""


class MdiProgram:
    """The program of MDI operation; its blocks count from 0, without the O word."""

    def __init__(self, power: Power, parameters: Parameters, state: MdiState) -> None:
        self._power = power
        self._parameters = parameters
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
            tv_check=self._parameters.bit(0, 0), ends_at_m=False, on_program=_anything, on_block=_anything
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
        self._power.control.set_mdi("\n".join(blocks) + "\n")
