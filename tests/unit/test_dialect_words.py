"""What FANUC, Haas and grbl controls mean by their words, against steps and numbers from their public descriptions."""

from __future__ import annotations

import pytest

import polycnc
from polycnc.errors import ConfigurationError, UsageError
from polycnc.nc import load_dialect
from polycnc.nc.dialect._dialect import Dialect, Numbers
from support.programs import (
    AXIS,
    FIVE,
    LINEAR,
    MILL,
    SPINDLE,
    accepted,
    machine_config,
    moves,
    notes,
    prepare,
    refusal,
)

FANUC = load_dialect("fanuc")

REFERENCES = machine_config(
    '[[axis]]\nname = "X"\nvmax_mm_s = 500\namax_mm_s2 = 5000\nhome_mm = 3\nreference_positions_mm = [-11, 12.5, 40]\n',
    '[[axis]]\nname = "Y"\nvmax_mm_s = 500\namax_mm_s2 = 5000\nhome_mm = 7\n',
    '[[axis]]\nname = "Z"\nvmax_mm_s = 500\namax_mm_s2 = 5000\nhome_mm = 90\nreference_positions_mm = [70]\n',
    SPINDLE,
)


def in_cycle(program: str, dialect: str | Dialect = "fanuc", start: int = 2) -> list[str]:
    """Return what happens from G0 X4 Y5 Z30 on, after the first items."""
    return moves(f"G0 X4. Y5. Z30.\n{program}\n", dialect=dialect)[start:]


# --- cancels and modes that need nothing


@pytest.mark.parametrize(
    "words",
    [
        *(
            "G69",
            "G15",
            "G50.1 X0 Y0",
            "G50",
            "G67",
            "G5.1 Q0",
            "G5.1 Q1",
            "G05 P0",
            "G05 P10000",
            "G8 P0",
            "G08 P1",
        ),
        *(
            "G64",
            "G80",
            "G40 G49 G80",
            "G40.1",
            "G13.1",
            "G113",
            "G23",
            "G25",
            "G11",
            "G150",
            "G94",
            "G97",
            "G98",
        ),
        *("G50.2", "G54", "G92.1", "G17 G21 G40 G49 G50 G54 G64 G67 G69 G80 G90 G94 G98"),
    ],
)
def test_a_cancel_changes_nothing_on_the_path(words: str) -> None:
    plain = "G0 X10. Y-7.25\nG1 X-3.5 F300.\nG2 X5. Y2. R25.\n"
    assert moves(f"{words}\n{plain}", dialect="fanuc") == moves(plain, dialect="fanuc")


@pytest.mark.parametrize(
    "code", ["43.4", "43.5", "68.2", "53.1", "7.1", "12.1", "54.2", "45", "60", "6.2", "33"]
)
def test_what_would_be_another_path_is_refused_with_its_count(code: str) -> None:
    program = f"G0 X1.\n(G{code})\nG{code} X1. H2\nG{code} X4.\nN9G{code}\n"
    channel = prepare(program, dialect="fanuc")
    assert channel.error is not None
    assert channel.error.what == f"G{code} is not supported yet (3 blocks have it)"


def test_a_sub_program_from_elsewhere_is_called_like_any_other() -> None:
    program = "M198 P77 L2\nM30\nO77\nG91 X1.5\nM99\n"
    assert moves(program, dialect="fanuc") == ["rapid X1.5 stop", "rapid X3 stop", "M30"]


def test_fanuc_begins_in_rapid() -> None:
    assert moves("X5. Y2.\n", dialect="fanuc") == ["rapid X5 Y2 stop"]


# --- tapping


TAP_SIDES = {
    # code, spindle before, into the thread, out of it
    "G84": ("M3", "M3", "M4"),
    "G74": ("M4", "M4", "M3"),
}


@pytest.mark.parametrize("code", TAP_SIDES)
def test_tapping_reverses_at_the_bottom(code: str) -> None:
    before, _, out = TAP_SIDES[code]
    assert in_cycle(f"{before} S500\n{code} Z-12.5 R3. P250 F625.\nG80") == [
        "rapid Z3 stop",
        "line Z-12.5 F625 stop",
        "M5",
        out,
        "wait 0.25",
        "line Z3 F625 stop",
        "M5",
        before,
        "rapid Z30 stop",
    ]


def test_left_hand_tapping_with_the_spindle_clockwise_is_refused() -> None:
    text = refusal("G0 Z10.\nM3 S500\nG74 Z-5. R2. F625.\n", dialect="fanuc")
    assert text == "3:1: G74 taps a left-hand thread, and the spindle turns clockwise (M3)"


