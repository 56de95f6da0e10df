"""What a probe has found."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Probe:
    """Hold the last probing move: `position` is where the axes stood at the contact, None without one.

    Positions are machine coordinates (mm, degree). `axes` are those that were measured, `in_passing` tells that the
    move went on. A move that `leaves` ends where the probe comes free. Where the program is to be told (`code`, the
    code at byte `place`), `missed` is set when the move has ended without what it was for, `at_once` when it could
    not begin; `needed` makes an error of a miss too.
    """

    axes: frozenset[int]
    in_passing: bool = False
    position: tuple[float, ...] | None = None
    leaves: bool = False
    code: str = ""
    place: int = 0
    needed: bool = False
    missed: bool = False
    at_once: bool = False

    @property
    def problem(self) -> tuple[str, str] | None:
        """What is wrong with the move, and what to do; None if nothing is."""
        if self.at_once:
            if self.leaves:
                return f"G{self.code}: the probe is free already", "Probe towards the workpiece first."
            return f"G{self.code}: the probe is in contact already", "Go away from the workpiece first."
        if self.missed and self.needed:
            what = "the probe does not come free" if self.leaves else "the probe meets nothing"
            return (
                f"G{self.code}: {what}",
                "Go further, or describe the workpiece in the machine file ([[surface]]).",
            )
        return None
