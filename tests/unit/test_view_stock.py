"""A body on the page: the film of its field against what cutting it leaves, at any time, and how large it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import polycnc
from polycnc.runner import view_program
from polycnc.runner.view import _film, _watched
from polycnc.runner.view._film import Film, film_of
from polycnc.stock import Cutting, Stock, Tool, Turned, TurnedCutting, TurningCutting, Voxels

PLATE = """(T1 D=10. CR=0. - flat end mill)
(T3 D=6. CR=3. - ball end mill)
G21 G90 G17 G94 G54
T1 M6
S5000 M3
G0 X-8 Y12 Z20
Z-4
G1 X60 F1500
G3 X52 Y27 R9
G0 Z20
T3 M6
G0 X20 Y30
G1 Z-6 F500
X45 Z-1
G0 Z20
M30
"""
STOCK = "box=0,0,-12,57,41,0"


def _field(film: Film, until_s: float) -> np.ndarray:
    field = film.begin.ravel().copy()
    changes = int(film.counts[: int(np.searchsorted(film.ends, until_s, side="right"))].sum())
    field[film.cells[:changes]] = film.levels[:changes]  # the last of several holds
    values: np.ndarray = field.reshape(film.begin.shape) * film.level
    return values + film.first_mm[2] if film.kind == "field" else values


def test_the_last_picture_is_what_is_left() -> None:
    result = polycnc.run(PLATE, "vmc3", "fanuc", stock=STOCK, resolution_mm=0.25)
    assert result.machined is not None
    film, left = film_of(result.machined), result.machined.stock
    assert isinstance(left, Stock)
    assert film.cell_mm == 0.25
    assert _field(film, np.inf) == pytest.approx(left.heights, abs=film.level)
    assert film.first_mm == pytest.approx((left.grid.x0, left.grid.y0, left.grid.bottom))


@pytest.mark.parametrize("share", [0.31, 0.55, 0.8])
def test_at_any_time_it_is_what_was_cut_until_then(share: float) -> None:
    result = polycnc.run(PLATE, "vmc3", "fanuc", stock=STOCK, resolution_mm=0.25)
    machined = result.machined
    assert machined is not None
    film = film_of(machined)
    step = int(share * len(film.ends))
    tools = {number: tool for number, tool in machined.tools.items() if isinstance(tool, Tool)}
    cutting = Cutting(machined.form.body(machined.course, tools), tools)
    cutting.add(machined.course.at(np.flatnonzero(machined.course.t_s <= film.ends[step])))
    found = _field(film, film.ends[step])
    assert found == pytest.approx(cutting.stock.heights, abs=film.level)


def test_a_large_field_is_shown_in_means_of_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_watched, "MOST_ACROSS", 60)
    result = polycnc.run(PLATE, "vmc3", "fanuc", stock=STOCK, resolution_mm=0.25)
    assert result.machined is not None
    assert isinstance(result.machined.stock, Stock)
    film, heights = film_of(result.machined), result.machined.stock.heights
    assert film.cell_mm == 1.0
    rows, columns = (size // 4 * 4 for size in heights.shape)
    means = heights[:rows, :columns].reshape(rows // 4, 4, columns // 4, 4).mean(axis=(1, 3))
    shown = _field(film, np.inf)[: means.shape[0], : means.shape[1]]
    assert shown == pytest.approx(means, abs=film.level)
    monkeypatch.setattr(_film, "MOST_CHANGES", film.counts.sum() // 2)
    assert film_of(result.machined).cell_mm > 1.0


SHAFT = """(T1 CNMG120408 roughing)
(T5 drill 8 mm)
G21 G18 G99
T0101
G97 S800 M4
G0 X32 Z2
X24
G1 Z-20 F0.3
X28 Z-27
X32
G0 X60 Z50
T0505
G0 X0 Z3
G1 Z-11 F0.2
G0 Z30
M30
"""


def test_a_turned_body_has_both_radii_at_any_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_watched, "MOST_ALONG", 120)
    result = polycnc.run(
        SHAFT, "lathe2", "fanuc-lathe", stock="cylinder=30,-40,0", resolution_mm=0.1, check=False
    )
    machined = result.machined
    assert machined is not None
    film = film_of(machined)
    assert film.kind == "turned"
    assert film.begin.shape == (2, 100)
    for until_s in (film.ends[len(film.ends) // 3], np.inf):
        bar = machined.form.turned_body(machined.course)
        cutting = TurningCutting(bar, machined.tools)
        cutting.add(machined.course.at(np.flatnonzero(machined.course.t_s <= until_s)))
        means = np.stack((bar.outer, bar.inner)).reshape(2, 100, 4).mean(axis=2)
        assert _field(film, until_s) == pytest.approx(means, abs=0.002)  # of the chords
    assert isinstance(machined.stock, Turned)
    assert means == pytest.approx(
        np.stack((machined.stock.outer, machined.stock.inner)).reshape(2, 100, 4).mean(axis=2), abs=1e-9
    )
    assert means[1].max() == pytest.approx(4.0)


TILTED = """(T1 D=6. CR=3. - ball end mill)
G21 G90 G94
T1 M6
S5000 M3
G0 X0 Y0 Z40
A-30
G1 Z8 F3000
X14 C55
Z40
M30
"""


def test_a_body_that_turns_has_shares_of_its_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cells are wider than those that were cut; the count of what is left is the same in both."""
    monkeypatch.setattr(_watched, "MOST_THROUGH", 12)
    machined = polycnc.run(
        TILTED, "mill5", "fanuc", stock="box=-15,-11,-9,17,12,16", resolution_mm=1.0, check=False
    ).machined
    assert machined is not None
    film = film_of(machined)
    assert film.kind == "solid"
    assert film.cell_mm == pytest.approx(32.0 / 12.0, rel=0.1)
    for until_s in (film.ends[len(film.ends) // 2], np.inf):
        solid = replace(machined.form, cell_mm=film.cell_mm / 2.0).voxels(machined.course, machined.rotating)
        cutting = TurnedCutting(solid, {1: machined.rotating[1]})
        cutting.add(machined.course.at(np.flatnonzero(machined.course.t_s <= until_s)))
        shares, (nz, ny, nx) = _field(film, until_s), solid.cells.shape
        shown = np.repeat(np.repeat(np.repeat(shares, 2, 0), 2, 1), 2, 2)[:nz, :ny, :nx].sum()
        assert 0.0 < shown == pytest.approx(float(solid.cells.sum()) / Voxels.FULL, abs=8.0)  # of the chords
    assert shown < film.begin.size * 8


def test_a_page_of_a_small_part_stays_small() -> None:
    html = view_program(PLATE, "vmc3", "fanuc", stock="auto").html
    assert len(html) < 1_200_000
