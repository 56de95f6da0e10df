"""Blocks on a path: the next one, the last prepared one, one that is searched; a refusal leaves the path as it was."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from polycnc.cnc._control_data import Search
from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._run_state import RunState
from polycnc.errors import UsageError
from polycnc.kernel import READY
from polycnc.machine import Machine
from polycnc.nc import BlockRecord, IncomingText, ProgramText


def next_block(machine: Machine, run: ProgramRun) -> BlockRecord | None:
    """Return the block that comes next where a path stands between two blocks; None where none is known."""
    if machine.state.paths.row[run.path]["state"] != READY:
        return None
    tag = run.feed.blocks.next_tag()
    return None if tag is None else run.channel.records.block(tag)


def prepared_block(machine: Machine, run: ProgramRun) -> BlockRecord | None:
    """Return the block that was prepared last of those whose motion is queued; the executed one where none is."""
    row = machine.state.paths.row[run.path]
    if row["tail"] <= row["head"]:
        return run.reading.block
    last = int(row["base"]) + (int(row["tail"]) - 1) % int(row["capacity"])
    return run.channel.records.block(int(machine.state.seg.row[last]["tag"])) or run.reading.block


def find_block(run: ProgramRun, search: Search) -> int:
    """Let a run begin at the block of a search; return its line.

    Raises:
        ControlError: There is none, or the program cannot begin there.
    """
    try:
        return run.selection.search(
            line=search.line, sequence=search.sequence, calculate=search.calculate, last=search.last
        )
    except UsageError as error:
        raise ControlError(Refusal.NOT_FOUND, error.what, hint=error.hint) from error


def stands_ready(run: ProgramRun, text: ProgramText, is_sought: bool) -> bool:
    """Tell whether a run has a text, and is before a block that was searched or at the beginning of what comes."""
    if run.program is not text or run.state is not RunState.READY:
        return False
    return isinstance(text, IncomingText) or (is_sought and run.channel.holds_searched)


@contextmanager
def unless_refused(machine: Machine, path: int, run: ProgramRun | None) -> Iterator[None]:
    """Let a refusal within leave a run and its path as they were."""
    state = machine.state
    arrays = (state.owner, *(each[path] for each in (state.paths.position, state.paths.queued)))
    kept = [each.copy() for each in arrays]
    row = state.paths.row[path : path + 1]
    kept_row = row.copy()
    try:
        saved = None if run is None else run.snapshot()
    except UsageError:  # a language has executed it: it stands at its beginning then
        saved = None
    try:
        yield
    except ControlError:
        row[:] = kept_row
        for each, content in zip(arrays, kept, strict=True):
            each[:] = content
        if run is not None and saved is not None:
            run.restore(saved)
        raise
