"""A killed process loses nothing that it has acknowledged."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from polycnc.errors import UsageError
from polycnc.machine._store import Store
from support.command import python
from support.started import started_python

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
import signal, sys
from polycnc.machine._store import Store

store = Store(sys.argv[1])
macros = store.area("macros", int)
macros[1] = 1
with store.transaction():
    macros.save({number: -1 for number in range(1, 5000)})
    print("inside", flush=True)
    signal.pause()
"""

OPENER = """
import sys
from polycnc.machine._store import Store

Store(sys.argv[1])
"""


def killed_after(lines: int, path: Path) -> int:
    """Kill a writer once it has acknowledged `lines` lines; return the number in its last whole line."""
    with started_python(WRITER, path) as process:
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
    with started_python(HOLDER, path) as process:
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
        assert "database is locked" in python(OPENER, path, status=1).stderr


# Writes 50, forks a child that ends in the way of the second argument, writes 50 more, and is killed.
FORKER = """
import gc, os, signal, sys
from polycnc.machine import Store, StoreError

store = Store(sys.argv[1])
macros = store.area("macros", int)
for number in range(1, 51):
    macros[number] = 3 * number
child = os.fork()
if child == 0:
    way = sys.argv[2]
    if way == "use":
        refused = 0
        uses = (
            lambda: macros[7],
            lambda: macros.put(7, 1),
            lambda: store.snapshot("x"),
            lambda: store.restore("x"),
            lambda: store.transaction().__enter__(),
        )
        for use in uses:
            try:
                use()
            except StoreError as error:
                refused += "belongs to the process that opened it" in str(error)
        if refused != 5:
            os._exit(3)
    elif way == "close":
        store.close()
        store.close()
    elif way == "forget":
        del store, macros
        gc.collect()
    sys.exit(0)  # with all that an interpreter does at its end
if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) != 0:
    sys.exit(1)
for number in range(51, 101):
    macros[number] = 3 * number
    print(number, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.parametrize("way", ["exit", "use", "close", "forget"])
def test_a_forked_child_that_ends_takes_nothing_of_its_parent_away(tmp_path: Path, way: str) -> None:
    path = tmp_path / "machine.db"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    process = subprocess.run(
        [sys.executable, "-c", FORKER, str(path), way],
        capture_output=True,
        text=True,
        env=environment,
        cwd=tmp_path,
        check=False,
    )
    assert process.returncode < 0, process.stderr
    assert process.stdout.split()[-1] == "100"
    with Store(path) as store:
        assert store.area("macros", int).load() == {number: 3 * number for number in range(1, 101)}
        assert store.query("PRAGMA integrity_check") == [("ok",)]
    assert not (tmp_path / "x").exists()


# Forks in the middle of a transaction; the child leaves it in the way of the second argument.
INSIDE = """
import os, signal, sys
from polycnc.machine import Store, StoreError

store = Store(sys.argv[1])
macros = store.area("macros", int)
macros[1] = 3
with store.transaction():
    macros[2] = 6
    child = os.fork()
    if child == 0:
        try:
            macros[9] = 9
        except StoreError:
            sys.exit(0 if sys.argv[2] == "exit" else "error")
    os.waitpid(child, 0)
    macros[3] = 9
macros[4] = 12
print("4", flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
@pytest.mark.parametrize("way", ["exit", "error"])
def test_a_child_that_comes_out_of_a_transaction_leaves_it_to_its_parent(tmp_path: Path, way: str) -> None:
    path = tmp_path / "machine.db"
    process = python(INSIDE, path, way, status=None)
    assert process.stdout == "4\n", process.stderr
    with Store(path) as store:
        assert store.area("macros", int).load() == {1: 3, 2: 6, 3: 9, 4: 12}


# Hands the store to children that are killed in the middle of using what they have inherited.
KILLED_CHILDREN = """
import os, signal, sys
from polycnc.machine import Store

store = Store(sys.argv[1])
macros = store.area("macros", int)
for number in range(1, 21):
    macros[number] = 7 * number
    child = os.fork()
    if child == 0:
        memory = Store()
        memory.area("macros", int)[number] = number
        os.kill(os.getpid(), signal.SIGKILL)
    os.waitpid(child, 0)
    print(number, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_children_that_are_killed_take_nothing_away(tmp_path: Path) -> None:
    path = tmp_path / "machine.db"
    done = python(KILLED_CHILDREN, path, status=-signal.SIGKILL)
    assert done.stdout.split()[-1] == "20", done.stderr
    with Store(path) as store:
        assert store.area("macros", int).load() == {number: 7 * number for number in range(1, 21)}
