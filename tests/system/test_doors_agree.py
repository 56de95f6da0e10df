"""One machine, four doors: FOCAS, REST, the stream and the sender's status line agree at random instants."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("httpx", reason="pip install httpx")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")
pytest.importorskip("websockets", reason="pip install websockets")

from support.four_doors import FourDoors

PROGRAM = (
    "O0012 (SQUARE)\nN10 G90 G1 F1200. X40. S800 M3\nN20 Y30.\nM98 P13\nM0\nN30 G2 X0 Y0 R30.\nN40 G0 X-20.\n"
    "G4 X2.\nM30\n"
)
PART = "O0013\nN5 G91 G1 X-3. F700.\nY2.5\nG90\nM99\n"
KINDS = {"absolute": 0, "machine": 1}
Act = tuple[str, dict[str, Any]]
FIRST: list[Act] = [
    ("select_mode", {"mode": "auto"}),
    ("select_program", {"program": "O0012"}),
    ("cycle_start", {}),
    ("set_overrides", {"feed": 0.7}),
    ("feed_hold", {}),
    ("cycle_start", {}),
    ("jump", {}),
    ("cycle_start", {}),
    ("emergency_stop", {"on": True}),
    ("emergency_stop", {"on": False}),
    ("reset", {}),
    ("select_mode", {"mode": "mdi"}),
    ("set_mdi", {"text": "G91 G1 X-5.3 Y2. F900.\n"}),
    ("cycle_start", {}),
    ("reset", {}),
    ("set_mdi", {"text": "G1 X[\n"}),
    ("cycle_start", {}),
    ("reset", {}),
    ("select_mode", {"mode": "jog"}),
    ("jog", {"axis": "Y", "direction": 1}),
]
MORE: list[Act] = [
    *[("cycle_start", {})] * 3,
    ("feed_hold", {}),
    ("reset", {}),
    ("jump", {}),
    ("emergency_stop", {"on": True}),
    ("emergency_stop", {"on": False}),
    ("set_overrides", {"feed": 0.4}),
    ("set_overrides", {"feed": 1.3}),
    ("select_mode", {"mode": "auto"}),
    ("select_mode", {"mode": "jog"}),
    ("select_mode", {"mode": "mdi"}),
    ("set_mdi", {"text": "G91 G1 X-5.3 F900.\n"}),
    ("jog", {"axis": "X", "direction": -1}),
    ("jog", {"axis": "X"}),
    ("select_program", {"program": "O0012"}),
    ("set_switches", {"single_block": True}),
    ("set_switches", {"single_block": False}),
    ("key", {"byte": b"!"}),
    ("key", {"byte": b"~"}),
    ("key", {"byte": b"\x92"}),
]


@pytest.fixture(scope="module")
def doors() -> Iterator[FourDoors]:
    made = FourDoors()
    made.clock(rate=0)
    assert made.http.put("/programs/O0012", content=PROGRAM).status_code == 201
    assert made.http.put("/programs/O0013", content=PART).status_code == 201
    yield made
    assert "Traceback" not in made.end()
    assert made.process.returncode == 143


def run_of(channel: dict[str, Any]) -> str:
    """Return the run state as FOCAS has it."""
    if channel["returning"] or channel["run_state"] == "active":
        return "start"
    names = {
        "hold": "hold",
        "stopped at block": "stop",
        "program stop": "stop",
        "optional stop": "stop",
        "alarm": "stop",
    }
    return names.get(channel["run_state"], "reset")


def check(doors: FourDoors) -> str:
    """Assert that all doors say the same of the present cycle; return what it was."""
    status, focas, report = doors.rest(), doors.focas(), doors.report()
    assert doors.rest() == status, "the clock is frozen"
    assert doors.streamed(status["cycle"]) == status
    channel = status["channels"][0]
    feed, override = channel["feed"]["actual"], round(100 * channel["overrides"]["feed"])
    assert focas["mode"] == status["mode"]
    assert focas["run"] == run_of(channel), channel["run_state"]
    assert focas["emergency"] == {"off": 0, "on": 1, "reset needed": 2}[status["emergency"]]
    shown = any(alarm["number"] >= 0 for alarm in status["alarms"])
    assert (focas["alarm"], focas["alarms"]) == (shown, shown)
    axes = status["axes"].values()
    assert focas["machine"] == pytest.approx([axis["machine"] for axis in axes], abs=0.00051)
    assert focas["absolute"] == pytest.approx([axis["work"] for axis in axes], abs=0.00051)
    assert focas["feed"] == pytest.approx(feed, abs=0.51)
    assert focas["override"] == override
    block = channel["block"]
    going = focas["run"] != "reset"
    if block is not None and going and status["mode"] == "auto":
        assert (focas["program"], focas["line"]) == (block["program"], block["line"])
        if block["sequence"] is not None:
            assert focas["sequence"] == block["sequence"]
    state = report["state"]
    assert [float(each) for each in report["MPos"].split(",")] == pytest.approx(focas["machine"], abs=0.0011)
    assert [float(each) for each in report["FS"].split(",")] == pytest.approx(
        [focas["feed"], focas["rpm"]], abs=1.01
    )
    assert int(report["Ov"].split(",")[0]) == override
    is_alarm = bool(status["alarms"]) or status["emergency"] != "off"
    assert (state == "Alarm") is is_alarm
    by_hand = any(axis["manual"] != "none" for axis in axes)
    if by_hand:
        assert is_alarm or state == "Jog"
    elif not is_alarm:
        expected = {"start": {"Run"}, "hold": {"Hold:0", "Hold:1"}, "stop": {"Hold:0", "Hold:1"}}
        assert state in expected.get(focas["run"], {"Idle", "Run"})
    return state if state != "Run" else f"Run {status['mode']}"


def act(doors: FourDoors, name: str, given: dict[str, Any]) -> None:
    """Do something at one of the doors."""
    if name == "jump":
        doors.clock(jump=20_000)
    elif name == "key":
        doors.key(given["byte"])
    else:
        assert doors.command(name, **given) in (200, 404, 409)


def visit(doors: FourDoors, seed: int, first: list[Act], count: int) -> set[str]:
    chosen = random.Random(seed)
    seen: set[str] = set()
    for name, given in [*first, *chosen.choices(MORE, k=count)]:
        act(doors, name, given)
        if chosen.random() < 0.2:  # by the wall clock, at another rate
            doors.clock(rate=chosen.choice([0.3, 1.0, 4.0]))
            doors.rest()
            doors.clock(freeze=True)
        doors.clock(step=chosen.randint(1, 400))
        seen.add(check(doors))
    return seen


def test_all_doors_agree(doors: FourDoors) -> None:
    """Running, held, in single steps, with an alarm, an emergency stop, a program stop, MDI and by hand."""
    seen = visit(doors, 20261124, FIRST, 10)
    assert {"Run auto", "Run mdi", "Hold:0", "Alarm", "Idle", "Jog"} <= seen, seen


@pytest.mark.long
@pytest.mark.parametrize("seed", range(5))
def test_all_doors_agree_at_a_hundred_instants(seed: int, doors: FourDoors) -> None:
    visit(doors, seed, FIRST, 100)


def test_a_moving_machine_is_read_within_the_cycles_of_the_question(doors: FourDoors) -> None:
    """While time passes, what FOCAS says lies between two statuses that were asked for before and after."""
    for name, given in (("emergency_stop", {"on": False}), ("reset", {}), ("select_mode", {"mode": "mdi"}),
                        ("set_overrides", {"feed": 1.0}), ("set_mdi", {"text": "G90 G1 X300. F600.\n"})):  # fmt: skip
        assert doors.command(name, **given) == 200
        doors.clock(step=200)
    assert doors.command("cycle_start") == 200
    doors.clock(rate=1)
    try:
        for _ in range(20):
            before = doors.rest()
            (x, *_), report = doors.focas()["machine"], doors.report()
            after = doors.rest()
            assert before["cycle"] < after["cycle"]
            low, high = (each["axes"]["X"]["machine"] for each in (before, after))
            assert low - 0.001 <= x <= high + 0.001
            assert low - 0.001 <= float(report["MPos"].split(",")[0]) <= high + 0.001
            assert report["state"] == "Run"
    finally:
        doors.clock(freeze=True)
        doors.command("reset")
        doors.clock(step=500)


def test_a_sender_at_a_fanuc_is_told_that_blocks_are_not_taken(doors: FourDoors) -> None:
    doors.clock(step=10)
    before = doors.rest()
    doors.sender.sendall(b"G1 X10 F600\n$J=G91 X5 F100\n$22=1\n$H\n$I\n")
    lines = [doors._reader.readline().decode().strip() for _ in range(11)]
    assert lines.count("error:20") == 4
    assert lines[-1] == "ok"
    assert any("Blocks are not taken: programs are read in dialect" in line for line in lines)
    assert doors.rest() == before
