"""M66, M98 and M99 under way: however time is cut, saved, held or stepped through, a program ends as undisturbed."""

from __future__ import annotations

import random

import pytest

from polycnc.cnc import Control, ControlSnapshot, RunState

PROGRAM = """G21 G61 G1 X2 F6000
M66 P3 L1 Q.9
#1 = [#5399 + 2]
M98 P70 L2
M66 P5 L4 Q.04 G1 Y[#5399 + 4.5]
o3 while [#2 lt 2]
#2 = [#2 + 1]
M66 P3 L2 Q.15
#3 = [#3 * 4 + #5399 + 3]
o3 endwhile
M66 E2
G1 X#3 Y[#5399 / 8]
M66 P9 L3 Q.11
G1 Z[#5399 - 6]
M2
O70
#1 = [#1 * 1.5]
G1 Z[-#1]
M98 P71
M99
O71
M66 P3 L0
G1 X[#1 + #5399]
M99
"""
EDGES = {90: 1, 260: 0, 300: 1, 381: 0, 420: 1}
END = (3 * 4 - 1 + 3.0, 19 / 8, -1 - 6.0)  # the first fall comes in cycle 381, the second too late


class Rig:
    """A control that executes the program while its inputs change at their cycles."""

    def __init__(self) -> None:
        self.control = Control(dialect="linuxcnc")
        self.control.programs.create("part.ngc", PROGRAM)
        self.control.machine.io["IW2"] = 19

    def start(self) -> None:
        self.control.select_program("part.ngc")
        self.control.cycle_start()

    @property
    def state(self) -> RunState | None:
        return self.control.channels[0].run_state

    def advance(self, cycles: int) -> None:
        """Let time pass, with every edge in its cycle."""
        left = cycles
        while left:
            now = self.control.clock.cycles
            if now in EDGES:
                self.control.machine.io["I3"] = EDGES[now]
            following = min((edge for edge in EDGES if edge > now), default=now + left)
            left -= self.control.advance(min(left, following - now))

    def end(self) -> tuple[object, ...]:
        """Go on to the end, and return all that can be seen there."""
        for _ in range(40):
            if self.state is RunState.COMPLETED:
                break
            self.advance(50)
        assert self.state is RunState.COMPLETED
        self.advance(2500 - self.control.clock.cycles)
        return self.control.snapshot().to_bytes(), self.place()

    def place(self) -> tuple[float, ...]:
        return tuple(self.control.machine.state.setpoint[:3].tolist())


@pytest.fixture(scope="module")
def wanted() -> tuple[object, ...]:
    rig = Rig()
    rig.start()
    found = rig.end()
    assert found[1] == pytest.approx(END)
    return found


def test_time_may_be_cut_anywhere(wanted: tuple[object, ...]) -> None:
    rng = random.Random(5)
    rig = Rig()
    rig.start()
    while rig.state is not RunState.COMPLETED:
        rig.advance(rng.choice((1, 1, 3, 40)))
    assert rig.end() == wanted


@pytest.mark.parametrize("cycle", [44, 89, 91, 261, 340, 382, 520])
def test_a_program_goes_on_from_any_cycle_in_another_control(cycle: int, wanted: tuple[object, ...]) -> None:
    rig, other = Rig(), Rig()
    rig.start()
    rig.advance(cycle)
    content = rig.control.snapshot().to_bytes()
    other.control.restore(ControlSnapshot.from_bytes(content))
    assert other.control.snapshot().to_bytes() == content
    assert other.end() == wanted


@pytest.mark.parametrize("cycle", [60, 150, 225, 330, 450])
def test_a_hold_holds_in_a_wait_and_everywhere(cycle: int, wanted: tuple[object, ...]) -> None:
    rig = Rig()
    rig.start()
    rig.advance(cycle)
    rig.control.feed_hold()
    rig.advance(60)  # it has braked
    held = (rig.place(), rig.state)
    rig.advance(1200)
    assert (rig.place(), rig.state) == held
    assert held[1] is RunState.HOLD
    rig.control.cycle_start()
    for _ in range(60):
        rig.advance(50)
    assert rig.state is RunState.COMPLETED


def test_single_blocks_come_to_the_same_end_and_stand_at_every_wait() -> None:
    rig = Rig()
    rig.control.set_switches(single_block=True)
    rig.start()
    stops = []
    for _ in range(200):
        rig.advance(25)
        if rig.state is RunState.COMPLETED:
            break
        if rig.state is RunState.STOPPED_AT_BLOCK:
            record = rig.control.channels[0].executed
            stops.append(0 if record is None else record.line)
            rig.control.cycle_start()
    assert rig.state is RunState.COMPLETED
    assert stops == [1, 2, 18, 22, 23, 18, 22, 23, 5, 8, 8, 11, 12, 13, 14]
    assert rig.place()[1:] == pytest.approx(END[1:])
