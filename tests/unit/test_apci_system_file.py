"""The system file: defaults, units, planning of the terminals, refusals with their place, and the way back to text."""

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.controllers.apci.board._system_axis import AxisSetup, PlantConfig
from polycnc.controllers.apci.board._system_file import (
    BoardVariables,
    InputPlan,
    OutputPlan,
    SystemFile,
    load_system_file,
    parse_system_file,
)
from polycnc.controllers.apci.board._system_text import system_file_text
from polycnc.controllers.apci.board._units import PositionUnit, TimeUnit, ratio, seconds
from polycnc.errors import ConfigurationError, UsageError
from support.apci_bits import ModeReg
from support.often import share


def refused(text: str) -> ConfigurationError:
    with pytest.raises(ConfigurationError) as caught:
        parse_system_file(text)
    return caught.value


@pytest.mark.covers("apci.const.sampletime")
def test_an_empty_file_is_a_board_with_three_servo_axes() -> None:
    config = parse_system_file("")
    assert config.axis_names == ("A1", "A2", "A3")
    assert config.number_of_axes == 3
    assert (config.board_type, config.type_number) == ("APCI-8001", 4)
    assert config.sample_time_us == 1280
    assert config.sample_time_s == 0.00128
    assert config == SystemFile()
    axis = config.axes[0]
    assert (axis.motor, axis.unit, axis.time_unit, axis.counts_per_unit) == ("servo", "mm", "sec", 1000.0)
    assert min(axis.jac, axis.jvl, axis.hac, axis.hvl, axis.sdec) > 0.0
    assert (axis.soft_left, axis.soft_right, axis.ipw, axis.mpe) == ("none", "none", 0.0, 0.0)
    assert (axis.jerkrel, axis.MaxVel, axis.MaxAcc, axis.MDVEL) == (1.0, 0.0, 0.0, 0.0)
    assert (config.board.pu, config.board.tu, config.modereg, config.nfrax) == ("mm", "sec", 0, 0)
    assert (config.outputs_at_reset, config.inputs_for("EO", 0), config.outputs_for(2)) == (0, 0, 0)


def test_axes_are_counted_or_completed_to_their_number() -> None:
    assert parse_system_file("number_of_axes = 18").axis_names[17] == "A18"
    assert parse_system_file('[[axis]]\nname = "X"').axis_names == ("X",)
    assert parse_system_file('number_of_axes = 2\n[[axis]]\nname = "X"').axis_names == ("X", "A2")
    assert parse_system_file('[[axis]]\n[[axis]]\nname = "C"\nunit = "deg"').axis_names == ("A1", "C")
    config = parse_system_file('[[axis]]\nname = "X"\n[[axis]]\nname = "c"')
    assert [config.axis_index(name) for name in ("x", "C")] == [0, 1]
    with pytest.raises(UsageError, match="no axis 'Z'"):
        config.axis_index("Z")


@pytest.mark.parametrize(
    ("text", "line", "what", "hint"),
    [
        ("jac = 3", 1, "unknown key 'jac' in the file", ""),
        ("[[axis]]\njack = 3.0", 2, "unknown key 'jack'", "'jac'"),
        ("[[axis]]\njac = 0", 2, "'jac' is 0", "jac > 0"),
        ('[[axis]]\njac = "fast"', 2, "must be a number", "1.5"),
        ("[[axis]]\nkpl = 1.1", 2, "out of range", "0 <= kpl <= 1"),
        ("[[axis]]\njvl = 5.0\njtvl = -6.0", 3, "'jtvl' is faster", "at most 5.0"),
        ('[[axis]]\nsoft_left = "SMX"', 2, "'soft_left' must be", "'SMD'"),
        ('[[axis]]\nsll = 5.0\nslr = 5.0\nsoft_left = "SMD"', 3, "no room", "sll must be below slr"),
        ('[[axis]]\nunit = "mm"\ndisplay_unit = "deg"', 3, "cannot be shown in deg", "display_factor"),
        ("[[axis]]\neffradius = 5.0", 2, "no effect", 'unit = "deg"'),
        ("[[axis]]\n[axis.plant]\nlag_s = 0.1", 3, "no effect on an ideal plant", "lag"),
        ("[[axis]]\n[axis.plant]\nlimit_left = 1.0\nlimit_right = 1.0", 4, "overlap", "below"),
        ("[[axis]]\n[axis.plant]\nreference = [2.0, 1.0]", 3, "stretch is empty", "from < to"),
        ('[[axis]]\nmotor = "stepper"\n[axis.plant]\nvelocity_at_10_v = 5.0', 4, "no effect", "remove"),
        ('[[axis]]\nname = "1X"', 2, "'1X' is not an axis name", "letter"),
        ('[[axis]]\nname = "x"\n[[axis]]\nname = "X"', 4, "two axes 'X'", "rename"),
        ("number_of_axes = 0", 1, "'number_of_axes' is 0", "<= 18"),
        ("number_of_axes = 19", 1, "'number_of_axes' is 19", "<= 18"),
        ("number_of_axes = 1\n[[axis]]\n[[axis]]", 3, "there are 2 axes", "at most 1"),
        ("[[axis]]\n" * 19, 19, "there are 19 axes", "at most 18"),
        ('board_type = "PA 8000"', 1, "'board_type' must be", ""),
        ("sample_time_us = 1280.5", 1, "a whole number", ""),
        ("[inputs.4]\nfunctions = ['LSL_SMX']", 2, "'functions' must be", "LSL_SM"),
        ("[inputs.4]\naxes = ['Q']", 2, "no axis 'Q'", "A1, A2, A3"),
        ("[board]\nmodereg = ['SProf']", 2, "no mode 'SProf'", "SProfile"),
        ("[board]\nnfrax = ['Q']", 2, "no axis 'Q'", "A1"),
        ("[board\n", 1, "not valid TOML", ""),
    ],
)
def test_a_wrong_file_is_refused_with_place_and_hint(text: str, line: int, what: str, hint: str) -> None:
    error = refused(text)
    assert error.position is not None
    assert (error.position.file, error.position.line) == ("system.dat", line)
    assert what in error.what
    assert hint in error.hint


