"""See a run: one self-contained page with the path in three dimensions, time, blocks, tools, speed."""

from polycnc.runner.view._page import Beside, Mark, page
from polycnc.runner.view._part_frame import turns, with_part_frame
from polycnc.runner.view._preview import Preview, preview
from polycnc.runner.view._program_view import view_program
from polycnc.runner.view._thin import kept_rows
from polycnc.runner.view._track import MOST_POINTS, Track, TrackCollector
from polycnc.runner.view._view import VIEW_FORMATS, View, check_view_file, open_in_browser, view_of_trace

__all__ = [
    "MOST_POINTS",
    "VIEW_FORMATS",
    "Beside",
    "Mark",
    "Preview",
    "Track",
    "TrackCollector",
    "View",
    "check_view_file",
    "kept_rows",
    "open_in_browser",
    "page",
    "preview",
    "turns",
    "view_of_trace",
    "view_program",
    "with_part_frame",
]
