"""Everything that a program run holds at one cycle, as plain data: to compare, to write to a file, to go back to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, Self, TypeAlias

from polycnc.cnc._path_feed import FeedSnapshot
from polycnc.cnc._path_runner import PathRunner
from polycnc.cnc._probing import Probing
from polycnc.cnc._run_channels import RunChannels
from polycnc.cnc._run_progress import RunProgress
from polycnc.cnc._run_state import RunAlarm, RunState
from polycnc.cnc._stops import Step
from polycnc.cnc._tool_times import ToolTime, ToolTimes
from polycnc.errors import UsageError
from polycnc.machine import Snapshot, SnapshotError, Values, damaged_snapshot, described
from polycnc.nc import (
    CHANNEL_CLASSES,
    ChannelSnapshot,
    IncomingText,
    Language,
    LastingLanguage,
    ProgramText,
    Texts,
)

DEVICE = "program run"
FindText: TypeAlias = Callable[[str], ProgramText | None]
"""What gives the present text of a program of a name, None where there is none."""


class SavedRun(NamedTuple):
    """What a run holds; its machine has a snapshot of its own, breakpoints are the operator's."""

    program: ProgramText
    channel: ChannelSnapshot
    feed: FeedSnapshot
    step: Step
    depth: int
    override_kept: float | None
    moment: RunProgress


_CLASSES = (
    *CHANNEL_CLASSES,
    FeedSnapshot,
    Probing,
    RunAlarm,
    RunProgress,
    RunState,
    SavedRun,
    Step,
    ToolTime,
    ToolTimes,
)


@dataclass(frozen=True, slots=True)
class RunSnapshot(Snapshot):
    """The snapshot of a program run: where program and language stand, with the texts of the programs under way."""

    @classmethod
    def of(
        cls, made_from: str, cycle: int, saved: SavedRun, language: Language | None, find: FindText
    ) -> Self:
        """Keep what a run holds; `find` tells which of its texts can be found where it was made.

        Raises:
            SnapshotError: Something of it cannot be kept.
        """
        texts = Texts()
        run = _values(texts, language).plain(saved)
        kept = [[text.name, text.content, _is_found(text, find), text.first_line] for text in texts.all]
        return cls.take(DEVICE, made_from, cycle, (), {"texts": kept, "run": run})

    @classmethod
    def of_any(cls, snapshot: Snapshot) -> Self:
        """Return a snapshot as that of a run."""
        return cls(snapshot.device, snapshot.made_from, snapshot.cycle, snapshot.blocks, snapshot.beside)

    def saved(self, language: Language | None, find: FindText) -> SavedRun:
        """Return what the run held.

        Raises:
            SnapshotError: It is damaged, of another language, or a program has been changed since.
        """
        data = self.data()
        try:
            rows: Sequence[Any] = data["texts"]
            texts = [ProgramText(str(name), bytes(content), int(line)) for name, content, _, line in rows]
            changes = [
                str(name) for name, content, found, _ in rows if found and _is_changed(name, content, find)
            ]
            plain = data["run"]
        except (LookupError, TypeError, ValueError) as error:
            raise damaged_snapshot(error) from error
        if changes:
            raise SnapshotError(
                f"{changes[0]} has been changed since the snapshot was taken",
                hint="put the program back as it was, or use another snapshot",
            )
        saved = _values(Texts(texts), language).value(plain)
        if not isinstance(saved, SavedRun) or not saved.channel.calls:
            raise damaged_snapshot("there is no run in it")
        return saved


def file_text(name: str) -> ProgramText | None:
    """Return the program that lies in a file."""
    try:
        return ProgramText.from_path(name) if Path(name).is_file() else None
    except (UsageError, OSError, ValueError):
        return None


def _values(texts: Texts, language: Language | None) -> Values:
    more = language.classes if isinstance(language, LastingLanguage) else ()
    return Values((*_CLASSES, *more), texts.forms())


def _is_found(text: ProgramText, find: FindText) -> bool:
    found = find(text.name)
    return found is not None and found.content == text.content


def _is_changed(name: str, content: bytes, find: FindText) -> bool:
    found = find(name)
    return found is not None and found.content != content


class RunGoingBack:
    """Keep what a run holds, and give it back; `first` is the program that it was made with."""

    def __init__(self, runner: PathRunner, channels: RunChannels, first: ProgramText) -> None:
        self._runner = runner
        self._channels = channels
        self._first = first

    def snapshot(self, program: ProgramText, find: FindText) -> RunSnapshot:
        """Return what the run of `program` holds.

        Raises:
            SnapshotError: The program is still coming, or its language cannot tell where it is.
        """
        runner = self._runner
        if isinstance(program, IncomingText):
            if not runner.channel.done:
                raise SnapshotError(
                    "a program that is still coming is under way",
                    hint="Take the snapshot before or after it.",
                )
            program = ProgramText(program.name, b"")
        saved = SavedRun(
            program,
            runner.channel.snapshot(),
            runner.feed.snapshot(),
            runner.stopper.step,
            runner.stopper.depth,
            runner.overrides.kept,
            runner.moment.copy(),
        )
        cycle = runner.machine.clock.cycles
        return RunSnapshot.of(self._made_from, cycle, saved, self._channels.language, find)

    def restore_point(
        self, snapshot: Snapshot, program: ProgramText, find: FindText
    ) -> Callable[[], ProgramText]:
        """Return what goes back to a snapshot and gives its program, when it is certain that it can be done.

        Raises:
            SnapshotError: It is of something else than the run of `program`, of one that has been changed since, or
                damaged.
        """
        snapshot.check(DEVICE, self._made_from, ())
        saved = RunSnapshot.of_any(snapshot).saved(self._channels.language, find)
        kept = saved.program
        if program is self._first and program.name == kept.name and program.content != kept.content:
            raise SnapshotError(
                f"{program.name} is another program than the one of the snapshot",
                hint="give the same one, or use another snapshot",
            )
        channel = self._channels.make(kept, saved.moment.block_delete, attaches=False)
        back = channel.restore_point(saved.channel)

        def go_back() -> ProgramText:
            runner = self._runner
            back()
            runner.channel = channel
            runner.feed.restore(saved.feed)
            runner.stopper.step, runner.stopper.depth = saved.step, saved.depth
            runner.overrides.kept = saved.override_kept
            runner.moment.restore(saved.moment)
            runner.take_switch()
            return kept

        return go_back

    @property
    def _made_from(self) -> str:
        common = self._channels
        return described((common.machine.config, common.path, common.dialect, common.options, common.axes))
