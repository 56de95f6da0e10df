"""What texts of tool paths are read as."""

from __future__ import annotations

from polycnc.post import ArcAxis, parse_tool_path
from polycnc.post.tool_path._records import Circle, Record


def records(text: str, arc_axis: ArcAxis = "auto") -> list[Record]:
    """Return the records of a text."""
    return list(parse_tool_path(text, "part.cl", arc_axis))


def senses(text: str, arc_axis: ArcAxis = "auto") -> list[float]:
    """Return the Z of the right-hand axis of each arc."""
    return [record.normal[2] for record in records(text, arc_axis) if isinstance(record, Circle)]
