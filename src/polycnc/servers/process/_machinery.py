"""What a machine of any kind is made of."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


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
