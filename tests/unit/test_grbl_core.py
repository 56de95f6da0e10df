"""The interface of grbl 1.1 on a control: what a sender sends, and what it gets."""

from __future__ import annotations

import random
import re

import pytest

from polycnc.cnc import Control, Mode
from polycnc.machine import load_machine
from polycnc.servers.grbl import GrblAlarm, GrblCore, GrblError, grbl_control
from support.cnc_machine import cnc_machine
from support.grbl_sender import SURFACE, Bench, stream

UNIT = "G21 G90 G94\n"


def test_a_sender_is_greeted() -> None:
    core = GrblCore(grbl_control(cnc_machine()))
    assert core.greet() == b"\r\nGrbl 1.1h ['$' for help]\r\n"


def test_whoever_stands_has_no_speed_in_any_cycle() -> None:
    core = GrblCore(control := grbl_control(load_machine("mill3")))
    core.receive(b"G1 X5 F3000\n")
    found = set()
    for _ in range(120):
        control.advance(1)
        core.turn()
        report = core.receive(b"?").decode()
        found.add((report.split("|")[0], report.split("FS:")[1].split(",")[0]))
    assert ("<Run", "3000") in found
    assert {speed for state, speed in found if state == "<Idle"} == {"0"}


def test_the_state_and_its_fields() -> None:
    bench = Bench()
    assert bench.send("?") == ["<Idle|MPos:12.500,0.000,3.000|FS:0,0|WCO:0.000,0.000,0.000>"]
    assert bench.send("?") == ["<Idle|MPos:12.500,0.000,3.000|FS:0,0|Ov:100,100,100>"]
    assert bench.send("?") == ["<Idle|MPos:12.500,0.000,3.000|FS:0,0>"]
    assert bench.send("$10=3\nG10 L2 P1 X2.5\nG0 X10\n", 300)[-1] == "ok"
    assert bench.send("?") == ["<Idle|MPos:12.500,0.000,3.000|Bf:15,128|FS:0,0|WCO:2.500,0.000,0.000>"]
    assert bench.send("$10=0\n?")[-1] == "<Idle|WPos:10.000,0.000,3.000|FS:0,0>"
    assert bench.send("$13=1\n?")[-1] == "<Idle|WPos:0.3937,0.0000,0.1181|FS:0.0,0>"


def test_offsets_and_overrides_come_again_after_ten_idle_reports() -> None:
    bench = Bench()
    reports = [bench.send("?")[0] for _ in range(24)]
    assert [n for n, each in enumerate(reports) if "WCO" in each] == [0, 11, 22]
    assert [n for n, each in enumerate(reports) if "Ov" in each] == [1, 12, 23]


def test_a_line_is_answered_when_it_is_taken_and_executed_after() -> None:
    bench = Bench()
    assert bench.send(UNIT + "G1 X20 F600\n", 10) == ["ok", "ok"]
    assert bench.state() == "Run"
    assert bench.send("", 2000) == []
    assert (bench.state(), bench.x()) == ("Idle", 20.0)


WRONG = (
    ("1", 1), ("X", 2), ("X1.2.3", 1), ("X-", 2), ("$Q", 3), ("F-1", 4), ("T-1", 4), ("$0=1", 8), ("$H", 8),
    ("G99", 20), ("G43.1 Z1", 20), ("Q1", 20), ("M6", 20), ("G0 G1 X1", 21), ("M3 M4", 21), ("G17 G18", 21),
    ("G1 X1", 22), ("G93 G1 X1", 22), ("M3.5", 23), ("G28 G1 X1 F100", 24), ("X1 X2", 25), ("G92", 26),
    ("G10 L2 P1", 26), ("G2 F100", 26), ("N99999999", 27), ("G4", 28), ("G10 X1 L2", 28), ("G10 L2 P7 X1", 29),
    ("G2 F100 X1 G53 I1", 30), ("G80 X1", 31), ("G2 Z1 F100", 32), ("G2 X20 Y5 I99 F100", 33),
    ("G2 X30 R1 F100", 34), ("G2 X20 Y5 F100", 35), ("G0 X1 I5", 36), ("G1 X1 P3 F100", 36),
    ("G0" + "X1" * 60, 11),
)  # fmt: skip


