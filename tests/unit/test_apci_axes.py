"""Every axis of a board has its own registers: what the first one does, the third one does in the same scans.

What a program reads is written down in `tests/golden/apci/scenes.txt`, so that no number can change unseen: of each
scene and register the value at the end of each step, how often it changes, and the sum over the samples, each value
times the number of its sample. After a wanted change: `--update-goldens`, and read the difference.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise, zip_longest
from pathlib import Path
from typing import Any, TypeAlias

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board._records import STRUCTURES
from support.apci_pc import Pc, near

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


def put(pc: Pc, an: int, **values: float) -> Any:
    for name, value in values.items():
        getattr(pcap, f"wr{STEMS.get(name, name)}")(pcap.TSRP(an=an, **{name: value}))


def go(pc: Pc, an: int, function: Callable[..., Any], target: float) -> Any:
    pc.tsrp[an].tp = target
    if function is pcap.shp:
        function(pc.tsrp[an])
    else:
        function(pcap.AS.of(an), pc.tsrp)


def line(pc: Pc, an: int, function: Callable[..., Any], *distances: float) -> Any:
    for distance in distances:
        dtm = [distance if k == an else 0.0 for k in range(18)]
        function(pcap.AS.of(an), pcap.LMP(ac=250.0, vl=35.0, dtm=dtm))


def switch(pc: Pc, number: int, on: bool) -> Any:
    pc.board.set_input(number, on)


SCENES: dict[str, list[Step]] = {
    "jogs": [
        (70, lambda pc, an: (pcap.cl(pcap.AS.of(an)), go(pc, an, pcap.jr, 3.5))),
        (
            60,
            lambda pc, an: (
                put(pc, an, jac=-650000.0),
                put(pc, an, jvl=2400.0, jtv=-300.0, jovr=0.75),
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
        (30, lambda pc, an: (put(pc, an, hac=300000.0), switch(pc, 4, True))),
        (20, lambda pc, an: (switch(pc, 4, False), switch(pc, 3, True))),
        (20, lambda pc, an: pcap.lps(an, 5)),
    ],
    "limits": [
        (
            10,
            lambda pc, an: (pcap.cl(pcap.AS.of(an)), put(pc, an, sll=-0.5, slr=1.25), pcap.shp(pc.tsrp[an])),
        ),
        (60, lambda pc, an: go(pc, an, pcap.jr, 9.0)),
        (60, lambda pc, an: (pcap.cl(pcap.AS.of(an)), go(pc, an, pcap.jr, -9.0))),
        (30, lambda pc, an: (pcap.cl(pcap.AS.of(an)), switch(pc, 5, True), go(pc, an, pcap.jr, 4.0))),
        (
            30,
            lambda pc, an: (
                switch(pc, 5, False),
                switch(pc, 6, True),
                switch(pc, 7, True),
            ),
        ),
    ],
    "offset": [
        (
            30,
            lambda pc, an: (
                pcap.cl(pcap.AS.of(an)),
                put(pc, an, rp=7.25),
                pcap.szpa(an, 2.5),
                put(pc, an, ipw=0.5),
                go(pc, an, pcap.ja, 1.75),
            ),
        ),
        (10, lambda pc, an: (switch(pc, 3, True), pcap.szpr(an, -4.0))),
        (20, lambda pc, an: (switch(pc, 3, False), pcap.rdigi(pcap.TSRP(an=an)), go(pc, an, pcap.jhi, -3.0))),
        (20, lambda pc, an: (line(pc, an, pcap.mla, -2.25), switch(pc, 3, True))),
        (
            10,
            lambda pc, an: (
                put(pc, an, dp=-1.25),
                put(pc, an, lp=3.75),
                pcap.wrlpndx(pcap.TSRP(an=an, lp=-0.75)),
            ),
        ),
        (10, lambda pc, an: (pcap.ol(pcap.AS.of(an)), put(pc, an, rp=-6.5), pcap.cl(pcap.AS.of(an)))),
        (10, lambda pc, an: go(pc, an, pcap.shp, 4.5)),
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
AXIS_ROWS = (
    "wrjvl", "wrjac", "wrjtvl", "wrjovr", "wrsdec", "wripw", "wrmpe", "wrdvoffset", "wrdpoffset", "wrmcp", "wrsll",
    "wrslr", "wrhac", "rdlp", "rdlpndx", "limit.SMD", "limit.SMA", "io.LSR_SMD", "io.REF", "io.LP", "io.EO", "io.UI",
    "io.PAE", "var.dv", "var.rv", "var.PosErr", "var.lp", "var.lpndx", "var.dpoffset", "var.dvoffset", "var.sdec",
    "axst.1.eo", "axst.4.lsrh", "axst.5.lsls", "axst.6.lsrs", "axst.12.pe", "axst.13.cl", "axst.14.ip", "axst.15.ui",
    "axst.16.lpsf", "axst.17.referenced", "axst.18.refh", "axst.7.mpe", "profile.trapezoid", "profile.override",
    "profile.acceleration", "profile.max_velocity", "profile.target_velocity", "profile.target_position",
    "mode.direct", "mode.spool", "ctrl.pidf", "limit.general", "rdaxst", "rddv", "rdlsm", "rdigi", "wrlp", "wrlpndx",
    "wrdp", "wrrp", "szpa", "szpr", "shp", "rdtp", "rdrp", "rddp", "rdjac", "rdhac", "rdjvl", "rdhvl", "axst.19.saf",
    "digi.16", "digi.17", "digi.18", "digi.19", "rdPosErr", "var.zeroOffset", "rule.referenced",
)  # fmt: skip


# What the whole board does, its three axes together.
BOARD_AXES = """
[[axis]]
time_unit = "min"
[[axis]]
[axis.plant]
kind = "lag"
lag_s = 0.005
[[axis]]
unit = "deg"
effradius = 25.0
jac = 400.0
jvl = 90.0
[outputs]
1 = { set_at_reset = true }
"""
ALL = pcap.AS.of(0, 1, 2)
TWO = pcap.AS.of(1, 0)


def distances(*values: float) -> list[float]:
    return [*values, *[0.0] * (18 - len(values))]


def points(*values: float) -> pcap.SPDBUF:
    buffer = pcap.SPDBUF()
    for k, value in enumerate(values):
        buffer.position[k] = value
    return buffer


BOARD: dict[str, list[tuple[int, Callable[[Pc], Any]]]] = {
    "paths": [
        (
            250,
            lambda pc: (
                pcap.cl(ALL),
                pcap.mca(TWO, pcap.CMP(ac=90.0, vl=14.0, tvl=0.0, phi=-130.0, dtca1=3.5, dtca2=1.25)),
            ),
        ),
        (
            250,
            lambda pc: (
                pcap.wrModeReg(1 << 16),
                pcap.wrJerkRel(0, 0.75),
                pcap.wrJerkRel(1, 0.75),
                pcap.wrJerkRel(2, 0.75),
                pcap.ctru(pcap.TRU(pu=1, tu=1)),
                pcap.mhr(
                    ALL,
                    pcap.HMP(
                        ac=9000.0,
                        vl=50.0,
                        phi=200.0,
                        dtca1=0.125,
                        dtca2=-0.0625,
                        dtm=distances(0.0, 0.0, 0.25),
                    ),
                ),
            ),
        ),
        (
            200,
            lambda pc: (
                pcap.wrModeReg(0x81),
                pcap.ctru(pcap.TRU(pu=0, tu=0)),
                pcap.wrMDVel(0, 4.0),
                pcap.wrMaxVel(1, 40.0),
                pcap.wrMaxAcc(1, 70.0),
                pcap.wrnfrax(4),
                pcap.smla(ALL, pcap.LMP(ac=120.0, vl=22.0, tvl=22.0, dtm=distances(3.0, -2.0, 1.5))),
                pcap.smlr(ALL, pcap.LMP(ac=120.0, vl=17.0, tvl=5.0, dtm=distances(-1.0, -1.5, 0.5))),
                pcap.smcr(TWO, pcap.CMP(ac=120.0, vl=9.0, phi=75.0, dtca1=0.5, dtca2=1.5)),
                pcap.sstvl(ALL, 3.0),
                pcap.ssms(ALL),
            ),
        ),
        (40, lambda pc: (pcap.wrtrovr(0.5), pcap.wrtrovrst(0.1), pcap.utrovr(ALL))),
        (60, lambda pc: pcap.ms(ALL)),
    ],
    "special": [
        (
            60,
            lambda pc: (
                pcap.cl(ALL),
                pcap.ssf(0, 1001, 6.0),
                pcap.ssf(0, 1003, 130.0),
                pcap.ssf(0, 1002, 9.0),
                pcap.ssf(0, 17, -70000.0),
                pcap.ssf(1, 1006, 7.0),
                pcap.ssf(0, 1006, 7.0),
                pcap.ssf(0, 10017, 9.0),
                pcap.spd(1, 4, points(0.5, 0.75, 0.875, 1.0)),
                pcap.ssms(ALL),
            ),
        ),
        (
            60,
            lambda pc: (
                pcap.ssf(2, 1006, 7.0),
                pcap.ssf(2, 1015, 5.0),
                pcap.ssf(2, 20003, 2.75),
                pcap.ssms(pcap.AS.of(2)),
            ),
        ),
        (
            40,
            lambda pc: (
                pcap.ClearCI99(),
                pcap.spdr(1, 3, points(0.25, -0.5, 0.125), 40),
                pcap.ssms(pcap.AS.of(1)),
            ),
        ),
        (30, lambda pc: (pcap.szpa(0, 2.5), pcap.azo(7), pcap.szpr(1, -1.5), put(pc, 2, tp=4.5), pcap.rs())),
    ],
}


def lift(pc: Pc, number: int) -> Any:
    """Let an input, an output and some registers have other bits."""
    pc.board.set_input(number, True)
    pcap.wrdigob(number % 3, number - 8, number % 2)
    pcap.wrModeReg(0x61000000 | number << 26)


def take_away(pc: Pc, *numbers: int) -> None:
    """Take some inputs off again."""
    for number in numbers:
        pc.board.set_input(number, False)


BOARD["bits"] = [
    (5, lambda pc: pcap.wrdigo(pcap.TSRP(an=2, digo=0x5A))),
    (5, lambda pc: pcap.wrdigo(pcap.TSRP(an=1, digo=-0x5B))),
    *((5, lambda pc, number=number: lift(pc, number)) for number in range(1, 19)),
    (5, lambda pc: take_away(pc, 2, 7, 11, 16)),
]
BIT_ROWS = (
    *(f"digi.{bit}" for bit in range(16)),
    *(f"rddigib.bitnr.{number}" for number in range(1, 17)),
    *(f"digo.{bit}" for bit in range(8)),
    *(f"wrdigob.bitnr.{number}" for number in range(1, 9)),
    *("rddigib.bitnr.25-32", "digo.8-31", "wrdigob.bitnr.9-32", "ErrorReg.21-31", "axst.20-31", "digi.24-31"),
    *(
        "rddigi",
        "rddigib",
        "rddigo",
        "rddigob",
        "wrdigo",
        "wrdigob",
        "rdaxstb",
        "rdModeReg",
        "wrModeReg",
        "MODEREG",
    ),
    *(
        "axst.0",
        "axst.10",
        "axst.11",
        "rdErrorReg",
        "const.digin",
        "const.digout",
        "TSRP.digi",
        "TSRP.digo",
        "ErrorReg",
    ),
)
BOARD_ROWS = (
    *BIT_ROWS,
    "mca", "mhr", "smla", "smlr", "smcr", "ssms", "sstvl", "ms", "ctru", "utrovr", "wrtrovr", "wrtrovrst", "wrMDVel",
    "wrMaxVel", "wrMaxAcc", "var.MaxVel", "var.MaxAcc", "MODEREG.7.maxcheck", "wrnfrax", "wrJerkRel", "wrModeReg",
    "NFRAX", "jerkrel", "MODEREG.SProfile", "MODEREG.0.lookahead", "pu.inch", "tu.min", "CMP.phi", "CMP.dtca1",
    "CMP.dtca2", "CMP.ac", "CMP.vl", "HMP.phi", "HMP.dtca1", "HMP.dtca2", "HMP.dtm", "HMP.ac", "HMP.vl", "LMP.dtm",
    "LMP.ac", "LMP.vl", "LMP.tvl", "interp.circular", "interp.helical", "interp.linear", "interp.surface",
    "ssf.0-999", "ssf.1001", "ssf.1002", "ssf.1003", "ssf.1006", "ssf.1015", "ssf.10000-10999", "ssf.20000-20999",
    "spd", "spdr", "ClearCI99", "szpa", "szpr", "azo", "rs", "rdPcapIndex", "TSRP.rp", "TSRP.dp", "TSRP.dv",
    "TSRP.digo", "TSRP.axst", "TSRP.lsm", "TSRP.mcp", "mode.spool", "profile.move.trajectory_velocity", "var.rv",
    "var.dv", "var.PosErr",
)  # fmt: skip

KEPT = (
    "error",
    "digi",
    "digo",
    "axst",
    "bits of digi",
    "bits of digo",
    "bits of axst",
)  # also where they stay 0
_FIELDS = [each.name for each in STRUCTURES["TSRP"].fields if each.name not in ("an", "scratch")]
RECORDED = Path(__file__).parents[1] / "golden" / "apci" / "scenes.txt"


def shown(an: int) -> dict[str, float]:
    """Return what a program reads of an axis."""
    record = pcap.TSRP(an=an)
    pcap.rdap(record)
    for name in READS:
        getattr(pcap, name)(record)
    more = {
        "PosErr": pcap.rdPosErr(an),
        "rv": pcap.rdrv(an),
        "MCiS": pcap.rdMCiS(an),
        "PcapIndex": pcap.rdPcapIndex(an)[1],
        "dpoffset": pcap.rddpoffset(an)[1],
    }
    return {**{name: getattr(record, name) for name in _FIELDS}, **more}


def bitwise(an: int) -> dict[str, float]:
    """Return the words of an axis as the functions for single bits tell them."""
    functions = {"digi": pcap.rddigib, "digo": pcap.rddigob, "axst": pcap.rdaxstb}
    return {
        f"{name}_bits": sum(read(an, number) << number for number in range(-1, 35) if number >= 0)
        for name, read in functions.items()
    }


def written_down(name: str, samples: list[dict[str, float]], ends: list[int]) -> str:
    """Return what the registers have done in a scene."""
    lines = [f"# {name}"]
    for register in samples[0]:
        values = [each[register] for each in samples]
        changes = sum(a != b for a, b in pairwise(values))
        if changes or values[0] != 0 or register in KEPT:
            total = sum(k * each for k, each in enumerate(values, 1))
            marks = " ".join(f"{values[end - 1]:.12g}" for end in ends)
            lines.append(f"{register} {marks} / {changes} / {total:.12g}")
    return "\n".join([*lines, ""])


def differs(name: str, found: str, request: pytest.FixtureRequest) -> str:
    """Return the line of a scene that is not as it is written down, number by number; nothing if all are."""
    text = RECORDED.read_text(encoding="utf-8")
    parts = {part.split("\n", 1)[0]: f"# {part}" for part in text.split("# ")[1:]}
    if request.config.getoption("update_goldens"):
        RECORDED.write_text("".join((parts | {name: found}).values()), encoding="utf-8")
        return ""
    for line, wanted in zip_longest(found.splitlines(), parts[name].splitlines(), fillvalue=""):
        register, *marks = line.replace(" /", "").split(" ")
        other, *numbers = wanted.replace(" /", "").split(" ")
        is_head = register == "#" or len(marks) != len(numbers)
        if register != other or (is_head and line != wanted):
            return f"{line} instead of {wanted}"
        if not is_head and list(map(float, marks)) != near(list(map(float, numbers)), rel=1e-8, abs=1e-9):
            return f"{line} instead of {wanted}"
    return ""


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.covers(*(f"apci.TSRP.{name}" for name in FIELDS))
@pytest.mark.covers(*(f"apci.{name}" for name in COMMANDS), "apci.rdPosErr", "apci.rdrv", "apci.rdMCiS")
@pytest.mark.covers(*(f"apci.{row}" for row in AXIS_ROWS))
def test_the_third_axis_does_what_the_first_one_does(scene: str, request: pytest.FixtureRequest) -> None:
    tracks = []
    for an in (0, 2):
        axes = "".join(f"[[axis]]\n{AXIS if k == an else ''}" for k in range(3))
        pc = Pc(axes + TERMINALS % ((an + 1,) * 6))
        track: list[dict[str, float]] = []
        ends = []
        for scans, act in SCENES[scene]:
            act(pc, an)
            for _ in range(scans):
                track.append(shown(an))
                pc.board.advance(5)
            record = pcap.TSRP(an=an)
            pcap.rdlp(record)
            pcap.rdlpndx(latched := pcap.TSRP(an=an))
            track.append({**track[-1], "lp": record.lp, "PosErr": latched.lp})
            ends.append(len(track))
        tracks.append(track)
        pcap.detach()
    assert tracks[0] == tracks[1]
    assert differs(scene, written_down(scene, tracks[0], ends), request) == ""


@pytest.mark.parametrize("scene", BOARD)
@pytest.mark.covers(*(f"apci.{row}" for row in BOARD_ROWS))
def test_the_whole_board_is_as_written_down(scene: str, request: pytest.FixtureRequest) -> None:
    pc = Pc(BOARD_AXES)
    tracks: list[list[dict[str, float]]] = [[], [], []]
    ends = []
    for scans, act in BOARD[scene]:
        act(pc)
        for _ in range(scans // 5):
            pc.board.advance(5)
            ci, cd = pc.board.state.ci, pc.board.state.cd
            bits = {"ModeReg": pcap.rdModeReg(), **bitwise(scans % 3)} if scene == "bits" else {}
            whole = {
                "error": pc.error(),
                "CI17": int(ci[17]),
                "CI99": int(ci[99]),
                "CD3": float(cd[3]),
                **bits,
            }
            for an, track in enumerate(tracks):
                track.append({**shown(an), **(whole if an == 0 else {})})
        ends.append(len(tracks[0]))
    pcap.detach()
    for an, track in enumerate(tracks):
        assert differs(f"{scene} {an}", written_down(f"{scene} {an}", track, ends), request) == ""
