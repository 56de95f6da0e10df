"""A keeper whose requests come closely: catching up costs a tenth of the time, and no cycle is lost or doubled."""

from __future__ import annotations

import asyncio
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
    is_followed: bool = True

    def advance(self, cycles: int, *, is_enough: Callable[[], bool] | None = None) -> int:
        self.wall.time_s += self.cost_s
        if is_enough is not None and is_enough():
            cycles = 1
        self.clock.cycles += cycles
        self.passed.append(cycles)
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
