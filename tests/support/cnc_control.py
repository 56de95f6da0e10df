"""A control with two programs on the small machine, and what tests ask of it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.cnc import (
    Control,
    ControlData,
    ControlError,
    Refusal,
    Status,
)
from support.cnc_machine import cnc_machine

# 30 mm at 3000 mm/min are 0.6 s, and the way back as long.
PART = """O7 (PLATE)
N10 G1 X42.5 F3000
N20 X12.5
N30 M30
"""
SLOT = """N10 G1 X20 F600
N20 M8
N30 X30
N40 M2
"""


def control(data: ControlData | None = None, **keys: object) -> Control:
    made = Control(cnc_machine(), data=data, **keys)  # type: ignore[arg-type]
    made.programs.create("PART", PART)
    made.programs.create("SLOT", SLOT)
    return made


def started(data: ControlData | None = None, program: str = "PART", **keys: object) -> Control:
    made = control(data, **keys)
    made.select_program(program)
    made.cycle_start()
    return made


def refused(reason: Refusal, call: Callable[[], object], made: Control) -> None:
    before = fresh(made)
    with pytest.raises(ControlError) as caught:
        call()
    assert caught.value.reason is reason
    assert caught.value.hint
    assert fresh(made) == before


def fresh(made: Control) -> Status:
    """Return a status that is read anew, whatever was read before."""
    made.clock.changes += 1
    return made.status()


def x_of(made: Control) -> float:
    return made.status().axes["X"].machine
