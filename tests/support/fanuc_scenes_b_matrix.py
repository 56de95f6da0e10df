"""Scenes of what is called and given in every state of a control: each function, signal, panel value and command.

States are brought about one by one; arguments differ from state to state, so that every state is seen beside others.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.cnc import Answer, Function
from polycnc.controllers.fanuc import PowerMateMode, fwlib
from support.fanuc_scenes_b import LETTERS, Bench, opdi, panel, plain, positions
from support.fanuc_scenes_b_motion import command, signal

AXES = 4
PROGRAM = """N2 G1 X30. Z-18. F2400
N3 G4 X2.
N4 M77
N5 M0
N6 #100=1/0
N7 M30"""
WAITS = {(Function.M, 77): Answer(after_s=None)}


def _running(b: Bench, cycles: int = 40) -> None:
    b.control.cycle_start()
    b.control.advance(cycles)


def _held(b: Bench) -> None:
    _running(b)
    b.control.feed_hold()
    b.control.advance(60)


def _single(b: Bench) -> None:
    b.control.control.set_switches(single_block=True)
    _running(b, 1500)


def _in(mode: str) -> Callable[[Bench], None]:
    return lambda b: b.control.select_mode(mode)


def _mdi(b: Bench) -> None:
    b.control.select_mode("MDI")
    b.control.mdi.put(b"\nO1\nG91 G1 X9. Y-4. F1200\nM30\n%")
    _running(b)


def _stopped_in_mdi(b: Bench) -> None:
    b.control.control.set_switches(single_block=True)
    _mdi(b)
    b.control.advance(600)


def _program_stop(b: Bench) -> None:
    b.control.programs.register(17, "O0017\nG4 X0.01 M0\nG1 X5. F600\nM30\n")
    b.control.select_program(17)
    _running(b)


def _moved_by_hand(mode: str) -> Callable[[Bench], None]:
    def act(b: Bench) -> None:
        for each in ("JOG", mode):
            b.control.select_mode(each)
            b.control.pmc.write("G", 100, b"\x02")
            b.control.pmc.write("G", 102, b"\x04")
            b.control.advance(25)
            if each != mode:
                b.control.pmc.write("G", 100, b"\0\0\0")
                b.control.advance(60)

    return act


def _direct(b: Bench) -> None:
    b.library.cnc_incpoint(b.handle, 2, 1, 2, 1500, positions((2, 30000), (4, -9000)))
    b.library.cnc_dwell(b.handle, 5, 1, 1, positions((3, 60000)))
    b.control.advance(25)


def _direct_held(b: Bench) -> None:
    _direct(b)
    b.control.feed_hold()
    b.control.advance(60)


def _given(address: int, mask: int, value: int) -> Callable[[Bench], None]:
    return lambda b: b.control.signals.give_bits(address, mask, value)


def _battery(b: Bench) -> None:
    b.control.signals.state.battery_low = True


def _locked(b: Bench) -> None:
    b.control.signals.give_bits(44, 2, 2)
    _running(b)


def _dry_run(b: Bench) -> None:
    b.control.signals.give_bits(46, 0x80, 0x80)
    _running(b)


def _alarm(b: Bench) -> None:
    _running(b)
    b.control.raise_alarm(417, "DETECT", axis=3)
    b.control.advance(40)


def _receiving(b: Bench) -> None:
    b.library.cnc_dwnstart(b.handle)
    b.library.cnc_download(b.handle, b"\nO0009\nG4", 9)


STATES: dict[str, Callable[[Bench], None]] = {
    "at rest": lambda b: None, "a program runs": _running, "a program is held": _held,
    "a dwell": lambda b: _running(b, 1500), "a function waits": lambda b: _running(b, 4500),
    "stopped after a block": _single,
    "MDI runs": _mdi, "stopped in MDI": _stopped_in_mdi, "stopped by M0": _program_stop,
     "jogging": _moved_by_hand("JOG"), "increments": _moved_by_hand("INC"),
    "reference return": _moved_by_hand("REF"), "EDIT": _in("EDIT"), "handle": _in("HND"), "RMT": _in("RMT"),
    "direct commands": _direct, "direct commands are held": _direct_held, "an alarm": _alarm,
    "emergency stop": lambda b: b.control.emergency_stop(), "reset is on": _given(8, 0x80, 0x80),
    "a servo is off": _given(126, 0xF, 5), "hold is on": _given(8, 0x20, 0), "machine lock": _locked,
    "the battery is low": _battery, "dry run": _dry_run, "a program comes in": _receiving,
}  # fmt: skip
BUSY = ("a program runs", "MDI runs", "jogging", "direct commands", "direct commands are held", "dry run")
"""States that most signals end."""
READS: tuple[tuple[Any, ...], ...] = (
    ("cnc_sysinfo",), ("cnc_sysconfig",), ("cnc_getfigure", 0), ("cnc_getfigure", 1), ("cnc_getfigure", 2),
    ("cnc_rdophisno",), ("cnc_rdophistry", 1, 2, 22), ("cnc_rdalmhisno",), ("cnc_rdalmhistry", 1, 1, 54),
    ("cnc_rdhissgnl",), ("cnc_modal", -1, 0), ("cnc_modal", -2, 1), ("cnc_modal", 1, 1), ("cnc_modal", 103, 0),
    ("cnc_modal", 123, 1), ("cnc_modal", 200, 0), ("cnc_modal", 205, 0), ("cnc_diagnoss", 0, 0, 5),
    ("cnc_diagnoss", 300, 2, 8), ("cnc_diagnoss", 301, -1, 28), ("cnc_rdalminfo", 0, 0x20, 10),
    ("cnc_rdalminfo", 1, 4, 40),
    ("cnc_rdopmsg", 0, 262), ("cnc_rdopnlsgnl", 0x1000), ("cnc_rdopnlgnrl", 0x41), ("cnc_rdopnlgsname", 0x22),
    ("pmc_rdpmcrng", 0, 1, 42, 47, 14), ("pmc_rdpmcrng", 1, 0, 0, 11, 20), ("pmc_rdpmcrng", 1, 2, 96, 103, 16),
    ("pmc_rdpmcinfo", 1),
)  # fmt: skip
"""Calls that read, of which a look shows no more than a part."""
FAR = positions((1, 5), (5, 5))
REFUSED: tuple[tuple[Any, ...], ...] = (
    ("cnc_rdophistry", 0, 1, 22), ("cnc_rdophistry", 1, 1, 13), ("cnc_rdalmhistry", 0, 1, 102),
    ("cnc_rdalmhistry", 1, 1, 53),
    ("cnc_clearophis", 2), ("cnc_wrhissgnl", fwlib.IODBSIG(type=21)), ("cnc_opdi", 5, opdi(1)),
    ("cnc_opdi", 2, opdi(2)),
    ("cnc_opdi", 9, opdi(6)), ("cnc_opdi", 4, opdi(0x40)), ("cnc_opdi", 12, opdi(0x80)), ("cnc_opdi", 14, opdi(2, 1)),
    ("cnc_opdi", 13, opdi(9, 5)), ("cnc_opdi", 14, opdi(1, -1)), ("cnc_refpoint", 0, 0, 1), ("cnc_refpoint", 1, 2, 1),
    ("cnc_refpoint", 1, 0, 5), ("cnc_abspoint", 7, 0, 1, 600, FAR), ("cnc_abspoint", 1, -1, 1, 600, FAR),
    ("cnc_abspoint", 1, 0, 2, 600, FAR), ("cnc_abspoint", 1, 0, 1, 0, FAR), ("cnc_incpoint", 2, 0, 1, -1, FAR),
    ("cnc_incpoint", 1, 0, 0, 600, FAR), ("cnc_incpoint", 1, 0, 3, 600, FAR), ("cnc_dwell", 1, 0, 1, positions((1, 0))),
    ("cnc_dwell", 1, 0, 1, positions((1, 100_000_000))), ("cnc_coordre", 1, 0, 1, positions((1, -100_000_000))),
    ("cnc_rdalminfo", 2, -1, 6), ("cnc_rdalminfo", 0, 0x7A80, 6), ("cnc_rdalminfo", 0, -1, 5),
    ("cnc_rdalminfo", 1, -1, 6),
    ("cnc_modal", 21, 0), ("cnc_modal", 99, 0), ("cnc_modal", 206, 0), ("cnc_modal", 0, 3), ("cnc_modal", 0, -1),
    ("cnc_diagnoss", 6, 0, 5), ("cnc_diagnoss", 300, 7, 8), ("cnc_diagnoss", 300, 1, 7), ("cnc_diagnosr", 5, 0, 4, 99),
    ("cnc_diagnosr", 0, -2, 4, 99), ("cnc_diagnosr", 0, 0, 4, 4), ("cnc_getfigure", 3), ("cnc_getfigure", -1),
    ("cnc_rdopmsg", 1, 262), ("cnc_rdopmsg", 0, 261), ("cnc_wropnlsgnl", panel(0x21, mode=6, feed_ovrd=4)),
    ("cnc_wropnlsgnl", panel(0x30, jog_ovrd=25, feed_ovrd=4)),
    ("cnc_wropnlsgnl", panel(0x1008, rpd_ovrd=2, feed_hold=2)),
    ("pmc_rdpmcrng", 10, 0, 0, 0, 9), ("pmc_rdpmcrng", 9, 3, 0, 0, 9), ("pmc_rdpmcrng", 9, 0, 1860, 1860, 9),
    ("pmc_rdpmcrng", 9, 2, 0, 3, 11), ("pmc_wrpmcrng", 9, bytes((1, 0, 0, 0, 5, 0, 5, 0, 7))),
    ("pmc_wrpmcrng", 9, bytes((3, 0, 0, 0, 5, 0, 5, 0, 7))), ("pmc_wrpmcrng", 9, bytes((7, 0, 0, 0, 17, 0, 17, 0, 7))),
    ("pmc_wrpmcrng", 9, bytes((5, 0, 0, 0, 0x28, 0x23, 0x28, 0x23, 7))),
    ("pmc_wrpmcrng", 8, bytes((9, 0, 0, 0, 5, 0, 5, 0, 7))),
    ("pmc_rdpmcinfo", 10), ("pmc_rdpmcinfo", -2),
    ("cnc_incpoint", 1, 0, 3, 600, positions((1, 5), (2, 5), (1, 6))),
    ("cnc_dwell", 1, 0, 4, positions((4, 5), (2, 5), (3, 6), (4, 6))),
    # what is right in the low byte alone
    ("cnc_rdopmsg", 256, 262), ("cnc_rdopmsg", -256, 262), ("cnc_getfigure", 256), ("cnc_rdalminfo", 256, -1, 6),
    ("cnc_clearophis", 256), ("cnc_modal", 256, 0), ("cnc_modal", 0, 256), ("cnc_diagnoss", 256, 0, 5),
    ("cnc_diagnoss", 300, 257, 8), ("cnc_refpoint", 257, 0, 1), ("cnc_refpoint", 1, 256, 1),
    ("cnc_refpoint", 1, 0, 257), ("cnc_incpoint", 1, 0, 257, 600, FAR),
    ("cnc_incpoint", 1, 0, 1, 600, positions((257, 5))),
    ("cnc_opdi", 257, opdi(0)), ("cnc_opdi", 14, opdi(1, 257)), ("pmc_rdpmcrng", 265, 0, 0, 0, 9),
    ("pmc_rdpmcrng", 9, 256, 0, 0, 9), ("pmc_rdpmcinfo", 265), ("cnc_wropnlsgnl", panel(1, mode=256)),
)  # fmt: skip
"""Calls that are refused whatever the state is; some would be refused by it too."""
ENDS = {
    "G": (0, 255),
    "Y": (0, 1063),
    "A": (0, 24),
    "R": (0, 999),
    "T": (0, 79),
    "K": (0, 16),
    "C": (0, 79),
    "D": (0, 1859),
}
"""Addresses that are written in every state."""


def begun(b: Bench, name: str, **machine: Any) -> None:
    """Begin with a control that has something to tell, and bring it into a state."""
    b.fresh(**{"axes": AXES, "rotary": (4,), "script": WAITS} | machine)
    control = b.control
    control.parameters.set(8003, 0x80)
    for axis in range(1, AXES + 1):
        control.parameters.set(8010, 5 - axis, axis)
    control.programs.register(7, f"O0007\n{PROGRAM}\n")
    control.select_mode("MEM")
    control.select_program(7)
    STATES[name](b)
    b.lines.append(f"## {name}")
    b.look()


def reads_in_states(b: Bench) -> None:
    """What each function that reads answers in each state; what is as in the state before is not written again."""
    before: dict[str, str] = {}
    for name in STATES:
        begun(b, name)
        b.control.operator_message(2001, "COOLANT")
        b.control.raise_alarm(1004 + len(b.lines) % 3, "AIR", axis=2) if name == "a program runs" else None
        b.look()
        for each in (*READS, *REFUSED):
            function, *arguments = each
            found = getattr(b.library, function)(b.handle, *arguments)
            code, *values = found if isinstance(found, tuple) else (found,)
            text = f"{function}({', '.join(map(plain, arguments))}) {fwlib.EW(code).name} "
            text += " | ".join(map(plain, values)) if code == 0 else ""
            if before.get(text.partition(")")[0]) != text:
                b.lines.append(text.rstrip())
                before[text.partition(")")[0]] = text
        b.histories()


def areas_in_states(b: Bench) -> None:
    """Bytes at both ends of the areas of the PMC in every third state, read again as words; what outlasts the power."""
    b.letters = LETTERS
    for k, name in list(enumerate(STATES))[::3]:
        begun(b, name)
        for letter, (first, last) in ENDS.items():
            data = bytes(((0x81 + 7 * k + ord(letter)) & 0xFF, (3 * k + 1) & 0xFF))
            low = first + k % 3
            for at, written in ((low, data), (last - k % 2, data[: 1 + k % 2])):
                head = (LETTERS.index(letter), 0, at, at + len(written) - 1)
                block = b"".join(each.to_bytes(2, "little") for each in head) + written
                assert b.library.pmc_wrpmcrng(b.handle, len(block), block) == 0
            b.ask("pmc_rdpmcrng", LETTERS.index(letter), 1, low, low + 1, 10)
        b.control.advance(2)
        b.look()
        b.act(("reset", "power_cycle")[k % 2])


SIGNALS = (
    (10, 30, 120), (13, 51, 204), (12, 0x2A, 0x15), (7, 1, 0), (15, 1, 0), (4, 1, 0), (14, 9, 0), (9, 4, 1), (2, 0, 1),
    (8, 1, 0), (3, 1, 0), (1, 0, 1),
)  # fmt: skip


def signals_in_states(b: Bench) -> None:
    """Each operation signal given and taken back in each state; busy ones are gone back to after each."""
    for k, name in enumerate(STATES):
        begun(b, name)
        here = b.control.snapshot() if name in BUSY else None
        kept, memory = dict(b.kept), dict(b.memory)
        for j in range(len(SIGNALS)):
            number, on, off = SIGNALS[(5 * k + j) % len(SIGNALS)]
            if here is not None:
                b.control.restore(here)
                b.kept, b.memory = dict(kept), dict(memory)
            axis = (k + j) % (AXES + 1) if number in (13, 14) else 0
            signal(b, number, on, axis, cycles=12)
            signal(b, number, off, axis, cycles=12)
    b.title("from each mode to each")
    b.fresh(axes=2)
    for before in PowerMateMode:
        for value in (0, 1, 2, 3, 4, 5, 7):
            b.control.select_mode(before)
            b.look()
            signal(b, 9, value, cycles=0)
    b.title("rapid beside keys, feed overrides of a direct command, the edges of a start in MDI")
    b.fresh(axes=3, increment="IS-A")
    b.control.panel.set({"jog_ovrd": 17})
    for mode in ("JOG", "T-JOG", "INC"):
        b.act("select_mode", mode)
        for bits in (0x30, 0xB0):
            b.control.pmc.write("G", 19, bytes([bits]))
            b.put("G", 100, 5, cycles=24)
            b.put("G", 100, 0, cycles=1200)
    begun(b, "at rest")
    command(b, "incpoint", 1, 0, 2, 3000, positions((1, 400000), (4, -90000)))
    for value in range(21):
        b.control.panel.set({"feed_ovrd": value})
        b.control.advance(60)
        b.look()
    b.act("reset")
    b.run(300)
    b.control.select_mode("MDI")
    b.control.mdi.put(b"\nO1\nG91 G1 X9. Y-4. F1200\nM30\n%")
    for value in (1, 0):
        signal(b, 8, value)
    b.title("external reset beside an alarm in an emergency stop")
    b.act("emergency_stop")
    b.act("raise_alarm", 5, axis=2)
    signal(b, 3, 1)
    signal(b, 3, 0)
    b.title("machine lock in each mode, at rest, before axes are moved by hand")
    for mode in ("JOG", "INC", "REF", "T-JOG"):
        b.fresh(axes=3)
        b.act("select_mode", "JOG")
        b.put("G", 102, 2, cycles=60)
        b.put("G", 102, 0, cycles=60)
        b.act("select_mode", mode)
        for value in (1, 0):
            b.do("cnc_wropnlsgnl", panel(1 << 9, machn_lock=value))
            b.put("G", 100, 2, cycles=30)
            b.put("G", 100, 0, cycles=60)


VALUES = (
    (5, "feed_ovrd", (20, 1, 11, 0, 7)), (3, "rpd_ovrd", (3, 1, 2, 0)), (4, "jog_ovrd", (24, 0, 17, 9, 1)),
    (12, "feed_hold", (1, 0)), (11, "mem_prtct", (1, 0)), (7, "blck_del", (1, 0)), (8, "sngl_blck", (1, 0)),
    (10, "dry_run", (1, 0)), (9, "machn_lock", (1, 0)), (0, "mode", (5, 2, 0, 3, 4, 1)),
)  # fmt: skip


def panel_in_states(b: Bench) -> None:
    """Signals of the panel in each state, each selected alone; another one comes first in each."""
    for k, name in enumerate(STATES):
        begun(b, name)
        for j in range(len(VALUES)):
            bit, member, values = VALUES[(3 * k + j) % len(VALUES)]
            value = values[k % len(values)]
            code = b.library.cnc_wropnlsgnl(b.handle, panel(1 << bit, **{member: value}))
            b.control.advance(7)
            b.lines.append(f"{member} <- {value} {fwlib.EW(code).name}")
            b.look()
        b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(type=1 << k % 8 | 1, sgnal=0xFF))
        b.do(
            "cnc_wropnlgsname",
            fwlib.IODBRDNA(type=1 << k % 8, **{f"sgnl{k % 8 + 1}_name": name.encode()[:8]}),
        )
        b.act("reset")


def commands_in_states(b: Bench) -> None:
    """Each direct command, flags, the buffers and what the histories take, in each state, on other paths and axes."""
    for k, name in enumerate(STATES):
        begun(b, name)
        path, axis, flag = 1 + k % 6, 1 + k % AXES, k % 2
        other = 1 + (axis + 1) % AXES
        command(b, "incpoint", path, flag, 2, 900 + k, positions((axis, -40 - k), (other, 25)))
        b.control.advance(9)
        command(b, "coordre", 1 + path % 6, 1, 1, positions((axis, 1000 + k)))
        command(b, "dwell", path, 1 - flag, 1, positions((other, 7 + k)))
        command(b, "abspoint", path, flag, 1, 1200, positions((axis, 300 - k)))
        command(b, "refpoint", 1 + (path + 1) % 6, flag, other)
        b.run(6)
        b.run(80)
        b.do(
            "cnc_setfin", fwlib.ODBFIN(cdata=[1 << path - 1 if each == path - 1 else 0 for each in range(8)])
        )
        b.put("D", 11 * k, 0x80 + k, k)
        b.put("G", 43 + 3 * (k % 2), 0x8D ^ k)
        b.do("cnc_opdi", 10, opdi(10 * k + 3))
        b.histories()
        b.act(
            "raise_alarm", (5, 102, 300, 401, 504, 701, 749, 1002, 5000)[k % 9], axis=axis if flag else None
        )
        b.histories()
        b.ask("cnc_clearophis", flag)
        b.histories()
        b.act("reset")


SCENES = (reads_in_states, areas_in_states, signals_in_states, panel_in_states, commands_in_states)
