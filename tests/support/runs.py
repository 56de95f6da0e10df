"""Program runs in tests: make one, let it come to its end, see where it stands."""

from __future__ import annotations

from typing import Any

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Language, ProgramText, load_dialect
from support.programs import MILL


def program_run(
    program: str | ProgramText,
    config: MachineConfig = MILL,
    *,
    dialect: str = "din",
    language: Language | None = None,
    segments: int = 1 << 16,
    **options: Any,
) -> ProgramRun:
    """Return a run of a program on a machine of its own."""
    text = program if isinstance(program, ProgramText) else ProgramText.from_text(program, "test.nc")
    machine = Machine(config, segments=segments)
    return ProgramRun(machine, text, load_dialect(dialect), options=RunOptions(**options), language=language)


def stands(run: ProgramRun) -> str:
    """Return the name of a run's state."""
    return run.state.name


def to_the_end(run: ProgramRun) -> int:
    """Let a run go on until it stands; return the cycles."""
    cycles = 0
    while run.active:
        cycles += run.advance(100_000)
    return cycles


def undisturbed(program: str | ProgramText, config: MachineConfig = MILL) -> tuple[int, dict[str, float]]:
    """Return cycles and end position of a run that nobody touches."""
    run = program_run(program, config, stands_at_stops=False)
    run.start()
    return to_the_end(run), run.machine.setpoints


def executed_line(run: ProgramRun) -> int:
    """Return the line of the executed block, 0 before the first."""
    block = run.reading.block
    return 0 if block is None else block.line
