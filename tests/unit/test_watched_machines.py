"""What is observed of a machine by itself does not depend on how its time is cut into calls."""

from __future__ import annotations

import functools
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.cnc import Control
from polycnc.nc import ProgramText
from polycnc.servers.machines import BUSY_S, IDLE_S, ServedDevice
from polycnc.servers.mtconnect import VERSIONS, Agent, model_of
from polycnc.servers.plant import see

PROGRAM = ProgramText("PART", b"G1 X7 F900\nX3 Y2\nG4 P.3\nY0\nM30\n")


def watched() -> tuple[Control, ServedDevice[Any], Agent]:
    control = Control("mill3")
    served: ServedDevice[Any] = ServedDevice(control, lambda: control)
    agent = Agent([model_of("m", control, VERSIONS["2.7"])], VERSIONS["2.7"], 3)
    look = see(lambda: control)
    served.watch(lambda: agent.observe(0, look()))
    agent.observe(0, look())
    return control, served, agent


def lived(cuts: list[int]) -> bytes:
    """Return everything that was observed of a program that runs in the middle of a time, which is cut."""
    control, served, agent = watched()
    for begin, end in ((0, 630), (630, 3410)):
        if begin:
            control.select_program(PROGRAM)
            control.cycle_start()
        inside = sorted(cut for cut in cuts if begin < cut < end)
        at = begin
        for cut in [*inside, end]:
            served.advance(cut - at)
            at = cut
    found = agent.get("/sample", b"count=5000")
    return found.document  # type: ignore[union-attr]


@functools.cache
def whole() -> bytes:
    return lived([])


def test_it_is_looked_at_ten_times_a_second_while_something_moves() -> None:
    control, served, _ = watched()
    seen: list[float] = []
    served.watch(lambda: seen.append(control.clock.now_s))
    served.advance(1630)
    control.select_program(PROGRAM)
    control.cycle_start()
    served.advance(300)
    cycle = control.clock.cycle_s
    idle = [k * IDLE_S for k in range(1, int(1630 * cycle / IDLE_S) + 1)]
    busy = [k * BUSY_S for k in range(1, 10_000) if 1630 * cycle < k * BUSY_S <= 1930 * cycle + 1e-9]
    assert len(busy) > 2
    assert [round(at, 6) for at in seen] == [round(at, 6) for at in (*idle, *busy)]


def test_what_nobody_wants_to_see_is_looked_at_once_a_second_until_somebody_does() -> None:
    control, served, _ = watched()
    served._watches.clear()
    seen: list[float] = []
    wanted = False
    served.watch(lambda: seen.append(control.clock.now_s), lambda: wanted)
    control.select_program(ProgramText("LONG", b"G1 X120 F1200\nM30\n"))
    control.cycle_start()
    second = control.clock.cycles_for(IDLE_S)
    served.advance(2 * second + 30)
    assert [round(at, 6) for at in seen] == [1.0, 2.0]
    wanted = True
    served.advance(second // 2)
    assert [round(at, 6) for at in seen[2:]] == [2.1, 2.2, 2.3, 2.4, 2.5]


@settings(max_examples=15)
@given(st.lists(st.integers(1, 3409), max_size=12))
def test_observations_do_not_depend_on_cuts(cuts: list[int]) -> None:
    assert lived(cuts) == whole()


def test_a_snapshot_that_sets_time_back_is_watched_on() -> None:
    control, served, agent = watched()
    snapshot = served.snapshot()
    served.advance(9000)
    served.restore(snapshot)
    control.select_program(PROGRAM)
    control.cycle_start()
    before = agent.buffer.next
    served.advance(400)
    assert agent.buffer.next > before + 4
