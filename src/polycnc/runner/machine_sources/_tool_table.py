"""The tool table of LinuxCNC: a line for each tool, like `T3 P3 Z12.5 D6 ; end mill`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping

from polycnc.errors import ConfigurationError, SourcePosition

LARGEST_BYTES = 1_000_000
MOST_NUMBER = 99_999
_WORD = re.compile(r"([A-Za-z])[ \t]*([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))")
_TIPS = (0, 4, 3, 2, 1, 5, 8, 7, 6, 9)
"""The tip of a tool of the machine file by Q. Source: LinuxCNC user manual, "Lathe User Information"."""

Tool = dict[str, float | str]


def table_rows(text: str, file: str, to_mm: float) -> Iterator[tuple[int, tuple[Tool, tuple[str, ...]]]]:
    """Give the tools of a table of LinuxCNC: number, data, and the letters that have no place.

    Raises:
        ConfigurationError: a line of the table is wrong.
    """
    for number, line in enumerate(text.splitlines(), 1):
        position = SourcePosition(file, number, 1, line)
        words, remark = _words(line, position)
        if words:
            yield (
                _whole(words, "T", MOST_NUMBER, position),
                (
                    _tool(words, remark, to_mm, position),
                    tuple(each for each in "ABCUVWIJ" if words.get(each, 0.0)),
                ),
            )


def _words(line: str, position: SourcePosition) -> tuple[dict[str, float], str]:
    """Return the words of a line, and its remark."""
    body, _, text = line.partition(";")
    words = {found[1].upper(): float(found[2]) for found in _WORD.finditer(body)}
    if _WORD.sub("", body).strip() or not all(map(math.isfinite, words.values())):
        raise ConfigurationError(
            "this is no tool",
            position=position,
            hint="A line of a tool table is like: T3 P3 Z12.5 D6 ; end mill",
        )
    return words, text.strip()


def _whole(words: Mapping[str, float], letter: str, most: int, position: SourcePosition) -> int:
    value = words.get(letter, -1.0 if letter == "T" else 0.0)
    if value != round(value) or not 0 <= value <= most:
        raise ConfigurationError(
            f"{letter} of a tool is a whole number from 0 to {most}",
            position=position,
            hint="Correct the line.",
        )
    return int(value)


def _tool(words: Mapping[str, float], text: str, to_mm: float, position: SourcePosition) -> Tool:
    tool: Tool = {}
    for key, letter, scale in (
        ("length_mm", "Z", to_mm),
        ("x_mm", "X", to_mm),
        ("y_mm", "Y", to_mm),
        ("radius_mm", "D", to_mm / 2.0),
    ):
        if value := words.get(letter, 0.0):
            tool[key] = (abs(value) if letter == "D" else value) * scale
    if words.get("D", 0.0) < 0.0:  # G41 goes to the right of the contour, G42 to the left
        tool["wear_radius_mm"] = words["D"] * to_mm
    if tip := _TIPS[_whole(words, "Q", 9, position)]:
        tool["tip"] = tip
    if text:
        tool["description"] = text
    return tool
