"""A circle in three axes: the start point turned about an axis through the centre.

The plane of the circle is the one through the start point with the given normal, so a centre off that plane
is moved into it along the normal. A circle is one row of `CIRCLE3D_SIZE` numbers:

    0..2   start point
    3..5   R, the radius vector from the centre to the start point
    6..8   Q = n x R, the radius vector a quarter turn further on
    9      sweep in degrees, right-hand rule about the normal; whole turns count
    10     radius
    11     length along the circle

A point is `start + (cos - 1) R + sin Q`: nothing cancels, and at fraction 0 it is the start, bit for bit.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from polycnc.kernel._jit import compiled

CIRCLE3D_SIZE = 12
CIRCLE3D_NO_NORMAL = -1
CIRCLE3D_NO_RADIUS = -2

_RADIANS = math.pi / 180.0
_ROUNDING = 1e-12  # a radius below this share of the numbers it comes from is rounding, not geometry


@compiled
def circle3d_setup(
    start: npt.NDArray[np.float64],
    centre: npt.NDArray[np.float64],
    normal: npt.NDArray[np.float64],
    sweep_deg: float,
    geo_out: npt.NDArray[np.float64],
) -> int:
    """Fill `geo_out[12]` from start, centre, normal (3 numbers each, the normal of any length) and sweep.

    Return 0, `CIRCLE3D_NO_NORMAL` for a zero normal, or `CIRCLE3D_NO_RADIUS` for a start on the axis of the
    circle; `geo_out` is then unchanged. A sweep of zero is a circle of length zero.
    Source: Manual 002, 4.4.30.
    """
    largest = max(abs(normal[0]), abs(normal[1]), abs(normal[2]))
    if not 0.0 < largest < math.inf:
        return CIRCLE3D_NO_NORMAL
    nx, ny, nz = normal[0] / largest, normal[1] / largest, normal[2] / largest
    norm = math.sqrt(nx * nx + ny * ny + nz * nz)
    nx, ny, nz = nx / norm, ny / norm, nz / norm
    rx, ry, rz = start[0] - centre[0], start[1] - centre[1], start[2] - centre[2]
    size = max(abs(rx), abs(ry), abs(rz))
    for _ in range(2):  # the second pass takes out what the first leaves when the centre is far off the plane
        along = rx * nx + ry * ny + rz * nz
        rx, ry, rz = rx - along * nx, ry - along * ny, rz - along * nz
    radius = math.sqrt(rx * rx + ry * ry + rz * rz)
    if not _ROUNDING * size < radius < math.inf:
        return CIRCLE3D_NO_RADIUS
    geo_out[0], geo_out[1], geo_out[2] = start[0], start[1], start[2]
    geo_out[3], geo_out[4], geo_out[5] = rx, ry, rz
    geo_out[6] = ny * rz - nz * ry
    geo_out[7] = nz * rx - nx * rz
    geo_out[8] = nx * ry - ny * rx
    geo_out[9] = sweep_deg
    geo_out[10] = radius
    geo_out[11] = radius * abs(sweep_deg) * _RADIANS
    return 0


@compiled
def _angle_rad(geo: npt.NDArray[np.float64], fraction: float) -> float:
    """Return the angle at a fraction of the sweep without whole turns, so that many turns lose no digits."""
    angle_deg = fraction * geo[9]
    return float((angle_deg - 360.0 * math.floor(angle_deg / 360.0 + 0.5)) * _RADIANS)


@compiled
def circle3d_point(geo: npt.NDArray[np.float64], fraction: float, out: npt.NDArray[np.float64]) -> None:
    """Write the point at a fraction 0..1 of the sweep to `out[3]`."""
    angle = _angle_rad(geo, fraction)
    half = math.sin(0.5 * angle)
    back = -2.0 * half * half  # cos - 1
    sine = math.sin(angle)
    for i in range(3):
        out[i] = geo[i] + (back * geo[3 + i] + sine * geo[6 + i])


@compiled
def circle3d_tangent(geo: npt.NDArray[np.float64], fraction: float, out: npt.NDArray[np.float64]) -> None:
    """Write the unit tangent in the direction of travel (dp/ds) to `out[3]`."""
    angle = _angle_rad(geo, fraction)
    scale = math.copysign(1.0, geo[9]) / geo[10]
    cosine, sine = math.cos(angle), math.sin(angle)
    for i in range(3):
        out[i] = scale * (cosine * geo[6 + i] - sine * geo[3 + i])


@compiled
def circle3d_curvature_vector(
    geo: npt.NDArray[np.float64], fraction: float, out: npt.NDArray[np.float64]
) -> None:
    """Write the curvature vector (d2p/ds2, towards the centre, length 1 / radius) to `out[3]`."""
    angle = _angle_rad(geo, fraction)
    scale = -1.0 / (geo[10] * geo[10])
    cosine, sine = math.cos(angle), math.sin(angle)
    for i in range(3):
        out[i] = scale * (cosine * geo[3 + i] + sine * geo[6 + i])


@compiled
def circle3d_tangent_bound(geo: npt.NDArray[np.float64], out: npt.NDArray[np.float64]) -> None:
    """Write the largest |dp_i/ds| of a whole turn to `out[3]`; over the radius, it bounds |d2p_i/ds2|."""
    for i in range(3):
        out[i] = math.sqrt(geo[3 + i] * geo[3 + i] + geo[6 + i] * geo[6 + i]) / geo[10]
