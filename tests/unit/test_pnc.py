"""The control as a device: channels with their own axes, the operator, errors, memory (Manual 003, 4.2, 4.13, 4.14)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.cnc import ControlError, RunState
from polycnc.cnc import Mode as CncMode
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import Mode
from polycnc.controllers.bosch.system import Signals, Tab
from polycnc.machine import Host, SnapshotError
from polycnc.post import parse_tool_path
from polycnc.runner import post_file

LINEAR = "vmax_mm_s = 500\namax_mm_s2 = 5000\n"
ROTARY = 'kind = "rotary"\nvmax_deg_s = 100\namax_deg_s2 = 400\n'
NAMES = ("X", "Y", "Z", "X2", "Y2", "Z2", "A")
SURFACES = "[[surface]]\nlow = { A = 123.5 }\n[[surface]]\nlow = { Y2 = 87.25 }\n"
MACHINE = 'name = "example"\n' + "".join(
    f'[[axis]]\nname = "{name}"\n{ROTARY if name == "A" else LINEAR}' for name in NAMES
)


class Example:
    """The manual's configuration: X Y Z in channel 1, X2 Y2 Z2 in channel 2, A (the 8th physical axis) in channel 3."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.machine = folder / "example.toml"
        self.machine.write_text(MACHINE + SURFACES)
        self.pnc = self.switched_on()

    def switched_on(self) -> Pnc:
        channels = [("X", "Y", "Z"), ("X2", "Y2", "Z2"), ("A",)]
        return Pnc(self.folder, self.machine, channels=channels, numbers=(1, 2, 3, 4, 5, 6, 8))

    def write(self, name: str, program: str) -> None:
        (self.folder / name).write_text(program + "\n")

    def start(self, program: str, channel: int = 1) -> None:
        name = f"main{channel}.npg"
        self.write(name, program)
        self.pnc.select_program(name, channel=channel)
        self.pnc.cycle_start(channel=channel)

    def run(self, program: str, channel: int = 1, cycles: int = 20_000) -> dict[str, object]:
        """Run a program to its end and return the variables."""
        self.start(program, channel)
        self.pnc.advance(cycles, until=lambda: self.pnc.run_state(channel) is not RunState.ACTIVE)
        assert self.pnc.run_state(channel) is RunState.COMPLETED, self.pnc.status().alarms
        return self.pnc.variables(channel)

    def value(self, expression: str, channel: int = 1) -> object:
        return self.run(f"10 WAIT\n20 #V!={expression}", channel)["#V!"]

    def refuses(self, expression: str, channel: int = 1) -> str:
        """Return the number of the error of an expression."""
        self.start(f"1 #V!={expression}", channel)
        self.pnc.advance(3)
        assert self.pnc.run_state(channel) is RunState.ALARM, expression
        run = self.pnc.control.channels[channel - 1].run
        assert run is not None
        assert run.error is not None
        assert (run.error.what, run.error.position.line if run.error.position else 0) == (
            "INVALID PARAMETER",
            1,
        )
        self.pnc.reset(channel=channel)
        self.pnc.advance(1)
        return run.channel.errors[0].code


@pytest.fixture
def example(tmp_path: Path) -> Iterator[Example]:
    found = Example(tmp_path)
    yield found
    found.pnc.close()


# ---------------------------------------------------------------------- axes and positions


@pytest.mark.covers("cpl.AXO")
@pytest.mark.covers(
    "cpl.ex.1398", "cpl.arg.coordsel", "cpl.seltype.0", "cpl.seltype.1", "cpl.err.RUNTIME_AXIS"
)
def test_g92_shifts_are_read_in_the_own_channel_only(example: Example) -> None:
    found = example.run(
        'N10 G1 G90 X100 Y200 F60000\nN20 G92 X75 Y125\n30 #XD = AXO("X")\n40 #YD = AXO(2,0)\n'
        "41 #A=AXO(2,1) : #B=AXO(3)"
    )
    assert [found[name] for name in ("#XD", "#YD", "#A", "#B")] == [25, 75, 75, 0]
    assert example.refuses("AXO(4,0)") == "1970"
    assert example.refuses("AXO(4)") == "1938"
    assert example.refuses("AXO(7,0)") == "1938"
    assert example.refuses('AXO("X2")') == "1970"
    assert example.refuses('AXO("Q")') == "1938"
    assert example.refuses("AXO(1,2)") == ""
    assert example.refuses("AXO(1,TRUE)") == ""


@pytest.mark.covers("cpl.err.RUNTIME_AXIS")
@pytest.mark.covers("cpl.ex.1420", "cpl.CPOS", "cpl.axis.logical", "cpl.axis.physical", "cpl.axis.example")
def test_programmed_positions_of_channel_2(example: Example) -> None:
    found = example.run(
        "N01 G0 G90 X2=150 Y2=100\n02 #A=CPOS(1)\nN03 G91 X2=10\n04 #B=CPOS(1,1)\nN05 X2=5 Y2=10\n"
        '06 #C=CPOS("Y2",1)\n07 #D=CPOS("X2")\n08 #E=CPOS(5,0)',
        channel=2,
    )
    assert [found[f"#{name}"] for name in "ABCDE"] == [150, 160, 110, 165, 110]
    assert example.refuses("CPOS(1,0)", 2) == "1970"
    assert example.refuses('CPOS("X")', 2) == "1970"


