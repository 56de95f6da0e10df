"""The computer's clock, for whoever passes one to a machine (`Elapsed`, `RealTime`, `Host`)."""

from __future__ import annotations

import time


class WallClock:
    """Tell the time since some moment, and wait, by the computer's clock; it satisfies `polycnc.machine.Pacer`."""

    def now_s(self) -> float:
        """Return a time that never runs back (s)."""
        return time.monotonic()

    def sleep_s(self, duration_s: float) -> None:
        """Wait for about `duration_s`."""
        time.sleep(duration_s)
