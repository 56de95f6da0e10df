"""What a view shows besides the path: the frame of the part, speed to jerk of every axis, operations."""

from __future__ import annotations

import base64
import gzip
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import polycnc
from polycnc.machine import MachineConfig, ToolConfig
from polycnc.runner import view_program
from polycnc.runner.view._motion import MOST_STRETCHES, MotionCollector
from polycnc.runner.view._part_frame import on_part

CENTERS = {"A": (11.0, -7.0, 23.0), "C": (-3.0, 5.0, 41.0)}


def _machine(**centers: tuple[float, float, float]) -> MachineConfig:
    machine = polycnc.load_machine("mill5")
    axes = tuple(
        axis.model_copy(update={"center_mm": centers[axis.name]}) if axis.name in centers else axis
        for axis in machine.axes
    )
    return machine.model_copy(update={"axes": axes})


def test_the_part_sees_the_tool_turned_about_both_tables() -> None:
    """Against scipy: what stands at q on the part is brought under the tool by -A about X, on it -C about Z."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    machine = _machine(**CENTERS)
    positions = np.array([[30.0, -17.0, 55.0, -35.0, 130.0], [4.0, 9.0, -8.0, 61.0, -755.0]])
    found = on_part(positions, machine)
    for position, place in zip(positions, found, strict=True):
        x, y, z, a, c = position
        tilt, turn = rotation.from_euler("x", -a, degrees=True), rotation.from_euler("z", -c, degrees=True)
        first, second = np.array(CENTERS["A"]), np.array(CENTERS["C"])
        on_table = turn.apply(place - second) + second
        assert tilt.apply(on_table - first) + first == pytest.approx((x, y, z), abs=1e-9)


def _with_head() -> MachineConfig:
    """Return a mill with a turning and tilting head: B hangs on C, 130 mm above the nose; tool 6 is 74 mm long."""
    machine = polycnc.load_machine("mill5")
    x, y, z, a, c = machine.axes
    turn = c.model_copy(update={"carries": "tool", "center_mm": (3.0, -2.0, 0.0)})
    tilt = a.model_copy(update={"name": "B", "carries": "tool", "center_mm": (5.0, 0.0, 130.0)})
    tools = {6: ToolConfig(length_mm=71.0, wear_length_mm=3.0)}
    return machine.model_copy(update={"axes": (x, y, z, turn, tilt), "tools": tools})


def test_a_head_swings_the_tip_of_the_tool() -> None:
    """Against scipy: the tip hangs below the nose; B turns it about its own line, C both of them."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    positions = np.array([[30.0, -17.0, 255.0, 130.0, -35.0], [4.0, 9.0, 208.0, -75.0, 61.0]])
    found = on_part(positions, _with_head(), np.array([6, 2]))
    for (x, y, z, c, b), length, place in zip(positions, (74.0, 0.0), found, strict=True):
        tilt, turn = rotation.from_euler("y", b, degrees=True), rotation.from_euler("z", c, degrees=True)
        tip = tilt.apply(np.array([0.0, 0.0, -length]) - (5.0, 0.0, 130.0)) + (5.0, 0.0, 130.0)
        tip = turn.apply(tip - (3.0, -2.0, 0.0)) + (3.0, -2.0, 0.0)
        assert place == pytest.approx((x, y, z) + tip, abs=1e-9)


