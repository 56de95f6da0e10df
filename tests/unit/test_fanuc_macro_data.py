"""Macro variables, and what holds for all data (Manual 000, 2712-4853)."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.fwlib import EW, IODBMR
from polycnc.controllers.library import variant
from support.power_mate import OK, attached, psd, registered, running

MODES = ("MDI", "MEM", "EDIT", "HND", "JOG", "T-JOG", "T-HND", "INC", "REF", "RMT")


def covers(*names: str) -> pytest.MarkDecorator:
    return pytest.mark.covers(*(f"fanuc.{name}" for name in names))


# ---------------------------------------------------------------------- macro variables


def macro(handle: int, number: int) -> tuple[int, int]:
    code, data = fwlib.cnc_rdmacro(handle, number, 10)
    assert (code, data.datano, data.dummy) == (OK, number, 0)
    return int(data.mcr_val), int(data.dec_val)


def shown(mantissa: int, decimals: int) -> str:
    """Return a value as the sample of cnc_rdmacro formats it."""
    text = list(f" {mantissa:09d}")
    if text[1] == "0":
        text[1] = " "
    front = "".join(text[1 : 1 + 9 - max(decimals, 0)])
    return f"{front}.{''.join(text)[10 - decimals :]}" if decimals >= 0 else " 00000000"


@pytest.mark.covers(
    "fanuc.ODBM.datano", "fanuc.ODBM.dec_val", "fanuc.ODBM.dummy", "fanuc.ODBM.mcr_val", "fanuc.struct.ODBM",
)  # fmt: skip
@covers("cnc_rdmacro", "cnc_wrmacro", "example.cnc_rdmacro", "example.cnc_wrmacro", "enum.macro_type.decimal")
@pytest.mark.covers("fanuc.concept.macro_empty", "fanuc.concept.macro_out_of_range")
def test_macro_variables_in_decimal_form() -> None:
    control, handle = attached()
    for mantissa, decimals, value in (
        (1500, 3, 1.5),
        (-1500, 3, -1.5),
        (99_999_999, 0, 99_999_999.0),
        (-99_999_999, 8, -0.99999999),
        (0, 0, 0.0),
        (0, 5, 0.0),
        (12_345_678, 0, 12_345_678.0),
    ):
        assert fwlib.cnc_wrmacro(handle, 137, 10, mantissa, decimals) == OK
        assert macro(handle, 137) == (mantissa, decimals)
        assert control.macros.get(137) == value
    assert shown(1500, 3).strip() == "00001.500"
    assert shown(-1500, 3) == "-00001.500"
    assert shown(12_345_678, 0).strip() == "12345678."
    for value, pair in (
        (1.5, (15, 1)),
        (-0.000_000_01, (-1, 8)),
        (123.456789012, (12_345_679, 5)),
        (9_999_999.96, (1, 7)),
        (9_999_999.9, (99_999_999, 1)),
        (99_999_999.4, (99_999_999, 0)),
    ):
        control.macros.set(137, value)
        assert macro(handle, 137) == ((10_000_000, 0) if pair == (1, 7) else pair)
    assert fwlib.cnc_wrmacro(handle, 137, 12, 5, 0) == OK


@pytest.mark.covers(
    "fanuc.ODBM.datano", "fanuc.ODBM.dec_val", "fanuc.ODBM.dummy", "fanuc.ODBM.mcr_val", "fanuc.cnc_rdmacro",
    "fanuc.enum.macro_type.binary", "fanuc.enum.macro_type.decimal", "fanuc.struct.ODBM",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrmacro")
@pytest.mark.covers("fanuc.cnc_setmactype")
@covers("concept.macro_empty")
def test_vacant_is_not_zero() -> None:
    control, handle = attached()
    for kind in (0, 1):
        assert fwlib.cnc_setmactype(handle, kind) == OK
        assert fwlib.cnc_wrmacro(handle, 500, 10, 0, 0) == OK
        assert (macro(handle, 500), control.macros.get(500)) == ((0, 0), 0.0)
        assert fwlib.cnc_wrmacro(handle, 500, 10, 0, -1) == OK
        assert (macro(handle, 500), control.macros.get(500)) == ((0, -1), None)


@pytest.mark.covers(
    "fanuc.EW_DATA", "fanuc.ODBM.datano", "fanuc.ODBM.dec_val", "fanuc.ODBM.dummy", "fanuc.ODBM.mcr_val",
    "fanuc.cnc_rdmacro", "fanuc.enum.macro_type.decimal", "fanuc.struct.ODBM",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrmacro")
@covers(
    "concept.macro_out_of_range",
    "enum.macro_type.binary",
    "cnc_wrmacro.err.EW_DATA",
    "cnc_setmactype",
    "cnc_getmactype",
)
@pytest.mark.covers("fanuc.concept.macro_empty")
def test_binary_form_reaches_farther_than_the_decimal_one() -> None:
    control, handle = attached()
    _, other = fwlib.cnc_allclibhndl()
    for mantissa, decimals in ((100_000_000, 0), (-100_000_000, 0), (5, 9), (5, -1), (5, -2), (1, 32_767)):
        assert fwlib.cnc_wrmacro(handle, 500, 10, mantissa, decimals) == EW.EW_DATA
        assert control.macros.get(500) is None
    assert fwlib.cnc_getmactype(handle) == (OK, 0)
    assert fwlib.cnc_setmactype(handle, 5) == OK
    assert fwlib.cnc_getmactype(handle) == (OK, 5)
    assert fwlib.cnc_getmactype(other) == (OK, 0)
    for mantissa, exponent in ((2**31 - 1, 0), (-(2**31) + 1, -128), (3, 127), (-5, 2), (1, -1)):
        assert fwlib.cnc_wrmacro(handle, 500, 10, mantissa, exponent) == OK
        assert macro(handle, 500) == (mantissa, exponent)
        assert control.macros.get(500) == mantissa * 2.0**-exponent
    for exponent in (-129, 128):
        assert fwlib.cnc_wrmacro(handle, 500, 10, 1, exponent) == EW.EW_DATA
    assert fwlib.cnc_wrmacro(handle, 500, 10, 3 * 2**20, -10) == OK
    assert macro(handle, 500) == (3, -30)
    assert macro(other, 500) == (-1, -1)  # too large for 8 digits
    control.macros.set(500, 1e-9)
    assert macro(other, 500) == (-1, -1)
    assert fwlib.cnc_wrmacro(other, 500, 10, 25, 1) == OK
    assert macro(handle, 500) == (5, 1)  # 2.5 is 5 halves
    assert macro(other, 500) == (25, 1)


@pytest.mark.covers(
    "fanuc.EW_NUMBER", "fanuc.ODBM.datano", "fanuc.ODBM.dummy", "fanuc.ODBM.mcr_val", "fanuc.enum.macro_type.decimal",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_rdmacror")
@pytest.mark.parametrize(
    ("options", "code", "there", "missing"),
    [
        pytest.param((), 0, (100, 149, 500, 531), (150, 499, 532), marks=covers("enum.use_no2.0")),
        pytest.param(True, 1, (100, 199, 500, 999), (99, 200, 499, 1000), marks=covers("enum.use_no2.1")),
        pytest.param(
            ("macro_variables_300",), 2, (100, 199, 500, 699), (200, 700), marks=covers("enum.use_no2.2")
        ),
    ],
)
@covers("cnc_rdmacroinfo", "cnc_rdmacro.err.EW_NUMBER", "cnc_wrmacro.err.EW_NUMBER")
@pytest.mark.covers("fanuc.ODBMVINF.use_no1", "fanuc.ODBMVINF.use_no2", "fanuc.ODBM.dec_val")
@pytest.mark.covers("fanuc.cnc_rdmacro", "fanuc.cnc_rdmacror.err.EW_NUMBER", "fanuc.cnc_wrmacro")
@pytest.mark.covers("fanuc.struct.ODBM", "fanuc.struct.ODBMVINF")
@pytest.mark.covers("fanuc.concept.macro_local_scope")
def test_ranges_of_common_variables(
    options: Any, code: int, there: tuple[int, ...], missing: tuple[int, ...]
) -> None:
    _, handle = attached(options=options)
    answer, info = fwlib.cnc_rdmacroinfo(handle)
    assert (answer, info.use_no1, info.use_no2) == (OK, 33, code)
    for number in there:
        assert fwlib.cnc_wrmacro(handle, number, 10, number, 1) == OK
        assert macro(handle, number) == (number, 1)
    for number in (*missing, 0, -1, 34, 5000):
        assert fwlib.cnc_rdmacro(handle, number, 10)[0] == EW.EW_NUMBER
        assert fwlib.cnc_wrmacro(handle, number, 10, 5, 0) == EW.EW_NUMBER
    assert fwlib.cnc_rdmacror(handle, there[0], there[2], 5000)[0] == EW.EW_NUMBER


@pytest.mark.covers("fanuc.cnc_wrmacror")
@covers("concept.macro_local_scope")
@pytest.mark.covers(
    "fanuc.cnc_rdmacror",
    "fanuc.cnc_wrmacro",
    "fanuc.cnc_wrmacro.err.EW_NUMBER",
    "fanuc.cnc_wrmacror.err.EW_NUMBER",
)
def test_local_variables_are_those_of_the_macro_and_cannot_be_written() -> None:
    control, handle = attached()
    assert [macro(handle, number) for number in (1, 33)] == [(0, -1)] * 2  # no macro
    registered(control, O1="\nG65P9000A2.5D-4.\nM30\n", O9000="\nG4X1.\n#2=#1\nG4X1.\nM99\n")
    running(control, 1, lambda: control.execution.numbers[0] == 9000)
    assert [macro(handle, number) for number in (1, 7, 33)] == [(25, 1), (-4, 0), (0, -1)]
    code, data = fwlib.cnc_rdmacror(handle, 1, 33, 6 + 6 * 33)
    assert code == OK
    assert [(each.mcr_val, each.dec_val) for each in data.data][:7:6] == [(25, 1), (-4, 0)]
    assert fwlib.cnc_wrmacro(handle, 1, 10, 5, 0) == EW.EW_NUMBER
    assert fwlib.cnc_wrmacror(handle, 12, variant(IODBMR, data=1)(datano_s=33, datano_e=33)) == EW.EW_NUMBER


@covers("cnc_rdmacror", "cnc_wrmacror", "example.cnc_rdmacror", "example.cnc_wrmacror")
@pytest.mark.covers(
    "fanuc.IODBMR.datano_s", "fanuc.IODBMR.datano_e", "fanuc.IODBMR.data.mcr_val", "fanuc.IODBMR.data.dec_val"
)
@pytest.mark.covers("fanuc.struct.IODBMR")
@pytest.mark.covers("fanuc.concept.macro_empty")
def test_ranges_of_macro_variables() -> None:
    control, handle = attached()
    count = 20
    data = IODBMR(datano_s=505, datano_e=505 + count - 1)
    for k in range(count):
        data.data[k].mcr_val = 11 * k - 50
    assert fwlib.cnc_wrmacror(handle, 6 + 6 * count, data) == OK
    assert [control.macros.get(505 + k) for k in range(count)] == [11.0 * k - 50 for k in range(count)]
    control.macros.set(507, None)
    code, found = fwlib.cnc_rdmacror(handle, 504, 508, 1000)
    assert (code, found.datano_s, found.datano_e) == (OK, 504, 508)
    assert [(each.mcr_val, each.dec_val) for each in found.data] == [
        (0, -1),
        (-50, 0),
        (-39, 0),
        (0, -1),
        (-17, 0),
    ]
    assert struct.unpack_from("<lh", found.pack(), 6 + 6 * 2) == (-39, 0)


@pytest.mark.covers("fanuc.cnc_rdmacro", "fanuc.cnc_rdmacror")
@covers(
    "cnc_rdmacro.err.EW_LENGTH", "cnc_wrmacro.err.EW_LENGTH", "cnc_rdmacror.err.EW_LENGTH",
    "cnc_rdmacror.err.EW_NUMBER",
    "cnc_wrmacror.err.EW_LENGTH", "cnc_wrmacror.err.EW_NUMBER", "cnc_wrmacror.err.EW_DATA",
)  # fmt: skip
@pytest.mark.covers("fanuc.cnc_wrmacro")
@pytest.mark.covers("fanuc.cnc_wrmacror")
@pytest.mark.covers(
    "fanuc.concept.length_argument", "fanuc.concept.macro_out_of_range", "fanuc.concept.macro_local_scope"
)
def test_macro_requests_that_are_refused_change_nothing() -> None:
    control, handle = attached()

    def written(first: int, last: int, length: int, *values: tuple[int, int]) -> EW:
        data = IODBMR(datano_s=first, datano_e=last)
        for k, (mantissa, decimals) in enumerate(values):
            data.data[k].mcr_val, data.data[k].dec_val = mantissa, decimals
        code = fwlib.cnc_wrmacror(handle, length, data)
        assert [control.macros.get(number) for number in (500, 501, 502)] == [None] * 3
        return code

    assert fwlib.cnc_rdmacro(handle, 9999, 9)[0] == EW.EW_LENGTH
    assert fwlib.cnc_wrmacro(handle, 500, 9, 5, 0) == EW.EW_LENGTH
    assert fwlib.cnc_rdmacror(handle, 500, 502, 23)[0] == EW.EW_LENGTH
    assert fwlib.cnc_rdmacror(handle, 500, 502, 24)[0] == OK
    for first, last in ((502, 500), (149, 500), (33, 100), (0, 5), (998, 1000)):
        assert fwlib.cnc_rdmacror(handle, first, last, 30_000)[0] == EW.EW_NUMBER
        assert written(first, last, 30_000, (1, 0), (2, 0)) == EW.EW_NUMBER
    assert written(500, 502, 23, (1, 0), (2, 0), (3, 0)) == EW.EW_LENGTH
    assert written(500, 502, 24, (1, 0), (2, 0), (100_000_000, 0)) == EW.EW_DATA
    assert written(500, 502, 24, (1, 0), (2, 9), (3, 0)) == EW.EW_DATA


@pytest.mark.covers("fanuc.cnc_wrmacro")
def test_a_reset_clears_volatile_variables_if_parameter_6001_says_so() -> None:
    control, handle = attached()
    for number in (100, 500):
        assert fwlib.cnc_wrmacro(handle, number, 10, 5, 0) == OK
    control.reset()
    assert macro(handle, 100) == (5, 0)
    control.parameters.set(6001, 0)
    control.reset()
    assert [macro(handle, number) for number in (100, 500)] == [(0, -1), (5, 0)]


CALLS: list[Callable[[int], Any]] = [
    lambda handle: fwlib.cnc_rdparam(handle, 6711, 0, 8)[0],
    lambda handle: fwlib.cnc_wrparam(handle, 8, psd(6711, 0, ldata=3)),
    lambda handle: fwlib.cnc_rdparar(handle, 6711, 0, 6713, 24)[0],
    lambda handle: fwlib.cnc_rdsetr(handle, 6711, 0, 6713, 24)[0],
    lambda handle: fwlib.cnc_rdparainfo(handle, 6711, 1)[0],
    lambda handle: fwlib.cnc_wrmacro(handle, 100, 10, 5, 0),
    lambda handle: fwlib.cnc_rdmacroinfo(handle)[0],
]


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.covers("fanuc.concept.mode_matrix")
def test_data_functions_work_in_every_mode(mode: str) -> None:
    control, handle = attached()
    control.select_mode(mode)
    assert [call(handle) for call in CALLS] == [OK] * len(CALLS)


def test_data_belong_to_their_control() -> None:
    first = PowerMate()
    second = PowerMate()
    first.macros.set(100, 5.0)
    first.parameters.set(6711, 7)
    assert (second.macros.get(100), second.parameters.value(6711)) == (None, 0)
