"""A program that begins anew leaves nothing of the channel before behind, which holds large arrays."""

from __future__ import annotations

import gc
import weakref

import pytest

from polycnc.cnc import Control, Mode, RunState
from polycnc.nc import ProgramText

PROGRAMS = {
    "din": "G1 X1 F60000\nM30\n",
    "fanuc": "O1\n#1=0\nWHILE[#1LT3]DO1\nG1 X#1 F60000\n#1=#1+1\nEND1\nM30\n",
    "linuxcnc": "o100 sub\nG1 X1 F60000\no100 endsub\no100 call\nM2\n",
    "bosch": "N20 G1 X1 F60000\nN30 M30\n",
}


@pytest.mark.parametrize("dialect", PROGRAMS)
def test_the_channel_before_goes_at_once(dialect: str) -> None:
    control = Control("mill3", dialect=dialect)
    control.select_program(ProgramText.from_text(PROGRAMS[dialect], "part.nc"))
    control.select_mode(Mode.AUTO)
    left = []
    gc.disable()
    try:
        for _ in range(3):
            control.cycle_start()
            run = control.channels[0].run
            assert run is not None
            left.append(weakref.ref(run.channel))
            while control.channels[0].run_state is RunState.ACTIVE:
                control.advance(1000)
            assert control.channels[0].run_state is RunState.COMPLETED
            control.status()
    finally:
        gc.enable()
    assert [each() for each in left[:-1]] == [None, None]
