"""Words of the dialect `linuxcnc`: numbers worked out by hand, what is refused, and parameters that tell of them."""

from __future__ import annotations

from pathlib import Path

import pytest

import polycnc

ENDS = [
    ("G0 X3 Y4\nG28.1\nG0 X9\nG28 X5", {"X": 3.0, "Y": 4.0}),
    ("G0 X3 Y4\nG30.1\nG0 X9\nG0 Y[#5181+#5182]", {"X": 9.0, "Y": 7.0}),
    ("#5161=6 #5163=2\nG0 X1\nG28", {"X": 6.0, "Z": 2.0}),
    ("G0 X6\nG92 X2\nG92.2\nG0 Y[#5210] Z[#5211]\nG92.3\nG0 X1 Y[#5210+8]", {"X": 5.0, "Y": 9.0, "Z": 4.0}),
    ("G92.1\n#5211=5\nG92.3\nG0 X2", {"X": 7.0}),
    ("G10 L2 P2 X7 R90\nG55 G0 X3 Y1\nG0 Z[#5250 / 10]", {"X": 6.0, "Y": 3.0, "Z": 9.0}),
    ("G59.2\nG0 X[#5220] Y[#<_coord_system>]", {"X": 8.0, "Y": 592.0}),
    ("G43.1 X3 Z5\nG0 X1 Z1 Y[#<_tool_offset>+6]", {"X": 4.0, "Z": 6.0, "Y": 7.0}),
    ("G7\nG0 X9 Z[#<_lathe_diameter_mode> + 1]\nG1 F99 Y#<_x>", {"X": 4.5, "Y": 4.5, "Z": 2.0}),
    ("M7\nM8\nG0 X[#<_mist>+2*#<_flood>]\nM9\nG0 Y[#<_mist>+2*#<_flood>+5]", {"X": 3.0, "Y": 5.0}),
    ("G0 @5 ^90\nG1 F100 ^0", {"X": 5.0, "Y": 0.0}),
]


def run(tmp_path: Path, program: str, machine: str = "mill3") -> polycnc.Result:
    path = tmp_path / "part.ngc"
    path.write_text(f"G21\n{program}\nM2\n", encoding="ascii")
    return polycnc.run(path, machine)


@pytest.mark.parametrize(("program", "end"), ENDS)
def test_where_it_goes(program: str, end: dict[str, float], tmp_path: Path) -> None:
    found = run(tmp_path, program).end_position_mm
    assert {name: found[name] for name in end} == pytest.approx(end, abs=1e-9)


REFUSALS = [
    ("M3 $1 S100", "there is no spindle 1"),
    ("M3 $-2 S100", "there is no spindle -2"),
    ("M3 $0 S100 $[1-1]", r"\$ without the number of a spindle"),
    ("$10=5", r"'\$' is not allowed in a block"),
    ("#1 = SQRT(2)", r"square brackets"),
    ("G10 L20 P1 X3 R5", "G10 L20 with R"),
    ("G10 L3 P1 X3", "L3 is not there"),
    ("G10 P1 X3", "without L and P"),
    ("G43.2 X3", "without H"),
    ("G0 G43.1 X3", "both use the axis words"),
    ("G41.1 X3", "without D"),
    ("G42.1 D3 L2", "in another plane than G18"),
    ("G92.3\n#5211=5", "while its shift is in force"),
    ("G91 G81 @5 ^90 Z-1 R2 L3 F100", "the tool is at zero"),
    ("M3 S100\nG33 Z-3 K-1", "without a lead above zero"),
    ("F100 G93\nG38.2 X3", "with inverse time feed"),
    ("M3 S100\nG96 S30\nG33 Z-3 K1", "constant surface speed"),
    ("M3 S20000\nG33 Z-30 K4", "of axis Z, which has"),
    ("M3 S100\nG76 P1 Z-9 I-1 J.2 K1 X3", "moves along Z, not X"),
    ("M3 S100\nG76 P1 Z-9 I-1 J.2 K1 Q85", "too steep"),
    ("M3 S100\nG76 P1 Z-9 I-1 J.2 K1 L2", "without its length"),
    ("M3 S100\nG76 P1 Z-9 I-1 J.2 K1 L3 E5", "tapers are longer than the thread"),
    ("M3 S100\nG76 P1 Z-9 I-1 J.000001 K1", "too many passes"),
    ("M3 S100\nG76 P-1 Z-9 I-1 J.2 K1", "the pitch is not above zero"),
    ("G38.2 X3", "a feed move without a feed"),
    ("F100 G1 N10 X3", "the block number N stands behind"),
    ("#1=2\nG0 N10 X#1", "the block number N stands behind"),
    ("#1=2 N10", "the block number N stands behind"),
    ("F100 G38.2 X0", "to where the probe is"),
    ("G55\nG10 L2 P2 R30\nG18 G2 X3 Z1 R5 F100", "an arc outside the plane that the work offset turns"),
]


