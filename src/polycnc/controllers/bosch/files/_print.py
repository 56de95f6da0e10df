"""How PRN# and DSP put values into words: formats of # take the numbers after them (Manual 003, 6.3 and 7.3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from polycnc.nc.cpl import Fault, Item, default_format, groups, number_in, text_of


class Output(NamedTuple):
    """What a command puts out; `pieces` are the parts of it, `misfits` the formats into which a number did not fit."""

    pieces: tuple[str, ...]
    misfits: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Return it as one text."""
        return "".join(self.pieces)


def as_output(items: tuple[object, ...], *, left: bool = False) -> Output:
    """Return the output of a list of values; `left` suppresses blanks before numbers and zeros after them (LJUST).

    Every group of # in a text takes the next number further right that none has taken yet; one without a group is
    written as its type is. A number that does not fit becomes asterisks.

    Raises:
        Fault: A number has no value.
    """
    values = [each if isinstance(each, Item) else Item("S", text_of(each)) for each in items]
    numbers = [place for place, item in enumerate(values) if _is_number(item)]
    pieces: list[str] = []
    misfits: list[str] = []
    taken: set[int] = set()

    def formatted(place: int, group: str) -> str | None:
        wanted = next((number for number in numbers if number > place and number not in taken), None)
        if wanted is None:
            return None
        taken.add(wanted)
        text = number_in(group, _number(values[wanted]))
        if text is None:
            misfits.append(group)
            return "*" * len(group)
        return text.strip() if left else text

    for place, item in enumerate(values):
        if place in taken:
            continue
        if _is_number(item):
            pieces.append(_standard(item, left))
        elif isinstance(item.value, bool):
            pieces.append("TRUE" if item.value else "FALSE")
        else:
            pieces.append(_filled(text_of(item.value) or "", lambda group, at=place: formatted(at, group)))  # type: ignore[misc]
    return Output(tuple(pieces), tuple(misfits))


def _is_number(item: Item) -> bool:
    if item.kind in ("I", "R", "D"):
        return True
    return item.kind == "X" and isinstance(item.value, int | float) and not isinstance(item.value, bool)


def _number(item: Item) -> float:
    if not isinstance(item.value, int | float):
        raise Fault("INVALID VARIABLE", "a number to be put out has no value (NUL)")
    return item.value


def _standard(item: Item, left: bool) -> str:
    value = _number(item)
    kind = "I" if isinstance(value, int) else item.kind
    text = default_format(kind, value)
    if not left:
        return text
    text = text.strip()
    return text.rstrip("0").rstrip(".") if "." in text else text


def _filled(text: str, formatted: Callable[[str], str | None]) -> str:
    parts: list[str] = []
    end = 0
    for begin, stop in groups(text):
        group = text[begin:stop]
        parts += (text[end:begin], formatted(group) or group)
        end = stop
    return "".join((*parts, text[end:]))
