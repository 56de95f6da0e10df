"""See a run: one self-contained page with the path in three dimensions, time, blocks, tools, speed."""

from polycnc.runner.view._track import MOST_POINTS, Track, TrackCollector
from polycnc.runner.view._view import (
    VIEW_FORMATS,
    View,
    check_view_file,
    open_in_browser,
    view_of_trace,
    view_program,
)

__all__ = [
    "MOST_POINTS",
    "VIEW_FORMATS",
    "Track",
    "TrackCollector",
    "View",
    "check_view_file",
    "open_in_browser",
    "view_of_trace",
    "view_program",
]
