"""A sender of grbl in tests: a core on a small machine, and programs that are streamed by counting characters."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from polycnc.cnc import Control
from polycnc.servers.grbl import GrblCore, grbl_control
from support.cnc_machine import cnc_machine

RX_BYTES = 128
STEP = 25
SURFACE = {"high": {"Z": -4.0}}


class Bench:
    """A machine and a sender at it: bytes go in, lines come out, time passes in small steps."""

    def __init__(self, **keys: object) -> None:
        self.control: Control = grbl_control(cnc_machine(**keys))
        self.core = GrblCore(self.control)
        self.lines(self.core.greet())

    @staticmethod
    def lines(given: bytes) -> list[str]:
        return given.decode("ascii").splitlines()

    def send(self, text: str | bytes, cycles: int = 0) -> list[str]:
        """Send text, let time pass, and return all answers."""
        given = self.core.receive(text.encode("latin-1") if isinstance(text, str) else text)
        return self.lines(given + self.passed(cycles))

    def passed(self, cycles: int) -> bytes:
        given = b""
        while cycles > 0:
            cycles -= self.control.advance(min(STEP, cycles))
            given += self.core.turn()
        return given

    def state(self) -> str:
        return self.send("?")[-1].strip("<>").split("|")[0]

    def x(self) -> float:
        return self.control.axes()["X"].machine


def stream(program: str, write: Callable[[bytes], None], read_line: Callable[[], str]) -> list[str]:
    """Stream a program by counting characters; return the answers to its lines."""
    answers: list[str] = []
    sent: deque[int] = deque()

    def answer() -> None:
        line = read_line()
        if line == "ok" or line.startswith(("error:", "ALARM:")):
            sent.popleft()
            answers.append(line)

    for line in program.splitlines():
        data = line.encode() + b"\n"
        while sum(sent) + len(data) >= RX_BYTES:
            answer()
        sent.append(len(data))
        write(data)
    while sent:
        answer()
    return answers
