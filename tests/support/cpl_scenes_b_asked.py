"""What scenes of a control ask beside its data: variables that are filled, process services, the screen."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from polycnc.controllers.bosch.ncs import DATA_SERVICES, Coupling
from polycnc.controllers.bosch.screen import Surface
from polycnc.nc.cpl import BLOCKED, Box, CharacterField, Fault, Field
from support.cpl_scenes_b import EXTRA, Bench, Place, number, refusal, shown_order, text

HOLDERS = {"I": "INTEGER", "R": "REAL", "D": "DOUBLE", "S": "CHARACTERS", "?": "BOOLEAN"}


def holders(bench: Bench, service: int) -> str:
    """Return the types of variables that a data service fills: a field and one variable of each, and one too small."""
    row = DATA_SERVICES[service]
    channel, extra = -1 if row.scope == "system" else 1, EXTRA.get(service, ())
    found = []
    for kind, name in HOLDERS.items():
        buffers = [CharacterField(160)] if kind == "S" else [Field(kind, (16,)), Box("V", kind, None)]  # type: ignore[arg-type]
        for buffer in buffers:
            bench.version.value = 0.0
            size = 1 if isinstance(buffer, Box) else 16
            with suppress(Fault):
                bench.coupling.mcods(service, channel, bench.version, buffer, size, *extra)
                found.append(name + (" alone" if isinstance(buffer, Box) else ""))
    return ", ".join(found)


def sizes(bench: Bench, service: int) -> str:
    """Return what is left in a field of three, or a text of nine characters, of sizes 0 to one too large."""
    row = DATA_SERVICES[service]
    channel, extra = -1 if row.scope == "system" else 1, EXTRA.get(service, ())
    found = []
    for size in range(12 if row.kind == "S" else 5):
        buffer = CharacterField(9) if row.kind == "S" else Field("R" if row.kind == "X" else row.kind, (3,))
        bench.version.value = 0.0
        try:
            answer = bench.coupling.mcods(service, channel, bench.version, buffer, size, *extra)
        except Fault as fault:
            found.append(refusal(fault))
            continue
        left = (
            text(buffer)
            if isinstance(buffer, CharacterField)
            else "/".join(text(buffer[k]) for k in (1, 2, 3))
        )
        found.append(left if answer == 0 else f"code {answer}")
    return " ".join(found)


SELECT, BLOCK, BUFFERED = 4, 32, 32 + 4096
ORDERS: list[tuple[object, ...]] = [
    (1,),
    *((2, kind) for kind in (0, 1, 2, 3)),
    (2,),
    *(
        (3, *ends)
        for ends in (
            (),
            ("N2",),
            ("", "N2"),
            ("N2", "N3"),
            ("2",),
            ("N9",),
            ("N2", "N9"),
            ("N3", "N2"),
            ("N2", "N3", "N4"),
        )
    ),
    *((SELECT, "PART", "", "", kind) for kind in (0, 1, 2, 3, 4, 64, 128, 192, 256, 512, 1024, 2048, 8192)),
    (SELECT, "PART", "N2", "N3", 128),
    (SELECT, "PART", "N9", "", 0),
    (SELECT, "NONE", "", "", 0),
    (SELECT, "NONE", "", "", 2),
    (SELECT, "WRONG", "", "", 1),
    (SELECT, "WRONG", "", "", 3),
    (SELECT, "", "", "", 0),
    (SELECT, "P" * 100, "", "", 2),
    (SELECT, "P" * 101, "", "", 2),
    (SELECT, "PART"),
    (SELECT,),
    *((SELECT, "G1 X2=3 F600", "", "", BLOCK + more) for more in (0, 64, 128, 192, 2048)),
    (SELECT, "G1 X2=" + "0" * 504 + "3", "", "", BLOCK),
    (SELECT, "G1 X2=" + "0" * 505 + "3", "", "", BLOCK),
    (SELECT, "G1 Q", "", "", BLOCK + 128),
    (SELECT, "G1 X2=3 F600\nX2=4", "", "", BUFFERED),
    (SELECT, "G1 X2=3 F600\nX2=4", "", "", BUFFERED + 128),
    (SELECT, "G1 X2=3" + " " * 4089, "", "", BUFFERED),
    *((5, kind) for kind in (0, 1, 2)),
    (6,),
    *((7, mode) for mode in (0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 12, 13, 14)),
    (7,),
    *((8, how, where) for how, where in ((1, 1), (3, 2), (2, 3), (0, 1), (4, 1), (1, 0), (1, 4))),
    (9,),
    (0,),
    (10,),
]
"""What MCOPS is asked for: the number of the function and its parameters."""


SETTINGS = (7, 8, 9)


class Orders:
    """Give one order after the other to a channel in the same state; write down the answers and what became of it."""

    def __init__(self, bench: Bench, channel: int = 2) -> None:
        self.bench, self.channel = bench, channel
        self.asked = 0

    def give_all(self, what: str) -> None:
        """Give every order in the present state, and go back to it after each that was carried out."""
        bench = self.bench
        bench.say(f"{what}: {self.state()}")
        begin = bench.pnc.snapshot()
        before, refused = self.state(), dict[str, list[str]]()
        for order in ORDERS:
            answer = self.give(order)
            if answer not in ("code 0", "waits") and self.state() == before:
                refused.setdefault(answer, []).append(shown_order(order))
                continue
            at_once = self.state()
            if order[0] in SETTINGS:  # of which the next one is asked in the state that this one leaves
                bench.note(f"({shown_order(order)}) {answer}", at_once)
                before = at_once
                continue
            bench.pnc.advance(30)
            later = self.state()
            bench.note(
                f"({shown_order(order)}) {answer}", at_once if later == at_once else f"{at_once} / {later}"
            )
            bench.pnc.restore(begin)
        bench.pnc.restore(begin)
        for answer, orders in refused.items():
            bench.note(f"{answer}: ({') ('.join(orders)})")

    def give(self, order: Sequence[object]) -> str:
        """Return what an order is answered within four cycles."""
        client = Coupling(self.bench.pnc.ncs, None, 1)
        for cycles in range(4):
            try:
                answer = client.mcops(order[0], self.channel, *order[1:])
            except Fault as fault:
                return refusal(fault)
            if answer is not BLOCKED:
                return f"code {answer}" + (f" after {cycles}" if cycles else "")
            self.bench.pnc.advance(1)
        return "waits"

    def state(self) -> str:
        """Return the mode, the states, how to return and the program of the channel."""
        bench = self.bench
        services = (31, 32, 46, 30, 87)
        found = [bench.data(service, self.channel).replace("P" * 90, "...") for service in services]
        bench.pnc.ncs.ledger.unchanged.clear()
        x2 = number(round(bench.pnc.axes["X2"].setpoint, 4))
        return f"mode {found[0]}, {found[1]}, way {found[2]}, {found[3]}, waits {found[4]}, X2 {x2}"


def picture(surface: Surface) -> list[str]:
    """Return what stands on a screen: pixels of each colour with their edges and a sum, texts, softkeys, colours."""
    found = []
    for colour in range(8):
        y, x = np.nonzero(surface.pixels == colour)
        if len(x):
            edges = f"{x.min()}-{x.max()} x {y.min()}-{y.max()}"
            found.append(f"colour {colour}: {len(x)} pixels, {edges}, sum {int((x * 7 + y * 13).sum())}")
    for row, written in enumerate(surface.lines(), 1):
        if shown := written.rstrip():
            found.append(f"line {row}: {shown!r}")
    cells = [cell for cell in surface.cells.values() if cell.character != " "]
    inks = sorted({(cell.colour, cell.background) for cell in cells})
    found += [f"characters: {len(cells)} in {inks}"] if cells else []
    found += ["text " + " ".join(map(str, (*each[:4], *each.font))) for each in surface.texts]
    tables = " ".join(
        "/".join("{:02x}{:02x}{:02x}".format(*each) for each in surface.tables[table])
        for table in surface.tables
    )
    return [
        *found,
        f"table {surface.table}, softkeys {surface.softkeys} in {surface.softkey_colours}, {tables}",
    ]


def show(bench: Bench, *calls: Place) -> None:
    """Write down what calls of a screen's functions leave: each is a name and its arguments."""
    done = []
    for name, *arguments in calls:
        asked = shown_order(arguments).replace("OMITTED", "")
        answer = bench.call(str(name), *arguments)
        done.append(f"{name}({asked})" + ("" if answer == "0" else f" {answer}"))
    bench.lines += ["", f"== {' '.join(done)}"]
    now = picture(bench.pnc.screen())
    kinds = {each.partition(":")[0] for each in now}
    gone = {each.partition(":")[0] for each in bench.seen} - kinds
    bench.lines += [f"no more: {', '.join(sorted(gone))}"] if gone else []
    bench.lines += [each for each in now if each not in bench.seen]
    bench.seen = set(now)
