"""Read bodies: JSON without doubled fields and numbers that are none, bounded in depth."""

from __future__ import annotations

import json
from typing import Any

from starlette.requests import Request

from polycnc.cnc import ControlError, Refusal

MOST_JSON_BYTES = 1 << 20


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) != len(pairs):
        raise ValueError("a field is there twice")
    return made


def _no_number(text: str) -> float:
    raise ValueError(f"{text} is not a number")


async def json_object(request: Request) -> dict[str, Any]:
    """Return the object that a request brings.

    Raises:
        ControlError: It is none, or too large.
    """
    body = await request.body()
    if len(body) > MOST_JSON_BYTES:
        raise ControlError(
            Refusal.FULL, "the body is too large", hint=f"Send at most {MOST_JSON_BYTES} bytes."
        )
    try:
        found = json.loads(body, object_pairs_hook=_once, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        raise ControlError(
            Refusal.DATA, f"the body is not JSON: {str(error)[:200]}", hint="Send an object in UTF-8."
        ) from None
    if not isinstance(found, dict):
        raise ControlError(Refusal.DATA, "the body is not an object", hint="Send an object.")
    return found
