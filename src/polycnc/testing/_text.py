"""Lines and tables that reports of failed tests are made of."""

from __future__ import annotations

from collections.abc import Iterator, Sequence


def time_text(time_s: float, cycle: int, more: str = "") -> str:
    """Return when something is so, and what else is said in the same line."""
    return ", ".join(each for each in (f"after {time_s:.3f} s ({cycle} cycles)", more) if each)


def number_text(value: float) -> str:
    """Return a position with four decimals."""
    return f"{value:.4f}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yield rows in columns: the first to the left, numbers to the right."""
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    for row in (head, *rows):
        _, *others = (cell.rjust(width) for cell, width in zip(row, widths, strict=True))
        yield "  ".join((row[0].ljust(widths[0]), *others)).rstrip()
