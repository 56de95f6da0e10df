"""What a control does when a program asks for it by MCOPS: services on its own channels (Manual 003, 4.14.2)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol

from polycnc.cnc import ControlError, Refusal, RunState
from polycnc.controllers.bosch._block_buffer import SIZE_BYTES
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
_PART_PROGRAM_MODES = AUTOMATIC | {Mode.DEBUG_BLOCK, Mode.DEBUG_AUTOMATIC}
_PROGRAM_MODES = _PART_PROGRAM_MODES | {Mode.MDI}
_READY = (Sav.AT_START, Sav.READY)
_FREE = (Sav.INACTIVE, Sav.AT_START, Sav.READY, Sav.ERROR)
_NO_MODES = frozenset((Mode.RETURN_TO_PATH, Mode.JOG_WORKPIECE))
"""Modes that are not simulated."""
_BEGUN = (
    RunState.ACTIVE, RunState.HOLD, RunState.STOPPED_AT_BLOCK, RunState.PROGRAM_STOP, RunState.OPTIONAL_STOP,
)  # fmt: skip
_HANDS = {Selection.JOG: Mode.JOG, Selection.REFERENCE: Mode.REFERENCE}
_CODES = {
    Refusal.NOT_REFERENCED: NcsCode.NOT_REFERENCED, Refusal.MODE: NcsCode.WRONG_MODE, Refusal.FULL: NcsCode.BUFFER_FULL,
    Refusal.NOT_FOUND: NcsCode.NO_SUCH_PROGRAM, Refusal.RUNNING: NcsCode.OCCUPIED, Refusal.DATA: NcsCode.UNKNOWN_SYNTAX,
}  # fmt: skip


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

    def miss(self, channel: int, name: str) -> None:
        """Select a program that does not exist."""

    def link(self, channel: int, name: str) -> bool:
        """Link a program; tell whether nothing is wrong with it."""

    def buffer(self, channel: int, text: str) -> None:
        """Put blocks after those put in by hand."""

    def leave(self, channel: int, *, again: bool) -> None:
        """Leave what is selected; with `again` the program is selected from its beginning."""

    def search(self, channel: int, start: str, end: str) -> bool:
        """Set where the selected program begins and ends; tell whether there are such blocks."""

    def set_channel_mode(self, channel: int, mode: Mode) -> None:
        """Switch the mode."""


class Services:
    """Answer process services; without an `operator`, in the run of one program, what would change it is refused.

    What ends a program is done by what is returned, so that the channel that asks can be the one that is ended.
    """

    def __init__(self, system: BoschSystem, operator: Operator | None = None) -> None:
        self._system = system
        self._operator = operator
        self._writers: dict[int, object] = {}
        """Who has written last into the buffer of each channel."""

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
        raise NcsError(NcsCode.NOT_AVAILABLE)

    def control_reset(self, channel: int, kind: int) -> Iterator[None]:
        _check_kind(kind)
        whole = channel == WHOLE_SYSTEM
        numbers = list(self._system.axes.channels) if whole else [self._channel(channel).number]
        return self._reset(self._may(NcsCode.OCCUPIED), numbers, again=self._again(kind))

    def search_block(self, channel: int, start: str, end: str) -> None:
        shown = self._channel(channel)
        if not shown.program:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.mode not in _PART_PROGRAM_MODES:
            raise NcsError(NcsCode.WRONG_MODE)
        if shown.sav not in _READY:
            raise NcsError(NcsCode.OCCUPIED)
        if self._system.channels.selected(channel) is None or self._has_begun(channel):
            raise NcsError(NcsCode.ALREADY_STARTED)
        self._search(self._may(NcsCode.OCCUPIED), channel, start, end)

    def select(
        self, client: object, channel: int, text: str, start: str, end: str, how: Selection
    ) -> Iterator[None]:
        shown = self._channel(channel)
        if int(how) & ~sum(Selection):
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        for flag, mode in _HANDS.items():
            if flag in how:
                if shown.mode is not mode:
                    raise NcsError(NcsCode.WRONG_MODE)
                return iter(())
        _check_selection(shown.mode, text, how)
        operator = self._may(NcsCode.CANNOT_SELECT)
        self._check_room(shown, channel, how)
        return self._select(operator, client, channel, (text, start, end), how)

    def exit_program(self, channel: int, kind: int) -> Iterator[None]:
        _check_kind(kind)
        if self._channel(channel).sav is Sav.INACTIVE:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        return self._leave(self._may(NcsCode.OCCUPIED), channel, again=self._again(kind))

    def start(self, channel: int) -> None:
        shown = self._channel(channel)
        if shown.sav is Sav.INACTIVE:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.sav not in _READY:
            raise NcsError(NcsCode.NOT_READY)
        operator = self._may(NcsCode.NOT_READY)
        with _codes(NcsCode.NOT_READY):
            operator.start(channel)

    def set_mode(self, channel: int, mode: int) -> None:
        shown = self._channel(channel)
        if mode not in MODES:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        group, bit = MODE_BY_PLC
        among = shown.mode in AUTOMATIC and mode in AUTOMATIC
        if (shown.sav is not Sav.INACTIVE and not among) or self._system.interface.bit(group, channel, bit):
            raise NcsError(NcsCode.MODE_FIXED)
        if mode in _NO_MODES:
            raise NcsError(NcsCode.NOT_AVAILABLE)
        operator = self._may(NcsCode.MODE_FIXED)
        with _codes(NcsCode.MODE_FIXED):
            operator.set_channel_mode(channel, Mode(mode))

    def set_return_strategy(self, channel: int, how: int, where: int) -> None:
        shown = self._channel(channel)
        if not (1 <= how <= 3 and 1 <= where <= 3):
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        shown.return_how, shown.return_where = how, where

    def stop_recording(self, channel: int) -> None:
        self._channel(channel).recording = False

    # ------------------------------------------------------------------ within

    def _channel(self, number: int) -> Channel:
        if number not in self._system.axes.channels:
            raise NcsError(NcsCode.NO_CHANNEL)
        shown = self.image.channels[number]
        if shown.sav is Sav.RESET:
            raise NcsError(NcsCode.IN_RESET)
        return shown

    def _check_room(self, shown: Channel, channel: int, how: Selection) -> None:
        """Make sure that something else can be selected.

        Raises:
            NcsError: Something is being executed that is not left before.
        """
        busy = shown.sav not in _FREE or self._has_begun(channel)
        buffers = Selection.BUFFERED in how and self._system.programs[channel].is_buffered
        if not busy or Selection.EXIT_BEFORE in how or buffers:
            return
        if how & (Selection.REPLACE | Selection.START_AT_ONCE):
            raise NcsError(NcsCode.NOT_AVAILABLE)  # modal states that stay; a machine function
        raise NcsError(NcsCode.OCCUPIED if Selection.MANUAL_BLOCK in how else NcsCode.CANNOT_SELECT)

    def _has_begun(self, channel: int) -> bool:
        """Tell whether what is selected has been started: it stands at a block's end, or is executed."""
        run = self._system.channels.run(channel)
        return run is not None and run.state in _BEGUN

    def _again(self, kind: int) -> bool:
        return self._system.channels.reselects() and not kind & WITHOUT_RESELECTION

    def _may(self, refusal: NcsCode) -> Operator:
        """Return who can do it.

        Raises:
            NcsError: Nobody can: this is the run of one program.
        """
        if self._operator is None:
            raise NcsError(refusal)
        return self._operator

    def _reset(self, operator: Operator, numbers: Sequence[int], *, again: bool) -> Iterator[None]:
        for number in numbers:
            operator.reset_channel(number)
            operator.leave(number, again=again)
        yield from ()

    def _leave(self, operator: Operator, channel: int, *, again: bool) -> Iterator[None]:
        operator.leave(channel, again=again)
        yield from ()

    def _search(self, operator: Operator, channel: int, start: str, end: str) -> None:
        with _codes(NcsCode.OCCUPIED):
            if not operator.search(channel, start, end):
                raise NcsError(NcsCode.NOT_FOUND)

    def _select(
        self, operator: Operator, client: object, channel: int, what: tuple[str, str, str], how: Selection
    ) -> Iterator[None]:
        text, start, end = what
        if Selection.EXIT_BEFORE in how and self.image.channels[channel].sav is not Sav.INACTIVE:
            operator.leave(channel, again=False)
            while self.image.channels[channel].ipo is not Ipo.STOPPED:
                yield
        with _codes(NcsCode.CANNOT_SELECT):
            if Selection.MANUAL_BLOCK not in how:
                self._select_program(operator, channel, text, how)
                if (start or end) and self.image.channels[channel].sav is not Sav.ERROR:
                    self._search(operator, channel, start, end)
            elif Selection.BUFFERED in how:
                self._writers[channel] = client
                yield  # another one may write in the same cycle
                if self._writers.get(channel) is not client:
                    raise NcsError(NcsCode.BUFFER_INTERRUPTED)
                operator.buffer(channel, text)
            else:
                operator.select_text(channel, text)
            if Selection.START_AT_ONCE in how and self.image.channels[channel].sav in _READY:
                operator.start(channel)
                yield  # its first block is prepared
                if self.image.channels[channel].sav is Sav.ERROR:
                    raise NcsError(NcsCode.BLOCK_ERROR)

    def _select_program(self, operator: Operator, channel: int, name: str, how: Selection) -> None:
        right = operator.has_program(name)
        if right:
            operator.select(channel, name)
            right = Selection.LINK not in how or operator.link(channel, name)
        if not right:  # else it is said by the run that links it
            operator.miss(channel, name)
            if Selection.WHEN_READY in how:
                raise NcsError(NcsCode.NO_SUCH_PROGRAM)


