"""CPL programs of a control that are put back in the middle of a loop, a sub-program and a wait."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.cnc import ControlSnapshot, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.machine import SnapshotError
from support.programs import MILL

MAIN = """N1 G1 F3000
10 #N%=2 : DIM T$(7) : T$="AB" : @5=7
20 FOR I%=1 TO 3
30 CALL HOLE[I%*1.5]
40 @5=@5+I%
50 T$=T$+"C"
60 NEXT
70 #L%=LEN(T$)
N80 M0
N90 G1 X[@5/2]
"""
HOLE = """1 V=P1+0.25 : K%=0
2 WHILE K%<2 DO
3 K%=K%+1
N4 G1 X[V] Y[K%*1.5]
5 WAIT(,45)
6 #N%=#N%+K%
7 END
N8 Z[V/2]
"""


def switched_on(folder: Path) -> Pnc:
    return Pnc(folder, MILL)


@pytest.fixture
def pnc(tmp_path: Path) -> Iterator[Pnc]:
    (tmp_path / "main.npg").write_text(MAIN)
    (tmp_path / "HOLE").write_text(HOLE)
    made = switched_on(tmp_path)
    yield made
    made.close()


def started(pnc: Pnc) -> Pnc:
    pnc.select_program("main.npg")
    pnc.cycle_start()
    return pnc


def end(pnc: Pnc) -> tuple[object, ...]:
    for _ in range(5):
        pnc.advance(20_000, until=lambda: pnc.run_state(1) is not RunState.ACTIVE)
        if pnc.run_state(1) is RunState.PROGRAM_STOP:
            pnc.cycle_start()
    assert pnc.run_state(1) is RunState.COMPLETED, pnc.status().alarms
    return pnc.clock.cycles, pnc.control.machine.snapshot(), pnc.variables(1)


@pytest.mark.parametrize("cycle", [11, 90, 133, 246, 390, 5000])
def test_a_program_goes_on_from_a_file(pnc: Pnc, tmp_path: Path, cycle: int) -> None:
    started(pnc).advance(cycle, until=lambda: pnc.run_state(1) is not RunState.ACTIVE)
    content = pnc.snapshot().to_bytes()
    wanted = end(pnc)
    assert wanted[2]["@5"] == 13  # type: ignore[index]
    assert wanted[2]["#N%"] == 11  # type: ignore[index]
    assert wanted[2]["#L%"] == 5  # type: ignore[index]
    pnc.restore(ControlSnapshot.from_bytes(content))
    assert pnc.snapshot().to_bytes() == content
    assert end(pnc) == wanted
    pnc.close()
    other = switched_on(tmp_path)
    other.restore(ControlSnapshot.from_bytes(content))
    assert end(other) == wanted
    other.close()


def test_a_program_that_was_changed_is_refused(pnc: Pnc, tmp_path: Path) -> None:
    started(pnc).advance(120)
    assert pnc.status().channel.run_state is RunState.ACTIVE
    kept = pnc.snapshot()
    (tmp_path / "HOLE").write_text(HOLE.replace("45", "46"))
    pnc.close()
    other = switched_on(tmp_path)
    before = other.snapshot()
    with pytest.raises(SnapshotError, match="HOLE has been changed"):
        other.restore(kept)
    assert other.snapshot() == before
    other.close()


@pytest.mark.parametrize(
    ("statement", "what"),
    [('OPENW(1,"NOTES")', "a file is open"), ("DLG", "a dialog is open")],
)
def test_what_is_open_is_said(pnc: Pnc, tmp_path: Path, statement: str, what: str) -> None:
    (tmp_path / "main.npg").write_text(f"10 {statement}\n20 WAIT(,500)\n30 A%=2\n")
    started(pnc).advance(30)
    assert pnc.run_state(1) is RunState.ACTIVE, pnc.status().alarms
    with pytest.raises(SnapshotError, match=what):
        pnc.snapshot()
