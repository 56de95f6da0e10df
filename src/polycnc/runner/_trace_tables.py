"""Traces as tables of other libraries: NumPy, Arrow, pandas, with the columns of a trace file."""

from __future__ import annotations

from importlib import import_module
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.runner._power import POWER
from polycnc.runner._trace_formats import COLUMN_NAMES, PROGRAM

RAPID = "rapid"
Array = npt.NDArray[Any]


class Recorded(Protocol):
    """What of a trace its tables are made of; see `Trace`."""

    @property
    def axes(self) -> tuple[str, ...]: ...
    @property
    def units(self) -> tuple[str, ...]: ...
    @property
    def t_s(self) -> Array: ...
    @property
    def block(self) -> Array: ...
    @property
    def feed_mm_s(self) -> Array: ...
    @property
    def rapid(self) -> Array: ...
    @property
    def setpoint(self) -> Array: ...
    @property
    def actual(self) -> Array | None: ...
    @property
    def program(self) -> Array | None: ...
    @property
    def power(self) -> Array | None: ...


def _numbers(trace: Recorded) -> dict[str, npt.NDArray[Any]]:
    found = dict(zip(COLUMN_NAMES, (trace.t_s, trace.block, trace.feed_mm_s), strict=True))
    parts = [("", trace.setpoint)] + ([] if trace.actual is None else [("_actual", trace.actual)])
    for word, positions in parts:
        names = (f"{axis}{word}_{unit}" for axis, unit in zip(trace.axes, trace.units, strict=True))
        found |= dict(zip(names, positions.T, strict=True))
    return found if trace.power is None else found | {POWER: trace.power}


def columns_of(trace: Recorded) -> dict[str, npt.NDArray[Any]]:
    """Return the columns of a trace file by name, and `rapid` before `program`."""
    found = _numbers(trace) | {RAPID: trace.rapid}
    return found if trace.program is None else found | {PROGRAM: trace.program}


def array_of(trace: Recorded, dtype: npt.DTypeLike | None, copy: bool | None) -> npt.NDArray[Any]:
    """Return the columns that are numbers, side by side.

    Raises:
        ValueError: A copy is not allowed; there are no such columns side by side in memory.
    """
    if copy is False:
        raise ValueError("a trace becomes an array by copying it: its columns lie apart")
    return np.column_stack(list(_numbers(trace).values())).astype(dtype or np.float64, copy=False)


def arrow_of(trace: Recorded) -> Any:
    """Return the columns as a table of pyarrow."""
    return _library("pyarrow", "polycnc[parquet]").table(columns_of(trace))


def pandas_of(trace: Recorded) -> Any:
    """Return the columns as a data frame of pandas."""
    return _library("pandas", "pandas").DataFrame(columns_of(trace))


def _library(name: str, package: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise UsageError(
            f"a trace as a table of {name} needs {name}", hint=f"Install it: pip install '{package}'."
        ) from None
