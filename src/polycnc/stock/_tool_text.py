"""Tools from what programs say about them in remarks."""

from __future__ import annotations

import math
import re
from dataclasses import replace

from polycnc.errors import UsageError
from polycnc.stock._tool import Tool, ToolKind
from polycnc.stock._tool_sizes import MM_PER_INCH, bare_size, size_mm

_NUMBERED = re.compile(
    r"\bT(?:OOL(?:\s+(?:-|NO\b\.?|\())?)?\s*[#:]?\s*0*(\d{1,9})\b\)?(?!/|\.\d|\s*(?:mm\b|inch\b|in\.?\s*$|\"))"
    r"|^\s*0*(\d{1,9}) = (?=[A-Za-z])",
    re.IGNORECASE,
)
_NUMBER = r"(\d+(?:\.\d*)?(?![\d.]*e[-+]?\d)(?!\.?\d)|\.\d+)"
_WITH_COMMA = r"(\d+(?:\.\d*|,\d+)?(?![\d.]*e[-+]?\d)(?![.,]?\d)|\.\d+)"
_STATED = re.compile(r"\bD(?:IA(?:M(?:ETER)?)?)?\s*=\s*[-+.\d]", re.IGNORECASE)
_DIAMETER = re.compile(
    rf"(?:\bD(?:IA(?:M(?:ETER)?)?)?\s*[=:]|\btool[ _]?dia(?:meter)?\"?\s*[=:]?)\s*"
    rf"{_WITH_COMMA}(?:\s*(mm|in)(?![a-z]))?",
    re.IGNORECASE,
)
_OF_NAMED = re.compile(
    rf"\bDIA\.?\s+(?:-\s+)?{_NUMBER}|{_NUMBER}\s*DIA\b(?!\.?\s*(?:-|OFF))",
    re.IGNORECASE,
)
_NOUN = re.compile(r"mill\b|drill\b|cutter\b|reamer\b", re.IGNORECASE)
_CALLED = re.compile(
    r"^\s*(?:tool|bit|cutter)\s*(?:[:=]|->)\s*[\d./]+\s*(?:mm|in|inch|\")\s*$", re.IGNORECASE
)
_SIZE_ALONE = re.compile(rf"^\s*T\d+\s*[:=]\s*{_NUMBER}\s*$", re.IGNORECASE)
_ROUND = re.compile(rf"\bD(?:IA\.?)? ?\d[\d.]*\s*R ?{_NUMBER}", re.IGNORECASE)
_STATEMENT = re.compile(r"^\s*TOOL/(MILL|DRILL|CHAMFER)\s*,(.*)", re.IGNORECASE)
_CORNER = re.compile(rf"\bCR\s*[=:]\s*{_NUMBER}", re.IGNORECASE)
_ANGLE = re.compile(
    rf"\b(?:TAPER|TIP|ANGLE)\s*[=:]?\s*{_NUMBER}\s*(?:DEG|°)|{_NUMBER}\s*(?:DEG\w*|°)", re.IGNORECASE
)
_UNLIKE = re.compile(
    r"\bprob(?:e|ing)\b|thread[ -]?mill|\bt[ -]slot|dove[ -]?tail|lollipop|undercut|woodruff|key(?:seat|way|slot)"
    r"|\b(?:bolts?|circle)\b.*\bdia"
    r"|gewindefr|schwalbenschwanz|\bt[ -]nut|radienfr"
    r"|\bradius mill|corner round|\bround[ -]?over|\bform (?:mill|tool|cutter)|\bogee\b|\bcove\b",
    re.IGNORECASE,
)
_TEETH = re.compile(r"(?<![\d.])(\d{1,2})[ -]?(?:flutes?|fl|teeth|tooth)\b(?! *len)", re.IGNORECASE)
_LEFT_HAND = re.compile(r"\bleft[ -]?hand(?:ed)?\b|\bLH\b", re.IGNORECASE)
POINT_DEG = 118.0
CHAMFER_DEG = 90.0
_MOST_FLANK_DEG = 60.0
_ALL_ROUND = 0.49  # of the diameter: the corner of a ball, rounded
_KINDS = (
    (re.compile(r"\bball|\bspherical|kugelfr|\bsferic", re.IGNORECASE), ToolKind.BALL),
    (re.compile(r"\bbull|\bcorner radius|\btoroid|torusfr", re.IGNORECASE), ToolKind.BULL),
    (re.compile(r"chamfer|v-?bit|engrav|counter ?sink|spot|fasenfr|senker", re.IGNORECASE), ToolKind.CHAMFER),
    (
        re.compile(r"drill|\btap\b|\bream|bohrer\b|\b(?:foret|broca|punta|maschio|taraud)\b", re.IGNORECASE),
        ToolKind.DRILL,
    ),
    (re.compile(r"taper", re.IGNORECASE), ToolKind.TAPER),
    (re.compile(r"(?:\b|end|face|slot)mill|cutter|\bflat|\bslot", re.IGNORECASE), ToolKind.FLAT),
    (re.compile(r"fr(?:ä|ae|a|\ufffd)ser|\bfresa\b|\bfraise\b", re.IGNORECASE), ToolKind.FLAT),
    (re.compile(r"\b(?:up|down)[ -]?cut\b|\bcompression\b|\brouter bit", re.IGNORECASE), ToolKind.FLAT),
    (re.compile(r"\bbor(?:e|ing)[ -]?(?:bar|head|tool)s?\b", re.IGNORECASE), ToolKind.BORING),
    (re.compile(r"\bholes?\b", re.IGNORECASE), ToolKind.DRILL),
)


