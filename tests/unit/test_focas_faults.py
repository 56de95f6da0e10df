"""Faults by a script, and a served control whose time is cut in any way: without sockets, without a wall clock."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from polycnc.controllers.fanuc import PowerMate, read_state
from polycnc.controllers.fanuc.wire import (
    Frame,
    FrameReader,
    FrameType,
    Request,
    read_replies,
    write_requests,
)
from polycnc.errors import UsageError
from polycnc.servers.focas import (
    Ending,
    Fault,
    FaultKind,
    Faults,
    FocasControl,
    ServedControl,
    Session,
    load_faults,
    load_profile,
)

OPEN = bytes(Frame(FrameType.OPEN, b"\0\2"))
STATE = bytes(Frame(FrameType.COMMANDS, write_requests([Request(0x19)])))
WRITE = bytes(
    Frame(
        FrameType.COMMANDS, write_requests([Request(0xA8, (500, 1, 0, 0), bytes.fromhex("c002000000000000"))])
    )
)


def served(*script: Fault) -> tuple[FocasControl, ServedControl]:
    power_mate = PowerMate(2)
    faults = Faults(script)
    return FocasControl(power_mate, load_profile("31i"), faults), ServedControl(power_mate, faults)


def opened(control: FocasControl) -> Session:
    session = Session(control)
    session.receive(OPEN)
    return session


def status_of(sent: bytes) -> int:
    (frame,) = FrameReader().feed(sent)
    ((_, reply),) = read_replies(frame.body)
    return reply.status


def test_latency_holds_for_as_many_requests_as_the_script_says() -> None:
    control, _ = served(Fault(kind=FaultKind.LATENCY, at_request=3, for_requests=2, delay_s=0.75))
    session = opened(control)
    delays = []
    for _ in range(6):
        session.delay_s = 0.0
        assert status_of(session.receive(STATE)) == 0
        delays.append(session.delay_s)
    assert delays == [0.0, 0.0, 0.75, 0.75, 0.0, 0.0]


def test_a_dropped_request_is_not_carried_out_and_resets_the_connection() -> None:
    control, _ = served(Fault(kind=FaultKind.DROP, at_request=2, for_requests=1))
    session, other = opened(control), opened(control)
    session.receive(STATE)
    assert session.receive(WRITE) == b""
    assert session.ending is Ending.RESET
    assert control.control.macros.get(500) is None
    assert status_of(other.receive(WRITE)) == 0
    assert control.control.macros.get(500) == -2.25
    assert control.sessions == {1: 0, 2: 1}


def test_half_a_reply_is_sent_of_a_request_that_was_carried_out() -> None:
    control, _ = served(Fault(kind=FaultKind.HALF, at_request=1, for_requests=1))
    session = opened(control)
    assert session.receive(WRITE).hex() == "a0a0a0a000032102001200010010"  # 14 of 28 bytes
    assert session.ending is Ending.RESET
    assert control.control.macros.get(500) == -2.25


def test_a_mute_control_carries_out_and_says_nothing() -> None:
    control, _ = served(Fault(kind=FaultKind.MUTE, at_request=1, for_requests=2))
    session = opened(control)
    assert session.receive(WRITE) == session.receive(STATE) == b""
    assert session.ending is None
    assert control.control.macros.get(500) == -2.25
    assert status_of(session.receive(STATE)) == 0


def test_sessions_are_refused_for_a_time_of_the_machine() -> None:
    control, machine = served(Fault(kind=FaultKind.REFUSE, at_s=0.5, for_s=0.25))
    machine.advance(499)
    before = opened(control)
    machine.advance(1)
    refused = Session(control)
    assert refused.receive(OPEN).hex() == "a0a0a0a00003010300080000000200000000"
    assert status_of(before.receive(STATE)) == 0
    machine.advance(250)
    assert status_of(opened(control).receive(STATE)) == 0


def test_an_option_is_missing_for_some_commands_or_all() -> None:
    control, _ = served(
        Fault(kind=FaultKind.NO_OPTION, at_request=1, for_requests=1, commands=("cnc_acts",)),
        Fault(kind=FaultKind.NO_OPTION, at_request=3),
    )
    session = opened(control)
    asked = bytes(Frame(FrameType.COMMANDS, write_requests([Request(0x24), Request(0x25)])))
    seen = []
    for _ in range(4):
        (frame,) = FrameReader().feed(session.receive(asked))
        seen.append([(reply.status, len(reply.payload)) for _, reply in read_replies(frame.body)])
    assert seen == [[(0, 8), (6, 0)], [(0, 8), (0, 8)], [(6, 0)] * 2, [(6, 0)] * 2]


def states(machine: ServedControl, cuts: Sequence[int]) -> list[tuple[int, int, int]]:
    """Return emergency, alarm and cycle whenever they change, however time is cut."""
    seen = []
    for cut in cuts:
        machine.advance(cut)
        state = read_state(machine.control)
        seen.append((state.emergency, state.alarm, machine.clock.cycles))
    return seen


SCRIPT = (
    Fault(kind=FaultKind.EMERGENCY_STOP, at_s=0.137, for_s=0.4),
    Fault(kind=FaultKind.ALARM, at_s=0.8, for_s=0.1, alarm=1007, text="DOOR OPEN"),
)


def test_alarms_and_emergency_stops_come_in_their_cycle() -> None:
    control, machine = served(*SCRIPT)
    seen = states(machine, [136, 1, 399, 1, 262, 1, 99, 1])
    assert seen == [
        (0, 0, 136),
        (1, 0, 137),
        (1, 0, 536),
        (0, 0, 537),
        (0, 0, 799),
        (0, 1, 800),
        (0, 1, 899),
        (0, 0, 900),
    ]
    _, machine = served(*SCRIPT)
    machine.advance(850)
    assert [alarm.text for alarm in machine.status().alarms] == ["DOOR OPEN"]
    assert control.faults.active == []


PROGRAM = "O7\nG91 G1 F3000 X1.75\nX-1.75\nM30\n"


@example([110, 1])
@settings(max_examples=15, deadline=None)
@given(st.lists(st.integers(1, 400), min_size=1, max_size=12))
def test_a_served_program_and_its_faults_do_not_depend_on_how_time_is_cut(cuts: list[int]) -> None:
    def made() -> ServedControl:
        power_mate = PowerMate(2)
        power_mate.programs.register(7, PROGRAM)
        power_mate.select_program(7)
        power_mate.cycle_start()
        return ServedControl(power_mate, Faults(SCRIPT), again=True)

    at_once, cut = made(), made()
    at_once.advance(sum(cuts))
    for each in cuts:
        cut.advance(each)
    assert at_once.status() == cut.status()
    assert at_once.faults.active == cut.faults.active


def test_a_served_program_begins_again() -> None:
    power_mate = PowerMate(2)
    power_mate.programs.register(7, PROGRAM)
    power_mate.select_program(7)
    power_mate.cycle_start()
    machine = ServedControl(power_mate, again=True)
    machine.advance(2000)
    assert power_mate.parameters.value(6711) >= 5


SCRIPT_FILE = """
[[fault]]
kind = "latency"
at_request = 20
for_requests = 5
delay_s = 0.5

