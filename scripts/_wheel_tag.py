"""The name of a wheel with compiled functions: it is for this Python and this platform, a plain one for all."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class WheelTag(BuildHookInterface[Any]):
    """Called by hatchling, see `pyproject.toml`."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Say what the wheel is for."""
        if any((Path(self.root) / "src" / "polycnc" / "_compiled").glob("*.nbc")):
            build_data["infer_tag"] = True
            build_data["pure_python"] = False
