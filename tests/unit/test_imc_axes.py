"""Every axis of a card has its own parameters: what the first one does, the third one does in the same cycles."""

from __future__ import annotations

from typing import TypeAlias

import pytest

from polycnc.controllers.imc.core._parameters import address
from support.imc_card import FLAG, ready_card, set_now

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
            (20, {"gearoutmod": FLAG, "gearoutvel": 2, "engear": 0}),
            (40, {"syntype": FLAG, "synsrc": address("mcspos"), "synaxis": 1, "synsrcvar": 150, "slavedist": -90,
                  "enasyn": FLAG, "startsyn": FLAG}),
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
}  # fmt: skip
SHOWN = (
    "curpos",
    "curvel",
    "motion",
    "run",
    "error",
    "encp",
    "poserr",
    "status",
    "moving",
    "mcsvel",
    "pcsvel",
)
NAMES = sorted({name for _, steps in SCENES.values() for _, given in steps for name in given} | set(SHOWN))
NO_ROWS = {"spin_handwheel", "touch_probe", "homestpos", "biciraxis"}


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.covers(*(f"imc.param.{name}" for name in NAMES if name not in NO_ROWS))
def test_the_third_axis_does_what_the_first_one_does(scene: str) -> None:
    axis_text, steps = SCENES[scene]
    tracks = []
    for axis in (0, 2):
        text = "".join(f"[[axis]]\n{axis_text if k == axis else ''}" for k in range(4))
        card = ready_card(text)
        set_now(card, ("mcstgvel", 5, 1))
        track = []
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
                track.append(bytes(card.state.memory[axis]))
        tracks.append(track)
    assert tracks[0] == tracks[1]
    assert len(set(tracks[0])) > 4  # something happens
