"""Skip moves (G31): the signal ends them in time, latches where it came, and the program goes on from there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.macro import MacroLanguage
from polycnc.runner import run
from support.power_mate import attached, registered, running

HEAD = 'name = "probe mill"\n'
AXES = "".join(
    f'[[axis]]\nname = "{name}"\nkind = "linear"\nvmax_mm_s = 200\namax_mm_s2 = 1000\n' for name in "XYZ"
)


def machine_file(tmp_path: Path, *regions: str) -> Path:
    path = tmp_path / "probe.toml"
    path.write_text(HEAD + AXES + "".join(f"[[surface]]\n{_box(region)}\n" for region in regions))
    return path


def _box(region: str) -> str:
    """Write `X = [1, 2]` lines as the ends of a box."""
    found = re.findall(r"(\w+) = \[([^,]*), ([^\]]*)\]", region)
    ends = (", ".join(f"{name} = {value[side]}" for name, *value in found) for side in (0, 1))
    return "\n".join(f"{end} = {{ {values} }}" for end, values in zip(("low", "high"), ends, strict=True))


def executed(
    text: str, machine: Path | None = None, *, closed: bool = False
) -> tuple[ProgramRun, MacroLanguage]:
    """Run a program to its end; with `closed` in closed form where nobody looks."""
    language = MacroLanguage()
    made = ProgramRun(
        Machine(load_machine(machine)),
        ProgramText.from_text(text, "probe.tap"),
        load_dialect("fanuc"),
        options=RunOptions(stands_at_stops=False),
        language=language,
    )
    made.start()
    for _ in range(20_000):
        if not made.active:
            break
        if closed:
            made.skip()
        else:
            made.advance(1000)
    assert not made.active
    assert made.error is None, str(made.error)
    return made, language


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize(
    ("following", "place"), [("G91 G1 X2.5", "incremental"), ("G90 G1 X40", "absolute"), ("", "there")]
)
def test_a_region_of_the_machine_file_stops_the_move(
    tmp_path: Path, following: str, place: str, closed: bool
) -> None:
    text = f"G90 G1 X3 F3000\nG31 X50 F600\n#100=#5061\n#101=#5041\n{following}\nM30\n"
    made, language = executed(text, machine_file(tmp_path, "X = [12.345, 100.0]"), closed=closed)
    latched, stood = (language.variables.get(number) for number in (100, 101))
    assert latched is not None
    assert stood is not None
    assert 12.345 <= latched <= 12.345 + 0.0101  # one cycle at 10 mm/s
    assert latched + 0.03 <= stood <= latched + 0.08  # braking from 10 mm/s at 1000 mm/s2 takes 0.05 mm
    expected = {"incremental": stood + 2.5, "absolute": 40.0, "there": stood}[place]
    assert made.reading.position["X"] == pytest.approx(expected, abs=1e-9)


def test_both_ways_of_running_stop_at_the_same_place(tmp_path: Path) -> None:
    text = "G90 G1 X3 Y1 F3000\nG31 X50 Y20 F900\n#100=#5061\nG91 X1\nM30\n"
    file = machine_file(tmp_path, "X = [7.77, 9]\nY = [0, 30]")
    (first, one), (second, two) = executed(text, file), executed(text, file, closed=True)
    assert first.reading.position == second.reading.position
    latched = one.variables.get(100), two.variables.get(100)
    assert latched[0] == pytest.approx(latched[1], abs=1e-9)
    assert first.machine.clock.cycles == second.machine.clock.cycles


def test_without_a_signal_the_move_goes_to_its_end() -> None:
    made, language = executed("G31 X7.25 F600\n#100=#5061\nM30\n")
    assert (made.reading.position["X"], language.variables.get(100)) == (7.25, 7.25)


def test_a_region_that_is_not_met_does_not_matter(tmp_path: Path) -> None:
    made, language = executed(
        "G31 X7.25 F600\n#100=#5061\nM30\n", machine_file(tmp_path, "X = [3, 5]\nZ = [-9, -1]")
    )
    assert (made.reading.position["X"], language.variables.get(100)) == (7.25, 7.25)


def test_a_signal_that_is_on_at_the_beginning_ends_the_move_at_once(tmp_path: Path) -> None:
    made, language = executed(
        "G1 X3 F3000\nG31 X50 F600\n#100=#5061\nG91 G1 Y1\nM30\n", machine_file(tmp_path, "X = [2, 5]")
    )
    assert language.variables.get(100) == pytest.approx(3.0, abs=0.0101)  # what one cycle goes
    assert made.reading.position["X"] == pytest.approx(3.0, abs=0.07)
    assert made.reading.position["Y"] == 1.0


def test_other_moves_pay_no_attention_to_the_signal(tmp_path: Path) -> None:
    made, _ = executed("G1 X20 F3000\nG0 X30\nM30\n", machine_file(tmp_path, "X = [2, 5]"))
    assert made.reading.position["X"] == 30.0


def test_functions_and_stops_of_the_block_still_come(tmp_path: Path) -> None:
    path = tmp_path / "probe.tap"
    path.write_text("G31 X50 F600 M8\nG31 X60 M0\nG1 X1\nM30\n")
    result = run(path, machine_file(tmp_path, "X = [5, 6]"))
    assert [event.word for event in result.events] == ["M8", "M0", "M30"]
    assert result.end_position_mm["X"] == 1.0


def test_skip_moves_in_a_loop_find_the_same_surface_each_time(tmp_path: Path) -> None:
    text = (
        "#1=0\nWHILE [#1 LT 3] DO1\nG90 G0 Z5\nG31 Z-50 F[120*[#1+1]]\n#[100+#1]=#5063\n#1=#1+1\nEND1\nM30\n"
    )
    file = machine_file(tmp_path, "Z = [-90, -2.5]")
    _, language = executed(text, file)
    for number, speed in ((100, 2.0), (101, 4.0), (102, 6.0)):
        found = language.variables.get(number)
        assert found is not None
        assert -2.5 - speed * 0.00101 <= found <= -2.5


def test_work_offsets_and_turned_positions_count(tmp_path: Path) -> None:
    text = "G10 L2 P1 X5\nG54\nG68 X0 Y0 R90\nG90 G1 X0 Y0 F3000\nG31 X20 F600\n#100=#5062\nG91 G1 X1\nM30\n"
    made, language = executed(text, machine_file(tmp_path, "Y = [7, 100]"))
    assert language.variables.get(100) == pytest.approx(7.0, abs=0.0101)
    assert made.reading.position["Y"] == pytest.approx(8.06, abs=0.02)
    assert made.reading.position["X"] == pytest.approx(5.0, abs=1e-9)


# ---------------------------------------------------------------------- on a control


def test_the_operators_signal_ends_the_move_of_a_power_mate() -> None:
    control, _ = attached()
    registered(control, O1="\nG90G31X50.F600\n#500=#5061\n#501=#5041\nG91G1X2.\nM30\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 5000)
    at = control.positions.read()[0].absolute
    control.skip_signal(True)
    control.skip_signal(False)  # gone before a cycle has passed: nobody has seen it
    control.advance(20)
    there = control.positions.read()[0].absolute
    assert there > at + 150
    control.pmc.set_input(4, 0x80)
    control.advance(100)
    control.pmc.set_input(4, 0)
    control.advance(3000)
    latched, stood = control.macros.get(500), control.macros.get(501)
    assert latched is not None
    assert stood is not None
    assert latched == pytest.approx(there / 1000.0, abs=0.011)
    assert latched < stood < latched + 1.5
    assert control.positions.read()[0].absolute == pytest.approx((stood + 2.0) * 1000.0, abs=1.0)
    assert control.skip.positions[0] == pytest.approx(latched * 1000.0, abs=1.0)


def test_a_hold_while_a_skip_move_brakes_is_kept() -> None:
    control, _ = attached()
    registered(control, O1="\nG31X50.F600\nG91G1X2.\nM30\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 5000)
    control.skip_signal(True)
    control.advance(1)
    control.feed_hold()
    control.advance(500)
    at = control.positions.read()[0].absolute
    control.advance(500)
    assert (control.positions.read()[0].absolute, control.status().channel.run_state.value) == (at, "hold")
    control.skip_signal(False)
    control.cycle_start()
    control.advance(2000)
    assert control.positions.read()[0].absolute == pytest.approx(at + 2000, abs=1)


def test_a_reset_ends_a_skip_move_and_its_signal_acts_no_more() -> None:
    control, _ = attached()
    registered(control, O1="\nG31X50.F600\nM30\n", O2="\nG90G1X40.F6000\nM30\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 5000)
    control.skip_signal(True)
    control.advance(1)
    control.reset()
    control.advance(300)
    running(control, 2)
    control.advance(3000)
    assert control.positions.read()[0].absolute == 40_000
