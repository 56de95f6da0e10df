"""How fast a path goes, against what is programmed: overrides of feed and rapid, dry run."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from polycnc.errors import UsageError
from polycnc.machine import LEAST_OVERRIDE


class PathOverrides:
    """Hold the overrides in the row of a path; `replan` lets the path take over what has changed.

    `dry_run_mm_s` is the feed of a dry run, 0 without one, `rapid_f0_mm_s` the lowest speed of rapids, 0 to stand,
    `most_feed` the largest factor of the feeds.
    While a program suppresses the feed override, `kept` is what acts again after it.
    """

    def __init__(
        self,
        row: np.void,
        replan: Callable[[], None],
        *,
        dry_run_mm_s: float,
        rapid_f0_mm_s: float,
        most_feed: float,
    ) -> None:
        self._row = row
        self._replan = replan
        self._dry_run_mm_s = dry_run_mm_s
        self._rapid_f0_mm_s = rapid_f0_mm_s
        self._most_feed = most_feed
        self.kept: float | None = None

    @property
    def feed(self) -> float:
        """Factor of the programmed feeds, 0 to the largest."""
        return float(self._row["override"]) if self.kept is None else self.kept

    @feed.setter
    def feed(self, factor: float) -> None:
        _check_factor(factor, self._most_feed, "the feed override")
        if self.kept is not None:
            self.kept = factor
        elif factor != self._row["override"]:
            self._row["override"] = factor
            self._replan()

    def suppress_feed(self, on: bool) -> None:
        """Let the feed override act no more, or again."""
        if on is (self.kept is not None):
            return
        factor, self.kept = (1.0, self.feed) if on else (self.feed, None)
        self._row["override"] = factor
        self._replan()

    @property
    def rapid(self) -> float:
        """Factor of positioning speeds, 0 to 1; 0 is the lowest speed (F0)."""
        return 0.0 if self._row["rapid_top"] < math.inf else float(self._row["rapid_override"])

    @rapid.setter
    def rapid(self, factor: float) -> None:
        _check_factor(factor, 1.0, "the rapid override")
        slow = factor == 0.0 and self._rapid_f0_mm_s > 0.0
        wanted = 1.0 if slow else factor, self._rapid_f0_mm_s if slow else math.inf
        if wanted != (self._row["rapid_override"], self._row["rapid_top"]):
            self._row["rapid_override"], self._row["rapid_top"] = wanted
            self._replan()

    @property
    def dry_run(self) -> bool:
        """Whether moves at feed go with the feed of a dry run."""
        return bool(self._row["dry_feed_mm_s"] > 0.0)

    @dry_run.setter
    def dry_run(self, on: bool) -> None:
        if on and not self._dry_run_mm_s > 0.0:
            raise UsageError("there is no feed for a dry run", hint="Give `dry_run_mm_s` in the options.")
        if on is not self.dry_run:
            self._row["dry_feed_mm_s"] = self._dry_run_mm_s if on else 0.0
            self._replan()


def _check_factor(factor: float, highest: float, what: str) -> None:
    if not (factor == 0.0 or LEAST_OVERRIDE <= factor <= highest):
        hint = f"Give 0, or a factor from {LEAST_OVERRIDE:g} to {highest:g}."
        raise UsageError(f"{what} cannot be {factor:g}", hint=hint)
