"""Lines of the adapter: habitual keys, conditions, messages, tools, and commands cut anywhere."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from polycnc.cnc import Control
from polycnc.nc import ProgramText
from polycnc.servers.mtconnect import VERSIONS, model_of
from polycnc.servers.plant import see
from polycnc.servers.shdr import Adapter, Session


def adapter(version: str = "2.7") -> tuple[Control, Adapter, list[str]]:
    """Return a control, its adapter, and the lines of the first look."""
    control = Control("mill3")
    made = Adapter(model_of("mill", control, VERSIONS[version]), VERSIONS[version])
    return control, made, made.look(see(lambda: control)()).decode().splitlines()


def test_the_first_look_brings_every_habitual_key() -> None:
    _, made, lines = adapter()
    values, *conditions = lines
    time, *fields = values.split("|")
    assert time == "2000-01-01T00:00:00.000Z"
    found = dict(zip(fields[::2], fields[1::2], strict=True))
    habitual = [
        "avail", "estop", "mode", "execution", "program", "program_comment", "block", "line", "tool_id", "part_count",
        "path_feedrate", "f_command", "Fovr", "path_position", "active_axes", "Xact", "Xload", "S1speed", "SspeedOvr",
    ]  # fmt: skip
    assert set(habitual) <= set(found)
    assert (found["avail"], found["Fovr"], found["active_axes"]) == ("AVAILABLE", "100", "X Y Z")
    names = {line.split("|")[1]: line.split("|")[2] for line in conditions}
    assert {"system", "logic", "motion", "comms", "Xtravel", "Xservo"} <= set(names)
    assert (names["system"], names["message"]) == ("NORMAL", "")
    assert made.everything().decode().splitlines() == lines


def test_only_what_changes_is_sent() -> None:
    control, made, _ = adapter()
    look = see(lambda: control)
    assert made.look(look()) == b""
    control.set_overrides(feed=0.35)
    assert made.look(look()) == b"2000-01-01T00:00:00.000Z|Fovr|35\n"
    control.alarms.put("soft_limit_high", axis="Y")
    control.messages.show(7, "oil | water")
    control.select_program(ProgramText("A|B", b"M30\n"))
    assert made.look(look()).decode().splitlines() == [
        '2000-01-01T00:00:00.000Z|program|"A\\|B"',
        "2000-01-01T00:00:00.000Z|Ytravel|FAULT|211||HIGH|axis Y is at its upper software limit",
        '2000-01-01T00:00:00.000Z|message|7|"oil \\| water"',
    ]
    control.alarms.reset()
    assert made.look(look()) == b"2000-01-01T00:00:00.000Z|Ytravel|NORMAL||||\n"


def test_a_new_agent_gets_what_holds() -> None:
    control, made, _ = adapter()
    look = see(lambda: control)
    control.alarms.put("soft_limit_high", axis="Y")
    control.alarms.put("limit_switch_high", axis="Y")
    made.look(look())
    lines = [line.split("|")[2:4] for line in made.everything().decode().splitlines() if "|Ytravel|" in line]
    assert lines == [["FAULT", "211"], ["FAULT", "213"]]
    control.alarms.reset()
    made.look(look())
    assert b"|Ytravel|NORMAL|" in made.everything()
    assert b"|Ytravel|FAULT|" not in made.everything()


def test_tools_are_assets() -> None:
    control, made, _ = adapter()
    look = see(lambda: control)
    control.tools.set(12, length_mm=70.5, description="<drill>")
    begin, asset, end = made.look(look()).decode().splitlines()
    assert begin.split("|")[1:4] == ["@ASSET@", "mill.T12", "CuttingTool"]
    assert begin.split("|")[4] == end == "--multiline--POLYCNC"
    assert 'assetId="mill.T12"' in asset
    assert "&lt;drill&gt;" in asset
    control.tools.remove(12)
    assert made.look(look()) == b"2000-01-01T00:00:00.000Z|@REMOVE_ASSET@|mill.T12\n"
    assert b"@ASSET@" not in made.everything()


LINES = st.lists(
    st.sampled_from(
        [b"* PING", b"* PING\r", b" * PING ", b"* ping", b"*", b"", b"x" * 1100, b"\xff\x00", b"* PONG"]
    )
)


@given(LINES, st.lists(st.integers(0, 4000)))
def test_answers_do_not_depend_on_cuts(lines: list[bytes], cuts: list[int]) -> None:
    data = b"".join(line + b"\n" for line in lines)
    session, at, got = Session(), 0, b""
    for cut in [*sorted(min(cut, len(data)) for cut in cuts), len(data)]:
        got += session.receive(data[at:cut])
        at = cut
    pings = sum(line.strip() == b"* PING" for line in lines)
    assert got == b"* PONG 10000\n" * pings
    assert session.receive(b"* PING\n") == b"* PONG 10000\n"
