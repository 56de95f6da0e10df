# ruff: noqa: E501  (programs and numbers are longer than lines)
"""What fuzz targets share: seeded changes of texts and bytes, numbers at the edge, and cases with a time limit.

A case is made from a seed and nothing else, so that what failed can be repeated. It fails where it raises anything but
an error of polycnc, or lasts longer than its limit.
"""

from __future__ import annotations

import faulthandler
import random
import signal
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from polycnc.errors import PolycncError

LIMIT_S = 10.0
"""How much processor time a case may take; uncompiled, the slowest good ones take a tenth of that."""

NUMBERS = (
    "0", "-0", "1", "-1", ".", "-", "+", "..5", "0.000000000000001", "1e-300", "1E400", "-1e400", "1e20", "nan", "inf",
    "99999999", "2147483648", "-2147483649", "9223372036854775808", "4294967295.9999", "0x1F", "1_0", "٣", "½",
    "9" * 30, "9" * 400, "9" * 5000, "0." + "0" * 400 + "1", "1" + "0" * 20, "-.5", "+7.", "1/0", "#1", "[1]", "360", "1e308",
)  # fmt: skip
PIECES = (
    "\0", "\x1a", "\ufeff", "é", "ÿ", "\ud800", "\u202e", "𝟛", "\r", "\n\n", "\t", " ", "%", "(", ")", "((", "[", "]", "{", "}",
    '"', "'", "\\", "/", "//", ";", ":", ",", "=", "==", "*", "**", "<", ">", "$", "$$", "&", "@", "#", "!", "|", "~", "?",
    "N", "O1", "G1", "G2", "G41", "M98P1", "M99", "X", "IF", "WHILE", "GOTO", "END", "BEGIN", "REM", "1 ", "\n[[",
)  # fmt: skip
VALUES: tuple[Any, ...] = (
    None, True, False, 0, -0.0, 1, -1, 2, 3, 7, 255, 256, 32767, -32768, 65535, 65536, 2**31 - 1, 2**31, -(2**31) - 1, 2**32,
    2**63, -(2**63) - 1, 2**64, 2**2000, 1e-300, 5e-324, 1e300, -1e300, 1e20, 1e100, 0.1, -0.5, float("inf"), float("-inf"), float("nan"),
    "", "a", "\ud800", "\0", "é" * 40, "x" * 5000, b"", b"\xff\x00", [], [1, 2, 3], [None], (), (1e300,), {}, object(), 3 + 4j,
)  # fmt: skip


class TookTooLong(BaseException):
    """A case has lasted longer than its limit."""


class Failure(NamedTuple):
    """A case that failed: its seed, what it was made of, and what it raised."""

    target: str
    seed: int
    what: str
    shown: str


@dataclass(frozen=True)
class Target:
    """What is fuzzed: `case` makes the input from chance, `run` gives it to polycnc.

    `allowed` are the exceptions, besides those of polycnc, that say what the caller did wrong; `TookTooLong` is among
    them where a program may loop for ever: what matters then is that a signal ends it.
    """

    name: str
    case: Callable[[random.Random], Any]
    run: Callable[[Any], object]
    allowed: tuple[type[BaseException], ...] = ()
    weight: float = 1.0
    limit_s: float = LIMIT_S


def changed(chance: random.Random, text: str, changes: int = 3) -> str:
    """Return a text with some changes: numbers, pieces, lines; left out, repeated, put in, exchanged."""
    for _ in range(chance.randint(1, changes)):
        text = chance.choice(_CHANGES)(chance, text)
    return text[:200_000]


def _other_number(chance: random.Random, text: str) -> str:
    places = [k for k, each in enumerate(text) if each.isdigit()]
    if not places:
        return _put_in(chance, text)
    begin = end = chance.choice(places)
    while begin and (text[begin - 1].isdigit() or text[begin - 1] in ".-"):
        begin -= 1
    while end < len(text) and (text[end].isdigit() or text[end] == "."):
        end += 1
    return text[:begin] + chance.choice(NUMBERS) + text[end:]


