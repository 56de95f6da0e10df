"""What each APT word says: one function for each, and the table that leads to them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Literal

from polycnc.post.tool_path import _cl_moves
from polycnc.post.tool_path._cl_cycles import read_cycle
from polycnc.post.tool_path._cl_reading import Handler, Reading
from polycnc.post.tool_path._cl_statement import Statement
from polycnc.post.tool_path._records import (
    Compensation,
    Coolant,
    CycleOff,
    Dwell,
    End,
    Feed,
    Path,
    Rapid,
    Record,
    Spindle,
    Stop,
    Text,
    Thread,
    Tool,
    ToolShape,
    WorkOffset,
)
from polycnc.units import MM_PER_INCH

TEXTS = re.compile(r"\s*(PARTNO|PPRINT|INSERT|REMARK|TPRINT)\b\s*/?\s?(.*)", re.IGNORECASE)
"""Statements whose text is taken as it stands, with or without a slash."""

_NOTE = re.compile(r"\[|[A-Z][a-z]+\b(?!\s*[(=\[])")
"""How the text of an INSERT begins that is no block of a control: CAM systems write notes as INSERT, too."""

_PROSE = re.compile(
    r"\d+(?:\.\d+)?[A-Za-z]{2,}\b|(?!(?:CALL|DIM|FOR|GOTO|GOSUB|IF|PRN|REPEAT|WAIT|WHILE)\b)"
    r"[A-Za-z]{3,}(?:\s+[A-Za-z]{2,})+\s*$"
)
"""How an INSERT begins, or what it is as a whole, that no control reads as a block: a size, or words alone."""

IGNORED = frozenset(
    (
        *(
            "REMARK",
            "PAINT",
            "DISPLY",
            "SELECT",
            "HEADER",
            "INTOL",
            "OUTTOL",
            "TOLER",
            "CUT",
            "CLPRNT",
        ),
        *("CSI_SET_FLUTE_LENGTH", "CSI_SET_EXTENSION_LENGTH", "CSI_TOOL_PATH"),
        *("NOPOST", "PLABEL", "LEADER", "REWIND", "CATPROCESS", "AUTOPS", "TLONPS", "TLOFPS", "PSIS"),
    )
)
"""Words that say nothing to a control."""

LEFT_OUT_MOTION = frozenset(
    (
        *("ARC", "GO", "GOLFT", "GORGT", "GOFWD", "GOBACK", "GOUP", "GODOWN", "INDEX", "ROTABL"),
        *("ROTATE", "ROTHED", "TRACUT", "COPY", "TRANS", "ORIGIN", "DNTCUT", "SPLINE", "NURBS", "GOCLER"),
        *(
            "SAFPOS",
            "HOMEPT",
            "LCS",
            "CALSUB",
            "OFSTNO",
            "OFSETL",
            "PIVOTZ",
            "POCKET",
            "SCURV",
            "MATRIX",
        ),
        *("MIRROR", "SCALE", "REFSYS", "CALL", "CALLSUB", "LOOPST", "JUMPTO", "TLCOMP"),
        *("LATHE", "LOCAL_ORIGIN", "PROFIL", "SCRUB", "CONTUR", "AREA", "FMILL", "AMILL", "RMILL", "SMILL"),
    )
)
"""Words that move the tool or its coordinates and are not known: leaving them out would cut another part."""

_OFFSETS = "Write a length offset with the tool, like LOADTL/3,ADJUST,13, and a work offset as CUTCOM/ADJUST,2 (G55)."
_PASSES = "Let the CAM system write each pass as points (GOTO, RAPID), not a cycle of the control."
_TURNED = (
    "Let the CAM system write points with the tool axis on the part (MULTAX, GOTO/x,y,z,i,j,k), and take a control "
    "file with rotary or five_axis: it turns the table."
)

HINTS = {
    "ROTABL": _TURNED,
    "ROTHED": _TURNED,
    "ROTATE": _TURNED,
    "NURBS": "In NX set 'Motion Output' of the operation to 'Line' or to 'Circular'.",
    "SPLINE": "Let the CAM system write points (GOTO) and arcs (CIRCLE, MOVARC) instead.",
    "SAFPOS": "Write the way to the safe position as RAPID and GOTO.",
    "HOMEPT": "Write FROM/x,y,z, or give the point with GOHOME/x,y,z.",
    "OFSTNO": _OFFSETS,
    "OFSETL": _OFFSETS,
    "LATHE": _PASSES,
    "PROFIL": _PASSES,
    "CONTUR": _PASSES,
    "AREA": _PASSES,
    "LOCAL_ORIGIN": "Let the CAM system write all operations in one coordinate system.",
    "CALLSUB": "Let the CAM system write out what the sub-program does.",
    "CALL": "Let the CAM system write out what the macro does.",
    "TLCOMP": "Write CUTCOM/LEFT, CUTCOM/RIGHT or CUTCOM/OFF.",
    "CALSUB": "Let the CAM system write out what the sub-program does.",
}
"""What to do instead, where it is something else than points and arcs."""

CLSF_WORDS = frozenset(("TOOLPATH", "TLDATA", "MSYS", "PAINT", "END-OF-PATH", "MCS", "CSI_TOOL_PATH"))
"""Words of files whose axes of arcs are for a clockwise direction: the CLSF of NX, and APT for CAMplete (MCS, CSI_)."""

_HIGHEST_SPEED = 1e6
_PLANES = {"ZXPLAN": 18, "XZPLAN": 18, "YZPLAN": 19}
_FIRST_G_CODE = 54  # from here on a number may be meant as a G code

_FEED_UNITS = {
    "MMPM": (1.0, False),
    "MMPR": (1.0, True),
    "IPM": (MM_PER_INCH, False),
    "IPR": (MM_PER_INCH, True),
    "FPM": (12.0 * MM_PER_INCH, False),
}


def _text(kind: Literal["part", "comment", "insert"]) -> Handler:
    def read(reading: Reading, statement: Statement) -> Iterator[Record]:
        found = TEXTS.match(statement.pieces[0].part)
        first = found[2] if found else ""
        text = "".join([first, *(piece.part for piece in statement.pieces[1:])])
        text = text.strip()
        if len(text) > 1 and text[0] == text[-1] and text[0] in "'\"" and kind != "insert":
            text = text[1:-1].strip()
        is_note = kind == "insert" and _NOTE.match(text) is not None
        if kind == "insert" and not is_note and _PROSE.match(text) is not None:
            is_note = True
            reading.remarks.add(statement.line, f"INSERT '{text[:40]}' is no block of a control: a comment")
        yield Text(statement.line, "comment" if is_note else kind, text)

    return read


def _tool_name(reading: Reading, statement: Statement) -> Iterator[Record]:
    found = TEXTS.match(statement.pieces[0].part)
    yield ToolShape(statement.line, name=(found[2] if found else "").split(",")[0].strip())


def _nothing(reading: Reading, statement: Statement) -> Iterator[Record]:
    return iter(())


_TOOL_KINDS = frozenset(
    ("MILL", "DRILL", "TAP", "REAM", "BORE", "TURN", "LATHE", "CBORE", "CSINK", "FACE", "TCUTTER")
)


def _machine(reading: Reading, statement: Statement) -> Iterator[Record]:
    yield Text(statement.line, "machine", statement.rest.split(",")[0].strip())


def _units(reading: Reading, statement: Statement) -> Iterator[Record]:
    words = statement.words()
    reading.units_said = True
    before = reading.scale
    if words & {"MM", "MILLIMETERS"}:
        reading.scale = 1.0
    elif words & {"INCH", "INCHES", "IN"}:
        reading.scale = MM_PER_INCH
    elif words & {"CM", "CENTIMETERS"}:
        reading.scale = 10.0
    else:
        raise statement.fail(f"{statement.major} without a unit", "Write UNITS/MM or UNITS/INCHES.")
    if reading.moves and reading.scale != before:
        raise statement.fail(
            "the unit changes after the first move",
            f"Write {statement.major} before all points, and one tool path for each unit.",
        )
    return iter(())


def _tool_path(reading: Reading, statement: Statement) -> Iterator[Record]:
    names = [name.strip() for name in statement.rest.split(",")]
    yield Path(statement.line, names[0])
    if len(names) > 2 and names[1].upper() == "TOOL":
        yield ToolShape(statement.line, name=names[2])


def _end_of_path(reading: Reading, statement: Statement) -> Iterator[Record]:
    yield Path(statement.line, None)


def _tool_data(reading: Reading, statement: Statement) -> Iterator[Record]:
    for token in statement:
        if token.number is None and token.text in ("MILL", "DRILL", "TCUTTER"):
            numbers = [n * reading.scale for n in statement.numbers()]
            if numbers:
                yield ToolShape(statement.line, None, numbers[0], numbers[2] if len(numbers) > 2 else None)
            return


def _cutter(reading: Reading, statement: Statement) -> Iterator[Record]:
    yield ToolShape(statement.line, diameter=statement.number("a diameter") * reading.scale)


def _tool(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read a tool change; the tool that is in the spindle with the same offsets is not changed again."""
    if (token := statement.peek()) is not None and token.text in ("TOOL", "TURRET"):
        next(iter(statement))
    elif token is not None and token.text == "ADJUST" and statement.major == "TOOLNO":
        next(iter(statement))
        register = statement.number("the number of an offset")
        reading.take_offset(statement, statement.whole(register, "the number of an offset") or 0)
        return
    number = statement.number("a tool number")
    if not number.is_integer() or number < 0:
        raise statement.fail(
            f"a tool number must be a whole number, not {number:g}", "Write it like LOADTL/3."
        )
    kind = statement.peek()
    if (
        statement.major == "TOOLNO"
        and kind is not None
        and (kind.text in _TOOL_KINDS or kind.number is not None)
    ):
        # CATIA describes the tool; LOADTL changes it, or nothing does before it moves.
        reading.announced = Tool(statement.line, int(number))
        reading.is_lathe = kind.text in ("TURN", "LATHE")
        return
    reading.announced = None
    change = _change(reading, statement, int(number))
    if reading.tool is None or change != reading.tool._replace(line=change.line):
        reading.tool = change
        reading.threads = False
        yield change
    elif reading.cycle_on:
        yield CycleOff(statement.line)
    reading.cycle_on = False


