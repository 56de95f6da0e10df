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
    plan = polycnc.plot(result, tmp_path / "plot.png").axes[0]  # a warning would be an error
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


def test_the_picture_shows_the_cuts_and_a_margin() -> None:
    """Cuts of 40 by 10: 0.15 of the larger side around them, no further than anything moves; 0.03 of that as room."""
    plan, solid, speed = _figure(MILLING).axes
    room = 0.03 * (40.0 + 2.0 * 6.0)
    assert plan.get_xlim() == pytest.approx((10.0 - 6.0 - room, 50.0 + 6.0 + room))
    assert plan.get_ylim() == pytest.approx((10.0 - 6.0 - room, 20.0 + 6.0 + room))
    assert solid.get_xlim() == pytest.approx(plan.get_xlim())
    limits: Any = solid
    assert limits.get_zlim() == pytest.approx((-1.0 - room, 5.0 + room))
    sides = solid.get_box_aspect if hasattr(solid, "get_box_aspect") else None
    assert sides is not None
    shares = solid._box_aspect / np.max(solid._box_aspect)
    width = 52.0 + 2.0 * room
    assert shares == pytest.approx([1.0, (22.0 + 2.0 * room) / width, 0.3])  # a flat part is drawn 0.3 high
    assert [axis.get_major_locator()._nbins for axis in (solid.xaxis, solid.yaxis, solid.zaxis)] == [7, 4, 4]
    end = speed.lines[0].get_xdata()
    assert speed.get_xlim()[1] / speed.get_xlim()[0] == pytest.approx(-101.0)
    assert speed.get_xlim()[1] > np.nanmax(end)


def test_a_flat_path_has_room_on_both_sides() -> None:
    plan = _figure("G1 X40 F600\nM30\n").axes[0]
    assert plan.get_xlim() == pytest.approx((-1.2, 41.2), abs=0.01)  # nothing moves beyond its ends
    assert plan.get_ylim() == pytest.approx((-6.0 - 1.2, 6.0 + 1.2), abs=0.01)
    rapid = _figure("G0 X40 Y1\nM30\n").axes[0]  # with nothing that cuts, everything
    assert rapid.get_xlim() == pytest.approx((-1.2, 41.2), abs=0.01)


def test_rapids_are_thin_grey_and_dashed_and_tools_are_not() -> None:
    figure = _figure(f"T3 M6\n{MILLING}T5 M6\nG0 X10 Y14\nG1 X22 F900\nM30\n")
    for axes in (figure.axes[0], figure.axes[1]):
        looks = {line.get_label(): line for line in axes.lines}
        assert looks["rapid"].get_linewidth() < looks["T3"].get_linewidth()
        assert looks["rapid"].is_dashed()
        assert not looks["T3"].is_dashed()
        assert [looks[name].get_color() for name in ("rapid", "T3", "T5")] == [
            "#8a949d",
            "#0072b2",
            "#d55e00",
        ]
    speeds = figure.axes[2].lines
    assert [line.get_color() for line in speeds] == ["#8a949d", "#0072b2", "#d55e00"]
    assert 0.0 < speeds[0].get_linewidth() < speeds[1].get_linewidth()
    # A rapid begins where the cut before it ended: no gap in the picture.
    joined = _lines(figure.axes[0])["T5"]
    assert joined[0] == pytest.approx([10.0, 14.0])


def test_start_and_end_have_their_marks() -> None:
    marks = {line.get_label(): line for line in _figure("G1 X4 F600\nX40 Y17\nM30\n").axes[0].lines}
    start, end = marks["start"], marks["end"]
    assert (start.get_marker(), start.get_markerfacecolor(), start.get_markeredgewidth()) == (
        "o",
        "none",
        1.8,
    )
    assert (end.get_marker(), end.get_markerfacecolor(), end.get_markeredgewidth()) == ("X", "#1b2228", 0.8)
    outside = _figure("G0 X400 Y300\nG1 X410 F600\nY310\nG0 X0 Y0\nM30\n").axes[0]
    marks = {line.get_label(): line for line in outside.lines}
    first, last = marks["start, further out"], marks["end, further out"]
    assert (first.get_markerfacecolor(), first.get_markeredgewidth()) == ("none", 0.8)
    assert (last.get_markerfacecolor(), last.get_markeredgewidth()) == ("white", 0.8)


def test_rapids_that_are_hardly_faster_stay_in_the_picture_of_the_speed() -> None:
    """mill3 goes at 30 m/min at rapid: no more than twice 20."""
    speed = _figure("G0 X300\nG1 X0 F20000\nM30\n").axes[-1]
    rapid = np.nanmax(speed.lines[0].get_ydata())
    assert rapid > 20_100.0
    assert speed.get_ylim() == (0.0, pytest.approx(1.2 * rapid))
    assert speed.get_title(loc="left") == "Speed"
    far = _figure("G0 X300\nG1 X200 F4000\nM30\n").axes[-1]
    rapid = np.nanmax(far.lines[0].get_ydata())
    assert far.get_title(loc="left") == f"Speed    (rapids leave the picture: they reach {rapid:,.0f} mm/min)"
    only = _figure("G0 X300\nM30\n").axes[-1]
    assert only.get_ylim() == (0.0, pytest.approx(1.2 * np.nanmax(only.lines[0].get_ydata())))