@pytest.mark.covers("cpl.ex.1493", "cpl.WPOS", "cpl.posfn.types", "cpl.err.RUNTIME_AXIS")
def test_workpiece_positions_of_other_channels(example: Example) -> None:
    example.run("N1 G168 Z2=1.5\nN2 G0 Z2=8 Y2=-3", channel=2)
    example.run("N1 G92 Y4\nN2 G0 X11 Y7")
    found = example.run(
        '10 WAIT\n20 #A = WPOS(3,1,2)\n21 #B=WPOS("Y")\n22 #C=WPOS(1)\n23 #D=WPOS("Z2",1,2)\n24 #E=WPOS(5,0)',
        channel=2,
    )
    assert [found[f"#{name}"] for name in "ABCDE"] == [9.5, 3, 0, 9.5, -3]
    assert example.refuses("WPOS(1,0,2)", 2) == ""
    assert example.refuses("WPOS(4,1,2)") == "1938"
    assert example.refuses("WPOS(1,1,4)") == ""


@pytest.mark.covers("cpl.ex.1556", "cpl.MPOS", "cpl.arg.axissel", "cpl.coord.index.note")
@pytest.mark.covers("cpl.coord")
def test_commanded_positions_of_axes(example: Example) -> None:
    example.run("N1 G0 X-7")
    found = example.run(
        'N10 G0 G90 X2=150 Y2=100\n20 WAIT\n30 #A=MPOS("X2")\nN40 G91 X2=10 Y2=10\n50 WAIT\n60 #B=MPOS(1)\n'
        '70 #C=MPOS("Y2",1,2)\n80 #D=MPOS(1,0)\n90 #E=MPOS(1,1,1) : #F=MPOS("X")',
        channel=2,
    )
    assert [found[f"#{name}"] for name in "ABCDEF"] == [150, 160, 110, -7, -7, -7]
    assert example.refuses('MPOS("X",1,2)') == "1971"
    assert example.refuses("MPOS(7,0)") == "1938"


@pytest.mark.covers("cpl.ex.1683", "cpl.ex.1712", "cpl.APOS", "cpl.SPOS", "cpl.arg.axissel.phys")
@pytest.mark.covers("cpl.arg.axissel")
def test_physical_axes_are_read_from_everywhere(example: Example) -> None:
    example.run("N1 G0 A33.5", channel=3)
    example.run("N1 G0 X2=4.5 Y2=-6", channel=2)
    example.run("N1 G0 X2")
    found = example.run(
        '10 WAIT\n30 #A=APOS(4) : #B=APOS("A") : #C=APOS(8) : #D=SPOS(1) : #E=SPOS("Y2") : #F=SPOS(4)'
    )
    assert [found[f"#{name}"] for name in "ABCDEF"] == [4.5, 33.5, 33.5, 2, -6, 4.5]
    assert example.refuses("APOS(7)") == "1938"
    assert example.refuses('SPOS("U")') == "1938"


@pytest.mark.covers("cpl.CPROBE", "cpl.PPOS")
@pytest.mark.covers("cpl.ex.1602", "cpl.ex.1635")
def test_measured_positions_of_the_own_channel(example: Example) -> None:
    text = (
        "N10 G1 G75 A250 F5000\n20 IF SD(9) = 1 THEN\nN30 (MSG, Measuring probe was not deflected!)\n40 GOTO .ERROR\n"
        "50 ELSE\n60 #AMEAS = PPOS(1,1)\n70 ENDIF\n80 .ERROR"
    )
    assert example.run(text, channel=3)["#AMEAS"] == pytest.approx(123.5)
    text = (
        "N70 G75 Y2=250 F6000\n80 IF SD(9)=1 THEN\nN90 (MSG, Measuring probe was not deflected!)\n100 GOTO .ERROR\n"
        "110 ELSE\n120 #Y2MEAS=PROBE(2)\n130 ENDIF\n140 .ERROR"
    )
    assert example.run(text, channel=2)["#Y2MEAS"] == pytest.approx(87.25)
    assert example.refuses("PPOS(8,0)") == "1970"
    assert example.refuses("CPROBE(4,0)") == "1970"


def test_a_program_reaches_the_axes_of_its_channel_only(example: Example) -> None:
    example.start("N1 G0 X2=5")
    example.pnc.advance(5)
    assert example.pnc.run_state(1) is RunState.ALARM
    assert example.pnc.axes["X2"].setpoint == 0


