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

ROUNDING = 4e-15  # by which a speed that can just be braked to may seem too low, on squares


@compiled
def plan_ramps(
    ramps: Floats, speed_in: float, length: float, cap: float, accel: float, speed_out: float, s: float
) -> None:
    """Fill `ramps[REGISTERS]` for `length` more of a segment that has been gone along up to `s`.

    The end speed is lowered to what can be reached, or raised to what cannot be braked away.
    """
    square = speed_in * speed_in
    gain = 2.0 * accel * length
    ramps[SPEED_IN] = speed_in
    ramps[TIME_IN] = 0.0
    ramps[TIME_CRUISE] = 0.0
    ramps[TIME_OUT] = 0.0
    ramps[FROM_S] = s
    ramps[LENGTH] = length
    if speed_out * speed_out >= square + gain:  # faster all the way
        top = math.sqrt(square + gain)
        ramps[SPEED_PEAK] = top
        ramps[SPEED_OUT] = top
        if top > 0.0:
            ramps[TIME_IN] = 2.0 * length / (speed_in + top)
        return
    least = square - gain
    if speed_out * speed_out <= least:  # slower all the way
        if speed_out * speed_out < least - ROUNDING * (square + 2.0 * accel * (s + length)):
            speed_out = math.sqrt(least)
        ramps[SPEED_PEAK] = speed_in
        ramps[SPEED_OUT] = speed_out
        ramps[TIME_OUT] = 2.0 * length / (speed_in + speed_out)
        return
    peak = min(max(cap, speed_out), math.sqrt(0.5 * (gain + square + speed_out * speed_out)))
    distance_in = abs(peak - speed_in) * (peak + speed_in) / (2.0 * accel)
    distance_out = (peak - speed_out) * (peak + speed_out) / (2.0 * accel)
    cruise = length - distance_in - distance_out
    ramps[SPEED_PEAK] = peak
    ramps[SPEED_OUT] = speed_out
    ramps[TIME_IN] = abs(peak - speed_in) / accel
    ramps[TIME_OUT] = (peak - speed_out) / accel
    if cruise > 0.0:
        ramps[TIME_CRUISE] = cruise / peak


@compiled
def plan_halt(ramps: Floats, speed_in: float, length: float, accel: float, s: float) -> None:
    """Fill `ramps` to brake at once, to rest if there is room; the arguments are those of `plan_ramps`."""
    needed = speed_in * speed_in / (2.0 * accel)
    plan_ramps(ramps, speed_in, min(needed, length), speed_in, accel, 0.0, s)


@compiled
def plan_pause(ramps: Floats, duration: float) -> None:
    """Fill `ramps` to stand still for `duration`."""
    plan_ramps(ramps, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    ramps[TIME_CRUISE] = duration


@compiled
def ramps_duration(ramps: Floats) -> float:
    """Return the time of the planned stretch in s."""
    return float(ramps[TIME_IN] + ramps[TIME_CRUISE] + ramps[TIME_OUT])


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
        back = to_speed * left - jerk * left * left * left / 6.0
        return 0.5 * (from_speed + to_speed) * duration - back, to_speed - 0.5 * jerk * left * left
    u = t - edge
    speed = from_speed + 0.5 * jerk * edge * edge
    distance = from_speed * edge + jerk * edge * edge * edge / 6.0
    return distance + speed * u + 0.5 * peak * u * u, speed + peak * u


@compiled
def ramps_at(ramps: Floats, t: float, jerkrel: float) -> tuple[float, float]:
    """Return path length within the segment and speed at time `t` of the planned stretch."""
    begin, peak, out = ramps[FROM_S], ramps[SPEED_PEAK], ramps[SPEED_OUT]
    if t < ramps[TIME_IN]:
        gone, speed = shaped_ramp(t, ramps[TIME_IN], ramps[SPEED_IN], peak, jerkrel)
        return begin + gone, speed
    # Everything else is measured from the end, so that the segment's end is met exactly.
    left = ramps_duration(ramps) - t
    end = begin + ramps[LENGTH]
    if left <= 0.0:
        return end, float(out)
    if left < ramps[TIME_OUT]:
        to_go, speed = shaped_ramp(left, ramps[TIME_OUT], out, peak, jerkrel)
        return end - to_go, speed
    to_go = 0.5 * (peak + out) * ramps[TIME_OUT]
    return end - to_go - peak * (left - ramps[TIME_OUT]), float(peak)
