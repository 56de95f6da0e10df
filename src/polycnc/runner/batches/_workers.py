"""Where chunks of programs are run: in processes of this computer, or on a cluster of Dask."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator, Sequence
from typing import Any, Protocol

from polycnc.errors import UsageError
from polycnc.runner.batches._child import Child, Limits
from polycnc.runner.batches._job import Answer, Job, Setup, answer_of, blank_report
from polycnc.runner.batches._store import version_digest

Chunk = list[Job]
Reported = list[tuple[str, Answer]]
_PLUGIN = "polycnc-batch"
_MOST_SENT = 5  # times that workers are sent what is the same for all programs
_LOOK_S = 0.5
_AHEAD = 3  # chunks for each worker that are on their way


class Workers(Protocol):
    """What runs chunks of jobs, in any order; the iterator is asked for no more than is needed soon."""

    def run(self, chunks: Iterator[Chunk], setups: Sequence[Setup], limits: Limits) -> Iterator[Reported]:
        """Yield the reports of each chunk, by the keys of their jobs, as they come."""


class LocalWorkers:
    """Processes of this computer, started for one batch and ended with it."""

    def __init__(self, count: int) -> None:
        if count < 1:
            raise UsageError(f"{count} processes", hint="Give 1 or more jobs.")
        self.count = count

    def run(self, chunks: Iterator[Chunk], setups: Sequence[Setup], limits: Limits) -> Iterator[Reported]:
        """Yield the reports of each chunk as they come."""
        todo: queue.Queue[Chunk | None] = queue.Queue()
        done: queue.Queue[Reported | Exception] = queue.Queue()
        children = [Child(limits) for _ in range(self.count)]
        threads = [
            threading.Thread(
                target=_work, args=(child, todo, done, setups), name="polycnc batch", daemon=True
            )
            for child in children
        ]
        under_way = 0
        try:
            for thread in threads:
                thread.start()
            for _ in range(_AHEAD * self.count):
                under_way += _next(chunks, todo)
            while under_way:
                reported = _taken(done)
                if isinstance(reported, Exception):
                    raise reported
                under_way += _next(chunks, todo) - 1
                yield reported
        finally:
            for child in children:
                child.close()
            for _ in threads:
                todo.put(None)
            for thread in threads:
                if thread.ident is not None:
                    thread.join()


def _taken(done: queue.Queue[Reported | Exception]) -> Reported | Exception:
    """Return what comes next; a Ctrl-C right before the wait begins does not interrupt it, so it is begun anew."""
    while True:
        try:
            return done.get(timeout=_LOOK_S)
        except queue.Empty:
            continue


def _next(chunks: Iterator[Chunk], todo: queue.Queue[Chunk | None]) -> int:
    chunk = next(chunks, None)
    if chunk is None:
        return 0
    todo.put(chunk)
    return 1


def _work(
    child: Child,
    todo: queue.Queue[Chunk | None],
    done: queue.Queue[Reported | Exception],
    setups: Sequence[Setup],
) -> None:
    while (chunk := todo.get()) is not None:
        keys = [job.key for job in chunk]
        try:
            done.put(list(zip(keys, child.answers(chunk, setups), strict=True)))
        except Exception as error:  # or whoever waits for this chunk waits for ever
            done.put(error)
            return


class ClusterWorkers:
    """The workers of a Dask cluster, each with a process of its own for every thread; the cluster is left as it was."""

    def __init__(self, client: Any) -> None:
        self.client = client

    @classmethod
    def at(cls, address: str, wait_s: float = 10.0) -> ClusterWorkers:
        """Return the workers of the scheduler at an address like tcp://10.0.0.7:8786, waiting `wait_s` for its answer.

        Raises:
            UsageError: dask.distributed is not installed, or nobody answers at the address.
        """
        distributed = distributed_module()
        try:
            client = distributed.Client(address, timeout=wait_s, set_as_default=False)
        except (OSError, ValueError, TimeoutError) as error:
            raise UsageError(
                f"no Dask scheduler answers at {address}: {error}",
                hint="Start one with `dask scheduler`, and give the address that it prints.",
            ) from None
        return cls(client)

    def close(self) -> None:
        """Take the connection away."""
        self.client.close()

    def run(self, chunks: Iterator[Chunk], setups: Sequence[Setup], limits: Limits) -> Iterator[Reported]:
        """Yield the reports of each chunk as they come; what a lost worker had is run by another."""
        distributed = distributed_module()
        from polycnc.runner.batches._on_worker import ChildrenPlugin, run_chunk

        client = self.client
        threads = sum(client.nthreads().values())
        if not threads:
            raise _no_worker()
        _check_versions(client)
        client.register_plugin(ChildrenPlugin(limits), name=_PLUGIN)
        sent = [_spread(client, setups)]
        waiting: dict[Any, tuple[Chunk, Any]] = {}
        futures = distributed.as_completed([], loop=client.loop)

        def submit(chunk: Chunk) -> None:
            future = client.submit(run_chunk, chunk, sent[-1], limits, pure=False)
            waiting[future] = chunk, sent[-1]
            futures.add(future)

        try:
            for _ in range(_AHEAD * threads):
                if (chunk := next(chunks, None)) is not None:
                    submit(chunk)
            for future in futures:
                chunk, had = waiting.pop(future)
                try:
                    reported: Reported = future.result()
                except (distributed.KilledWorker, distributed.client.FutureCancelledError) as error:
                    # The setups may have been lost with the last worker that had them.
                    is_killed = isinstance(error, distributed.KilledWorker)
                    if not is_killed and had is sent[-1] and len(sent) < _MOST_SENT:
                        sent.append(_spread(client, setups))
                    if not is_killed and had is not sent[-1]:
                        submit(chunk)
                        continue
                    if len(chunk) > 1:  # one of them may be why: each by itself
                        for job in chunk:
                            submit([job])
                        continue
                    reported = [(job.key, _lost(job, setups, error)) for job in chunk]
                future.release()
                if (following := next(chunks, None)) is not None:
                    submit(following)
                yield reported
        finally:
            client.cancel(list(waiting))
            client.unregister_worker_plugin(_PLUGIN)


def _no_worker() -> UsageError:
    return UsageError(
        "the Dask cluster has no worker",
        hint="Start one with `dask worker ADDRESS`, on as many computers as you like.",
    )


def _spread(client: Any, setups: Sequence[Setup]) -> Any:
    """Send all workers what is the same for all programs; return what stands for it.

    Raises:
        UsageError: There is no worker, or no longer.
    """
    try:
        return client.scatter([tuple(setups)], broadcast=True, hash=False)[0]
    except TimeoutError:
        raise _no_worker() from None


def _check_versions(client: Any) -> None:
    """Refuse workers whose polycnc is another one: their results could differ.

    Raises:
        UsageError: a worker has no polycnc, or another one.
    """
    try:
        found: dict[str, bytes] = client.run(version_digest)
    except ImportError as error:
        raise UsageError(
            f"the workers of the cluster cannot run polycnc: {error}",
            hint="Install it where they run: pip install 'polycnc[cluster]'.",
        ) from None
    others = [address for address, digest in found.items() if digest != version_digest()]
    if others:
        raise UsageError(
            f"another polycnc runs on {', '.join(sorted(others)[:3])}"
            + (f" and {len(others) - 3} more workers" if len(others) > 3 else ""),
            hint="Install the same version on all computers of the cluster and start the workers again.",
        )


def _lost(job: Job, setups: Sequence[Setup], error: Exception) -> Answer:
    text = f"{job.name}: the workers that ran it were lost, one after the other ({type(error).__name__})"
    return answer_of(blank_report(job, setups[job.setup], "lost", text))


def distributed_module() -> Any:
    """Return dask.distributed.

    Raises:
        UsageError: it is not installed.
    """
    try:
        import distributed
    except ImportError:
        raise UsageError(
            "a cluster needs dask.distributed",
            hint="Install it: pip install 'polycnc[cluster]'; without --cluster it is not needed.",
        ) from None
    return distributed
