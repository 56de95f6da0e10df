"""The speed profile over one segment: ramp, cruise, ramp, in closed form.

A ramp keeps its mean acceleration, duration and distance whatever its shape; `jerkrel` is the part of it that is
spent on building the acceleration up and down (0 rectangular, 1 triangular). Source: Manual 002, 2.2.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

Floats = npt.NDArray[np.float64]

# The registers of a running segment.
SPEED_IN, SPEED_PEAK, SPEED_OUT, TIME_IN, TIME_CRUISE, TIME_OUT, FROM_S, LENGTH = 0, 1, 2, 3, 4, 5, 6, 7
REGISTERS = 8

ROUNDING = 1e-12  # a rest that is missed by less than this is a rest


@compiled
def plan_ramps(
    ramps: Floats, speed_in: float, length: float, cap: float, accel: float, speed_out: float, s: float
) -> None:
    """Fill `ramps[REGISTERS]` for `length` more of a segment that has been gone along up to `s`.

    The end speed is lowered to what can be reached, or raised to what cannot be braked away.
    """
    gain = 2.0 * accel * length
    least = speed_in * speed_in - gain
    out = min(speed_out, math.sqrt(speed_in * speed_in + gain))
    if out * out < least - ROUNDING * speed_in * speed_in:
        out = math.sqrt(least)
    highest = math.sqrt(0.5 * (gain + speed_in * speed_in + out * out))
    peak = min(max(cap, out), max(highest, speed_in, out))
    distance_in = abs(peak * peak - speed_in * speed_in) / (2.0 * accel)
    distance_out = abs(peak * peak - out * out) / (2.0 * accel)
    if speed_in > peak and distance_in + distance_out > length:
        peak = speed_in  # too fast on arrival and no room: brake all the way
        distance_in = 0.0
        distance_out = length
    cruise = length - distance_in - distance_out
    ramps[SPEED_IN] = speed_in
    ramps[SPEED_PEAK] = peak
    ramps[SPEED_OUT] = out
    ramps[TIME_IN] = abs(peak - speed_in) / accel
    ramps[TIME_CRUISE] = cruise / peak if cruise > 0.0 and peak > 0.0 else 0.0
    ramps[TIME_OUT] = abs(peak - out) / accel
    ramps[FROM_S] = s
    ramps[LENGTH] = length


@compiled
def plan_halt(ramps: Floats, speed_in: float, length: float, accel: float, s: float) -> bool:
    """Fill `ramps` to brake at once; True if the path comes to rest within `length`."""
    needed = speed_in * speed_in / (2.0 * accel)
    if needed >= length:
        plan_ramps(ramps, speed_in, length, speed_in, accel, 0.0, s)
        return False
    plan_ramps(ramps, speed_in, needed, speed_in, accel, 0.0, s)
    return True


@compiled
def ramps_duration(ramps: Floats) -> float:
    """Return the time of the planned stretch in s."""
    return float(ramps[TIME_IN] + ramps[TIME_CRUISE] + ramps[TIME_OUT])


@compiled
def in_ramp(ramps: Floats, t: float) -> bool:
    """Tell whether the speed changes at time `t` of the planned stretch."""
    return bool(t < ramps[TIME_IN] or t > ramps[TIME_IN] + ramps[TIME_CRUISE])


@compiled
def shaped_ramp(
    t: float, duration: float, from_speed: float, to_speed: float, jerkrel: float
) -> tuple[float, float]:
    """Return distance and speed at time `t` into a ramp of `duration`."""
    change = to_speed - from_speed
    if jerkrel <= 0.0:
        rise = change * (t / duration)
        return (from_speed + 0.5 * rise) * t, from_speed + rise
    edge = duration * jerkrel / (1.0 + jerkrel)
    peak = change / (duration - edge)
    jerk = peak / edge
    if t <= edge:
        return from_speed * t + jerk * t * t * t / 6.0, from_speed + 0.5 * jerk * t * t
    left = duration - t
    if left < edge:  # mirror image from the end
        distance = 0.5 * (from_speed + to_speed) * duration - (
            to_speed * left - jerk * left * left * left / 6.0
        )
        return distance, to_speed - 0.5 * jerk * left * left
    u = t - edge
    speed = from_speed + 0.5 * jerk * edge * edge
    distance = from_speed * edge + jerk * edge * edge * edge / 6.0
    return distance + speed * u + 0.5 * peak * u * u, speed + peak * u


@compiled
def ramps_at(ramps: Floats, t: float, jerkrel: float) -> tuple[float, float]:
    """Return path length within the segment and speed at time `t` of the planned stretch."""
    start = ramps[FROM_S]
    if t < ramps[TIME_IN]:
        distance, speed = shaped_ramp(t, ramps[TIME_IN], ramps[SPEED_IN], ramps[SPEED_PEAK], jerkrel)
        return start + distance, speed
    t -= ramps[TIME_IN]
    gone = 0.5 * (ramps[SPEED_IN] + ramps[SPEED_PEAK]) * ramps[TIME_IN]
    if t < ramps[TIME_CRUISE]:
        return start + gone + ramps[SPEED_PEAK] * t, ramps[SPEED_PEAK]
    t -= ramps[TIME_CRUISE]
    if t >= ramps[TIME_OUT]:
        return start + ramps[LENGTH], ramps[SPEED_OUT]
    # Measured from the end, so that the segment's end is met exactly.
    left, _ = shaped_ramp(ramps[TIME_OUT] - t, ramps[TIME_OUT], ramps[SPEED_OUT], ramps[SPEED_PEAK], jerkrel)
    _, speed = shaped_ramp(t, ramps[TIME_OUT], ramps[SPEED_PEAK], ramps[SPEED_OUT], jerkrel)
    return start + ramps[LENGTH] - left, speed
