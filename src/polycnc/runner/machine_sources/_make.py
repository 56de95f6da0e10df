"""Find out what control a configuration belongs to, and make its machine file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from polycnc.errors import ConfigurationError
from polycnc.machine import parse_machine
from polycnc.runner.machine_sources import _fanuc, _fluidnc, _grbl, _klipper, _linuxcnc, _smoothie
from polycnc.runner.machine_sources._facts import Facts
from polycnc.runner.machine_sources._write import machine_text

LARGEST_BYTES = 16 << 20


@dataclass(frozen=True, slots=True)
class Control:
    """A control whose configuration can be read."""

    what: str
    recognises: Callable[[str], bool]
    read: Callable[[str, str], Facts]


CONTROLS = tuple(
    Control(module.CONTROL, module.recognises, module.read)
    for module in (_linuxcnc, _klipper, _fluidnc, _smoothie, _fanuc, _grbl)
)


def machine_from(path: str | Path) -> str:
    """Return the text of a machine file made from a control's configuration; comments list what was left out.

    Raises:
        ConfigurationError: The file cannot be read or belongs to no control known here, a setting is missing or is no
            number, or what it says is no machine.
    """
    path = Path(path)
    text = _text_of(path)
    for control in CONTROLS:
        if control.recognises(text):
            made = machine_text(control.read(text, str(path)), path.stem or "machine", path.name)
            parse_machine(made, f"{path} as a machine file")
            return made
    known = ", ".join(control.what for control in CONTROLS)
    raise ConfigurationError(
        f"{path}: this is the configuration of no control that is known here", hint=f"Known: {known}."
    )


def _text_of(path: Path) -> str:
    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise ConfigurationError(f"{path} is too large for a configuration", hint="Name another file.")
        return path.read_bytes().decode("utf-8-sig", errors="replace")
    except OSError as error:
        raise ConfigurationError(
            f"{path} cannot be read: {error.strerror or error}", hint="Check its name and your rights."
        ) from None
