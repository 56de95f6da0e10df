"""Random programs with parameters and O-words through polycnc and through LinuxCNC's `rs274`: the same moves."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ProgramText, language_for, load_dialect
from support import rs274
from support.canonical import Feed, Step, Traverse, first_difference, queued_steps
from support.often import often, share
from support.random_o_words import RandomProgram

pytestmark = pytest.mark.skipif(rs274.COMMAND is None, reason="rs274 (LinuxCNC) is not installed")

TOLERANCE_MM = 2e-4  # rs274 prints four decimals


def _config() -> MachineConfig:
    axes = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 2000\n' for name in "XYZ")
    return validate(MachineConfig, *parse_toml(f'name = "endless"\n{axes}', "endless.toml"))


CONFIG = _config()
DIALECT = load_dialect("din").model_copy(update={"language": "rs274"})


def prepare(program: str) -> tuple[list[Step], ProgramError | None]:
    """Return what polycnc queues for a program, and what it refuses."""
    machine = Machine(CONFIG, segments=1 << 14)
    channel = Channel(ProgramText.from_text(program), DIALECT, machine, language=language_for(DIALECT))
    give_to_path(machine.state, channel.path)
    for _ in range(100):
        channel.fill()
        if channel.done:
            break
        machine.clock.tick(1)  # so much is prepared in one cycle
    assert channel.done
    return queued_steps(machine, channel), channel.error


def printed(steps: list[Step]) -> list[Step]:
    """Return the steps without moves that four decimals do not show."""
    kept: list[Step] = []
    at: tuple[float, ...] = (0.0, 0.0, 0.0)
    for step in steps:
        if isinstance(step, Traverse | Feed) and math.dist(step.end, at) <= TOLERANCE_MM:
            continue
        at = step.end if isinstance(step, Traverse | Feed) else at
        kept.append(step)
    return kept


def compare(seed: int, folder: Path) -> str:
    """Return how a random program differs between the two; '' if it does not."""
    program = RandomProgram(seed).text()
    theirs = rs274.interpret(program, folder)
    ours, error = prepare(program)
    if bool(error) != bool(theirs.error):
        return f"seed {seed}: refused\n  ours   {error}\n  theirs {theirs.error}: {theirs.block}\n{program}"
    if error is not None:
        return ""
    found = first_difference(
        printed(ours), printed(rs274.canonical_steps(theirs, 3, 1.0)), 2.0 * TOLERANCE_MM
    )
    return f"seed {seed}: {found}\n{program}" if found else ""


BY_NUMBER = (
    "#1=5\nM98 P100 L3\nG0 Z#1\nM2\no100\n#1=[#1+1]\nG0 X#1 Y#<_call_level>\nM99\n",
    "G0X1\nM98 P100\nG0X3\no100\nG0 Y2\nM99\nG0X5\nM2\n",
    "o100\nG0 Y2\nM99\no1\nG0X1\nM98 P100\nG0X3\nM2\n",
    "/M98 P100\nG0Y1\nM2\no100\nG0 X3\n/M99\nG0Z1\nM99\n",
    "N10 M98 P100 (remark)\nG0Z4\nM2\no100\nG0 X3\nN30M99(remark)\n",
    "M98 P100\nG0Z7\nM2\no100\nG0 X3\no5 call [2]\nM99\no5 sub\nG0Z#1\no5 endsub\n",
    "o5 sub\nM98 P100\nG0 Y#1\no5 endsub\no5 call [6]\nG0X9\nM2\no100\nG0 X3 Z#1\n#1=2\nM99\n",
    "M98 P100\nG0X9\nM2\no100\nG0 X3\no100\nG0Y9\nM99\n",
    "o9 while [#3 LT 2]\n#3=[#3+1]\nM98 P100\no9 endwhile\nM2\no100\no8 repeat[2]\nG0X[#5420+1]\no8 endrepeat\nM99\n",
    "M98 P100\nM2\no100\nG0X[#<_call_level>+4]\nM98 P200\nG0 Z3\nM99\no200\nG0Y#<_call_level>\nM99\n",
    "M98 P100\nM2\no100\nG0 X1\no60 if [#7 eq 0]\nM99\no60 endif\nG0X2\nM99\n",
    "G0 X4\nM98 P7\nM2\n",
    "M98 P100 L1.5\nM2\no100\nG0X1\nM99\n",
    "o1 sub\nG0X1\nM99\no1 endsub\no1 call\nM2\n",
)
"""Programs with M98 and M99."""


@pytest.mark.parametrize("program", BY_NUMBER)
def test_sub_programs_by_number_ask_for_the_same_moves(program: str, tmp_path: Path) -> None:
    theirs = rs274.interpret(program, tmp_path)
    ours, error = prepare(program)
    assert bool(error) == bool(theirs.error), (error, theirs.error)
    if error is None:
        assert not first_difference(ours, rs274.canonical_steps(theirs, 3, 1.0), TOLERANCE_MM)


@pytest.mark.parametrize("first", often(range(0, 200, 50), 2))
def test_random_o_words_ask_for_the_same_moves(first: int, tmp_path: Path) -> None:
    found = [text for seed in range(first, first + share(50)) if (text := compare(seed, tmp_path))]
    assert not found, f"{len(found)}\n" + "\n\n".join(found[:2])


@pytest.mark.long
@pytest.mark.parametrize("first", range(10_000, 15_000, 500))
def test_many_random_o_words_ask_for_the_same_moves(first: int, tmp_path: Path) -> None:
    found = [text for seed in range(first, first + 500) if (text := compare(seed, tmp_path))]
    assert not found, f"{len(found)} of 500\n" + "\n\n".join(found[:2])
