"""What the operator sees and calls: dialog programs, the block in the editor, the information window, signals."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from polycnc.cnc import ControlError, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.system import Signals, Tab

MACHINE = "".join(
    f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 5000\n' for name in ("X", "Y", "X2", "Y2")
)


class Panel:
    """A control with two channels, its root a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.machine = folder / "two.toml"
        self.machine.write_text(f'name = "two"\n{MACHINE}')
        self.pnc = self.switched_on()

    def switched_on(self, keys: tuple[str, ...] = (), *, servo: bool = False) -> Pnc:
        channels = [("X", "Y"), ("X2", "Y2")]
        return Pnc(self.folder, self.machine, channels=channels, keys=keys, servo=servo)

    def restart(self, keys: tuple[str, ...] = (), *, servo: bool = False) -> None:
        self.pnc.close()
        self.pnc = self.switched_on(keys, servo=servo)

    def write(self, name: str, text: str) -> None:
        (self.folder / name).parent.mkdir(exist_ok=True)
        (self.folder / name).write_text(text + "\n")

    def start(self, program: str, channel: int = 1) -> None:
        self.write(f"main{channel}.npg", program)
        self.pnc.select_program(f"main{channel}.npg", channel=channel)
        self.pnc.cycle_start(channel=channel)

    def wait(self, channel: int = 1, cycles: int = 20_000) -> RunState:
        self.pnc.advance(cycles, until=lambda: self.pnc.run_state(channel) is not RunState.ACTIVE)
        return self.pnc.run_state(channel)

    def run(self, program: str, channel: int = 1) -> dict[str, object]:
        self.start(program, channel)
        assert self.wait(channel) is RunState.COMPLETED, self.pnc.status().alarms
        return self.pnc.variables(channel)


@pytest.fixture
def panel(tmp_path: Path) -> Iterator[Panel]:
    found = Panel(tmp_path)
    yield found
    found.pnc.close()


# ---------------------------------------------------------------------- dialogs


@pytest.mark.covers(
    "cpl.dialog.call", "cpl.dialog.file.1", "cpl.dialog.file.2", "cpl.dialog.file.3", "cpl.dialog.file.4",
    "cpl.dialog.file.5", "cpl.param.3080_00005",
)  # fmt: skip
def test_each_area_calls_the_dialog_program_that_was_there_at_power_up(panel: Panel) -> None:
    assert not panel.pnc.dialogs
    places = {1: "", 2: "usrfep/", 3: "fep/", 4: "", 5: "usrfep/"}
    for number, folder in places.items():
        panel.write(f"{folder}cpldlg0{number}.dlg", f"1 #N%={number * 7} : #C%=SD(8)")
    panel.write("fep/cpldlg02.dlg", "1 #N%=99")
    assert not panel.pnc.dialogs
    panel.write("macoda.dat", "3080 00005 = 2")
    panel.restart()
    assert list(panel.pnc.dialogs) == ["manual", "automatic", "manage", "diagnostics", "editor"]
    for number, area in enumerate(panel.pnc.dialogs, 1):
        panel.pnc.call_dialog(area)
        assert panel.wait(channel=2) is RunState.COMPLETED
        assert panel.pnc.variables(2)["#N%"] == number * 7
    assert not [name for name in panel.pnc.variables(1) if name.startswith("#")]
    (panel.folder / "cpldlg01.dlg").unlink()
    panel.restart()
    assert panel.pnc.dialogs == ("automatic", "manage", "diagnostics", "editor")
    with pytest.raises(ControlError, match="manual has no dialog program"):
        panel.pnc.call_dialog("manual")


def test_a_dialog_waits_until_its_channel_is_free(panel: Panel) -> None:
    panel.write("cpldlg03.dlg", "1 #N%=3")
    panel.restart()
    panel.start("N1 G1 X400 F600")
    panel.pnc.advance(20)
    with pytest.raises(ControlError):
        panel.pnc.call_dialog("manage")
    assert panel.pnc.run_state(1) is RunState.ACTIVE


