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
    for old, new in (("G99", "G95"), ("G98", "G94")):
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
    # Without the plane it is another part, which is found.
    assert not post_file(parse_tool_path(xy(PART)), "fanuc-lathe", verify=True).ok


def test_a_retract_to_a_level_says_nothing_there() -> None:
    control = parse_control(
        shipped_text("fanuc-lathe").replace("[nc_code]", 'turning_plane = "xy"\n\n[nc_code]', 1), "mine.toml"
    )
    with pytest.raises(ProgramError, match="a retract to a level in a turning path"):
        post_file(parse_tool_path("CLEARP/XYPLAN,50\n" + xy(PART).replace("FINI", "RETRCT\nFINI")), control)
