"""The rows are those of the inventory that they come from, where that is at hand, in the repository's wording."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from polycnc import conformance

REPOSITORY = Path(__file__).resolve().parents[2]
FILES = {
    "apci": ("apci",),
    "imc": ("imc",),
    "post": ("post",),
    "cpl": ("cpl",),
    "fanuc": ("fanuc_a", "fanuc_b"),
}
COLUMNS = ("id", "group", "name", "kind", "signature", "lines", "behaviour", "errors")
REWORDED = {
    "apci.ErrorReg.10.SsfWaitRefused",
    "apci.ifs.23.EpmOpmfResetFlag",
    "apci.mode.spool.conditions",
    "apci.scope.part1",
    "apci.stepcnct",
    "fanuc.MAX_AXIS",
    "fanuc.ODBDGN",
    "fanuc.common.ALL_AXES2",
    "fanuc.common.MAX_AXIS2",
    "fanuc.common.allmode",
    "fanuc.common.decl",
    "fanuc.common.handle2",
    "fanuc.common.types",
    "fanuc.concept.option_none",
    "fanuc.concept.struct_packing",
    "imc.IMC_GetParam48",
    "imc.concept.lost_sections",
}
"""Rows that say the same in other words, or that speak of the inventory itself there."""


def inventory() -> Path | None:
    """Return the folder of the inventory, if there is one."""
    data = os.environ.get("POLYCNC_DATA")
    places = [Path(data).parent] if data else []
    places += [each / "shared" for each in (REPOSITORY.parent, REPOSITORY.parent.parent)]
    return next((place / "inventory" for place in places if (place / "inventory").is_dir()), None)


def settled(text: str) -> str:
    """Return a text with what it suggests as what polycnc takes it for."""
    text = re.sub(r"(\S+) suggested\b", r"taken as \1", re.sub(r"\bsuggest(ed:)? ", "taken as ", text))
    return text.replace("sensible: ", "taken as: ").replace("Sensible reading: ", "Taken as: ").strip()


def in_our_words(row: dict[str, str]) -> dict[str, str]:
    """Return a row as the repository writes it: the section with the lines, suggestions settled."""
    own = {name: row[name].strip() for name in COLUMNS}
    for name in ("behaviour", "errors"):
        own[name] = settled(own[name])
    own["lines"] = re.sub(r"\s*;\s*", ",", own["lines"])
    found = re.fullmatch(r"(.*?)(?: \(chapter ([\d.]+)\))? (\d+(?:\.\d+)+)", own["group"])
    if found:
        own["group"] = found[1] + (f" ({found[2]})" if found[2] else "")
        own["lines"] += f" ({found[3]})"
    return own


def read(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table."""
    header, *lines = path.read_text(encoding="utf-8").splitlines()
    names = header.split("\t")
    return [dict(zip(names, line.split("\t"), strict=True)) for line in lines]


def test_every_system_is_compared() -> None:
    assert set(FILES) == set(conformance.SYSTEMS)


@pytest.mark.parametrize("system", FILES)
def test_ids_and_texts_are_those_of_the_inventory(system: str) -> None:
    folder = inventory()
    if folder is None:
        pytest.skip(
            "there is no inventory: put it beside the checkout as shared/inventory, or name POLYCNC_DATA"
        )
    theirs = [in_our_words(row) for file in FILES[system] for row in read(folder / f"{file}.tsv")]
    ours = read(REPOSITORY / "conformance" / f"{system}.tsv")
    assert [row["id"] for row in ours] == [row["id"] for row in theirs]
    different = [
        row["id"]
        for row, other in zip(ours, theirs, strict=True)
        if row != other and row["id"] not in REWORDED
    ]
    assert different == []
