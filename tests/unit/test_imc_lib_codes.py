"""Names and numbers of the function library: statuses, queues, events, macros, prototypes."""

from __future__ import annotations

import ctypes
import inspect
import re
from pathlib import Path

import pytest

from polycnc.conformance import load_conformance
from polycnc.controllers.imc import imclib
from polycnc.controllers.library import IN, INOUT, OUT, Refused

STATUSES = [
    "IMC_OK",
    "IMC_SEND_FAIL",
    "IMC_READ_FAIL",
    "IMC_TIME_OUT",
    "IMC_DEVICE_NOT_OPEN",
    "IMC_DEVICE_NOT_FOUND",
    "IMC_INVALID_HANDLE",
    "IMC_INVALID_PARAM",
    "IMC_INVALID_AXIS",
    "IMC_INVALID_FIFO",
    "IMC_FIFO_FULL",
    "IMC_FIFO_NULL",
    "IMC_PARAM_READ_ONLY",
    "IMC_OUT_OF_RANGE",
    "IMC_CHECK_ERROR",
    "IMC_VERSION_ERROR",
    "IMC_OTHER_ERROR",
    "IMC_PASSWORD_ERROR",
    "IMC_RBFIFO_EMPTY",
]


@pytest.mark.covers("imc.enum.IMC_STATUS")
def test_statuses_have_the_numbers_of_their_order_and_a_text() -> None:
    for value, name in enumerate(STATUSES):
        status = getattr(imclib, name)
        assert (status, status.name) == (value, name)
        assert isinstance(status, imclib.IMC_STATUS)
        assert len(status.text) > 3


@pytest.mark.covers("imc.enum.IMC_STATUS")
def test_statuses_count_from_0_and_say_different_things() -> None:
    assert [status.name for status in imclib.IMC_STATUS] == STATUSES
    assert len({status.text for status in imclib.IMC_STATUS}) == 19


@pytest.mark.covers(
    "imc.enum.FIFO_SEL", *(f"imc.fifo.SEL_{name}" for name in ("IFIFO", "QFIFO", "PFIFO1", "PFIFO2", "CFIFO"))
)
def test_queues_count_from_0() -> None:
    names = ["SEL_IFIFO", "SEL_QFIFO", "SEL_PFIFO1", "SEL_PFIFO2", "SEL_CFIFO"]
    assert [getattr(imclib, name) for name in names] == list(range(5))
    assert [each.name for each in imclib.FIFO_SEL] == names


# In the order of the manual's declarations, from 0.
COMMANDS = [
    "ADD32", "ADD32i", "ADD48", "ADD48i", "CMP32", "CMP32i", "CMP48", "CMP48i", "SCA32", "SCA32i", "SCA48",
    "SCA48i", "MUL32L", "MUL32iL", "MUL32A", "MUL32iA", "COP16", "COP32", "COP48", "SET16", "SET32", "SET48",
    "OR16", "OR16i", "OR16B", "OR16iB", "AND16", "AND16i", "AND16B", "AND16iB", "XOR16", "XOR16i", "XOR16B",
    "XOR16iB",
]  # fmt: skip
TYPES = [
    "Allways", "Edge_Zero", "Edge_NotZero", "Edge_Great", "Edge_GreatEqu", "Edge_Little", "Edge_Carry",
    "Edge_NotCarry", "IF_Zero", "IF_NotZero", "IF_Great", "IF_GreatEqu", "IF_Little", "IF_Carry", "IF_NotCarry",
]  # fmt: skip


@pytest.mark.covers(*(f"imc.event.CMD_{name}" for name in COMMANDS), "imc.enum.IMC_EVENT_CMD")
@pytest.mark.covers(*(f"imc.etype.IMC_{name}" for name in TYPES), "imc.enum.IMC_EventType")
def test_events_count_from_0() -> None:
    assert [getattr(imclib, f"CMD_{name}") for name in COMMANDS] == list(range(34))
    assert [getattr(imclib, f"IMC_{name}") for name in TYPES] == list(range(15))
    assert [each.name for each in imclib.IMC_EVENT_CMD] == [f"CMD_{name}" for name in COMMANDS]
    assert [each.name for each in imclib.IMC_EventType] == [f"IMC_{name}" for name in TYPES]


@pytest.mark.covers("imc.file.paramdef_h")
def test_macros_of_the_parameter_header_are_addresses() -> None:
    stated = [
        re.match(r"#define (\w+Loc) (\d+)", row.signature)
        for row in load_conformance().rows("imc")
        if row.id.startswith("imc.param.") and "Loc " in row.signature
    ]
    macros = {found[1]: int(found[2]) for found in stated if found}
    assert len(macros) > 150
    assert {name: getattr(imclib, name) for name in macros} == macros
    assert imclib.startgroup == imclib.startgroupLoc == 256
    assert "mcsposLoc" in dir(imclib)
    with pytest.raises(AttributeError, match="mcspossLoc"):
        _ = imclib.mcspossLoc


