"""The page of `polycnc view` in a real browser: what a user sees and does, against the trace of the run."""

from __future__ import annotations

import zipfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import polycnc
from polycnc.stock import Stock, check_closed, read_stl
from support.browser import browser, new_page
from support.command import polycnc as command

EXAMPLES = Path(__file__).parents[2] / "examples"
WAIT_MS = 90_000


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as running:
        yield running


class Opened:
    """A view in the browser, and the trace of the same run."""

    def __init__(
        self,
        chromium: Any,
        folder: Path,
        part: str,
        machine: str,
        stock: str | None = None,
        *,
        fails: bool = False,
        **page: Any,
    ) -> None:
        cut = () if stock is None else ("--stock", stock, "--resolution", "1")
        command("view", EXAMPLES / part, "-m", machine, "-o", folder / "part.html", *cut, status=int(fails))
        result = polycnc.run(EXAMPLES / part, machine, trace=True, check=not fails)
        assert result.trace is not None
        self.trace = result.trace
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page = new_page(chromium, **page)
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
        found = self.page.locator("#stage").get_attribute("data-tip")
        return [float(value) for value in found.split()]

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
    ("part", "machine", "stock", "drawn"),
    [
        ("bracket.nc", "mill3", None, (0, 1, 2)),
        ("lathe_shaft.nc", "lathe2", "cylinder=30,-70,0", (1, None, 0)),
    ],
    ids=["mill", "lathe"],
)
def test_slide_play_and_click(
    chromium: Any,
    tmp_path: Path,
    part: str,
    machine: str,
    stock: str | None,
    drawn: tuple[int | None, int | None, int | None],
) -> None:
    view = Opened(chromium, tmp_path, part, machine, stock)
    if stock is not None:
        _saves_what_is_left(view, tmp_path, part, machine, stock)
    end_s = float(view.trace.t_s[-1])
    for share in (0.829, 0.171):
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
    assert before + 0.399 < stopped <= end_s  # shown to a millisecond
    view.page.wait_for_timeout(100)
    assert view.time_s == stopped
    view.assert_agrees(drawn)

    line = int(view.trace.block[len(view.trace) // 3])
    view.page.locator("#listing").evaluate("(e, top) => { e.scrollTop = top; }", max(line - 4, 0) * 20)
    view.page.locator(".row", has=view.page.locator(f"b:text-is('{line}')")).click()
    assert view.cell("line") == str(line)
    first = np.flatnonzero(view.trace.block == line)
    assert np.min(np.abs(view.trace.t_s[first] - view.time_s)) < 0.0021
    view.assert_agrees(drawn)
    view.close()


def _saves_what_is_left(view: Opened, folder: Path, part: str, machine: str, stock: str) -> None:
    """The body that is shown at the end is saved as a closed surface with the volume of the run's; a click finds it."""
    assert float(view.page.locator("#slider").evaluate("s => s.value / s.max")) == 1.0  # the part first
    result = polycnc.run(EXAMPLES / part, machine, stock=stock, resolution_mm=1.0, check=False)
    assert result.machined is not None
    with view.page.expect_download() as saved:
        view.page.locator("#save").select_option("stl")
    saved.value.save_as(folder / "body.stl")
    surface = read_stl(folder / "body.stl")
    check_closed(folder / "body.stl", surface)
    whole = result.machined.stock
    assert surface.volume_mm3 == pytest.approx(whole.volume_mm3, rel=0.02)
    assert surface.vertices.min(axis=0) == pytest.approx(whole.mesh().vertices.min(axis=0), abs=0.5)
    at = [22.0, 0.0, 0.0] if machine == "mill5" else [-17.0, 0.0, 0.0]  # below it is what a cut has left
    met = view.page.evaluate(
        "at => document.getElementById('stage').seen.body.pick(at.map((v, i) => v + (i === 2 ? 90 : 0)), at)",
        at,
    )
    assert met["place"][:2] == pytest.approx(at[:2], abs=0.01)
    assert 0.0 < met["t"] <= float(view.trace.t_s[-1])
    view.page.locator("#section").select_option("1")
    view.page.locator("#section").select_option("")


ON_STAGE = """(place) => {
  const { stage, part } = document.getElementById('stage').seen;
  const Vector = stage.camera.position.constructor, box = stage.canvas.getBoundingClientRect();
  const at = stage.project(new Vector(...place).applyMatrix4(part.matrix));
  return [box.left + at.x, box.top + at.y];
}"""


PAINTED = """() => {
  const { stage } = document.getElementById('stage').seen, { width, height } = stage.canvas;
  const copy = new OffscreenCanvas(width, height).getContext('2d');
  stage.render();
  copy.drawImage(stage.canvas, 0, 0);
  const seen = new Uint32Array(copy.getImageData(0, 0, width, height).data.buffer);
  return seen.filter((each) => each !== seen[0]).length / seen.length;
}"""
"""The share of the picture that has not the colour of its corner."""


def test_a_click_on_the_path_goes_to_its_block(chromium: Any, tmp_path: Path) -> None:
    """Where the tool is drawn at a moment, a click on the path leads back to that moment; and the path is seen."""
    view = Opened(chromium, tmp_path, "lathe_shaft.nc", "lathe2", color_scheme="light", draws=True)
    assert view.page.evaluate(PAINTED) > 0.01
    assert (
        view.page.evaluate(
            "() => document.getElementById('stage').seen.stage.renderer.getContext().getError()"
        )
        == 0
    )
    view.slide(0.2)  # in the first roughing cut
    then, line, x_mm = view.time_s, view.cell("line"), view.cell("X")
    x, y = view.page.evaluate(ON_STAGE, view.marker())
    view.page.locator("#slider").focus()
    view.page.keyboard.press("Home")
    assert view.time_s == 0.0
    view.page.mouse.click(x, y)
    assert view.time_s == pytest.approx(then, abs=0.1)
    assert (view.cell("line"), view.cell("X")) == (line, x_mm)
    view.close()


def test_smaller_screens_show_all_in_one_column_and_in_the_dark(chromium: Any, tmp_path: Path) -> None:
    view = Opened(
        chromium, tmp_path, "bracket.nc", "mill3", viewport={"width": 390, "height": 844}, color_scheme="dark"
    )
    assert view.page.evaluate("() => document.documentElement.scrollWidth") <= 390
    assert view.page.locator("html").get_attribute("data-theme") == "dark"
    view.page.locator("#colour").select_option("tool")
    assert view.page.locator("#legend").inner_text().split() == ["T1", "T2", "T3", "rapid"]
    view.page.locator("#theme").click()
    assert view.page.locator("html").get_attribute("data-theme") == "light"
    for width, height in ((820, 1180), (390, 844)):
        view.page.set_viewport_size({"width": width, "height": height})
        assert view.page.evaluate("() => document.documentElement.scrollWidth") <= width
        assert view.page.locator("#stage").bounding_box()["height"] >= 300
    view.close()


def test_five_axes_as_the_part_sees_them(chromium: Any, tmp_path: Path) -> None:
    """In the frame of the part the tool is drawn where two rotations bring it; a chart shows the speed of C."""
    rotation = pytest.importorskip("scipy.spatial.transform").Rotation
    stock = "cylinder=90,0,36"
    view = Opened(chromium, tmp_path, "five_axis.nc", "mill5", stock, fails=True)  # it begins in the stock
    _saves_what_is_left(view, tmp_path, "five_axis.nc", "mill5", stock)
    view.slide(0.9)  # in the groove: all axes move
    row = view.row_at()
    x, y, z, a, c = view.trace.setpoint[row]
    turned = rotation.from_euler("z", c, degrees=True) * rotation.from_euler("x", a, degrees=True)
    assert view.marker() == pytest.approx(turned.apply((x, y, z)), abs=0.4)
    assert abs(c) > 100.0
    view.page.locator("#frame").select_option("machine")  # the part turns, and the tool is where the axes are
    drawn = view.page.evaluate(
        "() => { const { part, stage } = document.getElementById('stage').seen;"
        " const V = stage.camera.position.constructor;"
        " const tip = document.getElementById('stage').dataset.tip.split(' ').map(Number);"
        " return new V(...tip).applyMatrix4(part.matrix).toArray(); }"
    )
    assert drawn == pytest.approx((x, y, z), abs=0.4)
    assert float(view.cell("C").split()[0]) == pytest.approx(c, abs=0.2)
    view.page.locator("#shown").select_option(label="speed C")
    shown = view.page.evaluate(
        "() => Math.max(...document.getElementById('chart').drawn.points.y.map(Math.abs))"
    )
    assert shown == pytest.approx(np.max(np.abs(np.diff(view.trace.setpoint[:, 4]))) / 0.001, rel=0.01)
    assert "The groove" in view.page.locator("#operations").inner_text()
    view.close()


def test_a_distance_is_measured_between_two_places(chromium: Any, tmp_path: Path) -> None:
    """Clicks near ends of pieces are drawn to them."""
    program = tmp_path / "two.nc"
    program.write_text("G21 G90 G94\nG0 X3 Y4 Z1\nG1 X3 Y24 F900\nG1 X43 Y24\nG4 X0.1\nG2 X51 Y16 J-8\nM30\n")
    view = Opened(chromium, tmp_path, str(program), "mill3")
    view.page.keyboard.press("m")
    assert view.page.locator("#measure").get_attribute("aria-pressed") == "true"
    for place in ((3.0, 5.0, 1.0), (42.0, 24.0, 1.0)):
        view.page.mouse.click(*view.page.evaluate(ON_STAGE, place))
    found = view.page.locator("#status").inner_text()
    assert found == "Distance 44.721 mm (X 40.000, Y 20.000, Z 0.000)"
    for place in ((3.0, 5.0, 1.0), (43.2, 15.9, 1.0)):  # no line is at the middle of the arc
        view.page.mouse.click(*view.page.evaluate(ON_STAGE, place))
    words = view.page.locator("#status").inner_text().split()
    assert float(words[1]) == pytest.approx(float(np.hypot(40.0, 12.0)), abs=0.03)
    view.close()


def test_coordinates_of_the_work_of_the_machine_and_to_go(chromium: Any, tmp_path: Path) -> None:
    """In inch, as the program is, from a shifted zero."""
    program = tmp_path / "inch.nc"
    program.write_text("G20 G90 G94\nG92 X1 Y0.5\nG1 X3 F30\nM30\n")
    view = Opened(chromium, tmp_path, str(program), "mill3")
    view.slide(0.5)
    shown = [view.cell("X")]
    for _ in range(2):
        view.page.keyboard.press("w")
        shown.append(view.cell("X"))
    work, machine, to_go = (float(text.removesuffix(" in")) for text in shown)
    assert work == pytest.approx(machine + 1.0, abs=1e-4)
    assert work + to_go == pytest.approx(3.0, abs=2e-4)
    view.close()


def test_the_chart_draws_only_what_the_trace_has(chromium: Any, tmp_path: Path) -> None:
    """Lines are the record's; a band goes from its lowest to its highest, with its mean in it."""
    feeds = [310.0 + 137.0 * (n * n % 29) for n in range(900)]
    lines = [f"G1 X{(n % 2) * (3 + n % 7)} Y{0.3 * n:.1f} F{feed:.0f}" for n, feed in enumerate(feeds)]
    program = tmp_path / "plateaus.nc"
    program.write_text("G21 G90 G94\n" + "\n".join(lines) + "\nM30\n")
    view = Opened(chromium, tmp_path, str(program), "mill3")
    trace = view.trace
    speed = trace.feed_mm_s * 60.0
    end_s = float(trace.t_s[-1])
    bands = 0
    for first, last in ((0.0, 1.0), (0.4, 0.6), (0.71, 0.72)):
        drawn = view.page.evaluate(
            "([a, b]) => { const { drawn } = document.getElementById('chart'); drawn.zoom(a, b);"
            " return drawn.drawn; }",
            [first * end_s, last * end_s],
        )
        x, line, low, high, mean = (
            np.array([np.nan if value is None else value for value in drawn[name]], np.float64)
            for name in ("x", "line", "low", "high", "mean")
        )
        after = np.clip(np.searchsorted(trace.t_s, x), 1, trace.t_s.size - 1)
        at = after - (x - trace.t_s[after - 1] < trace.t_s[after] - x)
        known = np.isfinite(line)
        assert np.abs(line[known] - speed[at][known]).max() < 8.0  # the view's tolerance is 6 mm/min
        for begin, end in pairwise(np.flatnonzero(known)):
            inside = (trace.t_s >= x[begin] - 1e-4) & (trace.t_s <= x[end] + 1e-4)
            band = np.isfinite(low[begin + 1 : end])
            if np.any(band):
                bands += 1
                k = begin + 1 + int(np.flatnonzero(band)[0])
                assert low[k] == pytest.approx(speed[inside].min(), abs=8.0)
                assert high[k] == pytest.approx(speed[inside].max(), abs=8.0)
                assert mean[k] == pytest.approx(speed[inside].mean(), abs=0.02 * speed.max())
            elif x[end] > x[begin]:
                straight = np.interp(trace.t_s[inside], x[[begin, end]], line[[begin, end]])
                assert np.abs(straight - speed[inside]).max() < 15.0
    assert bands > 100
    view.close()


def test_the_slider_cuts_back_and_forth(chromium: Any, tmp_path: Path) -> None:
    """At any place of the slider the field is the same, whichever way it came there."""
    view = Opened(chromium, tmp_path, "bracket.nc", "mill3", stock="auto")
    field = (
        "() => { const { body } = document.getElementById('stage').seen; return [body.step, ...body.shown]; }"
    )
    seen: dict[float, np.ndarray[Any, Any]] = {}
    for share in (0.3, 1.0, 0.3):
        view.page.evaluate(
            "s => { const e = document.getElementById('slider'); e.value = s * e.max; e.oninput(); }", share
        )
        shown = np.array(view.page.evaluate(field))
        assert np.array_equal(seen.setdefault(share, shown), shown)
    assert seen[0.3][0] < seen[1.0][0]
    result = polycnc.run(EXAMPLES / "bracket.nc", "mill3", stock="auto", resolution_mm=1.0)
    assert isinstance(result.stock, Stock)
    heights = result.stock.heights - result.stock.grid.bottom
    assert seen[1.0][1::2] == pytest.approx(heights.ravel(), abs=0.01)
    for how in ("stl", "3mf"):
        view.page.evaluate(
            "s => { const e = document.getElementById('slider'); e.value = e.max; e.oninput(); }"
        )
        with view.page.expect_download() as saved:
            view.page.locator("#save").select_option(how)
        assert saved.value.suggested_filename == f"bracket.{how}"
        saved.value.save_as(tmp_path / f"part.{how}")
    assert read_stl(tmp_path / "part.stl").volume_mm3 == pytest.approx(
        result.stock.mesh().volume_mm3, rel=1e-3
    )
    with zipfile.ZipFile(tmp_path / "part.3mf") as archive:
        assert archive.testzip() is None
        model = archive.read("3D/3dmodel.model")
    assert model.count(b"<triangle ") == int(
        np.frombuffer((tmp_path / "part.stl").read_bytes(), "<u4", 1, 80)[0]
    )
    view.page.locator("#stock").select_option("whole")
    assert view.page.evaluate(field)[0] == 0
    bottom = "() => document.getElementById('stage').seen.body.mesh.children[1].visible"
    assert not view.page.evaluate(bottom)  # it is seen from above
    view.page.locator("#section").select_option("1")
    assert view.page.locator("#cut").is_visible()
    view.page.wait_for_function(bottom)  # what is seen through the section is full down to it
    view.close()


def test_an_alarm_is_named_with_its_place_and_the_rest_is_grey(chromium: Any, tmp_path: Path) -> None:
    """The camera shows what was meant to be cut, in one colour with nothing that turns over time."""
    program = tmp_path / "stopped.nc"
    program.write_text("G21 G90 G94\nG0 X3 Y4 Z1\nG1 X13 F900\nG2 X80 I3 J0\nG1 X43\nY24\nM30\n")
    view = Opened(chromium, tmp_path, str(program), "mill3", fails=True)
    assert (
        view.page.locator("#stopped").inner_text().startswith("▲ Stopped at line 4, X13.000 Y4.000 Z1.000: ")
    )
    box, count = view.page.evaluate(
        "() => { const { path, stage } = document.getElementById('stage').seen; return [path.box, path.rest().count]; }"
    )
    assert np.array(box[:2]) == pytest.approx(np.array([[0.0, 43.0], [0.0, 24.0]]), abs=4.1)
    assert count >= 2
    view.page.locator("#stopped").click()
    assert view.time_s == pytest.approx(float(view.trace.t_s[-1]), abs=0.002)
    view.close()


def test_rapids_between_cuts_are_in_the_picture_and_no_number_is_cut(chromium: Any, tmp_path: Path) -> None:
    """Its tool is not known, so that there is a body that nothing cuts: the path is shown instead, whole."""
    view = Opened(chromium, tmp_path, "bolt_circle.tap", "mill3", "auto")
    places, numbers, faint, size = view.page.evaluate(
        """() => { const { stage, path } = document.getElementById('stage').seen, at = stage.camera.position.clone();
        const on = (v) => stage.project(v, at).toArray().slice(0, 2), found = [];
        const legend = document.getElementById('legend');
        stage.render();
        stage.scene.traverse((each) => { if (each.isSprite && each.visible && each.size_px[1] === 14)
          found.push([...on(each.getWorldPosition(at)), each.size_px[0] / 2, 7]); });
        return [[[50, 70, 20], [20, 40, 20], [80, 40, 20], [50, 40, -12]].map((p) => on(at.clone().set(...p))), found,
          path.cuts.material.uniforms.faint.value,
          [stage.width, stage.height, legend.offsetWidth + 12, legend.offsetHeight + 10]]; }"""
    )
    assert all(0 < x < size[0] and 0 < y < size[1] for x, y in places)
    assert len(numbers) > 8
    assert all(w <= x <= size[0] - w and h <= y <= size[1] - h for x, y, w, h in numbers)
    assert not any(x - w < size[2] and y - h < size[3] for x, y, w, h in numbers)
    assert faint == 1
    view.close()


def test_a_laser_is_coloured_by_its_power_first(chromium: Any, tmp_path: Path) -> None:
    program, machine = tmp_path / "shades.nc", tmp_path / "laser.toml"
    program.write_text("G21 G90\nM3 S240\nG1 X40 F3000\nX40 Y30 S720\nX7 S0\nG0 X0 Y0\nM30\n")
    axes = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 200\namax_mm_s2 = 2000\n' for name in "XYZ")
    machine.write_text(f'name = "laser"\n[spindle]\nlaser = true\nmax_rpm = 1000\n{axes}')
    view = Opened(chromium, tmp_path, str(program), str(machine))
    assert view.page.locator("#colour").input_value() == "power"
    assert "S720" in view.page.locator("#legend").inner_text()
    view.page.locator("#colour").select_option("speed")
    assert "S720" not in view.page.locator("#legend").inner_text()
    view.close()
