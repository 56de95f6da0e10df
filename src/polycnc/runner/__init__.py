"""Run part programs: from a program and a machine to a typed result, a trace, a plot; post tool paths and prove them.

What a name needs is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from polycnc.on_demand import names_on_demand

if TYPE_CHECKING:
    from polycnc.runner._check import CheckReport, check, errors_in, inspect
    from polycnc.runner._debugger import Debugger, Place
    from polycnc.runner._execution import LOOP_LIMIT_S
    from polycnc.runner._machined import Machined
    from polycnc.runner._machining import MachiningCollector
    from polycnc.runner._operations import Operation
    from polycnc.runner._outcome import Alarm, RunMessage, Trace, counted, time_text
    from polycnc.runner._post import PostResult, post_file
    from polycnc.runner._program_control import SCREEN_FORMATS, read_keys
    from polycnc.runner._remarks import Remark
    from polycnc.runner._result import RunResult, TracedResult
    from polycnc.runner._run import run, run_program
    from polycnc.runner._run_events import RunEvent, RunEvents
    from polycnc.runner._schemas import SCHEMAS, json_schema
    from polycnc.runner._settings import RunSettings, machine_for, program_text
    from polycnc.runner._stock_tools import tools_of
    from polycnc.runner._survey import LineTime, Survey, holds_before, survey
    from polycnc.runner._trace import TraceWriter, read_trace, trace_columns
    from polycnc.runner._trace_formats import TRACE_FORMATS
    from polycnc.runner._verify import Violation, verify_trace
    from polycnc.runner._verify_post import Deviation, PostVerification, verify_post
    from polycnc.runner._wall import WallClock
    from polycnc.runner.batches import BatchResult, batch
    from polycnc.runner.comparison import Comparison, PathDeviation, compare
    from polycnc.runner.machine_sources import machine_from
    from polycnc.runner.plots import PLOT_FORMATS, check_plot_file, plot, plot_track
    from polycnc.runner.view import TrackCollector, View, check_view_file, open_in_browser, view_program

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
    "LineTime",
    "Machined",
    "MachiningCollector",
    "Operation",
    "PathDeviation",
    "Place",
    "PostResult",
    "PostVerification",
    "Remark",
    "RunEvent",
    "RunEvents",
    "RunMessage",
    "RunResult",
    "RunSettings",
    "Survey",
    "Trace",
    "TraceWriter",
    "TracedResult",
    "TrackCollector",
    "View",
    "Violation",
    "WallClock",
    "batch",
    "check",
    "check_plot_file",
    "check_view_file",
    "compare",
    "counted",
    "errors_in",
    "holds_before",
    "inspect",
    "json_schema",
    "machine_for",
    "machine_from",
    "open_in_browser",
    "plot",
    "plot_track",
    "post_file",
    "program_text",
    "read_keys",
    "read_trace",
    "run",
    "run_program",
    "survey",
    "time_text",
    "tools_of",
    "trace_columns",
    "verify_post",
    "verify_trace",
    "view_program",
]

__getattr__ = names_on_demand(__name__)
