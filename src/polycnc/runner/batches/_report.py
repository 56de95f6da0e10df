"""The report of a batch for people: one page that sorts and filters and loads nothing from elsewhere."""

from __future__ import annotations

import base64
import gzip
import io
import json
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any, Protocol

from polycnc.runner.batches._job import ProgramReport

MOST_DETAILED = 5_000
"""Above so many reports a page has no pictures and no slowest blocks, or it would not open."""

_MOST_MESSAGES = 20


class Reports(Protocol):
    """The reports of a batch."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[ProgramReport]: ...


def write_report(batch: Reports, path: Path) -> None:
    """Write the page to a file."""
    detailed = len(batch) <= MOST_DETAILED
    packed = io.BytesIO()
    with gzip.GzipFile(fileobj=packed, mode="wb", compresslevel=6, mtime=0) as file:
        lead = "["
        for report in batch:
            file.write((lead + json.dumps(_row(report, detailed), separators=(",", ":"))).encode())
            lead = ",\n"
        file.write(b"]" if lead != "[" else b"[]")
    parts = {
        "STYLE": _asset("report.css"),
        "DATA": base64.b64encode(packed.getvalue()).decode("ascii"),
        "SCRIPT": _asset("report.js"),
    }
    pieces = _asset("report.html").split("%%")
    page = "".join(parts[piece] if i % 2 else piece for i, piece in enumerate(pieces))
    path.write_text(page, encoding="utf-8", newline="\n")


def _row(report: ProgramReport, detailed: bool) -> dict[str, Any]:
    row = report.as_dict()
    del row["cycles"], row["rapid_time_s"], row["cutting_path_mm"]
    if len(report.messages) > _MOST_MESSAGES:
        left_out = len(report.messages) - _MOST_MESSAGES
        row["messages"] = [*report.messages[:_MOST_MESSAGES], f"and {left_out:,} more"]
    if not detailed:
        row["thumbnail"], row["slowest"] = None, []
    return row


def _asset(name: str) -> str:
    return (resources.files("polycnc.runner.batches") / name).read_text("utf-8")
