"""Speed, acceleration and jerk of every axis over a record of any length: lowest and highest in equal stretches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

MOST_STRETCHES = 4_000
DERIVATIVES = ("speed", "acceleration", "jerk")


@dataclass(frozen=True)
class Motion:
    """Hold for stretches of `stretch_s` the lowest and highest derivatives [stretches, derivatives, axes].

    Units are those of the axes per s, s^2 and s^3. They are differences over one control cycle.
    """

    stretch_s: float
    low: Floats
    high: Floats


class MotionCollector:
    """Collect the derivatives while the record comes; memory does not grow with it."""

    def __init__(self, axes: int) -> None:
        self._axes = axes
        self._cycles = 1  # of a stretch
        self._lows: list[Floats] = []
        self._highs: list[Floats] = []
        self._held = 0
        self._rest = np.zeros((0, len(DERIVATIVES), axes))  # of the stretch that is not complete
        self._before: Floats | None = None  # the last positions
        self._cycle_s = 0.0

    def add(self, t_s: Floats, position: Floats) -> None:
        """Take the next rows."""
        if not len(t_s):
            return
        if self._before is None:
            self._cycle_s = float(t_s[0])
            # Where the axes came from is not known: as if they had come at the speed that they have.
            step = position[1:2] - position[:1] if len(position) > 1 else np.zeros((1, self._axes))
            self._before = position[:1] - step * np.arange(len(DERIVATIVES), 0, -1)[:, None]
        whole = np.concatenate((self._before, position))
        self._before = whole[-len(DERIVATIVES) :].copy()
        found = []
        for order in range(1, len(DERIVATIVES) + 1):
            difference = np.diff(whole, n=order, axis=0) / self._cycle_s**order
            found.append(difference[len(DERIVATIVES) - order :])
        self._take(np.concatenate((self._rest, np.stack(found, axis=1))))

    def motion(self) -> Motion:
        """Return what was collected."""
        empty = np.zeros((0, len(DERIVATIVES), self._axes))
        rest = [self._rest] if len(self._rest) else []
        low = np.concatenate([empty, *self._lows, *(each.min(axis=0, keepdims=True) for each in rest)])
        high = np.concatenate([empty, *self._highs, *(each.max(axis=0, keepdims=True) for each in rest)])
        return Motion(self._cycles * self._cycle_s, low, high)

    def _take(self, rows: Floats) -> None:
        whole = len(rows) // self._cycles
        if whole:
            stretches = rows[: whole * self._cycles].reshape(whole, self._cycles, *rows.shape[1:])
            self._lows.append(stretches.min(axis=1))
            self._highs.append(stretches.max(axis=1))
            self._held += whole
        self._rest = rows[whole * self._cycles :]
        while self._held > 2 * MOST_STRETCHES:
            self._merge()

    def _merge(self) -> None:
        """Make stretches twice as long; an odd one at the end counts as a long one, of what it has."""
        low, high = np.concatenate(self._lows), np.concatenate(self._highs)
        if len(low) % 2:  # it is looked at again with what follows
            rows = np.repeat(high[-1:], self._cycles, axis=0)
            rows[0] = low[-1]
            self._rest = np.concatenate((rows, self._rest))
            low, high = low[:-1], high[:-1]
        pairs = (len(low) // 2, 2, *low.shape[1:])
        self._lows = [low.reshape(pairs).min(axis=1)]
        self._highs = [high.reshape(pairs).max(axis=1)]
        self._held = len(low) // 2
        self._cycles *= 2
