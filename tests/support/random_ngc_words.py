"""Random blocks with the words that LinuxCNC has of its own: shifts, turned offsets, polar positions, tools, threads.

What stands in a block together with what came before is such that both can execute it: no polar position at zero or
outside G17, no L20 while a work offset turns, no arc outside the plane that turns. Where the work offset may turn
otherwise than before, X and Y are said anew: rs274 takes the shift of G92 for turned there, and the axes would jump.
"""

from __future__ import annotations

import random

_RESET = (
    "G80 G40 G49 G8 G21 G90 G91.1 G17 G94 G98 G54",
    "F6000",  # beside G21 rs274 still takes it for inches
    "G92.1",
    "G10 L2 P1 X0 Y0 Z0 R0",
    "G10 L2 P2 X0 Y0 Z0 R0",
    "G10 L2 P7 X0 Y0 Z0 R0",
    "M3 S600",
    "G0 X11 Y-6 Z9",
)
_SYSTEMS = {1: "G54", 2: "G55", 7: "G59.1"}


class RandomWords:
    """Write sequences of blocks; equal seeds write equal ones."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._turned: set[int] = set()
        self._system = 1
        self._plane = 17
        self._absolute = True

    def sequences(self, count: int) -> str:
        """Return a program of so many sequences, each of which begins with all modes set anew."""
        lines: list[str] = []
        for _ in range(count):
            lines += self._sequence()
        return "\n".join(lines)

    def _sequence(self) -> list[str]:
        self._turned.clear()
        self._system, self._plane, self._absolute = 1, 17, True
        kinds = (
            [self._move] * 4
            + [self._polar, self._circle, self._distance, self._shift, self._offset, self._select] * 2
            + [
                self._plane_word,
                self._units,
                self._tool,
                self._reference,
                self._thread,
                self._cycle,
                self._lathe,
            ]
        )
        return [*_RESET, *(self._random.choice(kinds)() for _ in range(self._random.randint(6, 12)))]

    def _number(self, size: float = 20.0) -> str:
        return f"{self._random.uniform(-size, size):.3f}"

    def _axes(self, least: int = 1, letters: str = "XYZ") -> str:
        chosen = self._random.sample(letters, self._random.randint(least, len(letters)))
        return " ".join(letter + self._number() for letter in chosen)

    def _move(self) -> str:
        code = self._random.choice(("G0", "G1"))
        if self._random.random() < 0.15:
            names = self._random.choice(("#<_x>", "#<_y>", "#5422", "#5420"))
            return f"{code} X[{names} / 2 + {self._number(3.0)}]"
        if self._random.random() < 0.1 and self._absolute:
            return f"G53 {code} {self._axes()}"
        return f"{code} {self._axes()}"

    def _polar(self) -> str:
        if self._plane != 17:
            return self._move()
        words = self._random.choice(("@{0}", "^{1}", "@{0} ^{1}", "@{0} ^{1} Z{0}"))
        return f"G{self._random.randint(0, 1)} " + words.format(self._number(), self._number(170.0))

    def _circle(self) -> str:
        letters = {17: "IJ", 18: "IK", 19: "JK"}[self._plane]
        if self._plane != 17 and self._system in self._turned:
            return self._move()
        return f"G{self._random.randint(2, 3)} " + " ".join(letter + self._number(9.0) for letter in letters)

    def _distance(self) -> str:
        self._absolute = self._random.random() < 0.6
        return "G90" if self._absolute else "G91"

    def _shift(self) -> str:
        return (
            self._random.choice(("G92 ", "G52 ")) + self._axes()
            if self._random.random() < 0.7
            else (self._random.choice(("G92.1", "G92.2", "G92.3")))
        )

    def _offset(self) -> str:
        number = self._random.choice(tuple(_SYSTEMS))
        if self._random.random() < 0.3 and not self._turned:
            return f"G10 L20 P{self._random.choice((0, number))} {self._axes()}"
        turn = ""
        if self._random.random() < 0.4 and self._plane == 17:
            self._turned.add(number)
            turn = f" R{self._number(180.0)}"
        return f"G10 L2 P{number} {self._axes()}{turn}{self._anew()}"

    def _select(self) -> str:
        self._system = self._random.choice(tuple(_SYSTEMS))
        return _SYSTEMS[self._system] + self._anew()

    def _anew(self) -> str:
        if not self._turned:
            return ""
        self._absolute = True
        return f"\nG90 G0 X{self._number()} Y{self._number()}"

    def _plane_word(self) -> str:
        self._plane = 17 if self._turned else self._random.choice((17, 18, 19))
        return f"G{self._plane}"

    def _units(self) -> str:
        return self._random.choice(("G20", "G21"))

    def _tool(self) -> str:
        kinds: tuple[str, ...] = (
            "G43.1 {0}",
            "G43 H{1}",
            "G43.2 H{1}",
            "G49",
            "T{1} M6\nM3\nG90 G0 X{2} Y{2} Z{2}",
            "G10 L1 P{1} Z{2} X{2}",
        )
        kinds += () if self._turned else ("G10 L10 P{1} Z{2}", "G10 L11 P{1} X{2}")
        kind = self._random.choice(kinds)
        self._absolute |= kind[0] == "T"  # rs274 alone does not know where the axes are behind M6
        return kind.format(self._axes(), self._random.randint(1, 3), self._number())

    def _reference(self) -> str:
        return self._random.choice(("G28.1", "G30.1", "G28", "G30"))

    def _thread(self) -> str:
        if self._random.random() < 0.6:
            code = self._random.choice(("G33", "G33.1"))
            return f"{code} {self._axes()} K{self._random.uniform(0.5, 2.0):.3f}"
        if self._turned:
            return self._move()
        words = f"Z{self._number()} I{self._random.choice((-1, 1)) * self._random.uniform(0.5, 2.0):.3f}"
        more = self._random.choice(("", " Q29.5", " R2 H1", " R1.5 Q-20"))
        return f"G76 P1.25 {words} J0.35 K1.1{more}"

    def _cycle(self) -> str:
        if self._plane != 17 or not self._absolute:
            return self._move()
        code = self._random.choice(("G81", "G82", "G83", "G85"))
        words = {"G82": " P0.1", "G83": " Q30"}.get(code, "")
        return f"G0 Z60\n{code} X{self._number()} Y{self._number()} Z-70 R50{words}\nG80"

    def _lathe(self) -> str:
        return self._random.choice(("G7", "G8"))
