"""Read bodies: JSON without doubled fields and numbers that are none, bounded in depth."""

from __future__ import annotations

import json
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError
from starlette.requests import Request

from polycnc.servers.commands import NotMeantError, first_problem
from polycnc.servers.http._guard import TooLargeError

M = TypeVar("M", bound=BaseModel)
MOST_JSON_BYTES = 1 << 20
_EXACT = 2.0**53


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) != len(pairs):
        raise ValueError("a field is there twice")
    return made


def _number(text: str) -> float:
    """Return a number; one without a fraction is whole however it is written, as JSON Schema counts it."""
    value = float(text)
    return int(value) if abs(value) <= _EXACT and value == int(value) else value


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is not a number")


async def json_object(request: Request) -> dict[str, Any]:
    """Return the object that a request brings.

    Raises:
        NotMeantError: It is none.
        TooLargeError: It is too large.
    """
    body = await request.body()
    if len(body) > MOST_JSON_BYTES:
        raise TooLargeError
    try:
        found = json.loads(body, object_pairs_hook=_once, parse_constant=_no_number, parse_float=_number)
    except (ValueError, RecursionError) as error:
        raise NotMeantError(f"the body is not JSON: {str(error)[:200]}", "Send an object in UTF-8.") from None
    if not isinstance(found, dict):
        raise NotMeantError("the body is not an object", "Send an object.")
    return found


def checked(model: type[M], found: dict[str, Any]) -> M:
    """Return an object as the model that checks it.

    Raises:
        NotMeantError: It is not of this form.
    """
    try:
        return model.model_validate(found)
    except ValidationError as error:
        takes = ", ".join(model.model_fields)
        raise NotMeantError(first_problem(error), f"It takes {takes}.") from None
