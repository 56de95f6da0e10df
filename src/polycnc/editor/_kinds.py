"""What a text is: a part program, a stand-alone program, or one of the TOML files of polycnc."""

from __future__ import annotations

import re
from enum import Enum
from pathlib import Path

from pydantic import BaseModel

from polycnc.machine import MachineConfig
from polycnc.nc import Dialect


class Kind(Enum):
    """What a text is."""

    PROGRAM = "part program"
    STAND_ALONE = "stand-alone program"
    MACHINE = "machine file"
    DIALECT = "dialect file"
    CONTROL = "control file"
    UNKNOWN = "TOML file of others"


_KEY = re.compile(r"""^[ \t]*(?:\[{1,2}[ \t]*)?["']?([^\s.=\[\]"'#]+)""", re.MULTILINE)
_TABLE = re.compile(r"^[ \t]*\[", re.MULTILINE)


def kind_of(name: str, text: str) -> Kind:
    """Return what a text is, from the ending of its name, and of a TOML file from its keys, finished or not."""
    match Path(name).suffix.lower():
        case ".sap":
            return Kind.STAND_ALONE
        case ".toml":
            return _of_keys(text)
        case _:
            return Kind.PROGRAM


def model_of(kind: Kind) -> type[BaseModel] | None:
    """Return the tables of a TOML file, None of what is none."""
    from polycnc.post import ControlTables

    models: dict[Kind, type[BaseModel]] = {
        Kind.MACHINE: MachineConfig,
        Kind.DIALECT: Dialect,
        Kind.CONTROL: ControlTables,
    }
    return models.get(kind)


def _of_keys(text: str) -> Kind:
    """Return the kind whose keys at the top and names of tables the text has most of."""
    from polycnc.post import SECTIONS

    first = _TABLE.search(text)
    top = text[: first.start()] if first else text
    found = set(_KEY.findall(top)) | {each[1] for each in re.finditer(_HEADER, text)}
    found = {SECTIONS.get(each, each) for each in found} - {"name", "description"}
    points = {}
    for kind in (Kind.MACHINE, Kind.DIALECT, Kind.CONTROL):
        model = model_of(kind)
        assert model is not None
        names = {field.alias or key for key, field in model.model_fields.items()}
        points[kind] = len(found & names)
    best = max(points, key=lambda kind: points[kind])
    return best if points[best] and 2 * points[best] >= len(found) else Kind.UNKNOWN


_HEADER = re.compile(r"""^[ \t]*\[{1,2}[ \t]*["']?([^\s.=\[\]"'#]+)""", re.MULTILINE)
