"""What every command of the protocol is made from: the view of a control in one cycle, refusals, packing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import datetime
from functools import cached_property
from typing import Any, TypeAlias

from polycnc.controllers.fanuc import AxisPositions, PowerMate
from polycnc.controllers.fanuc.wire import CNC, Content, Request, Value8, layout_of, record
from polycnc.servers.focas._profile import Profile

NOT_THERE, LENGTH, NUMBER, ATTRIBUTE, DATA, NO_OPTION, PROTECTED = range(1, 8)
WRONG_PATH, REJECTED, BUSY = 11, 13, -1
"""Codes that clients get, by the names of the function library."""
ALL = -1
MOST_NUMBERS = 433
"""Values of eight bytes that the largest frame of all series holds."""


class RefusedError(Exception):
    """A command that is answered with a code instead of data."""

    def __init__(self, code: int, detail: int = 0) -> None:
        super().__init__(f"code {code}")
        self.code, self.detail = code, detail


class View:
    """A control and the series it is shown as; what was read once in a frame is not computed again."""

    def __init__(self, control: PowerMate, profile: Profile) -> None:
        self.control = control
        self.profile = profile

    @cached_property
    def positions(self) -> tuple[AxisPositions, ...]:
        """Where its axes are, in increments."""
        return self.control.positions.read()

    def forget(self) -> None:
        """Read anew: something has been changed."""
        self.__dict__.pop("positions", None)


Command: TypeAlias = Callable[[View, Request], Content]
"""Carries out a request and returns what the reply holds; it refuses by raising `RefusedError`."""
COMMANDS: dict[tuple[int, int], Command] = {}
"""The commands that are answered, by target and code."""
WRITING: set[tuple[int, int]] = set()
"""Those that change something."""


def answers(*codes: int, target: int = CNC, writes: bool = False) -> Callable[[Command], Command]:
    """Say which commands a function answers; what stands in request and reply is in `wire.LAYOUTS`."""

    def note(function: Command) -> Command:
        keys = [(target, code) for code in codes]
        COMMANDS.update(dict.fromkeys(keys, function))
        WRITING.update(keys if writes else ())
        return function

    return note


def numbers(request: Request) -> range:
    """Return the numbers from the first to the second argument."""
    first, last = request.arguments[:2]
    if last < first:
        raise RefusedError(NUMBER)
    if last - first >= MOST_NUMBERS:
        raise RefusedError(LENGTH)
    return range(first, last + 1)


def one_number(request: Request) -> int:
    """Return the one number that both first arguments say."""
    first, last = request.arguments[:2]
    if first != last:
        raise RefusedError(NUMBER)
    return first


def axes_of(view: View, axis: int) -> range:
    """Return the axes that are asked for: one, or all."""
    axes = view.control.axes
    if axis == ALL:
        return range(1, axes + 1)
    if not 1 <= axis <= axes:
        raise RefusedError(ATTRIBUTE)
    return range(axis, axis + 1)


def padded(values: Sequence[Value8 | int], view: View, axis: int = ALL) -> list[Value8 | int]:
    """Return the value of one axis, or of all with room for as many as the series can have.

    Unused places hold 0 with the base that the others have, as seen on a 31i.
    """
    return [*values, *[0] * (view.profile.most_axes - len(values))] if axis == ALL else [*values]


def data_of(request: Request, size: int) -> bytes:
    """Return the data of a request that have to be so many bytes."""
    if len(request.data) != size:
        raise RefusedError(LENGTH)
    return request.data


def given(request: Request) -> dict[str, Any]:
    """Return what the data of a request say, by name."""
    layout = layout_of(request)
    data_of(request, record(layout.data).size or 0)
    return layout.unpack_data(request.data)[0]


def given_each(request: Request, count: int) -> list[dict[str, Any]]:
    """Return what the data of a request say of each of so many things, by name."""
    layout = layout_of(request)
    data_of(request, count * (record(layout.data_each).size or 0))
    return layout.unpack_data(request.data)[1]


def named(request: Request, source: object) -> dict[str, Any]:
    """Return the attributes of `source` that the record of a reply names."""
    return {each.name: getattr(source, each.name) for each in record(layout_of(request).head).parts}


def moment(when: datetime) -> dict[str, int]:
    """Return date and time by the names that records have for them."""
    names = ("year", "month", "day", "hour", "minute", "second")
    return {name: getattr(when, name) for name in names}


_EXTERNAL, _FIRST_EXTRA, _MOST_EXTRA = "EXT", 7, 300


def offset_name(number: int) -> str:
    """Return the name of a work offset: external, G54 to G59, then the extra ones."""
    if not 0 <= number < _FIRST_EXTRA + _MOST_EXTRA:
        raise RefusedError(NUMBER)
    if number == 0:
        return _EXTERNAL
    return f"G{53 + number}" if number < _FIRST_EXTRA else f"G54.P{number - _FIRST_EXTRA + 1}"
