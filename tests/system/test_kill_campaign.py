"""Processes that are killed at any moment of any write: nothing acknowledged is lost, nothing is left half done.

Every kind of write has a writer that says what it has acknowledged, line by line; it is killed at a moment that its
seed decides, and what it leaves is held to what it said. The ordinary run kills each a few times, with the mark
`long` as often as ``--kills`` says.
"""

from __future__ import annotations

import contextlib
import json
import random
import sqlite3
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.fanuc import PowerMate
from polycnc.machine import Store
from polycnc.nc import ProgramText
from polycnc.runner import run
from support.programs import MILL
from support.started import started_python

FEW = 1

# Each line on standard output is a number: what has the numbers up to it is acknowledged.
STORE = """
import itertools, sys
from polycnc.machine import Store
store = Store(sys.argv[1] + "/m.db")
macros, alarms = store.area("macros", int), store.history("alarms")
for number in itertools.count(len(macros) + 1):
    with store.transaction():
        macros[number] = number * 7
        alarms.append({"number": number})
    print(number, flush=True)
"""

SNAPSHOT = """
import itertools, sys
from polycnc.machine import Store
store = Store()
macros = store.area("macros", int)
for number in itertools.count(1):
    macros.save({each: number for each in range(300)})
    store.snapshot(sys.argv[1] + "/m.db")
    print(number, flush=True)
"""

OUTPUT = """
import itertools, sys
from pathlib import Path
from polycnc.outputs import complete_or_absent
for number in itertools.count(1):
    with complete_or_absent(Path(sys.argv[1], "t.csv"), durable=True) as partial:
        with partial.open("w") as file:
            for _ in range(200):
                file.write(f"{number},{number * 7}\\n" * 20)
                file.flush()
    print(number, flush=True)
"""

TRACE = """
import itertools, sys
from pathlib import Path
import numpy as np
from polycnc.machine import load_machine
from polycnc.runner import TraceWriter
config = load_machine("mill3")
for number in itertools.count(1):
    with TraceWriter(Path(sys.argv[1], "t.csv"), config, False) as trace:
        for _ in range(5):
            trace.add(np.full((300, 7), float(number)))
    print(number, flush=True)
"""

POST = """
import itertools, sys
from pathlib import Path
from polycnc.runner import post_file
folder = Path(sys.argv[1])
source = folder.parent / f"{folder.name}.cls"
for number in itertools.count(1):
    points = "".join(f"GOTO/{number},{k},0\\n" for k in range(300))
    source.write_text(f"PARTNO A\\nFROM/0,0,0\\nFEDRAT/300\\n{points}FINI\\n")
    post_file(source, "din", folder / "p.nc")
    print(number, flush=True)
"""

LIBRARY = """
import itertools, sys
from polycnc.controllers.fanuc import PowerMate, fwlib
control = PowerMate(memory=sys.argv[1] + "/m.db")
fwlib.attach(0, control, None)
code, handle = fwlib.cnc_allclibhndl()
for number in itertools.count(int(sys.argv[2]) + 1):
    program = number % 20 + 1
    fwlib.cnc_delete(handle, program)
    text = f"\\nO{program}\\n" + f"N10 G1 X{number}. F100\\n" * 20 + "M30\\n%"
    assert fwlib.cnc_dwnstart(handle) == 0
    for at in range(0, len(text), 200):
        piece = text[at : at + 200]
        assert fwlib.cnc_download(handle, piece, len(piece)) == 0
    assert fwlib.cnc_dwnend(handle) == 0
    assert fwlib.cnc_wrmacro(handle, 500 + number % 32, 10, number * 7, 0) == 0
    assert fwlib.cnc_wrtofs(handle, number % 32 + 1, 0, 8, number * 3) == 0
    print(number, flush=True)
"""

BOARD = """
import itertools, sys
from pathlib import Path
from polycnc.controllers.apci import Board, pcap, sap
folder = Path(sys.argv[1])
(slot,) = pcap.attach(Board(), clock=None, folder=folder.parent, memory=folder / "m.db")
pcap.InitMcuSystem3(pcap.tsrp_array(), pcap.ROSI(), 0, "system.dat")
for number in itertools.count(int(sys.argv[2]) + 1):
    slot.board.eprom_cycles = number * 3
    slot.stop()
    slot.write_environment("Number", str(number) * 90)
    slot.running = True
    lines = f"  ci[{number % 2 + 1}] := {number * 3};\\n" * 40
    program = sap.compile_program(f"program p;\\nbegin\\n{lines}end.\\n", "p.sap", number % 4)
    file = folder.parent / f"{folder.name}.CNC"
    file.write_bytes(sap.write_cnc(program))
    assert pcap.txbf2(file.name) == 0
    print(number, flush=True)
"""

