"""Turn points about a direction, each by its own angle."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Triple = tuple[float, float, float]


def turned(points: Floats, direction: Triple, angles_deg: Floats, center: Triple = (0.0, 0.0, 0.0)) -> Floats:
    """Return points [n, 3] turned about a line through `center` by the right-hand rule, each by its angle [n]."""
    x, y, z = np.asarray(direction) / np.linalg.norm(direction)
    skew = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
    angles = np.radians(angles_deg)[:, None]
    off: Floats = points - center
    once: Floats = off @ skew.T
    twice: Floats = once @ skew.T
    found: Floats = points + np.sin(angles) * once + (1.0 - np.cos(angles)) * twice
    return found