@pytest.mark.parametrize("code", TAP_SIDES)
def test_peck_tapping_backs_up_by_the_chip_break(code: str) -> None:
    """From R 2 to Z -9 in pecks of 4: -2, -6, -9; back by 1 between them."""
    before, into, out = TAP_SIDES[code]
    assert in_cycle(f"{before} S500\n{code} G99 Z-9. R2. Q4. F625.\nG80") == [
        "rapid Z2 stop",
        *(
            "line Z-2 F625 stop",
            "M5",
            out,
            "line Z-1 F625 stop",
            "M5",
            into,
        ),
        *(
            "line Z-6 F625 stop",
            "M5",
            out,
            "line Z-5 F625 stop",
            "M5",
            into,
        ),
        *(
            "line Z-9 F625 stop",
            "M5",
            out,
            "line Z2 F625 stop",
            "M5",
            before,
        ),
    ]


def test_peck_tapping_can_go_back_to_r() -> None:
    cycles = FANUC.cycles.model_copy(update={"peck_tap": "retract"})
    levels = list(
        in_cycle("M3 S500\nG84 G99 Z-9. R2. Q4. F625.", FANUC.model_copy(update={"cycles": cycles}))
    )
    assert [each.split()[1] for each in levels if each.startswith("line")] == [
        "Z-2",
        "Z2",
        "Z-6",
        "Z2",
        "Z-9",
        "Z2",
    ]


def test_peck_tapping_with_q_0_is_tapping() -> None:
    with_q = in_cycle("M3 S500\nG84 Z-9. R2. Q0 F625.")
    assert with_q == in_cycle("M3 S500\nG84 Z-9. R2. F625.")


def test_a_control_without_peck_tapping_leaves_q_alone() -> None:
    assert in_cycle("M3 S500\nG84 Z-9. R2. Q4. F625.", "din") == in_cycle(
        "M3 S500\nG84 Z-9. R2. F625.", "din"
    )


@pytest.mark.parametrize("code", TAP_SIDES)
def test_rigid_tapping_turns_the_spindle_itself(code: str) -> None:
    """M29 stops the spindle; at S800 with a pitch of 1.25 mm the feed is 1000 mm/min."""
    _, into, out = TAP_SIDES[code]
    program = f"M3 S500\nG95 M29 S800\n{code} Z-9. R2. F1.25\nG80 G94\n"
    assert in_cycle(program, start=1) == [
        "M3 S500",
        "M29 S800",
        "rapid Z2 stop",
        into,
        "line Z-9 F1000 stop",
        "M5",
        out,
        "line Z2 F1000 stop",
        "M5",
        "rapid Z30 stop",
    ]
    channel = accepted(program, dialect="fanuc")
    assert channel.state.spindle.direction == 0
    assert not channel.state.rigid_tap


def test_rigid_tapping_needs_a_speed_and_ends_with_g80() -> None:
    assert (
        refusal("G0 Z10.\nM29\nG84 Z-5. R2. F600.\n", dialect="fanuc") == "3:1: G84 needs a turning spindle"
    )
    text = refusal("G0 Z10.\nM29 S500\nG84 Z-5. R2. F600.\nG80\nG84 Z-5. R2. F600.\n", dialect="fanuc")
    assert text == "5:1: G84 needs a turning spindle"


def test_the_start_of_the_spindle_for_m29_takes_no_time_at_rest() -> None:
    assert moves("M29 S500\n", config=FIVE, dialect="fanuc") == ["M29 S500", "wait 0.25"]
    assert moves("M3 S500\nM29\n", config=FIVE, dialect="fanuc")[-2:] == ["M29", "wait 2"]


# --- back boring


def test_back_boring_from_below() -> None:
    """R lies below the hole: the tool goes there beside it, shifted by Q, and bores up to Z."""
    assert in_cycle("M3 S500\nG98 G87 X14. Z-10. R-25.5 Q3.5 P500 F80.\nG80") == [
        "rapid X14 stop",
        "M5",
        "M19",
        "rapid X17.5 stop",
        "rapid Z-25.5 stop",
        "rapid X14 stop",
        "M3",
        "line Z-10 F80 stop",
        "wait 0.5",
        "M5",
        "M19",
        "rapid X17.5 stop",
        "rapid Z30 stop",
        "rapid X14 stop",
        "M3",
    ]


