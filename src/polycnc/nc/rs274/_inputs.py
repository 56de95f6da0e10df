"""M66: wait for an input, and tell in #5399 how it was.

Source: LinuxCNC G-code manual, "M66 Wait on Input", and what `rs274` refuses.
"""

from __future__ import annotations

from typing import TypeAlias

from polycnc.machine import Machine
from polycnc.nc.rs274._functions import NumberError

ANSWER = 5399
"""The parameter with the answer."""
TIMED_OUT = -1.0
_LONGEST_S = 1e7
_AT_ONCE, _RISE, _FALL, _HIGH, _LOW = range(5)
_LETTERS = frozenset("PELQ")
Asked: TypeAlias = tuple[str, int, float]
"""The point of the I/O image, how to wait for it, and how long (s)."""
Looking: TypeAlias = tuple[str, int, int, int]
"""The point, how to wait, the cycle in which the time is over, and what the point was when it was looked at last."""


def asked(machine: Machine, words: tuple[tuple[str, float], ...]) -> Asked:
    """Return what an M66 asks for.

    Raises:
        NumberError: its words do not go together, or there is no such input.
    """
    given = dict(words)
    if len(given) < len(words):
        raise NumberError("a letter twice beside M66", "Write P or E, L and Q once.")
    digital, analog = given.get("P"), given.get("E")
    if digital is None and analog is None:
        raise NumberError("M66 without an input", "Add P and a digital input, or E and an analog one.")
    if digital is not None and analog is not None:
        raise NumberError("M66 with two inputs", "Write P or E.")
    mode = _whole("L", given.get("L", 0.0))
    if mode > _LOW:
        raise NumberError(
            f"M66 L{mode}: no such way to wait", "L is 0 (not at all), 1 rise, 2 fall, 3 on, 4 off."
        )
    seconds = given.get("Q", 0.0)
    if mode != _AT_ONCE:
        if analog is not None:
            raise NumberError(f"M66 E with L{mode}: an analog input is read at once", "Leave L out.")
        if not 0.0 < seconds <= _LONGEST_S:
            raise NumberError(
                f"M66 L{mode} without a time", f"Add Q, in s, above 0 and up to {_LONGEST_S:g}."
            )
    return _point(machine, digital, analog), mode, seconds


def begun(machine: Machine, wait: Asked) -> Looking:
    """Return a wait that begins now: everything before it has been executed."""
    point, mode, seconds = wait
    return point, mode, machine.clock.cycles + machine.clock.cycles_for(seconds), machine.io[point]


def look(machine: Machine, wait: Looking, *, at_once: bool = False) -> Looking | float:
    """Look at the input; return the wait as it goes on, or its answer. With `at_once` time passes at once."""
    point, mode, last, before = wait
    now = machine.io[point]
    came = {
        _AT_ONCE: True,
        _RISE: before == 0 and now == 1,
        _FALL: before == 1 and now == 0,
        _HIGH: now == 1,
        _LOW: now == 0,
    }
    if came[mode]:
        return float(now)
    if at_once or machine.clock.cycles >= last:
        return TIMED_OUT
    return point, mode, last, now


def takes(letter: str) -> bool:
    """Tell whether a word beside M66 is its own."""
    return letter in _LETTERS


def _whole(letter: str, value: float) -> int:
    if not (value >= 0.0 and abs(value - round(value)) <= 0.0001):
        raise NumberError(f"M66 {letter}{value:g}: no whole number from 0 up", "Look at the expression.")
    return round(value)


def _point(machine: Machine, digital: float | None, analog: float | None) -> str:
    """Return the point of an input: the one that has the name of LinuxCNC's pin, else the one of this number."""
    io = machine.config.io
    letter, value, sort, size, address = (
        ("E", analog, "analog", io.input_words, "IW")
        if digital is None
        else ("P", digital, "digital", io.inputs, "I")
    )
    number = _whole(letter, value or 0.0)
    for name in (f"motion.{sort}-in-{number:02d}", f"{sort}-in-{number:02d}"):
        if io.points.get(name, "").rstrip("0123456789") == address:
            return name
    if number >= size:
        raise NumberError(
            f"M66 {letter}{number}: there are {size} such inputs",
            "Numbers start at 0; see [io] of the machine file.",
        )
    return f"{address}{number}"
