"""Faults planted in programs whose body is found (`auto`): each at its block, and nothing in the same without it."""

from __future__ import annotations

import pytest

from polycnc import runner

MILL = "(T1 D=8 flat end mill)\n(T2 D=5 drill)\nG21 G90 G17 G94 G54\nS3000 M3\n"
CONTOUR = f"""{MILL}T1 M6
G0 X-8 Y-4 Z30
Z-3
G1 X60 F800
Y44
X-4
Y-4
G0 Z2
X-8 Y-4
Z-6
G1 X60
Y44
X-4
Y-4
G0 Z30
M30
"""
POCKET = f"""{MILL}T1 M6
G0 X25 Y12 Z30
Z2
G1 Z-2.5 F250
X50 F800
Y25
X25
Y12
Z-5 F250
X50 F800
Y25
X25
Y12
G0 Z30
M30
"""
HOLES = f"""{MILL}T2 M6
G0 X10 Y11 Z30
G99 G81 X10 Y11 Z-15 R2 F600
X40
G83 X40 Y30 Z-18 R2 Q9 F600
X10
G80
G0 Z50
M30
"""
ZIGZAG = f"""{MILL}T1 M6
G0 X-8 Y5 Z30
Z-2
G1 X58 F2000
G0 Y12
G1 X-8
G0 Z30
X-8 Y19
Z-2
G1 X58
G0 Z30
M30
"""
SHAFT = """%
(T1 CNMG120408 roughing)
(T3 grooving 3 mm)
(T5 thread 60 deg)
G21 G18 G40 G99
T0101
G97 S800 M4
G0 X40 Z2
G1 X30 F.5
Z-40 F0.25
X37
G0 Z2
X24
G1 Z-25
X31
G0 X60 Z50
T0303
G0 X37.6 Z-41
G1 X26 F0.4
G0 X60
Z50
T0505
G0 X26 Z3
G32 X23.4 Z-20 F1.5
G0 X30
Z50
M30
"""
# Zero is at the bottom of the part, and home where nobody has set it.
HOMING = f"""{MILL}G28 G91 Z0
G90 T1 M6
G0 X-10 Y10 Z30
Z14
G1 Z8 F500
X50 F900
Y20
X-10
G0 Z30
G53 Z0
G28 G91 X0 Y0
G90 M30
"""
AROUND = f"""{MILL}T1 M6
G0 X-4 Y-4 Z30
Z2
G1 Z-3 F250
X60 F800
Y44
X-4
Y-4
G0 Z30
M30
"""
PROGRAMS = {
    "around": AROUND,
    "around from a side": AROUND.replace("X-4 Y-4 Z30", "X20 Y-4 Z30").replace("Y-4\nG0", "Y-4\nX20\nG0"),
    "around from beside": AROUND.replace("X-4 Y-4 Z30", "X-9 Y-4 Z30").replace("G1 Z-3 F250", "Z-3\nG1"),
    "contour": CONTOUR, "pocket": POCKET, "holes": HOLES, "zigzag": ZIGZAG, "shaft": SHAFT, "homing": HOMING,
    "shaft homing": SHAFT.replace("G0 X60 Z50", "G28 U0 W0").replace("G0 X60\nZ50", "G28 U0 W0"),
    "shaft, unknown tool": SHAFT.replace("(T1 CNMG120408 roughing)", ""),
}  # fmt: skip
# The program, what is right, what is wrong instead, and all that is said of it.
FAULTS = {
    "a rapid along the outermost cut": (
        "contour", "G1 X60\nY44\nX-4", "G1 X60\nG0 Y44\nG1 X-4", [("rapid", 16)],
    ),
    "a rapid along the first outermost cut": ("contour", "F800\nY44", "F800\nG0 Y44\nG1", [("rapid", 9)]),
    "a way down at rapid": ("pocket", "G1 Z-2.5 F250\nX50", "G0 Z-2.5\nG1 X50", [("rapid", 8)]),
    "a later way down at rapid": ("pocket", "Z-5 F250\nX50", "G0 Z-5\nG1 X50", [("rapid", 13)]),
    "a drill that gets down at rapid": ("holes", "R2 F600", "R-2 F600", [("rapid", 7), ("rapid", 8)]),
    "a drill that drags": ("holes", "X40\nG83", "G0 X40 Z-5\nG83", [("rapid", 8)]),
    "an outermost cut at rapid": ("zigzag", "Z-2\nG1 X58\nG0", "Z-2\nG0 X58\nG0", [("rapid", 14)]),
    "a bar that is turned at rapid": ("shaft", "X24\nG1 Z-25", "X24\nG0 Z-25", [("rapid", 14)]),
    "a rapid before the way home": ("homing", "G0 Z30\nG53", "G0 Z7\nG53", [("rapid", 13)]),
    "a groove at rapid after a way home": ("shaft homing", "G1 X26 F0.4", "G0 X26", [("rapid", 19)]),
    "a way down at rapid at a corner": ("around", "G1 Z-3 F250\nX60", "Z-3\nG1 X60", [("rapid", 8)]),
    "a way down at rapid on a side": ("around from a side", "G1 Z-3 F250\nX60", "Z-3\nG1 X60", [("rapid", 8)]),
    "a groove at rapid": ("shaft", "G1 X26 F0.4", "G0 X26", [("rapid", 19)]),
    "a spindle that turns the other way later": ("shaft", "Z2\nX24\n", "Z2 M3\nX24\n", [("direction", 14)]),
}  # fmt: skip


def looked_at(name: str, text: str) -> list[tuple[str, int]]:
    machine, dialect = ("lathe2", "fanuc-lathe") if "shaft" in name else ("mill3", "fanuc")
    report = runner.inspect(
        text, machine, dialect, stock="auto", resolution_mm=0.05 if "shaft" in name else 0.5
    )
    assert not report.errors
    return [(each.key, each.position.line if each.position else 0) for each in report.remarks]


@pytest.mark.parametrize("name", PROGRAMS)
def test_what_is_right_is_not_remarked(name: str) -> None:
    found = looked_at(name, PROGRAMS[name])
    assert found == ([("unknown_tool", 1)] * 2 if "unknown" in name else [])


@pytest.mark.parametrize("fault", FAULTS)
def test_a_planted_fault_is_found_at_its_block(fault: str) -> None:
    name, right, wrong, said = FAULTS[fault]
    assert PROGRAMS[name].count(right) == 1
    found = looked_at(name, PROGRAMS[name].replace(right, wrong))
    assert [each for each in found if each[0] != "rapid_in_material"] == said
