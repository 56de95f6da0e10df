"""Programs that poll: what they do is, scan by scan and bit by bit, what giving them every turn does, only sooner."""

from __future__ import annotations

import random
from dataclasses import dataclass

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._board import Board
from polycnc.controllers.apci.board._jog_commands import jr
from polycnc.controllers.apci.board._system_file import SystemFile, parse_system_file
from polycnc.controllers.apci.sap._board_host import BoardTasks
from polycnc.controllers.apci.sap._task import Task
from support.often import often
from support.sap_on_board import TWO_AXES

PROGRAMS = {
    "a common variable": "BEGIN REPEAT UNTIL CI7 = 3; CI8 := CI8 + 5 END.",
    "again and again": (
        "BEGIN WHILE TRUE DO BEGIN WHILE CI7 < 2 DO; CI8 := CI8 + CI7; WHILE CI7 >= 2 DO; END END."
    ),
    "a position": (
        "BEGIN REPEAT UNTIL A1.rp > 2.5; CD4 := A1.rp; REPEAT UNTIL A1.rp <= 1.25; CD5 := A1.dp END."
    ),
    "a status": (
        "BEGIN WHILE A1.axst AND 1024 <> 0 DO; CI9 := A1.axst; WHILE A1.axst AND 1024 = 0 DO; "
        "CD6 := A1.rp END."
    ),
    "an input": "BEGIN REPEAT UNTIL A2.digi AND 4 <> 0; CI10 := A2.digi END.",
    "an event": "EVENT e ON CI7 = 4; BEGIN CI11 := CI11 + 1 END; BEGIN WHILE TRUE DO; END.",
    "an event in a wait": (
        "EVENT e ON A1.rp > 1.5; BEGIN CI11 := CI11 + 1; CD7 := A1.rp END; BEGIN wt (2700.0); CI12 := 1 END."
    ),
    "short waits": (
        "BEGIN REPEAT wt (3.3); UNTIL CI7 = 5; CI13 := 17; REPEAT wt (1.3); wt (5.2) UNTIL CI7 = "
        "1; CI13 := 19 END."
    ),
    "waits for axes": (
        "BEGIN WHILE TRUE DO BEGIN wt (A1); IF CI7 = 6 THEN CI14 := CI14 + 1; wt (4.0) END END."
    ),
    "memory": (
        "VAR i: INTEGER; x: DOUBLE; BEGIN REPEAT x := A2.rp * 2.0; FOR i := 1 TO 3 DO x := x + "
        "0.25; UNTIL CI7 = 2; CD8 := x END."
    ),
    "a function": (
        "FUNCTION f (a: INTEGER): INTEGER; BEGIN f := a * 3 - CI7 END; BEGIN REPEAT UNTIL f (2) "
        "= 1; CI15 := f (7) END."
    ),
    "a long loop": ("VAR i: INTEGER; BEGIN REPEAT FOR i := 1 TO 37 DO; UNTIL CI7 = 4; CI16 := i END."),
    "a count": "VAR i: INTEGER; BEGIN REPEAT i := i + 1 UNTIL CI7 = 3; CI17 := i END.",
    "a heartbeat": (
        "BEGIN WHILE TRUE DO BEGIN CI20 := CI20 + 1; IF CI7 = 5 THEN stopcnct (0); IF CI7 = 6 "
        "THEN contcnct (0) END END."
    ),
    "a buffer": "BEGIN REPEAT UNTIL RDCBI (8) = 77; CI18 := RDCBI (12) END.",
    "moves": (
        "BEGIN cl (A2); A2.jac := 100; A2.jvl := 20; WHILE TRUE DO BEGIN REPEAT UNTIL CI7 = 1; "
        "jr (A2 := 0.5); wt (A2); REPEAT UNTIL CI7 <> 1 END END."
    ),
    "latches": "BEGIN WHILE A2.lp = 0.0 DO; CD9 := A2.lp END.",
    "the queue": "BEGIN WHILE A1.MCiS = 0 DO; CI19 := A1.lsm END.",
}

BUFFER = bytes([9] * 8 + [77, 0, 0, 0, 5, 6, 7, 0])


def rig(fast: bool, monkeypatch: pytest.MonkeyPatch) -> tuple[Board, BoardTasks]:
    """Return a board with tasks that have their turns in the compiled scan, or every one from Python."""
    board = Board(parse_system_file(TWO_AXES))
    tasks = BoardTasks(board)
    if not fast:
        monkeypatch.setattr(tasks._turns, "_is_worth_it", lambda number: False)
    return board, tasks


def picture(board: Board, tasks: BoardTasks) -> tuple[object, ...]:
    """Return all that can be seen of board and tasks, as bits."""
    state = board.state
    arrays = (state.axis, state.ci, state.cd, board.kernel.servo.actual, board.kernel.base)
    seen: list[object] = [array.tobytes() for array in arrays]
    for number, task in enumerate(tasks.each):
        seen.append(tasks.rdcncts(number))
        task.reclaim_state()
        seen.append((task.next, task.base, repr(task.stack), repr(task.memory), task.frames, task.waiting))
    return tuple(seen)


