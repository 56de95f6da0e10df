"""Functions about programs: transfer, search, deletion, directory, what is executed, MDI (Manual 000, programs)."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.device._program_rules import (
    Objection,
    delete_program,
    holds_programs,
    search_program,
)
from polycnc.controllers.fanuc.device._programs import FIRST, LAST
from polycnc.controllers.fanuc.device._transfer import Fault, Transfer, TransferError, Upload
from polycnc.controllers.fanuc.library._call import call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import ODBMDIP, ODBNC, ODBPRO, ODBSEQ, ODBUP, PRGDIR
from polycnc.controllers.library import INOUT, LONG, SHORT, USHORT, Bytes, LengthOf, Out, Refused, variant

CHARS: TypeAlias = Annotated[Any, Bytes("char *")]
"""Characters, which a program may pass as text or as bytes; a function gets bytes."""

PIECE_MOST = 256
MDI_MOST = 199
_INFO_LENGTHS = {0: (12,), 1: (31, 32)}

_FAULTS = {Fault.PROTECTED: EW.EW_PROT, Fault.FULL: EW.EW_OVRFLOW, Fault.RESET: EW.EW_RESET}
_OBJECTIONS = {Objection.BUSY: EW.EW_BUSY, Objection.MISSING: EW.EW_DATA, Objection.PROTECTED: EW.EW_PROT}


def _code(fault: Fault) -> EW:
    return _FAULTS.get(fault, EW.EW_DATA)


def _refuse_if(condition: bool, code: EW) -> None:
    if condition:
        raise Refused(code)


# ---------------------------------------------------------------------- download


@call
def cnc_dwnstart(link: Link) -> EW:
    """Begin to register programs (Manual 000, cnc_dwnstart)."""
    device = link.command()
    busy = (
        device.transfer is not None
        or device.programs.background_edit
        or device.power.blocks_transfers
        or device.mode is PowerMateMode.MDI
    )
    _refuse_if(busy, EW.EW_BUSY)
    _refuse_if(device.programs.key_protects, EW.EW_PROT)
    device.begin_transfer(owner=link)
    return EW.EW_OK


def _transfer(link: Link) -> tuple[PowerMate, Transfer]:
    """Return the open transfer of this handle, or one that was begun at the control."""
    device = link.command()
    transfer = device.transfer
    if transfer is None or transfer.owner not in (None, link):
        raise Refused(EW.EW_FUNC)
    # Ruling: a mode that forbids downloads holds an open one up; it goes on in another mode.
    _refuse_if(device.mode is PowerMateMode.MDI, EW.EW_BUSY)
    return device, transfer


@call
def cnc_download(link: Link, data: CHARS, number: Annotated[SHORT, LengthOf("data")]) -> EW:
    """Send a piece of 1 to 256 characters, cut anywhere (Manual 000, cnc_download)."""
    _, transfer = _transfer(link)
    _refuse_if(not 1 <= number <= PIECE_MOST or len(data) < number, EW.EW_LENGTH)
    try:
        transfer.take(data[:number])
    except TransferError as error:
        raise Refused(_code(error.fault)) from None
    return EW.EW_OK


@call
def cnc_dwnend(link: Link) -> EW:
    """End registering: what was sent is registered as a whole, or not at all (Manual 000, cnc_dwnend).

    Ruling: it answers the error of the download again; after a reset, of which `cnc_download` tells, it is EW_OK.
    """
    device, transfer = _transfer(link)
    device.transfer = None
    try:
        transfer.finish()
    except TransferError as error:
        return _code(error.fault)
    return EW.EW_OK


# ---------------------------------------------------------------------- upload


@call
def cnc_upstart(link: Link, number: SHORT) -> EW:
    """Begin to read a program (Manual 000, cnc_upstart)."""
    device = link.command()
    _refuse_if(link.upload is not None or device.power.blocks_transfers, EW.EW_BUSY)
    _refuse_if(number not in device.programs, EW.EW_DATA)
    link.upload = Upload(device.programs.read(number), device.power_ups)
    return EW.EW_OK


@call
def cnc_upload(
    link: Link, number: Annotated[USHORT, INOUT, LengthOf("upld")]
) -> tuple[EW, Annotated[ODBUP, Out("upld", before="number")], USHORT]:
    """Read at most `number` characters more; none come after the last % (Manual 000, cnc_upload)."""
    link.command()
    if link.upload is None:
        raise Refused(EW.EW_FUNC)
    _refuse_if(number == 0, EW.EW_LENGTH)
    piece = link.upload.read(number)
    return EW.EW_OK, variant(ODBUP, data=number)(data=piece), len(piece)


@call
def cnc_upend(link: Link) -> EW:
    """End reading a program (Manual 000, cnc_upend)."""
    link.command()
    _refuse_if(link.upload is None, EW.EW_FUNC)
    link.upload = None
    return EW.EW_OK


# ---------------------------------------------------------------------- memory


def _answer(objection: Objection | None) -> EW:
    return EW.EW_OK if objection is None else _OBJECTIONS[objection]


@call
def cnc_search(link: Link, number: SHORT) -> EW:
    """Select a program in MEM and EDIT; in other modes only tell whether it is there (Manual 000, cnc_search)."""
    return _answer(search_program(link.command(), number))


@call
def cnc_delall(link: Link) -> EW:
    """Delete all programs that nothing protects (Manual 000, cnc_delall).

    Ruling: with the key on nothing is deleted; programs that parameters protect stay, the others go, and it is EW_PROT.
    """
    device = link.command()
    _refuse_if(device.mode is PowerMateMode.MEM, EW.EW_BUSY)
    _refuse_if(holds_programs(device), EW.EW_BUSY)
    _refuse_if(device.programs.key_protects, EW.EW_PROT)
    try:
        kept = device.programs.delete_unprotected()
    except ControlError as error:
        raise Refused(EW.EW_PROT if error.reason is Refusal.PROTECTED else EW.EW_BUSY) from None
    return EW.EW_PROT if kept else EW.EW_OK


@call
def cnc_delete(link: Link, number: SHORT) -> EW:
    """Delete a program (Manual 000, cnc_delete)."""
    return _answer(delete_program(link.command(), number))


@call
def cnc_rdprogdir(
    link: Link, type: SHORT, datano_s: SHORT, datano_e: SHORT, length: Annotated[SHORT, LengthOf("prgdir")]
) -> tuple[EW, Annotated[PRGDIR, Out("prgdir")]]:
    """List programs: numbers (0), with comments (1), with characters as well (2) (Manual 000, cnc_rdprogdir).

    Ruling: characters are those that a program has, as in the manual's example, not rounded up.
    """
    _refuse_if(length < 1, EW.EW_LENGTH)
    _refuse_if(not FIRST <= datano_s <= datano_e <= LAST, EW.EW_NUMBER)
    _refuse_if(type not in (0, 1, 2), EW.EW_ATTRIB)
    listed = link.read("cnc_rdprogdir", type, datano_s, datano_e).programs.directory(datano_s, datano_e)
    if type == 0:
        text = "".join(f"O{each.number}" for each in listed) + "%"
    elif type == 1:
        lines = "".join(f"O{each.number}({each.comment})\n" for each in listed)
        text = f"%\n{lines}%" if listed else "%"
    else:
        text = "".join(f"O{each.number}({each.comment}){each.characters}" for each in listed) + "%"
    return EW.EW_OK, variant(PRGDIR, prg_data=length)(prg_data=text.encode("latin-1", "replace")[:length])


@call
def cnc_rdproginfo(
    link: Link, type: SHORT, length: Annotated[SHORT, LengthOf("prginfo")]
) -> tuple[EW, Annotated[ODBNC, Out("prginfo")]]:
    """Tell how full the program memory is, in numbers (0) or as text (1) (Manual 000, cnc_rdproginfo)."""
    lengths = _INFO_LENGTHS.get(type, (*_INFO_LENGTHS[0], *_INFO_LENGTHS[1]))
    _refuse_if(length not in lengths, EW.EW_LENGTH)
    _refuse_if(type not in _INFO_LENGTHS, EW.EW_ATTRIB)
    memory = link.read("cnc_rdproginfo", type).programs.memory
    registered = len(memory)
    more = max(0, (memory.data.most_programs or registered) - registered)
    used, free = memory.used_bytes, memory.free_bytes or 0
    info = ODBNC()
    if type == 0:
        info.u.bin.reg_prg, info.u.bin.unreg_prg = registered, more
        info.u.bin.used_mem, info.u.bin.unused_mem = used, free
    else:
        info.u.asc = f"%\n{registered}\n{more}\n{used}\n{free}\n%".encode()
    return EW.EW_OK, info


# ---------------------------------------------------------------------- execution


@call
def cnc_rdprgnum(link: Link) -> tuple[EW, Annotated[ODBPRO, Out("prgnum")]]:
    """Read the number of the program in execution, and of its main program (Manual 000, cnc_rdprgnum)."""
    current, main = link.read("cnc_rdprgnum").execution.numbers
    return EW.EW_OK, ODBPRO(data=current, mdata=main)


@call
def cnc_rdseqnum(link: Link) -> tuple[EW, Annotated[ODBSEQ, Out("seqnum")]]:
    """Read the last sequence number that was executed (Manual 000, cnc_rdseqnum)."""
    return EW.EW_OK, ODBSEQ(data=link.read("cnc_rdseqnum").execution.sequence)


@call
def cnc_rdexecprog(
    link: Link, length: Annotated[USHORT, INOUT, LengthOf("data")]
) -> tuple[
    EW, USHORT, Annotated[SHORT, Out("blknum")], Annotated[bytes, Bytes("char *"), Out("data", c="char *")]
]:
    """Read the program from its executed block on, and how many blocks are read ahead (Manual 000, cnc_rdexecprog)."""
    _refuse_if(length == 0, EW.EW_LENGTH)
    execution = link.read("cnc_rdexecprog").execution
    text = execution.text(length)
    return EW.EW_OK, len(text), execution.ahead, text


@call
def cnc_wrmdiprog(link: Link, length: Annotated[SHORT, LengthOf("data")], data: CHARS) -> EW:
    """Put in the program of MDI operation, 1 to 199 characters at once (Manual 000, cnc_wrmdiprog)."""
    device = link.command()
    _refuse_if(device.mode is not PowerMateMode.MDI, EW.EW_MODE)
    _refuse_if(not 1 <= length <= MDI_MOST or len(data) < length, EW.EW_LENGTH)
    _refuse_if(device.programs.editing, EW.EW_REJECT)
    try:
        device.mdi.put(data[:length])
    except TransferError:
        return EW.EW_DATA
    except ControlError:
        return EW.EW_REJECT
    return EW.EW_OK


@call
def cnc_rdmdipntr(link: Link) -> tuple[EW, Annotated[ODBMDIP, Out("mdip")]]:
    """Read programs and blocks of MDI operation; blocks count from 0 (Manual 000, cnc_rdmdipntr)."""
    _refuse_if(link.device.mode is not PowerMateMode.MDI, EW.EW_MODE)
    pointers = link.read("cnc_rdmdipntr").execution.mdi_pointers
    return EW.EW_OK, ODBMDIP(
        mdiprog=pointers.program,
        mdipntr=pointers.block,
        crntprog=pointers.ahead_program,
        crntpntr=pointers.ahead_block,
    )


@call
def cnc_wrmdipntr(link: Link, crntpntr: LONG) -> EW:
    """Say at which block MDI operation begins (Manual 000, cnc_wrmdipntr)."""
    device = link.command()
    _refuse_if(device.mode is not PowerMateMode.MDI, EW.EW_MODE)
    _refuse_if(device.programs.editing or not device.mdi, EW.EW_REJECT)
    try:
        device.mdi.set_start(crntpntr)
    except KeyError:
        return EW.EW_DATA
    except ControlError:
        return EW.EW_REJECT
    return EW.EW_OK


@call
def cnc_seqsrch(link: Link, seq_no: LONG) -> EW:
    """Put the cursor of the selected program to a sequence number, from its head on (Manual 000, cnc_seqsrch)."""
    device = link.command()
    _refuse_if(device.mode is not PowerMateMode.MEM, EW.EW_MODE)
    try:
        return EW.EW_OK if device.execution.search_sequence(seq_no) else EW.EW_DATA
    except ControlError:
        return EW.EW_REJECT


@call
def cnc_rewind(link: Link) -> EW:
    """Put the cursor to the head of the selected program (Manual 000, cnc_rewind)."""
    device = link.command()
    _refuse_if(device.mode is PowerMateMode.MDI, EW.EW_MODE)
    try:
        device.execution.rewind()
    except ControlError:
        return EW.EW_REJECT
    return EW.EW_OK


__all__ = [
    "cnc_delall",
    "cnc_delete",
    "cnc_download",
    "cnc_dwnend",
    "cnc_dwnstart",
    "cnc_rdexecprog",
    "cnc_rdmdipntr",
    "cnc_rdprgnum",
    "cnc_rdprogdir",
    "cnc_rdproginfo",
    "cnc_rdseqnum",
    "cnc_rewind",
    "cnc_search",
    "cnc_seqsrch",
    "cnc_upend",
    "cnc_upload",
    "cnc_upstart",
    "cnc_wrmdipntr",
    "cnc_wrmdiprog",
]
