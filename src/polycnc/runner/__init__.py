"""Run part programs: from a program and a machine to a typed result, a trace, a plot; post tool paths and prove them.

What posting and debugging need is loaded when it is first used.
"""

from typing import TYPE_CHECKING, Any

from polycnc.runner._execution import LOOP_LIMIT_S
from polycnc.runner._operations import Operation
from polycnc.runner._plot import PLOT_FORMATS, PlotCollector, check_plot_file, plot
from polycnc.runner._program_control import SCREEN_FORMATS, read_keys
from polycnc.runner._remarks import Remark
from polycnc.runner._result import (
    Alarm,
    RunEvent,
    RunMessage,
    RunResult,
    Trace,
    TracedResult,
    counted,
    time_text,
)
from polycnc.runner._run import CheckReport, check, inspect, program_text, run
from polycnc.runner._trace import TraceWriter, read_trace, trace_columns
from polycnc.runner._trace_formats import TRACE_FORMATS
from polycnc.runner._verify import Violation, verify_trace
from polycnc.runner._wall import WallClock

if TYPE_CHECKING:
    from polycnc.runner._debugger import Debugger, Place
    from polycnc.runner._post import PostResult, post_file
    from polycnc.runner._schemas import SCHEMAS, json_schema
    from polycnc.runner._verify_post import Deviation, PostVerification, verify_post
    from polycnc.runner.batches import BatchResult, batch
    from polycnc.runner.comparison import Comparison, PathDeviation, compare
    from polycnc.runner.machine_sources import machine_from
    from polycnc.runner.view import View, check_view_file, open_in_browser, view_program

_LATER = {
    "SCHEMAS": "_schemas",
    "BatchResult": "batches",
    "Comparison": "comparison",
    "Debugger": "_debugger",
    "Deviation": "_verify_post",
    "PathDeviation": "comparison",
    "Place": "_debugger",
    "PostResult": "_post",
    "PostVerification": "_verify_post",
    "View": "view",
    "batch": "batches",
    "check_view_file": "view",
    "compare": "comparison",
    "json_schema": "_schemas",
    "machine_from": "machine_sources",
    "open_in_browser": "view",
    "post_file": "_post",
    "verify_post": "_verify_post",
    "view_program": "view",
}

__all__ = [
    "LOOP_LIMIT_S",
    "PLOT_FORMATS",
    "SCHEMAS",
    "SCREEN_FORMATS",
    "TRACE_FORMATS",
    "Alarm",
    "BatchResult",
    "CheckReport",
    "Comparison",
    "Debugger",
    "Deviation",
    "Operation",
    "PathDeviation",
    "Place",
    "PlotCollector",
    "PostResult",
    "PostVerification",
    "Remark",
    "RunEvent",
    "RunMessage",
    "RunResult",
    "Trace",
    "TraceWriter",
    "TracedResult",
    "View",
    "Violation",
    "WallClock",
    "batch",
    "check",
    "check_plot_file",
    "check_view_file",
    "compare",
    "counted",
    "inspect",
    "json_schema",
    "machine_from",
    "open_in_browser",
    "plot",
    "post_file",
    "program_text",
    "read_keys",
    "read_trace",
    "run",
    "time_text",
    "trace_columns",
    "verify_post",
    "verify_trace",
    "view_program",
]


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name in _LATER:
        return getattr(import_module(f"polycnc.runner.{_LATER[name]}"), name)
    raise AttributeError(f"module 'polycnc.runner' has no attribute '{name}'")
