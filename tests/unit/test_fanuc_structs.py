"""Names and numbers of the Power Mate's library: codes, prototypes, structures as they lie in memory."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path
from typing import Any

import pytest

from polycnc.conformance import read_rows
from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.library import variant
from support.c_elements import is_signed
from support.power_mate import attached

CONFORMANCE = Path(__file__).resolve().parents[2] / "conformance"
ROWS = read_rows(CONFORMANCE)
PART_A = [
    "cnc_allclibhndl",
    "cnc_allclibhndl2",
    "cnc_freelibhndl",
    "cnc_actf",
    "cnc_absolute",
    "cnc_machine",
    "cnc_relative",
    "cnc_distance",
    "cnc_skip",
    "cnc_srvdelay",
    "cnc_accdecdly",
    "cnc_rddynamic",
    "cnc_wrrelpos",
    "cnc_dwnstart",
    "cnc_download",
    "cnc_dwnend",
    "cnc_upstart",
    "cnc_upload",
    "cnc_upend",
    "cnc_search",
    "cnc_delall",
    "cnc_delete",
    "cnc_rdprogdir",
    "cnc_rdproginfo",
    "cnc_rdprgnum",
    "cnc_rdseqnum",
    "cnc_rdexecprog",
    "cnc_wrmdiprog",
    "cnc_rdmdipntr",
    "cnc_wrmdipntr",
    "cnc_seqsrch",
    "cnc_rewind",
    "cnc_rdtofs",
    "cnc_wrtofs",
    "cnc_rdtofsr",
    "cnc_wrtofsr",
    "cnc_rdtofsinfo",
    "cnc_rdparam",
    "cnc_wrparam",
    "cnc_rdparar",
    "cnc_wrparas",
    "cnc_rdparainfo",
    "cnc_rdsetr",
    "cnc_wrsets",
    "cnc_rdmacro",
    "cnc_wrmacro",
    "cnc_rdmacror",
    "cnc_wrmacror",
    "cnc_rdmacroinfo",
    "cnc_getmactype",
    "cnc_setmactype",
]


def covers(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.covers(*(f"fanuc.{name}" for name in names))


@covers("concept.function_index", "concept.header_and_linkage")
def test_all_functions_of_this_half_have_the_prototypes_of_the_manual() -> None:
    assert len(PART_A) == 51
    for name in PART_A:
        printed = re.sub(r"FWLIBAPI |WINAPI |FAR PASCAL |;", "", ROWS[f"fanuc.{name}"].signature)
        assert fwlib.FUNCTIONS[name].prototype.replace(" *", "*") == (
            printed.replace("(void *)", "void *").replace(" *", "*")
        )
        assert getattr(fwlib, name).__doc__
        assert name in fwlib.__all__


CODES = {
    "ITLOW": -13, "ITHIGHT": -12, "BUS": -11, "SYSTEM2": -10, "HSSB": -9, "SYSTEM": -5, "BUSY": -1, "OK": 0,
    "FUNC": 1, "LENGTH": 2, "NUMBER": 3, "ATTRIB": 4, "DATA": 5, "NOOPT": 6, "PROT": 7, "OVRFLOW": 8, "PARAM": 9,
    "BUFFER": 10, "PATH": 11, "MODE": 12, "REJECT": 13, "RESET": -2, "NODLL": -15, "INIERR": -14, "HANDLE": -8,
    "VERSION": -7, "UNEXP": -6, "PARITY": -4, "MMCSYS": -3, "NOPMC": 1, "RANGE": 3, "TYPE": 4, "DTSRVR": 14,
}  # fmt: skip
_ROW = {"ITLOW": "ITHIGHT_m13", "ITHIGHT": "ITHIGHT_m12"}
_BEYOND = {
    "NODLL",
    "INIERR",
    "HANDLE",
    "VERSION",
    "UNEXP",
    "PARITY",
    "MMCSYS",
    "NOPMC",
    "RANGE",
    "TYPE",
    "DTSRVR",
}


@pytest.mark.parametrize(
    ("name", "number"),
    [
        pytest.param(
            name, number, marks=() if name in _BEYOND else covers(f"EW_{_ROW.get(name, name)}"), id=name
        )
        for name, number in CODES.items()
    ],
)
@pytest.mark.covers("fanuc.concept.return_convention")
def test_return_codes(name: str, number: int) -> None:
    code = getattr(fwlib, f"EW_{name}")
    assert code is fwlib.EW[f"EW_{name}"]
    assert code == number
    assert code.text
    assert -0x8000 <= code < 0x8000


@covers("concept.return_convention")
@pytest.mark.covers("fanuc.cnc_absolute", "fanuc.cnc_rdprgnum")
def test_a_function_answers_its_code_first_and_success_is_zero() -> None:
    _, handle = attached()
    assert fwlib.cnc_rdprgnum(handle)[0] == 0
    code, position = fwlib.cnc_absolute(handle, 1, 7)
    assert code > 0
    assert position == fwlib.ODBAXIS()
    code, _ = fwlib.cnc_absolute(handle + 1, 1, 8)
    assert code < 0
    assert all(function.result == "short" for function in fwlib.FUNCTIONS.values())
    assert len({int(code) for code in fwlib.EW}) == len(fwlib.EW)


@covers("ALL_AXES", "MAX_AXIS", "MAX_RBUF", "MAX_PBUF")
def test_constants() -> None:
    assert (fwlib.ALL_AXES, fwlib.MAX_AXIS, fwlib.MAX_RBUF) == (-1, 6, 256)
    assert fwlib.STRUCTURES["PRGDIR"].size == fwlib.MAX_PBUF
    assert attached(model="D")[0].max_axis == 2


# Elements of the structures: name of the row, offset, size. `n` axes are 6, N values are as many as in the samples.
LAYOUTS: dict[str, tuple[int, dict[str, tuple[int, int]]]] = {
    "ODBACT": (8, {"dummy": (0, 4), "data": (4, 4)}),
    "ODBAXIS": (28, {"dummy": (0, 2), "type": (2, 2), "data": (4, 24)}),
    "ODBDY": (
        118,
        {"dummy": (0, 2), "axis": (2, 2), "alarm": (4, 2), "prgnum": (6, 2), "prgmnum": (8, 2), "seqnum": (10, 4),
         "actf": (14, 4), "acts": (18, 4), "pos.faxis.absolute": (22, 24), "pos.faxis.machine": (46, 24),
         "pos.faxis.relative": (70, 24), "pos.faxis.distance": (94, 24), "pos.oaxis.absolute": (22, 4),
         "pos.oaxis.machine": (26, 4), "pos.oaxis.relative": (30, 4), "pos.oaxis.distance": (34, 4)},
    ),
    "IDBWRR": (28, {"datano": (0, 2), "type": (2, 2), "data": (4, 24)}),
    "ODBUP": (260, {"dummy": (0, 4), "data": (4, 256)}),
    "PRGDIR": (256, {"prg_data": (0, 256)}),
    "ODBNC": (
        31,
        {"u.bin.reg_prg": (0, 2), "u.bin.unreg_prg": (2, 2), "u.bin.used_mem": (4, 4), "u.bin.unused_mem": (8, 4),
         "u.asc": (0, 31)},
    ),
    "ODBPRO": (8, {"dummy": (0, 4), "data": (4, 2), "mdata": (6, 2)}),
    "ODBSEQ": (8, {"dummy": (0, 4), "data": (4, 4)}),
    "ODBMDIP": (12, {"mdiprog": (0, 2), "mdipntr": (2, 4), "crntprog": (6, 2), "crntpntr": (8, 4)}),
    "ODBTOFS": (8, {"datano": (0, 2), "type": (2, 2), "data": (4, 4)}),
    "IODBTO": (
        402,
        {"datano_s": (0, 2), "type": (2, 2), "datano_e": (4, 2), "u.m_ofs": (6, 396), "u.m_ofs_a": (6, 396)},
    ),
    "ODBTLINF": (4, {"ofs_type": (0, 2), "use_no": (2, 2)}),
    "IODBPSD": (
        28,
        {"datano": (0, 2), "type": (2, 2), "u.cdata": (4, 1), "u.idata": (4, 2), "u.ldata": (4, 4),
         "u.cdatas": (4, 6), "u.idatas": (4, 12), "u.ldatas": (4, 24)},
    ),
    "ODBPARAIF": (
        406,
        {"info_no": (0, 2), "prev_no": (2, 2), "next_no": (4, 2), "info.prm_no": (6, 2), "info.prm_type": (8, 2)},
    ),
    "ODBM": (10, {"datano": (0, 2), "dummy": (2, 2), "mcr_val": (4, 4), "dec_val": (8, 2)}),
    "IODBMR": (
        3006,
        {"datano_s": (0, 2), "dummy": (2, 2), "datano_e": (4, 2), "data.mcr_val": (6, 4), "data.dec_val": (10, 2)},
    ),
    "ODBMVINF": (4, {"use_no1": (0, 2), "use_no2": (2, 2)}),
}  # fmt: skip


def _place(cls: Any, path: str) -> tuple[int, int]:
    """Return offset and size of an element, of the first entry of an array of structures."""
    offset = 0
    for name in path.split("."):
        field = getattr(cls, name)
        offset += field.offset
        size = field.size
        cls = {each[0]: each[1] for each in cls._fields_}[name]
        if issubclass(cls, ctypes.Array) and issubclass(cls._type_, ctypes.Structure):
            cls = cls._type_
    return offset, size


@pytest.mark.parametrize(
    ("struct", "path"),
    [
        pytest.param(struct, path, marks=covers(f"{struct}.{path}"), id=f"{struct}.{path}")
        for struct, (_, paths) in LAYOUTS.items()
        for path in paths
    ],
)
@pytest.mark.covers("fanuc.concept.c_types", "fanuc.concept.struct_packing", "fanuc.common.types")
def test_elements_lie_where_the_manual_shows_them(struct: str, path: str) -> None:
    assert _place(getattr(fwlib, struct), path) == LAYOUTS[struct][1][path]
    printed = ROWS[f"fanuc.{struct}.{path}"].signature
    if printed.startswith(("short", "long", "unsigned")):
        assert is_signed(getattr(fwlib, struct), path) is not printed.startswith("unsigned")


@pytest.mark.parametrize(
    "struct", [pytest.param(struct, marks=covers(f"struct.{struct}"), id=struct) for struct in LAYOUTS]
)
@pytest.mark.covers("fanuc.concept.struct_packing", "fanuc.common.types")
def test_structures_have_the_manuals_size_and_elements(struct: str) -> None:
    size, paths = LAYOUTS[struct]
    layout = fwlib.STRUCTURES[struct]
    assert layout.size == size == ctypes.sizeof(getattr(fwlib, struct))
    assert {field.name for field in layout.fields} == {path.split(".")[0] for path in paths}
    assert [field.offset for field in layout.fields] == [
        min(place[0] for path, place in paths.items() if path.split(".")[0] == field.name)
        for field in layout.fields
    ]


@covers("concept.c_types")
@pytest.mark.covers("fanuc.common.types")
def test_c_types_are_little_endian_and_signed() -> None:
    assert fwlib.ODBACT(data=-2).pack() == b"\0\0\0\0\xfe\xff\xff\xff"
    assert fwlib.ODBPRO(data=9876).pack()[4:6] == (9876).to_bytes(2, "little")
    memory = bytearray(28)
    memory[4] = 0xFF
    assert fwlib.IODBPSD.from_buffer(memory).u.cdata == -1
    assert fwlib.ODBPARAIF(info_no=0xFFFF).info_no == 65535
    sizes = {"short": 2, "long": 4, "unsigned short": 2, "char": 1}
    for layout in fwlib.STRUCTURES.values():
        for field in layout.fields:
            if field.c in sizes:
                count = 1
                for each in field.counts:
                    count *= each
                assert field.size == sizes[field.c] * count


def _entry_size() -> int:
    """Return the size of an entry of IODBMR."""
    arrays: dict[str, Any] = {each[0]: each[1] for each in fwlib.IODBMR._fields_}
    return ctypes.sizeof(arrays["data"]._type_)


@pytest.mark.covers("fanuc.cnc_rdmacror", "fanuc.cnc_rdproginfo", "fanuc.cnc_rdtofsr")
@covers("concept.struct_packing")
@pytest.mark.covers("fanuc.cnc_rddynamic", "fanuc.cnc_rdmacro")
def test_nothing_is_aligned_to_four_bytes_but_lengths_of_that_packing_are_taken() -> None:
    assert _place(fwlib.ODBDY, "seqnum")[0] == 10
    assert _entry_size() == 6
    assert ctypes.sizeof(variant(fwlib.IODBMR, data=2)) == 18
    _, handle = attached()
    assert fwlib.cnc_rddynamic(handle, 1, 40)[0] == 0  # ODBDY packed to 4 has 40 bytes
    assert fwlib.cnc_rdmacro(handle, 100, 12)[0] == 0
    assert fwlib.cnc_rdmacror(handle, 100, 101, 8 + 2 * 8)[0] == 0
    assert fwlib.cnc_rdtofsr(handle, 1, 0, 3, 8 + 12)[0] == 0
    assert fwlib.cnc_rdproginfo(handle, 1, 32)[0] == 0


@pytest.mark.covers("fanuc.EW_LENGTH", "fanuc.concept.length_argument")
@pytest.mark.covers("fanuc.cnc_rddynamic", "fanuc.cnc_rddynamic.err.EW_LENGTH")
@pytest.mark.covers("fanuc.MAX_AXIS", "fanuc.common.MAX_AXIS2")
def test_a_power_mate_d_has_two_axes_in_its_structures() -> None:
    _, handle = attached(model="D")
    code, dynamic = fwlib.cnc_rddynamic(handle, -1, 22 + 16 * 2)
    assert (code, ctypes.sizeof(dynamic)) == (0, 54)
    assert fwlib.cnc_rddynamic(handle, -1, 22 + 16 * 2 - 1)[0] == fwlib.EW_LENGTH
