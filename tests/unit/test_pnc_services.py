"""MCOPS and MCODS between the channels of a living control: what is answered 0 has been done (Manual 003, 4.14)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.cnc import RunState
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import Ipo, Mode, Sav
from polycnc.controllers.bosch.system import MODE_BY_PLC
from polycnc.machine import SnapshotError

AXIS = '[[axis]]\nname = "{}"\nvmax_mm_s = 500\namax_mm_s2 = 5000\n'
MACHINE = 'name = "two"\n' + "".join(map(AXIS.format, ("X", "Y", "X2", "Y2")))
PART = "N10 G1 F60000 X2=10\nN20 X2=20\nN30 X2=30\nN40 X2=40\nM30\n"
COUNTED = "1 #A%=1\nN10 G1 F60000 X2=10\n15 #A%=2\nN20 X2=20\n25 #A%=3\nN30 X2=30\n35 #A%=4\nN40 X2=40\nM30\n"


class Two:
    """A control with X and Y in channel 1, X2 and Y2 in channel 2; `ask` runs lines in channel 1."""

    def __init__(self, folder: Path, *, reselects: bool = False) -> None:
        self.folder = folder
        (folder / "two.toml").write_text(MACHINE)
        channels = [("X", "Y"), ("X2", "Y2")]
        self.pnc = Pnc(folder, folder / "two.toml", channels=channels, reselects=reselects)
        self.write("PART", PART)
        self.write("COUNTED", COUNTED)
        self.write("LONG", "N1 G1 X2=400 F6000\nN2 X2=0\n")

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)

    def start(self, program: str, channel: int = 1) -> None:
        self.write(f"main{channel}", program + "\n")
        self.pnc.select_program(f"main{channel}", channel=channel)
        self.pnc.cycle_start(channel=channel)

    def ask(self, *calls: str, cycles: int = 20_000) -> list[object]:
        """Let channel 1 call functions one after the other; return what each has answered, None for never."""
        lines = [f"{10 * place} #R{place}%={call}" for place, call in enumerate(calls, 1)]
        self.start("\n".join(lines))
        self.pnc.advance(cycles, until=lambda: self.pnc.run_state(1) is not RunState.ACTIVE)
        found = self.pnc.variables(1)
        return [found.get(f"#R{place}%") for place, _ in enumerate(calls, 1)]

    def after(self, channel: int = 2) -> None:
        """Let time pass until a channel is over."""
        self.pnc.advance(20_000, until=lambda: self.pnc.run_state(channel) is not RunState.ACTIVE)

    def x2(self) -> float:
        return round(self.pnc.axes["X2"].setpoint, 9)

    def sav(self, channel: int = 2) -> Sav:
        return self.pnc.system.shown.renew().channels[channel].sav


@pytest.fixture
def two(tmp_path: Path) -> Iterator[Two]:
    found = Two(tmp_path)
    yield found
    found.pnc.close()


@pytest.fixture
def again(tmp_path: Path) -> Iterator[Two]:
    found = Two(tmp_path, reselects=True)
    yield found
    found.pnc.close()


# ---------------------------------------------------------------------- search, select


@pytest.mark.covers("cpl.MCOPS.6")
@pytest.mark.covers("cpl.MCOPS")
@pytest.mark.covers(
    "cpl.MCOPS.3",
    "cpl.MCOPS.4",
    "cpl.ncs.0",
    "cpl.ncs.14",
    "cpl.MCODS.32.sav.2",
    "cpl.MCODS.32",
    "cpl.MCODS.32.elem.1",
)
@pytest.mark.parametrize(
    ("name", "start", "end", "code", "x2", "seen"),
    [
        ("PART", "N20", "N30", 0, 30, None),
        ("COUNTED", "N20", "N30", 0, 30, 3),  # no statement after the end is executed
        ("PART", "", "N20", 0, 20, None),
        ("COUNTED", "", "20", 0, 20, 2),
        ("PART", "N30", "", 0, 40, None),
        ("PART", "N99", "N20", 14, 20, None),  # a block that is not there: from the beginning
        ("PART", "N20", "N99", 14, 40, None),  # to the end
        ("PART", "N98", "N99", 14, 40, None),
    ],
)
@pytest.mark.parametrize("at_once", [True, False])
@pytest.mark.covers("cpl.MCODS")
def test_a_part_of_a_program_is_selected_and_machined(
    two: Two, name: str, start: str, end: str, code: int, x2: float, seen: int | None, at_once: bool
) -> None:
    if at_once:
        assert two.ask(f'MCOPS(4,2,"{name}","{start}","{end}",1)') == [code]
    else:
        assert two.ask(f'MCOPS(4,2,"{name}")', f'MCOPS(3,2,"{start}","{end}")') == [0, code]
    assert two.sav() is Sav.READY or code == 14
    assert two.x2() == 0
    assert two.ask("MCOPS(6,2)") == [0]
    two.after()
    assert (two.pnc.run_state(2), two.x2(), two.pnc.variables(2).get("#A%")) == (RunState.COMPLETED, x2, seen)
    assert two.sav() is Sav.INACTIVE


@pytest.mark.covers("cpl.MCOPS.3", "cpl.MCOPS.4", "cpl.MCOPS.6")
@pytest.mark.covers(
    "cpl.ncs.10", "cpl.ncs.11", "cpl.ncs.15", "cpl.ncs.2", "cpl.ncs.8", "cpl.MCODS.32.sav.3", "cpl.MCODS.32"
)
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_a_search_is_refused_where_it_cannot_be(two: Two) -> None:
    two.write("STOPS", "N1 G1 X2=1 F6000\nN2 M0\nN3 X2=2\n")
    assert two.ask('MCOPS(3,2,"N3")', 'MCOPS(4,2,"STOPS")', "MCOPS(6,2)", 'MCOPS(3,2,"N3")') == [10, 0, 0, 2]
    two.after()
    assert two.pnc.run_state(2) is RunState.PROGRAM_STOP
    assert two.ask('MCOPS(3,2,"N3")', 'MCOPS(3,3,"N3")', 'MCOPS(4,2,"PART")') == [15, 1, 11]
    assert two.ask("MCOPS(6,2)") == [0]
    two.after()
    assert two.x2() == 2
    two.pnc.select_program("PART", channel=2)
    two.pnc.control.select_mode(two.pnc.control.mode.__class__.JOG, channel=1)
    assert two.ask('MCOPS(3,2,"N20")') == [8]


@pytest.mark.covers("cpl.MCOPS.6", "cpl.MCOPS.5")
@pytest.mark.covers(
    "cpl.ncs.6",
    "cpl.MCOPS.4.code.2",
    "cpl.MCOPS.4.code.1",
    "cpl.MCODS.32.sav.6",
    "cpl.MCOPS.4",
    "cpl.MCODS.32",
)
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_a_missing_program_is_refused_with_code_2_and_else_an_error_of_its_channel(two: Two) -> None:
    two.write("WRONG", "10 A%=\n")
    assert two.ask('MCOPS(4,2,"NONE",,,2)', 'MCOPS(4,2,"WRONG",,,3)') == [6, 6]
    assert two.ask('MCOPS(4,2,"NONE")') == [0]
    assert two.sav() is Sav.ERROR
    assert two.ask("MCOPS(6,2)", "MCOPS(5,2)", "MCOPS(6,2)") == [9, 0, 10]
    assert two.sav() is Sav.INACTIVE
    assert two.ask('MCOPS(4,2,"COUNTED",,,3)', "MCOPS(6,2)") == [0, 0]
    two.after()
    assert two.x2() == 40


@pytest.mark.covers("cpl.MCOPS.6")
@pytest.mark.covers("cpl.MCOPS")
@pytest.mark.covers("cpl.ncs.11", "cpl.MCOPS.4.code.64", "cpl.MCOPS.4.code.2048", "cpl.ncs.9", "cpl.MCOPS.4")
def test_an_active_program_is_left_before_another_one(two: Two) -> None:
    two.pnc.select_program("LONG", channel=2)
    two.pnc.cycle_start(channel=2)
    two.pnc.advance(100)
    # to replace it with all modal states is not simulated, and said
    assert two.ask('MCOPS(4,2,"PART")', 'MCOPS(4,2,"PART",,,2048)', "MCOPS(6,2)") == [11, 102, 9]
    assert two.pnc.run_state(2) is RunState.ACTIVE
    assert two.ask('MCOPS(4,2,"PART",,,64)', "MCOPS(6,2)") == [0, 0]
    two.after()
    assert two.x2() == 40


# ---------------------------------------------------------------------- blocks put in by hand


@pytest.mark.covers("cpl.MCOPS.7")
@pytest.mark.covers(
    "cpl.MCOPS.4.code.32", "cpl.MCOPS.5", "cpl.MCOPS.6", "cpl.MCODS.32.sav.11", "cpl.MCODS.32.sav.1", "cpl.ncs.10",
    "cpl.MCOPS.4", "cpl.MCODS.32")  # fmt: skip
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_a_block_put_in_by_hand_is_started_by_the_next_call(two: Two) -> None:
    block = 'MCOPS(4,2,"G1 X2=3 F6000",,,32)'
    assert two.ask(block) == [8]
    assert two.ask("MCOPS(7,2,4)", block) == [0, 0]
    assert two.sav() is Sav.AT_START
    assert two.ask("MCOPS(6,2)") == [0]
    two.after()
    assert (two.x2(), two.sav()) == (3, Sav.INACTIVE)
    assert two.ask("MCOPS(6,2)", block.replace("3 F", "4 F"), "MCOPS(5,2)", "MCOPS(5,2)", "MCOPS(6,2)") == [
        10, 0, 0, 10, 10,
    ]  # fmt: skip
    assert two.x2() == 3
    assert two.ask(block.replace("3 F", "5 F"), block.replace("3 F", "6 F"), "MCOPS(6,2)") == [0, 0, 0]
    two.after()
    assert two.x2() == 6


@pytest.mark.covers("cpl.MCOPS.5")
@pytest.mark.covers(
    "cpl.MCOPS.4.code.128", "cpl.MCOPS.4.code.1024", "cpl.ncs.25", "cpl.ncs.18", "cpl.ncs.102", "cpl.MCOPS.4"
)
@pytest.mark.covers("cpl.MCOPS")
def test_a_block_that_starts_at_once_is_executed_or_refused(two: Two) -> None:
    two.pnc.select_mode(Mode.MDI, channel=2)
    assert two.ask('MCOPS(4,2,"G1 X2=5 F6000",,,160)') == [0]
    # a machine function beside a block that is executed is not simulated
    assert two.ask('MCOPS(4,2,"M8",,,1184)', 'MCOPS(4,2,"M8",,,160)', 'MCOPS(4,2,"G1 X2=9",,,32)') == [
        102,
        102,
        2,
    ]
    two.after()
    assert two.x2() == 5
    assert two.ask('MCOPS(4,2,"G1 X2=",,,160)') == [25]
    assert two.sav() is Sav.ERROR
    assert two.ask("MCOPS(5,2)", f'MCOPS(4,2,"G1 X2=7 F6000",,,{160 + 2**14})', 'MCOPS(4,2,"",,,32)') == [
        0,
        18,
        18,
    ]


BUFFERED = 32 + 4096


@pytest.mark.covers("cpl.MCOPS.6", "cpl.MCOPS.5")
@pytest.mark.covers(
    "cpl.MCOPS.4.code.4096", "cpl.MCODS.32.sav.12", "cpl.ncs.26", "cpl.MCOPS.4", "cpl.MCODS.32"
)
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_blocks_are_put_in_while_others_are_executed(two: Two) -> None:
    two.pnc.select_mode(Mode.MDI, channel=2)
    write = 'MCOPS(4,2,"{}",,,{})'
    assert two.ask(write.format("G1 X2=3 F600", BUFFERED), "MCOPS(6,2)") == [0, 0]
    assert two.sav() is Sav.ACTIVE
    assert two.ask(write.format("X2=4", BUFFERED)) == [0]
    assert two.pnc.run_state(2) is RunState.ACTIVE
    two.pnc.advance(2000)
    assert (two.x2(), two.sav()) == (4, Sav.BUFFER_EMPTY)
    with pytest.raises(SnapshotError, match="buffered blocks"):
        two.pnc.snapshot()
    assert two.ask(write.format("X2=5", BUFFERED + 128), write.format("M0", BUFFERED)) == [0, 0]
    two.pnc.advance(500)
    assert (two.x2(), two.pnc.run_state(2)) == (5, RunState.PROGRAM_STOP)
    assert two.ask("MCOPS(6,2)", "MCOPS(5,2)") == [0, 0]
    assert two.sav() is Sav.INACTIVE


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.4.code.4096")
@pytest.mark.covers("cpl.ncs.26")
@pytest.mark.covers("cpl.MCOPS")
def test_a_buffer_that_is_full_takes_nothing(two: Two) -> None:
    two.pnc.select_mode(Mode.MDI, channel=2)
    pnc = two.pnc
    block = f'MCOPS(4,2,"{"    " * 46}G1 F6000 X2=1",,,4128)'  # with its line feed 198 bytes
    size = 4 * 46 + 14
    fitting = 4096 // size
    assert two.ask(f'MCOPS(4,2,"{" " * 4096}",,,4128)', f'MCOPS(4,2,"{" " * 9000}",,,4128)') == [26, 26]
    assert two.ask(*[block] * fitting, block, 'MCOPS(4,2,"X2=2",,,4128)') == [*fitting * [0], 26, 0]
    pnc.cycle_start(channel=2)
    pnc.advance(3000)
    assert two.x2() == 2
    assert two.ask("MCOPS(5,2)") == [0]
    pnc.advance(100)
    longest = [f'MCOPS(4,2,"G1{" " * (size - 2)}",,,4128)' for size in (4096, 4095)]
    assert two.ask(*longest) == [26, 0]
    assert two.ask("MCOPS(5,2)") == [0]
    pnc.advance(100)
    assert two.ask(
        f'MCOPS(4,2,"G1{" " * 4091}",,,4128)', 'MCOPS(4,2,"G1",,,4128)', 'MCOPS(4,2,"F",,,4128)'
    ) == [0, 26, 0]


@pytest.mark.covers("cpl.MCOPS.4")
@pytest.mark.covers("cpl.ncs.7")
@pytest.mark.covers("cpl.MCOPS")
def test_two_programs_cannot_write_into_a_buffer_in_one_cycle(tmp_path: Path) -> None:
    (tmp_path / "three.toml").write_text(MACHINE + AXIS.format("U"))
    pnc = Pnc(tmp_path, tmp_path / "three.toml", channels=[("X", "Y"), ("X2", "Y2"), ("U",)])
    pnc.select_mode(Mode.MDI, channel=2)
    for channel in (1, 3):
        (tmp_path / f"m{channel}").write_text(f'10 #R%=MCOPS(4,2,"G1 X2={channel} F6000",,,4256)\n')
        pnc.select_program(f"m{channel}", channel=channel)
        pnc.cycle_start(channel=channel)
    pnc.advance(500)
    assert [pnc.variables(channel)["#R%"] for channel in (1, 3)] == [7, 0]
    assert pnc.axes["X2"].setpoint == 3
    pnc.close()


# ---------------------------------------------------------------------- resets, of the own channel too


@pytest.mark.covers("cpl.MCOPS.6", "cpl.MCOPS.4")
@pytest.mark.covers("cpl.MCOPS")
@pytest.mark.covers("cpl.MCOPS.2", "cpl.MCODS.32.sav.8", "cpl.ncs.3", "cpl.MCODS.32")
@pytest.mark.covers("cpl.MCODS")
def test_a_control_reset_stops_another_channel_and_takes_no_orders_meanwhile(two: Two) -> None:
    two.pnc.select_program("LONG", channel=2)
    two.pnc.cycle_start(channel=2)
    two.pnc.advance(600)
    assert two.ask("MCOPS(2,2)", "MCOPS(6,2)", 'MCOPS(4,2,"PART")', "MCOPS(2,2)", "MCOPS(2,3)") == [
        0,
        3,
        3,
        3,
        1,
    ]
    two.pnc.advance(300)
    assert (two.sav(), two.pnc.run_state(2)) == (Sav.INACTIVE, RunState.RESET)
    assert two.ask("MCOPS(6,2)", 'MCOPS(4,2,"PART")', "MCOPS(6,2)") == [10, 0, 0]


@pytest.mark.covers("cpl.MCOPS.6", "cpl.MCOPS.4", "cpl.MCOPS.3")
@pytest.mark.covers("cpl.MCOPS.2", "cpl.MCOPS.5")
@pytest.mark.parametrize("call", ["MCOPS(2,1)", "MCOPS(5,1)", "MCOPS(2,-2)", "MCOPS(2,1,2)"])
@pytest.mark.covers("cpl.MCOPS")
def test_a_program_that_resets_its_own_channel_ends_there(two: Two, call: str) -> None:
    two.pnc.select_program("LONG", channel=2)
    two.pnc.cycle_start(channel=2)
    two.start(f'10 #A%=1\nN1 G1 X3 F6000\n20 WAIT\n30 OPENW(1,"R") : #A%=2\n40 #B%={call}\n50 #A%=3\nN2 X9')
    two.pnc.advance(600)
    assert two.pnc.run_state(1) is RunState.RESET
    assert (two.pnc.variables(1)["#A%"], two.pnc.axes["X"].setpoint) == (2, 3)
    assert two.sav(1) is Sav.INACTIVE
    assert two.pnc.run_state(2) is (RunState.RESET if "-2" in call else RunState.ACTIVE)
    assert not two.pnc.status().alarms
    assert two.ask("MCOPS(6,1)", 'MCOPS(4,1,"PART")', 'MCOPS(3,1,"N2")') == [9, 11, 2]


@pytest.mark.covers("cpl.MCOPS.4")
@pytest.mark.covers("cpl.MCOPS")
def test_a_program_that_leaves_itself_hands_over_to_the_next(two: Two) -> None:
    two.write("NEXT", "10 #N%=7\nN1 G1 Y4 F6000\n")
    two.start('N1 G1 X3 F6000\n20 WAIT\n30 #A%=MCOPS(4,1,"NEXT",,,64+128)\n40 #A%=99')
    two.pnc.advance(1000)
    assert two.pnc.run_state(1) is RunState.COMPLETED
    assert (two.pnc.axes["X"].setpoint, two.pnc.axes["Y"].setpoint) == (3, 4)
    assert two.pnc.variables(1)["#N%"] == 7


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.6")
@pytest.mark.covers("cpl.MCOPS", "cpl.ex.3209")
@pytest.mark.covers(
    "cpl.MCOPS.2.type.2",
    "cpl.MCOPS.5.type.2",
    "cpl.MCODS.70",
    "cpl.MCODS.70.val.1",
    "cpl.MCODS.refresh.I",
    "cpl.ex.3165",
    "cpl.ex.3209",
    "cpl.MCOPS.2",
    "cpl.MCOPS.5",
    "cpl.MCODS.refresh",
)
@pytest.mark.parametrize("service", [2, 5])
@pytest.mark.covers("cpl.MCODS")
def test_a_program_is_selected_again_unless_that_is_suppressed(again: Two, service: int) -> None:
    assert again.ask('MCOPS(4,2,"PART")', f"MCOPS({service},2)", "MCOPS(6,2)") == [0, 0, 0]
    again.after()
    assert (again.x2(), again.sav()) == (40, Sav.AT_START)  # selected again after its end, too
    found = again.ask(f"MCOPS({service},2,2)", "MCOPS(6,2)", f"MCOPS({service},2,1)")
    assert found == [0, 10, 18]
    again.start("1 DIM B%(1) : V=0 : #E%=MCODS(70,2,V,B%,1) : #F%=MCODS(70,2,V,B%,1) : #B%=B%(1)")
    again.after(1)
    assert [again.pnc.variables(1)[name] for name in ("#E%", "#F%", "#B%")] == [0, 0, 1]


@pytest.mark.covers("cpl.MCOPS.7", "cpl.MCOPS.5", "cpl.MCOPS.8", "cpl.MCOPS.8.how.3", "cpl.MCOPS.8.where.3")
@pytest.mark.covers("cpl.MCOPS", "cpl.ncs.18", "cpl.ncs.1", "cpl.MCOPS.6")
@pytest.mark.covers("cpl.ncs.13", "cpl.sig.NC-I_3.0")
def test_starts_and_modes_have_their_conditions(two: Two) -> None:
    two.pnc.select_program("PART", channel=2)
    assert two.ask("MCOPS(7,2,4)", "MCOPS(7,2,6)", "MCOPS(7,2,5)") == [13, 0, 0]
    assert two.ask("MCOPS(5,2)", "MCOPS(7,2,4)", 'MCOPS(4,2,"G1 X2=1",,,32)', "MCOPS(7,2,5)") == [0, 0, 0, 13]
    assert two.ask("MCOPS(5,2)", "MCOPS(7,2,5)", 'MCOPS(4,2,"PART")', "MCOPS(7,1,4)") == [0, 0, 0, 13]
    assert two.ask("MCOPS(8,2,0,1)", "MCOPS(8,2,1,0)", "MCOPS(8,2,4,1)", "MCOPS(8,2,3,3)") == [18, 18, 18, 0]
    assert two.ask("MCOPS(8,-1,1,1)", "MCOPS(7,0,5)", "MCOPS(5,-2)", "MCOPS(6,3)") == [1, 1, 1, 1]
    pnc = two.pnc
    group, bit = MODE_BY_PLC
    assert (group, bit) == (0, 3 * 8)  # NC-I 3.0: byte 3 and bit 0 of the inputs of the channel
    pnc.system.interface.set_bit(group, 2, bit, True)
    assert two.ask("MCOPS(7,2,6)") == [13]
    pnc.system.interface.set_bit(group, 2, bit, False)
    assert two.ask("MCOPS(5,2)", "MCOPS(7,2,1)", "MCOPS(7,2,11)", "MCOPS(7,2,14)", "MCOPS(7,2,3)") == [
        0,
        0,
        102,
        102,
        18,
    ]


@pytest.mark.covers(
    "cpl.MCOPS.4.code.256",
    "cpl.MCOPS.4.code.512",
    "cpl.MCOPS.7.mode.1",
    "cpl.MCOPS.7.mode.2",
    "cpl.ncs.8",
    "cpl.MCOPS.4",
    "cpl.MCOPS.7",
)
@pytest.mark.parametrize(("mode", "code", "other"), [(1, 256, 512), (2, 512, 256)])
@pytest.mark.covers("cpl.MCOPS")
def test_axes_are_moved_by_hand_where_the_mode_fits(two: Two, mode: int, code: int, other: int) -> None:
    assert two.ask(f"MCOPS(4,2,,,,{code})", f"MCOPS(7,2,{mode})") == [8, 0]
    assert two.ask(f"MCOPS(4,2,,,,{code})", f"MCOPS(4,2,,,,{other})") == [0, 8]
    control = two.pnc.control
    if mode == 1:
        control.jog("X2", 1)
        two.pnc.advance(50)
        assert two.x2() > 0
    else:
        control.reference("X2")
        two.pnc.advance(3000)
        assert control.manual.referenced["X2"]


@pytest.mark.covers(
    "cpl.MCOPS.4", "cpl.MCOPS.4.code.32", "cpl.MCOPS.4.code.2", "cpl.ncs.18", "cpl.ncs.6", "cpl.MCOPS"
)
def test_names_have_100_characters_and_blocks_511(two: Two) -> None:
    names = ["p" * 100, "p" * 101, ""]
    assert two.ask(*(f'MCOPS(4,2,"{name}",,,2)' for name in names)) == [6, 18, 18]
    assert two.ask("MCOPS(5,2)", "MCOPS(7,2,4)") == [0, 0]
    blocks = [f"G1 X2=1.{'0' * (length - 8)}" for length in (512, 511)]
    assert two.ask(*(f'MCOPS(4,2,"{block}",,,32)' for block in blocks)) == [18, 0]


@pytest.mark.covers("cpl.MCOPS.1", "cpl.ncs.102", "cpl.ncs.8", "cpl.ncs.10", "cpl.ncs.3", "cpl.ncs.18")
@pytest.mark.covers("cpl.MCOPS")
def test_what_is_not_simulated_is_refused(two: Two) -> None:
    two.pnc.select_program("LONG", channel=2)
    two.pnc.cycle_start(channel=2)
    assert two.ask("MCOPS(1,2)", "MCOPS(10,2)") == [102, 102]
    assert two.pnc.run_state(2) is RunState.ACTIVE
    assert two.ask("MCOPS(5,2)", "MCOPS(1,2)") == [0, 3]
    two.pnc.advance(500)
    assert two.ask("MCOPS(1,2)", "MCOPS(1,3)", "MCOPS(1,-2)", "MCOPS(1,2,0)") == [10, 1, 1, 18]
    two.pnc.select_program("LONG", channel=2)
    two.pnc.control.select_mode(two.pnc.control.mode.__class__.JOG, channel=1)
    assert two.ask("MCOPS(1,2)") == [8]


# ---------------------------------------------------------------------- what is waited for


@pytest.mark.covers("cpl.MCODS.87", "cpl.MCODS.87.bit.12", "cpl.MCODS")
@pytest.mark.parametrize("wait", ["WAIT(,100)", "WAIT(IC(4,1,2)=TRUE,100)"])
def test_a_channel_in_wait_says_so_and_wakes_who_asks_with_the_version(two: Two, wait: str) -> None:
    two.start(f"N1 G1 X2=1 F6000\n10 {wait}\nN2 X2=2", channel=2)
    program = "10 DIM W%(1) : V=0\n" + "".join(
        f"{20 + place} #E%=MCODS(87,2,V,W%,1) : #W{place}%=W%(1) : #T{place}%=CLOCK\n" for place in range(3)
    )
    two.start(program)
    two.pnc.advance(400)
    found = two.pnc.variables(1)
    assert [found[f"#W{place}%"] for place in range(3)] == [0, 4096, 0]
    times = [int(str(found[f"#T{place}%"])) for place in range(3)]
    assert 98 <= times[2] - times[1] <= 104


@pytest.mark.covers("cpl.MCODS.31")
@pytest.mark.covers("cpl.MCODS.87.bit.13", "cpl.MCODS.87")
@pytest.mark.covers("cpl.MCODS")
def test_a_channel_that_waits_for_data_shows_it(two: Two) -> None:
    two.start("10 DIM W%(1) : V=0\n20 E%=MCODS(31,2,V,W%,1)\n30 E%=MCODS(31,2,V,W%,1)\n40 #M%=W%(1)")
    two.pnc.advance(20)
    assert two.pnc.system.shown.renew().channels[1].other_waits == 1 << 13
    two.pnc.select_mode(Mode.MDI, channel=2)
    two.pnc.advance(3)
    assert (two.pnc.variables(1)["#M%"], two.pnc.run_state(1)) == (4, RunState.COMPLETED)


@pytest.mark.covers(
    "cpl.MCODS.32.ipo.1",
    "cpl.MCODS.32.ipo.2",
    "cpl.MCODS.32.ipo.3",
    "cpl.MCODS.32.elem.2",
    "cpl.MCODS.87.bit.5",
    "cpl.MCODS.32",
    "cpl.MCODS.87",
)
@pytest.mark.covers("cpl.MCODS")
def test_the_interpolator_runs_down_in_feed_hold(two: Two) -> None:
    two.pnc.select_program("LONG", channel=2)
    two.pnc.cycle_start(channel=2)
    two.pnc.advance(300)
    seen = [two.pnc.system.shown.renew().channels[2].ipo]
    two.pnc.feed_hold(channel=2)
    two.pnc.advance(3)
    seen.append(two.pnc.system.shown.renew().channels[2].ipo)
    two.pnc.advance(500)
    shown = two.pnc.system.shown.renew().channels[2]
    assert [*seen, shown.ipo] == [Ipo.RUNNING, Ipo.RUNNING_DOWN, Ipo.STOPPED]
    assert shown.other_waits == 1 << 5


def test_an_end_that_returns_stops_the_path(tmp_path: Path) -> None:
    """M30 is carried out after the motion of its block, as an end of the program is (ISO 6983-1)."""
    lowest = {}
    for end in ("M30", ""):
        folder = tmp_path / (end or "none")
        folder.mkdir()
        two = Two(folder)
        two.write("PLAIN", f"N1 G91 G1 X10 F6000\nG90 {end}\n")
        two.start("\n".join(["P PLAIN"] * 10))
        speeds = []
        while two.pnc.run_state(1) is RunState.ACTIVE:
            two.pnc.advance(1)
            speeds.append(abs(two.pnc.axes["X"].velocity))
        assert two.pnc.axes["X"].setpoint == pytest.approx(100)
        top = [at for at, speed in enumerate(speeds) if speed > 99]
        lowest[end] = min(speeds[top[0] : top[-1]])
        two.pnc.close()
    assert lowest["M30"] < 5  # it stands between two cycles
    assert lowest[""] > 90
