"""A circle in three axes, against rotation vectors from scipy."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest
import scipy

from polycnc.kernel._circle3d import (
    CIRCLE3D_NO_NORMAL,
    CIRCLE3D_NO_RADIUS,
    CIRCLE3D_SIZE,
    circle3d_curvature_vector,
    circle3d_point,
    circle3d_setup,
    circle3d_tangent,
    circle3d_tangent_bound,
)

Floats = npt.NDArray[np.float64]

START = np.array([12.0, -3.5, 40.25])
CENTRE = np.array([2.0, 5.0, 31.0])
NORMAL = np.array([1.0, -2.0, 0.75])


def circle(start: Floats, centre: Floats, normal: Floats, sweep_deg: float) -> Floats:
    geo = np.zeros(CIRCLE3D_SIZE)
    assert circle3d_setup(start, centre, normal, sweep_deg, geo) == 0
    return geo


def point(geo: Floats, fraction: float) -> Floats:
    out = np.zeros(3)
    circle3d_point(geo, fraction, out)
    return out


def moved_centre(start: Floats, centre: Floats, normal: Floats) -> Floats:
    unit = normal / math.sqrt(float(normal @ normal))
    return np.asarray(centre + unit * float(unit @ (start - centre)))


@pytest.mark.parametrize("sweep_deg", [37.5, -37.5, 90.0, -270.0, 360.0, 1234.5, -7200.0])
@pytest.mark.parametrize("fraction", [0.0, 0.1, 0.5, 0.83, 1.0])
def test_points_are_the_start_turned_by_the_right_hand_about_the_normal(
    sweep_deg: float, fraction: float
) -> None:
    centre = moved_centre(START, CENTRE, NORMAL)
    axis = NORMAL / np.linalg.norm(NORMAL)
    turned = scipy.spatial.transform.Rotation.from_rotvec(
        axis * math.radians(math.fmod(fraction * sweep_deg, 360.0))
    ).apply(START - centre)
    np.testing.assert_allclose(
        point(circle(START, CENTRE, NORMAL, sweep_deg), fraction), centre + turned, atol=1e-13, rtol=0.0
    )


def test_a_quarter_turn_about_z_goes_from_x_to_y() -> None:
    geo = circle(np.array([3.0, 0.0, 0.0]), np.zeros(3), np.array([0.0, 0.0, 5.0]), 90.0)
    np.testing.assert_allclose(point(geo, 1.0), [0.0, 3.0, 0.0], atol=1e-15)
    geo = circle(np.array([3.0, 0.0, 0.0]), np.zeros(3), np.array([0.0, 0.0, 5.0]), -90.0)
    np.testing.assert_allclose(point(geo, 1.0), [0.0, -3.0, 0.0], atol=1e-15)


def test_the_plane_contains_the_start_wherever_the_centre_is_on_the_axis() -> None:
    for lift in (-1e4, 0.0, 25.0):
        geo = circle(np.array([3.0, 4.0, 7.0]), np.array([0.0, 0.0, lift]), np.array([0.0, 0.0, 1.0]), 300.0)
        assert geo[10] == 5.0
        for fraction in np.linspace(0.0, 1.0, 11):
            assert point(geo, fraction)[2] == 7.0


def test_a_centre_far_off_the_plane_leaves_the_circle_round() -> None:
    normal = np.array([0.3, -0.5, 0.81])
    geo = circle(START, START + np.array([10.0, 0.0, 0.0]) + 1e6 * normal, normal, 360.0)
    centre = START - geo[3:6]
    radii = [float(np.linalg.norm(point(geo, f) - centre)) for f in np.linspace(0.0, 1.0, 33)]
    np.testing.assert_allclose(radii, geo[10], rtol=1e-14)


def test_start_and_whole_turns_are_exact() -> None:
    for turns in (1, -3, 100000):
        geo = circle(START, CENTRE, NORMAL, 360.0 * turns)
        assert point(geo, 0.0).tobytes() == START.tobytes()
        assert point(geo, 1.0).tobytes() == START.tobytes()
    assert circle(START, CENTRE, NORMAL, 36000.0)[11] == pytest.approx(200.0 * math.pi * geo[10], rel=1e-15)


@pytest.mark.parametrize("sweep_deg", [200.0, -200.0])
def test_tangent_and_curvature_are_the_derivatives_along_the_path(sweep_deg: float) -> None:
    geo = circle(START, CENTRE, NORMAL, sweep_deg)
    radius, length = geo[10], geo[11]
    assert length == pytest.approx(radius * math.radians(200.0), rel=1e-15)
    tangent, bend, bound = np.zeros(3), np.zeros(3), np.zeros(3)
    circle3d_tangent_bound(geo, bound)
    largest = np.zeros(3)
    for fraction in np.linspace(0.0, 1.0, 101):
        circle3d_tangent(geo, fraction, tangent)
        circle3d_curvature_vector(geo, fraction, bend)
        assert float(tangent @ tangent) == pytest.approx(1.0, abs=1e-14)
        assert math.sqrt(float(bend @ bend)) == pytest.approx(1.0 / radius, rel=1e-14)
        step = 1e-3
        ahead, behind = point(geo, fraction + step / length), point(geo, fraction - step / length)
        np.testing.assert_allclose((ahead - behind) / (2.0 * step), tangent, atol=1e-8)
        np.testing.assert_allclose(
            (ahead - 2.0 * point(geo, fraction) + behind) / (step * step), bend, atol=1e-6
        )
        largest = np.maximum(largest, np.abs(tangent))
        assert np.all(np.abs(bend) <= bound / radius * (1.0 + 1e-14))
    np.testing.assert_allclose(largest, bound, rtol=1e-3)
    assert np.all(largest <= bound * (1.0 + 1e-14))


@pytest.mark.parametrize(
    ("start", "normal", "code"),
    [
        ([1.0, 0.0, 0.0], [0.0, 0.0, 0.0], CIRCLE3D_NO_NORMAL),
        ([1.0, 0.0, 0.0], [math.nan, 0.0, 1.0], CIRCLE3D_NO_NORMAL),
        ([1.0, 0.0, 0.0], [math.inf, 0.0, 1.0], CIRCLE3D_NO_NORMAL),
        ([0.0, 0.0, 0.0], [0.0, 0.0, 1.0], CIRCLE3D_NO_RADIUS),
        ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0], CIRCLE3D_NO_RADIUS),
        ([math.nan, 0.0, 0.0], [0.0, 0.0, 1.0], CIRCLE3D_NO_RADIUS),
    ],
)
def test_what_is_no_circle_is_refused_and_writes_nothing(
    start: list[float], normal: list[float], code: int
) -> None:
    geo = np.full(CIRCLE3D_SIZE, 7.0)
    assert circle3d_setup(np.array(start), np.zeros(3), np.array(normal), 90.0, geo) == code
    assert np.all(geo == 7.0)


def test_the_length_of_the_normal_does_not_matter() -> None:
    expected = point(circle(START, CENTRE, NORMAL, 50.0), 1.0)
    for scale in (1e-200, 1e200):
        np.testing.assert_allclose(
            point(circle(START, CENTRE, NORMAL * scale, 50.0), 1.0), expected, rtol=1e-14
        )


def test_a_sweep_of_nothing_stays_at_the_start() -> None:
    geo = circle(START, CENTRE, NORMAL, 0.0)
    assert geo[11] == 0.0
    assert point(geo, 1.0).tobytes() == START.tobytes()
