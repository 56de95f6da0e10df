"""FANUC turning: diameters, ways, the turret, cycles pass by pass, threads and surface speed, worked out by hand."""

from __future__ import annotations

import math

import pytest

import polycnc
from polycnc.machine import load_machine
from polycnc.nc import load_dialect
from polycnc.nc.blocks._turning import Threading, thread_depths
from support.programs import machine_config, moves, prepare, refusal

AXES = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 5000\n' for name in "XZ")
LATHE = machine_config(
    AXES,
    "[spindle]\nmax_rpm = 4000\n[times]\ntool_change_s = 0.5\n",
    "[tools.3]\nradius_mm = 0.8\ntip = 3\nx_mm = 7\nz_mm = -2.5\nwear_x_mm = 0.125\n",
    "[tools.4]\nradius_mm = 0.4\ntip = 3\n[tools.5]\nradius_mm = 0.5\ntip = 2\n[tools.6]\nradius_mm = 0.4\n",
)
DIAMETER = machine_config(
    AXES.replace('name = "X"\n', 'name = "X"\ndiameter = true\n'), "[spindle]\nmax_rpm = 4000\n"
)
TURN = "G97 S1000 M3\n"


def turned(program: str, start: str = "G0 X50. Z2.\n") -> list[str]:
    """Return what a program does after its start at 1000 rpm."""
    return moves(f"{TURN}{start}{program}\n", config=LATHE, dialect="fanuc-lathe")[2:]


def wrong(program: str, start: str = "G0 X50. Z2.\n") -> str:
    return refusal(f"{TURN}{start}{program}\n", config=LATHE, dialect="fanuc-lathe").split(": ", 1)[1]


# --- words


@pytest.mark.parametrize(
    ("one", "two", "start"),
    [
        ("G71 P10 Q20 U1. W0.1 D4. F0.3\n{}", "G71 U4. R0.5\nG71 P10 Q20 U1. W0.1 F0.3\n{}", "G0 X60. Z2.\n"),
        ("G71 P10 Q20 U1. D4000 F0.3\n{}", "G71 U4. R0.5\nG71 P10 Q20 U1. F0.3\n{}", "G0 X60. Z2.\n"),
        ("G75 X44. Z-2. I3. K2000 D0.25 F0.1\n", "G75 X44. Z-2. P3000 Q2000 R0.25 F0.1\n", "G0 X50. Z2.\n"),
        ("G74 X44. Z-9. I3. K2. F0.1\n", "G74 X44. Z-9. P3000 Q2000 F0.1\n", "G0 X50. Z2.\n"),
        ("G76 X27.4 Z-20. K1.3 D500 F2.\n", "G76 X27.4 Z-20. P1300 Q500 F2.\n", "G0 X30. Z5.\n"),
    ],
)
def test_a_cycle_in_one_block_is_that_in_two(one: str, two: str, start: str) -> None:
    """As FANUC's Series 15 and Haas lathes have them: D, I and K say what the first block says else, and P and Q."""
    found = turned(one.format(CONTOUR), start)
    assert len(found) > 3
    assert found == turned(two.format(CONTOUR), start)


def test_x_is_a_diameter_and_u_w_are_ways() -> None:
    assert turned("G1 X40. Z-3.5 F0.2\nU-5. W-1.5\nU1.\nW0.5 X30.\n") == [
        *("line X20 Z-3.5 F200", "line X17.5 Z-5 F200", "line X18 F200", "line X15 Z-4.5 F200")
    ]


def test_i_k_and_r_are_radii() -> None:
    """From X50 (radius 25) Z2: quarters of radius 5, and the rest of such a circle."""
    assert turned("G2 X60. Z-3. I5. F0.2\nG3 X50. Z-8. R5.\n") == [
        "arc X30 Z-3 about Z2 X30 by -90 F200",
        "arc X25 Z-8 about Z-3 X25 by 90 F200",
    ]
    assert turned("G2 X60. Z-3. K-5. F0.2\n") == ["arc X30 Z-3 about Z-3 X25 by -270 F200"]


def test_inch_words_are_diameters_too() -> None:
    assert turned("G20 G1 X2. F0.01\nU-0.2\n")[0] == "line X25.4 F254"
    assert turned("G20 G1 X2. F0.01\nU-0.2\n")[1] == "line X22.86 F254"
    assert turned("G20 G1 X2. F0.01\nG21 X40.\n")[1] == "line X20 F254"


def test_a_way_and_a_position_of_one_axis_exclude_each_other() -> None:
    assert wrong("G1 X40. U2. F0.1") == "U and X both say where X goes"
    assert "no axis 'V'" in wrong("G1 V2. F0.1")


def test_the_machine_can_say_that_x_is_a_diameter() -> None:
    program = "G90 G1 X40 F500\nG2 X50 Z-5 I5 K0\nG91 G1 X-6\n"
    found = moves("G18 F500\n" + program, config=DIAMETER)
    assert found[0] == "line X20 F500"
    assert found[1].startswith("arc X25 Z-5 about Z0 X25")
    plain = machine_config(AXES, "[spindle]\nmax_rpm = 4000\n")
    assert moves("G18 F500\nG1 X40\n", config=plain) == ["line X40 F500"]
    # Said twice is said once.
    assert moves("X40.\n", config=DIAMETER, dialect="fanuc-lathe") == ["rapid X20 stop"]


@pytest.mark.parametrize("ordinary_blocks", [0, 1000])
def test_both_ways_to_read_blocks_read_diameters_alike(ordinary_blocks: int) -> None:
    program = "G18 G1 X40 Z-3 F500\nG2 X50 Z-8 I0 K-5\nG3 X44 Z-11 R3\nG1 X30\n"
    one = moves(program, config=DIAMETER, ordinary_blocks=ordinary_blocks)
    assert one == moves(program, config=DIAMETER, ordinary_blocks=math.inf)
    assert one[0] == "line X20 Z-3 F500"


def test_the_position_can_be_set_to_a_diameter() -> None:
    """At radius 25, Z2, which is called X80 Z12 from there on; U5 adds 5 to the diameter."""
    assert turned("G50 X80. Z12.\nG0 X84. Z10.\n") == ["rapid X27 Z0 stop"]
    assert turned("G50 U5.\nG0 X57.\n") == ["rapid X26 stop"]


