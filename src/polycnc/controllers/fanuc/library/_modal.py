"""Modal data (Manual 000, cnc_modal)."""

from __future__ import annotations

from typing import Annotated

from polycnc.controllers.fanuc.device._modal_data import ADDRESSES, GROUPS, ModalBlock, Word
from polycnc.controllers.fanuc.device._power_mate import PowerMate
from polycnc.controllers.fanuc.library._call import call
from polycnc.controllers.fanuc.library._codes import EW
from polycnc.controllers.fanuc.library._network import Link
from polycnc.controllers.fanuc.library._structs import MODAL_AUX, ODBMDL
from polycnc.controllers.library import SHORT, Out, Refused

_ALL_AXES, _ALL_ADDRESSES, _ALL_GROUPS = -3, -2, -1
_FIRST_ADDRESS, _FIRST_AXIS, _MOST_AXES = 100, 200, 6
_COMMANDED, _POINT, _NEGATIVE, _DIGITS = 0x80, 0x40, 0x20, 0x0F
_BLOCKS = 3


@call
def cnc_modal(link: Link, type: SHORT, block: SHORT) -> tuple[EW, Annotated[ODBMDL, Out("modal")]]:
    """Read modal G codes, addresses or axis words of the executed or a coming block (Manual 000, cnc_modal).

    Ruling: `aux_data` has its sign; of groups without codes in the manual the value is 0.
    """
    groups, addresses, axes = _chosen(type)
    if not 0 <= block < _BLOCKS:
        raise Refused(EW.EW_ATTRIB)
    device = link.read("cnc_modal", type, block)
    data = device.modal_data.block(block)
    made = ODBMDL(datano=type, type=block)
    for k, group in enumerate(groups):
        code, here = data.g[group]
        made.modal.g_rdata[k] = code | (_COMMANDED if here else 0)
    for k, name in enumerate(addresses):
        made.modal.raux1[k] = _aux(device, data, name)
    for k, axis in enumerate(axes):
        if axis <= device.axes:
            made.modal.raux2[k] = _aux(device, data, device.units.axis_name(axis))
    return EW.EW_OK, made


def _chosen(kind: int) -> tuple[list[int], list[str], list[int]]:
    """Return the groups, addresses and axes that a kind of modal data has."""
    if kind == _ALL_AXES:
        return [], [], list(range(1, _MOST_AXES + 1))
    if kind == _ALL_ADDRESSES:
        return [], list(ADDRESSES), []
    if kind == _ALL_GROUPS:
        return list(range(GROUPS)), [], []
    if 0 <= kind < GROUPS:
        return [kind], [], []
    if 0 <= kind - _FIRST_ADDRESS < len(ADDRESSES):
        return [], [ADDRESSES[kind - _FIRST_ADDRESS]], []
    if 0 <= kind - _FIRST_AXIS < _MOST_AXES:
        return [], [], [kind - _FIRST_AXIS + 1]
    raise Refused(EW.EW_NUMBER)


def is_of_groups(kind: int) -> bool:
    """Tell whether a kind of modal data is G codes."""
    return kind == _ALL_GROUPS or 0 <= kind < GROUPS


def _aux(device: PowerMate, data: ModalBlock, name: str) -> MODAL_AUX:
    word = data.words.get(name, Word())
    text = word.text
    digits = sum(each.isdigit() for each in text)
    if name in ("M", "M2", "M3"):
        digits = device.parameters.value(3030)
    point = name == "F" and "." in text
    flag = (_COMMANDED if word.here else 0) | (_POINT if point else 0)
    flag |= (_NEGATIVE if text.startswith("-") else 0) | digits & _DIGITS
    decimals = len(text.partition(".")[2]) if name == "F" else 0
    return MODAL_AUX(aux_data=device.modal_data.value(name, word), flag1=flag, flag2=decimals & 7)


__all__ = ["cnc_modal"]
