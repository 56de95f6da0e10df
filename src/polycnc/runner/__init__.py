"""Run part programs: from a program and a machine to a typed result, a trace, a plot; post tool paths and prove them.

What posting and debugging need is loaded when it is first used.
"""

from typing import TYPE_CHECKING, Any

from polycnc.runner._plot import PLOT_FORMATS, PlotCollector, check_plot_file, plot
from polycnc.runner._result import Alarm, RunEvent, RunMessage, RunResult, Trace, counted, time_text
from polycnc.runner._run import check, program_text, run
from polycnc.runner._trace import TRACE_FORMATS, TraceWriter, read_trace, trace_columns
from polycnc.runner._verify import Violation, verify_trace
from polycnc.runner._wall import WallClock

if TYPE_CHECKING:
    from polycnc.runner._debugger import Debugger, Place
    from polycnc.runner._post import PostResult, post_file
    from polycnc.runner._verify_post import Deviation, PostVerification, verify_post

_LATER = {
    "Debugger": "_debugger",
    "Deviation": "_verify_post",
    "Place": "_debugger",
    "PostResult": "_post",
    "PostVerification": "_verify_post",
    "post_file": "_post",
    "verify_post": "_verify_post",
}

__all__ = [
    "PLOT_FORMATS",
    "TRACE_FORMATS",
    "Alarm",
    "Debugger",
    "Deviation",
    "Place",
    "PlotCollector",
    "PostResult",
    "PostVerification",
    "RunEvent",
    "RunMessage",
    "RunResult",
    "Trace",
    "TraceWriter",
    "Violation",
    "WallClock",
    "check",
    "check_plot_file",
    "counted",
    "plot",
    "post_file",
    "program_text",
    "read_trace",
    "run",
    "time_text",
    "trace_columns",
    "verify_post",
    "verify_trace",
]


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name in _LATER:
        return getattr(import_module(f"polycnc.runner.{_LATER[name]}"), name)
    raise AttributeError(f"module 'polycnc.runner' has no attribute '{name}'")
