"""Circles, helices and circles in space about centres that lie on no axis, at once and queued."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import pytest

from polycnc.controllers.apci import pcap
from support.apci_pc import LATENCY, SCAN_S, Pc, near

Vector = npt.NDArray[np.float64]
SYSTEM = "number_of_axes = 5\n"
ORDER = (3, 0, 4)  # x, y, z of every command here
START = np.array([17.0, -9.0, 4.0])
SPEEDS = {"ac": 100.0, "vl": 50.0}


@pytest.fixture
def pc() -> Iterator[Pc]:
    yield Pc(SYSTEM)
    pcap.detach()


def case(name: str, *also: str) -> object:
    """Return a function's name as a case that claims its row and others."""
    return pytest.param(
        name, marks=pytest.mark.covers(f"apci.{name}", *(f"apci.{row}" for row in also)), id=name
    )


def by_axis(*values: float) -> list[float]:
    """Return values for x, y, z as a field by axis number."""
    field = [0.0] * 18
    for axis, value in zip(ORDER, values, strict=False):
        field[axis] = value
    return field


def places(pc: Pc) -> Vector:
    return np.array([pc.rp(axis) for axis in ORDER])


def at_start(pc: Pc) -> pcap.AS:
    """Close all loops and put the axes at `START`; return the selection in the order x, y, z."""
    axes = pc.close(*ORDER)
    pcap.mla(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START)))
    pc.scans_until_rest()
    assert places(pc) == near(START)
    return axes


def tracked(pc: Pc) -> tuple[int, Vector]:
    """Let the axes end their profiles; return the scans this takes and where they were in each."""
    track = [places(pc)]
    scans = 0
    while any(axis.is_busy for axis in pc.board.axes):
        scans += pc.board.advance(1)
        track.append(places(pc))
    return scans, np.array(track)


def turned_deg(track: Vector, center: Vector, normal: Vector) -> float:
    """Return how far a track goes round a centre, by the right hand about a normal (degrees)."""
    arms = track - center
    sines = np.cross(arms[:-1], arms[1:]) @ normal
    cosines = np.sum(arms[:-1] * arms[1:], axis=1)
    return math.degrees(float(np.sum(np.arctan2(sines, cosines))))


def profile_scans(length: float) -> int:
    """Return the scans of a direct command from rest to rest: a triangle up to 25 mm, then a trapezoid."""
    duration_s = 2.0 * math.sqrt(length / 100.0) if length < 25.0 else length / 50.0 + 0.5
    return LATENCY + math.ceil(duration_s / SCAN_S - 1e-9)


# ------------------------------------------------------------------ circles of two axes

CENTER = np.array([11.0, -1.0, 4.0])  # 6 and 8 away from the start: radius 10
UP = np.array([0.0, 0.0, 1.0])
QUARTERS = {90.0: (19.0, 5.0), -90.0: (3.0, -7.0), 450.0: (19.0, 5.0), -180.0: (5.0, 7.0)}
CMP = ("CMP", "CMP.phi", "CMP.dtca1", "CMP.dtca2", "CMP.ac", "CMP.vl", "CMP.tvl")


def cmp_for(name: str, phi: float, **given: float) -> pcap.CMP:
    x, y, _ = CENTER if "ca" in name else CENTER - START
    return pcap.CMP(**{**SPEEDS, **given}, phi=phi, dtca1=x, dtca2=y)


@pytest.mark.covers("apci.rddv")
@pytest.mark.parametrize("phi", QUARTERS)
@pytest.mark.parametrize("name", [case("mca", *CMP), case("mcr", *CMP)])
def test_a_circle_of_two_axes(pc: Pc, name: str, phi: float) -> None:
    axes = at_start(pc)
    two = pcap.AS.of(*ORDER[:2])
    getattr(pcap, name)(two, cmp_for(name, phi))
    scans, track = tracked(pc)
    assert scans == profile_scans(10.0 * math.radians(abs(phi)))
    assert tuple(track[-1]) == near((*QUARTERS[phi], 4.0))
    assert np.linalg.norm(track - CENTER, axis=1) == near(10.0)
    assert turned_deg(track, CENTER, UP) == near(phi)
    pcap.mla(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START)))
    pc.scans_until_rest()
    getattr(pcap, name)(two, cmp_for(name, phi, tvl=7.0))
    pc.scans_until_rest()
    assert math.hypot(pc.dv(ORDER[0]), pc.dv(ORDER[1])) == near(7.0)


