"""A Power Mate as the sessions of its clients see it; everything here is called between two control cycles."""

from __future__ import annotations

import re
import struct
from collections.abc import Sequence

from polycnc.cnc import ControlError
from polycnc.controllers.fanuc import Fault, PowerMate, PowerMateMode, Transfer, TransferError
from polycnc.controllers.fanuc.wire import REPLY_SIZE, Reply, Request, layout_of
from polycnc.errors import ProtocolError
from polycnc.servers.focas._command import (
    BUSY,
    DATA,
    LENGTH,
    NO_OPTION,
    NOT_THERE,
    PROTECTED,
    REJECTED,
    WRONG_PATH,
    RefusedError,
    View,
)
from polycnc.servers.focas._commands import WRITING, known
from polycnc.servers.focas._faults import FaultKind, Faults, Plan
from polycnc.servers.focas._profile import Profile
from polycnc.servers.focas._session import SESSIONS_USED_UP, Status

_COMMANDS = 2
_TRANSFER = 1
_SIZES = (32, 8)
_RECORD = 32
_UPLOAD = re.compile(r"(?:.*/)?O(\d{1,4})(?:-O(\d{1,4}))?$")
_RESET, _OVERFLOW = -2, 8
_BAD_NAME, _BAD_TEXT, _TV, _FULL, _EXISTS, _SELECTED = 1, 1, 2, 3, 4, 5
_COUNT = 2
_FAULTS = {
    Fault.TV: Status(DATA, _TV),
    Fault.REGISTERED: Status(DATA, _EXISTS),
    Fault.SELECTED: Status(DATA, _SELECTED),
    Fault.PROTECTED: Status(PROTECTED),
    Fault.FULL: Status(_OVERFLOW),
    Fault.RESET: Status(_RESET),
}


class FocasControl:
    """Answer the sessions of one control; at most `profile.most_sessions` sessions of each channel at a time.

    With `keep` what was read in a cycle is not read again in the same cycle, unless a client has written since: what is
    done to the control otherwise is seen from the next cycle on.
    """

    def __init__(
        self, control: PowerMate, profile: Profile, faults: Faults | None = None, *, keep: bool = False
    ) -> None:
        self.control = control
        self._keep = keep
        self._kept: tuple[int, View] | None = None
        self.faults = faults or Faults()
        self.profile = profile
        self.version = profile.frame_version
        self.sessions = {_TRANSFER: 0, _COMMANDS: 0}
        self._transfer: Transfer | None = None

    def open_session(self, channel: int) -> Status:
        """Count a session in, or refuse it."""
        if self.faults.has(FaultKind.REFUSE):
            return Status(SESSIONS_USED_UP)
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

    def plan(self) -> Plan:
        """Count a frame of commands and say what the script of faults wants to happen to it."""
        if self.faults.active:
            self._kept = None
        plan = self.faults.request(self.control)
        if self.faults.active:
            self._kept = None
        return plan

    def answer(self, requests: Sequence[Request], plan: Plan = Plan()) -> list[Reply] | Status:  # noqa: B008
        """Carry out the commands of one frame, in one cycle; one that fails leaves the others valid.

        What does not fit the largest frame of the series is answered with the code for a length, without data.
        """
        view = self._view()
        room = self.profile.most_body - _COUNT - REPLY_SIZE * len(requests)
        replies = []
        for request in requests:
            reply = self._reply(view, request, plan)
            if len(reply.payload) > max(room, 0):
                reply = Reply(status=LENGTH)
            room -= len(reply.payload)
            replies.append(reply)
        return replies

    def _view(self) -> View:
        cycle = self.control.clock.cycles
        if self._kept is None or not self._keep or self._kept[0] != cycle:
            self._kept = cycle, View(self.control, self.profile)
        return self._kept[1]

    def _reply(self, view: View, request: Request, plan: Plan) -> Reply:
        command = known(self.profile, request)
        if command is None:
            return Reply(status=NOT_THERE)
        if request.path > 1:
            return Reply(status=WRONG_PATH)
        missing = plan.missing
        if missing is not None and (not missing or (request.target, request.command) in missing):
            return Reply(status=NO_OPTION)
        try:
            return Reply(layout_of(request).pack(command(view, request)))
        except RefusedError as refusal:
            return Reply(status=refusal.code, detail=refusal.detail)
        except ProtocolError:
            return Reply(status=DATA)
        except ControlError:
            return Reply(status=REJECTED)
        finally:
            if (request.target, request.command) in WRITING:
                view.forget()

    # ------------------------------------------------------------------ programs come and go

    def download_start(self, name: str) -> Status:
        """Begin to take programs; the name of a file instead of a folder is refused."""
        control = self.control
        if name and not name.endswith(("/", ":")):
            return Status(DATA, _BAD_NAME)
        busy = (
            control.transfer is not None or control.programs.background_edit or control.power.blocks_transfers
        )
        if busy or control.mode is PowerMateMode.MDI:
            return Status(BUSY)
        if control.programs.key_protects:
            return Status(PROTECTED)
        self._transfer = control.begin_transfer(owner=self)
        return Status()

    def download(self, text: bytes) -> None:
        """Take a piece; what is wrong with it is reported at the end."""
        transfer = self._transfer
        if transfer is not None and transfer.fault is None and self.control.transfer is transfer:
            try:
                transfer.take(text)
            except TransferError:
                return  # the transfer remembers it

    def download_end(self, *, aborted: bool = False) -> Status:
        """Register what has come, all of it or nothing."""
        transfer, self._transfer = self._transfer, None
        if transfer is None or self.control.transfer is not transfer:
            return Status(_RESET)  # the power was off in between
        self.control.transfer = None
        if aborted:
            return Status()
        if transfer.fault is Fault.RESET:
            return Status(_RESET)
        try:
            transfer.finish()
        except TransferError as error:
            return _FAULTS.get(error.fault, Status(DATA, _BAD_TEXT))
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
