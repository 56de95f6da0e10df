"""The I/O image: what inputs and outputs are at this cycle, and which bits have just changed."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import entry
from polycnc.machine._config import IO_ADDRESS, IoConfig
from polycnc.units import whole

Row: TypeAlias = npt.NDArray[np.uint8] | npt.NDArray[np.int32]


class IoBits(NamedTuple):
    """A row of bits, each array uint8[bits] of 0 and 1: now, at the last scan, and what that scan found."""

    now: npt.NDArray[np.uint8]
    before: npt.NDArray[np.uint8]
    rising: npt.NDArray[np.uint8]
    falling: npt.NDArray[np.uint8]


@entry
def scan_edges(bits: IoBits) -> int:
    """Mark the bits that changed since the last call in `rising` and `falling`; return how many there are."""
    changes = 0
    for index in range(bits.now.size):
        now = bits.now[index]
        before = bits.before[index]
        bits.rising[index] = 1 if now > before else 0
        bits.falling[index] = 1 if now < before else 0
        bits.before[index] = now
        if now != before:
            changes += 1
    return changes


class IoImage:
    """Hold bits and words of inputs and outputs as arrays that compiled code shares.

    `inputs` and `outputs` are rows of bits (`IoBits`), `input_words` and `output_words` int32 arrays. A point
    is named by its address ("I3", "O5", "IW2", "OW1") or by its name in the configuration.
    """

    __slots__ = ("_points", "_rows", "input_words", "inputs", "output_words", "outputs")

    def __init__(self, config: IoConfig | None = None) -> None:
        config = config or IoConfig()
        self.inputs = _bits(config.inputs)
        self.outputs = _bits(config.outputs)
        self.input_words = np.zeros(config.input_words, dtype=np.int32)
        self.output_words = np.zeros(config.output_words, dtype=np.int32)
        self._points = dict(config.points)
        self._rows: dict[str, Row] = {
            "I": self.inputs.now,
            "O": self.outputs.now,
            "IW": self.input_words,
            "OW": self.output_words,
        }

    def __getitem__(self, point: str) -> int:
        """Return a bit (0 or 1) or a word.

        Raises:
            UsageError: There is no such point.
        """
        row, index = self._place(point)
        return int(row[index])

    def __setitem__(self, point: str, value: int) -> None:
        """Set a bit (0 or 1) or a word (32 bits, signed).

        Raises:
            UsageError: There is no such point, or the value does not fit.
        """
        row, index = self._place(point)
        low, high = (0, 1) if row.dtype == np.uint8 else (-(2**31), 2**31 - 1)
        if not low <= value <= high:
            raise UsageError(
                f"{value} does not fit into '{point}'", hint=f"give a value from {low} to {high}"
            )
        row[index] = value

    def scan(self) -> int:
        """Find the edges of all bits since the last scan; return how many there are."""
        return scan_edges(self.inputs) + scan_edges(self.outputs)

    def rose(self, point: str) -> bool:
        """Tell whether the last scan saw the bit go from 0 to 1.

        Raises:
            UsageError: There is no such bit.
        """
        bits, index = self._bit(point)
        return bool(bits.rising[index])

    def fell(self, point: str) -> bool:
        """Tell whether the last scan saw the bit go from 1 to 0.

        Raises:
            UsageError: There is no such bit.
        """
        bits, index = self._bit(point)
        return bool(bits.falling[index])

    def _bit(self, point: str) -> tuple[IoBits, int]:
        row, index = self._place(point)
        if row is self.inputs.now:
            return self.inputs, index
        if row is self.outputs.now:
            return self.outputs, index
        raise UsageError(f"'{point}' is a word and has no edges", hint='name a bit, like "I3" or "O5"')

    def _place(self, point: str) -> tuple[Row, int]:
        found = IO_ADDRESS.fullmatch(self._points.get(point, point))
        if found is None or whole(found[2]) >= self._rows[found[1]].size:
            sizes = ", ".join(
                f"{sort}0 to {sort}{row.size - 1}" for sort, row in self._rows.items() if row.size
            )
            names = f"; names: {', '.join(self._points)}" if self._points else ""
            raise UsageError(f"there is no I/O point '{point}'", hint=f"points: {sizes}{names}")
        return self._rows[found[1]], whole(found[2])


def _bits(count: int) -> IoBits:
    return IoBits(*(np.zeros(count, dtype=np.uint8) for _ in range(4)))
