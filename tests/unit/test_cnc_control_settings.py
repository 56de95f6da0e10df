"""A control: its settings, its snapshots, and what a vendor's control changes in it."""

from __future__ import annotations

import pytest

from polycnc.cnc import (
    Answer,
    ChannelData,
    Control,
    ControlData,
    ControlEvent,
    ControlSnapshot,
    Emergency,
    Function,
    Mode,
    Refusal,
    RunState,
)
from polycnc.errors import UsageError
from polycnc.machine import SnapshotError
from support.cnc_control import PART, control, refused, started, x_of
from support.cnc_machine import cnc_machine

# ---------------------------------------------------------------------- settings


def test_what_is_out_of_range_is_refused() -> None:
    made = control()
    for call in (
        lambda: made.set_overrides(feed=2.1),
        lambda: made.set_overrides(feed=0.5, rapid=0.3),
        lambda: made.set_overrides(spindle=float("nan")),
        lambda: made.set_switches(block_delete=frozenset({0})),
        lambda: made.set_switches(single_block=True, block_delete=frozenset({3, 10})),
        lambda: made.cycle_start(channel=1),
        lambda: made.set_relative("W"),
        lambda: made.set_relative("X", float("inf")),
    ):
        refused(Refusal.DATA, call, made)


def test_the_machine_lock_executes_without_the_axes_and_only_changes_in_between() -> None:
    made = control()
    made.set_switches(machine_lock=True)
    made.select_program("PART")
    made.cycle_start()
    made.advance(300)
    assert x_of(made) == 12.5
    refused(Refusal.RUNNING, lambda: made.set_switches(machine_lock=False), made)
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert x_of(made) == 12.5
    made.set_switches(machine_lock=False)
    made.cycle_start()
    made.advance(300)
    assert x_of(made) > 20.0


def test_axes_stay_where_they_are_when_the_machine_lock_is_taken_off() -> None:
    made = control()
    made.set_switches(machine_lock=True)
    made.select_program("SLOT")  # ends at X30, and the axes have never left 12.5
    made.cycle_start()
    made.advance(300)
    made.reset()
    made.advance(300)
    made.set_switches(machine_lock=False)
    made.advance(7)
    assert x_of(made) == 12.5
    made.cycle_start()
    made.advance(1)
    assert x_of(made) == pytest.approx(12.5, abs=1e-3)
    made.advance(10_000)
    assert x_of(made) == 30.0


@pytest.mark.parametrize("calculate", [False, True])
@pytest.mark.parametrize("ends", ["another program", "MDI", "reset"])
def test_a_search_ends_with_another_selection(ends: str, calculate: bool) -> None:
    made = control()
    made.select_program("PART")
    assert made.search(line=3, calculate=calculate) == 3
    if ends == "another program":
        made.select_program("SLOT")
    elif ends == "MDI":
        made.select_mode(Mode.MDI)
        made.set_mdi("G1 X14 F600\nX15\nX16\nX17\n")
    else:
        made.reset()
    made.cycle_start()
    made.advance(10)
    block = made.status().channel.block
    assert block is not None
    assert block.line == {"another program": 1, "MDI": 1, "reset": 2}[ends]  # O7 moves nothing


def test_dry_run_and_block_delete_reach_the_program() -> None:
    made = control(ControlData(dry_run_mm_min=1200.0))
    made.programs.create("DRY", "/2 N10 X99 \nN20 G1 X32.5 F60\nM30\n".replace(" X99", " Z-3 F900 G1"))
    made.set_switches(dry_run=True, block_delete=frozenset({2}))
    made.select_program("DRY")
    made.cycle_start()
    passed = made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert passed == pytest.approx(1000, abs=60)
    assert made.status().axes["Z"].machine == 3.0


def test_auxiliary_functions_take_the_machine_files_times_and_the_spindle_its_ramp() -> None:
    made = control()
    made.programs.create("AUX", "S1500 M3\nT4 M6\nM8\nM30\n")
    made.select_program("AUX")
    made.cycle_start()
    # 1500 rpm at 3000 rpm/s, 1.5 s of tool change, 0.3 s of coolant.
    passed = made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.COMPLETED
    assert passed == pytest.approx(500 + 1500 + 300, abs=8)