def test_back_boring_with_incremental_levels() -> None:
    """With G91 R counts from the initial level, Z from R."""
    assert in_cycle("M3 S500\nG91 G87 X10. Z15.5 R-55.5 Q3.5 P500 F80.\nG80") == in_cycle(
        "M3 S500\nG98 G87 X14. Z-10. R-25.5 Q3.5 P500 F80.\nG80"
    )


def test_the_shift_follows_the_configured_direction() -> None:
    cycles = FANUC.cycles.model_copy(update={"shift": "-2"})
    dialect = FANUC.model_copy(update={"cycles": cycles})
    found = in_cycle("M3 S500\nG87 Z-10. R-25. Q3. F80.", dialect)
    assert [each for each in found if "Y" in each] == ["rapid Y2 stop", "rapid Y5 stop"] * 2


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("G87 Z-25. R-10. Q3.", "G87 bores from R up to Z here, and Z -25 does not lie above R -10"),
        ("G87 Z31. R-10. Q3.", "G87 would bore up to Z 31, above the initial level 30"),
        ("G99 G87 Z-10. R-25. Q3.", "G87 goes out to the initial level only"),
        ("G87 Z-10. R-25.", "G87 needs a shift (I and J, or Q)"),
    ],
)
def test_back_boring_that_cannot_be(block: str, text: str) -> None:
    assert refusal(f"G0 Z30.\nM3 S500 F100.\n{block}\n", dialect="fanuc").split(": ", 1)[1] == text


@pytest.mark.parametrize("words", ["I5. J1.", "I5."])
def test_i_and_j_of_a_cycle_that_does_not_shift_are_refused(words: str) -> None:
    """Haas controls peck by I, J and K there: what polycnc does not know, it does not pass over."""
    text = refusal(f"G0 Z30.\nF100.\nG83 Z-10. R2. Q4. {words}\n", dialect="haas")
    assert text.endswith("'I' has no meaning in this block")


# --- reference positions


@pytest.mark.parametrize(
    ("block", "ends"),
    [
        ("G30 P2 X5. Z20.", ["rapid X5 Z20 stop", "rapid X-11 Z70 stop"]),
        ("G30 X5. Z20.", ["rapid X5 Z20 stop", "rapid X-11 Z70 stop"]),
        ("G91 G30 P3 X0", ["rapid X12.5 stop"]),
        ("G91 G30 P4 X0 Y0", ["rapid X40 stop"]),  # Y has one reference position: home
        ("G28 X5. Y8.", ["rapid X5 Y8 stop", "rapid X3 Y7 stop"]),
    ],
)
def test_reference_positions(block: str, ends: list[str]) -> None:
    found = moves(f"{block}\n", dialect="fanuc", config=REFERENCES)
    assert found == ends


def test_a_machine_without_a_second_reference_position_says_so() -> None:
    program = "G0 X10.\nG30 X20.\n"
    assert notes(program, dialect="fanuc", config=MILL)[0] == (
        "G30: the machine file has no reference position 2: the home position is used"
    )
    assert moves(program, dialect="fanuc")[-1] == "rapid X0 stop"
    for wrong in ("P1", "P5", "P2.5"):
        assert "reference position" in refusal(f"G30 {wrong} X0\n", dialect="fanuc")


def test_reference_positions_keep_to_the_soft_limits() -> None:
    config = machine_config(
        AXIS.format(name="X", low=-10, high=10) + "reference_positions_mm = [11.5]\n", SPINDLE
    )
    assert "would go home to 11.500 mm" in refusal("G91 G30 X0\n", dialect="fanuc", config=config)


# --- leaving codes out


def left_out(*codes: str, dialect: str = "fanuc") -> Dialect:
    return load_dialect(dialect).leaving_out(codes)


def test_codes_that_are_left_out_are_said_once_with_their_count() -> None:
    program = "G43.4 H1 Z50.\nG0 X10.\nG5.4 Q1 M77\nG43.4 Z40.\nG90 X5. M198 P7\n"
    dialect = left_out("G43.4", "g05.4", "M198")
    assert moves(program, dialect=dialect) == [
        *("rapid Z50 stop", "rapid X10 stop", "M77", "rapid Z40 stop", "rapid X5 stop")
    ]
    found = [(each.text, each.line, each.count) for each in accepted(program, dialect=dialect).messages.all()]
    assert [each for each in found if "left out" in each[0]] == [
        ("G43.4 is left out, as told", 1, 2),
        ("G5.4 is left out, as told", 3, 1),
        ("M198 is left out, as told", 5, 1),
    ]