@pytest.mark.covers("apci.CMP.phi", "apci.CMP.dtca1", "apci.CMP.dtca2")
@pytest.mark.parametrize("phi", QUARTERS)
@pytest.mark.parametrize("name", [case("smca"), case("smcr")])
def test_a_queued_circle_of_two_axes(pc: Pc, name: str, phi: float) -> None:
    axes = at_start(pc)
    two = pcap.AS.of(*ORDER[:2])
    home = pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START))
    pcap.smlr(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(2.5, -3.5, 0.0)))
    pcap.smla(axes, home)  # a relative centre counts from the end of what is queued before it
    getattr(pcap, name)(two, cmp_for(name, phi))
    assert pcap.rdMCiS(ORDER[0]) == 3
    pcap.ssms(axes)
    track = tracked(pc)[1]
    assert tuple(track[-1]) == near((*QUARTERS[phi], 4.0))
    first = int(np.flatnonzero(np.linalg.norm(track - START, axis=1) < 1e-6)[-1])
    assert np.linalg.norm(track[first:] - CENTER, axis=1) == near(10.0, abs=1e-6)
    assert turned_deg(track[first:], CENTER, UP) == near(phi, abs=1e-4)


# ------------------------------------------------------------------ helices

HMP = ("HMP", "HMP.phi", "HMP.dtca1", "HMP.dtca2", "HMP.dtm", "HMP.ac", "HMP.vl", "HMP.tvl")
RISE = 13.5


def hmp_for(name: str, phi: float, **given: float) -> pcap.HMP:
    """Return a helix about `CENTER` that rises by `RISE`; what is not looked at has numbers too."""
    absolute = "ha" in name
    x, y, _ = CENTER if absolute else CENTER - START
    third = (START[2] if absolute else 0.0) + RISE
    return pcap.HMP(**{**SPEEDS, **given}, phi=phi, dtca1=x, dtca2=y, dtm=by_axis(77.0, -88.0, third))


def assert_helix(track: Vector, phi: float) -> None:
    flat = track * [1.0, 1.0, 0.0] + [0.0, 0.0, 4.0]
    assert tuple(track[-1]) == near((*QUARTERS[phi], 4.0 + RISE))
    assert np.linalg.norm(flat - CENTER, axis=1) == near(10.0, abs=1e-6)
    assert turned_deg(flat, CENTER, UP) == near(phi, abs=1e-4)
    half = len(track) // 3
    assert track[half, 2] == near(4.0 + RISE * turned_deg(flat[: half + 1], CENTER, UP) / phi, abs=1e-4)


@pytest.mark.parametrize("phi", [90.0, -90.0, 450.0])
@pytest.mark.parametrize("name", [case("mha", *HMP), case("mhr", *HMP)])
def test_a_helix(pc: Pc, name: str, phi: float) -> None:
    axes = at_start(pc)
    getattr(pcap, name)(axes, hmp_for(name, phi))
    scans, track = tracked(pc)
    assert_helix(track, phi)
    assert scans == profile_scans(math.hypot(10.0 * math.radians(phi), RISE))
    pcap.mla(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START)))
    pc.scans_until_rest()
    getattr(pcap, name)(axes, hmp_for(name, phi, tvl=7.0))
    pc.scans_until_rest()
    assert math.sqrt(sum(pc.dv(axis) ** 2 for axis in ORDER)) == near(7.0)


@pytest.mark.parametrize("phi", [90.0, -90.0])
@pytest.mark.parametrize("name", [case("smha"), case("smhr")])
def test_a_queued_helix(pc: Pc, name: str, phi: float) -> None:
    axes = at_start(pc)
    pcap.smlr(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(2.5, -3.5, 6.5)))
    pcap.smla(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START)))
    getattr(pcap, name)(axes, hmp_for(name, phi))
    pcap.ssms(axes)
    track = tracked(pc)[1]
    first = int(np.flatnonzero(np.linalg.norm(track - START, axis=1) < 1e-6)[-1])
    assert_helix(track[first:], phi)


@pytest.mark.covers("apci.mha")
@pytest.mark.parametrize(("phi", "turned"), [(1e-100, 90.0), (-1e-100, -270.0)])
@pytest.mark.covers("apci.HMP.phi", "apci.HMP.dtm", "apci.const.phithreshold")
def test_a_helix_without_an_angle_ends_on_the_ray_to_its_target_point(
    pc: Pc, phi: float, turned: float
) -> None:
    axes = at_start(pc)
    x, y, _ = CENTER
    target = [CENTER[0] + 1.5 * 8.0, CENTER[1] + 1.5 * 6.0, 4.0 + RISE]  # half as far again as the circle
    pcap.mha(axes, pcap.HMP(**SPEEDS, phi=phi, dtca1=x, dtca2=y, dtm=by_axis(*target)))
    track = tracked(pc)[1]
    assert tuple(track[-1]) == near((19.0, 5.0, 4.0 + RISE))
    flat = track * [1.0, 1.0, 0.0] + [0.0, 0.0, 4.0]
    assert turned_deg(flat, CENTER, UP) == near(turned, abs=1e-6)


