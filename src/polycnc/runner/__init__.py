"""Run part programs: from a program and a machine to a typed result, a trace, a plot."""

from polycnc.runner._plot import PLOT_FORMATS, PlotCollector, check_plot_file, plot
from polycnc.runner._result import Alarm, RunEvent, RunMessage, RunResult, Trace, counted, time_text
from polycnc.runner._run import check, program_text, run
from polycnc.runner._trace import TRACE_FORMATS, TraceWriter, read_trace, trace_columns
from polycnc.runner._verify import Violation, verify_trace

__all__ = [
    "PLOT_FORMATS",
    "TRACE_FORMATS",
    "Alarm",
    "PlotCollector",
    "RunEvent",
    "RunMessage",
    "RunResult",
    "Trace",
    "TraceWriter",
    "Violation",
    "check",
    "check_plot_file",
    "counted",
    "plot",
    "program_text",
    "read_trace",
    "run",
    "time_text",
    "trace_columns",
    "verify_trace",
]
