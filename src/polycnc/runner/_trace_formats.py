"""Trace files by format: rows as they come, and the program of each row once there is a second one.

Whether sub-programs lie in texts of their own is known when the first of them is executed. So a file begins without
the column of programs, and what is there is written once more when it turns out to be needed.
"""

from __future__ import annotations

import csv
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TextIO, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import BLOCK, FEED_MM_S, LEADING, TIME_S

Floats = npt.NDArray[np.float64]
Names = npt.NDArray[np.object_]

COLUMN_NAMES = ("t_s", "block", "feed_mm_s")
PROGRAM = "program"
PROGRAMS = "programs"  # of an archive: the names that its column of programs counts
_COLUMNS = (TIME_S, BLOCK, FEED_MM_S)
_PIECE = 1 << 14  # lines


def file_columns(rows: Floats) -> Floats:
    """Return the columns of recorder rows that go into a file, in order."""
    kept = [*_COLUMNS, *range(LEADING, rows.shape[1])]
    return rows[:, kept]


class CsvTrace:
    """Write a trace as comma-separated text; numbers are the shortest that read back as the same double."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._path = path
        self._file: TextIO = _text_file(path)
        self._file.write(",".join(columns) + "\n")

    def add(self, rows: Floats, programs: Names | None) -> None:
        """Write a piece of the record."""
        texts = [_number_texts(column) for column in file_columns(rows).T]
        texts[_COLUMNS.index(BLOCK)] = list(map(str, rows[:, BLOCK].astype(np.int64).tolist()))
        if programs is not None:
            cells = {name: _cell(name) for name in set(programs.tolist())}
            texts.append([cells[name] for name in programs.tolist()])
        self._file.writelines(f"{line}\n" for line in map(",".join, zip(*texts, strict=True)))

    def add_programs(self, program: str) -> None:
        """Write the file once more, each line with the program."""
        self._file.close()
        with _copied(self._path) as before:
            self._file = _text_file(self._path)
            with before.open(encoding="utf-8") as lines:
                self._file.write(f"{lines.readline()[:-1]},{PROGRAM}\n")
                cell = _cell(program)
                self._file.writelines(f"{line[:-1]},{cell}\n" for line in lines)

    def close(self, complete: bool) -> None:
        """Finish the file."""
        self._file.close()


@contextmanager
def _copied(path: Path) -> Iterator[Path]:
    """Copy a file beside it for a while; the file itself stays, and with it its lock."""
    before = path.with_name(f"{path.name}.before")
    shutil.copyfile(path, before)
    try:
        yield before
    finally:
        before.unlink()


def _text_file(path: Path) -> TextIO:
    return path.open("w", encoding="utf-8", newline="\n")


def _cell(text: str) -> str:
    """Return a text as RFC 4180 wants it in a line."""
    return '"' + text.replace('"', '""') + '"' if any(each in text for each in ',"\r\n') else text


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
    """Collect a trace and write it as a NumPy archive, one array per column.

    The column of programs holds numbers of the names in one array more: as text it would be larger than all the rest.
    """

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._file = path.open("wb")
        self._columns = list(columns)
        self._pieces: list[Floats] = []
        self._numbers: dict[str, int] = {}
        self._programs: list[npt.NDArray[np.int32]] = []

    def add(self, rows: Floats, programs: Names | None) -> None:
        """Keep a piece of the record."""
        self._pieces.append(file_columns(rows))
        if programs is not None:
            numbers = [self._numbers.setdefault(name, len(self._numbers)) for name in programs.tolist()]
            self._programs.append(np.array(numbers, np.int32))

    def add_programs(self, program: str) -> None:
        """Count what there is to a program."""
        self._numbers = {program: 0}
        self._programs = [np.zeros(sum(map(len, self._pieces)), np.int32)]

    def close(self, complete: bool) -> None:
        """Write the file."""
        with self._file:
            if complete:
                rows = np.concatenate(self._pieces) if self._pieces else np.zeros((0, len(self._columns)))
                arrays: dict[str, Any] = {name: rows[:, i] for i, name in enumerate(self._columns)}
                arrays["block"] = arrays["block"].astype(np.int64)
                if self._numbers:
                    arrays[PROGRAM] = np.concatenate(self._programs)
                    arrays[PROGRAMS] = np.array(list(self._numbers), np.str_)
                np.savez(self._file, **arrays)


class ParquetTrace:
    """Write a trace as a Parquet file, one row group per piece of the record."""

    def __init__(self, path: Path, columns: Sequence[str]) -> None:
        self._arrow = pyarrow_for("a Parquet trace")
        self._path = path
        types = [self._arrow.int64() if name == "block" else self._arrow.float64() for name in columns]
        self._schema = self._arrow.schema(list(zip(columns, types, strict=True)))
        self._writer = self._arrow.parquet.ParquetWriter(str(path), self._schema)

    def add(self, rows: Floats, programs: Names | None) -> None:
        """Write a piece of the record."""
        kept = file_columns(rows)
        arrays = [
            kept[:, i].astype(np.int64) if name == "block" else np.ascontiguousarray(kept[:, i])
            for i, name in enumerate(self._schema.names)
            if name != PROGRAM
        ]
        if programs is not None:
            arrays.append(self._names(programs))
        self._writer.write_table(self._arrow.table(arrays, schema=self._schema))

    def _names(self, programs: Names) -> Any:
        kind = self._arrow.dictionary(self._arrow.int32(), self._arrow.string())
        return self._arrow.array(programs, self._arrow.string()).dictionary_encode().cast(kind)

    def add_programs(self, program: str) -> None:
        """Write the file once more, each row with the program."""
        self._writer.close()
        kind = self._arrow.dictionary(self._arrow.int32(), self._arrow.string())
        self._schema = self._schema.append(self._arrow.field(PROGRAM, kind))
        with _copied(self._path) as before:
            self._writer = self._arrow.parquet.ParquetWriter(str(self._path), self._schema)
            with self._arrow.parquet.ParquetFile(str(before)) as file:
                for group in range(file.num_row_groups):
                    table = file.read_row_group(group)
                    names = self._names(np.full(table.num_rows, program, object))
                    arrays = [*table.columns, names]
                    self._writer.write_table(self._arrow.table(arrays, schema=self._schema))

    def close(self, complete: bool) -> None:
        """Finish the file."""
        self._writer.close()


def pyarrow_for(what: str) -> Any:
    """Return pyarrow, with what reads and writes Parquet.

    Raises:
        UsageError: It is not installed; `what` needs it.
    """
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise UsageError(
            f"{what} needs pyarrow", hint="Install it: pip install 'polycnc[parquet]'."
        ) from None
    return pyarrow


TraceFile: TypeAlias = CsvTrace | NpzTrace | ParquetTrace
WRITERS: dict[str, type[TraceFile]] = {
    ".csv": CsvTrace,
    ".npz": NpzTrace,
    ".parquet": ParquetTrace,
}
TRACE_FORMATS = tuple(WRITERS)


def read_columns(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Return the columns of a trace file by name; the column of programs holds the names."""
    return {".csv": _read_csv, ".npz": _read_npz, ".parquet": _read_parquet}[path.suffix.lower()](path)


