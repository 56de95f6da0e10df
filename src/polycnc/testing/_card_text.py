"""What a report says of an iMC card: what waits and where its axes are."""

from __future__ import annotations

from polycnc.controllers.imc import CardStatus
from polycnc.testing._text import table, time_text


def card_text(status: CardStatus) -> str:
    """Return the lines about an iMC card; positions are in pulses and counts."""
    queues = ", ".join(map(str, status.queued))
    lines = [time_text(status.time_s, status.cycle), f"words that wait in its queues: {queues}"]
    rows = [
        (
            str(i),
            f"{each.command:.15g}",
            f"{each.encoder:.15g}",
            "moves" if each.is_moving else "rests",
            hex(each.error),
        )
        for i, each in enumerate(status.axes)
    ]
    return "\n".join([*lines, *table(("axis", "command", "encoder", "", "error"), rows)])
