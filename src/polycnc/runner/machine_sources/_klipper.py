"""Read a Klipper printer.cfg."""

from __future__ import annotations

from polycnc.errors import ConfigurationError
from polycnc.runner.machine_sources._facts import AxisFacts, Facts, LeftOut, Settings, others
from polycnc.runner.machine_sources._ini import read_sections, sections_of

CONTROL = "a Klipper configuration"
SQUARE_CORNER_MM_S = 5.0  # what the control takes where the file says nothing
CARTESIAN = ("cartesian", "corexy", "corexz", "hybrid_corexy", "hybrid_corexz")
CRUISE_RATIO = 0.5  # the same


def recognises(text: str) -> bool:
    """Tell whether `text` has a section [printer] with a highest speed."""
    return "printer" in sections_of(text) and "max_velocity" in text


def read(text: str, file: str) -> Facts:
    """Return what the configuration says.

    Raises:
        ConfigurationError: A value is no number, or the highest speed or acceleration is not there.
    """
    settings = read_sections(text, file, comments=("#", ";"), fold=True)
    speed = settings.need("printer.max_velocity", "the highest speed").positive
    acceleration = settings.need("printer.max_accel", "the highest acceleration").positive
    kinematics = settings.get("printer.kinematics")
    if kinematics is not None and kinematics.text == "none":
        raise kinematics.error("the printer has no kinematics, so it has no axes", "Name its kinematics.")
    straight = kinematics is None or kinematics.text in CARTESIAN
    axes = tuple(_axis(settings, name, speed, acceleration, straight=straight) for name in "XYZ")
    corner = settings.number("printer.square_corner_velocity", SQUARE_CORNER_MM_S)
    if corner <= 0.0:
        raise ConfigurationError(
            f"{file}: a square corner velocity of {corner:g} stops at every corner",
            hint="Write square_corner_velocity above zero.",
        )
    cruise = _cruise_ratio(settings, acceleration)
    left = others(settings, {})
    for name in sections_of(text):
        if name.startswith("include "):
            left = (
                LeftOut(f"[{name}]", "that file is not read; copy what it says of [printer] into this one"),
                *left,
            )
    if not straight and kinematics is not None:
        left = (
            LeftOut(f"kinematics {kinematics.text}", "speeds and accelerations are those of the tool"),
            *left,
        )
    return Facts(
        control=CONTROL,
        axes=axes,
        left_out=left,
        path={
            "speed_limit_mm_s": speed,
            "acceleration_limit_mm_s2": acceleration,
            "square_corner_mm_s": corner,
            "minimum_cruise_share": cruise,
        },
    )


def _axis(settings: Settings, name: str, speed: float, acceleration: float, *, straight: bool) -> AxisFacts:
    """Return an axis; its stepper says how far it goes where it moves that axis alone."""
    stepper = f"stepper_{name.lower()}"
    low = settings.number(f"{stepper}.position_min", 0.0)
    high = settings.get(f"{stepper}.position_max")
    limits = (low, high.number) if straight and high is not None else None
    if limits is not None and high is not None and limits[0] >= limits[1]:
        raise high.error(
            f"axis {name} has no travel: {limits[0]:g} to {limits[1]:g}",
            "Write position_max above position_min.",
        )
    home = settings.number(f"{stepper}.position_endstop", 0.0) if limits else 0.0
    if name == "Z":
        speed = min(settings.positive("printer.max_z_velocity", speed), speed)
        acceleration = min(settings.positive("printer.max_z_accel", acceleration), acceleration)
    return AxisFacts(name, speed, acceleration, limits=limits, home=home)


def _cruise_ratio(settings: Settings, acceleration: float) -> float:
    """Return the part of the acceleration that speeds between corners leave alone, written in either way."""
    ratio, older = settings.get("printer.minimum_cruise_ratio"), settings.get("printer.max_accel_to_decel")
    if ratio is not None:
        if not 0.0 <= ratio.number < 1.0:
            raise ratio.error(f"a minimum cruise ratio of {ratio.text}", "Write one from 0 up, below 1.")
        return ratio.number
    return CRUISE_RATIO if older is None else max(0.0, 1.0 - older.positive / acceleration)
