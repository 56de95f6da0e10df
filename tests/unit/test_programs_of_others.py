"""What stands in programs as people have them, and is in no manual's example: read as their controls take it."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.machine import load_machine, preset_text
from polycnc.nc import ProgramText, choose_dialect
from polycnc.runner import RunSettings, machine_for
from support.programs import notes, prepare, refusal

# --- the axes of the machine


@pytest.mark.parametrize(
    ("program", "machine"),
    [
        ("G0 X1 Y2\n", "mill3"),
        ("G0 X1 A90\n", "mill3+A"),
        ("#100=5\nG0 A#100 C[3*2]\n", "mill3+AC"),
        ("G10 L2 P1 X1 B-3.\n", "mill3+B"),
        ("G1 X5 Y1 U4 V3 F100\n", "mill3+UV"),
        ("G1 X5 U4 F100\n", "mill3"),  # U without Y: a way on a lathe
        ("G65 P7 A1 B2 C3\nM30\nO7\nM99\n", "mill3"),
        ("G4 U1.5\nG68 X0 Y0 A0 R30\nM98 P7 A3\n", "mill3"),
        ("(A90) G0 X1 ; B5\n#1=ABS[-5]\n", "mill3"),
        ("G71 P1 Q2\nG1 X1 C1.5\n", "lathe2"),
        ("10 A%=5\nN20 G0 A10\n", "mill3"),
    ],
)
def test_a_machine_that_nobody_names_has_the_axes_of_the_program(program: str, machine: str) -> None:
    text = ProgramText.from_text(program, "part.nc")
    assert machine_for(None, choose_dialect(text).dialect, text).name == machine
    assert RunSettings("vmc3").machine_of(text).name == "vmc3"


def test_a_program_with_a_rotary_table_is_run_by_every_door(tmp_path: Path) -> None:
    program = "G0 X1 Y2\nG1 A90 F3600\nM30\n"
    (tmp_path / "part.nc").write_text(program)
    result = polycnc.run(program)
    assert (result.machine, result.ok, result.extents_mm["A"][1]) == ("mill3+A", True, 90.0)
    told = "no machine is named: it is mill3 with axis A, which the program has words for"
    assert told in [message.text for message in result.messages]
    assert told not in [message.text for message in polycnc.run(program, "mill3+A").messages]
    assert polycnc.check(program) == []
    with polycnc.batch(tmp_path, jobs=1) as batch:
        (report,) = batch
    assert (report.machine, report.errors) == ("mill3+A", [])
    (error,) = polycnc.check(program, "mill3")
    assert error.hint.endswith("or choose another machine, like mill3+A.")


def test_axes_can_be_added_to_a_preset() -> None:
    config = load_machine("lathe2+UC")
    assert config.axis_names[-2:] == ("U", "C")
    assert [axis.kind for axis in config.axes[-2:]] == ["linear", "rotary"]
    assert 'name = "mill3+A"' in preset_text("mill3+A")
    for name, wrong in (("mill5+A", "A"), ("mill3+AA", "A"), ("mill3+Q", "Q")):
        with pytest.raises(UsageError, match=f"'{wrong}' cannot be added"):
            load_machine(name)


# --- lines and words


def test_commands_to_grbl_are_noted() -> None:
    program = "; part\n$H\n$X\n?\n$32=1 ; laser\n$$\n$G\nG1 X3 F100\n$120=50\n"
    assert [note.split(": a command")[0] for note in notes(program, dialect="grbl")] == [
        *("$H", "$X", "?", "$32=1", "$$", "$G", "$120=50")
    ]
    for wrong in ("G0 X1\n$H\n", "$J=G91 X1 F100\n", "$C\n", "!\n", "G0 X1 $X\n"):
        assert "is not allowed in a block" in refusal(wrong, dialect="grbl")
    assert "'$' is not allowed" in refusal("$X\n")


@pytest.mark.parametrize(
    ("line", "end"),
    [
        ("(a (b) c)", 0.0),
        ("(a (b) G0 X7)", 0.0),  # within the outer brackets
        ("G0 X2 (a (b) c)", 2.0),
        ("(a (b) G0 X7", 7.0),  # they do not match: the first ) ends it
        ("(a) G0 X7 (b)", 7.0),
    ],
)
def test_brackets_within_a_comment(line: str, end: float) -> None:
    channel = prepare(f"{line}\nM30\n")
    assert channel.error is None
    assert channel.state.modal.position[0] == end
    told = any("brackets within a comment" in message.text for message in channel.messages.all())
    assert told == (line.count("(") == line.count(")") and "((" not in line and "(a)" not in line)
    assert "')' is not allowed" in refusal("(a (b) c)\n", dialect="fanuc")


@pytest.mark.parametrize("dialect", ["fanuc", "fanuc-lathe", "haas"])
def test_m_codes_of_the_machine_take_p(dialect: str) -> None:
    assert prepare("M11 P1\nM59P1134\nM30\n", dialect=dialect).error is None
    assert "'P' has no meaning" in refusal("M8 P1\n", dialect=dialect)
    assert "'Q' has no meaning" in refusal("M11 Q1\n", dialect=dialect)


@pytest.mark.parametrize(
    ("dwell", "seconds", "noted"),
    [
        ("P1500", 1.5, False),
        ("P100", 0.1, False),
        ("P3", 0.003, True),
        ("P3.", 3.0, False),
        ("P0.5", 0.5, False),
    ],
)
def test_a_dwell_with_a_point_counts_seconds(dwell: str, seconds: float, noted: bool) -> None:
    result = polycnc.run(f"G4 {dwell}\nM30\n", dialect="fanuc")
    assert result.time_s == pytest.approx(seconds, abs=2e-3)
    assert any("with a decimal point it counts seconds" in each.text for each in result.messages) == noted


def test_a_drilling_cycle_without_r_retracts_to_where_the_axis_stood() -> None:
    result = polycnc.run("G0 Z4.\nG81 X1. Z-3. F600.\nM30\n", dialect="haas")
    assert result.ok
    assert result.extents_mm["Z"] == (-3.0, 4.0)
    assert result.cutting_path_mm == pytest.approx(7.0, abs=1e-3)
    assert "G81 needs a retract level (R)" in refusal("G81 X1 Z-3 F600\n", dialect="linuxcnc")


def test_tools_can_be_set_where_the_machine_has_no_table(tmp_path: Path) -> None:
    assert polycnc.check("G10 L1 P3 Z2 R1\n", dialect="linuxcnc") == []
    machine = tmp_path / "m.toml"
    machine.write_text(f"{preset_text('mill3')}\n[tools.1]\nlength_mm = 50\n")
    (error,) = polycnc.check("G10 L1 P3 Z2 R1\n", str(machine), "linuxcnc")
    assert "tool 3 is not in the tool table" in error.what


def test_calls_are_left_out_as_told() -> None:
    program = "O1\nG0 X1\nG65 P9810 Z5 F100\nM98 P77\nG0 X2\nM30\n"
    errors = polycnc.check(program, dialect="fanuc")
    assert [error.what for error in errors] == ["there is no sub-program 9810", "there is no sub-program 77"]
    assert all(error.hint.endswith("--ignore M98,G65 leaves all calls out.") for error in errors)
    result = polycnc.run(program, dialect="fanuc", ignore=("M98", "G65"))
    assert result.ok
    assert result.extents_mm["X"] == (0.0, 2.0)
    assert {"G65 is left out, as told", "M98 is left out, as told"} <= {each.text for each in result.messages}


# --- circular pockets of Haas mills


@pytest.mark.parametrize(
    ("words", "cut_mm"),
    [
        ("I15. D0", 3 * math.pi * 15.0),  # half a circle out, a circle, half a circle back
        ("I15. D1", 3 * math.pi * 10.0),
        ("I3. K9. Q3. D0", math.pi * (1.5 + 3.75 + 5.25 + 6.75 + 8.25 + 18.0 + 4.5)),
        ("I3. K8. Q6. D0", math.pi * (1.5 + 4.5 + 7.0 + 16.0 + 4.0)),
    ],
)
@pytest.mark.parametrize("code", ["G12", "G13"])
def test_a_circular_pocket(code: str, words: str, cut_mm: float, tmp_path: Path) -> None:
    machine = tmp_path / "m.toml"
    machine.write_text(f"{preset_text('mill3')}\n[tools.1]\nlength_mm = 50\nradius_mm = 5\n")
    result = polycnc.run(
        f"G0 X10. Y20. Z1.\n{code} {words} Z-2. F3000.\nG0 Z9.\nM30\n", str(machine), "haas", trace=True
    )
    assert result.ok
    assert result.cutting_path_mm == pytest.approx(3.0 + cut_mm, abs=1e-3)
    assert result.trace is not None
    x, y, z = result.trace.setpoint.T
    left = next(at for at in range(1, len(x)) if z[at] == -2.0 and y[at] != 20.0)
    assert x[left] > 10.0
    assert (y[left] > 20.0) == (code == "G12")
    assert (x[-1], y[-1], z[-1]) == (10.0, 20.0, 9.0)


@pytest.mark.parametrize(
    ("words", "what"),
    [
        ("G13 K5. Q1.", "G13 without I"),
        ("G13 I0 Z-1.", "G13 with I not above the radius"),
        ("G13 I5. K10.", "G13 with one of K and Q"),
        ("G13 I5. K3. Q1.", "G13: Q does not lead from I to K"),
        ("G13 I5. K9. Q0", "G13: Q does not lead from I to K"),
        ("G13 I5. L2", "G13 with L and absolute positions"),
        ("G18 G13 I5.", "G13 in another plane"),
        ("G41 D1\nG13 I5.", "G13 while radius compensation"),
    ],
)
def test_a_circular_pocket_that_cannot_be(words: str, what: str) -> None:
    assert what in refusal(f"F100.\n{words}\n", dialect="haas")


def test_a_circular_pocket_in_layers() -> None:
    result = polycnc.run("G91 G13 X4. Z-1. I5. D0 L3 F3000.\nM30\n", dialect="haas")
    assert (result.ok, result.extents_mm["Z"]) == (True, (-3.0, 0.0))
    assert result.cutting_path_mm == pytest.approx(3 * (1.0 + 15.0 * math.pi), abs=1e-3)
