"""Series of controls as clients tell them apart on the wire, each a small data file."""

from __future__ import annotations

from importlib.resources import files

from pydantic import Field

from polycnc.errors import UsageError
from polycnc.machine import StrictModel, parse_toml, validate

PROFILES = ("power-mate", "16i", "0i-d", "31i")


class Profile(StrictModel):
    """What a series answers with."""

    frame_version: int = Field(ge=1, le=5)
    cnc_type: str = Field(min_length=2, max_length=2)
    machine_type: str = Field(min_length=2, max_length=2)
    series: str = Field(min_length=4, max_length=4)
    software: str = Field(min_length=4, max_length=4)
    additional_info: int = Field(ge=0, le=0xFFFF)
    most_axes: int = Field(ge=1, le=32)
    wide_values: bool
    """Parameters in eight bytes under their new command codes, else in four under the old ones."""
    old_states: bool
    """States in the numbers of the function library's manual, else in those of later series."""
    system_variables: bool = True
    """System variables of macros are read like other ones; the library's manual knows local and common ones."""
    refused: tuple[int, ...] = ()
    """Command codes that this series does not know."""
    program_characters: int = Field(default=128_000, gt=0)
    """The size of the program memory of a control that is served."""
    last_alarm_type: int = 15
    """The largest number of a group of alarms."""
    most_sessions: int = 5
    most_spindles: int = Field(default=8, ge=1, le=8)

    @property
    def most_body(self) -> int:
        """The bytes that the library accepts in the body of a reply of this frame version."""
        return 1450 if self.frame_version <= 2 else 2910 if self.frame_version == 3 else 3470


def load_profile(name: str) -> Profile:
    """Return one of the `PROFILES`.

    Raises:
        UsageError: There is no such profile.
    """
    if name not in PROFILES:
        raise UsageError(f"there is no profile '{name}'", hint=f"There are {', '.join(PROFILES)}.")
    text = (files("polycnc.servers.focas") / "profiles" / f"{name}.toml").read_text(encoding="utf-8")
    return validate(Profile, *parse_toml(text, name))
