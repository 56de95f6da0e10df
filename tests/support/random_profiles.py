"""Random profiles of lathes with the cycles G70 to G72 of LinuxCNC about them."""

from __future__ import annotations

import math
from random import Random


def profile_program(seed: int) -> str:
    """Return a program with a profile in a sub-program, and one or two cycles."""
    return "\n".join(_Profile(Random(seed)).lines()) + "\n"


class _Profile:
    def __init__(self, random: Random) -> None:
        self._random = random
        self._x = random.choice((0.0, 4.0, 6.5))
        self._z = 0.0

    def lines(self) -> list[str]:
        chance = self._random.random
        lines = [
            "G61 G21 G18 F300",
            "G0 X30 Z5",
            "O5 SUB",
            f"{'G0' if chance() < 0.5 else 'G1'} X{self._x} Z0",
        ]
        lines += [self._move() for _ in range(self._random.randint(2, 7))]
        lines.append("O5 ENDSUB")
        for _ in range(self._random.randint(1, 2)):
            lines.append(self._cycle())
            if chance() < 0.3:
                lines.append("G0 X30 Z5")
        return [*lines, "M2"]

    def _move(self) -> str:
        chance, choice = self._random.random, self._random.choice
        z, x = -choice((0.0, 1.0, 2.0, 3.5, 5.0)), choice((0.0, 1.0, 2.5, 4.0, 3.0, 1.0, -1.0))
        if not z and not x:
            z = -2.0
        self._x, self._z = self._x + x, self._z + z
        end = f"X{self._x:.3f} Z{self._z:.3f}"
        if z and x and chance() < 0.35:
            long = math.hypot(x, z)
            center = f"R{long * choice((0.75, 1.0, 2.0)):.3f}"
            if abs(x) == abs(z) and chance() < 0.4:
                center = f"I{x:.3f} K0"
            move = f"{'G3' if chance() < 0.5 else 'G2'} {end} {center}"
        else:
            move = f"G1 {end}"
        return f"{move} {choice('AC')}{choice((0.2, 0.5))}" if chance() < 0.08 else move

    def _cycle(self) -> str:
        chance, choice = self._random.random, self._random.choice
        code = choice(("G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"))
        words = [code, "Q5"]
        if chance() < 0.8:
            words.append(f"X{choice((self._x + 3.0, self._x + 10.0, self._x + 1.0, 25.0)):.3f}")
            words.append(f"Z{choice((3.0, 1.0, 0.5))}")
        if chance() < 0.7:
            words.append(f"D{choice((0.0, 0.2, 0.5, 1.0, 1.5))}")
        if code == "G70":
            return " ".join(
                [*words, *((f"E{choice((0.0, 0.1))}", f"P{choice((1, 2, 3))}") if chance() < 0.5 else ())]
            )
        if chance() < 0.7:
            words.append(f"I{choice((1.0, 0.7, 2.0, 3.3))}")
        if chance() < 0.5:
            words.append(f"R{choice((0.3, 1.0, 0.0))}")
        return " ".join(words)