def test_what_is_refused_first_leaves_no_program_that_waits() -> None:
    """Nor does what only asks: the operator's mode and the state of the control are as before."""
    core = GrblCore(control := grbl_control(load_machine("mill3")))
    for mode in (Mode.JOG, Mode.AUTO, Mode.MDI):
        control.select_mode(mode)
        for line in ("G99", "G1 X1", "G2 X20 Y5 I99 F100", "G80 X1", "$J=X1 F0", "$J=X1", "$G", "$#"):
            core.receive(line.encode() + b"\n")
            control.advance(2)
            core.turn()
            channel = control.channel_status()
            assert (control.mode, channel.active, channel.motion) == (mode, False, "none"), line
            assert core.state == "Idle", line
    assert core.receive(b"G0 X7.5\n") == b"ok\r\n"
    control.advance(500)
    assert control.axes()["X"].machine == 7.5


def test_a_wrong_line_has_its_number_and_stops_nothing() -> None:
    bench = Bench()
    bench.send(UNIT + "G10 L20 P2 X0\nG53 G0 X37.5\n", 500)
    for place, (line, number) in enumerate(WRONG):
        target = 35.0 + 2.5 * (place % 2)
        bench.send(f"G53 G0 X{target}\n", 10)
        answers = [each for each in bench.send(line + "\n", 10) if not each.startswith("[MSG")]
        assert (line, answers) == (line, [f"error:{number}"])
        assert (line, bench.state()) == (line, "Run")
        bench.send("", 150)
        assert (line, bench.state(), bench.x()) == (line, "Idle", target)


@pytest.mark.parametrize(
    ("line", "number"), [("$200=1", 3), ("$0=-1", 4), ("$6=2", 2), ("$110=0", 2), ("$N3=G0", 3)]
)
def test_a_setting_that_cannot_be_has_its_number(line: str, number: int) -> None:
    bench = Bench()
    before = bench.send("$$\n")
    assert bench.send(line + "\n", 20)[-1] == f"error:{number}"
    assert bench.send("$$\n") == before


def test_every_number_has_a_text() -> None:
    assert all(each.text for each in (*GrblError, *GrblAlarm))
    assert {each: int(each) for each in GrblError}[GrblError.UNSUPPORTED] == 20


def test_a_hold_brakes_and_a_start_goes_on() -> None:
    bench = Bench()
    bench.send(UNIT + "G1 X40 F3000\n", 100)
    assert bench.send("!?")[0].startswith("<Hold:1|")
    bench.passed(500)
    assert bench.state() == "Hold:0"
    at = bench.x()
    assert 12.5 < at < 40.0
    assert bench.send("G1 X41\n") == ["ok"]  # taken, as into a planner that has room
    bench.send("~", 50)
    assert bench.state() == "Run"
    bench.passed(3000)
    assert bench.x() == 41.0


def test_the_door_holds_too() -> None:
    bench = Bench()
    bench.send(UNIT + "G1 X40 F3000\n", 100)
    assert bench.send(b"\x84?")[0].startswith("<Door:2|")
    bench.passed(500)
    assert bench.state() == "Door:0"
    bench.send("~", 3000)
    assert (bench.state(), bench.x()) == ("Idle", 40.0)


def test_a_reset_in_motion_is_an_alarm_and_one_at_rest_is_not() -> None:
    bench = Bench()
    assert bench.send("\x18") == ["", "Grbl 1.1h ['$' for help]"]
    bench.send(UNIT + "G1 X40 F3000\n", 100)
    assert bench.send("\x18") == ["ALARM:3", "", "Grbl 1.1h ['$' for help]", "[MSG:'$H'|'$X' to unlock]"]
    bench.passed(500)
    assert bench.send("?G0 X1\n")[-1] == "error:9"
    assert bench.send("$X\n") == ["[MSG:Caution: Unlocked]", "ok"]
    assert bench.send("G0 X13\n", 1000) == ["ok"]
    assert bench.x() == 13.0


def test_a_target_beyond_the_travel_is_an_alarm() -> None:
    bench = Bench()
    assert bench.send("G0 X500\n") == ["ALARM:2", "[MSG:Reset to continue]"]
    assert bench.send("G0 X1\n$X\n") == []
    assert bench.send("\x18")[-1] == "[MSG:'$H'|'$X' to unlock]"
    assert bench.send("$X\nG0 X14\n", 500)[-2:] == ["ok", "ok"]
    assert bench.x() == 14.0


