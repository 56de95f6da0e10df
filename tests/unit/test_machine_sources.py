"""Machine files from the configurations of other controls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from polycnc import runner
from polycnc.errors import ConfigurationError
from polycnc.machine import MachineConfig, parse_machine
from polycnc.runner import machine_from
from support.command import polycnc

GRBL = """\
Grbl 1.1h ['$' for help]
$0=10 (step pulse, usec)
$11=0.013 (junction deviation, mm)
$12=0.002
$20=1
$22=1
$23=2
$27=1.500
$30=18000.
$110=4500.000 (x max rate, mm/min)
$111=4200.000
$112=900.000
$120=310.000
$121=290.000
$122=55.000
$130=410.000
$131=420.000
$132=83.000
ok
"""
OFFSETS = "[G54:-395.500,-407.250,-31.000]\n[G55:1,2,3]\n[G28:0,0,0]\n"

KLIPPER = """\
[mcu]
serial: /dev/serial
[printer]
kinematics: corexy
max_velocity: 320   # fast
max_accel = 4100 ; strong
max_z_velocity: 17
max_z_accel: 130
square_corner_velocity: 6.5
[stepper_x]
position_endstop: 251
position_max: 252
[stepper_y]
position_min: -3
position_max: 243
position_endstop: 243
[stepper_z]
position_max: 229
"""

SMOOTHIE = """\
# comment
default_feed_rate 4000 # mm/min
alpha_steps_per_mm 80
alpha_max_rate 29000.0
beta_max_rate 31000
gamma_max_rate 310
x_axis_max_speed 27000
acceleration 2900
gamma_acceleration 510
junction_deviation 0.037
soft_endstop.enable true
soft_endstop.x_min -302
soft_endstop.x_max 7
alpha_homing_direction home_to_max
alpha_max 5
"""

FLUIDNC = """\
name: "Mill"
junction_deviation_mm: 0.017
arc_tolerance_mm: 0.002
axes:
  x:
    max_rate_mm_per_min: 5100.000
    acceleration_mm_per_sec2: 210.000
    max_travel_mm: 303.000
    soft_limits: true
    homing:
      cycle: 2
      positive_direction: false
      mpos_mm: 7.000
  z:
    acceleration_mm_per_sec2: 83
    soft_limits: true
    max_travel_mm: 60
    homing:
      mpos_mm: 2
