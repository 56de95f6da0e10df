"""A view of a run: made from a program or from a result with its trace; saved, opened, or shown in a notebook."""

from __future__ import annotations

import html
import webbrowser
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.nc import ProgramText
from polycnc.outputs import check_output, complete_or_absent, keep_inputs
from polycnc.runner._blocks import Execution
from polycnc.runner._outcome import RunOutcome, Trace
from polycnc.runner.view._page import page
from polycnc.runner.view._track import TrackCollector

VIEW_FORMATS = (".html", ".htm")
_GENERATOR = b'name="generator" content="polycnc view"'
_NOTEBOOK_PX = 720


@dataclass(frozen=True)
class View:
    """A page that shows a run, as HTML that loads nothing from elsewhere.

    `inputs` are files that the run was made from; the page is never written over one of them.
    """

    html: str = field(repr=False)
    result: RunOutcome
    inputs: tuple[Path, ...] = ()

    def save(self, path: str | Path) -> Path:
        """Write the page to an .html file and return its path.

        Raises:
            UsageError: another extension, no such folder, or the file is one that the run was made from.
        """
        target = check_view_file(path, self.inputs)
        with complete_or_absent(target) as partial:
            partial.write_text(self.html, encoding="utf-8", newline="\n")
        return target

    def _repr_html_(self) -> str:
        """Show the page in a notebook, in a frame of its own."""
        page = html.escape(self.html)
        return f'<iframe srcdoc="{page}" style="width:100%;height:{_NOTEBOOK_PX}px;border:0"></iframe>'


def check_view_file(
    path: str | Path, inputs: Iterable[str | Path] = (), *, replaces_views_only: bool = False
) -> Path:
    """Return the path of a view that could be written there; with `replaces_views_only` over no file but another view.

    Raises:
        UsageError: another extension, no such folder, one of `inputs`, another file.
    """
    target = check_output(path, VIEW_FORMATS, "a view")
    keep_inputs(target, inputs, "a view")
    if replaces_views_only and target.exists() and not _is_view(target):
        raise UsageError(
            f"{target} exists and is no view of polycnc",
            hint="Name the page with -o, or move that file away.",
        )
    return target


def _is_view(path: Path) -> bool:
    with path.open("rb") as file:
        return _GENERATOR in file.read(1024)


def open_in_browser(path: Path) -> bool:
    """Open a page with the system's browser; return whether one was found."""
    return webbrowser.open(path.resolve().as_uri())


def view_of_trace(result: RunOutcome, trace: Trace, execution: Execution) -> View:
    """Return the view of a result with its trace."""
    collector = TrackCollector(trace.units, laser=None if trace.power is None else result.config)
    collector.add_trace(trace, execution)
    axes = tuple(zip(trace.axes, trace.units, strict=True))
    shown = page(result, axes, collector.track(execution), execution.texts)
    return View(shown, result, files_of(execution.texts, result.source))


def files_of(texts: dict[str, ProgramText], main: ProgramText | None) -> tuple[Path, ...]:
    """Return the files that a run was made from."""
    names = [*texts, *([] if main is None else [main.name])]
    return tuple(dict.fromkeys(Path(name) for name in names if "\0" not in name))