@pytest.mark.parametrize(("program", "what"), REFUSALS)
def test_what_is_refused(program: str, what: str, tmp_path: Path) -> None:
    with pytest.raises(polycnc.ProgramError, match=what):
        run(tmp_path, program)


PROBED = """[[surface]]
low = { X = 20.25, Y = -5 }
high = { X = 30, Y = 5 }
"""


def probing(tmp_path: Path, program: str) -> polycnc.Result:
    machine = tmp_path / "probe.toml"
    machine.write_text(f"{polycnc.machine.preset_text('mill3')}\n{PROBED}", encoding="utf-8")
    return run(tmp_path, program, str(machine))


def test_a_probe_tells_the_program_where_it_was_met(tmp_path: Path) -> None:
    """The contact is that of the machine, less the shift of G92; the way back ends where the probe comes free."""
    program = (
        "G92 X2\nG38.2 X40 F1200\n#1=#5061\n#2=#5070\nG38.4 X-3 F240\n#3=#5061\n"
        "G38.3 Y60 F9000\nG92.1\nG0 X#1 Y#2 Z#3\nG91 G0 Z[#5070 + 0.5]"
    )
    end = probing(tmp_path, program).end_position_mm
    assert end["X"] == pytest.approx(22.25, abs=1e-9)
    assert end["Y"] == 1.0
    assert end["Z"] == pytest.approx(22.75, abs=1e-9)


@pytest.mark.parametrize(
    ("program", "what", "line"),
    [
        ("G38.2 X17 F600\n\nG0 X1", r"G38\.2: the probe meets nothing", 2),
        ("G38.2 X17 F600", r"G38\.2: the probe meets nothing", 2),
        ("G0 X22\nG38.2 X50 F600", r"G38\.2: the probe is in contact already", 3),
        ("G0 X22\nG38.3 X50 F600\nG0 Y3", r"G38\.3: the probe is in contact already", 3),
        ("G38.4 X50 F600\nG0 Y3", r"G38\.4: the probe is free already", 2),
        ("G0 X22\nG38.4 X25 F600\nG0 Y3", r"G38\.4: the probe does not come free", 3),
    ],
)
def test_a_probe_that_fails_is_an_error_at_its_line(
    program: str, what: str, line: int, tmp_path: Path
) -> None:
    with pytest.raises(polycnc.ProgramError, match=what) as caught:
        probing(tmp_path, program)
    assert caught.value.position is not None
    assert caught.value.position.line == line


def test_a_probe_may_miss_where_the_program_says_so(tmp_path: Path) -> None:
    end = probing(tmp_path, "G38.3 X17 F600\nG0 Y[3 + #5070] Z#5061").end_position_mm
    assert (end["X"], end["Y"], end["Z"]) == (17.0, 3.0, 17.0)
    end = probing(tmp_path, "G0 X22\nG38.5 X25 F600\nG0 Y[3 + #5070]").end_position_mm
    assert (end["X"], end["Y"]) == (25.0, 3.0)


