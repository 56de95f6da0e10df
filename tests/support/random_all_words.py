"""Random blocks with all words of LinuxCNC's language, those that it refuses too, in sequences tagged for an oracle.

Each block ends with a comment that names its sequence and its place in it, so that what an interpreter prints for many
sequences in one process can be told apart. A sequence begins with all modes, offsets and tools set anew.
"""

from __future__ import annotations

import random
import re
from collections.abc import Callable

RESET = (
    "G40",  # which may refuse the last move of the sequence before
    "G40",
    "G80 G40 G49 G8 G21 G90 G91.1 G17 G94 G97 G98 G54 G61",
    "F6000 S0 M5 M9",  # beside G21 rs274 still takes F for inches
    "G92.1",
    *(f"G10 L2 P{number} X0 Y0 Z0 A0 B0 C0 R0" for number in (1, 2, 7, 9)),
    "G10 L1 P1 X0 Y0 Z10 R3 Q0",
    "G10 L1 P2 X1 Y0 Z20 R4 Q0",
    "G10 L1 P3 X2 Y0 Z30 R2 Q3",
    "T1 M6",
    "M71",
    "M3 S600",
    "G53 G0 X0 Y0 Z0 A0 B0 C0",
    "G28.1",
    "G30.1",
    "#1=3 #2=-4.5 #31=7",
    "G0 X11 Y-6 Z9 A5",
)
FRESH = ("G61 G98 F6000", "T1 M6", "M3 S600", "#1=3 #2=-4.5 #31=7", RESET[-1])
"""What a sequence begins with where it is a program of its own."""
TOOLS = (1, 2, 3)
_SYSTEMS = {1: "G54", 2: "G55", 7: "G59.1", 9: "G59.3"}
_SHOWN = (
    *(
        "_x",
        "_y",
        "_z",
        "_a",
        "_abs_x",
        "_abs_y",
        "_abs_z",
        "_feed",
        "_rpm",
        "_current_tool",
        "_selected_tool",
    ),
    *(
        "_metric",
        "_absolute",
        "_incremental",
        "_plane",
        "_motion_mode",
        "_coord_system",
        "_ccomp",
        "_inverse_time",
    ),
    *("_units_per_minute", "_units_per_rev", "_tool_offset", "_retract_r_plane", "_retract_old_z"),
    *(
        "_spindle_rpm_mode",
        "_spindle_css_mode",
        "_ijk_absolute_mode",
        "_lathe_diameter_mode",
        "_lathe_radius_mode",
    ),
    *("_spindle_on", "_spindle_cw", "_mist", "_flood", "_imperial"),
)
_NUMBERED = (
    *(
        5161,
        5162,
        5163,
        5181,
        5182,
        5210,
        5211,
        5212,
        5213,
        5214,
        5220,
        5221,
        5222,
        5223,
        5230,
        5241,
        5341,
        5381,
    ),
    *(5400, 5401, 5403, 5410, 5413, 5420, 5421, 5422, 5423),
)
_STRAY = "ABCDEGHIJKLPQRSTUVWXYZ@^"
_CODES = (
    *(
        0,
        1,
        2,
        3,
        4,
        7,
        8,
        10,
        17,
        18,
        19,
        20,
        21,
        28,
        30,
        40,
        41,
        42,
        43,
        49,
        52,
        53,
        54,
        55,
        61,
        73,
        76,
        80,
        81,
    ),
    *(82, 83, 85, 86, 89, 90, 91, 92, 93, 94, 95, 96, 97, 98, 99, 33),
    *(28.1, 30.1, 33.1, 41.1, 42.1, 43.1, 43.2, 59.1, 59.3, 61.1, 90.1, 91.1, 92.1, 92.2, 92.3),
)
_M_CODES = (3, 4, 5, 6, 7, 8, 9, 19, 48, 49, 50, 51, 52, 53, 61, 62, 63, 64, 65, 67, 68, 70, 71, 72, 73)


_ANY_WORD = re.compile(r"\^|G(10|28|30|33|92|4[123](\.[12])?)\b|M6[1-8]|M19|M7[0-3]")
"""Codes beside which LinuxCNC takes words that nothing uses."""


