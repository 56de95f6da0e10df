"""Traces: the recorder's rows as arrays, written to a file as they come, and read from one."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.kernel import BLOCK, FEED_MM_S, IS_RAPID, LEADING, TIME_S
from polycnc.machine import MachineConfig
from polycnc.nc import BlockRecords
from polycnc.outputs import check_output, complete_or_absent, format_of
from polycnc.runner._blocks import Execution, ExecutionCollector
from polycnc.runner._outcome import Trace
from polycnc.runner._power import POWER, powers
from polycnc.runner._trace_formats import (
    COLUMN_NAMES,
    PROGRAM,
    PROGRAMS,
    TRACE_FORMATS,
    WRITERS,
    TraceFile,
    read_columns,
)

Floats = npt.NDArray[np.float64]

_AXIS_COLUMN = re.compile(r"([A-Z][0-9]*)(_actual)?_(mm|deg)")


def trace_columns(config: MachineConfig, actual: bool) -> list[str]:
    """Return the names of a trace file's columns."""
    names = [*COLUMN_NAMES, *(f"{axis.name}_{axis.unit}" for axis in config.axes)]
    if actual:
        names += [f"{axis.name}_actual_{axis.unit}" for axis in config.axes]
    if config.spindle.laser:
        names.append(POWER)
    return names


class TraceCollector:
    """Collect the recorder's rows in memory."""

    def __init__(self, config: MachineConfig, actual: bool) -> None:
        self._config = config
        self._actual = actual
        self._pieces: list[Floats] = []
        self._powers: list[Floats] = []
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
        if self._config.spindle.laser:
            self._powers.append(powers(rows, tags, records, self._config))

    def trace(self) -> Trace:
        """Return everything collected."""
        axes = len(self._config.axes)
        width = LEADING + axes * (2 if self._actual else 1)
        rows = np.concatenate(self._pieces) if self._pieces else np.zeros((0, width))
        execution = self._executions.execution() if self._tagged else None
        return Trace(
            axes=self._config.axis_names,
            units=tuple(axis.unit for axis in self._config.axes),
            t_s=rows[:, TIME_S],
            block=rows[:, BLOCK].astype(np.int64),
            feed_mm_s=rows[:, FEED_MM_S],
            rapid=rows[:, IS_RAPID] != 0.0,
            setpoint=rows[:, LEADING : LEADING + axes],
            actual=rows[:, LEADING + axes :] if self._actual else None,
            execution=execution,
            program=None if execution is None else _programs(execution, len(rows)),
            power=np.concatenate(self._powers) if self._powers else None,
        )


def _programs(execution: Execution, rows: int) -> npt.NDArray[np.object_] | None:
    """Return the program of each row, None where there is no more than one."""
    blocks = execution.blocks
    names = _carried(np.array(blocks.names, object)[blocks.program[execution.number]], "")
    known = {name for name in names.tolist() if name}
    if len(known) < 2:
        return None
    names[names == ""] = next(name for name in names.tolist() if name)
    return np.repeat(names, np.diff(execution.start, append=rows))


def _carried(names: npt.NDArray[np.object_], last: str) -> npt.NDArray[np.object_]:
    """Return names with those that are not known, of rests before a block, taken from before."""
    places = np.where(names != "", np.arange(len(names)), -1)
    places = np.maximum.accumulate(places)
    return np.where(places >= 0, names[places], last)