def test_home_by_ways() -> None:
    assert turned("G28 U0 W0\n") == ["rapid X0 Z0 stop"]
    assert turned("G28 U10. W1.\n") == ["rapid X30 Z3 stop", "rapid X0 Z0 stop"]


def test_the_dialect_begins_as_the_control_does() -> None:
    """Rapid, ZX, feed per revolution, millimetres."""
    assert turned("X10.\n") == ["rapid X5 stop"]
    assert refusal("G1 X5. F0.1\n", config=LATHE, dialect="fanuc-lathe").endswith("with the spindle at rest")
    assert turned("G98 G1 X10. F120.\nG99 F0.3 X8.\n") == ["line X5 F120", "line X4 F300"]


# --- the turret


def test_t_turns_the_turret_and_takes_the_offset() -> None:
    """Tool 3 lies 7.125 mm out in X (a radius) and -2.5 in Z."""
    found = moves("T0303\nG0 X20. Z5.\nT0300\nX20.\nT0403\nX22.\n", config=LATHE, dialect="fanuc-lathe")
    assert found == [
        *("T0303", "wait 0.5", "rapid X17.125 Z2.5 stop", "T0300", "rapid X10 stop"),
        *("T0403", "wait 0.5", "rapid X18.125 stop"),
    ]
    channel = prepare("T0303\nT0403\n", config=LATHE, dialect="fanuc-lathe")
    assert (channel.state.tool, channel.state.length_tool) == (4, 3)


def test_what_is_no_tool_of_a_turret_is_refused() -> None:
    assert refusal("T1\n", config=LATHE, dialect="fanuc-lathe") == "1:1: T1 names no tool"
    assert "tool and its offset" in refusal("T10101\n", config=LATHE, dialect="fanuc-lathe")


def test_a_turret_counts_as_a_change_of_tool() -> None:
    program = "(ROUGH)\nT0101\nG97 S1000 M3\nG0 X20. Z2.\nG1 Z-5. F0.1\n(FINISH)\nT0202\nG1 Z-9.\nM30\n"
    result = polycnc.run(program, "lathe2", "fanuc-lathe")
    assert [(each.name, each.tool) for each in result.operations] == [("ROUGH", 1), ("FINISH", 2)]
    assert polycnc.run(f"O0001\n{program}").machine == "lathe2"  # its dialect is guessed to be one of lathes
    assert polycnc.run(f"O0001\n{program}", "mill3").machine == "mill3"
    assert polycnc.run("G1 X9 F900\nM30\n").machine == "mill3"
    assert polycnc.check(program, "lathe2", "fanuc-lathe", strict=True) == []
    assert polycnc.check("G28 V0.\n", "mill3", "fanuc-lathe") == []
    assert polycnc.check("G28 V0.\n", dialect="fanuc-lathe") != []
    bare = "G97 S1000 M3\nG1 X5. F0.1\nM30\n"
    assert [error.code for error in polycnc.check(bare, "lathe2", "fanuc-lathe", strict=True)] == ["no_tool"]


# --- tables


def table(program: str) -> dict[str, float]:
    channel = prepare(f"G10 {program}\n", config=LATHE, dialect="fanuc-lathe")
    assert channel.error is None, channel.error
    tool = channel.state.tables.tool(3)
    return {name: getattr(tool, name) for name in (*REST, *BEFORE)}


BEFORE = {"radius_mm": 0.8, "tip": 3, "x_mm": 7.0, "z_mm": -2.5, "wear_x_mm": 0.125}
REST = dict.fromkeys(("length_mm", "wear_length_mm", "wear_radius_mm", "wear_z_mm"), 0.0)


@pytest.mark.parametrize(
    ("program", "changes"),
    [
        ("P3 X0.5 Z-0.25", {"wear_x_mm": 0.25, "wear_z_mm": -0.25}),
        ("P3 U0.5 W-0.25 C-0.125", {"wear_x_mm": 0.375, "wear_z_mm": -0.25, "wear_radius_mm": -0.125}),
        ("P10003 X-30. Z12.5 R0.4 Q2", {"x_mm": -15.0, "z_mm": 12.5, "radius_mm": 0.4, "tip": 2}),
        ("P10003 U-30. W1.5 C0.4", {"x_mm": -8.0, "z_mm": -1.0, "radius_mm": 1.2}),
        ("G20 P10003 X2. C0.01", {"x_mm": 25.4, "radius_mm": 1.054}),
    ],
)
def test_g10_sets_wear_and_geometry_of_turning_tools(program: str, changes: dict[str, float]) -> None:
    assert table(program) == pytest.approx({**REST, **BEFORE, **changes})


def test_an_offset_counts_from_the_next_t_on() -> None:
    program = "T0303\nG0 X20. Z5.\nG10 P10003 X4. W-1.\nX22.\nT0303\nX24. Z5.\n"
    found = moves(program, config=LATHE, dialect="fanuc-lathe")
    assert [each for each in found if each.startswith("rapid")] == [
        *("rapid X17.125 Z2.5 stop", "rapid X18.125 stop", "rapid X14.125 Z1.5 stop"),
    ]


def test_g10_shifts_the_work_coordinates() -> None:
    """P0 and L2 P0 count with every work offset, X a diameter; L2 P2 is G55; ways add."""
    program = "G10 P0 X10. Z-3.\nG0 X20. Z5.\nG10 P0 U4. W1.\nX20. Z5.\n"
    program += "G10 L2 P2 Z7.\nG10 L2 P2 W2. X1.\nG55 X20. Z5.\n"
    assert moves(program, config=LATHE, dialect="fanuc-lathe") == [
        *("rapid X15 Z2 stop", "rapid X17 Z3 stop", "rapid X17.5 Z12 stop")
    ]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("G10 X5.", "G10 without P"),
        ("G10 P3", "G10 P3 without a value"),
        ("G10 P0", "G10 without an axis"),
        ("G10 P3 X5. U2.", "U and X both change X"),
        ("G10 P3 R5. C2.", "R and C both change the radius"),
        ("G10 P10003 C-2.", "the radius is negative"),
        ("G10 P10003 Q10", "Q10 is not the place of a tip"),
        ("G10 P3 Y2.", "there is no axis 'Y' on machine 'test'"),
        ("G10 P5000 X1.", "there is no offset P5000"),
        ("G10 L10 P1 X1.", "G10 L10 is not supported yet"),
        ("G10 P3 X1. I5.", "'I' cannot be combined with G10"),
    ],
)
def test_g10_that_cannot_be(program: str, text: str) -> None:
    assert text in refusal(f"{program}\n", config=LATHE, dialect="fanuc-lathe")


