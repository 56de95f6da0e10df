"""How long a control has been on, has run, has cut, per tool as well, and how many parts it has made."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.errors import shown
from polycnc.machine import Clock, Store
from polycnc.units import is_finite

_TIMERS = "cnc.timers"
_TOOLS = "cnc.tool_times"
_PARTS = "cnc.parts"
MOST_PARTS = 999_999_999


class Timer(StrEnum):
    """The timers of a control."""

    POWER_ON = "power_on"
    OPERATING = "operating"  # a program runs, holds and stops apart
    CUTTING = "cutting"  # a feed motion runs
    CYCLE = "cycle"  # as operating, since the last start of a program from its beginning


@dataclass(frozen=True, slots=True)
class TimersState:
    """Everything that timers hold, to go back to."""

    base_s: dict[Timer, float]
    cycles: dict[Timer, int]
    tool_s: dict[int, float]
    saved_cycle: int
    cut: tuple[float, float, int] = (0.0, 0.0, 0)


class Timers:
    """Count times; they are saved every `save_every_s` of machine time, and by `save`.

    A killed process loses at most what it counted since then.
    """

    def __init__(self, store: Store, clock: Clock, *, save_every_s: float = 60.0) -> None:
        self._store = store
        self._clock = clock
        self._save_cycles = max(1, clock.cycles_for(save_every_s))
        self._area = store.area(_TIMERS, float)
        self._tool_area = store.area(_TOOLS, float)
        kept = self._area.load()
        self._base_s = {timer: kept.get(timer.value, 0.0) for timer in Timer}
        self._cycles = dict.fromkeys(Timer, 0)
        self._tool_s = {int(tool): time_s for tool, time_s in self._tool_area.load().items()}
        self._saved_cycle = clock.cycles
        self._cut_s = self._cut_before_s = 0.0  # what paths have cut, in all and when this tool came
        self._tool = 0

    def count(
        self, cycles: int, *, operating: bool = False, cut_s: float | None = None, tool: int = 0
    ) -> None:
        """Let cycles pass, by whose end paths have cut for `cut_s` in all, with a tool (0 none)."""
        self._clock.changes += 1
        self._cycles[Timer.POWER_ON] += cycles
        if operating:
            self._cycles[Timer.OPERATING] += cycles
            self._cycles[Timer.CYCLE] += cycles
        if tool != self._tool:
            self._fold()
            self._tool = tool
        if cut_s is not None:
            self._cut_s = cut_s
        if self._clock.cycles - self._saved_cycle >= self._save_cycles:
            self.save()

    @property
    def _newly_cut_s(self) -> float:
        """How long the present tool has cut; a difference, so that it does not matter how often it is counted."""
        return self._cut_s - self._cut_before_s

    def _fold(self) -> None:
        """Add what the present tool has cut to what is counted."""
        self._base_s[Timer.CUTTING] = self.seconds(Timer.CUTTING)
        if self._tool in self.tools:
            self._tool_s[self._tool] = self.tool_seconds(self._tool)
        self._cut_before_s = self._cut_s

    def seconds(self, timer: Timer) -> float:
        """Return what a timer shows (s)."""
        counted_s = self._base_s[timer] + self._cycles[timer] * self._clock.cycle_s
        return counted_s + self._newly_cut_s if timer is Timer.CUTTING else counted_s

    def shown_s(self) -> dict[Timer, float]:
        """Return what all timers show (s)."""
        return {timer: self.seconds(timer) for timer in Timer}

    def tool_seconds(self, tool: int) -> float:
        """Return how long a tool has cut (s)."""
        return self._tool_s.get(tool, 0.0) + (self._newly_cut_s if tool == self._tool else 0.0)

    @property
    def tools(self) -> tuple[int, ...]:
        """The tools that have cut, or whose time was set."""
        cuts = {self._tool} if self._tool and self._newly_cut_s > 0.0 else set()
        return tuple(sorted(cuts | set(self._tool_s)))

    def set_seconds(self, timer: Timer, time_s: float) -> None:
        """Set a timer (s), durably.

        Raises:
            ControlError: A time that is negative or not finite.
        """
        checked_s = _checked_s(time_s)
        self._fold()
        self._base_s[timer] = checked_s
        self._cycles[timer] = 0
        self._clock.changes += 1
        self.save()

    def set_tool_seconds(self, tool: int, time_s: float) -> None:
        """Set the time of a tool (s), durably.

        Raises:
            ControlError: A tool number below 1, or a time that is negative or not finite.
        """
        if tool < 1:
            raise ControlError(Refusal.DATA, f"there is no tool {tool}", hint="Tool numbers start at 1.")
        checked_s = _checked_s(time_s)
        self._fold()
        self._tool_s[tool] = checked_s
        self.save()

    def start_cycle(self) -> None:
        """Begin to count the cycle time anew."""
        self._base_s[Timer.CYCLE] = 0.0
        self._cycles[Timer.CYCLE] = 0
        self._clock.changes += 1

    def save(self) -> None:
        """Make everything counted durable."""
        with self._store.transaction():
            self._area.save({timer.value: self.seconds(timer) for timer in Timer})
            self._tool_area.save({tool: self.tool_seconds(tool) for tool in self.tools})
        self._saved_cycle = self._clock.cycles

    def snapshot(self) -> TimersState:
        """Return what the timers show, to go back to; what is durable stays until the next `save`."""
        return TimersState(
            dict(self._base_s),
            dict(self._cycles),
            dict(self._tool_s),
            self._saved_cycle,
            (self._cut_s, self._cut_before_s, self._tool),
        )

    def restore(self, state: TimersState) -> None:
        """Go back to a snapshot."""
        self._clock.changes += 1
        self._base_s = dict(state.base_s)
        self._cycles = dict(state.cycles)
        self._tool_s = dict(state.tool_s)
        self._saved_cycle = state.saved_cycle
        self._cut_s, self._cut_before_s, self._tool = state.cut


@dataclass(frozen=True, slots=True)
class Parts:
    """How many parts were made in this lot and in all, and how many the lot shall have (0: no number set)."""

    made: int = 0
    required: int = 0
    total: int = 0

    @property
    def reached(self) -> bool:
        """Whether the lot is complete."""
        return 0 < self.required <= self.made


class PartCounter:
    """Count parts, durably with each one."""

    def __init__(self, store: Store) -> None:
        self._area = store.area(_PARTS, int)
        kept = self._area.load()
        self.parts = Parts(*(kept.get(name, 0) for name in ("made", "required", "total")))
        """The counts."""

    def count(self) -> None:
        """Count one part; at the largest number it stays there."""
        made, total = min(self.parts.made + 1, MOST_PARTS), min(self.parts.total + 1, MOST_PARTS)
        self._keep(Parts(made, self.parts.required, total))

    def set(self, *, made: int | None = None, required: int | None = None, total: int | None = None) -> None:
        """Set counts; what is None stays.

        Raises:
            ControlError: A count below 0 or above 999 999 999.
        """
        now = self.parts
        wanted = Parts(
            now.made if made is None else made,
            now.required if required is None else required,
            now.total if total is None else total,
        )
        for value in (wanted.made, wanted.required, wanted.total):
            if not 0 <= value <= MOST_PARTS:
                raise ControlError(
                    Refusal.DATA, f"{value} is not a number of parts", hint=f"Give 0 to {MOST_PARTS}."
                )
        self._keep(wanted)

    def restore(self, parts: Parts) -> None:
        """Go back to earlier counts, durably."""
        self._keep(parts)

    def _keep(self, parts: Parts) -> None:
        self._area.save({"made": parts.made, "required": parts.required, "total": parts.total})
        self.parts = parts


def _checked_s(time_s: float) -> float:
    if not (is_finite(time_s) and time_s >= 0.0):
        raise ControlError(
            Refusal.DATA, f"a timer cannot show {shown(time_s)} s", hint="Give a time from 0 s."
        )
    return time_s
