"""Turned parts from a tool path: diameters that are proven, the spindle's clamp, turning in XY."""

from __future__ import annotations

import pytest

from polycnc.errors import ProgramError
from polycnc.machine import MachineConfig, load_machine
from polycnc.post import parse_control, parse_tool_path, shipped_text
from polycnc.runner import post_file

PART = (
    "UNITS/MM\nTURRET/2\nSPINDL/RPM,900,CLW\nRAPID\nGOTO/22,0,5\nFEDRAT/0.2,MMPR\nGOTO/12.5,0,0\nGOTO/12.5,0,-9.25\n"
    "CIRCLE/16.5,0,-9.25,0,-1,0,4\nGOTO/16.5,0,-13.25\nGOTO/22,0,-13.25\nFINI\n"
)


def test_x_is_a_diameter_and_the_proof_reads_it_so() -> None:
    result = post_file(parse_tool_path(PART), "fanuc-lathe", verify=True)
    text = result.text or ""
    for block in ("G00 X44. Z5.", "G99 G01 X25. Z0. F0.2", "Z-9.25", "G02 X33. Z-13.25 I4. K0."):
        assert block in text
    assert result.ok
    assert result.verification is not None
    assert result.verification.deviation_mm < 1e-3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (", scale = 2.0 }", " }"),  # radii for a control that reads diameters
        ('dialect = "fanuc-lathe"', 'dialect = "fanuc"'),  # diameters for a control that reads radii
    ],
)
def test_radii_and_diameters_taken_for_each_other_are_found(old: str, new: str) -> None:
    shipped = shipped_text("fanuc-lathe")
    assert old in shipped
    control = parse_control(shipped.replace(old, new), "mine.toml")
    result = post_file(parse_tool_path(PART.replace("MMPR", "MMPM")), control, verify=True)
    assert not result.ok


def test_the_machine_can_be_what_reads_diameters() -> None:
    """A control file with another dialect, proven on a machine file with `diameter = true`."""
    lathe = load_machine("lathe2")
    x, z = lathe.axes
    diameters = lathe.model_copy(update={"axes": (x.model_copy(update={"diameter": True}), z)})
    assert isinstance(diameters, MachineConfig)
    text = shipped_text("fanuc-lathe").replace('dialect = "fanuc-lathe"', 'dialect = "din"')
    for old, new in (
        ("G99", "G95"),
        ("G98", "G94"),
        ('G28!" U0."', 'G28!" X0."'),
        ('G28!" W0."', 'G28!" Z0."'),
    ):
        text = text.replace(old, new)
    control = parse_control(text, "mine.toml")
    part = parse_tool_path(PART)
    assert post_file(part, control, verify=True, machine=diameters).ok
    assert not post_file(part, control, verify=True, machine=lathe).ok


def test_the_highest_speed_is_written_as_the_spindles_clamp() -> None:
    part = PART.replace("SPINDL/RPM,900,CLW", "SPINDL/SMM,180,CLW,MAXRPM,2200")
    result = post_file(parse_tool_path(part), "fanuc-lathe", verify=True)
    blocks = (result.text or "").splitlines()
    clamp = blocks.index("G50 S2200")
    assert blocks[clamp + 1] == "G96 S180 M03"
    assert result.ok
    assert result.summary.remarks == ()


def xy(text: str) -> str:
    """Return the part as NX writes it: (x, y, z) of a lathe is (z, x, y) there."""
    lines = []
    for line in text.splitlines():
        word, _, numbers = line.partition("/")
        if word in ("GOTO", "CIRCLE"):
            values = numbers.split(",")
            points = [values[n : n + 3] for n in range(0, len(values) - len(values) % 3, 3)]
            rest = values[len(points) * 3 :]
            turned = [value for x, y, z in points for value in (z, x, y)]
            line = f"{word}/{','.join([*turned, *rest])}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def test_turning_in_xy_is_the_same_part() -> None:
    control = parse_control(
        shipped_text("fanuc-lathe").replace("[nc_code]", 'turning_plane = "xy"\n\n[nc_code]', 1), "mine.toml"
    )
    result = post_file(parse_tool_path(xy(PART)), control, verify=True)
    assert result.ok
    assert result.text == post_file(parse_tool_path(PART), "fanuc-lathe").text
    # Without the plane it is another part.
    with pytest.raises(ProgramError, match="22 mm off the plane: the control file writes no Y"):
        post_file(parse_tool_path(xy(PART)), "fanuc-lathe")


def test_a_retract_to_a_level_says_nothing_there() -> None:
    control = parse_control(
        shipped_text("fanuc-lathe").replace("[nc_code]", 'turning_plane = "xy"\n\n[nc_code]', 1), "mine.toml"
    )
    with pytest.raises(ProgramError, match="a retract to a level in a turning path"):
        post_file(parse_tool_path("CLEARP/XYPLAN,50\n" + xy(PART).replace("FINI", "RETRCT\nFINI")), control)


THREADED = (
    "UNITS/MM\nTURRET/4\nSPINDL/RPM,400,CLW\nRAPID\nGOTO/13,0,6\nFEDRAT/0.25,MMPR\n"
    "PITCH/LEAD,1.75\nTHREAD/TURN\n"
    "RAPID\nGOTO/9.6,0,6\nGOTO/9.6,0,-21.5\nRAPID\nGOTO/13,0,-21.5\nRAPID\nGOTO/13,0,6\n"
    "RAPID\nGOTO/9.2,0,6\nGOTO/9.4,0,-21.5\nTHREAD/OFF\nGOTO/13,0,-23\nFINI\n"
)


