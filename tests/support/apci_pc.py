"""A PC with one virtual APCI board, initialised, whose time moves only when a test says so."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._system_file import parse_system_file

SCAN_S = 0.00128
LATENCY = 2  # scans until a direct command takes effect


def near(value: Any, **tolerance: Any) -> Any:
    """Return what compares equal to numbers near `value`, in tuples too."""
    return pytest.approx(value, **tolerance)


class Pc:
    """The board, and the records that InitMcuSystem3 has filled."""

    def __init__(self, system: str = "", **options: Any) -> None:
        self.board = Board(parse_system_file(system), record_scans=options.pop("record_scans", 0))
        self.tsrp = pcap.tsrp_array()
        self.rosi = pcap.ROSI()
        (self.slot,) = pcap.attach(self.board, **{"clock": None, **options})
        self.code, self.board_type = pcap.InitMcuSystem3(self.tsrp, self.rosi, 0, "system.dat")

    def run(self, duration_s: float) -> None:
        """Let whole scans pass, as many as end by `duration_s`."""
        self.board.advance(int(duration_s / SCAN_S + 1e-9))

    def scans_until_rest(self, limit: int = 20_000) -> int:
        """Let scans pass until all profiles have ended; return how many."""
        done = 0
        while any(axis.is_busy for axis in self.board.axes) and done < limit:
            done += self.board.advance(1)
        return done

    def rp(self, an: int) -> float:
        """Return an actual position through the library."""
        pcap.rdrp(self.tsrp[an])
        return self.tsrp[an].rp

    def dv(self, an: int) -> float:
        """Return a profile velocity through the library."""
        pcap.rddv(self.tsrp[an])
        return self.tsrp[an].dv

    def close(self, *axes: int) -> pcap.AS:
        """Close the loops of axes and return their selection."""
        selection = pcap.AS.of(*axes)
        pcap.cl(selection)
        return selection

    def error(self) -> int:
        """Return the error register through the library."""
        return int(pcap.rdErrorReg())
