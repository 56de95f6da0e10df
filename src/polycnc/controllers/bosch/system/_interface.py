"""IC: the bits of the digital interface between CNC and PLC (Manual 003, 4.11)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import IntEnum

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER, whole
from polycnc.nc.cpl import OMITTED, Fault


class Signals(IntEnum):
    """Groups of interface signals."""

    CHANNEL_INPUTS = 0
    AXIS_INPUTS = 1
    SPINDLE_INPUTS = 2
    CHANNEL_OUTPUTS = 3
    AXIS_OUTPUTS = 4
    SPINDLE_OUTPUTS = 5
    GLOBAL_INPUTS = 6
    GLOBAL_OUTPUTS = 7
    FAST_INPUTS = 8
    FAST_OUTPUTS = 9


MODE_BY_PLC = (Signals.CHANNEL_INPUTS, 24)
"""NC-I 3.0: the PLC sets the operation mode."""
RESET_EXECUTED = (Signals.CHANNEL_OUTPUTS, 2)
"""IF 0.2: a control reset was executed."""
_SIZES = (112, 112, 112, 96, 64, 64, 32, 32, 8, 6)
_FAST_OUTPUTS_OF_PNC = 8
_WRITABLE = range(80, 96)
_OF_CHANNELS = (Signals.CHANNEL_INPUTS, Signals.CHANNEL_OUTPUTS)


class Interface:
    """The signals of a control, all FALSE at first; bits count from 0.

    Args:
        channels: How many channels there are; index 0 stands for what all of them share.
        axes: How many axes there are.
        spindles: How many spindles there are.
        pnc: Whether the high-speed interface has the 8 outputs of a PNC, else 6.
    """

    def __init__(self, channels: int, axes: int, spindles: int, *, pnc: bool = True) -> None:
        self.sizes = (*_SIZES[:9], _FAST_OUTPUTS_OF_PNC) if pnc else _SIZES
        of_channel, of_axis, of_spindle = range(channels + 1), range(1, axes + 1), range(1, spindles + 1)
        alone = range(1, 2)
        self._indices = (of_channel, of_axis, of_spindle, of_channel, of_axis, of_spindle, *4 * (alone,))
        self._words: dict[tuple[int, int], int] = {}

    def bit(self, group: Signals, index: int, bit: int) -> bool:
        """Return a signal."""
        return bool(self._words.get((group, index), 0) >> bit & 1)

    def set_bit(self, group: Signals, index: int, bit: int, value: bool) -> None:
        """Set a signal."""
        word = self._words.get((group, index), 0)
        self._words[group, index] = word | 1 << bit if value else word & ~(1 << bit)

    def save(self) -> list[tuple[int, int, int]]:
        """Return the signals as plain data: group, index, bits."""
        return [(int(group), index, word) for (group, index), word in self._words.items()]

    def has(self, group: int, index: int, word: int) -> bool:
        """Tell whether there are signals of this group and index, and all bits of a word among them."""
        return (
            group in range(len(self.sizes))
            and index in self._indices[group]
            and word >> self.sizes[group] == 0
        )

    def restore(self, words: Iterable[Sequence[int]]) -> None:
        """Go back to signals."""
        self._words = {(group, index): word for group, index, word in words}

    def read(self, active: int, bit: object, group: object = OMITTED, index: object = OMITTED) -> bool:
        """Return the signal that IC names in channel `active`.

        Raises:
            Fault: There is none.
        """
        place, kind, number = self._place(active, bit, group, index)
        return self.bit(kind, number, place)

    def write(
        self, value: object, active: int, bit: object, group: object = OMITTED, index: object = OMITTED
    ) -> None:
        """Set an output signal of a channel, 81 to 96, which are bits 80 to 95 of group 0.

        Raises:
            Fault: It is another one, or the value is no BOOLEAN.
        """
        place, kind, number = self._place(active, bit, group, index)
        if kind != Signals.CHANNEL_INPUTS or place not in _WRITABLE:
            raise Fault(INVALID_PARAMETER, "IC sets bits 80 to 95 of group 0 only")
        if not isinstance(value, bool):
            raise Fault("INVALID ASSIGNMENT", "IC takes TRUE or FALSE")
        self.set_bit(Signals.CHANNEL_OUTPUTS, number, place, value)

    def _place(self, active: int, bit: object, group: object, index: object) -> tuple[int, Signals, int]:
        kind = Signals(whole(group, "group", range(10), 0))
        default = active if kind in _OF_CHANNELS else 1
        number = whole(index, "index", self._indices[kind], default)
        return whole(bit, "bit", range(self.sizes[kind])), kind, number
