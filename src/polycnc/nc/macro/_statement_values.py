"""The values that statements of custom macros take: numbers of variables, blocks, programs and alarms, each checked."""

from __future__ import annotations

from typing import NoReturn

from polycnc.nc.macro._functions import rounded
from polycnc.nc.macro._reader import LARGEST_LABEL
from polycnc.nc.macro._variables import MacroError, Value
from polycnc.nc.sources._block_source import WordsBlock
from polycnc.nc.text._scan_plain import Word

INTO_LOOP = "Jump out of loops or inside them, never into one."
_ALARM_BASE = 3000
_LARGEST_ALARM = 999


def nearest(value: float, increment: float) -> float:
    """Return the nearest multiple of an increment, as it would be written in decimal digits."""
    if abs(value) > 1e12:
        return value
    per_unit = round(1.0 / increment)
    return rounded(value * per_unit + (1e-9 if value >= 0.0 else -1e-9)) / per_unit


def number(value: float) -> int:
    """Return the number of a variable that was calculated.

    Raises:
        MacroError: There is none.
    """
    if not -0.5 < value < 1e6:
        raise MacroError(f"there is no variable #{value:g}", "See the table of variables.", "PS0115")
    return int(rounded(value))


def negative(value: Value) -> Value:
    """Return a value with its sign changed; a vacant one stays vacant."""
    return None if value is None else -value


def alarm(value: float, text: str) -> NoReturn:
    """Raise an alarm of the program (#3000).

    Raises:
        MacroError: Always.
    """
    if not 0 <= value <= _LARGEST_ALARM:
        raise MacroError(f"#3000={value:g}: alarms are numbered 0 to 999", "Write 0 to 999.", "PS0119")
    raise MacroError(
        text or f"macro alarm {int(value)}",
        "The program has raised this alarm.",
        f"MC{_ALARM_BASE + int(value)}",
    )


def stop(value: float, line: int, offset: int, text: str) -> WordsBlock:
    """Return the block at which a program stands with a message (#3006)."""
    return WordsBlock((Word("M", 0.0, offset, False),), line, offset, text or f"macro message {value:g}")


def label(value: float) -> int:
    """Return the number of a block that was calculated.

    Raises:
        MacroError: It is none.
    """
    if not 0 <= value <= LARGEST_LABEL:
        raise MacroError(f"{value:g} is no block number", "Check the value.", "PS0128")
    return int(rounded(value))


def into_loop(number: int) -> NoReturn:
    """Refuse a jump into a loop.

    Raises:
        MacroError: Always.
    """
    raise MacroError(f"block N{number} is inside a loop", INTO_LOOP, "PS0128")


def program_number(value: float) -> int:
    """Return the number of a program that was calculated.

    Raises:
        MacroError: It is none.
    """
    number = rounded(value)
    if not 0 < number <= LARGEST_LABEL:
        raise MacroError(f"{value:g} is no program number", "Check P.", "PS0076")
    return int(number)


def repetitions(value: float) -> int:
    """Return a number of repetitions that was calculated.

    Raises:
        MacroError: It is none.
    """
    number = rounded(value)
    if not 0 <= number <= 9999:
        raise MacroError(f"{value:g} is no number of repetitions", "Write L1 to L9999.", "PS0119")
    return int(number)
