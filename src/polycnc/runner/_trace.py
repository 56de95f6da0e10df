"""Traces: the recorder's rows as arrays, written to a file as they come, and read from one."""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import BLOCK, FEED_MM_S, IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecords
from polycnc.outputs import check_output, complete_or_absent, format_of
from polycnc.runner._blocks import ExecutionCollector
from polycnc.runner._result import Trace

Floats = npt.NDArray[np.float64]

_COLUMNS = (TIME_S, BLOCK, FEED_MM_S)
_COLUMN_NAMES = ("t_s", "block", "feed_mm_s")
_AXIS_COLUMN = re.compile(r"([A-Z][0-9]*)(_actual)?_(mm|deg)")


def trace_columns(config: MachineConfig, actual: bool) -> list[str]:
    """Return the names of a trace file's columns."""
    names = [*_COLUMN_NAMES, *(f"{axis.name}_{axis.unit}" for axis in config.axes)]
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
        self._executions = ExecutionCollector()
        self._tagged = False

    def add(self, rows: Floats) -> None:
        """Take a piece of the record; the recorder will write over it, so it is copied."""
        self._pieces.append(rows.copy())

    def add_tagged(self, rows: Floats, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Take a piece of the record, and which block each row belongs to."""
        self.add(rows)
        self._tagged = True
        self._executions.add(tags, records)

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
            feed_mm_s=rows[:, FEED_MM_S],
            rapid=rows[:, IS_RAPID] != 0.0,
            setpoint=rows[:, LEADING : LEADING + axes],
            actual=rows[:, LEADING + axes :] if self._actual else None,
            execution=self._executions.execution() if self._tagged else None,
        )


class TraceFile(Protocol):
    """A trace file that is written as the program runs."""

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""

    def close(self, complete: bool) -> None:
        """Finish the file; one that is not complete will be removed."""


class CsvTrace:
    """Write a trace as comma-separated text; numbers are the shortest that read back as the same double."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._file = path.open("w", encoding="ascii", newline="\n")
        self._file.write(",".join(columns) + "\n")

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""
        texts = [_number_texts(column) for column in file_columns(rows).T]
        texts[_COLUMNS.index(BLOCK)] = list(map(str, rows[:, BLOCK].astype(np.int64).tolist()))
        self._file.writelines(f"{line}\n" for line in map(",".join, zip(*texts, strict=True)))

    def close(self, complete: bool) -> None:
        """Finish the file."""
        self._file.close()


def _number_texts(column: Floats) -> list[str]:
    """Return the numbers of a column as text; one that repeats the number before it is written once."""
    bits = np.ascontiguousarray(column).view(np.int64)
    starts = np.flatnonzero(np.diff(bits, prepend=~bits[:1]))
    texts = list(map(float.__repr__, column[starts].tolist()))
    if len(texts) == len(column):
        return texts
    repeated: list[str] = np.repeat(np.array(texts, object), np.diff(starts, append=len(column))).tolist()
    return repeated


class NpzTrace:
    """Collect a trace and write it as a NumPy archive, one array per column."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._file = path.open("wb")
        self._columns = list(columns)
        self._pieces: list[Floats] = []

    def add(self, rows: Floats) -> None:
        """Keep a piece of the record."""
        self._pieces.append(file_columns(rows))

    def close(self, complete: bool) -> None:
        """Write the file."""
        with self._file:
            if complete:
                rows = np.concatenate(self._pieces) if self._pieces else np.zeros((0, len(self._columns)))
                arrays: dict[str, Any] = {name: rows[:, i] for i, name in enumerate(self._columns)}
                arrays["block"] = arrays["block"].astype(np.int64)
                np.savez(self._file, **arrays)


class ParquetTrace:
    """Write a trace as a Parquet file, one row group per piece of the record."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._arrow = _pyarrow()
        types = [self._arrow.int64() if name == "block" else self._arrow.float64() for name in columns]
        self._schema = self._arrow.schema(list(zip(columns, types, strict=True)))
        self._writer = self._arrow.parquet.ParquetWriter(str(path), self._schema)

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""
        kept = file_columns(rows)
        arrays = [
            kept[:, i].astype(np.int64) if name == "block" else np.ascontiguousarray(kept[:, i])
            for i, name in enumerate(self._schema.names)
        ]
        self._writer.write_table(self._arrow.table(arrays, schema=self._schema))

    def close(self, complete: bool) -> None:
        """Finish the file."""
        self._writer.close()


def _pyarrow() -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise UsageError(
            "a Parquet trace needs pyarrow", hint="Install it: pip install 'polycnc[parquet]'."
        ) from None
    return pyarrow


_FORMATS: dict[str, type[CsvTrace] | type[NpzTrace] | type[ParquetTrace]] = {
    ".csv": CsvTrace,
    ".npz": NpzTrace,
    ".parquet": ParquetTrace,
}
TRACE_FORMATS = tuple(_FORMATS)


class TraceWriter:
    """Write a trace to a file whose extension names the format: .csv, .npz or .parquet.

    The file appears under its name when it is complete; a run that is broken off leaves none behind.

    Raises:
        UsageError: an unknown extension, no such folder, or pyarrow is needed and not installed.
    """

    def __init__(self, path: str | Path, config: MachineConfig, actual: bool) -> None:
        checked = check_output(path, TRACE_FORMATS, "a trace")
        with ExitStack() as stack:
            partial = stack.enter_context(complete_or_absent(checked))
            self._file: TraceFile = _FORMATS[format_of(checked, TRACE_FORMATS)](
                partial, trace_columns(config, actual)
            )
            stack.push(self._close)
            self._stack = stack.pop_all()

    def __enter__(self) -> TraceWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def _close(self, kind: type[BaseException] | None, *_: object) -> None:
        self._file.close(complete=kind is None)

    def add(self, rows: Floats) -> None:
        """Write a piece of the record."""
        self._file.add(rows)


def read_trace(path: str | Path) -> Trace:
    """Read a trace file; which moves were rapids is not in it, so none is marked.

    Raises:
        UsageError: no such file, an unknown extension, a damaged file, or columns that are not those of a trace.
    """
    path = Path(path)
    readers = {".csv": _read_csv, ".npz": _read_npz, ".parquet": _read_parquet}
    read = readers.get(path.suffix.lower())
    if read is None:
        raise UsageError(
            f"{path} is no trace file", hint=f"Its name must end with one of {', '.join(readers)}."
        )
    if not path.is_file():
        raise UsageError(f"no such file: {path}", hint="Check the name and the folder.")
    try:
        columns = read(path)
    except UsageError:
        raise
    except Exception as error:  # whatever the readers of three formats raise for what is no such file
        why = (str(error).splitlines() or [""])[0]
        raise UsageError(f"{path} cannot be read as a trace: {why}", hint=_WRITE_ANEW) from error
    axes = [match for name in columns if (match := _AXIS_COLUMN.fullmatch(name))]
    if not axes or tuple(columns)[: len(_COLUMN_NAMES)] != _COLUMN_NAMES:
        raise UsageError(
            f"{path} does not hold a trace", hint="Its columns begin with t_s, block, feed_mm_s."
        )
    setpoints = [match for match in axes if not match[2]]
    actual = [columns[match[0]] for match in axes if match[2]]
    if trouble := _trouble(columns, len(setpoints), len(actual)):
        raise UsageError(f"{path} is damaged: {trouble}", hint=_WRITE_ANEW)
    return Trace(
        axes=tuple(match[1] for match in setpoints),
        units=tuple(match[3] for match in setpoints),
        t_s=columns["t_s"],
        block=columns["block"].astype(np.int64),
        feed_mm_s=columns["feed_mm_s"],
        rapid=np.zeros(len(columns["t_s"]), np.bool_),
        setpoint=np.column_stack([columns[match[0]] for match in setpoints]),
        actual=np.column_stack(actual) if actual else None,
    )


_WRITE_ANEW = "Write it anew: polycnc run --trace."
_LARGEST_BLOCK = 2.0**53


def _trouble(columns: dict[str, Floats], setpoints: int, actual: int) -> str:
    """Return what is wrong with the columns of a trace; empty if nothing is."""
    rows = len(columns["t_s"]) if columns["t_s"].ndim == 1 else -1
    for name, column in columns.items():
        if column.shape != (rows,):
            return f"column {name} has another size than the others"
        if column.dtype.kind not in "fiu":
            return f"column {name} does not hold numbers"
    if not np.all(np.abs(columns["block"]) <= _LARGEST_BLOCK):
        return "column block holds what is no number of a block"
    return "" if setpoints and actual in (0, setpoints) else "positions of axes are missing"


def _read_csv(path: Path) -> dict[str, Floats]:
    with path.open(encoding="utf-8") as file:
        names = file.readline().rstrip("\n").split(",")
        if len(set(names)) != len(names):
            raise ValueError("two columns have the same name")
        lines = file.readlines()
    rows = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, len(names)))
    return dict(zip(names, rows.T, strict=True))


def _read_npz(path: Path) -> dict[str, Floats]:
    with np.load(path, allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}


def _read_parquet(path: Path) -> dict[str, Floats]:
    table = _pyarrow().parquet.read_table(path)
    return {name: table[name].to_numpy() for name in table.column_names}
