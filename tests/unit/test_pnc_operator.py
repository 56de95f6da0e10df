"""An operator at a living control: keys at any cycle, the screen, permanent variables (Manual 003, 7 and 8)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.cnc import RunState
from polycnc.controllers.bosch import Pnc
from polycnc.errors import UsageError
from polycnc.machine import SnapshotError


@pytest.fixture
def pnc(tmp_path: Path) -> Iterator[Pnc]:
    made = Pnc(tmp_path)
    yield made
    made.close()


def start(pnc: Pnc, text: str) -> None:
    (pnc.system.directory.root / "main").write_text(text + "\n")
    pnc.select_program("main")
    pnc.cycle_start()


SOFTKEYS = '10 #K%=0 : #N%=0\n20 SFK(#K%,"LEFT","RIGHT")\n30 #N%=1\nN40 G1 X5 F6000'
INPUT = '10 #V!=2\n20 DLG\n30 PRN(2,1,"Depth ###.##",#V!)\n40 INP(#V!)\n50 ENDDLG\n60 #N%=1'
POLLED = "10 #C%=0\n20 REPEAT\n30 #C%=INKEY\n40 UNTIL #C%<>0"


@pytest.mark.parametrize("before", [0, 1, 7, 60])
@pytest.mark.covers("cpl.SFK", "cpl.INKEY", "cpl.INP")
def test_a_program_waits_for_the_key_that_is_pressed(pnc: Pnc, before: int) -> None:
    start(pnc, SOFTKEYS)
    pnc.advance(before)
    assert pnc.run_state() is RunState.ACTIVE
    pnc.press("ENTER")  # no softkey: it goes on waiting
    pnc.advance(before)
    pnc.press("SOFTKEY2")
    pnc.advance(500)
    found = pnc.variables()
    assert (found["#K%"], found["#N%"], pnc.axes["X"].setpoint) == (2, 1, 5)
    start(pnc, INPUT)
    pnc.advance(before + 1)
    assert any("Depth   2.00" in line for line in pnc.screen().lines())
    for key in "1.5":
        pnc.press(key)
        pnc.advance(before)
    assert pnc.variables()["#V!"] == 2
    pnc.press("ENTER")
    pnc.advance(20)
    assert (pnc.variables()["#V!"], pnc.variables()["#N%"]) == (1.5, 1)
    start(pnc, POLLED)
    pnc.advance(before)
    pnc.press("A")
    pnc.advance(20)
    assert (pnc.variables()["#C%"], pnc.run_state()) == (65, RunState.COMPLETED)


def test_how_time_is_cut_makes_no_difference_while_a_key_is_awaited(tmp_path: Path) -> None:
    ends = []
    for cut in (1, 3, 300):
        folder = tmp_path / str(cut)
        folder.mkdir()
        pnc = Pnc(folder)
        start(pnc, SOFTKEYS)
        for _ in range(300 // cut):
            pnc.advance(cut)
        pnc.press("SOFTKEY1")
        cycles = 0
        while pnc.run_state() is RunState.ACTIVE:
            cycles += pnc.advance(1)
        ends.append((cycles, pnc.clock.cycles))
        pnc.close()
    assert len(set(ends)) == 1


def test_a_reset_ends_the_wait_and_what_was_typed_is_lost(pnc: Pnc) -> None:
    start(pnc, INPUT)
    pnc.advance(5)
    with pytest.raises(SnapshotError):
        pnc.snapshot()
    pnc.press("7")
    pnc.advance(5)
    pnc.reset()
    pnc.advance(5)
    start(pnc, "N10 G1 X30 F600")
    for key in ("8", "ENTER"):
        pnc.press(key)
    pnc.advance(5)
    pnc.reset()
    pnc.advance(100)
    start(pnc, INPUT)
    pnc.advance(5)
    pnc.press("ENTER")
    pnc.advance(5)
    assert (pnc.variables()["#V!"], pnc.run_state()) == (2, RunState.COMPLETED)
    with pytest.raises(UsageError, match="there is no key"):
        pnc.press("F13")


def test_permanent_variables_are_seen_before_the_first_program(tmp_path: Path) -> None:
    pnc = Pnc(tmp_path)
    assert pnc.variables()["@5"] is None
    start(pnc, "10 @5%=17")
    pnc.advance(20)
    pnc.close()
    pnc = Pnc(tmp_path)
    assert pnc.variables()["@5"] == 17
    pnc.close()
