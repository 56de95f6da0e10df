"""What part programs find beside them: folders, a file of parameters, and values by name."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field

from polycnc.machine._toml import StrictModel

MostNames = Annotated[dict[str, float], Field(max_length=10_000)]


class ProgramsConfig(StrictModel):
    """Say what programs with a language of their own find beside them."""

    folders: tuple[str, ...] = Field(
        default=(),
        description="Folders in which sub-programs in files of their own are looked for, after that of the program; "
        "relative to the machine file.",
    )
    parameter_file: str | None = Field(
        default=None,
        description="File with the parameters that programs begin with, number and value a line; relative to the "
        "machine file.",
    )
    parameters_inch: bool = Field(
        default=False,
        description="Offsets and tools in parameters, and lengths in that file, are inches, not mm.",
    )
    settings: Annotated[dict[str, MostNames], Field(max_length=10_000)] = Field(
        default={},
        description="Numbers that programs read by section and name, like `TOOLSENSOR = { X = 12.5 }`.",
    )
    pins: MostNames = Field(
        default={},
        description='Numbers that programs read by the name of a pin, like `"spindle.0.on" = 1`; names of points in '
        "`[io]` are read as they are.",
    )

    remaps: Annotated[dict[str, str], Field(max_length=1000)] = Field(
        default={},
        description='Codes that the control defines anew, and where: `"M6" = "line 12 of mill.ini"`. They are '
        "refused.",
    )

    def beside(self, folder: Path) -> ProgramsConfig:
        """Return the same with files and folders as seen from where polycnc is started."""
        file = self.parameter_file
        return self.model_copy(
            update={
                "folders": tuple(str(folder / each) for each in self.folders),
                "parameter_file": None if file is None else str(folder / file),
            }
        )
