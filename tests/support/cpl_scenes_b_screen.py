"""A scene of the screen: lines, circles, fillings, texts, fonts, colours, bitmaps, and where each ends."""

from __future__ import annotations

import struct
from contextlib import suppress

from polycnc.controllers.bosch.screen import KEYS
from polycnc.errors import UsageError
from polycnc.nc.cpl import OMITTED
from support.cpl_scenes_b import Bench, Place, scene
from support.cpl_scenes_b_asked import show

_ = OMITTED
_ROWS = ("000000 00ff00 0000ff", "ff0000 ffffff ffff00")  # from below, as bitmaps are
BITMAP = (
    b"BM" + struct.pack("<IHHI", 54 + 12 * 2, 0, 0, 54)
    + struct.pack("<IiiHHIIiiII", 40, 3, 2, 1, 24, 0, 24, 0, 0, 0, 0)
    + b"".join(b"".join(bytes.fromhex(each)[::-1] for each in row.split()).ljust(12, b"\0") for row in _ROWS)
)  # fmt: skip
"""Red, white and yellow above black, green and blue."""


FORMATS = (
    "I%", "R", "D!", "T$", "B?", '"A ##.# B ### C",R,I%', '"#",I%', '"##",I%', '"#.#",R', '"##.#",R',
    '"###.###",99.9996', '"[##]",I%', 'I%,R', '"##",T$,I%', '"A","B",I%', '"##.##",I%', '"###",R', '"######",1E5',
    "1E10", "0.0001", "-0.5",
)  # fmt: skip


