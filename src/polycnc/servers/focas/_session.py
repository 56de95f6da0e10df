"""One connection: which frame is allowed when, as a table, and what is answered. No sockets, no clock.

The number in the OPEN frame decides what a connection is for: 1 transfers programs, 2 carries commands. A frame
that the table does not have in the present state resets the connection, as controls do.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import NamedTuple, Protocol

from polycnc.controllers.fanuc.wire import (
    Frame,
    FrameReader,
    FrameType,
    Reply,
    Request,
    read_requests,
    status_body,
    write_replies,
)
from polycnc.errors import ProtocolError
from polycnc.servers.focas._faults import FaultKind, Plan

SESSIONS_USED_UP = 2
"""The code with which a control refuses one session too many."""
PROTOCOL_REFUSED = -17
REJECTED = 13

_START_BODY = 516
_NAME_AT = 4
_UPLOAD_PIECE = 0x500
_MOST_AT_ONCE = 1 << 15
_REPLY_LEAD_S, _TURN_S = 0.02, 0.005
"""Ruling: a control answers first and sends a program in its later turns. Clients take the reply by one `recv`."""


class Status(NamedTuple):
    """A return code with its detail and the data number it is about; code 0 is success."""

    code: int = 0
    detail: int = 0
    number: int = 0


class Answerer(Protocol):
    """What a session asks the control behind it; calls never raise, they answer with codes."""

    version: int
    """Frame version of the control."""

    def open_session(self, channel: int) -> Status:
        """Count a session in, or refuse it."""

    def close_session(self, channel: int) -> None:
        """Count a session out."""

    def opening(self) -> bytes:
        """Return the body of the frame that accepts a session."""

    def answer(self, requests: Sequence[Request], plan: Plan) -> list[Reply] | Status:
        """Carry out the commands of one frame in one cycle; a status refuses the frame as a whole."""

    def download_start(self, name: str) -> Status:
        """Begin to take a program for a folder or name."""

    def download(self, text: bytes) -> None:
        """Take a piece of the program."""

    def download_end(self, *, aborted: bool = False) -> Status:
        """Register the program, or drop it."""

    def upload(self, name: str) -> Status | bytes:
        """Return the text of a program or range of programs."""

    def plan(self) -> Plan:
        """Count a frame of commands and say what a script of faults wants to happen to it."""


class State(Enum):
    """Where a connection stands."""

    NEW = "connected"
    TRANSFER = "transfer channel"
    DOWNLOADING = "program comes in"
    UPLOADED = "program is sent"
    COMMAND = "command channel"
    ENDED = "closed"


class Transition(NamedTuple):
    """In `state`, a frame is carried out by `action`, and `next` follows unless the action says otherwise."""

    state: State
    frame: FrameType
    action: str
    next: State


TRANSITIONS = (
    Transition(State.NEW, FrameType.OPEN, "open", State.COMMAND),
    Transition(State.NEW, FrameType.CLOSE, "close", State.ENDED),
    Transition(State.COMMAND, FrameType.COMMANDS, "commands", State.COMMAND),
    Transition(State.COMMAND, FrameType.CLOSE, "close", State.ENDED),
    Transition(State.TRANSFER, FrameType.DOWNLOAD_START, "download_start", State.DOWNLOADING),
    Transition(State.TRANSFER, FrameType.UPLOAD_START, "upload_start", State.UPLOADED),
    Transition(State.TRANSFER, FrameType.UPLOAD_END, "upload_end", State.TRANSFER),
    Transition(State.TRANSFER, FrameType.CLOSE, "close", State.ENDED),
    Transition(State.DOWNLOADING, FrameType.DOWNLOAD_DATA, "download", State.DOWNLOADING),
    Transition(State.DOWNLOADING, FrameType.DOWNLOAD_END, "download_end", State.TRANSFER),
    Transition(State.DOWNLOADING, FrameType.CLOSE, "close", State.ENDED),
    Transition(State.UPLOADED, FrameType.UPLOAD_ACKNOWLEDGED, "ignore", State.TRANSFER),
    Transition(State.UPLOADED, FrameType.UPLOAD_MORE, "ignore", State.UPLOADED),
    Transition(State.UPLOADED, FrameType.UPLOAD_END, "upload_end", State.TRANSFER),
    Transition(State.UPLOADED, FrameType.UPLOAD_START, "upload_start", State.UPLOADED),
    Transition(State.UPLOADED, FrameType.DOWNLOAD_START, "download_start", State.DOWNLOADING),
    Transition(State.UPLOADED, FrameType.CLOSE, "close", State.ENDED),
)
_BY_FRAME = {(row.state, int(row.frame)): row for row in TRANSITIONS}
_STARTED, _OLD_STARTED = 256, 513
_LAST_OLD_VERSION = 2
_CHANNELS = {1: State.TRANSFER, 2: State.COMMAND}


class Ending(Enum):
    """How a connection ends: after the last bytes are out, or with a reset."""

    CLOSE = "close"
    RESET = "reset"


@dataclass
class Session:
    """Turn received bytes into bytes to send.

    After `receive`, `ending` tells whether the connection shall be closed, `delay_s` how long what is to be sent shall
    wait, and `more` whether there is more to be taken by `receive(b"")`, not before `pause_s` has passed: what is sent
    at once is bounded, and a program goes out frame by frame. `lost` is called when the peer is gone.
    """

    control: Answerer
    state: State = State.NEW
    ending: Ending | None = None
    channel: int = 0
    delay_s: float = 0.0
    more: bool = False
    pause_s: float = 0.0
    reader: FrameReader = field(default_factory=FrameReader)
    _out: list[bytes] = field(default_factory=list)
    _later: deque[bytes] = field(default_factory=deque)

    def receive(self, data: bytes) -> bytes:
        """Take bytes from the peer; return what to send, in one piece."""
        self.more, self.pause_s = False, 0.0
        frames = self.reader.feed(b"" if self.ending else data)
        if self._later:
            self._out.append(self._later.popleft())
            self.pause_s = _TURN_S
        else:
            self._answer_all(frames)
        if self._later:
            self.more, self.pause_s = True, self.pause_s or _REPLY_LEAD_S
        elif self.pause_s:
            self.more, self.pause_s = bool(self.reader.pending), 0.0
        sent = b"".join(self._out)
        self._out.clear()
        return sent

    def _answer_all(self, frames: Iterator[Frame]) -> None:
        """Answer what has come, until enough is to be sent at once."""
        try:
            for frame in frames:
                self._take(frame)
                if self.ending:
                    break
                if self._later or self.delay_s or sum(map(len, self._out)) >= _MOST_AT_ONCE:
                    self.more = bool(self.reader.pending)
                    break
        except ProtocolError:
            self._end(Ending.RESET)

    def lost(self) -> None:
        """Give back what the session holds: the peer has gone, or the connection was ended."""
        self._end(Ending.CLOSE)

    def _take(self, frame: Frame) -> None:
        row = _BY_FRAME.get((self.state, frame.type))
        if row is None:
            self._end(Ending.RESET)
            return
        action: Callable[[Frame, State], State] = getattr(self, f"_{row.action}")
        self.state = action(frame, row.next)

    def _send(self, kind: FrameType, body: bytes = b"") -> None:
        self._out.append(self._frame(kind, body))

    def _frame(self, kind: FrameType, body: bytes = b"") -> bytes:
        return bytes(Frame(kind, body, self.control.version))

    def _end(self, how: Ending) -> None:
        if self.state is State.DOWNLOADING:
            self.control.download_end(aborted=True)
        if self.state is not State.ENDED and self.channel:
            self.control.close_session(self.channel)
        self.state = State.ENDED
        self.ending = self.ending or how
        self._later.clear()

    # ------------------------------------------------------------------ actions: what each frame does

    def _open(self, frame: Frame, following: State) -> State:
        channel = int.from_bytes(frame.body, "big") if len(frame.body) == 2 else 0
        if channel not in _CHANNELS:
            self._end(Ending.RESET)
            return State.ENDED
        refused = self.control.open_session(channel)
        if refused.code:
            self._send(FrameType.OPEN_REFUSED, status_body(*refused))
            self._end(Ending.CLOSE)
            return State.ENDED
        self.channel = channel
        self._send(FrameType.OPENED, self.control.opening())
        return _CHANNELS[channel]

    def _close(self, frame: Frame, following: State) -> State:
        self._send(FrameType.CLOSED)
        self._end(Ending.CLOSE)
        return following

    def _commands(self, frame: Frame, following: State) -> State:
        plan = self.control.plan()
        if plan.kind is FaultKind.DROP:
            self._end(Ending.RESET)
            return State.ENDED
        before = len(self._out)
        self._answer(frame, plan)
        self.delay_s += plan.delay_s
        if plan.kind is not None:
            sent = b"".join(self._out[before:])
            del self._out[before:]
        if plan.kind is FaultKind.HALF:
            self._out.append(sent[: len(sent) // 2])
            self._end(Ending.RESET)
            return State.ENDED
        return following

    def _answer(self, frame: Frame, plan: Plan) -> None:
        try:
            requests = read_requests(frame.body) if frame.body else []
        except ProtocolError:
            self._send(FrameType.COMMANDS_REFUSED, status_body(PROTOCOL_REFUSED, 1))
            return
        answers = self.control.answer(requests, plan)
        if isinstance(answers, Status):
            self._send(FrameType.COMMANDS_REFUSED, status_body(*answers))
        else:
            self._send(FrameType.ANSWERS, write_replies(requests, answers))

    def _download_start(self, frame: Frame, following: State) -> State:
        refused = self.control.download_start(_name(frame.body))
        if refused.code:
            self._send(FrameType.DOWNLOAD_START_STATUS, status_body(*refused))
            return State.TRANSFER
        self._send(FrameType.DOWNLOAD_STARTED, bytes(_STARTED))
        return following

    def _download(self, frame: Frame, following: State) -> State:
        self.control.download(frame.body)  # never answered
        return following

    def _download_end(self, frame: Frame, following: State) -> State:
        status = self.control.download_end()
        if status.code:
            self._send(FrameType.DOWNLOAD_END_STATUS, status_body(*status))
        else:
            self._send(FrameType.DOWNLOAD_ENDED)
        return following

    def _upload_start(self, frame: Frame, following: State) -> State:
        text = self.control.upload(_name(frame.body))
        old = self.control.version <= _LAST_OLD_VERSION
        if isinstance(text, Status) and old:
            text = b""  # a program that is not there comes as an empty piece
        if isinstance(text, Status):
            self._send(
                FrameType.UPLOAD_STARTED, (0).to_bytes(2, "big") + text.code.to_bytes(2, "big", signed=True)
            )
            return State.TRANSFER
        self._send(FrameType.UPLOAD_STARTED, bytes(_OLD_STARTED if old else _STARTED))
        for at in range(0, len(text) or 1, _UPLOAD_PIECE):
            self._later.append(self._frame(FrameType.UPLOAD_DATA, text[at : at + _UPLOAD_PIECE]))
        self._later.append(self._frame(FrameType.UPLOAD_FINISHED))
        return following

    def _upload_end(self, frame: Frame, following: State) -> State:
        self._send(FrameType.UPLOAD_END_STATUS, status_body(REJECTED))
        return following

    def _ignore(self, frame: Frame, following: State) -> State:
        return following


def _name(body: bytes) -> str:
    """Return the name in the body that begins a transfer."""
    return body[_NAME_AT:_START_BODY].split(b"\0")[0].decode("latin-1")
