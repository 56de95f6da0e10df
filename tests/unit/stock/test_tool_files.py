"""Tools from files: tables of LinuxCNC and lists with a heading."""

from __future__ import annotations

from pathlib import Path

import pytest

import polycnc
from polycnc.errors import ConfigurationError, UsageError
from polycnc.machine import ToolConfig, load_machine
from polycnc.runner.machine_sources import with_tools

EXPORTED = """\
Number (tool_number),Type (tool_type),Diameter (tool_diameter),Corner Radius (tool_cornerRadius),\
Flute Length (tool_fluteLength),Taper Angle (tool_taperAngle),Number of Flutes (tool_numberOfFlutes),\
Unit (tool_unit),Description (tool_description),Vendor
1,flat end mill,6,0,20,0,2,millimeters,"6 mm, two flutes",A
2,bull nose end mill,0.5,0.0625,1,0,4,inches,half inch,A
3,drill,5,,30,,,millimeters,,A

4,tapered mill,3,,,7.5,,millimeters,,A
5,ball end mill,8,4,,,,millimeters,,A
6,slot mill,16,,,,,millimeters,T-slot,A
7,bull nose end mill,10,0,,,,millimeters,,A
"""


def _tools(folder: Path, name: str, text: str, prefix: str = "") -> dict[int, ToolConfig]:
    (folder / name).write_text(text, encoding="utf-8")
    return with_tools(load_machine("mill3"), f"{prefix}{folder / name}").tools


def test_a_list_as_it_is_exported(tmp_path: Path) -> None:
    found = _tools(tmp_path, "list.csv", EXPORTED)
    assert found == {
        1: ToolConfig(
            radius_mm=3.0, shape="flat", flute_mm=20.0, teeth=2, description="flat end mill 6 mm, two flutes"
        ),
        2: ToolConfig(
            radius_mm=6.35, shape="bull", corner_mm=1.5875, flute_mm=25.4, teeth=4,
            description="bull nose end mill half inch",
        ),
        3: ToolConfig(radius_mm=2.5, shape="drill", angle_deg=118.0, flute_mm=30.0, description="drill"),
        4: ToolConfig(radius_mm=1.5, shape="taper", angle_deg=7.5, description="tapered mill"),
        5: ToolConfig(radius_mm=4.0, shape="ball", corner_mm=4.0, description="ball end mill"),
        6: ToolConfig(radius_mm=8.0, description="slot mill T-slot"),
        7: ToolConfig(radius_mm=5.0, shape="flat", description="bull nose end mill"),
    }  # fmt: skip


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_units_of_headings_and_other_marks_between_columns(tmp_path: Path, mark: str) -> None:
    rows = [["tool", "dia (in)", "length_mm", "kind"], ["12", "0,5" if mark == ";" else "0.5", "-3", "flat"]]
    found = _tools(tmp_path, "list.csv", "\n".join(mark.join(row) for row in rows))
    assert found == {12: ToolConfig(radius_mm=6.35, length_mm=-3.0, shape="flat", description="flat")}


def test_a_table_of_linuxcnc(tmp_path: Path) -> None:
    table = "; tools\nT1 P1 Z2.5 D0.25 ;1/4 end mill\nT2 D-1 Q3\n"
    found = _tools(tmp_path, "tool.tbl", table, "inch=")
    assert found == {
        1: ToolConfig(length_mm=63.5, radius_mm=3.175, description="1/4 end mill"),
        2: ToolConfig(radius_mm=12.7, wear_radius_mm=-25.4, tip=2),
    }


@pytest.mark.parametrize(
    ("name", "text", "place", "says"),
    [
        ("a.csv", "diameter,shape\n5,flat\n", ":1:1", "no column has the numbers of the tools"),
        ("a.csv", "number,diameter\n1,5\n\n1,6\n", ":4:1", "tool 1 stands twice"),
        ("a.csv", "number,diameter\n,5\n", ":2:1", "the number of a tool is missing"),
        ("a.csv", "number,diameter\n1.5,5\n", ":2:1", "the number of a tool is missing"),
        ("a.csv", "number,diameter\n1,five\n", ":2:1", "'five' is no diameter of a tool"),
        ("a.csv", "number,diameter\n1,1e9\n", ":2:1", "'1e9' is no diameter of a tool"),
        ("a.csv", "number,diameter\n1,-5\n", ":2:1", "'-5' is no diameter of a tool"),
        ("a.csv", "number,diameter\n1,nan\n", ":2:1", "'nan' is no diameter of a tool"),
        ("a.csv", "number,teeth\n1,900\n", ":2:1", "'900' is no teeth of a tool"),
        ("a.csv", 'number,diameter\n1,"5\n', ":2:1", "this is no row of a list"),
        ("a.csv", "", "", "no column has the numbers of the tools"),
        ("a.tbl", "T1 D\n", ":1:1", "this is no tool"),
        ("a.tbl", "D5\n", ":1:1", "T of a tool is a whole number"),
        ("a.csv", "number\ninf\n", ":2:1", "the number of a tool is missing"),
        ("a.csv", "number,angle\n1,200\n", ":2:1", "'200' is no angle of a tool"),
        ("a.txt", "", "", "is no list of tools"),
        ("gone.csv", None, "", "cannot read"),
    ],
)
def test_a_wrong_list_is_refused_at_its_place(
    tmp_path: Path, name: str, text: str | None, place: str, says: str
) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises((ConfigurationError, UsageError)) as caught:
        with_tools(load_machine("mill3"), tmp_path / name)
    assert f"{name}{place}" in str(caught.value)
    assert says in str(caught.value)


def test_the_tools_of_a_list_cut(tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text("number,shape,diameter\n1,flat,6\n")
    program = "G0 X0 Y0 Z10\nT1 M6\nS1000 M3\nG1 Z-2 F3000\nG1 X10\nG0 Z10\nM30\n"
    result = polycnc.run(program, stock="box=-5,-5,-4,15,5,0", tools=tmp_path / "list.csv")
    assert result.removed_mm3 == pytest.approx(2.0 * (60.0 + 9.0 * 3.14159), rel=2e-3)
