"""Read a LinuxCNC INI file of a machine without its own kinematics."""

from __future__ import annotations

import re

from polycnc.errors import ConfigurationError
from polycnc.runner.machine_sources._facts import (
    AXIS_LETTERS,
    AxisFacts,
    Entry,
    Facts,
    LeftOut,
    Settings,
    others,
)
from polycnc.runner.machine_sources._ini import read_sections, sections_of
from polycnc.runner.machine_sources._linuxcnc_files import numbers_of, programs_of, remaps_of, tools_of
from polycnc.units import MM_PER_INCH

CONTROL = "a LinuxCNC configuration"
INCH = ("inch", "imperial", "in")
TOLERANCE = re.compile(r"G64\s*P\s*([\d.]+)(?:\s*Q\s*([\d.]+))?", re.IGNORECASE)
LEAST_JERK = 1.0  # in the file's unit; with less, or without one, the control takes trapezoids
PERIOD_NS = 1e6
KINK_RATIO, GAP_CYCLES = 0.1, 4.0  # what the control takes where the file says nothing
ARC_SHARE = LAST_SHARE = 0.5  # fixed in its planner
LEFT_OUT = {
    "TRAJ.ARC_BLEND_OPTIMIZATION_DEPTH": "the look-ahead is unlimited",
    "TRAJ.ARC_BLEND_RAMP_FREQ": "short moves speed up and slow down between their corners",
    "TRAJ.ARC_BLEND_ENABLE": "corners are rounded with arcs",
    "TRAJ.ARC_BLEND_FALLBACK_ENABLE": "corners are rounded with arcs",
}


def recognises(text: str) -> bool:
    """Tell whether `text` has the sections of such a file."""
    found = sections_of(text)
    return "TRAJ" in found and any(re.fullmatch(r"(JOINT|AXIS)_\w", name) for name in found)


def read(text: str, file: str) -> Facts:
    """Return what the configuration says.

    Raises:
        ConfigurationError: A value is no number, or an axis has no speed or acceleration.
    """
    settings = read_sections(text, file, comments=(), fold=False)
    unit = settings.get("TRAJ.LINEAR_UNITS")
    to_mm = MM_PER_INCH if unit is not None and unit.text.lower() in INCH else 1.0
    coordinates = settings.need("TRAJ.COORDINATES", "the axes of the machine")
    joints = _joint_letters(settings, coordinates)
    axes = tuple(
        _axis(settings, name, [index for index, letter in enumerate(joints) if letter == name], to_mm)
        for name in dict.fromkeys(joints)
    )
    if not axes:
        raise coordinates.error("no axis is named", "Write them like COORDINATES = X Y Z.")
    kinematics = settings.get("KINS.KINEMATICS")
    period = settings.get("EMCMOT.SERVO_PERIOD")
    top = settings.get("SPINDLE_0.MAX_FORWARD_VELOCITY")
    programs, no_files = programs_of(settings, inch=to_mm != 1.0)
    tools, no_tools = tools_of(settings, to_mm)
    left = (*no_files, *no_tools, *others(settings, LEFT_OUT))
    if kinematics is not None and not kinematics.text.startswith("trivkins"):
        left = (LeftOut(f"kinematics {kinematics.text}", "axes and joints count as the same"), *left)
    return Facts(
        control=CONTROL,
        axes=axes,
        left_out=left,
        path=_path(settings, to_mm),
        spindle={} if top is None else {"max_rpm": top.positive},
        cycle_s=None if period is None else period.positive * 1e-9,
        tools=tools,
        programs=programs,
        settings=numbers_of(settings),
        remaps=remaps_of(text, file),
    )


