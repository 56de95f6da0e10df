"""The recorder: rows come in order, and a full buffer is never written beyond."""

from __future__ import annotations

import numpy as np

from polycnc.kernel import advance, make_state
from polycnc.kernel._recorder import TIME_S


def test_a_full_recorder_keeps_its_rows_when_nobody_empties_it() -> None:
    state = make_state(1, record_cycles=4)
    assert advance(state, 10) == 10  # nothing asked it to stop
    assert state.recorder.filled[0] == 4
    np.testing.assert_allclose(state.recorder.rows[:, TIME_S], [0.001, 0.002, 0.003, 0.004])
    state.recorder.filled[0] = 0
    advance(state, 1)
    assert state.recorder.filled[0] == 1
    assert state.recorder.rows[0, TIME_S] == 11 * 0.001
