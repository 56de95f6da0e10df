"""Take the snapshot of a program run, and go back to one."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.cnc._path_runner import PathRunner
from polycnc.cnc._run_channels import RunChannels
from polycnc.cnc._run_snapshot import DEVICE, FindText, RunSnapshot, SavedRun
from polycnc.machine import Snapshot, SnapshotError, described
from polycnc.nc import IncomingText, ProgramText


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
