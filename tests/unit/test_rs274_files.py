"""What programs of LinuxCNC find beside them: parameters, settings, pins, folders; and what an INI file gives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import polycnc
from polycnc.cli._app import app
from polycnc.cnc import Control, RunState
from polycnc.errors import ConfigurationError, UsageError
from polycnc.machine import MachineConfig, load_machine
from polycnc.runner import RunSettings, machine_from, run_program

AXES: list[dict[str, Any]] = [
    {"name": "X", "vmax_mm_s": 500.0, "amax_mm_s2": 5000.0},
    {"name": "Z", "vmax_mm_s": 500.0, "amax_mm_s2": 5000.0},
    {"name": "A", "kind": "rotary", "vmax_deg_s": 90.0, "amax_deg_s2": 900.0},
]


def machine(**programs: Any) -> MachineConfig:
    return MachineConfig.model_validate(
        {"name": "m", "axis": tuple(AXES), "programs": programs, "io": {"points": {"probe-in": "I7"}}}
    )


def ends(program: str, config: MachineConfig, **settings: Any) -> list[float]:
    result = run_program(f"{program}\nM2\n", RunSettings(config, "linuxcnc", **settings))
    return list(result.end_position_mm.values())


@pytest.mark.parametrize(
    ("content", "program", "end"),
    [
        ("31 7.5\nremark\n40 -2 ; another\n5161 1\n", "G0 X#31 Z[#40+#5161]", [7.5, -1.0, 0.0]),
        ("5221 10\n5223 -4\n5224 30\n", "G0 X2 Z1 A5", [12.0, -3.0, 35.0]),
        ("5220 2\n5241 6\n", "G0 X2 Z#5220", [8.0, 2.0, 0.0]),
        ("5210 1\n5211 3\n", "G0 X2\nG92.2\nG0 Z#5211", [5.0, 3.0, 0.0]),
        ("5211 3\n", "G0 X2\nG92.3\nG0 Z#5211", [2.0, 3.0, 0.0]),
        ("5161 4\n5163 9\n", "G28", [4.0, 9.0, 0.0]),
    ],
)
def test_programs_begin_with_the_parameters_of_the_file(
    content: str, program: str, end: list[float], tmp_path: Path
) -> None:
    config = machine(parameter_file=str(tmp_path / "m.var"))
    (tmp_path / "m.var").write_text(content)
    assert ends(program, config) == pytest.approx(end)


def test_lengths_of_the_file_may_be_inches(tmp_path: Path) -> None:
    (tmp_path / "m.var").write_text("31 7.5\n5163 2\n5221 1\n5224 30\n")
    config = machine(parameter_file=str(tmp_path / "m.var"), parameters_inch=True)
    assert ends("G0 X#31 Z#5163 A1", config) == pytest.approx([32.9, 2.0, 31.0])
    assert ends("G28\nG90 G0 X#5221 A1", config)[:2] == pytest.approx([26.4, 50.8])
    out = tmp_path / "out.var"
    ends("G20\n#31=[#5221*8]\n#5163=3", config, save_parameters=out)
    found = dict(line.split("\t") for line in out.read_text().splitlines())
    assert {found[each] for each in ("31", "5163", "5221", "5224")} == {
        "8.000000",
        "3.000000",
        "1.000000",
        "30.000000",
    }


@pytest.mark.parametrize(
    ("content", "what"),
    [
        ("5221 10\n31 7.5\n", "m.var:2:1: #31 is out of order"),
        ("31 1\n31 2\n", "m.var:2:1: #31 is out of order"),
        ("99999 1\n", "m.var:1:1: there is no parameter #99999"),
        ("31 7.5\n32 1e999\n", "m.var:2:1: '1e999' is too large for #32"),
        ("31 1\n" * 200_001, "too large"),
        (None, "cannot be read"),
    ],
)
def test_a_wrong_file_is_refused(content: str | None, what: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "m.var").write_text(content)
    with pytest.raises(UsageError, match=what):
        ends("G0 X1", machine(parameter_file=str(tmp_path / "m.var")))


def test_what_programs_set_is_written_where_asked_and_read_again(tmp_path: Path) -> None:
    (tmp_path / "m.var").write_text("31 7.5\n33 1\n")
    before = (tmp_path / "m.var").read_bytes()
    (tmp_path / "m.toml").write_text(
        'name = "m"\n[programs]\nparameter_file = "m.var"\n[[axis]]\nname = "X"\nvmax_mm_s = 500\namax_mm_s2 = 5000\n'
    )
    part = tmp_path / "part.ngc"
    part.write_text("#31=[#31+1] #32=5\nG10 L2 P3 X2.25\nG92 X4\nG0 X#31\nM2\n")
    runner = CliRunner()
    call = ["run", str(part), "-m", str(tmp_path / "m.toml")]
    assert runner.invoke(app, call).exit_code == 0
    assert (tmp_path / "m.var").read_bytes() == before
    told = runner.invoke(app, [*call, "--save-parameters", str(tmp_path / "m.var")])
    assert told.exit_code == 0, told.output
    assert "m.var" in told.output
    lines = (tmp_path / "m.var").read_text().splitlines()
    assert lines[:3] == ["31\t8.500000", "33\t1.000000", "5161\t0.000000"]
    assert "32\t5.000000" not in lines  # only what stood there, and what always stands there
    assert {"5261\t2.250000", "5210\t1.000000", "5211\t-4.000000"} <= set(lines)
    part.write_text("G92.1\nG59 G0 X#31\nG56 G0 X#5261\nM2\n")
    assert ends(part.read_text(), load_machine(tmp_path / "m.toml")) == [4.5]


@pytest.mark.parametrize(
    ("options", "what"),
    [
        (["-d", "fanuc", "--save-parameters", "out.var"], "keep no file of parameters"),
        (["--save-parameters", "out.txt"], "'.txt' is none of its formats"),
        (["--save-parameters", "nowhere/out.var"], "folder"),
    ],
)
def test_where_no_parameters_can_be_written(
    options: list[str], what: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "part.ngc").write_text("G0 X1\nM2\n")
    told = CliRunner().invoke(app, ["run", "part.ngc", *options])
    assert told.exit_code != 0
    assert what in " ".join(told.output.split())
    assert [path.name for path in tmp_path.iterdir()] == ["part.ngc"]


def test_settings_and_pins_are_read_by_name() -> None:
    config = machine(settings={"ToolSensor": {"X": 12.5, "Max Depth": -3.0}}, pins={"spindle.0.on": 2.0})
    program = (
        "G0 X#<_ini[toolsensor]x> Z#<_INI[TOOLSENSOR]MAXDEPTH>\n"
        "G0 A[#<_hal[spindle.0.on]> + EXISTS[#<_hal[Probe-In]>] * 4 + EXISTS[#<_ini[toolsensor]y>] * 9]"
    )
    assert ends(program, config) == [12.5, -3.0, 6.0]


@pytest.mark.parametrize(
    ("program", "what"),
    [
        ("G0 X#<_ini[toolsensor]y>", r"#<_ini\[toolsensor\]y> is not there"),
        ("G0 X#<_hal[other]>", r"#<_hal\[other\]> is not there"),
        ("#<_ini[toolsensor]x>=1", "can only be read"),
    ],
)
def test_settings_and_pins_that_are_not_there(program: str, what: str) -> None:
    config = machine(settings={"TOOLSENSOR": {"X": 12.5}})
    with pytest.raises(polycnc.ProgramError, match=what):
        ends(program, config)


def test_pins_that_are_points_are_read_as_they_are_now() -> None:
    control = Control(machine(pins={"probe-in": 5.0}), dialect="linuxcnc")
    control.programs.create("a.ngc", "M66 P7 L3 Q2\nG0 X[#<_hal[probe-in]> + 6]\nM2\n")
    control.select_program("a.ngc")
    control.cycle_start()
    control.advance(400)
    control.machine.io["I7"] = 1
    control.advance(3000, until=lambda: not control.channels[0].active)
    assert control.channels[0].run_state is RunState.COMPLETED
    assert control.machine.state.setpoint[0] == 7.0


INI = """[EMC]
VERSION = 1.1
[DISPLAY]
PROGRAM_PREFIX = parts
[RS274NGC]
PARAMETER_FILE = sim.var
SUBROUTINE_PATH = subs:../nowhere:more
REMAP=M6 modalgroup=6 prolog=change_prolog ngc=toolchange epilog=change_epilog
REMAP = G88.1 modalgroup=1 argspec=XYZp py=cycle
REMAP=T prolog=prepare
[EMCIO]
TOOL_TABLE = sim.tbl
[TRAJ]
COORDINATES = X Z
LINEAR_UNITS = {unit}
[TOOLSENSOR]
X = 12.5
NAME = sensor
[AXIS_X]
MAX_VELOCITY = 10
MAX_ACCELERATION = 100
[AXIS_Z]
MAX_VELOCITY = 10
MAX_ACCELERATION = 100
"""
TABLE = "T3 P1 Z1.5 D.5 ; end mill\n\nT21 P2 X-2 Z+3 D1.25 I10 J20 Q2 ;turning\nT4 P9 Y7 A3\n; nothing\n"


def made(folder: Path, unit: str = "mm", table: str | None = TABLE) -> tuple[MachineConfig, str]:
    for name in ("parts", "subs", "more"):
        (folder / name).mkdir(exist_ok=True)
    (folder / "sim.var").write_text("31 4\n5221 2\n")
    if table is not None:
        (folder / "sim.tbl").write_text(table)
    (folder / "sim.ini").write_text(INI.format(unit=unit))
    text = machine_from(folder / "sim.ini")
    (folder / "m.toml").write_text(text)
    return load_machine(folder / "m.toml"), text


@pytest.mark.parametrize(("unit", "scale"), [("mm", 1.0), ("inch", 25.4)])
def test_an_ini_file_brings_its_tools_parameters_folders_and_numbers(
    unit: str, scale: float, tmp_path: Path
) -> None:
    config, text = made(tmp_path, unit)
    assert set(config.tools) == {3, 4, 21}
    end_mill, turning = config.tools[3], config.tools[21]
    assert (end_mill.length_mm, end_mill.radius_mm) == pytest.approx((1.5 * scale, 0.25 * scale))
    assert end_mill.description == "end mill"
    assert (turning.x_mm, turning.length_mm, turning.radius_mm) == pytest.approx(
        (-2 * scale, 3 * scale, 0.625 * scale)
    )
    assert turning.tip == 3
    assert config.programs.folders == tuple(str(tmp_path / each) for each in ("parts", "subs", "more"))
    assert config.programs.settings["TOOLSENSOR"] == {"X": 12.5}
    for left in ("../nowhere: there is no such folder", "A of tool 4", "I of tool 21", "J of tool 21"):
        assert left in text
    (tmp_path / "more" / "deep.ngc").write_text("o<deep> sub\nG0 Z#1\no<deep> endsub\n")
    end = ends("o<deep> call [#31]\nG0 X#<_ini[TOOLSENSOR]X>", config)
    assert end == pytest.approx([12.5 + 2 * scale, 4.0])


def test_a_negative_diameter_of_the_table_compensates_on_the_other_side(tmp_path: Path) -> None:
    """As LinuxCNC has it: along Z a G41 goes 2 mm above X20, with D-4 below (G54 is at X2)."""
    config, _ = made(tmp_path, table="T3 P1 D-4\nT4 P2 D4\n")
    assert [config.tools[number].radius_mm for number in (3, 4)] == [2.0, 2.0]
    program = "G18 G41 D{} G1 F600 X10 Z1\nX20\nG91 Z30\nZ9"
    assert [ends(program.format(tool), config)[0] for tool in (3, 4)] == pytest.approx([20.0, 24.0])


@pytest.mark.parametrize(
    "line", ["T3 P1 Zx", "T3.5 P1", "P1 Z3", "T3 Q12", "hello", f"T3 Z{9:9<400}", f"T{9:9<400}"]
)
def test_a_tool_table_with_a_wrong_line_is_refused_at_it(line: str, tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError) as found:
        made(tmp_path, table=f"T1 P1 Z2\n{line}\n")
    assert found.value.position is not None
    assert (Path(found.value.position.file).name, found.value.position.line) == ("sim.tbl", 2)


def test_files_that_are_not_there_are_left_out(tmp_path: Path) -> None:
    _, text = made(tmp_path, table=None)
    assert "EMCIO.TOOL_TABLE = sim.tbl: there is no such file" in text
    (tmp_path / "sim.var").unlink()
    assert "RS274NGC.PARAMETER_FILE = sim.var: there is no such file" in machine_from(tmp_path / "sim.ini")


@pytest.mark.parametrize(
    ("program", "what"),
    [
        ("G0 X1\nM6", r"2:1: M6 is remapped on this control: line 8 of sim.ini \(ngc=toolchange\)"),
        ("G0 X1\nG88.1 X2", r"2:1: G88.1 is remapped on this control: line 9 of sim.ini"),
        ("G0 X1\nX2 T3", r"2:4: T is remapped on this control: line 10 of sim.ini"),
    ],
)
def test_codes_that_an_ini_file_remaps_are_refused_by_name(program: str, what: str, tmp_path: Path) -> None:
    config, _ = made(tmp_path)
    with pytest.raises(polycnc.ProgramError, match=what):
        ends(program, config)
    assert ends("M61 Q3\nG0 X1 Z3", config)[:2] == [3.0, 3.0]


def test_a_tool_shifts_y(tmp_path: Path) -> None:
    config, text = made(tmp_path)
    assert "A of tool 4: tools shift X, Y and Z" in text
    config = config.model_copy(
        update={"axes": (*config.axes, config.axes[0].model_copy(update={"name": "Y"}))}
    )
    program = "G43 H4\nG0 Y1\nG0 X#5402\nG10 L1 P4 Y3\nG43.2 H4\nG0 Y1 Z#5402"
    assert ends(f"M61 Q4\n{program}", config) == pytest.approx([9.0, 3.0, 11.0])
