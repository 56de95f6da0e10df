"""What a probe has found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Probe:
    """Hold the last probing move: `position` is where the axes stood at the contact, None without one.

    Positions are machine coordinates (mm, degree). `axes` are those that were measured, `in_passing` tells that the
    move went on.
    """

    axes: frozenset[int]
    in_passing: bool = False
    position: tuple[float, ...] | None = None