def test_overrides_act_at_once_and_within_their_range() -> None:
    bench = Bench()
    bench.send(b"\x91" * 3 + b"\x94" + b"\x96" + b"\x9b\x9b")
    each = bench.control.overrides
    assert (each.feed, each.rapid, each.spindle) == (1.29, 0.5, 0.8)
    bench.send(b"\x92" * 40 + b"\x97" + b"\x9a" * 40)
    each = bench.control.overrides
    assert (each.feed, each.rapid, each.spindle) == (0.1, 0.25, 2.0) or each.spindle <= 2.0
    bench.send(b"\x90\x95\x99")
    assert bench.control.overrides.feed == bench.control.overrides.rapid == 1.0
    assert any("Ov:100,100,100" in bench.send("?")[0] for _ in range(3))


def test_modal_words_and_parameters() -> None:
    bench = Bench()
    assert bench.send("$G\n") == ["[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]", "ok"]
    bench.send("G20 G91 G18 G55 G1 F20 S500 M3 M8 T2\n", 2000)
    assert bench.send("$G\n") == ["[GC:G1 G55 G18 G20 G91 G94 M3 M8 T2 F508 S500]", "ok"]
    bench.send("$13=1\n")
    assert "F20.0" in bench.send("$G\n")[0]
    assert "F2000000" in bench.send("$13=0\nG21 F2000000\n$G\n")[-2], "senders read no exponents"
    bench.send("G21 G90 G92 X1\n", 50)
    found = bench.send("$#\n")
    assert found[0] == "[G54:0.000,0.000,0.000]"
    assert "[G92:11.500,0.000,0.000]" in found
    assert found[-2:] == ["[PRB:0.000,0.000,0.000:0]", "ok"]
    assert "[G28:12.500,0.000,3.000]" in found


def test_settings_are_the_machine_s() -> None:
    bench = Bench()
    found = dict(line[1:].split("=") for line in bench.send("$$\n")[:-1])
    assert (found["110"], found["120"], found["130"]) == ("7200.000", "700.000", "130.000")
    assert bench.send("$110=600\n$120=50\n$131=55\n", 50) == ["ok"] * 3
    x, y = bench.control.machine.config.axes[:2]
    assert (x.vmax, x.amax, y.soft_limits) == (10.0, 50.0, (-25.0, 30.0))
    bench.send(UNIT + "G0 X32.5\n", 1000)
    assert bench.x() < 22.5  # at 10 mm/s
    assert bench.send("$110=700\n")[-1] == "error:8"  # not idle
    bench.passed(3000)
    assert bench.send("$20=0\nG0 X200\n", 30)[:2] == ["ok", "ok"]
    bench.send("!", 300)
    assert bench.send("\x18$20=1\n?", 100)[-1].startswith("<Idle|MPos:3")


def test_soft_limits_are_on_only_with_a_travel_and_travels_act_only_with_soft_limits() -> None:
    bench = Bench()
    bench.control = grbl_control("mill3")  # without travels
    bench.core = GrblCore(bench.control)
    assert bench.send("$22=1\n$20=1\n", 50)[-1] == "error:3"
    assert "$20=0" in bench.send("$$\n")
    assert bench.send("$130=80\n", 50) == ["ok"]
    assert {"$20=0", "$130=80.000"} <= set(bench.send("$$\n"))
    assert not bench.control.machine.config.axes[0].soft_limits[0] > -1e9
    assert bench.send("$20=1\n", 50) == ["ok"]
    assert {"$20=1", "$130=80.000"} <= set(bench.send("$$\n"))
    assert bench.control.machine.config.axes[0].soft_limits == (-80.0, 0.0)


def test_settings_and_startup_lines_last_and_go_back_to_defaults() -> None:
    bench = Bench()
    assert bench.send("$10=2\n$27=1.5\n$N0=G21\n") == ["ok"] * 3
    again = GrblCore(bench.control)
    text = again.receive(b"$$\n$N\n").decode()
    assert {"$10=2", "$27=1.500", "$N0=G21"} <= set(text.splitlines())
    assert bench.send("$RST=*\n", 50)[-1] == "ok"
    assert "$10=1" in bench.send("$$\n")
    assert bench.send("$N\n") == ["$N0=", "$N1=", "ok"]


def test_a_check_moves_nothing_and_finds_what_is_wrong() -> None:
    bench = Bench()
    assert bench.send("$C\n") == ["[MSG:Enabled]", "ok"]
    assert bench.send(UNIT + "G1 X20 F100\nG2 X30 F100\nX21\n", 1000) == ["ok", "ok", "error:35", "ok"]
    assert (bench.state(), bench.x()) == ("Check", 12.5)
    assert bench.send("$C\n")[:2] == ["[MSG:Disabled]", ""]
    assert (bench.state(), bench.x()) == ("Idle", 12.5)


