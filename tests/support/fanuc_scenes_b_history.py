"""Scenes of the operation history and the alarm history (Manual 000, cnc_stopophis to cnc_wrhissgnl)."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from polycnc.controllers.fanuc import fwlib
from support.fanuc_scenes_b import Bench, plain, record

Entry = tuple[int, int, int, int]
"""The number of an entry, of a signal's name and of its address, and the mask of its bits."""
X, G, Y, F = range(1, 5)
ENDS = {X: (127, 1063), G: (255, 1255), Y: (127, 1063), F: (255, 1255)}


def table(*entries: Entry, count: int | None = None) -> Any:
    """Return a table of signals; `count` is another number of them than it has."""
    made = fwlib.IODBSIG(datano=5, type=len(entries) if count is None else count)
    for data, (entry, name, address, mask) in zip(made.data, entries, strict=False):
        data.ent_no, data.sig_name, data.sig_no, data.mask_pat = entry, name, address, mask
    return made


def watch(b: Bench, *entries: Entry, count: int | None = None) -> None:
    """Write the table; write down the code, and what the table is."""
    code = b.library.cnc_wrhissgnl(b.handle, table(*entries, count=count))
    given = "" if count is None else f" as {count}"
    b.lines.append(f"watch {' '.join(map(str, entries))}{given} {fwlib.EW(code).name}")
    shown(b)


def shown(b: Bench) -> None:
    """Write down the entries of the table that have changed since the last time."""
    found = b.library.cnc_rdhissgnl(b.handle)[1]
    rows = {each.ent_no: f"{each.sig_name}.{each.sig_no}/{each.mask_pat:02x}" for each in found.data}
    before = b.noted
    b.noted = {f"entry {entry}": row for entry, row in rows.items()} | {
        "head": f"{found.datano} {found.type}"
    }
    changed = [f"{name} is {row}" for name, row in b.noted.items() if before.get(name) != row]
    if changed:
        b.lines.append(f"    {', '.join(changed)}")


def records(b: Bench, name: str, first: int, last: int, length: int) -> None:
    """Read records, and write down what each kind of them has."""
    found = getattr(b.library, name)(b.handle, first, last, length)
    code, his = found if isinstance(found, tuple) else (found, None)
    text = ""
    if his is not None and code == 0:
        each = (
            [record(one) for one in his.data]
            if name == "cnc_rdophistry"
            else [plain(one) for one in his.alm_his]
        )
        text = f"{his.s_no} {his.type} {his.e_no}: {', '.join(each)}"
    b.lines.append(f"{name}({first}, {last}, {length}) {fwlib.EW(code).name} {text}".rstrip())


def counts(b: Bench) -> None:
    """Read how many records there are, and the first ones."""
    b.ask("cnc_rdophisno")
    b.ask("cnc_rdalmhisno")
    records(b, "cnc_rdophistry", 1, 1, 14)
    records(b, "cnc_rdalmhistry", 1, 1, 54)


def history_table(b: Bench) -> None:
    """Entries, names, addresses and masks at both ends and beyond; wrong ones; what outlasts power."""
    shown(b)
    for entry in (1, 20, 2, 0, 21, -1):
        watch(b, (entry, X, 3, 0x80 + entry & 0xFF))
    for name in (0, 1, 2, 3, 4, 5, -1, 127):
        watch(b, (5, name, 17, 0x5A))
    for name, (low, high) in ENDS.items():
        for address in (0, low, low + 1, 300, 555, 777, 999, 1000, high, high + 1, -1, 32767):
            watch(b, (name + 6, name, address, 0xA5))
    for mask in (0, 1, 0x7F, 0x80, 0xFF):
        watch(b, (12, G, 44, mask))
    watch(b, (13, 0, 9999, 0xFF))
    watch(b, (12, 0, 5, 1))
    for count in (0, -1, 21, 32767, 1):
        watch(b, (14, Y, 1, 1), (15, Y, 2, 2), count=count)
    watch(b, *((k, F, k, k) for k in range(20, 0, -1)))
    watch(b, (1, X, 1, 1), (2, X, 2, 2), (3, X, 128, 3))
    watch(b, (1, X, 1, 1), (21, X, 2, 2))
    watch(b, (4, X, 1, 1), (4, G, 2, 2))
    for act in ("reset", "power_cycle"):
        b.act(act)
        shown(b)
    b.again()
    shown(b)


