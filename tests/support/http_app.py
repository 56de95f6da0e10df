"""The HTTP door without a socket: an application of one machine whose wall clock stands, asked in one event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import pytest

from polycnc.machine import Wall
from polycnc.servers.machines import Keeper, ServedDevice, ServedMachine
from polycnc.servers.process import KINDS, Machinery

R = TypeVar("R")


class Still(Wall):
    """A wall clock that does not move."""

    def now_s(self) -> float:
        return 0.0


class Slow(Wall):
    """A wall clock that goes on a little whenever it is looked at."""

    def __init__(self, look_s: float) -> None:
        self._look_s = look_s
        self._now_s = 0.0

    def pass_s(self, duration_s: float) -> None:
        """Let more time pass at once."""
        self._now_s += duration_s

    def now_s(self) -> float:
        self._now_s += self._look_s
        return self._now_s


def served_machine(kind: str, machinery: Machinery, wall: Wall | None = None) -> ServedMachine:
    """Return a machine of a kind, in the running event loop."""
    made = KINDS[kind](machinery)
    served: ServedDevice[Any] = ServedDevice(made.device, made.find_control)
    keeper = Keeper(served, wall or Still())
    machine = ServedMachine(**made.all(), name="m", kind=kind, served=served, keeper=keeper)
    keeper.start()
    return machine


def visit(
    kind: str,
    machinery: Machinery,
    visitor: Callable[[Any, ServedMachine], Awaitable[R]],
    wall: Wall | None = None,
) -> R:
    """Let a visitor ask the application of a machine by an httpx client."""
    httpx = pytest.importorskip("httpx", reason="pip install httpx")
    pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")
    from polycnc.servers.http._app import make_app

    async def run() -> R:
        machine = served_machine(kind, machinery, wall)
        transport = httpx.ASGITransport(app=make_app([machine]))
        try:
            async with httpx.AsyncClient(
                transport=transport, base_url="http://localhost/api/machines/m"
            ) as client:
                return await visitor(client, machine)
        finally:
            machine.close()

    return asyncio.run(run())
