"""The power of a laser over a record: what S says with each block, and with M4 in proportion to the speed."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from polycnc.kernel import FEED_MM_S, IS_RAPID
from polycnc.machine import MachineConfig
from polycnc.nc import CONTEXT_SHIFT, BlockRecords

Floats = npt.NDArray[np.float64]

POWER = "power"
"""The name of its column in trace files."""


def powers(rows: Floats, tags: npt.NDArray[np.int64], records: BlockRecords, config: MachineConfig) -> Floats:
    """Return the power [cycles] in units of S for rows of the recorder and the tags of their blocks.

    It is 0 at rapid and after M5; with M3 it stays at S, with M4 it is S times speed over programmed feed.
    """
    starts = np.flatnonzero(np.diff(tags, prepend=~tags[:1]))
    said = np.zeros((len(starts), 3))
    contexts = tags[starts] >> CONTEXT_SHIFT
    begins = np.flatnonzero(np.diff(contexts, prepend=~contexts[:1]))
    for begin, end in pairwise([*begins.tolist(), len(starts)]):
        said[begin:end] = records.laser(tags[starts[begin:end]])
    speed, direction, feed_mm_s = np.repeat(said, np.diff(starts, append=len(tags)), axis=0).T
    follows = np.divide(rows[:, FEED_MM_S], feed_mm_s, out=np.zeros(len(rows)), where=feed_mm_s > 0.0)
    share = np.select([rows[:, IS_RAPID] != 0.0, direction > 0.0, direction < 0.0], [0.0, 1.0, follows], 0.0)
    found: Floats = np.minimum(speed * share, config.spindle.max_rpm)
    return found
