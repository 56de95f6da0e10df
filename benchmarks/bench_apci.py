"""Time the APCI board: 18 axes that work through their spoolers, commands that fill these, and what polls."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence

from _measure import Figure, at_least
from _report import run_script
from polycnc.controllers.apci import pcap, sap
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._move_commands import Speeds, mlr
from polycnc.controllers.apci.board._spool_commands import ssms
from polycnc.controllers.apci.board._system_file import parse_system_file
from polycnc.controllers.apci.core._registers import ModeReg
from polycnc.controllers.apci.sap._board_host import BoardTasks

RUNS = 3
AXES = 18
ENTRIES = 900  # in the spooler at once
SCANS_PER_LINE = 20
GOES_ON = Speeds(1e5, 1000.0, 1000.0)
POLLING = (
    "BEGIN REPEAT wt (3.3) UNTIL CI8 = 5 END.",
    "BEGIN REPEAT UNTIL A2.axst AND 1024 <> 0 END.",
    "BEGIN REPEAT UNTIL CI7 = 3 END.",
    "BEGIN REPEAT UNTIL A3.digi AND 4 <> 0 END.",
)
POLLING_AXES = (  # of moving axes: other values in every scan
    "BEGIN REPEAT UNTIL A1.rp > 1e9 END.",
    "BEGIN WHILE (A2.dp < 1e9) AND (A2.rv > -1e9) DO; END.",
    "VAR n: INTEGER; BEGIN n := 0; REPEAT IF ABS (A3.PosErr) > 1e6 THEN n := n + 1 UNTIL n > 5 END.",
    "EVENT e ON A4.rp > 1e9; BEGIN CI5 := 1 END; BEGIN WHILE A4.lsm < 1000000 DO; END.",
)
CALLS = 20_000


def closed_board(mode: int = 0) -> Board:
    """Return a board of 18 axes with closed loops."""
    board = Board(parse_system_file(f"number_of_axes = {AXES}"))
    board.modereg = mode
    cl(board, range(AXES))
    board.advance(1)
    return board


def fill(board: Board, axes: range) -> float:
    """Spool lines of `axes`; return the seconds that took."""
    step = 1000.0 * board.config.sample_time_s * SCANS_PER_LINE / len(axes) ** 0.5
    distances = [step] * len(axes)
    begin = time.process_time()
    for _ in range(ENTRIES):
        mlr(board, axes, distances, GOES_ON, spool=True)
    return time.process_time() - begin


def run(board: Board, scans: int) -> float:
    """Start all spoolers and run scans; return the seconds that took."""
    ssms(board, range(AXES))
    begin = time.process_time()
    board.advance(scans)
    spent = time.process_time() - begin
    assert board.axes[0].queued > 0, "the spooler ran empty"
    assert not board.axes[0].row["saf"]
    return spent


def rate_polling(programs: Sequence[str], scans: int) -> float:
    """Let 18 axes interpolate while programs poll in the board's tasks; return board seconds per processor second."""
    board = closed_board()
    tasks = BoardTasks(board)
    for number, text in enumerate(programs):
        tasks.load(sap.compile_program(text, task=number))
        tasks.startcnct(number)
    fill(board, range(AXES))
    return scans * board.config.sample_time_s / run(board, scans)


def polled_calls() -> float:
    """Let a program of the PC read a status again and again, a scan each; return calls per processor second."""
    pcap.attach(Board(parse_system_file(f"number_of_axes = {AXES}")))
    records = pcap.tsrp_array()
    pcap.InitMcuSystem3(records, pcap.ROSI(), 0, "system.dat")
    record = records[3]
    pcap.rdaxst(record)
    begin = time.process_time()
    before = pcap.board().clock.cycles
    for _ in range(CALLS):
        pcap.rdaxst(record)
    spent = time.process_time() - begin
    assert pcap.board().clock.cycles - before >= CALLS
    pcap.detach()
    return CALLS / spent


def figures(quick: bool) -> list[Figure]:
    """Measure and return the figures."""
    scans = (ENTRIES - 20) * SCANS_PER_LINE
    runs = 1 if quick else RUNS
    warm = closed_board(int(ModeReg.lookahead))
    fill(warm, range(2))
    run(warm, 10)
    rates: list[float] = []
    spooled: dict[str, list[float]] = {"3 axes": [], "3 axes, look-ahead": [], "18 axes": []}
    for _ in range(runs):
        board = closed_board()
        spooled["18 axes"].append(ENTRIES / fill(board, range(AXES)))
        rates.append(scans * board.config.sample_time_s / run(board, scans))
        spooled["3 axes"].append(ENTRIES / fill(closed_board(), range(3)))
        spooled["3 axes, look-ahead"].append(ENTRIES / fill(closed_board(int(ModeReg.lookahead)), range(3)))
    found = [at_least("18 axes interpolate from their spoolers", statistics.median(rates), "x real", 1000.0)]
    rate_polling(POLLING_AXES[:1], SCANS_PER_LINE)  # compiles
    for name, programs in (
        ("SAP polling: four tasks, a time, a status, a variable, an input", POLLING),
        ("SAP polling: one task, the position of a moving axis", POLLING_AXES[:1]),
        ("SAP polling: four tasks, positions, a speed, a deviation, an event", POLLING_AXES),
    ):
        rate = statistics.median(rate_polling(programs, scans) for _ in range(runs))
        found.append(at_least(name, rate, "x real", 500.0))
    calls = statistics.median(polled_calls() for _ in range(runs))
    found.append(Figure("a polled call (rdaxst, one scan each)", calls, "1/s"))
    for name, each in spooled.items():
        rate = statistics.median(each)
        title = f"lines spooled from Python, {name}"
        found.append(
            at_least(title, rate, "1/s", 50_000.0) if name == "3 axes" else Figure(title, rate, "1/s")
        )
    return found


if __name__ == "__main__":
    run_script("APCI board", figures)
