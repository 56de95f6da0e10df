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

    `source` is the name of a preset, the path of a machine file (a `Path`, or text with a folder or with the
    ending ".toml"), or a configuration, which is returned as it is. None is the machine "mill3".

    Raises:
        UsageError: There is no such preset.
        ConfigurationError: The file cannot be read, or has an unknown, missing or wrong key.
    """
    if isinstance(source, MachineConfig):
        return source
    if source is None:
        source = DEFAULT_MACHINE
    if isinstance(source, str):
        if source in PRESETS:
            return parse_machine(preset_text(source), f"{source}.toml")
        if not _is_path(source):
            raise UsageError(f"there is no machine '{source}'", hint=_instead(source))
    data, locator = load_toml(source)
    config = validate(MachineConfig, data, locator)
    return config.model_copy(update={"programs": config.programs.beside(Path(source).parent)})


def preset_text(name: str) -> str:
    """Return the machine file of a preset, to read or to start an own file from.

    Raises:
        UsageError: There is no such preset.
    """
    if name not in PRESETS:
        raise UsageError(f"there is no preset '{name}'", hint=_instead(name))
    return (files("polycnc.machine") / "presets" / f"{name}.toml").read_text(encoding="utf-8")


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