def _put_in(chance: random.Random, text: str) -> str:
    at = chance.randint(0, len(text))
    return text[:at] + chance.choice(PIECES + NUMBERS) * chance.choice((1, 1, 1, 2, 40, 3000)) + text[at:]


def _leave_out(chance: random.Random, text: str) -> str:
    at = chance.randint(0, len(text))
    return text[:at] + text[at + chance.choice((1, 1, 2, 5, 40)) :]


def _repeat(chance: random.Random, text: str) -> str:
    at = chance.randint(0, len(text))
    end = at + chance.choice((1, 3, 10, 60))
    return text[:at] + text[at:end] * chance.choice((2, 3, 100)) + text[end:]


def _swap_lines(chance: random.Random, text: str) -> str:
    lines = text.split("\n")
    a, b = chance.randrange(len(lines)), chance.randrange(len(lines))
    lines[a], lines[b] = lines[b], lines[a]
    return "\n".join(lines)


def _drop_line(chance: random.Random, text: str) -> str:
    lines = text.split("\n")
    del lines[chance.randrange(len(lines))]
    return "\n".join(lines)


def _cut(chance: random.Random, text: str) -> str:
    return text[: chance.randint(0, len(text))]


def _other_letter(chance: random.Random, text: str) -> str:
    at = chance.randint(0, max(len(text) - 1, 0))
    return (
        text[:at] + chr(chance.choice((chance.randrange(32, 127), chance.randrange(0x250)))) + text[at + 1 :]
    )


_CHANGES = (
    _other_number, _other_number, _other_number, _put_in, _leave_out, _repeat, _swap_lines, _drop_line, _cut, _other_letter,
)  # fmt: skip


def changed_bytes(chance: random.Random, content: bytes) -> bytes:
    """Return bytes with some changes."""
    made = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        at = chance.randint(0, len(made))
        match chance.randrange(5):
            case 0 if made:
                made[min(at, len(made) - 1)] = chance.choice((0, 1, 0x7F, 0x80, 0xFF, chance.randrange(256)))
            case 1:
                del made[at : at + chance.choice((1, 2, 8, 100))]
            case 2:
                made[at:at] = chance.randbytes(chance.choice((1, 4, 64)))
            case 3:
                del made[at:]
            case _:
                made[at : at + 8] = chance.choice((0, 1, 2**31, 2**63 - 1, 2**64 - 1)).to_bytes(8, "little")
    return bytes(made)


def value_for(chance: random.Random, usual: tuple[Any, ...] = ()) -> Any:
    """Return something to pass: mostly usual, often at an edge."""
    return chance.choice(usual) if usual and chance.random() < 0.6 else chance.choice(VALUES)


def seed_of(campaign: int, number: int) -> int:
    """Return the seed of a case of a campaign."""
    return campaign * 1_000_003 + number


def _too_long(number: int, frame: object) -> None:
    raise TookTooLong


def failures(target: Target, seeds: Iterator[int]) -> Iterator[Failure]:
    """Run the cases of some seeds; yield those that fail.

    What does not even return to Python, or waits for ever, ends the process with a traceback some minutes later.
    """
    signal.signal(signal.SIGPROF, _too_long)
    for seed in seeds:
        case = target.case(random.Random(f"{target.name} {seed}"))
        faulthandler.dump_traceback_later(30 * LIMIT_S, exit=True)
        signal.setitimer(signal.ITIMER_PROF, target.limit_s)
        try:
            target.run(case)
        except (Exception, TookTooLong) as error:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            if isinstance(error, (PolycncError, *target.allowed)):
                continue
            yield Failure(target.name, seed, ascii(traceback.format_exc()[-3000:]), ascii(case)[:3000])
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            faulthandler.cancel_dump_traceback_later()
