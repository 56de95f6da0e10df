"""Run or check many programs, on all cores or a cluster; what is done already is not done again."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from polycnc.errors import UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText, choose_dialect
from polycnc.runner._program_control import has_control
from polycnc.runner.batches._child import Limits
from polycnc.runner.batches._job import Job, ProgramReport, Setup, answer_of, blank_report
from polycnc.runner.batches._programs import find_programs
from polycnc.runner.batches._store import ResultStore, folder_digest, key_of, version_digest
from polycnc.runner.batches._sweep import setups_of
from polycnc.runner.batches._workers import Chunk, ClusterWorkers, LocalWorkers, Workers

_CHUNK_JOBS = 16
_CHUNK_BYTES = 1 << 16
_MOST_FILES = 500  # of a folder that is copied for a program
_NAME_ROOT = "Name the folder with the files of the control: --root."

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class BatchCounts:
    """How many programs there were, how many had no error, and how many were done before."""

    total: int
    ok: int
    earlier: int


class BatchResult:
    """The reports of a batch, in the order of programs and setups; they stay on disk until they are asked for.

    Close it, or use it as a context, when the reports are not needed any more.
    """

    def __init__(self, store: ResultStore, keys: list[str], counts: BatchCounts) -> None:
        self._store = store
        self._keys = keys
        self.counts = counts

    @property
    def ok(self) -> bool:
        """Whether no program has an error."""
        return self.counts.ok == self.counts.total

    def __len__(self) -> int:
        return len(self._keys)

    def __iter__(self) -> Iterator[ProgramReport]:
        return self._store.reports(self._keys)

    def __getitem__(self, index: int) -> ProgramReport:
        return self._store.report(self._keys[index])

    def __enter__(self) -> BatchResult:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the reports."""
        self._store.close()

    def save(self, path: str | Path) -> Path:
        """Write the reports to an .html, .parquet or .csv file.

        Raises:
            UsageError: another ending, no such folder, or pyarrow is needed and not installed.
        """
        from polycnc.runner.batches._write import write_batch

        return write_batch(self, path)


def batch(
    paths: str | Path | Iterable[str | Path],
    machine: str | Path | MachineConfig | None = None,
    dialect: str | Path | Dialect | None = None,
    *,
    check_only: bool = False,
    detail: bool = False,
    sweep: Mapping[str, Sequence[float | str | Path | MachineConfig]] | None = None,
    jobs: int | None = None,
    client: Any = None,
    patterns: Sequence[str] = (),
    root: str | Path | None = None,
    stock: str | None = None,
    resolution_mm: float | None = None,
    fixtures: Sequence[str] = (),
    timeout_s: float = 600.0,
    memory_mb: float = 4096.0,
    done: str | Path | None = None,
    progress: Progress | None = None,
) -> BatchResult:
    """Run programs, or with `check_only` check them, each in a process that may hang without harm.

    `paths` are programs and folders of them (files whose names match `patterns`, or look like programs). They run on
    `jobs` processes of this computer (as many as it has cores), or on the Dask cluster of `client`. `sweep` varies
    "override" (percent), "tolerance" (mm) and "machine": {"override": [80, 100, 120]}. `detail` adds the slowest blocks
    and a picture of the path, for a report. A program may take `timeout_s` and `memory_mb` (0: without limit). `done`
    is a file that keeps what is done: a program that is unchanged, as are machine, options and polycnc itself, is not
    run again. `progress` gets how many are done, of how many.

    With `stock`, `resolution_mm` and `fixtures` (as in `run`, but no files) the tools of each program cut it: a
    collision is an error, and `removed_mm3` is in its report.

    Programs with a language that reads and writes files (CPL) run on a copy of `root`, their folder if absent; what
    they write is thrown away.

    Raises:
        UsageError: no such file, machine or dialect, no program at all, or values that cannot be swept.
        BatchError: no process can be started.
    """
    limits = _limits(timeout_s, memory_mb)
    setups = setups_of(
        machine,
        dialect,
        sweep or {},
        check_only=check_only,
        detail=detail,
        stock=stock,
        resolution_mm=resolution_mm,
        fixtures=fixtures,
    )
    programs = find_programs([paths] if isinstance(paths, str | Path) else paths, patterns)
    if root is not None and not Path(root).is_dir():
        raise UsageError(f"no such folder: {root}", hint="Make it first; it holds the files of the control.")
    if jobs is not None and jobs < 1:
        raise UsageError(f"{jobs} processes", hint="Give 1 or more.")
    most = min(jobs or cores(), len(programs) * len(setups))  # more would have nothing to do
    workers: Workers = LocalWorkers(most) if client is None else ClusterWorkers(client)
    store = ResultStore(None if done is None else Path(done))
    try:
        run = _Run(programs, setups, store, None if root is None else Path(root), progress)
        run.to_end(workers, limits)
    except BaseException:
        store.close()
        raise
    return BatchResult(store, run.keys, run.counts())


