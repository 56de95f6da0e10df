"""When the calls of a program let time pass."""

from __future__ import annotations

from polycnc.machine import Elapsed, Poll, Polling, Step
from support.time_sources import Counter, FakeWall


def test_time_passes_only_when_the_same_thing_is_read_again_in_a_cycle() -> None:
    device = Counter()
    polling = Polling(Poll(1))
    reads = [("rp", 0), ("rp", 1), ("axst", 0), ("rp", 1), ("rp", 0), ("axst", 0), ("axst", 0)]
    cycles = []
    for each in reads:
        polling.read(device, each)
        cycles.append(device.clock.cycles)
    assert cycles == [0, 0, 0, 1, 1, 1, 2]


def test_what_was_read_before_time_passed_by_itself_counts_no_more() -> None:
    device = Counter()
    polling = Polling(Poll(7))
    assert polling.read(device, "rp") == 0
    device.advance(3)
    assert polling.read(device, "rp") == 0
    assert polling.read(device, "rp") == 7
    assert device.clock.cycles == 10


def test_a_call_that_reads_nothing_lets_no_time_pass() -> None:
    device = Counter()
    polling = Polling(Poll(1))
    assert [polling.call(device) for _ in range(3)] == [0, 0, 0]
    assert polling.let_pass(device, Step(5)) == 5


def test_without_a_way_no_time_passes_at_all() -> None:
    device = Counter()
    polling = Polling(None)
    assert [polling.read(device, "rp") for _ in range(3)] == [0, 0, 0]
    assert polling.let_pass(device, Step(5)) == 0


def test_the_other_devices_are_kept_in_step_although_their_cycles_differ() -> None:
    one, two, three = Counter(cycle_s=0.001), Counter(cycle_s=0.00128), Counter(cycle_s=0.001)
    polling = Polling(Poll(3), lambda: (one, two, three))
    for _ in range(129):
        polling.read(one, "rp")
    assert one.clock.cycles == three.clock.cycles == 3 * 128
    assert two.clock.cycles == 300
    polling.read(two, "rp")
    assert two.clock.cycles == 300  # it was not asked before
    polling.read(two, "rp")
    assert (one.clock.cycles, two.clock.cycles) == (3 * 128 + 3, 303)


def test_the_poll_goes_to_what_ends_it() -> None:
    device = Counter(stops=(41,))
    polling = Polling(Poll(1000))
    assert [polling.read(device, "pe", until=1) for _ in range(3)] == [0, 41, 1000]


def test_with_elapsed_every_call_takes_over_the_time_outside() -> None:
    wall = FakeWall()
    device, other = Counter(), Counter(cycle_s=0.002)
    polling = Polling(Elapsed(wall), lambda: (device, other))
    wall.time_s += 0.25
    assert polling.call(device) == 250
    wall.time_s += 0.01
    assert [polling.read(device, "rp"), polling.read(device, "rp")] == [10, 0]
    wall.time_s += 0.1
    assert polling.read(other, "rp") == 50
    assert (device.clock.cycles, other.clock.cycles) == (360, 180)


def test_time_that_a_call_takes_itself_is_not_counted_twice_with_elapsed() -> None:
    wall, device = FakeWall(), Counter()
    polling = Polling(Elapsed(wall))
    polling.call(device)
    for _ in range(5):
        polling.let_pass(device, Step(1))
    wall.time_s += 0.02
    polling.call(device)
    assert device.clock.cycles == 20


def test_a_jog_of_one_and_a_half_seconds_polled_every_10_ms_takes_as_long_outside() -> None:
    wall = FakeWall()
    device = Counter(stops=(1500,))
    polling = Polling(Elapsed(wall))
    polls = 0
    while True:
        polling.read(device, "pe", until=1)
        if device.clock.cycles >= 1500:
            break
        polls += 1
        wall.sleep_s(0.01)
    assert (polls, round(wall.time_s - 100.0, 9)) == (150, 1.5)
