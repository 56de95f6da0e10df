"""One machine, all doors: whatever it does, at every instant they say the same; the clock is frozen meanwhile."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from decimal import ROUND_HALF_UP, Decimal
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("httpx", reason="pip install httpx")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")
pytest.importorskip("websockets", reason="pip install websockets")

pytest.importorskip("asyncua", reason="pip install 'polycnc[opcua]'")

from polycnc.servers.process import DOORS
from polycnc.servers.setup import Flags, plan_of
from support.all_doors import AllDoors
from support.browser import browser
from support.command import script
from support.plant_doors import Page

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
def doors() -> Iterator[AllDoors]:
    made = AllDoors()
    made.clock(rate=0)
    assert made.http.put("/programs/O0012", content=PROGRAM).status_code == 201
    assert made.http.put("/programs/O0013", content=PART).status_code == 201
    yield made
    assert "Traceback" not in made.end()
    assert made.process.returncode == 143


@pytest.fixture(scope="module")
def page(doors: AllDoors) -> Iterator[Page]:
    with browser() as running:
        yield Page(running, doors.said["http:"])


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


def check(doors: AllDoors, page: Page | None = None) -> str:
    """Assert that all doors say the same of the present cycle; return what it was."""
    status, focas, report = doors.rest(), doors.focas(), doors.report()
    observed, sent, read = doors.agent.current(), doors.shdr.sync(), doors.opcua.read()
    check_observed(status, observed)
    assert {name: observed[name] for name in sent} == sent
    check_read(status, read)
    if page is not None:
        expected = page_of(status)
        assert page.comes_to(expected), {
            k: (v, page.shows()[k]) for k, v in expected.items() if page.shows()[k] != v
        }
    assert doors.rest() == status, "the clock is frozen"
    assert doors.streamed(status["cycle"]) == status
    return check_machine_doors(status, focas, report)


EXECUTIONS = {
    "ready": "READY", "reset": "STOPPED", "active": "ACTIVE", "hold": "FEED_HOLD", "alarm": "STOPPED",
    "stopped at block": "INTERRUPTED", "program stop": "PROGRAM_STOPPED", "optional stop": "OPTIONAL_STOP",
    "completed": "PROGRAM_COMPLETED",
}  # fmt: skip
MODES = {"auto": "AUTOMATIC", "mdi": "MANUAL_DATA_INPUT", "edit": "EDIT"}


def execution_of(channel: dict[str, Any]) -> str:
    """Return the execution as MTConnect has it."""
    is_active = channel["run_state"] == "active" or channel["returning"]
    return "ACTIVE" if is_active else EXECUTIONS[channel["run_state"]]


def number(value: str) -> float:
    """Return what an agent says as a number."""
    return float("nan") if value == "UNAVAILABLE" else float(value)


def check_observed(status: dict[str, Any], observed: dict[str, str]) -> None:
    """Compare what MTConnect says with a status."""
    channel = status["channels"][0]
    block = channel["block"]
    assert observed["execution"] == execution_of(channel)
    assert observed["mode"] == MODES.get(status["mode"], "MANUAL")
    assert observed["estop"] == ("TRIGGERED" if status["emergency"] == "on" else "ARMED")
    assert observed["program"] == (channel["program"] or "UNAVAILABLE")
    assert observed["line"] == (str(block["line"]) if block else "UNAVAILABLE")
    assert observed["block"] == (block["text"].strip() if block and block["text"].strip() else "UNAVAILABLE")
    assert number(observed["Fovr"]) == pytest.approx(100 * channel["overrides"]["feed"])
    assert number(observed["path_feedrate"]) == pytest.approx(channel["feed"]["actual"] / 60, abs=1e-4)
    assert number(observed["S1speed"]) == pytest.approx(abs(status["spindle"]["actual_rpm"]), abs=1e-4)
    assert number(observed["part_count"]) == status["parts"]["made"]
    for name, axis in status["axes"].items():
        assert number(observed[f"{name}act"]) == pytest.approx(axis["machine"], abs=1e-4)
        assert number(observed[f"{name}com"]) == pytest.approx(axis["setpoint"], abs=1e-4)
        assert number(observed[f"{name}work"]) == pytest.approx(axis["work"], abs=1e-4)
    conditions = {name for name, level in observed.items() if level == "Fault"}
    assert bool(conditions) is bool(status["alarms"]), conditions


OPERATION = {"auto": 2, "edit": 2, "mdi": 1}
CHANNEL_MODES = {"auto": 0, "mdi": 1, "jog": 2, "inc": 3, "handle": 3, "ref": 6, "edit": 7}
PROGRAM_STATES = {"hold": 3, "reset": 4, "alarm": 4}
PRODUCTION = {"ready": 0, "completed": 2, "reset": 4, "alarm": 4}
CHANNEL_STATES = {"hold": 1, "stopped at block": 1, "program stop": 1, "optional stop": 1, "alarm": 1}


def check_read(status: dict[str, Any], read: dict[str, Any]) -> None:
    """Compare what OPC UA says with a status, in both of its views."""
    channel = status["channels"][0]
    block, state = channel["block"], channel["run_state"]
    is_active = execution_of(channel) == "ACTIVE"
    assert read["ActOperationMode"] == OPERATION.get(status["mode"], 0)
    assert read["ChannelMode"] == CHANNEL_MODES[status["mode"]]
    assert read["ActProgramStatus"] == (1 if is_active else PROGRAM_STATES.get(state, 0))
    assert read["Production"] == (1 if is_active else PRODUCTION.get(state, 3))
    busy = is_active or channel["motion"] != "none"
    assert read["ActStatus"] == read["ChannelState"] == CHANNEL_STATES.get(state, 0 if busy else 2)
    assert read["FeedHold"] is (state == "hold")
    assert read["BlockMode"] is channel["switches"]["single_block"]
    assert read["ActProgramName"] == (block["program"] if block else channel["program"] or "")
    assert read["ActProgramLine"] == (str(block["line"]) if block else "")
    assert read["ActProgramBlock"] == ([block["text"]] if block else [])
    assert read["ActFeedrate"] == channel["feed"]["actual"]
    assert read["ActOverride"] == read["FeedOverride"] == 100 * channel["overrides"]["feed"]
    parts = status["parts"]
    lot_ended = read["Production"] == 2 and parts["made"] >= parts["required"]
    job = {
        "Identifier": channel["program"], "RunsPlanned": parts["required"], "RunsCompleted": parts["made"],
        "RunsPlanned/IsValid": parts["required"] != 0, "ProductionPrograms/Program1/Name": channel["program"],
        "State/CurrentState/Number": 3 if read["Production"] == 2 and not lot_ended else read["Production"],
    }  # fmt: skip
    assert read["ActiveJob"] == (channel["program"] or "")
    assert {name.removeprefix("job "): value for name, value in read.items() if name.startswith("job ")} == (
        job if channel["program"] else dict.fromkeys(job)
    )
    assert read["ActSpeed"] == abs(status["spindle"]["actual_rpm"])
    assert read["ToolId"] == channel["tool"]["number"]
    for name, axis in status["axes"].items():
        found = tuple(read[f"{name}/{part}"] for part in ("ActPos", "CmdPos", "RemDist"))
        assert found == (axis["machine"], axis["setpoint"], axis["to_go"])


def page_of(status: dict[str, Any]) -> dict[str, Any]:
    """Return what the page shall show of a status."""
    channel = status["channels"][0]
    block = channel["block"]
    over = channel["run_state"] in ("ready", "reset", "completed")
    text = channel["program"] if over or block is None else block["program"]  # whose lines are shown
    own = block is not None and block["program"] == text != "MDI"
    calls = [f"{each['program']}:{each['line']}" for each in (block["stack"] if block else ())]
    axes = [status["axes"][name] for name in "XYZ"]
    return {
        "mode": status["mode"],
        "run": channel["run_state"],
        "machine": [shown(axis["machine"]) for axis in axes],
        "work": [shown(axis["work"]) for axis in axes],
        "override": f"{round(100 * channel['overrides']['feed'])} %",
        "alarms": [
            f"{each['number']} {each['text']}" if each["number"] >= 0 else each["text"]
            for each in status["alarms"]
        ],
        "program": " › ".join(
            [*calls, block["program"] if block else channel["program"] or "No program selected"]
        ),
        "line": block["line"] if own else 0,
        "stopped": status["emergency"] == "on",
        "lost": False,
    }


def shown(value: float) -> float:
    """Return a position as the page rounds it: exactly, ties away from zero."""
    exact = Decimal(value).quantize(Decimal("0.001"), ROUND_HALF_UP)
    return float(exact) + 0.0 or 0


def check_machine_doors(status: dict[str, Any], focas: dict[str, Any], report: dict[str, str]) -> str:
    """Compare what FOCAS and the sender's line say with a status; return what it was."""
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


