"""When programs are deleted and selected from outside, and when not: one answer for the library and the network."""

from __future__ import annotations

from enum import Enum, auto

from polycnc.cnc import ControlError, Refusal
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._power_mate import PowerMate

MEM_OR_EDIT = (PowerMateMode.MEM, PowerMateMode.EDIT)


class Objection(Enum):
    """Why a program is not deleted or selected."""

    BUSY = auto()
    MISSING = auto()
    PROTECTED = auto()


def in_operation(control: PowerMate) -> bool:
    """Tell whether automatic operation forbids to touch programs: in EDIT and MEM only."""
    return control.mode in MEM_OR_EDIT and control.programs.in_operation


def holds_programs(control: PowerMate) -> bool:
    """Tell whether no program can be deleted now (Manual 000, cnc_delete: EW_BUSY)."""
    return (
        control.programs.background_edit
        or control.transfer is not None
        or control.power.blocks_transfers
        or control.mode is PowerMateMode.MDI
        or in_operation(control)
    )


def delete_program(control: PowerMate, number: int) -> Objection | None:
    """Delete a program, or tell why not (Manual 000, cnc_delete)."""
    programs = control.programs
    if holds_programs(control) or number == programs.selected != 0:
        return Objection.BUSY
    if number not in programs:
        return Objection.MISSING
    if programs.key_protects or programs.parameter_protects(number):
        return Objection.PROTECTED
    try:
        programs.delete(number)
    except ControlError as error:
        return Objection.PROTECTED if error.reason is Refusal.PROTECTED else Objection.BUSY
    return None


def search_program(control: PowerMate, number: int) -> Objection | None:
    """Select a program in MEM and EDIT, in other modes only look for it; tell why not (Manual 000, cnc_search)."""
    download = control.transfer is not None and not control.transfer.compare
    if in_operation(control) or download or control.power.blocks_transfers:
        return Objection.BUSY
    if number not in control.programs:
        return Objection.MISSING
    if control.mode in MEM_OR_EDIT:
        try:
            control.select_program(number)
        except ControlError:
            return Objection.BUSY
    return None
