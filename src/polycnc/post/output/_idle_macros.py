"""Macros of a control file that never write anything, although somebody has written them."""

from __future__ import annotations

from collections.abc import Iterator

from polycnc.post.macros._control_file import ControlFile
from polycnc.post.tool_path._cl_words import IGNORED


def idle_macros(control: ControlFile, arcs: int) -> Iterator[str]:
    """Yield what to remark of macros that are never called; `arcs` is how many arcs the tool path has."""
    for word in sorted(IGNORED):
        if control.has(f"WORD_{word}"):
            yield f"the macro WORD_{word} is never called: {word} says nothing to a control, and is left out"
    there, missing = ("ARC_CW", "ARC_CCW") if control.has("ARC_CW") else ("ARC_CCW", "ARC_CW")
    if arcs and control.parameters.arcs == "arcs" and control.has(there) and not control.has(missing):
        yield f"the macro {there} is never called: without {missing} all arcs become lines"
