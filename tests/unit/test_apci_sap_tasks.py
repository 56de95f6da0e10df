"""Four CNC tasks: starting, stopping, waiting, events, messages and common buffers."""

from __future__ import annotations

import struct

import pytest

from polycnc.controllers.apci import sap
from polycnc.controllers.apci.board._system_file import SystemFile
from support.sap_board import FakeBoard, run_text

COUNT_FOREVER = "WHILE TRUE DO CI0 := CI0 + 1;"


def running(board: FakeBoard, task: int = 0) -> int:
    return board.tasks.rdcncts(task).running


# Four tasks


@pytest.mark.covers("apci.sap", "apci.sap.multitasking", "apci.const.tasks")
def test_four_programs_run_at_the_same_time_with_equal_priority() -> None:
    board = FakeBoard()
    for task in range(4):
        board.start(f"WHILE TRUE DO CI{task} := CI{task} + 1;", task)
    board.advance(50)
    counts = [board.ci(task) for task in range(4)]
    assert counts[0] > 100
    assert counts == counts[:1] * 4
    board.tasks.stopcnct(2)
    board.advance(50)
    assert board.ci(2) == counts[2]
    assert board.ci(1) == board.ci(3) == pytest.approx(2 * counts[1], abs=1)


@pytest.mark.covers("sap.STARTCNCT", "sap.STOPCNCT", "sap.CONTCNCT")
def test_programs_start_stop_and_continue_each_other() -> None:
    board = FakeBoard()
    board.tasks.load(sap.compile_program("CI1 := 0; WHILE TRUE DO CI1 := CI1 + 1;", task=1))
    board.start(
        "STARTCNCT (1); wt (128); STOPCNCT (1); CI2 := CI1; wt (128); CONTCNCT (1); wt (128); STARTCNCT (1);"
    )
    board.advance(99)
    before = board.ci(1)
    assert before > 0
    board.advance(3)
    stopped = board.ci(2)
    assert stopped == board.ci(1)
    assert running(board, 1) == 0
    board.advance(90)
    assert board.ci(1) == stopped
    board.advance(100)
    assert board.ci(1) > stopped  # continued, not started anew
    board.advance(20)
    assert board.ci(1) < stopped  # started anew


def test_a_program_can_stop_and_restart_itself() -> None:
    board = run_text("CI0 := CI0 + 1; IF CI0 < 5 THEN STARTCNCT (0); STOPCNCT (0); CI1 := 1;")
    assert (board.ci(0), board.ci(1), running(board)) == (5, 0, 0)
    board.tasks.contcnct(0)
    board.advance()
    assert board.ci(1) == 1


@pytest.mark.covers("sap.STOP", "apci.contcnct")
def test_stop_is_left_with_contcnct_where_the_program_stood() -> None:
    board = run_text("VAR n : INTEGER; BEGIN n := 5; STOP; CI0 := n + 1; STOP; CI0 := n + 2 END.")
    assert (board.ci(0), running(board)) == (0, 0)
    board.tasks.contcnct(0)
    board.advance()
    assert (board.ci(0), running(board)) == (6, 0)
    board.tasks.contcnct(0)
    board.advance()
    assert (board.ci(0), running(board)) == (7, 0)
    board.tasks.contcnct(0)
    board.advance()
    assert board.ci(0) == 7  # at its end, it stays there


@pytest.mark.covers("sap.ABORT", "apci.contcnct")
def test_after_abort_a_program_can_only_be_restarted() -> None:
    board = run_text("CI0 := CI0 + 1; ABORT; CI0 := 100;")
    board.tasks.contcnct(0)
    board.advance(5)
    assert (board.ci(0), running(board)) == (1, 0)
    board.tasks.startcnct(0)
    board.advance(5)
    assert board.ci(0) == 2


@pytest.mark.covers("apci.startcnct")
def test_startcnct_begins_at_the_beginning_and_stops_a_running_program_first() -> None:
    board = FakeBoard()
    board.start("VAR n : INTEGER; BEGIN CI5 := CI5 + 1; WHILE TRUE DO BEGIN n := n + 1; CI0 := n END END.")
    board.advance(20)
    first = board.ci(0)
    board.tasks.startcnct(0)
    board.advance(20)
    assert (board.ci(5), board.ci(0), running(board)) == (2, first, 1)
    board.tasks.startcnct(1)  # nothing is loaded there
    board.tasks.startcnct(9)
    board.advance()
    assert running(board, 1) == 0