def _check_selection(mode: Mode, text: str, how: Selection) -> None:
    """Make sure that a text can be selected in a mode.

    Raises:
        NcsError: It cannot.
    """
    manual, size = Selection.MANUAL_BLOCK in how, len(text.encode("latin-1", "replace"))
    buffered = manual and Selection.BUFFERED in how
    fits = mode is Mode.MDI if manual else mode in _PART_PROGRAM_MODES
    if not fits:
        raise NcsError(NcsCode.WRONG_MODE)
    if buffered and size > SIZE_BYTES:
        raise NcsError(NcsCode.BUFFER_FULL)
    if not 0 < size <= (SIZE_BYTES if buffered else LONGEST_BLOCK if manual else LONGEST_PATH):
        raise NcsError(NcsCode.UNKNOWN_SYNTAX)


@contextmanager
def _codes(other: NcsCode) -> Iterator[None]:
    """Answer what the operator is refused by its code, by `other` where there is none.

    Raises:
        NcsError: The operator was refused.
    """
    try:
        yield
    except ControlError as error:
        raise NcsError(_CODES.get(error.reason, other)) from error


def _check_kind(kind: int) -> None:
    if kind & ~WITHOUT_RESELECTION:
        raise NcsError(NcsCode.UNKNOWN_SYNTAX)
