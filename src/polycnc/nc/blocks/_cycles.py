"""Drilling cycles (G73, G81-G89) as a table: each cycle is a row of steps at one hole.

A cycle drills from the R level down to the depth, always in the negative direction of the drilling axis; one bores
from below.
Expansion is pure: words, place and settings go in, a list of steps comes out; the interpreter turns them into
moves. Sequences follow the public NIST RS274NGC description; where they differ is said in
docs/reference/drilling-cycles.md.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto
from typing import Literal, TypeAlias

from polycnc.errors import ProgramError
from polycnc.nc.dialect._cycle_settings import Cycles

# More pecks in one hole than this are a mistyped Q, not a hole.
MOST_PECKS = 100_000
# Levels that differ by less are one level (as pecks that add up to the depth are).
_SAME_LEVEL_MM = 1e-9

Spindle: TypeAlias = Literal["forward", "reverse", "stopped"]


class StepKind(Enum):
    """What a step of a cycle does, and which fields of the step it uses."""

    RAPID_PLANE = auto()  # rapid in the plane to `first_mm`, `second_mm`
    RAPID_AXIS = auto()  # rapid along the drilling axis to `level_mm`
    FEED_AXIS = auto()  # feed along the drilling axis to `level_mm`; `feed_mm_s`, `synchronous`
    DWELL = auto()  # wait `duration_s`
    SPINDLE_STOP = auto()
    SPINDLE_START = auto()  # turn as before the cycle, or as its thread asks
    SPINDLE_REVERSE = auto()  # turn the other way than before the cycle
    SPINDLE_ORIENT = auto()  # stop at the angle at which the tool can shift
    PROGRAM_STOP = auto()  # wait for the operator (M0)
    OVERRIDE_OFF = auto()  # feed and spindle override count as 100 %
    OVERRIDE_ON = auto()


@dataclass(frozen=True, slots=True)
class CycleStep:
    """One step. `feed_mm_s` 0 means the programmed feed; `synchronous` ties the feed to the spindle."""

    kind: StepKind
    first_mm: float = 0.0
    second_mm: float = 0.0
    level_mm: float = 0.0
    duration_s: float = 0.0
    feed_mm_s: float = 0.0
    synchronous: bool = False


@dataclass(frozen=True, slots=True)
class CycleWords:
    """The words of a cycle; None where a block does not program one.

    `depth_mm` Z, `retract_mm` R, `peck_mm` Q, `dwell_s` P, `shift_mm` I and J, `back_mm` K (G87),
    `pitch_mm` the thread (G84), `repeats` L or K: how many holes, 0 only stores the words.
    """

    depth_mm: float | None = None
    retract_mm: float | None = None
    peck_mm: float | None = None
    dwell_s: float | None = None
    shift_mm: tuple[float, float] | None = None
    back_mm: float | None = None
    pitch_mm: float | None = None
    repeats: int = 1

    def then(self, block: CycleWords) -> CycleWords:
        """Return these stored words with those of a later block; repeats hold for their own block only."""
        changed = {
            field.name: value
            for field in dataclasses.fields(block)
            if field.name != "repeats" and (value := getattr(block, field.name)) is not None
        }
        return dataclasses.replace(self, repeats=block.repeats, **changed)

    def absolute(self, initial_mm: float) -> CycleWords:
        """Return incremental words (G91) as levels: R counts from the initial level, Z from R, K from Z."""
        if self.retract_mm is None or self.depth_mm is None:
            return self  # the expansion names what is missing
        retract = initial_mm + self.retract_mm
        depth = retract + self.depth_mm
        back = None if self.back_mm is None else depth + self.back_mm
        return dataclasses.replace(self, retract_mm=retract, depth_mm=depth, back_mm=back)


@dataclass(frozen=True, slots=True)
class CyclePlace:
    """Where and how the machine stands when a cycle block starts.

    `hole_mm` is the first hole in the plane, `increment_mm` the way to each further one (G91 with repeats), unless
    `further_mm` says where they are.
    Levels are on the drilling axis: `initial_mm` before the first cycle block, `level_mm` now. `retract` is
    G98 (initial) or G99 (r). `rigid`: a tapping cycle turns the spindle itself, and leaves it at rest.
    `taps_either_way`: G84 taps a left-hand thread with M4.
    """

    hole_mm: tuple[float, float]
    initial_mm: float
    level_mm: float
    retract: Literal["initial", "r"] = "initial"
    increment_mm: tuple[float, float] = (0.0, 0.0)
    spindle: Spindle = "forward"
    spindle_rpm: float = 0.0
    rigid: bool = False
    further_mm: tuple[tuple[float, float], ...] = ()
    taps_either_way: bool = True


class CycleError(ProgramError):
    """A cycle that cannot be run with its words.

    `reason` is a stable key a dialect can map to its own alarm number.
    """

    def __init__(self, what: str, *, reason: str, hint: str = "") -> None:
        super().__init__(what, hint=hint)
        self.reason = reason


@dataclass(frozen=True, slots=True)
class _Hole:
    """One hole with every number settled."""

    first: float
    second: float
    shifted: tuple[float, float]
    bottom: float
    r: float
    initial: float
    out: float
    back: float
    peck: float
    dwell_s: float
    tap_feed_mm_s: float
    rigid: bool
    settings: Cycles

    @property
    def fed(self) -> float:
        """The level up to which a cycle that goes out at feed does so."""
        return self.out if self.settings.feeds_out else self.r


_Part: TypeAlias = Callable[[_Hole], Iterator[CycleStep]]


def _axis(kind: StepKind, level: str) -> _Part:
    """Return the part that moves along the drilling axis to the level of that name."""
    return lambda hole: iter((CycleStep(kind, level_mm=getattr(hole, level)),))


def _tap(hole: _Hole) -> Iterator[CycleStep]:
    """Tap to the depth, in pecks where there are any, and back to R or all the way out."""

    def to(level_mm: float) -> CycleStep:
        return CycleStep(
            StepKind.FEED_AXIS, level_mm=level_mm, feed_mm_s=hole.tap_feed_mm_s, synchronous=True
        )

    stop, start = CycleStep(StepKind.SPINDLE_STOP), CycleStep(StepKind.SPINDLE_START)
    reverse = CycleStep(StepKind.SPINDLE_REVERSE)
    yield CycleStep(StepKind.OVERRIDE_OFF)
    if hole.rigid:
        yield start
    for depth in _peck_depths(hole) if hole.peck > 0.0 else ():
        back = hole.r
        if hole.settings.peck_tap == "chip_break":
            back = min(depth + hole.settings.chip_break_mm, hole.r)
        yield from (to(depth), stop, reverse, to(back), stop, start)
    yield from (to(hole.bottom), stop, reverse)
    yield from _dwell(hole)
    yield from (to(hole.fed), stop)
    if not hole.rigid:
        yield start
    yield CycleStep(StepKind.OVERRIDE_ON)


def _always(*kinds: StepKind) -> _Part:
    steps = tuple(CycleStep(kind) for kind in kinds)
    return lambda hole: iter(steps)


def _shift(hole: _Hole) -> Iterator[CycleStep]:
    yield CycleStep(StepKind.RAPID_PLANE, *hole.shifted)


def _unshift(hole: _Hole) -> Iterator[CycleStep]:
    yield CycleStep(StepKind.RAPID_PLANE, hole.first, hole.second)


def _dwell(hole: _Hole) -> Iterator[CycleStep]:
    if hole.dwell_s > 0.0:
        yield CycleStep(StepKind.DWELL, duration_s=hole.dwell_s)


def _peck_depths(hole: _Hole) -> Iterator[float]:
    """Return the depths of all pecks but the last, each counted from R so that no rounding adds up."""
    for number in range(1, math.ceil((hole.r - hole.bottom - _SAME_LEVEL_MM) / hole.peck)):
        yield hole.r - number * hole.peck


def _pecks_to_r(hole: _Hole) -> Iterator[CycleStep]:
    for depth in _peck_depths(hole):
        yield CycleStep(StepKind.FEED_AXIS, level_mm=depth)
        yield CycleStep(StepKind.RAPID_AXIS, level_mm=hole.r)
        yield CycleStep(StepKind.RAPID_AXIS, level_mm=min(depth + hole.settings.reentry_mm, hole.r))


def _pecks_breaking_chips(hole: _Hole) -> Iterator[CycleStep]:
    for depth in _peck_depths(hole):
        yield CycleStep(StepKind.FEED_AXIS, level_mm=depth)
        yield CycleStep(StepKind.RAPID_AXIS, level_mm=min(depth + hole.settings.chip_break_mm, hole.r))


_FEED_IN = _axis(StepKind.FEED_AXIS, "bottom")
_FEED_R = _axis(StepKind.FEED_AXIS, "r")
_FEED_OUT = _axis(StepKind.FEED_AXIS, "fed")
_FEED_BACK = _axis(StepKind.FEED_AXIS, "back")
_RAPID_IN = _axis(StepKind.RAPID_AXIS, "bottom")
_OUT = _axis(StepKind.RAPID_AXIS, "out")
_STOP = _always(StepKind.SPINDLE_STOP)
_START = _always(StepKind.SPINDLE_START)
_ORIENT = _always(StepKind.SPINDLE_STOP, StepKind.SPINDLE_ORIENT)
_OPERATOR = _always(StepKind.PROGRAM_STOP)
_BORE_BACK = (
    *(_shift, _ORIENT, _RAPID_IN, _unshift, _START),
    *(_FEED_BACK, _FEED_IN, _ORIENT, _shift, _OUT, _unshift, _START),
)
# From below: R lies under the hole, Z above it; the way out is always to the initial level.
_BORE_UP = (
    *(_ORIENT, _shift, _axis(StepKind.RAPID_AXIS, "r"), _unshift, _START),
    *(_FEED_IN, _dwell, _ORIENT, _shift, _axis(StepKind.RAPID_AXIS, "initial"), _unshift, _START),
)


@dataclass(frozen=True, slots=True)
class _Row:
    """What a cycle does at a hole, from the R level on, and which words and states it cannot do without."""

    code: str
    parts: tuple[_Part, ...]
    needs: frozenset[str] = frozenset()

    @property
    def upwards(self) -> bool:
        """Whether the cycle works from R up to Z, and comes to R beside the hole."""
        return "upwards" in self.needs


_PECK = frozenset({"peck"})
_SPINDLE = frozenset({"spindle"})
_SHIFT = frozenset({"spindle", "shift"})

_ROWS: dict[str, _Row] = {
    "cycle_chip_break": _Row("G73", (_pecks_breaking_chips, _FEED_IN, _OUT), _PECK),
    "cycle_fine_bore": _Row("G76", (_FEED_IN, _dwell, _ORIENT, _shift, _OUT, _unshift, _START), _SHIFT),
    "cycle_drill": _Row("G81", (_FEED_IN, _OUT)),
    "cycle_dwell": _Row("G82", (_FEED_IN, _dwell, _OUT)),
    "cycle_deep": _Row("G83", (_pecks_to_r, _FEED_IN, _OUT), _PECK),
    "cycle_tap": _Row("G84", (_tap, _OUT), _SPINDLE | {"tap"}),
    "cycle_tap_left": _Row("G74", (_tap, _OUT), _SPINDLE | {"tap", "left"}),
    "cycle_bore": _Row("G85", (_FEED_IN, _FEED_R, _OUT)),
    "cycle_bore_stop": _Row("G86", (_FEED_IN, _dwell, _STOP, _OUT, _START), _SPINDLE),
    "cycle_back_bore": _Row("G87", _BORE_BACK, _SHIFT | {"back"}),
    "cycle_back_bore_up": _Row("G87", _BORE_UP, _SHIFT | {"upwards"}),
    "cycle_bore_manual": _Row("G88", (_FEED_IN, _dwell, _STOP, _OPERATOR, _OUT, _START), _SPINDLE),
    "cycle_bore_dwell": _Row("G89", (_FEED_IN, _dwell, _FEED_OUT, _OUT)),
}

CYCLES: dict[str, str] = {name: row.code for name, row in _ROWS.items()}
SHIFTING = frozenset(name for name, row in _ROWS.items() if "shift" in row.needs)
"""Cycles whose I and J say where the tool shifts."""
DWELLING = frozenset(name for name, row in _ROWS.items() if _dwell in row.parts)
"""Cycles that wait at the bottom for as long as P says."""
PECKING = frozenset(name for name, row in _ROWS.items() if "peck" in row.needs)
"""Cycles whose Q is a peck."""
TAPPING = {name: -1 if "left" in row.needs else 1 for name, row in _ROWS.items() if "tap" in row.needs}
"""Tapping cycles, and which way the spindle turns into their thread."""


def expand_cycle(
    action: str,
    words: CycleWords,
    place: CyclePlace,
    settings: Cycles | None = None,
    *,
    code: str = "",
) -> list[CycleStep]:
    """Return the steps of one cycle block: the way to each hole, and what the cycle does there.

    `action` is a key of `CYCLES`; `words` are those in force, levels absolute. Repeats of 0 give no steps. Errors name
    the cycle by `code`, the G code that called it.

    Raises:
        CycleError: a word is missing or does not make sense, or the spindle must turn and does not.
    """
    row = dataclasses.replace(_ROWS[action], code=code or _ROWS[action].code)
    hole = _settled(row, words, place, settings or Cycles())
    steps: list[CycleStep] = []
    level = place.level_mm
    for number in range(words.repeats):
        first = place.hole_mm[0] + number * place.increment_mm[0]
        second = place.hole_mm[1] + number * place.increment_mm[1]
        if number and place.further_mm:
            first, second = place.further_mm[number - 1]
        level = _expand_hole(row, _moved(hole, first, second), level, steps)
    return steps


def _expand_hole(row: _Row, hole: _Hole, level: float, steps: list[CycleStep]) -> float:
    """Append the steps of one hole, without moves to the level at hand; return the level they end at."""
    if row.upwards:
        if level < hole.initial:
            steps.append(CycleStep(StepKind.RAPID_AXIS, level_mm=hole.initial))
            level = hole.initial
        steps.append(CycleStep(StepKind.RAPID_PLANE, hole.first, hole.second))
    else:
        if level < hole.r:
            steps.append(CycleStep(StepKind.RAPID_AXIS, level_mm=hole.r))
        steps.append(CycleStep(StepKind.RAPID_PLANE, hole.first, hole.second))
        if level > hole.r:
            steps.append(CycleStep(StepKind.RAPID_AXIS, level_mm=hole.r))
        level = hole.r
    for part in row.parts:
        for step in part(hole):
            if step.kind in (StepKind.RAPID_AXIS, StepKind.FEED_AXIS):
                if abs(step.level_mm - level) < _SAME_LEVEL_MM:
                    continue
                level = step.level_mm
            steps.append(step)
    return level


def _moved(hole: _Hole, first: float, second: float) -> _Hole:
    shifted = hole.shifted[0] + first - hole.first, hole.shifted[1] + second - hole.second
    return dataclasses.replace(hole, first=first, second=second, shifted=shifted)


def _settled(row: _Row, words: CycleWords, place: CyclePlace, settings: Cycles) -> _Hole:
    """Check the words of a cycle and return its numbers at the first hole."""
    code = row.code
    if words.repeats < 0:
        raise CycleError(f"{code} repeats {words.repeats} times", reason="repeats", hint="Use 0 or more.")
    bottom = _required(words.depth_mm, f"{code} needs a depth (Z)", "depth_missing")
    r = _required(words.retract_mm, f"{code} needs a retract level (R)", "retract_missing")
    if row.upwards:
        _check_upwards(code, bottom, r, place)
    elif r < bottom:
        raise CycleError(
            f"{code} would drill upwards: R {r:.6g} lies below Z {bottom:.6g}",
            reason="upwards",
            hint="Give R above the depth.",
        )
    dwell = words.dwell_s or 0.0
    if dwell < 0.0:
        raise CycleError(f"{code} dwells {dwell:.6g} s", reason="dwell", hint="Give P 0 or more.")
    _check_spindle(row, place)
    first, second = place.hole_mm
    shift = _shift_of(code, words, settings) if "shift" in row.needs else (0.0, 0.0)
    return _Hole(
        first=first,
        second=second,
        shifted=(first + shift[0], second + shift[1]),
        bottom=bottom,
        r=r,
        initial=place.initial_mm,
        out=max(place.initial_mm, r) if place.retract == "initial" else r,
        back=_back_of(code, words, bottom, r) if "back" in row.needs else bottom,
        peck=_peck_of(code, words, r - bottom) if _pecks(row, words, settings) else 0.0,
        dwell_s=dwell,
        tap_feed_mm_s=(words.pitch_mm or 0.0) * place.spindle_rpm / 60.0,
        rigid=place.rigid,
        settings=settings,
    )


def _check_upwards(code: str, top: float, r: float, place: CyclePlace) -> None:
    """Refuse a cycle from below that would not go up, or whose hole lies above where the tool came from."""
    if top <= r:
        raise CycleError(
            f"{code} bores from R up to Z here, and Z {top:.6g} does not lie above R {r:.6g}",
            reason="upwards",
            hint="Give R below the hole, and Z above R.",
        )
    if top > place.initial_mm:
        raise CycleError(
            f"{code} would bore up to Z {top:.6g}, above the initial level {place.initial_mm:.6g}",
            reason="upwards",
            hint="Go above the hole before the cycle.",
        )
    if place.retract == "r":
        raise CycleError(
            f"{code} goes out to the initial level only", reason="retract", hint="Program G98 in its block."
        )


def _check_spindle(row: _Row, place: CyclePlace) -> None:
    if "spindle" not in row.needs:
        return
    if place.spindle == "stopped":
        raise CycleError(
            f"{row.code} needs a turning spindle", reason="spindle_stopped", hint="Program M3 or M4 first."
        )
    is_right = "tap" in row.needs and "left" not in row.needs
    if is_right and place.spindle == "reverse" and not place.taps_either_way:
        raise CycleError(
            f"{row.code} taps a right-hand thread, and the spindle turns counter-clockwise (M4)",
            reason="spindle_direction",
            hint="Program M3 first.",
        )
    if "left" in row.needs and place.spindle != "reverse":
        raise CycleError(
            f"{row.code} taps a left-hand thread, and the spindle turns clockwise (M3)",
            reason="spindle_direction",
            hint="Program M4 first, or tap with G84.",
        )


def _pecks(row: _Row, words: CycleWords, settings: Cycles) -> bool:
    """Tell whether the cycle goes in by pecks: where it must, and where a tapping cycle has a Q that it uses."""
    return "peck" in row.needs or ("tap" in row.needs and settings.peck_tap != "none" and bool(words.peck_mm))


def _required(value: float | None, what: str, reason: str) -> float:
    if value is None:
        raise CycleError(what, reason=reason, hint="Program it in the first block of the cycle.")
    return value


def _peck_of(code: str, words: CycleWords, depth: float) -> float:
    peck = _required(words.peck_mm, f"{code} needs a peck (Q)", "peck_missing")
    if peck <= 0.0:
        raise CycleError(f"{code} pecks {peck:.6g} mm", reason="peck", hint="Give Q above 0.")
    if depth / peck > MOST_PECKS:
        raise CycleError(
            f"{code} would peck {depth / peck:.0f} times", reason="peck", hint="Give a larger Q."
        )
    return peck


def _shift_of(code: str, words: CycleWords, settings: Cycles) -> tuple[float, float]:
    if words.shift_mm is not None:
        return words.shift_mm
    amount = _required(words.peck_mm, f"{code} needs a shift (I and J, or Q)", "shift_missing")
    first, second = settings.shift_direction
    return amount * first, amount * second


def _back_of(code: str, words: CycleWords, bottom: float, r: float) -> float:
    back = _required(words.back_mm, f"{code} needs the level to bore back to (K)", "back_missing")
    if not bottom <= back <= r:
        raise CycleError(
            f"{code} would bore back to {back:.6g}, outside Z {bottom:.6g} to R {r:.6g}",
            reason="back",
            hint="Give K between the two.",
        )
    return back
