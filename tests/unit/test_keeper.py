"""A keeper whose requests come closely: catching up costs a tenth of the time, and no cycle is lost or doubled."""

from __future__ import annotations

import asyncio
import selectors
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import pytest

from polycnc.machine import Clock
from polycnc.servers.machines import Keeper, Turns

CYCLE_S, COST_S, APART_S = 0.001, 0.0002, 0.00013


@dataclass
class Wall:
    """A wall clock that only the test and the machine's own work move."""

    time_s: float = 7.0

    def now_s(self) -> float:
        return self.time_s


@dataclass
class Slow:
    """A device of which every stretch of time costs the wall clock as much, however long it is."""

    wall: Wall
    busy: bool = False
    clock: Clock = field(default_factory=lambda: Clock(CYCLE_S))
    cost_s: float = COST_S
    passed: list[int] = field(default_factory=list)
    at_s: list[float] = field(default_factory=list)
    is_followed: bool = True

    def advance(self, cycles: int, *, is_enough: Callable[[], bool] | None = None) -> int:
        self.wall.time_s += self.cost_s
        if is_enough is not None and is_enough():
            cycles = 1
        self.clock.cycles += cycles
        self.passed.append(cycles)
        self.at_s.append(self.wall.time_s)
        return cycles


def test_requests_that_come_closely_share_the_cost_of_time() -> None:
    async def run() -> None:
        wall = Wall()
        device = Slow(wall)
        keeper = Keeper(device, wall)
        for _ in range(3000):
            wall.time_s += APART_S
            late = (wall.time_s - 7.0) / CYCLE_S - device.clock.cycles
            assert keeper.submit(lambda: None, lambda _: None)
            assert late < 1 + 10 * COST_S / CYCLE_S + 1
        lasted_s = wall.time_s - 7.0
        assert len(device.passed) * COST_S < 0.11 * lasted_s
        wall.time_s += 0.0371
        keeper.submit(lambda: None, lambda _: None)
        assert abs((wall.time_s - COST_S - 7.0) / CYCLE_S - device.clock.cycles) < 1
        keeper.close()

    asyncio.run(run())


def test_a_step_that_is_asked_for_is_there_for_the_next_request() -> None:
    async def run() -> None:
        wall = Wall()
        device = Slow(wall)
        keeper = Keeper(device, wall, rate=0.0)
        seen: list[int] = []
        for steps in (3, 11, 2):
            keeper.pace.step(steps)
            keeper.submit(lambda: device.clock.cycles, seen.append)
        assert seen == [3, 14, 16]
        keeper.close()

    asyncio.run(run())


@pytest.mark.parametrize("asked", [False, True])
def test_machines_whose_time_is_costly_leave_room_for_requests(asked: bool) -> None:
    """Twenty machines of which every cycle costs more than it lasts, looked at between two turns of the event loop."""

    async def run() -> None:
        wall = Wall()
        turns = Turns(wall)
        devices = [Slow(wall, busy=True, cost_s=0.017) for _ in range(20)]
        keepers = [Keeper(each, wall, share_s=0.0005, turns=turns) for each in devices]
        for keeper in keepers:
            keeper.start()
            keeper.pace.step(100_000)
            keeper.submit(lambda: None, lambda _: None)  # which finds the steps that were asked for
        answers: list[None] = []
        for _ in range(200):
            begun_s = wall.time_s
            for keeper in keepers if asked else ():
                assert keeper.submit(lambda: None, answers.append)
            await asyncio.sleep(0)
            assert wall.time_s - begun_s < 0.05
        for keeper in keepers:
            keeper.close()
        times = [len(each.passed) for each in devices]
        assert min(times) > 2
        assert asked or max(times) - min(times) <= 1
        assert len(answers) == (4000 if asked else 0)

    asyncio.run(run())


