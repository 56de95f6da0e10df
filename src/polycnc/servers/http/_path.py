"""The path of a program before it runs."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Response

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.nc import ProgramText
from polycnc.servers.http._beside import Beside, Check, Work, copies_of
from polycnc.servers.http._documents import as_json
from polycnc.servers.http._found import JSON, ONE, Found, answer
from polycnc.servers.machines import Programs

MOST_POINTS = 20_000
_SCHEMA = {"type": "object", "required": ["program", "time_s", "t_s", "positions", "rapid", "line", "errors"]}


class PathRoutes:
    """Show where programs go, as `polycnc view` draws it."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        self._beside = Beside("path", "Use polycnc view.")
        router.get(f"{ONE}/path", summary="Where a program goes, before it runs.", response_class=Response,
            responses=answer(_SCHEMA))(self.show)  # fmt: skip

    async def show(
        self,
        machine: str,
        program: Annotated[str, Query(max_length=64, description="Its name; else the selected one.")] = "",
    ) -> Response:
        """Return the path of a program of the memory, on a machine of its own with these tools and offsets."""
        found, programs = self._found.programs(machine)
        _, control = self._found.operated(machine)
        shown = await self._beside.run(lambda: found.ask(lambda: _work(control(), programs, program)))
        return Response(shown, media_type=JSON)


def _work(control: Control, programs: Programs, name: str) -> Work:
    """Return what computes a path, from copies of what the control has now."""
    if not name:
        name = control.channel_status().program or ""
        if not name:
            raise ControlError(Refusal.NOT_FOUND, "no program is selected", hint="Name one.")
    if control.dialect.language == "cpl":
        raise ControlError(
            Refusal.DATA,
            "statements of CPL run on their control alone",
            hint="Run the program, or use polycnc view.",
        )
    text = ProgramText(name, programs.read(name))
    copies = copies_of(control, programs)

    def compute(check: Check) -> bytes:
        from polycnc.runner.view import preview  # a server that nobody asks for a path starts without it

        shown = preview(
            text, copies.config, copies.dialect, language=copies.language, texts=copies.texts,
            most=MOST_POINTS, progress=check,
        )  # fmt: skip
        return as_json(shown)

    return compute
