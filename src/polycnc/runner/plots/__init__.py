"""Draw a run as a picture: the path, each tool in its colour, speed and axes over time."""

from polycnc.runner.plots._plot import PLOT_FORMATS, check_plot_file, plot, plot_track
from polycnc.runner.plots._styles import END, RAPID, tool_colour

__all__ = ["END", "PLOT_FORMATS", "RAPID", "check_plot_file", "plot", "plot_track", "tool_colour"]
