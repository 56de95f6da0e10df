"""Draw a run as a picture: the path, each tool in its colour, speed and axes over time."""

from polycnc.runner.plots._plot import PLOT_FORMATS, check_plot_file, plot, plot_track

__all__ = ["PLOT_FORMATS", "check_plot_file", "plot", "plot_track"]