def act(doors: AllDoors, name: str, given: dict[str, Any]) -> None:
    """Do something at one of the doors."""
    if name == "jump":
        doors.clock(jump=20_000)
    elif name == "key":
        doors.key(given["byte"])
    else:
        assert doors.command(name, **given) in (200, 404, 409)


def visit(doors: AllDoors, page: Page | None, seed: int, first: list[Act], count: int) -> set[str]:
    chosen = random.Random(seed)
    seen: set[str] = set()
    for name, given in [*first, *chosen.choices(MORE, k=count)]:
        act(doors, name, given)
        if chosen.random() < 0.2:  # by the wall clock, at another rate
            doors.clock(rate=chosen.choice([0.3, 1.0, 4.0]))
            doors.rest()
            doors.clock(freeze=True)
        doors.clock(step=chosen.randint(1, 400))
        seen.add(check(doors, page))
    return seen


def test_all_doors_agree_at_a_hundred_instants(doors: AllDoors) -> None:
    """Running, held, in single steps, with an alarm, an emergency stop, a program stop, MDI and by hand."""
    seen = visit(doors, None, 20261124, FIRST, 80)
    assert {"Run auto", "Run mdi", "Hold:0", "Alarm", "Idle", "Jog"} <= seen, seen


def test_the_page_agrees_with_the_doors(doors: AllDoors, page: Page) -> None:
    visit(doors, page, 20261125, FIRST, 20)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(5))
