"""Traces as tables of other libraries: NumPy, Arrow, pandas, with the columns of a trace file."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError
from polycnc.runner._power import POWER
from polycnc.runner._trace_formats import COLUMN_NAMES, PROGRAM

if TYPE_CHECKING:
    from polycnc.runner._outcome import Trace

RAPID = "rapid"


def _numbers(trace: Trace) -> dict[str, npt.NDArray[Any]]:
    found = dict(zip(COLUMN_NAMES, (trace.t_s, trace.block, trace.feed_mm_s), strict=True))
    parts = [("", trace.setpoint)] + ([] if trace.actual is None else [("_actual", trace.actual)])
    for word, positions in parts:
        names = (f"{axis}{word}_{unit}" for axis, unit in zip(trace.axes, trace.units, strict=True))
        found |= dict(zip(names, positions.T, strict=True))
    return found if trace.power is None else found | {POWER: trace.power}


def columns_of(trace: Trace) -> dict[str, npt.NDArray[Any]]:
    """Return the columns of a trace file by name, and `rapid` before `program`."""
    found = _numbers(trace) | {RAPID: trace.rapid}
    return found if trace.program is None else found | {PROGRAM: trace.program}


def array_of(trace: Trace, dtype: npt.DTypeLike | None, copy: bool | None) -> npt.NDArray[Any]:
    """Return the columns that are numbers, side by side.

    Raises:
        ValueError: A copy is not allowed; there are no such columns side by side in memory.
    """
    if copy is False:
        raise ValueError("a trace becomes an array by copying it: its columns lie apart")
    return np.column_stack(list(_numbers(trace).values())).astype(dtype or np.float64, copy=False)


def arrow_of(trace: Trace) -> Any:
    """Return the columns as a table of pyarrow."""
    return _library("pyarrow", "polycnc[parquet]").table(columns_of(trace))


def pandas_of(trace: Trace) -> Any:
    """Return the columns as a data frame of pandas."""
    return _library("pandas", "pandas").DataFrame(columns_of(trace))


def _library(name: str, package: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise UsageError(
            f"a trace as a table of {name} needs {name}", hint=f"Install it: pip install '{package}'."
        ) from None
