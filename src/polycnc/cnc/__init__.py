"""A numerical control without a vendor: program runs that can be held, stepped and watched."""

from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._run_state import RunAlarm, RunOptions, RunState

__all__ = [
    "ProgramRun",
    "RunAlarm",
    "RunOptions",
    "RunState",
]
