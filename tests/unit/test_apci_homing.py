"""Reference travel, machine zero, latched positions, and the signals of encoder and inputs."""

from __future__ import annotations

import pytest

from polycnc.controllers.apci.board._axis_commands import cl, ol, ra, shp
from polycnc.controllers.apci.board._jog_commands import ja, jhi, jhl, jhr, jr, js
from polycnc.controllers.apci.board._move_commands import Speeds, mlr
from polycnc.controllers.apci.core._latches import BY_STROBE
from polycnc.controllers.apci.core._registers import Digi
from support.apci_bits import Axst
from support.apci_rig import LATENCY, SCAN_S, Rig

SYSTEM = """
number_of_axes = 3
[inputs]
1 = { functions = ["REF"], axes = ["A1"] }
2 = { functions = ["LP"], axes = ["A1"] }
[[axis]]
hvl = 20
hac = 100
[axis.plant]
reference = [-30.0, -25.0]
index = 3.0
"""


@pytest.mark.covers("apci.jhl", "apci.jhr", "apci.io.REF", "apci.axst.18.refh")
@pytest.mark.parametrize(("command", "sign", "edge"), [(jhl, -1.0, -25.0), (jhr, 1.0, -30.0)])
def test_search_of_the_reference_switch(command, sign: float, edge: float) -> None:  # type: ignore[no-untyped-def]
    rig = Rig(SYSTEM)
    if sign > 0.0:
        ja(rig.board, (0,), (-50.0,))
        rig.scans_until_end()
    command(rig.board, (0,))
    rig.board.advance(LATENCY + 400)
    assert rig.board.axes[0].dv == sign * 20.0
    assert not rig.bits() & Axst.pe
    rig.scans_until_end()
    beyond = (rig.board.axes[0].rp - edge) * sign
    assert 2.0 <= beyond <= 2.0 + 2 * 20.0 * SCAN_S  # v^2 / 2 a after the edge, seen a scan later
    assert rig.bits() & (Axst.pe | Axst.refh) == Axst.pe | Axst.refh


@pytest.mark.covers("apci.jhi")
@pytest.mark.parametrize(("distance", "found"), [(15.0, 3.0), (-15.0, -7.0), (2.5, None)])
def test_search_of_the_index(distance: float, found: float | None) -> None:
    rig = Rig(SYSTEM)  # a pulse at 3 mm and every 10 mm
    jhi(rig.board, (0,), (distance,))
    scans = rig.scans_until_end()
    axis = rig.board.axes[0]
    if found is None:
        assert axis.rp == distance
        assert not axis.digi & Digi.index_latched
    else:
        sign = 1.0 if distance > 0.0 else -1.0
        assert 2.0 <= (axis.rp - found) * sign <= 2.0 + 2 * 20.0 * SCAN_S
        assert axis.lpndx == found  # exactly where the pulse lies
        assert axis.digi & Digi.index_latched
    assert scans > 100


@pytest.mark.covers("apci.digi.16", "apci.digi.17", "apci.digi.18", "apci.digi.19")
def test_encoder_signals_of_an_axis() -> None:
    rig = Rig(SYSTEM)
    axis, seen = rig.board.axes[0], Digi(0)
    jr(rig.board, (0,), (5.0,))
    while axis.is_busy:
        rig.board.advance(1)
        seen |= axis.digi & Digi.index
    assert seen == Digi.index
    assert axis.digi == Digi.index_latched
    axis.row["signals"] |= Digi.encoder_error  # a fault of hardware, injected
    rig.board.set_input(14, True)
    rig.board.advance(1)
    assert axis.digi == Digi.index_latched | Digi.encoder_error | Digi.strobe_latched | Digi.input14
    assert rig.board.axes[1].digi == Digi.input14


@pytest.mark.parametrize(
    "number", [pytest.param(n, marks=pytest.mark.covers(f"apci.digi.{n - 1}")) for n in range(1, 17)]
)
def test_inputs_show_in_digi_of_every_axis(number: int) -> None:
    rig = Rig()
    rig.board.set_input(number, True)
    rig.board.advance(1)
    assert all(axis.digi & 0xFFFF == 1 << (number - 1) for axis in rig.board.axes)
    rig.board.set_input(number, False)
    rig.board.advance(1)
    assert all(axis.digi & 0xFFFF == 0 for axis in rig.board.axes)


