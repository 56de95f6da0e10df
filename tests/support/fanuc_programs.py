"""What the tests of programs on a Power Mate share."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from support.power_mate import OK


def covers(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.covers(*(f"fanuc.{name}" for name in names))


def sent(handle: int, *pieces: str) -> tuple[EW, EW]:
    """Download pieces like the manual's sample; return the first code that is no success, and that of the end."""
    assert fwlib.cnc_dwnstart(handle) == OK
    code = OK
    for piece in pieces:
        code = fwlib.cnc_download(handle, piece, len(piece))
        if code != OK:
            break
    return code, fwlib.cnc_dwnend(handle)


def uploaded(handle: int, number: int, size: int = 1000) -> str:
    assert fwlib.cnc_upstart(handle, number) == OK
    text = b""
    while True:
        code, piece, count = fwlib.cnc_upload(handle, size)
        assert code == OK
        assert len(piece.data) <= count <= size
        text += bytes(piece.data)
        if count == 0:
            break
    assert fwlib.cnc_upend(handle) == OK
    return text.decode()


def unchanged(control: PowerMate, call: Callable[[], EW], code: EW) -> None:
    """Check that a call is refused with a code, and that the programs and the selection stay."""
    before = (
        [(each, control.programs.read(each.number)) for each in control.programs.directory()],
        control.programs.selected,
    )
    assert call() == code
    after = (
        [(each, control.programs.read(each.number)) for each in control.programs.directory()],
        control.programs.selected,
    )
    assert after == before