def test_all_doors_agree_at_many_instants(seed: int, doors: AllDoors, page: Page) -> None:
    visit(doors, page, seed, FIRST, 100)


def test_a_moving_machine_is_read_within_the_cycles_of_the_question(doors: AllDoors) -> None:
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


def test_all_doors_have_the_same_tools(doors: AllDoors) -> None:
    for number, length_mm in ((17, 83.25), (4, 61.5), (30, 7.125), (4, None)):
        if length_mm is None:
            assert doors.http.delete(f"/tools/{number}").status_code == 204
        else:
            assert doors.http.put(f"/tools/{number}", json={"length_mm": length_mm}).status_code == 200
        there = {int(number): tool["description"] for number, tool in doors.http.get("/tools").json().items()}
        expected = {f"machine.T{number}": (number, name) for number, name in there.items()}
        assert doors.opcua.tools() == expected
        _, document = doors.agent.get("/assets")
        assert set(re.findall(rb' assetId="([^"]+)"', document)) == {name.encode() for name in expected}


def test_a_sender_at_a_fanuc_is_told_that_blocks_are_not_taken(doors: AllDoors) -> None:
    doors.clock(step=10)
    before = doors.rest()
    doors.sender.sendall(b"G1 X10 F600\n$J=G91 X5 F100\n$22=1\n$H\n$I\n")
    lines = [doors._reader.readline().decode().strip() for _ in range(11)]
    assert lines.count("error:20") == 4
    assert lines[-1] == "ok"
    assert any("Blocks are not taken: programs are read in dialect" in line for line in lines)
    assert doors.rest() == before


def test_what_the_tutorial_shows(doors: AllDoors, tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/tutorials/a-machine-with-seven-doors.md").read_text("utf-8")
    shown = dict(re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', page, re.DOTALL))
    (tmp_path / "O0012.nc").write_text(shown["O0012.nc"])
    kinds = {"fanuc": "", "plain": None, "bosch": None, "apci": None, "imc": None}
    plan = plan_of(Flags(None, kinds, doors="all", program=tmp_path / "O0012.nc"))
    names = [row.name for row, _ in (*plan.machines[0].doors, *plan.shared)]
    said = dict(line.split(": ", 1) for line in shown["says"].splitlines())
    assert list(said) == names
    assert {name: at.rpartition(":")[2] for name, at in said.items()} == {
        row.name: str(row.port) for row in DOORS.values()
    }
    doors.sender.close()  # there is one sender at a time
    doors._reader.close()
    doors.clock(rate=1)
    text = shown["ask_all.py"]
    for name, at in said.items():
        if name != "calls":
            there = doors.said[f"{name}:"].partition(";")[0].rpartition(":")[2]
            text = re.sub(rf"\b{at.rpartition(':')[2]}\b", there, text)
    (tmp_path / "ask_all.py").write_text(text)
    assert script(tmp_path / "ask_all.py", "", tmp_path).stdout == shown["prints"]
    figures = doors.http.get(f"{doors.said['http:']}/metrics").text
    assert 'polycnc_machine_lateness_seconds{machine="machine"}' in figures
