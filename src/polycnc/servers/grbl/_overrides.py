"""The real-time bytes of overrides, which step from where an override is."""

from __future__ import annotations

from polycnc.cnc import Overrides

_FEED = {0x90: None, 0x91: 10, 0x92: -10, 0x93: 1, 0x94: -1}
_RAPID = {0x95: 1.0, 0x96: 0.5, 0x97: 0.25}
_SPINDLE = {0x99: None, 0x9A: 10, 0x9B: -10, 0x9C: 1, 0x9D: -1}


def override_of(byte: int, now: Overrides) -> dict[str, float]:
    """Return the override that a byte sets and its value, nothing for another byte."""
    if byte in _FEED:
        return {"feed": _stepped(now.feed, _FEED[byte])}
    if byte in _RAPID:
        return {"rapid": _RAPID[byte]}
    return {"spindle": _stepped(now.spindle, _SPINDLE[byte])} if byte in _SPINDLE else {}


def _stepped(factor: float, step: int | None) -> float:
    """Return an override one step on, in percent, between 10 and 200; without a step 100 %."""
    return 1.0 if step is None else min(200, max(10, round(factor * 100) + step)) / 100
