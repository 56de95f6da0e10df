"""The ways to let time pass, the pace that one of them keeps, and `wait`."""

from __future__ import annotations

import math

import pytest

from polycnc.errors import UsageError
from polycnc.machine import Elapsed, Free, Pace, Poll, RealTime, Step, Way, wait
from support.time_sources import Counter, FakeWall

ANY = 1


def test_step_goes_over_stops_and_does_exactly_its_cycles() -> None:
    device = Counter(stops=(30, 31, 75))
    assert Step(100).run(device, until=ANY) == 100
    assert device.clock.cycles == 100
    assert device.asked == [100, 70, 69, 25]
    assert Step(0).run(device) == 0


def test_step_ends_early_where_the_device_cannot_go_on() -> None:
    device = Counter(stops=(30,), end=40)
    assert Step(100).run(device, until=ANY) == 40
    assert Step(100).run(device) == 0


def test_free_looks_at_its_condition_at_every_stop() -> None:
    device = Counter(stops=(30, 1234))
    free = Free(lambda: device.clock.cycles >= 1234, limit_cycles=10**6)
    assert free.run(device, until=ANY) == 1234
    assert device.asked == [1000, 1000, 1000]


def test_free_does_nothing_when_its_condition_holds_already() -> None:
    device = Counter()
    assert Free(lambda: True, limit_cycles=10).run(device) == 0
    assert device.asked == []


def test_free_ends_at_its_limit_and_where_the_device_cannot_go_on() -> None:
    assert Free(lambda: False, limit_cycles=2500).run(Counter()) == 2500
    assert Free(lambda: False, limit_cycles=2500).run(Counter(end=7)) == 7


def test_wait_looks_at_every_cycle_or_at_every_stop() -> None:
    device = Counter(stops=(30, 1234, 5000))
    assert wait(device, lambda: device.clock.cycles >= 17)
    assert device.clock.cycles == 17
    assert wait(device, lambda: device.clock.cycles >= 31, until=ANY)
    assert device.clock.cycles == 1234
    assert not wait(device, lambda: device.clock.cycles >= 7000, until=ANY, limit_s=4.0)
    assert device.clock.cycles == 5234


@pytest.mark.parametrize("limit_s", [-1.0, math.inf, math.nan])
def test_wait_refuses_a_limit_that_is_no_time(limit_s: float) -> None:
    with pytest.raises(UsageError, match=f"a limit of {limit_s} s"):
        wait(Counter(), lambda: True, limit_s=limit_s)


def test_poll_advances_to_the_next_stop_at_each_call() -> None:
    device = Counter(stops=(30, 31, 5000))
    poll: Way = Poll(limit_cycles=1000)
    assert [poll.run(device, until=ANY) for _ in range(4)] == [30, 1, 1000, 1000]


# --- real time


@pytest.mark.parametrize("rate", [0.5, 1.0, 20.0])
def test_real_time_keeps_pace_although_its_pacer_oversleeps(rate: float) -> None:
    device, wall = Counter(stops=(3, 500)), FakeWall(oversleep_s=0.0017)
    RealTime(wall, Pace(wall, rate), lambda: wall.time_s >= 102.0).run(device)
    assert device.clock.now_s == pytest.approx((wall.time_s - 100.0) * rate, abs=0.012 * rate)
    assert max(wall.naps_s) <= 0.01


def test_real_time_does_not_sleep_while_it_is_behind() -> None:
    wall = FakeWall()

    class Slow(Counter):
        def advance(self, cycles: int, *, until: int | None = None) -> int:
            wall.time_s += 2 * cycles * 0.001  # half as fast as asked for
            return Counter.advance(self, cycles, until=until)

    device = Slow()
    done = RealTime(wall, Pace(wall), lambda: wall.time_s >= 101.0).run(device)
    assert len(wall.naps_s) == 1
    assert done == pytest.approx(500, abs=10)
    assert max(device.asked) <= 10


def test_real_time_ends_where_the_device_cannot_go_on() -> None:
    wall, device = FakeWall(), Counter(end=25)
    assert RealTime(wall, Pace(wall), lambda: False).run(device) == 25


def test_the_rate_changes_freezes_and_steps_while_it_runs() -> None:
    """One condition, looked at once per slice, plays the person at the machine."""
    wall, device = FakeWall(), Counter()
    pace = Pace(wall, 2.0)
    seen: list[tuple[float, int]] = []
    script = {1.0: lambda: setattr(pace, "rate", 0.0), 3.0: lambda: pace.step(37)}
    script |= {4.0: lambda: setattr(pace, "rate", 0.25)}

    def condition() -> bool:
        passed_s = wall.time_s - 100.0
        for at_s in [each for each in script if passed_s >= each]:
            seen.append((at_s, device.clock.cycles))
            script.pop(at_s)()
        return passed_s >= 6.0

    RealTime(wall, pace, condition).run(device)
    assert seen[0][1] == pytest.approx(2000, abs=20)
    assert seen[1] == (3.0, seen[0][1])  # frozen for two seconds
    assert seen[2] == (4.0, seen[0][1] + 37)  # stepped while frozen
    assert device.clock.cycles == pytest.approx(seen[2][1] + 500, abs=4)


