"""Scenarios: what happens to a served machine and its doors, step by step, the same every time."""

from polycnc.servers.scenarios._actions import ACTIONS
from polycnc.servers.scenarios._script import Script, load_script, read_script
from polycnc.servers.scenarios._story import Happened, Story

__all__ = ["ACTIONS", "Happened", "Script", "Story", "load_script", "read_script"]
