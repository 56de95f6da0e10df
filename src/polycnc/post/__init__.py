"""The post-processor: a control file turns a tool path into a program for a control."""

from polycnc.post.macros._control_file import CONTROLS, ControlFile, load_control, parse_control, shipped_text
from polycnc.post.macros._control_parameters import SECTIONS, ControlTables, Parameters
from polycnc.post.macros._parameters import NO_DIALECT, FiveAxis, RotaryAxis
from polycnc.post.macros._reference import control_file_reference
from polycnc.post.macros._run import MacroRun
from polycnc.post.output._program import BlockMap, PostSummary, post_program
from polycnc.post.output._writing import program_file
from polycnc.post.tool_path._cl_reading import ArcAxis
from polycnc.post.tool_path._source import Remark
from polycnc.post.tool_path._sweep import Sweep, Ways, sweep_in_runs, sweep_tool_path
from polycnc.post.tool_path._tangency import Tangency
from polycnc.post.tool_path._tool_path import ToolPath, open_tool_path, parse_tool_path

__all__ = [
    "CONTROLS",
    "NO_DIALECT",
    "SECTIONS",
    "ArcAxis",
    "BlockMap",
    "ControlFile",
    "ControlTables",
    "FiveAxis",
    "MacroRun",
    "Parameters",
    "PostSummary",
    "Remark",
    "RotaryAxis",
    "Sweep",
    "Tangency",
    "ToolPath",
    "Ways",
    "control_file_reference",
    "load_control",
    "open_tool_path",
    "parse_control",
    "parse_tool_path",
    "post_program",
    "program_file",
    "shipped_text",
    "sweep_in_runs",
    "sweep_tool_path",
]
