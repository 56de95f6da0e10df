"""Who commands a machine: one client may hold it for a while, the others watch; anybody may take it over."""

from __future__ import annotations

import asyncio
import hmac
from collections.abc import Mapping
from typing import Annotated

from fastapi import APIRouter, Header, Request, Response
from pydantic import BaseModel, ConfigDict, Field, StringConstraints
from starlette.requests import HTTPConnection

from polycnc.errors import PolycncError
from polycnc.servers.http._body import checked, json_object
from polycnc.servers.http._found import NUMBER_HEADER, ONE, Found, body
from polycnc.servers.machines import ServedMachine

USUAL_S, MOST_S = 10.0, 600.0
KEY_HEADER = "polycnc-key"
_Key = Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_-]{8,64}$")]
_Name = Annotated[str, StringConstraints(pattern=r"^[^\x00-\x1f\x7f]{1,40}$")]
KeyShown = Annotated[str, Header(alias=KEY_HEADER, max_length=64, description="The key of the holder.")]


def is_for_all(asked: Mapping[str, object]) -> bool:
    """Tell whether whoever sees a danger may give a command: to brake, and to press the emergency stop."""
    name = asked.get("command")
    return name == "feed_hold" or (name == "emergency_stop" and asked.get("on", True) is True)


class HeldError(PolycncError):
    """Somebody else commands this machine."""


class LeaseShown(BaseModel):
    """Who commands a machine, null if nobody does alone, and for how long without renewing (s).

    `turn` grows whenever another key takes it: a holder knows by it that the lease is still its own.
    """

    holder: str | None
    left_s: float
    turn: int


class LeaseAsked(BaseModel):
    """Hold a machine, or go on holding it: `key` is chosen by the client and shown with its requests."""

    model_config = ConfigDict(extra="forbid", strict=True)
    operator: _Name = Field(description="The name that others see.")
    key: _Key
    seconds: Annotated[float, Field(gt=0, le=MOST_S, allow_inf_nan=False)] = USUAL_S
    take: bool = Field(False, description="Take it from whoever holds it.")


class Lease:
    """The lease of one machine, by the clock of the event loop."""

    def __init__(self) -> None:
        self._holder = self._key = ""
        self._until_s = 0.0
        self._turn = 0

    def shown(self) -> LeaseShown:
        """Return who holds it."""
        left_s = self._until_s - asyncio.get_running_loop().time()
        held = bool(self._key) and left_s > 0.0
        left_s = round(left_s, 3) if held else 0.0
        return LeaseShown(holder=self._holder if held else None, left_s=left_s, turn=self._turn)

    def check(self, key: str) -> None:
        """Refuse whoever does not hold it while somebody does.

        Raises:
            HeldError: Somebody else holds it.
        """
        holder = self.shown().holder
        if holder is not None and not hmac.compare_digest(key.encode("utf-8", "replace"), self._key.encode()):
            raise HeldError(f"{holder} commands this machine", hint="Wait, or take it over.")

    def take(self, asked: LeaseAsked) -> LeaseShown:
        """Hold it from now on for so long.

        Raises:
            HeldError: Somebody else holds it, and it is not to be taken.
        """
        if not asked.take:
            self.check(asked.key)
        if asked.key != self._key:
            self._turn += 1
        self._holder, self._key = asked.operator, asked.key
        self._until_s = asyncio.get_running_loop().time() + asked.seconds
        return self.shown()

    def give_back(self, key: str) -> None:
        """Hold it no longer.

        Raises:
            HeldError: Somebody else holds it.
        """
        self.check(key)
        self._key = ""


class Leases:
    """Show, take and give back; `check` is asked before whatever changes a machine, but commands."""

    def __init__(self, machines: Mapping[str, ServedMachine]) -> None:
        self._by_name = {name: Lease() for name in machines}

    def of(self, machine: str) -> Lease:
        """Return the lease of a machine; of one that there is not nobody holds one."""
        return self._by_name.get(machine) or Lease()

    async def check(self, asked: HTTPConnection, key: KeyShown = "") -> None:
        """Refuse what would change a machine that somebody else holds."""
        changes = asked.scope.get("method", "GET") != "GET"
        if changes and not asked.scope["path"].endswith(("/lease", "/commands")):
            self.of(asked.path_params.get("machine", "")).check(key)


class LeaseRoutes:
    """The questions about leases."""

    def __init__(self, found: Found, leases: Leases, router: APIRouter) -> None:
        self._found = found
        self._leases = leases
        at = f"{ONE}/lease"
        router.get(at, summary="Who commands.")(self.lease)
        router.post(at, summary="Command alone, for a while.",
            openapi_extra=body(LeaseAsked.model_json_schema()))(self.take_lease)  # fmt: skip
        router.delete(at, summary="Let everybody command.", status_code=204)(self.give_lease_back)

    async def lease(self, machine: str) -> LeaseShown:
        """Return who holds a machine."""
        self._found.machine(machine)
        return self._leases.of(machine).shown()

    async def take_lease(self, machine: str, request: Request, response: Response) -> LeaseShown:
        """Hold a machine, or go on holding it."""
        self._found.machine(machine)
        asked = checked(LeaseAsked, await json_object(request))
        before = self._leases.of(machine).shown().holder
        shown = self._leases.of(machine).take(asked)
        response.headers[NUMBER_HEADER] = str(self._found.next_number())
        if before != shown.holder:
            self._found.log.write("lease", machine=machine, holder=shown.holder, before=before)
        return shown

    async def give_lease_back(self, machine: str, key: KeyShown = "") -> Response:
        """Hold a machine no longer."""
        self._found.machine(machine)
        self._leases.of(machine).give_back(key)
        self._found.log.write("lease", machine=machine, holder=None)
        return Response(status_code=204)