def test_words_that_belong_to_a_code_go_with_it() -> None:
    """G68.2 X Y Z I J K is no move; but beside G1 the axis words are that move's."""
    dialect = left_out("G68.2", "G53.1")
    program = "G0 X1. Y2.\nG68.2 X50. Y60. Z70. I10. J20. K30.\nG53.1\nG1 G53.1 X4. F100.\n"
    assert moves(program, dialect=dialect) == ["rapid X1 Y2 stop", "line X4 F100"]


def test_a_known_code_can_be_left_out() -> None:
    assert moves("G41 D1 G1 X5. F100.\nM8\nX9.\n", dialect=left_out("G41", "M8"), config=FIVE) == [
        *("line X5 F100", "line X9 F100")
    ]


@pytest.mark.parametrize("code", ["X5", "G", "G1.25", "43.4", "M1.5", "G1000", "", "G-1"])
def test_what_is_no_code_cannot_be_left_out(code: str) -> None:
    with pytest.raises(UsageError, match="is no"):
        left_out(code)


# --- Haas


def test_haas_numbers_without_a_point_count_increments() -> None:
    program = "G1 X1500 Y2. F250.\nX3. F500\n"
    assert moves(program, dialect="haas") == ["line X1.5 Y2 F250", "line X3 F0.5"]
    assert notes(program, dialect="haas") == [
        "lengths without a decimal point count 0.001 in dialect 'haas'",
        "F without a decimal point counts 0.001 mm in dialect 'haas': F500 is 0.5",
    ]


def test_haas_inch_increments_are_a_tenth_of_the_number() -> None:
    """X10000 is an inch; F2000 is 0.2 inch a minute."""
    assert moves("G20 G1 X10000 F2000\n", dialect="haas") == ["line X25.4 F5.08"]


@pytest.mark.parametrize("ordinary_blocks", [0, 1000])
def test_both_ways_to_read_a_block_read_a_feed_alike(ordinary_blocks: int) -> None:
    program = "G1 X1. F250.\nX2. F750\nX3500 F1.5\nX4.\n"
    assert moves(program, dialect="haas", ordinary_blocks=ordinary_blocks) == [
        *("line X1 F250", "line X2 F0.75", "line X3.5 F1.5", "line X4 F1.5")
    ]


def test_a_feed_counts_increments_only_where_lengths_do() -> None:
    with pytest.raises((ConfigurationError, ValueError), match="only where lengths do"):
        Numbers(feed_least_input=0.001)


def test_haas_tapping_needs_no_m3() -> None:
    assert in_cycle("S500\nG84 G99 Z-9. R2. F625.\nG80", "haas") == [
        *(
            "rapid Z2 stop",
            "M3",
            "line Z-9 F625 stop",
            "M5",
            "M4",
            "line Z2 F625 stop",
            "M5",
        )
    ]
    assert "M4" in in_cycle("S500\nG74 Z-9. R2. F625.\nG80", "haas")[:2]


def test_haas_holes_are_counted_by_l_only() -> None:
    assert (
        len([each for each in moves("G91 G81 X5. Z-3. R-2. L3 F99.\n", dialect="haas") if "X" in each]) == 3
    )
    assert "'K'" in refusal("G81 X5. Z-3. R2. K3 F99.\n", dialect="haas")


def test_haas_work_offsets_beyond_g59() -> None:
    """G110 is G154 P1, G129 is G154 P20."""
    program = "G10 L20 P3 X7. Y8. Z0.\nG112 G0 X1.5 Y2.\nG154 P3 X2.5\nG54 X1.\n"
    assert moves(program, dialect="haas") == ["rapid X8.5 Y10 stop", "rapid X9.5 stop", "rapid X1 stop"]
    assert moves("G10 L20 P20 X7.\nG129 X1.\n", dialect="haas") == ["rapid X8 stop"]


def test_haas_mirrors() -> None:
    assert moves("G101 X0\nG0 X4. Y3.\nG100 X0\nG0 X5.\n", dialect="haas") == [
        *("rapid X-4 Y3 stop", "rapid X5 stop")
    ]


