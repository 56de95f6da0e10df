"""Latching positions by the scan, and recording for the graphical system analysis (Manual 002, 4.4.25 to 4.4.27)."""

from __future__ import annotations

from polycnc.controllers.apci._pcap_library import Recording, library, selected, usable_axis
from polycnc.controllers.apci._records import AS, LATCH_INFOS


def lps(an: int, mst: int) -> None:
    """Latch the actual position of an axis every `mst` scans, until `mst` is 0 (Manual 002, 4.4.27)."""
    axis = usable_axis(an)
    if axis is not None and mst >= 0:
        axis.row["latch_scans"], axis.row["latch_count"] = int(mst), 0


def lpr(latch_infos: LATCH_INFOS) -> None:
    """Start recording axis `latch_infos.san`; `recording` returns it (Manual 002, 4.4.25)."""
    lprs(AS(1, [latch_infos.san]), latch_infos)


def lprs(asel: AS, latch_infos: LATCH_INFOS) -> None:
    """Start recording the selected axes together; `latch_infos.san` is ignored (Manual 002, 4.4.26)."""
    found = selected(asel)
    if found is not None:
        board, axes = found
        library().recording = Recording(board, axes, int(board.kernel.recorder.filled[0]))


def recording() -> Recording | None:
    """Return the recording that lpr or lprs started last; mcfg.exe shows it on the real board."""
    return library().recording