def test_a_clock_that_cannot_keep_up_tells_what_it_drops() -> None:
    """Whose cycles cost twenty times what they last falls behind, half a second at most; what is dropped is told."""
    lags: list[float] = []

    async def run() -> None:
        wall = Wall()
        device = Slow(wall, cost_s=0.02)
        keeper = Keeper(device, wall, on_late=lags.append)
        for _ in range(150):
            wall.time_s += 0.01
            assert keeper.submit(lambda: None, lambda _: None)
            behind_s = wall.time_s - 7.0 - device.clock.now_s - sum(lags)
            assert behind_s < 0.5 + 0.04
        assert device.clock.cycles == len(device.passed)  # a cycle for each of them, and no more
        assert sum(lags) > 0.5 * (wall.time_s - 7.0)
        keeper.close()

    asyncio.run(run())
    assert all(lag >= 0.5 for lag in lags)


class _Waits(selectors.SelectSelector):
    """Waits that pass at once: `loop` is told how long they would have been."""

    def __init__(self, wall: Wall) -> None:
        super().__init__()
        self._wall = wall
        self.wakes = 0

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if timeout:
            self._wall.time_s += timeout
            self.wakes += 1
        return super().select(0)


class _AtOnce(asyncio.SelectorEventLoop):
    """An event loop in which time passes only where everybody waits."""

    def __init__(self, wall: Wall) -> None:
        self.waits = _Waits(wall)
        self._wall = wall
        super().__init__(self.waits)

    def time(self) -> float:
        return self._wall.time_s


def _lived(count: int, for_s: float, every_s: float = 0.0) -> tuple[list[Slow], int, float]:
    """Let busy machines live that cost nothing; return them, the wakes, and the worst lateness."""
    wall = Wall()
    loop = _AtOnce(wall)
    devices = [Slow(wall, busy=True, cost_s=0.0, is_followed=False) for _ in range(count)]

    async def run() -> tuple[int, float]:
        turns = Turns(wall)
        keepers = [Keeper(each, wall, turns=turns) for each in devices]
        for keeper in keepers:
            keeper.start()
        before, end_s = loop.waits.wakes, wall.time_s + for_s
        while wall.time_s < end_s - 1e-6:
            await asyncio.sleep(every_s or for_s)
            for keeper in keepers if every_s else ():
                keeper.submit(lambda: None, lambda _: None)
        wakes = loop.waits.wakes - before
        late_s = max(keeper.take_lateness_s() for keeper in keepers)
        for keeper in keepers:
            keeper.close()
        return wakes, late_s

    try:
        return devices, *loop.run_until_complete(run())
    finally:
        loop.close()


def test_many_machines_wake_the_process_no_oftener_than_one_with_as_many_beats() -> None:
    for_s = 6.0
    devices, wakes, late_s = _lived(40, for_s)
    assert wakes <= for_s / 0.02 + 5
    assert late_s < 1e-6
    for device in devices:
        assert for_s - 0.31 - 0.1 < device.clock.now_s <= for_s
        assert len(device.passed) <= for_s / 0.3 + 1
    at_once = Counter(round(at_s, 3) for each in devices for at_s in each.at_s)
    assert max(at_once.values()) <= 40 / 15 + 1  # they take turns


def test_a_machine_that_is_asked_needs_no_beats() -> None:
    devices, _, _ = _lived(3, 3.1, every_s=0.11)
    for device in devices:
        assert abs(device.clock.now_s - 3.1) < 0.11 + 2 * CYCLE_S
        assert len(device.passed) <= 3.1 / 0.11 + 2


def test_steps_that_take_long_are_gone_on_with_though_somebody_has_just_asked() -> None:
    wall = Wall()
    loop = _AtOnce(wall)

    async def run() -> float:
        device = Slow(wall, cost_s=0.02)  # a cycle each time, beyond its share
        keeper = Keeper(device, wall, rate=0.0)
        keeper.start()
        await asyncio.sleep(1.07)
        for _ in range(3):
            keeper.submit(lambda: None, lambda _: None)
        keeper.pace.step(9)
        keeper.submit(lambda: None, lambda _: None)
        begun_s = wall.time_s
        while device.clock.cycles < 9:
            await asyncio.sleep(0)
        keeper.close()
        return wall.time_s - begun_s

    try:
        assert loop.run_until_complete(run()) < 9 * 0.02 + 0.05
    finally:
        loop.close()