@pytest.mark.parametrize(
    ("block", "text"),
    [
        ("M97 P1000", "M97 is not supported yet"),  # a call of a line: no auxiliary function
        ("M96 P5 Q1", "M96 is not supported yet"),
        ("G150 P1 D1", "G150 is not supported yet (1 block has it)"),
        ("G70 I5. J0 L6", "G70 is not supported yet (1 block has it)"),
        ("G5.1 Q1", "G5.1 is not known in dialect 'haas'"),
        ("G77 Z-3. R2. F100. Q0.5", "G77 bores from R up to Z here, and Z -3 does not lie above R 2"),
    ],
)
def test_haas_words_that_are_refused(block: str, text: str) -> None:
    assert refusal(f"{block}\n", dialect="haas").split(": ", 1)[1] == text


def test_what_a_haas_post_processor_writes_is_read() -> None:
    program = (
        "%\nO01001 (PART)\nG90 G94 G17\nG21\nG53 G0 Z0.\nT1 M6\nS5000 M3\nG54\nM8\nG187 P2\nG0 X12. Y-3.\nG43 Z15. H1\n"
        "Z5.\nG1 Z-1. F333.\nG2 X22. Y-3. I5. J0.\nG17\nG103 P1\nM9\nM5\nG53 G0 Z0.\nG53 X0. Y0.\nM30\n%\n"
    )
    assert accepted(program, dialect="haas", config=machine_config(LINEAR, SPINDLE)).error is None


# --- grbl


@pytest.mark.parametrize(
    "block",
    [
        *(
            "M6 T1",
            "M98 P1",
            "M99",
            "M77",
            "G41 D1",
            "G43 H1",
            "G64",
            "G64 P0.1",
            "G81 X1 Z-1 R1",
            "G90.1",
            "G18.2",
        ),
        *(
            "G95",
            "G96 S100",
            "G70",
            "G52 X1",
            "G4 X1",
            "G2 X10 I5 P2",
            "G1 X1 H1",
            "G1 X1 Q1",
            "G38.2 Z-5",
            "G43.1 Z5",
        ),
        *("G28.1", "G5.1", "G68 R30", "G73 X1", "G10 L1 P1", "G10 L2 P7 X0", "G10 L2 X0", "M19"),
    ],
)
def test_what_grbl_answers_with_an_error_is_refused(block: str) -> None:
    assert refusal(f"F100\n{block}\n", dialect="grbl").startswith("2:")


def test_what_grbl_knows_is_read() -> None:
    program = (
        "G17 G21 G40 G49 G54 G61 G90 G91.1 G94\n"
        "T1\nM3 S1000\nM8\nG0 X1 Y2\nG1 X3 F100\nG2 X5 I1\nG3 X7 Y2 R5\n"
        "G4 P0.5\nG93 G1 X9 F30\nG94 F100\nM7\nM9\nM0\nM1\nG92 X0\nG92.1\nM5\nM2\n"
    )
    assert accepted(program, dialect="grbl").error is None


def test_grbl_passes_rapids_without_a_stop() -> None:
    assert moves("X1\nG0 Y2\n", dialect="grbl") == ["rapid X1", "rapid Y2"]


def test_grbl_has_no_motion_behind_g80() -> None:
    assert refusal("G1 X1 F100\nG80\nX2\n", dialect="grbl") == "3:1: axis words without a motion"
    assert moves("G1 X1 F100\nG80\nG0 X2\n", dialect="grbl") == ["line X1 F100 stop", "rapid X2"]


@pytest.mark.parametrize(
    ("program", "end"),
    [
        # L2 sets the zero, L20 makes the position read the values; P0 is the active system.
        ("G0 X10 Y20\nG10 L2 P1 X3 Y4\nG0 X1 Y1", "rapid X4 Y5"),
        ("G0 X10 Y20\nG10 L2 P0 X3\nG0 X1", "rapid X4"),
        ("G0 X10 Y20\nG10 L20 P1 X3 Y-4\nG0 X1 Y1", "rapid X8 Y25"),
        ("G0 X10 Y20\nG10 L20 P0 X3\nG0 X1", "rapid X8"),
        ("G0 X10 Y20\nG10 L20 P2 X3\nG55 G0 X1", "rapid X8"),
        ("G10 L2 P1 X5\nG0 X10 Y20\nG10 L20 P2 X3\nG55 G0 X1", "rapid X13"),
        ("G92 X5\nG0 X10\nG10 L20 P1 X3\nG0 X1", "rapid X3"),
        ("G20 G0 X1\nG10 L20 P1 X2\nG0 X0", "rapid X-25.4"),
    ],
)
def test_grbl_sets_work_offsets(program: str, end: str) -> None:
    assert moves(f"{program}\n", dialect="grbl")[-1] == end


