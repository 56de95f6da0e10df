"""Programs that poll: what they do is, scan by scan and bit by bit, what giving them every turn does, only sooner."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._jog_commands import jr
from polycnc.controllers.apci.board._system_file import SystemFile, parse_system_file
from polycnc.controllers.apci.sap._board_host import BoardTasks
from polycnc.controllers.apci.sap._task import Task

SYSTEM = """
[[axis]]
name = "A1"
[[axis]]
name = "A2"
[inputs]
3 = { functions = ["REF"], axes = ["A2"] }
"""

PROGRAMS = {
    "a common variable": "BEGIN REPEAT UNTIL CI7 = 3; CI8 := CI8 + 5 END.",
    "again and again": "BEGIN WHILE TRUE DO BEGIN WHILE CI7 < 2 DO; CI8 := CI8 + CI7; WHILE CI7 >= 2 DO; END END.",
    "a position": "BEGIN REPEAT UNTIL A1.rp > 2.5; CD4 := A1.rp; REPEAT UNTIL A1.rp <= 1.25; CD5 := A1.dp END.",
    "a status": "BEGIN WHILE A1.axst AND 1024 <> 0 DO; CI9 := A1.axst; WHILE A1.axst AND 1024 = 0 DO; CD6 := A1.rp END.",
    "an input": "BEGIN REPEAT UNTIL A2.digi AND 4 <> 0; CI10 := A2.digi END.",
    "an event": "EVENT e ON CI7 = 4; BEGIN CI11 := CI11 + 1 END; BEGIN WHILE TRUE DO; END.",
    "an event in a wait": "EVENT e ON A1.rp > 1.5; BEGIN CI11 := CI11 + 1; CD7 := A1.rp END; BEGIN wt (2700.0); CI12 := 1 END.",
    "short waits": "BEGIN REPEAT wt (3.3); UNTIL CI7 = 5; CI13 := 17; REPEAT wt (1.3); wt (5.2) UNTIL CI7 = 1; CI13 := 19 END.",
    "waits for axes": "BEGIN WHILE TRUE DO BEGIN wt (A1); IF CI7 = 6 THEN CI14 := CI14 + 1; wt (4.0) END END.",
    "memory": "VAR i: INTEGER; x: DOUBLE; BEGIN REPEAT x := A2.rp * 2.0; FOR i := 1 TO 3 DO x := x + 0.25; UNTIL CI7 = 2; CD8 := x END.",
    "a function": "FUNCTION f (a: INTEGER): INTEGER; BEGIN f := a * 3 - CI7 END; BEGIN REPEAT UNTIL f (2) = 1; CI15 := f (7) END.",
    "a long loop": "VAR i: INTEGER; BEGIN REPEAT FOR i := 1 TO 37 DO; UNTIL CI7 = 4; CI16 := i END.",
    "a count": "VAR i: INTEGER; BEGIN REPEAT i := i + 1 UNTIL CI7 = 3; CI17 := i END.",
    "a heartbeat": "BEGIN WHILE TRUE DO BEGIN CI20 := CI20 + 1; IF CI7 = 5 THEN stopcnct (0); IF CI7 = 6 THEN contcnct (0) END END.",
    "a buffer": "BEGIN REPEAT UNTIL RDCBI (8) = 77; CI18 := RDCBI (12) END.",
    "moves": "BEGIN cl (A2); A2.jac := 100; A2.jvl := 20; WHILE TRUE DO BEGIN REPEAT UNTIL CI7 = 1; jr (A2 := 0.5); wt (A2); REPEAT UNTIL CI7 <> 1 END END.",
    "latches": "BEGIN WHILE A2.lp = 0.0 DO; CD9 := A2.lp END.",
    "the queue": "BEGIN WHILE A1.MCiS = 0 DO; CI19 := A1.lsm END.",
}


def rig(fast: bool, monkeypatch: pytest.MonkeyPatch) -> tuple[Board, BoardTasks]:
    """Return a board with tasks that are looked at for polling, or given every turn."""
    board = Board(parse_system_file(SYSTEM))
    tasks = BoardTasks(board)
    for task in tasks.tasks._tasks:
        if not fast:
            monkeypatch.setattr(task, "poll", lambda budget: None)
    return board, tasks


def picture(board: Board, tasks: BoardTasks) -> tuple[object, ...]:
    """Return all that can be seen of board and tasks, as bits."""
    state = board.state
    arrays = (state.axis, state.ci, state.cd, board.kernel.servo.actual, board.kernel.base)
    seen: list[object] = [array.tobytes() for array in arrays]
    for number, task in enumerate(tasks.tasks._tasks):
        seen.append(tasks.tasks.rdcncts(number))
        seen.append((task.next, task.base, repr(task.stack), repr(task.memory), task.frames, task.waiting))
    return tuple(seen)


def _script(seed: int) -> list[tuple[int, Callable[[Board, BoardTasks], None]]]:
    """Return what happens from outside: after how many scans, what."""
    rng = random.Random(seed)
    steps: list[tuple[int, Callable[[Board, BoardTasks], None]]] = []
    for _ in range(30):
        value, level, way = rng.randrange(8), rng.random() < 0.5, rng.uniform(-3.0, 5.0)
        choices: list[Callable[[Board, BoardTasks], None]] = [
            lambda board, tasks, value=value: board.state.ci.__setitem__(7, value),
            lambda board, tasks, value=value: board.state.ci.__setitem__(7, value),
            lambda board, tasks, level=level: board.set_input(3, level),
            lambda board, tasks, way=way: jr(board, (0,), (way,)),
            lambda board, tasks, value=value: tasks.tasks.wrcbcnct(
                value % 4, 16, bytes([value] * 8 + [77, 0, 0, 0, 5, 6, 7, 0])
            ),
            lambda board, tasks, value=value: (tasks.tasks.stopcnct, tasks.tasks.contcnct)[value % 2](
                value // 2
            ),
        ]
        steps.append((rng.choice((1, 2, 3, 40, 170, 330)), rng.choice(choices)))
    return steps


@pytest.mark.parametrize("seed", range(12))
def test_polling_tasks_do_bit_for_bit_what_every_turn_would_do(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = random.Random(seed).sample(sorted(PROGRAMS), 4)
    pictures = []
    for fast in (True, False):
        board, tasks = rig(fast, monkeypatch)
        cl(board, (0,))
        board.axes[0].jac, board.axes[0].jvl = 60.0, 9.0
        for number, name in enumerate(names):
            tasks.load(sap.compile_program(PROGRAMS[name], task=number))
            tasks.tasks.startcnct(number)
        seen = []
        for scans, act in _script(seed):
            board.advance(scans)
            seen.append(picture(board, tasks))
            act(board, tasks)
        pictures.append(seen)
    for k, (quick, slow) in enumerate(zip(*pictures, strict=True)):
        assert quick == slow, (names, k)


@pytest.mark.parametrize(
    "name", ["a common variable", "a status", "an event", "short waits", "a function", "a long loop"]
)
def test_a_task_that_polls_needs_no_turns_while_nothing_changes(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    turns = []
    run = Task.run
    monkeypatch.setattr(Task, "run", lambda self, budget: (turns.append(1), run(self, budget))[1])
    board, tasks = rig(True, monkeypatch)
    for number in range(4):
        tasks.load(sap.compile_program(PROGRAMS[name], task=number))
        tasks.tasks.startcnct(number)
    board.advance(1000)
    before = len(turns)
    board.advance(300)
    assert len(turns) == before


def test_a_position_that_is_polled_ends_the_scan_in_which_it_is_reached() -> None:
    board = Board(SystemFile())
    tasks = BoardTasks(board)
    cl(board, (0,))
    board.axes[0].jac, board.axes[0].jvl = 60.0, 9.0
    tasks.load(sap.compile_program("BEGIN REPEAT UNTIL A1.rp >= 1.5; CD0 := A1.rp; js (A1) END."))
    tasks.tasks.startcnct(0)
    board.advance(50)
    jr(board, (0,), (7.0,))
    board.advance(2000)
    assert 1.5 <= float(board.state.cd[0]) < 1.5 + 9.0 * board.clock.cycle_s


def test_a_task_stopped_by_another_one_stands_where_its_last_turn_has_left_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = []
    for fast in (True, False):
        board, tasks = rig(fast, monkeypatch)
        tasks.load(
            sap.compile_program(
                "VAR i: INTEGER; BEGIN REPEAT i := 3 - i; i := CI7 UNTIL CI7 = 9 END.", task=0
            )
        )
        tasks.load(sap.compile_program("BEGIN wt (250.0); stopcnct (0); CI1 := 1 END.", task=1))
        for number in range(2):
            tasks.tasks.startcnct(number)
        board.advance(400)
        assert board.state.ci[1] == 1
        seen.append(picture(board, tasks))
    assert seen[0] == seen[1]
