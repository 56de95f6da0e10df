"""Custom macros that a Power Mate runs, seen from the function library while they run."""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.cnc import ControlError, ControlEvent, RunState
from polycnc.controllers.fanuc import PowerMate, PowerMateSnapshot, fwlib
from polycnc.controllers.fanuc.fwlib import EW
from polycnc.machine import SnapshotError
from support.power_mate import OK, attached, moved, registered, running


def macro(handle: int, number: int) -> tuple[int, int]:
    code, data = fwlib.cnc_rdmacro(handle, number, 10)
    assert code == OK
    return int(data.mcr_val), int(data.dec_val)


def until_over(control: PowerMate, number: int = 1) -> RunState:
    running(control, number)
    control.advance(20_000, until=ControlEvent.RUN_STATE)
    return control.status().channel.run_state


def alarms(handle: int) -> list[tuple[int, int, str]]:
    """Return bits, number and text of the alarms as the library gives them."""
    _, status = fwlib.cnc_alarm(handle)
    found = []
    for bit in range(16):
        if status.data >> bit & 1:
            _, info = fwlib.cnc_rdalminfo(handle, 1, 1 << bit, 38 + 2)
            row = info.u.alm2.alm[0]
            found.append((bit, row.alm_no, row.alm_msg.decode()))
    return found


@pytest.mark.covers("fanuc.cnc_wrmacro")
def test_a_program_and_a_pc_share_the_variables_while_it_runs() -> None:
    control, handle = attached()
    registered(control, O1="\n#500=7.25\nG4X0.5\n#101=#500*2\nWHILE[#102EQ#0]DO1\nEND1\n#103=#102+0.5\nM30\n")
    running(control, 1, lambda: control.macros.get(500) is not None)
    assert macro(handle, 500) == (725, 2)
    assert macro(handle, 101) in ((145, 1), (0, -1))  # read ahead during the dwell
    control.advance(2000)
    assert control.status().channel.run_state is RunState.ACTIVE  # waits for #102
    assert fwlib.cnc_wrmacro(handle, 102, 10, 41, 1) == OK
    control.advance(1000, until=ControlEvent.RUN_STATE)
    assert control.status().channel.run_state is RunState.COMPLETED
    assert macro(handle, 103) == (46, 1)


@pytest.mark.covers("fanuc.cnc_wrmacro")
def test_a_pair_stays_until_the_program_writes_another_value() -> None:
    control, handle = attached()
    for number in (500, 501):
        assert fwlib.cnc_wrmacro(handle, number, 10, 1500, 3) == OK
    registered(control, O1="\n#501=#501+1\nM30\n")
    assert until_over(control) is RunState.COMPLETED
    assert (macro(handle, 500), macro(handle, 501)) == ((1500, 3), (25, 1))


def test_variables_from_500_on_outlast_the_power_and_the_others_do_not(tmp_path: Path) -> None:
    control = PowerMate(memory=tmp_path / "power.mate")
    registered(control, O1="\n#500=2.5\n#100=3.5\n#1=4.5\n#501=1/3\n#502=9\nM30\n")
    assert until_over(control) is RunState.COMPLETED
    control.macros.set(502, None)
    control.macros.set(503, 1.25, (1250, 3))
    control.power_cycle()
    assert [control.macros.get(number) for number in (500, 100, 501, 502)] == [2.5, None, 1.0 / 3.0, None]
    assert control.custom_macros.local(1) is None
    control.close()
    again = PowerMate(memory=tmp_path / "power.mate")
    assert [again.macros.get(number) for number in (500, 100, 501, 502)] == [2.5, None, 1.0 / 3.0, None]
    assert again.macros.pair(503) == (1250, 3)
    again.close()


def test_what_a_program_has_written_is_kept_when_the_process_ends_without_a_word(tmp_path: Path) -> None:
    control = PowerMate(memory=tmp_path / "power.mate")
    registered(control, O1="\n#777=7.5\nG4X1000.\nM30\n")
    running(control, 1)
    control.advance(10)
    copy = tmp_path / "copy"
    control.store.snapshot(copy)  # what a killed process leaves
    assert PowerMate(memory=copy).macros.get(777) == 7.5


@pytest.mark.parametrize(
    ("bits", "left"), [(0, (None, None)), (64, (5.5, None)), (128, (None, 6.5)), (192, (5.5, 6.5))]
)
def test_a_reset_clears_what_parameter_6001_says(bits: int, left: tuple[float | None, float | None]) -> None:
    control, _ = attached()
    control.parameters.set(6001, bits)
    registered(control, O1="\n#100=5.5\n#1=6.5\nM30\n")
    assert until_over(control) is RunState.COMPLETED
    control.reset()
    assert (control.macros.get(100), control.custom_macros.local(1)) == left


