"""A body on the page: the film of its field against what cutting it leaves, at any time, and how large it is."""

from __future__ import annotations

import numpy as np
import pytest

import polycnc
from polycnc.runner import view_program
from polycnc.runner.view import _film
from polycnc.runner.view._film import Film, film_of
from polycnc.stock import Cutting, Stock, Tool

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
    heights: np.ndarray = field.reshape(film.begin.shape) * film.level_mm + film.bottom_mm
    return heights


def test_the_last_picture_is_what_is_left() -> None:
    result = polycnc.run(PLATE, "vmc3", "fanuc", stock=STOCK, resolution_mm=0.25)
    assert result.machined is not None
    film, left = film_of(result.machined), result.machined.stock
    assert isinstance(left, Stock)
    assert film.cell_mm == 0.25
    assert _field(film, np.inf) == pytest.approx(left.heights, abs=film.level_mm)
    assert film.first_mm == pytest.approx((left.grid.x0, left.grid.y0))


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
    assert found == pytest.approx(cutting.stock.heights, abs=film.level_mm)


def test_a_large_field_is_shown_in_means_of_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_film, "MOST_ACROSS", 60)
    result = polycnc.run(PLATE, "vmc3", "fanuc", stock=STOCK, resolution_mm=0.25)
    assert result.machined is not None
    assert isinstance(result.machined.stock, Stock)
    film, heights = film_of(result.machined), result.machined.stock.heights
    assert film.cell_mm == 1.0
    rows, columns = (size // 4 * 4 for size in heights.shape)
    means = heights[:rows, :columns].reshape(rows // 4, 4, columns // 4, 4).mean(axis=(1, 3))
    shown = _field(film, np.inf)[: means.shape[0], : means.shape[1]]
    assert shown == pytest.approx(means, abs=film.level_mm)
    monkeypatch.setattr(_film, "MOST_CHANGES", film.counts.sum() // 2)
    assert film_of(result.machined).cell_mm > 1.0


def test_a_page_of_a_small_part_stays_small() -> None:
    html = view_program(PLATE, "vmc3", "fanuc", stock="auto").html
    assert len(html) < 1_200_000