@pytest.mark.covers("cpl.CPOS")
@pytest.mark.covers("cpl.axis.sync", "cpl.coord")
def test_axes_go_from_channel_to_channel_and_indices_follow(example: Example) -> None:
    example.run("N1 G0 X3 Y4 Z5")
    example.run("N1 G70\nN2 G0 Z2=1", channel=2)
    assert example.value('SD(22,"Z",1)') == 3
    example.pnc.transfer_axis("Y", None)
    assert [example.value(each) for each in ("SD(20)", 'SD(22,"Z",1)', "MPOS(2)", "SD(25,2)")] == [
        2,
        2,
        5,
        -1,
    ]
    of_channels = ("CPOS", "CPROBE", "PPOS", "PROBE", "AXO")
    assert {example.refuses(f'{name}("Y")') for name in of_channels} == {"1970"}
    assert [example.value(f'{name}("Y")') for name in ("WPOS", "SPOS")] == [4, 4]
    # an asynchronous axis is in mm, whatever the unit of the channel
    found = example.run('N1 G70\n2 #A=MPOS("Y") : #B=MPOS("Z") : #C=WPOS("Y")')
    assert [found[f"#{name}"] for name in "ABC"] == pytest.approx([4, 5 / 25.4, 4])
    example.pnc.transfer_axis("Y", 2)
    assert [example.value(each, 2) for each in ("SD(20)", 'SD(22,"X2")', "MPOS(1)", "SD(25,2)")] == [
        4,
        2,
        4,
        2,
    ]
    assert example.run("N1 G1 G91 Y1.5 F6000\n2 WAIT\n3 #A=MPOS(2,0)", channel=2)["#A"] == 5.5
    with pytest.raises(ControlError):
        example.pnc.transfer_axis("W", 1)
    example.start("N1 G1 X100 F600")
    example.pnc.advance(50)
    with pytest.raises(ControlError, match="channel 1 executes a program"):
        example.pnc.transfer_axis("Z", 2)


def test_an_axis_has_the_overrides_of_its_channel_and_without_one_those_of_all(example: Example) -> None:
    control = example.pnc.control
    example.pnc.select_mode(Mode.REFERENCE)

    def speed() -> float:
        """Return how fast Y goes to its reference point."""
        control.reference("Y")
        example.pnc.advance(5000, until=lambda: not control.manual.moves(["Y"]))
        example.pnc.select_mode(Mode.JOG)
        control.jog("Y", 1, rapid=True)
        example.pnc.advance(300)
        found = example.pnc.axes["Y"].velocity
        control.jog("Y", None)
        example.pnc.advance(300)
        example.pnc.select_mode(Mode.REFERENCE)
        return found

    full = speed()
    control.set_overrides(rapid=0.0, channel=0)
    example.pnc.transfer_axis("Y", None)
    control.set_overrides(rapid=0.25)
    assert speed() == pytest.approx(0.25 * full)
    control.set_overrides(rapid=0.5, channel=1)
    example.pnc.transfer_axis("Y", 2)
    assert speed() == pytest.approx(0.5 * full)


def test_the_mode_of_all_channels_changes_or_that_of_none(example: Example) -> None:
    example.write("other.npg", "N10 G1 X2=20 F600\nN20 M30")
    example.pnc.select_program("other.npg", channel=2)
    example.pnc.cycle_start(channel=2)
    example.pnc.advance(40)
    with pytest.raises(ControlError):
        example.pnc.select_mode(Mode.JOG)
    assert {each.mode for each in example.pnc.status().channels} == {CncMode.AUTO}
    assert not example.pnc.status().channels[0].switches.single_block


@pytest.mark.covers("cpl.param.1003_00001", "cpl.param.1003_00002")
def test_parameters_have_gaps_where_there_is_no_axis(example: Example) -> None:
    found = example.run(
        "1 DIM N$(8)\n2 #A%=MCA(100300002,3) : #B%=MCA(100300002,6) : #C%=MCA(100300002,7)\n3 N$=MCA(100300001,7)\n"
        "4 DIM #N$(8) : #N$=N$"
    )
    assert [found[name] for name in ("#A%", "#B%", "#C%", "#N$")] == [2, 0, 3, "A"]


# ---------------------------------------------------------------------- channels ask each other


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.6", "cpl.MCODS.32")
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_a_channel_selects_starts_and_watches_another(example: Example) -> None:
    example.write("other.npg", "N10 G1 X2=20 F6000\nN20 M30")
    found = example.run(
        '10 #A%=MCOPS(4,2,"other.npg") : #B%=MCOPS(6,2)\n20 DIM BUF%(2) : VERSION=0\n'
        "30 E%=MCODS(32,2,VERSION,BUF%,2) : #C%=BUF%(1)\n40 WHILE BUF%(1)<>1 DO\n50 E%=MCODS(32,2,VERSION,BUF%,2)\n"
        '60 #N%=BUF%(1)\n70 END\n80 WAIT\n90 #D=MPOS("X2") : #E%=MCOPS(4,2,"none.npg",,,2)\n'
        '95 #F%=MCOPS(4,4,"other.npg")\n'
        '100 #G%=MCOPS(6,1) : #H%=MCOPS(4,1,"other.npg")'
    )
    assert [found[f"#{name}"] for name in ("A%", "B%", "C%", "N%", "D", "E%", "F%", "G%", "H%")] == [
        0, 0, 3, 1, 20, 6, 1, 9, 11,
    ]  # fmt: skip


@pytest.mark.covers("cpl.MCOPS.7", "cpl.MCOPS.5", "cpl.MCOPS.2", "cpl.MCOPS.4")
@pytest.mark.covers("cpl.MCOPS")
def test_a_channel_is_reset_and_changes_its_mode_on_demand(example: Example) -> None:
    example.start("N1 G1 X2=400 F600", channel=2)
    example.pnc.advance(100)
    found = example.run(
        "10 #A%=MCOPS(7,2,4) : #B%=MCOPS(5,2) : #C%=MCOPS(2,2)\n20 WAIT(,200)\n30 #D%=MCOPS(7,2,4)\n"
        '40 #E%=MCOPS(4,2,"G1 X2=3 F6000",,,160) : #F%=MCOPS(7,2,99)\n50 WAIT(,2000)\n60 #G=SPOS(4)'
    )
    assert [found[f"#{name}"] for name in ("A%", "B%", "C%", "D%", "E%", "F%")] == [13, 0, 3, 0, 0, 18]
    assert found["#G"] == pytest.approx(3)


