"""The scenario of a machine: what it says, how far it is, begun anew and ended."""

from __future__ import annotations

from typing import Any, Literal

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict

from polycnc.cnc import ControlError, Refusal
from polycnc.errors import UsageError
from polycnc.servers.http._body import checked, json_object, text_of
from polycnc.servers.http._found import ONE, Found, body
from polycnc.servers.machines import ServedMachine
from polycnc.servers.scenarios import Story, read_script

MOST_SCENARIO_BYTES = 1 << 20
MOST_HAPPENED = 200
_TEXT = {"type": "string", "maxLength": MOST_SCENARIO_BYTES}


class StepShown(BaseModel):
    """A step as its file has it, how often it has begun, and whether it is on."""

    step: dict[str, Any]
    done: int
    on: bool


class HappenedShown(BaseModel):
    """What a step has done, with the cycle."""

    cycle: int
    step: str
    what: str


class ScenarioShown(BaseModel):
    """A scenario: its text, its steps, what has happened, and whether it is followed; without one all is empty."""

    title: str = ""
    source: str = ""
    running: bool = False
    time_s: float = 0.0
    steps: list[StepShown] = []
    happened: list[HappenedShown] = []


class ScenarioAsked(BaseModel):
    """What a scenario is to do."""

    model_config = ConfigDict(extra="forbid", strict=True)
    do: Literal["start", "stop"]


class ScenarioRoutes:
    """Show the scenario of a machine, put another in its place, begin it anew, end it."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        self._last: dict[str, Story] = {}
        at = f"{ONE}/scenario"
        router.get(at, summary="The scenario, and how far it is.")(self.scenario)
        router.put(at, summary="Follow a scenario from now on.", openapi_extra=body(_TEXT, "text/plain"))(
            self.put_scenario
        )
        router.post(
            at, summary="Begin or end the scenario.", openapi_extra=body(ScenarioAsked.model_json_schema())
        )(self.control_scenario)

    async def scenario(self, machine: str) -> ScenarioShown:
        """Return the scenario that is followed, or the last one."""
        found = self._found.machine(machine)
        return await found.ask(lambda: self._shown(found))

    async def put_scenario(self, machine: str, request: Request) -> ScenarioShown:
        """Read a scenario and follow it in place of the one before; a wrong one changes nothing."""
        found = self._found.machine(machine)
        source = await text_of(request, "scenario", MOST_SCENARIO_BYTES)

        def begun() -> ScenarioShown:
            before = self._present(found)
            try:
                story = Story(read_script(source), found, self._found.log)
            except UsageError as error:
                raise ControlError(Refusal.DATA, error.what, hint=error.hint) from error
            self._begin(found, story, before)
            return self._shown(found)

        return await found.ask(begun)

    async def control_scenario(self, machine: str, request: Request) -> ScenarioShown:
        """Begin the scenario from its first step, or end it; what is on ends with it."""
        found = self._found.machine(machine)
        asked = checked(ScenarioAsked, await json_object(request))

        def done() -> ScenarioShown:
            story = self._present(found)
            if story is None:
                raise ControlError(Refusal.NOT_FOUND, "there is no scenario", hint="Put one.")
            if asked.do == "start":
                self._begin(found, Story(story.script, found, self._found.log), story)
            elif found.served.scenario is story:
                story.close()
                found.served.follow(None)
            return self._shown(found)

        shown = await found.ask(done)
        self._found.log.write("scenario", machine=machine, **asked.model_dump())
        return shown

    def _present(self, machine: ServedMachine) -> Story | None:
        scenario = machine.served.scenario
        if isinstance(scenario, Story):
            self._last[machine.name] = scenario
        return self._last.get(machine.name)

    def _begin(self, machine: ServedMachine, story: Story, before: Story | None) -> None:
        if before is not None and machine.served.scenario is before:
            before.close()
        self._last[machine.name] = story
        story.begin()
        machine.served.follow(story)

    def _shown(self, machine: ServedMachine) -> ScenarioShown:
        story = self._present(machine)
        if story is None:
            return ScenarioShown()
        steps = [
            StepShown(
                step=each.step.model_dump(mode="json", by_alias=True, exclude_defaults=True),
                done=each.done,
                on=each.on,
            )
            for each in story.steps
        ]
        happened = [
            HappenedShown(cycle=each.cycle, step=each.step, what=each.what)
            for each in story.happened[-MOST_HAPPENED:]
        ]
        return ScenarioShown(
            title=story.script.title,
            source=story.script.source,
            running=machine.served.scenario is story,
            time_s=story.passed_s,
            steps=steps,
            happened=happened,
        )
