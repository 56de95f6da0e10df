"""Random valid part programs in the words that DIN 66025 and LinuxCNC have in common.

A program is made of numbers, not of text, so that it can be written at another scale as well. The maker
follows the position of the machine, because arcs must end on their circles.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from decimal import Decimal

import numpy as np

from polycnc.units import MM_PER_INCH

LINEAR, ROTARY = "XYZ", "ABC"
AXES = LINEAR + ROTARY
_PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
_CENTERS = {17: "IJ", 18: "KI", 19: "JK"}
_CYCLES = (73, 81, 82, 83, 85, 86, 89, 84)
_TOOLS = 6


@dataclass(frozen=True)
class Word:
    """An address and its number; `length` numbers grow with the scale of the program."""

    letter: str
    value: Decimal
    length: bool = False
    style: int = 0

    def text(self, scale: int) -> str:
        """Write the number in one of the ways in which programs write it."""
        value = self.value * scale if self.length else self.value
        plain = f"{value:f}"
        if "." in plain:
            plain = plain.rstrip("0").rstrip(".")
        sign, digits = ("-", plain[1:]) if plain.startswith("-") else ("", plain)
        match self.style:
            case 1 if not sign:
                sign = "+"
            case 2:
                digits = f"0{digits}"
            case 3 if self.letter not in "GMTLN":
                digits = f"{digits}00" if "." in digits else f"{digits}."
            case 4 if digits.startswith("0."):
                digits = digits[1:]
            case _:
                pass
        return f"{self.letter}{sign}{digits}"


@dataclass(frozen=True)
class Block:
    """One line: words in writing order, and how they are written."""

    words: tuple[Word, ...] = ()
    number: int = 0
    comment: str = ""
    skip: bool = False
    gap: str = " "
    small: bool = False

    def text(self, scale: int = 1) -> str:
        """Return the line."""
        parts = [f"N{self.number}"] if self.number else []
        parts += [word.text(scale) for word in self.words]
        line = self.gap.join(parts)
        line = line.lower() if self.small else line
        return ("/" if self.skip else "") + line + self.comment


@dataclass(frozen=True)
class Program:
    """The blocks of a program."""

    blocks: tuple[Block, ...]

    def text(self, scale: int = 1) -> str:
        """Return the program; lengths and feeds are `scale` times as large."""
        return "".join(f"{block.text(scale)}\n" for block in self.blocks)


def tool_table(most: int = 0) -> str:
    """Return a tool table for LinuxCNC: tools without length and radius."""
    return "".join(f"T{tool} P{tool} D0 Z0 ;\n" for tool in range(1, (most or _TOOLS) + 1))


def random_program(seed: int, size: int = 60) -> Program:
    """Make a valid program of about `size` blocks; the same seed makes the same program."""
    maker = _Maker(np.random.default_rng(seed))
    return maker.program(size)


def _decimal(value: float, digits: int) -> Decimal:
    return Decimal(f"{value:.{digits}f}")


def g(code: float) -> Word:
    """Return a G word."""
    return Word("G", Decimal(f"{code:g}"))


def m(code: int) -> Word:
    """Return an M word."""
    return Word("M", Decimal(code))


@dataclass
class _Maker:
    """Make blocks, and know what they do to position and modal state (machine mm and degree)."""

    rng: np.random.Generator
    blocks: list[Block] = field(default_factory=list)
    at: list[float] = field(default_factory=lambda: [0.0] * len(AXES))
    shift: list[float] = field(default_factory=lambda: [0.0] * len(AXES))
    unit: float = 1.0
    absolute: bool = True
    center_absolute: bool = False
    plane: int = 17
    retract: int = 98
    motion: int = -1
    inverse: bool = False
    per_revolution: bool = False
    feed_known: bool = False
    feed_unit: float = 1.0

    # -------------------------------------------------------------- the program

    def program(self, size: int) -> Program:
        kinds: list[tuple[float, Callable[[], None]]] = [
            (20, self.straight),
            (10, self.rapid),
            (12, self.arc),
            (3, self.circle),
            (2, self.select_plane),
            (2, self.units),
            (3, self.distance),
            (1, self.center_mode),
            (2, self.feed),
            (2, self.feed_mode),
            (2, self.dwell),
            (2, self.set_position),
            (1, self.clear_position),
            (1, self.work_offset),
            (1, self.machine_move),
            (1, self.reference),
            (4, self.auxiliary),
            (2, self.harmless),
            (2, self.remark),
            (4, self.cycles),
        ]
        weights = np.array([weight for weight, _ in kinds], float)
        self.put(g(21), g(90), g(17), g(94), g(98), g(91.1), g(40), g(49), g(80))
        self.put(self.f_word(), m(3), Word("S", Decimal(1000)))
        while len(self.blocks) < size:
            kinds[self.rng.choice(len(kinds), p=weights / weights.sum())][1]()
        self.put(m(int(self.rng.choice([2, 30]))))
        return Program(tuple(self.blocks))

    def put(self, *words: Word) -> None:
        """Append a block of these words, in some order and spelling."""
        rng = self.rng
        order = [words[i] for i in rng.permutation(len(words))] if rng.random() < 0.3 else list(words)
        styled = tuple(replace(word, style=int(rng.choice([0, 0, 0, 1, 2, 3, 4]))) for word in order)
        self.blocks.append(
            Block(
                styled,
                number=10 * len(self.blocks) + 10 if rng.random() < 0.3 else 0,
                comment=str(rng.choice(["", "", "", "", " (remark X5)", "; G0 Z99", "(a)"])),
                gap=str(rng.choice([" ", "", "\t", "  "])),
                small=bool(rng.random() < 0.2),
            )
        )

    def chance(self, part: float) -> bool:
        return bool(self.rng.random() < part)

    # -------------------------------------------------------------- numbers

    def length(self, letter: str, value_mm: float, digits: int = 3) -> Word:
        """Return a word for a length, rounded in program units."""
        return Word(letter, _decimal(value_mm / self.unit, digits), length=True)

    def axis_word(self, axis: int, to: float, digits: int = 3) -> Word:
        """Return the word that moves `axis` near machine position `to`, and go there."""
        base = self.shift[axis] if self.absolute else self.at[axis]
        if axis < 3:
            word = self.length(AXES[axis], to - base, digits)
            self.at[axis] = base + float(word.value) * self.unit
        else:
            word = Word(AXES[axis], _decimal(to - base, 3))
            self.at[axis] = base + float(word.value)
        return word

    def axis_words(self, most: int = 3) -> list[Word]:
        """Return words for some axes; rotary axes only beside linear ones, or alone outside inverse time."""
        axes = self.rng.permutation(3)[: self.rng.integers(1, most + 1)].tolist()
        if self.chance(0.15):
            rotary = [3 + i for i in self.rng.permutation(3)[: self.rng.integers(1, 3)].tolist()]
            # A number of degrees per minute that was programmed in the other unit would mean something else.
            alone = self.chance(0.3) and not self.inverse and self.feed_unit == self.unit
            axes = rotary if alone else axes + rotary
        return [self.axis_word(axis, float(self.rng.uniform(-200, 200))) for axis in axes]

    def f_word(self) -> Word:
        self.feed_known, self.feed_unit = True, self.unit
        if self.per_revolution:
            return self.length("F", float(self.rng.uniform(0.1, 3)), 3)
        return self.length("F", float(self.rng.uniform(50, 5000)), 1)

    def motion_word(self, motion: int) -> list[Word]:
        """Return the G word of a motion, which may be left out while it is in force."""
        words = [] if motion == self.motion and self.chance(0.7) else [g(motion)]
        self.motion = motion
        return words

    def feed_words(self) -> list[Word]:
        """Return what a feed move needs or may have of F."""
        if self.inverse:
            return [Word("F", _decimal(float(self.rng.uniform(0.5, 60)), 2))]
        return [self.f_word()] if not self.feed_known or self.chance(0.1) else []

    # -------------------------------------------------------------- motion

    def distance_words(self) -> list[Word]:
        """Return a distance word now and then, to be put in force before the axis words are made."""
        if not self.chance(0.1):
            return []
        self.absolute = self.chance(0.6)
        return [g(90 if self.absolute else 91)]

    def straight(self) -> None:
        words = [*self.distance_words(), *self.motion_word(1), *self.feed_words()]
        self.put(*words, *self.axis_words())

    def rapid(self) -> None:
        self.put(*self.distance_words(), *self.motion_word(0), *self.axis_words())

    def arc(self) -> None:
        rng = self.rng
        words = self.distance_words()
        p, q, r = _PLANES[self.plane]
        clockwise = self.chance(0.5)
        by_radius = self.chance(0.35)
        radius = float(10 ** rng.uniform(-0.3, 2.0))
        first = float(rng.uniform(-math.pi, math.pi))
        if by_radius:
            sweep = float(rng.choice([0.0, math.pi]) + rng.uniform(0.1, math.pi - 0.1))
        else:
            sweep = float(rng.uniform(0.05, 2.0 * math.pi - 0.05))
        last = first - sweep if clockwise else first + sweep
        start = list(self.at)
        words += [*self.motion_word(2 if clockwise else 3), *self.feed_words()]
        center = self.center_words(start, radius, first)
        middle = center[1]
        radius = math.dist((start[p], start[q]), middle)
        words += [
            self.axis_word(p, middle[0] + radius * math.cos(last), 6),
            self.axis_word(q, middle[1] + radius * math.sin(last), 6),
        ]
        if by_radius:
            words.append(self.length("R", radius if sweep < math.pi else -radius, 6))
        else:
            words += center[0]
        if self.chance(0.1):
            words.append(Word("P", Decimal(int(rng.integers(1, 4)))))
        if self.chance(0.3):
            words.append(self.axis_word(r, start[r] + float(rng.uniform(-20, 20))))
        if self.chance(0.05):
            words.append(self.axis_word(3, start[3] + float(rng.uniform(-90, 90))))
        self.put(*words)

    def center_words(
        self, start: list[float], radius: float, angle: float
    ) -> tuple[list[Word], tuple[float, float]]:
        """Return centre words, and the centre that they mean, so that `start` is seen from it at `angle`."""
        middle: list[float] = []
        words: list[Word] = []
        toward = (-radius * math.cos(angle), -radius * math.sin(angle))
        for letter, axis, way in zip(_CENTERS[self.plane], _PLANES[self.plane][:2], toward, strict=True):
            base = self.shift[axis] if self.center_absolute else start[axis]
            word = self.length(letter, start[axis] + way - base)
            words.append(word)
            middle.append(base + float(word.value) * self.unit)
        return words, (middle[0], middle[1])

    def circle(self) -> None:
        """Make a full circle: no end point in the plane, perhaps several turns, perhaps a helix."""
        words = [*self.motion_word(int(self.rng.choice([2, 3]))), *self.feed_words()]
        radius = float(10 ** self.rng.uniform(-0.3, 2.0))
        center, _ = self.center_words(self.at, radius, float(self.rng.uniform(-math.pi, math.pi)))
        words += center
        if self.chance(0.3):
            words.append(Word("P", Decimal(int(self.rng.integers(1, 5)))))
        if self.chance(0.3):
            axis = _PLANES[self.plane][2]
            words.append(self.axis_word(axis, self.at[axis] + float(self.rng.uniform(-20, 20))))
        self.put(*words)

    def machine_move(self) -> None:
        if not self.absolute:  # LinuxCNC refuses G53 with G91
            return
        axis = int(self.rng.integers(0, 3))
        words = [g(53)]
        if self.inverse or not self.feed_known or self.motion not in (0, 1):
            words.append(g(0))
            self.motion = 0
        elif self.chance(0.5):
            self.motion = int(self.rng.integers(0, 2))
            words.append(g(self.motion))
        word = self.length(AXES[axis], float(self.rng.uniform(-200, 200)))
        self.at[axis] = float(word.value) * self.unit
        self.put(*words, word)

    def reference(self) -> None:
        words = self.axis_words() if self.chance(0.5) else []
        for axis in range(len(AXES)):
            if not words or AXES[axis] in {word.letter for word in words}:
                self.at[axis] = 0.0
        self.put(g(28), *words)

    # -------------------------------------------------------------- modal words

    def select_plane(self) -> None:
        self.plane = int(self.rng.choice([17, 18, 19]))
        self.put(g(self.plane))

    def units(self) -> None:
        self.unit = float(self.rng.choice([1.0, MM_PER_INCH]))
        self.put(g(21 if self.unit == 1.0 else 20))

    def distance(self) -> None:
        self.absolute = not self.absolute
        self.put(g(90 if self.absolute else 91))

    def center_mode(self) -> None:
        self.center_absolute = not self.center_absolute
        self.put(g(90.1 if self.center_absolute else 91.1))

    def feed(self) -> None:
        if not self.inverse:
            self.put(self.f_word())

    def feed_mode(self) -> None:
        mode = int(self.rng.choice([93, 94, 95]))
        self.inverse, self.per_revolution = mode == 93, mode == 95
        if self.inverse:
            self.feed_known = False
            self.put(g(93))
        else:
            self.put(g(mode), self.f_word())

    def set_position(self) -> None:
        words = []
        for axis in self.rng.permutation(len(AXES))[: self.rng.integers(1, 4)].tolist():
            value = float(self.rng.uniform(-50, 50))
            word = self.length(AXES[axis], value) if axis < 3 else Word(AXES[axis], _decimal(value, 3))
            self.shift[axis] = self.at[axis] - float(word.value) * (self.unit if axis < 3 else 1.0)
            words.append(word)
        self.put(g(92), *words)

    def clear_position(self) -> None:
        self.shift = [0.0] * len(AXES)
        self.put(g(92.1))

    def work_offset(self) -> None:
        self.put(g(int(self.rng.integers(54, 60))))

    # -------------------------------------------------------------- all else

    def dwell(self) -> None:
        self.put(g(4), Word("P", _decimal(float(self.rng.uniform(0.01, 3)), 2)))

    def auxiliary(self) -> None:
        speed = Word("S", Decimal(int(self.rng.integers(100, 9000))))
        tool = Word("T", Decimal(int(self.rng.integers(1, _TOOLS + 1))))
        match int(self.rng.integers(0, 8)):
            case 0:
                self.put(m(3), speed)
            case 1:
                self.put(m(4), speed)
            case 2:
                self.put(speed)
            case 3:
                self.put(tool)
            case 4:  # a tool change leaves the spindle at rest in LinuxCNC
                self.put(tool, m(6))
                self.put(m(3), speed)
            case 5:
                self.put(m(int(self.rng.choice([7, 8, 9]))))
            case 6:
                self.put(m(int(self.rng.choice([0, 1]))))
            case _:
                self.put(m(5))
                self.put(m(4), speed)

    def harmless(self) -> None:
        code = float(self.rng.choice([40, 49, 61, 64, 43, 80]))
        words = [g(code)]
        if code == 80:
            self.motion = int(self.rng.choice([-1, 0] if self.inverse or not self.feed_known else [-1, 0, 1]))
            words += [g(self.motion)] if self.motion >= 0 else []
        elif code == 43:
            words.append(Word("H", Decimal(0)))
        self.put(*words)

    def remark(self) -> None:
        texts = ["", "(only a remark)", "; (another)", "  ", "N5", "( % )"]
        self.blocks.append(Block(comment=str(self.rng.choice(texts))))
        if self.chance(0.5):  # what is left out with block delete changes nothing that follows
            self.dwell()
            self.blocks[-1] = replace(self.blocks[-1], skip=True)

    # -------------------------------------------------------------- drilling

    def cycles(self) -> None:
        """Make a few holes with one cycle or with several, then cancel and go to a known place.

        Where LinuxCNC goes ways of its own (see docs/reference/drilling-cycles.md), it is not led there.
        """
        if self.inverse:
            return
        self.put(m(3), Word("S", Decimal(int(self.rng.integers(100, 9000)))))
        p, q, r = _PLANES[self.plane]
        code, level = 0, 50.0 if self.absolute else 0.0
        for _ in range(int(self.rng.integers(1, 5))):
            words, first = [], not code
            below = level <= self.at[r] if self.absolute else True
            if first or (below and self.chance(0.3)):
                code = int(self.rng.choice(_CYCLES if self.plane == 17 else _CYCLES[:-1]))
                level = float(self.rng.uniform(-50 if self.absolute else level - 5, level))
                words += [g(code), *self.cycle_words(code, r, level)]
            if code in (84, 89) and self.retract == 98:
                self.retract = 99
                words.append(g(99))
            elif code not in (84, 89) and self.chance(0.2):
                self.retract = int(self.rng.choice([98, 99])) if first else 99
                words.append(g(self.retract))
            if self.chance(0.2):
                words.append(Word("L", Decimal(int(self.rng.integers(1, 4)))))
            axes = [axis for axis in (p, q) if self.chance(0.7)] or [p]
            words += [self.length(AXES[axis], float(self.rng.uniform(-100, 100))) for axis in axes]
            if self.chance(0.2):
                words.append(self.f_word())
            self.put(*words)
        self.put(g(80))
        self.absolute, self.motion = True, 0
        self.put(
            g(90), g(0), *(self.axis_word(axis, float(self.rng.uniform(-200, 200))) for axis in range(3))
        )

    def cycle_words(self, code: int, drill: int, level: float) -> list[Word]:
        depth = float(self.rng.uniform(1, 20))
        if self.absolute:
            base = self.shift[drill]
            words = [self.length(AXES[drill], level - depth - base), self.length("R", level - base)]
        else:
            words = [self.length(AXES[drill], -depth), self.length("R", level)]
        if code in (73, 83):
            words.append(self.length("Q", float(self.rng.uniform(0.6, 12))))
        if code in (82, 84, 86, 89):
            words.append(Word("P", _decimal(float(self.rng.uniform(0.01, 2)), 2)))
        return words