[[fault]]
kind = "alarm"
at_s = 3.5
alarm = 1007
text = "DOOR OPEN"
"""


def test_a_script_is_a_file(tmp_path: Path) -> None:
    path = tmp_path / "faults.toml"
    path.write_text(SCRIPT_FILE)
    first, second = load_faults(path)
    assert (first.kind, first.at_request, first.for_requests, first.delay_s) == (
        FaultKind.LATENCY,
        20,
        5,
        0.5,
    )
    assert (second.kind, second.at_s, second.alarm, second.text) == (FaultKind.ALARM, 3.5, 1007, "DOOR OPEN")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('kind = "latency"\nat_s = 1.0', "`delay_s` belongs to the kind latency"),
        ('kind = "drop"', "a fault begins at `at_s` or at `at_request`"),
        ('kind = "drop"\nat_s = 1.0\nat_request = 2', "a fault begins at `at_s` or at `at_request`"),
        ('kind = "drop"\nat_s = 1.0\nfor_s = 1.0\nfor_requests = 2', "a fault ends after"),
        ('kind = "drop"\nat_s = inf', "finite"),
        ('kind = "drops"\nat_s = 1.0', "drops"),
        ('kind = "no_option"\nat_s = 1.0\ncommands = ["cnc_nothing"]', "no command is called cnc_nothing"),
        ('kind = "drop"\nat_s = 1.0\ncommands = ["cnc_acts"]', "`commands` belong to the kind no_option"),
        ('kind = "drop"\nat = 1.0', "at"),
    ],
)
def test_a_script_that_cannot_be_is_refused(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "faults.toml"
    path.write_text(f"[[fault]]\n{text}\n")
    with pytest.raises(UsageError, match=r"faults\.toml") as refused:
        load_faults(path)
    assert said in str(refused.value)


def test_a_script_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot read"):
        load_faults(tmp_path / "none.toml")
