"""The stream: statuses at a rate, parts of the inventory when they change; whoever reads slowly gets the newest."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from polycnc.errors import PolycncError
from polycnc.servers.commands import carry_out
from polycnc.servers.http._documents import inventory_parts, status_json
from polycnc.servers.http._lease import Lease
from polycnc.servers.machines import ServedMachine

LEAST_RATE, MOST_RATE, USUAL_RATE = 0.1, 50.0, 10.0
DEAD_MAN_S = 0.5
_MOST_TEXT = 4096


def rate_of(text: str | None) -> float:
    """Return updates for each second, held to what is allowed; a text that is no number is the usual rate."""
    try:
        rate = USUAL_RATE if text is None else float(text)
    except ValueError:
        rate = USUAL_RATE
    return min(max(rate, LEAST_RATE), MOST_RATE) if rate == rate else USUAL_RATE


class Stream:
    """One viewer. It may hold jog keys: `{"jog": {"axis": "X", "direction": 1}}`, repeated while the key is held, with
    `"repeat": true` in it. Where somebody holds the machine, `"key": "..."` beside it is the holder's.

    A key that is not repeated for half a second, or whose connection is lost, is released; a repeat that comes later
    does not press it again.
    """

    def __init__(
        self,
        socket: WebSocket,
        machine: ServedMachine,
        rate: float,
        lease: Lease,
        next_number: Callable[[], int],
    ) -> None:
        self._next_number = next_number
        self._socket = socket
        self._machine = machine
        self._lease = lease
        self._beat_s = 1.0 / rate
        self._known: dict[str, int] = {}
        self._held: dict[str, asyncio.TimerHandle] = {}

    async def run(self) -> None:
        """Send until the viewer leaves."""
        await self._socket.accept()
        reading = asyncio.ensure_future(self._read())
        try:
            while not reading.done():
                text = await self._machine.ask(self._message)
                await self._socket.send_text(text)  # waits for a slow reader; nothing queues up meanwhile
                await asyncio.wait([reading], timeout=self._beat_s)
        except (WebSocketDisconnect, RuntimeError, PolycncError):
            pass
        finally:
            reading.cancel()
            for axis in tuple(self._held):
                self._release(axis)
            with contextlib.suppress(RuntimeError, asyncio.CancelledError, WebSocketDisconnect, PolycncError):
                await reading
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):
                await self._socket.close()

    def _message(self) -> str:
        status = status_json(self._machine).decode()
        parts = inventory_parts(self._machine, self._known)
        rate, lease = self._machine.keeper.pace.rate, self._lease.shown().model_dump_json()
        told = f'"status":{status},"inventory":{json.dumps(parts)},"rate":{rate!r},"lease":{lease}'
        return f'{{"number":{self._next_number()},{told}}}'

    async def _read(self) -> None:
        while True:
            text = await self._socket.receive_text()
            if len(text) > _MOST_TEXT:
                return
            answer = await self._machine.ask(lambda text=text: self._jog(text))  # type: ignore[misc]
            if answer:
                await self._socket.send_text(json.dumps(answer))

    def _jog(self, text: str) -> dict[str, Any] | None:
        try:
            message = json.loads(text)
            jog, key = message["jog"], str(message.get("key", ""))[:64]
            axis, direction, rapid = jog["axis"], jog.get("direction"), jog.get("rapid", False)
            is_repeat = jog.get("repeat", False)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            return {
                "refused": {"detail": "not a jog key", "hint": 'Send {"jog": {"axis": "X", "direction": 1}}.'}
            }
        if not isinstance(axis, str):
            return {"refused": {"detail": "an axis is text", "hint": "Name it."}}
        if not direction:
            self._release(axis)
        if not direction or (is_repeat and axis not in self._held):
            return None
        try:
            self._lease.check(key)
        except PolycncError as error:  # also while the key is held: somebody has taken the machine over
            self._release(axis)
            return _refused(error)
        if axis not in self._held:
            asked = {"command": "jog", "axis": axis, "direction": direction, "rapid": rapid}
            try:
                carry_out(self._machine, asked)
            except PolycncError as error:
                return _refused(error)
        else:
            self._held[axis].cancel()
        self._held[axis] = asyncio.get_running_loop().call_later(DEAD_MAN_S, self._release, axis)
        return None

    def _release(self, axis: str) -> None:
        timer = self._held.pop(axis, None)
        if timer is not None:
            timer.cancel()
            self._machine.keeper.submit(lambda: self._let_go(axis), lambda _: None)

    def _let_go(self, axis: str) -> None:
        with contextlib.suppress(PolycncError):
            carry_out(self._machine, {"command": "jog", "axis": axis})


def _refused(error: PolycncError) -> dict[str, Any]:
    return {"refused": {"detail": error.what, "hint": error.hint}}
