"""Tools from files: tool tables of LinuxCNC, and lists with a heading (CSV) as CAM systems export them."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Mapping
from pathlib import Path

from polycnc.errors import ConfigurationError, SourcePosition, UsageError
from polycnc.machine import MachineConfig, ToolConfig
from polycnc.runner.machine_sources._tool_table import LARGEST_BYTES, MOST_NUMBER, Tool, table_rows
from polycnc.stock import CHAMFER_DEG, POINT_DEG
from polycnc.units import MM_PER_INCH

_MOST_MM = 1000.0
_INCH = "inch="
_MOST = {"teeth": 200.0, "angle_deg": 180.0, "taper_deg": 90.0}

_COLUMNS = {
    "number": ("number", "tool", "tool number", "t", "no"),
    "length_mm": ("length", "length offset", "z"),
    "diameter": ("diameter", "dia", "d"),
    "radius_mm": ("radius",),
    "corner_mm": ("corner radius", "corner", "cr"),
    "flute_mm": ("flute length", "flute", "cutting length"),
    "tip_diameter_mm": ("tip diameter", "tip"),
    "angle_deg": ("angle", "tip angle", "point angle", "included angle"),
    "taper_deg": ("taper angle", "flank angle", "taper"),
    "teeth": ("teeth", "flutes", "number of flutes"),
    "shape": ("shape", "type", "kind"),
    "description": ("description", "name", "comment", "remark"),
    "unit": ("unit", "units"),
}
"""What a column is, by its heading without case, unit and name in brackets."""
_NAMED = {heading: key for key, headings in _COLUMNS.items() for heading in headings}
_TEXTS = ("shape", "description", "unit")
_NO_LENGTHS = ("number", "angle_deg", "taper_deg", "teeth")
_SHAPES = (
    ("ball", re.compile("ball", re.I)),
    ("bull", re.compile("bull|radius mill", re.I)),
    ("taper", re.compile("taper", re.I)),
    ("chamfer", re.compile("chamfer|v-?bit|engrav|spot|countersink", re.I)),
    ("drill", re.compile("drill|tap|ream", re.I)),
    ("boring", re.compile("boring", re.I)),
    ("flat", re.compile("flat|square|end ?mill|face mill", re.I)),
)
_UNIT = re.compile(r"[ (\[]+(mm|in|inch)[)\]]?$")


def with_tools(config: MachineConfig, source: str | Path) -> MachineConfig:
    """Return a machine with the tools of a file in place of its own of the same numbers.

    `inch=FILE` is a table of LinuxCNC, or a list, in inches.

    Raises:
        UsageError: the file is neither a `.tbl` nor a `.csv` file.
        ConfigurationError: it cannot be read, or what it says of a tool cannot be.
    """
    path, to_mm = _named(source)
    kind = path.suffix.lower()
    if kind not in (".tbl", ".csv"):
        raise UsageError(
            f"'{path}' is no list of tools", hint="Name a .tbl file of LinuxCNC, or a .csv file."
        )
    text = _content(path)
    found = dict(table_rows(text, str(path), to_mm)) if kind == ".tbl" else _listed(text, str(path), to_mm)
    tools = {number: ToolConfig.model_validate(tool) for number, (tool, _) in found.items()}
    return config.model_copy(update={"tools": {**config.tools, **tools}})


def tools_file(source: str | Path) -> Path:
    """Return the file that `FILE` or `inch=FILE` names."""
    return _named(source)[0]


def _named(source: str | Path) -> tuple[Path, float]:
    """Return a file, and what its lengths are in mm."""
    is_inch = str(source).lower().startswith(_INCH)
    return (Path(str(source)[len(_INCH) :]), MM_PER_INCH) if is_inch else (Path(source), 1.0)


def _content(path: Path) -> str:
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_BYTES + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise ConfigurationError(
            f"cannot read '{path}': {why}", hint="Check the name of the file."
        ) from error
    if len(content) > LARGEST_BYTES:
        raise ConfigurationError(f"'{path}' is too large for a list of tools", hint="Name another file.")
    return content.decode("utf-8-sig", "replace")


def _listed(text: str, file: str, to_mm: float) -> dict[int, tuple[Tool, tuple[str, ...]]]:
    """Return the tools of a list with a heading; columns that say nothing of a shape are left out."""
    first = text.partition("\n")[0]
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=max(",;\t", key=first.count), strict=True)
    columns: dict[int, tuple[str, float | None]] = {}
    found: dict[int, tuple[Tool, tuple[str, ...]]] = {}
    lines = text.splitlines()
    try:
        for row in reader:
            if not any(cell.strip() for cell in row):
                continue
            at = SourcePosition(file, reader.line_num, 1, lines[min(reader.line_num, len(lines)) - 1])
            if not columns:
                columns = _heading(row, at)
                continue
            number, tool = _row(row, columns, to_mm, at)
            if number in found:
                raise ConfigurationError(
                    f"tool {number} stands twice", position=at, hint="Leave one of them."
                )
            found[number] = tool, ()
    except csv.Error as error:
        at = SourcePosition(file, reader.line_num, 1, "")
        raise ConfigurationError(
            f"this is no row of a list: {error}", position=at, hint="Correct it."
        ) from None
    if not columns:
        _heading([], SourcePosition(file, 1, 1, ""))
    return found


def _heading(row: list[str], at: SourcePosition) -> dict[int, tuple[str, float | None]]:
    """Return what each column is that is read, and what its unit is in mm, if it says so."""
    columns: dict[int, tuple[str, float | None]] = {}
    for k, cell in enumerate(row):
        text = re.sub(r"\s*\(tool_\w*\)", "", cell.strip().lower()).replace("_", " ")
        unit = _UNIT.search(text)
        key = _NAMED.get(_UNIT.sub("", text).strip())
        if key is not None and key not in {each for each, _ in columns.values()}:
            columns[k] = key, None if unit is None else 1.0 if unit[1] == "mm" else MM_PER_INCH
    if "number" not in {key for key, _ in columns.values()}:
        raise ConfigurationError(
            "no column has the numbers of the tools",
            position=at,
            hint="Write a first line like: number,shape,diameter,corner radius,length,description",
        )
    return columns


def _row(
    row: list[str], columns: Mapping[int, tuple[str, float | None]], to_mm: float, at: SourcePosition
) -> tuple[int, Tool]:
    cells = {
        key: (row[k].strip(), unit) for k, (key, unit) in columns.items() if k < len(row) and row[k].strip()
    }
    unit = cells.get("unit", ("", None))[0].lower()
    usual = MM_PER_INCH if unit.startswith("in") else 1.0 if unit.startswith("m") else to_mm
    values = {
        key: _number(key, cell, at) * (1.0 if key in _NO_LENGTHS else own or usual)
        for key, (cell, own) in cells.items()
        if key not in _TEXTS
    }
    number = values.pop("number", -1.0)
    if not 0 <= number <= MOST_NUMBER or number != round(number):
        raise ConfigurationError(
            "the number of a tool is missing, or none", position=at, hint=f"Give 0 to {MOST_NUMBER}."
        )
    shape, description = (cells.get(key, ("", None))[0] for key in ("shape", "description"))
    return int(number), _shaped(values, shape, description)


def _number(key: str, cell: str, at: SourcePosition) -> float:
    try:
        value = float(cell.replace(",", "."))
    except ValueError:
        value = math.nan
    most = _MOST.get(key, _MOST_MM)
    if key != "number" and (not abs(value) <= most or (value < 0.0 and key != "length_mm")):
        raise ConfigurationError(
            f"'{cell}' is no {_COLUMNS[key][0]} of a tool", position=at, hint=f"Give 0 to {most:g}."
        )
    return value


def _shaped(values: dict[str, float], kind: str, description: str) -> Tool:
    """Return a tool as the machine file has it; without a shape that is known its text says what it is."""
    tool: Tool = {
        key: value for key, value in values.items() if key not in ("diameter", "taper_deg", "teeth")
    }
    if "diameter" in values:
        tool["radius_mm"] = values["diameter"] / 2.0
    if "teeth" in values:
        tool["teeth"] = round(values["teeth"])
    if text := " ".join(each for each in (kind, description) if each):
        tool["description"] = text
    if not tool.get("flute_mm"):
        tool.pop("flute_mm", None)
    shape = next((name for name, sign in _SHAPES if sign.search(kind)), None)
    if shape == "bull" and not values.get("corner_mm"):
        shape = "flat"
    if shape == "taper":
        tool["angle_deg"] = values.get("taper_deg", 0.0)
        shape = shape if tool["angle_deg"] else None
    elif shape in ("drill", "chamfer") and not values.get("angle_deg"):
        tool["angle_deg"] = POINT_DEG if shape == "drill" else CHAMFER_DEG
    elif shape not in ("drill", "chamfer"):
        tool.pop("angle_deg", None)
    if shape is not None and tool.get("radius_mm"):
        tool["shape"] = shape
    return tool
