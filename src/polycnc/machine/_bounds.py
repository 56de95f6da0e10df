"""What a number in a program or a file can ask for at most, so that nothing is asked for that has no end.

A feed of 1e-15 mm/min is a number like any other and a block of a hundred billion years. Whoever takes a number from
outside holds what follows from it to these bounds and names the place of the number. They leave every real machine
a factor of at least a thousand, and keep all counts of cycles far within 64 bits.
"""

from __future__ import annotations

LONGEST_BLOCK_S = 1e7
"""The longest that one move, dwell or auxiliary function may take: some sixteen weeks."""

SHORTEST_CYCLE_S = 1e-6
"""The shortest control cycle of a machine file."""

LEAST_RATE = 1e-3
"""The least speed (mm/s or deg/s) and acceleration (per s²) of an axis, or of a spindle in rpm and rpm/s."""

MOST_RATE = 1e9
"""The highest of these."""

LARGEST_POSITION = 1e9
"""No position lies further out (mm or degree): float64 would not resolve it any more."""

LEAST_OVERRIDE = 1e-3
"""The least override above 0; below it the control shows 0 % and nothing would ever arrive."""

PIECE_CYCLES = 1 << 16
"""Cycles that compiled code runs at most before it returns, so that signals and other threads have their turn."""
