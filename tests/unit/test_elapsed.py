"""Programs that sleep between their calls see a board and a card in real time, by a wall clock that is lent."""

from __future__ import annotations

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.imc import Card, CardConfig, imclib
from polycnc.machine import Elapsed
from support.apci_pc import Pc
from support.time_sources import FakeWall

POLL_S = 0.01
PROFILE_END = 13


def test_a_jog_of_a_board_takes_as_long_as_it_says() -> None:
    """17.5 mm at 12.5 mm/s with ramps of 0.1 s: 1.4 s and one ramp."""
    wall = FakeWall()
    pc = Pc("number_of_axes = 2", clock=Elapsed(wall))
    board, axes = pc.board, pc.close(1)
    board.axes[1].jac = 125.0
    board.axes[1].jvl = 12.5
    pc.tsrp[1].tp = 17.5
    pcap.jr(axes, pc.tsrp)
    polls = 0
    while not pcap.rdaxstb(1, PROFILE_END) and polls < 1000:
        polls += 1
        wall.sleep_s(POLL_S)
    passed_s = wall.time_s - 100.0
    assert passed_s == pytest.approx(1.5, abs=2.0 * POLL_S)
    assert board.clock.now_s == pytest.approx(passed_s, abs=0.002)
    assert board.axes[1].rp == pytest.approx(17.5)
    pcap.detach()


def test_a_move_of_a_card_takes_as_long_as_it_says() -> None:
    """30,600 pulses at 21.25 pulses/ms with ramps of 60 ms: 1.44 s and one ramp."""
    wall = FakeWall()
    card = Card(CardConfig(number_of_axes=2, ready=True))
    imclib.attach(card, clock=Elapsed(wall))
    _, handle = imclib.IMC_Open(0, 0)
    assert handle is not None
    card.write("mcsmaxvel", 21.25, 1)
    card.write("mcsaccel", 21.25 / 60.0, 1)
    card.write("mcsdecel", 21.25 / 60.0, 1)
    assert imclib.IMC_MoveAbsolute(handle, 30_600, 1, imclib.SEL_QFIFO) == imclib.IMC_OK
    polls = 0
    wall.sleep_s(POLL_S)
    while imclib.IMC_GetParam16(handle, imclib.movingLoc, 1)[1] and polls < 1000:
        polls += 1
        wall.sleep_s(POLL_S)
    passed_s = wall.time_s - 100.0
    assert passed_s == pytest.approx(1.5, abs=2.0 * POLL_S)
    assert card.clock.now_s == pytest.approx(passed_s, abs=0.002)
    assert card.read("curpos", 1) == 30_600
    imclib.detach()