def test_switching_off_clears_what_a_reset_may_keep() -> None:
    control, handle = attached()
    control.parameters.set(6001, 64 | 128)
    registered(control, O1="\n#100=5.5\n#1=6.5\n#500=0\nM30\n")
    assert until_over(control) is RunState.COMPLETED
    assert (control.macros.get(100), macro(handle, 500)) == (5.5, (0, 0))
    control.power_cycle()
    assert (control.macros.get(100), control.custom_macros.local(1), control.macros.get(500)) == (
        None,
        None,
        0.0,
    )


def test_codes_call_programs_by_parameters() -> None:
    control, _ = attached()
    for number, value in ((6053, 81), (6072, 40), (6084, 60)):
        control.parameters.set(number, value)
    control.parameters.set(6001, 64 | 32)
    registered(
        control,
        O1="\n#1=77.\nF6000\nG81X2.5Z-1.R0.\nM60A3.5\nM40\nT12\nM30\n",
        O9013="\n#500=#24\n#501=#26\nM99\n",
        O9002="\n#502=#1\nM99\n",
        O9024="\n#503=#1\nM99\n",
        O9000="\n#504=#149\nM99\n",
    )
    assert until_over(control) is RunState.COMPLETED
    assert [control.macros.get(number) for number in range(500, 505)] == [2.5, -1.0, 77.0, 3.5, 12.0]
    control.parameters.set(6053, 0)
    control.macros.set(500, 8.0)
    assert until_over(control) is RunState.COMPLETED  # G81 is a cycle again
    assert control.macros.get(500) == 8.0


@pytest.mark.covers(*(f"fanuc.ncparam.{6080 + k}" for k in range(10)))
def test_each_of_the_ten_m_codes_calls_its_own_program() -> None:
    control, _ = attached()
    for k in range(10):
        control.parameters.set(6080 + k, 41 + 3 * k)
        registered(control, **{f"O{9020 + k}": f"\n#{500 + k}=#1\nM99\n"})
    registered(control, O1="\n" + "".join(f"M{41 + 3 * k}A{70 - 4 * k}.\n" for k in range(10)) + "M30\n")
    assert until_over(control) is RunState.COMPLETED
    assert [control.macros.get(500 + k) for k in range(10)] == [70.0 - 4.0 * k for k in range(10)]


@pytest.mark.covers("fanuc.cnc_rdalminfo", "fanuc.ALMINFO.alm.alm_no", "fanuc.ALMINFO.alm.alm_msg")
def test_an_alarm_of_a_program_has_its_number_and_text() -> None:
    control, handle = attached()
    registered(control, O1="\nG1X2.F6000\n#3000=23(TOOL BROKEN)\nG1X5.\nM30\n")
    assert until_over(control) is RunState.ALARM
    assert alarms(handle) == [(3, 3023, "TOOL BROKEN")]
    assert control.positions.read()[0].absolute == 2000
    control.reset()
    assert alarms(handle) == []


@pytest.mark.parametrize(
    ("block", "number", "text"),
    [
        ("#1=1/0", 112, "DIVIDED BY ZERO"),
        ("#990=#4000", 115, "ILLEGAL VARIABLE NUMBER"),
        ("#5021=3", 116, "WRITE PROTECTED VARIABLE"),
        ("GOTO77", 128, "ILLEGAL MACRO SEQUENCE NUMBER"),
        ("#2001=1000.", 119, "ILLEGAL ARGUMENT"),
        ("#1101=2", 119, "ILLEGAL ARGUMENT"),
        ("#1132=65536", 119, "ILLEGAL ARGUMENT"),
        ("#1132=-1", 119, "ILLEGAL ARGUMENT"),
        ("#3002=-0.5", 119, "ILLEGAL ARGUMENT"),
        ("#3002=1000000", 119, "ILLEGAL ARGUMENT"),
        ("#3901=2.5", 119, "ILLEGAL ARGUMENT"),
        ("#3005=256", 119, "ILLEGAL ARGUMENT"),
        ("#1015=1", 116, "WRITE PROTECTED VARIABLE"),
        ("DO1", 124, "MISSING END STATEMENT"),
        ("DO4", 126, "ILLEGAL LOOP NUMBER"),
        ("M98P1", 77, "SUB PROGRAM NESTING ERROR"),
        ("M98P77", 78, "NUMBER NOT FOUND"),
        ("G65P77", 78, "NUMBER NOT FOUND"),
        ("G65P1", 122, "FOUR FOLD MACRO MODAL-CALL"),
    ],
)
@pytest.mark.covers("fanuc.cnc_rdalminfo")
def test_errors_of_macros_have_the_controls_numbers(block: str, number: int, text: str) -> None:
    control, handle = attached()
    registered(control, O1=f"\n{block}\nM30\n")
    running(control, 1)
    control.advance(1000, until=ControlEvent.RUN_STATE)
    assert alarms(handle) == [(3, number, text)]


