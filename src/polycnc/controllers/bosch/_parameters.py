"""MACODA parameters of a control: what the machine file says of it, and what its root adds (Manual 003, MCA)."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from polycnc.controllers.bosch._axes import SystemAxes
from polycnc.controllers.bosch.system import Macoda
from polycnc.errors import ProgramError, SourcePosition
from polycnc.machine import MachineConfig

FILE = "macoda.dat"
BASIC_SETTING = -1
LANGUAGE = 601000010
FIRST_MODULE, MODULES = 206000100, 206000110
TABLE_UNIT = 902000010
SEARCH_PATH, LINK_FOLDER = 308000001, 308000004
DIALOG_CHANNEL, DIALOG_CALLS, DIALOG_PROGRAMS = 308000005, 308000006, 308000007
PROBING_AXES = 100300012
LANGUAGE_GB = 44
_ENDLESS = 1e9
_MOVES = {"linear": 1, "rotary": 2}
_MODULO = 3
_CUSTOMER = 16
_LINE = re.compile(r"\s*(\d{4})\s*(\d{5})\s*(?:\[\s*(-?\d+)\s*\])?\s*=\s*(.+?)\s*")
Value = int | float | str


def parameters(config: MachineConfig, axes: SystemAxes) -> dict[tuple[int, int], Sequence[Value]]:
    """Return the parameters by number and channel; lists by axis have one element for each physical index."""
    by_number = dict(zip(axes.numbers, config.axes, strict=True))
    numbers = range(1, max(axes.numbers) + 1)
    axis_of = [by_number.get(number) for number in numbers]
    window = [
        0.0 if each is None or math.isinf(each.servo.in_position) else each.servo.in_position
        for each in axis_of
    ]
    found: dict[tuple[int, int], Sequence[Value]] = {
        (100300001, BASIC_SETTING): ["" if each is None else each.name for each in axis_of],
        (100300002, BASIC_SETTING): [axes.channel_of(number) or 0 for number in numbers],
        (100300004, BASIC_SETTING): [
            0 if each is None else _MODULO if each.modulo else _MOVES[each.kind] for each in axis_of
        ],
        (PROBING_AXES, BASIC_SETTING): [int(each is not None) for each in axis_of],
        (101500100, BASIC_SETTING): window,
        (102000001, BASIC_SETTING): [
            0.0 if each is None else max(min(each.soft_limits[1], _ENDLESS), -_ENDLESS) for each in axis_of
        ],
        (FIRST_MODULE, BASIC_SETTING): [0],
        (MODULES, BASIC_SETTING): [0],
        (SEARCH_PATH, BASIC_SETTING): ["/"],
        (LINK_FOLDER, BASIC_SETTING): ["/"],
        (DIALOG_CHANNEL, BASIC_SETTING): [1],
        (DIALOG_CALLS, BASIC_SETTING): [""],
        (DIALOG_PROGRAMS, BASIC_SETTING): ["cpldlg05.dlg"],
        (308000200, BASIC_SETTING): [".npv"],
        (501000001, BASIC_SETTING): [0] * _CUSTOMER,
        (501000002, BASIC_SETTING): [0] * _CUSTOMER,
        (600100020, BASIC_SETTING): [0],
        (LANGUAGE, BASIC_SETTING): [LANGUAGE_GB],
        (TABLE_UNIT, BASIC_SETTING): [0],
        (903000002, BASIC_SETTING): [0],
        (706000010, BASIC_SETTING): ["G1", "G17", "G40", "G53", "G71", "G90", "G94"],
        (706000020, BASIC_SETTING): ["G1", "G17", "G40", "G53", "G71", "G90", "G94"],
        (708000010, BASIC_SETTING): [""],
        (701000020, BASIC_SETTING): list(axes.names),
    }
    for channel, own in axes.channels.items():
        found[701000010, channel] = [axes.logical_name(channel, number) for number in own]
    return found


def macoda(
    config: MachineConfig, axes: SystemAxes, channel: int, text: str | None
) -> tuple[Macoda, list[ProgramError]]:
    """Return MCA's parameters for a channel, the root's before the machine's, and what is wrong there."""
    found, errors = parameters(config, axes), []
    for number, line in enumerate((text or "").splitlines(), 1):
        if not line.strip() or line.lstrip().startswith(";"):
            continue
        read = _LINE.fullmatch(line)
        values = None if read is None else _values(read[4])
        if read is None or values is None:
            errors.append(
                ProgramError(
                    "this is no MACODA parameter",
                    position=SourcePosition(FILE, number, 1, line),
                    hint='write it like: 5010 00001 [1] = 3, 2.5, "TEXT"',
                )
            )
            continue
        found[int(read[1] + read[2]), int(read[3] or BASIC_SETTING)] = values
    return Macoda(channel, len(axes.channels), found), errors


def _values(text: str) -> list[Value] | None:
    found: list[Value] = []
    for each in text.split(","):
        word = each.strip()
        if len(word) >= 2 and word[0] == word[-1] == '"':
            found.append(word[1:-1])
        elif re.fullmatch(r"[+-]?\d{1,9}", word):
            found.append(int(word))
        elif re.fullmatch(r"[+-]?\d{0,9}\.\d{0,9}", word) and any(char.isdigit() for char in word):
            found.append(float(word))
        else:
            return None
    return found
