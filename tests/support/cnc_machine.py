"""A small machine with ends of travel, a reference switch and index pulses, for tests of a control."""

from __future__ import annotations

from typing import Any

from polycnc.machine import MachineConfig

X = {
    "name": "X",
    "vmax_mm_s": 120.0,
    "amax_mm_s2": 700.0,
    "soft_limits_mm": (-50.0, 80.0),
    "limit_switches_mm": (-60.0, 95.0),
    "reference_switch_mm": -41.0,
    "index_pulse_mm": -37.5,
    "home_mm": 12.5,
}
Y = {
    "name": "Y",
    "vmax_mm_s": 90.0,
    "amax_mm_s2": 500.0,
    "soft_limits_mm": (-30.0, 30.0),
    "reference_switch_mm": 21.0,
    "index_pulse_mm": 17.25,
    "home_mm": 0.0,
}
Z = {"name": "Z", "vmax_mm_s": 60.0, "amax_mm_s2": 400.0, "soft_limits_mm": (-70.0, 5.0), "home_mm": 3.0}
B = {"name": "B", "kind": "rotary", "vmax_deg_s": 90.0, "amax_deg_s2": 360.0, "modulo": True}


def cnc_machine(**keys: Any) -> MachineConfig:
    """Return a machine with the axes X (switches all around), Y (index below the switch), Z (none) and B (endless)."""
    data: dict[str, Any] = {"name": "cnc", "axis": (X, Y, Z, B)}
    data["spindle"] = {"max_rpm": 6000.0, "acceleration_rpm_s": 3000.0}
    data["times"] = {"tool_change_s": 1.5, "auxiliary_s": 0.3}
    data.update(keys)
    return MachineConfig.model_validate(data)