@pytest.mark.covers(
    "cpl.dialog.editor",
    "cpl.dialog.call",
    "cpl.INP#0",
    "cpl.PRN#0",
    "cpl.nc.Q900",
    "cpl.param.3080_00006",
    "cpl.param.3080_00007",
)
def test_the_block_in_the_editor_is_read_and_overwritten(panel: Panel) -> None:
    panel.write(
        "width.dlg",
        "10 INP#(0,W,N%,B?,D!,M)\n20 #W=W : #N%=N% : #B?=B? : #D!=D! : #M=M\n"
        '30 DLG\n40 PRN(8,4,"MAX.CUTTING WIDTH: ###.### MM",W)\n50 INP(W)\n60 ENDDLG\n70 LJUST\n'
        '80 PRN#(0,"N10 Q900[",W,",",N%*2,"]")',
    )
    panel.write("cpldlg05.dlg", '10 INP#(0,A)\n20 #A=A\n30 PRN#(0,"  G1 X3 ")')
    panel.write("macoda.dat", '3080 00006 = "SP", "Q900"\n3080 00007 = "other.dlg", "width.dlg"')
    panel.restart(("3", "7", ".", "5", "ENTER"))
    block = panel.pnc.edit_block("N10 Q900[12.25, 4,TRUE ,-0.125]")
    assert panel.wait() is RunState.COMPLETED, panel.pnc.status().alarms
    found = panel.pnc.variables()
    assert [found[f"#{name}"] for name in ("W", "N%", "B?", "D!", "M")] == [12.25, 4, True, -0.125, None]
    assert block.text == "N10 Q900[37.5,8]"
    plain = panel.pnc.edit_block("N10 X5 Y3")
    panel.wait()
    assert (panel.pnc.variables()["#A"], plain.text, block.text) == (None, "  G1 X3 ", "N10 Q900[37.5,8]")
    with pytest.raises(ControlError, match=r"there is no program other\.dlg"):
        panel.pnc.edit_block('N10 P SP["a,b",3]')
    panel.write("other.dlg", "10 INP#(0,A,B)\n20 #A=A : #B=B")
    panel.pnc.edit_block('N10 P SP["a,b",3]')
    panel.wait()
    found = panel.pnc.variables()
    assert (found["#A"], found["#B"]) == (None, 3)
    panel.run('1 PRN#(0,"a message")')  # after the dialog number 0 is the message window again
    run = panel.pnc.control.channels[0].run
    assert run is not None
    assert [message.text for message in run.channel.messages.all()] == ["MSG: a message"]


# ---------------------------------------------------------------------- errors


READ = (
    "10 DIM E%(5,3)\n20 #A%=GETERR(2,0,E%,5)\n30 DIM #E%(5) : DIM #C%(5)\n"
    "40 FOR I%=1 TO 5 : #E%(I%)=E%(I%,1) : #C%(I%)=E%(I%,3) : NEXT I%\n50 #P%=GETERR(2,6,E%) : #Q%=E%(1,1)\n"
    "60 #W%=GETERR(1,7,E%,5) : #X%=E%(1,2) : #Y%=E%(2,3)"
)


def listed(panel: Panel) -> tuple[list[object], list[object], object, object]:
    """Return numbers and categories of the errors of channel 2, how many part program errors, the first of them."""
    found = panel.run(READ)
    count = int(str(found["#A%"]))
    numbers, categories = found["#E%"], found["#C%"]
    assert isinstance(numbers, list)
    assert isinstance(categories, list)
    return numbers[1 : count + 1], categories[1 : count + 1], found["#P%"], found["#Q%"]


@pytest.mark.covers("cpl.err.1971", "cpl.err.1970", "cpl.err.1938")
def test_errors_with_axes_have_the_numbers_of_the_manual(panel: Panel) -> None:
    for expression, number, category in (
        ('MPOS("X",1,2)', 1971, 6), ("MPOS(3,1,2)", 1938, 6), ("AXO(1,0)", 1970, 0),
    ):  # fmt: skip
        panel.start(f"1 A={expression}", channel=2)
        panel.pnc.advance(3)
        assert panel.pnc.run_state(2) is RunState.ALARM
        assert listed(panel) == ([number], [category], int(category == 6), number if category == 6 else 0)
        panel.pnc.reset(channel=2)
        assert listed(panel)[0] == []


