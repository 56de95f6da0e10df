"""What an operator sees while a program runs: machine lock, timers, overrides, feed hold (Manual 000)."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.cnc import ControlError, ControlEvent, Refusal, RunState, Timer
from polycnc.controllers.fanuc import fwlib
from support.power_mate import OK, attached, registered, running

TIMES = "\nG1 X6. F3000\nG0 X0\nG4 P200\nG2 X4. I2. F1800\nM30\n"
_ACTS = ("absolute", "relative", "distance")


def shown(control: Any, lock: bool) -> list[tuple[int, ...]]:
    """Run a program of two axes and return what displays show of both in each cycle."""
    control.signals.give_bits(44, 2, 2 if lock else 0)
    control.control.set_relative("Y", 1.5)
    registered(control, O7="\nG54\nG1 X3. Y-1. F6000\nG91 X-1.\nM30\n")
    running(control, 7)
    seen = []
    while control.control.channels[0].active:
        control.advance(1)
        axes = control.positions.read()
        seen.append(tuple(getattr(each, what) for each in axes for what in _ACTS))
        if lock:
            assert {each.machine for each in axes} == {0}
            assert not any(control.machine.actual.values())
    return seen


@pytest.mark.covers("fanuc.concept.position_contents")
def test_under_a_machine_lock_displays_show_the_motion_and_the_machine_stands() -> None:
    free, _ = attached(axes=2)
    locked, _ = attached(axes=2)
    for control in (free, locked):
        control.control.offsets.set("G54", {"X": 2.5})
    assert shown(locked, True) == shown(free, False)
    assert locked.positions.read()[0].absolute == 2_000
    locked.signals.give_bits(44, 2, 0)
    assert locked.positions.read()[0].absolute == -2_500  # where the axes are


def test_under_a_machine_lock_macros_read_the_positions_that_are_shown() -> None:
    control, _ = attached(axes=2)
    control.signals.give_bits(44, 2, 2)
    registered(control, O7="\nWHILE[#5041LT3]DO1\nG91G1X0.5F6000\nEND1\n#500=#5041\n#501=#5021\nM30\n")
    running(control, 7)
    control.advance(5000, until=ControlEvent.RUN_STATE)
    assert (control.macros.get(500), control.macros.get(501)) == (3.0, 0.0)


def test_cutting_time_counts_every_cycle_at_feed() -> None:
    control, _ = attached(axes=2)
    registered(control, O7=TIMES)
    running(control, 7)
    channel = control.control.channels[0]
    expected, cycle_ms = 0.0, control.clock.cycle_s * 1000.0
    cycles = 0
    while channel.active:
        before = control.status().channel
        assert before.run_state is RunState.ACTIVE
        control.advance(1)
        cycles += 1
        status = control.status().channel
        block = status.block
        if block is not None and block.text.startswith(("G1", "G2")) and status.motion.value == "moving":
            expected += cycle_ms
        counted = 1000.0 * control.control.timers.seconds(Timer.CUTTING)
        assert abs(counted - expected) <= 2.5 * cycle_ms
        assert control.parameters.value(6753) == round(counted)
        assert control.parameters.value(6757) == control.parameters.value(6751) == round(cycles * cycle_ms)
    assert expected > 200.0


@pytest.mark.parametrize("step", [1, 3, 1000])
def test_cutting_time_does_not_depend_on_who_looks(step: int) -> None:
    control, _ = attached(axes=2)
    registered(control, O7=TIMES)
    running(control, 7)
    seen = {}
    for cycle in range(0, 1000, step):
        control.advance(step)
        seen[cycle + step] = control.control.timers.seconds(Timer.CUTTING)
    other, _ = attached(axes=2)
    registered(other, O7=TIMES)
    running(other, 7)
    for cycle in sorted(seen)[:: max(1, len(seen) // 10)]:
        other.advance(cycle - other.clock.cycles)
        assert other.control.timers.seconds(Timer.CUTTING) == seen[cycle]


@pytest.mark.covers("fanuc.cnc_opdi.number.10")
@pytest.mark.parametrize("percent", [150, 200, 201, 254])
@pytest.mark.covers("fanuc.cnc_opdi")
def test_a_feed_override_acts_up_to_254_percent(percent: int) -> None:
    control, _ = attached(axes=2)
    registered(control, O7="\nG1 X40. F1000\nM30\n")
    control.signals.give(12, 255 - percent)
    running(control, 7)
    control.advance(300)
    assert control.positions.feed() == 10 * percent
    assert control.signals.feed_override == percent
    control.signals.give(12, 0)  # all signals: 255, which is 0 %
    control.advance(300)
    assert (control.positions.feed(), control.signals.feed_override) == (0, 0)


@pytest.mark.covers("fanuc.cnc_wropnlsgnl")
def test_nothing_starts_while_feed_hold_is_given() -> None:
    control, handle = attached(axes=1)
    registered(control, O7="\nG1 X4. F6000\nM30\n")
    control.select_program(7)
    sgnl = fwlib.IODBSGNL(type=1 << 12, feed_hold=1)
    assert fwlib.cnc_wropnlsgnl(handle, sgnl) == OK
    for press in (control.cycle_start, control.cycle_start):
        with pytest.raises(ControlError) as caught:
            press()
        assert caught.value.reason is Refusal.HELD
        assert caught.value.hint
        assert control.status().channel.run_state is RunState.READY
    control.signals.give_bits(7, 4, 4)
    control.signals.give_bits(7, 4, 0)  # the start signal falls: nothing happens
    control.advance(50)
    assert control.machine.actual["X"] == 0.0
    sgnl.feed_hold = 0
    assert fwlib.cnc_wropnlsgnl(handle, sgnl) == OK
    control.cycle_start()
    control.advance(20)
    sgnl.feed_hold = 1
    assert fwlib.cnc_wropnlsgnl(handle, sgnl) == OK
    control.advance(200)
    at = control.machine.actual["X"]
    assert 0.0 < at < 4.0
    with pytest.raises(ControlError, match="feed hold is given"):
        control.cycle_start()
    control.advance(200)
    assert (control.machine.actual["X"], control.status().channel.run_state) == (at, RunState.HOLD)
    sgnl.feed_hold = 0
    assert fwlib.cnc_wropnlsgnl(handle, sgnl) == OK
    control.cycle_start()
    control.advance(1000, until=ControlEvent.RUN_STATE)
    assert control.machine.actual["X"] == 4.0
