"""A host in an event loop: commands, conditions and statuses, what ends them, and that nothing queues up."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine
from typing import Any

import pytest

from polycnc.machine import AsyncHost, Host, HostError, Snapshot, SnapshotError
from support.time_sources import Counter, FakeWall


class Device(Counter):
    """A device whose status is its cycle, and which breaks at one."""

    breaks_at = 10**9

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        done = super().advance(cycles, until=until)
        if self.clock.cycles >= self.breaks_at:
            raise ZeroDivisionError("the drive burns")
        return done

    def status(self) -> int:
        return self.clock.cycles

    def snapshot(self) -> Snapshot:
        raise SnapshotError("none is kept", hint="count on")

    def restore(self, snapshot: Snapshot) -> None:
        raise SnapshotError("none is kept", hint="count on")


def visit(
    visitor: Callable[[AsyncHost[Device]], Coroutine[Any, Any, None]], device: Device | None = None
) -> None:
    """Let a visitor use a host that is frozen until it steps."""

    async def run() -> None:
        async with AsyncHost(Host(device or Device(), FakeWall(), rate=0.0)) as host:
            await visitor(host)
        assert not host.host.running

    asyncio.run(run())


def test_commands_run_in_the_thread_of_the_host_and_raise_what_they_raise() -> None:
    async def use(host: AsyncHost[Device]) -> None:
        owner = await host.call(lambda device: threading.get_ident())
        assert owner != threading.get_ident()
        assert await host.call(lambda device: device.advance(7)) == 7
        assert host.status == 7
        with pytest.raises(ZeroDivisionError):
            await host.call(lambda device: device.advance(3) // 0)

    visit(use)


def test_until_returns_the_first_seen_status_that_holds_at_once_or_when_it_comes() -> None:
    async def use(host: AsyncHost[Device]) -> None:
        assert await host.until(lambda cycle: cycle == 0) == 0
        limits = (3, 150, 420)
        waiting = [asyncio.ensure_future(host.until(limit.__le__)) for limit in limits]
        await asyncio.sleep(0)
        for _ in range(43):
            host.host.pace.step(10)
        assert [await each >= k for each, k in zip(waiting, limits, strict=True)] == [True] * 3
        with pytest.raises(HostError, match=r"nothing of the kind for 0\.01 s"):
            await host.until(lambda cycle: cycle > 10**6, timeout_s=0.01)

    visit(use)


def test_whoever_is_slow_gets_the_newest_status_and_no_queue() -> None:
    async def use(host: AsyncHost[Device]) -> None:
        seen: list[int] = []
        async for cycle in host.statuses():
            seen.append(cycle)
            if len(seen) == 3:
                break
            for _ in range(50):
                await host.call(lambda device: device.advance(2))
        assert seen == [0, 100, 200]

    visit(use)


def test_streams_and_waiting_end_with_the_host() -> None:
    async def use(host: AsyncHost[Device]) -> None:
        waiting = asyncio.ensure_future(host.until(lambda cycle: cycle > 10**6))
        stream = asyncio.ensure_future(_all(host))
        await host.call(lambda device: device.advance(5))
        await asyncio.to_thread(host.host.stop)
        assert (await stream)[-1] == 5
        with pytest.raises(HostError, match="not running"):
            await waiting
        with pytest.raises(HostError, match="not running"):
            await host.call(lambda device: None)

    visit(use)


def test_a_device_that_fails_tells_everybody_who_waits() -> None:
    device = Device()
    device.breaks_at = 30

    async def use(host: AsyncHost[Device]) -> None:
        waiting = asyncio.ensure_future(host.until(lambda cycle: cycle > 10**6))
        stream = asyncio.ensure_future(_all(host))
        await asyncio.sleep(0)
        host.host.pace.step(40)
        for each in (waiting, stream):
            with pytest.raises(HostError, match="the drive burns"):
                await each

    visit(use, device)


def test_a_command_that_nobody_waits_for_any_more_is_not_carried_out() -> None:
    async def use(host: AsyncHost[Device]) -> None:
        release = threading.Event()
        first = asyncio.ensure_future(host.call(lambda device: release.wait(10)))
        second = asyncio.ensure_future(host.call(lambda device: device.advance(9)))
        await asyncio.sleep(0)
        second.cancel()
        await asyncio.sleep(0)
        release.set()
        assert await first
        assert await host.call(lambda device: device.clock.cycles) == 0

    visit(use)


async def _all(host: AsyncHost[Device]) -> list[int]:
    return [cycle async for cycle in host.statuses()]
