"""SD and SDR: system data of the calling channel by group and indices (Manual 003, 4.9 and 4.10)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER
from polycnc.nc.cpl import OMITTED, CharacterField, Fault, text_of

NO_SPINDLE = -1
_G63 = 63
_EIGHT = range(1, 9)
_AXES = range(1, 65)

SD_GROUPS: dict[int, tuple[int, ...]] = {
    2: (0, 1, 2, 3, 5, 11, 12, 13, 73),
    3: (70, 71),
    4: (90, 91, 189, 190, 191),
    5: (63, 66),
    6: (543,),
    7: (93, 94, 95),
    8: (40, 41, 42),
    9: (6, 7),
    10: (17, 18, 19, 20),
    11: (8, 9),
    13: (14, 15),
    17: tuple(range(53, 60)),
    18: tuple(range(153, 160)),
    19: tuple(range(253, 260)),
    20: (60, 67),
    21: (37, 38, 39),
    22: (61, 62),
    25: (64, 65),
    26: (68, 69),
    28: (145, 146, 245, 345, 445, 545, 645, 745, 845),
    29: (114, 115),
    30: (160, 167),
}
"""The groups of G functions of the older CC controls, which SD(1) counts by; the others up to 48 have none."""


@dataclass(frozen=True, slots=True)
class Moment:
    """What holds at one moment: of the block that was prepared last, or of the one under execution.

    `axes` are physical axes by channel in the order of their logical numbers; `plane` main and secondary axis,
    `drilling_axes` those of H and of L3; `senses` of spindles 3, 4, 0 or 19; `speeds_rpm` without potentiometer.
    """

    functions: frozenset[int] = frozenset()
    feed: float = 0.0
    plane: tuple[int, int] = (1, 2)
    drilling_axes: tuple[int, int] = (3, 3)
    shifts_168: tuple[float, ...] = (0.0,) * 8
    shifts_268: tuple[float, ...] = (0.0,) * 8
    axes: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    speeds_rpm: Mapping[int, float] = field(default_factory=dict)
    senses: Mapping[int, int] = field(default_factory=dict)


class Area(NamedTuple):
    """A dead range (`kind` 1) or work area (2); centre and extension along its two axes, in programming units."""

    active: bool
    kind: int
    centre: tuple[float, float]
    extension: tuple[float, float]


class AxisCoupling(NamedTuple):
    """What couples a slave axis to its master axis."""

    master: int
    slave_shift: float
    factor: float
    master_shift: float


@dataclass(slots=True)
class SystemData:
    """What SD and SDR read of a channel; feeds in the programmed unit per minute, overrides in percent.

    `block_function` is the G function of the block before, of those that hold for one block only; `probe_missing`
    tells that a probe has not switched (G75) or a fixed stop not been reached (G375); `axis_names` are physical
    axes by name, `logical_names` logical axes by channel and name; `search_positions` hold after a block search.
    """

    channel: int
    programmed: Moment = field(default_factory=Moment)
    active: Moment = field(default_factory=Moment)
    block_function: int = 0
    feed_override: float = 100.0
    rapid: float = 0.0
    spindle_overrides: Mapping[int, float] = field(default_factory=dict)
    actual_rpm: Mapping[int, float] = field(default_factory=dict)
    probe_missing: bool = False
    machining_mode: int = 1
    language: int = 44
    test_without_motion: bool = False
    axis_names: Mapping[str, int] = field(default_factory=dict)
    logical_names: Mapping[tuple[int, str], int] = field(default_factory=dict)
    tangential: tuple[float, float, float, float] = (0, 0, 0.0, 0.0)
    areas: Sequence[Area] = ()
    precision: tuple[float, float] = (0.0, 0.0)
    couplings: Mapping[int, AxisCoupling] = field(default_factory=dict)
    search_positions: Mapping[int, float] = field(default_factory=dict)
    machining_axes: frozenset[int] = frozenset(_EIGHT)

    def sd(self, *arguments: object) -> int:
        """Return system data as INTEGER.

        Raises:
            Fault: There are none of this group and indices.
        """
        value = _find(_SD, self, arguments, "SD")
        return math.floor(round(value, 9) + 0.5)  # 1.5 inch in mm and back is a bit less

    def sdr(self, *arguments: object) -> float:
        """Return system data as REAL.

        Raises:
            Fault: There are none of this group and indices.
        """
        return float(_find(_SDR, self, arguments, "SDR"))


Index: TypeAlias = int | range | str
"""What an index has to be: one number, one of a range, or an axis by number or name."""


class _Row(NamedTuple):
    """System data: group, indices, how they are read from the free ones, and what the last index is by default."""

    group: int
    indices: tuple[Index, ...]
    read: Callable[..., float]
    default: int | None = None


_Rows: TypeAlias = Mapping[object, Sequence[_Row]]


def _by_group(rows: Sequence[_Row]) -> _Rows:
    found: dict[object, list[_Row]] = {}
    for row in rows:
        found.setdefault(row.group, []).append(row)
    return found


def _find(rows: _Rows, data: SystemData, arguments: Sequence[object], name: str) -> float:
    given = [_plain(each) for each in arguments]
    for row in rows.get(given[0], ()):
        wanted = (row.group, *row.indices)
        indices = (
            [*given, row.default] if row.default is not None and len(given) == len(wanted) - 1 else given
        )
        if len(indices) == len(wanted) and all(map(_fits, wanted, indices)):
            return row.read(
                data, *(each for each, spec in zip(indices, wanted, strict=True) if spec.__class__ is not int)
            )
    shown = ",".join("" if each is OMITTED else str(each) for each in given)
    raise Fault(INVALID_PARAMETER, f"there are no system data {name}({shown}), or they are not in use")


def _plain(value: object) -> object:
    if isinstance(value, float) and value.is_integer():
        return int(value)
    return value if isinstance(value, int | float | str) or value is OMITTED else text_of(value)


def _fits(wanted: Index, given: object) -> bool:
    if isinstance(given, bool):
        return False
    if wanted == "axis":
        return isinstance(given, str | CharacterField) or given in _AXES
    return given in wanted if isinstance(wanted, range) else given == wanted


def _function(moment: Moment, group: int) -> int:
    return next((code for code in SD_GROUPS.get(group, ()) if code in moment.functions), -1)


def _last_function(data: SystemData, group: int) -> int:
    return data.block_function if group == 1 else _function(data.programmed, group)


def _feed(data: SystemData) -> float:
    share = 1.0 if _G63 in data.active.functions else data.feed_override / 100
    return math.ceil(round(data.active.feed * share, 6))


def _speed(data: SystemData, spindle: int) -> float:
    return data.active.speeds_rpm.get(spindle, 0.0) * data.spindle_overrides.get(spindle, 0.0) / 100


def _sense(moment: Moment, spindle: int) -> int:
    return moment.senses.get(spindle, NO_SPINDLE)


def _physical(data: SystemData, axis: object) -> int:
    if isinstance(axis, str):
        if axis not in data.axis_names:
            raise Fault(INVALID_PARAMETER, f"there is no axis {axis}")
        return data.axis_names[axis]
    assert isinstance(axis, int)
    return axis


def _logical_of(data: SystemData, moment: Moment, axis: object) -> int:
    axes = moment.axes.get(data.channel, ())
    physical = _physical(data, axis)
    return axes.index(physical) + 1 if physical in axes else 0


def _physical_of(data: SystemData, moment: Moment, axis: object, channel: int) -> int:
    axes = moment.axes.get(channel, ())
    if isinstance(axis, str):
        if (channel, axis) not in data.logical_names:
            raise Fault(INVALID_PARAMETER, f"channel {channel} has no axis {axis}")
        axis = data.logical_names[channel, axis]
    assert isinstance(axis, int)
    return axes[axis - 1] if axis <= len(axes) else 0


def _channel_of(data: SystemData, axis: object) -> int:
    physical = _physical(data, axis)
    return next((channel for channel, axes in data.active.axes.items() if physical in axes), -1)


def _area(data: SystemData, number: int) -> Area:
    return data.areas[number - 1] if number <= len(data.areas) else Area(False, 0, (0.0, 0.0), (0.0, 0.0))


def _search_position(data: SystemData, axis: int) -> float:
    if axis not in data.machining_axes:
        raise Fault(INVALID_PARAMETER, f"axis {axis} is none that machines")
    return data.search_positions.get(axis, 0.0)


def _moments() -> tuple[tuple[int, Callable[[SystemData], Moment]], ...]:
    return (1, lambda data: data.programmed), (2, lambda data: data.active)


def _shift_rows() -> list[_Row]:
    rows = []
    for index, moment in _moments():
        rows += [
            _Row(68, (index, _EIGHT), lambda d, n, m=moment: m(d).shifts_168[n - 1] + m(d).shifts_268[n - 1]),
            _Row(168, (index, _EIGHT), lambda d, n, m=moment: m(d).shifts_168[n - 1]),
            _Row(268, (index, _EIGHT), lambda d, n, m=moment: m(d).shifts_268[n - 1]),
        ]
    return rows


def _coupling_rows() -> list[_Row]:
    none = AxisCoupling(0, 0.0, 0.0, 0.0)
    masters = _Row(
        581, (0, _EIGHT), lambda d, m: m if any(each.master == m for each in d.couplings.values()) else 0
    )
    return [
        masters,
        *(
            _Row(581, (_EIGHT, place), lambda d, s, p=place: d.couplings.get(s, none)[p])
            for place in range(4)
        ),
    ]


def _axis_rows() -> list[_Row]:
    rows = []
    channels = range(1, 65)
    for index, moment in _moments():
        default = 1 if index == 1 else None
        rows += [
            _Row(20, (index,), lambda d, m=moment: len(m(d).axes.get(d.channel, ())), default),
            _Row(21, (channels, index), lambda d, n, m=moment: len(m(d).axes.get(n, ())), default),
            _Row(22, ("axis", index), lambda d, a, m=moment: _logical_of(d, m(d), a), default),
            _Row(23, ("axis", index), lambda d, a, m=moment: _physical_of(d, m(d), a, d.channel), default),
            _Row(
                24, ("axis", channels, index), lambda d, a, n, m=moment: _physical_of(d, m(d), a, n), default
            ),
        ]
    return [*rows, _Row(25, ("axis",), _channel_of)]


_PRECISION = [_Row(328, (1,), lambda d: d.precision[0], 1), _Row(328, (2,), lambda d: d.precision[1])]
_OVERRIDES = [
    _Row(2, (1,), lambda d: d.feed_override),
    _Row(2, (3,), lambda d: d.spindle_overrides.get(1, 0.0)),
    _Row(2, (4,), lambda d: d.spindle_overrides.get(2, 0.0)),
    _Row(202, (_EIGHT,), lambda d, s: d.spindle_overrides.get(s, 0.0)),
]
_SD = _by_group(
    [
        _Row(1, (range(2, 49), 1), lambda d, g: _function(d.active, g)),
        _Row(1, (range(1, 49), 2), _last_function),
        *_OVERRIDES,
        _Row(5, (1, 1), _feed),
        _Row(5, (1, 2), lambda d: d.programmed.feed),
        _Row(5, (2, 1), lambda d: d.rapid),
        *(_Row(5, (2 + s, 1), lambda d, s=s: _speed(d, s)) for s in (1, 2)),
        *(_Row(5, (2 + s, 2), lambda d, s=s: d.programmed.speeds_rpm.get(s, 0.0)) for s in (1, 2)),
        *(_Row(5, (2 + s, 3), lambda d, s=s: d.actual_rpm.get(s, 0.0)) for s in (1, 2)),
        _Row(8, (), lambda d: d.channel),
        _Row(9, (), lambda d: d.probe_missing),
        *(_Row(10, (1, n), lambda d, n=n: d.programmed.drilling_axes[n - 1]) for n in (1, 2)),
        *(_Row(10, (2, n), lambda d, n=n: d.active.drilling_axes[n - 1]) for n in (1, 2)),
        *(_Row(11, (n, 1), lambda d, n=n: d.programmed.plane[n - 1]) for n in (1, 2)),
        *(_Row(11, (n, 2), lambda d, n=n: d.active.plane[n - 1]) for n in (1, 2)),
        _Row(12, (1,), lambda d: _sense(d.active, 1)),
        _Row(12, (2,), lambda d: _sense(d.programmed, 1)),
        _Row(12, (3,), lambda d: _sense(d.active, 2)),
        _Row(12, (4,), lambda d: _sense(d.programmed, 2)),
        _Row(13, (), lambda d: d.machining_mode),
        _Row(14, (), lambda d: d.language),
        _Row(15, (), lambda d: d.test_without_motion),
        *_axis_rows(),
        *_shift_rows(),
        *(_Row(131, (n,), lambda d, n=n: d.tangential[n - 1]) for n in (1, 2)),
        _Row(200, (1,), lambda d: sum(area.active for area in d.areas)),
        _Row(200, (1, range(1, 11)), lambda d, i: _area(d, i).active),
        _Row(200, (3, range(1, 11)), lambda d, i: _area(d, i).kind),
        *(_Row(200, (10 + n, range(1, 11)), lambda d, i, n=n: _area(d, i).centre[n - 1]) for n in (1, 2)),
        *(_Row(200, (20 + n, range(1, 11)), lambda d, i, n=n: _area(d, i).extension[n - 1]) for n in (1, 2)),
        _Row(205, (1, _EIGHT), _speed),
        _Row(205, (2, _EIGHT), lambda d, s: d.programmed.speeds_rpm.get(s, 0.0)),
        _Row(205, (3, _EIGHT), lambda d, s: d.actual_rpm.get(s, 0.0)),
        _Row(212, (1, _EIGHT), lambda d, s: _sense(d.active, s)),
        _Row(212, (2, _EIGHT), lambda d, s: _sense(d.programmed, s)),
        *_PRECISION,
        *_coupling_rows(),
    ]
)
_SDR = _by_group(
    [
        _Row(1, (_EIGHT,), _search_position),
        *_OVERRIDES,
        *_shift_rows(),
        *(_Row(131, (n,), lambda d, n=n: d.tangential[n - 1]) for n in (3, 4)),
        *_PRECISION,
        *_coupling_rows(),
    ]
)
