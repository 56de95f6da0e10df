"""The page of `polycnc view` in a real browser: what a user sees and does, against the trace of the run."""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.image import imread

import polycnc
from support.browser import browser
from support.command import polycnc as command

EXAMPLES = Path(__file__).parents[2] / "examples"
WAIT_MS = 90_000


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as running:
        yield running


class Opened:
    """A view in the browser, and the trace of the same run."""

    def __init__(self, chromium: Any, folder: Path, part: str, machine: str, **page: Any) -> None:
        command("view", EXAMPLES / part, "-m", machine, "-o", folder / "part.html")
        result = polycnc.run(EXAMPLES / part, machine, trace=True)
        assert result.trace is not None
        self.trace = result.trace
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page = chromium.new_page(**{"viewport": {"width": 1280, "height": 800}, **page})
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto((folder / "part.html").as_uri())
        self.page.wait_for_selector("html[data-ready=yes]", timeout=WAIT_MS)

    def cell(self, name: str) -> str:
        return str(self.page.locator(f'#readout dd[data-of="{name}"]').inner_text())

    @property
    def time_s(self) -> float:
        return float(self.cell("time").split()[0])

    def slide(self, part: float) -> None:
        """Drag the thumb of the slider with the mouse."""
        slider = self.page.locator("#slider").bounding_box()
        now = float(self.page.locator("#slider").evaluate("s => s.value / s.max"))
        inner = slider["width"] - 16.0  # the thumb is 16 wide
        y = slider["y"] + slider["height"] / 2.0
        self.page.mouse.move(slider["x"] + 8.0 + now * inner, y)
        self.page.mouse.down()
        self.page.mouse.move(slider["x"] + 8.0 + part * inner, y, steps=3)
        self.page.mouse.up()

    def marker(self) -> list[float]:
        """Return where the tool is drawn: x, y and z of the picture."""
        found = self.page.evaluate(
            "() => ['x', 'y', 'z'].map((n) => document.getElementById('tool').data[0][n][0])"
        )
        return [float(value) for value in found]

    def row_at(self) -> int:
        return int(np.searchsorted(self.trace.t_s, self.time_s))

    def assert_agrees(self, drawn: tuple[int | None, int | None, int | None]) -> None:
        """Compare readout, picture and lit line with the trace; the clock of the page is read to 1 ms."""
        row = self.row_at()
        near = slice(max(row - 1, 0), row + 2)
        for i, (axis, marked) in enumerate(zip(self.trace.axes, self.trace.units, strict=True)):
            assert marked == "mm"
            shown = float(self.cell(axis).split()[0])
            low, high = np.min(self.trace.setpoint[near, i]), np.max(self.trace.setpoint[near, i])
            assert low - 0.006 <= shown <= high + 0.006, axis
            if i in drawn:
                assert self.marker()[drawn.index(i)] == pytest.approx(shown, abs=6e-4)
        lit = self.page.locator(".row.lit b").inner_text()
        assert int(lit) == int(self.cell("line"))
        assert int(lit) in self.trace.block[near].tolist()

    def close(self) -> None:
        assert [url for url in self.requests if not url.startswith(("file:", "blob:", "data:"))] == []
        assert len([url for url in self.requests if url.startswith("file:")]) == 1
        assert self.errors == []
        self.page.close()


