"""What G10, G52, G54.1, G68, G51, G51.1, G16 and G31 mean, against figures made by hand."""

from __future__ import annotations

import math

import pytest

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine, load_machine
from polycnc.nc import Channel, ChannelOptions, ProgramText, language_for, load_dialect
from support.programs import moves

ROOT = math.sqrt(3.0)


def run(text: str) -> ProgramRun:
    """Run a program of the fanuc dialect to its end."""
    dialect = load_dialect("fanuc")
    made = ProgramRun(
        Machine(load_machine(None)),
        ProgramText.from_text("G90 G21 F2000\n" + text + "\nM30\n", "frames.tap"),
        dialect,
        options=RunOptions(stands_at_stops=False),
        language=language_for(dialect),
    )
    made.start()
    while made.active:
        made.advance(1_000_000)
    return made


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # Rotation by 30 degrees about (10, 20): 20 mm to the right of the centre.
        ("G68 X10 Y20 R30\nG0 X30 Y20", (10 + 10 * ROOT, 30, 0)),
        ("G68 X10 Y20 R30\nG0 X30 Y20\nG91 X4\nG69", (10 + 12 * ROOT, 32, 0)),
        ("G68 X10 Y20 R30\nG0 X30 Y20\nG69 X1.5 Y2.5", (1.5, 2.5, 0)),
        ("G0 X7 Y3\nG91 G68 R90\nG0 X5", (7, 8, 0)),
        ("G68 X0 Y0 R90\nG0 X10 Y0\nG3 X6 Y4 I-4 J0\nG69", (-4, 6, 0)),
        ("G18 G68 X2 Z1 R90\nG0 X2 Z8", (9, 0, 1)),
        # Without a coordinate the centre is where the tool stands in it.
        ("G0 X4 Z9\nG18 G68 X1 R90\nG0 X1 Z11", (3, 0, 9)),
        ("G0 X4 Z9\nG18 G68 Z2.5 R90\nG0 X6 Z2.5", (4, 0, 0.5)),
        # Scaling: without a point a factor counts thousandths.
        ("G51 X10 Y20 P1500\nG1 X30 Y40", (40, 50, 0)),
        ("G51 X10 Y20 I500 J2.5 K1000\nG1 X30 Y40 Z7\nG50\nG91 X1", (21, 70, 7)),
        ("G51 X0 Y0 Z0 P0.5\nG1 X8\nG91 G2 X6 Y6 R6", (7, 3, 0)),
        # A mirror turns arcs over.
        ("G51.1 X15\nG1 X40 Y3\nG2 X50 Y13 I0 J10\nG50.1 X0", (-20, 13, 0)),
        ("G51.1 X15 Y4\nG1 X40 Y3\nG50.1 Y0\nG1 X41 Y9", (-11, 9, 0)),
        # Mirror first, then scale, then turn: x 4 -> -4 -> -8, turned by 90 degrees.
        ("G51.1 X0\nG51 X0 Y0 Z0 P2000\nG68 X0 Y0 R90\nG1 X4 Y1", (-2, -8, 0)),
        # Polar coordinates: radius and angle, each absolute or incremental.
        ("G16\nG1 X50 Y30\nG91 Y60\nG15", (0, 50, 0)),
        ("G16\nG1 X50 Y30\nG90 Y150", (-25 * ROOT, 25, 0)),
        ("G1 X3 Y4\nG16\nG91 X10 Y0", (3 + 10 * 0.6, 4 + 10 * 0.8, 0)),
        ("G16 G81 X50 Y30 Z-5 R2\nY150\nG15 G80", (-25 * ROOT, 25, 2)),
        # Coordinate systems.
        ("G52 X11 Y22\nG0 X1.5 Y2", (12.5, 24, 0)),
        ("G52 X11 Y22\nG52 X0 Y0\nG0 X1.5 Y2", (1.5, 2, 0)),
        ("G10 L2 P1 X7 Y8 Z0\nG0 X1.5 Y2", (8.5, 10, 0)),
        ("G10 L2 P3 X7 Y8\nG0 X1.5 Y2\nG56 X1.5", (8.5, 2, 0)),
        ("G10 L2 P6 X7 Y8\nG59 G0 X1.5 Y2", (8.5, 10, 0)),
        ("G10 L20 P13 X7 Y8 Z3\nG54.1 P13 G0 X1.5 Y2 Z1", (8.5, 10, 4)),
        ("G10 L2 P0 X100\nG0 X1.5\nG91 G10 L2 P0 X5\nG90 X1.5", (106.5, 0, 0)),
        ("G20\nG10 L2 P1 X1\nG21\nG0 X2", (27.4, 0, 0)),
        # Tool offsets: length and its wear.
        ("G10 L10 P3 R12.5\nG10 L11 P3 R-.5\nG43 H3 G0 Z1.5", (0, 0, 13.5)),
        ("G10 L10 P3 R12.5\nG91 G10 L10 P3 R2\nG90 G43 H3 G0 Z1.5", (0, 0, 16)),
        ("G10 L12 P4 R3\nG10 L13 P4 R.25\nG41 D4 G1 X10 Y0\nX20\nX30", (30, 3.25, 0)),
        # Without a signal a skip move goes to its end; the next block sees where that is.
        ("G31 X5.5 F100\nG0 X[#5061*2]", (11, 0, 0)),
        # Cancels that need nothing.
        ("G5.1 Q0\nG8 P0\nG67\nG15\nG50.1 X0\nG50\nG69\nG64\nG49\nG0 X3.5", (3.5, 0, 0)),
    ],
)
def test_positions(text: str, expected: tuple[float, float, float]) -> None:
    made = run(text)
    assert made.error is None, str(made.error)
    assert list(made.reading.position.values()) == pytest.approx(list(expected), abs=1e-9)