@pytest.mark.covers("apci.axst.13.cl", "apci.TSRP.dp")
@pytest.mark.covers("apci.shp", "apci.axst.17.referenced", "apci.rule.referenced", "apci.ra")
@pytest.mark.parametrize("motor", ["servo", "stepper"])
def test_machine_zero_and_what_ends_it(motor: str) -> None:
    rig = Rig(f'[[axis]]\nmotor = "{motor}"\n', keep=0)
    axis = rig.board.axes[0]
    assert not rig.bits() & Axst.referenced
    jr(rig.board, (0,), (7.0,))
    rig.board.advance(50)
    shp(rig.board, 0, 5.0)  # not while it moves
    assert not rig.bits() & Axst.referenced
    rig.scans_until_end()
    mlr(rig.board, (0,), (1.0,), Speeds(100.0, 10.0), spool=True)
    shp(rig.board, 0, 5.0)  # nor with moves queued
    assert not rig.bits() & Axst.referenced
    js(rig.board, (0,))
    shp(rig.board, 0, 5.0)
    assert axis.rp == axis.dp == 5.0
    assert rig.bits() & Axst.referenced
    for command in (ol, cl):
        shp(rig.board, 0, 5.0)
        command(rig.board, (0,))
        assert bool(rig.bits() & Axst.referenced) is (motor == "servo")
    shp(rig.board, 0, 5.0)
    rig.board.axes[0].rp = 1.0  # only with the loop open
    assert axis.rp == 5.0
    ol(rig.board, (0,))
    shp(rig.board, 0, 5.0)
    rig.board.axes[0].rp = 1.0
    assert axis.rp == pytest.approx(1.0)
    assert not rig.bits() & Axst.referenced
    shp(rig.board, 0, 5.0)
    ra(rig.board, (0,))
    assert not rig.bits() & Axst.referenced
    shp(rig.board, 0, 5.0)
    rig.board.reset()
    assert not rig.bits() & Axst.referenced


@pytest.mark.covers("apci.TSRP.lp")
@pytest.mark.covers(
    "apci.const.lplatency", "apci.io.LP", "apci.axst.16.lpsf", "apci.var.lp", "apci.var.lpndx"
)
def test_position_latched_by_an_input() -> None:
    rig = Rig(SYSTEM)
    axis = rig.board.axes[0]
    jr(rig.board, (0,), (50.0,))
    rig.board.advance(300)
    at = axis.rp
    rig.board.set_input(2, True)
    rig.board.advance(2)
    assert rig.bits() & Axst.lpsf
    assert at <= axis.lp <= at + 2 * axis.dv * SCAN_S
    assert not rig.bits() & Axst.lpsf  # it was read
    kept = axis.lp
    rig.board.advance(50)
    assert axis.lp == kept  # the next one needs another edge
    rig.board.set_input(2, False)
    rig.board.advance(1)
    rig.board.set_input(2, True)
    rig.board.advance(2)
    assert axis.lp > kept + 1.0


@pytest.mark.covers("apci.TSRP.lp")
@pytest.mark.covers("apci.lps", "apci.axst.16.lpsf")
@pytest.mark.parametrize("scans", [10, 100])
def test_position_latched_every_so_many_scans(scans: int) -> None:
    rig = Rig(SYSTEM)
    axis = rig.board.axes[0]
    axis.row["latch_scans"] = scans
    jr(rig.board, (0,), (100.0,))
    latched = []
    for scan in range(5 * scans):
        rig.board.advance(1)
        if rig.bits() & Axst.lpsf:
            latched.append((scan + 1, axis.lp == axis.rp))
    assert latched == [(k * scans, True) for k in range(1, 6)]


@pytest.mark.parametrize("number", [14, 15, 16])
@pytest.mark.covers("apci.digi.13", "apci.digi.14", "apci.digi.15", "apci.digi.19")
def test_hardware_strobe_latches_its_axis_at_once_and_wins(number: int) -> None:
    rig = Rig()
    axis = rig.board.axes[number - 14]
    jr(rig.board, rig.all, (50.0, 50.0, 50.0))
    axis.row["latch_scans"] = 1
    rig.board.advance(300)
    rig.board.set_input(number, True)
    rig.board.advance(1)
    at = axis.rp
    assert axis.row["lp_source"] == BY_STROBE
    rig.board.advance(20)
    assert axis.lp == at
    assert [bool(each.digi & Digi.strobe_latched) for each in rig.board.axes] == [
        n == number for n in (14, 15, 16)
    ]
