"""Calls of the functions of a Power Mate's first half: ends of what each takes, one beyond, and what it refuses."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, TypeAlias

from polycnc.controllers.fanuc import fwlib
from support.fanuc_scenes_a import stream
from support.fanuc_scenes_a_data import packed, tool_offsets
from support.power_mate import psd

Calls: TypeAlias = Iterator[tuple[str, list[tuple[Any, ...]]]]

POSITIONS = ("absolute", "machine", "relative", "distance", "skip", "srvdelay", "accdecdly")


def axes_calls(m: int, most: int) -> Calls:
    """Yield functions about axes with their arguments; `m` axes of `most`."""
    every = 4 + 4 * m
    given = [
        (-1, every),
        (-1, 28),
        (1, 8),
        (m, 8),
        (m, 28),
        (-1, every - 1),
        (m, 7),
        (m + 1, 8),
        (most + 1, 99),
        (0, 28),
        (-2, 28),
    ]
    for name in POSITIONS:
        yield name, given
    whole = 22 + 16 * most
    yield "rddynamic", [(-1, whole), (m, 38), (1, 38), (-1, whole - 1), (m, 37), (m + 1, 38), (0, 118)]
    values = [5, -6, 70000, -99999999, 99999999, 1]
    yield (
        "wrrelpos",
        [
            (every, fwlib.IDBWRR(type=-1, data=values)),
            (28, fwlib.IDBWRR(type=-1, datano=9, data=values[::-1])),
            (8, fwlib.IDBWRR(type=m, datano=-3, data=[-321, 7])),
            (8, fwlib.IDBWRR(type=1, data=[100000000])),
            (every - 1, fwlib.IDBWRR(type=-1, data=values)),
            (8, fwlib.IDBWRR(type=m + 1)),
            (28, fwlib.IDBWRR(type=0)),
            (7, fwlib.IDBWRR(type=m)),
        ],
    )


def parameter_calls(m: int, most: int) -> Calls:
    """Yield functions about parameters and settings."""
    yield (
        "rdparam",
        [
            (1320, -1, 4 + 4 * most), (1320, m, 8), (1020, -1, 4 + most), (1020, m, 5), (1620, -1, 28),
            (1620, m, 6), (12, -1, 28),
            (12, most, 5), (6080, 0, 5), (3032, 0, 5), (6050, 0, 6), (6711, 0, 8), (3210, 0, 8), (1320, 0, 8),
            (1320, most + 1, 8),
            (6711, 1, 8), (6711, -1, 28), (1320, m, 7), (2, 0, 8), (-1, 0, 8),
        ],
    )  # fmt: skip
    yield (
        "wrparam",
        [
            (8, psd(6711, 0, ldata=-7)), (8, psd(6711, 0, ldata=77)), (8, psd(1320, m, ldata=-5555)),
            (28, psd(1321, -1, ldatas=[-9] * 6)),
            (6, psd(1620, m, idata=250)), (5, psd(12, m, cdata=-128)), (5, psd(6089, 0, cdata=31)),
            (6, psd(6050, 0, idata=300)),
            (5, psd(1020, m, cdata=85)), (5, psd(1010, 0, cdata=2)), (8, psd(8010, m, cdata=1)), (4, psd(6711)),
            (8, psd(6711, 1, ldata=1)),
            (8, psd(1320, 0, ldata=1)), (8, psd(1320, most + 1, ldata=1)), (8, psd(3)), (7, psd(1320, m, ldata=1)),
            (5, psd(1004, 0, cdata=1)),
        ],
    )  # fmt: skip
    records = [
        packed(6711, 0, "i", 12) + packed(6712, 0, "i", 13), packed(20, 0, "b", 4), packed(1320, m, "i", 654321),
        packed(3281, 0, "b", 2),
        packed(12, 0xFF, "b", *[1] * most), packed(6712, 0, "i", 3) + packed(6711, 0, "i", 4),
        packed(1010, 0, "b", 3),
        packed(6080, 0, "b", 60) + packed(6711, 0, "i", 5), packed(6711, 0, "i", 9)[:-1], packed(1320, 0, "i", 1),
        packed(21, 0, "b", 1), b"",
        packed(20, 0, "b", 99), packed(12, 0, "b", 1), packed(6711, 1, "i", 1), packed(8010, 1, "b", 1),
    ]  # fmt: skip
    for name in ("wrparas", "wrsets"):
        yield name, [(len(record), record) for record in records]
    ranges = [
        (6711, 0, 6713, 24), (0, -1, 20, 99), (1320, m, 1321, 16), (1320, -1, 1320, 4 + 4 * most),
        (1620, most, 1624, 24), (6711, 0, 6713, 23),
        (1320, 0, 1320, 99), (12, most + 1, 12, 99), (6713, 0, 6711, 99), (-1, 0, 0, 99), (21, 0, 99, 99),
        (12, 1, 20, 99),
    ]  # fmt: skip
    for name in ("rdparar", "rdsetr"):
        yield name, ranges
    yield "rdparainfo", [(0, 2), (1320, 1), (6711, 3), (8022, 1), (8023, 1), (-1, 1), (12, 0)]


def _pairs(first: int, last: int, *pairs: tuple[int, int]) -> Any:
    record = fwlib.IODBMR(datano_s=first, datano_e=last)
    for entry, (mantissa, decimals) in zip(record.data, pairs, strict=False):
        entry.mcr_val, entry.dec_val = mantissa, decimals
    return record


def data_calls(count: int) -> Calls:
    """Yield functions about tool offsets, `count` of them, and macro variables."""
    yield (
        "rdtofs",
        [
            (1, 0, 8),
            (count, 0, 8),
            (3, 0, 99),
            (count + 1, 0, 8),
            (0, 0, 8),
            (1, 1, 8),
            (1, -1, 8),
            (1, 0, 7),
        ],
    )
    yield (
        "wrtofs",
        [(count, 0, 8, -4321), (1, 0, 8, 99999), (2, 0, 8, 999999), (3, 0, 9, 9999999), (4, 0, 8, -10000000),
         (count + 1, 0, 8, 1),
         (0, 0, 8, 1), (5, 1, 8, 1), (5, 0, 7, 1)],
    )  # fmt: skip
    yield (
        "rdtofsr",
        [
            (1, 0, 4, 22),
            (count - 1, -1, count, 14),
            (1, -1, count, 6 + 4 * count),
            (3, 0, 2, 22),
            (1, 1, 4, 22),
            (count, 0, count + 1, 14),
            (1, 0, 4, 21),
        ],
    )
    yield (
        "wrtofsr",
        [(18, tool_offsets(2, 4, 0, (4, -5, 60000))), (14, tool_offsets(count - 1, count, -1, (8, -9))),
         (18, tool_offsets(2, 4, 0, (1, 2, 10000000))),
         (17, tool_offsets(2, 4, 0, (7,))), (14, tool_offsets(count, count + 1, 0, (7,))),
         (10, tool_offsets(3, 3, 2, (7,))), (10, tool_offsets(4, 3, 0, (7,)))],
    )  # fmt: skip
    yield "rdtofsinfo", [()]
    yield (
        "rdmacro",
        [
            (1, 10),
            (33, 10),
            (34, 10),
            (100, 10),
            (500, 10),
            (531, 12),
            (532, 10),
            (699, 10),
            (999, 10),
            (1000, 10),
            (149, 10),
            (199, 10),
            (0, 10),
            (500, 9),
        ],
    )
    yield (
        "wrmacro",
        [(500, 10, -15, 1), (100, 10, 99999999, 8), (149, 10, 0, -1), (199, 10, 7, 0), (531, 12, -99999999, 0),
         (999, 10, 25, 3), (1, 10, 5, 0), (500, 10, 100000000, 0),
         (500, 10, 5, 9), (500, 10, 5, -1), (500, 10, 5, -2), (500, 9, 5, 0), (1000, 10, 5, 0)],
    )  # fmt: skip
    yield (
        "rdmacror",
        [
            (1, 3, 24),
            (500, 502, 24),
            (147, 149, 24),
            (148, 150, 24),
            (530, 532, 24),
            (33, 34, 99),
            (502, 500, 24),
            (500, 502, 23),
            (999, 999, 12),
        ],
    )
    yield (
        "wrmacror",
        [(18, _pairs(510, 511, (5, 2), (0, -1))), (18, _pairs(148, 149, (-1, 0), (8, 8))),
         (18, _pairs(531, 532, (6, 0), (7, 0))), (12, _pairs(33, 33, (1, 0))),
         (18, _pairs(512, 513, (1, 0), (5, 9))), (17, _pairs(512, 513, (1, 0), (5, 1))), (18, _pairs(513, 512))],
    )  # fmt: skip
    yield "rdmacroinfo", [()]
    yield "getmactype", [()]
    yield "setmactype", [(0,), (1,), (-1,)]


def program_calls() -> Calls:
    """Yield functions about programs: those that read first, those that take most away last."""
    for name in ("actf", "rdprgnum", "rdseqnum", "rdmdipntr"):
        yield name, [()]
    yield "rdexecprog", [(1,), (9,), (60,), (0,)]
    yield (
        "rdprogdir",
        [(kind, *rest) for kind in range(3) for rest in ((1, 9999, 99), (8, 9000, 20), (9999, 9999, 9))]
        + [(3, 1, 2, 9), (0, 0, 5, 9), (1, 9, 8, 9), (2, 1, 10000, 9), (0, 1, 9, 0)],
    )
    yield "rdproginfo", [(0, 12), (1, 31), (1, 32), (0, 31), (1, 12), (2, 12), (2, 13)]
    texts = [
        stream("O1", "N7G4", "M30"),
        stream("O1", "G4", "G4X1.", "M3"),
        stream("O1", "M030"),
        stream("O1", "g4"),
        stream("O1"),
        b"\nO1\nM30\n",
    ]
    yield "wrmdipntr", [(0,), (1,), (2,), (3,), (-1,)]
    yield "wrmdiprog", [(len(data), data) for data in texts] + [(0, texts[0]), (200, texts[0] + b" " * 200)]
    yield "wrmdipntr", [(0,), (1,), (2,), (-1,)]
    yield "upload", [(1,), (7,), (0,)]
    yield "upstart", [(8,), (9001,), (0,), (99,), (-7,)]
    yield "upload", [(0,), (7,), (99,)]
    yield "upend", [()]
    yield "upload", [(7,)]
    sent = [
        b"", b"(D)\nM30\n%", b"\nO13\nG!\n%", stream("O8", "M30"), stream("O9001", "M99"), stream("O8500", "M99"),
        stream("O7", "M99"), stream("O77", "G01", "M30"), stream("O12", "G1X1.", "M30"), b"\nO14\nM99",
    ]  # fmt: skip
    for data in (b"\n", *sent):
        yield "download", [(b"\n" * 300, 257), (data, 0), (b"", 1)] if data == b"\n" else [(data, len(data))]
        yield "dwnend", [()]
        yield "dwnstart", [()]
    yield "download", [(b"\n" * 300, 256), (b"\n", 2)]
    yield "search", [(8,), (9001,), (0,), (99,), (10000,)]
    yield "dwnend", [()]
    yield "seqsrch", [(30,), (44,), (10,), (0,), (31,), (-1,)]
    yield "rewind", [()]
    yield "search", [(8,), (7,), (9001,), (0,), (99,), (10000,)]
    yield "delete", [(9001,), (8500,), (7,), (0,), (99,), (11,)]
    yield "delall", [()]
