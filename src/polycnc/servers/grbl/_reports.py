"""What a grbl reports: its state, positions, modal words, parameters and settings, as lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from polycnc.cnc import Status
from polycnc.nc import Group, ModalWords
from polycnc.servers.grbl._settings import REPORT_INCHES, REPORT_MASK, GrblSettings

VERSION = "1.1h"
WELCOME = f"Grbl {VERSION} ['$' for help]"
HELP = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]"
PLANNER_BLOCKS = 15
MM_PER_INCH = 25.4
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59")

_OVERRIDES_BUSY, _OVERRIDES_IDLE = 20, 10
_OFFSETS_BUSY, _OFFSETS_IDLE = 30, 10
_IDLE_STATES = ("Idle", "Alarm", "Check", "Sleep")
_SHOWN = (
    Group.MOTION, Group.WORK_OFFSET, Group.PLANE, Group.UNITS, Group.DISTANCE, Group.FEED_MODE,
)  # fmt: skip
_SPINDLE = {1: "M3", -1: "M4", 0: "M5"}


class Units:
    """Write lengths and rates as $13 says: mm with three decimals, or inches with four."""

    def __init__(self, settings: GrblSettings) -> None:
        self._settings = settings

    def lengths(self, values: Iterable[float]) -> str:
        """Return lengths in mm as reports have them."""
        if self._settings.flag(REPORT_INCHES):
            return ",".join(f"{value / MM_PER_INCH + 0.0:.4f}" for value in values)
        return ",".join(f"{round(value, 3) + 0.0:.3f}" for value in values)

    def rate(self, value: float) -> str:
        """Return a rate in mm/min."""
        return f"{value / MM_PER_INCH:.1f}" if self._settings.flag(REPORT_INCHES) else f"{value:.0f}"


@dataclass(frozen=True, slots=True)
class Probed:
    """Where the probe met something last (machine coordinates, mm), and whether it did."""

    position: tuple[float, ...]
    met: bool = False


class StatusReport:
    """Write `<...>`: offsets and overrides come with the first reports, when they change, and now and then."""

    def __init__(self, settings: GrblSettings, units: Units) -> None:
        self._settings = settings
        self._units = units
        self.begin()

    def begin(self) -> None:
        """Report offsets and overrides anew."""
        self._until_offsets = self._until_overrides = 0
        self._offsets: Sequence[float] = ()
        self._overrides: tuple[int, ...] = ()

    def text(
        self,
        state: str,
        status: Status,
        zero: Sequence[float],
        free: int,
        queued: int,
        accessories: str,
        pins: str,
    ) -> str:
        """Return the report; `zero` is program zero in machine coordinates."""
        names = self._settings.names
        machine = [status.axes[name].machine for name in names]
        mask = int(self._settings[REPORT_MASK])
        if mask & 1:
            parts = [state, "MPos:" + self._units.lengths(machine)]
        else:
            work = [at - begin for at, begin in zip(machine, zero, strict=True)]
            parts = [state, "WPos:" + self._units.lengths(work)]
        if mask & 2:
            parts.append(f"Bf:{max(0, PLANNER_BLOCKS - queued)},{free}")
        idle = state.split(":")[0] in _IDLE_STATES
        # A machine that stands has no feed, not even in the very cycle in which a motion ended.
        feed = 0.0 if idle else status.channel.feed.actual
        parts.append(f"FS:{self._units.rate(feed)},{abs(status.spindle.actual_rpm):.0f}")
        if pins:
            parts.append("Pn:" + pins)
        parts += self._seldom(idle, status, zero, accessories)
        return "<" + "|".join(parts) + ">"

    def _seldom(self, idle: bool, status: Status, zero: Sequence[float], accessories: str) -> list[str]:
        each = status.channel.overrides
        overrides = tuple(round(100 * factor) for factor in (each.feed, each.rapid, each.spindle))
        if tuple(zero) != self._offsets:
            self._until_offsets = 0
        if overrides != self._overrides:
            self._until_overrides = 0
        if self._until_offsets <= 0:
            self._until_offsets = _OFFSETS_IDLE if idle else _OFFSETS_BUSY
            self._offsets = tuple(zero)
            self._until_overrides = max(1, self._until_overrides)
            return ["WCO:" + self._units.lengths(zero)]
        self._until_offsets -= 1
        self._until_overrides -= 1
        if self._until_overrides > 0:
            return []
        self._until_overrides = _OVERRIDES_IDLE if idle else _OVERRIDES_BUSY
        self._overrides = overrides
        return ["Ov:" + ",".join(map(str, overrides)), *(["A:" + accessories] if accessories else [])]


def modal_report(modal: ModalWords, coolant: frozenset[str], units: Units) -> str:
    """Return `[GC:...]`."""
    words = [modal.g[group] for group in _SHOWN if group in modal.g]
    if Group.MOTION not in modal.g:
        words.insert(0, "G80")
    words += [_SPINDLE[modal.spindle_direction], *(sorted(coolant) or ["M9"])]
    feed_mm = modal.feed * (MM_PER_INCH if modal.inch else 1.0)
    words += [f"T{modal.next_tool or modal.tool}", f"F{units.rate(feed_mm)}", f"S{modal.speed:.0f}"]
    return f"[GC:{' '.join(words)}]"
