"""What one machine is asked costs what one machine has, however many others the agent has."""

from __future__ import annotations

import sys
from types import FrameType
from typing import Any

from polycnc.cnc import Control
from polycnc.servers.mtconnect import VERSIONS, Agent, model_of
from polycnc.servers.plant import see


def _steps(control: Control, count: int) -> int:
    """Return how many steps of Python an agent of so many machines needs for the `current` of one."""
    version = VERSIONS["2.7"]
    agent = Agent([model_of(f"m{k}", control, version) for k in range(count)], version, 3)
    look = see(lambda: control)
    for number in range(count):
        agent.observe(number, look())
    agent.get("/m1/current")
    steps = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal steps
        frame.f_trace_opcodes = True
        steps += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        agent.get("/m1/current")
    finally:
        sys.settrace(before)
    return steps


def test_the_current_of_one_machine_does_not_grow_with_the_others() -> None:
    control = Control("mill3")
    assert _steps(control, 24) < 1.1 * _steps(control, 2)
