"""The measuring example: its report, its motion and its cycle time against computed numbers."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from polycnc.runner import RunResult, run

EXAMPLES = Path(__file__).parents[2] / "examples"
CENTER, FACE, BORE, LENGTH = (50.15, 39.9), -2.35, 20.01, 62.48
REPORT = """bore at   50.150   39.900, face at   -2.350
diameter  40.020, off by  0.020
hole  1    31.393    8.412
hole  2     8.412   31.393
hole  3   -22.981   22.981
hole  4   -31.393   -8.412
hole  5    -8.412  -31.393
hole  6    22.981  -22.981
time  100.185 s
"""


@pytest.fixture(scope="module")
def measured(tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    folder = tmp_path_factory.mktemp("flange")
    result = run(EXAMPLES / "flange.npg", EXAMPLES / "flange.toml", trace=True, root=folder)
    return result, folder


def test_the_report_is_what_was_measured_and_reached(measured: tuple[RunResult, Path]) -> None:
    result, folder = measured
    assert (folder / "flange.txt").read_bytes() == REPORT.encode() + b"\x03\n"
    assert result.alarms == []
    assert result.time_s == pytest.approx(100.185, abs=0.0005)


def test_the_probe_stays_at_the_wall_and_the_holes_lie_on_their_circle(
    measured: tuple[RunResult, Path],
) -> None:
    trace = measured[0].trace
    assert trace is not None
    x, y, z = trace.setpoint.T
    radius = np.hypot(x - CENTER[0], y - CENTER[1])
    probing = z == -10.0
    overshoot = radius[probing].max() - BORE
    assert 0.0 < overshoot < 0.01 + 10.0**2 / (2 * 5000) + 0.001  # a cycle at 10 mm/s, then braking
    bottom = np.isclose(z, FACE + LENGTH - 8)
    holes = {
        (round(a, 3), round(b, 3)) for a, b in zip(x[bottom], y[bottom], strict=True) if math.hypot(a, b) > 0
    }
    angles = [math.radians(15 + 60 * place) for place in range(6)]
    wanted = {
        (round(CENTER[0] + 32.5 * math.cos(angle), 3), round(CENTER[1] + 32.5 * math.sin(angle), 3))
        for angle in angles
    }
    assert wanted <= holes


def test_the_thread_is_a_helix_of_its_pitch(measured: tuple[RunResult, Path]) -> None:
    trace = measured[0].trace
    assert trace is not None
    x, y, z = trace.setpoint.T
    radius = np.hypot(x - CENTER[0], y - CENTER[1])
    path = 20.92 - 8.0
    depth = z - FACE - LENGTH
    helix = np.flatnonzero(np.isclose(radius, path, atol=1e-6) & (depth > -8.99) & (depth < -0.01))
    angle = np.unwrap(np.arctan2(y[helix] - CENTER[1], x[helix] - CENTER[0]))
    assert (np.diff(angle) > 0).all()
    slope = np.polyfit(angle, depth[helix], 1)[0]
    assert slope * 2 * math.pi == pytest.approx(1.5, abs=1e-6)
    assert (angle[-1] - angle[0]) / (2 * math.pi) == pytest.approx(9 / 1.5, abs=0.02)  # the ends are cut off


def test_the_next_run_begins_with_the_zero_that_was_measured(measured: tuple[RunResult, Path]) -> None:
    plain = measured[1] / "plain.npg"
    plain.write_text("N10 G54 H5\nN20 G1 X1 Y2 Z3 F1000\nN30 M30\n")
    found = run(plain, EXAMPLES / "flange.toml").end_position_mm
    wanted = {"X": CENTER[0] + 1, "Y": CENTER[1] + 2, "Z": FACE + LENGTH + 3}
    assert found == pytest.approx(wanted, abs=1e-4)