def tool_number(remark: str) -> int | None:
    """Return the number of the tool that a remark is about, None if it names none."""
    found = _NUMBERED.search(remark)
    return int(found[1] or found[2]) if found else None


def tool_of_remark(remark: str, *, inch: bool = False) -> Tool | None:
    """Return the tool that a remark describes, None if that cannot be read.

    Read are `T1 D=10. CR=0. - ZMIN=-12. - flat end mill` and the like, and a size beside a word for a kind: `end mill
    10 mm`, `1/4" end mill`, `drill 8.5 mm`, `DRILL #4`, `1/4-20 tap`. With `inch` numbers without a unit are inches.
    Probes, and tools that cut under what is above them or by a form, are none that can be read.
    """
    if _UNLIKE.search(remark):
        return None
    if (stated := _STATEMENT.match(remark)) is not None:
        return _of_statement(stated[1].upper(), stated[2], MM_PER_INCH if inch else 1.0)
    try:
        tool = _of_words(remark, inch)
    except UsageError:
        return None
    if tool is None:
        return None
    teeth = int(found[1]) if (found := _TEETH.search(remark)) else 0
    return replace(tool, left_hand=_LEFT_HAND.search(remark) is not None, teeth=teeth)


def _of_words(remark: str, inch: bool) -> Tool | None:
    """Return the tool of a size beside a word for a kind, of `D=`, or of `DIA` where the remark names the tool."""
    kind = next((kind for pattern, kind in _KINDS if pattern.search(remark)), None)
    size = _diameter_mm(remark, inch)
    if size is None or (kind is None and not _is_of_tool(remark)):
        return None
    found = _CORNER.search(remark) or _ROUND.search(remark)
    corner = float(found[1]) * (MM_PER_INCH if inch else 1.0) if found else 0.0
    angle = float(found[1] or found[2]) if (found := _ANGLE.search(remark)) else 0.0
    kind = kind or ToolKind.FLAT
    if kind is ToolKind.CHAMFER and angle <= _MOST_FLANK_DEG and "chamfer" in remark.lower():
        angle *= 2.0  # chamfering tools are named by their flank, V-bits and countersinks by their point
    if kind is ToolKind.FLAT and corner > 0.0:
        kind = ToolKind.BALL if corner >= 0.5 * size else ToolKind.BULL
    return _tool(kind, size, corner, angle)


def _tool(kind: ToolKind, size: float, corner: float, angle: float) -> Tool | None:
    match kind:
        case ToolKind.BULL:
            return Tool(kind, size, corner_mm=corner) if corner > 0.0 else None
        case ToolKind.DRILL:
            return Tool(kind, size, angle_deg=angle or POINT_DEG)
        case ToolKind.CHAMFER:
            return Tool(kind, size, angle_deg=angle or CHAMFER_DEG)
        case ToolKind.TAPER:
            return Tool(kind, size, angle_deg=angle) if angle > 0.0 else None
        case _:
            return Tool(kind, size)


def _of_statement(kind: str, numbers: str, unit_mm: float) -> Tool | None:
    """Return the tool of a statement that viewers of programs read: `TOOL/MILL,diameter,corner,height,flank`."""
    try:
        found = [float(each) for each in numbers.split(",")]
        size, second, height, flank = (*found, 0.0, 0.0, 0.0)[:4]
        size, height = size * unit_mm, height * unit_mm
        if kind != "MILL":
            return Tool(ToolKind[kind], size, angle_deg=second)
        if flank > 0.0:  # the diameter is that of the end
            wide = size + 2.0 * height * math.tan(math.radians(flank))
            return Tool(ToolKind.TAPER, wide, angle_deg=flank, tip_mm=size)
        corner = second * unit_mm
        if corner >= _ALL_ROUND * size:
            return Tool(ToolKind.BALL, size)
        return Tool(ToolKind.BULL, size, corner_mm=corner) if corner > 0.0 else Tool(ToolKind.FLAT, size)
    except (ValueError, UsageError):
        return None


def _diameter_mm(remark: str, inch: bool) -> float | None:
    if found := _DIAMETER.search(remark):
        in_inches = found[2].lower() == "in" if found[2] else inch
        return float(found[1].replace(",", ".")) * (MM_PER_INCH if in_inches else 1.0)
    if _STATED.search(remark):  # a sign or a second point: no size
        return None
    rest = _NUMBERED.sub("", remark)
    named = _OF_NAMED.search(rest) if rest != remark or _NOUN.search(rest) else None
    if named is not None and (size := named[1] or named[2]):
        return float(size) * (MM_PER_INCH if inch else 1.0)
    size = size_mm(rest, inch=inch)
    if size is None and (bare := bare_size(rest, tool_number(remark))) is not None:
        return bare * (MM_PER_INCH if inch else 1.0)
    return size


def _is_of_tool(remark: str) -> bool:
    """Tell whether the size in a remark is that of a tool though no word says its kind, as in `T1 : 6.0`."""
    if tool_number(remark) is not None and _OF_NAMED.search(remark):
        return True
    return any(pattern.search(remark) for pattern in (_DIAMETER, _CALLED, _SIZE_ALONE))
