"""What a path has yet to come to: events by number, those of a run of plain blocks as columns."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from polycnc.nc.blocks._moves import Stop
from polycnc.nc.blocks._words import code_text
from polycnc.nc.records._block_records import LINE_MASK

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that the path has come to: an auxiliary function by its words, or a point where it may stand.

    `line` and `tag` are the block's line and the reference of its record. `default_s` is what the machine file says
    that the function takes, where the queue does not wait for it (`QueueWriter.answers`). `message` is what the
    operator is shown there. Preparation continues after a `barrier` when it has been answered.
    """

    word: str
    line: int
    stop: Stop | None = None
    default_s: float = 0.0
    tag: int = field(default=0, compare=False)
    message: str = ""
    barrier: bool = False

    @property
    def passes(self) -> bool:
        """Whether the path may go on before anybody has looked at it."""
        return self.stop is None and not self.barrier


def function_word(speed: float, code: float) -> str:
    """Return what S and an M code, negative where there is none, are reported as."""
    said = (f"M{code:.0f}" if code >= 0.0 else "", f"S{code_text(speed)}" if speed >= 0.0 else "")
    return " ".join(filter(None, said))


def output_word(value: float, code: float, number: float) -> str:
    """Return what the output of an M code is reported as: P, or the number E and its value Q."""
    words = f"E{number:.0f} Q{code_text(value)}" if number >= 0.0 else f"P{value:.0f}"
    return f"M{code:.0f} {words}"


def run_word(value: float, code: float, number: float) -> str:
    """Return what an event of a run is reported as, see `EventRun`."""
    return function_word(value, code) if number == FUNCTION else output_word(value, code, number)


FUNCTION = -1.0


@dataclass(frozen=True, eq=False, slots=True)
class EventRun:
    """Hold the events of a run of plain blocks as columns: what S and M say, negative for nothing, and the tags.

    `number` is FUNCTION for these. Of an output it is the number E, and `speed` its value Q; below FUNCTION it has
    none, and `speed` is its P.
    """

    speed: Floats
    code: Floats
    number: Floats
    tag: npt.NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.tag)

    def word(self, at: int) -> str:
        """Return an event as it is reported."""
        return run_word(float(self.speed[at]), float(self.code[at]), float(self.number[at]))

    def part(self, first: int, after: int) -> EventRun:
        """Return some of the events."""
        here = slice(first, after)
        return EventRun(self.speed[here], self.code[here], self.number[here], self.tag[here])

    def __getitem__(self, at: int) -> Event:
        tag = int(self.tag[at])
        return Event(self.word(at), tag & LINE_MASK, tag=tag)


class PendingEvents:
    """Keep events by number until the path has come to them, which it does in their order."""

    def __init__(self) -> None:
        self._single: dict[int, Event] = {}
        self._runs: deque[tuple[int, EventRun]] = deque()  # with the number of their first event
        self._taken = 0  # events of runs before this number are no more pending

    def __setitem__(self, number: int, event: Event) -> None:
        self._single[number] = event

    def __getitem__(self, number: int) -> Event:
        if (event := self._single.get(number)) is not None:
            return event
        for first, run in self._runs:
            if max(first, self._taken) <= number < first + len(run):
                return run[number - first]
        raise KeyError(number)

    def add_run(self, first: int, run: EventRun) -> None:
        """Take the events of a run of plain blocks, whose numbers go on from `first`."""
        self._runs.append((first, run))

    def pop(self, number: int) -> Event:
        """Return an event that the path has come to, which is pending no more."""
        found = self.pop_some(number, 1)
        return found if isinstance(found, Event) else found[0]

    def pop_some(self, number: int, most: int) -> Event | EventRun:
        """Return the event of a number, or up to `most` events of a run of plain blocks from it on, pending no more."""
        event = self._single.pop(number, None)
        if event is not None:
            return event
        while self._runs and self._runs[0][0] + len(self._runs[0][1]) <= number:
            self._runs.popleft()
        first, run = self._runs[0] if self._runs else (number + 1, None)
        if run is None or number < max(first, self._taken):
            raise KeyError(number)
        found = run.part(number - first, number - first + most)
        self._taken = number + len(found)
        return found

    def m_codes(self, numbers: npt.NDArray[np.int64]) -> Floats:
        """Return the M codes of events of runs of plain blocks, negative for S alone; NaN for all others."""
        found = np.full(len(numbers), np.nan)
        for first, run in self._runs:
            here = (numbers >= first) & (numbers < first + len(run))
            found[here] = run.code[numbers[here] - first]
        return found

    def values(self) -> list[Event]:
        """Return what is pending, in the order in which the path comes to it."""
        return [event for _, event in sorted(self._numbered(), key=lambda each: each[0])]

    def tags(self) -> list[int]:
        """Return the tags of what is pending; of those that have one context one is enough."""
        runs = (tag for _, run in self._runs for tag in run.tag[-1:].tolist())
        return [*(event.tag for event in self._single.values()), *runs]

    def clear(self) -> None:
        """Forget everything."""
        self._single.clear()
        self._forget_runs()

    def snapshot(self) -> dict[int, Event]:
        """Return what is pending by number, to go back to."""
        return dict(self._numbered())

    def restore(self, saved: dict[int, Event]) -> None:
        """Go back to a snapshot."""
        self._forget_runs()
        self._single = dict(saved)

    def _forget_runs(self) -> None:
        self._runs.clear()
        self._taken = 0

    def _numbered(self) -> Iterator[tuple[int, Event]]:
        yield from self._single.items()
        for first, run in self._runs:
            for at in range(max(self._taken - first, 0), len(run)):
                yield first + at, run[at]
