from datetime import UTC, datetime

import pytest

from polycnc.errors import UsageError
from polycnc.machine._clock import Clock, Free, Poll, RealTime, Step, Way


class Machine:
    """A machine that stops at given cycles, and for good at `end`."""

    def __init__(self, stops: tuple[int, ...] = (), end: int = 10**9) -> None:
        self.clock = Clock(0.001)
        self.stops = (*stops, end)
        self.end = end
        self.asked: list[int] = []

    def advance(self, cycles: int, /) -> int:
        self.asked.append(cycles)
        stop = min((each for each in self.stops if each > self.clock.cycles), default=self.clock.cycles)
        done = min(cycles, stop - self.clock.cycles)
        self.clock.tick(done)
        return done


class FakePacer:
    """A wall clock that only passes while somebody sleeps, each time a little too long."""

    def __init__(self, oversleep_s: float = 0.0) -> None:
        self.time_s = 100.0
        self.oversleep_s = oversleep_s
        self.naps_s: list[float] = []

    def now_s(self) -> float:
        return self.time_s

    def sleep_s(self, duration_s: float) -> None:
        assert duration_s > 0.0
        self.naps_s.append(duration_s)
        self.time_s += duration_s + self.oversleep_s


# --- the clock


def test_time_is_counted_in_cycles_and_does_not_drift() -> None:
    clock = Clock(0.00128)
    for _ in range(1000):
        clock.tick(7)
    assert clock.cycles == 7000
    assert clock.now_s == 7000 * 0.00128
    assert clock.now == datetime(2000, 1, 1, 0, 0, 8, 960_000)


def test_the_date_starts_at_the_epoch_and_can_be_set() -> None:
    clock = Clock(0.001, epoch=datetime(1999, 12, 31, 23, 59, 59))
    clock.tick(1500)
    assert clock.now == datetime(2000, 1, 1, 0, 0, 0, 500_000)
    clock.set_now(datetime(2024, 2, 29, 12))
    assert clock.now == datetime(2024, 2, 29, 12)
    assert (clock.cycles, clock.now_s) == (1500, 1.5)
    clock.tick(250)
    assert clock.now == datetime(2024, 2, 29, 12, 0, 0, 250_000)


def test_what_the_clock_refuses() -> None:
    clock = Clock(0.001)
    with pytest.raises(UsageError, match="time does not run back: -1 cycles"):
        clock.tick(-1)
    with pytest.raises(UsageError, match="no time zone"):
        clock.set_now(datetime(2024, 1, 1, tzinfo=UTC))
    with pytest.raises(AttributeError):
        clock.cycle = 3  # type: ignore[attr-defined]
    assert clock.cycles == 0


@pytest.mark.parametrize(
    ("duration_s", "cycles"),
    [(0.0, 0), (-1.0, 0), (0.001, 1), (0.0011, 2), (0.3, 300), (0.0003, 1), (1e6, 10**9)],
)
def test_a_duration_lasts_whole_cycles(duration_s: float, cycles: int) -> None:
    assert Clock(0.001).cycles_for(duration_s) == cycles


# --- the ways to run


def test_step_goes_over_stops_and_does_exactly_its_cycles() -> None:
    machine = Machine(stops=(30, 31, 75))
    assert Step(100).run(machine.advance) == 100
    assert machine.clock.cycles == 100
    assert machine.asked == [100, 70, 69, 25]
    assert Step(0).run(machine.advance) == 0


def test_step_ends_early_where_the_machine_cannot_go_on() -> None:
    machine = Machine(stops=(30,), end=40)
    assert Step(100).run(machine.advance) == 40
    assert Step(100).run(machine.advance) == 0


def test_free_looks_at_its_condition_at_every_stop() -> None:
    machine = Machine(stops=(30, 1234))
    assert Free(lambda: machine.clock.cycles >= 1234, limit_cycles=10**6).run(machine.advance) == 1234
    assert machine.asked == [1000, 1000, 1000]


def test_free_does_nothing_when_its_condition_holds_already() -> None:
    machine = Machine()
    assert Free(lambda: True, limit_cycles=10).run(machine.advance) == 0
    assert machine.asked == []


def test_free_ends_at_its_limit_and_where_the_machine_cannot_go_on() -> None:
    assert Free(lambda: False, limit_cycles=2500).run(Machine().advance) == 2500
    assert Free(lambda: False, limit_cycles=2500).run(Machine(end=7).advance) == 7


@pytest.mark.parametrize("rate", [0.5, 1.0, 20.0])
def test_real_time_keeps_pace_with_its_pacer_although_it_oversleeps(rate: float) -> None:
    machine, pacer = Machine(stops=(3, 500)), FakePacer(oversleep_s=0.0017)
    RealTime(pacer, 0.001, until=lambda: pacer.time_s >= 102.0, rate=rate).run(machine.advance)
    passed_s = pacer.time_s - 100.0
    assert machine.clock.now_s == pytest.approx(passed_s * rate, abs=0.012 * rate)
    assert max(pacer.naps_s) <= 0.01


def test_real_time_does_not_sleep_while_it_is_behind() -> None:
    machine, pacer = Machine(), FakePacer()

    def slow_advance(cycles: int, /) -> int:
        pacer.time_s += 2 * cycles * 0.001  # half as fast as asked for
        return machine.advance(cycles)

    done = RealTime(pacer, 0.001, until=lambda: pacer.time_s >= 101.0).run(slow_advance)
    assert len(pacer.naps_s) == 1
    assert done == pytest.approx(500, abs=10)
    assert max(machine.asked) <= 10


def test_real_time_ends_where_the_machine_cannot_go_on() -> None:
    machine = Machine(end=25)
    assert RealTime(FakePacer(), 0.001, until=lambda: False).run(machine.advance) == 25


@pytest.mark.parametrize(
    ("cycle_s", "rate", "slice_s"),
    [(0.001, 0.0, 0.01), (0.001, -1.0, 0.01), (0.001, 1.0, 0.0), (0.0, 1.0, 0.01)],
)
def test_real_time_refuses_a_rate_that_never_arrives(cycle_s: float, rate: float, slice_s: float) -> None:
    with pytest.raises(UsageError, match="must be greater than 0\nuse Free"):
        RealTime(FakePacer(), cycle_s, until=lambda: False, rate=rate, slice_s=slice_s)


def test_poll_advances_to_the_next_event_at_each_call() -> None:
    machine = Machine(stops=(30, 31, 5000))
    poll: Way = Poll(limit_cycles=1000)
    assert [poll.run(machine.advance) for _ in range(4)] == [30, 1, 1000, 1000]
