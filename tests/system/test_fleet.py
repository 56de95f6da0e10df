"""A fleet: one file, several processes, a line for each door of each machine, one page of figures."""

from __future__ import annotations

import os
import re
import signal
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from polycnc.errors import PolycncError
from polycnc.servers.setup import Flags, load_serve_file, plan_of
from support.command import slow_s
from support.started import Started, started

httpx = pytest.importorskip("httpx", reason="pip install httpx")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

FLEET = """
processes = 2
metrics = 0

[doors]
mtconnect = 0

[[machine]]
name = "mill"
count = 3
controller = "plain"
file = "mill3"
program = "part.nc"
doors.shdr = 0

[[machine]]
name = "lathe-{n}-b"
count = 2
controller = "plain"
file = "lathe2"
"""
PART = "G90 G1 F600 X-12.5\nX0\nM30\n"
NAMES = ["mill1", "mill2", "mill3", "lathe-1-b", "lathe-2-b"]


def is_there(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] != "Z"
    except OSError:
        return False


def children(pid: int) -> list[int]:
    found = []
    for each in Path("/proc").glob("[0-9]*/stat"):
        try:
            if int(each.read_text().rpartition(") ")[2].split()[1]) == pid:
                found.append(int(each.parent.name))
        except OSError:
            continue
    return sorted(found)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("fleet")
    (made / "part.nc").write_text(PART)
    (made / "fleet.toml").write_text(FLEET)
    return made


class Running:
    """A fleet that runs, and what it has said."""

    def __init__(self, folder: Path) -> None:
        self.process: Started = started("serve", folder / "fleet.toml")
        self.lines: list[str] = []
        while not self.lines or not self.lines[-1].startswith("ready"):
            line = self.process.stdout.readline()
            assert line, self.process.communicate(timeout=60)
            self.lines.append(line.strip())
        self.children = children(self.process.pid)


@pytest.fixture
def fleet(folder: Path) -> Iterator[Running]:
    made = Running(folder)
    yield made
    made.process.kill()


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="the system does not tell")
def test_a_fleet_says_where_everything_is_and_ends_as_one(fleet: Running) -> None:
    at = dict(line.split(": ", 1) for line in fleet.lines)
    assert at.pop("ready") == "2 processes"
    metrics = at.pop("metrics")
    assert set(at) == {f"{name} mtconnect" for name in NAMES} | {f"mill{k} shdr" for k in (1, 2, 3)}
    assert len({at[f"{name} mtconnect"] for name in NAMES}) == 2, "each process has a door of its own"
    assert len({at[f"mill{k} shdr"] for k in (1, 2, 3)}) == 3
    assert len(fleet.children) == 2
    answer = httpx.get(f"{at['mill2 mtconnect']}/mill2/current", timeout=60)
    assert 'name="mill2"' in answer.text
    up: dict[str, str] = {}
    for _ in range(30):  # a process that has no time for two seconds is left out
        figures = httpx.get(metrics, timeout=60).text
        up = dict(re.findall(r'polycnc_machine_up\{machine="([^"]+)",process="(\d)"\} 1\.0', figures))
        if len(up) == len(NAMES):
            break
    assert up == {"mill1": "1", "mill2": "1", "mill3": "2", "lathe-1-b": "2", "lathe-2-b": "2"}
    assert figures.count("\npolycnc_machine_lateness_seconds{") == 5
    health: dict[str, Any] = {}
    for _ in range(30):
        health = httpx.get(metrics.replace("/metrics", "/health"), timeout=60).json()
        if health["status"] == "ok":
            break
    assert health == {"status": "ok", "machines": 5}
    begun_s = time.perf_counter()
    fleet.process.terminate()
    _, error = fleet.process.communicate(timeout=60)
    assert (fleet.process.returncode, error) == (143, "")
    assert time.perf_counter() - begun_s < 5.0 + 25 * slow_s()  # a second, on a computer that has time
    assert not any(map(is_there, fleet.children))


@pytest.mark.long
@pytest.mark.parametrize("who", ["first", "other"])
def test_no_process_of_a_fleet_is_left_when_one_is_killed(who: str, fleet: Running) -> None:
    os.kill(fleet.process.pid if who == "first" else fleet.children[1], signal.SIGKILL)
    _, error = fleet.process.communicate(timeout=60)
    if who == "other":
        assert fleet.process.returncode == 1
        assert "process 2 of the fleet has ended with status -9" in error
    end = time.monotonic() + 20.0
    while any(map(is_there, fleet.children)) and time.monotonic() < end:
        time.sleep(0.05)
    assert not any(map(is_there, fleet.children))