LONGEST_TIMEOUT_S = 1e8  # three years
MOST_MEMORY_MB = 1e9


def cores() -> int:
    """Return how many processes can run at once on this computer."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _limits(timeout_s: float, memory_mb: float) -> Limits:
    limits = (("a time-out", timeout_s, LONGEST_TIMEOUT_S), ("a limit of memory", memory_mb, MOST_MEMORY_MB))
    for what, value, most in limits:
        if not 0.0 <= value <= most:
            raise UsageError(
                f"{what} of {value:g}", hint=f"Give a number above 0, up to {most:g}, or 0 for none."
            )
    return Limits(timeout_s, memory_mb)


class _Run:
    """The jobs of one batch: made when they are asked for, counted when their reports come."""

    def __init__(
        self,
        programs: Sequence[Path],
        setups: Sequence[Setup],
        store: ResultStore,
        root: Path | None,
        progress: Progress | None,
    ) -> None:
        self.keys: list[str] = []
        self._programs = programs
        self._setups = setups
        self._setup_parts = [repr(_plain(setup)).encode() for setup in setups]
        self._store = store
        self._root = root
        self._progress = progress
        self._total = len(programs) * len(setups)
        self._seen = self._ok = self._earlier = 0
        self._roots: dict[Path, bytes] = {}

    def to_end(self, workers: Workers, limits: Limits) -> None:
        """Run everything that is not done."""
        for reported in workers.run(self._chunks(), self._setups, limits):
            self._store.keep(reported)
            self._count(len(reported), sum(answer.ok for _, answer in reported))

    def counts(self) -> BatchCounts:
        """Return what came out, in numbers."""
        return BatchCounts(self._total, self._ok, self._earlier)

    def _count(self, reports: int, ok: int) -> None:
        self._seen += reports
        self._ok += ok
        if self._progress is not None:
            self._progress(self._seen, self._total)

    def _chunks(self) -> Iterator[Chunk]:
        """Yield the jobs that are not done, some small ones together."""
        chunk: Chunk = []
        size = 0
        for job in self._jobs():
            chunk.append(job)
            size += len(job.content)
            if len(chunk) >= self._chunk_jobs or size >= _CHUNK_BYTES:
                yield chunk
                chunk, size = [], 0
        if chunk:
            yield chunk

    @property
    def _chunk_jobs(self) -> int:
        return max(1, min(_CHUNK_JOBS, self._total // 64))

    def _jobs(self) -> Iterator[Job]:
        for path in self._programs:
            content, trouble = _read(path)
            for number, (setup, part) in enumerate(zip(self._setups, self._setup_parts, strict=True)):
                root = None if trouble else self._root_of(path, content, setup)
                folder = b"" if root is None else self._digest_of(root)
                if root is not None and not folder:
                    trouble = f"{path}: its folder {root} is too large to run it on a copy. {_NAME_ROOT}"
                name = str(path).encode("utf-8", "surrogateescape")
                key = key_of(
                    version_digest(), part, name, content, folder, trouble.encode("utf-8", "replace")
                )
                self.keys.append(key)
                job = Job(key, str(path), content, number, None if root is None else str(root.resolve()))
                if trouble:
                    self._store.keep([(key, answer_of(blank_report(job, setup, "error", trouble)))])
                    self._count(1, 0)
                elif status := self._store.done(key):
                    self._earlier += 1
                    self._count(1, int(status == "ok"))
                else:
                    yield job

    def _root_of(self, path: Path, content: bytes, setup: Setup) -> Path | None:
        """Return the folder with the control's files, where programs of its dialect need one."""
        try:
            chosen = choose_dialect(ProgramText(str(path), content), setup.dialect)
        except UsageError:
            return None  # no text: its job reports it
        return (self._root or path.parent) if has_control(chosen.dialect) else None

    def _digest_of(self, root: Path) -> bytes:
        if root not in self._roots:
            few = sum(1 for _ in islice(root.rglob("*"), _MOST_FILES + 1)) <= _MOST_FILES
            self._roots[root] = folder_digest(root) if few else b""
        return self._roots[root]


def _read(path: Path) -> tuple[bytes, str]:
    """Return the content of a program, or why there is none."""
    try:
        return path.read_bytes(), ""
    except OSError as error:
        return b"", f"cannot read {path}: {error.strerror}"


def _plain(setup: Setup) -> tuple[object, ...]:
    """Return what tells a setup from others, the same in every process."""
    dialect = setup.dialect.model_dump_json() if isinstance(setup.dialect, Dialect) else setup.dialect
    stock = setup.stock, setup.resolution_mm, setup.fixtures
    return (
        *("" if each is None else each.model_dump_json() for each in (setup.machine, setup.lathe)),
        dialect,
        setup.override_percent,
        setup.check_only,
        setup.detail,
        stock,
    )
