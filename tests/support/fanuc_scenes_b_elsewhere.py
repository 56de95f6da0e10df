"""Scenes of modal data, figures and configurations on other machines, in other units and states."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from polycnc.controllers.fanuc.data._configuration import Configuration
from support.fanuc_scenes_b import Bench
from support.fanuc_scenes_b_matrix import begun

BLOCKS = """N1 G20 G91 G94 G17 F1.5
N2 G1 X.1 Y-.02 S77 M4
N3 G3 X.02 Y.02 R.02 F2. T55 H2 D1
G2 X-.02 Y-.02 I-.02 J0 M11
G18 G1 G95 F.002 X-0.01
G90 G43 H1 X0 Y0 M7 M12 M13
G49 G19 G4 X.05
/N9998 G44 H2 G1 Y-.03
G21 G94 F500. X-1.25 S33 M5
g91 g0 x.5 y-.25 m8
#2=G
G67
N7 G66 P132 A-1.5 I2. J3.
X-.5
G67
M98 P132 L1
G49 Q3 P8 L7 B.5 E7 K3. C12
M30"""
MACHINES: tuple[dict[str, Any], ...] = (
    {"model": "D", "increment": "IS-C"},
    {"axes": 4, "increment": "IS-A"},
    {"axes": 3, "inch_input": True, "inch_output": True},
)


def modal_elsewhere(b: Bench) -> None:
    """Modal data of other machines: by single blocks, held within a block, in an alarm, after an end, in MDI."""
    b.wide, b.letters = True, ""
    for machine in MACHINES:
        b.fresh(**machine)
        b.parameters(3030, (8, 1, 5)[MACHINES.index(machine)])
        b.control.tool_offsets.set_all({1: 120, 2: -340})
        b.control.programs.register(132, "O0132\nN55 G90 X.1 F300\nM99\n")
        b.control.control.set_switches(single_block=True, block_delete=frozenset({1}))
        b.program(133, BLOCKS.replace("#2=G\n", "#2=3\n"), start=False)
        for _ in BLOCKS.splitlines():
            if b.control.status().channel.run_state.value == "alarm":
                break
            b.act("cycle_start")
            b.control.advance(9)
            b.look()
            b.control.advance(20000)
    b.title("held, in an alarm, after it, in MDI after a program, in other modes")
    b.fresh(axes=3)
    b.program(134, "N3 G20 G18 G1 X1. F90.\nN4 G95 Z.5 F.01\nN5 M30")
    b.run(300)
    for act, arguments in (
        ("feed_hold", ()), ("select_mode", ("JOG",)), ("select_mode", ("MEM",)), ("cycle_start", ()),
        ("raise_alarm", (1003,)), ("reset", ()), ("select_mode", ("EDIT",)), ("select_mode", ("MDI",)),
    ):  # fmt: skip
        b.act(act, *arguments)
        b.run(120)
    b.act("mdi.put", b"\nO1\nN8 G19 G21 Y2. S5 T3\nN9 M99\n%")
    b.act("cycle_start")
    b.run(40)
    b.act("emergency_stop")
    b.run(40)
    b.act("emergency_stop", False)
    b.act("power_cycle")


def figures_elsewhere(b: Bench) -> None:
    """Figures while parameters of units and increments change, and when the power comes on after it."""
    for axes, rotary in ((2, ()), (4, (1, 4))):
        for number, values in ((0, (4, 0)), (1001, (1, 0)), (1004, (1, 2, 0))):
            b.fresh(axes=axes, rotary=rotary)
            for value in values:
                b.parameters(number, value)
                for act in ("", "reset", "power_cycle"):
                    if act:
                        b.act(act)
                    for kind in range(3):
                        b.ask("cnc_getfigure", kind)
    b.title("inch by a program, while it runs, in alarm, after its end")
    b.fresh(axes=2, increment="IS-C", rotary=(2,))
    b.program(73, "G20 G91 G1 X.01 Y3. F1000.\nG21 X1.\nG20 G4 X9.\nM30")
    for act in ("", "feed_hold", "reset", "select_mode", "power_cycle"):
        b.run(60)
        if act:
            b.act(act, *(("MDI",) if act == "select_mode" else ()))
        for kind in range(3):
            b.ask("cnc_getfigure", kind)


def _with(configuration: Configuration, modules: list[str], there: bool) -> Configuration:
    changes: dict[str, Any] = dict.fromkeys(modules, there)
    return replace(configuration, **changes)


def configurations_elsewhere(b: Bench) -> None:
    """Modules that are all there, and none; of few and of all axes, of both models, and while something happens."""
    modules = [each.name for each in fields(Configuration) if each.type == "bool"]
    for machine in ({"axes": 6}, {"axes": 1}, {"axes": 3, "increment": "IS-C"}, {"model": "D", "axes": 2}):
        b.fresh(**machine)
        for there in (False, True):
            made = _with(Configuration(), modules, there)
            b.control.configuration = made
            b.ask("cnc_sysconfig")
            for name in modules:
                b.control.configuration = _with(made, [name], not there)
                b.ask("cnc_sysconfig")
        b.control.configuration = Configuration(
            "2 MB",
            "2.5 MB",
            "768 KB",
            "PMP module",
            "M-NET",
            False,
            True,
            False,
            "90A1B2C3",
            "4077AB",
            "LADDER",
            "MACRO1",
        )
        b.ask("cnc_sysconfig")
        b.act("emergency_stop")
        b.ask("cnc_sysinfo")
        b.act("power_cycle")
        b.ask("cnc_sysinfo")
        b.ask("cnc_sysconfig")


def diagnosis_elsewhere(b: Bench) -> None:
    """Servo alarms of each axis alone and beside others, far positions, a spindle to minus, of other machines."""
    b.letters = ""
    b.fresh(axes=6, rotary=(6,))
    for number in (411, 417):
        for axis in range(1, 7):
            b.act("raise_alarm", number, axis=axis)
            if axis % 3 == 0:
                b.act("reset")
    for axis in (0, 1, 2, 5, 6):
        b.ask("cnc_diagnoss", 301, axis, 28)
    b.program(151, "G0 X-990. Y880. Z-1234. A-900.\nM4 S650\nG1 U-1.5 V2. F300\nM5\nM30")
    for cycles in (5000, 9000, 9000, 20000):
        b.run(cycles)
        for number in (201, 300, 301, 411):
            b.ask("cnc_diagnoss", number, -1, 28)
    for machine in (
        {"model": "D", "inch_output": True},
        {"axes": 4, "increment": "IS-C", "inch_input": True},
    ):
        b.fresh(**machine)
        b.program(152, "G20 G91 G0 X-1.5 Y2.25\nG1 X-.1 F2.\nM30")
        for cycles in (300, 3000, 3000):
            b.run(cycles)
            for axis in (-1, 1, 2):
                b.ask("cnc_diagnoss", 301, axis, 28)
                b.ask("cnc_diagnosr", 200, axis, 301, 200)


def editing_elsewhere(b: Bench) -> None:
    """Editing, sending, receiving and comparing beside an alarm, an emergency stop, a program, other modes."""
    for name in (
        "an alarm",
        "emergency stop",
        "a program runs",
        "a program is held",
        "jogging",
        "EDIT",
        "the battery is low",
    ):
        begun(b, name)
        b.control.programs.register(8, "O0008\nM30\n")
        edit = b.control.control.edit("O0008", background=True)
        b.look()
        b.act("reset")
        edit.close()
        b.look()
        for function, arguments in (
            ("cnc_upstart", (8,)), ("cnc_upload", (9,)), ("cnc_upend", ()), ("cnc_dwnstart", ()),
            ("cnc_download", (b"\nO0009\nM30\n", 11)), ("cnc_download", (b"%", 1)), ("cnc_dwnend", ()),
        ):  # fmt: skip
            b.do(function, *arguments)
        b.act("start_compare")
        b.act("raise_alarm", 3)
        b.act("feed_hold")
        b.do("cnc_dwnend")


SCENES = (
    diagnosis_elsewhere,
    editing_elsewhere,
    modal_elsewhere,
    figures_elsewhere,
    configurations_elsewhere,
)
