"""Roughing of contours with pockets, held against a model of the material: how deep it is cut along Z.

Depth counts from where the cycle begins into the part. The model knows nothing of levels: it follows the steps.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.nc.blocks._moves import GeometryError
from polycnc.nc.blocks._turning import Piece, Roughing, Step, exchanged, rough
from polycnc.nc.blocks._turning_pockets import rough_pockets
from support.often import share

Floats = npt.NDArray[np.float64]
GRID = 4001
TOLERANCE = 2e-3  # chords of arcs, and how far a slope of 10 goes between places of the grid


def points_of(start: tuple[float, float], step: Piece | Step) -> Floats:
    """Return points along a line or an arc, rows of x and z."""
    arc = step.arc if isinstance(step, Step) else step
    part = np.linspace(0.0, 1.0, 400)
    if arc is None or arc.center is None:
        ends = np.array([start, step.end])
        return (
            ends if start[1] != step.end[1] else np.array([ends[0], ends[0] * 0.5 + ends[1] * 0.5, ends[1]])
        )
    x, z = arc.center
    radius = math.dist(arc.start, arc.center)
    angle = math.atan2(arc.start[0] - x, arc.start[1] - z) + part * arc.sweep_rad
    return np.stack((x + radius * np.sin(angle), z + radius * np.cos(angle)), axis=1)


def depth_along(points: Floats, z: Floats, top: float, way: float) -> Floats:
    """Return how deep a run of points is at each z, -inf beside it; across Z nothing."""
    depth = np.full(len(z), -np.inf)
    for (x0, z0), (x1, z1) in itertools.pairwise(points):
        if abs(z1 - z0) < 1e-12:
            continue
        low, high = sorted((z0, z1))
        inside = (z >= low) & (z <= high)
        x = x0 + (x1 - x0) * (z[inside] - z0) / (z1 - z0)
        depth[inside] = np.maximum(depth[inside], (x - top) * way)
    return depth


def check_material(contour: Sequence[Piece], numbers: Roughing, steps: Sequence[Step], way: float) -> int:
    """Cut the material by the steps, and say how many cuts there were."""
    shifted = [piece.shifted(numbers.allowance) for piece in contour]
    start = contour[0].start
    top = shifted[0].start[0]
    # On the way to the contour there is no material.
    z = np.linspace(shifted[0].end[1], shifted[-1].end[1], GRID)[1:-1]
    wanted = np.full(len(z), -np.inf)
    for piece in shifted:
        wanted = np.maximum(wanted, depth_along(points_of(piece.start, piece), z, top, way))
    assert np.isfinite(wanted).all()
    cut = np.minimum((start[0] - top) * way, wanted)  # the tool stands beside the material
    last = len(steps) - len(shifted)
    at, cuts = start, 0
    for number, step in enumerate(steps):
        if number == last - 2:
            assert (
                wanted - cut <= numbers.depth_mm + TOLERANCE
            ).all()  # what the last way along the contour leaves
        depth = depth_along(points_of(at, step), z, top, way)
        assert (depth <= wanted + TOLERANCE).all(), f"step {number} cuts into the part"
        removed = depth - cut
        if step.rapid:
            assert (removed <= TOLERANCE).all(), f"rapid {number} runs into the material"
        else:
            assert (removed <= numbers.depth_mm + TOLERANCE).all(), f"step {number} cuts too deep"
            cuts += bool((removed > TOLERANCE).any())
        cut = np.maximum(cut, depth)
        at = step.end
    assert np.abs(cut - wanted).max() < TOLERANCE
    assert at == pytest.approx(start)
    return cuts


def contour_of(points: Sequence[tuple[float, float]]) -> list[Piece]:
    return [Piece(a, b) for a, b in itertools.pairwise(points) if a != b]


@st.composite
def outlines(draw: st.DrawFn) -> tuple[list[Piece], Roughing]:
    """Contours from (40, 3) that go one way along Z, in and out across it, with walls and flats."""
    numbers = Roughing(
        draw(st.sampled_from([0.7, 1.3, 2.5, 9.0])),
        draw(st.sampled_from([0.0, 0.2, 1.1, 4.0])),
        (draw(st.sampled_from([0.0, 0.4])), draw(st.sampled_from([0.0, 0.15]))),
    )
    x = st.sampled_from([12.0, 14.5, 17.25, 21.0, 21.8, 26.5, 30.0, 35.75])
    points = [(40.0, 3.0), (draw(x), draw(st.sampled_from([3.0, 1.5])))]
    for _ in range(draw(st.integers(2, 9))):
        before = points[-1]
        points.append((draw(x), before[1] - draw(st.sampled_from([0.0, 0.8, 2.5, 6.0]))))
    points.append((draw(st.sampled_from([38.0, 21.0])), points[-1][1] - draw(st.sampled_from([0.5, 2.0]))))
    if draw(st.booleans()):
        points.append((43.0, points[-1][1]))
    return contour_of(points), numbers


@settings(max_examples=share(100), deadline=None)
@given(outlines(), st.booleans())
def test_no_pass_cuts_the_part_or_too_deep(case: tuple[list[Piece], Roughing], rapid: bool) -> None:
    contour, numbers = case
    check_material(contour, numbers, rough_pockets(contour, numbers, first_rapid=rapid), -1.0)


@settings(max_examples=share(60), deadline=None)
@given(outlines())
def test_bores_are_the_same_from_the_other_side(case: tuple[list[Piece], Roughing]) -> None:
    contour, numbers = case
    inside = [
        Piece((80.0 - each.start[0], each.start[1]), (80.0 - each.end[0], each.end[1])) for each in contour
    ]
    numbers = Roughing(numbers.depth_mm, numbers.escape_mm, (-numbers.allowance[0], numbers.allowance[1]))
    check_material(inside, numbers, rough_pockets(inside, numbers, first_rapid=True), 1.0)


def test_pockets_of_arcs_are_cut_one_after_the_other() -> None:
    """A round pocket of radius 9 about (26, -12), and one of lines; the first is finished before the second."""
    half = math.sqrt(9.0**2 - 5.0**2)
    low, high = (21.0, -12.0 + half), (21.0, -12.0 - half)
    # Through the bottom, at (17, -12): from Z towards X the angle goes from -34 to -146 degree.
    pocket = Piece(low, high, (26.0, -12.0), -2.0 * math.acos(5.0 / 9.0))
    contour = [Piece((40.0, 3.0), (21.0, 3.0)), Piece((21.0, 3.0), low), pocket]
    contour += contour_of([high, (21.0, -25.0), (15.0, -27.0), (15.0, -30.0), (38.0, -33.0)])
    numbers = Roughing(1.75, 0.5, (0.3, 0.1))
    steps = rough_pockets(contour, numbers, first_rapid=True)
    assert check_material(contour, numbers, steps, -1.0) > 12
    deep = [step.end[1] for step in steps[:-9] if step.end[0] < 21.0 and not step.rapid]
    assert deep == sorted(deep, key=lambda z: z < -24.0)


def test_a_contour_without_pockets_takes_the_levels_of_the_plain_cycle() -> None:
    contour = contour_of([(25.0, 2.0), (10.0, 2.0), (10.0, -10.0), (15.0, -20.0), (25.0, -20.0)])
    numbers = Roughing(4.0, 1.0, (0.5, 0.1))
    plain, pockets = (cut(contour, numbers, first_rapid=True) for cut in (rough, rough_pockets))
    along = [
        [step.end for step in steps if not step.rapid and step.end[0] in (21.5, 17.5, 13.5)]
        for steps in (plain, pockets)
    ]
    assert along[0] == [(21.5, -19.9), (17.5, -19.9), (13.5, pytest.approx(-15.9))]
    assert set(along[0]) <= set(along[1])
    assert check_material(contour, numbers, plain, -1.0) == 5
    assert check_material(contour, numbers, pockets, -1.0) == 6  # it follows the slope after a cut


@pytest.mark.parametrize(
    ("points", "text"),
    [
        ([(25, 2), (10, 2), (10, -9), (15, -8), (25, -12)], "turns back along the cuts"),
        ([(25, 2), (10, 5), (10, -9), (25, -12)], "turns back along the cuts"),
        ([(25, 2), (10, 2), (30, -9), (20, -12), (20, -14)], "comes out beyond the start"),
        ([(25, 2), (10, 2), (10, -9), (26, -9), (26, -14)], "comes out beyond the start"),
        ([(25, 2), (25, -9)], "one block only"),
        ([(25, 2), (10, 2), (25, 2)], "comes back to where it begins"),
    ],
)
def test_contours_that_cannot_be_cut(points: list[tuple[float, float]], text: str) -> None:
    with pytest.raises(GeometryError, match=text):
        rough_pockets(contour_of(points), Roughing(4.0, 1.0, (0.0, 0.0)), first_rapid=True)


def test_facing_is_the_same_with_axes_exchanged() -> None:
    contour = contour_of([(2.0, 30.0), (-9.0, 30.0), (-9.0, 22.0), (-4.0, 18.0), (-8.0, 15.0), (1.0, 12.0)])
    steps = rough_pockets(contour, Roughing(2.0, 0.4, (0.1, 0.3)), first_rapid=False)
    assert [step.end[::-1] for step in steps] == [step.end for step in exchanged(steps)]
    assert check_material(contour, Roughing(2.0, 0.4, (0.1, 0.3)), steps, -1.0) > 5