def test_a_sub_program_comes_from_the_memory() -> None:
    made = Control(cnc_machine(), dialect="fanuc")
    made.programs.create("MAIN", "G1 X13.5 F6000\nM98 P31\nM30\n")
    made.programs.create("O0031", "O31\nG1 Y4.25\nM99\n")
    made.select_program("MAIN")
    made.cycle_start()
    made.advance(100_000, until=lambda: made.status().axes["Y"].machine > 1.0)
    assert made.programs.running == {"MAIN", "O0031"}
    refused(Refusal.IN_USE, lambda: made.programs.delete("O0031"), made)
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().axes["Y"].machine == 4.25


def test_a_turret_takes_the_offsets_of_the_table() -> None:
    made = Control("lathe2", dialect="fanuc-lathe")
    made.tools.set(3, x_mm=7.0, wear_x_mm=0.125, z_mm=-2.5, tip=3)
    made.programs.create("TURN", "G97 S1000 M3\nT0303\nG0 X20. Z5.\nM30\n")
    made.select_program("TURN")
    made.cycle_start()
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    axes = made.status().axes
    assert (axes["X"].machine, axes["Z"].machine) == (17.125, 2.5)  # X20 is a diameter


def test_positions_machine_work_and_relative() -> None:
    made = control()
    made.offsets.set("G54", {"X": 2.5})
    made.set_relative("X", 100.0)
    made.select_mode(Mode.INC)
    made.increment("X", 1, 7.25)
    made.advance(1)
    assert 0.0 < made.status().axes["X"].to_go <= 7.25
    made.advance(2000)
    axis = made.status().axes["X"]
    assert (axis.machine, axis.relative, axis.to_go) == (19.75, 107.25, 0.0)
    made.select_mode(Mode.AUTO)
    made.programs.create("AT", "G54 G1 X20 F6000\nM30\n")
    made.select_program("AT")
    made.cycle_start()
    made.advance(2000)
    axis = made.status().axes["X"]
    assert (axis.machine, axis.work) == (22.5, 20.0)


# ---------------------------------------------------------------------- snapshots


def test_a_snapshot_in_the_middle_of_a_program_goes_on_as_the_undisturbed_one() -> None:
    script = {(Function.M, 8): Answer(0.7)}
    made = started(program="SLOT", script=script)
    made.set_overrides(feed=0.9)
    made.advance(600)
    saved = made.snapshot()
    assert made.snapshot() == saved
    ends = []
    for _ in range(2):
        made.advance(77)
        made.set_overrides(feed=1.7)
        passed = made.advance(100_000, until=ControlEvent.RUN_STATE)
        ends.append((passed, made.status()))
        made.select_mode(Mode.JOG)
        made.jog("Y", 1)
        made.advance(100)
        made.emergency_stop()
        made.restore(saved)
        assert made.clock.cycles == 600
        assert made.snapshot() == saved
    assert ends[0][0] == ends[1][0]
    first, second = (end.axes for _, end in ends)
    assert first == second
    assert made.status().emergency is Emergency.OFF
    elsewhere = control(script=script)
    elsewhere.restore(ControlSnapshot.from_bytes(saved.to_bytes()))
    assert elsewhere.snapshot() == saved
    elsewhere.advance(77)
    elsewhere.set_overrides(feed=1.7)
    assert elsewhere.advance(100_000, until=ControlEvent.RUN_STATE) == ends[0][0]
    assert elsewhere.status().axes == first
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    ended, status = made.snapshot(), made.status()
    made.reset()
    made.restore(ended)
    assert made.status() == status
    other = control(script=script)
    other.restore(ControlSnapshot.from_bytes(ended.to_bytes()))
    assert other.status().axes["X"].machine == 30.0


def test_a_snapshot_at_rest_is_a_file_for_another_control_made_alike() -> None:
    made = control(ControlData(referenced_at_start=False))
    made.select_mode(Mode.REF)
    made.reference("Z")
    made.advance(40)
    made.messages.show(7, "clean the table")
    made.set_switches(block_delete=frozenset({2, 5}))
    made.spindle.turn(rpm=900.0, direction=1)
    made.plc.strobe(Function.M, 30)
    saved = made.snapshot()
    made.advance(3000)
    other = control(ControlData(referenced_at_start=False))
    other.restore(ControlSnapshot.from_bytes(saved.to_bytes()))
    assert other.snapshot() == saved
    other.advance(3000)
    assert other.status() == made.status()
    assert other.status().axes["Z"].referenced


