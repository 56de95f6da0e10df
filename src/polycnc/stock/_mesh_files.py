"""Triangles as files: binary STL, and 3MF with its unit (3D Manufacturing Format, core specification)."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

from polycnc.outputs import check_output, complete_or_absent, format_of

Vertices = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]

_EARLIEST = (1980, 1, 1, 0, 0, 0)  # the date of all parts: the same body gives the same bytes
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


def stl(vertices: Vertices, faces: Faces) -> bytes:
    """Return a binary STL file."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    rows = np.zeros(len(faces), row)
    rows["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0.0)
    rows["corners"] = np.stack((a, b, c), axis=1)
    return b"polycnc".ljust(80) + np.uint32(len(rows)).tobytes() + rows.tobytes()


def three_mf(vertices: Vertices, faces: Faces) -> bytes:
    """Return a 3MF file; places are rounded to 0.1 micrometre."""
    places = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in np.round(vertices, 4).tolist())
    corners = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces.tolist())
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in (
            ("[Content_Types].xml", _TYPES),
            ("_rels/.rels", _RELATIONS),
            ("3D/3dmodel.model", _MODEL % (places, corners)),
        ):
            archive.writestr(zipfile.ZipInfo(name, _EARLIEST), text, zipfile.ZIP_DEFLATED)
    return packed.getvalue()


_FORMATS: dict[str, Callable[[Vertices, Faces], bytes]] = {".stl": stl, ".3mf": three_mf}
MESH_FORMATS = tuple(_FORMATS)


def write_mesh(vertices: Vertices, faces: Faces, path: str | Path) -> None:
    """Write triangles to a file that its extension tells the format of, whole or not at all.

    Raises:
        UsageError: another extension, or no such folder.
    """
    target = check_output(path, MESH_FORMATS, "a body")
    data = _FORMATS[format_of(target, MESH_FORMATS)](vertices, faces)
    with complete_or_absent(target) as partial:
        partial.write_bytes(data)
