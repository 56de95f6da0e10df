"""The program that is sent while it is executed: what RMT runs."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.cnc import Control, ControlError, OpenProgram, Refusal
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.nc import IncomingText

REMOTE_NAME = "RMT"


class RemoteProgram:
    """Take a program from outside in RMT, block by block; `mode` and `control` are the present ones."""

    def __init__(self, mode: Callable[[], PowerMateMode], control: Callable[[], Control]) -> None:
        self._mode = mode
        self._control = control

    def open(self) -> OpenProgram:
        """Begin to send a program; the next start in RMT executes what comes.

        Raises:
            ControlError: Not in RMT, or as `cnc.Control.open_program`.
        """
        mode = self._mode()
        if mode is not PowerMateMode.RMT:
            raise ControlError(
                Refusal.MODE, f"not in {mode.label}: a program can be sent only in RMT", hint="Select RMT."
            )
        return self._control().open_program(REMOTE_NAME)

    def before_start(self, selected: str | None) -> None:
        """Let a start in RMT execute what is sent, and one in MEM the program `selected` there.

        Raises:
            ControlError: In RMT, and nothing sends a program.
        """
        mode, control = self._mode(), self._control()
        channel = control.channels[0]
        is_sent = isinstance(channel.program, IncomingText)
        if channel.interrupted:
            return
        if mode is PowerMateMode.RMT and not is_sent:
            raise ControlError(
                Refusal.NOT_FOUND, "nothing sends a program in RMT", hint="Send one, or select MEM or MDI."
            )
        if mode is PowerMateMode.MEM and is_sent:
            channel.select(None)
            if selected is not None:
                control.select_program(selected)
