"""Drilling cycles in APT words: by name (DEPTH, CLEAR, ...) as CAM systems write them today, or by place.

By name the levels count from the point: DEPTH or FEDTO downwards, CLEAR upwards; RAPTO goes further down from
CLEAR, or is the level itself with FEDTO or where there is no CLEAR; RETURN or RTRCTO is the level to leave to. By
place the numbers are the depth, the feed with its unit, and the clearance.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from polycnc.post.tool_path._cl_statement import Statement
from polycnc.post.tool_path._records import LARGEST_MM, Cycle, CycleKind
from polycnc.units import MM_PER_INCH

_KINDS: dict[str, CycleKind] = {
    "DRILL": "drill",
    "THRU": "drill",
    "FACE": "dwell",
    "CSINK": "dwell",
    "CBORE": "dwell",
    "DEEP": "deep",
    "DEEPHL": "deep",
    "DEEP2": "deep",
    "BRKCHP": "chip_break",
    "TAP": "tap",
    "BORE": "bore",
    "REAM": "bore",
}
_TURNING = ("TURN", "ROUGH", "FINISH", "GROOVE", "THREAD", "PROFIL", "CONTUR", "AREA", "LATHE", "TURNIN")
_PASSES = "Let the CAM system write each pass as points (GOTO, RAPID), not a cycle of the control."
_SLOW_MM_MIN = 20.0  # no drill is as slow, and no clearance as high
_PECKS = ("STEP", "INCR", "1STPECK", "SUBPECK")
_NUMBERED = ("DEPTH", "FEDTO", "CLEAR", "RAPTO", "RETURN", "RTRCTO", "DWELL", *_PECKS)


def read_cycle(statement: Statement, scale: float, units: Mapping[str, tuple[float, bool]]) -> Cycle:
    """Return the cycle of a CYCLE statement; `units` are the words of feeds: factor, and per revolution.

    Raises:
        ProgramError: an unknown cycle, or one without a depth.
    """
    words = statement.words()
    kind = _kind_in(statement, words)
    values, bare, feed, per_revolution = _split(statement, scale, units)
    depth = values.get("DEPTH", values.get("FEDTO"))
    if depth is None and bare:
        depth = bare.pop(0)
    if depth is None:
        raise statement.fail(
            "a cycle without a depth", "Write it like CYCLE/DRILL,DEPTH,10,MMPM,100,CLEAR,2."
        )
    clear = values.get("CLEAR")
    if clear is None and bare:
        if kind == "tap" and len(bare) > 1:
            bare.pop(0)  # threads per inch
        clear = bare.pop(0)
    rapid_to = values.get("RAPTO", 0.0)
    # With FEDTO, RAPTO is a level like the others; with DEPTH, and by place, it goes further down from CLEAR.
    is_level = clear is None or ("FEDTO" in values and "RAPTO" in values)
    start = rapid_to if is_level or clear is None else clear - rapid_to
    out = values.get("RETURN", values.get("RTRCTO", start if clear is None else clear))
    dwell = values.get("DWELL", 0.0)
    if kind == "drill" and dwell > 0.0:
        kind = "dwell"
    kind, peck = _pecks_of(statement, kind, values, bare)
    if any(abs(value) > LARGEST_MM for value in (depth, start, out, peck)):
        raise statement.fail("a level further than any machine", "Check the numbers of the cycle.")
    _check_pecks(statement, kind, peck, bare, scale)
    bottom = abs(depth)
    if not start > -bottom:
        raise statement.fail("a cycle whose feed begins below its depth", "Check CLEAR, RAPTO and DEPTH.")
    leave = None if (out == 0.0 and "RETURN" in values) or "AUTO" in words else max(out, start)
    return Cycle(statement.line, kind, bottom, start, leave, feed, per_revolution, peck, dwell)


def _kind_in(statement: Statement, words: Collection[str]) -> CycleKind:
    """Return which cycle the words of a statement name."""
    # NX writes CYCLE/DRILL,DEEP: the more special word counts.
    named = [_KINDS[word] for word in _KINDS if word in words]
    if not named:
        first = statement.peek()
        raise statement.fail(
            f"the cycle '{first.text}' is not known" if first else "a cycle without a kind",
            _PASSES if first and first.text in _TURNING else f"Known are {', '.join(_KINDS)}.",
            first,
        )
    if "BACK" in words:
        raise statement.fail("a cycle that cuts from below", "Let the CAM system write its moves as points.")
    return "tap" if "tap" in named else named[-1] if named[0] == "drill" else named[0]


def _pecks_of(
    statement: Statement, kind: CycleKind, values: Mapping[str, float], bare: list[float]
) -> tuple[CycleKind, float]:
    """Return the kind of a cycle that may peck, and the depth of a peck, 0 without."""
    pecks = [values[word] for word in _PECKS if word in values]
    if pecks and kind == "tap":
        raise statement.fail(
            "a thread tapped in pecks", "Let the CAM system write a tap that goes down at once."
        )
    if pecks:  # a control pecks by one depth: of several the smallest takes no more than any
        return "deep" if kind == "drill" else kind, min(pecks)
    return kind, bare.pop(0) if bare else 0.0


def _check_pecks(statement: Statement, kind: CycleKind, peck: float, bare: list[float], scale: float) -> None:
    """Refuse pecks without a depth, and numbers that are left over."""
    if kind in ("deep", "chip_break") and not peck > 0.0:
        raise statement.fail(
            "a cycle with pecks that does not say how deep they are", "Write STEP and a length."
        )
    if bare:
        raise statement.fail(
            f"the numbers of the cycle from {bare[0] / scale:g} on are not known by their places",
            "Let the CAM system write them by name, like CYCLE/DRILL,DEPTH,10,MMPM,100,CLEAR,2.",
        )


def _is_kind(word: str) -> bool:
    """Return whether numbers by place may stand after a word."""
    return word in _KINDS or word in _TURNING


def _split(
    statement: Statement, scale: float, units: Mapping[str, tuple[float, bool]]
) -> tuple[dict[str, float], list[float], float | None, bool]:
    """Return the numbers after words, those without one, the feed, and whether that is per revolution."""
    values: dict[str, float] = {}
    bare: list[float] = []
    feed: float | None = None
    per_revolution = False
    known = {**units, "PERMIN": (scale, False), "PERREV": (scale, True), "PITCH": (scale, True)}
    for token in statement:
        number = token.number
        if number is not None:
            bare.append(number * scale)
        elif token.text in known:
            factor, per_revolution = known[token.text]
            feed = _feed(statement, bare, scale, factor, per_revolution=per_revolution)
        elif token.text == "TPI":
            feed, per_revolution = MM_PER_INCH / statement.number("threads per inch"), True
        elif token.text == "RTRCTO" and (after := statement.peek()) is not None and after.text == "AUTO":
            continue
        elif token.text in _NUMBERED:
            value = statement.number(f"a number after {token.text}")
            values[token.text] = value if token.text == "DWELL" else value * scale
            if token.text in _PECKS:  # several pecks, each smaller than the one before
                values[token.text] = min((value, *(n for n in statement.numbers() if n > 0.0))) * scale
        elif (
            (after := statement.peek()) is not None and after.number is not None and not _is_kind(token.text)
        ):
            raise statement.fail(
                f"{token.text},{after.text} in a cycle is not known",
                "Remove it of the tool path, or let the CAM system write the moves of the holes as points.",
                token,
            )
    if feed is not None and not feed > 0.0:
        raise statement.fail(f"a cycle with a feed of {feed:g}", "Give a feed above 0.")
    return values, bare, feed, per_revolution


def _feed(
    statement: Statement, bare: list[float], scale: float, factor: float, *, per_revolution: bool
) -> float:
    """Return the feed that a unit stands by: before it by place, else after it."""
    if len(bare) < 2:
        return statement.number("a feed") * factor
    feed = bare.pop() / scale * factor
    if len(bare) > 1 and not per_revolution and feed < _SLOW_MM_MIN < bare[1]:
        raise statement.fail(
            f"which of the numbers {bare[1] / scale:g} and {feed / factor:g} is the feed is not clear",
            "Let the CAM system write them by name, like CYCLE/DRILL,DEPTH,10,MMPM,100,CLEAR,2.",
        )
    return feed
