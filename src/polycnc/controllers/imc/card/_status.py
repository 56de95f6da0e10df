"""What a card is and does in one cycle, as a value."""

from __future__ import annotations

from dataclasses import dataclass


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
