"""What is wrong with a program, before it is put into the memory."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from pydantic import BaseModel

from polycnc.cnc import Control
from polycnc.errors import ProgramError
from polycnc.nc import ProgramText
from polycnc.nc.cpl import holds_cpl
from polycnc.servers.http._beside import Beside, Check, Work, copies_of
from polycnc.servers.http._documents import as_json
from polycnc.servers.http._found import JSON, ONE, Found, body
from polycnc.servers.http._guard import TooLargeError
from polycnc.servers.machines import ServedMachine

MOST_CHECKED_BYTES = 1 << 20
MOST_ERRORS = 200
_TEXT = {"type": "string", "maxLength": MOST_CHECKED_BYTES}


class ErrorShown(BaseModel):
    """An error of a program: its place (from 1; line 0 if it is in another program), what is wrong, what to do."""

    line: int
    column: int
    text: str
    hint: str


class CheckRoutes:
    """Check programs as `polycnc check` does, on a machine of their own with this control's tools and sub-programs."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        self._beside = Beside("check", "Use polycnc check.")
        router.post(
            f"{ONE}/check",
            summary="What is wrong with a program.",
            response_model=list[ErrorShown],
            openapi_extra=body(_TEXT, "text/plain", required=False),
        )(self.check)

    async def check(
        self,
        machine: str,
        request: Request,
        program: Annotated[str, Query(min_length=1, max_length=64, description="Its name.")] = "program",
    ) -> Response:
        """Return the errors of a text in their order; nothing changes."""
        found, control = self._found.operated(machine)
        content = await request.body()
        if len(content) > MOST_CHECKED_BYTES:
            raise TooLargeError
        text = ProgramText(program, content)
        shown = await self._beside.run(lambda: found.ask(lambda: _work(found, control(), text)))
        return Response(shown, media_type=JSON)


def _work(machine: ServedMachine, control: Control, text: ProgramText) -> Work:
    assert machine.programs is not None
    copies, folder = copies_of(control, machine.programs), machine.folder

    def compute(check: Check) -> bytes:
        # A server that nobody asks for a check starts without it.
        from polycnc.runner import errors_in, inspect

        if copies.dialect.language == "cpl" and holds_cpl(text.content):
            found = inspect(
                text, copies.config, copies.dialect, root=folder, rehearse=False, progress=check
            ).errors
        else:
            found = errors_in(
                text, copies.config, copies.dialect, language=copies.language, texts=copies.texts,
                progress=check,
            )  # fmt: skip
        return as_json([_shown(each, text.name).model_dump() for each in found[:MOST_ERRORS]])

    return compute


def _shown(error: ProgramError, name: str) -> ErrorShown:
    place = error.position
    if place is None or place.file != name:
        what = error.what if place is None else f"{place}: {error.what}"
        return ErrorShown(line=0, column=0, text=what, hint=error.hint)
    return ErrorShown(line=place.line, column=place.column, text=error.what, hint=error.hint)
