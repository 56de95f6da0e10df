"""Programs that wait, loop or call without motion: a cycle looks at what they wait for, and does little else."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.cnc import ControlEvent, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.device._history import Monitored
from polycnc.nc.channel._preparation import BARREN_TURNS, TURNS_PER_CYCLE
from polycnc.runner import run

COUNTING = "#1=0\nWHILE[#1LT20000]DO1\n#1=#1+1\nEND1\nM30\n"


def started(text: str, sub_program: str = "") -> PowerMate:
    made = PowerMate(2)
    made.programs.register(1, f"O0001\n{text}")
    if sub_program:
        made.programs.register(9, f"O0009\n{sub_program}")
    made.select_mode("MEM")
    made.select_program(1)
    made.cycle_start()
    return made


@pytest.mark.parametrize("cut", [1, 7, 39, 20_000])
def test_a_loop_takes_its_cycles_however_they_are_cut(cut: int) -> None:
    made = started(COUNTING)
    while made.status().channel.run_state is RunState.ACTIVE:
        made.advance(cut, until=ControlEvent.RUN_STATE)
    assert made.clock.cycles == 39  # 500 jumps a cycle


WAITING = {
    "signal": "WHILE[#1000EQ0]DO1\nEND1\nM30\n",
    "word of signals": "WHILE[#1032EQ0]DO1\nEND1\nM30\n",
    "goto its own line": "N10 IF[#1000EQ0]GOTO10\nM30\n",
    "timer": "#3001=0\nWHILE[#3001LT1000000]DO1\nEND1\nM30\n",
    "position": "WHILE[#5041LT1]DO1\nEND1\nM30\n",
    "parts": "WHILE[#3901LT7]DO1\n#5=#5+1\nEND1\nM30\n",
    "by its number": "#2=1000\nWHILE[#[#2]EQ0]DO1\nEND1\nM30\n",
    "in a sub-program": "WHILE[1EQ1]DO1\nM98P9\nEND1\nM30\n",
}


@pytest.mark.parametrize("kind", WAITING)
def test_a_program_that_waits_is_asked_once_a_cycle(kind: str) -> None:
    made = started(WAITING[kind], "IF[#1000EQ1]GOTO5\nM99\nN5M99\n")
    made.advance(5)
    turns = made.custom_macros.language.turns
    assert made.advance(90) == 90
    assert made.custom_macros.language.turns - turns <= 90 * (4 if "sub" in kind else 2)
    assert made.status().channel.run_state is RunState.ACTIVE


def test_a_wait_ends_in_the_cycle_after_its_signal() -> None:
    made = started("WHILE[#1003EQ0]DO1\nEND1\n#500=17.5\nM30\n")
    made.advance(31)
    made.signals.give(54, 8)
    made.advance(1)
    assert made.macros.get(500) == 17.5


def test_a_wait_for_a_timer_lasts_as_long() -> None:
    made = started("#3001=0\nN7 IF[#3001LT25]GOTO7\n#500=#3001\nM30\n")
    made.advance(10_000, until=ControlEvent.RUN_STATE)
    assert made.macros.get(500) == 25.0
    assert made.clock.cycles == 25
    result = run("#3001=0\nN7 IF[#3001LT25]GOTO7\nG1X1F600\nM30\n", dialect="fanuc")
    assert result.time_s == pytest.approx(0.125, abs=0.006)


LOOPS = {
    "empty calls": ("WHILE[1EQ1]DO1\nM98P9\nEND1\nM30\n", "M99\n"),
    "calls with arguments": ("WHILE[1EQ1]DO1\nG65P9A1\nEND1\nM30\n", "#3=#1\nM99\n"),
    "repeated calls": ("M98P9L9999\n" * 9 + "M30\n", "M99\n"),
    "blocks without motion": ("WHILE[1EQ1]DO1\nG90\nEND1\nM30\n", ""),
    "plain text": ("G90\n" * 20_000 + "M30\n", ""),
    "functions that take no time": ("WHILE[1EQ1]DO1\nM50\nEND1\nM30\n", ""),
    "dwells of no time": ("WHILE[1EQ1]DO1\nG4X0\nEND1\nM30\n", ""),
    "statements": ("WHILE[1EQ1]DO1\n#500=#500+1\nEND1\nM30\n", ""),
    "itself again": ("G90\nM99\n", ""),
    "outputs": ("WHILE[1EQ1]DO1\n#1132=1\n#1132=0\nEND1\nM30\n", ""),
}


@pytest.mark.parametrize("kind", LOOPS)
def test_what_a_cycle_prepares_is_bounded(kind: str) -> None:
    made = started(*LOOPS[kind])
    channel = made.control.channels[0]
    made.advance(1)
    assert channel.run is not None
    for _ in range(12):
        blocks, turns = channel.run.channel.blocks, made.custom_macros.language.turns
        assert made.advance(1) == 1
        assert channel.run.channel.blocks - blocks <= TURNS_PER_CYCLE // BARREN_TURNS * 64
        assert made.custom_macros.language.turns - turns <= TURNS_PER_CYCLE
    assert made.status().channel.run_state is RunState.ACTIVE


def test_a_cpl_program_that_waits_is_asked_once_a_cycle(tmp_path: Path) -> None:
    for text in ("10 WAIT(IC(4)=TRUE)", "10 WAIT(,900000)", "10 IF CLOCK<900000 THEN GOTO 10 ENDIF"):
        (tmp_path / "main.npg").write_text(f"{text}\nM30\n")
        made = Pnc(tmp_path)
        made.select_program("main.npg")
        made.cycle_start()
        assert made.advance(30) == 30
        assert made.run_state(1) is RunState.ACTIVE, (text, made.status().alarms)
        made.close()


def test_what_the_history_notes_does_not_depend_on_the_cut() -> None:
    """Signals that a program gives are noted in their cycles, also where many cycles pass in one call."""
    text = "#1132=5\nG4X0.01\n#1132=2\nG4X0.01\n#3000=7(BROKEN)\nM30\n"
    found = []
    for cut in (1, 100):
        made = started(text)
        made.history.monitor({1: Monitored("F", 0, 0xFF), 2: Monitored("F", 54, 0xFF)})
        for _ in range(100 // cut):
            made.advance(cut)
        found.append(made.history.operations())
    assert found[0] == found[1]
    assert len(found[0]) > 5
