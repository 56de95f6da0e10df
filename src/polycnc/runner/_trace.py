"""Traces: the recorder's rows as arrays, or written to a file as they come."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import BLOCK, FEED, IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig
from polycnc.runner._result import Trace

Floats = npt.NDArray[np.float64]

_COLUMNS = (TIME_S, BLOCK, FEED)


def trace_columns(config: MachineConfig, actual: bool) -> list[str]:
    """Return the names of a trace file's columns."""
    names = ["t_s", "block", "feed_mm_s", *(f"{axis.name}_{axis.unit}" for axis in config.axes)]
    if actual:
        names += [f"{axis.name}_actual_{axis.unit}" for axis in config.axes]
    return names


def file_columns(rows: Floats) -> Floats:
    """Return the columns of recorder rows that go into a file, in order."""
    kept = [*_COLUMNS, *range(LEADING, rows.shape[1])]
    return rows[:, kept]


class TraceCollector:
    """Collect the recorder's rows in memory."""

    def __init__(self, config: MachineConfig, actual: bool) -> None:
        self._config = config
        self._actual = actual
        self._pieces: list[Floats] = []

    def add(self, rows: Floats) -> None:
        """Take a piece of the record; the recorder will write over it, so it is copied."""
        self._pieces.append(rows.copy())

    def trace(self) -> Trace:
        """Return everything collected."""
        axes = len(self._config.axes)
        width = LEADING + axes * (2 if self._actual else 1)
        rows = np.concatenate(self._pieces) if self._pieces else np.zeros((0, width))
        return Trace(
            axes=self._config.axis_names,
            units=tuple(axis.unit for axis in self._config.axes),
            t_s=rows[:, TIME_S],
            block=rows[:, BLOCK].astype(np.int64),
            feed_mm_s=rows[:, FEED],
            rapid=rows[:, IS_RAPID] != 0.0,
            setpoint=rows[:, LEADING : LEADING + axes],
            actual=rows[:, LEADING + axes :] if self._actual else None,
        )


class TraceFile(Protocol):
    """A trace file that is written as the program runs."""

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""

    def close(self) -> None:
        """Finish the file."""


class CsvTrace:
    """Write a trace as comma-separated text, one row per control cycle."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._file = path.open("w", encoding="ascii", newline="\n")
        self._file.write(",".join(columns) + "\n")
        self._format = ",".join(["%.9f", "%d"] + ["%.15g"] * (len(columns) - 2))

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""
        text = io.StringIO()
        line = self._format + "\n"
        for row in file_columns(rows).tolist():
            text.write(line % tuple(row))
        self._file.write(text.getvalue())

    def close(self) -> None:
        """Finish the file."""
        self._file.close()


class NpzTrace:
    """Collect a trace and write it as a NumPy archive, one array per column."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._path = path
        self._columns = list(columns)
        self._pieces: list[Floats] = []

    def add(self, rows: Floats) -> None:
        """Keep a piece of the record."""
        self._pieces.append(file_columns(rows))

    def close(self) -> None:
        """Write the file."""
        rows = np.concatenate(self._pieces) if self._pieces else np.zeros((0, len(self._columns)))
        arrays: dict[str, Any] = {name: rows[:, index] for index, name in enumerate(self._columns)}
        arrays["block"] = arrays["block"].astype(np.int64)
        np.savez_compressed(self._path, **arrays)


class ParquetTrace:
    """Write a trace as a Parquet file, one row group per piece of the record."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        try:
            import pyarrow
            import pyarrow.parquet
        except ImportError:
            raise UsageError(
                "a Parquet trace needs pyarrow", hint="Install it: pip install 'polycnc[parquet]'."
            ) from None
        self._arrow = pyarrow
        types = [pyarrow.int64() if name == "block" else pyarrow.float64() for name in columns]
        self._schema = pyarrow.schema(list(zip(columns, types, strict=True)))
        self._writer = pyarrow.parquet.ParquetWriter(str(path), self._schema)

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""
        kept = file_columns(rows)
        arrays = [
            kept[:, i].astype(np.int64) if name == "block" else np.ascontiguousarray(kept[:, i])
            for i, name in enumerate(self._schema.names)
        ]
        self._writer.write_table(self._arrow.table(arrays, schema=self._schema))

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()


_FORMATS = {".csv": CsvTrace, ".npz": NpzTrace, ".parquet": ParquetTrace}


class TraceWriter:
    """Write a trace to a file whose extension names the format: .csv, .npz or .parquet.

    The file appears under its name when it is complete; a run that fails leaves none behind.
    """

    def __init__(self, path: Path, config: MachineConfig, actual: bool) -> None:
        kind = _FORMATS.get(path.suffix.lower())
        if kind is None:
            raise UsageError(
                f"a trace cannot be written as '{path.suffix or path.name}'",
                hint=f"Use {', '.join(_FORMATS)}.",
            )
        if not path.parent.is_dir():
            raise UsageError(f"no such folder: {path.parent}", hint="Make it first.")
        self._path = path
        self._partial = path.with_name(f".{path.stem}.partial{path.suffix}")
        self._file: TraceFile = kind(self._partial, trace_columns(config, actual))

    def __enter__(self) -> TraceWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()
        if kind is None:
            self._partial.replace(self._path)
        else:
            self._partial.unlink(missing_ok=True)

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""
        self._file.add(rows)