def test_the_snapshot_of_another_thing_is_refused_before_anything_changes() -> None:
    made = started()
    made.advance(300)
    others = (
        Control(cnc_machine(), channels=(ChannelData(("X", "Y")), ChannelData(("Z", "B")))).snapshot(),
        Control("mill3").snapshot(),
        Control(cnc_machine(cycle_s=0.002)).snapshot(),
        Control(cnc_machine(), dialect="fanuc").snapshot(),
        made.machine.snapshot(),
    )
    before = made.status()
    for other in others:
        with pytest.raises(SnapshotError):
            made.restore(other)
        assert made.status() == before
    made.advance(100_000, until=ControlEvent.RUN_STATE)
    assert made.status().channel.run_state is RunState.COMPLETED
    with pytest.raises(SnapshotError):
        ControlSnapshot.from_bytes(Control("mill3").machine.snapshot().to_bytes())


# ---------------------------------------------------------------------- what a vendor's control changes


def test_axes_can_be_given_other_limits_while_nothing_runs() -> None:
    made = started()
    axes = made.machine.config.axes
    slower = axes[0].model_copy(update={"vmax_mm_s": 30.0, "soft_limits_mm": (-50.0, 42.0)})
    made.advance(10)
    refused(Refusal.RUNNING, lambda: made.change_axes((slower, *axes[1:])), made)
    made.reset()
    made.advance(200)
    made.change_axes((slower, *axes[1:]))
    made.cycle_start()
    assert made.status().alarms[0].name == "program"  # 42.5 is beyond the new limit
    made.reset()
    made.programs.write("PART", PART.replace("42.5", "41.5"))
    made.cycle_start()
    made.advance(300)
    assert made.status().axes["X"].velocity == pytest.approx(30.0)
    with pytest.raises(UsageError):
        made.machine.change_axes(axes[1:])


def test_a_program_can_begin_at_a_line() -> None:
    made = control()
    made.select_program("SLOT")
    refused(Refusal.NOT_FOUND, lambda: made.cycle_start(line=99), made)
    made.programs.write("SLOT", "N10 G1 X20 F600\nN20 Y3\nN30 G1 X15.5 F600\nM2\n")
    made.cycle_start(line=3)
    made.advance(2000)
    status = made.status()
    assert (status.axes["X"].machine, status.axes["Y"].machine) == (15.5, 0.0)


def test_an_alarm_from_outside_stops_everything_once() -> None:
    made = started()
    made.advance(100)
    made.put_alarm("function_failed", detail="M8")
    made.advance(300)
    at = x_of(made)
    made.advance(300)
    assert x_of(made) == at
    assert made.status().channel.run_state is RunState.ALARM
    assert [alarm.text for alarm in made.status().alarms] == ["M8"]
    made.put_alarm("function_failed", detail="again")
    assert [alarm.text for alarm in made.status().alarms] == ["M8"]
    made.reset()
    assert made.status().alarms == ()


CORNERS = "G1 X12 F4000\nY7\nG2 X20 Y15 R9 F2500\nG1 X3.3 Y1.1 F9000\nG0 X0 Y0\nM30\n"


def test_setting_what_is_set_changes_no_bit_at_any_cycle() -> None:
    """Not of the path, at whatever cycle it comes: an operator's panel sends its settings again and again."""

    def moved(*, again: bool) -> list[tuple[float, float]]:
        made = Control("mill3")
        made.programs.create("PART", CORNERS)
        made.select_program("PART")
        made.set_overrides(feed=0.8, rapid=0.5)
        made.set_switches(optional_stop=True)
        made.cycle_start()
        found = []
        for _ in range(600):
            if again:
                made.set_overrides(feed=0.8, rapid=0.5, spindle=1.0)
                made.set_switches(
                    dry_run=False,
                    optional_stop=True,
                    single_block=False,
                    machine_lock=False,
                    block_delete=frozenset(),
                )
                made.select_mode(Mode.AUTO)
                made.channels[0].set_breakpoints(frozenset())
                made.channels[0].set_skip_signal(False)
            made.advance(1)
            axes = made.status().axes
            found.append((axes["X"].machine, axes["Y"].machine))
        return found

    assert moved(again=True) == moved(again=False)
