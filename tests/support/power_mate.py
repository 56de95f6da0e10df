"""A Power Mate on the bus of the library, and what tests do with it."""

from __future__ import annotations

from typing import Any

from polycnc.cnc import ControlEvent
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import IODBPSD

OK = fwlib.EW.EW_OK


def attached(clock: Any = None, **keys: Any) -> tuple[PowerMate, int]:
    """Return a control that is node 0, alone, and a handle of it."""
    control = PowerMate(**keys)
    fwlib.detach()
    fwlib.attach(0, control, clock)
    code, handle = fwlib.cnc_allclibhndl()
    assert code == OK
    return control, handle


def moved(control: PowerMate, blocks: str) -> None:
    """Let blocks be executed in MDI, to their end."""
    before = control.mode
    control.select_mode("MDI")
    control.mdi.put(f"\nO1\n{blocks}\nM30\n%".encode())
    control.cycle_start()
    control.advance(1_000_000, until=ControlEvent.RUN_STATE)
    assert control.status().channel.run_state.value == "completed", control.control.alarms.active
    control.select_mode(before)


def registered(control: PowerMate, **programs: str) -> None:
    """Put programs into the memory: O7="N10 G1 ..." and so on; the O word comes by itself."""
    for name, text in programs.items():
        number = int(name[1:])
        control.programs.register(number, f"O{number:04d}{text}")


def running(control: PowerMate, number: int, condition: Any = None) -> None:
    """Start a program in MEM and let it run until a condition holds."""
    control.select_mode("MEM")
    control.select_program(number)
    control.cycle_start()
    if condition is not None:
        passed = control.advance(1_000_000, until=condition)
        assert condition(), passed


def psd(number: int, axis: int = 0, **values: Any) -> IODBPSD:
    """Return the structure of one parameter."""
    data = IODBPSD(datano=number, type=axis)
    for name, value in values.items():
        if isinstance(value, (list, tuple)):
            getattr(data.u, name)[: len(value)] = value
        else:
            setattr(data.u, name, value)
    return data