@pytest.mark.covers("apci.stopcnct", "sap.EVENT")
def test_stopcnct_stops_the_program_and_its_event_handlers() -> None:
    board = FakeBoard()
    board.start(f"EVENT e ON CI10 = 1; BEGIN CI1 := CI1 + 1 END; BEGIN {COUNT_FOREVER} END.")
    board.advance(3)
    board.tasks.stopcnct(0)
    count = board.ci(0)
    board.system["ci", 10] = 1
    board.advance(5)
    assert (board.ci(0), board.ci(1), running(board)) == (count, 0, 0)
    board.tasks.contcnct(0)
    board.advance(2)
    assert board.ci(0) > count
    assert board.ci(1) == 1


@pytest.mark.covers("apci.stepcnct")
def test_stepcnct_is_not_implemented_and_does_nothing() -> None:
    board = FakeBoard()
    board.start("CI0 := 1; STOP; CI0 := 2;")
    board.advance()
    before = board.tasks.rdcncts(0)
    board.tasks.stepcnct(0)
    board.advance(3)
    assert board.tasks.rdcncts(0) == before
    assert board.ci(0) == 1


def test_a_reset_of_the_system_halts_all_tasks() -> None:
    board = FakeBoard()
    board.start(COUNT_FOREVER, task=1)
    board.start("RS; CI5 := 1;")
    board.advance(5)
    assert [call.name for call in board.calls] == ["rs"]
    assert (board.ci(5), running(board, 0), running(board, 1)) == (0, 0, 0)


# Status


@pytest.mark.covers(
    "apci.CNCTS",
    "apci.CNCTS.running",
    "apci.CNCTS.running.bit0",
    "apci.CNCTS.running.bit3",
    "apci.CNCTS.csrcline",
    "apci.rdcncts",
)
def test_status_shows_the_line_that_is_being_executed() -> None:
    board = FakeBoard()
    board.start("CI0 := 1;\nSTOP;\nCI0 := 2;\nSTOP;\nwt (1000);\n")
    assert board.tasks.rdcncts(0) == sap.TaskStatus(
        errnum=0, errline=0, stackfree=32768, running=1, csrcline=1
    )
    board.advance()
    assert board.tasks.rdcncts(0)[3:] == (0, 3)  # what comes next
    board.tasks.contcnct(0)
    board.advance()
    assert board.tasks.rdcncts(0)[3:] == (0, 5)
    board.tasks.contcnct(0)
    board.advance()
    assert board.tasks.rdcncts(0).running == 1 | 8  # it runs while it waits
    assert board.tasks.rdcncts(7) == (0, 0, 0, 0, 0)


@pytest.mark.covers("apci.CNCTS.stackfree", "apci.CNCTS")
def test_calls_take_stack_and_give_it_back() -> None:
    board = FakeBoard()
    board.start(
        "PROCEDURE p (n : INTEGER); VAR a : ARRAY [1..7] OF DOUBLE;"
        "BEGIN IF n > 0 THEN p (n - 1) ELSE STOP END; BEGIN p (3); STOP END."
    )
    assert board.tasks.rdcncts(0).stackfree == 32768
    board.advance()
    # Four calls: a parameter, seven values and where to return to (two), 8 bytes each.
    assert board.tasks.rdcncts(0).stackfree == 32768 - 4 * (1 + 7 + 2) * 8
    board.tasks.contcnct(0)
    board.advance()
    assert board.tasks.rdcncts(0).stackfree == 32768


# Waiting


@pytest.mark.covers("sap.wt", "apci.CNCTS.running.bit3")
def test_wt_waits_whole_scans_and_shows_it() -> None:
    board = FakeBoard()
    board.start("CI0 := 1; wt (12.8); CI0 := 2; wt (1.3); CI0 := 3; wt (0); wt (-5); CI0 := 4;")
    board.advance()
    assert (board.ci(0), running(board)) == (1, 0b1001)
    board.advance(9)
    assert (board.ci(0), running(board)) == (1, 0b1001)
    board.advance()  # 10 scans of 1.28 ms later
    assert (board.ci(0), running(board)) == (2, 0b1001)
    board.advance()
    assert board.ci(0) == 2
    board.advance()  # 1.3 ms are two scans
    assert (board.ci(0), running(board)) == (4, 0)


