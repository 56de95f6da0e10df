"""Rehearse a program with statements: it runs in a copy of its control's folder, to see the motion that it makes."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.errors import PolycncError
from polycnc.machine import Machine, MachineConfig
from polycnc.nc import Dialect, ProgramText
from polycnc.runner._execution import run_to_end
from polycnc.runner._program_control import Surroundings, control_for
from polycnc.runner._remarks import MachiningWatch, Remark

MOST_FILES = 500
MOST_BYTES = 32 << 20
"""A folder with more is not copied, and a program in it not rehearsed."""
_LOOP_LIMIT_S = 1.0


def rehearsed(program: ProgramText, config: MachineConfig, dialect: Dialect, root: Path) -> list[Remark]:
    """Return what a machinist would remark on the motion of a program, as far as it comes without keys and inputs."""
    with _copy(root) as folder:
        if folder is None:
            return []
        machine = Machine(config)
        control = control_for(dialect, program, machine, Surroundings(folder))
        assert control is not None
        run = ProgramRun(
            machine,
            program,
            dialect,
            options=RunOptions(stands_at_stops=False),
            language=control.language,
            config=control.config,
        )
        control.attach(run)
        watch = MachiningWatch(run.channel)
        run.channel.on_filled = watch.look
        try:
            run_to_end(run, every_cycle=False, control=control, loop_limit_s=_LOOP_LIMIT_S)
            control.finish()
        except PolycncError:
            pass  # it waits for what only a real run has: what came before is seen
        return watch.remarks


@contextmanager
def _copy(root: Path) -> Iterator[Path | None]:
    """Yield a copy of a folder that is removed behind, None if it is too large or cannot be read."""
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
