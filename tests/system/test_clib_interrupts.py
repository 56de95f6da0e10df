"""The program's routine for interrupts of a board: called between calls, replaced, lost and found, left behind."""

from __future__ import annotations

import asyncio
import ctypes
import subprocess
import threading
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import Board, load_system_file, pcap
from polycnc.servers.process import Machinery
from support.c_library import Door, at_door, built, loaded
from support.command import environment
from support.facade_programs import SYSTEM

EXAMPLES = Path(__file__).parents[2] / "examples" / "c"
WARNINGS = ("-Wall", "-Wextra", "-Werror", "-pedantic")
DRILLED = "init 0\ninstall 0\nat 37.500 4.250\ncalled 1, lines 1, requested 1\nother calls meanwhile: none\nremove 0\n"
FORKS = """\
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include "mcug3.h"
static TSRP tsrp[MAXAXIS];
static void PC_CALL routine(int lines) { (void)lines; }
int main(void)
{
    ROSI rosi;
    double value = -1.0;
    int type, state = -1;
    if (InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type) || MCUG3_SetBoardIntRoutine(routine))
        return 1;
    if (!fork()) {
        MCUG3_ResetBoardIntRoutine();
        exit(InitMcuSystem3(tsrp, &rosi, 0, "system.dat", &type) || rdtrvl(&value) ? 2 : 0);
    }
    wait(&state);
    printf("child %d, parent %d\\n", WEXITSTATUS(state), rdtrvl(&value));
    return 0;
}
"""


def _run(door: Door, source: Path, to: Path) -> tuple[str, int]:
    folder, made = built("apci"), to / "client"
    subprocess.run(
        ["gcc", "-std=gnu11", *WARNINGS, "-I", folder, "-o", made, source, "-L", folder, "-lmcug3",
         f"-Wl,-rpath,{folder}"], check=True,
    )  # fmt: skip
    ran = subprocess.run(
        [made], env=environment(POLYCNC_CALLS=door.place), capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    return ran.stdout, ran.returncode


def _compile_motion() -> None:
    """Move a board once: what is compiled then would take longer than a program waits for an answer."""
    board, session = Board(load_system_file(SYSTEM)), pcap.Session()
    session.attach(board)
    table = pcap.AS(unoa=2)
    table.san[1] = 1
    session.InitMcuSystem(pcap.tsrp_array())
    session.cl(table)
    session.smla(table, pcap.LMP(ac=500.0, vl=80.0))
    session.ssms(table)
    board.advance(200)


@pytest.mark.covers("apci.MCUG3_SetBoardIntRoutine", "apci.MCUG3_ResetBoardIntRoutine", "apci.ssf.1101")
def test_a_routine_is_called_where_the_spooler_says_and_no_call_ends_meanwhile(tmp_path: Path) -> None:
    _compile_motion()
    door = Door(("apci", Machinery(file=SYSTEM)), running=True)
    try:
        assert _run(door, EXAMPLES / "apci_interrupts.c", tmp_path) == (DRILLED, 0)
    finally:
        door.close()


def test_a_fork_and_an_exit_while_a_routine_is_installed_are_harmless(tmp_path: Path) -> None:
    source = tmp_path / "forks.c"
    source.write_text(FORKS)
    door = Door(("apci", Machinery(file=SYSTEM)))
    try:
        assert _run(door, source, tmp_path) == ("child 0, parent 0\n", 0)
    finally:
        door.close()


class Routine:
    """A routine of a program, as C has it."""

    def __init__(self) -> None:
        self.came, self.lines = threading.Semaphore(0), list[int]()
        self.c = ctypes.CFUNCTYPE(None, ctypes.c_int)(self._call)

    def _call(self, lines: int) -> None:
        self.lines.append(lines)
        self.came.release()


def _interrupt(door: Door) -> None:
    """Let the board interrupt the PC, and take the request back."""

    async def rise() -> None:
        board: Any = door.devices[0]
        board.raise_interrupt(True)
        board.raise_interrupt(False)

    assert door.loop is not None
    asyncio.run_coroutine_threadsafe(rise(), door.loop).result(60)


def test_a_routine_is_replaced_removed_lost_and_found(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    library, first, second = loaded("apci", tmp_path), Routine(), Routine()
    monkeypatch.setenv("POLYCNC_CALLS", "127.0.0.1:1")
    assert library.MCUG3_SetBoardIntRoutine(first.c) == -4  # nobody is there
    door = Door(("apci", Machinery(file=SYSTEM)))
    at_door(monkeypatch, door)
    records = (pcap.TSRP * 18)()
    assert library.InitMcuSystem(records) == 0
    assert library.MCUG3_SetBoardIntRoutine(None) == 1
    assert library.MCUG3_SetBoardIntRoutine(first.c) == 0
    for _ in range(3):
        _interrupt(door)
        assert first.came.acquire(timeout=60)
    assert library.MCUG3_SetBoardIntRoutine(second.c) == 0
    _interrupt(door)
    assert second.came.acquire(timeout=60)
    door.close()
    assert library.rdtrvl(ctypes.byref(ctypes.c_double())) == -4
    again = Door(("apci", Machinery(file=SYSTEM)))
    try:
        at_door(monkeypatch, again)
        assert library.InitMcuSystem(records) == 0
        _interrupt(again)
        assert second.came.acquire(timeout=60)
        assert library.MCUG3_ResetBoardIntRoutine() == 0
        _interrupt(again)
        assert library.InitMcuSystem(records) == 0
        assert (first.lines, second.lines) == ([1, 1, 1], [1, 1])
    finally:
        again.close()
