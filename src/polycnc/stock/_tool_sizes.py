"""Sizes of tools as shops write them: with a unit, as fractions of an inch, by numbers or letters, as threads."""

from __future__ import annotations

import math
import re

MM_PER_INCH = 25.4

_WITH_UNIT = re.compile(
    r"(?<![\d.,/])(?:(?P<whole>\d+)[ -])?(?:(?P<over>\d+)/(?P<under>\d+)|(?P<size>\d+(?:[.,]\d*)?|\.\d+))"
    r"\s*-?(?P<unit>mm|inch(?:es)?|in|\")(?![a-z])",
    re.IGNORECASE,
)
_KIND = r"(?:(?:end|face|slot|ball|flat|spot|cent(?:er|re))[ -]?)?(?:mill|drill|tap|ream(?:er)?)"
_WORDS = r"(?:(?:[a-z]+[ -]+){0,2})"  # "9/64 clearance drill"
_PART = r"(?P<over>\d{1,2})/(?P<under>2|4|8|16|32|64)(?:th|nd)?"
# Fractions are of an inch; what they stand beside tells that they are no page, date or side of a part.
_FRACTIONS = (
    re.compile(
        rf"(?<![\w.,/#-])(?:(?P<whole>\d)[ -]+)?{_PART}(?:-\d\d?)?[ -]+{_WORDS}{_KIND}\b", re.IGNORECASE
    ),
    re.compile(rf"\b{_KIND}s?[ -]+(?:(?P<whole>\d)[ -]+)?{_PART}(?![\d./])", re.IGNORECASE),
)
_NOT_A_SIZE = re.compile(r"\b(?:op(?:eration)?|side|part|setup|page|sheet|step)\W*\d+/\d+", re.IGNORECASE)
# Decimals without a unit are read in inch programs alone: in others they may be lengths of anything.
_DECIMALS = (
    re.compile(rf"(?<![\w.,/#-])(?P<size>\d?\.\d{{2,4}})[ -]+{_WORDS}{_KIND}\b", re.IGNORECASE),
    re.compile(rf"\b{_KIND}s?[ -]+(?P<size>\d?\.\d{{2,4}})(?![\d./])", re.IGNORECASE),
)
_NUMBER_DRILL = re.compile(
    rf"(?:#|\bno\.?)\s*(?P<a>\d\d?)[ -]+{_WORDS}drill\b|\bdrill[ -]+(?:#|no\.?)\s*(?P<b>\d\d?)(?![\d./])",
    re.IGNORECASE,
)
_LETTER_DRILL = re.compile(
    r"\bletter[ -]+(?P<a>[A-Z])\b|\bdrill[ -]+letter[ -]+(?P<b>[A-Z])\b", re.IGNORECASE
)
_FOREIGN_TAP = r"(?:gewindebohrer|\bmaschio|\btaraud)"
_THREAD = r"M(?P<{0}>\d{{1,2}}(?:\.\d)?)"
_METRIC_TAP = re.compile(  # M3 alone may be a code
    rf"\b{_THREAD.format('a')}\s*x\s*\d?\.?\d|\b{_THREAD.format('b')}[ -]+tap"
    rf"|(?:\btap|{_FOREIGN_TAP})[ -]+{_THREAD.format('c')}\b",
    re.IGNORECASE,
)
_FRACTION_TAP = re.compile(rf"(?<![\w.,/#-])(?P<whole>\d[ -]+)?{_PART}-\d\d?\b", re.IGNORECASE)
_NUMBER_TAP = re.compile(r"(?<![\w./])#?(?P<size>\d\d?)-\d\d\b")
_TAP = re.compile(rf"\btap(?:ping)?\b(?![ -]*drill)|{_FOREIGN_TAP}", re.IGNORECASE)
_CENTRE = re.compile(r"\bcent(?:er|re)\b", re.IGNORECASE)

# In a remark that names a tool, numbers without a unit are its size where they begin or end a part of the remark.
_SHAPE = (
    r"(?:(?:end|face|slot|ball|spot|cent(?:er|re))[ -]?)?(?:mill|drill|ream(?:er)?)\b(?![ -]*holes)"
    r"|(?:\w*fr(?:ä|ae|a|\ufffd)ser|\w*bohrer|fresa|fraise|foret|broca|punta)\b"
)
_ADJECTIVES = (
    r"(?:(?:rough|finish|std|standard|flat|ball|bull|nose|carbide|hss|square|stub|long|twist)\w*[ -]+){0,3}"
)
_ENDS = r"\s*(?=$|[|,;)])"
_BARE = (
    re.compile(
        rf"(?:^|[|:,;(=-])\s*(?P<size>\d+\.\d*|\.\d+|[1-5]?\d)[ -]+{_ADJECTIVES}(?:{_SHAPE})", re.IGNORECASE
    ),
    re.compile(rf"(?:{_SHAPE})[ -]+(?P<size>\d+\.\d*|\.\d+|(?<=- )\d+|\d+(?=\s*\|)){_ENDS}", re.IGNORECASE),
    re.compile(rf"^\s*[:=]\s*(?P<size>\d+\.\d*|\.\d+){_ENDS}$"),
)
_D_WORD = re.compile(r"(?<![A-Za-z0-9.])D ?(?P<size>\d+(?:[.,]\d*)?)(?![\d.]|\s*[=:])", re.IGNORECASE)
_BESIDE_SHAPE = re.compile(rf"(?:{_SHAPE})[ _-]*D ?\d|\bD ?[\d.,]+[ _-]+(?:{_SHAPE})", re.IGNORECASE)
_LENGTH_OFFSET = re.compile(r"\bH ?\d", re.IGNORECASE)

