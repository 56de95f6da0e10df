"""Why the machine stops a program: an axis that lags too far behind, or is on a limit switch."""

from __future__ import annotations

from polycnc.kernel import FOLLOWING_ERROR, LIMIT_HIGH, LIMIT_LOW, SWITCH_EDGE
from polycnc.machine import Machine

_LIMIT_SWITCHES = (LIMIT_LOW, LIMIT_HIGH)


def axis_alarm(machine: Machine, raised: int, path: int) -> tuple[str, str] | None:
    """Return text and code of the first alarm of a path's axes by the reasons `raised` in a cycle, None for none."""
    if not raised & (FOLLOWING_ERROR | SWITCH_EDGE):
        return None
    state = machine.state
    for index, axis in enumerate(machine.config.axes):
        if index not in state.paths.axis[path]:
            continue
        if raised & FOLLOWING_ERROR and state.servo.error_tripped[index]:
            error = float(state.servo.row[index]["following_error"])
            text = f"axis {axis.name}: following error {error:.4f} {axis.unit} is above its limit"
            return text, "following_error"
        if raised & SWITCH_EDGE and any(state.switches.switch[index, j]["level"] for j in _LIMIT_SWITCHES):
            at = float(state.servo.actual[index])
            return f"axis {axis.name} is on a limit switch at {at:.3f} {axis.unit}", "limit_switch"
    return None
