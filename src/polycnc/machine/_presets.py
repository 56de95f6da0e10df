"""Find a machine: a preset that comes with polycnc, or a machine file."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from polycnc.errors import UsageError
from polycnc.machine._config import MachineConfig
from polycnc.machine._toml import load_toml, parse_toml, validate

DEFAULT_MACHINE = "mill3"
PRESETS = ("card6", "lathe2", "mill3", "mill5", "vmc3")


def load_machine(source: str | Path | MachineConfig | None = None) -> MachineConfig:
    """Return the machine that `source` names.

    `source` is the name of a preset, also with further axes like "mill3+A", the path of a machine file (a `Path`, or
    text with a folder or with the ending ".toml"), or a configuration, which is returned as it is. None is the machine
    "mill3".

    Raises:
        UsageError: There is no such preset.
        ConfigurationError: The file cannot be read, or has an unknown, missing or wrong key.
    """
    if isinstance(source, MachineConfig):
        return source
    if source is None:
        source = DEFAULT_MACHINE
    if isinstance(source, str):
        if source.partition("+")[0] in PRESETS:
            return parse_machine(preset_text(source), f"{source}.toml")
        if not _is_path(source):
            raise UsageError(f"there is no machine '{source}'", hint=_instead(source))
    data, locator = load_toml(source)
    config = validate(MachineConfig, data, locator)
    return config.model_copy(update={"programs": config.programs.beside(Path(source).parent)})


_ROTARY_AXIS = """
[[axis]]
name = "{name}"
kind = "rotary"
carries = "part"
vmax_deg_s = 180
amax_deg_s2 = 1200
"""
_LINEAR_AXIS = """
[[axis]]
name = "{name}"
vmax_mm_s = 500
amax_mm_s2 = 5000
"""
_ADDED = dict.fromkeys("ABC", _ROTARY_AXIS) | dict.fromkeys("UVW", _LINEAR_AXIS)
ADDED_AXES = "".join(_ADDED)
"""Axes that a preset can have besides its own, like "mill3+A"."""


def preset_text(name: str) -> str:
    """Return the machine file of a preset, to read or to start an own file from; "mill3+A" has a further axis.

    A, B and C turn the part, U, V and W move straight.

    Raises:
        UsageError: There is no such preset, or no such axis to add.
    """
    preset, _, further = name.partition("+")
    if preset not in PRESETS:
        raise UsageError(f"there is no preset '{name}'", hint=_instead(name))
    text = (files("polycnc.machine") / "presets" / f"{preset}.toml").read_text(encoding="utf-8")
    for letter in further:
        if letter not in _ADDED or f'name = "{letter}"' in text:
            raise UsageError(
                f"'{letter}' cannot be added to the axes of {preset}",
                hint=f"Add axes of {', '.join(ADDED_AXES)} that it lacks, each once, like {DEFAULT_MACHINE}+A.",
            )
        text += _ADDED[letter].format(name=letter)
    return text.replace(f'name = "{preset}"', f'name = "{name}"')


def parse_machine(text: str, file: str) -> MachineConfig:
    """Return the machine that the text of a machine file describes; errors speak of `file`.

    Raises:
        ConfigurationError: It is no TOML, or has an unknown, missing or wrong key.
    """
    data, locator = parse_toml(text, file)
    return validate(MachineConfig, data, locator)


def _is_path(source: str) -> bool:
    return source.endswith(".toml") or "/" in source or "\\" in source


def _instead(name: str) -> str:
    from difflib import get_close_matches

    close = get_close_matches(name, PRESETS, n=1)
    question = f"did you mean '{close[0]}'? " if close else ""
    return f"{question}presets: {', '.join(PRESETS)}; a machine file is named by its path, like ./mine.toml"
