"""Ramps of the path speed with limited jerk, in closed form: how far they go, how fast they may begin.

A ramp changes the acceleration with the full jerk, up to the full acceleration, and ends without acceleration. Braking
from any state takes three phases: build the deceleration up, keep it, take it back.

Units: lengths in mm (deg where only rotary axes move), speeds per s, accelerations per s2, jerks per s3, times in s.
"""

from __future__ import annotations

import math

from polycnc.kernel._jit import compiled


@compiled
def fastest_start(speed: float, way: float, accel: float, jerk: float) -> float:
    """Return the highest speed, without acceleration, from which `way` is enough to come down to `speed`."""
    if way <= 0.0:
        return speed
    # The ramp takes the mean speed (2 speed + d) / 2 for 2 sqrt(d / jerk): a cubic in sqrt(d).
    linear, constant = 2.0 * speed, way * math.sqrt(jerk)
    if linear * linear * linear <= 1e-18 * constant * constant:
        root: float = constant ** (1.0 / 3.0)
    else:
        third = math.sqrt(linear / 3.0)
        root = 2.0 * third * math.sinh(math.asinh(0.5 * constant / (third * third * third)) / 3.0)
    change = root * root
    if change > accel * accel / jerk:
        # With the full acceleration in between the ramp takes d / accel + accel / jerk.
        half = speed / accel + 0.5 * accel / jerk
        change = accel * (math.sqrt(half * half + 2.0 / accel * (way - speed * accel / jerk)) - half)
    return speed + change


@compiled
def brake_phases(
    speed: float, rate: float, to_speed: float, accel: float, jerk: float
) -> tuple[float, float, float, float]:
    """Return the phases that take a speed with the acceleration `rate` down to `to_speed` without one.

    They are the jerk of the first and the times of all three; the last has the full jerk. If the speed gets no higher
    than `to_speed` anyway there is only the first, which takes `rate` back.
    """
    rest = speed + 0.5 * rate * abs(rate) / jerk
    if rest <= to_speed:
        return -math.copysign(jerk, rate), abs(rate) / jerk, 0.0, 0.0
    if rate < -accel:
        return jerk, -(rate + accel) / jerk, (rest - to_speed) / accel, accel / jerk
    square = 0.5 * rate * rate
    peak = math.sqrt(jerk * (speed - to_speed) + square)
    if peak <= accel:
        return -jerk, (rate + peak) / jerk, 0.0, peak / jerk
    held = (speed - to_speed + (square - accel * accel) / jerk) / accel
    return -jerk, (rate + accel) / jerk, held, accel / jerk


@compiled
def moved(speed: float, rate: float, jerk: float, time_s: float) -> tuple[float, float, float]:
    """Return the way, the speed and the acceleration after `time_s` with constant jerk."""
    way = time_s * (speed + time_s * (0.5 * rate + time_s * (jerk / 6.0)))
    return way, speed + time_s * (rate + time_s * (0.5 * jerk)), rate + time_s * jerk


@compiled
def brake_way(speed: float, rate: float, to_speed: float, accel: float, jerk: float) -> float:
    """Return how far the path goes in the phases of `brake_phases`."""
    first, build, hold, release = brake_phases(speed, rate, to_speed, accel, jerk)
    way, speed, rate = moved(speed, rate, first, build)
    if release > 0.0:
        more, speed, rate = moved(speed, rate, 0.0, hold)
        way += more
        more, speed, rate = moved(speed, rate, jerk, release)
        way += more
    return way


@compiled
def wanted_rate(speed: float, rate: float, to_speed: float, jerk: float, dt: float) -> float:
    """Return the acceleration to have after a cycle on the way to `to_speed`: the farthest that does not overshoot.

    It is approached with the full jerk, and kept for the rest of the cycle.
    """
    if speed + 0.5 * rate * abs(rate) / jerk > to_speed:
        return -_rate_up(-speed, -rate, -to_speed, jerk, dt)
    return _rate_up(speed, rate, to_speed, jerk, dt)


@compiled
def _rate_up(speed: float, rate: float, to_speed: float, jerk: float, dt: float) -> float:
    """Return the highest acceleration after a cycle that can be taken back before `to_speed` is passed."""
    highest = rate + jerk * dt
    if highest <= 0.0:
        return highest
    square = 0.5 * rate * rate / jerk
    time = dt + rate / jerk
    if time > 0.0:
        up = (to_speed - speed + square) / time
        if up >= rate:
            return min(highest, up)
    more = max(0.0, to_speed - speed - square)
    less = 0.5 * jerk * (dt - rate / jerk)
    return max(rate - jerk * dt, math.sqrt(less * less + jerk * more) - less)
