"""How numbers are written: a format like "X%.3f", turned into Python that writes a number without "-0.000".

Conversions are those of printf: %f with decimals, %d for whole numbers (rounded), %g for up to six digits that
count. Width, a leading 0 and + are possible. Exponents, which no control reads, are written out.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from decimal import Decimal
from typing import Literal

Zeros = Literal["keep", "trim", "point"]

_FORMAT = re.compile(r"([^%]*)%(\+?)(0?)([0-9]{0,2})(?:\.([0-9]))?([dfg])([^%]*)", re.DOTALL)


class FormatError(ValueError):
    """A format that cannot be used."""


@dataclass(frozen=True, slots=True)
class NumberFormat:
    """A format taken apart: text before and after the number, the conversion, and what is done to its end.

    `zeros`: "keep" all decimals, "trim" zeros at the end and then the point, "point": trim zeros but keep the point.
    """

    before: str
    conversion: str
    behind: str
    zeros: Zeros = "keep"
    scale: float = 1.0

    def steps(self, value: str, result: str, lead: str = "") -> list[str]:
        """Return Python lines that write the variable `value` into the variable `result`, with `lead` before.

        The lines use `plain` for exponents; the value must be finite.
        """
        number = value if self.scale == 1.0 else f"({value} * {self.scale!r})"
        before = (lead + self.before).replace("%", "%%")
        if self.conversion.endswith("g"):
            return [
                f"{result} = {self.conversion!r} % {number}",
                f"if 'e' in {result}: {result} = plain({result})",
                f"if {result} == {self._number(-0.0)!r}: {result} = {self._number(0.0)!r}",
                f"{result} = {lead + self.before!r} + {result} + {self.behind!r}",
            ]
        trims = {"keep": "", "trim": '.rstrip("0").rstrip(".")', "point": '.rstrip("0")'}[self.zeros]
        behind = self.behind
        if not trims:
            before, behind = f"{before}{self.conversion}{behind.replace('%', '%%')}", ""
        else:
            before = f"{before}{self.conversion}"
        tail = f" + {behind!r}" if behind else ""
        minus, zero = (lead + self.before + self._number(each) + self.behind for each in (-0.0, 0.0))
        return [
            f"{result} = ({before!r} % {number}){trims}{tail}",
            f"if {result} == {minus!r}: {result} = {zero!r}",
        ]

    def text(self, value: float) -> str:
        """Return a finite number as the format writes it."""
        scope: dict[str, object] = {"__builtins__": {}, "value": value, "plain": plain}
        exec("\n".join(self.steps("value", "result")), scope)
        return str(scope["result"])

    def _number(self, value: float) -> str:
        text = self.conversion % value
        if self.zeros != "keep":
            text = text.rstrip("0")
        return text.rstrip(".") if self.zeros == "trim" else text


def read_format(text: str, zeros: Zeros = "keep", scale: float = 1.0) -> NumberFormat:
    """Return the format that `text` spells.

    Raises:
        FormatError: It has not exactly one number, or trims decimals that it does not have.
    """
    found = _FORMAT.fullmatch(text)
    if found is None:
        raise FormatError(f"'{text}' is not a format with one number like %.3f, %d or %g")
    before, plus, pad, width, decimals, kind, behind = found.groups()
    if kind == "d":
        if decimals is not None:
            raise FormatError(f"'{text}' gives decimals to a whole number")
        decimals, kind = "0", "f"  # so that a number is rounded, not cut
    if zeros != "keep" and (kind != "f" or not int(decimals or 6)):
        raise FormatError(f"'{text}' has no decimals to trim; use it with %.3f and the like")
    if "\n" in text or "\r" in text:
        raise FormatError("a format has one line")
    point = "" if decimals is None else f".{decimals}"
    return NumberFormat(before, f"%{plus}{pad}{width}{point}{kind}", behind, zeros, scale)


def plain(text: str) -> str:
    """Return a number with an exponent written out."""
    return format(Decimal(text), "f")


def decimal(value: float) -> str:
    """Return a number with up to six decimals, as few as it needs."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