@pytest.mark.covers("cpl.MCOPS.1", "cpl.MCOPS.2", "cpl.MCOPS.7")
@pytest.mark.covers("cpl.MCOPS")
def test_the_rest_of_a_way_is_not_cancelled_by_another_channel(example: Example) -> None:
    example.start("N1 G1 X2=9 F600", channel=2)
    ask = "{0}0 #{1}%=MCOPS(1,{2})\n"
    found = example.run(
        "".join(ask.format(*each) for each in ((1, "A", 2), (2, "B", 3), (3, "C", 4)))
        + "40 #D%=MCOPS(2,2)\n50 WAIT(,500)\n60 #E%=MCOPS(7,2,1) : #F%=MCOPS(1,2)"
    )
    assert [found[f"#{name}%"] for name in "ABCDEF"] == [102, 10, 1, 0, 0, 10]


@pytest.mark.covers("cpl.PROBE")
@pytest.mark.covers("cpl.ex.2607", "cpl.err.1938", "cpl.err.1970")
def test_errors_of_another_channel_are_told_in_their_order(example: Example) -> None:
    example.start("1 A=CPOS(9)", channel=2)
    example.pnc.advance(3)
    program = (
        "10 DIM ERRNO%(5,3):REM Integer array with 5 elements\n20 CHAN%=2 : CATEGORY%=0\n"
        "30 ERG%= GETERR(CHAN%, CATEGORY%, ERRNO%, 5)\n40 FOR I%= 1 TO ERG%\n50 IF ERRNO%(I%,3)=6 THEN\n"
        '60 PRN#(0, "Part program error: ",ERRNO%(I%,1))\n70 ENDIF\n80 NEXT I%\n90 #ERG%=ERG% : #E%=ERRNO%(1,2)'
    )
    found = example.run(program)
    assert (found["#ERG%"], found["#E%"]) == (1, 2)
    run = example.pnc.control.channels[0].run
    assert run is not None
    assert [message.text.split() for message in run.channel.messages.all()] == [
        ["MSG:", "Part", "program", "error:", "1938"]
    ]
    example.pnc.reset(channel=2)
    assert example.run(program)["#ERG%"] == 0
    assert example.refuses("PROBE(1,0)", 2) == "1970"


@pytest.mark.parametrize(
    ("line", "what"), [("20 A=CPOS(9)", "INVALID"), ("N2 X[1/A%]", "division"), ("N2 Q7", "Q")]
)
def test_an_error_of_a_block_prepared_ahead_is_told_when_the_program_gets_there(
    example: Example, line: str, what: str
) -> None:
    example.start(f"1 A%=0\nN1 G1 X10 F6000\n{line}\nN3 X20")
    for _ in range(3):  # 100 ms of motion and ramps
        example.pnc.advance(30)
        assert example.pnc.information(Tab.ERRORS) == []
        assert example.pnc.run_state(1) is RunState.ACTIVE
    example.pnc.advance(60)
    assert example.pnc.run_state(1) is RunState.ALARM
    assert example.pnc.axes["X"].setpoint == 10.0
    (told,) = example.pnc.information(Tab.ERRORS)
    assert what in told[-1]
    assert [*example.pnc.information(Tab.ERRORS)] == [told]  # once
    example.pnc.reset(channel=1)
    assert example.pnc.information(Tab.ERRORS) == []


def test_an_error_stops_its_channel_alone_and_closes_its_files(example: Example) -> None:
    example.start("N1 G1 X30 F6000\n1 WAIT\n2 #A=1")
    example.start('10 OPENW(1,"R") : PRN#(1,"KEPT") : @7%=5\n20 A=CPOS(9)', channel=2)
    example.pnc.advance(2000)
    assert example.pnc.run_state(1) is RunState.COMPLETED
    assert example.pnc.run_state(2) is RunState.ALARM
    assert (example.folder / "R").read_bytes() == b"KEPT\n\x03\n"
    found = example.run('1 OPENW(1,"R") : PRN#(1,"NEXT") : #B%=@7%')  # number 1 and the file are free
    assert found["#B%"] == 5
    with pytest.raises(ControlError):
        example.pnc.cycle_start(channel=2)
    example.pnc.reset(channel=2)
    example.pnc.cycle_start(channel=2)


# ---------------------------------------------------------------------- the operator


