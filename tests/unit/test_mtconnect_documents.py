"""Documents of the agent: valid by the schemas, with the values of the status, and errors with their codes."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import pytest

from polycnc.cnc import ALARMS, AlarmKind, ChannelData, Control, Mode
from polycnc.nc import ProgramText
from polycnc.servers.mtconnect import VERSIONS, Agent, Answer, model_of, value_text
from polycnc.servers.plant import see
from support.mtconnect import Rig, assert_valid, header_of, plain, values_of

PROGRAM = "N10 G90 G1 F1200 X40 S800 M3\nN20 Y30\nM1\nN30 G2 X0 Y0 R30\nM30\n"
REQUESTS = [
    ("/probe", ""), ("/", ""), ("/mill", ""), ("/mill/probe", ""), ("/polycnc.mill/probe", ""),
    ("/current", ""), ("/mill/current", "path=//Path"), ("/current", "at=7"), ("/sample", "count=500&_=1717"),
    ("/sample", "count=-5"), ("/sample", "from=3&to=9"), ("/mill/sample", "path=//Linear&count=3"),
    ("/assets", ""), ("/assets", "removed=true&count=1"), ("/asset", "type=CuttingTool"),
    ("/asset/mill.T3", ""), ("/assets/mill.T3;mill.T7", ""), ("/mill/assets", ""), ("/assets", "type=Pallet"),
]  # fmt: skip
REFUSED = [
    ("/nowhere/current", "", "NoDevice", "NO_DEVICE", 404),
    ("/nowhere", "", "NoDevice", "NO_DEVICE", 404),
    ("/mill/nothing", "", "InvalidURI", "INVALID_URI", 404),
    ("/a/b/c", "", "InvalidURI", "INVALID_URI", 404),
    ("/current", "at=0", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/current", "at=99999", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/current", "at=-3", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/current", "at=3&interval=100", "InvalidRequest", "INVALID_REQUEST", 400),
    ("/current", "path=//[", "InvalidXPath", "INVALID_XPATH", 400),
    ("/current", "path=//Nothing", "InvalidXPath", "INVALID_XPATH", 400),
    ("/current", "path=", "InvalidXPath", "INVALID_XPATH", 400),
    ("/sample", "from=0", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/sample", "count=0", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/sample", "count=1000000000000000000", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/sample", f"count={'9' * 3000}", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/sample", "interval=-1", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/sample", "interval=0&heartbeat=0", "OutOfRange", "OUT_OF_RANGE", 400),
    ("/sample", "count=ten", "InvalidParameterValue", "QUERY_ERROR", 400),
    ("/sample", "from=", "InvalidParameterValue", "QUERY_ERROR", 400),
    ("/sample", "from=1&from=2", "InvalidParameterValue", "QUERY_ERROR", 400),
    ("/sample", "at=3", "QueryError", "QUERY_ERROR", 400),
    ("/probe", "count=3", "QueryError", "QUERY_ERROR", 400),
    ("/asset/none", "", "AssetNotFound", "ASSET_NOT_FOUND", 404),
    ("/assets/mill.T3;none", "", "AssetNotFound", "ASSET_NOT_FOUND", 404),
    ("/current", "deviceType=Agent", "NoDevice", "NO_DEVICE", 404),
    ("/current", "x" * 5000, "InvalidRequest", "INVALID_REQUEST", 400),
]  # fmt: skip


def lived(version: str = "2.7", machine: str = "mill5") -> Rig:
    """Return a machine that has had a program, alarms, messages and tools."""
    rig = Rig(machine, version)
    control = rig.control
    control.tools.set(3, length_mm=81.25, radius_mm=6.0, wear_length_mm=-0.5, description="drill <6> & co")
    rig.observe()
    control.select_program(ProgramText("PART<1>", PROGRAM.encode()))
    control.set_switches(optional_stop=True)
    control.cycle_start()
    for _ in range(12):
        control.advance(150)
        rig.observe()
    control.messages.show(41, 'door "A" is open\x07')
    control.tools.set(7, radius_mm=2.0)
    control.emergency_stop()
    rig.observe()
    control.tools.remove(7)
    rig.observe()
    return rig


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("machine", ["mill5", "lathe2"])
def test_every_kind_of_document_is_valid(version: str, machine: str) -> None:
    rig = lived(version, machine)
    answers = [rig.get(path, query) for path, query in REQUESTS]
    assert [answer.status for answer in answers] == [200] * len(REQUESTS)
    for answer in answers:
        assert f":{version}}}" in ElementTree.fromstring(answer.document).tag
    for answer in answers:
        assert_valid(answer.document, version)


@pytest.mark.parametrize("version", ["2.7", "2.2"])
def test_refusals_have_their_codes(version: str) -> None:
    rig = lived(version, "mill3")
    before = rig.agent.buffer.next
    for path, query, element, code, status in REFUSED:
        answer = rig.get(path, query)
        tree = ElementTree.fromstring(answer.document)
        (error,) = tree[1]
        assert (answer.status, path, query[:40]) == (status, path, query[:40])
        if version == "2.7":
            assert plain(error.tag) == element, (path, query[:40])
            assert_valid(answer.document, version)
        else:
            assert error.attrib == {"errorCode": code}
            assert error.text
    assert rig.agent.buffer.next == before


def test_values_are_those_of_the_status() -> None:
    rig = Rig("mill3")
    control = rig.control
    rig.observe()
    assert rig.values()["program"] == "UNAVAILABLE"
    control.select_program(ProgramText("PART", PROGRAM.encode()))
    control.set_overrides(feed=0.7, rapid=0.25, spindle=1.1)
    control.cycle_start()
    control.advance(900)
    rig.observe()
    status, found = control.status(), rig.values()
    assert float(found["Xact"]) == pytest.approx(status.axes["X"].machine, abs=1e-4)
    assert status.axes["X"].machine > 1.0
    assert float(found["path_feedrate"]) == pytest.approx(status.channel.feed.actual / 60, abs=1e-4)
    assert float(found["f_command"]) == pytest.approx(14.0)
    assert float(found["f_program"]) == pytest.approx(20.0)
    assert float(found["S1speed"]) == pytest.approx(status.spindle.actual_rpm, abs=1e-4)
    assert (found["Fovr"], found["Frapidovr"], found["SspeedOvr"]) == ("70", "25", "110")
    assert (found["mode"], found["execution"], found["estop"]) == ("AUTOMATIC", "ACTIVE", "ARMED")
    assert (found["program"], found["line"], found["sequenceNum"]) == ("PART", "1", "10")
    assert (found["block"], found["Xstate"], found["S1dir"]) == (
        PROGRAM.splitlines()[0],
        "TRAVEL",
        "CLOCKWISE",
    )
    x, y, z = map(float, found["path_position"].split())
    assert (x, y, z) == pytest.approx([status.axes[name].work for name in "XYZ"], abs=1e-4)


def test_execution_and_mode_follow_the_control() -> None:
    rig = Rig("mill3")
    control = rig.control
    control.select_program(ProgramText("PART", PROGRAM.encode()))
    control.set_switches(optional_stop=True)
    seen = []
    steps: list[Any] = [
        control.cycle_start, control.feed_hold, control.cycle_start, lambda: control.advance(4000),
        control.cycle_start, control.reset, lambda: control.advance(2000),
        lambda: control.set_switches(optional_stop=False), control.cycle_start, lambda: control.advance(9000),
        lambda: control.select_mode(Mode.JOG), control.emergency_stop,
    ]  # fmt: skip
    for step in steps:
        step()
        rig.observe()
        seen.append(rig.values()["execution"])
    assert seen[:6] == ["ACTIVE", "FEED_HOLD", "ACTIVE", "OPTIONAL_STOP", "ACTIVE", "STOPPED"]
    assert seen[9] == "PROGRAM_COMPLETED"
    assert (rig.values()["mode"], rig.values()["estop"], rig.values()["system"]) == (
        "MANUAL",
        "TRIGGERED",
        "Fault",
    )


def test_older_versions_have_older_types() -> None:
    old, new = lived("1.3", "mill3"), lived("2.7", "mill3")
    types = [
        {each.attrib["type"] for each in rig.tree("/probe").iter() if plain(each.tag) == "DataItem"}
        for rig in (old, new)
    ]
    assert {"LINE", "TOOL_ID", "SPINDLE_SPEED"} <= types[0]
    assert not {"LINE", "TOOL_ID", "SPINDLE_SPEED"} & types[1]
    assert not {"LINE_NUMBER", "CONTROLLER_MODE_OVERRIDE", "ASSET_COUNT"} & types[0]
    assert {"LINE_NUMBER", "LINE_LABEL", "ASSET_COUNT", "TOOL_NUMBER"} <= types[1]
    rig = Rig("mill3", "1.3")
    rig.control.select_program(ProgramText("PART", b"M1\nM30\n"))
    rig.control.set_switches(optional_stop=True)
    rig.control.cycle_start()
    rig.control.advance(50)
    rig.observe()
    assert rig.values()["execution"] == "PROGRAM_OPTIONAL_STOP"


def test_conditions_come_and_go_one_by_one() -> None:
    rig = Rig("mill3")
    alarms = rig.control.alarms
    rig.observe()
    assert rig.values()["Xtravel"] == "Normal"
    alarms.put("soft_limit_low", axis="X")
    alarms.put("limit_switch_high", axis="X")
    rig.observe()
    faults = [each for each in rig.tree("/current").iter() if plain(each.tag) == "Fault"]
    assert [each.attrib["nativeCode"] for each in faults] == ["210", "213"]
    assert [each.attrib["qualifier"] for each in faults] == ["LOW", "HIGH"]
    assert faults[0].text == "axis X is at its lower software limit"
    assert_valid(rig.get("/current").document, "2.7")
    at = rig.agent.buffer.last
    alarms.reset()
    rig.observe()
    assert rig.values()["Xtravel"] == "Normal"
    assert values_of(rig.tree("/current", f"at={at}"))["Xtravel"] == "Fault"


@pytest.mark.parametrize("kind", ALARMS)
def test_alarms_of_every_kind_in_every_channel_are_conditions(kind: str) -> None:
    control = Control("mill5", channels=(ChannelData(("X", "Y", "Z"), spindle=True), ChannelData(("A", "C"))))
    device = model_of("m", control, VERSIONS["2.7"])
    agent, look = Agent([device], VERSIONS["2.7"], 3), see(lambda: control)
    agent.observe(0, look())
    for axis, channel in ((None, None), (None, 1), ("A", None), ("X", None)):
        control.alarms.put(kind, axis=axis, channel=channel, detail="?")
        agent.observe(0, look())
    current = agent.get("/current")
    assert isinstance(current, Answer)
    assert_valid(current.document, "2.7")
    faults = [each for each in ElementTree.fromstring(current.document).iter() if plain(each.tag) == "Fault"]
    assert len(faults) == len(control.alarms.active) == 4
    assert {each.attrib["nativeCode"] for each in faults} == {str(ALARMS[kind].number)}
    names = {each.attrib["name"] for each in faults}
    if ALARMS[kind].kind is AlarmKind.PROGRAM:
        assert names == {"motion", "motion2"}
    elif ALARMS[kind].kind is AlarmKind.TRAVEL:
        assert names == {"Xtravel", "Atravel", "system"}
    control.alarms.reset()
    control.alarms.cause_gone(kind, "A")
    agent.observe(0, look())
    left = [plain(each.tag) for each in ElementTree.fromstring(agent.get("/current").document).iter()]  # type: ignore[union-attr]
    assert left.count("Fault") == len(control.alarms.active)


def test_assets_follow_the_tool_table() -> None:
    rig = lived(machine="mill3")
    tree = rig.tree("/asset/mill.T3")
    text = {plain(each.tag): each.text for each in tree.iter()}
    assert text["FunctionalLength"] == "80.75"
    assert text["CuttingDiameterMax"] == "12"
    assert (text["ProgramToolNumber"], text["Description"]) == ("3", "drill <6> & co")
    assert [each.attrib["assetId"] for each in rig.tree("/assets")[1]] == ["mill.T3"]
    both = rig.tree("/assets", "removed=true")[1]
    assert {each.attrib["assetId"]: each.attrib.get("removed") for each in both} == {
        "mill.T3": None, "mill.T7": "true",
    }  # fmt: skip
    assert header_of(rig.get("/assets").document)["assetCount"] == "1"
    found = rig.values()
    assert (found["asset_chg"], found["asset_rem"], found["asset_count"]) == ("mill.T7", "mill.T7", "1")


def test_the_same_machine_and_requests_give_the_same_bits() -> None:
    first, second = (lived(machine="mill5") for _ in range(2))
    for path, query in REQUESTS:
        assert first.get(path, query) == second.get(path, query), path


def test_observations_carry_the_time_of_the_machine() -> None:
    rig = Rig("mill3")
    rig.control.advance(12_345)
    rig.observe()
    now = rig.control.status().now.isoformat(timespec="milliseconds") + "Z"
    answer = rig.get("/current")
    times = {each.attrib["timestamp"] for each in ElementTree.fromstring(answer.document).iter()
             if "dataItemId" in each.attrib}  # fmt: skip
    assert times == {now}
    assert header_of(answer.document)["creationTime"] == now


@pytest.mark.parametrize(
    ("value", "text"),
    [(1 / 3, "0.3333"), (-1e-9, "0"), (1e6, "1000000"), (-7.25, "-7.25"), (float("nan"), None), (float("inf"), None),
     (None, None), (41, "41"), ((0.5, -2.0, 1e-7), "0.5 -2 0"), ("a\x07\n|", "a??|"), ("x" * 300, "x" * 255)],
)  # fmt: skip
def test_values_are_written_as_documents_have_them(value: Any, text: str | None) -> None:
    assert value_text(value) == text
