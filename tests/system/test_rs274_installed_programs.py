"""The programs that LinuxCNC installs: where polycnc and `rs274` both take one, the path has the same end points."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ProgramText, language_for, load_dialect
from support import rs274
from support.canonical import Feed, Point, Step, Traverse, Turn, queued_steps
from support.random_programs import tool_table

FOLDER = Path("/usr/share/linuxcnc/ncfiles")
NAMES = sorted(path.name for path in FOLDER.glob("*.ngc") if "3D_Chips" not in path.name)
TOLERANCE_MM = 0.01  # rs274 prints four decimals of an inch, of points and of each shift
FILLS = 400

pytestmark = [
    pytest.mark.skipif(rs274.COMMAND is None, reason="rs274 (LinuxCNC) is not installed"),
    pytest.mark.skipif(not NAMES, reason=f"the programs of LinuxCNC are not in {FOLDER}"),
]


def _config() -> MachineConfig:
    axes = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 500\namax_mm_s2 = 2000\n' for name in "XYZ")
    axes += "".join(
        f'[[axis]]\nname = "{name}"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900\n' for name in "ABC"
    )
    return validate(MachineConfig, *parse_toml(f'name = "endless"\n{axes}', "endless.toml"))


CONFIG = _config()
DIALECT = load_dialect("linuxcnc")

REFUSED: dict[str, str] = {
    "tool-length-probe": "G38.2 to where the probe is",  # it begins where the operator has moved to
    "cone": "there is no axis 'W'",
    "nestedcall": "'u' is no function",  # an O-word `callsub`, which rs274 refuses too
}
"""Programs that polycnc refuses, with what its error says."""
REFUSED_BY_RS274 = {"increment", "probe-hole"}
"""Programs that polycnc takes and rs274 does not."""
OTHER_WAYS = {
    "lathe_g70_71_demo": "G70 begins its compensated passes in another way",
    "systems": "rs274 does not print where splines (G5.1) end",
    **dict.fromkeys(("gridprobe", "smartprobe", "x-trim"), "polycnc waits for the probe, rs274 has none"),
}
"""Programs that both take and that cannot be compared, and why."""


def copies(folder: Path) -> None:
    """Copy all programs, as they are but for rounded corners: with G61 paths go through their end points."""
    for path in FOLDER.glob("*.ngc"):
        if path.name in NAMES:
            text = path.read_text("utf-8", errors="replace").encode("ascii", "replace").decode()
            text = re.sub(r"\bG64([ \t]*[PQ][ \t]*[0-9.]+)*", "G61", text, flags=re.IGNORECASE)
            (folder / path.name).write_text(text, encoding="ascii")
    (folder / "tools.tbl").write_text(tool_table(), encoding="ascii")


def with_exact_path(program: str) -> str:
    """Return a program that begins with G61."""
    return "G61\n" + program if not program.lstrip().startswith("%") else program.replace("%", "%\nG61", 1)


def prepare(file: Path) -> tuple[list[Step], ProgramError | None, bool]:
    """Return what polycnc queues for a program, what it refuses, and whether that is all (the queue may be full)."""
    machine = Machine(CONFIG, segments=1 << 16)
    channel = Channel(ProgramText.from_path(file), DIALECT, machine, language=language_for(DIALECT))
    give_to_path(machine.state, channel.path)
    for _ in range(FILLS):
        channel.fill()
        if channel.done:
            break
    return ([] if channel.error else queued_steps(machine, channel)), channel.error, channel.done


def end_points(steps: list[Step]) -> list[Point]:
    """Return where moves end, each place once."""
    points: list[Point] = [(0.0,) * 6]
    for step in steps:
        if isinstance(step, Traverse | Feed | Turn) and math.dist(step.end, points[-1]) > TOLERANCE_MM / 50.0:
            points.append(step.end)
    return points


@pytest.mark.parametrize("name", NAMES)
def test_an_installed_program_has_the_same_end_points(name: str, tmp_path: Path) -> None:
    copies(tmp_path)
    program = with_exact_path((tmp_path / name).read_text("ascii"))
    file = tmp_path / name
    file.write_text(program, encoding="ascii")
    ours, error, done = prepare(file)
    if (refused := REFUSED.get(file.stem)) is not None:
        assert error is not None
        assert refused in error.what
        return
    assert error is None
    theirs = rs274.interpret(program, tmp_path, tools=tool_table(20))
    assert bool(theirs.error) == (file.stem in REFUSED_BY_RS274)
    if theirs.error or file.stem in OTHER_WAYS:
        return
    here, there = end_points(ours), end_points(rs274.canonical_steps(theirs, 6, scale=1))
    for number, (own, other) in enumerate(zip(here, there, strict=False)):
        assert math.dist(own, other) <= TOLERANCE_MM, f"end point {number}: {own}, in rs274 {other}"
    assert len(here) == len(there) or (not done and here)


def test_the_number_of_a_line_is_that_of_rs274(tmp_path: Path) -> None:
    program = (
        "\nG0 X#<_line>\nO<a> SUB\nG0 Z[#<_line>+1]\nO<a> ENDSUB\nO<a> CALL\n"
        "O1 REPEAT [2]\nG91 G0 Y#<_line>\nO1 ENDREPEAT\nM2\n"
    )
    file = tmp_path / "lines.ngc"
    (tmp_path / "tools.tbl").write_text(tool_table(), encoding="ascii")
    file.write_text(program, encoding="ascii")
    ours, error, done = prepare(file)
    assert error is None
    assert done
    theirs = rs274.canonical_steps(rs274.interpret(program, tmp_path), 6, scale=1)
    assert end_points(ours) == end_points(theirs)
    assert end_points(ours)[-1][:3] == (2.0, 16.0, 5.0)
