"""A Power Mate as the sessions of its clients see it; everything here is called between two control cycles."""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.wire import Reply, Request
from polycnc.errors import ProtocolError
from polycnc.servers.focas._commands import DATA, NOT_THERE, REJECTED, RefusedError, known
from polycnc.servers.focas._profile import Profile
from polycnc.servers.focas._session import SESSIONS_USED_UP, Status

_COMMANDS = 2
_TRANSFER = 1
_SIZES = (32, 8)
_RECORD = 32
_OLD_RECORD = 8
_NUMBER = re.compile(rb"\s*O(\d{1,4})")
_UPLOAD = re.compile(r"(?:.*/)?O(\d{1,4})(?:-O(\d{1,4}))?$")
_BAD_TEXT, _EXISTS, _SELECTED = 1, 4, 5
_MOST_TEXT = 1 << 20


class FocasControl:
    """Answer the sessions of one control; at most `profile.most_sessions` command channels at a time."""

    def __init__(self, control: PowerMate, profile: Profile) -> None:
        self.control = control
        self.profile = profile
        self.version = profile.frame_version
        self.sessions = {_TRANSFER: 0, _COMMANDS: 0}
        self._incoming: bytearray | None = None

    def open_session(self, channel: int) -> Status:
        """Count a session in, or refuse it."""
        if self.sessions[channel] >= self.profile.most_sessions:
            return Status(SESSIONS_USED_UP)
        self.sessions[channel] += 1
        return Status()

    def close_session(self, channel: int) -> None:
        """Count a session out."""
        self.sessions[channel] -= 1

    def opening(self) -> bytes:
        """Return the body that accepts a session: how many axes, spindles and paths there are."""
        axes = self.control.axes
        if self.profile.frame_version <= 2:
            head = struct.pack(">8H", 6, 5, 1, self.profile.most_axes, 1, 0, axes, 1)
            return head + struct.pack(">4H", 0x204D, 1, axes, 1)
        head = struct.pack(">20H", 6, 5, 1, *_SIZES, 10, 3, 3, axes, axes, 0, 1, 1, 0, 1, *[0] * 5)
        first = struct.pack(">8H", 0x204D, 1, 0, axes, axes, 0, 1, 1).ljust(_RECORD, b"\0")
        return head + first + bytes(9 * _RECORD)

    def answer(self, requests: Sequence[Request]) -> list[Reply] | Status:
        """Carry out the commands of one frame; one that fails leaves the others valid."""
        return [self._reply(request) for request in requests]

    def _reply(self, request: Request) -> Reply:
        command = known(self.profile, request) if request.path <= 1 else None
        if command is None:
            return Reply(status=NOT_THERE)
        try:
            return Reply(command(self.control, self.profile, request))
        except RefusedError as refusal:
            return Reply(status=refusal.code, detail=refusal.detail)
        except ProtocolError:
            return Reply(status=DATA)
        except ControlError:
            return Reply(status=REJECTED)

    # ------------------------------------------------------------------ programs come and go

    def download_start(self, name: str) -> Status:
        """Begin to take a program; a name of a file instead of a folder is refused."""
        if self._incoming is not None:
            return Status(-1)
        if name and not name.endswith(("/", ":")):
            return Status(DATA, 1)
        self._incoming = bytearray()
        return Status()

    def download(self, text: bytes) -> None:
        """Take a piece of the program."""
        if self._incoming is not None and len(self._incoming) <= _MOST_TEXT:
            self._incoming += text

    def download_end(self, *, aborted: bool = False) -> Status:
        """Register the program: from behind the first line end to the last %."""
        taken, self._incoming = bytes(self._incoming or b""), None
        if aborted:
            return Status()
        _, found, text = taken.partition(b"\n")
        text, end, _ = text.rpartition(b"%")
        begin = _NUMBER.match(text)
        if not found or not end or begin is None or len(taken) > _MOST_TEXT:
            return Status(DATA, _BAD_TEXT)
        number = int(begin[1])
        if number == self.control.selected:
            return Status(DATA, _SELECTED, number)
        if number in self.control.programs:
            return Status(DATA, _EXISTS, number)
        try:
            self.control.programs.register(number, text)
        except ControlError:
            return Status(DATA, _BAD_TEXT, number)
        return Status()

    def upload(self, name: str) -> Status | bytes:
        """Return programs as text, in ascending order."""
        asked = _UPLOAD.match(name.removeprefix("N:"))
        if asked is None:
            return Status(DATA)
        first = int(asked[1])
        wanted = self.control.programs.directory(first, int(asked[2] or first))
        if not wanted:
            return Status(DATA)
        parts = [self.control.programs.read(each.number).rstrip(b"\n") + b"\n" for each in wanted]
        return b"%\n" + b"".join(parts) + b"%"
