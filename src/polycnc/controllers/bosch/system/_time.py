"""CLOCK, DATE and TIME: the control's own time (Manual 003, 4.12)."""

from __future__ import annotations

from polycnc.machine import Clock

_LARGEST = 2**31


def clock_ms(clock: Clock) -> int:
    """Return the time since the control was switched on, in ms; it begins anew after 2**31 (24.8 days)."""
    return round(clock.now_s * 1000) % _LARGEST


def date_text(clock: Clock) -> str:
    """Return the date as DD.MM., with a point at its end."""
    return f"{clock.now:%d.%m.}"


def time_text(clock: Clock) -> str:
    """Return the time of day as HH.MM.SS."""
    return f"{clock.now:%H.%M.%S}"