class TraceWriter:
    """Write a trace to a file whose extension names the format: .csv, .npz or .parquet.

    The file appears under its name when it is complete; a run that is broken off leaves none behind. Once a second
    program is executed, a column says which one each row belongs to.

    Raises:
        UsageError: an unknown extension, no such folder, or pyarrow is needed and not installed.
    """

    def __init__(self, path: str | Path, config: MachineConfig, actual: bool) -> None:
        checked = check_output(path, TRACE_FORMATS, "a trace")
        with ExitStack() as stack:
            partial = stack.enter_context(complete_or_absent(checked, rewritten=True))
            columns = trace_columns(config, actual)
            self._file: TraceFile = WRITERS[format_of(checked, TRACE_FORMATS)](partial, columns)
            stack.push(self._close)
            self._stack = stack.pop_all()
        self._config = config
        self._first = ""  # the program of all rows so far, if it is known
        self._last = ""
        self._several = False

    def __enter__(self) -> TraceWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def _close(self, kind: type[BaseException] | None, *_: object) -> None:
        self._file.close(complete=kind is None)

    def add(self, rows: Floats) -> None:
        """Write a piece of the record, which belongs to the same program as what came before.

        Raises:
            UsageError: the machine has a laser, whose power stands with the blocks.
        """
        if self._config.spindle.laser:
            raise UsageError(
                "rows alone do not tell the power of the laser", hint="Give `add_tagged` as `tagged_rows`."
            )
        self._file.add(rows, np.full(len(rows), self._last, object) if self._several else None)

    def add_tagged(self, rows: Floats, tags: npt.NDArray[np.int64], records: BlockRecords) -> None:
        """Write a piece of the record, and which program each row belongs to."""
        starts = np.flatnonzero(np.diff(tags, prepend=~tags[:1]))
        found = np.array([_as_text(records.program(tag)) for tag in tags[starts].tolist()], object)
        names = _carried(found, self._last)
        for name in dict.fromkeys(names.tolist()):
            self._first = self._first or name
            if name not in ("", self._first) and not self._several:
                self._several = True
                self._file.add_programs(self._first)
        names[names == ""] = self._first
        if len(names):
            self._last = names[-1]
        if self._config.spindle.laser:
            rows = np.column_stack((rows, powers(rows, tags, records, self._config)))
        self._file.add(rows, np.repeat(names, np.diff(starts, append=len(tags))) if self._several else None)


def _as_text(program: str | None) -> str:
    """Return the name of a program without what no file can hold: bytes of a file name that are no text."""
    return (program or "").encode("utf-8", "backslashreplace").decode("utf-8")


def read_trace(path: str | Path) -> Trace:
    """Read a trace file; which moves were rapids is not in it, so none is marked.

    Raises:
        UsageError: no such file, an unknown extension, a damaged file, or columns that are not those of a trace.
    """
    path = Path(path)
    if path.suffix.lower() not in TRACE_FORMATS:
        raise UsageError(
            f"{path} is no trace file", hint=f"Its name must end with one of {', '.join(TRACE_FORMATS)}."
        )
    if not path.is_file():
        raise UsageError(f"no such file: {path}", hint="Check the name and the folder.")
    try:
        columns = read_columns(path)
    except UsageError:
        raise
    except Exception as error:  # whatever the readers of three formats raise for what is no such file
        why = (str(error).splitlines() or [""])[0]
        raise UsageError(f"{path} cannot be read as a trace: {why}", hint=_WRITE_ANEW) from error
    axes = [match for name in columns if (match := _AXIS_COLUMN.fullmatch(name))]
    if not axes or tuple(columns)[: len(COLUMN_NAMES)] != COLUMN_NAMES:
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
        program=columns.get(PROGRAM),
        power=columns.get(POWER),
    )


_WRITE_ANEW = "Write it anew: polycnc run --trace."
_LARGEST_BLOCK = 2.0**53


def _trouble(columns: Mapping[str, npt.NDArray[Any]], setpoints: int, actual: int) -> str:
    """Return what is wrong with the columns of a trace; empty if nothing is."""
    rows = len(columns["t_s"]) if columns["t_s"].ndim == 1 else -1
    for name, column in columns.items():
        if name not in (PROGRAM, PROGRAMS) and column.dtype.kind not in "fiu":
            return f"column {name} does not hold numbers"
        if name != PROGRAMS and column.shape != (rows,):
            return f"column {name} has another size than the others"
    if not np.all(np.abs(columns["block"]) <= _LARGEST_BLOCK):
        return "column block holds what is no number of a block"
    return "" if setpoints and actual in (0, setpoints) else "positions of axes are missing"