ALIASES = {
    "IMC_AddContourData": "IMC_PutContourData",
    "IMC_MoveTP": "IMC_MoveInTime",
    "IMC_MovePP": "IMC_MoveInDist",
    "IMC_MoveTV": "IMC_TgvelInTime",
    "IMC_MovePV": "IMC_TgvelInDist",
    "IMC_AddApiralWithVel": "IMC_AddSpiralWithVel",
    "IMC_AddApiralWitchVel": "IMC_AddSpiralWithVel",
    "IMC_GetPatamBit": "IMC_GetParamBit",
}


@pytest.mark.covers(
    "imc.IMC_GetParamBit",
    "imc.IMC_AddSpiralWithVel",
    "imc.IMC_AddContourData",
    "imc.IMC_MoveTP",
    "imc.IMC_MovePP",
    "imc.IMC_MoveTV",
    "imc.IMC_MovePV",
)
def test_other_names_are_the_same_functions() -> None:
    for other, name in ALIASES.items():
        assert getattr(imclib, other) is getattr(imclib, name)
    assert imclib.COP48 is imclib.CMD_COP48


PROTOTYPES = {
    row.id.removeprefix("imc."): row.signature.replace("WINAPI ", "")
    for row in load_conformance().rows("imc")
    if row.id.startswith("imc.IMC_") and row.kind == "function"
}


@pytest.mark.covers(*(f"imc.{name}" for name in PROTOTYPES))
def test_all_53_functions_have_the_prototype_of_the_manual() -> None:
    assert len(PROTOTYPES) == 53
    assert {getattr(imclib, name).__name__ for name in PROTOTYPES} == set(imclib.FUNCTIONS)
    for name, prototype in PROTOTYPES.items():
        function = getattr(imclib, name)
        row = imclib.FUNCTIONS[function.__name__]
        assert row.prototype.replace(function.__name__, name) == prototype
        assert [each.name for each in row.passed] == list(inspect.signature(function).parameters)
        assert "Manual 004" in (function.__doc__ or "")
        assert function.__module__ == "polycnc.controllers.imc.imclib"


# What a pointer to numbers is for; a pointer to a structure that the card reads is not among them.
POINTERS = {
    "IMC_FindNetCard": {"pinfo": OUT, "num": OUT},
    "IMC_Open": {"Handle": OUT},
    "IMC_OpenX": {"Handle": OUT},
    "IMC_OpenUsePassword": {"Handle": OUT},
    "IMC_GetParam16": {"pdata": OUT},
    "IMC_GetParam32": {"pdata": OUT},
    "IMC_GetParam48": {"pdata": OUT},
    "IMC_GetParamBit": {"pdata": OUT},
    "IMC_GetMulParam": {"pdes": INOUT},
    "IMC_GetCapData": {"pdata": OUT, "dataNum": OUT, "lastNum": OUT},
}


def test_every_argument_has_a_direction_and_pointers_that_read_are_returned_or_filled() -> None:
    for name, row in imclib.FUNCTIONS.items():
        going_out = {each.name: each.direction for each in row.arguments if each.direction is not IN}
        assert going_out == POINTERS.get(name, {}), name
        filled = {each.name for each in row.arguments if each.direction is not IN and not each.returned}
        assert filled <= {"pinfo", "pdes"}


def test_counts_know_what_they_count() -> None:
    counted = {
        each.name: each.length_of
        for row in imclib.FUNCTIONS.values()
        for each in row.arguments
        if each.length_of
    }
    assert counted == {
        "ArrNum": "pdes",
        "NumofArr": "pdes",
        "nWords": "pdata",
        "EventNum": "pEvent",
        "rdnum": "pdata",
    }


@pytest.mark.covers("imc.type.IMCU16")
def test_the_number_of_events_is_a_small_unsigned_number() -> None:
    (count,) = (each for each in imclib.FUNCTIONS["IMC_InstallEvent"].arguments if each.name == "EventNum")
    assert count.type is not None
    assert (count.c, ctypes.sizeof(count.type.ctype), count.take(31, None)) == ("IMCU16", 2, 31)
    assert count.type.ctype(-1).value == 65535
    for number in (65535, 32, 0, -1):
        with pytest.raises(Refused) as refused:
            count.take(number, None)
        assert refused.value.code is imclib.IMC_OUT_OF_RANGE


def test_everything_listed_is_there() -> None:
    assert all(hasattr(imclib, name) for name in imclib.__all__)
    assert Path(str(imclib.__file__)).name == "imclib.py"
