"""Batches on a Dask cluster: a real scheduler and two worker processes on loopback, one of which is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.runner import batches
from support.command import environment
from support.command import polycnc as command

pytestmark = pytest.mark.skipif(
    find_spec("distributed") is None, reason="no dask.distributed: pip install 'polycnc[cluster]'"
)

PROGRAM = "G0 X{0} Y2\nG1 X{1} F{2}\nG2 X{1} Y2 I7\nM30\n"
PROGRAMS = 40
PLAIN = {"NUMBA_DISABLE_JIT": "1"}  # the same bits, and quick to start


@contextmanager
def _dask(*arguments: str) -> Iterator[subprocess.Popen[bytes]]:
    running = subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments],
        env=environment(**PLAIN),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield running
    finally:
        running.kill()
        running.wait()


def _client(card: Path) -> Any:
    import distributed

    make: Any = distributed.Client
    return make(scheduler_file=str(card), timeout=60, set_as_default=False)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Start a scheduler and three workers, as the how-to does; yield the address and the workers."""
    place = tmp_path_factory.mktemp("cluster")
    card = place / "scheduler.json"
    worker = ("worker", "--scheduler-file", str(card), "--nthreads", "1", "--no-dashboard", "--no-nanny")
    local = str(place / "local")
    scheduler = ("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
    with (
        _dask(*scheduler, "--scheduler-file", str(card)),
        _dask(*worker, "--local-directory", local) as one,
        _dask(*worker, "--local-directory", local) as other,
        _dask(*worker, "--local-directory", local) as last,
        _client(card) as client,
    ):
        client.wait_for_workers(3, timeout=60)
        yield client.scheduler.address, [one, other, last]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    parts = tmp_path / "parts"
    parts.mkdir()
    for number in range(PROGRAMS):
        (parts / f"p{number:03}.nc").write_text(PROGRAM.format(number, 100 + number, 2900 + number))
    (parts / "p017.nc").write_text("G1 X5 F100\nG1 X7 Q\n")
    return parts


def _reports(result: polycnc.BatchResult) -> list[dict[str, Any]]:
    with result:
        return [report.as_dict() for report in result]


@pytest.mark.long  # two schedulers and their workers are started
def test_the_command_on_a_cluster(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], folder: Path, tmp_path: Path
) -> None:
    address, workers = cluster
    (folder / "endless.tap").write_text("WHILE [1 EQ 1] DO1\n#1=#1+1\nEND1\n")
    arguments = ("batch", "parts", "--cluster", address, "-o", "out.csv", "--timeout", "2")
    done = command(*arguments, cwd=tmp_path, status=1)
    assert f"{PROGRAMS + 1} runs, 2 with errors\n" in done.stdout
    assert "endless.tap: stopped after 2 s\n" in done.stdout
    again = command(*arguments, cwd=tmp_path, status=1)
    assert f"done before and unchanged: {PROGRAMS}\n" in again.stdout
    assert [worker.poll() for worker in workers] == [None, None, None]  # the cluster is left as it was


@pytest.mark.filterwarnings("ignore::ResourceWarning")  # of sockets that dask leaves to the garbage collector
def test_a_worker_is_killed_and_everything_comes_once(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    address, workers = cluster
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    here = _reports(polycnc.batch(folder, jobs=1))
    seen: list[int] = []

    def kill(number: int, total: int) -> None:
        seen.append(number)
        if len(seen) == 5:
            os.kill(workers[0].pid, signal.SIGKILL)

    connected = batches.ClusterWorkers.at(address)
    try:
        there = _reports(polycnc.batch(folder, client=connected.client, progress=kill))
    finally:
        connected.close()
    assert workers[0].wait(60) == -signal.SIGKILL
    assert seen[-1] == len(there) == PROGRAMS
    assert there == here
    assert [each["ok"] for each in there].count(False) == 1


@pytest.mark.filterwarnings("ignore::ResourceWarning")
def test_what_all_programs_need_is_sent_anew_when_the_worker_that_had_it_is_killed(
    cluster: tuple[str, list[subprocess.Popen[bytes]]], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    address, workers = cluster
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    here = _reports(polycnc.batch(folder, jobs=1))
    connected = batches.ClusterWorkers.at(address)
    client = connected.client
    scatter, places = client.scatter, client.run(os.getpid)
    (only,) = (place for place, process in places.items() if process == workers[1].pid)
    sent: list[int] = []

    def to_one(*given: Any, **asked: Any) -> Any:
        sent.append(len(sent))
        if len(sent) > 1:
            return scatter(*given, **asked)
        found = scatter(*given, **{**asked, "broadcast": False, "workers": [only]})
        os.kill(workers[1].pid, signal.SIGKILL)
        workers[1].wait(60)
        return found

    monkeypatch.setattr(client, "scatter", to_one)
    try:
        there = _reports(polycnc.batch(folder, client=client))
    finally:
        connected.close()
    assert there == here
    assert sent == [0, 1]


def test_nobody_answers() -> None:
    with pytest.raises(UsageError, match=r"no Dask scheduler answers at tcp://127\.0\.0\.1:9"):
        batches.ClusterWorkers.at("tcp://127.0.0.1:9", wait_s=0.5)


def test_without_the_extra_the_command_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UsageError, match=r"polycnc\[cluster\]"):
        batches.ClusterWorkers.at("tcp://127.0.0.1:8786")
