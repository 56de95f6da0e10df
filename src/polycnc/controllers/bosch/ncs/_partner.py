"""A second control in the same process: what it does when a part program of the first asks (Manual 003, 4.14.2).

It executes its blocks in a simple way, each in a fixed number of cycles, so that its states, ends and distances are
those that a neighbour would show; a control with real motion takes its place by the same protocol.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from polycnc.controllers.bosch.ncs._blocks import find_block, read_block
from polycnc.controllers.bosch.ncs._codes import NcsCode, NcsError
from polycnc.controllers.bosch.ncs._image import Axis, Channel, Image, Ipo, Mode, Sav, Wait
from polycnc.controllers.bosch.ncs._partner_run import Job, Runner
from polycnc.controllers.bosch.ncs._process_services import (
    AUTOMATIC,
    MODES,
    WHOLE_SYSTEM,
    WITHOUT_RESELECTION,
    Selection,
)
from polycnc.machine import Clock
from polycnc.nc.cpl import holds_cpl

LONGEST_PATH = 100
LONGEST_BLOCK = 511
BUFFER_SIZE = 4095
_PROGRAM_MODES = AUTOMATIC | {Mode.DEBUG_BLOCK, Mode.DEBUG_AUTOMATIC}
_CAN_START = (Sav.READY, Sav.AT_START, Sav.BUFFER_EMPTY)
_BUSY = (Sav.ACTIVE, Sav.CANCELLING, Sav.PREPARING, Sav.BUFFER_EMPTY)


@dataclass(slots=True)
class Station:
    """What a partner holds of a channel beside what it shows.

    `adopted` are MACODA parameters in force, `changed` those that a control reset puts there; `errors` as texts.
    """

    job: Job | None = None
    errors: list[str] = field(default_factory=list)
    changed: dict[str, float] = field(default_factory=dict)
    adopted: dict[str, float] = field(default_factory=dict)
    reset_executed: bool = False
    reselects: bool = True
    hand: Mode | None = None
    writer: object = None
    functions: list[str] = field(default_factory=list)


class Partner:
    """A control that answers process services and lets its time pass with `advance`.

    Args:
        image: What it shows; the caller may change everything in it.
        programs: Part programs by path.
        block_cycles: How many cycles a block takes.
    """

    def __init__(
        self,
        image: Image,
        programs: Mapping[str, str] | None = None,
        *,
        block_cycles: int = 2,
        cycle_s: float = 0.001,
    ) -> None:
        self.image = image
        self.programs = dict(programs or {})
        self.linked: set[str] = set()
        self.clock = Clock(cycle_s)
        self.stations = {number: Station() for number in image.channels}
        self.mode_by_plc: set[int] = set()
        self.references_needed: set[int] = set()
        self._runner = Runner(image, block_cycles)

    def status(self) -> Image:
        """Return what it shows."""
        return self.image

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Let cycles pass; nothing ends them early."""
        for _ in range(cycles):
            self.image.cycle += 1
            for number, station in self.stations.items():
                self._pass(self.image.channels[number], station)
        self.clock.tick(cycles)
        return cycles

    def cancel_distance(self, channel: int) -> None:
        shown, station = self._ready(channel)
        if station.job is None:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.mode not in _PROGRAM_MODES | {Mode.MDI}:
            raise NcsError(NcsCode.WRONG_MODE)
        if shown.sav not in (Sav.ACTIVE, Sav.READY):
            raise NcsError(NcsCode.OCCUPIED)
        shown.sav = Sav.CANCELLING
        shown.ipo = Ipo.RUNNING_DOWN

    def control_reset(self, channel: int, kind: int) -> None:
        if kind & ~WITHOUT_RESELECTION:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        if channel == WHOLE_SYSTEM:
            numbers: Iterable[int] = self.stations
        else:
            self._ready(channel)
            numbers = (channel,)
        for number in numbers:
            shown, station = self.image.channels[number], self.stations[number]
            station.reselects = not kind & WITHOUT_RESELECTION
            station.reset_executed = False
            shown.sav, shown.ipo = Sav.RESET, Ipo.STOPPED

    def search_block(self, channel: int, start: str, end: str) -> None:
        shown, station = self._ready(channel)
        if station.job is None or station.job.manual:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.sav == Sav.READY and station.job.started:
            raise NcsError(NcsCode.ALREADY_STARTED)
        if shown.sav not in (Sav.AT_START, Sav.READY):
            raise NcsError(NcsCode.OCCUPIED)
        shown.sav = Sav.READY
        _search(station.job, start, end)

    def select(
        self, client: object, channel: int, text: str, start: str, end: str, how: Selection
    ) -> Iterator[None]:
        shown, station = self._ready(channel)
        if int(how) & ~sum(Selection):
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        for flag, modes in (
            (Selection.JOG, (Mode.JOG, Mode.JOG_WORKPIECE)),
            (Selection.REFERENCE, (Mode.REFERENCE,)),
        ):
            if flag in how:
                if shown.mode not in modes:
                    raise NcsError(NcsCode.WRONG_MODE)
                station.hand = shown.mode
                return
        if Selection.MANUAL_BLOCK in how:
            yield from self._select_blocks(client, shown, station, text, how)
        else:
            yield from self._select_program(shown, station, text, start, end, how)

    def exit_program(self, channel: int, kind: int) -> None:
        if kind & ~WITHOUT_RESELECTION:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        shown, station = self._ready(channel)
        if station.job is None:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        self._exit(shown, station, reselect=not kind & WITHOUT_RESELECTION)

    def start(self, channel: int) -> None:
        shown, station = self._ready(channel)
        if station.job is None:
            raise NcsError(NcsCode.NOTHING_SELECTED)
        if shown.sav not in _CAN_START:
            raise NcsError(NcsCode.NOT_READY)
        axes = self.image.channel_axes(channel)
        if channel in self.references_needed and not all(axis.referenced for axis in axes):
            raise NcsError(NcsCode.NOT_REFERENCED)
        self._start(shown, station, station.job)

    def set_mode(self, channel: int, mode: int) -> None:
        shown, station = self._ready(channel)
        if mode not in MODES:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        if channel in self.mode_by_plc:
            raise NcsError(NcsCode.MODE_FIXED)
        if station.job is not None and not (shown.mode in AUTOMATIC and mode in AUTOMATIC):
            raise NcsError(NcsCode.MODE_FIXED)
        shown.mode = Mode(mode)
        station.hand = None
        shown.recording = mode == Mode.RETURN_TO_PATH

    def set_return_strategy(self, channel: int, how: int, where: int) -> None:
        shown, _ = self._ready(channel)
        if not (1 <= how <= 3 and 1 <= where <= 3):
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        shown.return_how, shown.return_where = how, where

    def stop_recording(self, channel: int) -> None:
        self._ready(channel)[0].recording = False

    def hold(self, channel: int, on: bool = True) -> None:
        """Hold the feed of a channel, or let it go on: the interpolator runs down first."""
        shown = self.image.channels[channel]
        if on:
            shown.other_waits |= Wait.FEED_HOLD
            if shown.ipo == Ipo.RUNNING:
                shown.ipo = Ipo.RUNNING_DOWN
        else:
            shown.other_waits &= ~Wait.FEED_HOLD
            if shown.sav == Sav.ACTIVE:
                shown.ipo = Ipo.RUNNING

    def move_by_hand(self, channel: int, axis: Axis, position: float) -> None:
        """Jog an axis, or have it search its reference point, to a machine position in mm or deg.

        Raises:
            NcsError: The channel was not prepared for it (selection types 256 and 512).
        """
        hand = self.stations[channel].hand
        if hand is None:
            raise NcsError(NcsCode.WRONG_MODE)
        axis.setpoint = axis.actual = position
        axis.referenced = axis.referenced or hand == Mode.REFERENCE

    def _ready(self, channel: int) -> tuple[Channel, Station]:
        if channel not in self.stations:
            raise NcsError(NcsCode.NO_CHANNEL)
        if self.image.channels[channel].sav == Sav.RESET:
            raise NcsError(NcsCode.IN_RESET)
        return self.image.channels[channel], self.stations[channel]

    def _select_program(
        self, shown: Channel, station: Station, path: str, start: str, end: str, how: Selection
    ) -> Iterator[None]:
        if shown.mode not in _PROGRAM_MODES:
            raise NcsError(NcsCode.WRONG_MODE)
        if not 0 < len(path) <= LONGEST_PATH:
            raise NcsError(NcsCode.UNKNOWN_SYNTAX)
        self._make_room(shown, station, how, NcsCode.CANNOT_SELECT)
        text = self.programs.get(path)
        job = station.job = Job(path, None if text is None else text.splitlines(), start=start, end=end)
        shown.program = path
        shown.sav = Sav.PREPARING
        if Selection.LINK in how:
            self.linked.add(path)
        if Selection.WHEN_READY in how:
            while station.job is job and shown.sav == Sav.PREPARING:
                yield
            if shown.sav == Sav.ERROR:
                raise NcsError(NcsCode.NO_SUCH_PROGRAM)

    def _select_blocks(
        self, client: object, shown: Channel, station: Station, text: str, how: Selection
    ) -> Iterator[None]:
        buffered = Selection.BUFFERED in how
        active = shown.sav in _BUSY and not (buffered and station.job is not None and station.job.buffered)
        at_once = Selection.START_AT_ONCE in how
        if at_once and active and Selection.EXIT_BEFORE not in how and Selection.REPLACE not in how:
            how |= Selection.MACHINE_FUNCTION
        if Selection.MACHINE_FUNCTION in how and at_once:
            _machine_function(self.image, station, text)
            return
        if shown.mode != Mode.MDI:
            raise NcsError(NcsCode.WRONG_MODE)
        if buffered:
            yield from self._write_buffer(client, shown, station, text, how)
        else:
            if len(text.encode("latin-1", "replace")) > LONGEST_BLOCK:
                raise NcsError(NcsCode.UNKNOWN_SYNTAX)
            if at_once and read_block(text) is None:
                raise NcsError(NcsCode.BLOCK_ERROR)
            self._make_room(shown, station, how, NcsCode.OCCUPIED)
            station.job = Job("", [text], manual=True)
            shown.sav = Sav.AT_START
        if at_once and station.job is not None and shown.sav in _CAN_START:
            self._start(shown, station, station.job)

    def _write_buffer(
        self, client: object, shown: Channel, station: Station, text: str, how: Selection
    ) -> Iterator[None]:
        if (
            station.job is None
            or not station.job.buffered
            or how & (Selection.REPLACE | Selection.EXIT_BEFORE)
        ):
            self._make_room(shown, station, how, NcsCode.OCCUPIED)
        kept = station.job
        waiting = 0 if kept is None else sum(len(block) + 1 for block in (kept.blocks or [])[kept.at :])
        if waiting + len(text.encode("latin-1", "replace")) > BUFFER_SIZE:
            raise NcsError(NcsCode.BUFFER_FULL)
        station.writer = client
        yield  # one cycle long, in which others may come
        if station.writer is not client:
            raise NcsError(NcsCode.BUFFER_INTERRUPTED)
        station.writer = None
        blocks = text.split("\n")
        if station.job is None:
            station.job = Job("", blocks, manual=True, buffered=True)
            shown.sav = Sav.AT_START
            return
        station.job.extend(blocks)
        if shown.sav == Sav.BUFFER_EMPTY:
            shown.sav, shown.ipo = Sav.ACTIVE, Ipo.RUNNING

    def _make_room(self, shown: Channel, station: Station, how: Selection, refusal: NcsCode) -> None:
        if station.job is None and shown.sav != Sav.ERROR:
            return
        if Selection.EXIT_BEFORE in how:
            self._exit(shown, station, reselect=False)
        elif Selection.REPLACE in how:
            station.job = None
            shown.ipo = Ipo.STOPPED
        else:
            raise NcsError(refusal)

    def _start(self, shown: Channel, station: Station, job: Job) -> None:
        if job.name and job.name not in self.linked and holds_cpl(self.programs[job.name].encode()):
            station.errors.append(f"{job.name}: no link table")
            shown.sav = Sav.ERROR
            return
        job.started = True
        shown.sav, shown.ipo = Sav.ACTIVE, Ipo.RUNNING
        shown.other_waits &= ~Wait.PROGRAM_STOP

    def _exit(self, shown: Channel, station: Station, *, reselect: bool) -> None:
        job = station.job
        again = (
            reselect and shown.reselection and job is not None and not job.manual and job.blocks is not None
        )
        self._runner.leave(shown, modal=True)
        station.job = Job(job.name, job.blocks) if again and job is not None else None
        shown.program = job.name if again and job is not None else ""
        shown.sav = Sav.AT_START if again else Sav.INACTIVE

    def _pass(self, shown: Channel, station: Station) -> None:
        job = station.job
        if shown.sav == Sav.RESET:
            self._exit(shown, station, reselect=station.reselects)
            station.errors.clear()
            station.adopted |= station.changed
            station.changed.clear()
            station.reset_executed = True
        elif shown.sav == Sav.PREPARING and job is not None:
            if job.blocks is None:
                station.errors.append(f"{job.name}: no such program")
                shown.sav = Sav.ERROR
            else:
                shown.sav = Sav.AT_START
                if job.start or job.end:
                    _search(job, job.start, job.end, quiet=True)
        elif shown.sav == Sav.CANCELLING and job is not None:
            self._runner.cancel(shown, job)
        elif shown.ipo == Ipo.RUNNING_DOWN:
            shown.ipo = Ipo.STOPPED
        elif shown.sav == Sav.ACTIVE and shown.ipo == Ipo.RUNNING and job is not None:
            self._run(shown, station, job)

    def _run(self, shown: Channel, station: Station, job: Job) -> None:
        if (wrong := self._runner.cycle(shown, job)) is not None:
            station.errors.append(wrong)
            shown.sav, shown.ipo = Sav.ERROR, Ipo.STOPPED
        elif job.over and job.buffered:
            shown.sav, shown.ipo = Sav.BUFFER_EMPTY, Ipo.STOPPED
        elif job.over:
            self._exit(shown, station, reselect=True)


def _machine_function(image: Image, station: Station, text: str) -> None:
    words = read_block(text)
    alone = {axis.name: axis for axis in image.feed_axes() if axis.channel is None}
    moves = [] if words is None else [word for word in words.values if word[0] in alone]
    if words is None or any(name[0] not in "MSTHF" and name not in alone for name, _ in words.values):
        raise NcsError(NcsCode.BLOCK_ERROR)
    for name, value in moves:
        alone[name].setpoint = alone[name].actual = value
    station.functions.append(text)


def _search(job: Job, start: str, end: str, *, quiet: bool = False) -> None:
    blocks = job.blocks or []
    first = find_block(blocks, start) if start else 0
    last = find_block(blocks, end, first or 0) if end else len(blocks) - 1
    job.at = first or 0
    job.last = len(blocks) - 1 if last is None else last
    job.throw_away()
    if not quiet and None in (first, last):
        raise NcsError(NcsCode.NOT_FOUND)
