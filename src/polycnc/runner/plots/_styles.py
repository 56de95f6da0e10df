"""How tools look in pictures: colours that people tell apart without red and green, then lines of other kinds."""

from __future__ import annotations

from typing import Any

TOOL_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#a8488a", "#8a6d00", "#3a3f45", "#4fa3d9")
"""After Okabe and Ito; the same ones as in a view."""

_DASHES: tuple[Any, ...] = ("solid", (0, (6, 1.5)), (0, (1.5, 1)), (0, (6, 1.5, 1.5, 1.5)))
RAPID = "#8a949d"
END = "#1b2228"


def tool_colour(place: int) -> str:
    """Return the colour of the tool at a place among the tools of a run."""
    return TOOL_COLOURS[place % len(TOOL_COLOURS)]


def tool_line(place: int) -> dict[str, Any]:
    """Return colour and kind of the line of a tool for matplotlib."""
    return {"color": tool_colour(place), "linestyle": _DASHES[place // len(TOOL_COLOURS) % len(_DASHES)]}