# --- nose radius


def test_the_tip_stays_on_cylinders_and_faces_and_keeps_off_slopes() -> None:
    """Tip 3, nose 0.4: on a cylinder and a face the tip is on the contour.

    At a slope of 45 degrees it is 0.4 * (2 - sqrt 2) further along Z: there the nose touches beside the tip.
    """
    program = "T0404\nG0 X16. Z4.\nG42 G1 X20. Z2. F0.1\nZ-10.\nX30. Z-15.\nX40.\nG40 X44. Z-12.\n"
    found = moves(TURN + program, config=LATHE, dialect="fanuc-lathe")
    assert found[4:] == [
        "line X10 Z1.6 F100",  # the middle of the nose is beside the start
        "line Z-10.2343 F100",
        "line X14.7657 Z-15 F100",
        "line X19.6 F100",  # the middle of the nose is beside the end
        "line X22 Z-12 F100",
    ]


def test_a_boring_tool_has_its_tip_on_the_other_side() -> None:
    program = "T0505\nG0 X18. Z4.\nG41 G1 X20. Z2. F0.1\nZ-10.\nG40 X16. Z-10.\n"
    ends = [
        each for each in moves(TURN + program, config=LATHE, dialect="fanuc-lathe") if each.startswith("line")
    ]
    assert ends[0].startswith("line X10 Z")
    assert ends[1].startswith("line Z-10")


@pytest.mark.parametrize(
    ("tip", "expected"),
    [
        # The middle of the nose (0.5) keeps off the cylinder of radius 10; the tip is beside it.
        (0, "X10.5 Z-6"),
        (1, "X11 Z-5.5"),
        (2, "X11 Z-6.5"),
        (3, "X10 Z-6.5"),
        (4, "X10 Z-5.5"),
        (5, "X10.5 Z-5.5"),
        (6, "X11 Z-6"),
        (7, "X10.5 Z-6.5"),
        (8, "X10 Z-6"),
        (9, "X10.5 Z-6"),
    ],
)
def test_where_the_tip_is_by_its_number(tip: int, expected: str) -> None:
    lathe = machine_config(AXES, "[spindle]\nmax_rpm = 4000\n", f"[tools.5]\nradius_mm = 0.5\ntip = {tip}\n")
    program = "T0505\nG0 X16. Z4.\nG42 G1 X20. Z2. F0.1\nZ-6.\nZ-10.\nG40 X30.\n"
    found = moves(TURN + program, config=lathe, dialect="fanuc-lathe")
    x, z = expected.split()
    assert found[3].startswith(f"line {x} Z")
    assert found[4] == f"line {z} F100"


def test_a_tool_without_a_tip_is_programmed_by_its_middle() -> None:
    program = "T0606\nG0 X16. Z4.\nG42 G1 X20. Z2. F0.1\nZ-10.\nG40 X30.\n"
    ends = [
        each for each in moves(TURN + program, config=LATHE, dialect="fanuc-lathe") if each.startswith("line")
    ]
    assert ends[0].startswith("line X10.4 Z2")


# --- surface speed


@pytest.mark.parametrize(("clamp", "seconds"), [(0.0, None), (1500.0, None), (400.0, None)])
def test_facing_with_constant_surface_speed_takes_its_time_in_closed_form(
    clamp: float, seconds: None
) -> None:
    """dt = 2 pi r dr / (f v) where the spindle follows, dr / (f n) where it is at its clamp."""
    program = f"{f'G50 S{clamp:g}' if clamp else ''}\nG96 S150 M3\nG0 X80. Z0\nG1 X-1. F0.2\nM30\n"
    top = clamp or 4000.0
    follows = 150_000.0 / (2.0 * math.pi * top)  # radius where the clamp is reached
    above = max(40.0 - follows, 0.0)
    expected = math.pi * (40.0**2 - (40.0 - above) ** 2) / (0.2 * 150_000.0 / 60.0)
    expected += (40.5 - above) / (0.2 * top / 60.0)
    result = polycnc.run(program, LATHE, "fanuc-lathe")
    assert result.cutting_time_s == pytest.approx(expected, abs=0.006)


def test_the_clamp_is_no_speed_and_holds_for_surface_speed_only() -> None:
    assert moves("G50 S1200\nG97 S3000 M3\nG1 X10. F0.1\n", config=LATHE, dialect="fanuc-lathe") == [
        *("M3 S3000", "line X5 F300")
    ]
    assert refusal("G50\n", config=LATHE, dialect="fanuc-lathe") == "1:1: G50 without an axis"
    assert refusal("G50 S0\n", config=LATHE, dialect="fanuc-lathe").endswith("clamp is not above zero")
    din = "G18 G95 G92 S500\nG96 S150 M3\nG0 X2 Z5\nG1 Z0 F0.2\n"
    assert moves(din, config=LATHE)[-1] == "line Z0 F100"


# --- G code system B

_CUTS = "N1 G0 X40.\nG1 Z-9. F0.2\nX44. Z-12.\nN2 X52.\n"
_CUTS_B = _CUTS.replace("X44. Z-12.", "G91 X4. Z-3.").replace("N2", "N2 G90")


