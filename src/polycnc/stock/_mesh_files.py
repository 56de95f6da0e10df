"""Triangles as files: binary STL, and 3MF with its unit (3D Manufacturing Format, core specification)."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.outputs import check_output, complete_or_absent, format_of

Vertices = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]

_EARLIEST = (1980, 1, 1, 0, 0, 0)  # the date of all parts: the same body gives the same bytes
_STRETCH = 50_000
"""How many triangles or places are written at a time."""
_MOST_ZIP32 = 20_000_000
"""Of triangles in a part of an archive without long sizes."""
_ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_TYPES = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">'
    '<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>'
    '<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>'
    "</Types>"
)
_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
    '<Relationship Target="/3D/3dmodel.model" Id="rel0" '
    'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>'
)
_MODEL = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<model unit="millimeter" xml:lang="en-US" '
    'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
    '<resources><object id="1" type="model"><mesh><vertices>%s</vertices>'
    "<triangles>%s</triangles></mesh></object></resources>"
    '<build><item objectid="1"/></build></model>'
)


def write_stl(vertices: Vertices, faces: Faces, path: Path) -> None:
    """Write a binary STL file, a stretch of triangles at a time."""
    with path.open("wb") as file:
        file.write(b"polycnc".ljust(80) + np.uint32(len(faces)).tobytes())
        for first in range(0, len(faces), _STRETCH):
            corners = vertices[faces[first : first + _STRETCH]]
            a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
            normal = np.cross(b - a, c - a)
            length = np.linalg.norm(normal, axis=1, keepdims=True)
            rows = np.zeros(len(corners), _ROW)
            rows["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
            rows["corners"] = corners
            file.write(rows.tobytes())


def write_three_mf(vertices: Vertices, faces: Faces, path: Path) -> None:
    """Write a 3MF file, a stretch at a time; places are rounded to 0.1 micrometre."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (("[Content_Types].xml", _TYPES), ("_rels/.rels", _RELATIONS)):
            archive.writestr(zipfile.ZipInfo(name, _EARLIEST), text, zipfile.ZIP_DEFLATED)
        model = zipfile.ZipInfo("3D/3dmodel.model", _EARLIEST)
        model.compress_type = zipfile.ZIP_DEFLATED
        with archive.open(model, "w", force_zip64=len(faces) > _MOST_ZIP32) as part:
            for text in _model(vertices, faces):
                part.write(text.encode())


def _model(vertices: Vertices, faces: Faces) -> Iterator[str]:
    """Yield the model of a 3MF file in stretches."""
    head, middle, end = _MODEL.split("%s")
    yield head
    for first in range(0, len(vertices), _STRETCH):
        places = np.round(vertices[first : first + _STRETCH], 4).tolist()
        yield "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in places)
    yield middle
    for first in range(0, len(faces), _STRETCH):
        corners = faces[first : first + _STRETCH].tolist()
        yield "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in corners)
    yield end


_FORMATS: dict[str, Callable[[Vertices, Faces, Path], None]] = {".stl": write_stl, ".3mf": write_three_mf}
MESH_FORMATS = tuple(_FORMATS)


def write_mesh(vertices: Vertices, faces: Faces, path: str | Path) -> None:
    """Write triangles to a file that its extension tells the format of, whole or not at all.

    Raises:
        UsageError: another extension, or no such folder.
    """
    target = check_output(path, MESH_FORMATS, "a body")
    with complete_or_absent(target) as partial:
        _FORMATS[format_of(target, MESH_FORMATS)](vertices, faces, partial)
