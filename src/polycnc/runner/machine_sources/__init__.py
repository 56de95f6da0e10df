"""Make a machine file from the configuration of a control that people have.

Each control has a module that reads its configuration into `Facts`. What a machine file has no place for is listed
at its top.
"""

from polycnc.runner.machine_sources._facts import AxisFacts, Facts, LeftOut
from polycnc.runner.machine_sources._make import CONTROLS, machine_from
from polycnc.runner.machine_sources._tool_files import tools_file, with_tools
from polycnc.runner.machine_sources._write import machine_text

__all__ = [
    "CONTROLS",
    "AxisFacts",
    "Facts",
    "LeftOut",
    "machine_from",
    "machine_text",
    "tools_file",
    "with_tools",
]