def _path(settings: Settings, to_mm: float) -> dict[str, float | str]:
    """Return limits of the path, how it goes through corners, and how it rounds and merges moves."""
    path: dict[str, float | str] = {}
    for key, name in (
        ("speed_limit_mm_s", "TRAJ.MAX_LINEAR_VELOCITY"),
        ("acceleration_limit_mm_s2", "TRAJ.MAX_LINEAR_ACCELERATION"),
    ):
        if (entry := settings.get(name)) is not None:
            path[key] = entry.positive * to_mm
    planner, jerk = settings.get("TRAJ.PLANNER_TYPE"), settings.get("TRAJ.MAX_LINEAR_JERK")
    if planner is not None and planner.text == "1" and jerk is not None and jerk.positive >= LEAST_JERK:
        path["jerk_mm_s3"] = jerk.positive * to_mm
    else:
        path |= _corners(settings, (settings.number("EMCMOT.SERVO_PERIOD", PERIOD_NS)) * 1e-9)
    path["path_tolerance_mm"] = "free"  # G64 without P
    start = settings.get("RS274NGC.RS274NGC_STARTUP_CODE")
    tolerance = TOLERANCE.search(start.text) if start is not None else None
    if start is not None and tolerance is not None:
        in_inch = re.search(r"G20\b", start.text) is not None or (to_mm != 1.0 and "G21" not in start.text)
        unit_mm = MM_PER_INCH if in_inch else 1.0
        path["path_tolerance_mm"] = float(tolerance[1]) * unit_mm
        path["merge_mm"] = float(tolerance[2] or tolerance[1]) * unit_mm
    return path


def _corners(settings: Settings, period_s: float) -> dict[str, float | str]:
    """Return how the control passes, rounds and rests in corners."""
    gap = max(0.0, settings.number("TRAJ.ARC_BLEND_GAP_CYCLES", GAP_CYCLES)) * period_s
    return {
        "corner_share": min(max(settings.number("TRAJ.ARC_BLEND_KINK_RATIO", KINK_RATIO), 0.001), 0.5),
        "rounding_share": ARC_SHARE,
        "rounding_gap_s": min(gap, 1.0),
        "last_share": LAST_SHARE,
        "free_overlaps": True,
    }


def _joint_letters(settings: Settings, coordinates: Entry) -> list[str]:
    """Return the axis letter of each joint: those of the kinematics, or one joint for each coordinate."""
    kinematics = settings.get("KINS.KINEMATICS")
    named = re.search(r"coordinates\s*=\s*(\w+)", kinematics.text, re.IGNORECASE) if kinematics else None
    letters = [letter for letter in (named[1] if named else coordinates.text).upper() if not letter.isspace()]
    for letter in letters:
        if letter not in AXIS_LETTERS + "UVW":
            raise coordinates.error(f"'{letter}' is no axis", "Write them like COORDINATES = X Y Z.")
    return letters


def _axis(settings: Settings, name: str, joints: list[int], to_mm: float) -> AxisFacts:
    sections = [
        f"AXIS_{name}",
        *(f"JOINT_{joint}" for joint in joints),
        *(f"AXIS_{joint}" for joint in joints),
    ]
    scale = 1.0 if name in "ABC" else to_mm

    def values(key: str) -> list[Entry]:
        found = (settings.get(f"{section}.{key}") for section in sections)
        return [entry for entry in found if entry is not None]

    speeds, accelerations = values("MAX_VELOCITY"), values("MAX_ACCELERATION")
    for key, each in (("MAX_VELOCITY", speeds), ("MAX_ACCELERATION", accelerations)):
        if not each:
            raise ConfigurationError(
                f"{settings.file}: axis {name} has no {key}",
                hint=f"Write it into [AXIS_{name}], as the control wants it too.",
            )
    lows = [entry.number * scale for entry in values("MIN_LIMIT")]
    highs = [entry.number * scale for entry in values("MAX_LIMIT")]
    limits = (max(lows), min(highs)) if lows and highs else None
    homes = values("HOME")
    home = homes[0].number * scale if homes else 0.0
    if limits is not None and not limits[0] <= home <= limits[1]:
        raise (homes[0] if homes else values("MIN_LIMIT")[0]).error(
            f"axis {name} is at home at {home:g}, outside {limits[0]:g} to {limits[1]:g}",
            "Write HOME inside the limits.",
        )
    return AxisFacts(
        name,
        min(entry.positive for entry in speeds) * scale,
        min(entry.positive for entry in accelerations) * scale,
        limits=limits,
        home=home,
    )
