"""Arguments of MCODS and MCOPS: numbers that must be whole, and the variables that data are written into."""

from __future__ import annotations

import struct
from collections.abc import Sequence

from polycnc.controllers.bosch.ncs._codes import NcsCode, NcsError
from polycnc.controllers.bosch.ncs._data_services import DataService, Values
from polycnc.controllers.bosch.ncs._process_services import Parameter
from polycnc.nc.cpl import OMITTED, Box, CharacterField, Fault, Field, text_of

INVALID_PARAMETER = "INVALID PARAMETER"
INVALID_FIELD_LIMIT = "INVALID FIELD LIMIT"
_HOLDERS = {"I": "IRD", "R": "RD", "D": "D", "X": "RD", "S": ""}
_KINDS = {"I": "INTEGER", "R": "REAL", "D": "DOUBLE"}


def integer(value: object, what: str) -> int:
    """Return a value that has to be whole; REAL variables may hold it.

    Raises:
        Fault: It is not whole.
    """
    if isinstance(value, int | float) and not isinstance(value, bool) and float(value).is_integer():
        return int(value)
    raise Fault(INVALID_PARAMETER, f"the {what} has to be a whole number")


def known_version(version: object) -> int:
    """Return the version that the caller has, 0 for none.

    Raises:
        Fault: It stands in no INTEGER or REAL variable, or the variable has no value.
    """
    if not isinstance(version, Box) or version.kind not in ("I", "R"):
        raise Fault(INVALID_PARAMETER, "the version has to be an INTEGER or REAL variable")
    if version.value is None:
        raise Fault(INVALID_PARAMETER, "set the version before: 0 gives the data at once")
    return integer(version.value, "version")


def parameters(given: Sequence[object], wanted: Sequence[Parameter]) -> list[int | str]:
    """Return the parameters of a process service, what stands for those left out in their places.

    Raises:
        Fault: A parameter has the wrong type.
        NcsError: There are too many, or one is missing.
    """
    if len(given) > len(wanted):
        raise NcsError(NcsCode.UNKNOWN_SYNTAX)
    found: list[int | str] = []
    for place, (kind, default) in enumerate(wanted):
        value = given[place] if place < len(given) else OMITTED
        if value is OMITTED:
            if default is None:
                raise NcsError(NcsCode.UNKNOWN_SYNTAX)
            found.append(default)
        elif kind == "I":
            found.append(integer(value, f"parameter P{place + 1}"))
        else:
            text = text_of(value)
            found.append("" if text is None else text)
    return found


def check_buffer(service: DataService, values: Values, buffer: object, size: int) -> None:
    """Make sure that the data fit into a variable by their type, and its size is not exceeded.

    Raises:
        Fault: They do not.
    """
    if isinstance(values, str):
        if not isinstance(buffer, CharacterField):
            raise Fault(INVALID_PARAMETER, f"MCODS({service.number}) needs a dimensioned string variable")
        capacity = buffer.size
    else:
        whole = service.kind == "X" and all(isinstance(each, int) for each in values)
        holders = _HOLDERS["I" if whole else service.kind]
        kind = buffer.kind if isinstance(buffer, Box | Field) else ""
        if not kind or kind not in holders or (isinstance(buffer, Field) and len(buffer.sizes) != 1):
            names = " or ".join(_KINDS[each] for each in holders)
            raise Fault(INVALID_PARAMETER, f"MCODS({service.number}) needs {names}, one variable or a field")
        capacity = buffer.sizes[0] if isinstance(buffer, Field) else 1
    if not 1 <= size <= capacity:
        raise Fault(INVALID_FIELD_LIMIT, f"the size is {size}, the variable has room for {capacity}")


def fill(service: DataService, values: Values, buffer: object, size: int) -> None:
    """Write data into a variable that has been checked."""
    if isinstance(values, str):
        assert isinstance(buffer, CharacterField)
        buffer.assign(values[:size])
        return
    rest = [] if service.fill is None else [service.fill] * (size - len(values))
    written = [*values, *rest][:size]
    if isinstance(buffer, Box):
        if written:
            buffer.value = held(buffer.kind, written[0])
        return
    assert isinstance(buffer, Field)
    for index, value in enumerate(written, 1):
        buffer[index] = held(buffer.kind, value)


def held(kind: str, value: float) -> float:
    """Return a number as a variable of a type holds it."""
    if kind == "I":
        return int(value)
    return float(struct.unpack("<f", struct.pack("<f", value))[0]) if kind == "R" else float(value)