@pytest.mark.covers("cpl.start", "cpl.sig.NC-I_1.0")
def test_programs_are_selected_started_held_and_reset(example: Example) -> None:
    pnc = example.pnc
    with pytest.raises(ControlError, match="there is no program"):
        pnc.select_program("none.npg")
    with pytest.raises(ControlError):
        pnc.cycle_start()
    example.start("10 FOR I%=1 TO 3\nN10 G91 G1 X10 F6000\n20 NEXT I%")
    pnc.advance(150)
    pnc.feed_hold(channel=1)
    pnc.advance(100)
    held = pnc.axes["X"].setpoint
    assert 0 < held < 30
    assert pnc.run_state() is RunState.HOLD
    pnc.advance(500)
    assert pnc.axes["X"].setpoint == held
    pnc.cycle_start()
    pnc.advance(2000)
    assert (pnc.axes["X"].setpoint, pnc.run_state()) == (30, RunState.COMPLETED)
    pnc.cycle_start()
    pnc.advance(100)
    pnc.reset()
    pnc.advance(500)
    assert pnc.run_state() is RunState.RESET
    assert 30 < pnc.axes["X"].setpoint < 60


def test_single_block_stops_behind_each_block(example: Example) -> None:
    example.pnc.select_mode(Mode.SINGLE_BLOCK, channel=1)
    example.start("N1 G1 X1 F6000\n10 A=CPOS(1)+1\nN2 X[A]\nN3 X7")
    reached = []
    for _ in range(3):
        example.pnc.advance(500)
        reached.append(example.pnc.axes["X"].setpoint)
        example.pnc.cycle_start()
    assert reached == [1, 2, 7]
    assert example.run("1 A%=0 : #A%=SD(13)", channel=2)["#A%"] == 1


@pytest.mark.parametrize(
    ("mode", "expected"),
    [
        pytest.param(mode, value, marks=pytest.mark.covers("cpl.SD.13", f"cpl.SD.13.val.{value}"))
        for mode, value in (
            (Mode.SINGLE_BLOCK, 0), (Mode.SINGLE_STEP, 0), (Mode.AUTOMATIC, 1), (Mode.PROGRAM_BLOCK, 2),
        )
    ],
)  # fmt: skip
@pytest.mark.covers("cpl.SD")
def test_a_program_is_told_the_mode_of_its_channel(example: Example, mode: Mode, expected: int) -> None:
    other = Mode.AUTOMATIC if mode is Mode.SINGLE_BLOCK else Mode.SINGLE_BLOCK
    example.pnc.select_mode(other, channel=1)
    example.pnc.select_mode(mode, channel=2)
    example.start("1 #A%=SD(13)", channel=2)
    example.pnc.advance(20)
    assert example.pnc.variables(2)["#A%"] == expected


@pytest.mark.parametrize(
    "loop",
    ["10 WHILE 1=1 DO\n20 A=A\n30 END", "10 A%=1\n20 GOTO 10", "10 REPEAT\n20 A?=IC(1)\n30 UNTIL 1=2"],
)
def test_an_endless_loop_lets_time_pass_and_ends_with_a_reset(example: Example, loop: str) -> None:
    example.start(loop.replace("20 A=A", "20 A=1"))
    example.start("N1 G1 X2=2 F6000", channel=2)
    assert example.pnc.advance(60) == 60
    assert example.pnc.run_state(1) is RunState.ACTIVE
    assert example.pnc.axes["X2"].setpoint > 1
    example.pnc.reset(channel=1)
    assert example.pnc.run_state(1) is RunState.RESET
    assert example.run("N1 G1 X4 F6000\n1 #A=1")["#A"] == 1


def test_a_wait_ends_by_a_signal_in_its_cycle(example: Example) -> None:
    example.start("10 WAIT(IC(4,1,2)=TRUE,5000,#R%)\nN1 G1 X1 F6000\n20 WAIT\n30 #T%=CLOCK")
    example.pnc.advance(250)
    assert example.pnc.axes["X"].setpoint == 0
    example.pnc.system.interface.set_bit(Signals.AXIS_INPUTS, 2, 4, True)
    example.pnc.advance(100)
    assert (example.pnc.variables()["#R%"], example.pnc.axes["X"].setpoint) == (2, 1)


def test_what_is_permanent_is_there_after_switching_on_again(example: Example) -> None:
    example.run('1 @5%=17 : FXC("X2",55,1)=2.5 : TC(1,7,4)=30 : TDA(1,2,9)=4711')
    example.pnc.close()
    example.pnc = example.switched_on()
    found = example.run(
        "1 #A%=@5% : #B=TC(1,7,4) : #C%=TDA(1,2,9)\nN1 G55\nN2 G0 X2=1\n2 WAIT\n3 #D=MPOS(1)", channel=2
    )
    assert [found[name] for name in ("#A%", "#B", "#C%", "#D")] == [17, 30, 4711, 3.5]


def test_snapshots_are_taken_between_cpl_programs_and_in_them(example: Example) -> None:
    example.run("N1 G0 X5")
    snapshot = example.pnc.snapshot()
    example.run("N1 G0 X9")
    example.pnc.restore(snapshot)
    assert example.pnc.axes["X"].setpoint == 5
    example.start("10 WAIT(,500)\n20 #A=1")
    example.pnc.advance(5)
    snapshot = example.pnc.snapshot()
    assert example.pnc.advance(20_000, until=lambda: example.pnc.run_state(1) is RunState.COMPLETED) == 496
    example.pnc.restore(snapshot)
    assert example.pnc.advance(20_000, until=lambda: example.pnc.run_state(1) is RunState.COMPLETED) == 496


# ---------------------------------------------------------------------- what another channel sees