def test_a_message_stop_shows_its_text_until_the_program_goes_on() -> None:
    control, handle = attached()
    registered(control, O1="\nG1X1.F6000\n#3006=1(TURN THE PART)\nG1X2.\nM30\n")
    running(control, 1, lambda: control.status().channel.run_state is RunState.PROGRAM_STOP)
    code, count, found = fwlib.cnc_rdopmsg3(handle, 4, 5)
    assert (code, count, found[0].data, found[0].type) == (OK, 1, b"TURN THE PART", 4)
    assert fwlib.cnc_rdopmsg3(handle, 0, 5)[1] == 0
    assert fwlib.cnc_rdopmsg3(handle, -1, 5)[1] == 1
    assert control.positions.read()[0].absolute == 1000
    control.cycle_start()
    assert fwlib.cnc_rdopmsg3(handle, 4, 5)[1] == 0
    control.reset()
    registered(control, O1="\n#3006=1(TURN THE PART)\nM30\n")
    running(control, 1, lambda: control.status().channel.run_state is RunState.PROGRAM_STOP)
    control.reset()
    assert fwlib.cnc_rdopmsg3(handle, 4, 5)[1] == 0


@pytest.mark.covers("fanuc.pmc_rdpmcrng")
def test_system_variables_are_those_of_the_control() -> None:
    control, handle = attached()
    control.parameters.set(6711, 41)
    control.parameters.set(6713, 60)
    control.tool_offsets.set_all({7: 12_345})
    control.signals.give(54, 0b101)
    control.signals.give(55, 0b10)
    control.advance(2500)
    registered(
        control,
        O1="\n#500=#3901\n#3902=77\n#501=#2007\n#10008=-1.5\n#502=#1002\n#503=#1032\n#1101=1\n#1109=1\n"
        "#504=#1132\n#505=#3001\n#3001=0\nG4X0.25\n#506=#3001\n#507=#4115\n#508=#3005\nM30\n",
    )
    assert until_over(control) is RunState.COMPLETED
    values = [control.macros.get(number) for number in range(500, 509)]
    assert values[:5] == [41.0, 12.345, 1.0, 517.0, 514.0]
    assert values[5] == pytest.approx(2500.0, abs=20.0)
    assert values[6] == pytest.approx(250.0, abs=3.0)
    assert values[7:] == [1.0, float(control.parameters.value(0))]
    assert control.parameters.value(6713) == 77
    assert control.tool_offsets.get(8) == -1500
    assert fwlib.pmc_rdpmcrng(handle, 1, 0, 54, 55, 10)[1].u.cdata[:2] == [2, 2]
    control.power_cycle()
    assert fwlib.pmc_rdpmcrng(handle, 1, 0, 54, 55, 10)[1].u.cdata[:2] == [0, 0]


@pytest.mark.covers("fanuc.pmc_rdpmcrng")
def test_the_hours_of_operation_are_counted_on_from_what_a_program_wrote() -> None:
    control, handle = attached()
    registered(
        control,
        O1="\n#3002=0.25\n#500=#3002\nG4X3.6\n#501=#3002\n#3901=17\n#3005=2\n#1132=40965\n#1100=0\n#1114=1\nM30\n",
    )
    assert until_over(control) is RunState.COMPLETED
    assert control.macros.get(500) == pytest.approx(0.25, abs=2e-5)
    assert control.macros.get(501) == pytest.approx(0.251, abs=2e-5)
    assert (control.parameters.value(6711), control.parameters.value(0)) == (18, 2)  # and this part
    assert control.custom_macros.state.user_outputs == 0b1110_0000_0000_0100
    assert fwlib.pmc_rdpmcrng(handle, 1, 0, 54, 55, 10)[1].u.cdata[:2] == [4, 0xE0 - 256]


def test_positions_are_read_when_the_blocks_before_have_been_executed() -> None:
    control, _ = attached()
    registered(control, O1="\nG90G1X3.5Y-2.F6000\n#500=#5041\n#501=#5022\nG91X1.\n#502=#5001\nM30\n")
    assert until_over(control) is RunState.COMPLETED
    assert [control.macros.get(number) for number in (500, 501, 502)] == [3.5, -2.0, 4.5]


