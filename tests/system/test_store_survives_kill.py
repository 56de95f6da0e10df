"""A killed process loses nothing that it has acknowledged."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from polycnc.errors import UsageError
from polycnc.machine._store import Store

# Writes for ever; each line on stdout is the acknowledgement of everything before it.
WRITER = """
import itertools, sys
from polycnc.machine._store import Store

store = Store(sys.argv[1])
macros, pairs, alarms = store.area("macros", int), store.area("pairs", int), store.history("alarms")
for number in itertools.count(1):
    macros[number] = number * number
    with store.transaction():
        pairs["left"] = number
        pairs["right"] = number
    alarms.append({"number": number})
    print(number, flush=True)
"""

# Leaves a transaction open.
HOLDER = """
import sys
from polycnc.machine._store import Store

store = Store(sys.argv[1])
macros = store.area("macros", int)
macros[1] = 1
with store.transaction():
    macros.save({number: -1 for number in range(1, 5000)})
    print("inside", flush=True)
    sys.stdin.read()
"""

OPENER = """
import sys
from polycnc.machine._store import Store

Store(sys.argv[1])
"""


def python(script: str, path: Path) -> "subprocess.Popen[str]":
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.Popen(
        [sys.executable, "-c", script, str(path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )


@contextmanager
def running(script: str, path: Path) -> Iterator["subprocess.Popen[str]"]:
    with python(script, path) as process:
        try:
            yield process
        finally:
            process.kill()


def killed_after(lines: int, path: Path) -> int:
    """Kill a writer once it has acknowledged `lines` lines; return the number in its last whole line."""
    with running(WRITER, path) as process:
        assert process.stdout is not None
        read = [process.stdout.readline() for _ in range(lines)]
        process.kill()
        read += process.stdout.readlines()
        assert process.wait() < 0 or os.name == "nt"
    return max(int(line) for line in read if line.endswith("\n"))


def test_what_was_acknowledged_is_there_after_a_kill(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    for lines in (1, 40, 250):
        acknowledged = killed_after(lines, path)
        assert acknowledged >= lines
        with Store(path) as store:
            macros = store.area("macros", int).load()
            assert all(macros[number] == number * number for number in range(1, acknowledged + 1))
            pairs = store.area("pairs", int).load()
            assert pairs["left"] == pairs["right"] in (acknowledged, acknowledged + 1)
            numbers = [entry.content["number"] for entry in store.history("alarms").read()]
            assert numbers[:acknowledged] == list(range(1, acknowledged + 1))
            assert len(numbers) <= acknowledged + 1
            assert store.query("PRAGMA integrity_check") == [("ok",)]
            store.area("macros", int).clear()
            store.history("alarms").trim(keep=0)


def test_an_open_transaction_is_gone_after_a_kill(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with running(HOLDER, path) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "inside\n"
        with pytest.raises(UsageError, match="database is locked"):
            Store(path)
    with Store(path) as store:
        assert store.area("macros", int).load() == {1: 1}


def test_nothing_in_the_owning_process_lets_another_one_in(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    with Store(path) as store:
        store.area("macros", int)[1] = 1
        for attempt in (Store, store.snapshot, store.restore):
            with pytest.raises(UsageError):
                attempt(path)
        with running(OPENER, path) as process:
            _, errors = process.communicate()
        assert process.returncode == 1
        assert "database is locked" in errors