def _read_csv(path: Path) -> dict[str, npt.NDArray[Any]]:
    with path.open(encoding="utf-8", newline="") as file:
        names = file.readline().rstrip("\r\n").split(",")
        if names[-1] == PROGRAM:
            return _read_csv_with_programs(names, csv.reader(file))
        lines = file.readlines()
    if len(set(names)) != len(names):
        raise ValueError("two columns have the same name")
    rows = np.loadtxt(lines, delimiter=",", ndmin=2) if lines else np.zeros((0, len(names)))
    return dict(zip(names, rows.T, strict=True))


def _read_csv_with_programs(names: list[str], lines: Iterator[list[str]]) -> dict[str, npt.NDArray[Any]]:
    pieces: list[Floats] = []
    programs: list[str] = []
    known: dict[str, str] = {}  # one text for all rows of a program
    numbers: list[list[str]] = []
    for *cells, program in lines:
        numbers.append(cells)
        programs.append(known.setdefault(program, program))
        if len(numbers) == _PIECE:
            pieces.append(np.array(numbers, np.float64))
            numbers = []
    if numbers or not pieces:
        pieces.append(np.array(numbers, np.float64).reshape(len(numbers), len(names) - 1))
    columns: dict[str, npt.NDArray[Any]] = dict(zip(names[:-1], np.concatenate(pieces).T, strict=True))
    columns[PROGRAM] = np.array(programs, object)
    return columns


def _read_npz(path: Path) -> dict[str, npt.NDArray[Any]]:
    with np.load(path, allow_pickle=False) as archive:
        columns: dict[str, npt.NDArray[Any]] = {name: np.asarray(archive[name]) for name in archive.files}
    if PROGRAM in columns:
        columns[PROGRAM] = columns.pop(PROGRAMS).astype(object)[columns[PROGRAM]]
    return columns


def _read_parquet(path: Path) -> dict[str, npt.NDArray[Any]]:
    table = pyarrow_for("a Parquet trace").parquet.read_table(path)
    return {
        name: table[name].cast("string").to_numpy() if name == PROGRAM else table[name].to_numpy()
        for name in table.column_names
    }
