"""How long what is planned on a path takes, in closed form from its speeds."""

from __future__ import annotations

import math

from polycnc.kernel._braking import GONE
from polycnc.kernel._jit import entry
from polycnc.kernel._path import HELD, RUNNING, Paths, slot
from polycnc.kernel._ramps import ramps_duration
from polycnc.kernel._segments import WAIT, WAIT_S, Segments

_LEAST = 1e-9  # a speed of 0 is that of a segment without length, or of one that an override holds


def _steps(seg: Segments, paths: Paths, g: int, *_: object) -> int:
    return int(paths.row["prepared"][g] - paths.row["head"][g]) + 1


@entry(steps=_steps)
def planned_s(seg: Segments, paths: Paths, g: int, dt: float) -> float:
    """Return how long path `g` takes to the end of what is planned (s), without a hold.

    Ramps have their mean acceleration: with limited jerk, and beside corners, a motion takes a little longer.
    """
    path, ramps = paths.row[g], paths.ramps[g]
    under_way = path["state"] == RUNNING or path["state"] == HELD
    total, speed = 0.0, 0.0
    for count in range(path["head"], path["prepared"]):
        k = slot(paths, g, count)
        row = seg.row[k]
        first = under_way and count == path["head"]
        if row["kind"] == WAIT or (first and path["jerk_mm_s3"] <= 0.0):
            if first:
                total += max(0.0, ramps_duration(ramps) - path["lead"] - path["cycles"] * dt)
            else:
                total += seg.geo[k, WAIT_S]
            speed = row["out"]
            continue
        length = row["length"]
        if first:
            length, speed = length - ramps[GONE], path["speed"]
        out, accel = row["out"], max(row["accel"], _LEAST)
        square = min(row["cap"] * row["cap"], 0.5 * (speed * speed + out * out) + accel * length)
        top = math.sqrt(max(square, _LEAST))
        in_ramps = max(2.0 * top * top - speed * speed - out * out, 0.0) / (2.0 * accel)
        total += max(2.0 * top - speed - out, 0.0) / accel + max(length - in_ramps, 0.0) / top
        speed = out
    return total