@pytest.mark.covers("cpl.err.1869", "cpl.var.defperm")
def test_a_variable_without_memory_is_told_and_programs_run_without_it(panel: Panel) -> None:
    panel.write("anwperm.dat", "DEF DOUBLE @B(13000) ;\nDEF INT @A ;")
    panel.restart()
    panel.pnc.advance(1500)
    assert panel.run("1 @A%=7 : #A%=@A%*3")["#A%"] == 21
    assert panel.pnc.information(Tab.ERRORS) == [
        ("1869", "-1", "01.01.00", "00:00:00", "(000)", "@B! not installed. Memory full")
    ]
    assert listed(panel)[:2] == ([1869], [1])
    panel.start("1 @B!(3)=2")
    panel.pnc.advance(3)
    run = panel.pnc.control.channels[0].run
    assert run is not None
    assert run.error is not None
    assert run.error.what == "there is no permanent variable @B!"


@pytest.mark.covers("cpl.err.1856", "cpl.info.columns", "cpl.info.tabs")
def test_a_drive_that_lags_is_in_the_list_with_its_time(panel: Panel) -> None:
    servo = "[axis.servo]\nkind = 'pidf'\nkp = 20\nfollowing_error_limit_mm = 0.5\n"
    panel.machine.write_text(f'name = "two"\n{MACHINE}{servo}')
    panel.restart(servo=True)
    panel.pnc.advance(1250)
    panel.start("N1 G1 Y2=400 F30000", channel=2)
    assert panel.wait(channel=2) is RunState.ALARM
    row = panel.pnc.information(Tab.ERRORS)[0]
    assert row[:2] == ("1856", "2")
    assert row[5].startswith("axis Y2: following error")
    assert row[4] != "(000)"
    assert (row[4][0], len(row[4]), row[4][1:4].isdigit(), row[4][4]) == ("(", 5, True, ")")
    assert listed(panel)[:2] == ([1856], [2])
    assert panel.pnc.information(Tab.WARNINGS) == panel.pnc.information(Tab.MESSAGES) == []


@pytest.mark.covers("cpl.GETERR.cat.7", "cpl.info.tabs", "cpl.GETERR")
def test_warnings_of_a_program_are_kept_until_a_reset(panel: Panel) -> None:
    found = panel.run(f'1 #R%=ERASE("NONE") : PRN#(0,"##",12345)\n{READ}')
    assert (found["#R%"], found["#W%"], found["#X%"], found["#Y%"], found["#P%"]) == (1, 2, 1, 7, 0)
    rows = [(row[0], row[1], row[5]) for row in panel.pnc.information(Tab.WARNINGS)]
    assert rows == [
        ("0", "1", "NONE was not erased: it does not exist"),
        ("0", "1", "PRN FORMAT INCORRECT: ##"),
    ]
    assert panel.pnc.information(Tab.ERRORS) == []
    panel.pnc.reset(channel=2)
    assert len(panel.pnc.information(Tab.WARNINGS)) == 2
    panel.pnc.reset(channel=1)
    assert panel.pnc.information(Tab.WARNINGS) == []


# ---------------------------------------------------------------------- signals


@pytest.mark.covers("cpl.MCOPS.2")
@pytest.mark.covers("cpl.sig.IF_0.2")
@pytest.mark.covers("cpl.MCOPS")
def test_a_reset_is_signalled_until_the_channel_has_a_new_job(panel: Panel) -> None:
    assert panel.run("1 #A?=IC(2,3,2)")["#A?"] is False
    found = panel.run("10 #B?=IC(2,3,2) : #A%=MCOPS(2,2)\n20 WAIT(IC(2,3,2)=TRUE,300,#W%)\n30 #C?=IC(2,3,1)")
    assert (found["#B?"], found["#A%"], found["#W%"] in (0, 2), found["#C?"]) == (False, 0, True, False)
    panel.run("1 A=3", channel=2)
    assert panel.run("1 #A?=IC(2,3,2)")["#A?"] is False


