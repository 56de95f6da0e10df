"""Functions of the PMC: its memory by address letter and range (Manual 000, PMC)."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.device._pmc_memory import LETTERS, PARTS, exists, parts_of, writable
from polycnc.controllers.fanuc.library._call import call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import HEADER, IODBPMC, ODBPMCINF
from polycnc.controllers.library import SHORT, Bytes, LengthOf, Out, Refused

_HEADER = 8
_SIZES = (1, 2, 4)
_ALL = -1
_PROTECTED = 0x80


def _letter(link: Link, kind: int, data_type: int, first: int, last: int, length: int) -> str:
    """Return the letter of an address kind after all checks."""
    if not link.device.has_option("pmc"):
        raise Refused(EW.EW_NOPMC)
    if not 0 <= data_type < len(_SIZES) or not 0 <= kind < len(LETTERS):
        raise Refused(EW.EW_ATTRIB)
    count = last - first + 1
    if count < 1:
        raise Refused(EW.EW_NUMBER)
    if count % _SIZES[data_type] or length != _HEADER + count:
        raise Refused(EW.EW_LENGTH)
    if not exists(LETTERS[kind], first, last):
        raise Refused(EW.EW_NUMBER)
    return LETTERS[kind]


@call
def pmc_rdpmcrng(
    link: Link,
    adr_type: SHORT,
    data_type: SHORT,
    s_number: SHORT,
    e_number: SHORT,
    length: Annotated[SHORT, LengthOf("buf")],
) -> tuple[EW, Annotated[IODBPMC, Out("buf")]]:
    """Read PMC addresses, in bytes, as bytes, words or longs (Manual 000, pmc_rdpmcrng)."""
    letter = _letter(link, adr_type, data_type, s_number, e_number, length)
    data = link.read("pmc_rdpmcrng", letter, s_number, e_number).pmc.read(letter, s_number, e_number)
    made = HEADER.make("IODBPMC", PMC_ITEMS=len(data) // _SIZES[data_type])(
        type_a=adr_type, type_d=data_type, datano_s=s_number, datano_e=e_number
    )
    part = (made.u.cdata, made.u.idata, made.u.ldata)[data_type]
    memoryview(part).cast("B")[:] = data
    return EW.EW_OK, made


@call
def pmc_wrpmcrng(
    link: Link, length: Annotated[SHORT, LengthOf("buf")], buf: Annotated[bytes, Bytes("IODBPMC *")]
) -> EW:
    """Write PMC addresses; F, X, R9000 on and K17 on are protected (Manual 000, pmc_wrpmcrng).

    Ruling: a protected address is refused as EW_PROT.
    """
    if not _HEADER <= length <= len(buf):
        raise Refused(EW.EW_LENGTH)
    kind, data_type, first, last = (
        int.from_bytes(buf[k : k + 2], "little", signed=True) for k in range(0, _HEADER, 2)
    )
    letter = _letter(link, kind, data_type, first, last, length)
    if not writable(letter, first, last):
        raise Refused(EW.EW_PROT)
    link.command().pmc.write(letter, first, buf[_HEADER:length])
    return EW.EW_OK


@call
def pmc_rdpmcinfo(link: Link, adr_type: SHORT) -> tuple[EW, Annotated[ODBPMCINF, Out("pmcif")]]:
    """Read which addresses of a kind, or of all (-1), there are and which are protected (Manual 000, pmc_rdpmcinfo).

    Ruling: the order is that of the kinds, and addresses stand apart where only some of a letter are protected.
    """
    if not _ALL <= adr_type < len(LETTERS):
        raise Refused(EW.EW_ATTRIB)
    link.read("pmc_rdpmcinfo", adr_type)
    parts = PARTS if adr_type == _ALL else parts_of(LETTERS[adr_type])
    made = ODBPMCINF(datano=len(parts))
    for entry, part in zip(made.info, parts, strict=False):
        entry.pmc_adr = ord(part.letter)
        entry.adr_attr = 0 if part.writable else _PROTECTED
        entry.top_num, entry.last_num = part.first, part.last
    return EW.EW_OK, made


__all__ = ["pmc_rdpmcinfo", "pmc_rdpmcrng", "pmc_wrpmcrng"]
