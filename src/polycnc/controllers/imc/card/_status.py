"""What a card is and does in one cycle, as a value."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from polycnc.controllers.imc.core._parameters import parameter

if TYPE_CHECKING:
    from polycnc.controllers.imc.card._card import Card


@dataclass(frozen=True, slots=True)
class AxisStatus:
    """One axis: `command` and `velocity` in pulses and pulses/ms, `encoder` in counts, `error` as in its parameter."""

    command: float
    encoder: float
    velocity: float
    is_moving: bool
    error: int


@dataclass(frozen=True, slots=True)
class CardStatus:
    """A card in one cycle; `inputs` and `outputs` bit by bit, number 1 is bit 0, `queued` in words, by queue."""

    cycle: int
    time_s: float
    axes: tuple[AxisStatus, ...]
    inputs: int
    outputs: int
    queued: tuple[int, ...]


def card_status(card: Card) -> CardStatus:
    """Return the status of a card in its present cycle."""
    return CardStatus(
        cycle=card.clock.cycles,
        time_s=card.clock.now_s,
        axes=tuple(
            AxisStatus(
                command=card.read("curpos", i),
                encoder=card.read("encp", i),
                velocity=card.read("curvel", i),
                is_moving=card.is_moving(i),
                error=card.read_words(parameter("error").address, i, 1)[0],
            )
            for i in range(card.axes)
        ),
        inputs=_bits(card, "gin1", "gin2"),
        outputs=_bits(card, "gout1", "gout2", "gout3"),
        queued=tuple(int(words) for words in card.state.fifo["words"]),
    )


def _bits(card: Card, *names: str) -> int:
    words = (card.read_words(parameter(name).address, 0, 1)[0] for name in names)
    return sum(word << 16 * k for k, word in enumerate(words))