# fmt: off
_THOUSANDTHS_OF_NUMBERS = (
    228, 221, 213, 209, 205.5, 204, 201, 199, 196, 193.5, 191, 189, 185, 182, 180, 177, 173, 169.5,
    166, 161, 159, 157, 154, 152, 149.5, 147, 144, 140.5, 136, 128.5, 120, 116, 113, 111, 110, 106.5,
    104, 101.5, 99.5, 98, 96, 93.5, 89, 86, 82, 81, 78.5, 76, 73, 70, 67, 63.5, 59.5, 55,
    52, 46.5, 43, 42, 41, 40, 39, 38, 37, 36, 35, 33, 32, 31, 29.2, 28, 26, 25,
    24, 22.5, 21, 20, 18, 16, 14.5, 13.5,
)
_THOUSANDTHS_OF_LETTERS = dict(
    zip(
        "ABCDEFGHIJKLMNOPQRSTUVWXYZ",
        (234, 238, 242, 246, 250, 257, 261, 266, 272, 277, 281, 290, 295, 302, 316, 323, 332, 339, 348, 358, 368, 377,
         386, 397, 404, 413),
        strict=True,
    )
)
# fmt: on


def size_mm(remark: str, *, inch: bool = False) -> float | None:
    """Return the diameter that a remark gives, mm, None if it gives none; with `inch` bare decimals are inches."""
    if found := _WITH_UNIT.search(remark):
        size = _fraction(found) if found["over"] else float(found["size"].replace(",", "."))
        return size * (1.0 if found["unit"].lower() == "mm" else MM_PER_INCH)
    if (thousandths := _of_drill(remark)) is not None:
        return thousandths / 1000.0 * MM_PER_INCH
    if _TAP.search(remark) and (thread_mm := _of_thread_mm(remark)) is not None:
        return thread_mm
    if not _NOT_A_SIZE.search(remark):
        for pattern in _FRACTIONS:
            if found := pattern.search(remark):
                return _fraction(found) * MM_PER_INCH
    for pattern in _DECIMALS if inch else ():
        if found := pattern.search(remark):
            return float(found["size"]) * MM_PER_INCH
    return None


def bare_size(remark: str, number: int | None) -> float | None:
    """Return the diameter without a unit that a remark, without the number of its tool, gives; None if it gives none.

    That is `D10` beside a word for a shape, and in a remark that names a tool `10. flat endmill` or `end mill - 10`.
    """
    if (found := _D_WORD.search(remark)) and not _LENGTH_OFFSET.search(remark):  # beside H it is an offset
        size = float(found["size"].replace(",", "."))
        if (number is None or size != number) and (number is not None or _BESIDE_SHAPE.search(remark)):
            return size
    if number is None:
        return None
    sizes = (pattern.search(remark) for pattern in _BARE)
    return next((float(each["size"]) for each in sizes if each), None)


def _fraction(found: re.Match[str]) -> float:
    return float(found["whole"] or 0.0) + float(found["over"]) / (float(found["under"]) or math.inf)


def _of_drill(remark: str) -> float | None:
    if _CENTRE.search(remark):  # numbers of centre drills are other sizes
        return None
    if found := _NUMBER_DRILL.search(remark):
        number = int(found["a"] or found["b"])
        return _THOUSANDTHS_OF_NUMBERS[number - 1] if 1 <= number <= len(_THOUSANDTHS_OF_NUMBERS) else None
    if found := _LETTER_DRILL.search(remark):
        return float(_THOUSANDTHS_OF_LETTERS[(found["a"] or found["b"]).upper()])
    return None


def _of_thread_mm(remark: str) -> float | None:
    if found := _METRIC_TAP.search(remark):
        return float(found["a"] or found["b"] or found["c"])
    if found := _FRACTION_TAP.search(remark):
        return _fraction(found) * MM_PER_INCH
    if found := _NUMBER_TAP.search(remark):
        return (0.060 + 0.013 * int(found["size"])) * MM_PER_INCH
    return None
