"""Random programs of RS274/NGC: parameters, expressions, O-words of every kind, and moves that show their values.

A loop stands in another one only by a call, and there is no DO: rs274 leaves loops too early when others have run
within them, and a DO after its first round where anything was skipped before.
"""

from __future__ import annotations

import random

_BINARY = ("+", "-", "*", "/", "mod", "eq", "ne", "gt", "ge", "lt", "le", "and", "or", "xor")
_UNARY = ("abs", "fix", "fup", "round", "cos", "sin")
_NAMES = ("#1", "#2", "#31", "#<a>", "#<_g>", "#<Long Name>", "#[30+2]")


class RandomProgram:
    """Write one program; equal seeds write equal ones."""

    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._number = 100
        self._loops: list[int] = []
        self._subs = 0
        self._in_sub = False
        self.lines: list[str] = []

    def text(self) -> str:
        """Return the program."""
        for number in range(self._random.randint(0, 3)):
            self._sub(number)
        self.lines += ["G21 G90 G17 F1000", "G0 X0 Y0 Z0"]
        self._set_all()
        self._statements(self._random.randint(3, 8), 3)
        self.lines += ["M2", ""]
        return "\n".join(self.lines)

    def _set_all(self) -> None:
        self.lines += [f"{name}={self._random.randint(-9, 9)}" for name in _NAMES]

    def _sub(self, number: int) -> None:
        self.lines.append(f"o<sub{number}> sub")
        self._in_sub = True
        self.lines += [f"#<a>={self._random.randint(1, 5)}", "#<longname>=#1"]
        self._statements(self._random.randint(1, 4), 2)
        self._in_sub = False
        value = f" [{self._expression(1)}]" if self._random.random() < 0.6 else ""
        self.lines.append(f"o<sub{number}> endsub{value}")
        self._subs = number + 1

    def _statements(self, count: int, depth: int) -> None:
        kinds = [self._assign, self._assign, self._move, self._call, self._leave, self._two]
        for _ in range(count):
            if depth and self._random.random() < 0.45:
                kinds_of_blocks = [self._if]
                if not self._loops:
                    kinds_of_blocks += [self._while, self._repeat]
                self._random.choice(kinds_of_blocks)(depth - 1)
            else:
                self._random.choice(kinds)()

    def _label(self) -> int:
        self._number += 1
        return self._number

    # ------------------------------------------------------------------ statements

    def _assign(self) -> None:
        name = self._random.choice(_NAMES)
        self.lines.append(f"{name} = [[{self._expression(2)}] mod 97]")

    def _two(self) -> None:
        self.lines.append(f"#1=[#2+{self._random.randint(1, 4)}] #2=#1 G1 X#1 Y#2")

    def _move(self) -> None:
        words = [f"{letter}[[{self._expression(1)}] mod 100]" for letter in self._random.sample("XYZ", 2)]
        self.lines.append(self._random.choice(("", "N5 ")) + "G1 " + " ".join(words))

    def _call(self) -> None:
        if not self._subs:
            return self._move()
        given = " ".join(f"[{self._expression(1)}]" for _ in range(self._random.randint(0, 3)))
        number = self._random.randrange(self._subs)
        self.lines += [f"o<sub{number}> call {given}", "G1 X[#<_value> mod 100] Y[#<_value_returned>]"]
        return None

    def _leave(self) -> None:
        if self._loops and self._loops[-1]:  # rs274 loses its way where a REPEAT is left
            label, number = self._loops[-1], self._label()
            word = self._random.choice(("break", "continue"))
            self.lines += [
                f"o{number} if [{self._expression(1)} gt 3]",
                f"o{label} {word}",
                f"o{number} endif",
            ]

    def _if(self, depth: int) -> None:
        label = self._label()
        self.lines.append(f"o{label} if [{self._expression(2)}]")
        self._statements(1, depth)
        if not self._loops and self._random.random() < 0.5:
            self.lines.append(f"O{label} ELSEIF [{self._expression(1)}]")
            self._statements(1, depth)
        if self._random.random() < 0.5:
            self.lines.append(f"o{label} else")
            self._statements(1, depth)
        self.lines.append(f"o{label} endif")

    def _while(self, depth: int) -> None:
        label = self._label()
        self.lines += [f"#{label}=0", f"o{label} while [#{label} lt {self._random.randint(1, 4)}]"]
        self.lines.append(f"#{label}=[#{label}+1]")
        self._inside(label, depth)
        self.lines.append(f"o{label} endwhile")

    def _repeat(self, depth: int) -> None:
        label = self._label()
        self.lines.append(f"o{label} repeat [{self._random.randint(0, 3)}]")
        self._inside(0, depth)
        self.lines.append(f"o{label} endrepeat")

    def _inside(self, label: int, depth: int) -> None:
        self._loops.append(label)  # 0 for one that rs274 does not leave as it should
        self._statements(self._random.randint(1, 3), depth)
        self._loops.pop()

    # ------------------------------------------------------------------ expressions

    def _operand(self) -> str:
        kind = self._random.random()
        if kind < 0.5:
            return self._random.choice(_NAMES)
        if kind < 0.6:
            return self._random.choice(
                ("#5420", "#5421", "#<_x>", "#<_metric>", "EXISTS[#<a>]", "EXISTS[#<none>]")
            )
        return f"{self._random.choice((0, 1, 2, 2.5, 3, -4, 0.75, 7))}"

    def _expression(self, depth: int) -> str:
        if depth == 0 or self._random.random() < 0.2:
            return self._operand()
        kind = self._random.random()
        if kind < 0.15:
            return f"{self._random.choice(_UNARY)}[{self._expression(depth - 1)}]"
        if kind < 0.2:
            return f"atan[{self._operand()}]/[{self._random.choice((1, 2, 3))}]"
        if kind < 0.25:
            return f"-[{self._expression(depth - 1)}]"
        if kind < 0.3:
            return f"{self._operand()}**{self._random.choice((2, 3))}"
        operator = self._random.choice(_BINARY)
        right = self._expression(depth - 1)
        if operator in ("/", "mod"):
            right = f"[abs[{right}]+1]"
        return f"{self._expression(depth - 1)} {operator} {right}"
