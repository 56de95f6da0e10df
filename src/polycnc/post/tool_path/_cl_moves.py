"""APT words that move: points, distances, circles in the three forms that CAM systems write."""

from __future__ import annotations

import math
from collections.abc import Iterator

from polycnc.post.tool_path._arcs import across, cross, dot
from polycnc.post.tool_path._cl_reading import PendingCircle, Reading
from polycnc.post.tool_path._cl_statement import Statement
from polycnc.post.tool_path._records import (
    LARGEST_MM,
    MOST_TURNS,
    UPRIGHT,
    Axis,
    Delta,
    From,
    Home,
    Rapid,
    Record,
    Retract,
    Vector,
)

_MATRIX_NUMBERS = 12
_LEANING = 1e-6


def _near(reading: Reading, statement: Statement, *numbers: float) -> None:
    if not all(abs(number * reading.scale) <= LARGEST_MM for number in numbers):
        raise statement.fail("a position further than any machine", "Check the numbers.")


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
    _near(reading, statement, *numbers[:3])
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
    if not all(abs(number) <= LARGEST_MM for number in numbers):
        raise statement.fail("a distance further than any machine", "Check the numbers.")
    if len(numbers) in (1, 3):
        reading.moves += 1
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
    """Read GOHOME, with its point or without."""
    reading.moves += 1
    if statement.peek() is None:
        reading.position = None
        yield Home(statement.line)
        return
    (x, y, z), axis = _position(reading, statement)
    if axis is not None:
        yield Axis(statement.line, axis)
    reading.position = (x * reading.scale, y * reading.scale, z * reading.scale)
    yield Home(statement.line, reading.position)


