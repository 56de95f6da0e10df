"""Small readers of what two shipped control files write, in languages that polycnc does not read: every word counts.

They follow the makers' programming manuals, not the control files: Siemens' positions are modal, centres of arcs count
from the start, CYCLE81 and CYCLE82 give planes in absolute values and a clearance without sign; Heidenhain's CC is
absolute, DR- is clockwise, and of cycle 200 depth and clearances count from the surface Q203.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

NUMBER = r"[-+]?\d+(?:\.\d*)?"
Step = tuple[Any, ...]


@dataclass
class Reader:
    """What holds from line to line, and what has been read: `steps`."""

    at: dict[str, float | None] = field(default_factory=lambda: dict.fromkeys("XYZ"))
    feed: float = 0.0
    speed: float = 0.0
    steps: list[Step] = field(default_factory=list)

    def place(self) -> tuple[float | None, ...]:
        """Return where the tool is; Z is unknown at the machine's top."""
        return tuple(self.at.values())

    def arc(self, clockwise: bool, center: tuple[float, float]) -> None:
        """Note an arc to the present place."""
        rounded = tuple(round(value, 3) for value in center)
        self.steps.append(("arc", clockwise, self.place(), rounded, self.feed))


def read_siemens(text: str) -> list[Step]:
    """Return what a program for a SINUMERIK 840D does.

    Raises:
        ValueError: a line that is not understood.
    """
    reader, motion, plane = Reader(), 0, 17
    for line in text.splitlines():
        line = line.split(";")[0].strip()
        if call := re.fullmatch(r"CYCLE8([12])\(([-+\d., ]*)\)", line):
            back, surface, clearance, depth, *more = (
                float(each) if each.strip() else 0.0 for each in call[2].split(",")
            )
            dwell = more[1] if call[1] == "2" else 0.0
            x, y = reader.at["X"], reader.at["Y"]
            reader.steps.append(("hole", (x, y), surface + clearance, depth, back, 0.0, dwell, reader.feed))
            reader.at["Z"] = back
            continue
        if line == "G0 SUPA Z0 D0":
            reader.at["Z"], motion = None, 0
            continue
        words = line.split()
        found = {word[0]: word[1:] for word in words if not word.startswith(("G", "M"))}
        center = [0.0, 0.0]
        moves, dwells = False, False
        for word in words:
            letter, value = word[0], word[1:]
            if not re.fullmatch(NUMBER, value):
                raise ValueError(line)
            match letter:
                case "G" if value in ("0", "1", "2", "3"):
                    motion = int(value)
                case "G" if value in ("17", "18", "19"):
                    plane = int(value)
                case "G" if value == "4":
                    dwells = True
                    reader.steps.append(("dwell", float(found.pop("F"))))
                case "G" if value in ("40", "54", "90", "94", "710"):
                    pass
                case "M" if value in ("3", "4", "5"):
                    reader.speed = float(found.get("S", reader.speed))
                    reader.steps.append(("spindle", {"3": 1, "4": -1, "5": 0}[value] * reader.speed))
                case "M" if value in ("0", "6", "8", "9", "30"):
                    reader.steps.append(("M", int(value)))
                case "T":
                    reader.steps.append(("tool", int(value)))
                case "X" | "Y" | "Z":
                    moves = True
                case "I" | "J":
                    center["IJ".index(letter)] = float(value)
                case "F" if not dwells:
                    reader.feed = float(value)
                case "D" | "S" | "F":
                    pass
                case _:
                    raise ValueError(line)
        if not moves:
            continue
        start = [reader.at[letter] or 0.0 for letter in "XY"]
        reader.at.update({letter: float(found[letter]) for letter in "XYZ" if letter in found})
        if motion >= 2:
            assert plane == 17, line
            reader.arc(motion == 2, (start[0] + center[0], start[1] + center[1]))
        else:
            reader.steps.append(
                ("line", reader.place(), reader.feed) if motion else ("rapid", reader.place())
            )
    return reader.steps


def read_heidenhain(text: str) -> list[Step]:
    """Return what a conversational program for a TNC does.

    Raises:
        ValueError: a line that is not understood, or its number is not the next one.
    """
    reader, center = Reader(), (0.0, 0.0)
    cycle: dict[int, float] = {}
    for count, numbered in enumerate(text.splitlines()):
        number, _, line = numbered.partition(" ")
        if int(number) != count:
            raise ValueError(numbered)
        words = {word[0]: word[1:] for word in line.split()}
        if line.startswith((";", "BEGIN PGM ", "END PGM ")) or line == "CYCL DEF 9.0 DWELL TIME":
            continue
        if line == "L Z+0 R0 FMAX M91":
            reader.at["Z"] = None
        elif found := re.fullmatch(rf"L((?: [XYZ]{NUMBER})*) R0(?: F(MAX|{NUMBER}))?( M99)?", line):
            reader.at.update({axis: float(words[axis]) for axis in "XYZ" if f" {axis}" in found[1]})
            if found[2] not in (None, "MAX"):
                reader.feed = float(found[2])
            if found[3]:
                top = cycle[203]
                hole = (top + cycle[200], top + cycle[201], top + cycle[204])
                peck = 0.0 if cycle[202] >= -cycle[201] else cycle[202]
                place = (reader.at["X"], reader.at["Y"])
                reader.steps.append(("hole", place, *hole, peck, cycle[211], cycle[206]))
                reader.at["Z"] = hole[2]
            elif found[2] == "MAX":
                reader.steps.append(("rapid", reader.place()))
            else:
                reader.steps.append(("line", reader.place(), reader.feed))
        elif found := re.fullmatch(rf"CC X({NUMBER}) Y({NUMBER})", line):
            center = (float(found[1]), float(found[2]))
        elif found := re.fullmatch(rf"C X({NUMBER}) Y({NUMBER}) DR([-+]) R0(?: F({NUMBER}))?", line):
            reader.at["X"], reader.at["Y"] = float(found[1]), float(found[2])
            reader.feed = float(found[4] or reader.feed)
            reader.arc(found[3] == "-", center)
        elif found := re.fullmatch(r"TOOL CALL (\d+) Z", line):
            reader.steps.append(("tool", int(found[1])))
        elif found := re.fullmatch(r"TOOL CALL S(\d+)", line):
            reader.speed = float(found[1])
        elif found := re.fullmatch(r"M(\d+)", line):
            code = int(found[1])
            turns = {3: 1, 4: -1, 5: 0}.get(code)
            reader.steps.append(("M", code) if turns is None else ("spindle", turns * reader.speed))
        elif line.startswith("CYCL DEF 200 DRILLING "):
            cycle = {int(q): float(value) for q, value in re.findall(rf"Q(\d+)=({NUMBER})", line)}
            if set(cycle) != {200, 201, 206, 202, 210, 203, 204, 211}:
                raise ValueError(line)
        elif found := re.fullmatch(rf"CYCL DEF 9\.1 DWELL ?({NUMBER})", line):
            reader.steps.append(("dwell", float(found[1])))
        else:
            raise ValueError(line)
    return reader.steps
