"""The control that executes the language of a program, where it holds more than NC blocks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from polycnc.cnc import OnPassed, ProgramRun, RunOptions
from polycnc.errors import UsageError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Dialect, Event, ProgramText, language_for
from polycnc.outputs import check_output

if TYPE_CHECKING:
    from polycnc.controllers.bosch import ChannelHost, DebuggedPnc

RowsWithTags = Callable[[npt.NDArray[np.float64], npt.NDArray[np.int64]], None]
OnEvent = Callable[[Event], bool | None]


@dataclass(frozen=True)
class Surroundings:
    """Where a program runs: the control's root, the keys that are pressed, the blocks that are left out."""

    root: Path
    keys: tuple[str, ...] = ()
    skip_levels: frozenset[int] = frozenset()


def control_for(
    dialect: Dialect, program: ProgramText, machine: Machine, surroundings: Surroundings
) -> ChannelHost | None:
    """Return the control that executes a program's language, None if it holds NC blocks only."""
    make = _CONTROLS.get(dialect.language)
    return None if make is None else make(program, machine, surroundings)


def run_under(
    control: ChannelHost | None,
    machine: Machine,
    program: ProgramText,
    dialect: Dialect,
    options: RunOptions,
    *,
    root: Path | None = None,
    rows: RowsWithTags | None = None,
    on_event: OnEvent | None = None,
    on_passed: OnPassed | None = None,
) -> ProgramRun:
    """Return the run of a program under the control that executes its language, None for NC blocks and macros."""
    run = ProgramRun(
        machine,
        program,
        dialect,
        language=language_for(dialect, () if root is None else (root,))
        if control is None
        else control.language,
        config=None if control is None else control.config,
        options=options,
        rows=rows,
        on_event=on_event,
        on_passed=on_passed,
    )
    if control is not None:
        control.attach(run)
    return run


def has_control(dialect: Dialect) -> bool:
    """Say whether a control executes the language of a dialect, whose programs may read and write its files."""
    return dialect.language in _CONTROLS


def root_of(program: str | Path | ProgramText, root: str | Path | None) -> Path:
    """Return the root of the control: a folder that is given, else that of the program.

    Raises:
        UsageError: There is no such folder.
    """
    if root is None:
        name = program.name if isinstance(program, ProgramText) else str(program)
        is_text = "\n" in name or "\r" in name
        return Path.cwd() if is_text else Path(name).parent
    if not Path(root).is_dir():
        raise UsageError(f"no such folder: {root}", hint="Make it first; it holds the files of the control.")
    return Path(root)


MOST_KEYS_BYTES = 1_000_000


def read_keys(path: str | Path) -> tuple[str, ...]:
    """Read the keys that are pressed, one a line.

    Raises:
        UsageError: The file cannot be read, or is longer than a million bytes.
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(MOST_KEYS_BYTES + 1)
        if len(content) > MOST_KEYS_BYTES:
            raise UsageError(
                f"{path} holds more than {MOST_KEYS_BYTES:,} bytes of keys", hint="Write one key a line."
            )
        lines = content.decode("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"no keys can be read from {path}: {error}", hint="Write one key a line.") from None
    return tuple(line if line == " " else line.strip() for line in lines if line)


def _cpl(program: ProgramText, machine: Machine, surroundings: Surroundings) -> ChannelHost | None:
    from polycnc.controllers.bosch import BoschSystem, ChannelHost

    return ChannelHost(
        BoschSystem(surroundings.root, machine.clock, machine.config),
        program=program.name,
        keys=surroundings.keys,
        skip_levels=surroundings.skip_levels,
    )


def statements_for(
    dialect: Dialect, program: ProgramText, machine: MachineConfig, root: Path
) -> DebuggedPnc | None:
    """Return the control for a debugger of a program with statements, None if it holds NC blocks only."""
    from polycnc.nc.cpl import holds_cpl

    if dialect.language != "cpl" or not holds_cpl(program.content):
        return None
    from polycnc.controllers.bosch import DebuggedPnc

    return DebuggedPnc(root, machine)


_CONTROLS: dict[str, Callable[[ProgramText, Machine, Surroundings], ChannelHost | None]] = {"cpl": _cpl}
"""The controls by the language that a dialect names."""


SCREEN_FORMATS = (".txt", ".svg", ".png")


def check_screen_file(path: str | Path, program: ProgramText, control: ChannelHost | None) -> None:
    """Check that the screen of a program can be kept under a name.

    Raises:
        UsageError: The program shows nothing, no format has this ending, or the place is wrong.
    """
    target = check_output(path, SCREEN_FORMATS, "a screen")
    if control is None or not control.has_statements(program):
        raise UsageError(
            f"{program.name} has no screen: it holds NC blocks only",
            hint="Leave --screen out, or name the dialect of a control with a language (bosch).",
        )
    if target.resolve() == Path(program.name).resolve():
        raise UsageError(
            f"a screen cannot be written to {path}: it is the program", hint="Take another name."
        )
    if target.suffix.lower() == ".png" and find_spec("matplotlib") is None:
        raise UsageError(
            "a screen as .png needs matplotlib",
            hint="Install it: pip install 'polycnc[plot]'; .svg needs nothing.",
        )
