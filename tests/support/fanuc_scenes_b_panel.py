"""Scenes of the software operator's panel and of the PMC (Manual 000, cnc_rdopnlsgnl to pmc_rdpmcinfo)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.cnc import Answer, Function
from polycnc.controllers.fanuc import fwlib
from support.fanuc_scenes_b import AREAS, LETTERS, Bench, panel, plain, short

MEMBERS = {
    0: ("mode", 5), 3: ("rpd_ovrd", 3), 4: ("jog_ovrd", 24), 5: ("feed_ovrd", 20), 7: ("blck_del", 1),
    8: ("sngl_blck", 1), 9: ("machn_lock", 1), 10: ("dry_run", 1), 11: ("mem_prtct", 1), 12: ("feed_hold", 1),
}  # fmt: skip
"""Signals by their bit in the selection, with their largest value (Manual 000, cnc_wropnlsgnl)."""
USED = 0x1FB9
NAMES = [f"sgnl{k}_name" for k in range(1, 9)]
WHOLE = 0xFFFF


def shown(b: Bench) -> None:
    """Everything that can be read when the power comes on, of either model."""
    for machine in ({"axes": 3}, {"model": "D"}):
        b.fresh(**machine)
        b.kept, b.memory = {}, {}
        b.look()


def panel_values(b: Bench) -> None:
    """Each value of each signal alone, beside others that are not selected; both ends and beyond."""
    junk = {name: 1 for name, _ in MEMBERS.values()}
    spare = {"datano": 77, "hndl_ax": 5, "hndl_mv": 6, "spdl_ovrd": 7}
    for bit, (name, most) in MEMBERS.items():
        b.title(f"{name}, bit {bit}")
        for value in (*range(most, -1, -1), -1, most + 1, 32767, -32768):
            chosen = panel(1 << bit | ~USED & WHOLE, **{**junk, **spare, name: value})
            code = b.library.cnc_wropnlsgnl(b.handle, chosen)
            b.lines.append(f"{name} <- {value} {fwlib.EW(code).name}")
            b.look()
    b.title("what is there when the power comes on again, and after a reset")
    first = {"mode": 4, "rpd_ovrd": 2, "jog_ovrd": 23, "feed_ovrd": 13, "blck_del": 1, "sngl_blck": 0}
    second = {"machn_lock": 1, "dry_run": 0, "mem_prtct": 1, "feed_hold": 1}
    b.do("cnc_wropnlsgnl", panel(USED, **first, **second))
    b.act("reset")
    b.act("power_cycle")
    b.again()
    b.title("each bit read alone, and all but one")
    for bit in range(16):
        b.ask("cnc_rdopnlsgnl", short(1 << bit))
        b.ask("cnc_rdopnlsgnl", short(WHOLE & ~(1 << bit)))
    b.ask("cnc_rdopnlsgnl", 0)
    b.title("all but one are written, to and fro")
    others = {name: most - (first | second)[name] for name, most in MEMBERS.values()}
    for k, bit in enumerate(MEMBERS):
        b.do("cnc_wropnlsgnl", panel(USED & ~(1 << bit), **(first | second if k % 2 else others)))
    for values in (others, first | second):
        b.do("cnc_wropnlsgnl", panel(USED, **values))
        b.act("power_cycle")
        b.again()
    b.title("one that is wrong among all: nothing is written")
    for name, most in MEMBERS.values():
        b.do("cnc_wropnlsgnl", panel(USED, **{**others, **first, **second, name: most + 1}))
    b.do("cnc_wropnlsgnl", panel(0, **others))


def panel_general(b: Bench) -> None:
    """General-purpose signals and their names: each alone, all but one, at the length of a name."""
    b.title("signals: each alone, all but one")
    for bit in range(16):
        for chosen in (1 << bit, WHOLE & ~(1 << bit)):
            b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(datano=9, type=short(chosen), sgnal=0xFF))
            b.ask("cnc_rdopnlgnrl", short(chosen))
            b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(type=short(chosen), sgnal=1 << bit & 0xFF))
            b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(type=0xFF, sgnal=0xA5))
            b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(type=short(chosen), sgnal=0x5A))
            b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(type=0xFF, sgnal=0x5A))
    b.title("names: each alone, all but one")
    texts = [f"{'ABCDEFGH'[k]}{'=' * k}".encode() for k in range(8)]
    b.do("cnc_wropnlgsname", fwlib.IODBRDNA(type=0xFF, **dict(zip(NAMES, texts, strict=True))))
    for bit in range(16):
        b.ask("cnc_rdopnlgsname", short(1 << bit))
        b.ask("cnc_rdopnlgsname", short(WHOLE & ~(1 << bit)))
    for bit in range(16):
        new = {name: f"NEW {bit} {k}".encode() for k, name in enumerate(NAMES)}
        b.do("cnc_wropnlgsname", fwlib.IODBRDNA(datano=3, type=short(1 << bit), **new))
        b.do("cnc_wropnlgsname", fwlib.IODBRDNA(type=short(WHOLE & ~(1 << bit)), **new))
    b.title("lengths and characters of a name")
    for k, text in enumerate(
        (b"", b"X", b"12345678", b"123456789", b"A B  C", b"\xb1\xb2\xff", b"a\0b", b" lead")
    ):
        b.do("cnc_wropnlgsname", fwlib.IODBRDNA(type=0xFF, **{NAMES[k]: text}))
    for first in range(0x20, 0x100, 64):
        every = bytes(range(first, min(first + 64, 0x100))).ljust(64)
        named = {name: every[8 * k : 8 * k + 8] for k, name in enumerate(NAMES)}
        b.do("cnc_wropnlgsname", fwlib.IODBRDNA(type=0xFF, **named))
    b.do("cnc_wropnlgsname", fwlib.IODBRDNA(type=0x100, sgnl1_name=b"NOTHING"))
    b.do("cnc_wropnlgnrl", fwlib.IODBGNRL(type=0xFF, sgnal=0xA6))
    b.do("cnc_wropnlgsname", fwlib.IODBRDNA(type=0x81, sgnl1_name=b"COOLANT", sgnl8_name=b"CHIPS ON"))
    for name in ("reset", "power_cycle"):
        b.act(name)
    b.again()


def panel_at_work(b: Bench) -> None:
    """What the panel does to programs, jogging, reference return and the program memory."""
    b.parameters(1420, 9000, 6000, 4800)
    b.parameters(1421, 540, 300, 240)
    b.parameters(1423, 6000, 3000, 1200)
    text = "N1 G0 X60. Z-30.\nN2 G1 X2. F900\n/N3 Y-4.\nN4 M30"
    b.program(21, text, start=False)
    for name, values in (("rpd_ovrd", (3, 2, 1, 0)), ("feed_ovrd", (20, 1, 0, 10)), ("dry_run", (1, 0))):
        bit = next(bit for bit, (member, _) in MEMBERS.items() if member == name)
        for value in values:
            b.title(f"{name} {value}")
            b.act("cycle_start")
            b.run(400)
            b.do("cnc_wropnlsgnl", panel(1 << bit, **{name: value}))
            b.run(4)
            b.run(60)
            b.run(2000)
            b.control.reset()
            b.run(300)
    b.title("F0 follows both of its parameters")
    b.do("cnc_wropnlsgnl", panel(8, rpd_ovrd=3))
    b.act("cycle_start")
    b.run(200)
    for number, axes in ((1421, (1080, 300, 240)), (1420, (6000, 6000, 4800)), (1421, (9000, 300, 240))):
        b.parameters(number, *axes)
        b.run(200)
    b.do("cnc_wropnlsgnl", panel(8, rpd_ovrd=0))
    b.control.reset()
    b.run(600)
    b.parameters(1420, 9000, 6000, 4800)
    b.parameters(1421, 540, 300, 240)
    for bit, name in (
        (7, "blck_del"),
        (8, "sngl_blck"),
        (9, "machn_lock"),
        (12, "feed_hold"),
        (11, "mem_prtct"),
    ):
        b.title(name)
        for value in (1, 0):
            b.do("cnc_wropnlsgnl", panel(1 << bit, **{name: value}))
            b.act("cycle_start")
            b.run(40)
            b.do("cnc_wropnlsgnl", panel(1 << bit, **{name: 1 - value}))
            b.run(40)
            b.do("cnc_wropnlsgnl", panel(1 << bit, **{name: value}))
            b.act("cycle_start")
            b.run(9000)
            b.ask("cnc_dwnstart")
            b.ask("cnc_dwnend")
            b.control.reset()
            b.run(300)
    b.title("jogging: a key of the second axis, and of the third to minus, at every override")
    b.do("cnc_wropnlsgnl", panel(1, mode=4))
    b.put("G", 100, 2)
    b.put("G", 102, 4)
    for value in range(25):
        b.control.panel.set({"jog_ovrd": value})
        b.run(150)
    for manual in ("T-JOG", "INC"):
        b.act("select_mode", manual)
        for address, bits in ((100, 0), (102, 0), (100, 2), (102, 4)):
            b.control.pmc.write("G", address, bytes([bits]))
        for value in range(24, -1, -1):
            b.control.panel.set({"jog_ovrd": value})
            b.control.advance(40)
            b.look()
    b.act("select_mode", "JOG")
    b.title("modes while a program runs, and when axes are jogged")
    for mode in (1, 5, 3, 0, 2, 4):
        b.do("cnc_wropnlsgnl", panel(1, mode=mode))
        b.run(100)
    b.put("G", 100, 0)
    b.put("G", 102, 0)
    b.run(100)
    for name, mode in (
        ("INC", 3),
        ("HND", 3),
        ("T-HND", 3),
        ("T-JOG", 4),
        ("RMT", 1),
        ("RMT", 0),
        ("INC", 4),
    ):
        b.act("select_mode", name)
        b.do("cnc_wropnlsgnl", panel(1, mode=mode))
    for mode in (0, 2, 3, 4, 5):
        b.do("cnc_wropnlsgnl", panel(1, mode=1))
        b.act("cycle_start")
        b.run(30)
        b.do("cnc_wropnlsgnl", panel(1, mode=mode))
        b.run(100)
        b.control.reset()
        b.run(300)


def given(
    b: Bench, kind: int, data_type: int, first: int, last: int, data: bytes, length: int | None = None
) -> None:
    """Write an area by its numbers, right or wrong, and look."""
    block = (
        b"".join(each.to_bytes(2, "little", signed=True) for each in (kind, data_type, first, last)) + data
    )
    code = b.library.pmc_wrpmcrng(b.handle, len(block) if length is None else length, block)
    size = "" if length is None else f" in {length}"
    b.lines.append(
        f"write {kind} {data_type} {first}..{last} {data[:9].hex(' ')}{size} {fwlib.EW(code).name}"
    )
    b.look()


def read(b: Bench, kind: int, data_type: int, first: int, last: int, length: int | None = None) -> None:
    """Read an area by its numbers, right or wrong, as items of its type."""
    found = b.library.pmc_rdpmcrng(
        b.handle, kind, data_type, first, last, 9 + last - first if length is None else length
    )
    size = "" if length is None else f" in {length}"
    text = ""
    if isinstance(found, tuple) and found[0] == 0:
        made = found[1]
        member: Any = (made.u.cdata, made.u.idata, made.u.ldata)[data_type]
        text = f"{made.type_a} {made.type_d} {made.datano_s} {made.datano_e} {plain(member)}"
    code = found[0] if isinstance(found, tuple) else found
    b.lines.append(f"read {kind} {data_type} {first}..{last}{size} {fwlib.EW(code).name} {text}".rstrip())


def pmc_areas(b: Bench) -> None:
    """Each area at its ends and one beyond, in bytes, words and longs; lengths, kinds, options; what outlasts power."""
    b.letters = LETTERS
    b.fresh(axes=3)
    ends = {**AREAS, "F": ((0, 255), (1000, 1255))}
    for kind, letter in enumerate(LETTERS):
        b.title(f"{letter}, kind {kind}")
        b.ask("pmc_rdpmcinfo", kind)
        for first, last in ends[letter]:
            spared = range(7, 15) if letter == "G" and first == 0 else range(0)
            for at, data in ((first, b"\x8d\x72\x93\xe4"), (last - 3, b"\xf1\x7e\x81\xc5")):
                if at not in spared:
                    given(b, kind, 0, at, at + 3, data)
            for data_type, size in ((0, 1), (1, 2), (2, 4)):
                starts = (first - size, first - 1, first, last - size + 1, last + 2 - size, last + 1)
                for start in dict.fromkeys(starts):
                    read(b, kind, data_type, start, start + size - 1)
                    if start not in range(first, last - size + 2):
                        given(b, kind, data_type, start, start + size - 1, b"\x5b" * size)
        low, high = ends[letter][0][0], ends[letter][-1][1]
        read(b, kind, 0, low, high)
    b.title("an area as a whole, in words and longs, and across its ends")
    for kind, first, last, data_type in (
        (9, 0, 1859, 2),
        (5, 0, 999, 1),
        (5, 9000, 9117, 1),
        (7, 0, 19, 2),
        (7, 16, 17, 0),
        (7, 0, 15, 2),
        (8, 0, 79, 1),
        (6, 0, 79, 2),
        (2, 0, 127, 1),
        (4, 0, 23, 2),
    ):
        read(b, kind, data_type, first, last)
        data = bytes((37 * k + 11) % 251 for k in range(first, last + 1))
        given(b, kind, data_type, first, last, data)
        given(b, kind, data_type, first, last, bytes(0xFF - each for each in data))
    for address in (*range(128), *range(1000, 1064)):
        b.control.pmc.set_input(address, 0x97 * (address + 1) & 0xFF)
    b.look()
    for address in (*range(128), *range(1000, 1064)):
        b.control.pmc.write("Y", address, bytes([0x59 * (address + 3) & 0xFF]))
    b.look()
    b.title("what outlasts a reset, and switching off")
    b.act("reset")
    b.act("power_cycle")
    b.again()
    b.title("lengths, types, kinds, ranges that are none")
    for data_type, first, last, length in (
        (0, 5, 4, 8), (0, 5, 5, 8), (0, 5, 5, 10), (0, 5, 5, 9), (1, 5, 5, 9), (1, 5, 7, 11), (1, 5, 8, 12),
        (1, 5, 8, 11), (2, 5, 6, 10), (2, 5, 8, 12), (2, 5, 8, 13), (2, 5, 8, 24), (3, 5, 5, 9), (-1, 5, 5, 9),
        (0, -1, -1, 9), (0, -1, 0, 10), (0, 32767, 32767, 9), (0, 5, 5, 0), (0, 5, 5, -1), (0, 5, 5, 7),
    ):  # fmt: skip
        read(b, 9, data_type, first, last, length)
        given(b, 9, data_type, first, last, b"\x17" * max(last - first + 1, 1), length)
    for kind in (-1, 10, 9, 100, -128):
        read(b, kind, 0, 5, 5)
        given(b, kind, 0, 5, 5, b"\x29")
        b.ask("pmc_rdpmcinfo", kind)
    b.ask("pmc_rdpmcinfo", -2)
    b.title("a control without a PMC")
    b.letters = ""
    b.fresh(options=("external_message",))
    read(b, 9, 0, 5, 5)
    read(b, 10, 0, 5, 5)
    given(b, 9, 0, 5, 5, b"\x29")
    b.ask("pmc_rdpmcinfo", 9)


SIGNALS = {
    4: 0xFF, 7: 0xFF, 8: 0xFF, 10: 0xFF, 11: 0xFF, 12: 0xFF, 14: 0xFF, 19: 0xFF, 43: 0xFF, 44: 0xFF, 46: 0xFF,
    53: 0xFF, 96: 0x81, 100: 0x0F, 102: 0x0F, 126: 0x0F, 255: 0x81, 1000: 0x81,
}  # fmt: skip
"""Addresses of G with the bits that are given one by one."""
AT_REST = {8: 0x30}


def one_by_one(b: Bench, bits_of: dict[int, int], ready: Callable[[], None] | None = None) -> None:
    """Give and take back each of some bits; `ready` comes before each."""
    for address, bits in bits_of.items():
        for bit in range(8):
            if bits >> bit & 1:
                if ready is not None:
                    ready()
                there = b.control.pmc.read("G", address, address)[0]
                for value in (there ^ 1 << bit, there):
                    b.put("G", address, value, cycles=3)


def signals_idle(b: Bench) -> None:
    """Each bit of each signal given and taken back while nothing happens, and inputs."""
    b.program(31, "N1 G1 X900. F1800\nN2 M30", start=False)
    for address, bits in SIGNALS.items():
        one_by_one(b, {address: bits})
        b.control.reset()
        b.control.advance(200)
        b.look()
    b.title("inputs: the skip signal, others")
    b.act("select_mode", "JOG")
    b.put("G", 100, 1)
    b.run(100)
    for address, value in ((4, 0x80), (4, 0x7F), (127, 0x81), (1063, 0xC3), (3, 0xFF), (4, 0xC0), (4, 0)):
        b.act("pmc.set_input", address, value)
        b.run(1)
        b.ask("cnc_skip", -1, 28)


def signals_at_work(b: Bench) -> None:
    """The same while a program runs, and while axes are moved by hand."""
    b.program(31, "N1 G1 X900. F1800\nN2 M30", start=False)

    def ready() -> None:
        state = b.control.status().channel.run_state.value
        if state != "active" or b.control.mode.name != "MEM":
            b.lines.append("* started anew")
            for address in (8, 126):
                b.control.pmc.write("G", address, bytes([AT_REST.get(address, 0)]))
            b.control.select_mode("MEM")
            b.control.reset()
            b.control.advance(200)
            b.control.cycle_start()
            b.control.advance(30)
            b.look()

    one_by_one(b, {each: SIGNALS[each] for each in (7, 8, 11, 12, 14, 43, 44, 46, 53, 100, 102, 126)}, ready)
    for mode in ("JOG", "INC", "REF", "HND"):
        b.title(mode)
        b.fresh(axes=3)
        b.act("select_mode", mode)
        for address, value in ((100, 5), (102, 2)):
            b.put("G", address, value)
        b.run(30)
        one_by_one(b, {19: 0xB0, 8: 0xB0, 12: 3, 11: 0x81, 100: 7, 102: 7, 126: 7})


def pmc_functions(b: Bench) -> None:
    """Functions that wait: their signals and numbers in four bytes, what answers them, and what does not."""
    waits = {(kind, number): Answer(after_s=None) for kind, number in (
        (Function.M, 1), (Function.M, 65538), (Function.S, 70001), (Function.T, 66051), (Function.M, 300),
    )}  # fmt: skip
    b.fresh(script=waits)
    b.parameters(3030, 8)
    b.parameters(3031, 5)
    b.parameters(3032, 8)
    b.program(41, "N1 M300\nN2 M65538\nN3 T66051\nN5 S70001\nN6 G1 X5. F600 M300\nN7 G4 X0.5\nN8 M30")
    for bits in (0, 4, 0x80, 8, 0xFF, 0, 8, 0, 8, 0, 8, 0, 8, 0, 8, 0):
        b.run(12)
        b.put("G", 4, bits)
    b.run(300)
    b.act("reset")


SCENES = (
    shown, panel_values, panel_general, panel_at_work, pmc_areas, signals_idle, signals_at_work, pmc_functions,
)  # fmt: skip
