"""Observations in a ring: what changed, numbered without a gap, and the state at any number that is still held."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from typing import NamedTuple, TypeAlias

from polycnc.servers.mtconnect._device import Item

NORMAL, WARNING, FAULT, UNAVAILABLE = "NORMAL", "WARNING", "FAULT", "UNAVAILABLE"


class Observation(NamedTuple):
    """A value that came at a time of its machine (ISO, UTC).

    Of a condition `value` is its level and `text` what it says; `code` is the control's number, `key` tells one trouble
    from another, "" for all of them. Of a message `code` is its number. `kind` is the type of an asset.
    """

    sequence: int
    item: Item
    time: str
    value: str
    code: str = ""
    key: str = ""
    text: str = ""
    qualifier: str = ""
    kind: str = ""


State: TypeAlias = dict[Item, tuple[Observation, ...]]
"""What holds: of each item its last observation, of a condition one for each trouble that is on."""


def apply(state: State, seen: Observation) -> None:
    """Let an observation hold."""
    item = seen.item
    if item.about is None or not seen.key:
        state[item] = (seen,)
        return
    others = tuple(
        each
        for each in state.get(item, ())
        if each.key != seen.key and each.value not in (NORMAL, UNAVAILABLE)
    )
    state[item] = others if seen.value == NORMAL else (*others, seen)


class Buffer:
    """Hold the last `size` observations, and what held before them.

    The first observation has the number 1; `first` and `last` are held, `next` is the number of the next one.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self._held: deque[Observation] = deque()
        self._before: State = {}
        self._now: State = {}
        self.next = 1

    @property
    def first(self) -> int:
        """The number of the oldest observation that is held."""
        return self.next - len(self._held)

    @property
    def last(self) -> int:
        """The number of the newest observation."""
        return self.next - 1

    def add(self, item: Item, time: str, value: str, *more: str) -> Observation:
        """Hold an observation, in place of the oldest if there is no more room; `more` are its other fields."""
        seen = Observation(self.next, item, time, value, *more)
        self.next += 1
        if len(self._held) == self.size:
            apply(self._before, self._held.popleft())
        self._held.append(seen)
        apply(self._now, seen)
        return seen

    def now(self) -> Mapping[Item, tuple[Observation, ...]]:
        """Return what holds now."""
        return self._now

    def at(self, sequence: int) -> Mapping[Item, tuple[Observation, ...]]:
        """Return what held when the observation of this number, from `first` to `last`, had come."""
        state = dict(self._before)
        for seen in islice(self._held, sequence - self.first + 1):
            apply(state, seen)
        return state

    def sample(
        self, start: int | None, count: int, wanted: Callable[[Item], bool]
    ) -> tuple[list[Observation], int]:
        """Return up to |count| observations in their order, and the number with which to go on.

        They go up from `start` (None: the first that is held), with a negative `count` down from it (None: the last).
        """
        if count >= 0:
            begin = self.first if start is None else start
            return self._run(islice(self._held, begin - self.first, None), count, wanted, self.next)
        begin = self.last if start is None else min(start, self.last)
        downward = islice(reversed(self._held), self.last - begin, None)
        found, end = self._run(downward, -count, wanted, self.first - 1)
        return found[::-1], max(1, end)

    @staticmethod
    def _run(
        run: Iterator[Observation], most: int, wanted: Callable[[Item], bool], end: int
    ) -> tuple[list[Observation], int]:
        found: list[Observation] = []
        for seen in run:
            if len(found) == most:
                return found, seen.sequence
            if wanted(seen.item):
                found.append(seen)
        return found, end
