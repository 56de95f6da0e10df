"""Read tool paths in APT words (ISO 4343), as CAM systems write them: line by line, whatever their length.

A point is read on a short way of its own; every other statement goes through `Statement` and the table of
`_cl_words`. Statements that are not known are remarked, unless they would move the tool: those are errors.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.post.tool_path._cl_reading import Reading
from polycnc.post.tool_path._cl_statement import Piece, Statement
from polycnc.post.tool_path._cl_words import HANDLERS, IGNORED, LEFT_OUT_MOTION, TEXTS
from polycnc.post.tool_path._records import Circle, Goto, Record
from polycnc.post.tool_path._source import Remarks, Source, decoded


def read_cl(source: Source, remarks: Remarks) -> Iterator[Record]:
    """Yield the records of an APT tool path; what is left out goes to `remarks`.

    Raises:
        ProgramError: a statement without its numbers, an arc without an end point, an unknown motion.
    """
    reading = Reading(remarks)
    pieces: list[Piece] = []
    for number, raw in enumerate(source.lines(), 1):
        if not pieces and (rest := _behind_goto(raw)):
            point = _point(reading, number, rest)
            if point is not None:
                yield point
                continue
        text = decoded(raw)
        part = text.partition("$$")[0].rstrip()
        continued = part.endswith("$")
        if part.strip() or pieces:
            pieces.append(Piece(number, text, part[:-1] if continued else part))
        if pieces and not continued:
            yield from _statement(source, reading, pieces)
            pieces = []
    if pieces:
        yield from _statement(source, reading, pieces)
    if reading.circle is not None:
        raise reading.circle.statement.fail("an arc without an end point", "Write a GOTO behind it.")


def _behind_goto(raw: bytes) -> bytes:
    """Return what stands behind GOTO/, nothing if the line is another statement."""
    if raw.startswith(b"GOTO/"):
        return raw[5:]
    head, _, rest = raw.partition(b"/")
    return rest if head.strip() == b"GOTO" else b""


def _point(reading: Reading, line: int, rest: bytes) -> Goto | Circle | None:
    """Return the move of a plain GOTO; None if the line must be read the long way, for its errors too."""
    numbers = rest.split(b",")
    try:
        if len(numbers) == 3:
            x, y, z = map(float, numbers)
            axis = None
        else:
            x, y, z, i, j, k = map(float, numbers)
            length = math.hypot(i, j, k)
            axis = i / length, j / length, k / length
    except (ValueError, ZeroDivisionError):
        return None
    if not -1e9 < x + y + z < 1e9 or b"_" in rest:
        return None
    return reading.point(line, x, y, z, axis)


def _statement(source: Source, reading: Reading, pieces: list[Piece]) -> Iterator[Record]:
    text = TEXTS.match(pieces[0].part)
    statement = Statement(source.name, pieces)
    major = text[1].upper() if text is not None else statement.major
    handler = HANDLERS.get(major)
    if handler is not None:
        yield from handler(reading, statement)
    elif major in LEFT_OUT_MOTION:
        raise statement.fail(
            f"{major} moves the tool or its coordinates in a way that is not known here",
            "Let the CAM system write points (GOTO) and arcs (CIRCLE, MOVARC) instead.",
        )
    elif major not in IGNORED:
        reading.remarks.add(statement.line, f"{major} is not known and was left out")
