"""Read a FluidNC configuration, which is YAML."""

from __future__ import annotations

import re
from typing import Any

from polycnc.errors import ConfigurationError, SourcePosition, UsageError
from polycnc.runner.machine_sources._facts import AXIS_LETTERS, AxisFacts, Entry, Facts, Settings, others

CONTROL = "a FluidNC configuration"
DEVIATION_MM, SPEED_MM_MIN, ACCELERATION_MM_S2, TRAVEL_MM = 0.01, 1000.0, 25.0, 1000.0  # the control's own
LEFT_OUT = {"arc_tolerance_mm": "arcs are traversed as arcs, not as chords"}


def recognises(text: str) -> bool:
    """Tell whether `text` has axes with the keys of such a file."""
    return re.search(r"^axes:", text, re.MULTILINE) is not None and "mm_per_min" in text


def read(text: str, file: str) -> Facts:
    """Return what the configuration says.

    Raises:
        UsageError: PyYAML is not installed.
        ConfigurationError: The text is no YAML, a value is no number, or there is no axis.
    """
    settings = Settings(file, _entries(text, file))
    axes = []
    for name in AXIS_LETTERS:
        lead = f"axes.{name.lower()}."
        if not any(key.startswith(lead) for key in settings.entries):
            continue
        travel = settings.positive(lead + "max_travel_mm", TRAVEL_MM)
        position = settings.number(lead + "homing.mpos_mm", 0.0)
        limits = None
        if settings.switch(lead + "soft_limits"):
            up = settings.switch(lead + "homing.positive_direction", default=True)
            limits = (position - travel, position) if up else (position, position + travel)
        axes.append(
            AxisFacts(
                name,
                settings.positive(lead + "max_rate_mm_per_min", SPEED_MM_MIN) / 60.0,
                settings.positive(lead + "acceleration_mm_per_sec2", ACCELERATION_MM_S2),
                limits=limits,
                home=position if limits is not None else 0.0,
            )
        )
    if not axes:
        raise ConfigurationError(f"{file}: there is no axis", hint="Axes lie under 'axes:', like x: and y:.")
    has_laser = any(name.lower().startswith("laser.") for name in settings.entries)
    return Facts(
        control=CONTROL,
        axes=tuple(axes),
        spindle={"laser": True} if has_laser else {},
        path={"junction_deviation_mm": settings.positive("junction_deviation_mm", DEVIATION_MM)},
        left_out=others(settings, LEFT_OUT),
    )


def _entries(text: str, file: str) -> dict[str, Entry]:
    try:
        import yaml
    except ImportError:
        raise UsageError(
            "a FluidNC configuration is YAML, and PyYAML is not installed", hint="pip install 'polycnc[yaml]'"
        ) from None
    try:
        tree = yaml.compose(text, Loader=yaml.SafeLoader)
    except (yaml.YAMLError, RecursionError) as error:
        mark = getattr(error, "problem_mark", None)
        lines = text.splitlines()
        position = (
            SourcePosition(file, mark.line + 1, mark.column + 1, lines[mark.line])
            if mark is not None and mark.line < len(lines)
            else None
        )
        what = getattr(error, "problem", None) or "it cannot be read"
        raise ConfigurationError(f"this is no YAML: {what}", position=position, hint="Correct it.") from None
    found: dict[str, Entry] = {}
    _walk(tree, "", found, file, text.splitlines())
    return found


def _walk(node: Any, lead: str, found: dict[str, Entry], file: str, lines: list[str]) -> None:
    """Collect the plain values below `node`, "a.b.c" by the keys that lead to them."""
    waiting = [(node, lead)]
    seen: set[int] = set()
    while waiting:
        each, name = waiting.pop(0)
        if id(each) in seen or each is None:  # an alias may lead back
            continue
        seen.add(id(each))
        if each.id == "mapping":
            waiting.extend((value, f"{name}{key.value}.") for key, value in each.value if key.id == "scalar")
        elif each.id == "scalar":
            mark = each.start_mark
            position = SourcePosition(file, mark.line + 1, mark.column + 1, lines[mark.line] if lines else "")
            found[name[:-1]] = Entry(name[:-1], each.value, position)
