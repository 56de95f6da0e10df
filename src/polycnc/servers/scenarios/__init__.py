"""Scenarios: what happens to a served machine and its doors, step by step, the same every time."""

from polycnc.servers.scenarios._actions import ACTIONS, DOORS, Action
from polycnc.servers.scenarios._script import Script, Step, When, load_script, read_script
from polycnc.servers.scenarios._story import Happened, StepState, Story

__all__ = [
    "ACTIONS",
    "DOORS",
    "Action",
    "Happened",
    "Script",
    "Step",
    "StepState",
    "Story",
    "When",
    "load_script",
    "read_script",
]