@pytest.mark.covers("apci.const.digin", "apci.const.digout")
def test_there_are_16_inputs_and_8_outputs() -> None:
    assert set(parse_system_file("[inputs.1]\n[inputs.16]").inputs) == {1, 16}
    assert set(parse_system_file("[outputs.1]\n[outputs.8]").outputs) == {1, 8}
    for table, numbers in (("inputs", ("0", "17", "x")), ("outputs", ("0", "9"))):
        for number in numbers:
            assert f"there is no number '{number}'" in refused(f"[{table}.{number}]").what


def test_terminals_are_planned_for_axes() -> None:
    config = parse_system_file(
        """
        number_of_axes = 3
        [inputs]
        1 = { functions = ["EO"], inverted = true }
        2 = { functions = ["LSL_SMD", "REF"], axes = ["A1", "A3"] }
        16 = { functions = ["LSL_SMD"], axes = ["A1"] }
        5 = { inverted = true }
        [outputs]
        1 = { functions = ["PAE"], axes = ["A2"] }
        2 = { functions = ["PAE"] }
        8 = { set_at_reset = true }
        """
    )
    assert [config.inputs_for("EO", axis) for axis in range(3)] == [1, 1, 1]
    assert [config.inputs_for("LSL_SMD", axis) for axis in range(3)] == [0x8002, 0, 2]
    assert [config.inputs_for("REF", axis) for axis in range(3)] == [2, 0, 2]
    assert [config.inputs_for("LSR_SMD", axis) for axis in range(3)] == [0, 0, 0]
    assert config.inverted_inputs == 0b1_0001
    assert config.active_inputs(0) == 0b1_0001
    assert config.active_inputs(0x1_0003) == 0b1_0010
    assert [config.outputs_for(axis) for axis in range(3)] == [2, 3, 2]
    assert config.outputs_at_reset == 0x80
    with pytest.raises(UsageError, match="no axis 3"):
        config.inputs_for("EO", 3)
    with pytest.raises(UsageError, match="no axis -1"):
        config.outputs_for(-1)


def test_modes_and_axes_without_feed_become_registers() -> None:
    config = parse_system_file(
        '[board]\nmodereg = ["lookahead", "JSatSAF", "SProfile"]\nnfrax = ["A3", "A1"]'
    )
    assert config.modereg == 1 | 1 << 28 | ModeReg.SProfile
    assert config.nfrax == 0b101


@pytest.mark.covers("apci.const.clock8001", "apci.const.clock8008")
def test_the_clock_of_step_pulses_follows_the_board() -> None:
    assert parse_system_file('board_type = "APCI-8001"').stepper_clock_hz == 70_000_000
    assert parse_system_file('board_type = "APCI-8008"').stepper_clock_hz == 66_666_660
    assert parse_system_file('board_type = "APCI-8008"').type_number == 32


def test_units_are_numbered_and_turned_into_each_other() -> None:
    assert [unit.name for unit in sorted(PositionUnit)] == "mm inch m rev deg rad counts steps".split()  # noqa: SIM905
    assert [unit.name for unit in sorted(TimeUnit)] == ["sec", "min", "tsample"]
    mm, inch, m, rev, deg, rad, counts, steps = sorted(PositionUnit)
    assert ratio(inch, mm, 1000.0) == 25.4
    assert ratio(mm, m, 1000.0) == 0.001
    assert ratio(rev, deg, 1000.0) == 360.0
    assert ratio(deg, rad, 1000.0) == pytest.approx(math.pi / 180.0, rel=1e-15)
    assert ratio(mm, counts, 1000.0) == ratio(deg, steps, 1000.0) == 1000.0
    assert ratio(counts, steps, 7.0) == 1.0
    assert ratio(mm, deg, 1.0) is ratio(deg, mm, 1.0) is ratio(counts, mm, 1.0) is None
    assert [seconds(unit, 0.00128) for unit in sorted(TimeUnit)] == [1.0, 60.0, 0.00128]


