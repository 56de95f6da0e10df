"""How a partner control executes blocks: prepared ahead, each in a fixed number of cycles."""

from __future__ import annotations

from dataclasses import dataclass, field

from polycnc.controllers.bosch.ncs._blocks import Words, read_block
from polycnc.controllers.bosch.ncs._image import Channel, Coordinate, Image, Ipo, Mode, Sav, Wait

DEPTH = 3
"""How many blocks are prepared ahead."""
_ONE_BY_ONE = (Mode.PROGRAM_BLOCK, Mode.SINGLE_STEP, Mode.SINGLE_BLOCK, Mode.DEBUG_BLOCK)


@dataclass(slots=True)
class Prepared:
    """A block ready to be executed: its words, and for each axis word the end with the shifts of that moment."""

    words: Words
    ends: dict[str, tuple[float, float]]


@dataclass(slots=True)
class Job:
    """Blocks to be executed; `at` is the next one to prepare, `last` the last of them (None: all).

    `frozen` are blocks as they were when they were prepared first: computed values stay what they were then.
    """

    name: str
    blocks: list[str] | None
    manual: bool = False
    buffered: bool = False
    start: str = ""
    end: str = ""
    at: int = 0
    last: int | None = None
    started: bool = False
    over: bool = False
    prepared: list[Prepared] = field(default_factory=list)
    current: Prepared | None = None
    done_cycles: int = 0
    frozen: dict[int, str] = field(default_factory=dict)

    def extend(self, blocks: list[str]) -> None:
        """Put blocks after those that wait."""
        self.blocks = [*(self.blocks or []), *blocks]
        self.over = False

    def throw_away(self) -> int:
        """Throw away what is prepared and return how many blocks that were."""
        number = len(self.prepared) + (self.current is not None)
        self.prepared.clear()
        self.current = None
        self.done_cycles = 0
        return number


class Runner:
    """The execution of jobs on the channels of an image."""

    def __init__(self, image: Image, block_cycles: int) -> None:
        self._image = image
        self._block_cycles = block_cycles

    def cycle(self, shown: Channel, job: Job) -> str | None:
        """Execute one cycle of a job; return what is wrong with a block, else None."""
        while len(job.prepared) < DEPTH and job.at < self._stop(job):
            text = job.frozen.setdefault(job.at, (job.blocks or [])[job.at])
            words = read_block(text)
            if words is None:
                return f"{job.name or 'manual block'}:{job.at + 1}: {text}"
            job.prepared.append(Prepared(words, self._ends(shown, words)))
            job.at += 1
        if job.current is None:
            if not job.prepared:
                job.over = True
                return None
            self._begin(shown, job)
        self._move(shown, job)
        return None

    def cancel(self, shown: Channel, job: Job) -> None:
        """End a cancelled block where the axes are; all prepared ones are prepared anew, with new shifts."""
        job.at -= job.throw_away()
        for coordinate in shown.coordinates:
            coordinate.end = coordinate.workpiece
            coordinate.end_shifted = coordinate.workpiece + self._shift(coordinate)
            coordinate.to_go = 0.0
        shown.sav, shown.ipo = Sav.READY, Ipo.STOPPED
        shown.dwell = False

    def leave(self, shown: Channel, *, modal: bool) -> None:
        """Stop what runs; with `modal` the power-up condition comes into force."""
        shown.ipo = Ipo.STOPPED
        shown.dwell = shown.auxiliary_waits = False
        shown.other_waits = Wait(0)
        for axis in self._image.channel_axes(shown.number):
            axis.travel = False
        if modal:
            shown.inch = shown.inch_at_power_up
            shown.programmed_feed = 0.0

    def _stop(self, job: Job) -> int:
        return len(job.blocks or []) if job.last is None else job.last + 1

    def _shift(self, coordinate: Coordinate) -> float:
        return sum(self._image.axes[number].shift for number in coordinate.axes[:1])

    def _ends(self, shown: Channel, words: Words) -> dict[str, tuple[float, float]]:
        names = {each.name: each for each in shown.coordinates}
        return {
            name: (value, value + self._shift(names[name])) for name, value in words.values if name in names
        }

    def _begin(self, shown: Channel, job: Job) -> None:
        block = job.current = job.prepared.pop(0)
        job.done_cycles = 0
        shown.blocks += 1
        if block.words.message is not None:
            shown.message = block.words.message
        for name, value in block.words.values:
            if name == "F":
                shown.programmed_feed = value
            elif name == "G" and value in (70, 71):
                shown.inch = value == 70
        shown.dwell = block.words.has("G", 4)
        for coordinate in shown.coordinates:
            if coordinate.name in block.ends:
                coordinate.end, coordinate.end_shifted = block.ends[coordinate.name]
                for number in coordinate.axes[:1]:
                    self._image.axes[number].end = coordinate.end

    def _move(self, shown: Channel, job: Job) -> None:
        block = job.current
        assert block is not None
        left = self._block_cycles - job.done_cycles
        job.done_cycles += 1
        for coordinate in shown.coordinates:
            if coordinate.name not in block.ends:
                continue
            step = (coordinate.end - coordinate.workpiece) / left
            coordinate.workpiece += step
            coordinate.to_go = coordinate.end - coordinate.workpiece
            for number in coordinate.axes[:1]:
                axis = self._image.axes[number]
                axis.setpoint = axis.actual = (
                    coordinate.workpiece + block.ends[coordinate.name][1] - coordinate.end
                )
                axis.travel = left > 1
        if left > 1:
            return
        shown.dwell = False
        job.current = None
        stop = block.words.has("M", 0) or (block.words.has("M", 1) and shown.optional_stop[1])
        if block.words.has("M", 2, 30):
            job.over = True
        elif stop or shown.mode in _ONE_BY_ONE:
            shown.sav, shown.ipo = Sav.READY, Ipo.STOPPED
            if stop:
                shown.other_waits |= Wait.PROGRAM_STOP
        elif not job.prepared and job.at >= self._stop(job):
            job.over = True
