"""What calls a macro besides G65, and the addresses that become its local variables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from polycnc.language import Flaw
from polycnc.nc.macro._syntax import Address
from polycnc.nc.macro._variables import Value

ARGUMENTS_I: Mapping[str, int] = {
    "A": 1, "B": 2, "C": 3, "D": 7, "E": 8, "F": 9, "H": 11, "I": 4, "J": 5, "K": 6, "M": 13, "Q": 17, "R": 18,
    "S": 19, "T": 20, "U": 21, "V": 22, "W": 23, "X": 24, "Y": 25, "Z": 26,
}  # fmt: skip
"""Local variables of the addresses in the first form of arguments."""

ARGUMENTS_EACH: Mapping[str, int] = {**ARGUMENTS_I, "G": 10, "L": 12, "N": 14, "P": 16}
"""Local variables of all words of a block that becomes a call, by G66.1."""

_FIRST_REPEATED = 4
"""In the second form I, J and K repeat up to ten times: I1 J1 K1 are #4 #5 #6, I2 J2 K2 are #7 #8 #9, ..."""
_MOST_REPEATS = 10
_ABC: Mapping[str, int] = {"A": 1, "B": 2, "C": 3}
_IJK = "IJK"


@dataclass(frozen=True, slots=True)
class MacroCalls:
    """Say which codes call a program instead of doing what they do; FANUC parameters in parentheses.

    `g` are G codes that call a macro with arguments (6050 to 6059: O9010 to O9019), `m` the same for M codes (6080 to
    6089: O9020 to O9029), `m_sub` M codes that call a sub-program without arguments (6071 to 6079: O9001 to O9009),
    `t` is the sub-program that T calls with its number in #149 (6001#5: O9000). Inside a program that was called so,
    the codes are ordinary ones.
    """

    g: Mapping[float, int] = field(default_factory=dict)
    m: Mapping[int, int] = field(default_factory=dict)
    m_sub: Mapping[int, int] = field(default_factory=dict)
    t: int | None = None

    def __bool__(self) -> bool:
        return bool(self.g or self.m or self.m_sub or self.t)


@dataclass(frozen=True, slots=True)
class Arguments:
    """What a program is called with: local variables, None to share those of the caller.

    `modal` is a call after a move, by G66, or in place of a block, by G66.1; `by_code` one by a G, M or T code;
    `interrupt` one by the interrupt signal.
    """

    values: Mapping[int, Value] | None
    modal: bool = False
    by_code: bool = False
    interrupt: bool = False


def argument_numbers(arguments: list[Address] | tuple[Address, ...]) -> list[int]:
    """Return the local variable of each argument.

    I, J and K of which one repeats are the second form; a number given twice counts last.

    Raises:
        Flaw: An address that has no local variable, more repetitions than there are variables.
    """
    numbers = []
    seen: set[str] = set()
    row, last = 0, -1
    repeated = _repeats(arguments)
    for word in arguments:
        letter = word.letter
        if letter not in ARGUMENTS_I:
            raise Flaw(
                word.at,
                f"{letter} cannot be an argument of a macro",
                "G, L, N, O and P have no local variable.",
                code="PS0129" if letter == "G" else "PS0119",
            )
        if repeated and letter in _IJK:
            place = _IJK.index(letter)
            if place <= last:
                row += 1
            last = place
            if row >= _MOST_REPEATS:
                raise Flaw(
                    word.at, f"{letter} for the 11th time", "I, J and K repeat up to 10 times.", code="PS0129"
                )
            numbers.append(_FIRST_REPEATED + 3 * row + place)
            continue
        if letter in seen:
            raise Flaw(word.at, f"the argument {letter} is given twice", "Write it once.", code="PS0129")
        seen.add(letter)
        numbers.append(_ABC.get(letter, ARGUMENTS_I[letter]))
    return numbers


def _repeats(arguments: list[Address] | tuple[Address, ...]) -> bool:
    letters = [word.letter for word in arguments if word.letter in _IJK]
    return len(set(letters)) < len(letters)
