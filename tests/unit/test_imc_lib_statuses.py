"""Every status of the function library, by number, as the answer to what causes it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest

from polycnc.controllers.imc import imclib as lib
from support.imc_network import ToldCard

I, Q, P1 = lib.SEL_IFIFO, lib.SEL_QFIFO, lib.SEL_PFIFO1  # noqa: E741


@pytest.fixture(autouse=True)
def _leave_no_card() -> Iterator[None]:
    yield
    lib.detach()


class Line:
    """A card, the cable to it, and the handle of a program that has opened it."""

    def __init__(self) -> None:
        self.card = ToldCard(axes=3, password="secret7")
        (self.port,) = lib.attach(lib.Port(self.card, 5), clock=None)
        self.handle: Any = lib.IMC_Open(0, 5)[1]

    def move(self, axis: int = 2, fifo: int = I) -> Any:
        return lib.IMC_MoveVelocity(self.handle, 77, axis, fifo)

    def with_fault(self, fault: lib.IMC_STATUS) -> Any:
        self.port.fault = fault
        return self.move()

    def late(self) -> Any:
        self.port.reply_ms = 40.5
        return self.move()

    def closed(self) -> Any:
        lib.IMC_Close(self.handle)
        return self.move()

    def full(self) -> Any:
        self.card.full = True
        return self.move(fifo=Q)

    def other_version(self) -> Any:
        lib.attach(ToldCard(fwversion=417))
        return lib.IMC_Open(0, 0)[0]


CAUSES: dict[str, tuple[int, Callable[[Line], Any]]] = {
    "IMC_OK": (0, Line.move),
    "IMC_SEND_FAIL": (1, lambda line: line.with_fault(lib.IMC_SEND_FAIL)),
    "IMC_READ_FAIL": (2, lambda line: line.with_fault(lib.IMC_READ_FAIL)),
    "IMC_TIME_OUT": (3, Line.late),
    "IMC_DEVICE_NOT_OPEN": (4, Line.closed),
    "IMC_DEVICE_NOT_FOUND": (5, lambda line: lib.IMC_Open(0, 4)[0]),
    "IMC_INVALID_HANDLE": (6, lambda line: lib.IMC_MoveVelocity(None, 77, 2, I)),  # type: ignore[arg-type]
    "IMC_INVALID_PARAM": (7, lambda line: lib.IMC_SetParam16(line.handle, 900, 77, 2, I)),
    "IMC_INVALID_AXIS": (8, lambda line: line.move(axis=3)),
    "IMC_INVALID_FIFO": (9, lambda line: line.move(fifo=lib.SEL_CFIFO)),
    "IMC_FIFO_FULL": (10, Line.full),
    "IMC_PARAM_READ_ONLY": (12, lambda line: lib.IMC_SetParam16(line.handle, lib.mcsmovingLoc, 77, 2, I)),
    "IMC_OUT_OF_RANGE": (13, lambda line: lib.IMC_AddArc(line.handle, 40, 30, 20, 10, 2, P1)),
    "IMC_CHECK_ERROR": (14, lambda line: line.with_fault(lib.IMC_CHECK_ERROR)),
    "IMC_VERSION_ERROR": (15, Line.other_version),
    "IMC_OTHER_ERROR": (16, lambda line: lib.IMC_FindNetCard(lib.NIC_INFO())[0]),  # while a card is open
    "IMC_PASSWORD_ERROR": (17, lambda line: lib.IMC_OpenUsePassword(0, 5, "secret8")[0]),
}


@pytest.mark.parametrize(
    ("name", "value", "cause"),
    [
        pytest.param(name, value, cause, marks=pytest.mark.covers(f"imc.status.{name}"), id=name)
        for name, (value, cause) in CAUSES.items()
    ],
)
def test_a_status_is_the_answer_to_its_cause_and_nothing_else_reaches_the_card(
    name: str, value: int, cause: Callable[[Line], Any]
) -> None:
    line = Line()
    answer = cause(line)
    assert (int(answer), answer.name) == (value, name)
    assert len(line.card.told) == (name == "IMC_OK")