CPL = """
import itertools, sys
from pathlib import Path
from polycnc.machine import load_machine
from polycnc.nc import ProgramText
from polycnc.runner import run
folder, mill = Path(sys.argv[1]), load_machine("mill3")
for number in itertools.count(int(sys.argv[2]) + 1):
    records = "".join(f'{10 + k} PRN#(1,"{number} {k} {number * 7}")\\n' for k in range(30))
    text = f'1 OPENW(1,"P{number % 5}",3000)\\n2 REWRITE(1)\\n{records}70 CLOSE(1)\\n'
    text += f"80 @5%={number} : @_R(7)={number}*0.25\\n"
    result = run(ProgramText.from_text(text, str(folder / "main.npg")), mill, "bosch", root=folder)
    assert not result.alarms
    print(number, flush=True)
"""

BATCH = """
import sys
from pathlib import Path
from polycnc import batch
folder, first = Path(sys.argv[1]), int(sys.argv[2])
parts = folder / "parts"
parts.mkdir(exist_ok=True)
for number in range(1, first + 41):
    (parts / f"{number:04}.nc").write_text(f"G1 X{number} F900\\n")
batch(parts, jobs=1, done=folder / "m.done", progress=lambda done, total: done > first and print(done, flush=True))
"""


def _check_store(folder: Path, said: int) -> None:
    with Store(folder / "m.db") as store:
        found = store.area("macros", int).load()
        alarms = [entry.content["number"] for entry in store.history("alarms").read()]
    assert len(found) in (said, said + 1)
    assert found == {number: number * 7 for number in range(1, len(found) + 1)}
    assert alarms == list(found)


def _check_snapshot(folder: Path, said: int) -> None:
    if said == 0 and not (folder / "m.db").exists():
        return
    with Store(folder / "m.db") as store:
        found = set(store.area("macros", int).load().values())
        assert len(store.area("macros", int)) == 300
    assert found in ({said}, {said + 1})


def _check_output(folder: Path, said: int) -> None:
    if said == 0 and not (folder / "t.csv").exists():
        return
    lines = (folder / "t.csv").read_text().splitlines()
    assert len(lines) == 4000
    assert set(lines) <= {f"{said},{said * 7}"} or set(lines) <= {f"{said + 1},{said * 7 + 7}"}


def _check_trace(folder: Path, said: int) -> None:
    if said == 0 and not (folder / "t.csv").exists():
        return
    lines = (folder / "t.csv").read_text().splitlines()[1:]
    assert len(lines) == 1500
    assert {line.split(",")[1] for line in lines} in ({f"{said}"}, {f"{said + 1}"})


def _check_post(folder: Path, said: int) -> None:
    if said == 0 and not (folder / "p.nc").exists():
        return
    lines = (folder / "p.nc").read_text().splitlines()
    assert any(f"X{said}" in line for line in lines) or any(f"X{said + 1}" in line for line in lines)
    assert "Y299" in "".join(lines[-6:])


def _check_library(folder: Path, said: int) -> None:
    control = PowerMate(memory=folder / "m.db")
    try:
        there = {each.number for each in control.programs.directory()}
        for number in range(max(1, said - 19), said + 1):
            if number % 20 == (said + 1) % 20:
                continue  # it may have been deleted, to be written anew
            text = control.programs.read(number % 20 + 1)
            assert text.count(b"N10G1X%d.F100" % number) == 20
            assert b"M30" in text
        if (said + 1) % 20 + 1 in there:  # before or after, never in between
            text = control.programs.read((said + 1) % 20 + 1)
            assert {text.count(b"X%d.F" % (said + 1)), text.count(b"X%d.F" % (said - 19))} == {0, 20}
        for number in range(max(1, said - 31), said + 1):
            after = (number + 32) * 7 if number == said - 31 else number * 7
            assert control.macros.get(500 + number % 32) in (number * 7, after)
            assert control.tool_offsets.get(number % 32 + 1) is not None
    finally:
        control.close()


