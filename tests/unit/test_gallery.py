"""What the gallery of the documentation shows is what its build makes, of programs without an error."""

from __future__ import annotations

import runpy
from pathlib import Path
from typing import Any

import pytest

import polycnc

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def gallery() -> dict[str, Any]:
    return runpy.run_path(str(REPOSITORY / "scripts" / "_gallery.py"))


def test_the_page_shows_what_is_made(gallery: dict[str, Any]) -> None:
    page = (REPOSITORY / "docs" / "gallery" / "index.md").read_text(encoding="utf-8")
    for name in gallery["VIEWS"]:
        assert f'src="{name}.html"' in page
        assert f'href="{name}.html"' in page
    assert page.count("<iframe") == len(gallery["VIEWS"])
    assert gallery["REPORT"] in page
    assert 'src="gear-line.svg"' in page


def test_calculated_programs_have_no_error(gallery: dict[str, Any], tmp_path: Path) -> None:
    for name in ("laser.toml", "mould.nc", "laser.gcode"):
        (tmp_path / name).write_text(gallery["WRITTEN"][name](), encoding="utf-8")
    assert polycnc.check(tmp_path / "mould.nc") == []
    assert polycnc.check(tmp_path / "laser.gcode", tmp_path / "laser.toml", "grbl") == []


def test_what_follows_a_master_has_its_speed(gallery: dict[str, Any]) -> None:
    drawn = gallery["_gear_line"]()
    assert drawn.count("<polyline") == 4
    assert "nan" not in drawn
