"""Plots: what is drawn for which machine and motion, from the axes and lines of the figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import polycnc
from polycnc.runner import PLOT_FORMATS, PlotCollector, run

MILLING = "G0 X10 Y10 Z5\nG1 Z-1 F300\nG1 X40 F900\nG3 X50 Y20 J10\nG0 Z5\nG0 X500 Y500\n"


def _figure(program: str, machine: str = "mill3") -> Any:
    return polycnc.plot(polycnc.run(program, machine, trace=True))


def _titles(figure: Any) -> list[str]:
    return [axes.get_title(loc="left").partition("  ")[0] for axes in figure.axes]


def _lines(axes: Any) -> dict[str, np.ndarray]:
    return {line.get_label(): np.array(line.get_xydata()) for line in axes.lines}


def test_a_mill_has_plan_perspective_and_speed() -> None:
    figure = _figure(MILLING)
    assert _titles(figure) == ["Plan view", "Perspective", "Speed"]
    plan, solid, speed = figure.axes
    assert (plan.get_xlabel(), plan.get_ylabel()) == ("X [mm]", "Y [mm]")
    assert (solid.get_xlabel(), solid.get_ylabel(), solid.get_zlabel()) == ("X [mm]", "Y [mm]", "Z [mm]")
    assert (speed.get_xlabel(), speed.get_ylabel()) == ("time [s]", "path speed [mm/min]")
    assert plan.get_aspect() == 1.0
    assert [text.get_text() for text in plan.get_legend().get_texts()] == ["rapid", "cut", "plunge"]
    assert figure.get_suptitle().startswith("<text>    on mill3    ")


def test_start_and_end_are_marked_where_they_are_seen() -> None:
    figure = polycnc.plot(polycnc.run("G1 X4 F600\nX40 Y17\nY31\nM30\n", trace=True))
    ends = {line.get_label(): np.asarray(line.get_xydata())[0].tolist() for line in figure.axes[0].lines}
    assert ends["start"] == pytest.approx([0.0, 0.0], abs=0.01)
    assert ends["end"] == pytest.approx([40.0, 31.0])
    far = polycnc.plot(polycnc.run("G0 X400 Y300\nG1 X410 F600\nY310\nG0 X0 Y0\nM30\n", trace=True))
    assert {"start", "end"} & {line.get_label() for line in far.axes[0].lines} == set()


def test_cuts_and_rapids_are_apart_and_far_rapids_leave_the_picture() -> None:
    plan = _figure(MILLING).axes[0]
    lines = _lines(plan)
    cut = lines["cut"][~np.isnan(lines["cut"]).any(axis=1)]
    assert cut.min(axis=0) == pytest.approx([10.0, 10.0])
    assert cut.max(axis=0) == pytest.approx([50.0, 20.0])
    rapid = lines["rapid"][~np.isnan(lines["rapid"]).any(axis=1)]
    assert rapid.max() < 60.0  # of the way to 500, the first steps
    assert lines["plunge"].tolist() == [[10.0, 10.0]]
    low, high = plan.get_xlim()
    assert low < 10.0
    assert 50.0 < high < 70.0


def test_speed_shows_cuts_and_tells_where_rapids_go() -> None:
    speed = _figure(MILLING).axes[-1]
    assert speed.get_ylim() == (0.0, pytest.approx(1.2 * 900.0))
    assert "rapids leave the picture" in speed.get_title(loc="left")


def test_a_lathe_is_drawn_with_z_to_the_right() -> None:
    figure = _figure("G1 X10 Z-30 F500\nX20\n", "lathe2")
    assert _titles(figure)[:2] == ["Path", "Speed"]
    path, _, positions = figure.axes
    assert (path.get_xlabel(), path.get_ylabel()) == ("Z [mm]", "X [mm]")
    assert positions.get_ylabel() == "position [mm]"
    assert list(_lines(positions)) == ["X [mm]", "Z [mm]"]


def test_rotary_axes_that_move_are_drawn_over_time() -> None:
    figure = _figure("G91 G1 X10 C720 F500\n", "mill5")
    assert [axes.get_ylabel() for axes in figure.axes[2:]] == ["path speed [mm/min or deg/min]", "C [deg]"]
    assert _lines(figure.axes[-1])["C [deg]"][-1].tolist() == pytest.approx(
        [figure.axes[-1].lines[0].get_xdata()[-1], 720]
    )


@pytest.mark.parametrize("program", ["", "G4 P1\n", "G1 X0 F100\n"])
def test_no_motion_says_so(program: str) -> None:
    figure = _figure(program + "\n")
    assert [text.get_text() for text in figure.texts if text is not figure._suptitle] == [
        "The program moves no axis."
    ]
    assert figure.axes == []


@pytest.mark.parametrize("program", ["G0 X5\n", "G1 Z-5 F100\n", "G1 X0.0001 F100\n"])
def test_small_and_flat_motions_are_drawn(tmp_path: Path, program: str) -> None:
    result = polycnc.run(program, trace=True)
    polycnc.plot(result, tmp_path / "plot.png")  # a warning would be an error
    plan = polycnc.plot(result).axes[0]
    for low, high in (plan.get_xlim(), plan.get_ylim()):
        assert high - low > 0.1


@pytest.mark.parametrize("ending", PLOT_FORMATS)
def test_formats_are_the_same_bytes_every_time(tmp_path: Path, ending: str) -> None:
    result = polycnc.run(MILLING, trace=True)
    for name in ("one", "two"):
        polycnc.plot(result, tmp_path / f"{name}{ending}")
    assert (tmp_path / f"one{ending}").read_bytes() == (tmp_path / f"two{ending}").read_bytes()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_program_name_is_no_formula(tmp_path: Path) -> None:
    program = tmp_path / "part_$1$.nc"
    program.write_text("G1 X5 F100\n")
    polycnc.plot(polycnc.run(program, trace=True), tmp_path / "plot.svg")
    assert (tmp_path / "plot.svg").stat().st_size > 0


def test_what_cannot_be_plotted(tmp_path: Path) -> None:
    result = polycnc.run("G1 X5 F100\n")
    with pytest.raises(polycnc.UsageError, match="the result has no trace"):
        polycnc.plot(result, tmp_path / "plot.png")
    result = polycnc.run("G1 X5 F100\n", trace=True)
    for name in ("plot.jpg", "plot", "nowhere/plot.png"):
        with pytest.raises(polycnc.UsageError, match="a plot cannot be written to"):
            polycnc.plot(result, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_collector_thins_long_records(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("polycnc.runner._plot._MOST_ROWS", 1000)
    config = polycnc.load_machine("mill3")
    collector = PlotCollector(config)
    result = run("G1 X100 F200\n", config, rows=collector.add)  # 30,001 cycles
    trace = collector.with_trace(result).trace
    assert trace is not None
    assert 1000 <= len(trace) <= 2001 + 1
    assert np.all(np.diff(trace.t_s) >= 0.0)
    assert trace.t_s[0] == 0.001
    assert trace.t_s[-1] == result.time_s
    assert trace.setpoint[-1, 0] == 100.0