def test_run_and_check_leave_codes_out() -> None:
    program = "G43.4 H1 Z5.\nG0 X10.\nM30\n"
    assert [error.what for error in polycnc.check(program, dialect="fanuc")] == [
        "G43.4 is not supported yet (1 block has it)"
    ]
    assert polycnc.check(program, dialect="fanuc", ignore=["G43.4"]) == []
    result = polycnc.run(program, dialect="fanuc", ignore=["G43.4"])
    assert result.end_position_mm == {"X": 10.0, "Y": 0.0, "Z": 5.0}
    assert [(each.text, each.line) for each in result.messages if "left out" in each.text] == [
        ("G43.4 is left out, as told", 1)
    ]


# --- blanks inside numbers


@pytest.mark.parametrize("ordinary_blocks", [0, 1000])
@pytest.mark.parametrize(
    ("block", "plain"),
    [
        ("G0 X1 0. Y-2 5.7 5", "G0 X10. Y-25.75"),
        ("G 0 1 X - 1 . 5 F 1 0 0", "G01 X-1.5 F100"),
        ("N 1 0 G1 X. 5 Y 2 . F300", "N10 G1 X.5 Y2. F300"),
        ("G1 X1\t2 (3) Y4 F9 9", "G1 X12 Y4 F99"),
    ],
)
def test_blanks_inside_numbers_count_for_nothing(block: str, plain: str, ordinary_blocks: int) -> None:
    options = {"dialect": "fanuc", "ordinary_blocks": ordinary_blocks}
    assert moves(f"{block}\n", **options) == moves(f"{plain}\n", **options)
    assert refusal("G0 X1 0\n") == "1:7: '0' has no letter"  # din


@pytest.mark.parametrize("block", ["X1 .2.3", "X1 (a) 0", "X", "X 1 0 0 . 1 . 2"])
def test_what_is_no_number_with_blanks_is_refused(block: str) -> None:
    assert refusal(f"{block}\n", dialect="fanuc")


# --- two codes of one group: the last one counts

PAIRS = [
    ("G91 G90 X17.", "G90 X17.", "G91 and G90 exclude each other (group 'distance')"),
    ("G90 G91 X17.", "G91 X17.", "G90 and G91 exclude each other (group 'distance')"),
    ("G0 G1 X10. F1000", "G1 X10. F1000", "G0 and G1 exclude each other (group 'motion')"),
    ("G1 G0 X10. F1000", "G0 X10. F1000", "G1 and G0 exclude each other (group 'motion')"),
    ("G17 G18 G2 X8. Z30. R2.", "G18 G2 X8. Z30. R2.", "G17 and G18 exclude each other (group 'plane')"),
    ("G28 G53 G0 X3.", "G53 G0 X3.", "G28 and G53 exclude each other (group 'non modal')"),
    ("M8 M9", "M9", "M8 and M9 exclude each other (group 'coolant')"),
    ("M9 M7 X3.", "M7 X3.", "M9 and M7 exclude each other (group 'coolant')"),
    ("S300 M3 M4 M5", "S300 M5", "M3 and M4 exclude each other (group 'spindle')"),
    ("G1 G1 X7. F50", "G1 X7. F50", "G1 is given twice in this block"),
    ("M8 M8", "M8", "M8 is given twice in this block"),
]


@pytest.mark.parametrize(("block", "last", "what"), PAIRS)
def test_of_two_codes_of_one_group_the_last_one_counts(block: str, last: str, what: str) -> None:
    config = machine_config(LINEAR, SPINDLE)
    programs = [f"G0 X4. Y5. Z30. F77\n{each}\nG1 X21. Y2.5\n" for each in (block, last)]
    assert moves(programs[0], dialect="fanuc", config=config) == moves(
        programs[1], dialect="fanuc", config=config
    )
    found, without = (notes(each, dialect="fanuc", config=config) for each in programs)
    assert [each for each in found if each not in without][:1] == [f"{what}: the last one counts"]


@pytest.mark.parametrize("dialect", ["din", "haas", "grbl", "linuxcnc", "bosch"])
def test_elsewhere_they_are_refused(dialect: str) -> None:
    assert refusal("G90 G91 X17.\n", dialect=dialect).endswith(
        "G90 and G91 exclude each other (group 'distance')"
    )


def test_words_of_the_code_that_does_not_count_are_refused() -> None:
    assert "'R' has no meaning in this block" in refusal("G0 X4. F9\nG2 G1 X9. R3.\n", dialect="fanuc")
