"""Read a grbl or grblHAL settings listing (`$$`), with the offsets of `$#` where they are in the file."""

from __future__ import annotations

import re

from polycnc.errors import SourcePosition
from polycnc.runner.machine_sources._facts import (
    AXIS_LETTERS,
    AxisFacts,
    Entry,
    Facts,
    LeftOut,
    Settings,
    others,
)

CONTROL = "the settings of grbl"
SETTING = re.compile(r"\s*\$(\d{1,3})\s*=\s*([^\s(]*)")
OFFSET = re.compile(r"\s*\[(G5[4-9]):([^\]]*)\]")
AXES = 6
DEVIATION_MM = 0.01  # what the control takes where the listing says nothing
SPEED, ACCELERATION, TRAVEL = 110, 120, 130  # the first axis; mm/min, mm/s2, mm
DEVIATION, ARC_TOLERANCE, SOFT_LIMITS, HOMING, HOME_SIDES, PULL_OFF, TOP_RPM, LASER = (
    11,
    12,
    20,
    22,
    23,
    27,
    30,
    32,
)
LEFT_OUT = {f"${ARC_TOLERANCE}": "arcs are traversed as arcs, not as chords"}


def recognises(text: str) -> bool:
    """Tell whether `text` lists at least the speed and the acceleration of an axis."""
    found = {match[1] for match in map(SETTING.match, text.splitlines()) if match}
    return {str(SPEED), str(ACCELERATION)} <= found


def read(text: str, file: str) -> Facts:
    """Return what the listing says.

    Raises:
        ConfigurationError: A value is no number, or an axis has a speed and no acceleration.
    """
    settings, offsets = _settings(text, file)
    travel_known = bool(offsets)
    limited = settings.switch(f"${SOFT_LIMITS}")
    sides = int(settings.number(f"${HOME_SIDES}", 0.0))
    homing, pull_off = settings.switch(f"${HOMING}"), settings.number(f"${PULL_OFF}", 0.0)
    axes, left = [], []
    for index in range(AXES):
        speed = settings.get(f"${SPEED + index}")
        if speed is None:
            continue
        acceleration = settings.need(
            f"${ACCELERATION + index}", f"the acceleration of axis {AXIS_LETTERS[index]}"
        )
        travel = settings.get(f"${TRAVEL + index}")
        limits, home = None, 0.0
        if limited and travel is not None:
            if travel_known:
                limits = (-travel.positive, 0.0)
            else:
                left.append(f"{AXIS_LETTERS[index]} {-travel.positive:g} to 0")
            if homing and travel_known:
                home = pull_off - travel.positive if sides >> index & 1 else -pull_off
        axes.append(
            AxisFacts(
                AXIS_LETTERS[index], speed.positive / 60.0, acceleration.positive, limits=limits, home=home
            )
        )
    top = settings.get(f"${TOP_RPM}")
    spindle: dict[str, float | bool] = {} if top is None else {"max_rpm": top.positive}
    if settings.switch(f"${LASER}"):
        spindle["laser"] = True
    deviation_mm = settings.positive(f"${DEVIATION}", DEVIATION_MM)
    left_out = others(settings, LEFT_OUT)
    if left:
        why = "where the program's zero lies is not in this file; add the output of $# and make it again"
        left_out = (LeftOut("travel " + ", ".join(left), why), *left_out)
    names = [axis.name for axis in axes]
    return Facts(
        control=CONTROL,
        axes=tuple(axes),
        left_out=left_out,
        path={"junction_deviation_mm": deviation_mm},
        spindle=spindle,
        offsets={name: dict(zip(names, values, strict=False)) for name, values in offsets.items()},
    )


def _settings(text: str, file: str) -> tuple[Settings, dict[str, list[float]]]:
    entries: dict[str, Entry] = {}
    offsets: dict[str, list[float]] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if match := SETTING.match(line):
            position = SourcePosition(file, number, match.start(2) + 1, line)
            entries[f"${match[1]}"] = Entry(f"${match[1]}", match[2], position)
        elif match := OFFSET.match(line):
            position = SourcePosition(file, number, match.start(2) + 1, line)
            offsets[match[1]] = [Entry(match[1], each, position).number for each in match[2].split(",")]
    return Settings(file, entries), offsets
