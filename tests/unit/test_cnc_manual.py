"""Axes moved by hand: where they come to rest, what keeps them from moving, and what is left behind."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from polycnc.cnc import AlarmList, ControlError, ManualData, ManualKind, ManualMotion, Refusal
from polycnc.errors import UsageError
from polycnc.kernel import REFERENCE
from polycnc.machine import Machine
from support.cnc_machine import B, X, Y, Z, cnc_machine
from support.often import share


class Rig:
    """A machine moved by hand."""

    def __init__(self, data: ManualData | None = None, *, referenced: bool = True, **keys: object) -> None:
        self.machine = Machine(cnc_machine(**keys), record_cycles=20_000)
        self.alarms = AlarmList(self.machine.memory, self.machine.clock)
        self.manual = ManualMotion(self.machine, self.alarms, data, referenced=referenced)

    def run(self, cycles: int) -> None:
        while cycles > 0:
            done = self.machine.advance(min(cycles, self.manual.horizon()), until=ManualMotion.REASONS)
            cycles -= done
            self.manual.after()

    def at(self, axis: str) -> float:
        return self.machine.setpoints[axis]

    def record(self, axis: int) -> np.ndarray:
        recorder = self.machine.state.recorder
        return recorder.rows[: int(recorder.filled[0]), 4 + axis].copy()


def refused(reason: Refusal, call: Callable[[], object]) -> None:
    with pytest.raises(ControlError) as caught:
        call()
    assert caught.value.reason is reason


def test_a_jog_runs_until_the_key_is_let_go_and_brakes_to_rest() -> None:
    rig = Rig()
    rig.manual.jog("X", 1)
    rig.run(500)
    # 24 mm/s after 24/700 s; half of that time is lost on the way up.
    assert rig.at("X") == pytest.approx(12.5 + 24.0 * 0.5 - 24.0**2 / 1400.0)
    rig.manual.jog("X", None)
    rig.run(5)
    assert rig.manual.motion("X").stopping
    rig.run(95)
    assert rig.at("X") == pytest.approx(12.5 + 12.0)
    assert not rig.manual.active
    assert rig.alarms.active == ()


def test_a_jog_comes_to_rest_on_the_software_limit_to_the_last_bit_and_says_so() -> None:
    rig = Rig()
    rig.manual.jog("X", 1, rapid=True)
    rig.run(3000)
    assert rig.at("X") == 80.0
    assert rig.record(0).max() == 80.0
    assert [(alarm.number, alarm.axis) for alarm in rig.alarms.active] == [(211, "X")]
    refused(Refusal.TRAVEL, lambda: rig.manual.jog("X", 1))
    rig.manual.jog("X", -1)
    rig.run(100)
    assert rig.at("X") < 80.0


def test_an_endless_axis_jogs_on_and_on() -> None:
    rig = Rig()
    rig.manual.jog("B", -1)
    rig.run(20_000)
    # 18 deg/s, 0.05 s of ramp.
    assert rig.at("B") == pytest.approx(-(18.0 * 20.0 - 0.5 * 18.0 * 0.05))
    rig.manual.set_overrides(feed=2.0)
    rig.run(1000)
    assert rig.machine.state.velocity[3] == pytest.approx(-36.0)
    rig.manual.jog("B", 1)
    rig.run(1000)
    assert rig.machine.state.velocity[3] == pytest.approx(36.0)
    rig.manual.jog("B", 0)
    rig.run(1000)
    assert rig.machine.state.velocity[3] == 0.0


def test_an_override_of_0_holds_a_jog_and_lets_it_go_on() -> None:
    rig = Rig()
    rig.manual.jog("X", 1)
    rig.run(300)
    rig.manual.set_overrides(feed=0.0)
    rig.run(300)
    here = rig.at("X")
    assert rig.manual.motion("X").kind is ManualKind.JOG
    rig.run(100)
    assert rig.at("X") == here
    rig.manual.set_overrides(feed=0.5)
    rig.run(300)
    assert rig.machine.state.velocity[0] == pytest.approx(12.0)
    rig.manual.set_overrides(feed=0.0)
    rig.manual.jog("X", None)
    rig.run(300)
    assert not rig.manual.active
    rig.manual.set_overrides(feed=1.0)
    here = rig.at("X")
    rig.run(300)
    assert rig.at("X") == here


def test_each_override_stays_when_the_other_is_set() -> None:
    rig = Rig()
    rig.manual.set_overrides(rapid=0.35)
    rig.manual.set_overrides(feed=0.25)
    speeds = []
    for rapid in (True, False):
        rig.manual.jog("X", 1, rapid=rapid)
        rig.run(300)
        speeds.append(rig.machine.state.velocity[0])
        rig.manual.jog("X", None)
        rig.run(300)
    assert speeds == pytest.approx([0.35 * 120.0, 0.25 * 24.0])


def test_increments_are_exact_and_stop_at_the_limit() -> None:
    rig = Rig()
    rig.manual.increment("Z", -1, 0.125)
    refused(Refusal.RUNNING, lambda: rig.manual.increment("Z", -1, 0.125))
    refused(Refusal.RUNNING, lambda: rig.manual.jog("Z", -1))
    rig.run(400)
    assert rig.at("Z") == 2.875
    rig.manual.increment("Z", 1, 5.0)
    rig.run(3000)
    assert rig.at("Z") == 5.0
    assert [(alarm.number, alarm.axis) for alarm in rig.alarms.active] == [(211, "Z")]


def test_an_increment_that_ends_on_the_limit_is_no_alarm() -> None:
    rig = Rig()
    rig.manual.increment("Z", 1, 2.0)
    rig.run(3000)
    assert rig.at("Z") == 5.0
    assert rig.alarms.active == ()


def test_the_handwheel_adds_up_pulses_and_loses_those_beyond_the_limit() -> None:
    rig = Rig()
    for _ in range(10):
        rig.manual.handwheel("Y", 7, 0.01)
        rig.run(3)
    rig.run(1000)
    assert rig.at("Y") == pytest.approx(0.7)
    rig.manual.handwheel("Y", 100_000, 0.1)
    rig.run(100)
    rig.manual.handwheel("Y", 5, 0.1)
    rig.manual.handwheel("Y", -25, 0.1)
    rig.run(3000)
    assert rig.at("Y") == pytest.approx(27.5)
    assert rig.alarms.active == ()
    rig.manual.handwheel("Y", 0, 0.1)
    assert not rig.manual.active


@pytest.mark.parametrize(
    ("axis", "start", "edge"), [("X", 12.5, -41.0), ("X", -47.0, -41.0), ("Y", 0.0, 21.0)]
)
def test_a_reference_search_finds_its_marks_and_ends_at_home(axis: str, start: float, edge: float) -> None:
    rig = Rig(referenced=False, start={axis: start})
    rig.manual.reference(axis)
    lowest = highest = start
    for _ in range(40):
        rig.run(500)
        lowest, highest = min(lowest, rig.at(axis)), max(highest, rig.at(axis))
        if not rig.manual.active:
            break
    assert rig.manual.referenced[axis]
    assert rig.at(axis) == (12.5 if axis == "X" else 0.0)
    assert rig.record("XY".index(axis)).min() < edge
    marks = rig.machine.state.switches.marks["XY".index(axis)]
    assert marks["index_latch"] == (-37.5 if axis == "X" else 17.25)
    assert marks["index_armed"] == 0
    assert rig.alarms.active == ()


def test_an_axis_without_marks_goes_straight_to_its_reference_position() -> None:
    rig = Rig(referenced=False, start={"Z": -40.0})
    rig.manual.reference("Z")
    rig.run(100)
    assert not rig.manual.referenced["Z"]
    rig.run(5000)
    assert (rig.at("Z"), rig.manual.referenced["Z"]) == (3.0, True)
    rig.manual.jog("X", -1)
    rig.run(2000)
    rig.manual.jog("X", 0)
    rig.run(200)
    # Referenced once, X goes straight; the switch is not visited.
    rig.manual.reference("X")
    rig.run(20000)
    assert rig.manual.referenced["X"]


def test_a_search_that_is_stopped_leaves_the_axis_unreferenced_and_nothing_armed() -> None:
    rig = Rig(ManualData(search_again=True))
    rig.manual.reference("X")
    refused(Refusal.RUNNING, lambda: rig.manual.jog("X", 1))
    marks = rig.machine.state.switches.marks[0]
    for _ in range(10_000):
        rig.run(1)
        if marks["index_armed"]:
            break
    rig.manual.stop("X")
    assert marks["index_armed"] == 0
    rig.run(1000)
    assert not rig.manual.active
    assert not rig.manual.referenced["X"]
    assert rig.manual.referenced["Y"]


def test_a_search_holds_at_rapid_override_0_and_goes_on() -> None:
    rig = Rig(referenced=False)
    rig.manual.reference("X")
    rig.run(100)
    rig.manual.set_overrides(rapid=0.0)
    rig.run(500)
    assert rig.machine.state.velocity[0] == 0.0
    assert rig.manual.active
    rig.manual.set_overrides(rapid=0.25)
    rig.run(60_000)
    assert rig.manual.referenced["X"]


def test_a_search_that_finds_nothing_ends_with_an_alarm() -> None:
    rig = Rig(referenced=False)
    rig.machine.state.switches.switch[1]["on_from"] = np.inf  # the switch of Y is broken
    rig.machine.state.switches.switch[1]["on_to"] = -np.inf
    rig.manual.reference("Y")
    rig.run(10_000)
    assert [(alarm.number, alarm.axis) for alarm in rig.alarms.active] == [(220, "Y")]
    assert "reference switch" in rig.alarms.active[0].text
    assert not rig.manual.active
    assert not rig.manual.referenced["Y"]


@pytest.mark.parametrize(("axis", "start", "end"), [("Y", 0.0, -33.5), ("X", 12.5, -53.5)])
def test_a_search_that_finds_nothing_gives_up_a_margin_behind_all_there_is(
    axis: str, start: float, end: float
) -> None:
    x = {name: value for name, value in X.items() if name != "limit_switches_mm"}
    rig = Rig(ManualData(search_margin=3.5), referenced=False, axis=(x, Y, Z, B))
    rig.machine.state.switches.switch["XYZ".index(axis), REFERENCE]["on_from"] = np.inf
    rig.machine.state.switches.switch["XYZ".index(axis), REFERENCE]["on_to"] = -np.inf
    assert rig.at(axis) == start
    rig.manual.reference(axis)
    rig.run(20_000)
    assert rig.at(axis) == end
    assert [(alarm.number, alarm.axis) for alarm in rig.alarms.active] == [(220, axis)]


def test_a_limit_switch_stops_everything_and_the_axis_can_only_leave_it() -> None:
    rig = Rig(referenced=False)
    rig.manual.jog("X", 1, rapid=True)
    rig.manual.jog("B", 1)
    rig.run(3000)
    stood = rig.at("X")
    assert 95.0 < stood < 95.0 + 120.0**2 / 1400.0 + 0.2
    assert [(alarm.number, alarm.axis) for alarm in rig.alarms.active] == [(213, "X")]
    assert not rig.manual.active
    refused(Refusal.TRAVEL, lambda: rig.manual.jog("X", 1))
    refused(Refusal.TRAVEL, lambda: rig.manual.increment("X", 1, 0.1))
    refused(Refusal.TRAVEL, lambda: rig.manual.handwheel("X", 1, 0.1))
    refused(Refusal.TRAVEL, lambda: rig.manual.go_to("X", 200.0))
    rig.alarms.reset()
    assert rig.manual.check_limit_switches()
    rig.manual.jog("X", -1)
    rig.run(2000)
    rig.manual.jog("X", None)
    rig.run(200)
    rig.alarms.reset()
    assert not rig.manual.check_limit_switches()


def test_a_machine_that_is_switched_on_on_a_limit_switch_knows_it() -> None:
    rig = Rig(referenced=False)
    rig.machine.state.switches.switch[0][1]["on_from"] = 12.0
    assert rig.manual.check_limit_switches()
    refused(Refusal.TRAVEL, lambda: rig.manual.jog("X", 1))
    other = Rig(referenced=False)
    other.machine.state.switches.switch[1][0]["on_to"] = 2.5  # of Y alone, below
    other.machine.state.switches.switch[1][0]["on_from"] = -99.0
    assert other.manual.check_limit_switches()
    assert [(alarm.number, alarm.axis) for alarm in other.alarms.active] == [(212, "Y")]
    refused(Refusal.TRAVEL, lambda: other.manual.jog("Y", -1))
    assert not other.manual.blocked("Y", 1)
    assert not other.manual.blocked("X", -1)
    other.manual.jog("Y", 1)


def test_what_cannot_be_meant_is_refused_and_moves_nothing() -> None:
    rig = Rig()
    before = rig.manual.snapshot()
    for call in (
        lambda: rig.manual.jog("W", 1),
        lambda: rig.manual.jog("X", 2),
        lambda: rig.manual.increment("X", 1, 0.0),
        lambda: rig.manual.increment("X", 1, float("nan")),
        lambda: rig.manual.increment("X", 0, 1.0),
        lambda: rig.manual.handwheel("X", 1, -1.0),
        lambda: rig.manual.handwheel("X", 10**300, 1e300),
        lambda: rig.manual.reference("W"),
        lambda: rig.manual.stop("W"),
    ):
        refused(Refusal.DATA, call)
    refused(Refusal.TRAVEL, lambda: rig.manual.go_to("X", 80.001))
    refused(Refusal.TRAVEL, lambda: rig.manual.go_to("X", float("nan")))
    rig.machine.state.owner[2] = 0
    refused(Refusal.RUNNING, lambda: rig.manual.jog("Z", 1))
    refused(Refusal.RUNNING, lambda: rig.manual.reference("Z"))
    assert rig.manual.snapshot() == before
    rig.run(50)
    assert rig.at("X") == 12.5
    with pytest.raises(UsageError, match="moves nothing"):
        ManualData(jog_speeds={"X": 0.0})


def test_a_handwheel_turned_back_just_before_the_software_limit_waits_for_the_rest_there() -> None:
    """With S-shaped ramps a new profile would brake later than the one that is nearly over."""
    rig = Rig(path={"jerkrel": 0.6})
    rig.manual.handwheel("X", -170, 0.37)  # far beyond -50
    while rig.at("X") > -48.5:
        rig.run(1)
    assert rig.at("X") > -50.0
    rig.manual.handwheel("X", 11, 0.37)
    rig.run(2000)
    assert rig.record(0).min() == -50.0
    assert rig.at("X") == pytest.approx(-50.0 + 11 * 0.37, abs=1e-12)
    assert not rig.manual.active


COMMANDS = st.lists(
    st.tuples(
        st.sampled_from(
            ("up", "down", "rapid", "release", "handle", "increment", "feed", "stop", "reference")
        ),
        st.integers(1, 260),
        st.floats(0.0, 2.0),
    ),
    min_size=1,
    max_size=14,
)


@settings(max_examples=share(60))
@example(commands=[("handle", 1, 0.0), ("up", 186, 0.0), ("handle", 74, 0.0), ("up", 260, 0.0)], jerkrel=0.6)
@given(commands=COMMANDS, jerkrel=st.sampled_from((0.0, 0.6)))
def test_whatever_the_operator_does_no_axis_breaks_a_limit_in_any_cycle(
    commands: list[tuple[str, int, float]], jerkrel: float
) -> None:
    rig = Rig(path={"jerkrel": jerkrel})
    manual = rig.manual
    for what, cycles, amount in commands:
        calls: dict[str, Callable[[], object]] = {
            "up": lambda: manual.jog("X", 1),
            "down": lambda: manual.jog("X", -1),
            "rapid": lambda: manual.jog("X", 1, rapid=True),
            "release": lambda: manual.jog("X", None),
            "handle": lambda a=amount: manual.handwheel("X", int(a * 90) - 90, 0.37),  # type: ignore[misc]
            "increment": lambda a=amount: manual.increment("X", -1, 20.0 * a + 0.001),  # type: ignore[misc]
            "feed": lambda a=amount: manual.set_overrides(feed=a, rapid=a / 2.0),  # type: ignore[misc]
            "stop": lambda: manual.stop("X"),
            "reference": lambda: manual.reference("X"),
        }
        with suppress(ControlError):
            calls[what]()
        rig.run(cycles)
    manual.set_overrides(feed=1.0, rapid=1.0)
    manual.stop_all()
    rig.run(400)
    assert not manual.active
    positions = np.concatenate(([12.5, 12.5], rig.record(0)))
    speeds = np.diff(positions) / 0.001
    assert np.abs(speeds).max() <= 120.0 * (1.0 + 1e-9)
    assert np.abs(np.diff(speeds)).max() <= 0.7 * (1.0 + 1e-6)
    assert positions.max() <= 80.0
    assert positions.min() >= -50.0
    assert speeds[-1] == 0.0


def test_overrides_are_those_of_an_axis() -> None:
    rig = Rig()
    rig.manual.set_overrides(feed=0.5, axes=["X"])
    rig.manual.set_overrides(rapid=0.25, axes=["Y"])
    speeds = {}
    for rapid in (False, True):
        for axis in "XYZ":
            rig.manual.jog(axis, -1, rapid=rapid)
        rig.run(300)
        speeds[rapid] = rig.machine.state.velocity[:3].tolist()
        rig.manual.stop_all()
        rig.run(400)
    # Jogging goes with 0.2 of 120, 90 and 60 mm/s.
    assert speeds[False] == pytest.approx([-0.5 * 24.0, -18.0, -12.0])
    assert speeds[True] == pytest.approx([-120.0, -0.25 * 90.0, -60.0])
    rig.manual.set_overrides(axes=["Z"], feed=0.1)
    assert rig.manual.snapshot().feed_overrides == (0.5, 1.0, 0.1, 1.0)
    assert rig.manual.snapshot().rapid_overrides == (1.0, 0.25, 1.0, 1.0)


def test_how_fast_each_command_moves() -> None:
    rig = Rig(ManualData(jog_speeds={"Y": 7.0, "Z": 500.0}, jog_share=0.3))

    def speed(axis: str) -> float:
        rig.run(250)
        found = abs(rig.machine.state.velocity["XYZB".index(axis)])
        rig.manual.stop(axis)
        rig.run(400)
        assert not rig.manual.moves([axis])
        return float(found)

    rig.manual.go_to("X", -48.0)
    assert speed("X") == pytest.approx(0.3 * 120.0)
    rig.manual.go_to("X", 79.0, rapid=True)
    assert speed("X") == pytest.approx(120.0)
    rig.manual.increment("X", -1, 60.0)
    assert speed("X") == pytest.approx(36.0)
    rig.manual.increment("X", 1, 60.0, rapid=True)
    assert speed("X") == pytest.approx(120.0)
    rig.manual.jog("Y", 1)
    assert speed("Y") == pytest.approx(7.0)
    rig.manual.jog("Z", -1)
    assert speed("Z") == pytest.approx(60.0)  # no faster than it can
    rig.manual.set_overrides(feed=0.1, rapid=0.1)
    rig.manual.handwheel("X", -500, 0.1)
    assert speed("X") == pytest.approx(120.0)  # it follows the hand
