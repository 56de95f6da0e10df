"""Random lathe profiles with G70 to G72 through polycnc and through LinuxCNC's `rs274`: the same moves and refusals."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ProgramText, language_for, load_dialect
from support import rs274
from support.canonical import Feed, Step, Traverse, Turn, first_difference, queued_steps
from support.often import share
from support.random_profiles import profile_program

pytestmark = pytest.mark.skipif(rs274.COMMAND is None, reason="rs274 (LinuxCNC) is not installed")

TOLERANCE_MM = 0.01  # rs274 prints four decimals of an inch
LEAST_MM = 2e-4
AXES = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 2000\n' for name in "XYZ")
CONFIG = validate(MachineConfig, *parse_toml(f'name = "endless"\n{AXES}', "endless.toml"))
DIALECT = load_dialect("linuxcnc")


def prepare(program: str) -> tuple[list[Step], ProgramError | None]:
    """Return what polycnc queues for a program, and what it refuses."""
    machine = Machine(CONFIG, segments=1 << 12)
    channel = Channel(ProgramText.from_text(program), DIALECT, machine, language=language_for(DIALECT))
    give_to_path(machine.state, channel.path)
    for _ in range(100):
        channel.fill()
        if channel.done:
            break
        machine.clock.tick(1)
    assert channel.done
    return queued_steps(machine, channel), channel.error


def difference(program: str, folder: Path) -> str | None:
    """Return how a program differs between the two, '' if it does not, None where both refuse it."""
    ours, error = prepare(program)
    if error is not None and "more than 100000 cuts" in error.what:
        return None  # rs274 cuts for ever
    theirs = rs274.interpret(program, folder)
    if error is not None and theirs.error:
        return None
    if error is not None or theirs.error:
        return f"refused\n  ours   {error}\n  theirs {theirs.error}: {theirs.block}"
    steps = rs274.canonical_steps(theirs, 3, scale=1, least_mm=LEAST_MM)
    return first_difference(ours, steps, TOLERANCE_MM)


def test_random_profiles_are_cut_alike(tmp_path: Path) -> None:
    found = [(seed, difference(profile_program(seed), tmp_path)) for seed in range(share(60))]
    differing = [f"seed {seed}: {what}\n{profile_program(seed)}" for seed, what in found if what]
    assert not differing, "\n".join(differing[:2])
    assert sum(what == "" for _, what in found) > len(found) / 4


@pytest.mark.parametrize(
    "words",
    [
        "G71 Q1 X15 Z2 D0.5 I1.5",
        "G7\nG71 Q1 X30 Z2 I1",
        "G20 G70 Q1 X15 Z2 P2 D.5",
        "G91\nG71.1 Q2",
        "G90.1 G70 Q1 Z3",
        "G71.1 Q1 X15 Z4\nX20",
        "G55 G71 Q1 X15 Z2\nZ-4",
    ],
)
def test_modes_in_force_count_in_a_profile(words: str, tmp_path: Path) -> None:
    """Modal codes, positions that a profile asks for, loops and settings in it."""
    program = (
        "G61 G21 G18 F300\nG10 L2 P2 X1 Z2\nG0 X10 Z1\nO1 SUB\nG0 X2 Z0.5\n#1=3\n"
        "O2 REPEAT [2]\nG1 X[#<_x>+1] Z[#<_z>-#1]\n#1=[#1-1]\nO2 ENDREPEAT\n"
        f"G3 X[#<_x>+2] Z[#<_z>-2] R3\nG1 Z[#<_z>-1]\nO1 ENDSUB\n"
        f"O2 SUB\nG0 X-9\nG1 Z-3\nG2 X2 Z-2 I2 K0\nG1 X1 Z-1\nO2 ENDSUB\n{words}\nM2\n"
    )
    ours, error = prepare(program)
    assert error is None
    found = difference(program, tmp_path)
    assert found is not None
    assert {type(step) for step in ours} == {Traverse, Feed, Turn}
    assert not found
