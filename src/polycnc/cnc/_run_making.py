"""Make the runs of a channel: with the machine file as its programs see it, and back from a snapshot."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from polycnc.cnc._program_run import ProgramRun
from polycnc.cnc._run_snapshot import FindText
from polycnc.cnc._run_state import RunOptions
from polycnc.machine import Machine, MachineConfig, Snapshot
from polycnc.nc import Dialect, Event, Language, Library, ProgramText, of_another_channel


class RunMaker:
    """Make runs on a path of a machine; `language` and `names` hold for runs that are made from now on.

    `names` are the machine's axes for programs, see `of_another_channel`; None: as the machine has them.
    """

    def __init__(
        self,
        machine: Machine,
        path: int,
        dialect: Dialect,
        config: MachineConfig,
        axes: Sequence[str],
        *,
        library: Library,
        dry_run_mm_s: float,
        most_feed_override: float,
        on_event: Callable[[Event], bool],
        language: Language | None,
    ) -> None:
        self._machine = machine
        self._path = path
        self._library = library
        self._options = RunOptions(
            answers=True, dry_run_mm_s=dry_run_mm_s, most_feed_override=most_feed_override
        )
        self._on_event = on_event
        self.language = language
        self.names: Sequence[str] | None = None
        self.change(config, dialect, axes)

    def change(self, config: MachineConfig, dialect: Dialect, axes: Sequence[str]) -> None:
        """Make runs that keep other limits, are read in this dialect, and have these axes."""
        self._file, self._dialect = config, dialect
        self.share(axes)

    def share(self, axes: Sequence[str]) -> None:
        """Make runs that have these axes: no word of a program reaches those of others."""
        self.stale = True
        """Whether a run that was made before knows less."""
        own = tuple(
            axis if axis.name in axes else axis.model_copy(update={"name": of_another_channel(axis.name)})
            for axis in self._file.axes
        )
        self._config = self._file.model_copy(update={"axes": own})

    def make(self, text: ProgramText, *, attaches: bool = True) -> ProgramRun:
        """Return a new run of a text."""
        return ProgramRun(
            self._machine,
            text,
            self._dialect,
            path=self._path,
            options=self._options,
            config=self._config,
            library=self._library,
            language=self.language,
            axes=self.names,
            on_event=self._on_event,
            attaches=attaches,
        )

    def restore_point(self, run: Snapshot | None, find: FindText) -> Callable[[], ProgramRun | None]:
        """Return what makes a run that goes back to a snapshot, when it is certain that it can be done.

        Raises:
            SnapshotError: It cannot.
        """
        if run is None:
            return lambda: None
        made = self.make(ProgramText("", b""), attaches=False)
        back = made.restore_point(run, find=find)

        def go_back() -> ProgramRun:
            back()
            return made

        return go_back
