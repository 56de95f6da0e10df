"""System variables of custom macros as a client reads them: of what is executed, not of what is prepared."""

from __future__ import annotations

from collections.abc import Mapping

from polycnc.nc.macro import MacroError
from polycnc.servers.focas._command import View, offset_name
from polycnc.servers.focas._state_commands import code_of

_BLOCK_END, _MACHINE, _WORK, _SKIP, _LENGTH, _LAG = 5001, 5021, 5041, 5061, 5081, 5101
_POSITIONS = (_BLOCK_END, _MACHINE, _WORK, _SKIP, _LENGTH, _LAG)
_LENGTH_AXIS = "Z"
_MODAL = (4000, 4200)
_CODES = range(1, 23)
_INITIAL = {6: "40", 12: "97", 13: "54", 14: "64", 15: "69", 16: "15"}
"""What holds before the first block, by group from 0; groups of which this control has no codes are 0."""
_WORDS = {107: "D", 109: "F", 111: "H", 113: "M", 119: "S", 120: "T"}
_SEQUENCE, _PROGRAM = 114, 115
_COMMON_OFFSET, _G59, _EXTRA_OFFSET, _LAST_EXTRA = 5201, 5328, 7001, 7960
_EACH_OFFSET, _FIRST_EXTRA = 20, 7


def system_variable(view: View, number: int) -> float:
    """Return a system variable.

    Raises:
        KeyError: There is none of this number, or its value is not known.
    """
    for base in _POSITIONS:
        if 1 <= number - base + 1 <= view.control.axes:
            return _position(view, base, number - base + 1)
    for base in _MODAL:
        if base < number <= base + _PROGRAM + 5:
            return _modal(view, number - base)
    if (found := _offset(view, number)) is not None:
        return found
    return view.control.custom_macros.at_rest(number) or 0.0


def _position(view: View, base: int, axis: int) -> float:
    control, here = view.control, view.positions[axis - 1]
    units = control.units.output_scale(axis) if base == _MACHINE else control.units.input_scale(axis)
    has_length = control.units.axis_name(axis) == _LENGTH_AXIS
    length = units.counts(control.positions.tool_length_mm) if has_length else 0
    counts = {
        _BLOCK_END: here.absolute + here.distance - length,
        _MACHINE: here.machine,
        _WORK: here.absolute,
        _SKIP: control.skip.positions[axis - 1],
        _LENGTH: length,
        _LAG: here.servo_delay,
    }[base]
    return counts * 10.0**-units.decimals


def _modal(view: View, number: int) -> float:
    execution = view.control.execution
    if number in _CODES:
        return float(code_of(view, number - 1) or _INITIAL.get(number - 1, "0"))
    if number == _SEQUENCE:
        return float(execution.sequence)
    if number == _PROGRAM:
        return float(execution.numbers[0])
    word = view.control.modal_data.block(0).words.get(_WORDS[number])
    return float(word.text or 0) if word else 0.0


def write_system_variables(view: View, values: Mapping[int, float]) -> None:
    """Set tool offsets and work offsets by the variables that they are, all or none.

    Raises:
        KeyError: A variable is none of them.
        ValueError: A value is out of range.
    """
    control = view.control
    tools, works = {}, []
    for number, value in values.items():
        if (place := _offset_place(view, number)) is not None:
            units = control.units.input_scale(place[1])
            counts = round(value * 10.0**units.decimals)
            if abs(counts) > control.units.increment.offset_limit:
                raise ValueError(f"#{number} cannot be {value:g}")
            works.append((offset_name(place[0]), control.units.axis_name(place[1]), units.value(counts)))
            continue
        try:
            found = control.custom_macros.tool_offset(number, value)
        except MacroError as error:
            raise ValueError(error.what) from None
        if found is None:
            raise KeyError(number)
        tools[found[0]] = found[1]
    control.tool_offsets.set_all(tools)
    for name, axis, at in works:
        control.control.offsets.set(name, {axis: at})


def _offset(view: View, number: int) -> float | None:
    """Return a work offset of an axis: #5201 the external one, #5221 G54, #7001 the first extra one."""
    found = _offset_place(view, number)
    if found is None:
        return None
    control, (place, axis) = view.control, found
    units = control.units.input_scale(axis)
    value = control.control.offsets.get(offset_name(place), {}).get(control.units.axis_name(axis), 0.0)
    return units.counts(value) * 10.0**-units.decimals


def _offset_place(view: View, number: int) -> tuple[int, int] | None:
    """Return the work offset that a variable is of, by its number, and the axis (from 1); None for other variables.

    Raises:
        KeyError: There is no such axis.
    """
    if _COMMON_OFFSET <= number <= _G59:
        place, axis = divmod(number - _COMMON_OFFSET, _EACH_OFFSET)
    elif _EXTRA_OFFSET <= number <= _LAST_EXTRA:
        place, axis = divmod(number - _EXTRA_OFFSET, _EACH_OFFSET)
        place += _FIRST_EXTRA
    else:
        return None
    if axis >= view.control.axes:
        raise KeyError(number)
    return place, axis + 1
