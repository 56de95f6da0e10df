"""PLC: data of the PLC by type and address (Manual 003, 4.11)."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum

from polycnc.controllers.bosch.system._arguments import INVALID_PARAMETER, whole
from polycnc.nc.cpl import OMITTED, Fault


class PlcRange(IntEnum):
    """Types of PLC data."""

    INPUT = 1
    OUTPUT = 2
    MARKER = 3
    DATA_WORD = 4
    DATA_BUFFER = 5
    DATA_FIELD = 6
    TIMER = 7
    COUNTER = 8
    SPECIAL_MARKER = 9
    SYSTEM = 10
    EXTENDED_INPUT = 11
    EXTENDED_OUTPUT = 12


_NUMBERS = (PlcRange.TIMER, PlcRange.COUNTER)
_SIZES = (1, 2, 4)


@dataclass(slots=True)
class PlcData:
    """The ranges of a PLC; low bytes come first, bytes and words have no sign.

    `timers_ms` and `counters` are values by number; `first_writable` and `writable` are MACODA 2060 00100 and 00110:
    which data modules a part program may write.
    """

    ranges: dict[PlcRange, bytearray] = field(default_factory=dict)
    modules: dict[int, bytearray] = field(default_factory=dict)
    timers_ms: dict[int, int] = field(default_factory=dict)
    counters: dict[int, int] = field(default_factory=dict)
    first_writable: int = 0
    writable: int = 0

    def read(self, kind: object, module: object, address: object, size: object = OMITTED) -> int:
        """Return a value.

        Raises:
            Fault: The PLC has no such data.
        """
        which = PlcRange(whole(kind, "type", range(1, 13)))
        if which in _NUMBERS:
            self._check_module(which, module)
            values = self.timers_ms if which == PlcRange.TIMER else self.counters
            return values[whole(address, "number", values.keys())]
        data, start, length = self._place(which, module, address, size)
        return int.from_bytes(data[start : start + length], "little", signed=length == 4)

    def write(
        self, value: object, kind: object, module: object, address: object, size: object = OMITTED
    ) -> None:
        """Write into a data module.

        Raises:
            Fault: It is none that may be written, or the value does not fit.
        """
        which = PlcRange(whole(kind, "type", range(1, 13)))
        if which != PlcRange.DATA_WORD:
            raise Fault(INVALID_PARAMETER, "only data modules can be written: type 4")
        data, start, length = self._place(which, module, address, size)
        if whole(module, "data module", self.modules) not in range(
            self.first_writable, self.first_writable + self.writable
        ):
            raise Fault(
                INVALID_PARAMETER, "MACODA 2060 00100 and 2060 00110 say which modules can be written"
            )
        lowest = -(2**31) if length == 4 else 0
        highest = 2**31 - 1 if length == 4 else 256**length - 1
        number = whole(value, "value", range(lowest, highest + 1))
        data[start : start + length] = number.to_bytes(length, "little", signed=length == 4)

    def _place(
        self, which: PlcRange, module: object, address: object, size: object
    ) -> tuple[bytearray, int, int]:
        self._check_module(which, module)
        if which == PlcRange.DATA_WORD:
            data = self.modules[whole(module, "data module", self.modules.keys())]
        else:
            data = self.ranges.get(which, bytearray())
        length = whole(size, "size", _SIZES)
        return data, whole(address, "address", range(len(data) - length + 1)), length

    def _check_module(self, which: PlcRange, module: object) -> None:
        if (module is OMITTED) == (which == PlcRange.DATA_WORD):
            raise Fault(INVALID_PARAMETER, "a data module's number belongs to type 4 only: PLC(1,,10,1)")
