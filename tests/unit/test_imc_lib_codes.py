"""Names and numbers of the function library: statuses, queues, events, macros, prototypes."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from polycnc.conformance import load_conformance
from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.library._call import c_type

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


@pytest.mark.parametrize(
    ("name", "value"),
    [
        pytest.param(name, value, marks=pytest.mark.covers(f"imc.status.{name}"), id=name)
        for value, name in enumerate(STATUSES)
    ],
)
def test_status(name: str, value: int) -> None:
    status = getattr(imclib, name)
    assert (status, status.name) == (value, name)
    assert isinstance(status, imclib.IMC_STATUS)
    assert len(status.text) > 3


@pytest.mark.covers("imc.enum.IMC_STATUS")
def test_statuses_count_from_0_and_say_different_things() -> None:
    assert [status.name for status in imclib.IMC_STATUS] == STATUSES
    assert len({status.text for status in imclib.IMC_STATUS}) == 19


@pytest.mark.covers("imc.enum.FIFO_SEL")
def test_queues_count_from_0() -> None:
    names = ["SEL_IFIFO", "SEL_QFIFO", "SEL_PFIFO1", "SEL_PFIFO2", "SEL_CFIFO"]
    assert [getattr(imclib, name) for name in names] == list(range(5))
    assert [each.name for each in imclib.FIFO_SEL] == names


@pytest.mark.covers("imc.enum.IMC_EVENT_CMD", "imc.enum.IMC_EventType")
def test_events_count_from_0() -> None:
    assert len(imclib.IMC_EVENT_CMD) == 34
    assert len(imclib.IMC_EventType) == 15
    for each in chain[Any](imclib.IMC_EVENT_CMD, imclib.IMC_EventType):
        assert getattr(imclib, each.name) is each
    first = (imclib.CMD_ADD32, imclib.CMD_CMP32, imclib.CMD_SET16, imclib.CMD_XOR16iB)
    assert first == (0, 4, 19, 33)
    assert (imclib.IMC_Allways, imclib.IMC_Edge_Great, imclib.IMC_IF_NotCarry) == (0, 3, 14)


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


def test_other_names_are_the_same_functions() -> None:
    for other, name in ALIASES.items():
        assert getattr(imclib, other) is getattr(imclib, name)
    assert imclib.COP48 is imclib.CMD_COP48


def prototypes() -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """Yield every function of the manual with its arguments: type and name in C."""
    for row in load_conformance().rows("imc"):
        if row.id.startswith("imc.IMC_") and row.kind == "function":
            name, listed = re.fullmatch(r"IMC_STATUS (?:WINAPI )?(\w+)\((.*)\)", row.signature).groups()  # type: ignore[union-attr]
            arguments = [re.fullmatch(r"(.*?)(\w+)", each.strip()).groups() for each in listed.split(",")]  # type: ignore[union-attr]
            yield name, [(kind.strip(), argument) for kind, argument in arguments]


def test_all_53_functions_have_the_arguments_of_the_manual() -> None:
    functions = dict(prototypes())
    assert len(functions) == 53
    for name, arguments in functions.items():
        function = getattr(imclib, name)
        expected = [
            (kind, argument)
            for kind, argument in arguments
            if argument not in {"num", "dataNum", "lastNum"}
            and kind not in {"IMC_HANDLE *", "PVOID"}
            and (name, argument) != ("IMC_GetCapData", "pdata")
        ]
        hints = get_type_hints(function, include_extras=True)
        made = []
        for argument in inspect.signature(function).parameters:
            ctype = c_type(hints[argument])
            known = {"Handle": "IMC_HANDLE", "password": "char *"}
            made.append((known.get(argument) if ctype is None else ctype.c, argument))
        assert made == expected, name
        assert "Manual 004" in (function.__doc__ or "")
        assert function.__module__ == "polycnc.controllers.imc.imclib"


@pytest.mark.covers("imc.type.IMCU16")
def test_the_number_of_events_is_a_small_unsigned_number() -> None:
    hints = get_type_hints(imclib.IMC_InstallEvent, include_extras=True)
    count = c_type(hints["EventNum"])
    assert count is not None
    assert (count.c, count.check(31, 4), count.check(65535, 4)) == ("IMCU16", 0, imclib.IMC_OUT_OF_RANGE)


def test_everything_listed_is_there() -> None:
    assert all(hasattr(imclib, name) for name in imclib.__all__)
    assert Path(str(imclib.__file__)).name == "imclib.py"
