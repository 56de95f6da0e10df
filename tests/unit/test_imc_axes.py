"""Every axis of a card has its own parameters: what the first one does, the third one does in the same cycles.

What every word of the first one does is written down in `tests/golden/imc/scenes.txt`, so that no number can change
unseen: of each scene and parameter the integer that it is at the end of each step, how often it changes, and the sum
over the cycles, each integer times the number of its cycle. After a wanted change: `--update-goldens`, and read the
difference.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.controllers.imc.core._homing import home_sequence
from polycnc.controllers.imc.core._instructions import (
    ChangeBits,
    InstallEvents,
    Points,
    Segment,
    WaitParam,
    WaitTime,
)
from polycnc.controllers.imc.core._parameters import PARAMETERS, Parameter, address
from polycnc.controllers.imc.core._state import CFIFO
from support.imc_card import FLAG, IFIFO, PFIFO1, PFIFO2, QFIFO, event, ready_card, set_now, setting

Steps: TypeAlias = list[tuple[int, dict[str, float]]]

# Of each scene: the axis in the card file, and what it is given, before so many cycles.
SCENES: dict[str, tuple[str, Steps]] = {
    "moves": (
        "lag_s = 0.004\ngain = 60.0\n",
        [
            (90, {"smooth": 7, "mcsmaxvel": 9, "mcsaccel": 0.7, "mcsdecel": 0.3, "breakp": 150, "encpfactor": 0.9,
                  "settlewin": 3, "settlen": 9, "trackwin": 20, "poserrlim": 600, "mcstgpos": 431, "mcsgo": FLAG}),
            (60, {"pcsmaxvel": 6, "pcsaccel": 0.4, "pcsdecel": 0.9, "shiftmaster": FLAG, "pcsdist": -83,
                  "pcsgo": FLAG}),
            (30, {"mcstrack": FLAG, "mcstgpos": 300, "mcsgo": FLAG, "pcstgvel": 2}),
            (20, {"pcstgvel": 0, "homepos": 77, "sethome": FLAG}),
            (20, {"clear": FLAG}),
        ],
    ),
    "home": (
        "origin = [500, 560]\nindex = { first = 13, pitch = 40 }\n",
        [(300, {"highvel": 8, "lowvel": 2, "homeseq": 0x5E, "homepos": 19, "homestpos": 55, "indexNum": 2,
                "mcsaccel": 2, "mcsdecel": 3, "gohome": FLAG})],
    ),
    "limits": (
        "limit_positive = 300\nlimit_negative = -250\n",
        [
            (60, {"aioctr": 0x000F, "stopfilt": 0xFFFE, "stopmode": 1, "exitfilt": 0, "mcstgvel": 9}),
            (100, {"clraiolat": 1, "error": 0, "stopfilt": 2, "stopmode": 2, "mcstgvel": -11}),
            (60, {"error": 0, "exitfilt": 4, "aioctr": 0xC000, "psoftlim": -50, "nsoftlim": -350, "mcstgvel": 6}),
        ],
    ),
    "speed": ("", [(40, {"vellim": 7, "accellim": 3, "mcsaccel": 2, "mcstgvel": 9})]),
    "ring": ("", [(80, {"ciraxis": FLAG, "cirpos": 90, "mcstgvel": 7}), (90, {"biciraxis": FLAG, "mcstgvel": -6})]),
    "gear": (
        "",
        [
            (30, {"mcsaccel": 0.6, "master": 1, "gearsrc": address("mcsvel"), "gearratio": -0.75, "engear": FLAG}),
            (20, {"gearoutmod": FLAG, "gearoutvel": -2.25, "engear": 0}),
            (40, {"syntype": FLAG, "synsrc": address("mcspos"), "synaxis": 1, "synsrcvar": 150, "slavedist": -90,
                  "enasyn": FLAG, "startsyn": FLAG}),
        ],
    ),
    "gears": (
        "lag_s = 0.006\ngain = 50.0\n",
        [
            (25, {"mcstgvel": 4, "mcsaccel": 0.9, "mcsdecel": 0.45, "master": 1, "gearsrc": address("encpvel"),
                  "gearratio": 1.375, "synsrc": address("ticks"), "synsrcvar": 13, "enasyn": FLAG, "engear": FLAG,
                  "startsyn": FLAG}),
            (20, {"engear": 0, "haltmode": FLAG, "haltstep": 1}),
            (20, {"haltstep": 0, "mcsdist": 70, "mcsgo": FLAG, "mcsmaxvel": 5}),
            (20, {"haltmode": 0, "haltstep": 1}),
            (15, {"haltstep": 0, "syntype": 0, "synsrcvar": 11, "mcstgvel": -3}),
            (30, {"enasyn": FLAG, "startsyn": FLAG}),
            (40, {"mcsdist": -33, "mcsgo": FLAG, "pcsdist": 21, "pcsaccel": 0.3, "pcsdecel": 0.6, "pcsgo": FLAG}),
            (30, {"pcstgpos": -15, "pcsmaxvel": 3, "pcsgo": FLAG, "pcstrack": FLAG}),
            (30, {"pcstgpos": 4, "exitfilt": 0, "fixvel": 2}),
        ],
    ),
    "far": (
        "lag_s = 0.003\ngain = 80.0\n",
        [
            (2, {"homepos": 131000, "sethome": FLAG}),
            (30, {"mcsmaxvel": 40, "mcsaccel": 6, "mcsdecel": 4, "mcstgpos": 131300,
                  "mcsgo": FLAG, "breakp": 131085, "encsfactor": 400.25, "spin_handwheel": 21, "encpctr": 0x400}),
            (20, {"capture": FLAG, "touch_probe": 0, "pcsdist": -70000, "pcsmaxvel": 5000, "pcsaccel": 1200,
                  "pcsdecel": 900, "pcsgo": FLAG}),
            (30, {"aioctr": 0x8000, "nsoftlim": 65530, "stopfilt": 8, "mcstgvel": -900, "mcsdecel": 60,
                  "mcsaccel": 200, "spin_handwheel": -30}),
            (30, {"cirpos": 70001, "ciraxis": FLAG, "error": 0, "aioctr": 0, "mcstgvel": 30000}),
        ],
    ),
    "home back": (
        "origin = [-420, -380]\n",
        [(170, {"highvel": 7, "lowvel": 1.5, "homeseq": home_sequence(
            switch=True, index=False, negative=True, rising=True, go_to=True, returns=2),
            "homepos": -23, "homestpos": -60, "mcsaccel": 1.5, "mcsdecel": 0.8, "gohome": FLAG})],
    ),
    "home by index": (
        "index = { first = 31, pitch = 45 }\nlimit_positive = 120\n",
        [
            (60, {"highvel": 3, "homeseq": home_sequence(switch=False, index=True, negative=False, rising=False,
                  go_to=False), "indexNum": 3, "homepos": 11, "gohome": FLAG, "aioctr": 2, "stopfilt": 0}),
            (60, {"run": FLAG, "mcstgvel": 6, "exitfilt": 0, "stopmode": 0, "stopfilt": 0xFFFF}),
        ],
    ),
    "encoders": (
        "",
        [
            (20, {"encsfactor": 1.5, "spin_handwheel": 3, "encpctr": 0x400, "mcstgvel": 4}),
            (20, {"touch_probe": 0, "spin_handwheel": -2}),
            (20, {"capture": FLAG, "clrencs": FLAG}),
        ],
    ),
    "ends": (
        "",
        [
            (3, {"homepos": 2_147_000_003, "sethome": FLAG}),
            (25, {"vellim": 32767.5, "accellim": 32767.5, "mcsmaxvel": 31000.3, "mcsaccel": 12000.7, "mcsdecel": 9000.1,
                  "mcsdist": -1_900_000_001, "mcsgo": FLAG, "breakp": 2_146_900_001, "clear": 0}),
            (20, {"pcsmaxvel": 30000.7, "pcsaccel": 9000.3, "pcsdecel": 8000.1, "pcsdist": 1_700_000_003,
                  "pcsgo": FLAG, "shiftmaster": FLAG, "capture": FLAG}),
            (12, {"pcstgvel": 0, "mcstgvel": -0.3, "aioctr": 0xC000, "psoftlim": 2_147_000_000, "nsoftlim": 16_777_219,
                  "stopfilt": 8, "exitfilt": 0}),
            (12, {"mcstgvel": 20000.1, "pcstgpos": -1_000_000_001, "pcsgo": FLAG}),
            (12, {"mcstgpos": 16_777_217, "mcsgo": FLAG, "mcsmaxvel": 12.3, "haltstep": 1, "haltmode": FLAG}),
            (8, {"haltstep": 0, "ciraxis": FLAG, "cirpos": 2_100_000_001, "biciraxis": FLAG}),
            (8, {"homepos": -2_147_000_001, "sethome": FLAG, "nsoftlim": -2_147_000_003}),
            (6, {"mcsvel": 100.3, "pcsvel": -230.7, "ciraxis": 0}),
            (6, {"run": 0}),
        ],
    ),
    "far gears": (
        "",
        [
            (20, {"vellim": 32767, "accellim": 32767, "mcsaccel": 2000.3, "mcsdecel": 3000.1, "master": 1,
                  "gearsrc": address("curvel"), "gearratio": -4321.1, "engear": FLAG}),
            (10, {"gearoutmod": FLAG, "gearoutvel": 30000.3, "engear": 0}),
            (15, {"syntype": FLAG, "slaveabs": FLAG, "synsrc": address("curpos"), "synaxis": 1,
                  "synsrcvar": 33_000_001, "slavedist": -1_800_000_001, "enasyn": FLAG, "startsyn": FLAG}),
            (10, {"enasyn": 0, "syntype": 0, "synsrcvar": 7, "mcstgvel": 20000.3}),
            (12, {"enasyn": FLAG, "startsyn": FLAG}),
            (12, {"mcstgvel": 0, "encsfactor": 50000.3, "spin_handwheel": -7, "encpfactor": 40000.3,
                  "gearsrc": address("mcsvel"), "gearratio": 300.3}),
            (12, {"engear": FLAG, "poserrlim": 60001, "settlewin": 50003, "trackwin": 40001, "smooth": 3,
                  "indexNum": 60003}),
            (8, {"encsfactor": 1.3, "spin_handwheel": 7}),
        ],
    ),
    "far home": (
        "origin = [500, 560]\n",
        [(120, {"highvel": 23.3, "lowvel": 1.7, "homeseq": 0x14 | 0x20 | 2, "homepos": 1_000_000_019,
                "homestpos": 1_000_000_351, "mcsaccel": 2.3, "mcsdecel": 3.1, "gohome": FLAG})],
    ),
}  # fmt: skip
# What the whole card does: what is written to it, or pushed into a queue, before so many cycles.
CARD: dict[str, list[tuple[int, list[tuple[Any, ...]]]]] = {
    "paths": [
        (
            40,
            [
                ("segmap_x1", 1), ("segmap_y1", 0), ("segmap_z1", 2), ("pathacc1", 0.75), ("segtgvel1", 7),
                ("segendvel1", 1.5), ("pathabs", FLAG), ("pathabs", FLAG, 1), ("mcstgvel", 3, 3), ("startpath1", FLAG),
                (PFIFO1, Segment((130, -70))),
                (PFIFO1, Segment((150, -40, 35), speed=5 << 16, end_speed=1 << 15)),
            ],
        ),
        (40, [("feedrate1", 1.25), (PFIFO1, Segment((110, -10, 60), center=(140, -20), clockwise=True))]),
        (25, [("hpause", 1)]),
        (
            60,
            [
                ("hpause", 0), ("mcstgvel", 0, 3), ("feedrate1", 0.5), ("asseglen1", 2), ("segmap_x2", 3),
                ("segmap_y2", 2), ("pathaxisnum2", 2), ("pathacc2", 1.25), ("segtgvel2", 9),
                ("startpath2", FLAG), (PFIFO2, Points((25, -15, 30, -5, 35, 10))),
                (PFIFO2, Segment((40, -30), center=(10, 15), speed=6 << 16)),
                (PFIFO1, Segment((95, 20, 80), speed=8 << 16)),
            ],
        ),
        (20, [("startpath1", 0)]),
    ],
    "contour": [
        (
            20,
            [
                ("groupnum", 3), ("group_x", 2), ("group_y", 0), ("group_z", 3), ("groupsmooth", 4),
                ("startgroup", FLAG), ("ticks", 2**32 - 30),
                (CFIFO, 9, -7, 5, 13, -11, 3, 15, -6, -2, 17, 4, -8, 6, 10, 2),
                ("delayus", 90000), ("timer", 21),
            ],
        ),
        (12, [("hpause", 1)]),
        (12, [("hpause", 0), (CFIFO, 5, 6, 7)]),
        (5, [(CFIFO, 401, -302, 203, 10, 20, 30)]),
        (6, [("startgroup", 0)]),
        (3, [("startgroup", FLAG)]),
        (10, [("emstop", 0x0010)]),
    ],
    "queue": [
        (
            30,
            [
                ("ticks", 65520),
                (QFIFO, setting("user16b3", 5)), (QFIFO, WaitTime(7)), (QFIFO, setting("user32b2", -70000)),
                (QFIFO, ChangeBits(address("user16b3"), 6, 12)), (QFIFO, WaitParam(address("user16b2"), 9, 12, 0, 11)),
                (QFIFO, setting("user48b1", -(1 << 40))), (QFIFO, WaitParam(address("user16b2"), 77)),
                (QFIFO, setting("mcsdist", 9, 1)), (QFIFO, setting("mcsgo", FLAG, 1)), (QFIFO, WaitTime(0)),
            ],
        ),
        (20, [("user16b2", 77), (IFIFO, InstallEvents((event("ADD32i", first=address("user32b2"), constant=3,
                                                             target=address("user32b2")),)))]),
        (20, [("clrqfifo", 0), ("gio", 0x1234), ("giod", 0x4321), ("events", 0), (QFIFO, setting("timer", 40))]),
        (5, [("clear", FLAG, 2)]),
    ],
}  # fmt: skip
CARD_ROWS = (
    "param.segmap_x1", "param.segmap_x2", "param.pathaxisnum2", "param.segtgvel1", "param.segtgvel2", "param.pathacc1",
    "param.pathacc2", "param.segabs", "param.feedoverride", "param.pfifoenable", "param.hpause", "param.emstop",
    "param.groupnum", "param.groupsmooth", "param.startgroup", "param.group_x", "param.group_y", "param.group_z",
    "param.cfifocnt", "param.delayus", "param.timer", "param.ticks", "param.events", "param.clrqfifo", "param.clear",
    "param.contouring", "param.user16b3", "param.user32b2", "param.user48b1", "concept.contour", "concept.pfifo1",
    "concept.pfifo2", "concept.qfifo", "concept.atomic_rmw", "concept.segment_blocking", "event.CMD_ADD32i",
    "etype.IMC_Allways",
)  # fmt: skip
SHOWN = (
    "curpos", "curvel", "motion", "run", "error", "encp", "poserr", "status", "moving", "mcsvel", "pcsvel", "mcspos",
    "pcspos", "mcsslope", "pcsslope", "mcsmoving", "pcsmoving", "profiling", "smoothing", "outsettle", "outtrack",
    "encpvel", "encs", "encsvel", "cappos", "aio", "aiolat", "mcsdist", "pcstgpos", "pcstrack",
)  # fmt: skip
NAMES = sorted({name for _, steps in SCENES.values() for _, given in steps for name in given} | set(SHOWN))
NO_ROWS = {"spin_handwheel", "touch_probe", "homestpos", "biciraxis", "haltmode", "haltstep"}
FLAGS = {
    "mcsgo", "pcsgo", "mcstrack", "pcstrack", "shiftmaster", "engear", "gearoutmod", "ciraxis", "biciraxis", "enasyn",
    "startsyn", "syntype", "slaveabs", "sethome", "gohome", "haltstep", "haltmode",
}  # fmt: skip
RECORDED = Path(__file__).parents[1] / "golden" / "imc" / "scenes.txt"


def numbers(each: Parameter, memory: npt.NDArray[np.int16]) -> list[int]:
    """Return what a parameter is in each of some copies of memory, as integers."""
    words = memory[:, each.address : each.address + each.words].astype(np.int64) % 65536
    raw = (words << 16 * np.arange(each.words)).sum(axis=1)
    half = 1 << 16 * each.words - 1
    return [int(one - 2 * half if each.is_signed and one >= half else one) for one in raw]


def written_down(name: str, scope: str, memory: list[npt.NDArray[np.int16]], ends: list[int]) -> str:
    """Return what the parameters of the card or of an axis have done in a scene."""
    lines, copies = [f"# {name}"], np.stack(memory)
    for each in PARAMETERS.values():
        if each.scope != scope:
            continue
        values = numbers(each, copies)
        changes = sum(a != b for a, b in pairwise(values))
        if changes == 0 and (each.access != "ro" or values[0] == 0):
            continue
        total = sum(k * one for k, one in enumerate(values, 1))
        lines.append(f"{each.name} {' '.join(str(values[end - 1]) for end in ends)} / {changes} / {total}")
    return "\n".join([*lines, ""])


def is_as_recorded(name: str, found: str, request: pytest.FixtureRequest) -> None:
    """Compare a scene with what is written down of it, line by line."""
    text = RECORDED.read_text(encoding="utf-8")
    parts = {part.split("\n", 1)[0]: f"# {part}" for part in text.split("# ")[1:]}
    if request.config.getoption("update_goldens"):
        RECORDED.write_text("".join((parts | {name: found}).values()), encoding="utf-8")
    else:
        assert found.splitlines() == parts[name].splitlines()


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.covers(*(f"imc.param.{name}" for name in NAMES if name not in NO_ROWS))
def test_the_third_axis_does_what_the_first_one_does(scene: str, request: pytest.FixtureRequest) -> None:
    axis_text, steps = SCENES[scene]
    tracks = []
    for axis in (0, 2):
        text = "".join(f"[[axis]]\n{axis_text if k == axis else ''}" for k in range(4))
        card = ready_card(text)
        set_now(card, ("mcstgvel", 5, 1))
        track, ends = [], []
        for cycles, given in steps:
            for name, value in given.items():
                if name == "touch_probe":
                    card.touch_probe(axis)
                elif name == "spin_handwheel":
                    card.spin_handwheel(axis, value)
                else:
                    set_now(card, (name, value, axis))
            for _ in range(cycles):
                card.advance(1)
                track.append(np.array(card.state.memory[axis]))
            ends.append(len(track))
        tracks.append(track)
    assert all((one == other).all() for one, other in zip(*tracks, strict=True))
    is_as_recorded(scene, written_down(scene, "A", tracks[0], ends), request)


COMMANDED = ("curpos", "curvel", "mcspos", "pcspos", "encp", "error", "motion", "homed")


@pytest.mark.covers(*(f"imc.param.{name}" for name in sorted(FLAGS - {"haltstep", "haltmode", "biciraxis"})))
def test_any_number_but_0_sets_a_flag() -> None:
    for name in ("gear", "gears", "ring", "home back", "ends", "far gears"):
        axis_text, steps = SCENES[name]
        tracks = []
        for flag in (FLAG, 1, 0x2000):
            card = ready_card(f"[[axis]]\n{axis_text}[[axis]]\n")
            set_now(card, ("mcstgvel", 5, 1))
            track = []
            for cycles, given in steps:
                for each, value in given.items():
                    if each != "spin_handwheel":
                        set_now(card, (each, flag if each in FLAGS and value == FLAG else value))
                for _ in range(cycles):
                    card.advance(1)
                    track.append([card.read(each) for each in COMMANDED])
            tracks.append(track)
        assert tracks[0] == tracks[1] == tracks[2], name


@pytest.mark.parametrize("scene", CARD)
@pytest.mark.covers(*(f"imc.{row}" for row in CARD_ROWS))
def test_the_whole_card_is_as_written_down(scene: str, request: pytest.FixtureRequest) -> None:
    card = ready_card("".join("[[axis]]\n" for _ in range(4)))
    track, ends = [], []
    for cycles, told in CARD[scene]:
        for first, *rest in told:
            if isinstance(first, str):
                set_now(card, (first, *rest))
            elif first == CFIFO:
                assert card.push_points(rest)
            else:
                assert card.push(first, rest[0])
        for _ in range(cycles):
            card.advance(1)
            track.append(np.array(card.state.memory))
        ends.append(len(track))
    found = written_down(scene, "G", [each[4] for each in track], ends)
    for axis in range(4):
        found += written_down(f"{scene} {axis}", "A", [each[axis] for each in track], ends)
    for part in found[2:].split("\n# "):
        is_as_recorded(part.split("\n", 1)[0], f"# {part}", request)
