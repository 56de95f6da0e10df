"""What the function library answers with, and the queues it can send to, numbered as the manual numbers them (6)."""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

from enum import IntEnum


class IMC_STATUS(IntEnum):
    """What every function returns."""

    IMC_OK = 0
    IMC_SEND_FAIL = 1
    IMC_READ_FAIL = 2
    IMC_TIME_OUT = 3
    IMC_DEVICE_NOT_OPEN = 4
    IMC_DEVICE_NOT_FOUND = 5
    IMC_INVALID_HANDLE = 6
    IMC_INVALID_PARAM = 7
    IMC_INVALID_AXIS = 8
    IMC_INVALID_FIFO = 9
    IMC_FIFO_FULL = 10
    IMC_FIFO_NULL = 11
    IMC_PARAM_READ_ONLY = 12
    IMC_OUT_OF_RANGE = 13
    IMC_CHECK_ERROR = 14
    IMC_VERSION_ERROR = 15
    IMC_OTHER_ERROR = 16
    IMC_PASSWORD_ERROR = 17
    IMC_RBFIFO_EMPTY = 18

    @property
    def text(self) -> str:
        """Return what the status says."""
        return _TEXTS[self]


_TEXTS = {
    IMC_STATUS.IMC_OK: "done",
    IMC_STATUS.IMC_SEND_FAIL: "sending to the card failed",
    IMC_STATUS.IMC_READ_FAIL: "receiving from the card failed",
    IMC_STATUS.IMC_TIME_OUT: "the card did not answer in time",
    IMC_STATUS.IMC_DEVICE_NOT_OPEN: "the card is not open",
    IMC_STATUS.IMC_DEVICE_NOT_FOUND: "there is no such card to open",
    IMC_STATUS.IMC_INVALID_HANDLE: "this is no handle of a card",
    IMC_STATUS.IMC_INVALID_PARAM: "there is no such parameter, or no such bit of it",
    IMC_STATUS.IMC_INVALID_AXIS: "the card has no such axis",
    IMC_STATUS.IMC_INVALID_FIFO: "the queue does not take this instruction",
    IMC_STATUS.IMC_FIFO_FULL: "the queue is full; the card has not taken the instruction",
    IMC_STATUS.IMC_FIFO_NULL: "the queue is empty",
    IMC_STATUS.IMC_PARAM_READ_ONLY: "the parameter cannot be written",
    IMC_STATUS.IMC_OUT_OF_RANGE: "an argument is out of range",
    IMC_STATUS.IMC_CHECK_ERROR: "the data that came back do not check",
    IMC_STATUS.IMC_VERSION_ERROR: "library and card have different versions",
    IMC_STATUS.IMC_OTHER_ERROR: "the call cannot be carried out now",
    IMC_STATUS.IMC_PASSWORD_ERROR: "the password is wrong",
    IMC_STATUS.IMC_RBFIFO_EMPTY: "there is nothing to read back",
}

(
    IMC_OK,
    IMC_SEND_FAIL,
    IMC_READ_FAIL,
    IMC_TIME_OUT,
    IMC_DEVICE_NOT_OPEN,
    IMC_DEVICE_NOT_FOUND,
    IMC_INVALID_HANDLE,
    IMC_INVALID_PARAM,
    IMC_INVALID_AXIS,
    IMC_INVALID_FIFO,
    IMC_FIFO_FULL,
    IMC_FIFO_NULL,
    IMC_PARAM_READ_ONLY,
    IMC_OUT_OF_RANGE,
    IMC_CHECK_ERROR,
    IMC_VERSION_ERROR,
    IMC_OTHER_ERROR,
    IMC_PASSWORD_ERROR,
    IMC_RBFIFO_EMPTY,
) = IMC_STATUS


class FIFO_SEL(IntEnum):
    """The queue that an instruction is sent to."""

    SEL_IFIFO = 0
    SEL_QFIFO = 1
    SEL_PFIFO1 = 2
    SEL_PFIFO2 = 3
    SEL_CFIFO = 4


SEL_IFIFO, SEL_QFIFO, SEL_PFIFO1, SEL_PFIFO2, SEL_CFIFO = FIFO_SEL


class Refused(Exception):  # noqa: N818  no error of the program
    """A call that the library answers with a status other than IMC_OK; it never leaves the library."""

    def __init__(self, status: IMC_STATUS) -> None:
        super().__init__(status.text)
        self.status = status
