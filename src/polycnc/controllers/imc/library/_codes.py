"""What the function library answers with, and the queues it can send to, numbered as the manual numbers them (6)."""

# ruff: noqa: N801  the names are the manual's

from __future__ import annotations

from enum import IntEnum

from polycnc.controllers.library import Code


class IMC_STATUS(Code):
    """What every function returns."""

    IMC_OK = 0, "done"
    IMC_SEND_FAIL = 1, "sending to the card failed"
    IMC_READ_FAIL = 2, "receiving from the card failed"
    IMC_TIME_OUT = 3, "the card did not answer in time"
    IMC_DEVICE_NOT_OPEN = 4, "the card is not open"
    IMC_DEVICE_NOT_FOUND = 5, "there is no such card to open"
    IMC_INVALID_HANDLE = 6, "this is no handle of a card"
    IMC_INVALID_PARAM = 7, "there is no such parameter, or no such bit of it"
    IMC_INVALID_AXIS = 8, "the card has no such axis"
    IMC_INVALID_FIFO = 9, "the queue does not take this instruction"
    IMC_FIFO_FULL = 10, "the queue is full; the card has not taken the instruction"
    IMC_FIFO_NULL = 11, "the queue is empty"
    IMC_PARAM_READ_ONLY = 12, "the parameter cannot be written"
    IMC_OUT_OF_RANGE = 13, "an argument is out of range"
    IMC_CHECK_ERROR = 14, "the data that came back do not check"
    IMC_VERSION_ERROR = 15, "library and card have different versions"
    IMC_OTHER_ERROR = 16, "the call cannot be carried out now"
    IMC_PASSWORD_ERROR = 17, "the password is wrong"
    IMC_RBFIFO_EMPTY = 18, "there is nothing to read back"


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

# fmt: off
__all__ = [
    "FIFO_SEL", "IMC_CHECK_ERROR", "IMC_DEVICE_NOT_FOUND", "IMC_DEVICE_NOT_OPEN", "IMC_FIFO_FULL",
    "IMC_FIFO_NULL", "IMC_INVALID_AXIS", "IMC_INVALID_FIFO", "IMC_INVALID_HANDLE", "IMC_INVALID_PARAM",
    "IMC_OK", "IMC_OTHER_ERROR", "IMC_OUT_OF_RANGE", "IMC_PARAM_READ_ONLY", "IMC_PASSWORD_ERROR",
    "IMC_RBFIFO_EMPTY", "IMC_READ_FAIL", "IMC_SEND_FAIL", "IMC_STATUS", "IMC_TIME_OUT",
    "IMC_VERSION_ERROR", "SEL_CFIFO", "SEL_IFIFO", "SEL_PFIFO1", "SEL_PFIFO2", "SEL_QFIFO",
]
# fmt: on