class AllWords:
    """Write sequences of blocks; equal seeds write equal ones."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._plane, self._cycling, self._turned, self._shifted = 17, False, False, False
        self._compensated = self._has_offset = self._inch = False

    def sequence(self) -> list[str]:
        """Return the blocks of one sequence, without tags: the reset and what follows it."""
        self._plane, self._cycling, self._turned, self._shifted = 17, False, False, False
        self._compensated = self._has_offset = self._inch = False
        blocks = [line for _ in range(self._random.randint(5, 11)) for line in self._block().split("\n")]
        return [*RESET, *blocks]

    def _block(self) -> str:
        draw = self._random.random()
        if draw < 0.02:
            return self._anything()
        words = self._choice(
            (self._move, 8),
            (self._arc, 3),
            (self._polar, 1),
            (self._cycle, 4),
            (self._cycle_goes_on, 2),
            (self._modes, 5),
            (self._shift, 3),
            (self._offset, 2),
            (self._tool, 4),
            (self._reference, 1),
            (self._compensation, 2),
            (self._thread, 1),
            (self._spindle, 2),
            (self._function, 2),
            (self._dwell, 1),
            (self._shown, 3),
            (self._assignment, 1),
        )()
        if "\n" in words:
            return words
        parts = words.split()
        if self._random.random() < 0.2 and "=" not in words:
            self._random.shuffle(parts)  # the order of words in a block says nothing
        if self._random.random() < 0.06 and not _ANY_WORD.search(words):
            stray = self._stray()
            if not (
                stray[0] == "F" and {"G20", "G21"} & set(parts)
            ):  # F counts in the units before for rs274
                parts.append(stray)
        number = f"N{self._random.randint(1, 9999)} " if self._random.random() < 0.1 else ""
        return number + " ".join(parts)

    def _choice(self, *weighted: tuple[Callable[[], str], int]) -> Callable[[], str]:
        return self._random.choices([kind for kind, _ in weighted], [weight for _, weight in weighted])[0]

    def _of(self, *texts: str) -> str:
        return self._random.choice(texts)

    def _number(self, size: float = 20.0) -> str:
        return f"{self._random.uniform(-size, size):.3f}"

    def _positive(self, least: float, most: float) -> str:
        return f"{self._random.uniform(least, most):.3f}"

    def _axes(self, letters: str = "XYZ", least: int = 1) -> str:
        chosen = self._random.sample(letters, self._random.randint(least, len(letters)))
        return " ".join(letter + self._number() for letter in chosen)

    def _plane_axes(self) -> tuple[str, str, str]:
        return {17: ("XY", "IJ", "Z"), 18: ("XZ", "IK", "Y"), 19: ("YZ", "JK", "X")}[self._plane]

    def _some(self, chance: float, text: str) -> str:
        return f" {text}" if self._random.random() < chance else ""

    def _stray(self) -> str:
        if self._random.random() < 0.5:
            return self._of(
                "F900", "F70", "S400", "S0", "M3", "M4", "M5", "M8", "M9", "M7", "T2", "G90", "G91"
            )
        return self._random.choice(_STRAY) + self._of("0", "1", "2", "3.5", "-4.5")

    def _anything(self) -> str:
        words = [f"G{code:g}" for code in self._random.sample(_CODES, self._random.randint(0, 2))]
        words += [f"M{code}" for code in self._random.sample(_M_CODES, self._random.choice((0, 0, 1)))]
        words += [
            letter + self._of("0", "1", "2", "3", "-1.5", "7.25", "-12.5")
            for letter in self._random.sample("XYZABCDEHIJKLPQRST@^", self._random.randint(0, 4))
        ]
        block = " ".join(words)
        moved = "M6" in words  # where rs274 is after that is not known
        return "G80" if not block or moved or _ANY_WORD.search(block) else block

    def _move(self) -> str:
        code = self._of("G0 ", "G1 ", "G1 ", "", "G53 G0 ", "G53 G1 ")
        return (
            code
            + self._axes("XYZ" if self._compensated or self._random.random() < 0.8 else "XYZABC")
            + self._some(0.15, "F" + self._positive(50, 900))
        )

    def _arc(self) -> str:
        axes, centre, third = self._plane_axes()
        code = self._of("G2 ", "G3 ", "G2 ", "G3 ", "")
        turns = self._some(0.15, f"P{self._random.randint(1, 3)}")
        helix = self._some(0.3, third + self._number())
        if self._random.random() < 0.5:
            ends = " ".join(letter + self._number() for letter in axes)
            return f"{code}{ends} R{self._of('', '-')}{self._positive(30, 90)}{helix}{turns}"
        return code + " ".join(letter + self._number(9.0) for letter in centre) + helix + turns

    def _polar(self) -> str:
        words = self._of("@{0}", "^{1}", "@{0} ^{1}", "@{0} ^{1} Z{0}")
        return self._of("G0 ", "G1 ") + words.format(self._positive(1, 20), self._number(170.0))

    def _cycle(self) -> str:
        code = self._of("73", "81", "82", "83", "85", "86", "89", "84" if self._plane == 17 else "81", "81")
        axes, _, third = self._plane_axes()
        self._cycling = True
        words = {
            "73": " Q7",
            "82": " P0.1",
            "83": f" Q{self._positive(9, 30)}",
            "86": " P0.2",
            "84": " P0.4",
            "89": " P0.3",
        }.get(code, "")
        where = self._axes(axes)
        depth = self._of(f"{third}-70 R50", f"{third}-30 R-4", f"{third}{self._number()} R{self._number(30)}")
        return f"G{code} {where} {depth}{words}{self._some(0.2, 'L' + self._of('1', '2', '3'))}"

    def _cycle_goes_on(self) -> str:
        axes, _, third = self._plane_axes()
        return (
            self._axes(axes)
            + self._some(0.3, third + self._number(60))
            + self._some(0.3, "R" + self._number(60))
            + self._some(0.1, "Q5")
            + self._some(0.1, "P0.4")
        )

    def _modes(self) -> str:
        groups: tuple[tuple[str, ...], ...] = (
            ("G17", "G18", "G19"),
            ("G21",) if self._has_offset else ("G20", "G21"),
            ("G90", "G91"),
            ("G90.1", "G91.1"),
            ("G93 F7", "G94 F900", "G95 F3"),
            ("G98", "G99"),
            ("G61", "G61.1"),
            ("G80",) if self._turned else ("G54", "G55", "G59.1", "G59.3"),
            ("G7", "G8"),
            ("G97 S500", "G96 S90", "G96 D800 S70"),
            ("G80",),
        )
        if self._cycling:
            return self._end()
        words = [
            self._random.choice(group)
            for group in self._random.sample(groups, self._random.choice((1, 1, 2, 3)))
        ]
        if self._compensated:  # rs274 takes the end of the move before for one in the new units
            words = [word for word in words if word not in ("G20", "G21")] or ["G80"]
        self._inch |= "G20" in words  # rs274 mixes up units of tool offsets after it
        for word in words:
            if word in groups[0]:
                self._plane = int(word[1:])
        if {"G20", "G21"} & set(words) and "F" in " ".join(words):
            words = words[:1]  # F counts in the units before for rs274
        return " ".join(words)

    def _shift(self) -> str:
        if self._cycling or self._turned:
            return self._end()
        self._shifted = True
        return (
            self._of("G92 ", "G52 ", "G92 ") + self._axes("XYZ" if self._random.random() < 0.8 else "XYZAC")
            if (self._random.random() < 0.7)
            else self._of("G92.1", "G92.2", "G92.3")
        )

    def _end(self) -> str:
        """End a cycle: rs274 takes the level that it began at for one in the coordinates in force by then."""
        self._cycling = False
        return "G80"

    def _offset(self) -> str:
        if self._cycling or self._turned:
            return self._end()
        number = self._random.choice((0, *_SYSTEMS))
        if self._random.random() < 0.4:
            return f"G10 L20 P{number} {self._axes('XYZA')}"
        return f"G10 L2 P{number} {self._axes('XYZC')}{self._turn()}{self._anew()}"

    def _anew(self) -> str:
        return f"\nG90 G40 G0 X{self._number()} Y{self._number()}" if self._turned else ""

    def _turn(self) -> str:
        if self._shifted or self._random.random() < 0.7:
            return ""
        self._turned = True  # rs274 takes the shift of G92 for turned where the turn changes
        return " R" + self._number(180.0)

    def _tool(self) -> str:
        if self._cycling or self._turned or self._inch:
            return self._end()
        number = self._random.choice(TOOLS)
        anew = "G90 G40 G0 " + " ".join(
            letter + self._number() for letter in "XYZABC"
        )  # where rs274 is after M6
        self._has_offset = True
        return self._of(
            f"G43.1 {self._axes()}",
            "G43",
            f"G43 H{number}",
            f"G43.2 H{number}",
            "G49",
            f"T{number} M6\n{anew}",
            f"M6\n{anew}",
            f"T{number}",
            f"G10 L1 P{number} {self._axes('XZ')}{self._some(0.3, 'R' + self._positive(1, 5))}",
            f"G10 L10 P{number} {self._axes('XZ')}",
            f"G10 L11 P{number} {self._axes('XZ')}",
        )

    def _reference(self) -> str:
        return self._of(
            "G28.1", "G30.1", "G21 G28", "G21 G30", f"G21 G28 {self._axes()}", f"G21 G30 {self._axes()}"
        )

    def _compensation(self) -> str:
        self._compensated = True
        return self._of(
            f"G41.1 D{self._positive(1, 4)} G1 {self._axes()}",
            f"G42.1 D{self._positive(1, 4)}",
            "G41 D1",
            "G42",
            "G40",
            f"G40 G1 {self._axes()}",
            f"G40 G0 {self._axes()}",
            "G40",
        )

    def _thread(self) -> str:
        if self._random.random() < 0.6:
            return f"G97 S500 {self._of('G33', 'G33.1')} {self._axes()} K{self._positive(0.5, 2)}"
        more = self._of("", " Q29.5", " R2 H1", " R1.5 Q-20", " E0.5 L3")
        lift = self._of("", "-") + self._positive(0.5, 2)
        return f"G97 S500 G76 P1.25 Z{self._number()} I{lift} J0.35 K1.1{more}"

    def _spindle(self) -> str:
        return self._of("M3 S700", "M4 S300", "M5", "S250", "M3", "M4", "M19 R30", "M5 S90", "S0")

    def _function(self) -> str:
        number = self._random.randint(0, 3)
        return self._of(
            *(
                "M7",
                "M8",
                "M9",
                "M7 M8",
                "M48",
                "M49",
                "M50 P0",
                "M51 P1",
                "M52 P0",
                "M53 P1",
                "M70",
                "M71",
                "M72",
                "M73",
            ),
            *(
                f"M62 P{number}",
                f"M63 P{number}",
                f"M64 P{number}",
                f"M65 P{number}",
                f"M67 E{number} Q3.5",
                f"M68 E{number} Q-2",
            ),
            *("M0", "M1", "M60"),
        )

    def _dwell(self) -> str:
        return f"G4 P{self._positive(0, 3)}"

    def _shown(self) -> str:
        """Show values by a move to them."""
        names = [name for name in _SHOWN if "abs" not in name or not self._compensated]
        values = [
            f"#<{self._random.choice(names)}>"
            if self._compensated or self._random.random() < 0.6
            else f"#{self._random.choice(_NUMBERED)}"
            for _ in range(2)
        ]
        return f"{self._of('G0', 'G1')} X[{values[0]}] Y[{values[1]}/3]".replace(" /", "/")

    def _assignment(self) -> str:
        return self._of(
            f"#1=[#2+{self._positive(1, 4)}]",
            f"#5221={self._number()}",
            f"#5222={self._number()}",
            "#31=#5420 X#31",
            f"#5161={self._number()}",
            f"G1 X#1 Y#2 #1={self._number()}",
        )


def tagged(sequences: list[list[str]]) -> str:
    """Return one program of sequences whose blocks carry a comment with their numbers."""
    return "\n".join(
        f"{block} ({number}.{place})"
        for number, blocks in enumerate(sequences)
        for place, block in enumerate(blocks)
    )
