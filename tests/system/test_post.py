"""``polycnc post`` as users meet it: the example parts on every control, files, errors, long tool paths."""

from __future__ import annotations

import json
import math
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from polycnc.cli._app import app
from polycnc.post import CONTROLS, NO_DIALECT, load_control, parse_tool_path, shipped_text
from polycnc.post.tool_path._cl_words import HANDLERS
from polycnc.post.tool_path._json_path import DOINGS
from polycnc.runner import post_file
from support.command import COMMAND, environment, polycnc
from support.pages import REPOSITORY

EXAMPLES = REPOSITORY / "examples"
# Every control file with its own example part, and the milled parts on every mill.
PARTS = {
    "fanuc-mill": ("mount_plate.cl", "cover.cl", "badge.json"),
    "bosch-pnc": ("cover.cl", "mount_plate.cl", "badge.json"),
    "bosch-pnc-cpl": ("mount_plate.cl",),
    "din": ("badge.json", "cover.cl", "mount_plate.cl"),
    "fanuc-lathe": ("pin.cl",),
    "fanuc-5axis": ("ring.cl", "cover.cl"),
    "grbl": ("cover.cl", "mount_plate.cl"),
    "haas-mill": ("cover.cl", "mount_plate.cl"),
    "linuxcnc-mill": ("cover.cl", "mount_plate.cl"),
}
CASES = [(control, part) for control, parts in PARTS.items() for part in parts]


def test_every_control_file_has_an_example() -> None:
    read = {name for name in CONTROLS if load_control(name).parameters.dialect != NO_DIALECT}
    assert set(PARTS) == read  # others: test_post_foreign_controls
    assert {part for _, part in CASES} == {p.name for p in EXAMPLES.iterdir() if p.suffix in (".cl", ".json")}


@pytest.mark.parametrize(("control", "part"), CASES)
def test_an_example_part_is_cut_as_meant(control: str, part: str, tmp_path: Path) -> None:
    output = tmp_path / f"part{load_control(control).parameters.extension}"
    result = post_file(EXAMPLES / part, control, output, verify=True)
    proof = result.verification
    assert proof is not None
    assert proof.run.alarms == []
    assert proof.deviation_mm <= 1e-3
    assert proof.rapid_cuts == 0
    assert result.ok
    assert result.summary.remarks == ()
    assert (
        proof.detour_mm < 1e-6 or part == "badge.json" or control not in ("bosch-pnc", "din", "fanuc-lathe")
    )
    assert proof.path_feed_mm == pytest.approx(result.summary.feed_mm, rel=0.05)  # pecks by moves go farther
    assert 10.0 < proof.run.time_s < 200.0
    assert list(tmp_path.iterdir()) == [output]


def test_fanuc_mill_goes_home_before_a_tool_change_and_comes_in_x_and_y_first() -> None:
    text = "LOADTL/{0}\nSPINDL/RPM,900\nRAPID\nGOTO/7,{0},30\nRAPID\nGOTO/7,{0},2\nFEDRAT/90\nGOTO/7,{0},-1\n"
    drill = "LOADTL/9\nCYCLE/DRILL,DEPTH,6,CLEAR,3\nGOTO/7,11,0\nCYCLE/OFF\nRAPID\nGOTO/7,11,40\n"
    path = parse_tool_path(text.format(4) + text.format(5) + drill)
    blocks = (post_file(path, "fanuc-mill").text or "").splitlines()
    change = ["M05", "G91 G28 Z0.", "G90 G49"]
    first, second, third = (
        blocks.index(f"N{number} T0{tool} M06") for number, tool in ((10, 4), (20, 5), (30, 9))
    )
    for place in (first, second, third):
        assert blocks[place - 3 : place] == change
    assert blocks[second + 1 : second + 5] == ["S900 M03", "G00 X7. Y5.", "G43 H05 Z30.", "Z2."]
    assert blocks[third + 2 : third + 5] == ["G00 X7. Y11.", "G43 H09 Z3.", "G99 G81 X7. Y11. Z-6. R3. F90."]
    assert [block for block in blocks if block.startswith("G00") and "Z" in block] == ["G00 X7. Y11. Z40."]


def test_post_prints_the_program_and_tells_the_rest_beside(tmp_path: Path) -> None:
    (tmp_path / "a.cl").write_text("PARTNO A\nLOADTL/1\nFOO\nRAPID\nGOTO/1,2,3\nFINI\n")
    done = polycnc("post", "a.cl", "-c", "din", cwd=tmp_path)
    assert done.stdout.splitlines()[:2] == ["%", "N10 (A)"]
    assert "G0 X1.000 Y2.000\nN80 Z3.000\n" in done.stdout
    told = done.stderr.splitlines()
    assert told[0] == "tool path  a.cl"
    assert told[1].split() == ["6", "records,", "1", "tool,", "0", "arcs,", "0", "holes"]
    assert "remark     line 3: FOO is not known and was left out" in told
    assert list(tmp_path.iterdir()) == [tmp_path / "a.cl"]


def test_post_json(tmp_path: Path) -> None:
    output = tmp_path / "pin.tap"
    done = polycnc("post", EXAMPLES / "pin.cl", "-c", "fanuc-lathe", "-o", output, "--verify", "--json")
    report = json.loads(done.stdout)
    assert (report["arcs"], report["tools"], report["holes"]) == (2, 2, 0)
    assert report["verification"]["ok"] is True
    assert report["verification"]["deviation_mm"] <= 1e-3
    assert report["blocks"] == len(output.read_text().splitlines())


