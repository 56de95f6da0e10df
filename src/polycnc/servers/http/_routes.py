"""What REST answers, for one machine; each question is asked between two cycles."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Mapping
from typing import Any

from fastapi import APIRouter, Request, Response
from starlette.websockets import WebSocket

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.machine import Snapshot
from polycnc.servers.commands import COMMANDS, carry_out, model_of
from polycnc.servers.http._body import json_object
from polycnc.servers.http._documents import as_json, status_json
from polycnc.servers.http._problem import Problem
from polycnc.servers.http._stream import Stream, rate_of
from polycnc.servers.machines import Log, ServedMachine

_MOST_SNAPSHOTS = 16
_MOST_STEP, _MOST_RATE = 1_000_000, 1000.0
_MOST_IDLE = 100  # looks at a device whose time does not pass
_JSON = "application/json"
REFUSALS: dict[int | str, dict[str, Any]] = {
    code: {"model": Problem, "description": "Refused."} for code in (400, 403, 404, 409, 413, 422, 503)
}


class Api:
    """The questions that can be asked of machines, as a router."""

    def __init__(self, machines: Mapping[str, ServedMachine], log: Log) -> None:
        self._machines = machines
        self._log = log
        self._snapshots: dict[str, dict[str, Snapshot]] = {name: {} for name in machines}
        self.router = router = APIRouter(prefix="/api/machines", responses=REFUSALS)
        get, one = router.get, "/{machine}"
        get("", summary="The machines.")(self.machines)
        get(f"{one}/status", summary="All that a machine shows at its present cycle.")(self.status)
        get(f"{one}/inventory", summary="What changes seldom, with a revision for each part.")(self.inventory)
        for part in ("programs", "tools", "offsets", "alarms", "messages"):
            get(f"{one}/{part}", summary=f"The {part}.")(self._part(part))
        get(f"{one}/programs/{{name}}", summary="The text of a program.")(self.program)
        text = {"requestBody": {"content": {"text/plain": {"schema": {"type": "string"}}}}}
        router.put(
            f"{one}/programs/{{name}}", summary="Put a program in.", status_code=204, openapi_extra=text
        )(self.put)
        router.delete(f"{one}/programs/{{name}}", summary="Delete a program.", status_code=204)(self.delete)
        get(f"{one}/commands", summary="The commands, with their parameters.")(self.commands)
        models = [model_of(name).model_json_schema() for name in COMMANDS]
        router.post(f"{one}/commands", summary="Carry out a command.", status_code=200,
            openapi_extra=_body({"oneOf": models}))(self.command)  # fmt: skip
        get(f"{one}/clock", summary="The pace of time.")(self.clock)
        router.post(f"{one}/clock", summary="Change the pace, step or jump.", openapi_extra=_body(_CLOCK))(
            self.set_clock
        )
        get(f"{one}/snapshots", summary="The snapshots that are kept.")(self.snapshots)
        router.put(f"{one}/snapshots/{{name}}", summary="Keep the present state.", status_code=204)(self.keep)
        router.post(f"{one}/snapshots/{{name}}", summary="Go back to a state.", status_code=204)(self.go_back)
        router.websocket(f"{one}/stream")(self.stream)

    # ------------------------------------------------------------------ reading

    async def machines(self) -> list[dict[str, str]]:
        """Return names and kinds."""
        return [{"name": each.name, "kind": each.kind} for each in self._machines.values()]

    async def status(self, machine: str) -> Response:
        """Return the status."""
        found = self._found(machine)
        return Response(await found.ask(lambda: status_json(found)), media_type=_JSON)

    async def inventory(self, machine: str) -> Response:
        """Return the inventory."""
        found, control = self._operated(machine)
        return Response(await found.ask(lambda: as_json(control().inventory())), media_type=_JSON)

    def _part(self, part: str) -> Callable[[str], Any]:
        async def read(machine: str) -> Response:
            found, control = self._operated(machine)
            return Response(
                await found.ask(lambda: as_json(getattr(control().inventory(), part))), media_type=_JSON
            )

        read.__name__ = part
        return read

    async def program(self, machine: str, name: str) -> Response:
        """Return a program as it is kept."""
        found, _ = self._operated(machine)
        programs = found.programs
        assert programs is not None
        content = await found.ask(lambda: programs.read(name))
        return Response(content, media_type="text/plain; charset=utf-8")

    # ------------------------------------------------------------------ changing

    async def put(self, machine: str, name: str, request: Request) -> Response:
        """Put a program in, in place of one of this name."""
        found, _ = self._operated(machine)
        programs = found.programs
        assert programs is not None
        content = await request.body()
        is_new = await found.ask(lambda: programs.put(name, content))
        self._log.write("program", machine=machine, name=name, bytes=len(content))
        return Response(status_code=201 if is_new else 204)

    async def delete(self, machine: str, name: str) -> Response:
        """Delete a program."""
        found, _ = self._operated(machine)
        programs = found.programs
        assert programs is not None
        await found.ask(lambda: programs.delete(name))
        return Response(status_code=204)

    async def commands(self, machine: str) -> list[dict[str, Any]]:
        """Return the rows of the commands."""
        self._operated(machine)
        return [
            {
                "command": row.name,
                "what": row.what,
                "modes": [mode.value for mode in row.modes],
                "schema": model_of(row.name).model_json_schema(),
            }
            for row in COMMANDS.values()
        ]

    async def command(self, machine: str, request: Request) -> Response:
        """Carry out a command; the answer is the status after it."""
        found = self._found(machine)
        asked = await json_object(request)

        def done() -> bytes:
            carry_out(found, asked)
            return status_json(found)

        answer = await found.ask(done)
        self._log.write("command", machine=machine, door="http", asked=asked)
        return Response(answer, media_type=_JSON)

    async def clock(self, machine: str) -> dict[str, float]:
        """Return the rate and the cycles that have passed."""
        found = self._found(machine)
        cycles = await found.ask(lambda: found.served.clock.cycles)
        return {
            "rate": found.keeper.pace.rate,
            "cycles": cycles,
            "cycle_s": found.served.clock.cycle_s,
        }

    async def set_clock(self, machine: str, request: Request) -> dict[str, float]:
        """Set the rate, or let cycles pass beside it."""
        found = self._found(machine)
        asked = await json_object(request)
        if len(asked) != 1 or next(iter(asked)) not in _CLOCK["properties"]:
            raise _no_clock("one of rate, step, jump is to be given")
        ((what, value),) = asked.items()
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise _no_clock(f"{what} is no number")
        if what == "rate":
            if not 0.0 <= value <= _MOST_RATE:
                raise _no_clock(f"a rate of {value:g}")
            await found.ask(lambda: setattr(found.keeper.pace, "rate", float(value)))
        else:
            if not isinstance(value, int) or not 1 <= value <= _MOST_STEP:
                raise _no_clock(f"{what} is no number of cycles")
            await _pass(found, value)
        return await self.clock(machine)

    async def snapshots(self, machine: str) -> list[dict[str, Any]]:
        """Return names and cycles of the snapshots."""
        self._found(machine)
        return [{"name": name, "cycle": each.cycle} for name, each in self._snapshots[machine].items()]

    async def keep(self, machine: str, name: str) -> Response:
        """Keep the state under a name, in place of one of this name."""
        found = self._found(machine)
        kept = self._snapshots[machine]
        if not (0 < len(name) <= 64 and name.isprintable()):
            raise ControlError(Refusal.DATA, "this cannot name a snapshot", hint="Give 1 to 64 characters.")
        if name not in kept and len(kept) >= _MOST_SNAPSHOTS:
            raise ControlError(Refusal.FULL, f"{_MOST_SNAPSHOTS} snapshots are kept", hint="Replace one.")
        kept[name] = await found.ask(found.device.snapshot)
        return Response(status_code=204)

    async def go_back(self, machine: str, name: str) -> Response:
        """Go back to a state that was kept."""
        found = self._found(machine)
        kept = self._snapshots[machine].get(name)
        if kept is None:
            raise ControlError(Refusal.NOT_FOUND, "there is no such snapshot", hint="Keep one with PUT.")
        await found.ask(lambda: found.device.restore(kept))
        return Response(status_code=204)

    async def stream(self, socket: WebSocket, machine: str) -> None:
        """Send statuses until the viewer leaves."""
        found = self._machines.get(machine)
        if found is None:
            await socket.close(1008, "there is no such machine")
            return
        await Stream(socket, found, rate_of(socket.query_params.get("rate"))).run()

    # ------------------------------------------------------------------ within

    def _found(self, machine: str) -> ServedMachine:
        found = self._machines.get(machine)
        if found is None:
            hint = f"Machines are {', '.join(list(self._machines)[:10])}."
            raise ControlError(Refusal.NOT_FOUND, "there is no such machine", hint=hint)
        return found

    def _operated(self, machine: str) -> tuple[ServedMachine, Callable[[], Control]]:
        found = self._found(machine)
        if found.find_control is None:
            raise ControlError(
                Refusal.NOT_FOUND, f"machine {machine} has no control", hint="Ask for its status."
            )
        return found, found.find_control


async def _pass(machine: ServedMachine, cycles: int) -> None:
    """Let cycles pass beside the pace, and wait until they have; other clients are answered meanwhile."""
    clock = machine.served.clock
    before = await machine.ask(lambda: clock.cycles)
    machine.keeper.pace.step(cycles)
    last, idle = before, 0
    while clock.cycles - before < cycles and idle < _MOST_IDLE:
        await asyncio.sleep(0)
        now = await machine.ask(lambda: clock.cycles)
        last, idle = now, idle + 1 if now == last else 0


def _no_clock(what: str) -> ControlError:
    hint = f"Give rate (0 to {_MOST_RATE:g}), or step: 1 to {_MOST_STEP} cycles."
    return ControlError(Refusal.DATA, what, hint=hint)


_CLOCK: dict[str, Any] = {
    "type": "object",
    "properties": {
        "rate": {"type": "number", "minimum": 0, "maximum": _MOST_RATE},
        "step": {"type": "integer", "minimum": 1, "maximum": _MOST_STEP},
    },
    "minProperties": 1,
    "maxProperties": 1,
    "additionalProperties": False,
}


def _body(schema: dict[str, Any]) -> dict[str, Any]:
    return {"requestBody": {"required": True, "content": {_JSON: {"schema": schema}}}}
