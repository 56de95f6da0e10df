"""What a control is asked for the golden files of the FOCAS protocol, and the files' text.

`python tests/support/focas_scenes.py` (from the project's folder, `PYTHONPATH=tests`) writes them anew.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.wire import PMC, Frame, FrameReader, FrameType, Request, Value8, write_requests
from polycnc.servers.focas import PROFILES, Dissector, FocasControl, Session, load_profile

GOLDEN = Path(__file__).parents[1] / "golden" / "focas"
PROGRAM = b"O0815 (SLOW SQUARE)\nN10 G90 G1 G54 F600 X-12.5 S350 M3\nN20 Y7.25\nN30 X0\nM30\n"
FOLDER = b"//CNC_MEM/USER/PATH1/"
ALL = -1


def path(name: bytes = b"") -> bytes:
    """Return a path in the 256 bytes of a request."""
    return (FOLDER + name).ljust(256, b"\0")


def r(code: int, *arguments: int, data: bytes = b"", target: int = 1) -> Request:
    """Return a request."""
    padded = (*arguments, 0, 0, 0, 0)
    return Request(code, (padded[0], padded[1], padded[2], padded[3]), data, target)


SCENES: tuple[tuple[str, tuple[Request, ...]], ...] = (
    ("system", (r(0x18),)),
    ("state, as the library asks for it", (r(0x19), r(0xE1), r(0x98))),
    (
        "dynamic data of all axes",
        (
            r(0x1A),
            r(0x1C),
            r(0x1D),
            r(0x24),
            r(0x25),
            r(0x26, 4, ALL),
            r(0x26, 1, ALL),
            r(0x26, 6, ALL),
            r(0x26, 7, ALL),
        ),
    ),
    ("dynamic data of axis 2", (r(0x26, 4, 2), r(0x26, 1, 2), r(0x26, 6, 2), r(0x26, 7, 2))),
    (
        "positions, one kind",
        (r(0xA4), r(0x89, ALL), r(0x88, 1), r(0x88, 2), r(0xA3, 0, ALL), r(0x26, 0, 1), r(0xA4)),
    ),
    ("skip, servo delay, acceleration delay", (r(0x26, 8, 1), r(0x26, 9, 1), r(0x26, 10, 1), r(0x26, 5, 1))),
    ("servo meter", (r(0xA4, 2), r(0x89), r(0x56, 1), r(0xA4, 2))),
    ("servo current, which is not known", (r(0x56, 3),)),
    ("spindle meter", (r(0xA4, 1), r(0x8A), r(0x40, 4, ALL), r(0x40, 5, ALL), r(0xA4, 1))),
    ("highest spindle speed", (r(0x40, 1, 1), r(0x40, 2, 1))),
    (
        "alarms with and without texts",
        (r(0x23, ALL, 10, 2, 64), r(0x23, ALL, 10, 0, 0), r(0x23, 4, 10, 1, 32)),
    ),
    ("messages", (r(0x34, 0), r(0x34, 4), r(0x34, 5))),
    ("figures", tuple(r(0x1B, kind) for kind in range(6))),
    ("program in execution", (r(0x20, 24), r(0xCF), r(0xFC))),
    ("directory", (r(0x06, 1, 19, 2), r(0x06, 816, 19, 2))),
    ("modal G codes", (r(0x96, 0, 0), r(0x96, 13, 0), r(0x96, 24, 0))),
    ("commanded words", (r(0x97, 103, 0), r(0x97, 130, 0))),
    ("operator's panel", (r(0x5D, 0xFFFF),)),
    ("date and time", (r(0x45, 0), r(0x45, 1))),
    ("timers", (r(0x120, 0), r(0x120, 1), r(0x120, 5))),
    ("macro variables, vacant, missing", (r(0x15, 500, 501), r(0x15, 5000, 5000), r(0xA7, 500, 2), r(0x17))),
    (
        "writing macro variables",
        (
            r(0x16, 510, 510, data=bytes(Value8(3125, 3))),
            r(0x15, 510, 510),
            r(0xA8, 511, 1, data=bytes.fromhex("c002000000000000")),
            r(0x15, 511, 511),
        ),
    ),
    ("parameter of the old series", (r(0x0E, 6711, 6711, 0), r(0x0E, 1320, 1320, ALL), r(0x10, 6711, 2))),
    ("parameter of the new series", (r(0x8D, 6711, 6711, 0), r(0x8D, 1320, 1320, 2))),
    ("what parameters and diagnosis data are", (r(0xA0, 6711, 2), r(0xA2, 300, 2), r(0xA2, 9000, 1))),
    ("executed blocks", (r(0x35),)),
    ("settings", (r(0x29, 6711, 6711, 0), r(0x90, 6711, 6711, 0))),
    ("diagnosis", (r(0x30, 300, 300, ALL), r(0x93, 300, 301, 2))),
    (
        "tool offsets",
        (
            r(0x08, 3, 4, 1003),
            r(0x08, 3, 3, 1001),
            r(0x0A),
            r(0x09, 4, 4, 1003, data=bytes.fromhex("fffffb2e0000ffff")),
            r(0x08, 4, 4, 3),
        ),
    ),
    (
        "work offsets",
        (
            r(0x0B, 1, 1, 1),
            r(0x0B, 1, 1, 0),
            r(0x0C, 2, 2, 2, data=bytes.fromhex("000004d20000ffff")),
            r(0x0B, 2, 2, 2),
        ),
    ),
    ("tool life, an option that is not there", (r(0x4A), r(0x8B, 1, 1), r(0x48))),
    ("folders", (r(0xAE), r(0xB0, 1), r(0xB4, data=path()), r(0xB3, 0, 10, 0, 1, data=path()), r(0xB9))),
    ("lines of a program", (r(0xF0, 1, 2, data=path(b"O815")), r(0xF0, 1, 2, data=path(b"O4")))),
    (
        "PMC bytes, words, double words",
        (
            r(0x8001, 12, 13, 0, 0, target=PMC),
            r(0x8001, 100, 103, 9, 1, target=PMC),
            r(0x8001, 100, 103, 9, 2, target=PMC),
        ),
    ),
    (
        "writing the PMC",
        (r(0x8002, 5, 5, 5, 0, data=b"\x5a", target=PMC), r(0x8002, 5, 5, 3, 0, data=b"\1", target=PMC)),
    ),
    (
        "what no layout is known of",
        (r(0x21), r(0x22), r(0x61), r(0x63), r(0x8E), r(0xFD), r(0x8003, target=PMC)),
    ),
)


def scene_control(profile: str) -> FocasControl:
    """Return a control in the middle of a program, with something of everything."""
    made = PowerMate(3)
    made.programs.register(815, PROGRAM)
    made.select_program(815)
    made.parameters.set(6711, 7)
    made.macros.set(500, -2.625)
    made.tool_offsets.set_all({3: 12345})
    made.pmc.write("D", 100, bytes((0x12, 0x34, 0x56, 0x78)))
    made.control.offsets.set("G54", {"X": 1.5, "Z": -20.25})
    made.operator_message(2001, "OIL LOW")
    made.cycle_start()
    made.advance(137)
    made.raise_alarm(1007, "DOOR OPEN")
    made.raise_alarm(417, axis=2)
    return FocasControl(made, load_profile(profile))


def open_session(control: FocasControl, channel: int = 2) -> tuple[Session, Frame]:
    """Return a session and the frame that accepts it."""
    session = Session(control)
    (opened,) = FrameReader().feed(session.receive(bytes(Frame(FrameType.OPEN, bytes((0, channel))))))
    return session, opened


def _without_repetition(lines: list[str]) -> Iterator[str]:
    """Say how many more lines follow that differ in their offset and number only."""
    key, more = "", 0
    for line in [*lines, ""]:
        here = re.sub(r"\d+", "", line[6:55]) + re.sub(r"\d+", "#", line[55:]) + line[6:55]
        if line and here == key:
            more += 1
            continue
        if more:
            yield f"        ... and {more} more of these bytes"
        key, more = here, 0
        if line:
            yield line


def render(profile: str) -> str:
    """Return the text of a golden file."""
    control = scene_control(profile)
    dissector = Dissector()
    session, opened = open_session(control)
    lines = [
        f"# {profile}: what the server answers, byte for byte, and what the bytes are",
        "",
        "## open",
        "",
    ]
    lines += _without_repetition([line for each in dissector.explain(opened) for line in each.lines()])
    for title, requests in SCENES:
        sent = Frame(FrameType.COMMANDS, write_requests(requests))
        dissector.explain(sent)
        (answer,) = FrameReader().feed(session.receive(bytes(sent)))
        asked = bytes(sent).hex(" ")
        lines += [
            "",
            f"## {title}",
            "",
            *(f"> {asked[at : at + 96].rstrip()}" for at in range(0, len(asked), 96)),
            "",
        ]
        lines += _without_repetition([line for each in dissector.explain(answer) for line in each.lines()])
    return "\n".join(lines) + "\n"


def write() -> None:
    """Write every golden file."""
    GOLDEN.mkdir(parents=True, exist_ok=True)
    for profile in PROFILES:
        (GOLDEN / f"{profile}.txt").write_text(render(profile), encoding="utf-8")


if __name__ == "__main__":
    write()