@pytest.mark.covers("cpl.MCODS.3", "cpl.MCODS.87")
@pytest.mark.covers("cpl.nc.G95", "cpl.nc.M0_M1")
@pytest.mark.covers("cpl.MCODS")
def test_feeds_per_revolution_and_program_stops_are_seen(example: Example) -> None:
    example.start("N1 G95 F0.5 S1300 M3\nN2 G1 X4\nN3 M0\nN4 G1 X5")
    read = "1 DIM R(3) : DIM W%(1)\n2 V=0 : #E%=MCODS(3,1,V,R,3) : #F=R(1)\n3 V=0 : #G%=MCODS(87,1,V,W%,1) : #W%=W%(1)"
    example.pnc.advance(150)
    found = example.run(read, channel=2)
    assert (found["#E%"], found["#F"], found["#G%"], found["#W%"]) == (0, 650, 0, 0)
    example.pnc.advance(1000)
    assert example.pnc.run_state(1) is RunState.PROGRAM_STOP
    found = example.run(read, channel=2)
    assert (found["#F"], found["#W%"]) == (0, 16)
    example.pnc.cycle_start()
    example.pnc.advance(500)
    assert example.pnc.axes["X"].setpoint == 5
    example.pnc.control.set_switches(optional_stop=True)
    example.start("N1 M1\nN2 G1 X7")
    example.pnc.advance(50)
    assert example.pnc.run_state(1) is RunState.OPTIONAL_STOP
    assert example.run(read, channel=2)["#W%"] == 16


@pytest.mark.covers("cpl.SCS")
@pytest.mark.covers(
    "cpl.err.SERCOS_LOCKED", "cpl.SCS.result.1", "cpl.SCSL.result.1", "cpl.err.SCS_ACCESS", "cpl.SCSL"
)
def test_a_locked_service_channel_leaves_the_old_value(example: Example) -> None:
    drives = example.pnc.system.drives
    example.run("N1 G0 X3.5")
    assert example.run('1 #P%=SCS(1,"S",47)')["#P%"] == 35000
    drives.locked = True
    example.run("N1 G0 X8")
    found = example.run('1 #P%=SCS(1,"S",47,#E%) : SCSL(1,"S",187,"L",#F%) : #Q%=SCS(1,"S",51,#G%)')
    assert [found[name] for name in ("#P%", "#E%", "#F%", "#Q%", "#G%")] == [
        35000,
        1,
        1,
        80000,
        0,
    ]  # 51 is cyclic
    for statement in ('A%=SCS(1,"S",47)', 'SCSL(1,"S",187,"L")'):
        example.start(f"1 {statement}")
        example.pnc.advance(3)
        run = example.pnc.control.channels[0].run
        assert run is not None
        assert run.error is not None
        assert run.error.what == "SERCOS SERVICE CHANNEL IS LOCKED"
        example.pnc.reset()
        example.pnc.advance(1)
    drives.locked = False
    assert example.run('1 #P%=SCS(1,"S",47,#E%)')["#P%"] == 80000
    assert not (example.folder / "L").exists()


class Frozen:
    """A wall clock that stands."""

    def now_s(self) -> float:
        return 0.0


def test_a_host_lends_it_time(example: Example) -> None:
    example.start("N1 G1 X2 F6000\n1 WAIT(,100)\n2 #A=MPOS(1)")
    with Host(example.pnc, Frozen(), rate=0.0) as host:
        host.call(lambda pnc: pnc.advance(400))
        assert host.call(lambda pnc: pnc.run_state()) is RunState.COMPLETED
    assert example.pnc.variables()["#A"] == 2


# ---------------------------------------------------------------------- the NCS coupling

ASKS = "10 DIM B%(2) : V=0\n20 E%=MCODS(32,1,V,B%,2) : #S%=B%(1)\n"


@pytest.mark.covers("cpl.MCODS.32")
@pytest.mark.covers("cpl.MCODS")
def test_what_changes_and_changes_back_between_two_questions_is_new(example: Example) -> None:
    """Channel 1 is inactive, runs a short program, and is inactive again while channel 2 dwells."""
    example.start(ASKS + "30 WAIT(,300)\n40 E%=MCODS(32,1,V,B%,2) : #T%=B%(1) : #E%=E%", channel=2)
    example.pnc.advance(5)
    example.start("N1 G0 X1")
    example.pnc.advance(2000)
    assert example.pnc.run_state(2) is RunState.COMPLETED
    found = example.pnc.variables(2)
    assert [found[name] for name in ("#S%", "#T%", "#E%")] == [1, 1, 0]


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCODS.32")
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_another_control_is_asked_and_serves_without_further_calls(example: Example, tmp_path: Path) -> None:
    root = tmp_path / "second"
    root.mkdir()
    (root / "main.npg").write_text(
        ASKS + '25 #F%=MCOPS(4,1,"short.npg",,,128)\n30 WAIT(,300)\n40 E%=MCODS(32,1,V,B%,2) : #T%=B%(1)\n'
    )
    example.write("short.npg", "N1 G1 X3 F6000")
    second = Pnc(root, example.machine, server=example.pnc.ncs)
    try:
        second.select_program("main.npg")
        second.cycle_start()
        for _ in range(100):  # two clocks of one time, a while each
            second.advance(20)
            example.pnc.advance(20)
        assert second.run_state() is RunState.COMPLETED, second.status().alarms
        found = second.variables()
    finally:
        second.close()
    assert [found[name] for name in ("#S%", "#F%", "#T%")] == [1, 0, 1]
    assert example.pnc.axes["X"].setpoint == 3


