"""Read tool paths in APT words (ISO 4343), as CAM systems write them: line by line, whatever their length.

A point is read on a short way of its own; every other statement goes through `Statement` and the table of
`_cl_words`. Statements that are not known become words, unless they would move the tool: those are errors.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError
from polycnc.post.tool_path._cl_reading import ArcAxis, Reading
from polycnc.post.tool_path._cl_statement import Piece, Statement
from polycnc.post.tool_path._cl_words import CLSF_WORDS, HANDLERS, HINTS, IGNORED, LEFT_OUT_MOTION, TEXTS
from polycnc.post.tool_path._records import (
    LARGEST_MM,
    Circle,
    Delta,
    End,
    Goto,
    Home,
    Points,
    Record,
    Retract,
    Word,
)
from polycnc.post.tool_path._source import Remarks, Source, decoded

_MOVES = frozenset(
    ("GOTO", "GODLTA", "GOHOME", "RETRCT", "CIRCLE", "MOVARC", "INDIRV", "TLON,GOFWD", "CYCLE", "RAPID")
)
_CATIA_FRAME = re.compile(r"\$\$\s*\*CATIA\d", re.IGNORECASE)
_MATRIX = 12
_CONTROL_CYCLE = re.compile(r"CYCLE\d+")
_CREO = re.compile(r"(->\s*)(?=(CUTTER|CSYS)\b)", re.IGNORECASE)


_NUMBER = rb"[ \t]*[-+]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)[ \t]*"
_POINTS = re.compile(rb"(?:GOTO/" + rb",".join([_NUMBER] * 3) + rb"\n){8,}+")
"""So many lines with plain points that it is worth while to take them together."""


def read_cl(source: Source, remarks: Remarks, arc_axis: ArcAxis = "auto") -> Iterator[Record | Points]:
    """Yield the records of an APT tool path, many plain points together; what is left out goes to `remarks`.

    `arc_axis` says what the axes of arcs are for; "auto" by the kind of file.

    Raises:
        ProgramError: a statement without its numbers, an arc without an end point, an unknown motion, or no tool
            path at all.
    """
    reading = Reading(remarks, arc_axis)
    pieces: list[Piece] = []
    end: End | None = None
    for number, raw in _lines(source, reading, pieces):
        if isinstance(raw, Points):
            if end is not None:
                raise _behind_the_end(source, number)
            yield from reading.release()
            yield raw
            continue
        if not pieces and not reading.waits and (rest := _behind_goto(raw)):
            point = _point(reading, number, rest)
            if point is not None:
                if end is not None:
                    raise _behind_the_end(source, number)
                if reading.held:
                    yield from reading.hold((point,))
                else:
                    yield point
                continue
        text = decoded(raw)
        part = _statement_of(text).rstrip()
        continued = part.endswith("$")
        if not part.strip():
            yield from _frame_in_remarks(reading, number, text)
        if part.strip() or pieces:
            pieces.append(Piece(number, text, part[:-1] if continued else part))
        if pieces and not continued:
            whole = pieces.copy()
            pieces.clear()
            if end is not None and whole[0].part.strip().upper() == "FINI":
                break
            for record in reading.hold(_statement(source, reading, whole)):
                if record.__class__ is End:
                    _check_recognised(source, reading)
                    end = End(record.line)
                elif end is None:
                    yield record
                elif isinstance(record, Goto | Circle | Delta | Home | Retract):
                    raise _behind_the_end(source, number)
            if end is not None and whole[0].part.strip().upper() == "FINI":
                break
    if pieces and end is None:
        yield from reading.hold(_statement(source, reading, pieces))
    if reading.circle is not None:
        raise reading.circle.statement.fail("an arc without an end point", "Write a GOTO after it.")
    _check_recognised(source, reading)
    yield from reading.release()
    if end is not None:
        yield end


def _behind_the_end(source: Source, line: int) -> ProgramError:
    return ProgramError(
        "a move after END, which ends the program",
        position=source.position(line),
        hint="Take END out, or make a separate tool path of what follows it.",
    )


def _lines(source: Source, reading: Reading, pieces: list[Piece]) -> Iterator[tuple[int, bytes | Points]]:
    """Yield the lines with their numbers, and many points at once where nothing before waits for the next one.

    `pieces` is the statement that is not complete yet.
    """
    number = 1
    for text in source.pieces():
        at = look_from = 0
        while at < len(text):
            waits = pieces or reading.waits or reading.circle is not None
            if at >= look_from and not waits and (found := _POINTS.match(text, at)) is not None:
                points = reading.points(number, _numbers(found[0]))
                if points is not None:
                    yield number, points
                    number += len(points.xyz)
                    at = found.end()
                    continue
                look_from = found.end()
            end = text.find(b"\n", at) + 1 or len(text)
            yield number, text[at:end]
            number += 1
            at = end


def _numbers(text: bytes) -> npt.NDArray[np.float64]:
    """Return the numbers of lines with points, [points, 3]."""
    numbers = text.replace(b"GOTO/", b"").replace(b"\n", b",").split(b",")
    numbers.pop()
    return np.array(list(map(float, numbers))).reshape(-1, 3)


def _check_recognised(source: Source, reading: Reading) -> None:
    """Refuse what is no tool path: nothing in it is known, or nothing moves and most is unknown."""
    if reading.moves or (reading.known and reading.unknown <= reading.known):
        return
    raise ProgramError(
        "this is no tool path: "
        + ("hardly anything" if reading.known else "nothing")
        + " in it is an APT word",
        position=source.position(1),
        hint="Give CL data (APT, CLSF) as the CAM system writes it, not a program for a control.",
    )


def _statement_of(text: str) -> str:
    """Return a line without its remark; in `$$->` Creo writes statements, of which the size of the tool is one."""
    before, mark, remark = text.partition("$$")
    if mark and not before.strip() and (found := _CREO.match(remark)):
        return remark[found.end(1) :]
    return before


def _frame_in_remarks(reading: Reading, line: int, text: str) -> Iterator[Record]:
    """Read the coordinate system that CATIA writes in remarks: `$$*CATIA0`, then three rows of four numbers."""
    text = text.strip()
    if _CATIA_FRAME.match(text):
        reading.matrix = []
    elif reading.matrix is not None and text.startswith("$$"):
        try:
            reading.matrix += map(float, text[2:].split())
        except ValueError:
            return  # the name of the program stands before the numbers
        if len(reading.matrix) >= _MATRIX:
            numbers, reading.matrix = tuple(reading.matrix[:_MATRIX]), None
            yield from reading.take_frame(line, numbers)


def _behind_goto(raw: bytes) -> bytes:
    """Return what stands after GOTO/, nothing if the line is another statement."""
    if raw.startswith(b"GOTO/"):
        return raw[5:]
    head, _, rest = raw.partition(b"/")
    return rest if head.strip() == b"GOTO" else b""


def _point(reading: Reading, line: int, rest: bytes) -> Goto | Circle | None:
    """Return the move of a plain GOTO; None if the line must be read the long way, for its errors too."""
    numbers = rest.split(b",")
    largest = LARGEST_MM / reading.scale
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
    if not (abs(x) <= largest and abs(y) <= largest and abs(z) <= largest) or b"_" in rest:
        return None
    return reading.point(line, x, y, z, axis)


def _statement(source: Source, reading: Reading, pieces: list[Piece]) -> Iterator[Record]:
    text = TEXTS.match(pieces[0].part)
    statement = Statement(source.name, pieces)
    major = text[1].upper() if text is not None else statement.major
    handler = HANDLERS.get(major)
    if reading.resumes and major != "CUTCOM":
        yield reading.resume(statement)
    if reading.announced is not None and (major in _MOVES or (major == "SPINDL" and reading.is_lathe)):
        yield from reading.load(statement.line)
    if major in CLSF_WORDS and not reading.clsf_word:
        if reading.right_handed and reading.arc_axis == "auto":
            raise statement.fail(
                f"{major} is of a file with clockwise axes, but the arc on line {reading.right_handed} was read by the "
                "right-hand rule",
                "Say with --arc-axis which way the axes of CIRCLE/ are meant: clockwise as NX writes them, or "
                "counterclockwise.",
            )
        reading.clsf_word = major
    if handler is not None:
        reading.known += 1
        yield from handler(reading, statement)
    elif major in LEFT_OUT_MOTION or _CONTROL_CYCLE.fullmatch(major):
        raise statement.fail(
            f"{major} moves the tool or its coordinates in a way that is not known here",
            HINTS.get(major, "Let the CAM system write points (GOTO) and arcs (CIRCLE, MOVARC) instead."),
        )
    elif major in IGNORED:
        reading.known += 1
    else:
        reading.unknown += 1
        yield _word(statement, major)


def _word(statement: Statement, major: str) -> Word:
    """Return a statement that is not known as it stands."""
    tokens = list(statement)
    first = next((token.text for token in tokens if token.number is None), "")
    numbers = tuple(value for token in tokens if (value := token.number) is not None)
    return Word(statement.line, major, first, numbers, statement.rest.strip())
