"""Words that share a block: what each of them does, and what none of them may do besides."""

from __future__ import annotations

import math

import pytest

from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ProgramText, load_dialect
from polycnc.units import MM_PER_INCH
from support.canonical import Feed, Step, Traverse, Turn, queued_steps

ROTARY = """
name = "four"
[[axis]]
name = "X"
vmax_mm_s = 500
amax_mm_s2 = 2000
[[axis]]
name = "Y"
vmax_mm_s = 500
amax_mm_s2 = 2000
[[axis]]
name = "Z"
vmax_mm_s = 500
amax_mm_s2 = 2000
[[axis]]
name = "A"
kind = "rotary"
vmax_deg_s = 90
amax_deg_s2 = 900
"""
CONFIG = validate(MachineConfig, *parse_toml(ROTARY, "four.toml"))


def moves(program: str) -> list[Step]:
    """Return what a program asks for, without its first and last block."""
    machine = Machine(CONFIG, segments=256)
    channel = Channel(ProgramText.from_text(program), load_dialect("din"), machine)
    give_to_path(machine.state, channel.path)
    channel.fill()
    assert channel.error is None, channel.error
    return [step for step in queued_steps(machine, channel) if isinstance(step, Traverse | Feed | Turn)]


@pytest.mark.parametrize("state", ["G91", "G93", "G80", "G2 G91", "G99 G81 X1 Z-5 R1"])
def test_setting_a_position_does_not_move(state: str) -> None:
    before = moves(f"G1 X5 F100\n{state}\nM30\n")
    assert moves(f"G1 X5 F100\n{state}\nG92 X20\nM30\n") == before


def test_a_motion_word_beside_a_reference_return_stays_in_force() -> None:
    steps = moves("G1 X5 F100\nG0 G28 Z3\nX9\nM30\n")
    assert steps[-1] == Traverse((9.0, 0.0, 0.0, 0.0))


def test_the_usual_first_block_names_a_motion_and_cancels_cycles() -> None:
    assert moves("G0 G17 G40 G49 G80 G90\nX5\nM30\n") == [Traverse((5.0, 0.0, 0.0, 0.0))]


def test_a_cycle_ends_where_a_motion_stands_beside_g80() -> None:
    steps = moves("G0 Z10\nG81 X1 Z-5 R1 F100\nG80 G0 X9\nM30\n")
    assert steps[-1] == Traverse((9.0, 0.0, 10.0, 0.0))


@pytest.mark.parametrize("spelling", ["G2 I1", "G2 I1 P1", "G90.1 G2 I1 J0"])
def test_a_full_circle_in_inch_keeps_its_feed(spelling: str) -> None:
    (circle,) = moves(f"G20 F10\n{spelling}\nM30\n")
    assert isinstance(circle, Turn)
    assert circle.speed == pytest.approx(10.0 * MM_PER_INCH)
    assert circle.sweep == pytest.approx(-2.0 * math.pi)


def test_an_arc_by_radius_makes_whole_turns_too() -> None:
    (arc,) = moves("F100\nG3 X10 R5 P3\nM30\n")
    assert isinstance(arc, Turn)
    assert arc.sweep == pytest.approx(5.0 * math.pi)
    assert arc.end[:2] == (10.0, 0.0)


def test_a_feed_per_revolution_of_a_rotary_axis_is_in_degrees_in_inch_too() -> None:
    (turn,) = moves("G20 M3 S100\nG95 F2\nG1 A90\nM30\n")
    assert isinstance(turn, Feed)
    assert turn.speed == pytest.approx(200.0)