@pytest.mark.covers("apci.mha", "apci.HMP.phi", "apci.const.phithreshold")
@pytest.mark.parametrize("phi", [1.5e-100, -1.5e-100])
def test_an_angle_above_the_threshold_is_one(pc: Pc, phi: float) -> None:
    axes = at_start(pc)
    x, y, _ = CENTER
    pcap.mha(axes, pcap.HMP(**SPEEDS, phi=phi, dtca1=x, dtca2=y, dtm=by_axis(19.0, 5.0, 4.0 + RISE)))
    track = tracked(pc)[1]
    assert tuple(track[-1][:2]) == near(tuple(START[:2]))  # it hardly turns


# ------------------------------------------------------------------ circles in space

# The normal (1, 2, 2)/3 times 1.5; the arm (6, 3, -6) of length 9 stands on it, and (-6, 6, -3) on both.
NORMAL = np.array([1.0, 2.0, 2.0]) / 3.0
MIDDLE = START - np.array([6.0, 3.0, -6.0])
SPACE = {
    90.0: (5.0, -6.0, 7.0),
    -90.0: (17.0, -18.0, 13.0),
    180.0: (5.0, -15.0, 16.0),
    630.0: (17.0, -18.0, 13.0),
}
HMP3D = (
    *(
        "HMP3D",
        "HMP3D.phi",
        "HMP3D.dtca1",
        "HMP3D.dtca2",
        "HMP3D.dtca3",
        "HMP3D.pn1",
        "HMP3D.pn2",
        "HMP3D.pn3",
    ),
    *("HMP3D.dtm", "HMP3D.ac", "HMP3D.vl", "HMP3D.tvl"),
)


def hmp3d_for(name: str, phi: float, tvl: float = 0.0) -> pcap.HMP3D:
    center = MIDDLE if "ca" in name else MIDDLE - START
    reserved = [31.0, -32.0, 33.0, *[0.0] * 15]  # is not used
    return pcap.HMP3D(100.0, 50.0, tvl, phi, *center, *(1.5 * NORMAL), dtm=reserved)


def assert_space_circle(track: Vector, phi: float) -> None:
    assert tuple(track[-1]) == near(SPACE[phi])
    assert np.linalg.norm(track - MIDDLE, axis=1) == near(9.0, abs=1e-6)
    assert (track - MIDDLE) @ NORMAL == near(0.0, abs=1e-6)
    assert turned_deg(track, MIDDLE, NORMAL) == near(phi, abs=1e-4)


@pytest.mark.parametrize("phi", SPACE)
@pytest.mark.parametrize("name", [case("mca3d", *HMP3D), case("mcr3d", *HMP3D)])
def test_a_circle_in_space(pc: Pc, name: str, phi: float) -> None:
    axes = at_start(pc)
    getattr(pcap, name)(axes, hmp3d_for(name, phi))
    scans, track = tracked(pc)
    assert_space_circle(track, phi)
    assert scans == profile_scans(9.0 * math.radians(abs(phi)))
    pcap.mla(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START)))
    pc.scans_until_rest()
    getattr(pcap, name)(axes, hmp3d_for(name, phi, tvl=7.0))
    pc.scans_until_rest()
    assert math.sqrt(sum(pc.dv(axis) ** 2 for axis in ORDER)) == near(7.0)


@pytest.mark.covers("apci.HMP3D.phi", "apci.HMP3D.dtca1", "apci.HMP3D.dtca2", "apci.HMP3D.dtca3")
@pytest.mark.parametrize("phi", [90.0, -90.0])
@pytest.mark.parametrize("name", [case("smca3d"), case("smcr3d")])
def test_a_queued_circle_in_space(pc: Pc, name: str, phi: float) -> None:
    axes = at_start(pc)
    pcap.smlr(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(2.5, -3.5, 6.5)))
    pcap.smla(axes, pcap.LMP(ac=1e6, vl=1e5, dtm=by_axis(*START)))
    getattr(pcap, name)(axes, hmp3d_for(name, phi))
    pcap.ssms(axes)
    track = tracked(pc)[1]
    first = int(np.flatnonzero(np.linalg.norm(track - START, axis=1) < 1e-6)[-1])
    assert_space_circle(track[first:], phi)
