"""Refusals as problem+json (RFC 9457): the control's number, text and hint."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel, Field
from starlette.responses import Response

from polycnc.cnc import ControlError, Refusal
from polycnc.errors import PolycncError
from polycnc.machine import SnapshotError
from polycnc.servers.commands import NUMBERS, NotMeantError
from polycnc.servers.machines import MachineError

_TOO_LARGE = 413
_STATUS = {Refusal.NOT_FOUND: 404, Refusal.PROTECTED: 403}
"""Status codes of a control's refusals; the others are 409: what was asked is well-formed."""


class Problem(BaseModel):
    """What was refused: `number` and `reason` are the control's, 0 and "request" where it was not asked."""

    title: str
    status: int
    detail: str
    hint: str = ""
    number: int = 0
    reason: str = "request"
    errors: list[str] = Field(default_factory=list, description="Places, each a line.")


def problem(status: int, detail: str, hint: str = "", **more: Any) -> Response:
    """Return a refusal."""
    said = Problem(title=_TITLES.get(status, "refused"), status=status, detail=detail, hint=hint, **more)
    body = json.dumps(said.model_dump()).encode()
    closing = {"connection": "close"} if status == _TOO_LARGE else None  # the rest of it is not read
    return Response(body, status, closing, media_type="application/problem+json")


def of_error(error: PolycncError) -> Response:
    """Return the refusal of a control, 409 where its state is in the way."""
    if isinstance(error, ControlError):
        status = 422 if isinstance(error, NotMeantError) else _STATUS.get(error.reason, 409)
        return problem(
            status, error.what, error.hint, number=NUMBERS[error.reason], reason=error.reason.value,
            errors=_places(error.__cause__ or error),
        )  # fmt: skip
    if isinstance(error, SnapshotError):
        reason = Refusal.SNAPSHOT
        return problem(409, error.what, error.hint, number=NUMBERS[reason], reason=reason.value)
    if isinstance(error, MachineError):
        return problem(503, error.what, error.hint)
    return problem(422, error.what, error.hint, errors=_places(error))


def _places(error: BaseException) -> list[str]:
    """Return what is wrong with a file, a line for each thing with its place."""
    parts: tuple[BaseException, ...] = getattr(error, "parts", ()) or (error,)
    placed = [(getattr(each, "position", None), getattr(each, "what", "")) for each in parts]
    return [f"{place}: {what}" for place, what in placed if place is not None]


_TITLES = {
    401: "unauthorized", 403: "forbidden", 404: "not found", 405: "method not allowed", 409: "the control refuses",
    413: "too large", 415: "unsupported media type", 421: "misdirected request", 422: "cannot be meant",
    429: "too many requests", 431: "headers too large", 503: "not available",
}  # fmt: skip