@pytest.mark.covers("sap.wt", "apci.CNCTS.running.bit3")
def test_wt_with_axes_waits_for_the_ends_of_their_profiles() -> None:
    board = FakeBoard()
    board.start("ja (X := 10, Y := 5); CI0 := 1; wt (X, Y); CI0 := 2; wt (Z); CI0 := 3;")
    board.advance()
    board.ends[1] = board.scan + 15
    for _ in range(14):
        board.advance()
        assert (board.ci(0), running(board)) == (1, 0b1001)
    board.advance()
    assert (board.ci(0), running(board)) == (3, 0)  # Z does not move


def test_a_stopped_wait_goes_on_when_continued() -> None:
    board = FakeBoard()
    board.start("wt (12.8); CI0 := 1;")
    board.advance(3)
    board.tasks.stopcnct(0)
    assert running(board) == 0
    board.tasks.contcnct(0)
    assert running(board) == 0b1001
    board.advance(7)
    assert board.ci(0) == 0
    board.advance()
    assert board.ci(0) == 1


def test_a_task_gets_its_budget_and_no_more() -> None:
    board = FakeBoard()
    board.start(COUNT_FOREVER)
    for _ in range(3):
        board.run_scan(budget=6)  # TRUE, IF, CI0, 1, +, :=, and the jump back in the next one
    assert board.ci(0) == 2
    assert SystemFile().rulings.instructions_per_scan == 100


# Events


@pytest.mark.covers("sap.EVENT")
def test_an_event_interrupts_the_program_when_its_condition_becomes_true() -> None:
    board = FakeBoard()
    board.start(
        """
        VAR n : INTEGER;
        EVENT limit ON (A1.axst AND $8) <> 0;
        VAR local : INTEGER;
        BEGIN local := local + 1; CI1 := CI1 + local; js (A1) END;
        BEGIN CI0 := 1; wt (12.8); CI0 := 2 END.
        """
    )
    board.advance(3)
    assert board.ci(1) == 0
    board.qualifiers[0, "axst", None] = 8
    board.advance(2)
    assert [call.name for call in board.calls] == ["js"]
    assert (board.ci(0), board.ci(1)) == (1, 1)  # once, though the condition still holds
    assert running(board) == 0b1001
    board.qualifiers[0, "axst", None] = 0
    board.advance()
    board.qualifiers[0, "axst", None] = 12
    board.advance()
    assert board.ci(1) == 2
    board.advance(3)
    assert board.ci(0) == 1
    board.advance()
    assert (board.ci(0), running(board)) == (2, 0)  # the wait was as long as without the events


def test_events_keep_what_the_program_was_just_computing() -> None:
    board = FakeBoard()
    board.start(
        """
        VAR i, n : INTEGER;
        EVENT e ON ODD (CI9); VAR k : INTEGER;
        BEGIN FOR k := 1 TO 20 DO CI1 := CI1 + 1 END;
        FUNCTION f (a : INTEGER) : INTEGER; BEGIN f := a + i END;
        BEGIN FOR i := 1 TO 100 DO n := n + f (1) * (i + f (2)); CI0 := n END.
        """
    )
    for scan in range(400):
        board.system["ci", 9] = scan
        board.advance()
    assert running(board) == 0
    assert board.ci(0) == sum((1 + i) * (i + 2 + i) for i in range(1, 101))
    assert board.ci(1) % 20 == 0
    assert board.ci(1) >= 100


def test_the_first_event_comes_first_and_the_others_follow() -> None:
    board = FakeBoard()
    board.start(
        """
        EVENT a ON CI9 = 1; BEGIN CI0 := CI0 * 10 + 1; wt (2.56); CI0 := CI0 * 10 + 2 END;
        EVENT b ON CI9 = 1; BEGIN CI0 := CI0 * 10 + 3 END;
        BEGIN WHILE TRUE DO ; END.
        """
    )
    board.advance()
    board.system["ci", 9] = 1
    board.advance(10)
    assert board.ci(0) == 123


@pytest.mark.covers("apci.CNCTS.errline")
def test_a_mistake_in_a_condition_stops_the_task() -> None:
    board = FakeBoard()
    board.start("VAR z : INTEGER;\nEVENT e ON 1 DIV z = 0; BEGIN END;\nBEGIN WHILE TRUE DO ; END.")
    board.advance()
    status = board.tasks.rdcncts(0)
    assert (status.errnum, status.errline, status.running) == (1, 2, 0)


# Messages