@scene
def screen(b: Bench) -> None:
    """What each function of the screen draws and writes, to the ends of its arguments; refused ones draw nothing."""
    (b.folder / "cplbmp").mkdir()
    (b.folder / "cplbmp" / "m.bmp").write_bytes(BITMAP)
    b.run("1 A=1", 20)
    show(b, ("CLS",))
    for kind in (0, 3, 4, 5, -1, 1.0):
        show(b, ("CLR",), ("GMD", kind), ("LIN", 10, 20, 60, 20), ("LIN", 10, 25, 40, 55))
    for kind in (1, 2, 2, 1, 2):
        show(b, ("GMD", kind), ("LIN", 10, 20, 60, 20), ("LIN", 10, 25, 40, 55))
    show(b, ("GMD", 0), ("CLR",), ("LIN", 0, 0, 632, 374), ("LIN", 632, 374, 632, 0), ("LIN", 0, 0, 633, 0))
    show(
        b, ("CLR",), ("LIN", 5, 6), ("LIN", _, 9), ("LIN", 12, _), ("LIN", 1.5, 2.4, 7.5, 8.6), ("LIN", -5, 3)
    )
    show(
        b,
        ("CLS",),
        ("COL", 3),
        ("CIR", 100, 80, 10),
        ("CIR", _, 120, _),
        ("CIR", 130, 80, 0),
        ("CIR", 130, 80, -1),
    )
    show(
        b,
        ("CLS",),
        ("CIR", 200, 0, _, _, 200, 10),
        ("CIR", 50, 50, 70, 70, 70, 50),
        ("CIR", 300, 60, 300, 40, 300, 50),
    )
    for edges in (
        (0, 632, 0, 374),
        (10, 110, 20, 70),
        (0, 633, 0, 374),
        (-1, 9, 0, 9),
        (5, 5, 0, 9),
        (0, 9, 9, 9),
        (0, 9, 0, 375),
    ):
        show(b, ("GWD", *edges), ("CLR",), ("LIN", 0, 0, 632, 374), ("CIR", 60, 40, 30))
    show(
        b,
        ("GWD", 100, 300, 50, 150),
        ("MWD", 0, 20, 0, 10),
        ("LIN", 0, 0, 20, 10),
        ("LIN", 10, 5),
        ("CIR", 10, 5, 2),
    )
    show(b, ("MWD", 0, 20, 0, 20), ("LIN", 0, 0, 20, 20), ("MWD", 9, 9, 0, 1), ("MWD", 0, 1, 5, 4))
    show(
        b,
        ("CLS",),
        ("GWD", 0, 632, 0, 374),
        ("COL", 5),
        ("LIN", 10, 10, 30, 10),
        ("LIN", 30, 30),
        ("LIN", 10, 30),
        ("LIN", 10, 10),
    )
    for more in ((0, 4, 5), (0, 6), (5, 2, 5), (6, 2), (-1, 2), (0, 8), (0, -1), (0, 7, 8)):
        show(b, ("FIL", 20, 20, *more))
    show(b, ("FIL", 633, 20, 0, 3), ("FIL", 20, 375, 0, 3), ("CLG",), ("DLF",))
    colours: list[Place] = [(0, 1), (7, 7), (8,), (-1,), (1.5,), (_, 3, 1), (_, _, 6)]
    for codes in colours:
        show(b, ("CLS",), ("COL", *codes), ("LIN", 1, 1, 4, 1), ("DSP", 1, 1, "A"))
    for table in (7, 10, 1, 2, 3, 4):
        show(
            b,
            ("LIN", table, 7, 40, 8),
            ("COL", 2, 4, 3, table, 6, 5),
            ("LIN", 1, 1, 9, 1),
            ("DSP", 3, 4, "TABLE"),
        )
    for portions in (
        (0, 255, 0, 0),
        (7, 1, 2, 3),
        (8, 0, 0, 0),
        (-1, 0, 0, 0),
        (3, 256, 0, 0),
        (3, 0, -1, 0),
        (3, 0, 0, 256),
    ):
        show(b, ("RGB", *portions))
    show(b, ("CLS",), ("COL", 1, 2, 0, 7))
    for line, column in ((1, 1), (46, 79), (0, 1), (47, 1), (1, 0), (1, 80), (20, 40)):
        show(b, ("DSP", line, column, "<AB>"))
    show(b, ("DSP", 16, 1, "T" * 77), ("DSP", 17, 1, "T" * 78))
    show(b, ("CLS",))
    for row, what in enumerate(FORMATS, 1):
        b.run(f'1 I%=42 : R=-3.25 : D!=1.5 : T$="AB" : B?=TRUE\n2 DSP({row},3,{what})\n3 WAIT\nN4 M0', 10)
        b.note(f"DSP({row},3,{what})", repr(b.pnc.screen().lines()[row - 1].rstrip()))
        b.note(" ".join(alarm.text for alarm in b.pnc.status().alarms) or "shown")
        b.pnc.reset()
        b.pnc.advance(2)
    b.run("1 CLS\nN2 M0", 10)
    for place in ((0, 0), (632, 414), (633, 0), (0, 415), (-1, 0), (0, -1), (40, 50)):
        show(b, ("GPR", *place, "GRAPHIC"))
    for font in (0, 5, 10, 11, -1):
        show(b, ("CLS",), ("TFO", font, 12, 1, 90), ("DSP", 4, 5, "FONT"))
    sizes: list[Place] = [
        (1, 500),
        (1, 501),
        (1, 0),
        (1, 500500),
        (1, 501012),
        (1, 12501),
        (1, -1),
        (1, 20008),
        (1, 1000),
    ]
    cuts: list[Place] = [
        (1, 8, 3, 360),
        (1, 8, 4),
        (1, 8, -1),
        (1, 8, 2, 361),
        (1, 8, 0, -1),
        (_, _, 3),
        (5, 8, 0, 45),
        (0, 0, 0, 0),
    ]
    for chosen in (*sizes, *cuts):
        show(b, ("CLS",), ("TFO", *chosen), ("GPR", 9, 9, "F"))
    for copy in (_, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, -1):
        show(b, ("CLS",), ("COL", 3), ("LIN", 20, 40, 21, 40), ("BMP", 20, 40, "m", copy))
    for place in ((0, 0), (632, 374), (633, 0), (0, 375), (-1, 0), (0, -1)):
        show(b, ("CLS",), ("BMP", *place, "m"))
    b.say("keys that INKEY and SFK read, in the order in which they were pressed")
    for key in ("\x01", "A", "a", "~", "\x7f", "\x80", "AB", "", *KEYS):
        with suppress(UsageError):
            b.pnc.press(key)
            b.note(f"{key!r}", b.call("INKEY"))
    b.note("none", b.call("INKEY"))
    show(b, ("BMP", 1, 1, "none"), ("BMP", 1, 1, "n" * 70), ("BMP", 1, 1, "n" * 71), ("BMP", 1, 1, "../m"))
