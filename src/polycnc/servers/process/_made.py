"""What a machine of any kind is made of, and what it is once it is made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from polycnc.cnc import Control
from polycnc.machine import Device
from polycnc.servers.machines import NO_PARAMETERS, NO_SIGNALS, NO_VARIABLES, Programs, Screen, Tasks, Values


@dataclass(frozen=True, slots=True)
class Machinery:
    """What a machine is to be made of: `file` is its machine, system or card file, None for the kind's own default.

    `channels` are the axes of each channel; without any, one has them all.
    """

    name: str = "machine"
    file: str | Path | None = None
    memory: Path | None = None
    axes: int = 3
    characters: int = 128_000
    channels: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True, slots=True)
class Made:
    """A device with its control and what its operator does in its own way.

    `load` takes the name and bytes of a file over and selects the program; None where no part programs run. `programs`
    are None where they are those of the control's memory as they come. `folder` is where the control keeps its programs
    as files, if it does.
    """

    device: Device[Any]
    find_control: Callable[[], Control] | None = None
    own: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    end: Callable[[], None] = lambda: None
    load: Callable[[str, bytes], None] | None = None
    parameters: Values = NO_PARAMETERS
    variables: Values = NO_VARIABLES
    signals: Values = NO_SIGNALS
    screen: Screen | None = None
    tasks: Tasks | None = None
    programs: Programs | None = None
    folder: Path | None = None
