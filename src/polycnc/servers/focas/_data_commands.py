"""Commands that read and write data: macro variables, parameters, diagnosis, offsets, timers, PMC memory."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from polycnc.controllers.fanuc import DIAGNOSIS, Attribute, Kind, ParameterRow, pmc
from polycnc.controllers.fanuc.wire import PMC, PMC_WIDTHS, Content, Request, Value8, swapped
from polycnc.servers.focas._command import (
    ATTRIBUTE,
    DATA,
    LENGTH,
    MOST_NUMBERS,
    NO_OPTION,
    NOT_THERE,
    NUMBER,
    PROTECTED,
    RefusedError,
    View,
    answers,
    axes_of,
    data_of,
    given,
    given_each,
    numbers,
    offset_name,
    one_number,
    padded,
)
from polycnc.servers.focas._system_variables import system_variable, write_system_variables

# ---------------------------------------------------------------------- macro variables

_LOCALS = range(1, 34)
_DECIMALS = 9


def _macro(view: View, number: int) -> float | None:
    if number in _LOCALS:
        return view.control.custom_macros.local(number)
    try:
        return view.control.macros.get(number)
    except KeyError:
        raise RefusedError(NUMBER) from None


def _readable_macro(view: View, number: int) -> float | None:
    try:
        return _macro(view, number)
    except RefusedError:
        if not view.profile.system_variables:
            raise
    try:
        return system_variable(view, number)
    except KeyError:
        raise RefusedError(NUMBER) from None


def _value(number: float | None) -> Value8:
    """Return a number with as many decimals as it needs, for a client that shows what it gets."""
    made = Value8.of(number, _DECIMALS)
    mantissa, exponent = made.mantissa, made.exponent
    while made.base and exponent > 0 and mantissa % 10 == 0:
        mantissa, exponent = mantissa // 10, exponent - 1
    return Value8(mantissa, exponent, made.base)


@answers(0x15)
def read_macros(view: View, request: Request) -> Content:
    """Return macro variables; a vacant one is marked."""
    return [_value(_readable_macro(view, number)) for number in numbers(request)]


def _set_macros(view: View, values: dict[int, float | None]) -> None:
    """Set variables, all or none; a system variable that is made vacant is 0, as in a program."""
    system: dict[int, float] = {}
    for number, value in values.items():
        if number in _LOCALS:
            raise RefusedError(NUMBER)
        if view.profile.system_variables and number not in view.control.macros:
            system[number] = value or 0.0
        else:
            _macro(view, number)
        if value is not None and not abs(value) < 1e12:
            raise RefusedError(DATA)
    try:
        write_system_variables(view, system)
    except KeyError:
        raise RefusedError(NUMBER) from None
    except ValueError:
        raise RefusedError(DATA) from None
    with view.control.store.transaction():
        for number, value in values.items():
            if number not in system:
                view.control.macros.set(number, value)


@answers(0x16, writes=True)
def write_macros(view: View, request: Request) -> Content:
    """Set macro variables."""
    found = numbers(request)
    values = [each["value"].number for each in given_each(request, len(found))]
    _set_macros(view, dict(zip(found, values, strict=True)))
    return None


@answers(0xA7)
def read_doubles(view: View, request: Request) -> Content:
    """Return macro variables as floating-point numbers; a vacant one is no number."""
    first, count = request.arguments[:2]
    if count < 1:
        raise RefusedError(NUMBER)
    if count > MOST_NUMBERS:
        raise RefusedError(LENGTH)
    values = [_readable_macro(view, number) for number in range(first, first + count)]
    return [math.nan if value is None else value for value in values]


@answers(0xA8, writes=True)
def write_double(view: View, request: Request) -> Content:
    """Set a macro variable; what is no number makes it vacant."""
    value = given_each(request, 1)[0]["value"]
    if math.isinf(value):
        raise RefusedError(DATA)
    _set_macros(view, {request.arguments[0]: None if math.isnan(value) else value})
    return None


@answers(0x17)
def macro_range(view: View, request: Request) -> Content:
    """Return how many local and how many common variables there are."""
    commons = (last - first + 1 for first, last in view.control.macros.variables.ranges)
    return {"locals": len(_LOCALS), "commons": sum(commons)}


# ---------------------------------------------------------------------- parameters, settings, diagnosis


def _records(view: View, rows: list[tuple[int, int, bool, Callable[[int], int]]], asked: int) -> Content:
    """Return one record for each number: number, axis, type, and room for the values of all axes."""
    made = []
    for number, kind, per_axis, value in rows:
        if per_axis and asked == 0:
            raise RefusedError(ATTRIBUTE)
        values = [value(axis) for axis in (axes_of(view, asked) if per_axis else range(1))]
        axis = asked if per_axis else 0
        made.append({"number": number, "axis": axis, "type": kind, "values": padded(values, view)})
    if not rows:
        raise RefusedError(NUMBER)
    return made


def _readable(view: View, request: Request) -> list[ParameterRow]:
    rows = view.control.parameters.rows
    found = [rows[number] for number in numbers(request) if number in rows]
    return [row for row in found if Attribute.NOT_READABLE not in row.attributes]


def _of_parameters(view: View, rows: list[ParameterRow], asked: int) -> Content:
    value = view.control.parameters.value
    return _records(
        view,
        [
            (row.number, int(row.kind), row.per_axis, lambda axis, number=row.number: value(number, axis))  # type: ignore[misc]
            for row in rows
        ],
        asked,
    )


@answers(0x0E, 0x8D)
def parameters(view: View, request: Request) -> Content:
    """Return parameters, of one axis or all; numbers without one are left out."""
    return _of_parameters(view, _readable(view, request), request.arguments[2])


@answers(0x29, 0x90)
def settings(view: View, request: Request) -> Content:
    """Return the parameters that stand on the setting screen."""
    rows = [row for row in _readable(view, request) if Attribute.SETTING in row.attributes]
    return _of_parameters(view, rows, request.arguments[2])


@answers(0x10)
def parameter_types(view: View, request: Request) -> Content:
    """Return numbers and type words of so many parameters from one on, and the numbers before and after."""
    rows = view.control.parameters.rows
    around, found = _from_one_on(
        request, [number for number, row in rows.items() if Attribute.NOT_READABLE not in row.attributes]
    )
    return around, [{"number": number, "type": rows[number].type_word} for number in found]


def _from_one_on(request: Request, known: Iterable[int]) -> tuple[dict[str, int], list[int]]:
    """Return the numbers before and after those that are asked for, so many from one on, and these."""
    first, count = request.arguments[:2]
    if not 0 < count <= MOST_NUMBERS:
        raise RefusedError(LENGTH)
    known = sorted(known)
    found = [number for number in known if number >= first][:count]
    if not found:
        raise RefusedError(NUMBER)
    before = max((number for number in known if number < found[0]), default=0)
    behind = min((number for number in known if number > found[-1]), default=0)
    return {"before": before, "behind": behind}, found


_ONE_VALUE, _EACH_AXIS, _EACH_SPINDLE = 0, 3, 4
_PLAIN = {"unit": 0, "dimension": 0, "input": 0, "display": 0}


def _infos(request: Request, rows: Mapping[int, tuple[Kind, int, int]]) -> Content:
    """Return what so many rows are, from a number on, with the numbers before and after.

    A row is its kind, how it is repeated (once, for each axis, for each spindle), and its other attributes.
    """
    around, found = _from_one_on(request, rows)
    made = []
    for number in found:
        kind, array, others = rows[number]
        size = 0 if kind is Kind.BIT else kind.size
        made.append({"number": number, "size": size, "array": array, "others": others, **_PLAIN})
    return around, made


@answers(0xA0)
def parameter_infos(view: View, request: Request) -> Content:
    """Return number, size, repetition and type word of so many parameters from one on."""
    rows = {}
    for number, row in view.control.parameters.rows.items():
        if Attribute.NOT_READABLE not in row.attributes:
            spindle = Attribute.SPINDLE in row.attributes
            array = _EACH_AXIS if row.per_axis else _EACH_SPINDLE if spindle else _ONE_VALUE
            rows[number] = row.kind, array, row.type_word
    return _infos(request, rows)


@answers(0xA2)
def diagnosis_infos(view: View, request: Request) -> Content:
    """Return number, size and repetition of so many diagnosis data from one on."""
    return _infos(
        request,
        {
            number: (row.kind, _EACH_AXIS if row.per_axis else _ONE_VALUE, 0)
            for number, row in DIAGNOSIS.items()
        },
    )


_OLD_DIAGNOSIS = {0: 3, 1: 0, 2: 1, 3: 2}
"""Type numbers of diagnosis data on old series, by those of parameters: bits, byte, word, two words."""


@answers(0x30, 0x93)
def diagnosis(view: View, request: Request) -> Content:
    """Return diagnosis data, of one axis or all; numbers without any are left out."""
    control = view.control
    rows = [(number, DIAGNOSIS[number]) for number in numbers(request) if number in DIAGNOSIS]
    return _records(
        view,
        [
            (
                number,
                int(row.kind) if view.profile.wide_values else _OLD_DIAGNOSIS[int(row.kind)],
                row.per_axis,
                lambda axis, row=row: int(row.value(control, axis)),  # type: ignore[misc]
            )
            for number, row in rows
        ],
        request.arguments[2],
    )


# ---------------------------------------------------------------------- offsets


_OFFICIAL = 1000
_LENGTHS = (0, 3)
"""Types of tool offsets: none (one value for each tool), and the geometry of its length, which that value is."""
_AS_IT_IS = 0, -1


def _check_type(kind: int) -> None:
    if kind % _OFFICIAL not in _LENGTHS or kind // _OFFICIAL not in (0, 1):
        raise RefusedError(ATTRIBUTE)


def _increments(asked: Mapping[str, int], decimals: int) -> int:
    """Return a value that comes in increments, or with decimals of its own."""
    if (asked["base"], asked["exponent"]) == _AS_IT_IS:
        return asked["increments"]
    number = Value8.checked(asked["increments"], asked["base"], asked["exponent"]).number
    if number is None or not abs(number) < 1e9:
        raise RefusedError(DATA)
    counted: float = number * 10.0**decimals
    if abs(counted - round(counted)) > 1e-6:
        raise RefusedError(DATA)
    return round(counted)


def _offset_decimals(view: View) -> int:
    return view.control.units.increment.decimals + int(view.control.units.inch_input)


@answers(0x08)
def read_tool_offsets(view: View, request: Request) -> Content:
    """Return tool offsets."""
    _check_type(request.arguments[2])
    try:
        found = [view.control.tool_offsets.get(number) for number in numbers(request)]
    except KeyError:
        raise RefusedError(NUMBER) from None
    return [Value8(value, _offset_decimals(view)) for value in found]


@answers(0x09, writes=True)
def write_tool_offset(view: View, request: Request) -> Content:
    """Set a tool offset."""
    number = one_number(request)
    _check_type(request.arguments[2])
    value = _increments(given(request), _offset_decimals(view))
    try:
        view.control.tool_offsets.set_all({number: value})
    except KeyError:
        raise RefusedError(NUMBER) from None
    except ValueError:
        raise RefusedError(DATA) from None
    return None


@answers(0x0A)
def tool_offset_range(view: View, request: Request) -> Content:
    """Return how many tool offsets there are, and the type of their memory: one value each."""
    return {"offsets": view.control.tool_offsets.count, "memory": 0}


@answers(0x0B)
def read_work_offset(view: View, request: Request) -> Content:
    """Return a work offset of one axis or all."""
    control, name, asked = view.control, offset_name(one_number(request)), request.arguments[2]
    values = control.control.offsets.get(name, {})
    made = []
    for axis in axes_of(view, asked):
        units = control.units.input_scale(axis)
        made.append(Value8(units.counts(values.get(control.units.axis_name(axis), 0.0)), units.decimals))
    return padded(made, view, asked)


@answers(0x0C, writes=True)
def write_work_offset(view: View, request: Request) -> Content:
    """Set a work offset of one axis, or of all."""
    control, name, asked = view.control, offset_name(one_number(request)), request.arguments[2]
    axes = axes_of(view, asked)
    values = {}
    for axis, each in zip(axes, given_each(request, len(axes)), strict=True):
        units = control.units.input_scale(axis)
        count = _increments(each, units.decimals)
        if abs(count) > control.units.increment.offset_limit:
            raise RefusedError(DATA)
        values[control.units.axis_name(axis)] = units.value(count)
    control.control.offsets.set(name, values)
    return None


# ---------------------------------------------------------------------- timers


_TIMERS = {0: (None, 6750), 1: (6751, 6752), 2: (6753, 6754), 3: (6757, 6758), 4: (6755, 6756)}
"""Parameters of each timer: milliseconds and minutes; 4 is the time of an external signal."""


@answers(0x120)
def timer(view: View, request: Request) -> Content:
    """Return a timer: minutes and milliseconds."""
    found = _TIMERS.get(request.arguments[0])
    if found is None:
        raise RefusedError(NUMBER)
    ms, minutes = (0 if number is None else view.control.parameters.value(number) for number in found)
    return {"minutes": minutes, "milliseconds": ms}


@answers(0x48, 0x4A, 0x52, 0x8B)
def no_tool_life(view: View, request: Request) -> Content:
    """Refuse: this control manages no tool life, which is an option."""
    raise RefusedError(NO_OPTION)


# ---------------------------------------------------------------------- PMC


def _pmc_place(view: View, request: Request) -> tuple[str, int, int]:
    first, last, area, kind = request.arguments
    if not view.control.has_option("pmc"):
        raise RefusedError(NOT_THERE)
    if not 0 <= kind < len(PMC_WIDTHS) or not 0 <= area < len(pmc.LETTERS):
        raise RefusedError(ATTRIBUTE)
    letter = pmc.LETTERS[area]
    if last - first >= view.profile.most_body - 32 or not pmc.exists(letter, first, last):
        raise RefusedError(NUMBER)
    if (last - first + 1) % PMC_WIDTHS[kind]:
        raise RefusedError(LENGTH)
    return letter, first, last


@answers(0x8001, target=PMC)
def read_pmc(view: View, request: Request) -> Content:
    """Return bytes, words or double words of an area."""
    letter, first, last = _pmc_place(view, request)
    values = swapped(view.control.pmc.read(letter, first, last), PMC_WIDTHS[request.arguments[3]])
    return {"values": values}


@answers(0x8002, target=PMC, writes=True)
def write_pmc(view: View, request: Request) -> Content:
    """Set bytes, words or double words of an area that is not protected."""
    letter, first, last = _pmc_place(view, request)
    data = data_of(request, last - first + 1)
    if not pmc.writable(letter, first, last):
        raise RefusedError(PROTECTED)
    view.control.pmc.write(letter, first, swapped(data, PMC_WIDTHS[request.arguments[3]]))
    return None