def _change(reading: Reading, statement: Statement, number: int) -> Tool:
    """Return the change to a tool, with the length and the offsets that stand after its number."""
    length = statement.value_of("LENGTH", "a length")
    more = statement.numbers()
    offset = statement.value_of("ADJUST", "an offset number")
    for word in ("OSETNO", "OFFSET"):
        if offset is None:
            offset = statement.value_of(word, "an offset number")
    radius = statement.value_of("CUTCOM", "an offset number")
    if len(more) == 3 and statement.peek() is None:  # of ISO 4343: pocket, length, number of the offset
        length = more[1] if length is None else length
        offset = more[2] if offset is None else offset
    return Tool(
        statement.line,
        number,
        None,
        None if length is None else length * reading.scale,
        statement.whole(offset, "the number of an offset"),
        statement.whole(radius, "the number of an offset"),
    )


def _set(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read SET/OFSETL,n: the register of the tool's length offset."""
    if (token := statement.peek()) is not None and token.text == "OFSETL":
        next(iter(statement))
        number = statement.whole(statement.number("the number of an offset"), "the number of an offset")
        strange = next((each for each in statement if each.text != "ON"), None)
        if strange is None and number is not None:
            reading.take_offset(statement, number)
            return iter(())
        token = strange
    raise statement.fail("SET with something else than OFSETL and the number of an offset", _OFFSETS, token)


def _spindle(reading: Reading, statement: Statement) -> Iterator[Record]:
    words = statement.words()
    if "ORIENT" in words:
        raise statement.fail(
            "SPINDL/ORIENT is not known", "Write the block of the control, like INSERT M19, or leave it out."
        )
    highest = statement.value_of("MAXRPM", "a highest speed") or 0.0
    speed = None
    for token in statement:
        if token.text in ("RANGE", "MAXRPM"):  # a number of theirs is no speed
            statement.numbers()
        elif speed is None and (speed := token.number) is not None and not 0.0 <= speed <= _HIGHEST_SPEED:
            raise statement.fail(
                f"a spindle speed of {speed:g}", "Give a speed from 0 up; CCLW turns it round.", token
            )
    sense: Literal["cw", "ccw", "off", "on"] = "on"
    if words & {"OFF", "LOCK", "NEUTRL"}:
        sense = "off"
    elif words & {"CCLW", "CCW"}:
        sense = "ccw"
    elif words & {"CLW", "CW"} or speed is not None:
        sense = "cw"
    surface = bool(words & {"SFM", "SMM"})
    if speed is not None and "SFM" in words:
        speed *= 12.0 * MM_PER_INCH / 1000.0
    yield Spindle(statement.line, sense, speed, surface, highest)


def _feed(reading: Reading, statement: Statement) -> Iterator[Record]:
    words = statement.words()
    reading.check_units(statement)
    if "RAPID" in words:
        yield Rapid(statement.line)
        return
    if "INVERS" in words:
        raise statement.fail("an inverse time feed", "Let the CAM system write feeds per minute.")
    value = statement.first_number()
    if value is None:
        raise statement.fail("FEDRAT needs a feed", "Write it like FEDRAT/250,MMPM.")
    if value <= 0.0:
        raise statement.fail(f"a feed of {value:g}", "Give a feed above 0.")
    unit = next((_FEED_UNITS[word] for word in words if word in _FEED_UNITS), None)
    scale, per_revolution = unit or (reading.scale, "PERREV" in words)
    yield Feed(statement.line, value * scale, per_revolution)


def _cycle(reading: Reading, statement: Statement) -> Iterator[Record]:
    words = statement.words()
    reading.cycle_on = True
    first = statement.peek()
    alone = first is not None and len(words) == 1
    if alone and first is not None and first.text in ("INIT", "CLEAR"):
        # SolidWorks CAM announces a cycle with INIT; CLEAR ends one that has had its points.
        if first.text == "CLEAR" and reading.moves > reading.cycle_began:
            yield CycleOff(statement.line)
    elif "OFF" in words or "NOMORE" in words:
        yield CycleOff(statement.line)
    elif alone and first is not None and first.text == "ON":
        yield CycleOff(statement.line, on=True)
    else:
        reading.check_units(statement)
        reading.cycle_began = reading.moves
        cycle = read_cycle(statement, reading.scale, _FEED_UNITS)
        by_place = not words & {"DEPTH", "FEDTO", "CLEAR"}
        leaves_to = cycle.out if reading.mode_said and by_place else None
        reading.unsure_cycle = None if leaves_to is None else (statement, leaves_to)
        yield cycle


def _thread(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read THREAD, or OP/THREAD as Creo writes it: feed moves are cuts of a thread from here on."""
    words = statement.words()
    if statement.major == "OP" and "THREAD" not in words:
        if reading.threads:
            reading.threads = False
            yield Thread(statement.line, False)
        return
    if "AUTO" in words or any(token.number is not None for token in statement):
        raise statement.fail(
            f"{statement.major} that leaves the passes of a thread to the control",
            "Let the CAM system write each pass as points, between THREAD/TURN and THREAD/OFF.",
        )
    known = {"TURN", "FACE", "TAPER", "ON", "OFF", "OUT", "IN", "THREAD"}
    if strange := sorted(words - known):
        raise statement.fail(
            f"{statement.major}/{strange[0]} is not known", "Write THREAD/TURN, THREAD/FACE or THREAD/OFF."
        )
    reading.threads = "OFF" not in words
    yield Thread(statement.line, reading.threads, reading.lead if reading.threads else None)


def _pitch(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read PITCH: the lead of threads. A bare number is a lead for some systems and threads per inch for others."""
    words = statement.words()
    reading.check_units(statement)
    per_inch = statement.value_of("TPI", "threads per inch") if "TPI" in words else None
    value = statement.first_number()
    if value is None or value <= 0.0:
        raise statement.fail("PITCH needs a number above 0", "Write it like PITCH/LEAD,1.5 or PITCH/TPI,12.")
    if per_inch is not None:
        reading.lead = MM_PER_INCH / value
    elif words & {"MMPR", "IPR"}:
        reading.lead = value * (MM_PER_INCH if "IPR" in words else 1.0)
    elif "LEAD" in words:
        reading.lead = value * reading.scale
    else:
        raise statement.fail(
            "PITCH that says neither a lead nor threads per inch",
            "Write PITCH/LEAD,1.5 for a lead, or PITCH/TPI,12 for threads per inch.",
        )
    if reading.threads:
        yield Thread(statement.line, True, reading.lead)


def _coolant(reading: Reading, statement: Statement) -> Iterator[Record]:
    words = statement.words()
    mode: Literal["flood", "mist", "through", "off"] = "flood"
    if "OFF" in words:
        mode = "off"
    elif words & {"MIST", "AIR"}:
        mode = "mist"
    elif words & {"THRU", "THRUTL", "TAPKUL"}:
        mode = "through"
    yield Coolant(statement.line, mode)


def _compensation(reading: Reading, statement: Statement) -> Iterator[Record]:
    words = statement.words()
    if "ADJUST" in words:
        yield from _work_offset(reading, statement)
        return
    side: Literal["left", "right", "off"] = "off"
    reading.resumes = words == {"ON"}
    if reading.resumes:
        return
    if "OFF" in words:
        side = "off"
    elif "LEFT" in words:
        side = "left"
    elif "RIGHT" in words:
        side = "right"
    else:
        raise statement.fail("CUTCOM without a side", "Write CUTCOM/LEFT, CUTCOM/RIGHT or CUTCOM/OFF.")
    number = statement.first_number()
    plane = next((_PLANES[word] for word in sorted(words) if word in _PLANES), None)
    compensation = Compensation(
        statement.line, side, statement.whole(number, "the number of an offset"), plane
    )
    if side != "off":
        reading.side = compensation
    yield compensation


def _work_offset(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read CUTCOM/ADJUST,n: the work offset."""
    number = statement.whole(statement.value_of("ADJUST", "a work offset"), "a work offset") or 0
    if statement.words() != {"ADJUST"} or not 1 <= number < _FIRST_G_CODE:
        raise statement.fail(
            "CUTCOM/ADJUST with something else than the number of a work offset",
            "Write CUTCOM/ADJUST,1 for the first one (G54), CUTCOM/ADJUST,2 for the second one (G55).",
        )
    reading.forget_position()
    yield WorkOffset(statement.line, number)


def _dwell(reading: Reading, statement: Statement) -> Iterator[Record]:
    value = statement.first_number()
    if value is None or value < 0.0:
        word = statement.major
        raise statement.fail(
            f"{word} needs a time", f"Write it in seconds, like {word}/1.5, or as {word}/5,REV."
        )
    if "REV" in statement.words():
        yield Dwell(statement.line, revolutions=value)
    else:
        yield Dwell(statement.line, seconds=value)


def _transformation(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read TRNTYP: points count from the world, whatever CSYS come."""
    first = statement.peek()
    if first is None or first.text != "WORLD" or any(token.number for token in statement):
        raise statement.fail(
            "TRNTYP with other coordinates than those of the part",
            "Let the CAM system write all points in one coordinate system (TRNTYP/WORLD,0,0,0).",
            first,
        )
    if reading.frame and not reading.in_world:
        _cl_moves.check_upright(statement, reading.frames[reading.frame - 1])
    if len(reading.frames) > 1 and not reading.in_world and reading.moves:
        raise statement.fail(
            "TRNTYP/WORLD after points of several coordinate systems",
            "Let the CAM system write it before all points.",
        )
    reading.in_world = True
    return iter(())


def _mode(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read MODE: absolute milling or turning is what is read anyway."""
    reading.mode_said = True
    for token in statement:
        if token.text not in ("MILL", "TURN", "ABSOL"):
            raise statement.fail(
                f"MODE/{token.text} is not known", "Let the CAM system write absolute points.", token
            )
    return iter(())


def _stop(optional: bool) -> Handler:
    def read(reading: Reading, statement: Statement) -> Iterator[Record]:
        yield Stop(statement.line, optional)

    return read


def _end(reading: Reading, statement: Statement) -> Iterator[Record]:
    yield End(statement.line)


def _multax(reading: Reading, statement: Statement) -> Iterator[Record]:
    """Read MULTAX: after OFF a point without an axis is for an upright tool, for some systems."""
    reading.axis_unsure = statement if "OFF" in statement.words() and reading.is_tilted else None
    return iter(())


HANDLERS: dict[str, Handler] = {
    "MULTAX": _multax,
    "PARTNO": _text("part"),
    "PPRINT": _text("comment"),
    "INSERT": _text("insert"),
    "REMARK": _nothing,
    "TPRINT": _tool_name,
    "MACHIN": _machine,
    "UNITS": _units,
    "UNIT": _units,
    "MODE": _mode,
    "TRNTYP": _transformation,
    "MSYS": _cl_moves.coordinate_system,
    "CSYS": _cl_moves.coordinate_system,
    "MCS": _cl_moves.coordinate_system,
    "TOOLPATH": _tool_path,
    "END-OF-PATH": _end_of_path,
    "TLDATA": _tool_data,
    "CUTTER": _cutter,
    "LOADTL": _tool,
    "LOAD": _tool,
    "TOOLNO": _tool,
    "TURRET": _tool,
    "SET": _set,
    "SPINDL": _spindle,
    "FEDRAT": _feed,
    "RAPID": _cl_moves.rapid,
    "GOTO": _cl_moves.goto,
    "FROM": _cl_moves.start_from,
    "GODLTA": _cl_moves.delta,
    "GOHOME": _cl_moves.home,
    "TLAXIS": _cl_moves.tool_axis,
    "CLEARP": _cl_moves.clearance_plane,
    "RETRCT": _cl_moves.retract,
    "CIRCLE": _cl_moves.circle,
    "MOVARC": _cl_moves.circle,
    "INDIRV": _cl_moves.direction,
    "TLON,GOFWD": _cl_moves.follow_circle,
    "CYCLE": _cycle,
    "THREAD": _thread,
    "OP": _thread,
    "PITCH": _pitch,
    "COOLNT": _coolant,
    "CUTCOM": _compensation,
    "DELAY": _dwell,
    "DWELL": _dwell,
    "STOP": _stop(False),
    "OPSTOP": _stop(True),
    "END": _end,
    "FINI": _end,
}
"""The known words, each with the function that reads its statement."""
