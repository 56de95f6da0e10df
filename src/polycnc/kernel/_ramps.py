"""The speed profile over one segment: ramp, cruise, ramp, in closed form.

A ramp keeps its mean acceleration, duration and distance whatever its shape; `jerkrel` is the part of it that is
spent on building the acceleration up and down (0 rectangular, 1 triangular). Source: Manual 002, 2.2.

Within a cycle of a corner a segment gives up part of its acceleration. So it comes in three pieces: near its start,
between, and near its end. A ramp that goes over several of them has a leg in each.

Units: lengths in mm (deg where only rotary axes move), speeds per s, accelerations per s2, times in s; shares are parts
of one.
"""

from __future__ import annotations

import math

from polycnc.kernel._jit import compiled
from polycnc.kernel._path import (
    FROM_S,
    LEGS_IN,
    LEGS_OUT,
    LENGTH,
    PIECES,
    SPEED_IN,
    SPEED_OUT,
    SPEED_PEAK,
    TIME_CRUISE,
    TIME_IN,
    TIME_OUT,
    ramps_duration,
)
from polycnc.kernel._segments import Floats

ROUNDING = 4e-15  # by which a speed that can just be braked to may seem too low, on squares
MOST_SHARE = 0.75  # of its acceleration is all that a segment gives up


@compiled
def beside_corner(speed: float, accel: float, share: float, dt: float, length: float) -> float:
    """Return how far, at most `length`, the path may be from a corner passed with `speed` within `dt`.

    It has given up `share` of `accel` till then. A greater share than a half counts as a half, so that what is lost by
    it never falls with the speed.
    """
    return min(length, (speed + 0.5 * accel * (1.0 - min(share, 0.5)) * dt) * dt)


@compiled
def set_pieces(
    ramps: Floats,
    speed_in: float,
    length: float,
    accel: float,
    speed_out: float,
    zone: float,
    share: float,
    yield_out: float,
    dt: float,
) -> None:
    """Set the pieces of `length` more of a segment, for `plan_ramps`.

    `share` of `accel` is given up for `zone` more, and `yield_out` of it per speed beside the end. Where the pieces
    overlap the greater part counts.
    """
    top = math.sqrt(speed_in * speed_in + 2.0 * accel * length)
    speed = min(speed_out, top)
    last = min(MOST_SHARE, yield_out * speed)
    from_start = min(zone, length) if share > 0.0 and zone > 0.0 else 0.0
    to_end = beside_corner(speed, accel, last, dt, length) if last > 0.0 else 0.0
    both = max(0.0, from_start + to_end - length)
    ramps[PIECES] = from_start - both
    ramps[PIECES + 1] = accel * (1.0 - share)
    ramps[PIECES + 2] = both if both > 0.0 else length - from_start - to_end
    ramps[PIECES + 3] = accel * (1.0 - max(share, last)) if both > 0.0 else accel
    ramps[PIECES + 4] = to_end - both
    ramps[PIECES + 5] = accel * (1.0 - last)