@pytest.mark.parametrize(
    ("a", "b"),
    [
        ("G1 X40. Z-3.5 F0.2\nU-5. W-1.5\nX30.", "G90 G1 X40. Z-3.5 F0.2\nG91 X-5. Z-1.5\nG90 X30."),
        ("G98 G1 X40. F150\nG99 Z-3. F0.2", "G94 G1 X40. F150\nG95 Z-3. F0.2"),
        ("G90 X45. Z-30. R-3.5 F0.25\nX40.\nU-15.", "G77 X45. Z-30. R-3.5 F0.25\nX40.\nG91 X-15."),
        ("G92 X27. Z-20. F2.\nX26.", "G78 X27. Z-20. F2.\nX26."),
        ("G94 X20. Z-1.5 F0.2\nZ-3.", "G79 X20. Z-1.5 F0.2\nG98 Z-3."),
        ("G32 Z-38. F1.5\nU6. W-40.", "G33 Z-38. F1.5\nG91 X6. Z-40."),
        ("G50 X60. Z5.\nG0 X50.", "G92 X60. Z5.\nG0 X50."),
        ("G50 S900\nG96 S300\nG1 X20. F0.2", "G92 S900\nG96 S300\nG1 X20. F0.2"),
        ("G28 U0 W-1.", "G91 G28 X0 Z-1."),
        (f"G71 U4. R0.5\nG71 P1 Q2 U1. W0.1 F0.3\n{_CUTS}G70 P1 Q2",) * 2,
        (
            f"G71 U4. R0.5\nG71 P1 Q2 U1. W0.1 F0.3\n{_CUTS}G70 P1 Q2",
            f"G71 U4. R0.5\nG71 P1 Q2 U1. W0.1 F0.3\n{_CUTS_B}G70 P1 Q2",
        ),
        ("G75 R0.2\nG75 X44. Z-2. P3000 Q2000 F0.1",) * 2,
        ("G76 P010060 Q100 R0.05\nG76 X27.4 Z-20. P1300 Q500 F2.",) * 2,
        ("G10 P3 X0.25 Z-1.\nT0303\nG0 X40. Z3.", "G10 P3 X0.25 Z-1.\nT0303\nG0 X40. Z3."),
        ("G10 P3 U0.25 W-1.\nT0303\nG0 X40. Z3.", "G91 G10 P3 X0.25 Z-1. R0\nG90 T0303\nG0 X40. Z3."),
        ("G10 L2 P1 X1. Z2.\nG10 L2 P1 U1.\nG0 X40.", "G10 L2 P1 X1. Z2.\nG91 G10 L2 P1 X1.\nG90 G0 X40."),
    ],
)
def test_system_b_says_the_same_by_other_codes(a: str, b: str) -> None:
    start = f"{TURN}G0 X50. Z2.\n"
    found = moves(f"{start}{b}\n", config=LATHE, dialect="fanuc-lathe-b")
    assert len(found) > 2
    assert found == moves(f"{start}{a}\n", config=LATHE, dialect="fanuc-lathe")


@pytest.mark.parametrize(
    ("block", "hint"),
    [
        ("G28 U0", "The dialect has ways by G91: write G91 and X, then G90."),
        ("G10 P3 W1.", "The dialect has ways by G91: write G91 and Z, then G90."),
        ("G1 B5. F1", "Its axes are X, Z; remove the word, or choose another machine."),
    ],
)
def test_system_b_has_no_addresses_of_ways(block: str, hint: str) -> None:
    (error,) = polycnc.check(f"G97 S500 M3\n{block}\n", LATHE, "fanuc-lathe-b")
    assert error.what.startswith("there is no axis '")
    assert error.hint == hint


# --- single cuts


def test_a_turning_cycle_and_its_next_diameters() -> None:
    box = ["rapid X{} stop", "line Z-30 F250", "line X25 F250 stop", "rapid Z2 stop"]
    found = turned("G90 X45. Z-30. F0.25\nX40.\nU-15.\nG0 X60.\n")
    assert found == [each.format(x) for x in (22.5, 20, 17.5) for each in box] + ["rapid X30 stop"]


def test_a_tapered_cut_begins_r_further_in() -> None:
    assert turned("G90 X45. Z-30. R-3.5 F0.25\n")[:2] == ["rapid X19 stop", "line X22.5 Z-30 F250"]


def test_a_facing_cycle_goes_along_x() -> None:
    assert turned("G94 X20. Z-1.5 F0.2\nZ-3.\n") == [
        *("rapid Z-1.5 stop", "line X10 F200", "line Z2 F200 stop", "rapid X25 stop"),
        *("rapid Z-3 stop", "line X10 F200", "line Z2 F200 stop", "rapid X25 stop"),
    ]


def test_a_block_without_a_position_repeats_no_cut() -> None:
    assert turned("G90 X45. Z-30. F0.25\nM8\nF0.3\n")[4:] == ["M8"]
    assert wrong("G90 X45. F0.25") == "a cutting cycle without X (U) or Z (W)"


# --- threads


def test_a_thread_goes_with_the_spindle() -> None:
    """Lead 1.5 at 1000 rpm: 1500 mm/min along the axis that goes further; a taper of 3 on 40 is a little longer."""
    slope = math.hypot(40.0, 3.0) / 40.0
    assert turned("G32 Z-38. F1.5\nU6. W-40.\nU60. W-3.\n") == [
        *("line Z-38 F1500", f"line X28 Z-78 F{_text(1500 * slope)}"),
        f"line X58 Z-81 F{_text(1500 * math.hypot(30, 3) / 30)}",
    ]


def test_the_lead_of_a_thread_grows_with_every_turn() -> None:
    """F2 and K0.5: after 1, 2 and 3 turns 2.25, 5 and 8.25; the fourth turn is broken off at 10.

    There 2 n + n^2 / 4 is 10: n = sqrt(56) - 4 = 3.4833; the mean lead of that part is 1.75 / 0.4833.
    """
    part = math.sqrt(56.0) - 7.0
    assert turned("G34 W-10. F2. K0.5\n") == [
        *("line Z-0.25 F2250", "line Z-3 F2750", "line Z-6.25 F3250"),
        f"line Z-8 F{_text(1750.0 / part)}",
    ]