def test_a_jump_goes_to_the_next_event_at_once_and_the_pace_goes_on_from_there() -> None:
    wall, device = FakeWall(), Counter(stops=(7_777,))
    pace = Pace(wall)
    pace.jump_to_event()
    RealTime(wall, pace, lambda: device.clock.cycles >= 7_777).run(device, until=ANY)
    assert (device.clock.cycles, wall.naps_s) == (7_777, [])
    RealTime(wall, pace, lambda: wall.time_s >= 100.3).run(device, until=ANY)
    assert device.clock.cycles == pytest.approx(7_777 + 300, abs=11)


def test_a_jump_without_an_event_ends_at_its_limit() -> None:
    wall, device = FakeWall(), Counter()
    pace = Pace(wall, 0.0)
    pace.jump_to_event(limit_cycles=4_321)
    RealTime(wall, pace, lambda: device.clock.cycles > 0).run(device, until=ANY)
    assert device.clock.cycles == 4_321


def test_without_limit_it_runs_as_fast_as_it_can() -> None:
    wall, device = FakeWall(), Counter()
    RealTime(wall, Pace(wall, math.inf), lambda: device.clock.cycles >= 50_000).run(device)
    assert (device.clock.cycles, wall.naps_s) == (50_000, [])


def test_what_was_late_is_not_lost_when_the_rate_changes_but_forgotten_when_it_freezes() -> None:
    wall = FakeWall()
    pace = Pace(wall, 3.0)
    assert pace.due(0.001, 10**9) == 0
    wall.time_s += 0.5
    pace.rate = 2.0
    wall.time_s += 0.25
    assert pace.due(0.001, 10**9) == 1500 + 500
    pace.count(800)
    assert pace.due(0.001, 10**9) == 1200
    assert pace.due(0.002, 10**9) == 600  # a device with another cycle
    pace.rate = 0.0
    assert (pace.due(0.001, 10**9), pace.rate, pace.wait_s(0.001, 10)) == (0, 0.0, math.inf)


def test_nothing_is_due_at_once_when_a_pace_without_limit_gets_one() -> None:
    wall = FakeWall()
    pace = Pace(wall, math.inf)
    assert pace.due(0.001, 77) == 77
    pace.count(77)
    pace.rate = 2.0
    assert pace.due(0.001, 10**9) == 0
    wall.time_s += 0.25
    assert pace.due(0.001, 10**9) == 500


def test_what_passed_before_the_first_question_counts_at_its_own_rate() -> None:
    wall = FakeWall()
    pace = Pace(wall, 3.0)
    wall.time_s += 0.5
    pace.rate = 7.0
    wall.time_s += 0.25
    assert pace.due(0.001, 10**9) == 1500 + 1750


@pytest.mark.parametrize("rate", [-1.0, math.nan])
def test_a_rate_that_cannot_be_is_refused_and_the_old_one_stays(rate: float) -> None:
    pace = Pace(FakeWall(), 1.5)
    with pytest.raises(UsageError, match=f"a rate of {rate}"):
        pace.rate = rate
    with pytest.raises(UsageError, match=f"a rate of {rate}"):
        Pace(FakeWall(), rate)
    with pytest.raises(UsageError, match="-3 cycles"):
        pace.step(-3)
    with pytest.raises(UsageError, match="a jump of 0 cycles"):
        pace.jump_to_event(0)
    assert pace.rate == 1.5


@pytest.mark.parametrize("slice_s", [0.0, math.nan, math.inf])
def test_real_time_refuses_a_slice_that_is_no_time(slice_s: float) -> None:
    wall = FakeWall()
    with pytest.raises(UsageError, match=f"a slice of {slice_s} s"):
        RealTime(wall, Pace(wall), lambda: False, slice_s)


# --- elapsed


def test_elapsed_takes_over_the_time_that_passed_outside_and_loses_no_part_of_a_cycle() -> None:
    wall, device = FakeWall(), Counter(stops=(400,))
    way = Elapsed(wall)
    assert way.run(device) == 0
    passed = 0
    for _ in range(1000):
        wall.time_s += 0.0017
        passed += way.run(device, until=ANY)
    assert passed == device.clock.cycles == pytest.approx(1700, abs=1)


def test_elapsed_has_a_rate_that_changes() -> None:
    wall, device = FakeWall(), Counter()
    way = Elapsed(wall, rate=10.0)
    wall.time_s += 0.5
    way.pace.rate = 0.0
    wall.time_s += 9.0
    assert way.run(device) == 0
    way.pace.rate = 3.0
    wall.time_s += 0.25
    assert way.run(device) == 750
    with pytest.raises(UsageError, match="without limit"):
        Elapsed(wall, math.inf)
