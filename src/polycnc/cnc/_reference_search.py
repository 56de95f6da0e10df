"""The search of a reference point: one step after the other, then straight to the reference position."""

from __future__ import annotations

import math
from dataclasses import replace

from polycnc.cnc._alarms import AlarmList
from polycnc.cnc._manual_data import AxisMotion
from polycnc.cnc._manual_profiles import DOWN, ManualProfiles
from polycnc.cnc._reference_steps import Until
from polycnc.kernel import REFERENCE
from polycnc.machine import Machine


class ReferenceSearch:
    """Take axes through the steps of their search; one that finds nothing on its whole travel gets an alarm."""

    def __init__(self, machine: Machine, profiles: ManualProfiles, alarms: AlarmList) -> None:
        self._machine = machine
        self._profiles = profiles
        self._alarms = alarms

    def begin_step(self, i: int, step: int) -> None:
        """Let an axis begin a step of its search."""
        motion, axis = self._profiles.motions[i], self._profiles.axes[i]
        what = motion.steps[step]
        marks = self._machine.state.switches.marks[i]
        marks["index_latched"] = 0
        marks["index_armed"] = 1 if what.until is Until.INDEX else 0
        share = self._profiles.data.reference_share if what.fast else self._profiles.data.creep_share
        self._profiles.begin(
            i,
            replace(
                motion,
                direction=what.direction,
                target=self._search_end(i, what.direction),
                speed=axis.vmax * share,
                step=step,
                braking=False,
            ),
        )

    def _search_end(self, i: int, direction: int) -> float:
        """Return where a search gives up: at the limit switch, or well after everything there is to find."""
        axis = self._profiles.axes[i]
        switch = axis.limit_switches[0 if direction == DOWN else 1]
        if math.isfinite(switch):
            return switch
        low, high = axis.soft_limits
        marks = (low, high, axis.reference_switch, axis.index_pulse, axis.home, self._profiles.position(i))
        known = [mark for mark in marks if mark is not None and math.isfinite(mark)]
        return (
            min(known) if direction == DOWN else max(known)
        ) + direction * self._profiles.data.search_margin

    def look(self, i: int, motion: AxisMotion, at_rest: bool) -> None:
        """Look whether a step is over, and go on with the next one."""
        if motion.braking:
            if not at_rest:
                return
            if motion.step + 1 < len(motion.steps):
                self.begin_step(i, motion.step + 1)
            else:
                self.go_home(i)
        elif self._found(i, motion.steps[motion.step].until):
            self._profiles.motions[i] = replace(motion, braking=True)
            self._profiles.brake(i)
        elif at_rest and self._profiles.speed(i, motion) > 0.0:
            self._profiles.stop(i)
            self._alarms.put(
                "reference_not_found",
                axis=self._profiles.axes[i].name,
                detail=motion.steps[motion.step].until.value,
            )

    def _found(self, i: int, until: Until) -> bool:
        if until is Until.INDEX:
            return bool(self._machine.state.switches.marks[i]["index_latched"])
        return self._profiles.on(i, REFERENCE) == (until is Until.ON)

    def go_home(self, i: int) -> None:
        """Let an axis go to its reference position."""
        axis = self._profiles.axes[i]
        self._profiles.begin(
            i,
            replace(
                self._profiles.motions[i],
                home=True,
                braking=False,
                target=axis.home,
                speed=axis.vmax * self._profiles.data.reference_share,
            ),
        )
