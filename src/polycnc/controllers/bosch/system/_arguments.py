"""Arguments of system functions: whole numbers within their ranges."""

from __future__ import annotations

from collections.abc import Container

from polycnc.nc.cpl import OMITTED, Fault

INVALID_PARAMETER = "INVALID PARAMETER"


def whole(value: object, what: str, allowed: Container[int], default: int | None = None) -> int:
    """Return a whole number within its range, `default` for one left out.

    Raises:
        Fault: It is none, outside, or left out without a default.
    """
    if value is OMITTED and default is not None:
        value = default
    if isinstance(value, int | float) and not isinstance(value, bool) and float(value).is_integer():
        if int(value) in allowed:
            return int(value)
        shown = (
            f", it has to be in {allowed.start} to {allowed[-1]}"
            if isinstance(allowed, range) and allowed
            else ""
        )
        raise Fault(INVALID_PARAMETER, f"the {what} is {int(value)}{shown}")
    raise Fault(INVALID_PARAMETER, f"the {what} has to be a whole number")
