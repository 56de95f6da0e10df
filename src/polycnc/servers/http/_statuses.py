"""The question that is asked most, without the way through the router: the status of a machine."""

from __future__ import annotations

from collections.abc import Mapping

from starlette.types import ASGIApp, Receive, Scope, Send

from polycnc.errors import PolycncError
from polycnc.servers.asgi import Said, answers_again
from polycnc.servers.http._documents import status_json
from polycnc.servers.http._lease import KEY_HEADER
from polycnc.servers.http._problem import of_error
from polycnc.servers.machines import ServedMachine

_KEY_HEADER = KEY_HEADER.encode()


class Statuses:
    """Answer `GET .../status` of the machines that there are; everything else is handed on.

    The answer is that of the route, which describes it, and answers for a machine that there is not.
    """

    def __init__(self, app: ASGIApp, machines: Mapping[str, ServedMachine]) -> None:
        self._app = app
        self._by_path = {f"/api/machines/{name}/status": machine for name, machine in machines.items()}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or hand on."""
        machine = self._by_path.get(scope["path"]) if scope["type"] == "http" else None
        if machine is None or scope["method"] != "GET" or _shows_key(scope):
            await self._app(scope, receive, send)
            return
        try:
            said = _said(machine)
        except PolycncError as error:
            await of_error(error)(scope, receive, send)
            return
        answers_again(scope, lambda: _again(machine))
        await send({"type": "http.response.start", "status": 200, "headers": said.headers})
        await send({"type": "http.response.body", "body": said.body})


def _said(machine: ServedMachine) -> Said:
    shown = machine.ask_at_once(lambda: status_json(machine))
    return Said([(b"content-length", b"%d" % len(shown)), (b"content-type", b"application/json")], shown)


def _again(machine: ServedMachine) -> Said | None:
    """Answer once more, unless a scenario wants something else or the machine has failed."""
    try:
        return _said(machine) if machine.is_usual else None
    except PolycncError:
        return None


def _shows_key(scope: Scope) -> bool:
    """Tell whether a request shows a key, which the route checks."""
    return any(name == _KEY_HEADER for name, _ in scope["headers"])