def test_a_thread_of_changing_lead_takes_the_time_of_its_turns() -> None:
    """80 long from lead 4 with -0.0625: 4 n - n^2 / 32 = 80 gives 64 - sqrt(1536) turns; 600 rpm are 10 a second."""
    program = "G97 S600 M3\nG0 X30. Z0\nG34 Z-80. F4. K-0.0625\nM30\n"
    result = polycnc.run(program, LATHE, "fanuc-lathe")
    assert result.cutting_time_s == pytest.approx((64.0 - math.sqrt(1536.0)) / 10.0, abs=0.02)


def test_a_threading_cycle_leaves_along_45_degrees() -> None:
    """The last lead of 1.5 is the way out."""
    assert turned("G92 X47. Z-30. F1.5\nX46.5\n") == [
        *(
            "rapid X23.5 stop",
            "line Z-28.5 F1500",
            "line X25 Z-30 F2121.3203 stop",
            "rapid X25 stop",
            "rapid Z2 stop",
        )[:3],
        "rapid Z2 stop",
        *("rapid X23.25 stop", "line Z-28.5 F1500", "line X24.75 Z-30 F2121.3203 stop", "rapid X25 stop"),
        "rapid Z2 stop",
    ]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("M5\nG32 Z-5. F1.5", "a thread with the spindle at rest"),
        ("G96 S100\nG32 Z-5. F1.5", "a thread with constant surface speed (G96)"),
        ("G98 G32 Z-5. F1.5", "a thread without feed per revolution"),
        ("G32 Z-5.", "a thread without a lead"),
        ("G34 Z-5. F2.", "a thread of changing lead without K"),
        ("G34 Z-38. F2. K-0.0625", "the lead of the thread comes down to 0 before its end"),
        (
            "G34 Z-38. F2. K20.",
            "the thread needs 31025 mm/min of axis Z, which has 30000",
        ),
        ("G34 Z-38. F0.0001 K0", "a thread of 400000 turns"),
        ("S4000 G32 Z-5. F8.", "the thread needs 32000 mm/min of axis Z, which has 30000"),
    ],
)
def test_threads_that_cannot_be_cut(program: str, text: str) -> None:
    assert wrong(program) == text


THREAD = Threading(
    end=(30.32, 25.0),
    taper=0.0,
    height_mm=3.68,
    first_mm=1.8,
    least_mm=0.1,
    allowance_mm=0.2,
    finishing=1,
    angle_deg=60.0,
    chamfer_leads=1.0,
    lead_mm=6.0,
)


def test_the_passes_of_a_thread_cut_equal_areas() -> None:
    """The example of FANUC's manuals: 3.68 high, 1.8 first: 1.8 sqrt(n), down to the allowance, then the whole."""
    assert thread_depths(THREAD) == pytest.approx([1.8, 2.5456, 3.1177, 3.48, 3.68], abs=1e-4)


def test_a_thread_in_many_passes() -> None:
    """M30 x 2 from X30: 1.3 high, 0.5 first, 0.2 least, 0.05 left, twice finished, in along 30 degrees.

    0.5 sqrt 2 is 0.7071; from there on 0.5 sqrt n is less than 0.2 more, so 0.2 are added.
    """
    found = turned("G76 P020060 Q200 R0.05\nG76 X27.4 Z-20. P1300 Q500 F2.\n", "G0 X30. Z5.\n")
    second = 0.5 * math.sqrt(2.0)
    depths = [0.5, second, second + 0.2, second + 0.4, 1.25, 1.3, 1.3]
    expected = []
    for depth in depths:
        z = 5.0 - depth * math.tan(math.radians(30.0))
        expected += [f"rapid Z{_text(z)} stop", f"rapid X{_text(15.0 - depth)} stop"]
        expected += ["line Z-20 F2000 stop", "rapid X15 stop", "rapid Z5 stop"]
    assert found == expected


def _text(value: float) -> str:
    return f"{value:.4f}".rstrip("0").rstrip(".")


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("G76 P020061 Q100 R0.05", "P020061 is none of finishing passes, chamfer and angle"),
        ("G76 P000060 Q100 R0.05", "P000060 is none of finishing passes, chamfer and angle"),
        ("G76 X27.4 Z-20. Q500 F2.", "G76: height or first depth of the thread is not above zero"),
        (
            "G76 P010060 Q100 R2.\nG76 X27.4 Z-20. P1300 Q500 F2.",
            "G76: the allowance is no part of the thread's height",
        ),
        ("G76 X27.4 Z2. P1300 Q500 F2.", "G76: the thread has no length, or lies where the tool is"),
    ],
)
def test_threads_in_many_passes_that_cannot_be(program: str, text: str) -> None:
    assert wrong(program) == text


# --- grooves and holes


def test_pecking_a_face_in_several_places() -> None:
    """From X50 Z2 to X42 in steps of 3 (radius), Z-9 in pecks of 4, back by 1."""
    pecks = [
        "line Z-2 F100 stop",
        "rapid Z-1 stop",
        "line Z-6 F100 stop",
        "rapid Z-5 stop",
        "line Z-9 F100 stop",
    ]
    assert turned("G74 R1.\nG74 X42. Z-9. P3000 Q4000 F0.1\n") == [
        *(*pecks, "rapid Z2 stop", "rapid X22 stop", *pecks, "rapid Z2 stop"),
        *("rapid X21 stop", *pecks, "rapid Z2 stop", "rapid X25 stop"),
    ]


@pytest.mark.parametrize("end", ["Z2.", "Z2.0000000001"])
def test_pecking_without_depth_goes_across_only(end: str) -> None:
    found = turned(f"G74 X44. {end} P3000 R0.25 F0.1\n")
    assert [each for each in found if "Z" in each] == []
    assert found == turned(f"G74 X44. {end} P3000 F0.1\n")


def test_grooving_with_relief() -> None:
    """From X50 Z2 to X44: one peck of 3; along Z by 2 to -2, relief 0.25 against the way."""
    assert turned("G75 R0.5\nG75 X44. Z-2. P3000 Q2000 R0.25 F0.1\n") == [
        *("line X22 F100 stop", "rapid X25 stop"),
        *("rapid Z0 stop", "line X22 F100 stop", "rapid Z0.25 stop", "rapid X25 stop"),
        *("rapid Z-2 stop", "line X22 F100 stop", "rapid Z-1.75 stop", "rapid X25 stop", "rapid Z2 stop"),
    ]