@pytest.mark.covers("fanuc.concept.mdi_program")
def test_mdi_takes_macro_statements_too() -> None:
    control, _ = attached()
    moved(control, "#500=4\nG0X[#500/8]")
    assert (control.macros.get(500), control.positions.read()[0].absolute) == (4.0, 500)


@pytest.mark.covers("fanuc.cnc_wrmacro")
def test_without_the_option_statements_are_refused() -> None:
    control, handle = attached(options=("macro_variables_300",))
    registered(control, O1="\n#500=4\nM30\n")
    running(control, 1)
    control.advance(100, until=ControlEvent.RUN_STATE)
    assert control.status().channel.run_state is RunState.ALARM
    assert control.macros.get(500) is None
    assert fwlib.cnc_wrmacro(handle, 500, 10, 5, 0) == OK


def test_m99_in_the_main_program_repeats_it() -> None:
    control, _ = attached()
    registered(control, O1="\n#500=#500+1\nG4X0.1\nM99\n")
    running(control, 1)
    control.advance(550)
    assert control.status().channel.run_state is RunState.ACTIVE
    assert (control.macros.get(500) or 0.0) >= 5.0


def test_a_snapshot_keeps_a_program_under_way_and_its_variables() -> None:
    control, _ = attached()
    registered(
        control,
        O1="\nG1X5.F600\nX6.\nX7.\nX8.\nX9.\nX10.\nX11.\nX12.\nX5.\nM98P2\nM30\n",
        O2="\n#500=#5041\nM99\n",
        O3="\nG4X1.\nM30\n",
    )
    running(control, 3, lambda: control.status().time_s > 0.2)
    taken = control.snapshot()
    control.advance(100)
    control.restore(taken)
    control.advance(10_000, until=ControlEvent.RUN_STATE)
    assert control.status().channel.run_state is RunState.COMPLETED
    running(control, 1, lambda: control.positions.read()[0].absolute > 2000)
    taken = control.snapshot()
    control.advance(10_000, until=ControlEvent.RUN_STATE)
    assert control.macros.get(500) == 5.0
    control.macros.set(500, None)
    control.restore(taken)
    assert until_rest(control) is RunState.COMPLETED
    assert control.macros.get(500) == 5.0  # read in the channel that was put back
    registered(control, O4="\n#500=1\n#101=#500*3\nG4X1.\n#501=#101+#5041\n#500=#500+2\nM30\n")
    running(control, 4, lambda: control.status().time_s > 0.5)
    taken = control.snapshot()
    assert until_rest(control) is RunState.COMPLETED
    assert [control.macros.get(number) for number in (101, 500, 501)] == [3.0, 3.0, 8.0]
    control.macros.set(500, 9.0)
    control.macros.set(101, None)
    control.restore(taken)
    assert [control.macros.get(number) for number in (101, 500)] == [3.0, 1.0]
    assert until_rest(control) is RunState.COMPLETED
    assert [control.macros.get(number) for number in (101, 500, 501)] == [3.0, 3.0, 8.0]


def test_a_snapshot_of_something_else_is_refused() -> None:
    control, _ = attached()
    for snapshot in (control.machine.snapshot(), control.control.snapshot()):
        with pytest.raises(SnapshotError, match="not of a Power Mate"):
            control.restore(snapshot)
        with pytest.raises(SnapshotError, match="not of a Power Mate"):
            PowerMateSnapshot.from_bytes(snapshot.to_bytes())
    assert control.snapshot() == control.snapshot()


def test_a_program_goes_on_from_a_file_in_another_control() -> None:
    program = "\n#101=3\nWHILE[#101LT7]DO1\n#101=#101+1\nG1X#101F900.\nG4X0.1\n#502=#502+#5041\nEND1\nM30\n"
    control, _ = attached()
    registered(control, O5=program)
    running(control, 5, lambda: control.status().time_s > 0.7)
    content = control.snapshot().to_bytes()
    assert until_rest(control) is RunState.COMPLETED
    assert control.macros.get(502) == 4.0 + 5.0 + 6.0 + 7.0
    other, _ = attached()
    registered(other, O5=program)
    other.restore(PowerMateSnapshot.from_bytes(content))
    assert other.snapshot().to_bytes() == content
    assert until_rest(other) is RunState.COMPLETED
    assert [other.macros.get(number) for number in (101, 502)] == [7.0, 22.0]
    assert other.clock.cycles == control.clock.cycles


