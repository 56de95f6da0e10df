"""Drilling cycles: their sequences step by step, what they refuse, and the same holes drilled by rs274."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.nc.blocks._cycles import (
    CYCLES,
    CycleError,
    CyclePlace,
    CycleStep,
    CycleWords,
    StepKind,
    expand_cycle,
)
from polycnc.nc.dialect._cycle_settings import Cycles
from support.rs274 import COMMAND, call

PLACE = CyclePlace(hole_mm=(5.0, 7.0), initial_mm=10.0, level_mm=10.0)
R_PLACE = CyclePlace(hole_mm=(5.0, 7.0), initial_mm=10.0, level_mm=10.0, retract="r")
WORDS = CycleWords(depth_mm=-3.0, retract_mm=2.0)
FULL = CycleWords(depth_mm=-3.0, retract_mm=2.0, peck_mm=2.0, dwell_s=0.5, shift_mm=(1.0, 0.5), back_mm=-1.0)
# The amount LinuxCNC backs up by, 0.010 inch.
TEN_THOU = Cycles(chip_break_mm=0.254, reentry_mm=0.254)


def text(step: CycleStep) -> str:
    match step.kind:
        case StepKind.RAPID_PLANE:
            return f"xy {step.first_mm:g} {step.second_mm:g}"
        case StepKind.RAPID_AXIS:
            return f"rapid {step.level_mm:g}"
        case StepKind.FEED_AXIS:
            return f"feed {step.level_mm:g}"
        case StepKind.DWELL:
            return f"dwell {step.duration_s:g}"
        case _:
            return step.kind.name.lower().replace("spindle_", "").replace("_", " ")


def steps(action: str, words: CycleWords = FULL, place: CyclePlace = PLACE) -> list[str]:
    if action == "cycle_tap_left":
        place = replace(place, spindle="reverse")
    return [text(step) for step in expand_cycle(action, words, place)]


SEQUENCES = {
    "cycle_drill": "feed -3, rapid 10",
    "cycle_dwell": "feed -3, dwell 0.5, rapid 10",
    "cycle_deep": "feed 0, rapid 2, rapid 1, feed -2, rapid 2, rapid -1, feed -3, rapid 10",
    "cycle_chip_break": "feed 0, rapid 1, feed -2, rapid -1, feed -3, rapid 10",
    "cycle_tap": (
        "override off, feed -3, stop, reverse, dwell 0.5, feed 2, stop, start, override on, rapid 10"
    ),
    "cycle_bore": "feed -3, feed 2, rapid 10",
    "cycle_bore_stop": "feed -3, dwell 0.5, stop, rapid 10, start",
    "cycle_back_bore": (
        "xy 6 7.5, stop, orient, rapid -3, xy 5 7, start, feed -1, feed -3, "
        "stop, orient, xy 6 7.5, rapid 10, xy 5 7, start"
    ),
    "cycle_bore_manual": "feed -3, dwell 0.5, stop, program stop, rapid 10, start",
    "cycle_bore_dwell": "feed -3, dwell 0.5, feed 2, rapid 10",
    "cycle_tap_left": (
        "override off, feed -3, stop, reverse, dwell 0.5, feed 2, stop, start, override on, rapid 10"
    ),
    "cycle_fine_bore": "feed -3, dwell 0.5, stop, orient, xy 6 7.5, rapid 10, xy 5 7, start",
}


@pytest.mark.parametrize("action", SEQUENCES)
def test_sequence_with_retract_to_the_initial_level(action: str) -> None:
    assert steps(action) == ["xy 5 7", "rapid 2", *SEQUENCES[action].split(", ")]


@pytest.mark.parametrize("action", SEQUENCES)
def test_sequence_with_retract_to_r(action: str) -> None:
    expected = SEQUENCES[action].replace("rapid 10", "rapid 2").split(", ")
    if action in ("cycle_tap", "cycle_tap_left", "cycle_bore", "cycle_bore_dwell"):
        expected = expected[:-1]  # the feed out already ended at R
    assert steps(action, place=R_PLACE) == ["xy 5 7", "rapid 2", *expected]


def test_every_cycle_has_a_code() -> None:
    assert CYCLES.keys() == {*SEQUENCES, "cycle_back_bore_up"}
    codes = (73, 74, 76, 81, 82, 83, 84, 85, 86, 87, 87, 88, 89)
    assert sorted(CYCLES.values()) == [f"G{n}" for n in codes]


@pytest.mark.parametrize("action", ["cycle_dwell", "cycle_bore_stop", "cycle_bore_dwell", "cycle_tap"])
def test_no_dwell_word_no_dwell(action: str) -> None:
    assert not any(step.startswith("dwell") for step in steps(action, WORDS))


# --- levels -----------------------------------------------------------------------------------------------


def test_start_below_r_rises_first() -> None:
    place = CyclePlace((5.0, 7.0), initial_mm=1.0, level_mm=1.0)
    assert steps("cycle_drill", WORDS, place) == ["rapid 2", "xy 5 7", "feed -3", "rapid 2"]


def test_start_at_r_does_not_move_along_the_axis() -> None:
    place = CyclePlace((5.0, 7.0), initial_mm=10.0, level_mm=2.0, retract="r")
    assert steps("cycle_drill", WORDS, place) == ["xy 5 7", "feed -3", "rapid 2"]


def test_r_at_the_depth_drills_nothing() -> None:
    assert steps("cycle_drill", CycleWords(-3.0, -3.0)) == ["xy 5 7", "rapid -3", "rapid 10"]
    assert steps("cycle_deep", CycleWords(-3.0, -3.0, 1.0)) == ["xy 5 7", "rapid -3", "rapid 10"]


def test_incremental_levels() -> None:
    words = CycleWords(depth_mm=-5.0, retract_mm=-8.0, back_mm=2.0).absolute(10.0)
    assert (words.retract_mm, words.depth_mm, words.back_mm) == (2.0, -3.0, -1.0)
    assert CycleWords(depth_mm=-5.0).absolute(10.0).depth_mm == -5.0


def test_words_stay_until_programmed_again_but_repeats_do_not() -> None:
    stored = CycleWords(depth_mm=-3.0, retract_mm=2.0, peck_mm=1.0, repeats=4)
    later = stored.then(CycleWords(depth_mm=-5.0, dwell_s=0.2))
    assert later == CycleWords(depth_mm=-5.0, retract_mm=2.0, peck_mm=1.0, dwell_s=0.2, repeats=1)


# --- pecks ------------------------------------------------------------------------------------------------


def test_pecks_that_add_up_to_the_depth_end_there_once() -> None:
    words = CycleWords(depth_mm=-0.3, retract_mm=0.0, peck_mm=0.1)
    feeds = [step for step in steps("cycle_chip_break", words) if step.startswith("feed")]
    assert feeds == ["feed -0.1", "feed -0.2", "feed -0.3"]


def test_a_peck_deeper_than_the_hole_is_one_feed() -> None:
    words = CycleWords(depth_mm=-3.0, retract_mm=2.0, peck_mm=50.0)
    assert steps("cycle_deep", words) == ["xy 5 7", "rapid 2", "feed -3", "rapid 10"]


def test_backing_up_ends_at_r() -> None:
    words = CycleWords(depth_mm=-1.0, retract_mm=2.0, peck_mm=2.0)
    wide = Cycles(chip_break_mm=9.0, reentry_mm=9.0)
    broken = [text(step) for step in expand_cycle("cycle_chip_break", words, R_PLACE, wide)]
    assert broken == ["xy 5 7", "rapid 2", "feed 0", "rapid 2", "feed -1", "rapid 2"]
    assert [text(step) for step in expand_cycle("cycle_deep", words, R_PLACE, wide)] == broken


# --- tapping ----------------------------------------------------------------------------------------------


def test_tapping_feed_is_pitch_times_speed() -> None:
    place = CyclePlace((0.0, 0.0), 10.0, 10.0, spindle_rpm=600.0)
    words = CycleWords(depth_mm=-10.0, retract_mm=2.0, pitch_mm=1.25)
    taps = [step for step in expand_cycle("cycle_tap", words, place) if step.kind is StepKind.FEED_AXIS]
    assert [step.level_mm for step in taps] == [-10.0, 2.0]
    assert [step.feed_mm_s for step in taps] == [12.5, 12.5]
    assert all(step.synchronous for step in taps)


def test_tapping_without_a_pitch_leaves_the_feed_to_the_program() -> None:
    taps = [step for step in expand_cycle("cycle_tap", WORDS, PLACE) if step.kind is StepKind.FEED_AXIS]
    assert [step.feed_mm_s for step in taps] == [0.0, 0.0]


# --- repeats, shift ---------------------------------------------------------------------------------------


def test_repeats_go_on_by_the_increment() -> None:
    place = CyclePlace((5.0, 0.0), 10.0, 10.0, retract="r", increment_mm=(5.0, 1.0))
    words = CycleWords(depth_mm=-3.0, retract_mm=2.0, repeats=3)
    assert steps("cycle_drill", words, place) == [
        *("xy 5 0", "rapid 2", "feed -3", "rapid 2"),
        *("xy 10 1", "feed -3", "rapid 2"),
        *("xy 15 2", "feed -3", "rapid 2"),
    ]


def test_shift_moves_with_the_hole() -> None:
    place = CyclePlace((5.0, 7.0), 10.0, 10.0, increment_mm=(10.0, 0.0))
    words = CycleWords(depth_mm=-3.0, retract_mm=2.0, shift_mm=(1.0, 0.0), repeats=2)
    assert [step for step in steps("cycle_fine_bore", words, place) if step.startswith("xy")] == [
        *("xy 5 7", "xy 6 7", "xy 5 7"),
        *("xy 15 7", "xy 16 7", "xy 15 7"),
    ]


def test_q_shifts_where_no_i_and_j_are() -> None:
    words = CycleWords(depth_mm=-3.0, retract_mm=2.0, peck_mm=0.5)
    out = expand_cycle("cycle_fine_bore", words, PLACE, Cycles(shift="-2"))
    assert "xy 5 6.5" in [text(step) for step in out]


def test_no_repeats_no_steps_but_still_checked() -> None:
    assert steps("cycle_drill", CycleWords(-3.0, 2.0, repeats=0)) == []
    with pytest.raises(CycleError, match="depth"):
        steps("cycle_drill", CycleWords(repeats=0))


# --- refusals ---------------------------------------------------------------------------------------------

STOPPED = CyclePlace((0.0, 0.0), 10.0, 10.0, spindle="stopped")


@pytest.mark.parametrize(
    ("action", "words", "place", "reason"),
    [
        ("cycle_drill", CycleWords(retract_mm=2.0), PLACE, "depth_missing"),
        ("cycle_drill", CycleWords(depth_mm=-3.0), PLACE, "retract_missing"),
        ("cycle_drill", CycleWords(depth_mm=3.0, retract_mm=2.0), PLACE, "upwards"),
        ("cycle_drill", CycleWords(-3.0, 2.0, repeats=-1), PLACE, "repeats"),
        ("cycle_dwell", CycleWords(-3.0, 2.0, dwell_s=-0.1), PLACE, "dwell"),
        ("cycle_deep", WORDS, PLACE, "peck_missing"),
        ("cycle_deep", CycleWords(-3.0, 2.0, 0.0), PLACE, "peck"),
        ("cycle_chip_break", CycleWords(-3.0, 2.0, -1.0), PLACE, "peck"),
        ("cycle_chip_break", CycleWords(-3.0, 2.0, 1e-9), PLACE, "peck"),
        ("cycle_back_bore", CycleWords(-3.0, 2.0, back_mm=-1.0), PLACE, "shift_missing"),
        ("cycle_back_bore", CycleWords(-3.0, 2.0, shift_mm=(1.0, 0.0)), PLACE, "back_missing"),
        ("cycle_back_bore", CycleWords(-3.0, 2.0, shift_mm=(1.0, 0.0), back_mm=-4.0), PLACE, "back"),
        ("cycle_back_bore", CycleWords(-3.0, 2.0, shift_mm=(1.0, 0.0), back_mm=3.0), PLACE, "back"),
        ("cycle_tap", WORDS, STOPPED, "spindle_stopped"),
        ("cycle_bore_stop", WORDS, STOPPED, "spindle_stopped"),
        ("cycle_bore_manual", WORDS, STOPPED, "spindle_stopped"),
        ("cycle_back_bore", FULL, STOPPED, "spindle_stopped"),
        ("cycle_fine_bore", FULL, STOPPED, "spindle_stopped"),
    ],
)
def test_refusals(action: str, words: CycleWords, place: CyclePlace, reason: str) -> None:
    with pytest.raises(CycleError) as caught:
        expand_cycle(action, words, place)
    assert isinstance(caught.value, ProgramError)
    assert caught.value.reason == reason
    assert CYCLES[action] in caught.value.what
    assert caught.value.hint


def test_plain_cycles_do_not_ask_for_the_spindle() -> None:
    assert steps("cycle_drill", WORDS, STOPPED)


# --- against another control ------------------------------------------------------------------------------

CALL = re.compile(r"N\.+\s+(\w+)\((.*)\)")
CALLS = {
    "DWELL": "dwell",
    "STOP_SPINDLE_TURNING": "stop",
    "ORIENT_SPINDLE": "orient",
    "PROGRAM_STOP": "program stop",
    "DISABLE_FEED_OVERRIDE": "override off",
    "ENABLE_FEED_OVERRIDE": "override on",
}


def rs274_steps(block: str, folder: Path) -> list[str]:
    """Return what LinuxCNC's interpreter does for one cycle block from X0 Y0 Z10, in the words of `text`."""
    program = folder / "cycle.ngc"
    program.write_text(f"G21 G17 G90 G94 G49 G40\nM3 S600 F100\nG0 X0 Y0 Z10\n{block}\nG80\nM2\n")
    done = call(program)
    assert "PROGRAM_END" in done.stdout, done.stdout + done.stderr
    started = finished = False
    place = (0.0, 0.0, 10.0)
    out: list[str] = []
    for name, words in CALL.findall(done.stdout):
        numbers = [float(word) for word in re.findall(r"-?\d+\.\d+", words)]
        if name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            to = (numbers[0], numbers[1], numbers[2])
            if started and to != place:
                way = f"{'rapid' if name == 'STRAIGHT_TRAVERSE' else 'feed'} {to[2]:g}"
                out.append(f"xy {to[0]:g} {to[1]:g}" if to[2] == place[2] else way)
            started, place = True, to
        elif name == "SET_G5X_OFFSET" and started:
            finished = True
        elif started and not finished and name == "DWELL" and numbers[0]:
            out.append(f"dwell {numbers[0]:g}")
        elif started and not finished and name in CALLS and name != "DWELL":
            out.append(CALLS[name])
        elif started and not finished and name.startswith("START_SPINDLE"):
            out.append("start" if name.endswith("_CLOCKWISE") else "reverse")
    return out