@pytest.mark.parametrize(
    ("part", "machine", "drawn"),
    [("bracket.nc", "mill3", (0, 1, 2)), ("lathe_shaft.nc", "lathe2", (1, None, 0))],
    ids=["mill", "lathe"],
)
def test_slide_play_and_click(
    chromium: Any, tmp_path: Path, part: str, machine: str, drawn: tuple[int | None, int | None, int | None]
) -> None:
    view = Opened(chromium, tmp_path, part, machine)
    end_s = float(view.trace.t_s[-1])
    for share in (0.829, 0.437, 0.171):
        view.slide(share)
        assert view.time_s == pytest.approx(share * end_s, abs=0.02 * end_s)
        view.assert_agrees(drawn)

    view.page.locator("#rate").select_option("2")
    before = view.time_s
    view.page.locator("#play").click()
    view.page.wait_for_function(
        "t => document.getElementById('slider').value > t", arg=before + 0.4, timeout=WAIT_MS
    )
    view.page.keyboard.press("Space")  # the play button has the focus: it stops
    stopped = view.time_s
    assert before + 0.4 < stopped <= end_s
    view.page.wait_for_timeout(100)
    assert view.time_s == stopped
    view.assert_agrees(drawn)

    line = int(view.trace.block[len(view.trace) // 3])
    view.page.locator("#listing").evaluate("(e, top) => { e.scrollTop = top; }", max(line - 4, 0) * 20)
    view.page.locator(".row", has=view.page.locator(f"b:text-is('{line}')")).click()
    assert view.cell("line") == str(line)
    first = np.flatnonzero(view.trace.block == line)
    assert any(abs(view.time_s - view.trace.t_s[row]) < 0.0021 for row in first)
    view.assert_agrees(drawn)
    view.close()


def _tool_on_screen(shot: bytes, accent: tuple[int, int, int]) -> tuple[int, int]:
    """Return the pixel in the middle of the tool: its colour all around, which is wider than a line."""
    pixels = np.rint(imread(BytesIO(shot))[:, :, :3] * 255.0).astype(int)
    alike = np.all(np.abs(pixels - np.array(accent)) < 12, axis=2)
    filled = np.cumsum(np.cumsum(np.pad(alike, ((1, 0), (1, 0))), axis=0), axis=1)
    side = 11
    count = filled[side:, side:] - filled[:-side, side:] - filled[side:, :-side] + filled[:-side, :-side]
    rows, columns = np.nonzero(count >= side * side - 8)
    assert len(rows)
    return int(columns.mean()) + side // 2, int(rows.mean()) + side // 2


def test_a_click_on_the_path_goes_to_its_block(chromium: Any, tmp_path: Path) -> None:
    """Where the tool is drawn at a moment, a click on the path leads back to that moment."""
    view = Opened(chromium, tmp_path, "lathe_shaft.nc", "lathe2", color_scheme="light")
    view.slide(0.2)  # in the first roughing cut
    then, line, x_mm = view.time_s, view.cell("line"), view.cell("X")
    stage = view.page.locator("#stage").bounding_box()
    view.page.wait_for_timeout(500)
    column, row = _tool_on_screen(view.page.screenshot(clip=stage), (0xB3, 0x40, 0x0A))
    view.page.locator("#slider").focus()
    view.page.keyboard.press("Home")
    assert view.time_s == 0.0
    view.page.mouse.move(stage["x"] + column + 6, stage["y"] + row)
    for _ in range(20):  # the library looks under the mouse when it draws the next picture
        view.page.mouse.move(stage["x"] + column, stage["y"] + row, steps=3)
        view.page.wait_for_timeout(200)
        view.page.mouse.click(stage["x"] + column, stage["y"] + row, delay=120)  # as long as a finger
        if view.time_s > 0.0:
            break
    assert view.time_s == pytest.approx(then, abs=0.25)
    assert (view.cell("line"), view.cell("X")) == (line, x_mm)
    view.close()


def test_a_phone_in_the_dark(chromium: Any, tmp_path: Path) -> None:
    view = Opened(
        chromium, tmp_path, "bracket.nc", "mill3", viewport={"width": 390, "height": 844}, color_scheme="dark"
    )
    assert view.page.evaluate("() => document.documentElement.scrollWidth") <= 390
    assert view.page.locator("html").get_attribute("data-theme") == "dark"
    view.page.locator("#colour").select_option("tool")
    assert view.page.locator("#legend").inner_text().split() == ["T1", "T2", "T3", "rapid"]
    view.page.locator("#theme").click()
    assert view.page.locator("html").get_attribute("data-theme") == "light"
    view.close()


def test_five_axes_as_the_part_sees_them(chromium: Any, tmp_path: Path) -> None:
    """In the frame of the part the tool is drawn where two rotations bring it; a chart shows the speed of C."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    view = Opened(chromium, tmp_path, "five_axis.nc", "mill5")
    view.page.locator("#frame").select_option("part")
    view.page.wait_for_function("() => document.querySelector('#frame')?.value === 'part'", timeout=WAIT_MS)
    view.page.wait_for_selector("html[data-ready=yes]", timeout=WAIT_MS)
    view.slide(0.9)  # in the groove: all axes move
    row = view.row_at()
    x, y, z, a, c = view.trace.setpoint[row]
    turned = rotation.from_euler("z", c, degrees=True) * rotation.from_euler("x", a, degrees=True)
    assert view.marker() == pytest.approx(turned.apply((x, y, z)), abs=0.4)
    assert abs(c) > 100.0
    assert float(view.cell("C").split()[0]) == pytest.approx(c, abs=0.2)
    view.page.locator("#shown").select_option(label="speed C")
    shown = view.page.evaluate("() => Math.max(...document.getElementById('chart').data[0].y)")
    assert shown == pytest.approx(np.max(np.abs(np.diff(view.trace.setpoint[:, 4]))) / 0.001, rel=0.01)
    assert "The groove" in view.page.locator("#operations").inner_text()
    view.requests.remove(view.requests[-1])  # the page was loaded once more
    view.close()


def test_a_distance_is_measured_between_two_places(chromium: Any, tmp_path: Path) -> None:
    view = Opened(chromium, tmp_path, "bracket.nc", "mill3")
    view.page.locator("#measure").click()
    assert view.page.locator("#measure").get_attribute("aria-pressed") == "true"
    for point in ((3.0, 4.0, 1.0), (6.0, 8.0, 13.0)):  # clicks as the library tells them
        view.page.evaluate(
            "([x, y, z]) => document.getElementById('path').emit('plotly_click', "
            "{ points: [{ x, y, z, curveNumber: 0, pointNumber: 0 }] })",
            point,
        )
    assert view.page.locator("#status").inner_text() == "Distance 13.000 mm (X 3.000, Y 4.000, Z 12.000)"
    view.close()


def test_the_chart_goes_through_the_trace(chromium: Any, tmp_path: Path) -> None:
    """However many points are crowded together, a line that can be seen as one is where the record is."""
    feeds = [310.0 + 137.0 * (n * n % 29) for n in range(900)]
    lines = [f"G1 X{(n % 2) * (3 + n % 7)} Y{0.3 * n:.1f} F{feed:.0f}" for n, feed in enumerate(feeds)]
    program = tmp_path / "plateaus.nc"
    program.write_text("G21 G90 G94\n" + "\n".join(lines) + "\nM30\n")
    view = Opened(chromium, tmp_path, str(program), "mill3")
    trace = view.trace
    speed = np.where(trace.rapid, np.nan, trace.feed_mm_s * 60.0)
    end_s = float(trace.t_s[-1])
    for first, last in ((0.0, 1.0), (0.4, 0.6), (0.71, 0.72)):
        view.page.evaluate(
            "([a, b]) => Plotly.relayout('chart', {'xaxis.range[0]': a, 'xaxis.range[1]': b})",
            [first * end_s, last * end_s],
        )
        x, y = view.page.evaluate(
            "() => [...document.getElementById('chart').data].map((d) => [d.x, d.y])[0]"
        )
        drawn = np.array([[t, np.nan if v is None else v] for t, v in zip(x, y, strict=True)], np.float64)
        nearest = (
            np.abs(drawn[:, None, 0] - trace.t_s[None, ::1]).argmin(axis=1) if len(drawn) < 200 else None
        )
        at = np.searchsorted(trace.t_s, drawn[:, 0]).clip(0, len(trace) - 1) if nearest is None else nearest
        known = np.isfinite(drawn[:, 1])
        assert np.nanmax(np.abs(drawn[known, 1] - speed[at][known])) < 8.0  # the view's tolerance is 6 mm/min
        piece_s = (last - first) * end_s / 200.0
        for (t0, v0), (t1, v1) in pairwise(drawn):
            if t1 - t0 < piece_s or not np.isfinite(v0 + v1):
                continue
            inside = (trace.t_s > t0) & (trace.t_s < t1)
            line = v0 + (v1 - v0) * (trace.t_s[inside] - t0) / (t1 - t0)
            assert np.nanmax(np.abs(line - speed[inside])) < 15.0, (t0, t1)
    view.close()