def test_axes_beyond_three_have_rows_of_their_own_if_they_move() -> None:
    figure = _figure("G91 G1 X10 U7 W5 F900\nM30\n", "card6")
    assert _titles(figure) == ["Plan view", "Perspective", "Speed", "", ""]
    assert [axes.get_ylabel() for axes in figure.axes[3:]] == ["U [mm]", "W [mm]"]
    assert [axes.get_xlabel() for axes in figure.axes[2:]] == ["", "", "time [s]"]
    shown = [axes.xaxis.get_tick_params()["labelbottom"] for axes in figure.axes[2:]]
    assert shown == [False, False, True]
    assert figure.get_size_inches().tolist() == [12.0, 9.0 + 1.5]  # the first row is in the 9
    assert _lines(figure.axes[4])["W [mm]"][-1, 1] == 5.0
    assert figure.axes[3].legend_ is None
    assert _figure(MILLING).get_size_inches().tolist() == [12.0, 9.0]


def test_one_axis_is_drawn_over_time_alone(tmp_path: Path) -> None:
    machine = tmp_path / "slide.toml"
    machine.write_text('name = "slide"\n[[axis]]\nname = "X"\nvmax_mm_s = 90\namax_mm_s2 = 900\n')
    figure = _figure("G1 X5 F300\nM30\n", str(machine))
    assert [axes.get_ylabel() for axes in figure.axes] == ["path speed\n[mm/min]", "X [mm]"]
    assert figure.legends == []
    assert _lines(figure.axes[1])["X [mm]"][-1, 1] == 5.0


def test_a_lathe_shows_its_axis_wherever_it_turns() -> None:
    figure = _figure("G0 X80 Z-5\nG1 Z-30 F500\nX70\nM30\n", "lathe2")
    low, high = figure.axes[0].get_ylim()
    assert (low, high) == pytest.approx((-0.03 * 80.0, 80.0 + 0.03 * 80.0))
    (line,) = [each for each in figure.axes[0].lines if list(each.get_ydata()) == [0.0, 0.0]]
    assert line.get_color() == "#1b2228"
    colours = [each.get_color() for each in figure.axes[2].lines]
    assert colours == ["#0072b2", "#d55e00"]
    figure.draw_without_rendering()
    legend = figure.axes[2].legend_.get_window_extent()
    assert figure.axes[2].bbox.x1 <= legend.x0  # beside the curves
    assert legend.x1 <= figure.bbox.x1


def test_names_in_the_legend_are_short_and_no_formulas() -> None:
    long = "a name that takes all of the space, and more"
    program = f"({long})\nT2 M6\nG1 X5 F900\n(costs $5)\nT3 M6\nG1 X9\n(one)\nT4 M6\nG1 X12\n(two)\nM8\nG1 X15\nM30\n"
    names = _legend(_figure(program))
    assert names[:3] == ["T2  a name that takes all of the space…", "T3  costs \\$5", "T4"]
    exact = _legend(_figure(f"({'m' * 36})\nT2 M6\nG1 X5 F900\n({'n' * 37})\nT3 M6\nG1 X9\nM30\n"))
    assert exact[:2] == [f"T2  {'m' * 36}", f"T3  {'n' * 35}…"]


def test_the_title_says_what_was_run(tmp_path: Path) -> None:
    long = tmp_path / f"{'p' * 40}_{'q' * 20}.nc"
    long.write_text("G1 X1500 F30000\n")
    result = polycnc.run(long, trace=True)
    title = polycnc.plot(result).get_suptitle()
    assert title.split("    ") == [
        f"{'p' * 35}…{'q' * 9}.nc", "on mill3", polycnc.runner.time_text(result.time_s), "1,500 mm", "1 block",
    ]  # fmt: skip
    fits = tmp_path / f"{'p' * 45}.nc"
    fits.write_text("G1 X1 F900\n")
    assert polycnc.plot(polycnc.run(fits, trace=True)).get_suptitle().startswith(f"{fits.name}    ")


def test_plunges_are_marked_once_for_each_place_and_tool() -> None:
    holes = "G0 X{0} Y3 Z5\nG1 Z-2 F700\nG0 Z5\n"
    program = "T2 M6\n" + holes.format(5) * 2 + holes.format(9) + "T3 M6\n" + holes.format(14) + "M30\n"
    plan = _figure(program).axes[0]
    found = [
        (line.get_color(), line.get_xydata().tolist()) for line in plan.lines if line.get_label() == "plunge"
    ]
    assert found == [("#0072b2", [[5.0, 3.0], [9.0, 3.0]]), ("#d55e00", [[14.0, 3.0]])]


def test_of_more_than_twenty_tools_the_rest_is_counted() -> None:
    program = "".join(f"T{tool} M6\nG1 X{3 * tool} F9000\n" for tool in range(1, 22))
    assert _legend(_figure(program + "M30\n"))[19:21] == ["T20", "and 1 more tool"]
    twenty = "".join(f"T{tool} M6\nG1 X{3 * tool} F9000\n" for tool in range(1, 21))
    assert _legend(_figure(twenty + "M30\n"))[19:] == ["T20", "start", "end"]


def test_a_picture_with_stock_shows_the_solid() -> None:
    """Its surface reaches as high and as low as the body, in machine coordinates."""
    program = "(T1 D=6. CR=0. - flat end mill)\nT1 M6\nS900 M3\nG0 X3 Y4 Z9\nG1 Z-3 F600\nX41 Y19\nM30\n"
    result = polycnc.run(program, "mill3", trace=True, stock="box=-4,-5,-7,50,30,0", resolution_mm=1.0)
    figure = result.plot()
    (solid,) = (axes for axes in figure.axes if axes.name == "3d")
    assert solid.get_title(loc="left") == "What is left of the stock"
    assert solid.get_xlim() == pytest.approx((-4.0, 50.0), abs=1.1)
    limits: Any = solid
    assert limits.get_zlim() == pytest.approx((-7.0, 0.0), abs=0.2)
    assert len(solid.collections) == 1
    assert not solid.lines
