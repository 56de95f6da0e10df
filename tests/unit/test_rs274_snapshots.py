"""Controls with programs of RS274/NGC under way, in files: put back where they were, to the same bits."""

from __future__ import annotations

import pytest

from polycnc.cnc import Control, ControlSnapshot, RunState
from polycnc.machine import SnapshotError
from polycnc.nc import Language, language_for, load_dialect
from support.often import often

PROGRAM = """o<part> sub
#<depth> = [#1 / 4]
#7 = [#2 + #<depth>]
o10 do
#7 = [#7 - 1.5]
G1 X#7 Y[#1 + #<depth>] F3000
o11 if [#7 lt 3]
o10 continue
o11 elseif [#7 lt 5]
(debug,at #7)
o11 endif
G38.3 Z[-7 - #7]
#<_sum> = [#<_sum> + #5063 / 64]
o10 while [#7 gt 0]
o<part> endsub [#7 * 10]
G21 G61
#<_sum> = 0
o1 repeat [2]
o2 while [#100 lt 3]
#100 = [#100 + 1] #<_sum> = [#<_sum> + #100]
o<part> call [#100] [6.25]
G0 X[#<_value> / 8] Z#<_value_returned>
o2 endwhile
#100 = 1
G43.1 Z[#<_sum> / 16]
G92 X1.25
o1 endrepeat
o3 if [EXISTS[#<depth>]]
G0 X99
o3 else
G1 Y#<_sum> F2500
G2 X#5420 Y[#<_sum> + 3] J1.5
o3 endif
M2
"""


def made(text: str = PROGRAM) -> tuple[Control, Language]:
    language = language_for(load_dialect("linuxcnc"))
    assert language is not None
    control = Control(dialect="linuxcnc", languages=[language])
    control.programs.create("part.ngc", text)
    return control, language


def started() -> Control:
    control, _ = made()
    control.select_program("part.ngc")
    control.cycle_start()
    return control


def end(control: Control) -> tuple[object, ...]:
    control.advance(200_000, until=lambda: not control.channels[0].active)
    run = control.channels[0].run
    assert run is not None
    return control.clock.cycles, control.channels[0].run_state, control.machine.snapshot(), run.reading.block


@pytest.mark.parametrize("cycle", often([1, 333, 1007, 1804, 2450, 3300], 3))
def test_a_program_goes_on_from_any_cycle_in_another_control(cycle: int) -> None:
    control = started()
    control.advance(cycle)
    assert control.channels[0].active
    content = control.snapshot().to_bytes()
    wanted = end(control)
    assert wanted[1] is RunState.COMPLETED
    other, _ = made()
    other.restore(ControlSnapshot.from_bytes(content))
    assert other.snapshot().to_bytes() == content
    assert end(other) == wanted
    control.restore(ControlSnapshot.from_bytes(content))
    assert end(control) == wanted


def test_what_programs_have_set_is_there_again_behind_them() -> None:
    control = started()
    assert end(control)[1] is RunState.COMPLETED
    content = control.snapshot().to_bytes()
    other, _ = made()
    other.programs.create("more.ngc", "G0 X[#100 + #<_sum> / 3]\nM2\n")
    other.restore(ControlSnapshot.from_bytes(content))
    assert other.snapshot().to_bytes() == content


def test_a_changed_program_is_refused_and_nothing_has_changed() -> None:
    control = started()
    control.advance(333)
    content = control.snapshot().to_bytes()
    other, _ = made(PROGRAM.replace("6.25", "6.5"))
    before = other.snapshot().to_bytes()
    with pytest.raises(SnapshotError):
        other.restore(ControlSnapshot.from_bytes(content))
    assert other.snapshot().to_bytes() == before
