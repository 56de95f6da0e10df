"""What a Power Mate is built from: software, memory modules and boards, as cnc_sysconfig shows them (Manual 000)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from polycnc.errors import UsageError

NOT_MOUNTED = "not mounted"
# fmt: off
FROM_MODULES = MappingProxyType({NOT_MOUNTED: -1, "2 MB": 0, "4 MB": 2})
DRAM_MODULES = MappingProxyType({NOT_MOUNTED: -1, "2 MB": 0, "2.5 MB": 1, "3 MB": 3})
SRAM_MODULES = MappingProxyType({
    NOT_MOUNTED: -1, "256 KB, type 0": 0, "1 MB, type 1": 1, "1 MB": 2, "512 KB": 3, "256 KB": 4, "128 KB": 5,
    "768 KB": 6, "none": 7,
})
PMC_MODULES = MappingProxyType({
    NOT_MOUNTED: -1, "PMP2 and SLC": 0, "bit operation module": 1, "PMP module": 2, "none": 3,
})
SUB_BOARDS = MappingProxyType({
    NOT_MOUNTED: -1, "RS485": 1, "built-in I/O": 2, "M-NET": 3, "I/O Link 2": 7,
})
# fmt: on
SOFTWARE = MappingProxyType({"H": ("8880", "0014"), "D": ("8831", "0009")})
"""Series and version of the software of a model; those of the H are the manual's sample."""
CNC_SOFTWARE, END_OF_LIST = 0x40, 0xFF


@dataclass(frozen=True, slots=True)
class Configuration:
    """Name the modules of a control; without a ladder or macro executor their text is empty.

    Raises:
        UsageError: There is no such module.
    """

    from_module: str = "4 MB"
    dram_module: str = "3 MB"
    sram_module: str = "512 KB"
    pmc_module: str = "PMP2 and SLC"
    sub_board: str = NOT_MOUNTED
    sic: bool = True
    position_lsi: bool = True
    high_speed_skip: bool = True
    servo: str = "90600004"
    pmc: str = "406001"
    ladder: str = ""
    macro_executor: str = ""

    def __post_init__(self) -> None:
        for table, name in (
            (FROM_MODULES, self.from_module),
            (DRAM_MODULES, self.dram_module),
            (SRAM_MODULES, self.sram_module),
            (PMC_MODULES, self.pmc_module),
            (SUB_BOARDS, self.sub_board),
        ):
            _check(table, name)
        for text, lengths in (
            (self.servo, {8}),
            (self.pmc, {6}),
            (self.ladder, {0, 6}),
            (self.macro_executor, {0, 6}),
        ):
            if len(text) not in lengths or not text.isascii():
                raise UsageError(
                    f"'{text}' is no series with a version", hint=f"It has {max(lengths)} characters."
                )


def _check(table: Mapping[str, int], name: str) -> None:
    if name not in table:
        raise UsageError(f"there is no module '{name}'", hint=f"There are {', '.join(table)}.")
