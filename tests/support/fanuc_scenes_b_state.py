"""Scenes of what a control tells of itself: state, alarms, modal and diagnosis data, figures, servos, messages."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from polycnc.cnc import Answer, Function
from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.data._configuration import (
    DRAM_MODULES,
    FROM_MODULES,
    PMC_MODULES,
    SRAM_MODULES,
    SUB_BOARDS,
    Configuration,
)
from support.fanuc_scenes_b import Bench, opdi, short

MODULES = {
    "from_module": FROM_MODULES, "dram_module": DRAM_MODULES, "sram_module": SRAM_MODULES, "pmc_module": PMC_MODULES,
    "sub_board": SUB_BOARDS,
}  # fmt: skip
MODES = ("MDI", "MEM", "EDIT", "HND", "JOG", "T-JOG", "T-HND", "INC", "REF", "RMT")
ENDS = (
    1, 2, 3, 99, 100, 101, 102, 299, 300, 399, 400, 499, 500, 599, 600, 699, 700, 749, 750, 999, 1000, 1999, 2000, 4999,
    5000, 5999, 0,
)  # fmt: skip
"""Numbers of alarms at the ends of their groups, and beside them."""


def configurations(b: Bench) -> None:
    """What a control is: model, axes, software, and each module that it can have, alone."""
    for model, most in (("H", 6), ("D", 2)):
        for axes in range(1, most + 1):
            b.fresh(model=model, axes=axes)
            b.ask("cnc_sysinfo")
            b.ask("cnc_sysconfig")
    texts = {"servo": "90B0A1Z9", "pmc": "4066XY", "ladder": "LADR12", "macro_executor": "BX0103"}
    changes: list[dict[str, Any]] = [{name: module} for name, table in MODULES.items() for module in table]
    changes += [{each.name: False} for each in fields(Configuration) if each.type == "bool"]
    changes += [{name: text} for name, text in texts.items()]
    for change in changes:
        b.control.configuration = replace(Configuration(), **change)
        b.lines.append(f"* {change}")
        b.ask("cnc_sysconfig")


def figures(b: Bench) -> None:
    """Digits and decimals in each increment system, in mm, inch and degree, of a program and of the machine."""
    machines: tuple[dict[str, Any], ...] = (
        *({"increment": each, "inch_input": to, "inch_output": of, "axes": 3, "rotary": (2,)}
          for each in ("IS-A", "IS-B", "IS-C") for to in (False, True) for of in (False, True)),
        {"model": "D"}, {"model": "D", "increment": "IS-C", "axes": 1}, {"axes": 6, "rotary": (6, 1)},
        {"axes": 6, "rotary": (3, 5), "inch_input": True}, {"axes": 5, "rotary": (2,), "inch_output": True},
    )  # fmt: skip
    for machine in machines:
        b.fresh(**machine)
        for kind in range(3):
            b.ask("cnc_getfigure", kind)
    for kind in (-1, 3, 32767):
        b.ask("cnc_getfigure", kind)
    b.title("a program changes the unit; the machine keeps its own")
    b.fresh(axes=3, rotary=(3,))
    for unit in ("G20", "G21"):
        b.program(70 + int(unit[1:]), f"{unit} G90 G1 X0.25 F20.\nM30")
        b.run(900)
        for kind in range(3):
            b.ask("cnc_getfigure", kind)


def states(b: Bench) -> None:
    """Modes, run states, motions, functions, stops, alarms, battery, editing: each beside the others."""
    waits = {(Function.M, 77): Answer(after_s=None), (Function.T, 4): Answer(after_s=0.02)}
    b.fresh(script=waits)
    for mode in MODES:
        b.act("select_mode", mode)
    for machine_state in ("idle", "reset signal", "emergency", "emergency and reset", "battery", "alarm"):
        b.title(machine_state)
        signals = b.control.signals
        if machine_state.endswith("reset"):
            b.control.emergency_stop()
        if "reset" in machine_state:
            signals.give_bits(8, 0x80, 0x80)
        elif machine_state == "emergency":
            b.control.emergency_stop()
        elif machine_state == "battery":
            signals.state.battery_low = True
        elif machine_state == "alarm":
            b.control.raise_alarm(1005, "LUBRICATION")
        b.look()
        for mode in ("JOG", "REF", "MEM"):
            b.act("select_mode", mode)
        text = "N1 M77\nN2 T4\nN3 G4 X0.05\nN4 G1 X1. F600\nN5 M0\nN6 M1\nN7 X0\nN8 M30"
        b.control.programs.register(81, f"O0081\n{text}\n")
        b.act("select_program", 81)
        b.act("optional_stop", True)
        b.act("cycle_start")
        b.run(8)
        b.put("G", 4, 8)
        b.put("G", 4, 0)
        for cycles in (8, 12, 30, 60, 200):
            b.run(cycles)
        for _ in range(3):
            b.act("cycle_start")
            b.run(20)
            b.act("feed_hold")
            b.run(60)
            b.act("cycle_start")
            b.run(200)
        b.act("reset")
        signals.give_bits(8, 0x80, 0)
        b.control.emergency_stop(False)
        signals.state.battery_low = False
        b.run(5)
        b.control.reset()
        b.run(5)
    b.title("an alarm, and a battery that is low, while a program stands or moves")
    b.program(82, "N1 G1 X-9. F600\nN2 M30")
    b.run(40)
    b.control.signals.state.battery_low = True
    b.look()
    b.act("raise_alarm", 2, "P/S")
    b.run(200)
    b.act("reset")
    b.control.signals.state.battery_low = False
    b.look()
    b.title("external reset beside an alarm that no reset takes away, beside a low battery")
    b.control.signals.give_bits(8, 0x80, 0x80)
    b.look()
    b.control.signals.state.battery_low = True
    b.act("raise_alarm", 101)
    b.control.emergency_stop()
    b.look()
    b.control.emergency_stop(False)
    b.act("power_cycle")
    b.control.signals.state.battery_low = False
    b.title("editing")
    edit = b.control.control.edit("O0082", background=True)
    b.look()
    edit.close()
    b.look()
    b.ask("cnc_upstart", 82)
    b.look()
    b.ask("cnc_upload", 20)
    b.look()
    b.ask("cnc_upend")
    b.look()
    b.ask("cnc_dwnstart")
    b.look()
    b.ask("cnc_download", b"LABEL", 5)
    b.look()
    b.ask("cnc_download", b"\nO0083\nG1X1.\n", 13)
    b.look()
    b.ask("cnc_download", b"%", 1)
    b.ask("cnc_dwnend")
    b.look()
    b.act("start_compare")
    assert b.control.transfer is not None
    b.control.transfer.take(b"\nO0083\n")
    b.look()
    b.act("reset")
    b.ask("cnc_dwnend")
    b.look()


def alarm_info(b: Bench, kind: int, chosen: int, length: int) -> None:
    """Read alarms, and write down axis, number and text of each as they lie in memory."""
    found = b.library.cnc_rdalminfo(b.handle, kind, chosen, length)
    code, made = found if isinstance(found, tuple) else (found, None)
    shown = []
    if made is not None and code == 0:
        data, size = bytes(made.pack())[:length], (4, 38)[kind]
        for at in range(0, length - 2, size):
            axis, number = (int.from_bytes(data[at + k : at + k + 2], "little", signed=True) for k in (0, 2))
            text = (
                f" {int.from_bytes(data[at + 4 : at + 6], 'little')} {data[at + 6 : at + 38]!r}"
                if kind
                else ""
            )
            shown.append(f"{axis}:{number}{text}")
        shown.append(data[-2:].hex())
    b.lines.append(f"alarms {kind} {chosen} in {length} {fwlib.EW(code).name} {', '.join(shown)}".rstrip())


def alarms(b: Bench) -> None:
    """Alarms at the ends of each group, of no axis, the first and the last; formats, selections, rooms."""
    b.title("each number alone")
    for number in ENDS:
        b.fresh(axes=3)
        b.act("raise_alarm", number, f"TEXT OF {number}", axis=None if number % 2 else 1 + number % 3)
        for kind, size in ((0, 4), (1, 38)):
            alarm_info(b, kind, -1, size + 2)
        b.ask("cnc_clearophis", 0)
        b.act("reset")
        b.histories()
    b.title("many at once: every group alone, all but one, room for some")
    b.fresh(axes=6)
    texts = ("", "A", "B" * 31, "C" * 32, "D" * 33, "Ä€ß", "LOW  AIR ")
    for k, number in enumerate((100, 101, 7, 503, 744, 409, 350, 5010, 1003)):
        b.control.raise_alarm(number, texts[k % 7], axis=(None, 6, 1, 4)[k % 4])
    b.look()
    for bit in range(16):
        for chosen in (1 << bit, 0xFFFF & ~(1 << bit)):
            for kind, size in ((0, 4), (1, 38)):
                alarm_info(b, kind, short(chosen), size * (9 if chosen > 0x8000 else 2) + 2)
    for kind, size in ((0, 4), (1, 38)):
        for count in (1, 8, 9, 10, 20):
            alarm_info(b, kind, -1, size * count + 2)
        for length in (0, -1, 2, size + 1, size + 3, size * 3, size * 2 + 2):
            alarm_info(b, kind, 1, length)
    for kind in (-1, 2, 0):
        alarm_info(b, kind, 0, 6)
    for chosen in (0, 0x80, 0x200, 0x7800, short(0xFFFF & ~0x857F)):
        alarm_info(b, 0, chosen, 6)
    b.act("reset")
    b.act("power_cycle")
    b.histories()


def real_alarms(b: Bench) -> None:
    """Alarms that a machine and its programs bring themselves, and what takes them away."""
    for check in (0, 0x80):
        b.fresh(axes=3)
        b.parameters(1301, check)
        b.parameters(1320, 9000, 8000, 7000)
        b.parameters(1321, -9500, -8500, -7500)
        for axis, word in enumerate(("X20.", "Y-20.", "Z20.", "X-20.", "Y20.", "Z-20."), 1):
            b.program(90 + axis, f"G1 {word} F12000\nM30")
            b.run(800)
            b.act("reset")
            b.run(100)
        for bits, address in ((1, 100), (2, 102), (4, 100)):
            b.act("select_mode", "JOG")
            b.put("G", address, bits, cycles=900)
            b.put("G", address, 0, cycles=50)
            b.act("reset")
    b.title("programs: words, macros, messages; parameters; names")
    b.fresh(axes=3)
    texts = [
        "G1 X1.", "G999", "#3000=5(CLAMP OPEN)", "#1=1/0", "M98 P7777", "G1 X[", "#3006=7(LOOK)\nG4 X0.01", "GOTO 99",
    ]  # fmt: skip
    for number, text in enumerate(texts, 101):
        b.program(number, f"{text}\nM30")
        b.run(60)
        b.act("reset")
    b.parameters(1006, 1, 0, 0)
    b.act("reset")
    b.act("power_cycle")
    b.title("a position loop that lags too far, of each axis")
    for axis in (1, 3):
        b.fresh(axes=3, servo=True)
        b.control.parameters.set(1828, 60, axis)
        b.program(110 + axis, f"G1 {'XYZ'[axis - 1]}9. F9000\nM30")
        b.run(300)
        b.act("reset")
        b.run(300)
    b.histories()


PROGRAM = """G21 G17 G90 G94 G49 G67
N1 G0 X1. Y-2.5 Z3
N20 G1 X-4.75 F1200
N300 G18 G2 X4. Z9. R8.5 F80.5
G91 G1 Y.5
N4000 G90 G19 G3 Y-1. Z7. J-1.5 K-2.
G1 M3 S450 T7 D4
M8
G43 H3 Z12.
/N5 G44 H4 Z11.
G49 Z10. (G20 X7.)
G95 F0.25 Y1.
G4 P30
G94 M98 P131 L2
G17 X[2*3] F600. M9
#1=7.5
G20 X.1 F10.
G21 Y2. A-6. U8. V-9.125
G66 P131 A2.
X1.
G67 Y0
N99999 M5
G91 M30
B5 E3. Q-4. C7 W10. I-1.5 L9 D8 R-2. K.5 P77 O9
G44 G95 G2 G19 G20 A-6. C7 U8. V9 W10 X-0 F12.345 M11 M12 M13 S2 T3 H4 J-.25"""


def modal(b: Bench) -> None:
    """Every block of a program with all groups and addresses, as it is executed and from both blocks before it."""
    b.wide, b.letters = True, ""
    b.fresh(axes=6, rotary=(6,))
    b.control.tool_offsets.set_all({3: 1500, 4: -2500})
    b.parameters(3030, 2)
    b.control.programs.register(131, "O0131\nN7 G91 X.25 F300\nM99\n")
    b.program(130, PROGRAM, start=False)
    b.control.control.set_switches(single_block=True)
    for _ in range(32):
        b.act("cycle_start")
        b.run(2)
        b.run(15000)
    b.act("reset")
    b.title("one at a time, within a block")
    b.control.control.set_switches(single_block=False)
    b.act("cycle_start")
    b.control.advance(2200)
    for block in range(3):
        for kind in (*range(21), *range(100, 127), *range(200, 206)):
            found = b.library.cnc_modal(b.handle, kind, block)[1]
            data = bytes(found.pack())
            size = 1 if kind < 21 else 6
            if any(data[4 : 4 + size]):
                b.lines.append(f"block {found.type} type {found.datano}: {data[4 : 4 + size].hex(' ')}")
    for kind in (-4, -5, 21, 22, 99, 127, 199, 206, 32767):
        b.ask("cnc_modal", kind, 0)
    for block in (-1, 3, 100):
        b.ask("cnc_modal", 0, block)
    b.title("in MDI, in inch, after switching on")
    b.act("reset")
    b.run(300)
    b.act("select_mode", "MDI")
    b.act("mdi.put", b"\nO1\nG91 G20 G1 X.5 F20.\nM98 P131\nM30\n%")
    b.act("cycle_start")
    b.run(30)
    b.run(5000)
    b.act("power_cycle")


def diagnosis(b: Bench) -> None:
    """Diagnosis data of each kind, of no axis, one, the last, all; lengths and ranges; at rest and at work."""
    b.wide, b.letters = True, ""
    b.fresh(axes=4, servo=True)
    b.parameters(1420, 15000, 9000, 12000, 6000)
    b.program(141, "N1 S1200 M3\nN2 G1 X9. Y-7. Z-5. F2000\nG4 X0.3\nM30")
    for cycles in (30, 40, 100, 300):
        b.run(cycles)
    signal_of_axes = ((4, 8, 0), (12, 0x0A, 0), (13, 100, 4), (13, 9, 2))
    for number, value, axis in signal_of_axes:
        b.do("cnc_opdi", number, opdi(value, axis))
    b.act("raise_alarm", 417, axis=3)
    b.act("raise_alarm", 411, axis=4)
    b.title("one number: axes and lengths")
    numbers = (
        0,
        1,
        2,
        3,
        4,
        5,
        20,
        30,
        31,
        200,
        201,
        202,
        203,
        204,
        300,
        301,
        302,
        308,
        309,
        400,
        403,
        410,
        411,
        712,
        713,
        -1,
    )
    for number in numbers:
        for axis in (0, 1, 4, 5, 6, 7, -1, -2):
            b.ask("cnc_diagnoss", number, axis, 28)
        for length in (4, 5, 6, 8, 9, 12, 20, 27):
            b.ask("cnc_diagnoss", number, -1, length)
    b.title("ranges")
    for first, last in (
        (0, 0),
        (0, 4),
        (3, 3),
        (3, 20),
        (21, 199),
        (5, 19),
        (20, 31),
        (200, 203),
        (300, 301),
        (202, 202),
        (400, 712),
        (31, 30),
        (-1, 4),
    ):
        for axis in (0, 1, 4, 6, 7, -1, -2):
            for length in (4, 5, 6, 23, 24, 45, 46, 200):
                found = b.library.cnc_diagnosr(b.handle, first, axis, last, length)
                if isinstance(found, tuple) and found[0] == 0:
                    b.lines.append(
                        f"{first}..{last} axis {axis} in {length}: {' '.join(map(str, found[1:4]))} {found[4].hex()}"
                    )
                else:
                    code = found[0] if isinstance(found, tuple) else found
                    b.lines.append(f"{first}..{last} axis {axis} in {length}: {fwlib.EW(code).name}")


def servo_values(b: Bench) -> None:
    """Currents, speeds and loop gains of all axes, in both directions, of an ideal machine and of position loops."""
    for servo in (False, True):
        b.fresh(axes=6, rotary=(6,), servo=servo)
        b.parameters(2086, 1000, 0, 3000, 32767, 1, 500)
        b.parameters(1825, 3000, 1, 9999, 2500, 4000, 5000)
        b.parameters(1420, 9000, 6000, 15000, 3000, 24000, 7200)
        b.act("power_cycle")
        b.program(151, "G0 X-6. Y5. Z9. U-7. V8. A-90.\nG4 X0.1\nG1 X3. Z-2. F4000\nM30")
        for cycles in (20, 30, 60, 60, 200, 900, 900, 300):
            b.run(cycles)
        b.act("cycle_start")
        b.run(40)
        for value, axis in ((128, 0), (3, 1), (255, 3), (0, 4), (1, 6)):
            b.do("cnc_opdi", 13, opdi(value, axis))
        b.do("cnc_opdi", 4, opdi(0x21))
        b.run(40)
        b.act("emergency_stop")
        b.run(400)
        b.act("emergency_stop", False)
        b.act("power_cycle")
    b.fresh(model="D")
    b.ask("cnc_rdcurrent")
    b.ask("cnc_rdsrvspeed")
    b.ask("cnc_rdloopgain")


def messages(b: Bench) -> None:
    """Messages to the operator: numbers, lengths, several at once, options, what takes them away."""
    texts = ("X", "OIL LEVEL LOW", "Y" * 255, "tür Ä")
    for k, number in enumerate((99, 100, 101, 999, 1000, 1999, 2000, 2050, 2099, 2100, 0, 4000)):
        b.fresh()
        b.act("operator_message", number, texts[k % 4])
        b.ask("cnc_rdopmsg", 0, 262)
        b.act("reset")
        b.act("control.messages.withdraw", number)
    b.title("several: the first one is read until it is taken away")
    for number, text in ((2001, "FIRST"), (105, "SECOND"), (106, "THIRD"), (105, "SECOND ANEW")):
        b.act("operator_message", number, text)
    for number in (105, 2001, 106):
        b.act("control.messages.withdraw", number)
    b.act("operator_message", 500, "STAYS")
    b.act("reset")
    b.act("power_cycle")
    b.title("lengths, types, options")
    b.act("operator_message", 501, "HERE")
    for kind, length in (
        (0, 261),
        (0, 262),
        (0, 263),
        (0, 0),
        (0, -1),
        (1, 262),
        (-1, 262),
        (4, 262),
        (4, 100),
    ):
        b.ask("cnc_rdopmsg", kind, length)
    for options in (
        (),
        ("external_message",),
        ("external_data_input",),
        ("external_message", "external_data_input"),
    ):
        b.fresh(options=options)
        b.control.operator_message(501, "HERE")
        b.ask("cnc_rdopmsg", 0, 262)
        b.ask("cnc_rdopmsg", 1, 262)
        b.ask("cnc_rdopmsg", 0, 200)


SCENES = (configurations, figures, states, alarms, real_alarms, modal, diagnosis, servo_values, messages)
