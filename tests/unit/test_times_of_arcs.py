"""Time and way of arcs, spirals and reversals, beside closed forms worked out by hand.

From rest to rest a way s takes s / v + v / a, or 2 sqrt(s / a) where the speed v is not reached.
"""

from __future__ import annotations

import math

import pytest

import polycnc
from polycnc.machine import MachineConfig, parse_toml, validate

A, V = 1000.0, 50.0  # mm/s2, mm/s
CYCLES_S = 0.0025  # an end comes with the next cycle; ramps end in whole ones
AXES = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 90000\n' for name in "XYZ")
MACHINE = validate(
    MachineConfig,
    *parse_toml(f'name = "even"\n[path]\nacceleration_limit_mm_s2 = {A}\n{AXES}', "even.toml"),
)


def rest_to_rest_s(way: float) -> float:
    return way / V + V / A if way >= V * V / A else 2.0 * math.sqrt(way / A)


def time_and_way(program: str) -> tuple[float, float]:
    text = f"G61.1 G21 F{V * 60:g}\n{program}\nM2\n"
    result = polycnc.run(text, machine=MACHINE, dialect="linuxcnc")
    assert not result.alarms, result.alarms
    return result.time_s, result.path_mm


CIRCLES = ("G17 G2 I{0}", "G18 G3 K{0}", "G19 G2 J{0}", "G90.1 G2 I{0} J0", "G91 G3 I{0}")


@pytest.mark.parametrize("circle", CIRCLES)
def test_a_circle_takes_the_same_in_every_plane(circle: str) -> None:
    """The centripetal acceleration of 125 mm/s2 leaves 992 of 1000 mm/s2 along the path: 0.4 ms more."""
    time, way = time_and_way(circle.format(20.0))
    assert way == pytest.approx(math.tau * 20.0, abs=1e-6)
    assert time == pytest.approx(rest_to_rest_s(way), abs=2.0 * CYCLES_S)


def test_a_circle_whose_acceleration_is_mostly_centripetal_takes_the_same_in_every_plane() -> None:
    """833 of 1000 mm/s2, so that its ramps are longer: at 553 mm/s2 where it is fast."""
    found = {time_and_way(circle.format(3.0))[0] for circle in CIRCLES}
    assert len(found) == 1
    ways = math.tau * 3.0
    assert rest_to_rest_s(ways) < found.pop() < ways / V + 2.5 * V / A


@pytest.mark.parametrize("radius", [0.01, 0.0005])
def test_an_arc_that_is_shorter_than_a_cycle_of_its_feed_starts_and_ends_at_rest(radius: float) -> None:
    time, way = time_and_way(f"G2 X{2 * radius} I{radius}")
    assert way == pytest.approx(math.pi * radius, abs=1e-9)
    assert rest_to_rest_s(way) <= time <= 1.6 * rest_to_rest_s(way) + CYCLES_S


def test_a_spiral_goes_from_one_radius_to_the_other() -> None:
    """Half a turn whose radius grows from 50 to 50.04: its way is that of the mean radius."""
    time, way = time_and_way("G2 X100.04 I50")
    assert way == pytest.approx(math.pi * 50.02, abs=1e-3)
    assert time == pytest.approx(rest_to_rest_s(way), abs=2.0 * CYCLES_S)


@pytest.mark.parametrize("mode", ["G61", "G61.1"])
def test_a_reversal_comes_to_rest(mode: str) -> None:
    time, way = time_and_way(f"{mode}\nG1 X10\nX0\nX10")
    assert way == pytest.approx(30.0, abs=1e-6)
    assert time == pytest.approx(3.0 * rest_to_rest_s(10.0), abs=3.0 * CYCLES_S)
