"""Which macro each event of a tool path calls, and which words it sets: one table, from which the reference page
is written, the control files are checked and the program driver takes its names.

Lengths are in the units of the output (`units` of the control file), angles in degree, times in seconds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class WordRow:
    """A word that an event sets before its macro runs: a number, or a text.

    `added`: an addition to the words of Manual 001, which a control file with `strict` does not have. `kept`: the
    driver keeps it, so that a macro cannot set it.
    """

    name: str
    kind: Literal["number", "text"]
    meaning: str
    added: bool = False
    kept: bool = False


@dataclass(frozen=True, slots=True)
class EventRow:
    """An event of a tool path: the macro it calls, when, and the words it sets.

    `group` says what happens if the control file has no such macro: "motion" is an error, "cycle" is expanded
    into moves, "arc" becomes lines, "state" emits nothing and is remarked or an error, "frame" emits nothing.
    """

    macro: str
    group: Literal["frame", "state", "motion", "arc", "cycle"]
    when: str
    words: tuple[str, ...] = ()
    added: bool = False


_POINT = ("X", "Y", "Z")
_ROTARY = ("A", "B", "C")
_TOOL_AXIS = ("TOOLI", "TOOLJ", "TOOLK")
_START = ("STARTX", "STARTY", "STARTZ")
_MOVE = (*_POINT, *_ROTARY, *_TOOL_AXIS, *_START)
_FEED = ("F", "FEEDMODE")
_ARC = (*_POINT, *_START, "I", "J", "K", "R", "PLANE", "SWEEP", *_FEED)
_HOLE = (*_POINT, *_START, "SURFACE", "R", "OUT", "RETRACT", "HOLE", *_FEED)
_SPINDLE = ("S", "SPINDLEMODE", "MAXRPM")
_NUMBERS = tuple(f"NUMBER{place}" for place in range(1, 10))
_TOOL = ("T", "TOOLCHANGE", "TOOLNAME", "TOOLDIAMETER", "TOOLLENGTH", "H", "D")

WORDS: tuple[WordRow, ...] = (
    WordRow("X", "number", "end point; in a cycle the hole"),
    WordRow("Y", "number", "end point; in a cycle the hole"),
    WordRow("Z", "number", "end point; in a cycle the bottom of the hole"),
    WordRow("A", "number", "rotary position about X, if the control file has one"),
    WordRow("B", "number", "rotary position about Y, if the control file has one"),
    WordRow("C", "number", "rotary position about Z, if the control file has one"),
    WordRow("TOOLI", "number", "tool axis at the end point: a unit vector from the tip to the holder"),
    WordRow("TOOLJ", "number", "the same, part along Y"),
    WordRow("TOOLK", "number", "the same, part along Z"),
    WordRow("STARTX", "number", "where the move begins"),
    WordRow("STARTY", "number", "where the move begins"),
    WordRow("STARTZ", "number", "where the move begins"),
    WordRow("I", "number", "arc centre along X: from the start point, or its position (`arc_center`)"),
    WordRow("J", "number", "arc centre along Y, likewise"),
    WordRow("K", "number", "arc centre along Z, likewise"),
    WordRow("R", "number", "of an arc its radius, below 0 if it is longer than half a turn; in a cycle the level "
            "where the feed begins"),
    WordRow("PLANE", "number", "plane of the arc: 17 XY, 18 ZX, 19 YZ"),
    WordRow("SWEEP", "number", "angle of the arc, above 0 and up to 360 degree; more turns are several arcs"),
    WordRow("F", "number", "feed per minute, or per revolution, as FEEDMODE says; per minute in a tapping cycle too"),
    WordRow("FEEDMODE", "number", "94: F is per minute; 95: F is per revolution"),
    WordRow("SURFACE", "number", "level of the point that the tool path names: the top of the hole"),
    WordRow("OUT", "number", "level to which the tool leaves the hole"),
    WordRow("RETRACT", "number", "98: leave to the level before the cycle, which is OUT; 99: leave to R"),
    WordRow("HOLE", "number", "1 at the first hole of a cycle, then 2, 3, ..."),
    WordRow("Q", "number", "peck, as a length above 0"),
    WordRow("P", "number", "dwell in seconds"),
    WordRow("PITCH", "number", "pitch of the thread: feed per revolution"),
    WordRow("LEAD", "number", "lead of the thread: the way of one turn of the spindle", added=True),
    WordRow("S", "number", "spindle speed, or surface speed, as SPINDLEMODE says"),
    WordRow("SPINDLEMODE", "number", "97: S is revolutions per minute; 96: m per minute, in inch feet per minute"),
    WordRow("MAXRPM", "number", "highest speed that is allowed with a surface speed, 0 if none is given", added=True),
    WordRow("T", "number", "tool number"),
    WordRow("TOOLCHANGE", "text", "the tool number as the control writes it: T in its own format"),
    WordRow("TOOLNAME", "text", "name of the tool"),
    WordRow("TOOLDIAMETER", "number", "diameter of the tool, 0 if it is not known"),
    WordRow("TOOLLENGTH", "number", "length of the tool, 0 if it is not known"),
    WordRow("H", "number", "number of the length offset; the tool number if none is given"),
    WordRow("D", "number", "number of the radius offset; the tool number if none is given"),
    WordRow("DWELL", "number", "time to wait, in seconds; 0 if it is given in revolutions"),
    WordRow("DWELLREV", "number", "time to wait, in revolutions; 0 if it is given in seconds"),
    WordRow("COMMENT", "text", "text of the record"),
    WordRow("PARTNAME", "text", "name of the part (PARTNO)"),
    WordRow("PATHNAME", "text", "name of the operation, empty if it has none"),
    WordRow("PATHNUMBER", "number", "1 for the first operation, then 2, 3, ..."),
    WordRow("MACHINENAME", "text", "name in the MACHIN record"),
    WordRow("UNITS", "number", "21: lengths are written in mm; 20: in inch"),
    WordRow("WORD", "text", "first word of the record, like AUXFUN", added=True, kept=True),
    WordRow("WORDTEXT", "text", "what follows its slash, unchanged", added=True, kept=True),
    WordRow("NUMBERS", "number", "how many numbers the record has", added=True, kept=True),
    *(
        WordRow(name, "number", f"its number {name[6:]} unchanged, 0 if it has fewer", added=True, kept=True)
        for name in _NUMBERS
    ),
)  # fmt: skip

EVENTS: tuple[EventRow, ...] = (
    EventRow("PROGRAM_START", "frame", "before everything else", ("PARTNAME", "MACHINENAME", "UNITS")),
    EventRow("PROGRAM_END", "frame", "at FINI, or at the end of the tool path"),
    EventRow("PATH_START", "frame", "at the first record of an operation", ("PATHNAME", "PATHNUMBER")),
    EventRow("PATH_END", "frame", "at the end of an operation", ("PATHNAME", "PATHNUMBER")),
    EventRow("WORK_OFFSET", "frame", "CUTCOM/ADJUST, another coordinate system, `work_offset` in JSON", added=True),
    EventRow("TOOL_CHANGE", "state", "LOADTL, LOAD/TOOL, TOOLNO, TURRET", _TOOL),
    EventRow("SPINDLE_CW", "state", "SPINDL clockwise", _SPINDLE),
    EventRow("SPINDLE_CCW", "state", "SPINDL counter-clockwise", _SPINDLE),
    EventRow("SPINDLE_OFF", "state", "SPINDL/OFF"),
    EventRow("COOLANT_FLOOD", "state", "COOLNT/FLOOD, COOLNT/ON"),
    EventRow("COOLANT_MIST", "state", "COOLNT/MIST"),
    EventRow("COOLANT_THROUGH", "state", "COOLNT/THRU"),
    EventRow("COOLANT_OFF", "state", "COOLNT/OFF"),
    EventRow("COMP_LEFT", "state", "CUTCOM/LEFT", ("D",)),
    EventRow("COMP_RIGHT", "state", "CUTCOM/RIGHT", ("D",)),
    EventRow("COMP_OFF", "state", "CUTCOM/OFF"),
    EventRow("RAPID", "motion", "a move after RAPID", _MOVE),
    EventRow("LINEAR", "motion", "a move with feed, a piece of an arc that is split into lines", (*_MOVE, *_FEED)),
    EventRow("THREAD", "motion", "a cut of a thread, between THREAD/TURN and THREAD/OFF", (*_MOVE, "LEAD"), added=True),
    EventRow("ARC_CW", "arc", "an arc clockwise in its plane, or a helix", _ARC),
    EventRow("ARC_CCW", "arc", "an arc counter-clockwise in its plane, or a helix", _ARC),
    EventRow("CYCLE_DRILL", "cycle", "each hole of CYCLE/DRILL", _HOLE),
    EventRow("CYCLE_DWELL", "cycle", "each hole of CYCLE/DRILL with DWELL, FACE, CSINK, CBORE", (*_HOLE, "P")),
    EventRow("CYCLE_DEEP", "cycle", "each hole of CYCLE/DEEP", (*_HOLE, "Q", "P")),
    EventRow("CYCLE_CHIP_BREAK", "cycle", "each hole of CYCLE/BRKCHP", (*_HOLE, "Q", "P")),
    EventRow("CYCLE_TAP", "cycle", "each hole of CYCLE/TAP", (*_HOLE, "PITCH", "S", "P")),
    EventRow("CYCLE_BORE", "cycle", "each hole of CYCLE/BORE, REAM", (*_HOLE, "P")),
    EventRow("CYCLE_OFF", "frame", "after the last hole that a cycle macro drilled"),
    EventRow("DWELL", "state", "DELAY", ("DWELL", "DWELLREV")),
    EventRow("STOP", "state", "STOP"),
    EventRow("OPTIONAL_STOP", "state", "OPSTOP"),
    EventRow("COMMENT", "frame", "PPRINT", ("COMMENT",)),
    EventRow("INSERT", "state", "INSERT: a text that is a block of the control", ("COMMENT",)),
    EventRow("WORD", "state", "a record that no other event takes, like AUXFUN, PREFUN, OPSKIP, CLAMP",
             ("WORD", "WORDTEXT", "NUMBERS", *_NUMBERS), added=True),
)  # fmt: skip

STATES: tuple[WordRow, ...] = (
    WordRow("SPINDLESTATE", "number", "3: the spindle turns clockwise; 4: counter-clockwise; 5: stopped", True, True),
    WordRow("COOLANTSTATE", "number", "8: flood; 7: mist; 88: through the tool; 9: off", True, True),
    WordRow("NEXTTOOL", "number", "tool of the next tool change, 0 after the last one", True, True),
    WordRow("NEXTSPINDLE", "number", "revolutions per minute of the next SPINDL/ that turns the spindle; 0 if none "
            "follows, or a surface speed", True, True),
    WordRow("NEXTSPINDLESTATE", "number", "3 or 4: how it turns then, as SPINDLESTATE; 5 if none follows", True, True),
    WordRow("FIRSTMOTION", "number", "2: the first move or hole of the program, after a tool change or in another "
            "work offset; 1: the first of an operation otherwise; 0: any other", True, True),
    WordRow("WORKOFFSET", "number", "number of the work offset, 1 if the tool path names none", True, True),
)  # fmt: skip
"""Words that hold in every macro: what the tool path has switched, whatever a tool change does to it in between."""

MACROS: frozenset[str] = frozenset(event.macro for event in EVENTS)
"""Names of the macros that a control file may have."""

NUMBER_WORDS: frozenset[str] = frozenset(word.name for word in (*WORDS, *STATES) if word.kind == "number")
"""Words that events set to numbers: function variables of the control file, or variables of its macros."""

ADDED_WORDS: frozenset[str] = frozenset(word.name for word in (*WORDS, *STATES) if word.added)
"""Words that are no words with `strict`."""

KEPT_WORDS: frozenset[str] = frozenset(word.name for word in (*WORDS, *STATES) if word.kept)
"""Words that macros cannot set."""

MOST_NUMBERS = len(_NUMBERS)
"""How many numbers of a record WORD has words for."""

TEXT_WORDS: frozenset[str] = frozenset(word.name for word in WORDS if word.kind == "text")
"""Words that events set to texts."""


def words_of(macro: str) -> tuple[str, ...]:
    """Return the words that the event of a macro sets."""
    return next(event.words for event in EVENTS if event.macro == macro)


_WORD_MACRO = re.compile(r"WORD(_[A-Z][A-Z0-9]*){1,2}")


def word_macros(name: str, first: str) -> Iterable[str]:
    """Return the macros that may take a record, the narrowest first.

    A condition cannot compare texts (Manual 001, 8), so the name of the record, and the first word after its slash,
    are part of the macro's: WORD_OPSKIP_ON, WORD_OPSKIP, WORD.
    """
    return f"WORD_{name}_{first}", f"WORD_{name}", "WORD"


def is_macro(name: str) -> bool:
    """Tell whether an event may call a macro of that name."""
    return name in MACROS or _WORD_MACRO.fullmatch(name) is not None


def is_added_macro(name: str) -> bool:
    """Tell whether a macro is an addition, which a control file with `strict` cannot have."""
    return name.startswith("WORD_") or any(event.added and event.macro == name for event in EVENTS)
