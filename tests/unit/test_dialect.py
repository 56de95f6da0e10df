"""Dialects: their files, the meaning of codes, the dialect of a program."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import polycnc
from polycnc.errors import ConfigurationError, ProgramError, UsageError
from polycnc.nc.dialect._dialect import DEFAULT_DIALECT, DIALECTS, Dialect, load_dialect
from polycnc.nc.dialect._guess import choose_dialect, dialect_for
from polycnc.nc.modal._actions import Action, Group, MAction
from polycnc.nc.modal._modal import (
    ABSOLUTE,
    ARC_RELATIVE,
    ARC_TOLERANCE,
    EXACT_STOP,
    FEED,
    FEED_MODE,
    FEED_PER_REVOLUTION,
    MOTION,
    MOTION_LINEAR,
    PLANE,
    PLANE_ZX,
    RAPID_STOP,
    make_modal,
)
from polycnc.nc.text._program import ProgramText, TextRules
from polycnc.nc.text._scan import STATEMENT
from polycnc.nc.text._scan_plain import scan_blocks
from polycnc.runner import RunSettings

SHORT = 'name = "own"\n[g]\n0 = "rapid"\n"5.1" = "ignored"\n[m]\n30 = "program_end"\n'


def own(tmp_path: Path, text: str) -> Dialect:
    path = tmp_path / "own.toml"
    path.write_text(text, encoding="utf-8")
    return load_dialect(path)


# --- what comes with polycnc


def test_the_default_is_din() -> None:
    assert DEFAULT_DIALECT == load_dialect().name == "din"
    assert set(DIALECTS) == {
        "din",
        "fanuc",
        "fanuc-lathe",
        "fanuc-lathe-b",
        "haas",
        "grbl",
        "linuxcnc",
        "bosch",
    }
    for name in DIALECTS:
        assert load_dialect(name).name == name
    din = load_dialect("din")
    assert load_dialect(din) is din


# Codes that ISO 6983 / DIN 66025-2 fix, or that nearly all milling controls share.
COMMON = {
    0: Action.RAPID,
    1: Action.LINEAR,
    2: Action.ARC_CW,
    3: Action.ARC_CCW,
    4: Action.DWELL,
    17: Action.PLANE_XY,
    18: Action.PLANE_ZX,
    19: Action.PLANE_YZ,
    40: Action.COMP_OFF,
    41: Action.COMP_LEFT,
    42: Action.COMP_RIGHT,
    54: Action.WORK_OFFSET,
    59: Action.WORK_OFFSET,
    80: Action.CYCLE_CANCEL,
    90: Action.ABSOLUTE,
    91: Action.INCREMENTAL,
    92: Action.SET_POSITION,
    94: Action.FEED_PER_MINUTE,
    95: Action.FEED_PER_REVOLUTION,
}


MILLING = ("din", "fanuc", "haas", "bosch")


@pytest.mark.parametrize("name", MILLING)
def test_common_codes(name: str) -> None:
    dialect = load_dialect(name)
    assert {code: dialect.g_action(code) for code in COMMON} == COMMON
    m_codes = {0: "program_stop", 1: "optional_stop", 2: "program_end", 3: "spindle_cw", 4: "spindle_ccw"}
    m_codes |= {5: "spindle_stop", 6: "tool_change", 8: "coolant_flood", 9: "coolant_off", 30: "program_end"}
    for code, action in m_codes.items():
        found = dialect.m_action(code)
        assert found is not None
        assert found.title == action
    assert dialect.m_action(77) in (MAction.AUXILIARY, MAction.AUXILIARY_WORDS)


@pytest.mark.parametrize(
    ("name", "inch", "metric"),
    [("din", (20, 70), (21, 71)), ("fanuc", (20,), (21,)), ("bosch", (70,), (71,))],
)
def test_units(name: str, inch: tuple[int, ...], metric: tuple[int, ...]) -> None:
    dialect = load_dialect(name)
    units = (Action.INCH, Action.METRIC)
    for code in (20, 21, 70, 71):
        wanted = Action.INCH if code in inch else Action.METRIC if code in metric else None
        found = dialect.g_action(code)
        assert (found if found in units else None) is wanted


def test_the_din_dialect_knows_what_cam_systems_write() -> None:
    din = load_dialect("din")
    safety_line = [
        17,
        20,
        21,
        28,
        40,
        43,
        49,
        53,
        54,
        61,
        64,
        73,
        80,
        81,
        82,
        83,
        84,
        90,
        90.1,
        91.1,
        92.1,
        93,
        98,
        99,
    ]
    assert [code for code in safety_line if din.g_action(code) is None] == []
    assert din.dwell["P"] == "s"
    assert load_dialect("fanuc").dwell["P"] == "s_or_ms"


def test_bosch_has_three_groups_of_zero_shifts_and_a_code_to_leave_each() -> None:
    bosch = load_dialect("bosch")
    for first in (54, 154, 254):
        assert {bosch.g_action(first + n) for n in range(6)} == {Action.WORK_OFFSET}
        assert bosch.g_action(first - 1) is Action.WORK_OFFSET_OFF


def test_bosch_recognises_cpl_blocks() -> None:
    text = ProgramText.from_text('10 A%=5 : B$="x"\nN10 G1 X[A%]\n.LABEL\nREM end\nN30 P999\n')
    flags = [block.flags & STATEMENT for block in scan_blocks(text, load_dialect("bosch").text)]
    assert flags == [STATEMENT, STATEMENT, STATEMENT, STATEMENT, 0]


def test_nesting_depth() -> None:
    assert load_dialect("bosch").sub_program.depth == 7  # Manual 003, 2.1
    assert load_dialect("fanuc").sub_program.depth == 4


# --- codes


def test_a_code_is_known_exactly_or_not_at_all() -> None:
    din = load_dialect("din")
    assert din.g_action(90.1) is Action.ARC_CENTER_ABSOLUTE
    for code in (90.2, 90.05, 90.149, 5, 1000, -1, 1e300):
        assert din.g_action(code) is None


@pytest.mark.parametrize("name", DIALECTS)
def test_compiled_tables_say_the_same(name: str) -> None:
    dialect = load_dialect(name)
    table = dialect.tables().g_action
    assert table.dtype == np.int16
    assert table.shape == (10_000,)
    for tenths in range(10_000):
        action = dialect.g_action(tenths / 10)
        ordinary = dialect.notes_codes or "feeds of before" in dialect.refuses
        noted = ordinary and action is Action.FEED_PER_MINUTE  # by ordinary blocks alone
        assert table[tenths] == (0 if action is None or noted else action)


def test_every_action_has_a_group_and_its_number_is_not_zero() -> None:
    assert {action.group for action in Action} == set(Group)
    assert min(Action) > 0


# --- own files


def test_a_short_file_gets_the_documented_defaults(tmp_path: Path) -> None:
    dialect = own(tmp_path, SHORT)
    assert dialect.text == TextRules()
    assert dialect.g_action(5.1) is Action.IGNORED
    assert dialect.g_action(1) is None
    assert dialect.m_action(30) is MAction.PROGRAM_END
    assert dialect.tables().least_input == 0.0
    assert dialect.cycles.chip_break_mm == 1.0


def test_values_of_a_file_reach_their_readers(tmp_path: Path) -> None:
    dialect = own(
        tmp_path,
        'other_m = "error"\nrapid_exact_stop = false\n'
        + SHORT
        + '[numbers]\ndecimal_point = "least_input"\nleast_input = 0.01\n'
        + "[arcs]\ntolerance_mm = 0.5\nrelative_tolerance = 0.02\n"
        + "[cycles]\nchip_break_mm = 0.25\nreentry_mm = 2\n"
        + "[text]\nsemicolon_comments = false\nunclosed_comments = true\nline_numbers = true\n"
        + 'statement_characters = "["\n'
        + '[initial]\nmotion = "linear"\nplane = "zx"\nunits = "inch"\nabsolute = false\nexact_stop = true\n'
        + 'feed_mode = "per_revolution"\nfeed_mm_min = 120\n',
    )
    assert dialect.m_action(31) is None
    assert dialect.tables().least_input == 0.01
    assert (dialect.cycles.chip_break_mm, dialect.cycles.reentry_mm) == (0.25, 2.0)
    assert dialect.text == TextRules(
        semicolon_comments=False, unclosed_comments=True, line_numbers=True, statement_characters="["
    )
    modal = make_modal(["X", "Y", "Z", "A"], [False, False, False, True], [0.0] * 4, [1.0] * 4)
    dialect.set_initial_state(modal)
    assert modal.scale.tolist() == [25.4, 25.4, 25.4, 1.0]
    whole, real = modal.whole, modal.real
    assert (whole[MOTION], whole[PLANE], whole[ABSOLUTE]) == (MOTION_LINEAR, PLANE_ZX, 0)
    assert (whole[EXACT_STOP], whole[RAPID_STOP], whole[FEED_MODE]) == (1, 0, FEED_PER_REVOLUTION)
    assert (real[FEED], real[ARC_TOLERANCE], real[ARC_RELATIVE]) == (120.0, 0.5, 0.02)


@pytest.mark.parametrize(
    ("wrong", "line", "message"),
    [
        ("colour = 1\n", 1, "unknown key 'colour'"),
        ('dwell = { P = "h" }\n', 1, "'P' must be"),
        ('extensions = ["nc"]\n', 1, "'nc'"),
        ("rapid_exact_stop = 1\n", 1, "true or false"),
    ],
)
def test_a_wrong_key_is_named_with_its_line(tmp_path: Path, wrong: str, line: int, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message) as caught:
        own(tmp_path, wrong + SHORT)
    assert caught.value.position is not None
    assert caught.value.position.line == line


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ('[g]\n0 = "rapit"\n[m]\n', "'rapit' is not an action"),
        ('[g]\nG0 = "rapid"\n[m]\n', "'G0' is not a G code"),
        ('[g]\n1000 = "rapid"\n[m]\n', "'1000' is not a G code"),
        ('[g]\n[m]\n3 = "spin"\n', "'spin' is not an action"),
        ('[g]\n[m]\n"3.1" = "spindle_cw"\n', "'3.1' is not an M code"),
        ('[g]\n[m]\n[text]\nstatement_characters = "[1"\n', "'1' cannot mark a statement"),
    ],
)
def test_a_wrong_table_is_refused(tmp_path: Path, wrong: str, message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        own(tmp_path, f'name = "own"\n{wrong}')


def test_an_unknown_dialect_names_those_that_there_are() -> None:
    with pytest.raises(UsageError, match="fanuk") as caught:
        load_dialect("fanuk")
    assert all(name in caught.value.hint for name in DIALECTS)


# --- the dialect of a program


def test_the_dialect_of_a_program() -> None:
    def of(name: str, explicit: str | None = None) -> str:
        return dialect_for(
            ProgramText.from_text("%\nO1\n" if "tap" in name else "G0 X1\n", name), explicit
        ).name

    assert of("part.tap", "bosch") == "bosch"  # what is said counts first
    for text, remarks in (("G0 X1 ; to the edge\n", True), ("G0 X1;\n(a; remark)\n", False)):
        found = dialect_for(ProgramText.from_text(text, "part.tap"))
        assert (found.name, found.text.semicolon_comments) == ("fanuc", remarks)
    for name in DIALECTS:
        for extension in load_dialect(name).extensions:
            assert of(f"folder/part{extension}") == name
            assert of(f"part{extension.upper()}") == name
    for program in ("part", "part.nc", "part.unheard-of", "<text>"):
        assert of(program) == "din"
    with pytest.raises(UsageError):
        of("part.nc", "nothing")


@pytest.mark.parametrize(
    ("program", "name", "reason"),
    [
        ("%\nO1000 (PART)\nG0 X1\n", "fanuc", "O1000 in line 2"),
        ("%\nO1000 (PART; ROUGH)\nG0 X1;\nM30 ;\n", "fanuc", "O1000 in line 2"),
        ("; part\nO1000\nG0 X1 ; fast\n", "din", ""),
        ("G0 X1\nN20 G65 P9010 A1\n", "fanuc", "G65 P9 in line 2"),
        ("G65 A1. B2 P9010\n", "fanuc", "G65 A1. B2 P9 in line 1"),
        ("G0 X1\n#101=5\nIF[#101GT3]GOTO10\n", "fanuc", "#101= in line 2"),
        ("%\nO0002\nT0101\nG0 X20. Z5.\n", "fanuc-lathe", "O0002 in line 2"),
        ("O2\nT0101 M6\nG0 X20. Y5.\n", "fanuc", "O2 in line 1"),
        ("O2\nT101\nG0 X20. Z5.\n", "fanuc-lathe", "O2 in line 1"),
        ("O2\nT0101\nG90 G95\nG77 X9. Z-5.\n", "fanuc-lathe-b", "G95 in line 3"),
        ("O2\nT0101\nN13 G91 G28 X0\n", "fanuc-lathe-b", "G91 in line 3"),
        ("G0 X1 ; to the edge\nG31 Z-9 F50\n", "fanuc", "G31 in line 2"),
        ("O7\nG13 Z-.3 I.19 K.2 Q.19 D02 F10.\n", "haas", "G13 in line 2"),
        ("O7\nG13\nG12.1 I5 Z1\n", "fanuc", "O7 in line 1"),
        ("N10 T2\nG71 P70 Q110 U0.4\n", "fanuc-lathe", "G71 P70 Q110 in line 2"),
        ("O2 ; shaft\nT1 ; rough\nG71 P10 Q20 U1. ; cut\n", "fanuc-lathe", "G71 P10 Q20 in line 3"),
        ("N10 G28 U0 W0\nT0202\n", "fanuc-lathe", "G28 U0 in line 1"),
        ("G28 X0 Y0 U0 V0\nG73 X1 Z-1 Q1 R1\n", "din", ""),
        ("O2 ; shaft\nT0101 ; rough\nG0 X20. Z5. ; start\n", "fanuc-lathe", "O2 in line 1"),
        ("O3 (G15 H1, P1=7)\n(P2=12, IF P2 IS LONG)\nG15\nG33 Z-4. E2.5\n", "fanuc", "O3 in line 1"),
        ("(a)\n#<depth> = 5\n", "linuxcnc", "#<d in line 2"),
        ("#1=2\no100 while [#1 gt 0]\n", "linuxcnc", "o100 while in line 2"),
        ("G64 P0.01\n", "linuxcnc", "G64 P0 in line 1"),
        ("N10 G0 X0\n20 IF A%=1 THEN\n", "bosch", "20 IF in line 2"),
        ("10 A%=5\n", "bosch", "10 A%= in line 1"),
        ("$32=1\nG0 X1\n", "grbl", "$32= in line 1"),
        ("G0 X1\nG68 R90\nX5\nG69\n", "fanuc", "G68 in line 2"),
        ("; part\nG54.1 P3\n", "fanuc", "G54.1 in line 2"),
        ("%\n:0491(PART)\nG10 L2 P1 X5\n", "fanuc", ":0491 in line 2"),
        ("G0 X1\n:10 G0 X5\n", "din", ""),
        ("O7\nG1 X1\nG150 X2. P3 Z-.5\n", "haas", "G150 X2. P3 in line 3"),
        ("O7\nG150 G40 X2. Z5.\n", "fanuc", "O7 in line 1"),
        ("G0 X1 (O100 sub, #<a>, G65 P1)\nG1 X2 F100\n", "din", ""),
        ("N10 G0 X1 O5\n", "din", ""),
    ],
)
def test_the_dialect_is_guessed_and_says_why(program: str, name: str, reason: str) -> None:
    chosen = choose_dialect(ProgramText.from_text(program, "part.nc"))
    assert (chosen.dialect.name, chosen.reason, chosen.problem) == (name, reason, None)
    assert chosen.dialect.text.semicolon_comments or "; s" not in program
    assert choose_dialect(ProgramText.from_text(program, "part.nc"), "haas").reason == ""


@pytest.mark.parametrize(
    ("program", "language", "line"),
    [
        ("BEGIN PGM PLATE MM\n1 L X+10\n", "Heidenhain", 1),
        ("\n0  BEGIN PGM 12 INCH\n", "Heidenhain", 2),
        ("N10 G0 X0\nN20 MCALL CYCLE81(10,0,2,-5)\n", "Siemens", 2),
        ("DEF REAL DEPTH\n", "Siemens", 1),
        ("N5 R1=3\nG0 X=R1\n", "Siemens", 1),
        ("%_N_PART_MPF\n", "Siemens", 1),
        ("(a)\n%PLATE G71 *\nN10 G30 G17 X+0 Y+0 Z-40 *\n", "DIN/ISO language of Heidenhain", 2),
        ("$SHAFT.MIN%\nO17\nG0 X40 Z2\n", "OSP language", 1),
        ("O17\nG15 H2\nG0 X40 Y2\n", "OSP language", 2),
        ("N3 G0 X40\nN4 VC12 = 3\n", "OSP language", 2),
        ("G0 X40 Z2\nG85 NLAP1 D4\n", "OSP language", 2),
        ("G0 X40 Z2\nNAT03\n", "OSP language", 2),
        ("%PLATE,MX--\nN10 G90\n", "Fagor language", 1),
        ("%PLATE,MX,\nN10 G90\n", "Fagor language", 1),
        ("G28\n<Slice> Blank\n", "language of 3D printers", 2),
        ("G28\nM140 S60\n", "language of 3D printers", 2),
        ("N10 G90\nN20 (IF P7 GT 3 GOTO N50)\nN50 M30\n", "Fagor language", 2),
        ("N20 (P7 = P2 + P3)\n", "Fagor language", 1),
        ("G21\nG92 E0\n", "language of 3D printers", 2),
        ("G21\nG1 X3.5 Y7 E.25\n", "language of 3D printers", 2),
        ("'CUT\nVS,2,1\nM3,4,5,-.1\n", "language of ShopBot tools", 2),
        ("IMF_PBL V1.0\nFASTABS X0\n", "NCP language", 1),
        ("IN;SP1;PU0,0;PD100,0;\n", "plotter language HPGL", 1),
    ],
)
def test_a_language_that_is_not_read_is_named(program: str, language: str, line: int, tmp_path: Path) -> None:
    (tmp_path / "part.h").write_text(program)
    chosen = choose_dialect(ProgramText.from_path(tmp_path / "part.h"))
    assert chosen.problem is not None
    assert f"this program is in the {language}" in str(chosen.problem)
    result = polycnc.runner.run_program(tmp_path / "part.h", RunSettings(), check=False)
    (alarm,) = result.alarms
    assert (language in alarm.text, alarm.line, result.blocks, result.time_s) == (True, line, 0, 0.0)
    with pytest.raises(ProgramError, match=language):
        dialect_for(ProgramText.from_path(tmp_path / "part.h"))
    assert [each.what for each in polycnc.check(tmp_path / "part.h")] == [alarm.text]
    assert choose_dialect(ProgramText.from_text(program), "bosch").problem is None


def test_what_can_be_read_beyond_an_error_is_run_on_request() -> None:
    program = "G0 X10\nG1 X20 F600\nG1 X30 Q1x\nG1 X40\nG1 X50\n"
    refused = polycnc.runner.run_program(program, RunSettings(), check=False)
    assert (refused.end_position_mm["X"], refused.refused_s) == (20.0, None)
    drawn = polycnc.runner.run_program(program, RunSettings(past_errors=True), check=False)
    assert [alarm.line for alarm in drawn.alarms] == [3]
    assert drawn.end_position_mm["X"] == 50.0
    assert drawn.refused_s == pytest.approx(refused.time_s, abs=0.002)


def test_no_extension_means_two_dialects() -> None:
    extensions = [extension for name in DIALECTS for extension in load_dialect(name).extensions]
    assert len(extensions) == len(set(extensions))


def _dialect(folder: Path, name: str, text: str) -> Dialect:
    (folder / name).write_text(text)
    return load_dialect(folder / name)


def test_a_dialect_on_another_says_what_differs(tmp_path: Path) -> None:
    haas = load_dialect("haas")
    page = Path(__file__).parents[2] / "docs" / "reference" / "dialects.md"
    text = page.read_text(encoding="utf-8").partition('title="our-haas.toml"\n')[2].partition("```")[0]
    ours = _dialect(tmp_path, "our-haas.toml", text)
    assert (ours.name, ours.description, ours.extensions) == ("our-haas", "", ())
    assert ours.g == {**haas.g, "93": "feed_inverse_time"}
    assert ours.m == {**{code: action for code, action in haas.m.items() if code != "19"}, "36": "left_out"}
    assert haas.increment
    assert not ours.increment
    assert ours.numbers.least_input == haas.numbers.least_input
    kept = set(Dialect.model_fields) - {
        "name",
        "description",
        "extensions",
        "base",
        "without",
        "g",
        "m",
        "numbers",
    }
    assert all(getattr(ours, key) == getattr(haas, key) for key in kept)
    third = _dialect(
        tmp_path,
        "third.toml",
        'name = "third"\nbase = "our-haas.toml"\ndwell = { P = "s" }\n[g]\n94 = "nothing"\n',
    )
    assert third.dwell == {"P": "s"}
    assert third.g == {**ours.g, "94": "nothing"}
    assert third.m == ours.m


@pytest.mark.parametrize(
    ("text", "place", "says"),
    [
        ('name = "a"\nbase = "hass"\n', "a.toml:2:1", "there is no dialect 'hass'"),
        (
            'name = "a"\nbase = "haas"\nwithout = ["G5000"]\n',
            "a.toml:3:12",
            "'G5000' is no code of dialect 'haas'",
        ),
        (
            'name = "a"\nbase = "haas"\nwithout = ["G4", 4]\n',
            "a.toml:3:18",
            "'4' is no code of dialect 'haas'",
        ),
        ('name = "a"\nwithout = ["G4"]\n[g]\n[m]\n', "a.toml:2:1", "there is no base to leave codes out of"),
        ('name = "a"\nbase = "a.toml"\n', "a.toml:2:1", "each the base of the one before"),
        ('name = "a"\nbase = "gone.toml"\n', "", "cannot read"),
        ('name = "a"\nbase = 5\n[g]\n[m]\n', "a.toml:2:1", "base"),
        ('base = "haas"\n', "a.toml", "name"),
        ('name = "a"\nbase = "haas"\n[g]\n1 = "liner"\n', "a.toml:4:1", "'liner' is not an action"),
        ('name = "a"\nbase = "wrong.toml"\n', "wrong.toml:3:1", "'liner' is not an action"),
    ],
)
def test_a_wrong_base_is_refused_at_its_place(tmp_path: Path, text: str, place: str, says: str) -> None:
    (tmp_path / "wrong.toml").write_text('name = "w"\n[g]\n1 = "liner"\n[m]\n')
    with pytest.raises(ConfigurationError) as caught:
        _dialect(tmp_path, "a.toml", text)
    assert place in str(caught.value)
    assert re.search(says, str(caught.value))
