"""What a call across the NCS coupling answers (Manual 003, 4.14.1)."""

from __future__ import annotations

from enum import IntEnum


class NcsCode(IntEnum):
    """Answers of the NCS coupling that a call can have; `text` says what is wrong."""

    text: str

    def __new__(cls, value: int, text: str) -> NcsCode:
        code = int.__new__(cls, value)
        code._value_ = value
        code.text = text
        return code

    DONE = 0, "no error"
    NO_CHANNEL = 1, "there is no such channel"
    OCCUPIED = 2, "the channel is occupied at the moment"
    IN_RESET = 3, "a control reset of the channel is under way"
    NAME_TOO_LONG = 4, "the name of the program is too long"
    NOT_REFERENCED = 5, "the axes have to be at their reference points before"
    NO_SUCH_PROGRAM = 6, "there is no such program, or it cannot be executed"
    BUFFER_INTERRUPTED = 7, "another client wrote into the buffer at the same time"
    WRONG_MODE = 8, "not in this operation mode"
    NOT_READY = 9, "the channel is not ready to start"
    NOTHING_SELECTED = 10, "no program is selected"
    CANNOT_SELECT = 11, "the state of the channel does not permit to select"
    MODE_FIXED = 13, "the state of the channel does not permit another mode"
    NOT_FOUND = 14, "the block searched for was not found"
    ALREADY_STARTED = 15, "no search: the main program has been started already"
    TOO_MANY_SHIFT_AXES = 16, "external zero shifts: too many axes"
    TOO_MANY_SHIFT_GROUPS = 17, "external zero shifts: too many groups"
    UNKNOWN_SYNTAX = 18, "unknown syntax"
    BAD_TOOL_INDEX = 19, "external tool compensation: bad index"
    TOO_MANY_TOOL_VALUES = 20, "external tool compensation: too many values"
    BAD_TOOL_FORMAT = 21, "external tool compensation: bad format"
    BAD_TOOL_ORIENTATION = 22, "external tool compensation: bad orientation"
    BAD_GROUP = 23, "bad compensation group"
    NO_AXIS = 24, "there is no such axis"
    BLOCK_ERROR = 25, "the block that was to start at once has an error"
    BUFFER_FULL = 26, "the buffer of NC blocks overflows"
    BAD_FILTER = 27, "bad filter of coordinates"
    BAD_MAGIC = 100, "the magic number of the message is wrong"
    DISRUPTED = 101, "the communication is disrupted"
    NOT_AVAILABLE = 102, "this software has no such function"


class NcsError(Exception):
    """A service that was not done, or not wholly; it goes to the caller as its code."""

    def __init__(self, code: NcsCode) -> None:
        super().__init__(code.text)
        self.code = code
