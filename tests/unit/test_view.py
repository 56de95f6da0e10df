"""Views: what a record is thinned to, which block is when, and what the page holds and where it may be written."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import polycnc
from polycnc.errors import UsageError
from polycnc.machine import ToolConfig
from polycnc.runner import check_view_file, view_program
from polycnc.runner.view import TrackCollector
from polycnc.runner.view._thin import kept_rows

# A rapid, a slot with a corner, an arc, a drilled hole, a dwell, another tool, a sub-program that runs twice.
PROGRAM = """G0 X3 Y2 Z5
T4 M6
G1 Z-1.5 F300
G1 X43 F1700
G1 Y22
G3 X33 Y32 I-10
G4 F0.7
T7 M6
G0 Z5
G1 X5 Y5 F900
M30
"""


def _content(html: str) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    def unpacked(name: str) -> bytes:
        found = re.search(rf'<script type="text/plain" class="data" id="{name}">([^<]*)</script>', html)
        assert found is not None
        return gzip.decompress(base64.b64decode(found[1]))

    about = json.loads(unpacked("about"))
    blob = unpacked("data")
    columns = {
        name: np.frombuffer(blob, f"<{at['type']}", at["length"], at["at"])
        for name, at in about["columns"].items()
    }
    return about, columns


def test_thinning_keeps_corners_and_drops_what_lies_between() -> None:
    time = np.arange(12.0)
    values = np.array([0, 3, 6, 9, 12, 12, 12, 12, 5, -2, -9, -16.0])[:, None]
    assert np.flatnonzero(kept_rows(time, values)).tolist() == [0, 4, 7, 11]


def test_thinning_looks_at_the_moment_and_not_only_at_the_shape() -> None:
    """On one straight line, but slower in the second half: the turn in time stays."""
    values = np.array([0, 7, 14, 21, 23, 25, 27.0])[:, None]
    assert np.flatnonzero(kept_rows(np.arange(7.0), values)).tolist() == [0, 3, 6]


def test_thinning_keeps_what_it_is_told_to() -> None:
    forced = np.zeros(9, np.bool_)
    forced[5] = True
    assert np.flatnonzero(kept_rows(np.arange(9.0), np.zeros((9, 2)), forced)).tolist() == [0, 5, 8]


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_thinning_of_very_few_rows(rows: int) -> None:
    assert kept_rows(np.arange(float(rows)), np.ones((rows, 3))).tolist() == [True] * rows


def test_every_row_of_the_record_is_met_within_the_tolerance() -> None:
    result = polycnc.run(PROGRAM, trace=True)
    trace = result.trace
    assert trace is not None
    about, columns = _content(result.view().html)
    positions = columns["position"].reshape(len(trace.axes), -1)
    assert positions.shape[1] < len(trace) / 20
    for axis, column in enumerate(positions):
        shown = np.interp(trace.t_s, columns["t_s"], column)
        assert np.max(np.abs(shown - trace.setpoint[:, axis])) < 0.0051
    assert "0.005 mm" in about["note"]
    assert columns["t_s"][-1] == trace.t_s[-1]


def test_a_streamed_view_is_the_view_of_the_trace() -> None:
    result = polycnc.run(PROGRAM, trace=True)
    assert view_program(PROGRAM).html == result.view().html


def test_blocks_tools_and_kinds() -> None:
    about, columns = _content(view_program(PROGRAM).html)
    number = columns["number"]
    lines = columns["line"][columns["block_row"][number]].tolist()
    assert lines == [1, 3, 4, 5, 6, 7, 9, 10]  # a tool change takes no time on this machine
    by_line = dict(zip(lines, number.tolist(), strict=True))
    kinds = {line: about["kinds"][columns["block_kind"][by_line[line]]] for line in (1, 4, 6, 9)}
    assert kinds == {1: "rapid", 4: "line", 6: "arc", 9: "rapid"}
    assert [int(columns["block_tool"][by_line[line]]) for line in (1, 4, 10)] == [0, 4, 7]
    trace = polycnc.run(PROGRAM, trace=True).trace
    assert trace is not None
    starts = dict(zip(lines, columns["start_s"].tolist(), strict=True))
    for line in (4, 6, 10):
        first = int(np.flatnonzero(trace.block == line)[0])
        assert starts[line] == pytest.approx(trace.t_s[first - 1])
    assert about["text"][5] == "G3 X33 Y32 I-10"
    assert [each["tool"] for each in about["tools"]] == [0, 4, 7]


def test_sub_programs_are_listed_where_they_stand(tmp_path: Path) -> None:
    (tmp_path / "main.nc").write_text("G0 X2\nM98 P0007 L2\nG1 X9 F800\nM30\n")
    (tmp_path / "O0007.nc").write_text("O0007\nG91 G1 Y3 F700\nG90\nM99\n")
    about, columns = _content(view_program(tmp_path / "main.nc", dialect="fanuc").html)
    rows = columns["block_row"][columns["number"]].tolist()
    shown = [(about["text"][row], int(columns["line"][row])) for row in rows]
    assert shown == [
        ("G0 X2", 1),
        ("G91 G1 Y3 F700", 2),
        ("G91 G1 Y3 F700", 2),
        ("G1 X9 F800", 3),
    ]
    names = [text for text, line in zip(about["text"], columns["line"].tolist(), strict=True) if not line]
    assert [Path(name).name for name in names] == ["main.nc", "O0007.nc"]


def test_alarms_and_remarks_have_their_rows() -> None:
    view = view_program("G1 X10 F500\nG1 Y5 Q\nG1 X0\n")
    assert not view.result.ok
    about, _ = _content(view.html)
    (alarm,) = about["remarks"]
    assert (alarm["kind"], alarm["line"], alarm["row"]) == ("alarm", 2, 1)
    assert alarm["time_s"] == view.result.alarms[0].time_s
    assert not about["ok"]


def test_texts_cannot_leave_their_place() -> None:
    hostile = "(</script><script>alert(1)</script>%%DATA%%)\nG1 X5 F100\n"
    about, _ = _content(view_program(polycnc.runner.program_text(hostile)).html)
    assert about["text"][0] == "(</script><script>alert(1)</script>%%DATA%%)"
    html = view_program(polycnc.nc.ProgramText.from_text(hostile, "<b>%%DATA%%")).html
    assert "<title>&lt;b&gt;%%DATA%%</title>" in html
    assert "alert(1)" not in html


def test_a_page_names_nothing_to_load() -> None:
    """Style, script and modules are in the page; the policy allows these alone, by their hashes."""
    html = view_program(PROGRAM).html
    own = re.sub(r"<!--.*?-->", "", html, flags=re.DOTALL)
    assert not re.search(r"""(?:src|href)\s*=|@import|url\(|fetch\(|XMLHttp|https?://""", own)
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', html)
    assert policy is not None
    assert "unsafe" not in policy[1]
    for tag, directive in (("script", "script-src"), ("style", "style-src")):
        (text,) = re.findall(rf"<{tag}>(.*?)</{tag}>", html, re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"{directive} 'sha256-{digest}'" in policy[1]
    assert len(html) < 1_200_000


def test_a_program_without_motion_has_a_page() -> None:
    about, columns = _content(view_program("M8\nM30\n").html)
    assert columns["t_s"].size == 0
    assert about["text"] == ["M8", "M30"]


def test_a_long_record_is_thinned_to_so_many_points() -> None:
    """A zigzag of which every corner matters, until there are too many: the tolerance grows and is told."""
    program = "F6000\n" + "".join(f"G1 X{i * 0.3:.1f} Y{0.4 * (i % 2):.1f}\n" for i in range(1, 360))
    result = polycnc.run(program, trace=True)
    assert result.trace is not None
    assert result.trace.execution is not None
    collector = TrackCollector(("mm", "mm", "mm"), most=80)
    collector.add_trace(result.trace, result.trace.execution)
    track = collector.track(result.trace.execution)
    assert len(track.t_s) <= 2 * 80 + 1
    assert track.thinned
    assert set(track.number.tolist()) <= set(result.trace.execution.number.tolist())
    assert track.tolerance_mm > 0.005
    for axis in range(3):
        shown = np.interp(result.trace.t_s, track.t_s, track.position[:, axis])
        assert np.max(np.abs(shown - result.trace.setpoint[:, axis])) <= track.tolerance_mm


def test_a_result_without_trace_has_no_view() -> None:
    with pytest.raises(UsageError, match="no trace"):
        polycnc.run("G0 X1\n").view()


def test_a_view_is_never_written_over_an_input(tmp_path: Path) -> None:
    program = tmp_path / "part.html"
    program.write_text("G0 X5\n")
    view = view_program(program)
    with pytest.raises(UsageError, match="the command reads that file"):
        view.save(program)
    (tmp_path / "linked.html").symlink_to(program)
    with pytest.raises(UsageError, match="the command reads that file"):
        view.save(tmp_path / "linked.html")
    assert program.read_text() == "G0 X5\n"
    assert view.save(tmp_path / "other.html").read_text("utf-8") == view.html


def test_by_itself_a_view_replaces_only_views(tmp_path: Path) -> None:
    page = tmp_path / "part.html"
    page.write_text("<p>mine")
    with pytest.raises(UsageError, match="no view of polycnc"):
        check_view_file(page, replaces_views_only=True)
    assert check_view_file(page) == page
    view_program("G0 X5\n").save(page)
    assert check_view_file(page, replaces_views_only=True) == page


def test_a_notebook_gets_a_frame() -> None:
    frame = view_program("G0 X5\n")._repr_html_()
    assert frame.startswith('<iframe srcdoc="&lt;!doctype html&gt;')
    assert "<script" not in frame


def test_the_work_is_shown_from_its_zero_and_in_its_units() -> None:
    """A work offset and a shift: what the page subtracts is where the program has its zero."""
    machine = polycnc.load_machine("mill3").model_copy(
        update={"offsets": {"G54": {"X": 17.0, "Y": -23.0, "Z": 5.5}}}
    )
    program = "G20 G54\nG0 X1 Y2 Z0.5\nG1 Z-0.25 F20\nX3\nG92 X0.5\nG1 X1\nM30\n"
    about, columns = _content(view_program(program, machine, "fanuc").html)
    assert about["inch"]
    assert about["zero"] == pytest.approx([17.0, -23.0, 5.5])
    zeros = columns["zero"].reshape(3, -1)
    assert zeros[:, -1] == pytest.approx([17.0 + 2.5 * 25.4, -23.0, 5.5])
    assert columns["position"].reshape(3, -1)[0, -1] - zeros[0, -1] == pytest.approx(25.4, abs=0.01)
    about, _ = _content(view_program(program, machine, "fanuc", inch=False).html)
    assert not about["inch"]


def test_a_tool_hangs_from_the_spindle_and_has_its_shape() -> None:
    tools = {3: ToolConfig(length_mm=71.0, description="ball end mill D=6.")}
    machine = polycnc.load_machine("mill3").model_copy(update={"tools": tools})
    program = "T3 M6\nG43 H3 Z40\nG1 X9 F800\nZ-2\nM30\n"
    about, columns = _content(view_program(program, machine, "fanuc").html)
    assert about["shapes"]["3"]["kind"] == "ball"
    assert about["shapes"]["3"]["hang"] == [0.0, 0.0, -71.0]
    assert about["zero"] == pytest.approx([0.0, 0.0, 0.0])
    assert columns["tip"].reshape(3, -1)[2, -1] == pytest.approx(-2.0)


def test_what_comes_after_an_alarm_is_in_the_page_without_its_time() -> None:
    """The block of the alarm is left out, the run and its times end there; a control's program is not run twice."""
    program = "G0 X5 Y7 Z2\nG1 Z-3 F600\nX41\nG2 X80 Y7 I3 J0\nG1 Y29\nG0 Z11\nM30\n"
    view = view_program(program, "mill3")
    about, columns = _content(view.html)
    assert [each["line"] for each in about["remarks"] if each["kind"] == "alarm"] == [4]
    tips = columns["rest_tip"].reshape(3, -1)
    assert tips[:, 0] == pytest.approx((41.0, 7.0, -3.0), abs=0.01)
    assert tips[:, -1] == pytest.approx((41.0, 29.0, 11.0), abs=0.01)
    assert columns["t_s"][-1] == pytest.approx(view.result.time_s, abs=0.002)
    assert "rest_tip" not in _content(view_program("G1 X9 F600\nM30\n", "mill3").html)[1]
    executed = "10 A% = 3\nN20 G1 X9 F600\nN30 G1 X#\nN40 X20\nN50 M30\n"
    assert "rest_tip" not in _content(view_program(executed, "mill3", "bosch").html)[1]