# ---------------------------------------------------------------------- block search

SEARCHED = """1 OPENW(1,"R",200) : @5=@5+1 : #S%=SD(13)
10 FOR I%=1 TO 3
N20 G91 G1 X[I%*2] F6000
30 NEXT I%
35 WAIT(,5000,#W%)
36 WAIT(IC(1),,#X%)
37 #P=SDR(1,1) : #Q=MPOS(1)
40 CALL side
N50 G90 G1 Y8
60 #T%=SD(13) : #A=SDR(1,1) : #B=SDR(1,2) : #C=SDR(1,3) : WHO%=3
N70 G1 Z[WHO%]
80 WAIT
90 #D=MPOS(1) : #E=MPOS(2)
"""


@pytest.mark.covers(
    "cpl.SD.13", "cpl.SD.13.val.10", "cpl.SD.13.val.11", "cpl.SD.13.val.0", "cpl.SD.13.val.1", "cpl.SDR.1.n"
)
@pytest.mark.parametrize(
    ("mode", "seen"), [(Mode.AUTOMATIC, (11, 1)), (Mode.SINGLE_BLOCK, (10, 0)), (Mode.PROGRAM_BLOCK, (10, 2))]
)
@pytest.mark.covers("cpl.SD", "cpl.SDR")
def test_a_block_is_searched_through_statements(example: Example, mode: Mode, seen: tuple[int, int]) -> None:
    """Three moves of 2, 4 and 6 mm and one of 1.5 in a sub-program stand before N50; nothing of them is moved."""
    example.run("1 @5=0")
    example.write("side", "1 P%=5\nN1 G1 X[P%*0.3] Y4")
    example.write("main1.npg", SEARCHED)
    pnc = example.pnc
    pnc.select_mode(mode)
    pnc.select_program("main1.npg")
    assert pnc.search_block("N50") == 9
    with pytest.raises(SnapshotError, match="has been searched"):
        pnc.snapshot()
    assert (pnc.axes["X"].setpoint, pnc.axes["Y"].setpoint) == (0, 0)
    for _ in range(30):
        if pnc.run_state() is RunState.COMPLETED:
            break
        pnc.cycle_start()
        pnc.advance(2000, until=lambda: pnc.run_state() is not RunState.ACTIVE)
    found = pnc.variables()
    assert (found["#S%"], found["#T%"]) == seen
    assert [found[name] for name in ("#W%", "#X%", "#P", "#Q")] == [1, 2, 12, 0]
    assert [found[name] for name in ("#A", "#B", "#C", "#D", "#E", "@5")] == [13.5, 4, 0, 13.5, 8, 1]
    assert pnc.axes["Z"].setpoint == 3
    assert example.run("1 #A=SDR(1,1) : #S%=SD(13)")["#A"] == 0


def test_searches_that_come_to_nothing_leave_the_program_at_its_beginning(example: Example) -> None:
    loops = "10 GOTO 10\nN30 X1\n"
    for program, what in (
        ("10 GOTO 40\nN30 X1\n40 A=1", "the program ends before line 2"),
        (loops, "waits or loops without a block before line 2"),
        ("10 A=1/0\nN30 X1", "the program ends before line 2"),
    ):
        example.write("main1.npg", program)
        example.pnc.select_program("main1.npg")
        with pytest.raises(ControlError, match=what):
            example.pnc.search_block("30")
    with pytest.raises(ControlError, match="no block N31"):
        example.pnc.search_block("N31")
    assert example.run("N1 G0 X2\n2 WAIT\n3 #A=MPOS(1)")["#A"] == 2


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.6")
@pytest.mark.covers("cpl.MCOPS.3")
@pytest.mark.covers("cpl.MCOPS")
def test_a_program_has_another_channel_search_a_block(example: Example) -> None:
    example.write("other.npg", "1 A=4\nN10 G91 G1 X2=[A] F6000\nN20 X2=[A]\nN30 Y2=[A]")
    found = example.run(
        '1 #A%=MCOPS(4,2,"other.npg") : #B%=MCOPS(3,2,"30") : #C%=MCOPS(3,2,"N40") : #D%=MCOPS(6,2)\n2 WAIT(,500)'
    )
    assert [found[name] for name in ("#A%", "#B%", "#C%", "#D%")] == [0, 0, 14, 0]
    assert (example.pnc.axes["X2"].setpoint, example.pnc.axes["Y2"].setpoint) == (8, 4)


# ---------------------------------------------------------------------- the spindle

SENSES = " : ".join(
    f"#{name}%=SD({place})" for name, place in zip("ABC", ("12,1", "12,2", "212,1,1"), strict=True)
)


