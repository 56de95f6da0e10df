"""Read a Smoothieware configuration: a name and a value on each line."""

from __future__ import annotations

import re

from polycnc.errors import SourcePosition
from polycnc.runner.machine_sources._facts import AxisFacts, Entry, Facts, Settings, others

CONTROL = "a Smoothieware configuration"
LINE = re.compile(r"\s*([a-zA-Z_][\w.]*)\s+([^\s#]+)")
ACTUATORS = {"X": "alpha", "Y": "beta", "Z": "gamma", "A": "delta", "B": "epsilon", "C": "zeta"}
DEVIATION_MM = 0.05  # what the control takes where the file says nothing
LEFT_OUT = {
    "z_junction_deviation": "one deviation holds for all corners",
    "mm_per_arc_segment": "arcs are traversed as arcs, not as chords",
    "mm_max_arc_error": "arcs are traversed as arcs, not as chords",
    "default_seek_rate": "rapids go as fast as the axes",
    "default_feed_rate": "a program says its feed",
    "minimum_planner_speed": "the path may come to rest",
}


def recognises(text: str) -> bool:
    """Tell whether `text` has the steps or the highest rate of the first actuator, as this control writes them."""
    return re.search(r"^\s*alpha_(max_rate|steps_per_mm)\s+[\d.]", text, re.MULTILINE) is not None


def read(text: str, file: str) -> Facts:
    """Return what the configuration says.

    Raises:
        ConfigurationError: A value is no number, or a speed or acceleration is not there.
    """
    settings = _settings(text, file)
    common = settings.need("acceleration", "the acceleration of all axes").positive
    axes = []
    for name, actuator in ACTUATORS.items():
        rate = settings.get(f"{actuator}_max_rate")
        asked = settings.get(f"{name.lower()}_axis_max_speed")
        if rate is None and asked is None:
            if name in "XYZ":
                settings.need(f"{actuator}_max_rate", f"the highest rate of axis {name}")
            continue
        speed = min(each.positive for each in (rate, asked) if each is not None) / 60.0
        limits = None
        if settings.switch("soft_endstop.enable"):
            low = settings.get(f"soft_endstop.{name.lower()}_min")
            high = settings.get(f"soft_endstop.{name.lower()}_max")
            limits = (low.number, high.number) if low is not None and high is not None else None
        own = settings.positive(f"{actuator}_acceleration", common)
        if name == "Z":
            own = settings.positive("z_acceleration", own)
        towards_max = settings.get(f"{actuator}_homing_direction")
        side = "max" if towards_max is not None and towards_max.text == "home_to_max" else "min"
        home = settings.number(f"{actuator}_{side}", 0.0) if limits is not None else 0.0
        axes.append(AxisFacts(name, speed, own, limits=limits, home=home))
    return Facts(
        control=CONTROL,
        axes=tuple(axes),
        path={"junction_deviation_mm": settings.positive("junction_deviation", DEVIATION_MM)},
        left_out=others(settings, LEFT_OUT),
    )


def _settings(text: str, file: str) -> Settings:
    entries: dict[str, Entry] = {}
    for number, line in enumerate(text.splitlines(), 1):
        if match := LINE.match(line):
            position = SourcePosition(file, number, match.start(2) + 1, line)
            entries[match[1]] = Entry(match[1], match[2], position)
    return Settings(file, entries)
