"""What of a machine is set by name: parameters, variables, tools, work offsets."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Path, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from polycnc.servers.commands import carry_out
from polycnc.servers.http._body import checked, json_object
from polycnc.servers.http._documents import as_json
from polycnc.servers.http._found import JSON, ONE, Found, answer, body
from polycnc.servers.machines import NamedValue, ServedMachine, Values

MOST_NAMES = 200
_Any = Annotated[float, Field(allow_inf_nan=False)]
_Number = Annotated[float, Field(ge=-1e6, le=1e6, allow_inf_nan=False)]
_Text = Annotated[str, Field(max_length=255)]
_One = bool | int | _Any | _Text | None
_AxisName = Annotated[str, Field(max_length=16)]
_ToolNumber = Annotated[int, Path(ge=1, le=99_999_999)]
_OffsetName = Annotated[str, Path(pattern=r"^[A-Z][A-Z0-9]{0,7}([.][A-Z0-9]{1,8})?$")]
_ValueName = Annotated[str, Path(min_length=1, max_length=64)]


class ValueAsked(BaseModel):
    """A value that is to be set: one, or one for each axis by name."""

    model_config = ConfigDict(extra="forbid", strict=True)
    value: _One | dict[_AxisName, int | _Any]


class ToolAsked(BaseModel):
    """Fields of a tool that are to be changed (mm); the others stay."""

    model_config = ConfigDict(extra="forbid", strict=True)
    length_mm: _Number = 0.0
    radius_mm: _Number = 0.0
    wear_length_mm: _Number = 0.0
    wear_radius_mm: _Number = 0.0
    description: _Text = ""
    tip: Annotated[int, Field(ge=0, le=9)] = 0
    x_mm: _Number = 0.0
    z_mm: _Number = 0.0
    wear_x_mm: _Number = 0.0
    wear_z_mm: _Number = 0.0
    y_mm: _Number = 0.0


class OffsetAsked(BaseModel):
    """Values of axes that are to be set (mm or degree); with `add` they are added to what is there."""

    model_config = ConfigDict(extra="forbid", strict=True)
    values: Annotated[dict[_AxisName, _Number], Field(max_length=32)]
    add: bool = False


class ValueShown(BaseModel):
    """A value with what can be set: numbers from `low` to `high`, one of `choices`."""

    name: str
    value: Any
    what: str
    low: float | None
    high: float | None
    choices: list[str]
    writable: bool


class DataRoutes:
    """Show and set what is set by name."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        for part in ("parameters", "variables", "signals"):
            read_all, read, write = self._of(part)
            at = f"{ONE}/{part}"
            router.get(at, summary=f"The {part}, or some of them.", response_model=list[ValueShown])(read_all)
            router.get(f"{at}/{{name}}", summary="One of them.", response_model=ValueShown)(read)
            router.put(f"{at}/{{name}}", summary="Set one.", response_model=ValueShown,
                openapi_extra=body(ValueAsked.model_json_schema()))(write)  # fmt: skip
        router.put(
            f"{ONE}/tools/{{number}}",
            summary="Change a tool, or make it.",
            openapi_extra=body(ToolAsked.model_json_schema()),
            response_class=Response,
            responses=answer({"type": "object"}),
        )(self.set_tool)
        router.delete(f"{ONE}/tools/{{number}}", summary="Take a tool out.", status_code=204)(
            self.remove_tool
        )
        router.put(
            f"{ONE}/offsets/{{name}}",
            summary="Set or shift a work offset.",
            openapi_extra=body(OffsetAsked.model_json_schema()),
            response_class=Response,
            responses=answer({"type": "object"}),
        )(self.set_offset)

    def _of(self, part: str) -> tuple[Callable[..., Any], Callable[..., Any], Callable[..., Any]]:
        async def read_all(
            machine: str,
            names: Annotated[str, Query(max_length=4096, description="Names, with commas.")] = "",
        ) -> Response:
            found = self._found.machine(machine)
            values: Values = getattr(found, part)
            wanted = [each.strip() for each in names.split(",") if each.strip()][:MOST_NAMES]
            return await _shown(
                found, lambda: [values.get(name) for name in wanted] if wanted else list(values.all())
            )

        async def read(machine: str, name: _ValueName) -> Response:
            found = self._found.machine(machine)
            values: Values = getattr(found, part)
            return await _shown(found, lambda: values.get(name))

        async def write(machine: str, name: _ValueName, request: Request) -> Response:
            found = self._found.machine(machine)
            values: Values = getattr(found, part)
            value = checked(ValueAsked, await json_object(request)).value

            def written() -> NamedValue:
                values.set(name, value)
                return values.get(name)

            answered = await _shown(found, written)
            self._found.log.write(part, machine=machine, name=name, value=value)
            return answered

        for function, name in ((read_all, part), (read, f"{part}_one"), (write, f"set_{part}")):
            function.__name__ = name
        return read_all, read, write

    async def set_tool(self, machine: str, number: _ToolNumber, request: Request) -> Response:
        """Change fields of a tool; the answer is the tool."""
        found, control = self._found.operated(machine)
        values = checked(ToolAsked, await json_object(request)).model_dump(exclude_unset=True)
        asked = {"command": "set_tool", "number": number, "values": values}
        return await self._changed(found, asked, lambda: control().tools.get(number))

    async def remove_tool(self, machine: str, number: _ToolNumber) -> Response:
        """Take a tool out of the table."""
        found, _ = self._found.operated(machine)
        await found.ask(lambda: carry_out(found, {"command": "remove_tool", "number": number}))
        return Response(status_code=204)

    async def set_offset(self, machine: str, name: _OffsetName, request: Request) -> Response:
        """Set or shift a work offset; the answer are its values."""
        found, control = self._found.operated(machine)
        values = checked(OffsetAsked, await json_object(request)).model_dump()
        asked = {"command": "set_offset", "name": name, **values}
        return await self._changed(found, asked, lambda: dict(control().offsets.get(name, {})))

    async def _changed(
        self, found: ServedMachine, asked: Mapping[str, Any], read: Callable[[], object]
    ) -> Response:
        def done() -> bytes:
            carry_out(found, asked)
            return as_json(read())

        answered = await found.ask(done)
        self._found.log.write("command", machine=found.name, door="http", asked=asked)
        return Response(answered, media_type=JSON)


async def _shown(machine: ServedMachine, read: Callable[[], object]) -> Response:
    return Response(await machine.ask(lambda: as_json(_finite(read()))), media_type=JSON)


def _finite(value: Any) -> Any:
    """Return values without numbers that JSON does not have."""
    if isinstance(value, list):
        return [_finite(each) for each in value]
    if isinstance(value, NamedValue) and isinstance(value.value, float) and not math.isfinite(value.value):
        return NamedValue(value.name, None, value.what, value.low, value.high, value.choices, value.writable)
    return value
