"""The libraries in the folder `vendor`, file by file as npm brings them, with their licences."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable

VENDOR = "vendor"
BARE = {"three": "three.module.min.js", "uplot": "uPlot.esm.js"}
"""The files of libraries that are imported by a bare name."""


@dataclass(frozen=True, slots=True)
class Library:
    """A file of a library: which package and version it is from, under what licence, and the SHA-256 of its bytes."""

    file: str
    package: str
    version: str
    licence: str
    licence_file: str
    sha256: str


def folder(name: str) -> Traversable:
    """Return a folder of this package."""
    return resources.files("polycnc.web") / name


def libraries() -> tuple[Library, ...]:
    """Return the table of the files that come from elsewhere."""
    text = (folder(VENDOR) / "licences.tsv").read_text("utf-8")
    return tuple(Library(**row) for row in csv.DictReader(text.splitlines(), delimiter="\t"))
