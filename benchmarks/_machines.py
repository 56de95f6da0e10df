"""The machine of the benchmarks that need a full one: eight axes, simulated servos, encoders, limit switches."""

from __future__ import annotations

import numpy as np

from polycnc.kernel import append_line, give_to_path, prepare_path, start_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate

_AXIS = """
[[axis]]
name = "{name}"
vmax_mm_s = 500
amax_mm_s2 = 5000
resolution_mm = 0.0001
backlash_mm = 0.002
limit_switches_mm = [-2000, 2000]
reference_switch_mm = -1990
[axis.servo]
kind = "pidf"
kp = 60
ki = 10
kfcv = 1
kfca = 0.003
lag_s = 0.003
following_error_limit_mm = 50
"""
AXES = "XYZABCUV"
SEGMENTS = 40_000


def full_machine(record_cycles: int = 1 << 14) -> Machine:
    """Return an eight-axis machine on a long path of short lines in all axes, prepared and started."""
    text = 'name = "eight"\n' + "".join(_AXIS.format(name=name) for name in AXES)
    config = validate(MachineConfig, *parse_toml(text, "eight.toml"))
    machine = Machine(config, servo=True, record_cycles=record_cycles)
    state = machine.state
    give_to_path(state, 0)
    start_path(state.paths, 0)
    # Every axis swings to and fro by 200 mm at a rate of its own, in steps of about 0.5 mm along the path.
    phase = 0.0009 * np.arange(1, SEGMENTS + 1)[:, None] * (1.0 + 0.13 * np.arange(len(AXES)))
    for i, point in enumerate(200.0 * np.sin(phase)):
        append_line(state.seg, state.paths, 0, state.limits, point, 40.0, 0, i)
    state.paths.row["closed"] = 1
    prepare_path(state.seg, state.paths, 0, state.limits, config.cycle_s, state.work)
    return machine