def test_positions_are_shown_in_the_display_unit() -> None:
    axis = AxisSetup(name="X", unit="inch", display_unit="mm", display_factor=2.0)
    assert axis.display_ratio(axis.counts_per_unit) == pytest.approx(50.8, rel=1e-15)
    counts = AxisSetup(name="X", display_unit="counts", slsp=500.0, gf=0.2)
    assert counts.counts_per_unit == 100.0
    assert counts.display_ratio(counts.counts_per_unit) == 100.0
    assert counts.display_ratio(250.0) == 250.0  # after wrgf or wrslsp
    assert AxisSetup(name="C", unit="rad").is_rotary
    assert not axis.is_rotary


def test_limits_of_the_motor_command() -> None:
    assert AxisSetup(name="X").mcp_range == (-32767, 32767)
    assert AxisSetup(name="X", motor="stepper").mcp_range == (-1_048_574, 1_048_574)
    assert AxisSetup(name="X").mcp_limits_are_possible
    assert AxisSetup(name="X", mcpmin=-100, mcpmax=200, mcpcp=5, mcpcn=-5).mcp_limits_are_possible
    for wrong in ({"mcpmax": 32768}, {"mcpmin": -32768}, {"mcpmax": -1}, {"mcpcp": -1}, {"mcpcn": 1}):
        assert not AxisSetup(name="X", **wrong).mcp_limits_are_possible  # type: ignore[arg-type]
    assert not AxisSetup(name="X", mcpmin=0, mcpmax=0).mcp_limits_are_possible


def test_differences_from_the_board_are_found() -> None:
    board = parse_system_file("")
    assert parse_system_file("[[axis]]\njac = 5.0\n[[axis]]\n[[axis]]").differences(board) == ()
    other = parse_system_file(
        'board_type = "APCI-8008"\nnumber_of_axes = 2\n[[axis]]\n[[axis]]\nmotor = "stepper"'
    )
    assert other.differences(board) == ("board_type", "number_of_axes", "motor of axis 1")


def test_a_file_is_read_from_disk(tmp_path: Path) -> None:
    path = tmp_path / "system.dat"
    path.write_text('[[axis]]\nname = "X"\n')
    assert load_system_file(path).axis_names == ("X",)
    with pytest.raises(ConfigurationError, match="cannot read"):
        load_system_file(tmp_path / "other.dat")


numbers = st.floats(0.001, 1e6)
names = st.text(max_size=8)
axes: st.SearchStrategy[dict[str, Any]] = st.builds(
    dict,
    motor=st.sampled_from(["servo", "stepper"]),
    unit=st.sampled_from(["mm", "deg", "counts"]),
    jac=numbers,
    jtvl=st.floats(-1.0, 1.0),
    MDVEL=numbers,
    sll=st.floats(-1e6, -1.0),
    slr=st.floats(1.0, 1e6),
    soft_left=st.sampled_from(["none", "TOM", "SMA", "SMD"]),
    mcpmax=st.none() | st.integers(1, 32767),
    mcp_inverted=st.booleans(),
    plant=st.builds(
        PlantConfig,
        kind=st.just("lag"),
        lag_s=numbers,
        limit_left=st.none() | st.floats(-9.0, -1.0),
        reference=st.none() | st.just((-1.5, 2.5)),
    ),
)
files = st.builds(
    lambda axes, **rest: SystemFile(
        axis=tuple(AxisSetup(name=f"A{n}", **each) for n, each in enumerate(axes, 1)), **rest
    ),
    axes=st.lists(axes, min_size=1, max_size=3),
    board_type=st.sampled_from(["APCI-8001", "APCI-8008"]),
    sample_time_us=st.integers(1, 100_000),
    board=st.builds(BoardVariables, trac=numbers, modereg=st.just(("maxcheck",)), nfrax=st.just(("A1",))),
    inputs=st.dictionaries(
        st.integers(1, 16),
        st.builds(InputPlan, functions=st.just(("LP", "UI")), axes=st.just(("A1",)), inverted=st.booleans()),
    ),
    outputs=st.dictionaries(st.integers(1, 8), st.builds(OutputPlan, set_at_reset=st.booleans())),
    environment=st.dictionaries(names, names),
)


@settings(max_examples=share(60))
@given(files)
def test_a_system_file_comes_back_from_its_text(config: SystemFile) -> None:
    assert parse_system_file(system_file_text(config)) == config


def test_the_text_names_every_key_once_and_stays_the_same() -> None:
    text = system_file_text(parse_system_file("number_of_axes = 1"))
    assert text.count("jac = 1000.0\n") == text.count("[axis.plant]\n") == text.count("[board]\n") == 1
    assert system_file_text(parse_system_file(text)) == text


@pytest.mark.parametrize("key", ["slsp", "gf", "display_factor"])
@pytest.mark.parametrize("value", ["5e-324", "9e-101", "1.1e100"])
def test_factors_whose_products_would_be_0_or_infinite_are_refused(key: str, value: str) -> None:
    with pytest.raises(ConfigurationError, match=f"'{key}' is .* out of range"):
        parse_system_file(f"[[axis]]\n{key} = {value}\n")