@dataclass(frozen=True)
class Outside:
    """Something that happens between two calls of the board: what, and with what."""

    after_scans: int
    what: str
    value: int
    way: float

    def act(self, board: Board, tasks: BoardTasks) -> None:
        """Let it happen."""
        if self.what == "variable":
            board.state.ci[7] = self.value
        elif self.what == "input":
            board.set_input(3, self.value > 3)
        elif self.what == "jog":
            jr(board, (0,), (self.way,))
        elif self.what == "buffer":
            board.variables.buffers[self.value % 4][:16] = BUFFER
        else:
            control = tasks.stopcnct if self.value % 2 else tasks.contcnct
            control(self.value // 2)


def _script(seed: int) -> list[Outside]:
    """Return what happens from outside."""
    rng = random.Random(seed)
    kinds = ("variable", "variable", "input", "jog", "buffer", "task")
    return [
        Outside(
            rng.choice((1, 2, 3, 40, 170, 330)), rng.choice(kinds), rng.randrange(8), rng.uniform(-3.0, 5.0)
        )
        for _ in range(30)
    ]


@pytest.mark.parametrize("seed", often(range(12), 3))
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
            tasks.startcnct(number)
        seen = []
        for each in _script(seed):
            board.advance(each.after_scans)
            seen.append(picture(board, tasks))
            each.act(board, tasks)
        pictures.append(seen)
    for k, (quick, slow) in enumerate(zip(*pictures, strict=True)):
        assert quick == slow, (names, k)


@pytest.mark.parametrize(
    "name",
    [
        *("a common variable", "a status", "an event", "an event in a wait", "short waits", "a function"),
        *("a long loop", "a position", "a heartbeat", "the queue", "a buffer", "memory"),
    ],
)
def test_a_task_that_polls_has_its_turns_in_the_compiled_scan(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    turns = []
    run = Task.run

    def counted(self: Task, budget: int) -> None:
        turns.append(1)
        run(self, budget)

    monkeypatch.setattr(Task, "run", counted)
    board, tasks = rig(True, monkeypatch)
    for number in range(4):
        tasks.load(sap.compile_program(PROGRAMS[name], task=number))
        tasks.startcnct(number)
    cl(board, (0,))
    board.axes[0].jac, board.axes[0].jvl = 60.0, 9.0
    board.advance(100)
    jr(board, (0,), (1.25,))
    before = len(turns)
    board.advance(300)
    assert len(turns) == before
    assert board.axes[0].rp > 1.0


def test_a_position_that_is_polled_ends_the_scan_in_which_it_is_reached() -> None:
    board = Board(SystemFile())
    tasks = BoardTasks(board)
    cl(board, (0,))
    board.axes[0].jac, board.axes[0].jvl = 60.0, 9.0
    tasks.load(sap.compile_program("BEGIN REPEAT UNTIL A1.rp >= 1.5; CD0 := A1.rp; js (A1) END."))
    tasks.startcnct(0)
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
            tasks.startcnct(number)
        board.advance(400)
        assert board.state.ci[1] == 1
        seen.append(picture(board, tasks))
    assert seen[0] == seen[1]


@pytest.mark.parametrize("name", ["a common variable", "short waits", "an event", "a function"])
def test_a_snapshot_of_a_polling_board_goes_on_as_the_board_does(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = []
    for fast in (True, False):
        board, tasks = rig(fast, monkeypatch)
        tasks.load(sap.compile_program(PROGRAMS[name]))
        tasks.startcnct(0)
        board.advance(137)
        kept = board.snapshot()
        board.advance(61)
        seen.append(picture(board, tasks))
        board.state.ci[7] = 3
        board.advance(40)
        board.restore(kept)
        assert board.snapshot() == kept
        board.advance(61)
        seen.append(picture(board, tasks))
        board.state.ci[7] = 4
        board.advance(50)
        seen.append(picture(board, tasks))
    assert seen[0] == seen[1] == seen[3] == seen[4]
    assert seen[2] == seen[5]


@pytest.mark.parametrize("instructions", [7, 100, 333])
def test_a_board_may_run_other_numbers_of_instructions_in_a_scan(instructions: int) -> None:
    board = Board(parse_system_file(f"[rulings]\ninstructions_per_scan = {instructions}\n"))
    tasks = BoardTasks(board)
    tasks.load(sap.compile_program("BEGIN WHILE TRUE DO CI3 := CI3 + 1 END."))
    tasks.startcnct(0)
    board.advance(60)
    # a pass: the condition, the jump out, three and a store, the jump back
    assert int(board.state.ci[3]) == pytest.approx(60 * instructions / 7, abs=1)