def test_a_jog_goes_leaves_modal_words_and_can_be_cancelled() -> None:
    bench = Bench()
    bench.send(UNIT + "G92 X1\nG1 F300\n", 50)
    before = bench.send("$G\n")
    assert bench.send("$J=G91 X5 F600\n", 50) == ["ok"]
    assert (bench.state(), bench.send("G0 X1\n")) == ("Jog", ["error:9"])
    bench.passed(2000)
    assert (bench.state(), bench.x(), bench.send("$G\n")) == ("Idle", 17.5, before)
    bench.send("$J=G53 X40 F600\n", 300)
    bench.send(b"\x85", 500)
    at = bench.x()
    assert bench.state() == "Idle"
    assert 17.5 < at < 40.0
    assert bench.send("$G\n") == before
    assert bench.send("X7\n", 3000) == ["ok"]  # G1 F300, where G92 has put zero
    assert bench.x() == pytest.approx(18.5)


@pytest.mark.parametrize(
    ("jog", "number"),
    [
        ("$J=X5000 F100", 15),
        ("$J=X5", 22),
        ("$J=F100", 26),
        ("$J=G1 X5 F100", 16),
        ("$JX5", 16),
        ("$J=X5 F100 M3", 16),
    ],
)
def test_a_wrong_jog_has_its_number(jog: str, number: int) -> None:
    bench = Bench()
    assert bench.send(jog + "\n", 100) == [f"error:{number}"]
    assert bench.x() == 12.5


def test_homing_references_every_axis_and_answers_then() -> None:
    bench = Bench()
    assert bench.send("G0 X30 Y5\n", 600) == ["ok"]
    assert bench.send("$H\n", 20) == []
    assert bench.state() == "Home"
    assert bench.send("", 20_000) == ["ok"]
    assert bench.state() == "Idle"
    assert bench.send("G0 X5\n", 2000) == ["ok"]
    assert bench.x() == 5.0
    assert bench.send("$22=0\n$H\n", 200) == ["ok", "error:5"]
    bench.send("$22=1\n$H\n", 20)
    assert bench.state() == "Home"
    assert bench.send("\x18")[0] == "ALARM:6"


def test_a_dwell_is_answered_when_it_is_over() -> None:
    bench = Bench()
    assert bench.send("G4 P0.2\n", 150) == []
    assert bench.send("", 100) == ["ok"]


def test_a_stop_waits_for_a_start() -> None:
    bench = Bench()
    assert bench.send("G0 X14\nM0\nG0 X15\n", 1000) == ["ok"]
    assert (bench.state(), bench.x()) == ("Hold:0", 14.0)
    assert bench.send("~", 1000) == ["ok", "ok"]
    assert bench.x() == 15.0


@pytest.mark.parametrize("end", ["M2", "M30"])
def test_a_program_ends_and_the_next_begins(end: str) -> None:
    bench = Bench()
    assert bench.send(f"G91 G20 M3 S100\nG0 X0.1\n{end}\nG0 X14\n", 3000) == ["ok"] * 4
    assert (bench.state(), bench.x()) == ("Idle", 14.0)
    assert bench.control.spindle.state().commanded_rpm == 0.0


def test_a_probe_stops_at_a_surface_and_says_where() -> None:
    bench = Bench(surface=(SURFACE,))
    answers = bench.send("G38.2 Z-20 F100\n", 20_000)
    assert re.fullmatch(r"\[PRB:12\.500,0\.000,-4\.0\d\d:1\]", answers[0])
    assert answers[1] == "ok"
    assert bench.send("G0 Z1\nG38.3 Z-1 F100\n", 20_000)[1:] == ["[PRB:12.500,0.000,-1.000:0]", "ok"]
    assert bench.send("G0 Z1\nG38.2 Z-1 F100\n", 20_000)[1:3] == ["[PRB:12.500,0.000,-1.000:0]", "ALARM:5"]
    assert bench.state() == "Alarm"


def test_sleep_ends_with_a_reset() -> None:
    bench = Bench()
    assert bench.send("$SLP\nG0 X20\n", 500) == ["[MSG:Sleeping]", "ok"]
    assert (bench.state(), bench.x()) == ("Sleep", 12.5)
    assert bench.send("\x18")[1] == "Grbl 1.1h ['$' for help]"


