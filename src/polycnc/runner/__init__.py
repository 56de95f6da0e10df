"""Run part programs: from a program and a machine to a typed result, a trace, a plot."""

from polycnc.runner._plot import PlotCollector, plot
from polycnc.runner._result import Alarm, RunEvent, RunMessage, RunResult, Trace
from polycnc.runner._run import check, program_text, run
from polycnc.runner._trace import TraceWriter, trace_columns
from polycnc.runner._verify import Violation, verify_trace

__all__ = [
    "Alarm",
    "PlotCollector",
    "RunEvent",
    "RunMessage",
    "RunResult",
    "Trace",
    "TraceWriter",
    "Violation",
    "check",
    "plot",
    "program_text",
    "run",
    "trace_columns",
    "verify_trace",
]