ARC = "G1 X20 Y10\nG2 X26 Y16 I6\n"  # from the left of its centre to above it


@pytest.mark.parametrize(
    ("frame", "expected"),
    [
        ("G51 X3 Y7 P500", ["line X11.5 Y8.5", "arc X14.5 Y11.5 about X14.5 Y8.5 by -90"]),
        ("G51 X3 Y7 P1500", ["line X28.5 Y11.5", "arc X37.5 Y20.5 about X37.5 Y11.5 by -90"]),
        ("G51.1 X15", ["line X10 Y10", "arc X4 Y16 about X4 Y10 by 90"]),
        ("G51.1 Y-2", ["line X20 Y-14", "arc X26 Y-20 about X26 Y-14 by 90"]),
        ("G51.1 X15 Y-2", ["line X10 Y-14", "arc X4 Y-20 about X4 Y-14 by -90"]),
        ("G51 X3 Y7 I-500 J500", ["line X-5.5 Y8.5", "arc X-8.5 Y11.5 about X-8.5 Y8.5 by 90"]),
        ("G68 X4 Y7 R90", ["line X1 Y23", "arc X-5 Y29 about X1 Y29 by -90"]),
    ],
)
def test_arcs_are_scaled_turned_and_turned_over(frame: str, expected: list[str]) -> None:
    found = moves(f"F500 {frame}\n{ARC}", dialect="fanuc")
    assert found == [f"{each} F500" for each in expected]


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("G43.4 H1\nG0 X1\nG43.4 H2", "G43.4 is not supported yet (2 blocks have it)"),
        ("G68.2 X1 Y2 Z3 I4 J5 K6", "G68.2 is not supported yet (1 block has it)"),
        ("G68 X1 Y2", "G68 without an angle"),
        ("G68 X1 Z2 R30", "axis Z is not in the plane that G68 turns"),
        ("G51 X1", "G51 without a factor"),
        ("G51 X1 P0", "the factor P0 is no scale"),
        ("G51 I2. J3.\nG2 X5 Y5 I5 J0", "an arc with a centre between axes of different scale"),
        ("G51.1", "G51.1 without an axis"),
        ("G10 P1 X1", "G10 without L"),
        ("G10 L2 P9 X1", "P9 is not a number of these data"),
        ("G10 L50 P1 R1", "G10 L50 is not supported yet"),
        ("G10 L2 P1 X5 Q7", "'Q' cannot be combined with G10"),
        ("G10 L12 P1 R-1", "the radius is negative"),
        ("G54.1 P0", "there is no G54.1 P0"),
        ("G68 X0 Y0 R30\nG92 X0", "G92 while positions are turned, scaled or mirrored"),
        ("G41 D1 G1 X10\nG52 X5", "G52 while radius compensation is active"),
        ("G51 Z0 P2000\nG81 X1 Z-5 R2", "G81 with a scaled or mirrored drilling axis is not supported yet"),
    ],
)
def test_what_cannot_be_done_is_said(text: str, what: str) -> None:
    error = run(text).error
    assert error is not None
    assert error.what == what
    assert error.hint


def test_a_refused_block_leaves_the_frame_as_it_was() -> None:
    dialect = load_dialect("fanuc")
    text = "F500\nG68 X0 Y0 R90\nG68 X0 Y0 R45 E5\nG10 L2 P1 X9 E5\nG1 X10 Y0\n"
    options = ChannelOptions(collect_errors=True)
    channel = Channel(ProgramText.from_text(text), dialect, Machine(load_machine(None)), options=options)
    channel.fill()
    assert len(channel.errors) == 2
    assert channel.state.modal.position.tolist() == pytest.approx([0.0, 10.0, 0.0], abs=1e-12)