def test_a_table_with_a_count_is_so_many_machines(tmp_path: Path) -> None:
    path = tmp_path / "f.toml"
    path.write_text(
        '[[machine]]\nname = "m"\ncount = 3\ncontroller = "fanuc"\nmemory = "m{n}.db"\n'
        "doors = {focas = 8193, grbl = 0}\n"
    )
    machines = load_serve_file(path).machine
    assert [each.name for each in machines] == ["m1", "m2", "m3"]
    assert [each.memory for each in machines] == ["m1.db", "m2.db", "m3.db"]
    assert [dict(each.doors) for each in machines] == [{"focas": 8193 + k, "grbl": 0} for k in range(3)]


def test_processes_share_the_machines_and_the_ports_of_shared_doors_count_up(folder: Path) -> None:
    plans = [plan_of(Flags(folder / "fleet.toml", {}, part=f"{k}/2")) for k in (1, 2)]
    assert [each.machinery.name for plan in plans for each in plan.machines] == NAMES
    assert all(plan.processes == 1 for plan in plans)
    (folder / "ports.toml").write_text(FLEET.replace("mtconnect = 0", "mtconnect = 5000"))
    plans = [plan_of(Flags(folder / "ports.toml", {}, part=f"{k}/2")) for k in (1, 2)]
    assert [plan.shared[0][1].port for plan in plans] == [5000, 5001]


def test_the_page_shows_the_lines_of_its_file(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "run-a-fleet.md").read_text("utf-8")
    shown = dict(re.findall(r'```\w+ title="([^"]+)"\n(.*?)```', page, re.DOTALL))
    (tmp_path / "plant.toml").write_text(shown["plant.toml"])
    (tmp_path / "plate.nc").write_text(shown["plate.nc"])
    lines = ["metrics: http://127.0.0.1:9100/metrics"]
    for k in (1, 2):
        plan = plan_of(Flags(tmp_path / "plant.toml", {}, part=f"{k}/2"))
        own = [
            (each.machinery.name, row.name, at.port, "") for each in plan.machines for row, at in each.doors
        ]
        both = [
            (each.machinery.name, row.name, at.port, "http://")
            for row, at in plan.shared
            for each in plan.machines
        ]
        lines += [f"{name} {door}: {scheme}127.0.0.1:{port}" for name, door, port, scheme in own + both]
    assert shown["says"].splitlines() == [*lines, "ready: 2 processes"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('count = 2\nmemory = "m.db"', "2 machines cannot share m.db"),
        ("count = 1000\ndoors = {shdr = 65000}", "the ports of m go beyond 65535"),
        ("[[machine]]\nname='x'\ncontroller='plain'\ncount = 1000", "1001 machines"),
        (
            "[[machine]]\nname='x'\ncontroller='fanuc'\nchannels = [['X'], ['Y']]",
            "no channels for a machine of the kind fanuc",
        ),
    ],
)
def test_what_no_fleet_can_be_is_said(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "f.toml"
    path.write_text(f'[[machine]]\nname = "m"\ncontroller = "plain"\n{text}\n')
    with pytest.raises(PolycncError, match=said):
        load_serve_file(path)


@pytest.mark.parametrize(
    ("text", "said"),
    [("processes = 2", "2 processes for 1 machines"), ("metrics = 0", "metrics without processes")],
)
def test_processes_without_machines_are_refused(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "f.toml"
    path.write_text(f'{text}\n[[machine]]\nname = "m"\ncontroller = "plain"\n')
    with pytest.raises(PolycncError, match=said):
        load_serve_file(path)
    path.write_text('processes = 2\n[[machine]]\nname = "m"\ncontroller = "plain"\ncount = 2\n')
    with pytest.raises(PolycncError, match="3/2 is no part of 2 processes"):
        plan_of(Flags(path, {}, part="3/2"))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            '[[machine]]\nname = "a b"\ncontroler = "fanuc"\n',
            [
                "serve.toml:2:1: 'name' cannot be \"a b\"",
                "unknown key 'controler' in [[machine]]",
                "up to 32 letters",
            ],
        ),
        ("machine = []\n", ["serve.toml:1:1: 'machine' must have at least 1 element"]),
    ],
)
def test_a_wrong_file_of_machines_is_refused_in_words(text: str, said: list[str], tmp_path: Path) -> None:
    path = tmp_path / "serve.toml"
    path.write_text(text)
    with pytest.raises(PolycncError) as caught:
        load_serve_file(path)
    assert all(each in str(caught.value) for each in said)
    assert not re.search(r"validation|pattern|\^\(|at least.*not 0", str(caught.value))


def test_two_kinds_of_machine_at_once_are_named() -> None:
    with pytest.raises(PolycncError, match="--fanuc and --plain at once"):
        plan_of(Flags(None, {"fanuc": "", "plain": "mill3"}))


def test_a_machine_beside_the_fanuc_control_is_refused_with_what_to_do() -> None:
    with pytest.raises(PolycncError, match=r"--fanuc takes no machine, but 'mill3' is given"):
        plan_of(Flags(Path("mill3"), {"fanuc": ""}))