@compiled
def set_one_piece(ramps: Floats, length: float, accel: float) -> None:
    """Set the pieces of a stretch that has `accel` all along."""
    set_pieces(ramps, 0.0, length, accel, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def plan_ramps(
    ramps: Floats, speed_in: float, length: float, cap: float, accel: float, speed_out: float, s: float
) -> None:
    """Fill `ramps[REGISTERS]` for `length` more of a segment that has been traversed up to `s`.

    Its pieces are set (`set_pieces`), `accel` is the greatest of theirs. The end speed is lowered to what can be
    reached, or raised to what cannot be braked away.
    """
    square = speed_in * speed_in
    first = 2.0 * ramps[PIECES + 1] * ramps[PIECES]
    middle = 2.0 * ramps[PIECES + 3] * ramps[PIECES + 2]
    last = 2.0 * ramps[PIECES + 5] * ramps[PIECES + 4]
    gain = first + middle + last
    ramps[SPEED_IN] = speed_in
    ramps[TIME_IN] = 0.0
    ramps[TIME_CRUISE] = 0.0
    ramps[TIME_OUT] = 0.0
    ramps[FROM_S] = s
    ramps[LENGTH] = length
    even = first == 0.0 and last == 0.0
    if speed_out * speed_out >= square + gain:  # faster all the way
        top = math.sqrt(square + gain)
        ramps[SPEED_PEAK] = top
        ramps[SPEED_OUT] = top
        if top > 0.0:
            _set_legs(ramps, LEGS_IN, TIME_IN, speed_in, top, length, even)
        return
    least = square - gain
    if speed_out * speed_out <= least:  # slower all the way
        if speed_out * speed_out < least - ROUNDING * (square + 2.0 * accel * (s + length)):
            speed_out = math.sqrt(least)
        ramps[SPEED_PEAK] = speed_in
        ramps[SPEED_OUT] = speed_out
        _set_legs(ramps, LEGS_OUT, TIME_OUT, speed_out, speed_in, length, even)
        return
    out = speed_out * speed_out
    # The square at which the fastest way in meets the fastest way out; both go on with the same slope in a piece.
    meet = 0.5 * (gain + square + out)
    if not even:
        if square + first >= out + last + middle:
            meet = 0.5 * (square + first + out + last + middle)
        elif square + first + middle >= out + last:
            meet = 0.5 * (square + first + middle + out + last)
    peak = min(max(cap, speed_out), math.sqrt(meet))
    if even:
        accel = ramps[PIECES + 3]
        distance_in = abs(peak - speed_in) * (peak + speed_in) / (2.0 * accel)
        distance_out = (peak - speed_out) * (peak + speed_out) / (2.0 * accel)
        ramps[TIME_IN] = abs(peak - speed_in) / accel
        ramps[TIME_OUT] = (peak - speed_out) / accel
        _set_one_leg(ramps, LEGS_IN, ramps[TIME_IN], peak)
        _set_one_leg(ramps, LEGS_OUT, ramps[TIME_OUT], peak)
    else:
        distance_in = _set_legs(ramps, LEGS_IN, TIME_IN, speed_in, peak, length, even)
        distance_out = _set_legs(ramps, LEGS_OUT, TIME_OUT, speed_out, peak, length, even)
    cruise = length - distance_in - distance_out
    ramps[SPEED_PEAK] = peak
    ramps[SPEED_OUT] = speed_out
    if cruise > 0.0:
        ramps[TIME_CRUISE] = cruise / peak


@compiled
def _set_one_leg(ramps: Floats, legs: int, time_s: float, speed: float) -> None:
    ramps[legs] = time_s
    ramps[legs + 1] = speed
    ramps[legs + 2] = 0.0
    ramps[legs + 4] = 0.0


@compiled
def _set_legs(
    ramps: Floats, legs: int, total: int, near: float, far: float, length: float, even: bool
) -> float:
    """Set the legs of a ramp from speed `near` at its end of the segment to `far`; return the distance it takes.

    `total` is the register of its time. A ramp over an even segment goes all its `length`.
    """
    if even:
        ramps[total] = 2.0 * length / (near + far)
        _set_one_leg(ramps, legs, ramps[total], far)
        return length
    square, target = near * near, far * far
    way = 1.0 if target > square else -1.0
    distance, time = 0.0, 0.0
    speed = near
    for leg in range(3):
        piece = PIECES + 2 * (leg if legs == LEGS_IN else 2 - leg)
        along, accel = ramps[piece], ramps[piece + 1]
        needed = abs(target - square) / (2.0 * accel)
        ramps[legs + 2 * leg] = 0.0
        ramps[legs + 2 * leg + 1] = far
        if speed == far:
            continue
        if needed <= along or leg == 2:
            along = needed
            after = far
        else:
            square += way * 2.0 * accel * along
            after = math.sqrt(max(square, 0.0))
        if along > 0.0:
            ramps[legs + 2 * leg] = 2.0 * along / (speed + after)
            ramps[legs + 2 * leg + 1] = after
        elif after != far:
            ramps[legs + 2 * leg + 1] = speed
            after = speed
        time += ramps[legs + 2 * leg]
        distance += along
        speed = after
    ramps[total] = time
    return distance


@compiled
def halting_distance(speed: float, accel: float, zone: float, share: float) -> float:
    """Return the way to rest when `share` of `accel` is given up for `zone` more."""
    square = speed * speed
    if zone > 0.0 and share > 0.0:
        lower = 2.0 * accel * (1.0 - share) * zone
        if square <= lower:
            return zone * square / lower
        return zone + (square - lower) / (2.0 * accel)
    return square / (2.0 * accel)


@compiled
def plan_pause(ramps: Floats, duration_s: float) -> None:
    """Fill `ramps` to stand still for `duration_s`."""
    set_one_piece(ramps, 0.0, 1.0)
    plan_ramps(ramps, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    ramps[TIME_CRUISE] = duration_s


@compiled
def shaped_ramp(
    t: float, duration_s: float, from_speed: float, to_speed: float, jerkrel: float
) -> tuple[float, float]:
    """Return distance and speed at time `t` into a ramp of `duration_s`."""
    change = to_speed - from_speed
    if jerkrel <= 0.0:
        rise = change * (t / duration_s)
        return (from_speed + 0.5 * rise) * t, from_speed + rise
    edge = duration_s * jerkrel / (1.0 + jerkrel)
    peak = change / (duration_s - edge)
    jerk = peak / edge
    if t <= edge:
        return from_speed * t + jerk * t * t * t / 6.0, from_speed + 0.5 * jerk * t * t
    left = duration_s - t
    if left < edge:  # mirror image from the end
        back = to_speed * left - jerk * left * left * left / 6.0
        return 0.5 * (from_speed + to_speed) * duration_s - back, to_speed - 0.5 * jerk * left * left
    u = t - edge
    speed = from_speed + 0.5 * jerk * edge * edge
    distance = from_speed * edge + jerk * edge * edge * edge / 6.0
    return distance + speed * u + 0.5 * peak * u * u, speed + peak * u


@compiled
def _along_legs(ramps: Floats, legs: int, speed: float, t: float, jerkrel: float) -> tuple[float, float]:
    """Return distance and speed at time `t` into a ramp that begins with `speed` and has the legs at `legs`."""
    gone = 0.0
    for leg in range(legs, legs + 6, 2):
        time, after = ramps[leg], ramps[leg + 1]
        if t < time:
            distance, now = shaped_ramp(t, time, speed, after, jerkrel)
            return gone + distance, now
        if time > 0.0:
            gone += 0.5 * (speed + after) * time
            speed = after
            t -= time
    return gone, speed


@compiled
def ramps_at(ramps: Floats, t: float, jerkrel: float) -> tuple[float, float]:
    """Return path length within the segment and speed at time `t` of the planned stretch."""
    begin, peak, out = ramps[FROM_S], ramps[SPEED_PEAK], ramps[SPEED_OUT]
    if t < ramps[TIME_IN]:
        gone, speed = _along_legs(ramps, LEGS_IN, ramps[SPEED_IN], t, jerkrel)
        return begin + gone, speed
    # Everything else is measured from the end, so that the segment's end is met exactly.
    left = ramps_duration(ramps) - t
    end = begin + ramps[LENGTH]
    if left <= 0.0:
        return end, float(out)
    if left < ramps[TIME_OUT]:
        to_go, speed = _along_legs(ramps, LEGS_OUT, out, left, jerkrel)
        return end - to_go, speed
    to_go, _ = _along_legs(ramps, LEGS_OUT, out, ramps[TIME_OUT], jerkrel)
    return end - to_go - peak * (left - ramps[TIME_OUT]), float(peak)
