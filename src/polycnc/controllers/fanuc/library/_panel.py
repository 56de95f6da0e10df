"""Functions of the software operator's panel (Manual 000, cnc_rdopnlsgnl and those after it)."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.device._panel import GENERAL, MEMBERS, NAME_LENGTH
from polycnc.controllers.fanuc.library._call import call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import IODBGNRL, IODBRDNA, IODBSGNL
from polycnc.controllers.library import IN, SHORT, Out, Refused

_SELECTION = sum(1 << bit for bit in MEMBERS)
_GENERAL = (1 << GENERAL) - 1


@call
def cnc_rdopnlsgnl(link: Link, slct_data: SHORT) -> tuple[EW, Annotated[IODBSGNL, Out("sgnl")]]:
    """Read the signals of the panel whose bits are 1; `type` says which were read (Manual 000, cnc_rdopnlsgnl)."""
    panel = link.read("cnc_rdopnlsgnl", slct_data).panel
    made = IODBSGNL(type=slct_data & _SELECTION)
    for bit, (name, _) in MEMBERS.items():
        if slct_data >> bit & 1:
            setattr(made, name, panel.value(name))
    return EW.EW_OK, made


@call
def cnc_wropnlsgnl(link: Link, sgnl: Annotated[IODBSGNL, IN]) -> EW:
    """Write the signals of the panel whose bits are 1 in `type` (Manual 000, cnc_wropnlsgnl)."""
    values = {}
    for bit, (name, most) in MEMBERS.items():
        if sgnl.type >> bit & 1:
            values[name] = getattr(sgnl, name)
            if not 0 <= values[name] <= most:
                raise Refused(EW.EW_DATA)
    link.command().panel.set(values)
    return EW.EW_OK


@call
def cnc_rdopnlgnrl(link: Link, slct_data: SHORT) -> tuple[EW, Annotated[IODBGNRL, Out("opnlgnrl")]]:
    """Read the general-purpose signals whose bits are 1 (Manual 000, cnc_rdopnlgnrl)."""
    panel = link.read("cnc_rdopnlgnrl", slct_data).panel
    chosen = slct_data & _GENERAL
    return EW.EW_OK, IODBGNRL(type=chosen, sgnal=panel.general & chosen)


@call
def cnc_wropnlgnrl(link: Link, opnlgnrl: Annotated[IODBGNRL, IN]) -> EW:
    """Write the general-purpose signals whose bits are 1 in `type` (Manual 000, cnc_wropnlgnrl)."""
    link.command().panel.set_general(opnlgnrl.type & _GENERAL, opnlgnrl.sgnal)
    return EW.EW_OK


@call
def cnc_rdopnlgsname(link: Link, slct_data: SHORT) -> tuple[EW, Annotated[IODBRDNA, Out("brdna")]]:
    """Read the names of the general-purpose signals whose bits are 1 (Manual 000, cnc_rdopnlgsname)."""
    panel = link.read("cnc_rdopnlgsname", slct_data).panel
    made = IODBRDNA(type=slct_data & _GENERAL)
    for signal in range(1, GENERAL + 1):
        if slct_data >> signal - 1 & 1:
            setattr(made, f"sgnl{signal}_name", panel.name(signal).encode("latin-1"))
    return EW.EW_OK, made


@call
def cnc_wropnlgsname(link: Link, brdna: Annotated[IODBRDNA, IN]) -> EW:
    """Name the general-purpose signals whose bits are 1 in `type`, by 8 characters (Manual 000, cnc_wropnlgsname)."""
    names = {
        signal: getattr(brdna, f"sgnl{signal}_name")[:NAME_LENGTH].ljust(NAME_LENGTH).decode("latin-1")
        for signal in range(1, GENERAL + 1)
        if brdna.type >> signal - 1 & 1
    }
    link.command().panel.set_names(names)
    return EW.EW_OK


__all__ = [
    "cnc_rdopnlgnrl",
    "cnc_rdopnlgsname",
    "cnc_rdopnlsgnl",
    "cnc_wropnlgnrl",
    "cnc_wropnlgsname",
    "cnc_wropnlsgnl",
]
