"""Snapshots of a machine: kept by name in the process or by a client as a file, gone back to as a whole."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from polycnc.cnc import ControlError, Refusal
from polycnc.machine import Snapshot
from polycnc.servers.http._body import checked, json_object
from polycnc.servers.http._documents import status_json
from polycnc.servers.http._found import JSON, ONE, STATUS, Found, answer, body
from polycnc.servers.machines import ServedMachine

MOST_SNAPSHOTS = 16
BYTES = "application/octet-stream"
_FILE = {"type": "string", "format": "binary"}
_Name = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9][A-Za-z0-9 _.-]{0,63}$")]


class SnapshotShown(BaseModel):
    """A snapshot that is kept, and the cycle of the machine that it is of."""

    name: str
    cycle: int


class SnapshotAsked(BaseModel):
    """The name of a snapshot."""

    model_config = ConfigDict(extra="forbid", strict=True)
    name: _Name = Field("snapshot", description="Its name; one of this name is replaced.")


class SnapshotRoutes:
    """Keep states and go back to them."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        self._kept: dict[str, dict[str, Snapshot]] = {name: {} for name in found.machines}
        asked = body(SnapshotAsked.model_json_schema())
        router.get(
            f"{ONE}/snapshot",
            summary="The present state as a file.",
            response_class=Response,
            responses=answer(_FILE, BYTES),
        )(self.file)
        router.put(
            f"{ONE}/snapshot",
            summary="Go back to the state of a file.",
            openapi_extra=body(_FILE, BYTES),
            response_class=Response,
            responses=answer(STATUS),
        )(self.restore_file)
        router.get(f"{ONE}/snapshots", summary="The snapshots that are kept.")(self.list)
        router.post(f"{ONE}/snapshot", summary="Keep the present state.", openapi_extra=asked)(self.keep)
        router.post(
            f"{ONE}/restore",
            summary="Go back to a state that was kept.",
            openapi_extra=asked,
            response_class=Response,
            responses=answer(STATUS),
        )(self.restore)
        router.delete(f"{ONE}/snapshots/{{name}}", summary="Forget a snapshot.", status_code=204)(self.forget)

    async def list(self, machine: str) -> list[SnapshotShown]:
        """Return names and cycles."""
        self._found.machine(machine)
        return [SnapshotShown(name=name, cycle=each.cycle) for name, each in self._kept[machine].items()]

    async def keep(self, machine: str, request: Request) -> SnapshotShown:
        """Keep the state under a name."""
        found = self._found.machine(machine)
        name = checked(SnapshotAsked, await json_object(request)).name
        kept = self._kept[machine]
        if name not in kept and len(kept) >= MOST_SNAPSHOTS:
            raise ControlError(
                Refusal.FULL, f"{MOST_SNAPSHOTS} snapshots are kept", hint="Replace or delete one."
            )
        kept[name] = await found.ask(found.device.snapshot)
        return SnapshotShown(name=name, cycle=kept[name].cycle)

    async def restore(self, machine: str, request: Request) -> Response:
        """Go back to a state; the answer is the status then."""
        found = self._found.machine(machine)
        kept = self._of(machine, checked(SnapshotAsked, await json_object(request)).name)
        return await _gone_back(found, lambda: kept)

    async def file(self, machine: str) -> Response:
        """Return the present state as the contents of a file."""
        found = self._found.machine(machine)
        state = await found.ask(found.device.snapshot)
        return Response(state.to_bytes(), media_type=BYTES)

    async def restore_file(self, machine: str, request: Request) -> Response:
        """Go back to the state of a file; the answer is the status then."""
        found = self._found.machine(machine)
        content = await request.body()
        return await _gone_back(found, lambda: type(found.device.snapshot()).from_bytes(content))

    async def forget(self, machine: str, name: str) -> Response:
        """Delete a snapshot."""
        self._found.machine(machine)
        self._of(machine, name)
        del self._kept[machine][name]
        return Response(status_code=204)

    def _of(self, machine: str, name: str) -> Snapshot:
        kept = self._kept[machine].get(name)
        if kept is None:
            raise ControlError(Refusal.NOT_FOUND, "there is no such snapshot", hint="See the list of them.")
        return kept


async def _gone_back(machine: ServedMachine, state: Callable[[], Snapshot]) -> Response:
    def go_back() -> bytes:
        machine.device.restore(state())
        return status_json(machine)

    return Response(await machine.ask(go_back), media_type=JSON)