@pytest.mark.covers(
    "sap.WRITE", "sap.WRITELN", "apci.gettskinfo", "apci.gettskstr", "apci.tskinfo.bit0", "apci.tskinfo.bit1"
)
def test_messages_are_incomplete_then_complete_and_read_once() -> None:
    board = FakeBoard()
    board.start(
        "WRITE ('x = ', 1.5:6:2); STOP; WRITELN (' mm'); STOP; WRITELN ('new'); STOP; WRITE ('more');"
    )
    assert board.tasks.gettskinfo(0) == (0, 0)
    board.advance()
    assert board.tasks.gettskinfo(0) == (0, 0b01)
    board.tasks.contcnct(0)
    board.advance()
    assert board.tasks.gettskinfo(0) == (0, 0b10)
    assert board.tasks.gettskstr(0) == "x =   1.50 mm"
    assert board.tasks.gettskinfo(0) == (0, 0)
    assert board.tasks.gettskstr(0) == ""
    board.tasks.contcnct(0)
    board.advance()
    assert board.tasks.gettskstr(0, 2) == "ne"
    assert board.tasks.gettskinfo(0) == (0, 0)
    board.tasks.contcnct(0)
    board.advance()
    assert board.tasks.gettskinfo(0) == (0, 0b01)
    assert board.tasks.gettskstr(0) == "more"
    assert board.tasks.gettskinfo(0) == (0, 0)
    assert board.tasks.gettskinfo(4)[0] != 0


def test_a_message_begins_anew_behind_a_complete_one() -> None:
    assert run_text("WRITELN ('old'); WRITE ('ne'); WRITE ('w');").tasks.gettskstr(0) == "new"
    assert run_text("WRITELN ('old'); WRITELN;").tasks.gettskstr(0) == ""


@pytest.mark.covers("apci.const.taskstr", "apci.gettskstr")
def test_at_most_512_characters_of_a_message_are_returned() -> None:
    board = run_text("VAR i : INTEGER; BEGIN FOR i := 1 TO 60 DO WRITE ('0123456789') END.", 20)
    assert board.tasks.gettskstr(0, 10_000) == ("0123456789" * 52)[:512]


@pytest.mark.covers("apci.CNCTS.running.bit2", "apci.MODEREG.26", "sap.WRITELN")
def test_writeln_stops_the_task_with_modereg_bit_26() -> None:
    text = "WRITELN ('a'); CI0 := 1; STOP; CI0 := 2;"
    board = run_text(text, system={("modereg", None): 1 << 26})
    assert (board.ci(0), running(board)) == (0, 0b0100)
    board.tasks.contcnct(0)
    board.advance()
    assert (board.ci(0), running(board)) == (1, 0)  # stopped by STOP
    forever = run_text(f"WRITELN ('a'); {COUNT_FOREVER}", system={("modereg", None): 1 << 26})
    assert running(forever) == 0b0100
    forever.tasks.contcnct(0)
    forever.advance()
    assert running(forever) == 0b0001  # bit 2 is that of a halt alone
    without = run_text(text)
    assert (without.ci(0), running(without)) == (1, 0)


# Common buffers


@pytest.mark.covers("sap.RDCBx", "sap.WRCBx", "apci.const.cbsize", "apci.sap.multitasking")
def test_a_task_reads_and_writes_its_own_common_buffer() -> None:
    board = FakeBoard()
    struct.pack_into("<id", board.buffers[2], 8, -70000, 0.1)
    board.buffers[2][999] = 200
    board.start(
        "CI0 := RDCBI (8); CD0 := RDCBD (12); CI1 := RDCBB (999);"
        "WRCBI (0, -2); WRCBD (992, CI0 / 2); WRCBB (4, 257); CI2 := RDCBB (5);",
        task=2,
    )
    board.advance()
    assert (board.ci(0), board.ci(1), board.system["cd", 0]) == (-70000, 200, 0.1)
    assert struct.unpack_from("<i", board.buffers[2], 0) == (-2,)
    assert struct.unpack_from("<d", board.buffers[2], 992) == (-35000.0,)
    assert board.buffers[2][4] == 1
    assert board.ci(2) == 0
    assert [any(buffer) for buffer in board.buffers] == [False, False, True, False]
    assert run_text("CI0 := RDCBB (1000);").tasks.rdcncts(0).errnum == 8
    assert run_text("WRCBD (993, 0);").tasks.rdcncts(0).errnum == 8