@pytest.mark.covers("cpl.SD.12.val.19", "cpl.SD.12.1", "cpl.SD.12.2", "cpl.MCODS.63.val.6", "cpl.MCODS.63")
@pytest.mark.covers("cpl.MCODS", "cpl.SD")
def test_an_oriented_spindle_is_told(tmp_path: Path) -> None:
    machine = tmp_path / "spindle.toml"
    machine.write_text(
        MACHINE + "[spindle]\nmax_rpm = 6000\norientation_deg = 37.5\n[times]\nspindle_start_s = 0.25\n"
    )
    ask = f'DIM B%(8) : DIM #T$(4) : V=0 : E%=MCODS(63,-1,V,B%,8) : #M%=B%(1) : {SENSES} : #T$=NCF("M5")'
    pnc = Pnc(tmp_path, machine)
    try:
        for before, sense, movement, oriented in (
            ("N1 M3 S1200\nN2 M19\nN3 M8", 19, 6, True),
            ("N1 M19\nN2 M4 S900", 4, 3, False),
            ("N1 M19\nN2 M5", 0, 5, False),
        ):
            (tmp_path / "main.npg").write_text(f"{before}\n10 WAIT\n20 {ask}\n")
            pnc.select_program("main.npg")
            pnc.cycle_start()
            pnc.advance(5000, until=lambda: pnc.run_state() is not RunState.ACTIVE)
            assert pnc.run_state() is RunState.COMPLETED, pnc.status().alarms
            found = pnc.variables()
            assert [found[f"#{name}%"] for name in "ABCM"] == [sense, sense, sense, movement]
            state = pnc.control.spindle.state()
            assert state.oriented is oriented
            if oriented:
                assert (state.actual_rpm, state.angle_deg % 360) == (0, 37.5)
    finally:
        pnc.close()


@pytest.mark.covers(
    *(f"cpl.SD.{row}" for row in (
        "2.1", "2.3", "2.4", "5.1.1", "5.2.1", "5.3.1", "5.3.3", "5.4.1", "8", "15", "20.1", "20.2", "21.n.1", "21.n.2",
        "22.m.1", "22.m.2", "23.m.1", "23.m.2", "24.m.n.1", "24.m.n.2", "25.m", "202.s", "205.1.s", "205.3.s",
    )),
    "cpl.SDR.2.1", "cpl.SDR.2.3", "cpl.SDR.202.s",
)  # fmt: skip
@pytest.mark.covers("cpl.SD", "cpl.SDR")
def test_system_data_are_those_of_the_running_control(example: Example) -> None:
    example.pnc.control.set_overrides(feed=0.85, spindle=0.5)
    example.pnc.control.set_switches(machine_lock=True)
    wanted = {
        "SD(2,1)": 85, "SD(2,3)": 50, "SD(2,4)": 0, "SD(5,1,1)": 340, "SD(5,2,1)": 30000, "SD(5,3,1)": 600,
        "SD(5,3,3)": 600, "SD(5,4,1)": 0, "SD(8)": 1, "SD(15)": 1, "SD(20)": 3, "SD(20,2)": 3, "SD(21,3)": 1,
        "SD(21,2,2)": 3, 'SD(22,"Z")': 3, "SD(22,4,2)": 0, "SD(23,2)": 2, 'SD(23,"Z",2)': 3, "SD(24,1,3)": 8,
        'SD(24,"Y2",2,2)': 5, 'SD(25,"A")': 3, "SD(25,6)": 2, "SD(202,1)": 50, "SD(205,1,1)": 600,
        "SD(205,3,1)": 600, "SDR(2,1)": 85, "SDR(2,3)": 50, "SDR(202,1)": 50,
    }  # fmt: skip
    asked = "\n".join(f"{place} #V{place}!={each}" for place, each in enumerate(wanted, 10))
    found = example.run(f"N1 M3 S1200\nN2 G1 X1 F400\n3 WAIT\n{asked}")
    assert {each: found[f"#V{place}!"] for place, each in enumerate(wanted, 10)} == wanted
    example.pnc.control.set_switches(machine_lock=False)
    assert example.value("SD(8)", 2) == 2
    assert example.value("SD(15)") == 0


TAPPED = (
    "PARTNO/TAPS\nUNITS/MM\nLOADTL/3\nSPINDL/RPM,400,{}\nRAPID\nGOTO/0,0,20\nCYCLE/TAP,DEPTH,12,MMPR,1.25,CLEAR,5\n"
    "GOTO/10,10,0\nCYCLE/OFF\nRAPID\nGOTO/0,0,50\nFINI\n"
)


@pytest.mark.parametrize(("name", "sense", "turn"), [("bosch-pnc", "CLW", 1), ("bosch-pnc-cpl", "CCLW", -1)])
def test_a_posted_thread_is_cut_with_the_turn_and_left_against_it(
    tmp_path: Path, name: str, sense: str, turn: int
) -> None:
    posted = post_file(parse_tool_path(TAPPED.format(sense)), name, verify=True)
    assert posted.ok
    (tmp_path / "tap.npg").write_text(posted.text or "")
    pnc = Pnc(tmp_path, "mill3")
    seen: list[tuple[int, float]] = []

    def look() -> bool:
        direction = pnc.control.spindle.state().direction
        if not seen or seen[-1][0] != direction:
            seen.append((direction, round(pnc.axes["Z"].setpoint, 3)))
        return pnc.run_state() is not RunState.ACTIVE

    try:
        pnc.select_program("tap.npg")
        pnc.cycle_start()
        pnc.advance(20_000, until=look)
        assert pnc.run_state() is RunState.COMPLETED, pnc.status().alarms
    finally:
        pnc.close()
    assert seen == [(0, 0), (turn, 0), (0, -12), (-turn, -12), (0, 5), (turn, 5), (0, 50)]
