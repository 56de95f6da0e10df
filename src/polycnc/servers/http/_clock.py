"""The clock of a machine: its rate, freezing it, single cycles, a jump to the next event."""

from __future__ import annotations

import asyncio
import time
from typing import Annotated

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field, model_validator

from polycnc.servers.http._body import checked, json_object
from polycnc.servers.http._found import ONE, Found, body
from polycnc.servers.machines import ServedMachine

MOST_STEP, MOST_RATE = 1_000_000, 1000.0
_SHARE_S = 0.01
_Cycles = Annotated[int, Field(ge=1, le=MOST_STEP)]


class ClockShown(BaseModel):
    """How time passes: `rate` seconds of the machine for each of the wall clock, cycles so far and their length (s)."""

    rate: float
    frozen: bool
    cycles: int
    cycle_s: float
    time_s: float


class ClockAsked(BaseModel):
    """One of: `rate`; `freeze`, false lets it go on at its last rate; `step` and `jump` let cycles pass at once.

    `jump` goes on to the next event, for at most so many cycles.
    """

    model_config = ConfigDict(
        extra="forbid", strict=True, json_schema_extra={"minProperties": 1, "maxProperties": 1}
    )
    rate: Annotated[float, Field(ge=0.0, le=MOST_RATE, allow_inf_nan=False)] = 1.0
    freeze: bool = True
    step: _Cycles = 1
    jump: _Cycles = MOST_STEP

    @model_validator(mode="after")
    def _one(self) -> ClockAsked:
        if len(self.model_fields_set) != 1:
            raise ValueError("give one of rate, freeze, step, jump")
        return self


class ClockRoutes:
    """Show and change clocks."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        self._before: dict[str, float] = {}
        router.get(f"{ONE}/clock", summary="The pace of time.")(self.show)
        router.post(
            f"{ONE}/clock",
            summary="Change the pace, freeze, step or jump.",
            openapi_extra=body(ClockAsked.model_json_schema()),
        )(self.change)

    async def show(self, machine: str) -> ClockShown:
        """Return the rate and the cycles that have passed."""
        found = self._found.machine(machine)
        cycles = await found.ask(lambda: found.served.clock.cycles)
        rate, cycle_s = found.keeper.pace.rate, found.served.clock.cycle_s
        return ClockShown(
            rate=rate, frozen=rate == 0.0, cycles=cycles, cycle_s=cycle_s, time_s=cycles * cycle_s
        )

    async def change(self, machine: str, request: Request) -> ClockShown:
        """Set the rate, or let cycles pass beside it; answered when they have passed."""
        found = self._found.machine(machine)
        asked = checked(ClockAsked, await json_object(request))
        match next(iter(asked.model_fields_set)):
            case "rate":
                await self._set_rate(found, asked.rate)
            case "freeze":
                await self._set_rate(found, 0.0 if asked.freeze else self._before.get(machine, 1.0))
            case "step":
                await _step(found, asked.step)
            case _:
                await _jump(found, asked.jump)
        self._found.log.write("clock", machine=machine, **asked.model_dump(include=asked.model_fields_set))
        return await self.show(machine)

    async def _set_rate(self, found: ServedMachine, rate: float) -> None:
        pace = found.keeper.pace
        if pace.rate > 0.0:
            self._before[found.name] = pace.rate
        await found.ask(lambda: setattr(pace, "rate", float(rate)))


async def _step(machine: ServedMachine, cycles: int) -> None:
    """Let cycles pass beside the pace, and wait until they have; other clients are answered meanwhile."""
    pace = machine.keeper.pace
    await machine.ask(lambda: pace.step(cycles))
    while pace.steps_left:  # time has its share of the wall clock, and rests
        await asyncio.sleep(0)
        await machine.ask(lambda: None)


async def _jump(machine: ServedMachine, cycles: int) -> None:
    """Let time pass to the next event, a slice at a time."""
    ended = False
    while not ended and cycles > 0:
        end_s = time.monotonic() + _SHARE_S
        passed, ended = await machine.ask(
            lambda most=cycles, end_s=end_s: machine.served.jump(most, lambda: time.monotonic() >= end_s)  # type: ignore[misc]
        )
        cycles -= passed
        await asyncio.sleep(0)