def history_signals(b: Bench) -> None:
    """Changes of signals of each kind, at both ends of their addresses, of each bit, masked and not."""
    b.histories()
    for name, letter in ((Y, "Y"), (X, "X"), (G, "G")):
        b.title(f"{letter}, kind {name}")
        low, high = ENDS[name]
        addresses = (44, low, 1000, high)
        watch(b, *((k, name, address, 0x7F) for k, address in enumerate(addresses, 1)))
        for address in (*addresses, 45, 43, low - 1, 1001, 1044, 0, high - 1000):
            for value in (0x41, 0xC1, 0x80, 0):
                if letter == "X":
                    b.control.pmc.set_input(address, value)
                else:
                    b.control.pmc.write(letter, address, bytes([value]))
        b.histories()
        watch(b, *((bit + 1, name, 60 + bit, 1 << bit) for bit in range(8)))
        for bit in range(8):
            for value in (0xFF & ~(1 << bit), 0xFF, 1 << bit, 0):
                if letter == "X":
                    b.control.pmc.set_input(60 + bit, value)
                else:
                    b.control.pmc.write(letter, 60 + bit, bytes([value]))
        b.histories()
        watch(b, *((entry, 0, 0, 0) for entry in range(1, 21)))
    b.title("F, kind 4: lamps, functions, the panel")
    watch(
        b,
        (1, F, 0, 0xFF),
        (2, F, 3, 0xFF),
        (3, F, 2, 0x40),
        (4, F, 73, 0xFF),
        (5, F, 10, 0xFF),
        (6, F, 1, 2),
        (7, F, 102, 6),
    )
    b.control.programs.register(5, "O0005\nG1 X1. F600 M45\nG0 Y-1.\nM30\n")
    b.control.select_mode("MEM")
    b.control.select_program(5)
    b.control.cycle_start()
    b.control.advance(700)
    b.control.select_mode("JOG")
    b.control.advance(3)
    b.control.select_mode("MEM")
    b.library.cnc_wropnlsgnl(b.handle, fwlib.IODBSGNL(type=1, mode=5))
    b.control.advance(3)
    b.histories()
    b.title("G signals that act, and switches that change them")
    watch(b, *((k, G, each, 0xFF) for k, each in enumerate((8, 12, 14, 43, 44, 46), 1)))
    b.library.cnc_opdi(b.handle, 10, fwlib.ODBOPDI())
    b.library.cnc_wropnlsgnl(
        b.handle,
        fwlib.IODBSGNL(type=0x1FB9, mode=1, rpd_ovrd=3, jog_ovrd=5, feed_ovrd=7, dry_run=1, feed_hold=1),
    )
    b.control.advance(2)
    b.histories()
    b.title("switches of the control that are signals")
    watch(b, (7, G, 10, 0xFF), (8, G, 11, 0x80), (9, G, 4, 0xFF))
    for act, arguments in (
        ("select_mode", ("JOG",)), ("select_mode", ("REF",)), ("emergency_stop", (True,)), ("emergency_stop", (False,)),
        ("protect_key", (True,)), ("signals.set_jog_override", (33.25,)),
    ):  # fmt: skip
        b.act(act, *arguments)
        b.control.advance(1)
        b.histories()
    b.control.control.set_overrides(feed=0.44, rapid=0.5)
    b.control.control.set_switches(single_block=True, block_delete=frozenset({1}))
    b.control.advance(1)
    b.act("power_cycle")
    b.control.advance(1)
    b.histories()


