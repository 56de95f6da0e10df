"""A control takes its language from its dialect, whoever made it: a bare one, a run, a debugger, a Power Mate."""

from __future__ import annotations

import pytest

from polycnc.cnc import Control, ControlData, ControlEvent, RunState
from polycnc.controllers.fanuc import PowerMate
from polycnc.nc import ProgramText, load_dialect
from polycnc.runner import Debugger, run

TEXT = "O0001\n#1=2.25\nWHILE[#1LT7]DO1\n#1=#1*2\nEND1\nG1 X[#1-0.5] F3000\nM30\n"


def _bare(dialect: str = "fanuc") -> Control:
    return Control(dialect=dialect, data=ControlData(reference_required=False))


def _by_control(made: Control) -> float:
    made.programs.create("O0001", TEXT)
    made.select_program("O0001")
    made.cycle_start()
    made.advance(10_000, until=ControlEvent.RUN_STATE)
    assert made.channels[0].run_state is RunState.COMPLETED, made.alarms.active
    return made.status().axes["X"].machine


def _by_debugger() -> float:
    made = Debugger(ProgramText.from_text(TEXT, "part.nc"), dialect="fanuc")
    made.run()
    made.pass_time(10_000)
    assert made.control.channels[0].run_state is RunState.COMPLETED, made.status.alarms
    return made.status.axes["X"].machine


def _changed() -> Control:
    made = _bare("din")
    made.change_dialect(load_dialect("fanuc"))
    return made


def _by_power_mate() -> float:
    made = PowerMate(2)
    made.programs.register(1, TEXT)
    made.select_mode("MEM")
    made.select_program(1)
    made.cycle_start()
    made.advance(10_000, until=ControlEvent.RUN_STATE)
    return made.control.status().axes["X"].machine


WAYS = {
    "run": lambda: float(run(TEXT, dialect="fanuc", trace=True).trace.setpoint[-1, 0]),
    "bare control": lambda: _by_control(_bare()),
    "changed dialect": lambda: _by_control(_changed()),
    "debugger": _by_debugger,
    "power mate": _by_power_mate,
}


@pytest.mark.parametrize("way", WAYS)
def test_custom_macros_are_read_wherever_the_dialect_has_them(way: str) -> None:
    assert WAYS[way]() == 8.5


def test_a_dialect_without_a_language_reads_words_alone() -> None:
    made = _bare("din")
    made.programs.create("PART", "#1=2\nM30\n")
    made.select_program("PART")
    made.cycle_start()
    assert made.channels[0].run_state is RunState.ALARM
