"""Plots: what is drawn for which machine and motion, from the axes and lines of the figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import polycnc
from polycnc.runner import PLOT_FORMATS

MILLING = "G0 X10 Y10 Z5\nG1 Z-1 F300\nG1 X40 F900\nG3 X50 Y20 J10\nG0 Z5\nG0 X500 Y500\n"


def _figure(program: str, machine: str = "mill3") -> Any:
    return polycnc.plot(polycnc.run(program, machine, trace=True))


def _titles(figure: Any) -> list[str]:
    return [axes.get_title(loc="left").partition("  ")[0] for axes in figure.axes]


def _legend(figure: Any) -> list[str]:
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


def _lines(axes: Any) -> dict[str, np.ndarray]:
    return {line.get_label(): np.array(line.get_xydata()) for line in axes.lines}


def test_a_mill_has_plan_perspective_and_speed() -> None:
    figure = _figure(MILLING)
    assert _titles(figure) == ["Plan view", "Perspective", "Speed"]
    plan, solid, speed = figure.axes
    assert (plan.get_xlabel(), plan.get_ylabel()) == ("X [mm]", "Y [mm]")
    assert (solid.get_xlabel(), solid.get_ylabel(), solid.get_zlabel()) == ("X [mm]", "Y [mm]", "Z [mm]")
    assert (speed.get_xlabel(), speed.get_ylabel()) == ("time [s]", "path speed\n[mm/min]")
    assert plan.get_aspect() == 1.0
    assert _legend(figure) == ["cut", "rapid", "plunge", "start, further out", "end, further out"]
    assert figure.get_suptitle().startswith("<text>    on mill3    ")


def test_start_and_end_are_marked_where_they_are_seen() -> None:
    figure = polycnc.plot(polycnc.run("G1 X4 F600\nX40 Y17\nY31\nM30\n", trace=True))
    ends = {line.get_label(): np.asarray(line.get_xydata())[0].tolist() for line in figure.axes[0].lines}
    assert ends["start"] == pytest.approx([0.0, 0.0], abs=0.01)
    assert ends["end"] == pytest.approx([40.0, 31.0])


def test_ends_outside_of_the_picture_are_hollow_where_the_path_comes_in_and_leaves() -> None:
    plan = _figure("G0 X400 Y300\nG1 X410 F600\nY310\nG0 X0 Y0\nM30\n").axes[0]
    low, high = plan.get_xlim()
    marks = {line.get_label(): line for line in plan.lines}
    for label in ("start, further out", "end, further out"):
        (x,), (y,) = marks[label].get_data()
        assert low < x < high
        assert 290.0 < y < 312.0
        assert marks[label].get_markerfacecolor() in ("none", "white")


def test_every_tool_has_a_colour_or_else_a_line_of_its_own() -> None:
    program = "".join(f"T{tool} M6\nG0 X{3 * tool} Y0 Z5\nG1 Z-2 F700\nY17\nG0 Z5\n" for tool in range(4, 27))
    figure = _figure(f"(slot, wide)\n{program}M30\n")
    names = _legend(figure)
    assert names[0] == "T4  slot, wide"
    assert names[1:3] + names[19:21] == ["T5", "T6", "T23", "and 3 more tools"]
    lines = [line for line in figure.axes[0].lines if line.get_label().startswith("T")]
    assert len(lines) == 23
    looks = {(line.get_color(), str(line._unscaled_dash_pattern)) for line in lines}
    assert len(looks) == 23
    assert len({line.get_color() for line in lines}) == 7


def test_no_label_of_the_legend_lies_on_another() -> None:
    program = "".join(
        f"(an operation with quite a long name, number {tool})\nT{tool} M6\nG0 X{tool}\nG1 Y{tool} F900\n"
        for tool in range(2, 9)
    )
    figure = _figure(program + "M30\n")
    figure.draw_without_rendering()
    (legend,) = figure.legends
    boxes = [text.get_window_extent() for text in legend.get_texts()]
    assert not any(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[:i])
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)


def test_a_part_on_turning_tables_is_drawn_as_it_sees_the_tool() -> None:
    figure = _figure("G0 X40 Z9\nG91 G1 C180 F7200\nM30\n", "mill5")
    assert _titles(figure)[:2] == ["Plan view, as the part sees it", "Perspective, as the part sees it"]
    cut = _lines(figure.axes[0])["T0"]
    cut = cut[~np.isnan(cut).any(axis=1)]
    assert np.hypot(*cut.T) == pytest.approx(np.full(len(cut), 40.0), abs=1e-6)
    assert cut[-1] == pytest.approx([-40.0, 0.0], abs=1e-6)
    assert list(_lines(figure.axes[3])) == ["X [mm]", "Y [mm]", "Z [mm]"]
    still = _figure("G0 X40 Z9\nG1 X70 F7200\nM30\n", "mill5")
    assert _titles(still)[0] == "Plan view"


def test_cuts_and_rapids_are_apart_and_far_rapids_leave_the_picture() -> None:
    plan = _figure(MILLING).axes[0]
    lines = _lines(plan)
    cut = lines["T0"][~np.isnan(lines["T0"]).any(axis=1)]
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
    assert _titles(figure)[:2] == ["Profile", "Speed"]
    path, _, positions = figure.axes
    assert (path.get_xlabel(), path.get_ylabel()) == ("Z [mm]", "X [mm], radius")
    assert path.get_ylim()[0] < 0.0 < path.get_ylim()[1]  # the axis of the spindle is in the picture
    figure.draw_without_rendering()
    (diameter,) = path.child_axes
    assert diameter.get_ylabel() == "X [mm], diameter"
    assert np.asarray(diameter.get_ylim()) == pytest.approx(2.0 * np.asarray(path.get_ylim()))
    assert positions.get_ylabel() == "position [mm]"
    assert list(_lines(positions)) == ["X [mm]", "Z [mm]"]


def test_rotary_axes_that_move_are_drawn_over_time() -> None:
    figure = _figure("G91 G1 X10 C720 F500\n", "mill5")
    assert [axes.get_ylabel() for axes in figure.axes[2:]] == [
        "path speed\n[mm/min or deg/min]",
        "position [mm]",
        "C [deg]",
    ]
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


def test_names_in_any_script_are_plotted_without_a_warning(tmp_path: Path) -> None:
    program = tmp_path / "Tëil ✓ 部品.nc"
    program.write_text("(部品)\nT3 M6\nG1 X5 F100\n", encoding="utf-8")
    polycnc.run(program, trace=True).plot(tmp_path / "plot.png")  # a warning would be an error
    assert (tmp_path / "plot.png").stat().st_size > 0


def test_what_cannot_be_plotted(tmp_path: Path) -> None:
    result = polycnc.run("G1 X5 F100\n")
    with pytest.raises(polycnc.UsageError, match="the result has no trace"):
        polycnc.plot(result, tmp_path / "plot.png")
    result = polycnc.run("G1 X5 F100\n", trace=True)
    for name in ("plot.jpg", "plot", "nowhere/plot.png"):
        with pytest.raises(polycnc.UsageError, match="a plot cannot be written to"):
            polycnc.plot(result, tmp_path / name)
    assert list(tmp_path.iterdir()) == []
