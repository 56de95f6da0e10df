"""Write the reports of a batch: a table for programs (CSV, Parquet) or a page for people (HTML)."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from polycnc.errors import UsageError
from polycnc.outputs import check_output, complete_or_absent, keep_inputs
from polycnc.runner._trace_formats import pyarrow_for
from polycnc.runner.batches._job import ProgramReport
from polycnc.runner.batches._report import Reports, write_report

_PIECE = 4096  # rows of a piece of a Parquet file
_NUMBERS = (
    "time_s",
    "cutting_time_s",
    "rapid_time_s",
    "waiting_time_s",
    "path_mm",
    "cutting_path_mm",
    "top_feed_mm_min",
    "removed_mm3",
)
_COLUMNS = (
    "program",
    "ok",
    "time_s",
    "cutting_time_s",
    "path_mm",
    "errors",
    "messages",
    "status",
    "machine",
    "dialect",
    "override_percent",
    "tolerance_mm",
    "rapid_time_s",
    "waiting_time_s",
    "cutting_path_mm",
    "top_feed_mm_min",
    "blocks",
    "cycles",
    "removed_mm3",
)


def _write_csv(batch: Reports, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(_COLUMNS)
        for report in batch:
            writer.writerow([_cell(getattr(report, name)) for name in _COLUMNS])


def _cell(value: object) -> object:
    if isinstance(value, list):
        return "\n".join(map(str, value))
    return "" if value is None else str(value).lower() if isinstance(value, bool) else value


def _write_parquet(batch: Reports, path: Path) -> None:
    arrow = pyarrow_for("a Parquet table")
    text, number, whole = arrow.string(), arrow.float64(), arrow.int64()
    types: dict[str, Any] = {
        **dict.fromkeys(_COLUMNS, text),
        **dict.fromkeys((*_NUMBERS, "override_percent", "tolerance_mm"), number),
        "ok": arrow.bool_(),
        "errors": arrow.list_(text),
        "messages": arrow.list_(text),
        "blocks": whole,
        "cycles": whole,
        "tools": arrow.list_(
            arrow.struct([("tool", whole), ("cutting_time_s", number), ("rapid_time_s", number)])
        ),
        "extents": arrow.list_(arrow.struct([("axis", text), ("lowest", number), ("highest", number)])),
        "slowest": arrow.list_(arrow.struct([("line", whole), ("block", text), ("time_s", number)])),
    }
    schema = arrow.schema(list(types.items()))
    with arrow.parquet.ParquetWriter(str(path), schema) as writer:
        for piece in _pieces(batch):
            rows = [_row(report) for report in piece]
            writer.write_table(arrow.Table.from_pylist(rows, schema=schema))


def _row(report: ProgramReport) -> dict[str, Any]:
    return {
        **{name: getattr(report, name) for name in _COLUMNS},
        "tools": [
            {"tool": tool, "cutting_time_s": cutting, "rapid_time_s": rapid}
            for tool, cutting, rapid in report.tools
        ],
        "extents": [{"axis": axis, "lowest": low, "highest": high} for axis, low, high in report.extents],
        "slowest": [{"line": line, "block": block, "time_s": time} for line, block, time in report.slowest],
    }


def _pieces(batch: Reports) -> Iterator[list[ProgramReport]]:
    rest = iter(batch)
    while piece := list(islice(rest, _PIECE)):
        yield piece


_WRITERS = {".html": write_report, ".htm": write_report, ".parquet": _write_parquet, ".csv": _write_csv}
BATCH_FORMATS = tuple(_WRITERS)


def check_batch_file(path: str | Path, inputs: Iterable[str | Path] = ()) -> Path:
    """Return the path of a report that could be written there.

    Raises:
        UsageError: another ending, no such folder, one of `inputs`, or pyarrow is needed and not installed.
    """
    target = check_output(path, BATCH_FORMATS, "a report")
    if target.suffix.lower() not in _WRITERS:
        raise UsageError(
            f"a report cannot be written to {target}: the name tells no format",
            hint=f"Use a name that ends with {', '.join(BATCH_FORMATS)}.",
        )
    keep_inputs(target, inputs, "a report")
    if target.suffix.lower() == ".parquet":
        pyarrow_for("a Parquet table")
    return target


def write_batch(batch: Reports, path: str | Path) -> Path:
    """Write the reports of a batch, in their order, and return the path.

    Raises:
        UsageError: see `check_batch_file`.
    """
    target = check_batch_file(path)
    with complete_or_absent(target) as partial:
        _WRITERS[target.suffix.lower()](batch, partial)
    return target
