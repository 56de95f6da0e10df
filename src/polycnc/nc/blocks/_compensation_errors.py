"""Why a path with radius compensation is refused: what is wrong, and what to do."""

from __future__ import annotations

from polycnc.errors import ProgramError

_CANCEL_FIRST = "Cancel with G40 and a straight move first."
_REFUSALS = {
    "radius": ("the tool radius is not a finite number", "Check the tool table."),
    "plane_change": ("the plane changes while radius compensation is active", _CANCEL_FIRST),
    "side_change": ("radius compensation changes sides while active", _CANCEL_FIRST),
    "radius_change": ("the tool radius changes while radius compensation is active", _CANCEL_FIRST),
    "no_lead_out": ("radius compensation starts again before its lead-out", _CANCEL_FIRST),
    "lead_in_arc": (
        "radius compensation starts with an arc",
        "Make the first plane move after G41 or G42 a straight one.",
    ),
    "lead_in_bend": (
        "the arc that radius compensation starts with has no place for the tool",
        "Make it larger, or start with a straight move.",
    ),
    "lead_in_short": (
        "the move that radius compensation starts with is not longer than the tool radius {tool:.6g} mm",
        "Start from farther off.",
    ),
    "lead_out_arc": (
        "radius compensation ends with an arc",
        "Make the first plane move after G40 a straight one.",
    ),
    "arc_too_small": (
        "the arc radius {arc:.6g} mm is smaller than the tool radius {tool:.6g} mm",
        "Use a smaller tool, or a larger arc.",
    ),
    "no_intersection": (
        "a tool of radius {tool:.6g} mm does not fit into this inside corner",
        "The offset paths do not meet: use a smaller tool, or round the corner.",
    ),
    "interference": (
        "the compensated move would run backwards: the tool is too large for this part of the contour",
        "Use a smaller tool, or leave out moves that are shorter than the tool needs at inside corners.",
    ),
    "spline": ("a spline with radius compensation", _CANCEL_FIRST),
    "stopped_inside": (
        "preparation stopped at an inside corner, so the tool has already cut into the next move",
        "Move the word that stops preparation away from this corner.",
    ),
}


class CompensationError(ProgramError):
    """A path that a tool of this radius cannot follow, or a compensation word out of place.

    `reason` is a stable key a dialect can map to its own alarm number; `line` is the number of the program
    line. The interpreter turns the line into `position`.
    """

    def __init__(self, what: str, *, reason: str, line: int, hint: str = "") -> None:
        super().__init__(what, hint=hint)
        self.reason = reason
        self.line = line


def refusal(reason: str, line: int, **values: float) -> CompensationError:
    """Return the error of a path on a line."""
    what, hint = _REFUSALS[reason]
    return CompensationError(what.format(**values), reason=reason, line=line, hint=hint)
