"""NC blocks with single CPL variables stay text; they mean what the same blocks do as statements."""

from __future__ import annotations

import random

import pytest

from polycnc.nc import Channel
from polycnc.nc.cpl import CplLanguage
from support.cpl_host import RecordingHost
from support.programs import FIVE, listing, prepare

_NAMES = ("A", "B%", "C!", "#G", "#K%")


def program(chance: random.Random) -> str:
    """Return random blocks, assignments and loops; variables stand in brackets without blanks."""
    found = ["N1 G1 G90 F700.", "2 A=1.5: B%=3: C!=-2.25: #G=4.125: #K%=712"]
    for line in range(10, 50):
        kind = chance.randrange(12)
        name = chance.choice(_NAMES)
        if kind == 0:
            found.append(
                f"{line} {name}={chance.choice(('NUL', '7', '2')) if chance.random() < 0.2 else '3'}"
            )
        elif kind == 1:
            found += [f"{line} FOR I%=1 TO 3", _block(chance), f"{line} NEXT I%"]
        elif kind == 2:
            found.append(chance.choice(("G91", "G90", "M8", "N7 G0 X1.5", "X2.5 (A [B] REMARK)")))
        else:
            found.append(_block(chance))
    return "\n".join([*found, "M30", ""])


def _block(chance: random.Random) -> str:
    words = [chance.choice(("", "N20 ", "G1 ", "G0 "))]
    for letter in chance.sample("XYZ", chance.randrange(1, 4)):
        if chance.random() < 0.6:
            words.append(f"{letter}[{chance.choice(_NAMES)}] ")
        else:
            words.append(f"{letter}{chance.uniform(1, 20):.3f} ")
    return "".join((*words, chance.choice(("", "F[#K%]"))))


def prepared(text: str) -> tuple[Channel, list[object]]:
    """Return a channel that has prepared a program, and what it made of every block."""
    language = CplLanguage(RecordingHost({}, {"main.cpl": text}))
    channel = prepare(text, config=FIVE, dialect="bosch", language=language)
    state = channel.machine.state
    tags = [int(state.seg.row[k]["tag"]) for k in range(int(state.paths.row[0]["tail"]))]
    records = [channel.records.block(tag) for tag in tags]
    return channel, [None if each is None else (each.line, each.modal) for each in records]


@pytest.mark.parametrize("seed", range(60))
def test_a_variable_in_brackets_means_what_it_means_in_a_statement(seed: int) -> None:
    text = program(random.Random(seed))
    (words, blocks), (statements, others) = prepared(text), prepared(text.replace("[", "[ "))
    assert listing(words, lines=True) == listing(statements, lines=True)
    assert blocks == others
    assert words.blocks == statements.blocks
    assert places(words) == places(statements)


def places(channel: Channel) -> list[tuple[str, int, int]]:
    """Return the errors of a channel with line and column, without the blanks after brackets."""
    found = []
    for error in channel.errors:
        assert error.position is not None
        line, column = error.position.text, error.position.column
        found.append((error.what, error.position.line, column - line[: column - 1].count("[ ")))
    return found
