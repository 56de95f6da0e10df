"""Check what is asked against the rows of the commands and carry it out; the models are made from the rows."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, create_model

from polycnc.cnc import ControlError, Refusal
from polycnc.errors import PolycncError
from polycnc.servers.commands._rows import COMMANDS, Command, Parameter
from polycnc.servers.machines import ServedMachine

NUMBERS = {reason: number for number, reason in enumerate(Refusal, 1)}
"""The numbers of refusals that have none of their control, by reason."""
_MOST_MARKS = 1000


class NotMeantError(ControlError):
    """What was asked is not of the form that it has to have: no control was asked."""

    def __init__(self, what: str, hint: str) -> None:
        super().__init__(Refusal.DATA, what, hint=hint)


class Asked(BaseModel):
    """What every command has: unknown fields are refused, and numbers have to be numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def _type(parameter: Parameter) -> Any:
    low, high = parameter.low, parameter.high
    number = Annotated[float, Field(ge=low, le=high, allow_inf_nan=False)]
    whole = Annotated[int, Field(ge=low, le=high)]
    if parameter.choices:
        return Literal[parameter.choices]
    match parameter.kind:
        case "text":
            return Annotated[str, Field(min_length=int(low or 0), max_length=int(high or 0))]
        case "whole":
            return whole
        case "switch":
            return bool
        case "marks":
            return Annotated[list[whole], Field(max_length=_MOST_MARKS)]
        case "values":
            value = number | Annotated[str, Field(max_length=255)]
            return Annotated[dict[Annotated[str, Field(max_length=32)], value], Field(max_length=64)]
        case _:
            return number


@cache
def model_of(name: str) -> type[Asked]:
    """Return the model that checks a command."""
    row = COMMANDS[name]
    fields: dict[str, Any] = {"command": (Literal[name], Field(description=row.what))}
    for each in row.parameters:
        what = f"{each.what} ({each.unit})" if each.unit else each.what
        kind, default = _type(each), ... if each.required else each.default
        if not each.required and each.default is None:
            kind = kind | None
        fields[each.name] = (kind, Field(default, description=what))
    return create_model("".join(map(str.title, name.split("_"))), __base__=Asked, **fields)


def carry_out(machine: ServedMachine, asked: Mapping[str, Any]) -> object:
    """Carry out a command, between two cycles: `command` is its name, the other fields are its parameters.

    Raises:
        ControlError: There is no such command, a value that it does not take, or the control refuses it; nothing has
            changed.
    """
    name = asked.get("command")
    if not isinstance(name, str) or name not in COMMANDS:
        raise NotMeantError(f"there is no command {name!r:.80}", f"Commands are {', '.join(COMMANDS)}.")
    row = COMMANDS[name]
    control = machine.control
    if control is None:
        raise ControlError(
            Refusal.DATA, f"machine {machine.name} has no operator", hint="Command it by its library."
        )
    try:
        values = model_of(name).model_validate(dict(asked)).model_dump(exclude={"command"})
    except ValidationError as error:
        raise NotMeantError(f"{name}: {told(error)}", _takes(row)) from None
    own = machine.own.get(name)
    try:
        return row.call(control, **values) if own is None else own(**values)
    except ControlError:
        raise
    except PolycncError as error:
        raise ControlError(Refusal.DATA, error.what, hint=error.hint) from error


_PLAIN = {"extra_forbidden": "there is no such value", "missing": "it is missing"}


def told(error: ValidationError) -> str:
    """Return what is wrong first, after its place."""
    first = error.errors(include_url=False, include_input=False, include_context=False)[0]
    place = ".".join(str(each)[:32] for each in first["loc"])
    what = _PLAIN.get(first["type"]) or first["msg"].removeprefix("Value error, ")[:200]
    return f"{place}: {what}" if place else what


def _takes(row: Command) -> str:
    if not row.parameters:
        return "It takes nothing else."
    return "It takes " + ", ".join(each.name for each in row.parameters) + "."