def test_grooves_without_a_step_are_refused() -> None:
    assert wrong("G75 X44. Z-2. P3000 F0.1") == "G75: several grooves without the step between them"


# --- contours

CONTOUR = "N10 G0 X20.\nG1 Z-10. F0.1\nX30. Z-20.\nN20 X50.\n"


def test_roughing_along_z_pass_by_pass() -> None:
    """From X50 Z2, depth 4, escape 1, 0.5 left in X (radius) and 0.1 in Z: levels 21.5, 17.5, 13.5, then the contour.

    Its slope from (10.5, -9.9) to (15.5, -19.9) is at 13.5 where Z is -15.9.
    """
    found = turned(f"G71 U4. R1.\nG71 P10 Q20 U1. W0.1 F0.3\n{CONTOUR}G0 X60.\n")
    assert found == [
        "rapid X25.5 Z2.1 stop",
        *("rapid X21.5 stop", "line Z-19.9 F300 stop", "rapid X22.5 Z-18.9 stop", "rapid Z2.1 stop"),
        *("rapid X17.5 stop", "line Z-19.9 F300 stop", "rapid X18.5 Z-18.9 stop", "rapid Z2.1 stop"),
        *("rapid X13.5 stop", "line Z-15.9 F300 stop", "rapid X14.5 Z-14.9 stop", "rapid Z2.1 stop"),
        *("rapid X10.5 stop", "line Z-9.9 F300", "line X15.5 Z-19.9 F300", "line X25.5 F300 stop"),
        *("rapid X25 stop", "rapid Z2 stop"),
        "rapid X30 stop",  # after the contour, which is not executed again
    ]


def test_finishing_follows_the_contour_with_its_own_feed() -> None:
    found = turned(f"G71 U4. R1.\nG71 P10 Q20 U1. W0.1 F0.3\n{CONTOUR}G70 P10 Q20\nG0 X60.\n")
    assert found[-6:] == [
        *("rapid X10 stop", "line Z-10 F100", "line X15 Z-20 F100", "line X25 F100 stop"),
        *("rapid Z2 stop", "rapid X30 stop"),
    ]


def test_a_bore_is_roughed_outwards() -> None:
    """From X10 Z2, allowance negative: levels 9, 13; the contour ends at X10."""
    contour = "N1 G0 X36.\nG1 Z-10. F0.1\nX20. Z-20.\nN2 X10.\n"
    found = turned(f"G71 U4. R1.\nG71 P1 Q2 U-1. W0.1 F0.3\n{contour}", "G0 X10. Z2.\n")
    levels = [each for each in found if each.startswith("rapid X") and "Z" not in each]
    assert levels == [
        *("rapid X8.5 stop", "rapid X12.5 stop", "rapid X16.5 stop", "rapid X17.5 stop"),
        "rapid X5 stop",
    ]
    assert found[2] == "line Z-19.9 F300 stop"


def test_roughing_stops_at_an_arc() -> None:
    """A quarter of radius 8 about (20, -10), from (12, -10) to (20, -18): at X 16 it is at -10 - sqrt(64 - 16)."""
    contour = "N1 G0 X24.\nG1 Z-10. F0.1\nG2 X40. Z-18. R8.\nN2 G1 X50.\n"
    found = turned(f"G71 U9. R1.\nG71 P1 Q2 U0 W0 F0.3\n{contour}")
    assert found[:2] == ["rapid X16 stop", f"line Z{_text(-10 - math.sqrt(48))} F300 stop"]
    assert "arc X20 Z-18 about Z-10 X20 by -90 F300" in found


@pytest.mark.parametrize("both", ["", " Z2."])
def test_a_rapid_back_at_the_end_of_a_contour_is_not_roughed(both: str) -> None:
    contour = "N1 G0 X40. {}\nG1 Z-4. F0.1\nX50. Z-18.{}\n{}G0 X60.\n"
    head = "G71 U4. R1.\nG71 P1 Q2 U0 W0 F0.3\n"
    plain = turned(head + contour.format(both, "\nN2 G40", ""))
    assert turned(head + contour.format(both, "", "N2 G0 G40 Z2.\n")) == plain
    assert wrong(head + contour.format(both, "", "N2 G1 Z2.\n")).startswith("G71: the contour comes back")


def test_roughing_a_contour_that_begins_with_a_face() -> None:
    """The face from radius 8 to 12 lies at the start's Z: down to it, from 25, in cuts of 4: 21, 17, 13, 9."""
    contour = "N1 G0 X16.\nG1 X24. F0.1\nZ-10.\nN2 X50.\n"
    found = turned(f"G71 U4. R1.\nG71 P1 Q2 U0 W0 F0.3\n{contour}")
    assert found[:8] == [
        *("rapid X21 stop", "line Z-10 F300 stop", "rapid X22 Z-9 stop", "rapid Z2 stop"),
        *("rapid X17 stop", "line Z-10 F300 stop", "rapid X18 Z-9 stop", "rapid Z2 stop"),
    ]


def test_roughing_along_x() -> None:
    """The same contour seen the other way: G72 cuts along X at Z levels of 2 - 3, 2 - 6, ..."""
    contour = "N1 G0 Z-10.\nG1 X30. F0.1\nX20. Z-5.\nN2 Z2.\n"
    found = turned(f"G72 W5. R1.\nG72 P1 Q2 U0 W0 F0.3\n{contour}")
    assert found == [
        *("rapid Z-3 stop", "line X10 F300 stop", "rapid X11 Z-2 stop", "rapid X25 stop"),
        *("rapid Z-8 stop", "line X13 F300 stop", "rapid X14 Z-7 stop", "rapid X25 stop"),
        *("rapid Z-10 stop", "line X15 F300", "line X10 Z-5 F300", "line Z2 F300 stop", "rapid X25 stop"),
    ]


