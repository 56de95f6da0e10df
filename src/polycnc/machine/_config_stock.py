"""What is clamped on the machine: the body that is cut, and what holds it."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from polycnc.machine._toml import StrictModel

_Form = Annotated[str, Field(min_length=1, max_length=1000)]


class StockConfig(StrictModel):
    """Describe the body that programs cut."""

    form: _Form = Field(
        description="`auto`, `box=X0,Y0,Z0,X1,Y1,Z1`, `cylinder=D,Z0,Z1` or an STL file, as for `--stock`."
    )
    resolution_mm: Annotated[float, Field(gt=0, le=1e6)] | None = Field(
        default=None, description="Width of a cell; absent: by the size of the body."
    )


class FixtureConfig(StrictModel):
    """Describe something that tools must not touch."""

    form: _Form = Field(
        description="`box=X0,Y0,Z0,X1,Y1,Z1`, `cylinder=D,Z0,Z1` or an STL file, as for `--fixture`."
    )
