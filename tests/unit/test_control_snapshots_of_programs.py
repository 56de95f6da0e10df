"""Controls whose programs are under way, in files: put back where they were, or refused whole."""

from __future__ import annotations

import pytest

from polycnc.cnc import Control, ControlSnapshot, Mode, RunState
from polycnc.machine import SnapshotError
from polycnc.nc.macro import MacroLanguage

MAIN = "#100=2\nWHILE[#100LT5]DO1\n#100=#100+1\nM98P7002\nG65P7001A#100\nEND1\nM0\nG1X1.5\nM30\n"
CALLED = "G1X#1Y[#100/4]F3000\nG4X0.05\n#101=#101+#5041\nG1Z-#1\nM99\n"
PLAIN = "G91G1X0.25F2000\nG90\nM99\n"


def made(**changed: str) -> tuple[Control, MacroLanguage]:
    language = MacroLanguage()
    control = Control(dialect="fanuc", languages=[language])
    for name, text in {"O0001": MAIN, "O7001": CALLED, "O7002": PLAIN, **changed}.items():
        control.programs.create(name, text)
    return control, language


def started(**changed: str) -> tuple[Control, MacroLanguage]:
    control, language = made(**changed)
    control.select_program("O0001")
    control.cycle_start()
    return control, language


def end(control: Control, language: MacroLanguage) -> tuple[object, ...]:
    for _ in range(50):
        if control.channels[0].run_state is RunState.PROGRAM_STOP:
            control.cycle_start()
        control.advance(100_000, until=lambda: not control.channels[0].active)
        if control.channels[0].run_state is RunState.COMPLETED:
            break
    variables = language.variables
    run = control.channels[0].run
    assert run is not None
    return (
        control.clock.cycles,
        control.machine.snapshot(),
        variables.get(100),
        variables.get(101),
        run.reading.block,
    )


@pytest.mark.parametrize("cycle", [3, 61, 150, 333, 414, 700, 100_000])
def test_a_control_goes_on_from_a_file_in_another_control(cycle: int) -> None:
    control, language = started()
    control.advance(cycle, until=lambda: not control.channels[0].active)
    content = control.snapshot().to_bytes()
    status = control.status()
    wanted = end(control, language)
    assert control.channels[0].run_state is RunState.COMPLETED
    other, second = made()
    other.restore(ControlSnapshot.from_bytes(content))
    assert other.snapshot() == ControlSnapshot.from_bytes(content)
    assert other.snapshot().to_bytes() == content
    assert other.status() == status
    assert end(other, second) == wanted
    control.restore(ControlSnapshot.from_bytes(content))
    assert end(control, language) == wanted


def test_a_control_in_the_middle_of_another_program_goes_back() -> None:
    control, language = started()
    control.advance(150)
    snapshot = control.snapshot()
    wanted = end(control, language)
    control.select_mode(Mode.MDI)
    control.set_mdi("#101=77\n#1=8\nG4X9.\n")
    control.cycle_start()
    control.advance(40)
    control.restore(snapshot)
    assert control.mode is Mode.AUTO
    assert end(control, language) == wanted


def test_a_program_that_was_edited_since_is_refused_before_anything_changes() -> None:
    control, _ = started()
    control.advance(150)
    snapshot = control.snapshot()
    for name, text in (("O7001", CALLED.replace("#101+", "#101-")), ("O0001", MAIN.replace("LT5", "LT6"))):
        other, language = started(**{name: text})
        other.advance(30)
        before = other.snapshot()
        variables = language.variables.saved(lasting=True)
        with pytest.raises(SnapshotError, match=f"{name} has been changed"):
            other.restore(snapshot)
        assert other.snapshot() == before
        assert language.variables.saved(lasting=True) == variables


def test_a_control_without_the_language_refuses_and_is_as_it_was() -> None:
    control, _ = started()
    control.advance(150)
    other = Control(dialect="fanuc", languages=(None,))
    before = other.snapshot()
    with pytest.raises(SnapshotError):
        other.restore(control.snapshot())
    assert other.snapshot() == before
