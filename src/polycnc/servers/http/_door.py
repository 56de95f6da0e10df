"""The door: the application of the machines on its port."""

from __future__ import annotations

from collections.abc import Sequence

from polycnc.servers.asgi import AsgiDoor
from polycnc.servers.http._app import make_app
from polycnc.servers.machines import ServedMachine, Wanted

PORT = 8080


class HttpDoor(AsgiDoor):
    """Serve machines by HTTP on one port."""

    def __init__(self, machines: Sequence[ServedMachine], wanted: Wanted) -> None:
        app = make_app(machines, token=wanted.token, log=wanted.log, hosts=(wanted.address,))
        super().__init__("http", app, wanted.address, PORT if wanted.port is None else wanted.port)
