"""APT words that move: points, distances, circles in the three forms that CAM systems write."""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.post.tool_path._arcs import across, cross, dot
from polycnc.post.tool_path._cl_reading import PendingCircle, Reading
from polycnc.post.tool_path._cl_statement import Statement
from polycnc.post.tool_path._records import UPRIGHT, Delta, From, Home, Rapid, Record, Vector

_LARGEST_MM = 1e9


def _unit(statement: Statement, vector: Vector) -> Vector:
    length = math.hypot(*vector)
    if length <= 0.0:
        raise statement.fail("a direction without a length", "Give a vector that is not 0, 0, 0.")
    return vector[0] / length, vector[1] / length, vector[2] / length


def rapid(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read RAPID."""
    yield Rapid(statement.line)


def _position(reading: Reading, statement: Statement) -> tuple[Vector, Vector | None]:
    numbers = statement.numbers()
    if len(numbers) not in (3, 6) or statement.peek() is not None:
        raise statement.fail(
            f"{statement.major} needs 3 numbers, or 6 with a tool axis, and has {len(numbers)}"
            + (f" and '{token.text}'" if (token := statement.peek()) else ""),
            f"Write it like {statement.major}/10,20,5.",
            statement.peek(),
        )
    if not all(abs(number) < _LARGEST_MM for number in numbers[:3]):
        raise statement.fail("a position further than any machine", "Check the numbers.")
    axis = _unit(statement, (numbers[3], numbers[4], numbers[5])) if len(numbers) == 6 else None
    return (numbers[0], numbers[1], numbers[2]), axis


def goto(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read GOTO."""
    (x, y, z), axis = _position(reading, statement)
    yield reading.point(statement.line, x, y, z, axis)


def start_from(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read FROM."""
    (x, y, z), axis = _position(reading, statement)
    reading.position = (x * reading.scale, y * reading.scale, z * reading.scale)
    yield From(statement.line, *reading.position, axis)


def delta(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read GODLTA."""
    numbers = [number * reading.scale for number in statement.numbers()]
    if len(numbers) == 1:
        yield Delta(statement.line, numbers[0], 0.0, 0.0, along_axis=True)
        reading.position = None
        return
    if len(numbers) != 3:
        raise statement.fail(
            f"GODLTA needs 1 or 3 numbers and has {len(numbers)}", "Write it like GODLTA/0,0,5."
        )
    x, y, z = numbers
    if reading.position is not None:
        reading.position = (reading.position[0] + x, reading.position[1] + y, reading.position[2] + z)
    yield Delta(statement.line, x, y, z)


def home(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read GOHOME."""
    reading.position = None
    yield Home(statement.line)


def circle(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read CIRCLE or MOVARC; the arc comes with the point behind it."""
    numbers = statement.numbers()
    if len(numbers) not in (4, 6) and len(numbers) < 7:
        raise statement.fail(
            f"{statement.major} needs a centre, an axis and a radius, and has {len(numbers)} numbers",
            "Write it like CIRCLE/10,20,0,0,0,1,5.",
        )
    x, y, z = (number * reading.scale for number in numbers[:3])
    normal = (numbers[3], numbers[4], numbers[5]) if len(numbers) >= 6 else UPRIGHT
    turns = statement.value_of("TIMES", "a number of turns") or 1.0
    angle = statement.value_of("ANGLE", "an angle")
    reading.circle = PendingCircle(
        statement, (x, y, z), _unit(statement, normal), angle, max(1, round(turns))
    )
    return iter(())


def direction(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read INDIRV."""
    numbers = statement.numbers()
    if len(numbers) != 3:
        raise statement.fail("INDIRV needs 3 numbers", "Write it like INDIRV/0,1,0.")
    reading.direction = (numbers[0], numbers[1], numbers[2])
    return iter(())


def follow_circle(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read TLON,GOFWD/(CIRCLE/...),ON,(LINE/...): the arc begins in the direction of INDIRV."""
    found: dict[str, list[float]] = {}
    for token in statement:
        if token.text in ("CIRCLE", "LINE"):
            found[token.text] = [number * reading.scale for number in statement.numbers()]
        elif token.number is None and token.text not in ("ON", "INTOF"):
            raise statement.fail(
                f"'{token.text}' in a move along a circle", "Only (CIRCLE/...),ON,(LINE/...) is known.", token
            )
    circle, line = found.get("CIRCLE", []), found.get("LINE", [])
    if len(circle) not in (4, 7) or len(line) not in (4, 6) or reading.direction is None:
        raise statement.fail(
            "a move along a circle without its circle, its end or its direction",
            "Write INDIRV/..., then TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z).",
        )
    center = (circle[0], circle[1], circle[2])
    normal = UPRIGHT
    if len(circle) == 7:
        s = reading.scale
        normal = _unit(statement, (circle[3] / s, circle[4] / s, circle[5] / s))
    half = len(line) // 2
    end = (line[half], line[half + 1], line[half + 2] if half == 3 else center[2])
    if reading.position is None:
        raise statement.fail("an arc without a start point", "Write a GOTO or FROM before it.")
    if dot(cross(across(reading.position, center, normal), reading.direction), normal) < 0.0:
        normal = (-normal[0], -normal[1], -normal[2])
    yield reading.arc(PendingCircle(statement, center, normal), end)
