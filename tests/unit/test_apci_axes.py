"""Every axis of a board has its own registers: what the first one does, the third one does in the same scans."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

import pytest

from polycnc.controllers.apci import pcap
from support.apci_pc import Pc

Step: TypeAlias = tuple[int, Callable[[Pc, int], Any]]

AXIS = """
time_unit = "min"
jac = 900000.0
jvl = 1800.0
hac = 700000.0
hvl = 900.0
sdec = 1500000.0
sll = -800.0
slr = 900.0
soft_left = "SMD"
soft_right = "SMA"
kp = 40.0
[axis.plant]
kind = "lag"
lag_s = 0.004
velocity_at_10_v = 18000.0
index = 1.5
"""
TERMINALS = """
[inputs]
3 = { functions = ["LP"], axes = ["A%d"] }
4 = { functions = ["REF"], axes = ["A%d"] }
5 = { functions = ["LSR_SMD"], axes = ["A%d"] }
6 = { functions = ["EO"], axes = ["A%d"] }
7 = { functions = ["UI"], axes = ["A%d"] }
[outputs]
2 = { functions = ["PAE"], axes = ["A%d"] }
"""
STEMS = {"jtv": "jtvl"}


def put(pc: Pc, an: int, **values: float) -> None:
    for name, value in values.items():
        getattr(pcap, f"wr{STEMS.get(name, name)}")(pcap.TSRP(an=an, **{name: value}))


def go(pc: Pc, an: int, function: Callable[..., Any], target: float) -> None:
    pc.tsrp[an].tp = target
    function(pcap.AS.of(an), pc.tsrp)


def line(pc: Pc, an: int, function: Callable[..., Any], *distances: float) -> None:
    for distance in distances:
        dtm = [distance if k == an else 0.0 for k in range(18)]
        function(pcap.AS.of(an), pcap.LMP(ac=250.0, vl=35.0, dtm=dtm))


SCENES: dict[str, list[Step]] = {
    "jogs": [
        (70, lambda pc, an: (pcap.cl(pcap.AS.of(an)), go(pc, an, pcap.jr, 3.5))),
        (
            60,
            lambda pc, an: (
                put(pc, an, jvl=2400.0, jac=500000.0, jtv=-300.0, jovr=0.75),
                go(pc, an, pcap.ja, -2.5),
            ),
        ),
        (30, lambda pc, an: (put(pc, an, sdec=800000.0), pcap.js(pcap.AS.of(an)))),
        (
            20,
            lambda pc, an: (
                put(pc, an, ipw=0.25, mpe=0.5),
                pcap.wrdvoffset(an, 600.0),
                pcap.wrdpoffset(an, 0.75),
            ),
        ),
        (10, lambda pc, an: (pcap.ol(pcap.AS.of(an)), put(pc, an, mcp=-4321))),
        (10, lambda pc, an: pcap.ra(pcap.AS.of(an))),
    ],
    "searches": [
        (40, lambda pc, an: (pcap.cl(pcap.AS.of(an)), go(pc, an, pcap.jhi, 2.5))),
        (30, lambda pc, an: pcap.jhl(pcap.AS.of(an))),
        (30, lambda pc, an: (put(pc, an, hac=300000.0), pc.board.set_input(4, True))),
        (20, lambda pc, an: (pc.board.set_input(4, False), pc.board.set_input(3, True))),
        (20, lambda pc, an: pcap.lps(an, 5)),
    ],
    "limits": [
        (
            10,
            lambda pc, an: (pcap.cl(pcap.AS.of(an)), put(pc, an, sll=-0.5, slr=1.25), pcap.shp(pc.tsrp[an])),
        ),
        (60, lambda pc, an: go(pc, an, pcap.jr, 9.0)),
        (60, lambda pc, an: (pcap.cl(pcap.AS.of(an)), go(pc, an, pcap.jr, -9.0))),
        (30, lambda pc, an: (pcap.cl(pcap.AS.of(an)), pc.board.set_input(5, True), go(pc, an, pcap.jr, 4.0))),
        (
            30,
            lambda pc, an: (
                pc.board.set_input(5, False),
                pc.board.set_input(6, True),
                pc.board.set_input(7, True),
            ),
        ),
    ],
    "queue": [
        (
            40,
            lambda pc, an: (
                pcap.cl(pcap.AS.of(an)),
                line(pc, an, pcap.smlr, 1.5, -0.75),
                pcap.ssf(an, 1003, 7),
            ),
        ),
        (90, lambda pc, an: (line(pc, an, pcap.smlr, 0.5), pcap.ssms(pcap.AS.of(an)))),
        (30, lambda pc, an: line(pc, an, pcap.mlr, 2.5)),
        (30, lambda pc, an: pcap.ms(pcap.AS.of(an))),
    ],
}
READS = ("rddv", "rdsdec", "rdaux")
FIELDS = (
    "an", "kp", "jac", "jvl", "jtv", "jovr", "hac", "hvl", "rp", "dp", "tp", "sll", "slr", "ipw", "mpe", "mcp", "axst",
    "lsm", "digi", "digo", "dv", "sdec", "lp",
)  # fmt: skip
COMMANDS = (
    "cl",
    "ol",
    "ra",
    "jr",
    "ja",
    "js",
    "jhi",
    "jhl",
    "lps",
    "shp",
    "smlr",
    "ssf",
    "ssms",
    "mlr",
    "ms",
    "rdap",
)


def shown(an: int) -> tuple[bytes, ...]:
    record = pcap.TSRP(an=an)
    pcap.rdap(record)
    for name in READS:
        getattr(pcap, name)(record)
    record.an = 0
    more = (pcap.rdPosErr(an), pcap.rdrv(an), pcap.rdMCiS(an), pcap.rdPcapIndex(an), pcap.rddpoffset(an))
    return bytes(record), repr(more).encode()


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.covers(*(f"apci.TSRP.{name}" for name in FIELDS))
@pytest.mark.covers(*(f"apci.{name}" for name in COMMANDS), "apci.rdPosErr", "apci.rdrv", "apci.rdMCiS")
def test_the_third_axis_does_what_the_first_one_does(scene: str) -> None:
    tracks = []
    for an in (0, 2):
        axes = "".join(f"[[axis]]\n{AXIS if k == an else ''}" for k in range(3))
        pc = Pc(axes + TERMINALS % ((an + 1,) * 6))
        track = []
        for scans, act in SCENES[scene]:
            act(pc, an)
            for _ in range(scans):
                track.append(shown(an))
                pc.board.advance(5)
            record = pcap.TSRP(an=an)
            pcap.rdlp(record)
            pcap.rdlpndx(latched := pcap.TSRP(an=an))
            track.append((bytes(pcap.TSRP(lp=record.lp)), bytes(pcap.TSRP(lp=latched.lp))))
        tracks.append(track)
        pcap.detach()
    assert tracks[0] == tracks[1]
    assert len(set(tracks[0])) > len(tracks[0]) // 2  # something happens
