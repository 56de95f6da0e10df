"""What body programs are cut from, as their remarks say: ours, and those of CAM systems that say it without doubt."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from polycnc.stock._stock import FARTHEST_MM

_NUMBER = r"([-+]?(?:\d+(?:\.\d*)?|\.\d+))"
_OWN = re.compile(r"^\s*STOCK\s+((?:box|cylinder)\s*=\s*[-+\d., ]+?)\s*$", re.IGNORECASE)
_BLOCK = re.compile(r"^\s*STOCK/BLOCK\s*,(.*)", re.IGNORECASE)
_CORNER = re.compile(
    rf"^\s*stock(Min|Max)\s*:\s*{_NUMBER}(mm|in)\s*,\s*{_NUMBER}\3\s*,\s*{_NUMBER}\3\s*$", re.IGNORECASE
)
_SIZE = re.compile(
    rf"^\s*X\s*=\s*{_NUMBER}\s*,\s*Y\s*=\s*{_NUMBER}\s*,\s*Z\s*=\s*{_NUMBER}\s*$", re.IGNORECASE
)
_TOP = re.compile(r"^\s*Z Origin for Material\s*=\s*(Material Surface|Table Surface)\s*$", re.IGNORECASE)
_ORIGIN = re.compile(r"^\s*XY Origin for Material\s*=\s*([A-Za-z ]+?)\s*$", re.IGNORECASE)
_SHIFT = re.compile(rf"^\s*XY Origin Position\s*=\s*X:\s*{_NUMBER}\s*,\s*Y:\s*{_NUMBER}\s*$", re.IGNORECASE)
_SHARES = {
    "bottom left corner": (0.0, 0.0), "bottom right corner": (1.0, 0.0), "top left corner": (0.0, 1.0),
    "top right corner": (1.0, 1.0), "center": (0.5, 0.5),
}  # fmt: skip
"""Where the origin is in a body, as shares of its size."""
_MM_PER_INCH = 25.4


def stock_of_remarks(remarks: Iterable[str], *, inch: bool = False) -> str | None:
    """Return the body that remarks say, as the text of a form (mm); None where none says it wholly.

    Read are `STOCK box=...`, `STOCK cylinder=...` (mm), `STOCK/BLOCK` with six numbers, `stockMin` with `stockMax`, and
    a size with both origins as Vectric writes it. With `inch` numbers without a unit are inches.
    """
    said, unit = list(remarks), _MM_PER_INCH if inch else 1.0
    for remark in said:
        if found := _OWN.match(remark):
            return re.sub(r"\s+", "", found[1]).lower()
        if (found := _BLOCK.match(remark)) and (body := _block(found[1], unit)):
            return body
    return _corners(said) or _placed(said, unit)


def _corners(said: list[str]) -> str | None:
    """Return the body between two corners."""
    corners = {}
    for found in filter(None, map(_CORNER.match, said)):
        of = _MM_PER_INCH if found[3].lower() == "in" else 1.0
        corners[found[1].lower()] = [of * float(found[i]) for i in (2, 4, 5)]
    return _box(corners["min"], corners["max"]) if len(corners) == 2 else None


def _placed(said: list[str], unit: float) -> str | None:
    """Return the body of a size, whose origin is at its surface or below and at a corner or in the middle."""
    sizes, tops, origins, shifts = (
        next(filter(None, map(each.match, said)), None) for each in (_SIZE, _TOP, _ORIGIN, _SHIFT)
    )
    share = None if origins is None else _SHARES.get(origins[1].lower())
    if sizes is None or tops is None or share is None:
        return None
    size = [unit * float(each) for each in sizes.groups()]
    shift = [0.0, 0.0] if shifts is None else [unit * float(each) for each in shifts.groups()]
    low = [shift[i] - share[i] * size[i] for i in range(2)]
    low.append(-size[2] if tops[1].lower() == "material surface" else 0.0)
    return _box(low, [a + b for a, b in zip(low, size, strict=True)])


def _block(numbers: str, unit: float) -> str | None:
    """Return the body of sizes and of where the origin is from its lowest corner."""
    try:
        found = [unit * float(each) for each in numbers.split(",")]
    except ValueError:
        return None
    if len(found) != 6:
        return None
    low = [-each for each in found[3:]]
    return _box(low, [a + b for a, b in zip(low, found[:3], strict=True)])


def _box(low: list[float], high: list[float]) -> str | None:
    fits = all(-FARTHEST_MM <= a < b <= FARTHEST_MM for a, b in zip(low, high, strict=True))
    if not fits or not all(map(math.isfinite, (*low, *high))):
        return None
    return "box=" + ",".join(f"{each + 0.0:.9g}" for each in (*low, *high))
