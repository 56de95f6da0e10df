"""Whole programs for the iMC card, call by call as client programs are written, against the virtual card."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import pytest

from polycnc.controllers.imc import imclib as lib
from polycnc.controllers.imc.card._card import Card
from polycnc.controllers.imc.card._config import parse_card
from polycnc.machine import Poll

ONE = 65536  # 1 in S16.16
AXES = 5

SHOP = """
number_of_axes = 5
[depths]
pfifo1 = 256
[[axis]]
origin = [2000, 2300]
limit_positive = 60000
limit_negative = -4000
low_when_on = ["limit_positive"]
[[axis]]
"""


class Client:
    """A program in the style of those that drive real cards: everything by IFIFO unless said otherwise."""

    def __init__(self, text: str = SHOP) -> None:
        self.card = Card(parse_card(text))
        lib.attach(self.card, clock=Poll(1))
        info = lib.NIC_INFO()
        status, num = lib.IMC_FindNetCard(info)
        assert (status, num) == (lib.IMC_OK, 1)
        status, handle = lib.IMC_Open(0, 0)
        assert status == lib.IMC_OK
        assert handle is not None
        self.handle = handle
        status, self.naxis = lib.IMC_GetParam16(handle, lib.naxisLoc, 0)
        assert (status, self.naxis) == (lib.IMC_OK, AXES)
        self.set16(lib.clearimcLoc, -1)

    def send(self, call: Callable[..., lib.IMC_STATUS], *arguments: object) -> int:
        """Repeat a call while its queue is full or the card does not answer; return how often."""
        for tries in range(2000):
            status = call(self.handle, *arguments)
            if status not in (lib.IMC_FIFO_FULL, lib.IMC_TIME_OUT):
                assert status == lib.IMC_OK, status.text
                return tries
            for _ in range(5):  # the pause of 5 ms that such programs make
                self.get16(lib.movingLoc)
        raise AssertionError("the queue does not drain")

    def set16(self, at: int, value: int, axis: int = 0, fifo: int = lib.SEL_IFIFO) -> None:
        self.send(lib.IMC_SetParam16, at, value, axis, fifo)

    def set32(self, at: int, value: int, axis: int = 0, fifo: int = lib.SEL_IFIFO) -> None:
        self.send(lib.IMC_SetParam32, at, value, axis, fifo)

    def get16(self, at: int, axis: int = 0) -> int:
        status, value = lib.IMC_GetParam16(self.handle, at, axis)
        assert status == lib.IMC_OK
        return value

    def get32(self, at: int, axis: int = 0) -> int:
        status, value = lib.IMC_GetParam32(self.handle, at, axis)
        assert status == lib.IMC_OK
        return value

    def get_all(self, at: int, length: int) -> list[int]:
        """Read a parameter of all axes with one call."""
        elements = [lib.WR_MUL_DES.of(at, axis, length) for axis in range(AXES)]
        assert lib.IMC_GetMulParam(self.handle, elements, AXES) == lib.IMC_OK
        return [each.value for each in elements]

    def poll(self, condition: Callable[[], bool], limit: int = 20_000) -> None:
        for _ in range(limit):
            if condition():
                return
        raise AssertionError("polled for too long")

    def configure(self, axis: int) -> None:
        self.set16(lib.clearLoc, -1, axis)
        self.set16(lib.pathabsLoc, -1, axis)
        self.set16(lib.steptimeLoc, 100, axis)
        for at in (lib.accellimLoc, lib.vellimLoc):
            self.set32(at, 0x7FFFFFFF, axis)
        for maxvel, accel, decel in (
            (lib.mcsmaxvelLoc, lib.mcsaccelLoc, lib.mcsdecelLoc),
            (lib.pcsmaxvelLoc, lib.pcsaccelLoc, lib.pcsdecelLoc),
        ):
            self.set32(maxvel, 50 * ONE, axis)
            self.set32(accel, ONE, axis)
            self.set32(decel, ONE, axis)
        self.set32(lib.highvelLoc, 20 * ONE, axis)
        self.set32(lib.lowvelLoc, 2 * ONE, axis)
        self.set32(lib.encpfactorLoc, ONE, axis)
        self.set16(lib.smoothLoc, 16, axis)
        self.set16(lib.settlewinLoc, 10, axis)
        self.set16(lib.aioctrLoc, 0, axis)
        self.set16(lib.enaLoc, -1, axis)
        self.set16(lib.exitfiltLoc, 0, axis)
        self.set16(lib.stopfiltLoc, -1, axis)
        self.set16(lib.runLoc, -1, axis)

    def prepare_paths(self) -> None:
        for clear, wait, start in (
            (lib.clrPFIFO1Loc, lib.pwaittime1Loc, lib.startpath1Loc),
            (lib.clrPFIFO2Loc, lib.pwaittime2Loc, lib.startpath2Loc),
        ):
            self.set16(clear, -1)
            self.set32(wait, 0)
            self.set16(start, -1)
        for acceleration, feed, speed, end in (
            (lib.pathacc1Loc, lib.feedrate1Loc, lib.segtgvel1Loc, lib.segendvel1Loc),
            (lib.pathacc2Loc, lib.feedrate2Loc, lib.segtgvel2Loc, lib.segendvel2Loc),
        ):
            self.set32(acceleration, ONE)
            self.set32(feed, ONE)
            self.set32(speed, 20 * ONE)
            self.set32(end, 0)
        self.set16(lib.eventsLoc, 0)

    def map_axes(self, *axes: int) -> None:
        for k, axis in enumerate(axes):
            self.set16(lib.segmap_x1Loc + k, axis, fifo=lib.SEL_PFIFO1)
            self.set16(lib.pathabsLoc, -1, axis, fifo=lib.SEL_PFIFO1)

    def line(self, ends: Sequence[int], speed: int, end_speed: int = 0) -> int:
        info = lib.PFIFOSegInfo.of(speed * ONE, end_speed * ONE, lib.PFIFOSegData.of(*ends))
        return self.send(lib.IMC_AddLineNWithVel, info, lib.SEL_PFIFO1)


@pytest.fixture
def client() -> Iterator[Client]:
    made = Client()
    for axis in range(AXES):
        made.configure(axis)
    made.prepare_paths()
    yield made
    lib.detach()


def test_move_and_wait_in_the_queue(client: Client) -> None:
    """C4: WaitParam(moving, 0) straight after MoveAbsolute in QFIFO holds what comes after it."""
    client.set32(lib.mcsmaxvelLoc, 40 * ONE)
    client.send(lib.IMC_MoveAbsolute, 3000, 0, lib.SEL_QFIFO)
    client.send(lib.IMC_WaitParam, lib.movingLoc, 0, 0, 0, lib.SEL_QFIFO)
    client.send(lib.IMC_MoveRelative, -1000, 0, lib.SEL_QFIFO)
    client.send(lib.IMC_WaitParam, lib.movingLoc, 0, 0, 0, lib.SEL_QFIFO)
    client.set16(lib.user16b0Loc, 1, fifo=lib.SEL_QFIFO)
    highest = 0

    def done() -> bool:
        nonlocal highest
        highest = max(highest, client.get32(lib.curposLoc))
        return client.get16(lib.user16b0Loc) == 1

    client.poll(done)
    assert (highest, client.get32(lib.curposLoc), client.get32(lib.encpLoc)) == (3000, 2000, 2000)


def test_own_expansion_of_an_absolute_move(client: Client) -> None:
    go = [lib.WR_MUL_DES.of(lib.mcstgposLoc, 1, 2, -500), lib.WR_MUL_DES.of(lib.mcsgoLoc, 1, 1, -1)]
    client.send(lib.IMC_SetMulParam, go, 2, lib.SEL_QFIFO)
    client.get16(lib.movingLoc)
    client.poll(lambda: client.get16(lib.movingLoc, 1) == 0 and client.get16(lib.mcsgoLoc, 1) == 0)
    assert client.get_all(lib.curposLoc, 2) == [0, -500, 0, 0, 0]


def test_jog_both_ways(client: Client) -> None:
    client.send(lib.IMC_MoveVelocity, 10 * ONE, 0, lib.SEL_IFIFO)
    client.set32(lib.pcstgvelLoc, -5 * ONE, 1)  # C1 jogs by this word alone
    client.poll(lambda: client.get32(lib.curvelLoc) == 10 * ONE)
    client.poll(lambda: client.get32(lib.curvelLoc, 1) == -5 * ONE)
    client.send(lib.IMC_MoveVelocity, 0, 0, lib.SEL_IFIFO)
    client.set32(lib.pcstgvelLoc, 0, 1)
    client.get16(lib.movingLoc)
    client.poll(lambda: not any(client.get_all(lib.movingLoc, 1)))
    assert client.get32(lib.curposLoc) > 0 > client.get32(lib.curposLoc, 1)


def test_stops(client: Client) -> None:
    client.send(lib.IMC_MoveAbsolute, 50_000, 0, lib.SEL_QFIFO)
    client.poll(lambda: client.get32(lib.curposLoc) > 3000)
    client.set16(lib.mcsgoLoc, 0)
    client.send(lib.IMC_ClearFIFO, lib.SEL_QFIFO)
    client.get16(lib.movingLoc)
    client.poll(lambda: client.get16(lib.movingLoc) == 0)
    assert 3000 < client.get32(lib.curposLoc) < 50_000
    # At once: no smoothing, no target, no velocity.
    client.send(lib.IMC_MoveVelocity, 30 * ONE, 1, lib.SEL_IFIFO)
    client.poll(lambda: client.get32(lib.curvelLoc, 1) == 30 * ONE)
    client.set16(lib.smoothLoc, 0, 1)
    client.set16(lib.mcsgoLoc, 0, 1)
    client.set32(lib.mcsvelLoc, 0, 1)
    client.set32(lib.mcstgvelLoc, 0, 1)
    client.get16(lib.movingLoc)
    before = client.get32(lib.mcsposLoc, 1)
    client.poll(lambda: client.get16(lib.movingLoc, 1) == 0)
    assert client.get32(lib.mcsposLoc, 1) - before < 35


def test_pause_of_everything(client: Client) -> None:
    for axis in range(AXES):
        client.send(lib.IMC_MoveVelocity, 10 * ONE, axis, lib.SEL_IFIFO)
    client.poll(lambda: min(client.get_all(lib.curvelLoc, 2)) == 10 * ONE)
    client.set16(lib.hpauseLoc, -1)
    client.poll(lambda: max(client.get_all(lib.curvelLoc, 2)) == 0)
    places = client.get_all(lib.curposLoc, 2)
    for _ in range(50):
        client.get16(lib.movingLoc)
    assert client.get_all(lib.curposLoc, 2) == places
    client.set16(lib.hpauseLoc, 0)
    client.poll(lambda: min(client.get_all(lib.curvelLoc, 2)) == 10 * ONE)


def test_emergency_stop_and_recovery(client: Client) -> None:
    client.map_axes(0, 1)
    client.line((20_000, 10_000), 20)
    client.send(lib.IMC_MoveVelocity, 10 * ONE, 3, lib.SEL_IFIFO)
    client.poll(lambda: client.get32(lib.curposLoc) > 2000)
    client.set16(lib.emstopLoc, 0x10)
    client.set16(lib.clrPFIFO1Loc, -1)
    for _ in range(5):
        client.get16(lib.movingLoc)
    assert all(error & 0x10 for error in client.get_all(lib.errorLoc, 1))
    client.poll(lambda: not any(client.get_all(lib.movingLoc, 1)))
    stopped = client.get_all(lib.curposLoc, 2)
    assert (client.get_all(lib.runLoc, 1), client.get_all(lib.enaLoc, 1)) == ([0] * AXES, [0] * AXES)
    assert client.get16(lib.startpath1Loc) == 0
    client.set16(lib.emstopLoc, 0)
    for axis in range(AXES):
        client.set16(lib.errorLoc, 0, axis)
        client.set16(lib.enaLoc, -1, axis)
        client.set16(lib.runLoc, -1, axis)
    client.prepare_paths()
    client.get16(lib.movingLoc)
    assert client.get_all(lib.errorLoc, 1) == [0] * AXES
    client.line((stopped[0], stopped[1] + 400), 20)
    client.poll(lambda: client.get32(lib.curposLoc, 1) == stopped[1] + 400)
    assert client.get32(lib.curposLoc) == stopped[0]


def test_home_with_a_switch(client: Client) -> None:
    for at, value in ((lib.homeposLoc, 0), (lib.highvelLoc, 20 * ONE), (lib.lowvelLoc, 2 * ONE)):
        client.set32(at, value)
    client.set16(lib.homedLoc, 0)
    client.send(lib.IMC_HomeSwitch2, 0, 1, 0, 0, lib.SEL_QFIFO)
    client.get16(lib.movingLoc)
    client.poll(lambda: client.get16(lib.movingLoc) == 0 or client.get16(lib.homedLoc) != 0)
    client.poll(lambda: client.get16(lib.movingLoc) == 0)
    assert client.get16(lib.homedLoc) != 0
    assert -40 <= client.get32(lib.curposLoc) <= 0  # smoothing passes on what the planner has done
    client.send(lib.IMC_HomeSwitch1, 0, 0, 0, 0, lib.SEL_IFIFO)
    client.get16(lib.movingLoc)
    client.set16(lib.gohomeLoc, 0)  # given up
    client.get16(lib.movingLoc)
    client.poll(lambda: client.get16(lib.movingLoc) == 0)
    client.set16(lib.gohomeLoc, 0)
    client.set32(lib.homeposLoc, 555)
    client.set16(lib.sethomeLoc, -1)  # here is the origin
    client.get16(lib.movingLoc)
    assert (client.get32(lib.curposLoc), client.get32(lib.encpLoc)) == (555, 555)


def test_home_from_a_limit(client: Client) -> None:
    """V: jog to the negative limit, clear, then search the switch from there."""
    client.set16(lib.aioctrLoc, 0x000F)  # limits enabled, active high
    client.send(lib.IMC_MoveVelocity, -20 * ONE, 0, lib.SEL_IFIFO)
    client.poll(lambda: lib.IMC_GetPatamBit(client.handle, lib.aioLoc, 1, 0)[1] == 1)
    client.poll(lambda: client.get16(lib.movingLoc) == 0)
    assert client.get32(lib.curposLoc) < -3990
    assert client.get16(lib.errorLoc) & 0x2


def test_lines_with_a_full_queue(client: Client) -> None:
    client.map_axes(0, 1, 2)
    corners = [(500, 0, 40), (500, 500, 80), (0, 500, 120), (0, 0, 160)] * 10
    tries = 0
    for k, (x, y, z) in enumerate(corners):
        tries += client.line((x, y, z * (k // 4 + 1)), 20, 0 if k == len(corners) - 1 else 20)
    assert tries > 0  # the queue holds 256 words only
    client.poll(lambda: client.get16(lib.PFIFOcnt1Loc) == 0)
    client.poll(lambda: not any(client.get_all(lib.movingLoc, 1)))
    assert client.get_all(lib.curposLoc, 2) == [0, 0, 1600, 0, 0]
    assert client.get32(lib.segID1Loc) == len(corners)


def test_plain_lines_take_the_speed_of_the_space(client: Client) -> None:
    """C3: everything anew for each job, datanum decides about the axes."""
    client.set16(lib.startpath1Loc, 0)
    client.set16(lib.clrPFIFO1Loc, -1)
    client.set32(lib.pathacc1Loc, ONE)
    client.set32(lib.feedrate1Loc, ONE)
    for k in range(AXES):
        client.set16(lib.segmap_x1Loc + k, k)
    client.set32(lib.segtgvel1Loc, 30 * ONE)
    client.set32(lib.segendvel1Loc, 0)
    client.set16(lib.startpath1Loc, -1)
    client.send(lib.IMC_AddLineN, lib.PFIFOSegData.of(3000, 4000, 0), lib.SEL_PFIFO1)
    client.send(lib.IMC_AddLineN, lib.PFIFOSegData.of(3000, 4000, 0, 70, -70), lib.SEL_PFIFO1)
    fastest = 0

    def done() -> bool:
        nonlocal fastest
        fastest = max(fastest, client.get32(lib.pathvel1Loc))
        return client.get_all(lib.curposLoc, 2) == [3000, 4000, 0, 70, -70]

    client.poll(done)
    assert fastest == pytest.approx(30 * ONE, rel=0.01)


def test_arc_after_a_line_without_a_stop(client: Client) -> None:
    client.map_axes(0, 1, 2)
    client.line((1000, 0, 0), 10, 10)
    arc = lib.PFIFOSegData.of(0, 1000, 300, center=(0, 0), direction=-1)
    client.send(lib.IMC_AddArcLineWithVel, lib.PFIFOSegInfo.of(10 * ONE, 0, arc), lib.SEL_PFIFO1)
    slowest, track = 10 * ONE, []

    def done() -> bool:
        nonlocal slowest
        x, y, z, *_ = client.get_all(lib.mcsposLoc, 2)
        if y > 5 and z < 250:
            slowest = min(slowest, client.get32(lib.pathvel1Loc))
            track.append(math.hypot(x, y))
        return (x, y, z) == (0, 1000, 300)

    client.poll(done)
    assert slowest > 9 * ONE
    assert all(abs(radius - 1000) < 2 for radius in track)


@pytest.mark.parametrize("by_feed", [True, False])
def test_pause_of_a_path(client: Client, by_feed: bool) -> None:
    """C3 pauses by the feed override; C1 by a wait after every segment, on a cell that the program sets."""
    client.map_axes(0, 1)
    for k in range(1, 5):
        client.line((1000 * k, 0), 20)
        client.send(lib.IMC_WaitParam, lib.user32b0Loc, 0, 0, 0, lib.SEL_PFIFO1)
    client.poll(lambda: client.get32(lib.curposLoc) > 1500)
    if by_feed:
        client.set32(lib.feedrate1Loc, 0)
        client.poll(lambda: client.get32(lib.curvelLoc) == 0)
    else:
        client.set16(lib.user32b0Loc, -1)
        client.poll(lambda: client.get32(lib.curposLoc) == 2000)
    for _ in range(200):
        client.get16(lib.movingLoc)
    place = client.get32(lib.curposLoc)
    assert (1500 < place < 2000) if by_feed else place == 2000
    if by_feed:
        client.set32(lib.feedrate1Loc, ONE)
    else:
        client.set16(lib.user32b0Loc, 0)
    client.poll(lambda: client.get32(lib.curposLoc) == 4000)


def test_handwheel_and_back_to_moves(client: Client) -> None:
    client.send(lib.IMC_SetParam48, lib.gearratioLoc, 5 << 32, 2, lib.SEL_IFIFO)
    client.set16(lib.masterLoc, 4, 2)
    client.set16(lib.gearsrcLoc, lib.encsvelLoc, 2)
    client.set16(lib.gearoutmodLoc, -1, 2)
    client.set16(lib.engearLoc, -1, 2)
    client.set16(lib.smoothLoc, 64, 2)
    client.get16(lib.movingLoc)
    client.card.turn_handwheel(4, 100)
    client.poll(lambda: client.get32(lib.curposLoc, 2) == 500)
    client.set16(lib.smoothLoc, 32, 2)
    client.set16(lib.engearLoc, 0, 2)
    client.get16(lib.movingLoc)
    client.card.turn_handwheel(4, 100)
    client.send(lib.IMC_MoveAbsolute, 250, 2, lib.SEL_IFIFO)
    client.get16(lib.movingLoc)
    client.poll(lambda: client.get16(lib.movingLoc, 2) == 0)
    assert client.get32(lib.curposLoc, 2) == 250


def test_events_of_the_vendors_example(client: Client) -> None:
    """E1: an input switches an output, and a position stops the axis there and makes it the origin: one load of 7."""
    event = lib.EventInfo.of
    output = (lib.gout1Loc, 0)
    events = [
        event(lib.CMD_AND16i, src1=(lib.gin1Loc, 0), src2=0x0004),
        event(lib.CMD_OR16i, lib.IMC_Edge_Zero, src1=output, src2=0x0020, dest=output),
        event(lib.CMD_AND16i, lib.IMC_Edge_NotZero, src1=output, src2=~0x0020, dest=output),
        event(lib.CMD_CMP32i, src1=(lib.curposLoc, 1), src2=3000),
        event(lib.CMD_SET32, lib.IMC_Edge_Great, src2=0, dest=(lib.mcstgvelLoc, 1)),
        event(lib.CMD_SET32, lib.IMC_Edge_Great, src2=0, dest=(lib.homeposLoc, 1)),
        event(lib.CMD_SET16, lib.IMC_Edge_Great, src2=-1, dest=(lib.sethomeLoc, 1)),
    ]
    client.send(lib.IMC_InstallEvent, events, 7, lib.SEL_IFIFO)
    client.poll(lambda: client.get16(lib.eventsLoc) == 7)
    assert not client.card.output(6)
    for closed in (True, False, True):
        client.card.set_input(3, closed)
        client.get16(lib.movingLoc)
        client.get16(lib.movingLoc)
        assert client.card.output(6) is closed
    client.send(lib.IMC_MoveVelocity, 20 * ONE, 1, lib.SEL_IFIFO)
    client.poll(lambda: client.get32(lib.curvelLoc, 1) > 0)
    client.poll(lambda: client.get16(lib.movingLoc, 1) == 0)
    # From 20 pulses/ms it brakes in 200 pulses, smoothed; the origin is where the event has acted.
    assert 150 < client.get32(lib.curposLoc, 1) < 600


def test_widths_found_in_programs(client: Client) -> None:
    client.set32(lib.hpauseLoc, 0x12340000)  # 32 bits at a flag: the word of ticks after it as well
    assert client.get32(lib.ticksLoc) & 0xFFFF < 0x1234 + 100
    assert client.get32(lib.ticksLoc) & 0xFFFF >= 0x1234
    client.send(lib.IMC_MoveAbsolute, 300, 0, lib.SEL_IFIFO)
    motion = [lib.WR_MUL_DES.of(lib.motionLoc, 0, 2)]  # motion, and outsettle with it
    client.get16(lib.movingLoc)
    assert lib.IMC_GetMulParam(client.handle, motion, 1) == lib.IMC_OK
    assert motion[0].value != 0

    def at_rest() -> bool:
        assert lib.IMC_GetMulParam(client.handle, motion, 1) == lib.IMC_OK
        return motion[0].value == 0

    client.poll(at_rest)
    assert client.get32(lib.curposLoc) == 300


def test_clear_of_one_axis_reaches_the_card(client: Client) -> None:
    client.set16(lib.hpauseLoc, -1)
    client.set16(lib.emstopLoc, 0x10)
    event = lib.EventInfo.of(lib.CMD_ADD32i, src1=(317, 0), src2=1, dest=(317, 0))
    client.send(lib.IMC_InstallEvent, [event], 1, lib.SEL_IFIFO)
    client.poll(lambda: client.get16(lib.eventsLoc) == 1)
    client.set16(lib.clearLoc, -1, 4)
    client.get16(lib.movingLoc)
    client.get16(lib.movingLoc)
    assert [client.get16(at) for at in (lib.hpauseLoc, lib.emstopLoc, lib.eventsLoc)] == [0, 0, 0]
    assert client.get32(lib.ticksLoc) < 10


def test_close(client: Client) -> None:
    for axis in range(AXES):
        client.set16(lib.enaLoc, 0, axis)
        client.set16(lib.aioctrLoc, 0, axis)
    assert lib.IMC_Close(client.handle) == lib.IMC_OK
    assert lib.IMC_GetParam16(client.handle, lib.movingLoc, 0)[0] == lib.IMC_DEVICE_NOT_OPEN
    assert lib.IMC_FindNetCard(lib.NIC_INFO()) == (lib.IMC_OK, 1)