def test_a_pocket_is_cut_where_the_first_block_names_both_axes() -> None:
    """From X50 Z2 at levels 21, 17: in along a slope of 45 degrees, along, out along the other, away by 1.

    The pocket is 8 deep from X40: from (20, -4) by (16, -8) and (16, -14) to (20, -18): at 17 it is -7 and -15.
    """
    contour = "N1 G0 X40. W0\nG1 Z-4. F0.1\nX32. Z-8.\nZ-14.\nX40. Z-18.\nN2 X50. W0\n"
    found = turned(f"G71 U4. R1.\nG71 P1 Q2 U0 W0 F0.3\n{contour}")
    assert found == [
        *("rapid X21 stop", "line Z-18 F300", "line X25 F300 stop", "rapid X26 Z-17 stop"),
        *("rapid Z-4 stop", "rapid X22 stop", "line X20 F300", "line X17 Z-7 F300", "line Z-15 F300"),
        *("line X20 Z-18 F300", "line X21 F300 stop", "rapid X22 Z-17 stop"),
        *("rapid X25 stop", "rapid Z2 stop", "rapid X20 stop", "line Z-4 F300", "line X16 Z-8 F300"),
        *("line Z-14 F300", "line X20 Z-18 F300", "line X25 F300 stop", "rapid Z2 stop"),
    ]


def test_a_pocket_in_a_face_is_cut_along_x() -> None:
    """The same seen the other way: from X50 Z2 at Z -2 and -6, where the groove lies between X30 and X20."""
    contour = "N1 G0 Z-3. U0\nG1 X40. F0.1\nX30. Z-7.\nX20.\nX10. Z-3.\nN2 Z2. U0\n"
    found = turned(f"G72 W4. R1.\nG72 P1 Q2 U0 W0 F0.3\n{contour}")
    assert found[:4] == ["rapid Z-2 stop", "line X5 F300", "line Z2 F300 stop", "rapid X6 Z3 stop"]
    assert found[4:8] == ["rapid X20 stop", "rapid Z-1 stop", "line Z-3 F300", "line X16.25 Z-6 F300"]
    assert found[8] == "line X8.75 F300"


def test_one_axis_or_two_in_the_first_block_decide_between_the_types() -> None:
    head = "G71 U4. R1.\nG71 P1 Q2 U0 W0 F0.3\n"
    contour = "N1 G0 {}\nG1 Z-4. F0.1\nX32. Z-8.\nX50. Z-18.\nN2 X52.\n"
    assert wrong(head + contour.format("X40.")).startswith("G71: the contour turns back, and its first block")
    for both in ("X40. Z2.", "U-10. W0", "X40. W0."):
        assert "line X17 Z-7 F300" in turned(head + contour.format(both))


def test_a_pattern_is_repeated_nearer_and_nearer() -> None:
    """Three passes, 6 out in X (radius) and 4 in Z, 0.5 and 0.1 left: 6.5/4.1, 3.5/2.1, 0.5/0.1."""
    found = turned(f"G73 U6. W4. R3\nG73 P10 Q20 U1. W0.1 F0.3\n{CONTOUR}")
    starts = [each for each in found if each.startswith("line Z")]
    assert starts == ["line Z-5.9 F300", "line Z-7.9 F300", "line Z-9.9 F300"]
    assert found[:3] == ["rapid X31.5 Z6.1 stop", "rapid X16.5 stop", "line Z-5.9 F300"]
    assert found[-2:] == ["rapid X25 stop", "rapid Z2 stop"]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        (f"G71 U4. R1.\nG71 P10 Q21 U1. F0.3\n{CONTOUR}", "there is no block N21 after N10"),
        (f"G71 U4. R1.\nG71 P9 Q20 U1. F0.3\n{CONTOUR}", "there is no block N9"),
        (f"G71 P10 Q20 U1. F0.3\n{CONTOUR}", "G71: the depth of a cut is not above zero"),
        (
            "G71 U4. R1.\nG71 P1 Q2 U1. F0.3\nN1 G0 X50.\nG1 X20. Z1.\nN2 X50. Z-9.",
            "G71: the first block of the contour moves the axis along which is roughed",
        ),
        (
            "G71 U4. R1.\nG71 P1 Q2 U1. F0.3\nN1 G0 X20.\nG1 Z-9.\nX15. Z-12.\nN2 X50.",
            "G71: the contour turns back, and its first block names one axis",
        ),
        (  # the arc begins and ends at 10 and 14 of X, with its top at 15 between
            "G71 U4. R1.\nG71 P1 Q2 U1. F0.3\nN1 G0 X20.\nG1 Z-9.\nG3 X28. Z-17. I0 K-5.\nN2 G1 X50.",
            "G71: the contour turns back, and its first block names one axis",
        ),
        (
            "G71 U4. R1.\nG71 P1 Q2 U1. F0.3\nN1 G0 X20.\nM98 P5\nN2 G1 X50. Z-3.\nO5\nM99",
            "a contour of G71 with a call, a cycle, a stop or an end",
        ),
        (
            "G71 U4. R1.\nG71 P1 Q2 U1. F0.3\nN1 G0 X20.\nG70 P1 Q2\nN2 G1 X50. Z-3.",
            "a contour of G71 with a call, a cycle, a stop or an end",
        ),
        ("G70", "G70 without a contour"),
        ("G70 P10", "G70 without Q"),
        (
            f"G42 G1 X49. F0.1\nG71 U4. R1.\nG71 P10 Q20 U1. F0.3\n{CONTOUR}",
            "a turning cycle while radius compensation is active",
        ),
    ],
)
def test_contours_that_cannot_be_cut(program: str, text: str) -> None:
    found = wrong(program)
    assert found == text


def test_a_contour_far_from_its_cycle_stays_a_part_of_the_program() -> None:
    """G70 cuts a contour that stands before it, and continues after itself."""
    program = f"{CONTOUR}G0 X50. Z2.\nG70 P10 Q20\nG0 X60.\n"
    found = turned(program)
    assert found.count("line Z-10 F100") == 2
    assert found[-1] == "rapid X30 stop"


def test_nothing_is_changed_by_a_contour_that_is_refused() -> None:
    program = f"{TURN}G0 X50. Z2.\nG71 U4. R1.\nG71 P10 Q99 U1. F0.3\n"
    channel = prepare(program, config=LATHE, dialect="fanuc-lathe")
    assert channel.error is not None
    assert channel.state.modal.position.tolist() == [25.0, 2.0]