MODES = [
    # what M70 keeps comes back by M72, with the units that the feed was said in
    (
        "F300\nM70\nG20 G91 G7 F2 G64 P.01 G55\nM72\nG1 X25.4\nG1 Y[#<_feed>] Z[#<_coord_system> / 10]",
        (25.4, 300.0, 54.0),
    ),
    ("o1 sub\nM73\nG91 G20 G43.1 Z1\nG0 X1\no1 endsub\no1 call\nG0 X7 Y2 Z3", (7.0, 2.0, 3.0)),
    (
        "o1 sub\nM73\nG91\no2 if [#1 gt 0]\no1 return\no2 endif\nG90\no1 endsub\no1 call [1]\nG0 X4\nG0 X6",
        (6.0, 0.0, 0.0),
    ),
    ("G43.1 Z4\nM70\nG49\nM72\nG0 Z3\nG0 X#<_tool_offset>", (1.0, 0.0, 7.0)),
    ("M61 Q3\nG0 X#<_current_tool> Y#5400", (3.0, 3.0, 0.0)),
]


@pytest.mark.parametrize(("program", "end"), MODES)
def test_modes_that_are_kept_come_back(program: str, end: tuple[float, float, float], tmp_path: Path) -> None:
    found = run(tmp_path, program).end_position_mm
    assert tuple(found.values()) == pytest.approx(end, abs=1e-9)


def test_the_only_spindle_may_be_named(tmp_path: Path) -> None:
    programs = "M3 $0 S100\nG1 X2 F100 (5 $7)\nM5 $-1", "M3 S100\nG1 X2 F100\nM5"
    named, plain = ([(each.word, each.line) for each in run(tmp_path, text).events] for text in programs)
    assert named == plain
    assert len(named) == 3


def test_functions_have_their_words_in_their_events(tmp_path: Path) -> None:
    path = tmp_path / "part.ngc"
    path.write_text("M62 P3 G1 X2 F100\nM67 E1 Q-2.5\nX3\nM101 P4.5 Q7\nM2\n", encoding="ascii")
    words = [event.word for event in polycnc.run(path).events]
    assert [word for word in words if word[0] == "M"][:3] == ["M62 P3", "M67 E1 Q-2.5", "M101 P4.5 Q7"]


@pytest.mark.parametrize(
    ("program", "what"),
    [
        ("M72", "no modes have been kept"),
        ("M70\nM71\nM72", "no modes have been kept"),
        ("o1 sub\nM72\no1 endsub\nM70\no1 call", "no modes have been kept"),
        ("G41.1 D3\nM70\nG40\nM72", "radius compensation cannot be put in force again"),
        ("M61", "M61 without Q"),
        ("M48 M88", "M88 is not known"),
        ("M49\nM200 P1", "M200 is not known"),
        ("M62 P1 M62 P2", "is given twice"),
    ],
)
def test_what_functions_refuse(program: str, what: str, tmp_path: Path) -> None:
    with pytest.raises(polycnc.ProgramError, match=what):
        run(tmp_path, program)


REFUSED = {
    "M63": "M63 without P",
    "M65 P1.5": "P1.5 is not a number of an output",
    "M67 E2": "M67 without Q",
    "M68 Q2": "M68 without E",
    "M68 E2 Q3 P4": "'P' has no meaning",
    "M7 M8": "exclude each other",
    "G90.1 G2 X5 I4": "without J",
    "G4 P.1 G2 X3 R5": "both use P",
    "G0 G28 X3": "exclude each other",
    "G2": "an arc without words",
    "G0 X3 H2": "'H' has no meaning",
    "G43 D2": "'D' has no meaning",
    "G19 G42 D2": "in this plane",
    **{f"G41.1 D3\n{code}": "while radius" for code in ("G55", "G61", "G49", "G42", "G99", "M6", "M64 P1")},
    "G83 X1 Z-3 R4 Q2\nG73 X2 Z-3 R4": "needs a peck",
    "G82 X1 Z-3 R4": "needs a dwell",
    "G81 X1 Z-3 R4 P2": "'P' has no meaning",
    "G81 X1 Z-3 R4\nG81": "without an axis",
    "M4 S100\nG84 X1 Z-3 R4": "right-hand thread",
    "T1 M6\nG84 X1 Z-3 R4": "needs a turning spindle",
}
"""What LinuxCNC refuses, and other controls take."""


def test_what_linuxcnc_refuses_is_refused(tmp_path: Path) -> None:
    wrong = {}
    for program, what in REFUSED.items():
        with pytest.raises(polycnc.ProgramError) as caught:
            run(tmp_path, f"F900 S500 M3\n{program}")
        if what not in caught.value.what:
            wrong[program] = caught.value.what
    assert wrong == {}