def test_a_thread_is_cut_with_its_lead() -> None:
    result = post_file(parse_tool_path(THREADED), "fanuc-lathe", verify=True)
    blocks = (result.text or "").splitlines()
    first = blocks.index("G99 G32 Z-21.5 F1.75")
    assert blocks[first - 1] == "X19.2"
    assert "G32 X18.8 Z-21.5 F1.75" in blocks
    assert blocks[blocks.index("G32 X18.8 Z-21.5 F1.75") + 1] == "G01 X26. Z-23. F0.25"
    assert result.ok
    assert result.verification is not None
    run = result.verification.run
    # 27.5 mm at 1.75 mm for each turn, 400 turns a minute, twice; then a way out of 1.75 mm along Z and 3.6 along X.
    out = (1.5**2 + 3.6**2) ** 0.5
    assert run.cutting_time_s == pytest.approx(
        60.0 * (2 * 27.5 / (1.75 * 400) + out / (0.25 * 400)), rel=0.02
    )


@pytest.mark.parametrize(
    ("pitch", "lead"),
    [
        ("PITCH/TPI,8", "F3.175"),
        ("PITCH/0.0625,IPR", "F1.5875"),
        ("PITCH/2.25,MMPR", "F2.25"),
        ("FEDRAT/1.25,MMPR", "F1.25"),
    ],
)
def test_leads_are_read_as_they_are_meant(pitch: str, lead: str) -> None:
    part = THREADED.replace("PITCH/LEAD,1.75", pitch)
    result = post_file(parse_tool_path(part), "fanuc-lathe")
    assert f"G99 G32 Z-21.5 {lead}" in (result.text or "").splitlines()


def test_threads_as_creo_announces_them() -> None:
    part = THREADED.replace("THREAD/TURN", "OP / THREAD, TURN, OUT").replace("THREAD/OFF", "OP / TURN, AREA")
    posted = [post_file(parse_tool_path(each), "fanuc-lathe").text for each in (part, THREADED)]
    assert posted[0] == posted[1]


@pytest.mark.parametrize(
    ("old", "new", "what", "line"),
    [
        ("PITCH/LEAD,1.75\n", "", None, 0),
        ("PITCH/LEAD,1.75\n", "FEDRAT/90,MMPM\n", "a thread whose lead is not known", 11),
        ("PITCH/LEAD,1.75", "PITCH/1.75", "PITCH that says neither a lead nor threads per inch", 7),
        ("PITCH/LEAD,1.75", "PITCH/LEAD,-1.75", "PITCH needs a number above 0", 7),
        ("THREAD/TURN", "THREAD/AUTO,FEDTO,21.5", "leaves the passes of a thread to the control", 8),
        ("THREAD/TURN", "THREAD/HELIX", "THREAD/HELIX is not known", 8),
        ("RPM,400", "SMM,120", "a thread with constant surface speed", 11),
        ("GOTO/9.6,0,-21.5", "CIRCLE/13,0,6,0,1,0,3.4\nGOTO/13,0,2.6", "an arc within a thread", 11),
    ],
)
def test_threads_that_say_too_little_are_refused(old: str, new: str, what: str | None, line: int) -> None:
    assert old in THREADED
    part = parse_tool_path(THREADED.replace(old, new, 1), "part.cl")
    if what is None:
        assert "G32 Z-21.5 F0.25" in (post_file(part, "fanuc-lathe").text or "")
        return
    with pytest.raises(ProgramError, match=what) as caught:
        post_file(part, "fanuc-lathe")
    assert caught.value.position is not None
    assert caught.value.position.line == line


def test_a_mill_cuts_no_threads() -> None:
    with pytest.raises(ProgramError, match="no macro THREAD"):
        post_file(parse_tool_path(THREADED), "fanuc-mill")


def test_a_tool_change_ends_a_thread() -> None:
    part = THREADED.replace("THREAD/OFF", "TURRET/5\nRAPID\nGOTO/14,0,-20")
    blocks = (post_file(parse_tool_path(part), "fanuc-lathe").text or "").splitlines()
    assert "G01 X26. Z-23. F0.25" in blocks


def test_swapped_centres_and_diameters_for_them_are_found() -> None:
    text = shipped_text("fanuc-lathe").replace("$I$$K$", "$K$$I$")
    swapped = (
        text.replace('I = { format = "I%.3f"', 'I = { format = "?"')
        .replace('K = { format = "K%.3f"', 'K = { format = "I%.3f"')
        .replace('I = { format = "?"', 'I = { format = "K%.3f"')
    )
    assert post_file(parse_tool_path(PART), "fanuc-lathe", verify=True).ok
    assert not post_file(parse_tool_path(PART), parse_control(swapped, "mine.toml"), verify=True).ok
    radius = 'I = { format = "I%.3f", zeros = "point"'
    diameters = shipped_text("fanuc-lathe").replace(radius, f"{radius}, scale = 2.0")
    assert not post_file(parse_tool_path(PART), parse_control(diameters, "mine.toml"), verify=True).ok
