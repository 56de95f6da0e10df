"""A keeper whose requests come closely: catching up costs a tenth of the time, and no cycle is lost or doubled."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field

from polycnc.machine import Clock
from polycnc.servers.machines import Keeper

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
    passed: list[int] = field(default_factory=list)
    is_followed: bool = True

    def advance(self, cycles: int, *, is_enough: Callable[[], bool] | None = None) -> int:
        self.wall.time_s += COST_S
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
