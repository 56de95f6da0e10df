"""Setpoint tables: the setpoints of several axes are given cycle by cycle and wait in a ring.

A slot is one ring of rows; a row holds the values of all the slot's axes for one cycle, so the axes cannot
slip against each other. When a running ring is empty the axes stay where they are and the underflow flag is
set.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled, entry

Floats: TypeAlias = npt.NDArray[np.float64]

RING_ROW = np.dtype(
    [
        ("relative", np.int64),  # written by the caller: 1 adds a row to the contribution, 0 replaces it
        ("fill", np.int64),  # rows that wait
        ("taken", np.int64),  # rows used since the start
        ("underflow", np.int64),  # stays 1 until the caller clears it
        ("head", np.int64),
    ]
)


class Table(NamedTuple):
    """Setpoint rings of `width` axes and `capacity` rows each."""

    row: npt.NDArray[np.void]  # [slots] of RING_ROW
    running: npt.NDArray[np.uint8]  # [slots] written by the caller: the ring may be emptied
    axis: npt.NDArray[np.int64]  # [slots, width] written by the caller: axis of each column, -1 unused
    value: Floats  # [slots, width] result: the contribution
    ring: Floats  # [slots, capacity, width]


def make_table(slots: int, width: int, capacity: int) -> Table:
    """Make empty rings for `slots` slots of `width` axes and `capacity` rows each."""
    return Table(
        row=np.zeros(slots, RING_ROW),
        running=np.zeros(slots, np.uint8),
        axis=np.full((slots, width), -1, np.int64),
        value=np.zeros((slots, width)),
        ring=np.zeros((slots, capacity, width)),
    )


@entry
def table_push(k: int, table: Table, rows: Floats) -> int:
    """Append `rows` ``[m, width]`` to ring `k` as far as they fit; return how many were taken over."""
    row = table.row[k]
    capacity = int(table.ring.shape[1])
    accepted = min(int(rows.shape[0]), capacity - int(row["fill"]))
    for m in range(accepted):
        at = (int(row["head"]) + int(row["fill"])) % capacity
        for column in range(table.ring.shape[2]):
            table.ring[k, at, column] = rows[m, column]
        row["fill"] += 1
    return accepted


@entry
def table_clear(k: int, table: Table) -> None:
    """Drop the rows that wait in ring `k`; its contribution stays."""
    row = table.row[k]
    row["head"] = 0
    row["fill"] = 0


@compiled
def table_cycle(k: int, table: Table) -> int:
    """Take the next row of ring `k` into `value`; return 1 if there was one, else 0."""
    if table.running[k] == 0:
        return 0
    row = table.row[k]
    if row["fill"] == 0:
        row["underflow"] = 1
        return 0
    at = row["head"]
    for column in range(table.ring.shape[2]):
        if row["relative"] != 0:
            table.value[k, column] += table.ring[k, at, column]
        else:
            table.value[k, column] = table.ring[k, at, column]
    row["head"] = (at + 1) % table.ring.shape[1]
    row["fill"] -= 1
    row["taken"] += 1
    return 1
