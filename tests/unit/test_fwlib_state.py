"""System, state and alarms through the library, set up by what the control really does (Manual 000, miscellaneous)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from polycnc.cnc import Answer, Function
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.data._configuration import Configuration
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from support.refusals import refused


def at(control: PowerMate) -> tuple[Any, int]:
    session = fwlib.Session()
    session.attach(0, control)
    code, handle = session.cnc_allclibhndl()
    assert code == 0
    return session, handle


def put(control: PowerMate, number: int, text: str) -> None:
    control.programs.memory.create(f"O{number:04d}", f"O{number:04d}\n{text}\n".encode())
    control.select_program(number)


def running(text: str, cycles: int = 5, **more: Any) -> PowerMate:
    control = PowerMate(**more)
    put(control, 7, text)
    control.cycle_start()
    control.advance(cycles)
    return control


# ---------------------------------------------------------------------- cnc_sysinfo, cnc_sysconfig


@pytest.mark.covers(
    "fanuc.cnc_sysinfo", "fanuc.example.cnc_sysinfo", "fanuc.ODBSYS.cnc_type.PM", "fanuc.ODBSYS.mt_type.H"
)
@pytest.mark.covers(
    "fanuc.ODBSYS.max_axis",
    "fanuc.ODBSYS.cnc_type",
    "fanuc.ODBSYS.mt_type",
    "fanuc.ODBSYS.series",
    "fanuc.ODBSYS.version",
    "fanuc.ODBSYS.axes",
)
@pytest.mark.covers("fanuc.ODBSYS")
def test_system_of_the_manuals_sample() -> None:
    library, handle = at(PowerMate(axes=4))
    code, system = library.cnc_sysinfo(handle)
    assert code == 0
    assert bytes(system) == b"\0\0\6\0PM H88800014 4"


@pytest.mark.covers("fanuc.cnc_sysinfo")
@pytest.mark.covers("fanuc.ODBSYS.mt_type.D")
@pytest.mark.covers("fanuc.ODBSYS", "fanuc.ODBSYS.mt_type")
def test_system_of_a_power_mate_d() -> None:
    library, handle = at(PowerMate(model="D", axes=1))
    _, system = library.cnc_sysinfo(handle)
    assert (system.max_axis, system.mt_type, system.axes) == (2, b" D", b" 1")


MODULES: dict[str, tuple[str, dict[int, Any]]] = {
    "frmmin": ("from_module", {-1: "not mounted", 0: "2 MB", 2: "4 MB"}),
    "drmmin": ("dram_module", {-1: "not mounted", 0: "2 MB", 1: "2.5 MB", 3: "3 MB"}),
    "srmmin": (
        "sram_module",
        {
            -1: "not mounted",
            0: "256 KB, type 0",
            1: "1 MB, type 1",
            2: "1 MB",
            3: "512 KB",
            4: "256 KB",
            5: "128 KB",
            6: "768 KB",
            7: "none",
        },
    ),
    "pmcmin": (
        "pmc_module",
        {-1: "not mounted", 0: "PMP2 and SLC", 1: "bit operation module", 2: "PMP module", 3: "none"},
    ),
    "submin": (
        "sub_board",
        {-1: "not mounted", 1: "RS485", 2: "built-in I/O", 3: "M-NET", 7: "I/O Link 2"},
    ),
    "sicmin": ("sic", {-1: False, 0: True}),
    "posmin": ("position_lsi", {-1: False, 0: True}),
    "hdiio": ("high_speed_skip", {-1: False, 0: True}),
}


@pytest.mark.covers("fanuc.cnc_sysconfig")
@pytest.mark.parametrize(
    ("element", "argument", "module", "value"),
    [
        pytest.param(
            element, argument, module, value,
            marks=pytest.mark.covers(f"fanuc.ODBSYSC.{element}.{value}"), id=f"{element}-{value}",
        )
        for element, (argument, modules) in MODULES.items()
        for value, module in modules.items()
    ],
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.ODBSYSC.hdiio", "fanuc.ODBSYSC.posmin", "fanuc.ODBSYSC.sicmin", "fanuc.ODBSYSC.srmmin"
)
@pytest.mark.covers(
    "fanuc.ODBSYSC",
    "fanuc.ODBSYSC.drmmin",
    "fanuc.ODBSYSC.frmmin",
    "fanuc.ODBSYSC.pmcmin",
    "fanuc.ODBSYSC.submin",
)
def test_a_module_has_its_code(element: str, argument: str, module: Any, value: int) -> None:
    absent = value != -1  # the others: not there while it is, there while it is not
    others = {
        name: (argument, modules[-1 if absent else max(modules)])
        for name, (argument, modules) in MODULES.items()
        if name != element
    }
    control = PowerMate()
    control.configuration = Configuration(**dict(others.values()), **{argument: module})
    library, handle = at(control)
    system = library.cnc_sysconfig(handle)[1]
    codes = {name: -1 if absent else max(MODULES[name][1]) for name in others}
    assert {name: getattr(system, name) for name in MODULES} == codes | {element: value}


@pytest.mark.parametrize(
    ("axes", "modules"),
    [
        pytest.param(
            2, [0, -1, -1], marks=pytest.mark.covers("fanuc.ODBSYSC.sv1min.0", "fanuc.ODBSYSC.sv3min.-1")
        ),
        pytest.param(
            3, [0, 0, -1], marks=pytest.mark.covers("fanuc.ODBSYSC.sv3min.0", "fanuc.ODBSYSC.sv5min.-1")
        ),
        pytest.param(5, [0, 0, 0], marks=pytest.mark.covers("fanuc.ODBSYSC.sv5min.0")),
    ],
)
@pytest.mark.covers("fanuc.ODBSYSC.sv1min", "fanuc.ODBSYSC.sv3min", "fanuc.ODBSYSC.sv5min")
@pytest.mark.covers("fanuc.cnc_sysconfig")
@pytest.mark.covers("fanuc.ODBSYSC")
def test_servo_modules_are_those_of_the_axes(axes: int, modules: list[int]) -> None:
    library, handle = at(PowerMate(axes=axes))
    system = library.cnc_sysconfig(handle)[1]
    assert [system.sv1min, system.sv3min, system.sv5min] == modules


@pytest.mark.covers("fanuc.cnc_sysconfig", "fanuc.ODBSYSC.soft_id.40H", "fanuc.ODBSYSC.soft_id.FFH")
@pytest.mark.covers(
    "fanuc.ODBSYSC.soft_id",
    "fanuc.ODBSYSC.s_series",
    "fanuc.ODBSYSC.s_version",
    "fanuc.ODBSYSC.svo_soft",
    "fanuc.ODBSYSC.pmc_soft",
    "fanuc.ODBSYSC.lad_soft",
    "fanuc.ODBSYSC.mcr_soft",
)
@pytest.mark.covers("fanuc.ODBSYSC")
def test_software_of_the_control() -> None:
    control = PowerMate()
    library, handle = at(control)
    code, system = library.cnc_sysconfig(handle)
    assert (code, list(system.soft_id[:2])) == (0, [0x40, 0xFF])
    found = system.drmmin, system.srmmin, system.sicmin, system.posmin, system.hdiio
    assert found == (3, 3, 0, 0, 0)
    memory = bytes(system)
    assert memory[96:101] == b"8880\0"
    assert memory[176:181] == b"0014\0"
    assert memory[276:304] == b"90600004" + b"406001" + b"      " + b"\xff" + bytes(7)
    control.configuration = Configuration(ladder="123401", macro_executor="A02B07", servo="90650012")
    memory = bytes(library.cnc_sysconfig(handle)[1])
    assert memory[276:304] == b"90650012" + b"406001" + b"123401" + b"\1A02B07\0"


# ---------------------------------------------------------------------- cnc_statinfo


@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.parametrize(
    ("mode", "value"),
    [
        pytest.param(mode, value, marks=pytest.mark.covers(f"fanuc.ODBST.aut.{value}"), id=mode)
        for value, mode in {
            0: "MDI", 1: "MEM", 3: "EDIT", 4: "HND", 5: "JOG", 6: "T-JOG", 7: "T-HND", 8: "INC", 9: "REF", 10: "RMT",
        }.items()
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBST.aut")
@pytest.mark.covers("fanuc.ODBST")
def test_mode(mode: str, value: int) -> None:
    control = PowerMate()
    control.select_mode(mode)
    library, handle = at(control)
    code, state = library.cnc_statinfo(handle)
    assert (code, state.aut) == (0, value)


@pytest.mark.covers("fanuc.ODBST.aut.2")
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.ODBST", "fanuc.ODBST.aut")
def test_mode_signals_that_no_mode_has_select_none() -> None:
    control = PowerMate()
    control.signals.give(43, 2)
    library, handle = at(control)
    assert library.cnc_statinfo(handle)[1].aut == 2


def held() -> PowerMate:
    control = running("G1 X50. F600")
    control.feed_hold()
    control.advance(400)
    return control


def stopped() -> PowerMate:
    return running("M0\nG1 X50. F600", 400)


def waiting(cycles: int = 3) -> PowerMate:
    return running("M8\nG1 X50. F600", cycles, script={(Function.M, 8): Answer(after_s=None)})


def waiting_for(word: str, function: Function) -> PowerMate:
    number = int(word[1:])
    return running(f"{word}\nG1 X50. F600", 3, script={(function, number): Answer(after_s=None)})


def held_while_a_function_waits() -> PowerMate:
    control = waiting()
    control.feed_hold()
    control.advance(5)
    return control


def stopped_by_choice() -> PowerMate:
    control = PowerMate()
    control.optional_stop()
    put(control, 7, "M1\nG1 X50. F600")
    control.cycle_start()
    control.advance(400)
    return control


def stopped_after_a_block() -> PowerMate:
    control = PowerMate()
    control.control.set_switches(single_block=True)
    put(control, 7, "G1 X2. F600\nX50.")
    control.cycle_start()
    control.advance(800)
    return control


def held_in_a_dwell() -> PowerMate:
    control = running("G4 P3000", 40)
    control.feed_hold()
    control.advance(5)
    return control


def held_by_the_mode() -> PowerMate:
    control = running("G1 X50. F600", 200)
    control.select_mode("EDIT")
    control.advance(300)
    control.select_mode("MEM")
    return control


STATES: dict[str, tuple[Callable[[], PowerMate], int, int, int]] = {
    "reset": (PowerMate, 0, 0, 0),
    "stopped": (stopped, 1, 0, 0),
    "held": (held, 2, 0, 0),
    "moving": (lambda: running("G1 X50. F600"), 4, 1, 0),
    "dwelling": (lambda: running("G4 P3000", 40), 4, 3, 0),
    "after a function": (lambda: running("M8\nG4 P3000", 40), 4, 3, 0),
    "at a function": (waiting, 4, 0, 1),
    "held at a function": (held_while_a_function_waits, 2, 0, 1),
    "at a speed": (lambda: waiting_for("S500", Function.S), 4, 0, 1),
    "stopped by M1": (stopped_by_choice, 1, 0, 0),
    "stopped after a block": (stopped_after_a_block, 1, 0, 0),
    "held in a dwell": (held_in_a_dwell, 2, 0, 0),
    "held by the mode": (held_by_the_mode, 2, 0, 0),
    "over": (lambda: running("G1 X.5 F600\nM30", 900), 0, 0, 0),
}


@pytest.mark.parametrize(
    ("setup", "run", "motion", "mstb"),
    [
        pytest.param(
            *each,
            marks=pytest.mark.covers(
                *(
                    f"fanuc.ODBST.{name}.{value}"
                    for name, value in zip(("run", "motion", "mstb"), each[1:], strict=True)
                )
            ),
            id=name,
        )
        for name, each in STATES.items()
    ],
)
@pytest.mark.covers("fanuc.ODBST.run", "fanuc.ODBST.motion", "fanuc.ODBST.mstb", "fanuc.cnc_statinfo")
@pytest.mark.covers(
    "fanuc.ODBST.emergency.0", "fanuc.ODBST.alarm.0", "fanuc.ODBST.edit.0", "fanuc.ODBST.aut.1"
)
@pytest.mark.covers(
    "fanuc.ODBST", "fanuc.ODBST.alarm", "fanuc.ODBST.aut", "fanuc.ODBST.edit", "fanuc.ODBST.emergency"
)
def test_state_of_a_program(setup: Callable[[], PowerMate], run: int, motion: int, mstb: int) -> None:
    library, handle = at(setup())
    state = library.cnc_statinfo(handle)[1]
    found = state.aut, state.run, state.motion, state.mstb, state.emergency, state.alarm, state.edit
    assert found == (1, run, motion, mstb, 0, 0, 0)


@pytest.mark.covers("fanuc.cnc_statinfo", "fanuc.ODBST.alarm.1", "fanuc.ODBST.alarm.0", "fanuc.ODBST.run")
@pytest.mark.covers("fanuc.ODBST.run.0", "fanuc.ODBST.run.1", "fanuc.ODBST.run.4", "fanuc.ODBST.emergency.1")
def test_an_alarm_stops_and_a_reset_ends_a_program() -> None:
    control = running("G1 X50. F600", 200)
    library, handle = at(control)

    def state() -> tuple[int, ...]:
        found = library.cnc_statinfo(handle)[1]
        return found.run, found.motion, found.emergency, found.alarm

    seen = [state()]
    control.raise_alarm(85, "OVERRUN")
    control.advance(500)
    seen.append(state())
    control.reset()
    seen.append(state())
    control.raise_alarm(85, "OVERRUN")  # at rest
    seen.append(state())
    control.reset()
    control.cycle_start()
    control.advance(100)
    control.emergency_stop()
    control.advance(300)
    seen.append(state())
    assert seen == [(4, 1, 0, 0), (1, 0, 0, 1), (0, 0, 0, 0), (0, 0, 0, 1), (0, 0, 1, 0)]


@pytest.mark.covers(
    "fanuc.cnc_statinfo", "fanuc.ODBST.motion", "fanuc.ODBST.motion.0", "fanuc.ODBST.motion.1"
)
@pytest.mark.covers("fanuc.ODBST.run.0", "fanuc.ODBST.aut.5", "fanuc.ODBST.aut.6")
def test_motion_without_a_program_shows() -> None:
    for mode, number in (("JOG", 5), ("T-JOG", 6)):
        control = PowerMate()
        library, handle = at(control)
        control.select_mode(mode)
        seen = []
        for key in (2, 0):
            control.signals.give(100, key)
            control.advance(300)
            found = library.cnc_statinfo(handle)[1]
            seen.append((found.aut, found.run, found.motion))
        assert seen == [(number, 0, 1), (number, 0, 0)]


@pytest.mark.covers("fanuc.cnc_diagnoss", "fanuc.diag.kind.byte")
def test_diagnosis_tells_that_a_function_waits_for_its_answer() -> None:
    told = []
    for control in (running("M8", 3), running("M8", 3, script={(Function.M, 8): Answer(after_s=None)})):
        library, handle = at(control)
        told.append(library.cnc_diagnoss(handle, 0, 0, 5)[1].u.cdata)
    assert told == [0, 1]


def emergency_of(control: PowerMate) -> int:
    library, handle = at(control)
    return int(library.cnc_statinfo(handle)[1].emergency)


@pytest.mark.covers("fanuc.ODBST.emergency.0", "fanuc.ODBST.emergency.1")
@pytest.mark.covers("fanuc.ODBST", "fanuc.ODBST.emergency")
def test_emergency_stop_and_its_release() -> None:
    control = PowerMate()
    control.emergency_stop()
    assert emergency_of(control) == 1
    control.emergency_stop(False)
    assert emergency_of(control) == 0


@pytest.mark.covers("fanuc.ODBST.emergency.0", "fanuc.ODBST.emergency.1", "fanuc.ODBST.emergency.2")
@pytest.mark.covers("fanuc.ODBST", "fanuc.ODBST.emergency")
def test_a_reset_signal_shows_as_reset() -> None:
    control = PowerMate()
    control.signals.give_bits(8, 0x80, 0x80)
    assert emergency_of(control) == 2
    control.emergency_stop()
    assert emergency_of(control) == 1  # it comes before the reset
    control.emergency_stop(False)
    assert emergency_of(control) == 2
    control.signals.give_bits(8, 0x80, 0)
    assert emergency_of(control) == 0


@pytest.mark.covers("fanuc.ODBST.alarm.0", "fanuc.ODBST.alarm.1", "fanuc.ODBST.alarm.2", "fanuc.ODBST.alarm")
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.ODBST")
def test_alarm_and_low_battery() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.emergency_stop()
    assert library.cnc_statinfo(handle)[1].alarm == 0
    control.signals.state.battery_low = True
    assert library.cnc_statinfo(handle)[1].alarm == 2
    control.raise_alarm(85, "OVERRUN")
    assert library.cnc_statinfo(handle)[1].alarm == 1
    control.reset()
    assert library.cnc_statinfo(handle)[1].alarm == 2


@pytest.mark.covers("fanuc.cnc_upend")
@pytest.mark.covers("fanuc.ODBST.edit.3")
@pytest.mark.covers("fanuc.cnc_statinfo", "fanuc.cnc_upstart")
@pytest.mark.covers("fanuc.ODBST", "fanuc.ODBST.edit")
def test_a_program_that_goes_out_shows_as_output() -> None:
    control = PowerMate()
    library, handle = at(control)
    put(control, 3, "G0 X1.")
    assert library.cnc_upstart(handle, 3) == 0
    assert library.cnc_statinfo(handle)[1].edit == 3
    assert library.cnc_upend(handle) == 0
    assert library.cnc_statinfo(handle)[1].edit == 0


@pytest.mark.covers(
    "fanuc.ODBST.edit",
    "fanuc.ODBST.edit.0",
    "fanuc.ODBST.edit.1",
    "fanuc.ODBST.edit.4",
    "fanuc.ODBST.edit.5",
    "fanuc.ODBST.edit.6",
)
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.ODBST")
@pytest.mark.covers("fanuc.concept.compare_running", "fanuc.concept.background_edit")
@pytest.mark.covers(
    "fanuc.ODBST.aut.0",
    "fanuc.ODBST.aut.1",
    "fanuc.ODBST.aut.2",
    "fanuc.ODBST.aut.3",
    "fanuc.ODBST.aut.4",
    "fanuc.ODBST.aut.5",
    "fanuc.ODBST.aut.6",
    "fanuc.ODBST.aut.7",
    "fanuc.ODBST.aut.8",
    "fanuc.ODBST.aut.9",
    "fanuc.ODBST.aut.10",
)
def test_edit_state() -> None:
    control = PowerMate()
    library, handle = at(control)
    put(control, 3, "G0 X1.")
    for mode in PowerMateMode:  # the mode alone is no editing
        control.select_mode(mode)
        assert (library.cnc_statinfo(handle)[1].aut, library.cnc_statinfo(handle)[1].edit) == (int(mode), 0)
    states = [library.cnc_statinfo(handle)[1].edit]
    edit = control.control.edit("O0003", background=True)
    states.append(library.cnc_statinfo(handle)[1].edit)
    edit.close()
    control.start_compare()
    states.append(library.cnc_statinfo(handle)[1].edit)
    assert control.transfer is not None
    control.transfer.take(b"%\nO0003\n")
    states.append(library.cnc_statinfo(handle)[1].edit)
    control.begin_transfer()
    control.transfer.take(b"%\nO0005\n")
    states.append(library.cnc_statinfo(handle)[1].edit)
    assert states == [0, 1, 6, 5, 4]
    control.transfer = None
    control.select_mode("EDIT")
    states = []
    for piece in ("", "%", "%\nO0009\nM30", "\n%"):
        if not piece:
            assert library.cnc_dwnstart(handle) == 0
        else:
            assert library.cnc_download(handle, piece, len(piece)) == 0
        states.append(library.cnc_statinfo(handle)[1].edit)
    assert library.cnc_dwnend(handle) == 0
    states.append(library.cnc_statinfo(handle)[1].edit)
    assert states == [6, 6, 4, 4, 0]
    control.select_mode("EDIT")
    with control.programs.edit(9):
        assert library.cnc_statinfo(handle)[1].edit == 1


# ---------------------------------------------------------------------- cnc_alarm, cnc_rdalminfo

GROUPS = {0: 100, 1: 0, 2: 101, 3: 85, 4: 506, 5: 700, 6: 417, 8: 300, 10: 5010, 15: 1003}
UNUSED = (7, 9, 11, 12, 13, 14)


ENDS = {
    3: (3, 99, 102, 255),
    4: (500, 599),
    5: (700, 749),
    6: (400, 499),
    8: (301, 399),
    10: (5000, 5999),
    15: (1000, 1999),
}
"""First and last numbers of the groups that have more than one."""


def signed(bits: int) -> int:
    return bits - 0x10000 if bits & 0x8000 else bits


@pytest.mark.covers("fanuc.cnc_alarm")
@pytest.mark.parametrize(
    ("bit", "number"),
    [
        pytest.param(
            bit, number, id=str(bit),
            marks=pytest.mark.covers(f"fanuc.ODBALM.data.bit{bit}", f"fanuc.cnc_rdalminfo.alm_type.bit{bit}"),
        )
        for bit, number in GROUPS.items()
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdalminfo")
@pytest.mark.covers("fanuc.ODBALM", "fanuc.ODBALM.data")
@pytest.mark.covers("fanuc.concept.alarm_ps000_ps101")
def test_an_alarm_sets_the_bit_of_its_group_and_is_found_by_it(bit: int, number: int) -> None:
    control = PowerMate()
    library, handle = at(control)
    control.raise_alarm(number, "TEXT")
    code, alarm = library.cnc_alarm(handle)
    assert (code, alarm.data) == (0, signed(1 << bit))
    _, found = library.cnc_rdalminfo(handle, 0, signed(1 << bit), 2 * 4 + 2)
    assert [found.u.alm1.alm[0].alm_no, found.u.alm1.alm[1].axis, found.u.alm1.data_end] == [number, -1, -1]
    for other in ENDS.get(bit, ()):
        control.raise_alarm(other, "TEXT")
        assert library.cnc_alarm(handle)[1].data == signed(1 << bit)
    others = sum(1 << each for each in GROUPS if each != bit)
    _, none = library.cnc_rdalminfo(handle, 0, signed(others), 4 + 2)
    assert none.u.alm1.alm[0].axis == -1


@pytest.mark.covers("fanuc.cnc_rdalminfo")
@pytest.mark.covers(
    "fanuc.cnc_alarm",
    *(f"fanuc.ODBALM.data.bit{bit}" for bit in UNUSED),
    *(f"fanuc.cnc_rdalminfo.alm_type.bit{bit}" for bit in UNUSED),
    "fanuc.cnc_rdalminfo.err.EW_ATTRIB",
)
@pytest.mark.covers("fanuc.ODBALM", "fanuc.ODBALM.data")
def test_unused_bits_are_never_set_and_select_nothing() -> None:
    control = PowerMate()
    library, handle = at(control)
    for number in GROUPS.values():
        control.raise_alarm(number, "TEXT")
    assert library.cnc_alarm(handle)[1].data & 0xFFFF == 0x857F
    for bit in UNUSED:
        assert library.cnc_rdalminfo(handle, 0, 1 << bit, 6)[0] is fwlib.EW.EW_ATTRIB
    assert library.cnc_rdalminfo(handle, 0, 0, 6)[0] is fwlib.EW.EW_ATTRIB


@pytest.mark.covers(*(f"fanuc.ODBALM.data.bit{bit}" for bit in (3, 4, 6)), "fanuc.cnc_alarm")
@pytest.mark.covers("fanuc.cnc_rdalminfo", "fanuc.ODBALM.data", "fanuc.ALMINFO.alm.axis")
def test_what_goes_wrong_sets_the_bit_of_its_group() -> None:
    limit = PowerMate()
    limit.parameters.set(1320, 4000, 2)
    servo = PowerMate(servo=True)
    servo.parameters.set(1828, 200, 1)
    found = []
    for control, text in (
        (limit, "G1 Y9. F600"),
        (servo, "G1 X50. F6000"),
        (PowerMate(), "G1 B5."),
    ):
        put(control, 7, text)
        control.cycle_start()
        control.advance(2000)
        library, handle = at(control)
        bits = library.cnc_alarm(handle)[1].data
        alarm = library.cnc_rdalminfo(handle, 0, bits, 6)[1].u.alm1.alm[0]
        found.append((bits, alarm.axis))
    assert found == [(1 << 4, 2), (1 << 6, 1), (1 << 3, 0)]


LABELS = [
    "P/S 100 ALARM", "P/S 000 ALARM", "P/S 101 ALARM", "P/S ALARM (1-255)", "OT ALARM", "OH ALARM", "SERVO ALARM",
    "unknown", "APC ALARM", "SPINDLE ALARM", "P/S ALARM (5000-)",
]  # fmt: skip


@pytest.mark.covers("fanuc.example.cnc_alarm")
@pytest.mark.parametrize(
    ("numbers", "printed"),
    [
        ((), ["NO ALARM"]),
        ((100,), ["P/S 100 ALARM"]),
        ((85,), ["P/S ALARM (1-255)"]),
        ((500, 401), ["OT ALARM", "SERVO ALARM"]),
        ((5005,), ["P/S ALARM (5000-)"]),
        ((1010,), []),
    ],
)
@pytest.mark.covers("fanuc.cnc_alarm")
def test_the_manuals_program_prints_alarms(numbers: tuple[int, ...], printed: list[str]) -> None:
    control = PowerMate()
    library, handle = at(control)
    for number in numbers:
        control.raise_alarm(number, "TEXT")
    data = library.cnc_alarm(handle)[1].data
    lines = [LABELS[bit] for bit in range(11) if data >> bit & 1] if data else ["NO ALARM"]
    assert lines == printed


@pytest.mark.covers("fanuc.cnc_rdalminfo", "fanuc.cnc_rdalminfo.type.0", "fanuc.cnc_rdalminfo.type.1")
@pytest.mark.covers(
    "fanuc.ALMINFO.alm.axis",
    "fanuc.ALMINFO.alm.msg_len",
    "fanuc.ALMINFO.alm.alm_msg",
    "fanuc.ALMINFO.data_end",
)
@pytest.mark.covers("fanuc.ALMINFO")
def test_alarms_with_axis_and_text() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.raise_alarm(85, "COMMUNICATION ERROR OF THE READER/PUNCHER")
    control.raise_alarm(417, axis=3)
    code, found = library.cnc_rdalminfo(handle, 1, 0x48, 3 * 38 + 2)
    assert code == 0
    memory = bytes(found)
    assert memory[:38] == b"\0\0\x55\0\x20\0COMMUNICATION ERROR OF THE READE"
    assert memory[38:44] == b"\3\0\xa1\1\x11\0"
    assert memory[44:76] == b"Z AXIS DGTL PARAM".ljust(32, b"\0")
    assert memory[76:78] == b"\xff\xff"
    assert memory[114:116] == b"\xff\xff"
    _, short = library.cnc_rdalminfo(handle, 0, 0x48, 4 + 2)
    assert bytes(short)[:6] == b"\0\0\x55\0\xff\xff"


@pytest.mark.covers("fanuc.cnc_rdalminfo")
@pytest.mark.parametrize(
    ("type_", "length", "code"),
    refused(
        "cnc_rdalminfo",
        (0, 5, "EW_LENGTH"),
        (0, 2, "EW_LENGTH"),
        (0, 4 + 2 + 1, "EW_LENGTH"),
        (1, 4 + 2, "EW_LENGTH"),
        (1, 2 * 38 + 4, "EW_LENGTH"),
        (2, 6, "EW_NUMBER"),
        (-1, 6, "EW_NUMBER"),
    ),
)
@pytest.mark.covers("fanuc.concept.length_argument")
def test_alarm_information_is_refused(type_: int, length: int, code: str) -> None:
    library, handle = at(PowerMate())
    assert library.cnc_rdalminfo(handle, type_, 8, length)[0] is fwlib.EW[code]
