"""A virtual CNC and motion controller.

Run part programs on a simulated machine, cycle by cycle, as a library or with the ``polycnc`` command::

    import polycnc

    result = polycnc.run("part.nc", machine="mill3", trace=True)
    print(result.time_s, result.extents_mm, result.trace.setpoint[-1])

The names below are loaded when they are first used, so that importing the package stays quick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from polycnc.on_demand import names_on_demand

__version__ = "0.1.0.dev0"

if TYPE_CHECKING:
    from polycnc.errors import AlarmError, ConfigurationError, PolycncError, ProgramError, UsageError
    from polycnc.machine import Machine, MachineConfig, load_machine
    from polycnc.runner import (
        Alarm,
        BatchResult,
        Comparison,
        RunResult,
        Trace,
        Violation,
        batch,
        check,
        compare,
        plot,
        read_trace,
        run,
        verify_trace,
    )

__all__ = [
    "Alarm",
    "AlarmError",
    "BatchResult",
    "Comparison",
    "ConfigurationError",
    "Machine",
    "MachineConfig",
    "PolycncError",
    "ProgramError",
    "RunResult",
    "Trace",
    "UsageError",
    "Violation",
    "batch",
    "check",
    "compare",
    "load_machine",
    "plot",
    "read_trace",
    "run",
    "verify_trace",
]


__getattr__ = names_on_demand(__name__)