def _check_board(folder: Path, said: int) -> None:
    with Store(folder / "m.db") as store:
        cycles = store.area("apci.board0.eeprom", int).load()["cycles"]
        strings = store.area("apci.board0.environment", str).load()
        programs = store.area("apci.board0.tasks", bytes).load()
    assert cycles in (said * 3, said * 3 + 3)
    assert strings["Number"] in (str(said) * 90, str(said + 1) * 90)
    for number in range(max(1, said - 2), said + 1):
        program = sap.read_cnc(programs[number % 4])  # which has a check sum
        assert sum(code[:2] == ("const", number * 3) for code in program.code) == 40


def _check_cpl(folder: Path, said: int) -> None:
    for number in range(max(1, said - 3), said + 1):
        records = "".join(f"{number} {k} {number * 7}\n" for k in range(30))
        assert (folder / f"P{number % 5}").read_bytes() == records.encode() + b"\x03\n"
    found = run(
        ProgramText.from_text("1 #A%=@5% : #B=@_R(7)\n", str(folder / "main.npg")), MILL, "bosch", root=folder
    ).variables
    assert (found["#A%"], found["#B"]) in ((said, said * 0.25), (said + 1, (said + 1) * 0.25))


def _check_batch(folder: Path, said: int) -> None:
    if said == 0 and not (folder / "m.done").exists():
        return
    with contextlib.closing(sqlite3.connect(folder / "m.done")) as store:
        found = [json.loads(text) for (text,) in store.execute("SELECT report FROM report")]
    assert len(found) >= said
    for report in found:
        assert report["extents"][0] == ["X", 0.0, float(Path(report["program"]).stem)]


@dataclass(frozen=True)
class Write:
    """A kind of write: its writer, what is held to what it said, and how far on it is killed, in lines."""

    script: str
    check: Callable[[Path, int], None]
    lines: int


WRITES = {
    "store": Write(STORE, _check_store, 60),
    "snapshot": Write(SNAPSHOT, _check_snapshot, 12),
    "output": Write(OUTPUT, _check_output, 12),
    "trace": Write(TRACE, _check_trace, 6),
    "post": Write(POST, _check_post, 6),
    "library": Write(LIBRARY, _check_library, 12),
    "board": Write(BOARD, _check_board, 12),
    "cpl": Write(CPL, _check_cpl, 6),
    "batch": Write(BATCH, _check_batch, 12),
}


def kill_once(write: Write, folder: Path, chance: random.Random, said: int) -> int:
    """Let a writer write, kill it at a moment of chance, check what it leaves; return what it has acknowledged."""
    with started_python(write.script, folder, str(said)) as process:
        lines = [process.stdout.readline() for _ in range(chance.randint(1, write.lines))]
        time.sleep(chance.random() * 0.02)  # anywhere within the next writes
        process.kill()
        lines += process.stdout.readlines()
        _, errors = process.communicate(timeout=60)
    assert lines[0], errors
    said = max(said, *(int(line) for line in lines if line.endswith("\n")))
    write.check(folder, said)
    left = [path.name for path in folder.iterdir() if ".partial" in path.name]
    assert len({path.split(".partial")[0] for path in left}) <= 1, (
        left
    )  # of this kill; the next writer sweeps it
    return said


def _campaign(name: str, folder: Path, kills: int, seed: int) -> None:
    chance = random.Random(f"{name} {seed}")
    grows = name in ("store", "library", "board", "cpl", "batch")
    said = 0
    for number in range(kills):
        at = folder / "lasting" if grows else folder / str(number)
        at.mkdir(exist_ok=True)
        found = kill_once(WRITES[name], at, chance, said if grows else 0)
        assert found > said or not grows
        said = found


@pytest.mark.parametrize("name", WRITES)
def test_a_killed_process_loses_nothing_acknowledged(name: str, tmp_path: Path) -> None:
    _campaign(name, tmp_path, FEW, 5)


@pytest.mark.long
@pytest.mark.timeout(0)
@pytest.mark.parametrize("name", WRITES)
def test_many_kills(name: str, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    _campaign(name, tmp_path, int(request.config.getoption("--kills")), 11)