def test_an_alarm_of_the_machine_locks_the_door() -> None:
    bench = Bench()
    bench.send(UNIT + "G1 X40 F600\n", 100)
    bench.control.emergency_stop()
    assert [each for each in bench.send("", 50) if "MSG" not in each] == ["ALARM:3"]
    assert bench.send("?G0 X1\n")[-1] == "error:9"
    bench.control.emergency_stop(False)
    assert bench.send("$X\n", 20) == ["[MSG:Caution: Unlocked]", "ok"]
    assert bench.send("G0 X13\n", 2000) == ["ok"]
    assert bench.x() == 13.0


def test_a_program_is_streamed_by_counting_characters() -> None:
    bench = Bench()
    program = UNIT + "".join(f"G1 X{20 + n % 7} Y{n % 5} F3000\n" for n in range(120)) + "G99\nG0 X20\nM30\n"
    got: list[str] = []

    def write(data: bytes) -> None:
        got.extend(bench.send(data))

    def read_line() -> str:
        while not got:
            got.extend(bench.send("", 10))
        return got.pop(0)

    answers = stream(program, write, read_line)
    assert answers == ["ok"] * 121 + ["error:20", "ok", "ok"]
    assert bench.x() == 20.0


def test_another_program_of_the_control_is_not_disturbed() -> None:
    control: Control = grbl_control(cnc_machine())
    core = GrblCore(control)
    control.programs.create("PART", "G1 X40 F600\nM30\n")
    control.select_mode(Mode.AUTO)
    control.select_program("PART")
    control.cycle_start()
    control.advance(20)
    assert core.receive(b"G0 X1\n") == b"error:8\r\n"
    assert core.receive(b"?").startswith(b"<Run|")
    control.advance(10_000)
    assert control.axes()["X"].machine == 40.0
    assert core.receive(b"G0 X13\n") == b"ok\r\n"


_PIECES = (
    b"G1X20F600\n", b"X14\n", b"?", b"!", b"~", b"$G\n", b"$#\n", b"$J=G91X1F500\n", b"\x85", b"\x91",
    b"\x97", b"\x84", b"G91\n", b"G90\n", b"G2X1\n", b"M3S100\n", b"M5\n", b"\x18", b"$X\n",
    b"G4P0.01\n", b"$C\n", b"(a?b)\n", b";c\r\n", b"M30\n", b"G0X9999\n", b"$10=3\n", b"$20=0\n",
    b"\xff\xfe", b"\x00", b"%\n", b"G92X1\n", b"G20\n", b"G21\n", b"$110=900\n", b"M0\n", b"$H\n",
)  # fmt: skip


def _conversation(chance: random.Random) -> list[tuple[bytes, int]]:
    found = []
    for _ in range(12):
        data = b"".join(chance.choice(_PIECES) for _ in range(chance.randint(1, 6)))
        if chance.random() < 0.3:
            data = bytes(chance.choice(data) for _ in data) + bytes(chance.randrange(256) for _ in range(5))
        found.append((data, chance.choice((0, 1, 30, 400))))
    return found


def _answers(
    conversation: list[tuple[bytes, int]], chance: random.Random | None
) -> tuple[list[bytes], object]:
    bench = Bench()
    answers = []
    for data, cycles in conversation:
        given = b""
        begin = 0
        while begin < len(data):
            size = len(data) if chance is None else chance.randint(1, 5)
            given += bench.core.receive(data[begin : begin + size])
            begin += size
        bench.control.advance(cycles)
        answers.append(given + bench.core.turn())
    bench.control.clock.changes += 1
    return answers, bench.control.status()


@pytest.mark.parametrize(
    "seed", [*range(8), *(pytest.param(n, marks=pytest.mark.long) for n in range(8, 400))]
)
def test_bytes_cut_anywhere_have_the_same_answers(seed: int) -> None:
    conversation = _conversation(random.Random(seed))
    whole, status = _answers(conversation, None)
    cut, other = _answers(conversation, random.Random(seed + 1))
    assert cut == whole
    assert other == status
    for line in b"".join(whole).splitlines():
        assert re.match(rb"(ok|error:\d+|ALARM:\d+|\[.*\]|<.*>|\$.*=.*|Grbl 1\.1h.*|)$", line), line
