"""Bodies as files: what a reader of each format finds is the body that was written, bit by bit the same each time."""

from __future__ import annotations

import zipfile
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from polycnc.errors import UsageError
from polycnc.stock import Box, Mesh, Stock, read_stl

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def step() -> Stock:
    """Return a block of 9 x 6 x 5 mm with a step of 4 mm width that is 3 mm deep."""
    stock = Stock(Box((-2.0, 3.0, -5.0), (7.0, 9.0, 0.0)), 0.5)
    stock.grid.z[:, stock.grid.x < 2.0] = -3.0
    return stock


def mesh_of_3mf(path: Path) -> Mesh:
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        model = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    assert names[0] == "[Content_Types].xml"
    assert model.get("unit") == "millimeter"
    (item,) = model.findall(f"{CORE}build/{CORE}item")
    (body,) = model.findall(f"{CORE}resources/{CORE}object")
    assert item.get("objectid") == body.get("id")
    vertices = [[float(each.get(name, "")) for name in "xyz"] for each in body.iter(f"{CORE}vertex")]
    faces = [
        [int(each.get(name, "")) for name in ("v1", "v2", "v3")] for each in body.iter(f"{CORE}triangle")
    ]
    return Mesh(np.array(vertices), np.array(faces))


@pytest.mark.parametrize(("name", "read"), [("part.3mf", mesh_of_3mf), ("part.STL", read_stl)])
def test_a_reader_finds_the_body_that_was_written(tmp_path: Path, name: str, read) -> None:  # type: ignore[no-untyped-def]
    body, file = step().mesh(), tmp_path / name
    body.write(file)
    first = file.read_bytes()
    found = read(file)
    assert found.volume_mm3 == pytest.approx(body.volume_mm3, rel=1e-6)
    assert found.vertices.min(axis=0) == pytest.approx((-2.0, 3.0, -5.0), abs=1e-4)
    assert found.vertices.max(axis=0) == pytest.approx((7.0, 9.0, 0.0), abs=1e-4)
    edges = np.sort(np.concatenate([found.faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]), axis=1)
    if name.endswith("3mf"):  # closed: each edge belongs to two triangles
        assert set(np.unique(edges, axis=0, return_counts=True)[1].tolist()) == {2}
    body.write(file)
    assert file.read_bytes() == first


def test_another_format_is_refused_and_nothing_is_written(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"\.stl or \.3mf"):
        step().mesh().write(tmp_path / "part.obj")
    assert not list(tmp_path.iterdir())
