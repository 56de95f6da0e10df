"""Rehearse a program with statements: it runs in a copy of its control's folder, to see the motion that it makes."""

from __future__ import annotations

import logging
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import takewhile
from pathlib import Path
from typing import NamedTuple

from polycnc.cnc import RunOptions, let_pass
from polycnc.errors import PolycncError, ProgramError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Dialect, ProgramText
from polycnc.runner._execution import Progress, run_to_end
from polycnc.runner._program_control import Surroundings, control_for, run_under
from polycnc.runner._remarks import MachiningWatch, Remark

MOST_FILES = 500
MOST_BYTES = 32 << 20
"""A folder with more is not copied, and a program in it not rehearsed."""
_LOOP_LIMIT_S = 1.0
_LOG = logging.getLogger(__name__)


class Rehearsal(NamedTuple):
    """What a rehearsal has found: blocks that are wrong, and what a machinist would remark on the motion."""

    errors: list[ProgramError]
    remarks: list[Remark]


def rehearsed(
    program: ProgramText,
    config: MachineConfig,
    dialect: Dialect,
    root: Path,
    progress: Progress | None = None,
) -> Rehearsal:
    """Return what is wrong with the blocks of a program and remarked on it, as far as it comes without keys and inputs.

    Where it ends early, and that it has not been rehearsed at all, is logged.
    """
    with _copy(root) as folder:
        if folder is None:
            _LOG.warning(
                "%s: not rehearsed: %s cannot be copied, or holds more than %d files or %d MB",
                program.name, root, MOST_FILES, MOST_BYTES >> 20,
            )  # fmt: skip
            return Rehearsal([], [])
        machine = Machine(config)
        control = control_for(dialect, program, machine, Surroundings(folder))
        assert control is not None
        options = RunOptions(stands_at_stops=False, collect_errors=True)
        run = run_under(control, machine, program, dialect, options, on_passed=let_pass)
        watch = MachiningWatch(run.channel)
        errors = run.channel.errors

        def look() -> None:
            watch.look()
            if any(map(_is_of_a_statement, errors)):
                run.channel.close()

        run.channel.on_filled = look
        ended: PolycncError | None = None
        try:
            run_to_end(run, every_cycle=False, progress=progress, control=control, loop_limit_s=_LOOP_LIMIT_S)
            control.finish()
        except PolycncError as error:
            ended = error
        wrong = list(takewhile(lambda each: not _is_of_a_statement(each), errors))
        ended = next(filter(_is_of_a_statement, errors), ended)
        if ended is not None:
            _LOG.warning("%s", _as_far_as(ended, program))
        return Rehearsal(wrong, watch.remarks)


def _is_of_a_statement(error: ProgramError) -> bool:
    """Tell whether a statement has failed: what it reads decides that, and in a real run it may read something else."""
    return error.__cause__ is not None


def _as_far_as(error: PolycncError, program: ProgramText) -> str:
    place = error.position if isinstance(error, ProgramError) else None
    return f"{program.name if place is None else place}: rehearsed up to here: {error.what}"


@contextmanager
def _copy(root: Path) -> Iterator[Path | None]:
    """Yield a copy of a folder that is removed after, None if it is too large or cannot be read."""
    files: list[Path] = []
    size = 0
    for folder, _, names in os.walk(root):
        for name in names:
            path = Path(folder, name)
            if path.is_symlink() or not path.is_file():
                continue
            files.append(path)
            size += path.stat().st_size
            if len(files) > MOST_FILES or size > MOST_BYTES:
                yield None
                return
    with tempfile.TemporaryDirectory(prefix="polycnc-") as scratch:
        try:
            for path in files:
                target = Path(scratch, path.relative_to(root))
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, target)
        except OSError:
            yield None
            return
        yield Path(scratch)