def history_records(b: Bench) -> None:
    """Keys, dates, alarms of each group; stopping, clearing, ranges, lengths, room, years, power."""
    b.histories()
    b.title("keys and dates")
    for code in (0, 1, 65, 127, 128, 255):
        b.control.history.press_key(code)
    for now in (datetime(1999, 12, 31, 23, 59, 59), datetime(2000, 1, 1), datetime(2027, 2, 28, 9, 8, 7)):
        b.control.clock.set_now(now)
        b.control.power_cycle()
        b.control.raise_alarm(7, "EARLY", axis=2)
        b.control.advance(1200)
    b.histories()
    for key, number in ((9, 430), (200, 1700)):
        b.control.raise_alarm(number, "BEFORE A KEY")
        b.control.history.press_key(key)
        b.control.reset()
    b.histories()
    b.title("stopped: nothing is noted, and nothing of it later; only then histories can be read")
    counts(b)
    b.ask("cnc_stopophis")
    counts(b)
    b.control.history.press_key(33)
    b.control.raise_alarm(1009, "WHILE STOPPED")
    b.control.select_mode("EDIT")
    b.control.pmc.write("G", 100, b"\x21")
    b.control.advance(5)
    b.control.raise_alarm(1010, "STILL STOPPED")
    b.ask("cnc_stopophis")
    counts(b)
    b.control.raise_alarm(1011, "JUST BEFORE")
    b.control.pmc.set_input(9, 1)
    b.control.select_mode("HND")
    b.ask("cnc_startophis")
    b.ask("cnc_startophis")
    b.control.advance(5)
    counts(b)
    b.control.history.press_key(34)
    b.control.raise_alarm(430, "AFTER", axis=3)
    b.control.advance(5)
    b.histories()
    b.title("ranges and lengths")
    b.ask("cnc_stopophis")
    most = b.ask("cnc_rdophisno"), b.ask("cnc_rdalmhisno")
    for name, size, count in (("cnc_rdophistry", 8, most[0]), ("cnc_rdalmhistry", 48, most[1])):
        for first, last in (
            (1, 1), (2, 3), (count, count), (count, count + 1), (count + 1, count + 1), (count - 1, count + 5), (0, 1),
            (0, 0), (3, 2), (1, 0), (1, count),
        ):  # fmt: skip
            length = 6 + size * max(last - first + 1, 0)
            for more in (0, 1, -1, size, -size):
                if length + more >= 0:
                    records(b, name, first, last, length + more)
    b.ask("cnc_startophis")
    b.title("cleared alone, running and stopped; what is wrong clears nothing")
    for slct in (2, -1, 32767):
        b.ask("cnc_clearophis", slct)
    b.histories()
    b.ask("cnc_clearophis", 0)
    b.histories()
    b.control.history.press_key(35)
    b.control.raise_alarm(5005, "NEW", axis=1)
    b.ask("cnc_clearophis", 1)
    b.histories()
    b.ask("cnc_stopophis")
    b.ask("cnc_clearophis", 0)
    b.ask("cnc_rdophisno")
    b.ask("cnc_startophis")
    b.title("more alarms than the history has room for: the oldest go; a stop outlasts no power")
    b.act("reset")
    for k in range(53):
        b.control.raise_alarm(2000 + k, f"NUMBER {k}", axis=1 + k % 3)
    b.control.advance(2)
    b.ask("cnc_stopophis")
    b.act("power_cycle")
    b.ask("cnc_rdalmhisno")
    b.ask("cnc_stopophis")
    b.again()
    b.ask("cnc_stopophis")
    b.ask("cnc_rdophisno")
    b.ask("cnc_rdalmhisno")
    b.ask("cnc_rdalmhistry", 1, 2, 102)
    b.ask("cnc_rdalmhistry", 49, 50, 102)


SCENES = (history_table, history_signals, history_records)
