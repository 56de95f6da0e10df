"""A jog key that a viewer of the stream holds is let go when its repeats stop: the loop's time is made here."""

from __future__ import annotations

import asyncio
import json
import selectors
from contextlib import suppress
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

from polycnc.cnc import Mode
from polycnc.servers.http._lease import Lease
from polycnc.servers.http._stream import DEAD_MAN_S, Stream
from polycnc.servers.process import Machinery
from support.http_app import served_machine

BEAT_S = 0.2


class _Made(selectors.DefaultSelector):
    """Waits for nothing: the time that a loop would wait has passed."""

    passed_s = 0.0

    def select(self, timeout: float | None = None) -> Any:
        self.passed_s += timeout or 0.0
        return super().select(0)


class _Viewer:
    """A client that says what is put into it, and reads everything."""

    def __init__(self) -> None:
        self.says: asyncio.Queue[str] = asyncio.Queue()

    async def accept(self) -> None: ...
    async def close(self) -> None: ...
    async def send_text(self, text: str) -> None: ...
    async def receive_text(self) -> str:
        return await self.says.get()

    def press(self, direction: int = 1, *, repeat: bool = False) -> None:
        self.says.put_nowait(json.dumps({"jog": {"axis": "Y", "direction": direction, "repeat": repeat}}))


def test_a_viewer_that_freezes_stops_its_axis_and_late_repeats_do_not_start_it() -> None:
    selector = _Made()
    loop = asyncio.SelectorEventLoop(selector)
    loop.time = lambda: selector.passed_s  # type: ignore[method-assign]

    async def visit() -> None:
        machine = served_machine("plain", Machinery(file="mill3"))
        control, viewer = machine.control, _Viewer()
        assert control is not None
        control.select_mode(Mode.JOG)
        stream = Stream(viewer, machine, 5.0, Lease(), lambda: 1)  # type: ignore[arg-type]
        running = asyncio.ensure_future(stream.run())

        def manual() -> str:
            machine.served.advance(1)
            return control.status().axes["Y"].manual

        viewer.press()
        for _ in range(5):
            await asyncio.sleep(BEAT_S)
            assert manual() == "jog"
            viewer.press(repeat=True)
        await asyncio.sleep(DEAD_MAN_S - 0.01)
        assert manual() == "jog"
        await asyncio.sleep(0.02)
        machine.served.advance(1000)
        assert manual() == "none"
        for direction in (1, 1, -1):  # what was under way while the network stood
            viewer.press(direction, repeat=True)
        await asyncio.sleep(0.01)
        assert manual() == "none"
        viewer.press()
        await asyncio.sleep(0.01)
        assert manual() == "jog"
        running.cancel()
        with suppress(asyncio.CancelledError):
            await running
        await asyncio.sleep(0.01)
        machine.served.advance(1000)
        assert manual() == "none"
        machine.close()

    loop.run_until_complete(visit())
    loop.close()
