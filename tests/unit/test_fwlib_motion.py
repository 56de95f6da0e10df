"""Axes moved by direct commands, and operation signals, on a machine that really moves (Manual 000, axis movement)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from polycnc.cnc import RunState
from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.fwlib import EW


def at(control: PowerMate) -> tuple[Any, int]:
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    return session, handle


def idb(*values: tuple[int, int]) -> bytes:
    return b"".join(bytes(fwlib.ODBPOS(idata=axis, ldata=value)) for axis, value in values)


def machine(control: PowerMate) -> list[int]:
    return [each.machine for each in control.positions.read()]


def buffers(library: Any, handle: int) -> list[list[int]]:
    code, odb = library.cnc_exebufstat(handle)
    assert code == 0
    return [list(row) for row in odb.cdata]


# ---------------------------------------------------------------------- samples of the manual


@pytest.mark.covers(
    "fanuc.example.cnc_abspoint", "fanuc.cnc_abspoint", "fanuc.nmod.0", "fanuc.ODBPOS.unit.linear_mm"
)
@pytest.mark.covers("fanuc.ODBPOS.idata", "fanuc.ODBPOS.ldata")
@pytest.mark.covers("fanuc.cnc_absolute", "fanuc.cnc_finstate")
@pytest.mark.covers("fanuc.ODBPOS")
@pytest.mark.covers("fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.ODBEXEC.EMNT11")
def test_absolute_motion_of_the_manual() -> None:
    control = PowerMate()
    control.programs.memory.create("O0004", b"O0004\nG0 X10. Y10.\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(3000)
    library, handle = at(control)
    code, odb = library.cnc_abspoint(handle, 1, 0, 2, 500, idb((1, 100000), (2, -100000)))
    assert code == 0
    assert bytes(odb) == b"\0\0" + b"\1" + bytes(15)
    control.advance(1000)
    assert control.status().axes["X"].velocity * 60.0 == pytest.approx(500.0)
    assert control.status().axes["Y"].velocity * 60.0 == pytest.approx(-500.0)
    control.advance(20000)
    assert machine(control) == [100000, -100000, 0]
    assert library.cnc_absolute(handle, -1, 28)[1].data[:3] == [100000, -100000, 0]
    assert list(library.cnc_finstate(handle)[1].cdata) == [0] * 8


@pytest.mark.covers("fanuc.example.cnc_incpoint", "fanuc.cnc_incpoint")
@pytest.mark.covers("fanuc.concept.direct_command", "fanuc.ODBPOS.unit.linear_mm")
@pytest.mark.covers("fanuc.nmod.0")
@pytest.mark.covers("fanuc.cnc_abspoint")
def test_incremental_motion_of_the_manual() -> None:
    control = PowerMate()
    library, handle = at(control)
    library.cnc_abspoint(handle, 1, 0, 2, 6000, idb((1, 10000), (2, 10000)))
    control.advance(3000)
    assert library.cnc_incpoint(handle, 1, 0, 2, 500, idb((1, 100000), (2, -100000)))[0] == 0
    control.advance(25000)
    assert machine(control) == [110000, -90000, 0]


@pytest.mark.covers("fanuc.example.cnc_refpoint", "fanuc.cnc_refpoint")
@pytest.mark.covers("fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.cnc_abspoint")
def test_reference_return_of_the_manual() -> None:
    control = PowerMate()
    library, handle = at(control)
    library.cnc_abspoint(handle, 1, 0, 2, 6000, idb((1, 7000), (2, 4000)))
    control.advance(3000)
    code, odb = library.cnc_refpoint(handle, 1, 0, 1)
    rows = [" ".join(f"{each:x}" for each in row) for row in odb.cdata]
    assert (code, rows) == (0, ["1 0 0 0 0 0 0 0", "0 0 0 0 0 0 0 0"])
    control.advance(3000)
    assert machine(control) == [0, 4000, 0]


@pytest.mark.parametrize(
    ("more", "value", "axis", "unit"),
    [
        pytest.param(
            {"inch_output": True},
            12345,
            "X",
            25.4e-4,
            marks=pytest.mark.covers("fanuc.ODBPOS.unit.linear_inch"),
        ),
        pytest.param(
            {"rotary": (1,)}, 12345, "A", 0.001, marks=pytest.mark.covers("fanuc.ODBPOS.unit.rotary")
        ),
        ({}, 12345, "X", 0.001),
        ({"inch_output": True, "rotary": (2,)}, 23456, "A", 0.001),  # each axis has its own
        ({"inch_output": True, "rotary": (1,)}, -9876, "X", 25.4e-4),
    ],
)
@pytest.mark.covers("fanuc.cnc_incpoint")
@pytest.mark.covers("fanuc.ODBPOS")
def test_units_of_positions(more: dict[str, Any], value: int, axis: str, unit: float) -> None:
    control = PowerMate(**more)
    library, handle = at(control)
    number = control.units.axis_names.index(axis) + 1
    assert library.cnc_incpoint(handle, 2, 0, 1, 3000, idb((number, value)))[0] == 0
    control.advance(3000)
    assert control.status().axes[axis].machine == pytest.approx(value * unit, abs=1e-9)


@pytest.mark.covers("fanuc.cnc_finstate", "fanuc.cnc_incpoint")
@pytest.mark.covers("fanuc.cnc_dwell", "fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.nmod.1", "fanuc.ODBEXEC.EMNT13", "fanuc.ODBEXEC.EMNT23", "fanuc.ODBFIN.EMNT13")
def test_a_dwell_keeps_its_path_waiting() -> None:
    control = PowerMate()
    library, handle = at(control)
    cycle_s = control.clock.cycle_s
    code, state = library.cnc_dwell(handle, 3, 1, 1, idb((1, 1500)))
    assert (code, [row[2] for row in state.cdata]) == (
        0,
        [4, 0],
    )  # each call answers with the buffers it leaves
    code, state = library.cnc_incpoint(handle, 3, 1, 1, 3000, idb((1, 2000)))
    assert (code, [row[2] for row in state.cdata]) == (0, [4, 4])
    control.advance(round(1.49 / cycle_s))
    assert (machine(control)[0], library.cnc_finstate(handle)[1].cdata[2]) == (0, 0)
    control.advance(round(0.03 / cycle_s))
    assert machine(control)[0] > 0
    assert library.cnc_finstate(handle)[1].cdata[2] == 4
    library.cnc_dwell(handle, 5, 1, 2, idb((3, 300), (2, 700)))  # the longest one counts
    control.advance(round(0.69 / cycle_s))
    assert library.cnc_finstate(handle)[1].cdata[4] == 0
    control.advance(round(0.02 / cycle_s))
    assert library.cnc_finstate(handle)[1].cdata[4] == 16


@pytest.mark.covers("fanuc.cnc_coordre")
@pytest.mark.covers("fanuc.cnc_absolute")
@pytest.mark.covers("fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.cnc_incpoint", "fanuc.cnc_abspoint")
def test_setting_a_coordinate() -> None:
    control = PowerMate()
    library, handle = at(control)
    library.cnc_incpoint(handle, 1, 0, 1, 6000, idb((2, 3000)))
    control.advance(2000)
    assert library.cnc_coordre(handle, 1, 0, 2, idb((2, 50000), (3, -700)))[0] == 0
    control.advance(1)
    assert library.cnc_absolute(handle, -1, 28)[1].data[:3] == [0, 50000, -700]
    assert machine(control) == [0, 3000, 0]
    library.cnc_abspoint(handle, 1, 0, 1, 6000, idb((2, 52500)))
    control.advance(2000)
    assert machine(control) == [0, 5500, 0]
    for value in (-900, 1200):  # each takes the place of the one before
        library.cnc_coordre(handle, 1, 0, 1, idb((2, value)))
        control.advance(1)
        assert library.cnc_absolute(handle, 2, 8)[1].data[0] == value
    library.cnc_incpoint(handle, 1, 0, 1, 6000, idb((2, -200)))
    control.advance(500)
    assert library.cnc_absolute(handle, -1, 28)[1].data[:3] == [0, 1000, -700]
    control.power_cycle()
    assert library.cnc_absolute(handle, -1, 28)[1].data[:3] == machine(control) == [0, 5300, 0]


# ---------------------------------------------------------------------- buffers and flags


@pytest.mark.covers("fanuc.cnc_refpoint")
@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=pytest.mark.covers(
            f"fanuc.ODBEXEC.EMNT1{path}", f"fanuc.ODBEXEC.EMNT2{path}", f"fanuc.ODBFIN.EMNT1{path}"))
        for path in range(1, 7)
    ],
)  # fmt: skip
@pytest.mark.covers(
    "fanuc.cnc_exebufstat", "fanuc.cnc_finstate", "fanuc.cnc_setfin", "fanuc.nmod.1", "fanuc.ODBEXEC.state.00",
    "fanuc.ODBEXEC.state.01", "fanuc.ODBEXEC.state.10", "fanuc.ODBEXEC.state.11", "fanuc.ODBEXEC.bits7_6",
    "fanuc.ODBFIN.bits7_6", "fanuc.cnc_dwell.err.EW_BUSY", "fanuc.cnc_incpoint.err.EW_BUSY",
    "fanuc.cnc_abspoint.err.EW_BUSY", "fanuc.cnc_coordre.err.EW_BUSY", "fanuc.cnc_refpoint.err.EW_BUSY",
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBEXEC.cdata", "fanuc.ODBFIN.cdata")
@pytest.mark.covers("fanuc.cnc_incpoint")
@pytest.mark.covers(
    "fanuc.ODBEXEC", "fanuc.ODBFIN", "fanuc.cnc_abspoint", "fanuc.cnc_coordre", "fanuc.cnc_dwell"
)
@pytest.mark.covers("fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.nmod.0")
def test_two_buffers_and_a_completion_flag_per_path(path: int) -> None:
    control = PowerMate()
    library, handle = at(control)
    bit, none = 1 << path - 1, [0] * 8
    one = [bit if k == path - 1 else 0 for k in range(8)]
    seen = [buffers(library, handle)]
    library.cnc_dwell(handle, path, 0, 1, idb((1, 300)))
    seen.append(buffers(library, handle))
    code, odb = library.cnc_incpoint(handle, path, 1, 1, 6000, idb((1, 700)))
    seen.append([list(row) for row in odb.cdata])
    assert (code, seen) == (0, [[none, none], [one, none], [one, one]])
    calls: list[Callable[[], Any]] = [
        lambda: library.cnc_dwell(handle, path, 1, 1, idb((1, 5))),
        lambda: library.cnc_incpoint(handle, path, 1, 1, 500, idb((1, 5))),
        lambda: library.cnc_abspoint(handle, path, 1, 1, 500, idb((1, 5))),
        lambda: library.cnc_coordre(handle, path, 1, 1, idb((1, 5))),
        lambda: library.cnc_refpoint(handle, path, 1, 1),
    ]
    assert [call()[0] for call in calls] == [EW.EW_BUSY] * 5
    control.advance(control.clock.cycles_for(0.3) + 3)
    assert buffers(library, handle) == [none, one]
    assert list(library.cnc_finstate(handle)[1].cdata) == none
    control.advance(2000)
    assert (buffers(library, handle), machine(control)[0]) == ([none, none], 700)
    code, fin = library.cnc_finstate(handle)
    assert (code, list(fin.cdata)) == (0, one)
    others = fwlib.ODBFIN(cdata=[0 if k == path - 1 else 0x3F for k in range(8)])
    assert library.cnc_setfin(handle, others) == 0
    assert list(library.cnc_finstate(handle)[1].cdata) == one
    library.cnc_setfin(handle, fwlib.ODBFIN(cdata=[0xC0 | bit] * 8))
    assert list(library.cnc_finstate(handle)[1].cdata) == none


@pytest.mark.covers("fanuc.concept.direct_command", "fanuc.cnc_incpoint", "fanuc.cnc_finstate")
@pytest.mark.covers("fanuc.nmod.1", "fanuc.ODBFIN.EMNT12", "fanuc.ODBFIN.EMNT14", "fanuc.ODBFIN.EMNT15")
def test_an_axis_belongs_to_the_path_that_moves_it() -> None:
    control = PowerMate()
    library, handle = at(control)
    library.cnc_incpoint(handle, 4, 1, 1, 6000, idb((1, 5000)))
    library.cnc_incpoint(handle, 5, 1, 2, 6000, idb((3, 400), (1, -2000)))
    library.cnc_incpoint(handle, 2, 1, 1, 6000, idb((2, 900)))
    control.advance(30)
    assert [axis.velocity > 0.0 for axis in control.status().axes.values()] == [True, True, False]
    control.advance(2000)
    assert machine(control) == [3000, 900, 400]
    assert list(library.cnc_finstate(handle)[1].cdata) == [0, 2, 0, 8, 16, 0, 0, 0]


@pytest.mark.covers("fanuc.cnc_finstate")
@pytest.mark.covers("fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.nmod.1")
@pytest.mark.covers("fanuc.cnc_incpoint")
def test_a_reset_and_an_alarm_empty_the_buffers() -> None:
    for stop in (PowerMate.reset, PowerMate.emergency_stop, lambda control: control.raise_alarm(85, "X")):
        control = PowerMate()
        library, handle = at(control)
        library.cnc_incpoint(handle, 1, 1, 1, 600, idb((1, 9000)))
        library.cnc_incpoint(handle, 1, 1, 1, 600, idb((1, 9000)))
        control.advance(200)
        stop(control)
        control.advance(500)
        there = machine(control)[0]
        assert 0 < there < 9000
        assert buffers(library, handle) == [[0] * 8, [0] * 8]
        control.advance(500)
        assert machine(control)[0] == there
        assert list(library.cnc_finstate(handle)[1].cdata) == [0] * 8


@pytest.mark.covers("fanuc.cnc_finstate")
@pytest.mark.covers("fanuc.concept.direct_command")
@pytest.mark.covers("fanuc.cnc_incpoint", "fanuc.cnc_dwell")
def test_a_change_of_mode_lets_commands_go_on() -> None:
    control = PowerMate()
    library, handle = at(control)
    library.cnc_incpoint(handle, 1, 0, 1, 600, idb((1, 9000)))
    library.cnc_incpoint(handle, 1, 1, 1, 600, idb((1, 4000)))
    library.cnc_dwell(handle, 2, 1, 1, idb((2, 700)))
    control.advance(200)
    for mode in ("JOG", "EDIT", "MDI", "REF"):
        control.select_mode(mode)
        control.advance(50)
        assert control.status().axes["X"].velocity * 60.0 == pytest.approx(600.0)
    assert list(library.cnc_finstate(handle)[1].cdata) == [0] * 8
    control.advance(1200)
    assert machine(control) == [13000, 0, 0]
    assert list(library.cnc_finstate(handle)[1].cdata) == [1, 2, 0, 0, 0, 0, 0, 0]


@pytest.mark.parametrize(
    ("axis", "distance", "alarm"),
    [(2, 9000, (500, "OVER TRAVEL : +Y")), (3, -9000, (501, "OVER TRAVEL : -Z"))],
)
@pytest.mark.covers("fanuc.cnc_abspoint", "fanuc.cnc_incpoint", "fanuc.concept.direct_command")
def test_a_command_past_a_limit_names_it(axis: int, distance: int, alarm: tuple[int, str]) -> None:
    control = PowerMate()
    library, handle = at(control)
    control.parameters.set(1320, 5000, 2)
    control.parameters.set(1321, -5000, 3)
    library.cnc_incpoint(handle, 1, 1, 2, 600, idb((1, 2000), (axis, distance)))
    control.advance(500)
    (found,) = control.status().alarms
    assert ((found.number, found.text), found.axis) == (alarm, "XYZ"[axis - 1])
    assert buffers(library, handle) == [[0] * 8, [0] * 8]
    control.reset()
    library.cnc_abspoint(handle, 1, 1, 1, 600, idb((axis, distance)))
    control.advance(500)
    assert [(each.number, each.text) for each in control.status().alarms] == [alarm]


@pytest.mark.covers(
    *(f"fanuc.cnc_{name}.err.EW_BUSY" for name in ("incpoint", "abspoint", "refpoint", "dwell", "coordre")),
    *(f"fanuc.cnc_{name}" for name in ("incpoint", "abspoint", "refpoint", "dwell", "coordre")),
)
@pytest.mark.covers("fanuc.concept.direct_command")
def test_a_running_program_has_the_axes() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.programs.memory.create("O0004", b"O0004\nG1 X10. F600\n")
    control.select_program(4)
    control.cycle_start()
    control.advance(10)
    calls: list[Callable[[], Any]] = [
        lambda: library.cnc_dwell(handle, 1, 0, 1, idb((1, 5))),
        lambda: library.cnc_incpoint(handle, 2, 0, 1, 600, idb((2, 500))),
        lambda: library.cnc_abspoint(handle, 3, 0, 1, 600, idb((1, 5))),
        lambda: library.cnc_coordre(handle, 1, 0, 1, idb((1, 5))),
        lambda: library.cnc_refpoint(handle, 1, 0, 3),
    ]
    assert [call()[0] for call in calls] == [EW.EW_BUSY] * 5
    control.advance(5000)
    assert library.cnc_incpoint(handle, 1, 0, 1, 600, idb((1, 500)))[0] is EW.EW_OK
    control.advance(1000)
    assert machine(control)[0] == 10500
    control.cycle_start()
    control.advance(3000)
    assert machine(control)[0] == 10000


# ---------------------------------------------------------------------- refusals


@pytest.mark.covers(
    "fanuc.cnc_abspoint",
    "fanuc.cnc_coordre",
    "fanuc.cnc_dwell",
    "fanuc.cnc_exebufstat",
    "fanuc.cnc_incpoint",
    "fanuc.cnc_opdi",
    "fanuc.cnc_setfin",
)
@pytest.mark.covers("fanuc.concept.not_on_pmd")
@pytest.mark.covers("fanuc.cnc_finstate", "fanuc.cnc_refpoint")
@pytest.mark.covers("fanuc.concept.power_mate_d_limit")
def test_a_power_mate_d_has_none_of_this() -> None:
    library, handle = at(PowerMate(model="D"))
    zero, fin = idb((1, 1)), fwlib.ODBFIN()
    assert [
        library.cnc_opdi(handle, 15, fwlib.ODBOPDI()),
        library.cnc_refpoint(handle, 1, 0, 1)[0],
        library.cnc_abspoint(handle, 1, 0, 1, 500, zero)[0],
        library.cnc_incpoint(handle, 1, 0, 1, 500, zero)[0],
        library.cnc_dwell(handle, 1, 0, 1, zero)[0],
        library.cnc_coordre(handle, 1, 0, 1, zero)[0],
        library.cnc_exebufstat(handle)[0],
        library.cnc_finstate(handle)[0],
        library.cnc_setfin(handle, fin),
    ] == [EW.EW_FUNC] * 9


UNMARKED: dict[str, tuple[int, ...]] = {
    "cnc_actf": (), "cnc_absolute": (-1, 12), "cnc_machine": (-1, 12), "cnc_relative": (-1, 12),
    "cnc_distance": (-1, 12), "cnc_skip": (-1, 12), "cnc_srvdelay": (-1, 12), "cnc_accdecdly": (-1, 12),
    "cnc_rddynamic": (1, 38), "cnc_rdprgnum": (), "cnc_rdseqnum": (), "cnc_rdproginfo": (0, 12),
    "cnc_rdmdipntr": (), "cnc_rdtofs": (1, 0, 8), "cnc_rdtofsinfo": (), "cnc_rdparam": (6711, 0, 8),
    "cnc_rdmacro": (100, 10), "cnc_rdmacroinfo": (), "cnc_getmactype": (), "cnc_rdparainfo": (6711, 1),
}  # fmt: skip


@pytest.mark.covers("fanuc.cnc_exebufstat")
@pytest.mark.covers("fanuc.concept.power_mate_d_limit")
def test_a_power_mate_d_has_the_functions_of_the_other_sections() -> None:
    control = PowerMate(model="D")
    library, handle = at(control)
    control.select_mode("MDI")
    refused = {
        name for name, given in UNMARKED.items() if getattr(library, name)(handle, *given)[0] != EW.EW_OK
    }
    assert refused == set()
    assert library.cnc_exebufstat(handle)[0] is EW.EW_FUNC


@pytest.mark.covers("fanuc.cnc_exebufstat", "fanuc.cnc_setfin")
@pytest.mark.covers("fanuc.param.8003_7", "fanuc.param.8010")
@pytest.mark.covers("fanuc.cnc_finstate", "fanuc.cnc_incpoint", "fanuc.cnc_refpoint")
@pytest.mark.covers("fanuc.common.allmode")
def test_parameters_allow_direct_commands() -> None:
    control = PowerMate()
    library, handle = at(control)
    control.parameters.set(8010, 0, 2)
    assert library.cnc_incpoint(handle, 1, 0, 2, 500, idb((1, 5), (2, 5)))[0] is EW.EW_PARAM
    assert library.cnc_refpoint(handle, 1, 0, 2)[0] is EW.EW_PARAM
    assert library.cnc_refpoint(handle, 1, 0, 1)[0] is EW.EW_OK
    control.parameters.set(8003, 0x7F)  # bit 7 alone allows them
    assert library.cnc_refpoint(handle, 1, 0, 1)[0] is EW.EW_PARAM
    assert library.cnc_exebufstat(handle)[0] is EW.EW_PARAM
    assert library.cnc_finstate(handle)[0] is EW.EW_PARAM
    assert library.cnc_setfin(handle, fwlib.ODBFIN()) is EW.EW_PARAM


@pytest.mark.covers("fanuc.cnc_abspoint", "fanuc.cnc_incpoint")
@pytest.mark.parametrize(
    ("path", "nmod", "count", "feed", "values", "code"),
    [
        (0, 0, 1, 500, ((1, 9),), "EW_PATH"),
        (7, 0, 1, 500, ((1, 9),), "EW_PATH"),
        (1, 2, 1, 500, ((1, 9),), "EW_DATA"),
        (1, 0, 0, 500, ((1, 9),), "EW_ATTRIB"),
        (1, 0, 4, 500, ((1, 9),) * 4, "EW_ATTRIB"),
        (1, 0, 1, 500, ((4, 9),), "EW_ATTRIB"),
        (1, 0, 2, 500, ((2, 9), (2, 8)), "EW_ATTRIB"),
        (1, 0, 2, 500, ((2, 9),), "EW_LENGTH"),
        (1, 0, 1, 0, ((1, 9),), "EW_DATA"),
        (1, 0, 1, 500, ((1, 100_000_000),), "EW_DATA"),
    ],
)
@pytest.mark.covers("fanuc.concept.direct_command")
def test_a_command_is_refused_whole(
    path: int, nmod: int, count: int, feed: int, values: tuple[tuple[int, int], ...], code: str
) -> None:
    control = PowerMate()
    library, handle = at(control)
    assert library.cnc_incpoint(handle, path, nmod, count, feed, idb(*values))[0] is EW[code]
    assert library.cnc_abspoint(handle, path, nmod, count, feed, idb(*values))[0] is EW[code]
    control.advance(100)
    assert (machine(control), control.axis_motion.busy) == ([0, 0, 0], False)


# ---------------------------------------------------------------------- operation signals


def give(library: Any, handle: int, number: int, value: int, axis: int = 0) -> EW:
    signal = fwlib.ODBOPDI(axis=axis)
    signal.u.cdata = value
    return EW(library.cnc_opdi(handle, number, signal))


def started(text: str = "G1 X90. F600") -> tuple[PowerMate, Any, int]:
    control = PowerMate()
    library, handle = at(control)
    control.programs.memory.create("O0004", f"O0004\n{text}\n".encode())
    control.select_program(4)
    give(library, handle, 8, 1)
    give(library, handle, 8, 0)
    control.advance(100)
    return control, library, handle


def state(control: PowerMate) -> RunState:
    return control.control.channels[0].run_state


@pytest.mark.covers(
    "fanuc.cnc_opdi", "fanuc.cnc_opdi.number.8", "fanuc.cnc_opdi.sig8.cdata.1", "fanuc.cnc_opdi.sig8.cdata.0",
    "fanuc.cnc_opdi.number.2", "fanuc.cnc_opdi.sig2.cdata.0", "fanuc.cnc_opdi.sig2.cdata.1",
    "fanuc.cnc_opdi.number.3", "fanuc.cnc_opdi.sig3.cdata.0", "fanuc.cnc_opdi.sig3.cdata.1",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_statinfo")
def test_start_hold_and_reset() -> None:
    control, library, handle = started()
    assert state(control) is RunState.ACTIVE
    assert give(library, handle, 2, 0) == 0
    assert state(control) is RunState.HOLD
    control.advance(300)
    give(library, handle, 8, 1)
    give(library, handle, 8, 0)
    assert state(control) is RunState.HOLD
    give(library, handle, 2, 1)
    give(library, handle, 8, 1)
    assert state(control) is RunState.HOLD
    give(library, handle, 8, 0)
    assert state(control) is RunState.ACTIVE
    give(library, handle, 3, 1)
    assert state(control) is RunState.RESET
    assert library.cnc_statinfo(handle)[1].emergency == 2
    give(library, handle, 3, 0)
    assert library.cnc_statinfo(handle)[1].emergency == 0
    give(library, handle, 3, 1)
    give(library, handle, 8, 1)
    give(library, handle, 8, 0)
    assert state(control) is RunState.RESET  # nothing starts while it is given
    give(library, handle, 8, 1)
    give(library, handle, 3, 0)
    give(library, handle, 8, 0)
    assert state(control) is RunState.ACTIVE


@pytest.mark.covers("fanuc.cnc_opdi.number.1", "fanuc.cnc_opdi.sig1.cdata.0", "fanuc.cnc_opdi.sig1.cdata.1")
@pytest.mark.covers("fanuc.cnc_statinfo")
@pytest.mark.covers("fanuc.cnc_opdi")
def test_emergency_stop_is_active_low() -> None:
    control, library, handle = started()
    give(library, handle, 1, 0)
    assert (library.cnc_statinfo(handle)[1].emergency, state(control)) == (1, RunState.RESET)
    give(library, handle, 1, 1)
    assert library.cnc_statinfo(handle)[1].emergency == 0


@pytest.mark.parametrize(
    ("value", "mode"),
    [
        pytest.param(value, mode, marks=pytest.mark.covers(f"fanuc.cnc_opdi.sig9.mode.{value}"))
        for value, mode in {0: "MDI", 1: "MEM", 2: "EDIT", 3: "REF", 4: "JOG", 5: "INC", 7: "HND"}.items()
    ],
)
@pytest.mark.covers("fanuc.cnc_opdi.number.9")
@pytest.mark.covers("fanuc.cnc_opdi")
def test_mode_select(value: int, mode: str) -> None:
    control = PowerMate()
    library, handle = at(control)
    for before in ("T-JOG", "RMT", "REF", "EDIT", "HND", "MDI", "INC", "MEM"):
        control.select_mode(before)
        assert give(library, handle, 9, value) == 0
        assert control.mode is PowerMateMode[mode]


@pytest.mark.covers("fanuc.cnc_opdi.number.10", "fanuc.cnc_opdi.sig10.255", "fanuc.cnc_opdi.sig10.range")
@pytest.mark.covers("fanuc.cnc_opdi")
def test_feed_override_is_the_percentage_itself() -> None:
    control, library, handle = started()
    seen = []
    for value in (0, 1, 64, 100, 173, 254, 255):
        give(library, handle, 10, value)
        control.advance(200)
        seen.append((control.signals.feed_override, round(control.status().axes["X"].velocity * 60.0, 6)))
    assert seen == [(0, 0), (1, 6), (64, 384), (100, 600), (173, 1038), (254, 1524), (0, 0)]
    give(library, handle, 10, 254)
    assert control.pmc.read("G", 12, 12) == b"\1"


@pytest.mark.covers(
    "fanuc.cnc_opdi.number.15", "fanuc.cnc_opdi.sig15.cdata.1", "fanuc.cnc_opdi.sig15.cdata.0"
)
@pytest.mark.covers("fanuc.cnc_opdi")
def test_single_block() -> None:
    control, library, handle = started("G1 X5. F600\nY2.\nZ3.")
    give(library, handle, 15, 1)
    control.advance(2000)
    assert (machine(control), state(control)) == ([5000, 0, 0], RunState.STOPPED_AT_BLOCK)
    give(library, handle, 15, 0)
    give(library, handle, 8, 1)
    give(library, handle, 8, 0)
    control.advance(3000)
    assert machine(control) == [5000, 2000, 3000]


@pytest.mark.covers(
    "fanuc.cnc_opdi.number.14", "fanuc.cnc_opdi.sig14.cdata.bit0", "fanuc.cnc_opdi.sig14.cdata.bit3",
    "fanuc.cnc_opdi.sig14.axis", "fanuc.cnc_opdi.number.7", "fanuc.cnc_opdi.sig7.cdata.0",
    "fanuc.cnc_opdi.sig7.cdata.1",
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBOPDI.axis")
@pytest.mark.covers("fanuc.ODBOPDI", "fanuc.cnc_opdi")
def test_jog_feed_of_one_axis_and_of_all() -> None:
    control = PowerMate()
    library, handle = at(control)
    give(library, handle, 9, 4)

    def speeds(value: int, axis: int) -> list[int]:
        give(library, handle, 14, value, axis)
        control.advance(300)
        found = [round(each.velocity * 60.0) for each in control.status().axes.values()]
        give(library, handle, 14, 0, axis)
        control.advance(300)
        assert all(each.velocity == 0.0 for each in control.status().axes.values())
        return found

    assert [speeds(1, 2), speeds(9, 3), speeds(1, 0)] == [[0, 3000, 0], [0, 0, -3000], [3000] * 3]
    give(library, handle, 7, 1)
    assert speeds(9, 1) == [-15000, 0, 0]
    assert [speeds(1, 1), speeds(1, 3)] == [[15000, 0, 0], [0, 0, 15000]]
    give(library, handle, 7, 0)
    assert speeds(9, 1) == [-3000, 0, 0]
    assert speeds(9, 0) == [-3000] * 3
    control.select_mode("T-JOG")
    assert speeds(1, 3) == [0, 0, 3000]
    control.select_mode("T-HND")
    assert speeds(1, 3) == [0, 0, 0]


@pytest.mark.covers("fanuc.cnc_opdi.number.4")
@pytest.mark.parametrize(
    "bit",
    [pytest.param(bit, marks=pytest.mark.covers(f"fanuc.cnc_opdi.sig4.cdata.bit{bit}")) for bit in range(6)],
)
@pytest.mark.covers("fanuc.cnc_incpoint")
@pytest.mark.covers("fanuc.cnc_opdi")
@pytest.mark.covers("fanuc.cnc_rdcurrent")
def test_an_axis_whose_servo_is_off_does_not_move(bit: int) -> None:
    control = PowerMate(axes=6)
    library, handle = at(control)
    give(library, handle, 9, 4)
    give(library, handle, 4, 1 << bit)
    assert library.cnc_incpoint(handle, 1, 0, 1, 3000, idb((bit + 1, 500)))[0] == 0
    control.advance(500)
    assert machine(control) == [0] * 6
    give(library, handle, 4, 0)
    control.advance(500)
    assert machine(control) == [500 if k == bit else 0 for k in range(6)]
    control.signals.give(100, 0x3F)  # all are jogged
    control.advance(200)
    give(library, handle, 4, 1 << bit)
    control.advance(300)
    assert all(each.velocity == 0.0 for each in control.status().axes.values())
    give(library, handle, 4, 0)
    control.advance(300)  # the others go on; this one wants its key again
    assert [each.velocity > 0.0 for each in control.status().axes.values()] == [k != bit for k in range(6)]


@pytest.mark.covers("fanuc.cnc_opdi.number.12")
@pytest.mark.parametrize(
    "bit",
    [pytest.param(bit, marks=pytest.mark.covers(f"fanuc.cnc_opdi.sig12.cdata.bit{bit}")) for bit in range(6)],
)
@pytest.mark.covers("fanuc.cnc_diagnoss")
@pytest.mark.covers("fanuc.cnc_opdi")
def test_torque_mode_of_an_axis(bit: int) -> None:
    control = PowerMate(axes=6)
    library, handle = at(control)
    assert give(library, handle, 12, 1 << bit) == 0
    seen = [library.cnc_diagnoss(handle, 203, axis, 5)[1].u.cdata for axis in range(1, 7)]
    assert seen == [int(k == bit) for k in range(6)]
    assert give(library, handle, 12, 0) == 0
    assert library.cnc_diagnoss(handle, 203, bit + 1, 5)[1].u.cdata == 0


@pytest.mark.covers("fanuc.cnc_rdcurrent")
@pytest.mark.covers("fanuc.cnc_opdi.number.13", "fanuc.cnc_opdi.sig13.axis", "fanuc.cnc_opdi.sig13.formula")
@pytest.mark.covers("fanuc.cnc_diagnoss")
@pytest.mark.covers("fanuc.cnc_opdi")
@pytest.mark.covers("fanuc.diag.kind.word_axis", "fanuc.param.2086")
def test_torque_override_limits_the_current() -> None:
    control, library, handle = started("G0 X900. Y-900. Z900.")
    control.advance(200)
    give(library, handle, 13, 51)
    give(library, handle, 13, 102, 2)
    assert [library.cnc_diagnoss(handle, 202, axis, 6)[1].u.idata for axis in (1, 2, 3)] == [200, 400, 200]
    assert library.cnc_rdcurrent(handle)[1][:3] == [round(1782 * each) for each in (0.2, -0.4, 0.2)]
    give(library, handle, 13, 0, 1)
    give(library, handle, 13, 255, 3)
    assert library.cnc_rdcurrent(handle)[1][:3] == [0, -round(1782 * 0.4), 1782]


@pytest.mark.parametrize(
    ("number", "value", "axis", "code"),
    [
        *(pytest.param(number, 1, 0, "EW_NUMBER", marks=pytest.mark.covers("fanuc.cnc_opdi.number.undefined"))
          for number in (0, 5, 6, 11, 16, -1)),
        (13, 9, 7, "EW_ATTRIB"),
        (13, 9, 4, "EW_ATTRIB"),  # the machine has three axes
        (14, 1, 4, "EW_ATTRIB"),
        (14, 1, -1, "EW_ATTRIB"),
        pytest.param(4, 0x40, 0, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig4.cdata.bit6")),
        pytest.param(4, 0x81, 0, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig4.cdata.bit7")),
        pytest.param(12, 0x41, 0, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig12.cdata.bit6")),
        pytest.param(12, 0x80, 0, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig12.cdata.bit7")),
        pytest.param(9, 0x11, 0, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig9.bits7_4")),
        pytest.param(9, 0x84, 0, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig9.bits7_4")),
        (9, 6, 0, "EW_DATA"),
        *(pytest.param(14, 1 << bit, 1, "EW_DATA", marks=pytest.mark.covers("fanuc.cnc_opdi.sig14.zero_bits"))
          for bit in (1, 2, 4, 5, 6, 7)),
        (1, 2, 0, "EW_DATA"),
        (15, 3, 0, "EW_DATA"),
    ],
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_opdi")
@pytest.mark.covers("fanuc.cnc_opdi.sig13.axis", "fanuc.cnc_opdi.sig14.axis")
def test_an_operation_signal_is_refused(number: int, value: int, axis: int, code: str) -> None:
    control, library, handle = started()
    before = control.pmc.read("G", 0, 255)
    assert give(library, handle, number, value, axis) is EW[code]
    assert (control.pmc.read("G", 0, 255), state(control)) == (before, RunState.ACTIVE)


@pytest.mark.covers("fanuc.cnc_finstate", "fanuc.cnc_setfin")
@pytest.mark.covers(
    "fanuc.cnc_opdi.err.EW_BUSY", "fanuc.cnc_exebufstat.err.EW_BUSY", "fanuc.cnc_finstate.err.EW_BUSY",
    "fanuc.cnc_setfin.err.EW_BUSY",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_exebufstat", "fanuc.cnc_opdi")
@pytest.mark.covers("fanuc.concept.program_busy_conditions")
@pytest.mark.covers("fanuc.cnc_wropnlgnrl")
def test_a_busy_control_is_asked_again() -> None:
    control, library, handle = started()
    library.cnc_wropnlgnrl(handle, fwlib.IODBGNRL(type=1, sgnal=1))
    control.axis_motion.state.finished[0] = True
    library.nodes[0].fault = EW.EW_BUSY
    fin = fwlib.ODBFIN(cdata=[1] * 8)
    answers = [
        give(library, handle, 2, 0),
        library.cnc_exebufstat(handle)[0],
        library.cnc_finstate(handle)[0],
        library.cnc_setfin(handle, fin),
    ]
    assert answers == [EW.EW_BUSY] * 4
    assert (state(control), control.axis_motion.state.finished[0]) == (RunState.ACTIVE, True)
    library.nodes[0].fault = EW.EW_OK
    assert [library.cnc_finstate(handle)[1].cdata[0], library.cnc_setfin(handle, fin)] == [1, EW.EW_OK]
    assert (give(library, handle, 2, 0), state(control)) == (EW.EW_OK, RunState.HOLD)


@pytest.mark.covers("fanuc.cnc_finstate")
@pytest.mark.covers("fanuc.cnc_incpoint")
def test_a_snapshot_holds_signals_buffers_and_memory() -> None:
    control = PowerMate()
    library, handle = at(control)
    library.cnc_incpoint(handle, 2, 1, 1, 1200, idb((1, 4000)))
    give(library, handle, 10, 70)
    control.pmc.write("R", 12, b"\x37")
    control.advance(100)
    there, before = control.snapshot(), machine(control)
    control.reset()
    give(library, handle, 10, 30)
    control.pmc.write("R", 12, b"\x11")
    control.advance(50)
    control.restore(there)
    assert (machine(control), control.pmc.read("R", 12, 12), control.signals.feed_override) == (
        before,
        b"\x37",
        70,
    )
    assert buffers(library, handle)[0][1] == 2
    control.advance(3000)
    assert (machine(control)[0], library.cnc_finstate(handle)[1].cdata[1]) == (4000, 2)