def test_a_deviation_is_status_1_and_the_program_stays_to_look_at(tmp_path: Path) -> None:
    # A control file that writes Z a little too long.
    output, control = tmp_path / "cover.tap", tmp_path / "mine.toml"
    shipped = shipped_text("fanuc-mill")
    wrong = shipped.replace('Z = { format = "Z%.3f"', 'Z = { scale = 1.002, format = "Z%.3f"')
    assert wrong != shipped
    control.write_text(wrong)
    done = polycnc("post", EXAMPLES / "cover.cl", "-c", control, "-o", output, "--verify", status=1)
    assert "deviates: more than 0.00125 mm" in done.stdout
    assert output.exists()


@pytest.mark.parametrize(
    ("arguments", "status", "said"),
    [
        (("part.cl",), 2, "no control file"),
        (("part.cl", "-c", "fanuc"), 2, "there is no control file 'fanuc'"),
        (("nothing.cl", "-c", "din"), 2, "no such file: nothing.cl"),
        (("-c", "din"), 2, "no tool path"),
        (("part.cl", "-c", "din", "--json"), 2, "--json needs --output"),
        (("part.cl", "-c", "din", "-o", "no/such/folder.nc"), 2, "no/such/folder.nc"),
        (("part.cl", "-c", "din", "--verify", "--machine", "none"), 2, "there is no machine 'none'"),
        (("part.cl", "-c", "din", "--arc-axis", "left"), 2, "'left' is no sense of rotation"),
        (("part.json", "-c", "din", "--arc-axis", "clockwise"), 2, "is for a file in APT words"),
        (("part.cl", "-c", "bad.toml", "-o", "part.nc"), 2, "bad.toml:2:"),
        (("bad.cl", "-c", "din", "-o", "part.nc"), 1, "bad.cl:2:8: 'X' is no number"),
    ],
)
def test_errors_leave_nothing_behind(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], status: int, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "part.cl").write_text("RAPID\nGOTO/1,2,3\n")
    (tmp_path / "bad.cl").write_text("RAPID\nLOADTL/X\n")
    (tmp_path / "bad.toml").write_text("[nc_macros]\nRAPID = '!G00!'\n")
    before = sorted(tmp_path.iterdir())
    done = CliRunner().invoke(app, ["post", *arguments])
    assert (done.exit_code, done.stdout) == (status, "")
    assert said in done.stderr
    assert sorted(tmp_path.iterdir()) == before


def test_show_control_is_a_control_file_that_works(tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text(polycnc("post", "-c", "din", "--show-control").stdout)
    again = post_file(EXAMPLES / "badge.json", tmp_path / "mine.toml").text
    assert again == post_file(EXAMPLES / "badge.json", "din").text


def points(count: int) -> str:
    """Return a tool path of many points on a spiral."""
    lines = ["PARTNO LONG", "LOADTL/1", "RAPID", "GOTO/0,0,10", "FEDRAT/2000,MMPM"]
    lines += [
        f"GOTO/{50 * math.cos(0.001 * i):.4f},{50 * math.sin(0.001 * i):.4f},{-1e-5 * i:.4f}"
        for i in range(count)
    ]
    return "\n".join([*lines, "FINI", ""])


_MEASURE = """
import resource, sys
from polycnc.post import load_control, open_tool_path, post_program
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
path, control = open_tool_path(sys.argv[1]), load_control("fanuc-mill")
with open(sys.argv[2], "w") as out:
    blocks = post_program(path, control, out.write).blocks
print(blocks, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def test_memory_does_not_grow_with_the_tool_path(tmp_path: Path) -> None:
    """Post 20,000 and 80,000 points: the longer one needs no more than the buffers of both."""
    grown = {}
    for count in (20_000, 80_000):
        (tmp_path / "long.cl").write_text(points(count))
        done = subprocess.run(
            [sys.executable, "-c", _MEASURE, tmp_path / "long.cl", tmp_path / "long.tap"],
            env=environment(),
            capture_output=True,
            text=True,
            timeout=120,
            check=True,
        )
        blocks, grown[count] = map(int, done.stdout.split())
        assert count < blocks < count + 20
    assert grown[80_000] - grown[20_000] < 1_500  # KB; the file itself has 2,100


@pytest.mark.skipif(not hasattr(signal, "SIGTERM"), reason="needs signals")
def test_a_run_that_is_ended_leaves_no_program(tmp_path: Path) -> None:
    (tmp_path / "long.cl").write_text(points(300_000))
    process = subprocess.Popen(
        [*COMMAND, "post", "long.cl", "-c", "din", "-o", "long.nc"],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    deadline = time.monotonic() + 60.0
    while len(list(tmp_path.iterdir())) < 2 and time.monotonic() < deadline:
        time.sleep(0.01)
    assert len(list(tmp_path.iterdir())) == 2  # the partial file
    process.terminate()
    process.communicate(timeout=60)
    assert process.returncode == 128 + signal.SIGTERM
    assert [path.name for path in tmp_path.iterdir()] == ["long.cl"]


def test_the_pages_name_every_statement_and_every_key() -> None:
    text = (REPOSITORY / "docs" / "reference" / "post-tool-paths.md").read_text(encoding="utf-8")
    named = {"TOOLPATH": "TOOL PATH", "LOAD": "LOAD/TOOL", "TLON,GOFWD": "TLON,GOFWD"}
    assert [word for word in HANDLERS if named.get(word, word) not in text] == []
    keys = {key for model in DOINGS for key in model.model_fields if key != "do"}
    assert [key for key in keys if f"`{key}`" not in text] == []
