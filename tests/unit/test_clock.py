from datetime import UTC, datetime

import pytest

from polycnc.errors import UsageError
from polycnc.machine import Clock

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