def tool_axis(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read TLAXIS: the tool axis of the points that follow."""
    numbers = statement.numbers()
    if len(numbers) != 3 or statement.peek() is not None:
        raise statement.fail(
            "TLAXIS with something else than a direction",
            "Write three numbers, like TLAXIS/0,0,1, or let the CAM system write the axis with each GOTO.",
            statement.peek(),
        )
    axis = _unit(statement, (numbers[0], numbers[1], numbers[2]))
    reading.is_tilted, reading.axis_unsure = axis != UPRIGHT, None
    yield Axis(statement.line, axis)


def clearance_plane(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read CLEARP: the level to which RETRCT goes."""
    reading.clearance_z = _level(reading, statement)
    return iter(())


def retract(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read RETRCT: up to the clearance plane."""
    if statement.peek() is not None:
        z = _level(reading, statement)
    elif reading.clearance_z is None:
        raise statement.fail(
            "RETRCT without a clearance plane",
            "Write CLEARP/XYPLAN,z before it, or a RAPID and GOTO instead.",
        )
    else:
        z = reading.clearance_z
    reading.moves += 1
    if reading.position is not None:
        x, y, height = reading.position
        reading.position = (x, y, max(height, z))
    yield Retract(statement.line, z)


def _level(reading: Reading, statement: Statement) -> float:
    """Return the height of a plane: XYPLAN,z, or a, b, c, d of a plane across Z."""
    first = statement.peek()
    if first is not None and first.text == "XYPLAN":
        next(iter(statement))
    numbers = statement.numbers()
    flat = len(numbers) == 4 and numbers[:2] == [0.0, 0.0] and numbers[2] == 1.0
    if statement.peek() is not None or not (flat or (len(numbers) == 1 and first and first.text == "XYPLAN")):
        raise statement.fail(
            f"{statement.major} with something else than a height",
            f"Write {statement.major}/XYPLAN,z; other planes need a RAPID and GOTO.",
            first,
        )
    _near(reading, statement, numbers[-1])
    return numbers[-1] * reading.scale


def coordinate_system(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read MSYS or CSYS: the first one is that of the program, another one is another work offset."""
    if numbers := tuple(statement.numbers()):
        if reading.in_world:
            check_upright(statement, numbers)
            if any(numbers[3::4]):
                reading.remarks.add(
                    statement.line,
                    "the points count from the world, so its zero is that of the program, not CSYS",
                )
        yield from reading.take_frame(statement.line, numbers)


def check_upright(statement: Statement, numbers: tuple[float, ...]) -> None:
    """Refuse a coordinate system that leans, where points count from the world: its tool is not upright there.

    The numbers are three rows of a direction matrix, each with a coordinate of the origin after it.

    Raises:
        ProgramError: it leans, or the numbers are not that matrix.
    """
    z_axis = numbers[2:11:4]
    if len(numbers) != _MATRIX_NUMBERS or math.dist(z_axis, UPRIGHT) > _LEANING:
        raise statement.fail(
            "a coordinate system that leans against the world, from which the points count",
            "Let the CAM system write a tool path of its own for each set-up, in that set-up's coordinates.",
        )


def circle(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read CIRCLE or MOVARC; the arc comes with the point after it.

    The axis is by the right-hand rule, in a CLSF of NX it is for a clockwise direction. The numbers stand by place, or
    after CENTER, AXIS and RADIUS.
    """
    numbers = statement.numbers()
    if not numbers and (first := statement.peek()) is not None and first.text == "CENTER":
        for word in ("CENTER", "AXIS", "RADIUS"):
            if (token := statement.peek()) is not None and token.text == word:
                next(iter(statement))
                numbers += statement.numbers()
    if len(numbers) not in (4, 6) and len(numbers) < 7:
        raise statement.fail(
            f"{statement.major} needs a centre, an axis and a radius, and has {len(numbers)} numbers",
            "Write it like CIRCLE/10,20,0,0,0,1,5.",
        )
    x, y, z = (number * reading.scale for number in numbers[:3])
    if not all(abs(number * reading.scale) <= LARGEST_MM for number in (*numbers[:3], *numbers[6:7])):
        raise statement.fail(
            "a circle further away or larger than any machine", "Check its centre and radius."
        )
    normal = (numbers[3], numbers[4], numbers[5]) if len(numbers) >= 6 else UPRIGHT
    turns = statement.value_of("TIMES", "a number of turns") or 1.0
    angle = statement.value_of("ANGLE", "an angle")
    if not (abs(turns) <= MOST_TURNS and abs(angle or 0.0) <= 360.0 * MOST_TURNS):
        raise statement.fail("an arc of too many turns", f"Write at most {MOST_TURNS} turns in one arc.")
    normal = _unit(statement, normal)
    if reading.turns_clockwise(statement):
        normal = (-normal[0], -normal[1], -normal[2])
    reading.circle = PendingCircle(statement, (x, y, z), normal, angle, max(1, round(turns)))
    return iter(())


def direction(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read INDIRV."""
    numbers = statement.numbers()
    if len(numbers) != 3:
        raise statement.fail("INDIRV needs 3 numbers", "Write it like INDIRV/0,1,0.")
    reading.direction = (numbers[0], numbers[1], numbers[2])
    return iter(())


def follow_circle(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read TLON,GOFWD/(CIRCLE/...),ON,(LINE/...): the arc begins in the direction of INDIRV.

    In space CATIA writes (CYLNDR/centre, axis, radius),ON,(PLANE/...,(POINT/centre),(POINT/end)).
    """
    found: dict[str, list[float]] = {}
    for token in statement:
        if token.text in ("CIRCLE", "CYLNDR", "LINE", "POINT", "VECTOR"):
            found[token.text] = [number * reading.scale for number in statement.numbers()]
        elif token.number is None and token.text not in ("ON", "INTOF", "PLANE", "PERPTO"):
            raise statement.fail(
                f"'{token.text}' in a move along a circle",
                "Only (CIRCLE/...),ON,(LINE/...) and (CYLNDR/...),ON,(PLANE/...) are known.",
                token,
            )
    circle, line = found.get("CIRCLE", []), found.get("LINE", [])
    if "CYLNDR" in found and "CIRCLE" not in found:  # the last point is the end
        circle, line = found["CYLNDR"], found.get("CYLNDR", [])[:3] + found.get("POINT", [])
    if len(circle) not in (4, 7) or len(line) not in (4, 6) or reading.direction is None:
        raise statement.fail(
            "a move along a circle without its circle, its end or its direction",
            "Write INDIRV/..., then TLON,GOFWD/(CIRCLE/x,y,z,r),ON,(LINE/x,y,z,x,y,z).",
        )
    if not all(abs(number) <= LARGEST_MM for number in (*circle[:3], circle[-1], *line)):
        raise statement.fail("a circle further away or larger than any machine", "Check its numbers.")
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
