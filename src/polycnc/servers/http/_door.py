"""The door: the application of the machines on its port."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.servers.asgi import AsgiDoor, Refused
from polycnc.servers.http._app import make_app
from polycnc.servers.http._documents import status_json
from polycnc.servers.http._problem import problem
from polycnc.servers.machines import ServedMachine, Treatment, Wanted, machines_of_path, treatment_of

PORT = 8080


class HttpDoor(AsgiDoor):
    """Serve machines by HTTP on one port."""

    def __init__(self, machines: Sequence[ServedMachine], wanted: Wanted) -> None:
        self._machines = machines
        self._guard = app = make_app(machines, token=wanted.token, log=wanted.log, hosts=(wanted.address,))
        port = PORT if wanted.port is None else wanted.port

        def treat(path: str) -> Treatment:
            return treatment_of(machines_of_path(machines, path), "http")

        super().__init__("http", app, wanted.address, port, _refuse, treat)

    async def start(self) -> None:
        """Listen, and get ready while no time passes yet: the first clients do not have the machines wait.

        Raises:
            UsageError: The address or port cannot be listened on.
        """
        await super().start()
        await self._guard.warm()
        for machine in {each.kind: each for each in self._machines}.values():
            status_json(machine)


def _refuse(status: int, what: str, hint: str) -> Refused:
    said = problem(status, what, hint)
    return Refused(status, said.raw_headers, bytes(said.body))
