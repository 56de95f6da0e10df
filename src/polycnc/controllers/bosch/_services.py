"""What a control does when a program asks for it by MCOPS: services on its own channels (Manual 003, 4.14.2)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from polycnc.controllers.bosch._system import BoschSystem
from polycnc.controllers.bosch.ncs import (
    AUTOMATIC,
    MODES,
    WHOLE_SYSTEM,
    Channel,
    Image,
    Ipo,
    Mode,
    NcsCode,
    NcsError,
    Sav,
    Selection,
)
from polycnc.controllers.bosch.system import MODE_BY_PLC

LONGEST_PATH = 100
LONGEST_BLOCK = 511
WITHOUT_RESELECTION = 2
_PROGRAM_MODES = AUTOMATIC | {Mode.MDI, Mode.DEBUG_BLOCK, Mode.DEBUG_AUTOMATIC}
_READY = (Sav.AT_START, Sav.READY)


class Operator(Protocol):
    """Who can operate the channels of a control, which count from 1."""

    def has_program(self, name: str) -> bool:
        """Tell whether there is a part program."""

    def select(self, channel: int, name: str) -> None:
        """Select a part program."""

    def select_text(self, channel: int, text: str) -> None:
        """Select blocks put in by hand."""

    def start(self, channel: int) -> None:
        """Start, or go on."""

    def reset_channel(self, channel: int) -> None:
        """Break off what a channel executes."""

    def leave(self, channel: int) -> None:
        """Leave the selected program."""

    def search(self, channel: int, start: str) -> bool:
        """Set where the selected program begins; tell whether there is such a block."""

    def set_channel_mode(self, channel: int, mode: Mode) -> None:
        """Switch the mode."""


class Services:
    """Answer process services; without an `operator`, in the run of one program, what would change it is refused."""

    def __init__(self, system: BoschSystem, operator: Operator | None = None) -> None:
        self._system = system
        self._operator = operator

    @property
    def image(self) -> Image:
        """What the control shows in the present cycle."""
        return self._system.shown.renew()

    def cancel_distance(self, channel: int) -> None:
        shown = self._channel(channel)
        if shown.sav == Sav.INACTIVE:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.mode not in _PROGRAM_MODES:
            raise NcsError(NcsCode.WRONG_MODE)
        # Statements before prepared blocks must not be executed a second time.
        raise NcsError(NcsCode.OCCUPIED)

    def control_reset(self, channel: int, kind: int) -> None:
        _check_kind(kind)
        numbers = list(self._system.axes.channels) if channel == WHOLE_SYSTEM else [channel]
        for number in numbers:
            self._channel(number)
        operator = self._may(NcsCode.OCCUPIED)
        for number in numbers:
            operator.reset_channel(number)

    def search_block(self, channel: int, start: str, end: str) -> None:
        shown = self._channel(channel)
        if not shown.program:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.sav != Sav.AT_START:
            raise NcsError(NcsCode.ALREADY_STARTED if shown.sav == Sav.READY else NcsCode.OCCUPIED)
        if end:
            raise NcsError(NcsCode.NOT_AVAILABLE)
        if not self._may(NcsCode.OCCUPIED).search(channel, start):
            raise NcsError(NcsCode.NOT_FOUND)

    def select(
        self, client: object, channel: int, text: str, start: str, end: str, how: Selection
    ) -> Iterator[None]:
        shown = self._channel(channel)
        if int(how) & ~sum(Selection):
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        manual = Selection.MANUAL_BLOCK in how
        longest = LONGEST_BLOCK if manual else LONGEST_PATH
        if not 0 < len(text.encode("latin-1", "replace")) <= longest:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        busy = shown.sav not in (Sav.INACTIVE, Sav.AT_START, Sav.ERROR)
        if busy and not how & (Selection.EXIT_BEFORE | Selection.REPLACE):
            raise NcsError(NcsCode.OCCUPIED if manual else NcsCode.CANNOT_SELECT)
        operator = self._may(NcsCode.CANNOT_SELECT)
        if not manual and not operator.has_program(text):
            raise NcsError(NcsCode.NO_SUCH_PROGRAM)
        if busy:
            operator.leave(channel)
            while self._channel(channel).ipo is not Ipo.STOPPED:
                yield
        if manual:
            if self._channel(channel).mode is not Mode.MDI:
                raise NcsError(NcsCode.WRONG_MODE)
            operator.select_text(channel, text)
        else:
            operator.select(channel, text)
            if start and not operator.search(channel, start):
                raise NcsError(NcsCode.NOT_FOUND)
        if Selection.START_AT_ONCE in how:
            operator.start(channel)

    def exit_program(self, channel: int, kind: int) -> None:
        _check_kind(kind)
        if not self._channel(channel).program:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        self._may(NcsCode.OCCUPIED).leave(channel)

    def start(self, channel: int) -> None:
        shown = self._channel(channel)
        if not shown.program:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.sav not in _READY:
            raise NcsError(NcsCode.NOT_READY)
        self._may(NcsCode.NOT_READY).start(channel)

    def set_mode(self, channel: int, mode: int) -> None:
        shown = self._channel(channel)
        if mode not in MODES:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        group, bit = MODE_BY_PLC
        if shown.sav in (Sav.ACTIVE, Sav.READY) or self._system.interface.bit(group, channel, bit):
            raise NcsError(NcsCode.MODE_FIXED)
        self._may(NcsCode.MODE_FIXED).set_channel_mode(channel, Mode(mode))

    def set_return_strategy(self, channel: int, how: int, where: int) -> None:
        shown = self._channel(channel)
        if not (1 <= how <= 3 and 1 <= where <= 3):
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        shown.return_how, shown.return_where = how, where

    def stop_recording(self, channel: int) -> None:
        self._channel(channel).recording = False

    def _channel(self, number: int) -> Channel:
        if number not in self._system.axes.channels:
            raise NcsError(NcsCode.NO_CHANNEL)
        return self.image.channels[number]

    def _may(self, refusal: NcsCode) -> Operator:
        """Return who can do it.

        Raises:
            NcsError: Nobody can: this is the run of one program.
        """
        if self._operator is None:
            raise NcsError(refusal)
        return self._operator


def _check_kind(kind: int) -> None:
    if kind & ~WITHOUT_RESELECTION:
        raise NcsError(NcsCode.UNKNOWN_SYNTAX)
