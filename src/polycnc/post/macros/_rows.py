"""Write a macro for many moves at once where only their ends differ: compiled, with the same text as one by one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel import compiled, entry
from polycnc.post.macros._symbols import VariableSymbol

if TYPE_CHECKING:
    from polycnc.post.macros._compile import Style

SteadyLine: TypeAlias = tuple[bool, list[tuple[str] | tuple[str, bool]]]
"""Whether a line is numbered, and its pieces: texts with whether they are words, or an axis by its name."""

_CONVERSION = re.compile(r"%(?:\.([0-9]))?f")
_NUMBERING = re.compile(r"%(?:0([0-9]{1,2}))?\.0f")
_ZEROS = {"keep": 0, "trim": 1, "point": 2}
_AXES = "XYZ"
_MOST_DIGITS = 12  # of a number below `_LIMIT`, with its sign
_LIMIT = float(1 << 31)
_SPLITTER = float((1 << 27) + 1)
_ZERO, _MINUS, _POINT, _FEED = ord("0"), ord("-"), ord("."), ord("\n")

# Columns of an axis and of the numbering.
_MODAL, _DECIMALS, _TRIM, _BEFORE, _BEFORE_BYTES, _BEHIND, _BEHIND_BYTES = range(7)
_AXIS = 7
_STEP, _START, _HIGHEST, _WIDTH = range(4)
_LAST, _HAS_LAST, _COUNT, _BYTES, _BLOCKS = 0, 3, 6, 7, 8


@dataclass(frozen=True, slots=True)
class Rows:
    """What is written for a row, as arrays: pieces line by line, their texts, and how the axes are written."""

    variables: Mapping[str, VariableSymbol]
    _pieces: npt.NDArray[np.int64]
    _texts: npt.NDArray[np.uint8]
    _axes: npt.NDArray[np.int64]
    _scales: npt.NDArray[np.float64]
    _numbering: npt.NDArray[np.int64]
    _most_bytes: int

    @classmethod
    def of(
        cls, lines: Sequence[SteadyLine], variables: Mapping[str, VariableSymbol], style: Style
    ) -> Rows | None:
        """Return it; None if a number is written in a way that is not known here."""
        texts = bytearray()

        def place(text: str) -> tuple[int, int]:
            encoded = text.encode()
            texts.extend(encoded)
            return len(texts) - len(encoded), len(encoded)

        separator = place(style.separator)
        number = style.number_format
        counted = _NUMBERING.fullmatch(number.conversion)
        if counted is None and any(numbered for numbered, _ in lines):
            return None
        width = int(counted[1] or 1) if counted else 1
        limits = (style.number_step, style.number_start, style.number_highest, width)
        numbering = (*limits, *place(number.before), *place(number.behind), *separator)
        pieces: list[int] = []
        used: dict[str, VariableSymbol] = {}
        for numbered, parts in lines:
            pieces += (int(numbered), len(parts))
            for part in parts:
                if len(part) == 1:
                    used[part[0]] = variables[part[0]]
                    pieces += (1 + _AXES.index(part[0]), 0, 0, int(used[part[0]].separated))
                else:
                    pieces += (0, *place(part[0]), int(part[1]))
        axes = np.zeros((3, _AXIS), np.int64)
        scales = np.ones(3)
        for name, variable in used.items():
            form = variable.format
            found = _CONVERSION.fullmatch(form.conversion)
            if found is None:
                return None
            axis = _AXES.index(name)
            marks = (int(variable.modal), int(found[1] or 6), _ZEROS[form.zeros])
            axes[axis] = (*marks, *place(form.before), *place(form.behind))
            scales[axis] = form.scale
        spare = len(style.separator.encode()) + _MOST_DIGITS + 8
        return cls(
            used,
            np.array(pieces, np.int64),
            np.frombuffer(texts or bytearray(b" "), np.uint8),
            axes.ravel(),
            scales,
            np.array(numbering, np.int64),
            len(texts) + (len(pieces) + 4) * spare + width,
        )

    def write(
        self,
        ends: npt.NDArray[np.float64],
        lasts: Mapping[str, float | None],
        number: int,
        behind: npt.NDArray[np.int64],
    ) -> tuple[str, int, int, int]:
        """Return the blocks of rows, their number, how many rows are done, and the next sequence number.

        It ends before a number of more than nine digits. `lasts` is what was written last of each axis, and `after`
        gets how many blocks there are after each row.
        """
        state = np.zeros(9, np.int64)
        state[_COUNT] = number
        for name, value in lasts.items():
            if value is not None:
                axis = _AXES.index(name)
                decimals = int(self._axes[axis * _AXIS + _DECIMALS])
                scaled = value * float(self._scales[axis])
                if not abs(scaled) * 10.0**decimals < _LIMIT:
                    return "", 0, 0, number
                state[_LAST + axis] = int(f"{scaled:.{decimals}f}".replace(".", ""))
                state[_HAS_LAST + axis] = 1
        flat = np.ascontiguousarray(ends[:, :3]).ravel()
        size = min(len(ends), 64) * self._most_bytes + 48 * len(ends)
        done, texts = 0, []
        while True:
            out = np.empty(size, np.uint8)
            state[_BYTES] = 0
            more = write_rows(
                flat, done, self._pieces, self._texts, self._axes, self._scales, self._numbering,
                self._most_bytes, state, out, behind,
            )  # fmt: skip
            texts.append(out[: state[_BYTES]].tobytes().decode())
            if more == len(ends) or more == done:
                return "".join(texts), int(state[_BLOCKS]), more, int(state[_COUNT])
            done = more


@entry(
    steps=lambda rows, begin, *_: 10 * (len(rows) // 3 - begin) + 1,
    spared=lambda end, rows, *_: 10 * (len(rows) // 3 - end),
)
def write_rows(
    rows: npt.NDArray[np.float64],
    begin: int,
    pieces: npt.NDArray[np.int64],
    texts: npt.NDArray[np.uint8],
    axes: npt.NDArray[np.int64],
    scales: npt.NDArray[np.float64],
    numbering: npt.NDArray[np.int64],
    most_bytes: int,
    state: npt.NDArray[np.int64],
    out: npt.NDArray[np.uint8],
    behind: npt.NDArray[np.int64],
) -> int:
    """Write rows from `begin` on into `out`, and return the first that was not: out of space, or a long number."""
    count = len(rows) // 3
    at = 0
    for row in range(begin, count):
        if at + most_bytes > len(out):
            state[_BYTES] = at
            return row
        x, x_fits = _digits(rows[3 * row], scales[0], axes[_DECIMALS])
        y, y_fits = _digits(rows[3 * row + 1], scales[1], axes[_AXIS + _DECIMALS])
        z, z_fits = _digits(rows[3 * row + 2], scales[2], axes[2 * _AXIS + _DECIMALS])
        if not (x_fits and y_fits and z_fits):
            state[_BYTES] = at
            return row
        place = 0
        while place < len(pieces):
            numbered, parts = pieces[place], pieces[place + 1]
            place += 2
            before = at
            if numbered:
                at = _text(texts, numbering[4], numbering[5], out, at)
                at = _number(state[_COUNT], numbering[_WIDTH], out, at)
                at = _text(texts, numbering[6], numbering[7], out, at)
                at = _text(texts, numbering[8], numbering[9], out, at)
            first = at
            for part in range(place, place + 4 * parts, 4):
                axis = pieces[part] - 1
                value = x if axis == 0 else y if axis == 1 else z
                if axis >= 0 and axes[axis * _AXIS + _MODAL]:
                    if state[_HAS_LAST + axis] and state[_LAST + axis] == value:
                        continue
                    state[_HAS_LAST + axis] = 1
                    state[_LAST + axis] = value
                if pieces[part + 3] and at > first:
                    at = _text(texts, numbering[8], numbering[9], out, at)
                if axis < 0:
                    at = _text(texts, pieces[part + 1], pieces[part + 2], out, at)
                else:
                    at = _value(value, axes, axis * _AXIS, texts, out, at)
            place += 4 * parts
            if at == first:
                at = before
                continue
            out[at] = _FEED
            at += 1
            state[_BLOCKS] += 1
            if numbered:
                following = state[_COUNT] + numbering[_STEP]
                wraps = numbering[_HIGHEST] and following > numbering[_HIGHEST]
                state[_COUNT] = numbering[_START] if wraps else following
        behind[row] = state[_BLOCKS]
    state[_BYTES] = at
    return count


@compiled
def _digits(value: float, scale: float, decimals: int) -> tuple[int, bool]:
    """Return a number rounded to decimals, as a whole number of them, and whether it is short enough.

    It is rounded as printf does: by the exact value of the double, ties to even. The product is exact as the sum of
    two doubles.
    """
    number = value * scale
    power = 10.0**decimals
    product = number * power
    if not abs(product) < _LIMIT:
        return 0, False
    high = number * _SPLITTER
    high -= high - number
    low = number - high
    power_high = power * _SPLITTER
    power_high -= power_high - power
    power_low = power - power_high
    rest = ((high * power_high - product) + high * power_low + low * power_high) + low * power_low
    whole = np.floor(product)
    half = (product - whole) - 0.5
    found = int(whole)
    if half > 0.0 or (half == 0.0 and (rest > 0.0 or (rest == 0.0 and found % 2 != 0))):
        found += 1
    return found, True


@compiled
def _text(texts: npt.NDArray[np.uint8], begin: int, size: int, out: npt.NDArray[np.uint8], at: int) -> int:
    for place in range(size):
        out[at + place] = texts[begin + place]
    return at + size


@compiled
def _number(value: int, width: int, out: npt.NDArray[np.uint8], at: int) -> int:
    """Write a whole number from 0 up with at least so many digits."""
    digits = 1
    rest = value // 10
    while rest > 0:
        digits += 1
        rest //= 10
    digits = max(digits, width)
    rest = value
    for place in range(digits - 1, -1, -1):
        out[at + place] = _ZERO + rest % 10
        rest //= 10
    return at + digits


@compiled
def _value(
    value: int,
    axes: npt.NDArray[np.int64],
    axis: int,
    texts: npt.NDArray[np.uint8],
    out: npt.NDArray[np.uint8],
    at: int,
) -> int:
    """Write a word: its address, the number with its point, and what stands after."""
    at = _text(texts, axes[axis + _BEFORE], axes[axis + _BEFORE_BYTES], out, at)
    decimals, trim = axes[axis + _DECIMALS], axes[axis + _TRIM]
    if value < 0:
        out[at] = _MINUS
        at += 1
        value = -value
    power = 1
    for _ in range(decimals):
        power *= 10
    at = _number(value // power, 1, out, at)
    if decimals > 0:
        out[at] = _POINT
        at = _number(value % power, decimals, out, at + 1)
        if trim:
            while out[at - 1] == _ZERO:
                at -= 1
            if trim == 1 and out[at - 1] == _POINT:
                at -= 1
    return _text(texts, axes[axis + _BEHIND], axes[axis + _BEHIND_BYTES], out, at)
