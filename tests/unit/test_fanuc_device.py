"""The Power Mate itself: what it is made of, what the operator does, what parameters do, what survives."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from polycnc.cnc import ControlError, ControlEvent, Emergency, Mode, Refusal, RunState
from polycnc.controllers.fanuc import PowerMate, PowerMateMode, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from polycnc.errors import UsageError
from support.often import share
from support.power_mate import OK, attached, moved, psd, registered, running

MODES = {
    "MDI": (0, Mode.MDI), "MEM": (1, Mode.AUTO), "EDIT": (3, Mode.EDIT), "HND": (4, Mode.HANDLE), "JOG": (5, Mode.JOG),
    "T-JOG": (6, Mode.JOG), "T-HND": (7, Mode.HANDLE), "INC": (8, Mode.INC), "REF": (9, Mode.REF),
    "RMT": (10, Mode.AUTO),
}  # fmt: skip


@pytest.mark.parametrize(
    "keys",
    [
        {"model": "X"},
        {"axes": 7},
        {"axes": 0},
        {"axes": 3, "model": "D"},
        {"increment": "IS-D"},
        {"rotary": (4,)},
        {"rotary": (0,)},
        {"rotary": ("C",)},
    ],
)
def test_controls_that_there_are_not(keys: dict[str, Any]) -> None:
    with pytest.raises(UsageError) as caught:
        PowerMate(**keys)
    assert caught.value.hint


def test_what_a_control_is_made_of() -> None:
    control = PowerMate()
    assert (control.axes, control.max_axis, control.model, control.mode) == (3, 6, "H", PowerMateMode.MEM)
    assert (PowerMate(model="D").axes, PowerMate(6).axes) == (2, 6)
    assert all(control.status().axes[name].referenced for name in "XYZ")
    assert [PowerMate(4, rotary=("Y", 4)).units.axis_name(k) for k in (1, 2, 3, 4)] == ["X", "A", "Y", "B"]
    some = PowerMate(options=("pmc_axis",))
    assert [some.has_option(name) for name in ("pmc_axis", "custom_macro", "")] == [True, False, True]


def test_modes_by_name() -> None:
    control = PowerMate()
    for name, (number, behind) in MODES.items():
        control.select_mode(name.lower())
        assert (control.mode, control.mode.label, control.control.mode) == (number, name, behind)
    control.select_mode(PowerMateMode.T_HND)
    assert control.mode.label == "T-HND"
    with pytest.raises(UsageError, match="AUTO"):
        control.select_mode("AUTO")


def test_another_mode_holds_a_program_and_mem_goes_on() -> None:
    control, _ = attached(axes=1)
    registered(control, O7="\nG1 X20. F3000\nM30\n")
    running(control, 7)
    control.advance(100)
    control.select_mode("JOG")
    control.advance(300)
    assert control.programs.in_operation
    assert control.status().channel.run_state is RunState.HOLD
    with pytest.raises(ControlError):
        control.cycle_start()
    control.control.jog("X", -1)
    control.advance(200)
    control.control.jog("X", None)
    control.advance(500)
    control.select_mode("MEM")
    control.cycle_start()  # the axis goes back first
    control.advance(5000)
    assert control.machine.actual["X"] == 20.0
    assert not control.programs.in_operation


def test_nothing_sends_a_program_in_rmt() -> None:
    control, _ = attached()
    registered(control, O7="\nM30\n")
    control.select_program(7)
    control.select_mode("RMT")
    with pytest.raises(ControlError) as caught:
        control.cycle_start()
    assert caught.value.reason is Refusal.NOT_FOUND


def test_rmt_executes_what_is_sent_and_mem_its_own_program() -> None:
    control, handle = attached()
    registered(control, O7="\nG1 X1. F6000\nM30\n", O8="\nG91 G1 X2. F6000\nG90\nM99\n")
    control.select_program(7)
    with pytest.raises(ControlError) as caught:
        control.remote.open()
    assert caught.value.reason is Refusal.MODE
    control.select_mode("RMT")
    sent = control.remote.open()
    control.cycle_start()
    for line in ("G1 X10. F6000\n", "M98 P8\n", "N30 G1 X#100\n", "#100=4.\n", "N50 G1 X#100\n"):
        sent.feed(line)
        control.advance(10_000, until=lambda: sent.starved)
    assert control.machine.actual["X"] == 4.0
    assert control.execution.sequence == 50
    assert control.execution.text(100) == b"N50 G1 X#100"
    sent.feed("M30\n")
    control.advance(100)
    assert not sent.is_open
    with pytest.raises(ControlError):
        control.cycle_start()
    control.select_mode("MEM")
    control.cycle_start()
    control.advance(10_000)
    assert control.machine.actual["X"] == 1.0
    assert handle


@pytest.mark.covers("fanuc.cnc_rddynamic")
def test_buttons() -> None:
    control, handle = attached(axes=1)
    registered(control, O7="\nG1 X2. F6000\nM1\nX4.\nM30\n")
    control.feed_hold()  # nothing moves: no harm
    control.optional_stop(True)
    running(control, 7)
    control.advance(2000, until=ControlEvent.RUN_STATE)
    assert control.status().channel.run_state is RunState.OPTIONAL_STOP
    control.optional_stop(False)
    control.cycle_start()
    control.advance(2000)
    assert control.status().channel.run_state is RunState.COMPLETED
    control.operator_message(2000, "CHECK TOOL")
    assert [(each.number, each.text) for each in control.status().messages] == [(2000, "CHECK TOOL")]
    with pytest.raises(ControlError):
        control.operator_message(-1, "X")
    control.emergency_stop(True)
    assert control.status().emergency is Emergency.ON
    assert fwlib.cnc_rddynamic(handle, 1, 38)[1].alarm == 0  # a state, no alarm
    with pytest.raises(ControlError):
        control.cycle_start()
    control.emergency_stop(False)
    assert control.status().emergency is Emergency.OFF
    for number, axis in ((6000, None), (-1, None), (5, 2)):
        with pytest.raises(UsageError):
            control.raise_alarm(number, axis=axis)
    with pytest.raises(UsageError):
        control.protect_key(key=5)


def test_an_alarm_stops_a_program_until_a_reset() -> None:
    control, _ = attached(axes=1)
    registered(control, O7="\nG1 X50. F3000\nM30\n")
    running(control, 7)
    control.advance(200)
    control.raise_alarm(417, axis=1)
    assert control.control.alarms.active[0].text == "X AXIS DGTL PARAM"
    control.advance(500)
    at = control.machine.actual["X"]
    control.advance(500)
    assert control.machine.actual["X"] == at < 50.0
    with pytest.raises(ControlError):
        control.cycle_start()
    control.reset()
    assert control.power.alarm_bits == 0


def test_a_program_that_is_wrong_puts_an_alarm_on() -> None:
    control, _ = attached(axes=1)
    registered(control, O7="\nG1 X5. F600 Y3.\nM30\n", O8="\nM30\n")
    running(control, 7)
    control.advance(5)
    assert control.power.alarm_bits == 1 << 3
    assert "O0007:2" in control.control.alarms.active[0].text
    control.reset()
    made = control.parameters.value(6711)
    running(control, 8)
    control.advance(5)
    assert (control.power.alarm_bits, control.parameters.value(6711)) == (0, made + 1)


# ---------------------------------------------------------------------- parameters that act


def _rapid(control: PowerMate) -> float:
    registered(control, O9="\nG0 X1000.\nM30\n")
    running(control, 9)
    control.advance(500)
    return control.status().axes["X"].velocity


def _jog(control: PowerMate) -> float:
    control.select_mode("JOG")
    control.control.jog("X", 1)
    control.advance(500)
    return control.status().axes["X"].velocity


def _start(control: PowerMate) -> float:
    registered(control, O9="\nG0 X1000.\nM30\n")
    running(control, 9)
    control.advance(20)
    return control.status().axes["X"].velocity


def _no_point(control: PowerMate) -> float:
    moved(control, "G0 X750")
    return control.machine.actual["X"]


@pytest.mark.parametrize(
    ("number", "value", "axis", "measured", "before", "after"),
    [
        (1420, 9000, 1, _rapid, 250.0, 150.0),
        (1423, 1500, 1, _jog, 50.0, 25.0),
        (1620, 40, 1, _start, 50.0, 125.0),
        (3401, 0, 0, _no_point, 750.0, 0.75),
    ],
)
def test_parameters_act_at_once(
    number: int, value: int, axis: int, measured: Callable[[PowerMate], float], before: float, after: float
) -> None:
    control, _ = attached()
    assert measured(control) == pytest.approx(before, rel=0.06)
    control, _ = attached()
    control.parameters.set(number, value, axis)
    assert measured(control) == pytest.approx(after, rel=0.06)


@pytest.mark.covers("fanuc.cnc_srvdelay", "fanuc.cnc_rdloopgain", "fanuc.cnc_wrparam")
def test_gain_and_deviation_limit_act_at_once() -> None:
    control, handle = attached(servo=True, axes=2)
    assert fwlib.cnc_wrparam(handle, 6, psd(1825, 1, idata=6000)) == OK  # 60/s
    assert fwlib.cnc_rdloopgain(handle)[1][:2] == [6000, 3000]
    registered(control, O7="\nG1 X60. Y60. F2400\nM30\n", O8="\nG1 X0 F2400\nM30\n")
    running(control, 7)
    control.advance(800)
    rate = 2400 / 60 / 2**0.5 * 1000  # increments a second along each axis
    delays = fwlib.cnc_srvdelay(handle, -1, 12)[1].data[:2]
    assert delays == [pytest.approx(rate / 60, rel=0.1), pytest.approx(rate / 30, rel=0.1)]
    control.advance(5000)
    assert fwlib.cnc_wrparam(handle, 8, psd(1828, 1, ldata=300)) == OK  # 0.3 mm, where 0.67 come
    running(control, 8)
    control.advance(500)
    assert [(each.number, each.axis) for each in control.status().alarms] == [(411, "X")]


def test_parameters_that_are_written_while_a_program_runs_act_with_the_next() -> None:
    control, _ = attached(axes=1)
    registered(control, O7="\nG1 X5. F3000\nM30\n")
    running(control, 7)
    control.advance(20)
    control.parameters.set(1320, 3000, 1)
    control.advance(3000)
    assert control.machine.actual["X"] == 5.0
    assert control.machine.config.axes[0].soft_limits[1] == 3.0
    control.parameters.set(1320, 99_999_999, 1)
    assert control.machine.config.axes[0].soft_limits[1] > 1000


@pytest.mark.covers("fanuc.ncparam.1320", "fanuc.ncparam.1321", "fanuc.param.1001_0")
def test_speeds_and_limits_of_an_inch_machine() -> None:
    control = PowerMate(1, inch_output=True)
    control.parameters.set(1320, 123_456, 1)  # 0.0001 inch
    axis = control.machine.config.axes[0]
    assert axis.soft_limits[1] == pytest.approx(12.3456 * 25.4)
    assert axis.vmax == pytest.approx(15_000 / 60 * 2.54)  # 0.1 inch/min


@pytest.mark.covers(
    "fanuc.ODBAXIS.data", "fanuc.concept.axis_number", "fanuc.concept.position_contents", "fanuc.enum.axis.1..m",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_machine")
@pytest.mark.parametrize(
    ("code", "name"), [(0, "Y"), (ord("X"), "Y"), (7, "Y"), (ord("N"), "Y"), (ord("W"), "W")]
)
@pytest.mark.covers("fanuc.cnc_wrparam")
@pytest.mark.covers("fanuc.ncparam.1020")
def test_axis_names_come_from_a_parameter_and_are_never_unusable(code: int, name: str) -> None:
    control, handle = attached(axes=2)
    moved(control, "G0 X3. Y-4.")
    data = fwlib.IODBPSD(datano=1020, type=2)
    data.u.cdata = code
    assert fwlib.cnc_wrparam(handle, 5, data) == OK
    assert control.units.axis_name(2) == "Y"
    control.power_cycle()
    assert [control.units.axis_name(axis) for axis in (1, 2)] == ["X", name]
    assert control.machine.actual == {"X": 3.0, name: -4.0}
    assert bool(control.power.alarm_bits) is (code != ord("W"))
    control.reset()
    moved(control, f"G0 {name}1.5")
    assert fwlib.cnc_machine(handle, 2, 8)[1].data[0] == 1500


@pytest.mark.covers("fanuc.cnc_absolute")
def test_work_offsets_are_parameters() -> None:
    control, handle = attached()
    control.parameters.set(1222, -2_500, 2)
    moved(control, "G55 G0 Y4.")
    assert control.machine.actual["Y"] == 1.5
    assert fwlib.cnc_absolute(handle, 2, 8)[1].data[0] == 4000
    assert control.control.offsets["G55"] == {"Y": -2.5}
    assert [control.parameters.value(1222, axis) for axis in (1, 2)] == [0, -2500]


def test_values_that_a_parameter_does_not_take() -> None:
    control = PowerMate()
    for number, axis, error in (
        (9, 0, KeyError),
        (1320, 0, KeyError),
        (1320, 4, KeyError),
        (6710, 1, KeyError),
    ):
        with pytest.raises(error):
            control.parameters.set(number, 5, axis)
    with pytest.raises(ValueError, match="6713"):
        control.parameters.set(6713, -1)


def test_every_parameter_has_a_default_that_it_takes() -> None:
    for row in PowerMate().parameters.rows.values():
        assert row.fits(row.default), row
        assert row.name


# ---------------------------------------------------------------------- what survives


@pytest.mark.covers("fanuc.cnc_rddynamic")
def test_a_snapshot_is_gone_back_to() -> None:
    control, handle = attached(axes=2)
    registered(control, O7="\nN10 G1 X20. F3000\nN20 Y-7.\nM30\n")
    running(control, 7)
    control.advance(150)
    moment = control.snapshot()
    seen = []
    for _ in range(2):
        control.advance(400)
        seen.append(
            (
                fwlib.cnc_rddynamic(handle, -1, 118)[1],
                control.mode,
                control.state.protection_keys,
                control.state.cursor,
            )
        )
        control.reset()
        control.advance(50)
        control.select_mode("JOG")
        control.protect_key()
        control.restore(moment)
        assert control.snapshot() == moment
    assert seen[0] == seen[1]
    assert seen[0][0].seqnum == 20
    assert moment.cycle == 150


@pytest.mark.covers("fanuc.cnc_download", "fanuc.cnc_dwnend")
@pytest.mark.covers("fanuc.cnc_allclibhndl", "fanuc.cnc_dwnstart", "fanuc.cnc_delete")
def test_two_programs_in_two_threads_have_one_control() -> None:
    control, _ = attached(axes=1)
    opened = []

    def begin(session: fwlib.Session, number: int) -> None:
        session.attach(0, control)
        _, handle = session.cnc_allclibhndl()
        for _ in range(200):
            if session.cnc_dwnstart(handle) == OK:
                opened.append(handle)
                text = f"\nO{number}\nM30\n%"
                assert session.cnc_download(handle, text, len(text)) == OK
                assert session.cnc_dwnend(handle) == OK
                while session.cnc_delete(handle, number) == EW.EW_BUSY:  # the other one has a session open
                    pass

    threads = [threading.Thread(target=begin, args=(fwlib.Session(), number)) for number in (7, 9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert opened
    assert control.transfer is None
    assert not control.programs.directory()


@pytest.mark.covers("fanuc.cnc_wrmdiprog")
@pytest.mark.covers("fanuc.cnc_dwnstart", "fanuc.cnc_wrmacro", "fanuc.cnc_wrmdiprog.err.EW_DATA")
@pytest.mark.covers("fanuc.concept.selected_program")
def test_power_off_and_on() -> None:
    control, handle = attached(axes=2)
    registered(control, O7="\nG1 X5. F600\nM30\n")
    control.select_program(7)
    moved(control, "G0 X3. Y-4.")
    control.select_mode("MDI")
    assert fwlib.cnc_wrmdiprog(handle, 13, "\nO1\nG4P9\nM30\n%") == EW.EW_DATA  # one character is missing
    assert fwlib.cnc_wrmdiprog(handle, 14, "\nO1\nG4P9\nM30\n%") == OK
    assert fwlib.cnc_wrmacro(handle, 500, 10, 15, 1) == OK
    control.select_mode("EDIT")
    assert fwlib.cnc_dwnstart(handle) == OK
    control.raise_alarm(101)
    cycles = control.clock.cycles
    control.power_cycle()
    assert (control.mode, control.programs.selected, control.transfer, bool(control.mdi)) == (
        PowerMateMode.MEM,
        7,
        None,
        False,
    )
    assert (control.machine.actual, control.clock.cycles) == ({"X": 3.0, "Y": -4.0}, cycles)
    assert control.power.alarm_bits == 0
    assert control.macros.get(500) == 1.5
    control.cycle_start()
    control.advance(2000)
    assert control.machine.actual["X"] == 5.0
    control.parameters.set(1320, 4000, 1)
    control.power_cycle()  # the axis stands beyond its limit
    assert control.machine.actual["X"] == 5.0
    assert control.machine.config.axes[0].soft_limits[1] == 4.0


@pytest.mark.covers("fanuc.cnc_rdmacro", "fanuc.cnc_rdprogdir", "fanuc.cnc_rdtofs")
@pytest.mark.covers("fanuc.cnc_wrmacro", "fanuc.cnc_wrtofs")
def test_everything_durable_is_in_the_file(tmp_path: Path) -> None:
    file = tmp_path / "power-mate.db"
    control, handle = attached(memory=file, axes=2, increment="IS-A")
    registered(control, O7="(PLATE)\nM30\n")
    control.select_program(7)
    control.parameters.set(1320, 4000, 1)
    assert fwlib.cnc_wrtofs(handle, 12, 0, 8, -321) == OK
    assert fwlib.cnc_wrmacro(handle, 531, 10, 2500, 3) == OK
    control.parameters.set(6711, 41)
    control.close()
    control, handle = attached(memory=file, axes=2)
    assert (control.programs.selected, control.units.increment.value) == (7, "IS-A")
    assert fwlib.cnc_rdprogdir(handle, 1, 1, 9999, 30)[1].prg_data == b"%\nO7(PLATE)\n%"
    assert control.parameters.value(1320, 1) == 4000
    assert control.machine.config.axes[0].soft_limits[1] == 40.0
    assert fwlib.cnc_rdtofs(handle, 12, 0, 8)[1].data == -321
    assert fwlib.cnc_rdmacro(handle, 531, 10)[1].mcr_val == 2500
    assert control.parameters.value(6711) == 41
    control.close()


WRITER = """
    import sys
    from polycnc.controllers.fanuc import PowerMate, fwlib
    control = PowerMate(1, memory=sys.argv[1])
    fwlib.attach(0, control)
    handle = fwlib.cnc_allclibhndl()[1]
    number = len(control.programs)
    while True:
        number += 1
        text = f"\\nO{number}\\n" + f"X{number}.\\n" * 20 + "M30\\n%"
        assert fwlib.cnc_dwnstart(handle) == 0
        assert fwlib.cnc_download(handle, text, len(text)) == 0
        assert fwlib.cnc_dwnend(handle) == 0
        assert fwlib.cnc_wrmacro(handle, 500, 10, number, 0) == 0
        assert fwlib.cnc_wrtofs(handle, 1, 0, 8, number) == 0
        sys.stdout.write(f"{number}\\n")
        sys.stdout.flush()
"""


@pytest.mark.skipif(os.name != "posix", reason="needs SIGKILL")
def test_a_killed_process_loses_nothing_acknowledged(tmp_path: Path) -> None:
    file = tmp_path / "power-mate.db"
    acknowledged = 0
    for rounds in range(share(3)):
        with subprocess.Popen(
            [sys.executable, "-c", textwrap.dedent(WRITER), str(file)],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        ) as writer:
            assert writer.stdout is not None
            for _ in range(2 + rounds):
                acknowledged = int(writer.stdout.readline())
            writer.send_signal(signal.SIGKILL)
            acknowledged = max([acknowledged, *map(int, writer.stdout.read().split())])
        control = PowerMate(1, memory=file)
        numbers = [each.number for each in control.programs.directory()]
        assert numbers == list(range(1, len(numbers) + 1))
        assert len(numbers) in (acknowledged, acknowledged + 1)
        for number in numbers:
            assert control.programs.read(number).count(f"X{number}.\n".encode()) == 20
        for found in (control.macros.get(500), control.tool_offsets.get(1)):
            assert found in (acknowledged, acknowledged + 1)
        control.close()
