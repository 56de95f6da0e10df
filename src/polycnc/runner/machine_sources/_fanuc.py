"""Read a FANUC parameter list (CNC-PARA as the control punches it out).

A number with a decimal point is in mm, mm/min or ms; one without counts the control's increments of 0.001 mm where it
is a position (0.0001 inch on a machine in inches), or what parameter 1013 says.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from polycnc.errors import ConfigurationError, SourcePosition
from polycnc.runner.machine_sources._facts import AxisFacts, Entry, Facts, LeftOut
from polycnc.units import MM_PER_INCH, whole

CONTROL = "a FANUC parameter list"
LINE = re.compile(r"\s*N0*(\d{1,5})(?:Q\d+)?((?:[AST]\d+)?[PMI][-+.\d].*)")
VALUE = re.compile(r"(?:([AST])(\d+))?[PMI]([-+]?[\d.]+)")
NAMES, RAPID, RAPID_TIME_MS = 1020, 1420, 1620
LIMIT_HIGH, LIMIT_LOW, HOME = 1320, 1321, 1240
INCH_BITS, INCREMENT_BITS = 1001, 1013
LOOK_AHEAD_RATE, LOOK_AHEAD_TIME_MS, LOOK_AHEAD_MM_S2 = 1770, 1771, 1660
CORNER_STEP, TOP_RPM = 1783, 3741
OFFSETS = {1221 + index: f"G{54 + index}" for index in range(6)}
INCREMENT_MM, COARSE_MM, FINE_MM = 0.001, 0.01, 0.0001
NO_LIMIT_MM = 99999.0  # and beyond: the control does not watch it
LEFT_OUT = {
    1006: "axes A, B and C turn, the others do not",
    1422: "the highest cutting feed; the axes go up to their rapid",
    1430: "the highest cutting feed of each axis; the axes go up to their rapid",
    1432: "the highest cutting feed of each axis; the axes go up to their rapid",
    1622: "ramps after interpolation, which round corners, are not imitated",
    1825: "the servo is ideal; see [axis.servo]",
    1826: "the servo is ideal; see [axis.servo]",
    1828: "the servo is ideal; see [axis.servo]",
    1851: "the servo is ideal; see backlash_mm",
}


@dataclass(frozen=True, slots=True)
class _Parameter:
    """The values of one number: by axis or spindle from 1, or at 0 where it has only one."""

    values: dict[int, Entry]


def recognises(text: str) -> bool:
    """Tell whether `text` has the rapid speed as a parameter with axes."""
    return re.search(r"^\s*N0*1420(Q1)?A1P", text, re.MULTILINE) is not None


def read(text: str, file: str) -> Facts:
    """Return what the list says.

    Raises:
        ConfigurationError: A value is no number, or an axis has no rapid or no acceleration.
    """
    listed = _parameters(text, file)
    axes = tuple(_axis(listed, index, file) for index in sorted(listed[RAPID].values))
    offsets = {}
    for number, name in OFFSETS.items():
        if number in listed:
            of_axis = {
                axis.name: _position(listed, number, index, _unit(listed, axis.name)) or 0.0
                for index, axis in enumerate(axes, 1)
            }
            if any(of_axis.values()):
                offsets[name] = of_axis
    top = listed[TOP_RPM].values if TOP_RPM in listed else {}
    rpm = next((entry.number for entry in top.values() if entry.number > 0.0), None)
    read_here = {
        NAMES,
        RAPID,
        RAPID_TIME_MS,
        LIMIT_HIGH,
        LIMIT_LOW,
        HOME,
        CORNER_STEP,
        TOP_RPM,
        INCH_BITS,
        INCREMENT_BITS,
    }
    read_here |= {LOOK_AHEAD_RATE, LOOK_AHEAD_TIME_MS, LOOK_AHEAD_MM_S2, *OFFSETS}
    told = [LeftOut(str(number), why) for number, why in LEFT_OUT.items() if number in listed]
    rest = len(listed.keys() - read_here - LEFT_OUT.keys())
    if rest:
        told.append(LeftOut(f"{rest} other parameters", "nothing here depends on them"))
    return Facts(
        control=CONTROL,
        axes=axes,
        left_out=tuple(told),
        spindle={} if rpm is None else {"max_rpm": rpm},
        offsets=offsets,
    )


def _parameters(text: str, file: str) -> dict[int, _Parameter]:
    listed: dict[int, _Parameter] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if not (match := LINE.match(line)):
            continue
        values = listed.setdefault(whole(match[1]), _Parameter({})).values
        for value in VALUE.finditer(match[2]):
            position = SourcePosition(file, number, match.start(2) + value.start(3) + 1, line)
            values[int(value[2]) if value[2] else 0] = Entry(f"parameter {match[1]}", value[3], position)
    return listed


def _value(listed: dict[int, _Parameter], number: int, index: int) -> Entry | None:
    found = listed.get(number)
    return None if found is None else found.values.get(index)


def _position(listed: dict[int, _Parameter], number: int, index: int, unit: float) -> float | None:
    entry = _value(listed, number, index)
    if entry is None:
        return None
    if "." in entry.text:
        return entry.number * unit
    bits = _value(listed, INCREMENT_BITS, index)
    increment = INCREMENT_MM
    if bits is not None:
        increment = FINE_MM if _bit(bits, 1) else COARSE_MM if _bit(bits, 0) else INCREMENT_MM
    return entry.number * increment * (1.0 if unit == 1.0 else 0.1 * unit)


def _unit(listed: dict[int, _Parameter], axis: str) -> float:
    """Return the millimetres of the machine's unit of length, 1 for an axis that turns."""
    if axis in "ABC":
        return 1.0
    bits = _value(listed, INCH_BITS, 0)
    return MM_PER_INCH if bits is not None and _bit(bits, 0) else 1.0


