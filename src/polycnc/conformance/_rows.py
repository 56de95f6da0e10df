"""Read the conformance rows: tab-separated files, one per system, one statement of a manual per line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from polycnc.errors import ConfigurationError, SourcePosition

SYSTEMS = MappingProxyType(
    {
        "fanuc": "FANUC Power Mate library",
        "apci": "APCI-8001/8008 motion board",
        "imc": "iMC motion card",
        "cpl": "Typ3 osa / PNC CPL",
        "post": "Post-processor macros",
    }
)
"""System name, which is also its file's name, to its title; in the order in which reports show them."""

ID_PREFIXES = MappingProxyType(
    {
        "fanuc": ("fanuc.",),
        "apci": ("apci.", "sap."),
        "imc": ("imc.",),
        "cpl": ("cpl.",),
        "post": ("post.",),
    }
)
"""How the row ids of each system begin; ``sap.`` rows are the board's own task language."""

COLUMNS = ("id", "group", "name", "kind", "signature", "lines", "behaviour", "errors")


@dataclass(frozen=True, slots=True)
class Row:
    """Hold one statement of a manual: what it is called, where it stands and what must happen.

    ``lines`` names the lines of the manual's plain text; ``signature`` and ``errors`` may be empty.
    """

    id: str
    system: str
    group: str
    name: str
    kind: str
    signature: str
    lines: str
    behaviour: str
    errors: str


def data_folder() -> Path:
    """Return the folder of the conformance files: package data, or ``conformance/`` of a checkout.

    Raises:
        ConfigurationError: Neither is there.
    """
    here = Path(__file__).resolve()
    candidates = (here.parent / "data", here.parents[3] / "conformance")
    for folder in candidates:
        if all((folder / f"{system}.tsv").is_file() for system in SYSTEMS):
            return folder
    raise ConfigurationError(
        f"conformance rows not found in {candidates[0]} nor in {candidates[1]}",
        hint="Install polycnc again, or run it from a complete checkout.",
    )


def read_rows(folder: Path) -> dict[str, Row]:
    """Return every row of every system by its id, in the order of the files.

    Raises:
        ConfigurationError: A file is missing or malformed; an id is used twice or is another system's.
    """
    rows: dict[str, Row] = {}
    for system in SYSTEMS:
        for row, place in _rows_of(system, folder / f"{system}.tsv"):
            if row.id in rows:
                raise ConfigurationError(
                    f"row id '{row.id}' is used twice", hint="Give each row an id of its own.", position=place
                )
            if not row.id.startswith(ID_PREFIXES[system]):
                prefixes = " or ".join(ID_PREFIXES[system])
                raise ConfigurationError(
                    f"row id '{row.id}' does not belong to {system}",
                    hint=f"Ids in this file begin with {prefixes}",
                    position=place,
                )
            rows[row.id] = row
    return rows


def table_lines(path: Path, columns: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], SourcePosition]]:
    """Yield the fields and the place of each line of a tab-separated file, after checking its header.

    Raises:
        ConfigurationError: The file cannot be read, or its header or the number of fields of a line is wrong.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise ConfigurationError(
            f"{path} cannot be read: {error.strerror}", hint="Restore the file; it belongs to polycnc."
        ) from error
    header = "\t".join(columns)
    for number, text in enumerate(lines or [""], start=1):
        place = SourcePosition(path.name, number, 1, text)
        fields = tuple(text.split("\t"))
        if number == 1 and text != header:
            raise ConfigurationError(
                "wrong header", hint=f"The columns are: {', '.join(columns)}", position=place
            )
        if len(fields) != len(columns):
            raise ConfigurationError(
                f"{len(fields)} fields where {len(columns)} belong",
                hint=f"Separate them by one tab each: {', '.join(columns)}",
                position=place,
            )
        if number > 1:
            yield fields, place


def _rows_of(system: str, path: Path) -> Iterator[tuple[Row, SourcePosition]]:
    for fields, place in table_lines(path, COLUMNS):
        row_id, *others = fields
        yield Row(row_id, system, *others), place
