"""A process that serves: it ends at once and keeps its memory, killed it loses nothing that it acknowledged."""

from __future__ import annotations

import random
import resource
import signal
import socket
import threading
import time
from pathlib import Path
from typing import Any

import pytest

from support.command import slow_s
from support.started import started

httpx = pytest.importorskip("httpx", reason="pip install httpx")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

LATE_S = 1.0  # on a computer that has time
FEW, MANY = 2, 100


class Process:
    """A process that serves one machine by several doors."""

    def __init__(self, *arguments: str | Path, files: int | None = None) -> None:
        self.process = started("serve", *arguments)
        self.said: dict[str, str] = {}
        while "http:" not in self.said:
            name, _, at = self.process.stdout.readline().partition(" ")
            assert at, self.process.stderr
            self.said[name] = at.strip()
        if files is not None:
            resource.prlimit(self.process.pid, resource.RLIMIT_NOFILE, (files, files))
        self.port = int(self.said["http:"].rpartition(":")[2])
        self.url = f"{self.said['http:']}/api/machines/machine"

    def end(self, number: signal.Signals) -> tuple[float, str]:
        """End it by a signal; return how long that took and what it said."""
        begun_s = time.perf_counter()
        self.process.send_signal(number)
        _, error = self.process.communicate(timeout=60)
        return time.perf_counter() - begun_s, error


@pytest.mark.parametrize(("number", "status"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_signal_ends_it_at_once_whatever_is_open(
    number: signal.Signals, status: int, tmp_path: Path
) -> None:
    memory = tmp_path / "m.db"
    served = Process("--fanuc", "--memory", memory, "--doors", "focas=0,grbl=0,http=0")
    stop = threading.Event()

    def ask() -> None:
        with httpx.Client(base_url=served.url) as client:
            while not stop.is_set():
                try:
                    client.get("/status")
                    client.put("/variables/500", json={"value": 4.25})
                except httpx.TransportError:
                    return

    threads = [threading.Thread(target=ask, daemon=True) for _ in range(2)]
    with httpx.Client(base_url=served.url, timeout=60) as client:
        assert (
            client.put(
                "/programs/O0012", content=b"O12\nWHILE[1EQ1]DO1\nG91 X1.\nX-1.\nEND1\nM30\n"
            ).status_code
            == 201
        )
        assert client.put("/variables/501", json={"value": -7.5}).status_code == 200
    half = [socket.create_connection(("127.0.0.1", served.port)) for _ in range(5)]
    half += [
        socket.create_connection(("127.0.0.1", int(served.said[name].rpartition(":")[2])))
        for name in ("focas:", "grbl:")
    ]
    for line in half[:5]:
        line.sendall(
            b"PUT /api/machines/machine/programs/O0013 HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99\r\n\r\nO13"
        )
    path = socket.create_connection(("127.0.0.1", served.port))
    path.sendall(b"GET /api/machines/machine/path?program=O0012 HTTP/1.1\r\nHost: localhost\r\n\r\n")
    for thread in threads:
        thread.start()
    time.sleep(0.3)
    took_s, error = served.end(number)
    stop.set()
    for line in (*half, path):
        line.close()
    for thread in threads:
        thread.join()
    assert served.process.returncode == status
    assert "Traceback" not in error
    assert took_s < LATE_S + 25 * slow_s()  # other tests run beside
    if number is signal.SIGTERM:
        check_kept(memory)


def test_a_program_that_takes_long_to_load_is_not_waited_for(tmp_path: Path) -> None:
    program = tmp_path / "long.nc"
    lines = "".join(f"G1 X{k % 97} Y{k % 89}.5 F1200\n" for k in range(15_000))
    program.write_text(100 * lines + "M30\n")
    served = Process("--plain", "mill3", "--program", program, "--doors", "http=0,shdr=0")
    took_s, error = served.end(signal.SIGTERM)
    assert (served.process.returncode, error) == (143, "")
    assert took_s < LATE_S + 25 * slow_s()  # other tests run beside


def test_a_program_that_is_not_there_is_told_before_any_door(tmp_path: Path) -> None:
    said, error = started(
        "serve", "--fanuc", "--program", tmp_path / "gone.nc", "--doors", "focas=0"
    ).communicate(timeout=60)
    assert said == ""
    assert "gone.nc: cannot be read" in error


def check_kept(memory: Path) -> None:
    """Assert that what was acknowledged is there, and nothing of what was not."""
    again = Process("--fanuc", "--memory", memory, "--doors", "http=0")
    with httpx.Client(base_url=again.url, timeout=60) as client:
        assert client.get("/variables/501").json()["value"] == -7.5
        assert client.get("/programs/O0012").status_code == 200
        assert client.get("/programs/O0013").status_code == 404
    again.end(signal.SIGTERM)


def killed(memory: Path, seed: int, before: dict[str, Any]) -> dict[str, Any]:
    """Write while it is killed; return what was acknowledged, with what may have come besides under None."""
    chosen = random.Random(seed)
    served = Process("--fanuc", "--memory", memory, "--doors", "http=0")
    timer = threading.Timer(chosen.uniform(0.0, 0.03), served.process.kill)
    begins = chosen.randint(5, 40)
    known = dict(before)
    with httpx.Client(base_url=served.url, timeout=60) as client:
        for place, value in before.items():
            found = client.get(place)
            shown = found.text if place.startswith("/programs") else found.json()["value"]
            assert shown in value, (place, shown, value)
        try:
            for number in range(10**6):
                if number == begins:
                    timer.start()
                value = seed * 1000.0 + number
                kind = chosen.randrange(2)
                place = f"/variables/%23{500 + number % 20}" if kind else f"/programs/O{number % 5 + 1:04d}"
                text = f"O{number % 5 + 1:04d}\n(A {value})\nG1 X{value} F100.\nM30\n"
                new = value if kind else text
                known[place] = [*known.get(place, [None])[-1:], new]  # it may come, or not
                answer = client.put(place, json={"value": value}) if kind else client.put(place, content=text)
                assert answer.status_code in (200, 201, 204), answer.text
                known[place] = [new]
        except httpx.TransportError:
            pass
    timer.join()
    served.process.communicate(timeout=60)
    return {place: each for place, each in known.items() if None not in each}


@pytest.mark.parametrize("kills", [FEW, pytest.param(MANY, marks=pytest.mark.long)])
def test_nothing_acknowledged_is_lost_when_it_is_killed(kills: int, tmp_path: Path) -> None:
    known: dict[str, Any] = {}
    for seed in range(1, kills + 1):
        known = killed(tmp_path / "m.db", seed, known)
    assert known


def test_more_connections_than_files_are_told_in_a_word() -> None:
    served = Process("--plain", "mill3", "--doors", "http=0", files=64)
    lines: list[socket.socket] = []
    files = Path(f"/proc/{served.process.pid}/fd")
    try:
        lines += [socket.create_connection(("127.0.0.1", served.port), timeout=60) for _ in range(100)]
        end_s = time.monotonic() + 60.0
        while len(list(files.iterdir())) < 60 and time.monotonic() < end_s:
            time.sleep(0.02)  # until it has taken those that it can
    finally:
        for line in lines:
            line.close()
    with httpx.Client(base_url=served.url, timeout=60) as client:
        assert client.get("/status").status_code == 200
    _, error = served.end(signal.SIGTERM)
    assert "Traceback" not in error
    assert error == "no more connections can be taken: the system gives this process no more files\n"
