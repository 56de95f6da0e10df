"""The rest of a program that an alarm stops: what can be read after the refused block."""

from __future__ import annotations

from dataclasses import replace

from polycnc.nc import ProgramText
from polycnc.runner._outcome import RunOutcome
from polycnc.runner._program_control import has_control
from polycnc.runner._run import run_program
from polycnc.runner._settings import RunSettings
from polycnc.runner.view._track import Track, TrackCollector

_MOST_POINTS = 20_000


def rest_of(text: ProgramText, settings: RunSettings, result: RunOutcome) -> Track | None:
    """Return the path after the block that stopped a run, refused blocks left out; None where nothing can be read.

    A program that a control executes is not run again, since it may write files.
    """
    if result.ok or has_control(settings.dialect_of(text).dialect):
        return None
    config = settings.machine_of(text)
    collector = TrackCollector(tuple(axis.unit for axis in config.axes), most=_MOST_POINTS)
    again = replace(settings, past_errors=True, stock=None, resolution_mm=None)
    whole = run_program(text, again, check=False, tagged_rows=collector.add)
    if whole.refused_s is None:
        return None
    track = collector.track(collector.execution())
    later = track.t_s >= whole.refused_s - track.cycle_s
    if not later.any():
        return None
    return replace(
        track,
        t_s=track.t_s[later],
        position=track.position[later],
        feed_mm_s=track.feed_mm_s[later],
        rapid=track.rapid[later],
    )