# The block, our action, words and retract mode.
BLOCKS = {
    "G98 G81 X5 Y7 Z-3 R2": ("cycle_drill", WORDS, "initial"),
    "G99 G81 X5 Y7 Z-3 R2": ("cycle_drill", WORDS, "r"),
    "G98 G81 X5 Y7 Z-3 R12": ("cycle_drill", CycleWords(-3.0, 12.0), "initial"),
    "G99 G81 X5 Y7 Z-3 R2 L2": ("cycle_drill", CycleWords(-3.0, 2.0, repeats=2), "r"),
    "G98 G82 X5 Y7 Z-3 R2 P0.5": ("cycle_dwell", FULL, "initial"),
    "G98 G83 X5 Y7 Z-3 R2 Q2": ("cycle_deep", FULL, "initial"),
    "G99 G83 X5 Y7 Z-3 R2 Q2": ("cycle_deep", FULL, "r"),
    "G98 G73 X5 Y7 Z-3 R2 Q2": ("cycle_chip_break", FULL, "initial"),
    "G99 G73 X5 Y7 Z-3 R2 Q2": ("cycle_chip_break", FULL, "r"),
    "G99 G84 X5 Y7 Z-3 R2 P0.5": ("cycle_tap", FULL, "r"),
    "G98 G85 X5 Y7 Z-3 R2": ("cycle_bore", FULL, "initial"),
    "G99 G85 X5 Y7 Z-3 R2": ("cycle_bore", FULL, "r"),
    "G98 G86 X5 Y7 Z-3 R2 P0.5": ("cycle_bore_stop", FULL, "initial"),
    "G99 G86 X5 Y7 Z-3 R2 P0.5": ("cycle_bore_stop", FULL, "r"),
    "G98 G87 X5 Y7 Z-3 R2 I1 J0.5 K-1": ("cycle_back_bore", FULL, "initial"),
    "G99 G87 X5 Y7 Z-3 R2 I1 J0.5 K-1": ("cycle_back_bore", FULL, "r"),
    "G99 G89 X5 Y7 Z-3 R2 P0.5": ("cycle_bore_dwell", FULL, "r"),
}