def test_a_table_and_a_head_along_any_direction() -> None:
    """Against scipy: a head that nutates about a slant line, over a table that turns."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    machine = _with_head()
    x, y, z, turn, tilt = machine.axes
    table = turn.model_copy(update={"carries": "part", "center_mm": (11.0, -7.0, 23.0)})
    slant = tilt.model_copy(update={"direction": (0.0, 3.0, 4.0)})
    machine = machine.model_copy(update={"axes": (x, y, z, table, slant)})
    (place,) = on_part(np.array([[30.0, -17.0, 255.0, 130.0, -35.0]]), machine, np.array([6]))
    swing = rotation.from_rotvec(np.radians(-35.0) * np.array([0.0, 0.6, 0.8]))
    tip = swing.apply(np.array([-5.0, 0.0, -204.0])) + (35.0, -17.0, 385.0)
    back = rotation.from_euler("z", 130.0, degrees=True)
    assert place == pytest.approx(back.apply(tip - (11.0, -7.0, 23.0)) + (11.0, -7.0, 23.0), abs=1e-9)


def test_a_view_of_a_head_follows_the_tip() -> None:
    """The nose goes round in a quarter of a circle while the tip of a tool stays where it is, and then goes on."""
    machine = _with_head()
    *linear, turn, tilt = machine.axes
    tilt = tilt.model_copy(update={"center_mm": (0.0, 0.0, 130.0)})
    turn = turn.model_copy(update={"center_mm": (0.0, 0.0, 0.0)})
    machine = machine.model_copy(update={"axes": (*linear, turn, tilt)})
    lines = ["T6 M6", "G1 Z74 F9000"]
    for degree in range(1, 61):
        b = np.radians(degree)
        lines.append(f"X{204.0 * np.sin(b):.4f} Z{204.0 * np.cos(b) - 130.0:.4f} B{degree}")
    about, columns = _content(view_program("\n".join([*lines, "M30", ""]), machine).html)
    points = columns["position"].reshape(len(about["axes"]), -1)
    still = points[4] > 0.0
    assert np.ptp(points[0][still]) > 170.0
    assert (
        np.abs(columns["tip"].reshape(3, -1)[:, still]).max() < 0.15
    )  # the corners between the blocks are rounded by no more


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ('carries = "tool"\ndirection = [0, 0, 0]', "'direction' has no length"),
        ('carries = "tool"', "nothing says what axis U turns about"),
    ],
)
def test_a_machine_file_says_what_an_axis_turns_about(tmp_path: Path, change: str, text: str) -> None:
    axis = f'[[axis]]\nname = "U"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 700\n{change}\n'
    file = tmp_path / "head.toml"
    file.write_text(f'name = "head"\n[[axis]]\nname = "X"\nvmax_mm_s = 300\namax_mm_s2 = 3000\n{axis}')
    with pytest.raises(polycnc.ConfigurationError, match=text):
        polycnc.load_machine(file)
    file.write_text(file.read_text().replace(change, 'carries = "tool"\ndirection = [0, 3, 4]'))
    assert polycnc.load_machine(file).axis_names == ("X", "U")


def test_at_zero_the_part_lies_as_the_machine_does() -> None:
    position = np.array([[30.0, -17.0, 55.0, 0.0, 0.0]])
    assert on_part(position, _machine(**CENTERS)) == pytest.approx(position[:, :3], abs=1e-12)


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


def test_a_turn_of_the_table_is_a_circle_on_the_part() -> None:
    about, columns = _content(view_program("G0 X40 Z9\nG91 G1 C350 F7200\nM30\n", "mill5").html)
    assert [each["carries"] for each in about["chain"]] == ["part", "part"]
    own, on_part = (columns[name].reshape(rows, -1) for name, rows in (("position", 5), ("tip", 3)))
    points = np.vstack((own, on_part))
    turning = points[4] > 0.0
    radius = np.hypot(points[5], points[6])[turning]
    assert radius == pytest.approx(np.full(len(radius), 40.0), abs=1e-3)
    angle = np.degrees(np.unwrap(np.arctan2(points[6], points[5])))[turning]
    assert angle[-1] == pytest.approx(350.0, abs=1e-3)
    assert np.max(np.diff(angle)) <= 3.001
    assert points[2][turning] == pytest.approx(points[7][turning])
    assert np.all(np.diff(columns["t_s"]) > 0.0)


def test_a_machine_without_tables_has_no_such_frame() -> None:
    about, _ = _content(view_program("G1 X40 F900\nM30\n", "mill3").html)
    assert (about["chain"], about["tips"]) == ([], [0, 1, 2])


def test_derivatives_are_those_of_the_record() -> None:
    result = polycnc.run("G0 X30\nG1 Y25 F3000\nG4 X0.3\nG2 X60 Y25 I15 F2400\nM30\n", "mill3", trace=True)
    trace = result.trace
    collector = MotionCollector(3)
    for first in range(0, len(trace), 1000):
        collector.add(trace.t_s[first : first + 1000], trace.setpoint[first : first + 1000])
    motion = collector.motion()
    assert motion.low.shape == motion.high.shape == (len(trace), 3, 3)
    assert motion.stretch_s == pytest.approx(0.001)
    speed = np.gradient(trace.setpoint, trace.t_s, axis=0)
    middle = 0.5 * (motion.high[1:, 0] + motion.high[:-1, 0])
    assert middle[1:-1] == pytest.approx(speed[1:-2], abs=1e-9)
    limits = [axis.amax for axis in polycnc.load_machine("mill3").axes]
    peaks = np.max(np.abs(motion.high[:, 1]), axis=0)
    assert np.all(peaks[:2] > 0.5 * np.array(limits[:2]))
    assert np.all(peaks <= np.array(limits) * (1.0 + 1e-6))


@pytest.mark.parametrize("rows", [5 * MOST_STRETCHES, 8 * MOST_STRETCHES + 3, 70_001])
def test_long_records_keep_their_lowest_and_highest(rows: int) -> None:
    """One jolt anywhere stays visible, at its time, however long the record is."""
    t_s = np.linspace(0.002, rows * 0.002, rows, dtype=np.float64)
    position = np.sin(t_s * 0.3)[:, None] * (1.0, 2.0)
    jolt = rows * 2 // 3
    position[jolt:, 1] += 0.5
    collector = MotionCollector(2)
    for first in range(0, rows, 3_777):
        collector.add(t_s[first : first + 3_777], position[first : first + 3_777])
    motion = collector.motion()
    assert len(motion.low) <= 2 * MOST_STRETCHES + 1
    assert len(motion.low) * motion.stretch_s >= t_s[-1] - 1e-9
    found = int(np.argmax(motion.high[:, 0, 1]))
    assert motion.high[found, 0, 1] == pytest.approx(0.5 / 0.002, rel=0.02)
    assert found * motion.stretch_s <= t_s[jolt] <= (found + 1) * motion.stretch_s + 0.002
    assert np.max(motion.high[:, 0, 0]) == pytest.approx(0.3, rel=0.01)


def test_operations_have_their_lines() -> None:
    program = "(rough)\nT4 M6\nG1 X30 F900\n(finish)\nT7 M6\nX5\nM30\n"
    about, columns = _content(view_program(program, "mill3").html)
    assert [(each["name"], each["tool"]) for each in about["operations"]] == [("rough", 4), ("finish", 7)]
    assert [int(columns["line"][each["row"]]) for each in about["operations"]] == [2, 5]


def test_a_notebook_shows_a_small_picture_of_a_traced_result() -> None:
    program = "G0 X10 Y5\nG1 X70 F2400\nY45\nM30\n"
    traced, plain = polycnc.run(program, trace=True)._repr_html_(), polycnc.run(program)._repr_html_()
    assert traced.startswith(plain.removesuffix("</svg>"))
    (cuts,) = re.findall(r'<path d="([^"]+)"[^>]*stroke="#0072b2"', traced)
    # 60 x 40 mm fill the box of 96 x 64 but for its edge: one line to the right, one up.
    assert cuts == "M4.5 61.0L91.5 61.0L91.5 3.0"
    assert "<svg" not in plain


def test_a_small_picture_tells_tools_and_ends_apart_and_shows_the_part() -> None:
    program = "T3 M6\nG0 X10 Y5\nG1 X70 F2400\nT8 M6\nY45\nM30\n"
    shown = polycnc.run(program, trace=True)._repr_html_()
    strokes = re.findall(r'stroke="([^"]+)"[^>]*><title>(T\d)</title>', shown)
    assert strokes == [("#0072b2", "T3"), ("#d55e00", "T8")]
    assert [re.search(rf"<title>{end}</title>", shown) is not None for end in ("start", "end")] == [
        True,
        True,
    ]
    turned = polycnc.run("G0 X40\nG91 G1 C360 F7200\nM30\n", "mill5", trace=True)._repr_html_()
    (cuts,) = re.findall(r'<path d="([^"]+)"[^>]*stroke="#0072b2"', turned)
    ends = np.array(re.findall(r"[ML]([-\d.]+) ([-\d.]+)", cuts), float)
    assert np.hypot(*(ends - (48.0, 32.0)).T) == pytest.approx(np.full(len(ends), 29.0), abs=0.2)


def test_a_lathe_s_small_picture_has_the_axis_of_its_spindle() -> None:
    shown = polycnc.run("G0 X20 Z-5\nG1 Z-40 F500\nM30\n", "lathe2", trace=True)._repr_html_()
    (height,) = re.findall(r'<path d="M0 ([\d.]+)H96"', shown)
    (cuts,) = re.findall(r'<path d="M[-\d.]+ ([-\d.]+)L[^"]*"[^>]*stroke="#0072b2"', shown)
    assert float(height) > float(cuts) + 20.0