def test_a_whole_part_runs_on_the_lathe_and_keeps_its_limits() -> None:
    program = (
        "%\nO0100\nG21 G40 G97 G99\nG28 U0 W0\nT0101\nG50 S3000\nG96 S180 M3\nG0 X62. Z2. M8\nG71 U2.5 R0.5\n"
        "G71 P100 Q200 U0.6 W0.1 F0.25\nN100 G0 X18.\nG1 Z0 F0.12\nX20. Z-1.\nZ-20.\nG2 X30. Z-25. R5.\nG1 Z-40.\n"
        "N200 X62.\nG0 X100. Z50.\nT0202\nG96 S220\nG0 X62. Z2.\nG70 P100 Q200\nG0 X100. Z50.\nT0303\nG97 S800\n"
        "G0 X24. Z4.\nG76 P010060 Q100 R0.05\nG76 X17.546 Z-16. P1227 Q400 F2.\nG0 X100. Z50. M9\nM5\nM30\n%\n"
    )
    machine = load_machine("lathe2")
    result = polycnc.run(program, machine, "fanuc-lathe", trace=True)
    assert result.ok
    assert polycnc.verify_trace(result.trace, machine) == []
    assert result.extents_mm["X"][1] == 50.0
    assert min(result.extents_mm["Z"]) == pytest.approx(-40.0)
    assert [each.text.split(" ")[0] for each in result.messages] == ["G28:", "the", "3"], result.messages


def test_the_lathe_dialect_refuses_what_it_does_not_know() -> None:
    dialect = load_dialect("fanuc-lathe")
    assert dialect.g_action(34) is not None
    for block in ("G83 Z-5. F0.1", "G36 X5.", "G12.1", "G84 Z-5. F1."):
        assert "is not supported yet" in refusal(f"{block}\n", config=LATHE, dialect="fanuc-lathe")


# --- corners between straight moves


def test_a_chamfer_and_a_rounding_between_straight_moves() -> None:
    """From (25, 2) along Z to -10 and out along X to 30: 3 mm chamfer, or radius 3 about (28, -7)."""
    assert turned("G1 Z-10. C3. F0.2\nX60.\nZ-20.\n") == [
        *("line Z-7 F200", "line X28 Z-10 F200", "line X30 F200", "line Z-20 F200")
    ]
    assert turned("G1 Z-10. R3. F0.2\nX60.\n") == [
        *("line Z-7 F200", "arc X28 Z-10 about Z-7 X28 by -90 F200", "line X30 F200")
    ]
    assert turned("G1 X60. R3. F0.2\nZ-10.\n") == [
        *("line X27 F200", "arc X30 Z-1 about Z-1 X27 by 90 F200", "line Z-10 F200")
    ]


def test_corners_follow_one_another() -> None:
    """Round to X30, chamfer of 2 to Z-20, and a remark between changes nothing."""
    assert turned("G1 Z-10. R3. F0.2\nX60. C2.\n(A REMARK)\nN5\nZ-20.\n") == [
        "line Z-7 F200",
        "arc X28 Z-10 about Z-7 X28 by -90 F200",
        "line X30 Z-12 F200",
        "line Z-20 F200",
    ]


def test_a_rounding_of_a_slope_touches_both_moves() -> None:
    """A corner of 135 degrees and radius 4: it begins 4 tan 22.5 degrees before."""
    found = turned("G1 Z-10. R4. F0.2\nX70. Z-20.\n")
    reach = 4.0 * math.tan(math.radians(22.5))
    assert found[0] == f"line Z{_text(-10 + reach)} F200"
    assert found[1] == (
        f"arc X{_text(25 + reach / math.sqrt(2))} Z{_text(-10 - reach / math.sqrt(2))} "
        f"about Z{_text(-10 + reach)} X29 by -45 F200"
    )
    assert found[2] == "line X35 Z-20 F200"


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("G1 Z-10. R3. F0.2\nG0 X60.", "R3 of the block before needs a straight move at feed after it"),
        ("G1 Z-10. C3. F0.2\nM8\nX60.", "C3 of the block before needs a straight move at feed after it"),
        ("G1 Z-10. C3. F0.2\nX60. M8", "C3 of the block before needs a straight move at feed after it"),
        (
            "G1 Z-10. R3. F0.2\nG2 X60. Z-15. R5.",
            "R3 of the block before needs a straight move at feed after it",
        ),
        ("G1 Z-10. R3. F0.2\nM30", "R3 of the block before needs a straight move at feed after it"),
        ("G1 Z-10. R3. F0.2", "R3 at the end of the program"),
        ("G1 Z-10. R3. C2. F0.2\nX60.", "R and C in one block"),
        ("G1 Z-10. R6. F0.2\nX60.", "R6 needs 6 mm of both moves, and one has 5 mm"),
        ("G1 Z-10. C13. F0.2\nX90.", "C13 needs 13 mm of both moves, and one has 12 mm"),
        ("G1 Z-10. R3. F0.2\nZ-5.", "R3 where the path turns back"),
        ("G0 Z-10. R3.", "'R' has no meaning in this block"),
    ],
)
def test_corners_that_cannot_be(program: str, text: str) -> None:
    assert wrong(program) == text


def test_a_contour_may_have_corners() -> None:
    contour = "N10 G0 X20.\nG1 Z-10. R2. F0.1\nX30. C1.\nZ-20.\nN20 X50.\n"
    found = turned(f"G71 U4. R1.\nG71 P10 Q20 U0 W0 F0.3\n{contour}G70 P10 Q20\n")
    assert "arc X12 Z-10 about Z-8 X12 by -90 F300" in found
    assert "arc X12 Z-10 about Z-8 X12 by -90 F100" in found
    assert found.count("line X15 Z-11 F100") == 1
    assert "R2 at the end" in wrong(
        f"G71 U4. R1.\nG71 P10 Q20 F0.3\n{CONTOUR.replace('N20 X50.', 'N20 X50. R2.')}"
    )