def ours(action: str, words: CycleWords, retract: str) -> list[str]:
    place = R_PLACE if retract == "r" else PLACE
    out = [text(step) for step in expand_cycle(action, words, place, TEN_THOU)]
    # A second rapid to the same hole does not move; rs274's text was filtered likewise.
    return [
        step
        for number, step in enumerate(out)
        if not step.startswith("xy") or step not in last_xy(out[:number])
    ]


def last_xy(before: list[str]) -> list[str]:
    return [step for step in before if step.startswith("xy")][-1:]


needs_rs274 = pytest.mark.skipif(COMMAND is None, reason="rs274 (LinuxCNC) is not installed")


@needs_rs274
@pytest.mark.parametrize("block", BLOCKS)
def test_cycles_as_linuxcnc_runs_them(block: str, tmp_path: Path) -> None:
    assert ours(*BLOCKS[block]) == rs274_steps(block, tmp_path)


@needs_rs274
def test_incremental_repeats_as_linuxcnc_runs_them(tmp_path: Path) -> None:
    words = CycleWords(depth_mm=-5.0, retract_mm=-8.0, repeats=3).absolute(10.0)
    place = CyclePlace((5.0, 7.0), 10.0, 10.0, retract="r", increment_mm=(5.0, 7.0))
    theirs = rs274_steps("G91 G99 G81 X5 Y7 Z-5 R-8 L3", tmp_path)
    assert steps("cycle_drill", words, place) == theirs


@needs_rs274
@pytest.mark.parametrize(
    ("block", "action", "their_way_out"),
    [
        # LinuxCNC feeds all the way to the initial level; here the feed ends at R.
        ("G98 G84 X5 Y7 Z-3 R2 P0.5", "cycle_tap", ["feed 10", "stop", "start", "override on"]),
        ("G98 G89 X5 Y7 Z-3 R2 P0.5", "cycle_bore_dwell", ["feed 10"]),
        # LinuxCNC leaves the whole way out to the operator.
        ("G98 G88 X5 Y7 Z-3 R2 P0.5", "cycle_bore_manual", ["start"]),
    ],
)
def test_known_differences_from_linuxcnc(
    block: str, action: str, their_way_out: list[str], tmp_path: Path
) -> None:
    theirs, here = rs274_steps(block, tmp_path), ours(action, FULL, "initial")
    common = len(theirs) - len(their_way_out)
    assert theirs[:common] == here[:common]
    assert theirs[common:] == their_way_out
    assert here[common:] != their_way_out
