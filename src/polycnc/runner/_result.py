"""The result of a run as programs get it: what the run gave, as a table, a page and a picture."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from polycnc.errors import UsageError
from polycnc.runner._outcome import RunOutcome, Trace, time_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from polycnc.runner.view._view import View


class RunResult(RunOutcome):
    """Say how a program ran; show it."""

    def _repr_html_(self) -> str:
        """Return times, axes and what went wrong as a table, for notebooks."""
        from polycnc.web import html_table

        rows = [
            ("cutting", time_text(self.cutting_time_s), f"{self.cutting_path_mm:,.3f} mm"),
            ("rapid", time_text(self.rapid_time_s), f"{self.rapid_path_mm:,.3f} mm"),
            ("waiting", time_text(self.waiting_time_s), ""),
            *(
                (f"{axis} ({self.axis_units[axis]})", f"{low:,.3f}", f"{high:,.3f}")
                for axis, (low, high) in self.extents_mm.items()
            ),
            *((f"T{each.tool} {each.name}", time_text(each.time_s), "") for each in self.operations),
        ]
        return html_table(str(self), ("", "", ""), rows) + self._picture()

    def _picture(self) -> str:
        """Return a small picture of the path, where there is a trace of it."""
        if self.trace is None or self.trace.execution is None or self.config is None:
            return ""
        from polycnc.runner.batches._thumbnail import picture
        from polycnc.runner.view._track import TrackCollector

        collector = TrackCollector(self.trace.units, most=2_000)
        collector.add_trace(self.trace, self.trace.execution)
        return picture(collector.track(self.trace.execution), self.config, 320)

    def view(self) -> View:
        """Return a page that shows the run: save it, open it, or leave it to a notebook to show.

        Raises:
            UsageError: the result has no trace.
        """
        from polycnc.runner.view._view import view_of_trace

        if self.trace is None or self.trace.execution is None:
            raise UsageError("there is nothing to view: the result has no trace", hint="Run with trace=True.")
        return view_of_trace(self, self.trace, self.trace.execution)

    def plot(self, path: str | Path | None = None) -> Figure:
        """Draw the run to a .png, .svg or .pdf file; return the matplotlib figure. Without a path nothing is written.

        Raises:
            UsageError: no trace, an unknown extension, no such folder, or matplotlib is not installed.
        """
        from polycnc.runner.plots._plot import plot

        return plot(self, path)


class TracedResult(RunResult):
    """A result that has its trace for certain."""

    if TYPE_CHECKING:

        @property
        def trace(self) -> Trace: ...