@pytest.mark.covers("fanuc.cnc_seqsrch")
def test_a_program_with_macros_may_begin_at_a_block() -> None:
    control, handle = attached()
    registered(
        control,
        O1="\nN10G1X9.F6000\n#500=1\nN20G1X2.F6000\nN25Y3.\n#501=5\nIF[#501EQ6]GOTO10\nN30#502=#502+1\n"
        "WHILE[#502LT3]DO1\nN40#502=#502+1\nEND1\nIF[#503EQ1]GOTO50\n#503=1\nGOTO25\nN50M30\n",
    )
    control.select_mode("MEM")
    control.select_program(1)
    assert fwlib.cnc_seqsrch(handle, 25) == OK
    assert until_over_again(control) is RunState.COMPLETED
    assert [control.macros.get(number) for number in (500, 501, 502, 503)] == [None, 5.0, 4.0, 1.0]
    assert [each.absolute for each in control.positions.read()] == [0, 3000, 0]
    assert fwlib.cnc_seqsrch(handle, 40) == OK
    with pytest.raises(ControlError, match="inside a loop"):
        control.cycle_start()


def until_over_again(control: PowerMate) -> RunState:
    control.cycle_start()
    control.advance(20_000, until=ControlEvent.RUN_STATE)
    return control.status().channel.run_state


def until_rest(control: PowerMate) -> RunState:
    control.advance(100_000, until=ControlEvent.RUN_STATE)
    return control.status().channel.run_state


@pytest.mark.covers("fanuc.cnc_wrmacro", "fanuc.cnc_wrmacro.err.EW_DATA")
@pytest.mark.covers("fanuc.cnc_allclibhndl2")
def test_two_handles_and_two_controls_do_not_share_variables() -> None:
    first, handle = attached()
    second = PowerMate()
    fwlib.attach(1, second)
    _, other = fwlib.cnc_allclibhndl2(1)
    assert fwlib.cnc_wrmacro(handle, 500, 10, 5, 0) == OK
    assert macro(other, 500) == (0, -1)
    assert fwlib.cnc_wrmacro(handle, 500, 10, 2**31 - 1, 0) == EW.EW_DATA
    assert (first.macros.get(500), second.macros.get(500)) == (5.0, None)


def test_calls_without_a_block_leave_the_control_its_turn() -> None:
    control = PowerMate()
    control.programs.register(1, "O0001\nG65P9001L9999\nM30\n")
    control.programs.register(9001, "O9001\nG65P9002L9999\nM99\n")
    control.programs.register(9002, "O9002\n#500=#500+1\nM99\n")
    control.macros.set(500, 0.0)
    control.select_program(1)
    control.cycle_start()
    assert control.advance(2) == 2
    counted = control.macros.get(500)
    assert counted is not None
    assert 60 < counted < 500  # 125 calls or blocks without motion in a cycle
    control.reset()
    control.advance(2)
    assert control.macros.get(500) == counted


@pytest.mark.parametrize(
    ("main", "sub", "left"),
    [
        ("M98P9001\nN10#500=7\nN20#501=3\n", "M99P20\n", [None, 3.0]),
        ("G1X2.F3000\nM98P00019001\nN10#500=7\nN20#501=#502\n", "#502=#502+1.5\nM99P20(X)\n", [None, 1.5]),
        ("G65P9001A4.\nN10#500=7\nN20#501=3\n", "IF[#1EQ4]GOTO5\nM99\nN5M99P20\n", [None, 3.0]),
        ("#1=9001\nM98P#1\nN10#500=7\nN20#501=3\n", "P20M99\n", [None, 3.0]),
        ("M98P9001\nN10#500=7\nN20#501=3\n", "M99(P20)\n", [7.0, 3.0]),
    ],
)
def test_a_program_of_the_memory_returns_to_a_block_of_its_caller(
    main: str, sub: str, left: list[float | None]
) -> None:
    control, _ = attached()
    registered(control, O1=f"\n{main}M30\n", O9001=f"\n{sub}")
    assert until_over(control) is RunState.COMPLETED
    assert [control.macros.get(number) for number in (500, 501)] == left


def test_a_program_without_statements_is_returned_into_too() -> None:
    control, handle = attached()
    registered(
        control,
        O1="\nG90G1F5000\nX1.\nM98P9001\nN10X2.\nY7.\nN20Z3.\nM30\n",
        O9001="\nM99P20\n",
        O2="\nM98P9002\nN10X4.\nM30\n",
        O9002="\nM99P77\n",
    )
    assert until_over(control) is RunState.COMPLETED
    assert [axis.machine for axis in control.status().axes.values()] == [1.0, 0.0, 3.0]
    assert until_over(control, 2) is RunState.ALARM
    assert alarms(handle) == [(3, 128, "ILLEGAL MACRO SEQUENCE NUMBER")]