def _bit(entry: Entry, bit: int) -> bool:
    """Return a bit of a value that is written as eight of them, bit 7 first."""
    return entry.text[::-1][bit : bit + 1] == "1"


def _axis(listed: dict[int, _Parameter], index: int, file: str) -> AxisFacts:
    letter = _value(listed, NAMES, index)
    name = (
        chr(int(letter.number))
        if letter is not None and letter.number in range(65, 91)
        else "XYZABC"[index - 1 : index]
    )
    if not name:
        raise ConfigurationError(
            f"{file}: the name of axis {index} is not known",
            hint=f"Parameter {NAMES} holds the names of the axes.",
        )
    unit = _unit(listed, name)
    speed = listed[RAPID].values[index].positive * unit / 60.0
    step = _value(listed, CORNER_STEP, index)
    low, high = _position(listed, LIMIT_LOW, index, unit), _position(listed, LIMIT_HIGH, index, unit)
    limits = (low, high) if low is not None and high is not None and _watched(low, high) else None
    home = _position(listed, HOME, index, unit) or 0.0
    return AxisFacts(
        name,
        speed,
        _acceleration(listed, index, unit, speed, name, file),
        jump=step.number * unit / 60.0 if step is not None and step.number > 0.0 else None,
        limits=limits,
        home=home,
    )


def _watched(low: float, high: float) -> bool:
    return low < high and (abs(low) < NO_LIMIT_MM or abs(high) < NO_LIMIT_MM)


def _acceleration(
    listed: dict[int, _Parameter], index: int, unit: float, rapid_mm_s: float, name: str, file: str
) -> float:
    """Return the acceleration before interpolation where there is one, else what the rapid's ramp takes."""
    known = _value(listed, LOOK_AHEAD_MM_S2, index)
    if known is not None and known.number > 0.0:
        return known.number * unit
    rate, time_ms = _value(listed, LOOK_AHEAD_RATE, index), _value(listed, LOOK_AHEAD_TIME_MS, index)
    if rate is None and time_ms is None:  # one for all axes
        rate, time_ms = _value(listed, LOOK_AHEAD_RATE, 0), _value(listed, LOOK_AHEAD_TIME_MS, 0)
    if rate is not None and time_ms is not None and rate.number > 0.0 and time_ms.number > 0.0:
        return rate.number * unit / 60.0 / (time_ms.number * 1e-3)
    ramp_ms = _value(listed, RAPID_TIME_MS, index)
    if ramp_ms is not None and ramp_ms.number > 0.0:
        return rapid_mm_s / (ramp_ms.number * 1e-3)
    raise ConfigurationError(
        f"{file}: axis {name} has no acceleration",
        hint=f"Parameter {LOOK_AHEAD_MM_S2}, {LOOK_AHEAD_RATE} with {LOOK_AHEAD_TIME_MS}, or {RAPID_TIME_MS} says it.",
    )