@pytest.mark.covers("cpl.MCOPS.7")
@pytest.mark.covers("cpl.sig.NC-I_3.0")
@pytest.mark.covers("cpl.MCOPS")
def test_the_mode_is_fixed_while_the_plc_sets_it(panel: Panel) -> None:
    bit = Signals.CHANNEL_INPUTS, 2, 24
    panel.pnc.system.interface.set_bit(*bit, True)
    found = panel.run("10 #A%=MCOPS(7,2,4) : #B?=IC(24,0,2) : #C%=MCOPS(7,2,99)")
    assert (found["#A%"], found["#B?"], found["#C%"]) == (13, True, 18)
    panel.pnc.system.interface.set_bit(*bit, False)
    assert panel.run("10 #A%=MCOPS(7,2,4)")["#A%"] == 0


@pytest.mark.covers("cpl.sig.NC-O_16.0")
def test_a_channel_is_ready_when_a_start_would_begin_or_go_on(panel: Panel) -> None:
    assert not panel.pnc.is_ready(1)
    panel.write("main1.npg", "N1 G1 X5 F6000\nN2 M0\n1 #A=3\nN3 X7")
    panel.pnc.select_program("main1.npg")
    assert panel.pnc.is_ready(1)
    assert not panel.pnc.is_ready(2)
    panel.pnc.cycle_start()
    panel.pnc.advance(5)
    assert not panel.pnc.is_ready(1)
    assert panel.wait() is RunState.PROGRAM_STOP
    assert panel.pnc.is_ready(1)
    panel.pnc.cycle_start()
    assert panel.wait() is RunState.COMPLETED
    assert not panel.pnc.is_ready(1)


@pytest.mark.covers("cpl.MCODS.5")
@pytest.mark.covers("cpl.nc.G196")
@pytest.mark.covers("cpl.MCODS")
def test_the_cutting_velocity_is_told_while_g196_holds(panel: Panel) -> None:
    found = panel.run(
        "N1 G196 S125 M3\nN2 G1 X3 F600\n3 WAIT\n4 DIM R(2) : V=0 : E%=MCODS(5,-1,V,R,1) : #A=R(1)\nN5 M5\n6 WAIT\n"
        "7 V=0 : E%=MCODS(5,-1,V,R,1) : #B=R(1)\nN8 G97 S750 M3\n9 WAIT\n10 V=0 : E%=MCODS(5,-1,V,R,1) : #C=R(1)"
    )
    assert (found["#A"], found["#B"], found["#C"]) == (125, 0, 750)


# ---------------------------------------------------------------------- files of two channels


@pytest.mark.covers("cpl.OPENR")
def test_a_file_that_another_channel_writes_is_open(panel: Panel) -> None:
    panel.write("SUB", "1 WAIT(,300)")
    panel.start('1 OPENW(1,"R",200)\n2 PRN#(1,"ONE")\n3 CALL SUB\n4 PRN#(1,"MORE")')
    panel.pnc.advance(20)
    found = panel.run(
        '1 #A%=ERASE("R") : #B%=ERASE("SUB") : DIM #T$(9) : OPENR(2,"R") : INP#(2,#T$) : CLOSE(2)', channel=2
    )
    assert (found["#A%"], found["#B%"], found["#T$"]) == (3, 3, "ONE")
    panel.start('1 OPENW(1,"R",200)', channel=2)
    panel.pnc.advance(3)
    run = panel.pnc.control.channels[1].run
    assert run is not None
    assert run.error is not None
    assert run.error.what == "FILE ALREADY OPEN"
    panel.pnc.reset(channel=2)
    assert panel.wait() is RunState.COMPLETED
    panel.run('1 OPENW(1,"R",200) : PRN#(1,"TWO")', channel=2)
    assert (panel.folder / "R").read_bytes() == b"ONE\nMORE\nTWO\n\x03\n"


def test_an_error_in_a_block_closes_the_files_of_its_channel(panel: Panel) -> None:
    panel.start('1 OPENW(1,"R",200) : PRN#(1,"KEPT";) : X=7\nN2 G987 X[X]', channel=2)
    assert panel.wait(channel=2) is RunState.ALARM
    assert (panel.folder / "R").read_bytes() == b"KEPT\n\x03\n"
    panel.run('1 OPENW(1,"R") : PRN#(1,"MORE")')
    assert (panel.folder / "R").read_bytes() == b"KEPT\nMORE\n\x03\n"
