"""CPL programs of a control that are put back in the middle of a loop, a sub-program and a wait."""

from __future__ import annotations

import json
from collections.abc import Iterator
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from polycnc.cnc import ControlSnapshot, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import Coupling, Mode
from polycnc.controllers.bosch.system import Signals
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


WRONG: tuple[Any, ...] = (None, True, -1, 1.5, 10**40, "x", "", [], [1], {}, {"1": []}, [[]])
RIGHT = {
    *((way, "[]") for way in ("shown", "signals", "errors")),
    *((way, "{}") for way in ("", "selected.0", "selected.1")),
    *(("selected.1.1", text) for text in ("x", "")),
    ("shown.0.0", str(10**40)),
    ("shown.0.3", "True"),
    *((f"errors.{n}.0", str(number)) for n in (0, 1) for number in (-1, 10**40)),
    *((f"errors.{n}.1", "-1") for n in (0, 1)),
    *((f"errors.{n}.3", text) for n in (0, 1) for text in ("x", "")),
    *((f"errors.{n}.4", "None") for n in (0, 1)),
}
"""What is right where it stands."""


def places_in(value: object) -> Iterator[tuple[Any, ...]]:
    """Return the way to every part of plain data, the whole first."""
    yield ()
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in parts:
        for way in places_in(part):
            yield key, *way


def with_part(data: Any, way: tuple[Any, ...], value: object) -> Any:
    """Return plain data with one part exchanged."""
    if not way:
        return value
    changed = copy(data)
    changed[way[0]] = with_part(data[way[0]], way[1:], value)
    return changed


def test_a_file_with_something_wrong_beside_the_programs_changes_nothing(pnc: Pnc) -> None:
    pnc.select_mode(Mode.SINGLE_BLOCK)
    assert Coupling(pnc.ncs, None, 1).mcops(4, 1, "GONE", "", "", 0) == 0
    pnc.control.put_alarm("function_failed", detail="M8")
    pnc.system.interface.set_bit(Signals.AXIS_INPUTS, 64, 63, True)
    kept = pnc.snapshot()
    data = kept.data()
    told = data["beside"]
    assert told["selected"] == [{"1": Mode.SINGLE_BLOCK}, {"1": "GONE"}]
    assert len(told["signals"]) >= 1 <= len(told["errors"])
    pnc.advance(7)
    before, taken = pnc.snapshot(), set()
    for way in places_in(told):
        for value in WRONG:
            changed = with_part(told, way, value)
            try:
                pnc.restore(replace(kept, beside=json.dumps({**data, "beside": changed})))
            except SnapshotError:
                continue
            taken.add((".".join(map(str, way)), str(value)))
            pnc.restore(before)
        assert pnc.snapshot() == before, way
    assert taken == RIGHT


@pytest.mark.parametrize(
    ("way", "value"),
    [
        *(("relative_zero", each) for each in ([], [1.0])),
        *((f"manual.{each}", []) for each in ("motions", "referenced", "feed_overrides", "rapid_overrides")),
        *((f"timers.{each}", {}) for each in ("base_s", "cycles")),
        ("channels.0.lent", [[3, 1.0]]),
        ("channels", []),
    ],
)
def test_a_file_of_other_axes_or_timers_changes_nothing(pnc: Pnc, way: str, value: object) -> None:
    kept = started(pnc).snapshot()
    pnc.advance(30)
    before = pnc.snapshot()
    parts = [int(each) if each.isdecimal() else each for each in way.split(".")]
    changed = json.dumps(with_part(kept.data(), tuple(parts), value))
    with pytest.raises(SnapshotError, match="damaged"):
        pnc.restore(replace(kept, beside=changed))
    assert pnc.snapshot() == before
