"""What REST answers, for one machine; each question is asked between two cycles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Path, Request, Response
from pydantic import BaseModel
from starlette.websockets import WebSocket

from polycnc.servers.commands import COMMANDS, carry_out, model_of
from polycnc.servers.http._body import json_object
from polycnc.servers.http._check import CheckRoutes
from polycnc.servers.http._clock import ClockRoutes
from polycnc.servers.http._data import DataRoutes
from polycnc.servers.http._documents import as_json, status_json
from polycnc.servers.http._found import JSON, NUMBER_HEADER, ONE, REFUSALS, STATUS, Found, answer, body
from polycnc.servers.http._lease import KeyShown, LeaseRoutes, Leases, is_for_all
from polycnc.servers.http._path import PathRoutes
from polycnc.servers.http._scenarios import ScenarioRoutes
from polycnc.servers.http._screens import ScreenRoutes
from polycnc.servers.http._snapshots import SnapshotRoutes
from polycnc.servers.http._stream import Stream, rate_of
from polycnc.servers.machines import Log, ServedMachine

PARTS = ("programs", "tools", "offsets", "alarms", "messages")
_TEXT = "text/plain"
_ANY_TEXT = {"type": "string", "maxLength": 16 << 20}
_Name = Annotated[str, Path(min_length=1, max_length=64)]


class MachineShown(BaseModel):
    """A machine: its name in paths, its kind of controller, and what it has of what only some machines have."""

    name: str
    kind: str
    parts: list[str]


class DoorShown(BaseModel):
    """A door to a machine: where it is, and the addresses of the clients that are connected now."""

    door: str
    address: str
    clients: list[str]


class CommandShown(BaseModel):
    """A command: what it does, the modes that it needs (empty: any), and the schema of its body."""

    command: str
    what: str
    modes: list[str]
    body: dict[str, Any]


class Api:
    """The questions that can be asked of machines, as a router."""

    def __init__(self, machines: Mapping[str, ServedMachine], log: Log) -> None:
        self._found = found = Found(machines, log)
        self._leases = leases = Leases(machines)
        self.router = router = APIRouter(
            prefix="/api/machines", responses=REFUSALS, dependencies=[Depends(leases.check)]
        )
        get = router.get
        get("", summary="The machines.")(self.machines)
        get(f"{ONE}/status", summary="All that a machine shows at its present cycle.", response_class=Response,
            responses=answer(STATUS))(self.status)  # fmt: skip
        get(f"{ONE}/inventory", summary="What changes seldom, with a revision for each part.",
            response_class=Response,
            responses=answer({"$ref": "#/components/schemas/Inventory"}))(self.inventory)  # fmt: skip
        for part in PARTS:
            shape = {"$ref": f"#/components/schemas/Inventory/properties/{part}"}
            get(f"{ONE}/{part}", summary=f"The {part}.", response_class=Response, responses=answer(shape))(
                self._part(part)
            )
        at = f"{ONE}/programs/{{name}}"
        get(at, summary="The text of a program.", response_class=Response,
            responses=answer(_ANY_TEXT, f"{_TEXT}; charset=utf-8"))(self.program)  # fmt: skip
        router.put(at, summary="Put a program in.", status_code=204, openapi_extra=body(_ANY_TEXT, _TEXT),
            responses={201: {"description": "It is new."}})(self.put)  # fmt: skip
        router.delete(at, summary="Delete a program.", status_code=204)(self.delete)
        get(f"{ONE}/commands", summary="The commands, with their parameters.")(self.commands)
        models = [model_of(name).model_json_schema() for name in COMMANDS]
        router.post(f"{ONE}/commands", summary="Carry out a command.", response_class=Response,
            responses=answer({"$ref": "#/components/schemas/Status"}),
            openapi_extra=body({"oneOf": models}))(self.command)  # fmt: skip
        DataRoutes(found, router)
        ClockRoutes(found, router)
        SnapshotRoutes(found, router)
        PathRoutes(found, router)
        CheckRoutes(found, router)
        ScenarioRoutes(found, router)
        get(f"{ONE}/connections", summary="The doors, and who is connected.")(self.connections)
        ScreenRoutes(found, router)
        LeaseRoutes(found, leases, router)
        router.websocket(f"{ONE}/stream")(self.stream)

    async def machines(self) -> list[MachineShown]:
        """Return names and kinds."""
        return [
            MachineShown(name=each.name, kind=each.kind, parts=each.parts)
            for each in self._found.machines.values()
        ]

    async def connections(self, machine: str) -> list[DoorShown]:
        """Return the doors to a machine with their clients, those that machines share with all of theirs."""
        doors = self._found.machine(machine).doors
        return [DoorShown(door=name, address=door.said, clients=door.clients) for name, door in doors.items()]

    async def status(self, machine: str) -> Response:
        """Return the status."""
        found = self._found.machine(machine)
        return Response(await found.ask(lambda: status_json(found)), media_type=JSON)

    async def inventory(self, machine: str) -> Response:
        """Return the inventory."""
        found, control = self._found.operated(machine)
        return Response(await found.ask(lambda: as_json(control().inventory())), media_type=JSON)

    def _part(self, part: str) -> Callable[[str], Any]:
        async def read(machine: str) -> Response:
            found, control = self._found.operated(machine)
            shown = await found.ask(lambda: as_json(getattr(control().inventory(), part)))
            return Response(shown, media_type=JSON)

        read.__name__ = part
        return read

    async def program(self, machine: str, name: _Name) -> Response:
        """Return a program as it is kept."""
        found, programs = self._found.programs(machine)
        content = await found.ask(lambda: programs.read(name))
        return Response(content, media_type=f"{_TEXT}; charset=utf-8")

    async def put(self, machine: str, name: _Name, request: Request) -> Response:
        """Put a program in, in place of one of this name."""
        found, programs = self._found.programs(machine)
        content = await request.body()
        is_new = await found.ask(lambda: programs.put(name, content))
        self._found.log.write("program", machine=machine, name=name, bytes=len(content))
        return Response(status_code=201 if is_new else 204)

    async def delete(self, machine: str, name: _Name) -> Response:
        """Delete a program."""
        found, programs = self._found.programs(machine)
        await found.ask(lambda: programs.delete(name))
        self._found.log.write("program", machine=machine, name=name, deleted=True)
        return Response(status_code=204)

    async def commands(self, machine: str) -> list[CommandShown]:
        """Return the rows of the commands."""
        self._found.operated(machine)
        return [
            CommandShown(
                command=row.name,
                what=row.what,
                modes=[mode.value for mode in row.modes],
                body=model_of(row.name).model_json_schema(),
            )
            for row in COMMANDS.values()
        ]

    async def command(self, machine: str, request: Request, key: KeyShown = "") -> Response:
        """Carry out a command; the answer is the status after it."""
        found = self._found.machine(machine)
        asked = await json_object(request)
        if not is_for_all(asked):
            self._leases.of(machine).check(key)

        def done() -> tuple[bytes, int]:
            carry_out(found, asked)
            return status_json(found), self._found.next_number()

        shown, number = await found.ask(done)
        self._found.log.write("command", machine=machine, door="http", asked=asked)
        return Response(shown, media_type=JSON, headers={NUMBER_HEADER: str(number)})

    async def stream(self, socket: WebSocket, machine: str) -> None:
        """Send statuses until the viewer leaves."""
        found = self._found.machines.get(machine)
        if found is None:
            await socket.close(1008, "there is no such machine")
            return
        rate, lease = rate_of(socket.query_params.get("rate")), self._leases.of(machine)
        await Stream(socket, found, rate, lease, self._found.next_number).run()