"""

LINUXCNC = """\
[EMCMOT]
SERVO_PERIOD = 500000
[RS274NGC]
RS274NGC_STARTUP_CODE = G17 G21 G64 P0.013
[TRAJ]
COORDINATES = X Y Z A
LINEAR_UNITS = inch
MAX_LINEAR_VELOCITY = 5
[KINS]
KINEMATICS = trivkins coordinates=XYYZA
[SPINDLE_0]
MAX_FORWARD_VELOCITY = 9000
[AXIS_X]
MAX_VELOCITY = 4
MAX_ACCELERATION = 30
MIN_LIMIT = -1
MAX_LIMIT = 20
[AXIS_Y]
MAX_VELOCITY = 3
MAX_ACCELERATION = 25
[JOINT_2]
MAX_VELOCITY = 2.5
MAX_ACCELERATION = 28
[AXIS_Z]
MAX_VELOCITY = 1.5
MAX_ACCELERATION = 12
HOME = 0
[AXIS_A]
MAX_VELOCITY = 60
MAX_ACCELERATION = 700
"""

FANUC = """\
%
N00000Q1L1P00000010
N01001Q1P00000000
N01020Q1A1P88A2P89A3P90
N01221Q1A1P-310.5A2P-207.25A3P-12.0
N01240Q1A1P0.0A2P0.0A3P250.5
N01320Q1A1P510.0A2P420.5A3P251.0
N01321Q1A1P-1.0A2P-1.5A3P-3.0
N01420Q1A1P24000.0A2P21000.0A3P15000.0
N01620Q1A1P120A2P150A3P180
N01783Q1A1P300.0A2P270.0A3P150.0
N03741Q1S1P12000
N01825Q1A1P3000A2P3000A3P3000
%
"""


def write(folder: Path, text: str, name: str = "machine.cfg") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def made(folder: Path, text: str) -> tuple[MachineConfig, str]:
    toml = machine_from(write(folder, text))
    return parse_machine(toml, "made.toml"), toml


def axes(config: MachineConfig) -> dict[str, Any]:
    return {
        axis.name: (axis.vmax, pytest.approx(axis.amax), axis.soft_limits, axis.home) for axis in config.axes
    }


NO_END = (-float("inf"), float("inf"))


def test_grbl_rates_become_speeds_and_the_deviation_the_corner_rule(tmp_path: Path) -> None:
    config, toml = made(tmp_path, GRBL)
    assert axes(config) == {
        "X": (75.0, 310.0, NO_END, 0.0),
        "Y": (70.0, 290.0, NO_END, 0.0),
        "Z": (15.0, 55.0, NO_END, 0.0),
    }
    assert config.path.junction_deviation_mm == 0.013
    assert config.spindle.max_rpm == 18000.0
    assert "travel X -410 to 0, Y -420 to 0, Z -83 to 0" in toml
    assert "$12 = 0.002" in toml


def test_grbl_travel_counts_where_the_offsets_are_known(tmp_path: Path) -> None:
    config, _ = made(tmp_path, GRBL + OFFSETS)
    assert axes(config) == {
        "X": (75.0, 310.0, (-410.0, 0.0), -1.5),
        "Y": (70.0, 290.0, (-420.0, 0.0), -418.5),  # homed on the other side
        "Z": (15.0, 55.0, (-83.0, 0.0), -1.5),
    }
    assert config.work_offset("G54") == (-395.5, -407.25, -31.0)
    assert config.work_offset("G55") == (1.0, 2.0, 3.0)


def test_klipper_limits_the_path_and_passes_corners_by_the_square_corner_speed(tmp_path: Path) -> None:
    config, toml = made(tmp_path, KLIPPER)
    assert axes(config) == {
        "X": (320.0, 4100.0, (0.0, 252.0), 251.0),
        "Y": (320.0, 4100.0, (-3.0, 243.0), 243.0),
        "Z": (17.0, 130.0, (0.0, 229.0), 0.0),
    }
    path = config.path
    assert (path.speed_limit_mm_s, path.acceleration_limit_mm_s2, path.square_corner_mm_s) == (320, 4100, 6.5)
    assert path.minimum_cruise_share == 0.5  # its default
    assert "minimum_cruise" not in "".join(line for line in toml.splitlines() if line.startswith("#"))


@pytest.mark.parametrize(
    ("line", "share"),
    [
        ("minimum_cruise_ratio: 0.3", 0.3),
        ("minimum_cruise_ratio: 0", 0.0),
        ("max_accel_to_decel: 1025", 0.75),
        ("max_accel_to_decel: 9000", 0.0),
    ],
)
def test_klipper_keeps_a_part_of_the_way_for_cruising(tmp_path: Path, line: str, share: float) -> None:
    config, _ = made(tmp_path, KLIPPER.replace("[printer]", f"[printer]\n{line}"))
    assert config.path.minimum_cruise_share == pytest.approx(share, rel=1e-12)


def test_a_cruise_ratio_of_one_is_refused_at_its_place(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"a minimum cruise ratio of 1\.0"):
        made(tmp_path, KLIPPER.replace("[printer]", "[printer]\nminimum_cruise_ratio: 1.0"))


def test_klipper_takes_its_default_corner_speed_and_names_what_lies_elsewhere(tmp_path: Path) -> None:
    text = "[include motors.cfg]\n[printer]\nkinematics: delta\nmax_velocity: 310\nmax_accel: 2900\n"
    config, toml = made(tmp_path, text)
    assert config.path.square_corner_mm_s == 5.0
    assert "[include motors.cfg]" in toml
    assert "kinematics delta" in toml
    assert all(axis.soft_limits == NO_END for axis in config.axes)


def test_smoothieware_takes_the_lower_of_both_speeds_and_each_acceleration(tmp_path: Path) -> None:
    config, _ = made(tmp_path, SMOOTHIE)
    assert axes(config) == {
        "X": (450.0, 2900.0, (-302.0, 7.0), 5.0),
        "Y": (pytest.approx(31000.0 / 60.0), 2900.0, NO_END, 0.0),
        "Z": (pytest.approx(310.0 / 60.0), 510.0, NO_END, 0.0),
    }
    assert config.path.junction_deviation_mm == 0.037


def test_fluidnc_is_read_with_the_defaults_of_its_control(tmp_path: Path) -> None:
    pytest.importorskip("yaml", reason="pip install 'polycnc[yaml]'")
    config, _ = made(tmp_path, FLUIDNC)
    assert axes(config) == {
        "X": (85.0, 210.0, (7.0, 310.0), 7.0),
        "Z": (pytest.approx(1000.0 / 60.0), 83.0, (-58.0, 2.0), 2.0),
    }
    assert config.path.junction_deviation_mm == 0.017
    assert not config.spindle.laser
    assert made(tmp_path, FLUIDNC + "Laser:\n  pwm_hz: 5000\n")[0].spindle.laser


@pytest.mark.parametrize(("line", "laser"), [("$32=1", True), ("$32=0 (laser mode)", False), ("", False)])
def test_grbl_tells_a_laser(tmp_path: Path, line: str, laser: bool) -> None:
    config, _ = made(tmp_path, GRBL.replace("ok\n", f"{line}\nok\n"))
    assert config.spindle.laser is laser
    assert config.spindle.max_rpm == 18000.0


def test_linuxcnc_takes_the_lowest_of_axis_and_joints_in_millimetres(tmp_path: Path) -> None:
    config, _ = made(tmp_path, LINUXCNC)
    assert config.cycle_s == 0.0005
    x, y, z, a = config.axes
    assert x.vmax == pytest.approx(4 * 25.4)
    assert x.amax == pytest.approx(30 * 25.4)
    assert x.soft_limits == pytest.approx((-25.4, 508.0))
    assert y.vmax == pytest.approx(2.5 * 25.4)  # of joint 2
    assert y.amax == pytest.approx(25 * 25.4)  # of the axis
    assert z.vmax == pytest.approx(1.5 * 25.4)
    assert z.amax == pytest.approx(12 * 25.4)
    assert (a.kind, a.vmax, a.amax) == ("rotary", 60.0, 700.0)
    assert config.path.speed_limit_mm_s == pytest.approx(127.0)
    assert config.path.path_tolerance_mm == 0.013  # G21 stands before it
    assert config.spindle.max_rpm == 9000.0
    free, _ = made(tmp_path, LINUXCNC.replace("G64 P0.013", "G64"))
    assert free.path.path_tolerance_mm == "free"
    assert (config.path.merge_mm, free.path.merge_mm) == (0.013, 0.0)
    apart, _ = made(tmp_path, LINUXCNC.replace("G64 P0.013", "G64 P0.013 Q0.07"))
    assert (apart.path.path_tolerance_mm, apart.path.merge_mm) == (0.013, 0.07)


@pytest.mark.parametrize(
    ("lines", "jerk"),
    [
        ("PLANNER_TYPE = 1\nMAX_LINEAR_JERK = 800", pytest.approx(800 * 25.4)),
        ("PLANNER_TYPE = 0\nMAX_LINEAR_JERK = 800", None),
        ("MAX_LINEAR_JERK = 800", None),
        ("PLANNER_TYPE = 1\nMAX_LINEAR_JERK = 0.5", None),
        ("PLANNER_TYPE = 1", None),
    ],
)
def test_linuxcnc_limits_the_jerk_with_its_second_planner_only(
    tmp_path: Path, lines: str, jerk: object
) -> None:
    config, _ = made(tmp_path, LINUXCNC.replace("[TRAJ]", f"[TRAJ]\n{lines}"))
    assert config.path.jerk_mm_s3 == jerk


def test_linuxcnc_corners_are_those_of_its_trapezoidal_planner(tmp_path: Path) -> None:
    lines = "ARC_BLEND_KINK_RATIO = 0.04\nARC_BLEND_GAP_CYCLES = 6"
    plain, _ = made(tmp_path, LINUXCNC)
    told, _ = made(tmp_path, LINUXCNC.replace("[TRAJ]", f"[TRAJ]\n{lines}"))
    jerk, _ = made(
        tmp_path, LINUXCNC.replace("[TRAJ]", f"[TRAJ]\n{lines}\nPLANNER_TYPE = 1\nMAX_LINEAR_JERK = 800")
    )
    found = [
        (path.corner_share, path.rounding_share, path.last_share, path.rounding_gap_s, path.free_overlaps)
        for path in (plain.path, told.path, jerk.path)
    ]
    # Its servo period is half a millisecond.
    assert found == [
        (0.1, 0.5, 0.5, 0.002, True),
        (0.04, 0.5, 0.5, 0.003, True),
        (None, None, None, 0.0, False),
    ]


def test_fanuc_ramps_give_the_acceleration_and_corner_steps_the_jump(tmp_path: Path) -> None:
    config, toml = made(tmp_path, FANUC)
    assert axes(config) == {
        "X": (400.0, 400.0 / 0.12, (-1.0, 510.0), 0.0),
        "Y": (350.0, 350.0 / 0.15, (-1.5, 420.5), 0.0),
        "Z": (250.0, 250.0 / 0.18, (-3.0, 251.0), 250.5),
    }
    assert [axis.jump for axis in config.axes] == [5.0, 4.5, 2.5]
    assert config.work_offset("G54") == (-310.5, -207.25, -12.0)
    assert config.spindle.max_rpm == 12000.0
    assert "1825" in toml


def test_fanuc_whole_numbers_count_increments_and_inches_are_inches(tmp_path: Path) -> None:
    older = (
        "%\nN1013A1P00000000A2P00000010\nN1320A1P310500A2P310500\nN1321A1P-2000A2P-2000\n"
        "N1420A1P9000A2P9000\nN1770P6000\nN1771P250\n%\n"
    )
    config, _ = made(tmp_path, older)
    assert axes(config) == {
        "X": (150.0, 400.0, (-2.0, 310.5), 0.0),
        "Y": (150.0, 400.0, (pytest.approx(-0.2), pytest.approx(31.05)), 0.0),  # IS-C
    }
    config, _ = made(tmp_path, older.replace("%\nN1013", "%\nN1001P00000001\nN1013"))
    assert config.axes[0].vmax == pytest.approx(150.0 * 25.4)
    assert config.axes[0].soft_limits == pytest.approx((-0.2 * 25.4, 31.05 * 25.4))


def test_grbl_without_a_pull_off_is_homed_on_its_switches(tmp_path: Path) -> None:
    config, _ = made(tmp_path, GRBL.replace("$27=1.500\n", "") + OFFSETS)
    assert [axis.home for axis in config.axes] == [0.0, -420.0, 0.0]
    other, _ = made(tmp_path, GRBL.replace("$23=2", "$23=5").replace("$22=1", "$22=0") + OFFSETS)
    assert [axis.home for axis in other.axes] == [0.0, 0.0, 0.0]
    sides, _ = made(tmp_path, GRBL.replace("$23=2", "$23=5") + OFFSETS)
    assert [axis.home for axis in sides.axes] == [-408.5, -1.5, -81.5]


@pytest.mark.parametrize(
    ("lines", "acceleration"),
    [
        ("N01660Q1A1P3100.0A2P2700.0", (3100.0, 2700.0)),  # before interpolation, that of each axis
        ("N01660Q1A1P0A2P2700.0", (400.0 / 0.12, 2700.0)),
        ("N01770Q1A1P24000.0A2P18000.0\nN01771Q1A1P160A2P150", (2500.0, 2000.0)),
        ("N01660Q1A1P3100.0\nN01770Q1A1P24000.0A2P18000.0\nN01771Q1A1P160A2P150", (3100.0, 2000.0)),
        ("N01770P21000.0\nN01771P140", (2500.0, 2500.0)),  # one for all
        ("N01770P21000.0", (400.0 / 0.12, 350.0 / 0.15)),
    ],
)
def test_fanuc_accelerations_before_interpolation_come_before_those_of_rapids(
    tmp_path: Path, lines: str, acceleration: tuple[float, float]
) -> None:
    config, _ = made(tmp_path, FANUC.replace("N01620", f"{lines}\nN01620"))
    assert tuple(axis.amax for axis in config.axes[:2]) == pytest.approx(acceleration)


def test_fanuc_names_that_are_not_given_are_those_of_the_places(tmp_path: Path) -> None:
    config, toml = made(
        tmp_path, FANUC.replace("N01020Q1A1P88A2P89A3P90\n", "").replace("N01783Q1A1P300.0", "N01783Q1A1P0")
    )
    assert [axis.name for axis in config.axes] == ["X", "Y", "Z"]
    assert [axis.jump for axis in config.axes] == [None, 4.5, 2.5]
    named, _ = made(tmp_path, FANUC.replace("A1P88A2P89", "A1P85A2P65"))
    assert [(axis.name, axis.kind) for axis in named.axes] == [
        ("U", "linear"),
        ("A", "rotary"),
        ("Z", "linear"),
    ]
    assert "1825" in toml
    assert "other parameters" not in toml
    free, _ = made(tmp_path, FANUC.replace("A1P510.0", "A1P99999.0").replace("A1P-1.0", "A1P-99999.0"))
    assert [axis.soft_limits for axis in free.axes] == [NO_END, (-1.5, 420.5), (-3.0, 251.0)]


@pytest.mark.parametrize(
    ("lines", "path"),
    [
        ("PLANNER_TYPE = 1\nMAX_LINEAR_JERK = 1", {"jerk_mm_s3": 25.4}),
        ("ARC_BLEND_GAP_CYCLES = 9000", {"rounding_gap_s": 1.0}),  # 4.5 s
        ("ARC_BLEND_GAP_CYCLES = -3", {"rounding_gap_s": 0.0}),
        ("ARC_BLEND_KINK_RATIO = 0.9", {"corner_share": 0.5}),
        ("ARC_BLEND_KINK_RATIO = 0", {"corner_share": 0.001}),
        ("MAX_LINEAR_ACCELERATION = 17", {"acceleration_limit_mm_s2": pytest.approx(17 * 25.4)}),
    ],
)
def test_linuxcnc_paths_keep_to_what_a_machine_may_have(
    tmp_path: Path, lines: str, path: dict[str, object]
) -> None:
    config, _ = made(tmp_path, LINUXCNC.replace("[TRAJ]", f"[TRAJ]\n{lines}"))
    assert {name: getattr(config.path, name) for name in path} == path


@pytest.mark.parametrize(
    ("start", "tolerance_mm", "merge_mm"),
    [
        ("G17 G64 P0.013", 0.013 * 25.4, 0.013 * 25.4),  # the machine's inches
        ("G20 G64 P0.002 Q0.01", 0.002 * 25.4, 0.01 * 25.4),
        ("G21 G64 P0.07 Q0.02", 0.07, 0.02),
        ("G61", "free", 0.0),
    ],
)
def test_linuxcnc_start_codes_are_in_the_unit_that_they_name(
    tmp_path: Path, start: str, tolerance_mm: float | str, merge_mm: float
) -> None:
    config, _ = made(tmp_path, LINUXCNC.replace("G17 G21 G64 P0.013", start))
    wanted = tolerance_mm if isinstance(tolerance_mm, str) else pytest.approx(tolerance_mm)
    assert config.path.path_tolerance_mm == wanted
    assert config.path.merge_mm == pytest.approx(merge_mm)


def test_a_fluidnc_file_that_is_no_yaml_is_refused_at_its_place(tmp_path: Path) -> None:
    pytest.importorskip("yaml", reason="pip install 'polycnc[yaml]'")
    with pytest.raises(ConfigurationError) as caught:
        made(tmp_path, FLUIDNC.replace("    max_travel_mm: 60", "    max_travel_mm: [60"))
    assert "machine.cfg:" in str(caught.value)
    assert "this is no YAML" in str(caught.value)
    with pytest.raises(ConfigurationError, match=r"machine\.cfg:8:20:"):
        made(tmp_path, FLUIDNC.replace("max_travel_mm: 303.000", "max_travel_mm: far"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hello\n", ("the configuration of no control", "grbl")),
        ("", ("the configuration of no control", "grbl")),
        (GRBL.replace("$121=290.000\n", ""), ("there is no '$121'", "axis Y")),
        (GRBL.replace("$120=310.000", "$120=fast"), ("machine.cfg:13:6", "'$120' is no number: 'fast'")),
        (GRBL.replace("$120=310.000", "$120=1e999"), ("machine.cfg:13:6", "no number")),
        (GRBL.replace("$110=4500.000", "$110=0"), ("machine.cfg:10:6", "not above zero")),
        (KLIPPER.replace("max_accel = 4100 ; strong\n", ""), ("no 'printer.max_accel'",)),
        (KLIPPER.replace("corexy", "none"), ("machine.cfg:4:13", "no kinematics")),
        (
            KLIPPER.replace("square_corner_velocity: 6.5", "square_corner_velocity: 0"),
            ("stops at every corner",),
        ),
        (KLIPPER.replace("position_max: 229", "position_max: 0"), ("axis Z has no travel",)),
        (SMOOTHIE.replace("acceleration 2900\n", "", 1), ("no 'acceleration'",)),
        (LINUXCNC.replace("[AXIS_A]\nMAX_VELOCITY = 60", "[AXIS_A]"), ("axis A has no MAX_VELOCITY",)),
        (LINUXCNC.replace("MIN_LIMIT = -1", "MIN_LIMIT = 1"), ("outside", "HOME inside")),
        (FANUC.replace("N01620", "N01621"), ("axis X has no acceleration", "1620")),
        (FANUC.replace("A2P21000.0", "A2P2.1.0"), ("machine.cfg:9:22:", "is no number")),
        (
            LINUXCNC.replace("X Y Z A", "").replace("coordinates=XYYZA", ""),
            ("machine.cfg:6:", "no axis is named", "X Y Z"),
        ),
    ],
)
def test_what_is_missing_or_wrong_is_named_with_its_place(
    tmp_path: Path, text: str, words: tuple[str, ...]
) -> None:
    with pytest.raises(ConfigurationError) as caught:
        machine_from(write(tmp_path, text))
    for word in words:
        assert word in str(caught.value)


def test_what_is_wrong_comes_before_what_to_do(tmp_path: Path) -> None:
    text = LINUXCNC.replace("X Y Z A", "").replace("coordinates=XYYZA", "")
    with pytest.raises(ConfigurationError) as caught:
        machine_from(write(tmp_path, text))
    first, *_, last = str(caught.value).splitlines()
    assert "no axis is named" in first
    assert last == "Write them like COORDINATES = X Y Z."


def test_a_hostile_configuration_writes_no_key_into_the_file(tmp_path: Path) -> None:
    text = GRBL + "$12=0.002\n$999=1\x85vmax=9\n"
    config, toml = made(tmp_path, text)
    assert config == parse_machine(toml, "made.toml")
    named = write(tmp_path, GRBL, 'a"\n[path]\njerkrel = 1 #.txt')
    assert parse_machine(machine_from(named), "made.toml").path.jerkrel == 0.0


def test_the_command_prints_or_writes_a_file_that_runs(tmp_path: Path) -> None:
    source = write(tmp_path, GRBL, "router.txt")
    printed = polycnc("machine", "--from", source)
    assert printed.stderr == ""
    done = polycnc("machine", "--from", source, "-o", tmp_path / "router.toml")
    assert (tmp_path / "router.toml").read_text(encoding="utf-8") == printed.stdout
    assert "3" in done.stdout
    square = write(tmp_path, "G1 F4000 X40\nY40\nX0\nY0\n", "square.nc")
    assert runner.run(square, tmp_path / "router.toml").ok


def test_the_command_refuses_what_cannot_be_meant(tmp_path: Path) -> None:
    source = write(tmp_path, GRBL, "router.toml")
    polycnc("machine", "--from", source, "-o", source, status=2)
    assert source.read_text(encoding="utf-8") == GRBL
    polycnc("machine", "mill3", "--from", source, status=2)
    polycnc("machine", "-o", tmp_path / "x.toml", status=2)
    polycnc("machine", "--from", tmp_path / "none.cfg", status=2)
    assert not (tmp_path / "x.toml").exists()
