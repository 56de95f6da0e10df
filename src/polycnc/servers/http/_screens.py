"""What only some machines have: the screen of programs with its keys, and tasks beside the axes."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import APIRouter, Path, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field

from polycnc.cnc import ControlError, Refusal
from polycnc.servers.http._body import checked, json_object, text_of
from polycnc.servers.http._found import ONE, Found, answer, body
from polycnc.servers.machines import Screen, ScreenShown, ServedMachine, Tasks, TaskShown

MOST_SOURCE_BYTES = 1 << 20
_SVG = "image/svg+xml"
_TEXT = {"type": "string", "maxLength": MOST_SOURCE_BYTES}
_Channel = Annotated[int, Query(ge=0, le=99, description="Channel, from 0.")]
_Task = Annotated[int, Path(ge=0, le=99)]


class KeyAsked(BaseModel):
    """A key to be pressed: one character, or the name of a key."""

    model_config = ConfigDict(extra="forbid", strict=True)
    key: Annotated[str, Field(min_length=1, max_length=16)]
    channel: Annotated[int, Field(ge=0, le=99)] = 0


class TaskAsked(BaseModel):
    """What a task is to do."""

    model_config = ConfigDict(extra="forbid", strict=True)
    do: Literal["start", "stop", "continue"]


class ScreenRoutes:
    """Show screens and tasks, press keys, load and command tasks."""

    def __init__(self, found: Found, router: APIRouter) -> None:
        self._found = found
        router.get(f"{ONE}/screen", summary="What a program shows.")(self.screen)
        router.get(f"{ONE}/screen.svg", summary="The same as a drawing.", response_class=Response,
            responses=answer({"type": "string"}, _SVG))(self.picture)  # fmt: skip
        router.post(
            f"{ONE}/screen", summary="Press a key.", openapi_extra=body(KeyAsked.model_json_schema())
        )(self.press)
        router.get(f"{ONE}/tasks", summary="The tasks.")(self.tasks)
        at = f"{ONE}/tasks/{{task}}"
        router.put(at, summary="Give a task a program.", openapi_extra=body(_TEXT, "text/plain"))(self.load)
        router.post(at, summary="Start or stop a task.", openapi_extra=body(TaskAsked.model_json_schema()))(
            self.control
        )

    async def screen(self, machine: str, channel: _Channel = 0) -> ScreenShown:
        """Return lines, softkeys and keys."""
        found, screen = self._screen(machine)
        return await found.ask(lambda: screen.shown(channel))

    async def picture(self, machine: str, channel: _Channel = 0) -> Response:
        """Return the screen with its colours and graphics."""
        found, screen = self._screen(machine)
        return Response(await found.ask(lambda: screen.picture(channel)), media_type=_SVG)

    async def press(self, machine: str, request: Request) -> ScreenShown:
        """Press a key; the answer is the screen then."""
        found, screen = self._screen(machine)
        asked = checked(KeyAsked, await json_object(request))

        def pressed() -> ScreenShown:
            screen.press(asked.key, asked.channel)
            return screen.shown(asked.channel)

        return await found.ask(pressed)

    async def tasks(self, machine: str) -> list[TaskShown]:
        """Return the tasks in their order."""
        found, tasks = self._tasks(machine)
        return await found.ask(tasks.all)

    async def load(self, machine: str, task: _Task, request: Request) -> list[TaskShown]:
        """Compile a program and give it to a task, which stops; the answer is the tasks then."""
        found, tasks = self._tasks(machine)
        source = await text_of(request, "program", MOST_SOURCE_BYTES)

        def loaded() -> list[TaskShown]:
            tasks.load(task, source)
            return tasks.all()

        shown = await found.ask(loaded)
        self._found.log.write("task", machine=machine, task=task, bytes=len(await request.body()))
        return shown

    async def control(self, machine: str, task: _Task, request: Request) -> list[TaskShown]:
        """Start, stop or continue a task; the answer is the tasks then."""
        found, tasks = self._tasks(machine)
        asked = checked(TaskAsked, await json_object(request))

        def done() -> list[TaskShown]:
            tasks.control(task, asked.do)
            return tasks.all()

        shown = await found.ask(done)
        self._found.log.write("task", machine=machine, task=task, **asked.model_dump())
        return shown

    def _screen(self, machine: str) -> tuple[ServedMachine, Screen]:
        found = self._found.machine(machine)
        if found.screen is None:
            raise ControlError(
                Refusal.NOT_FOUND, f"machine {machine} has no screen", hint="Ask for its status."
            )
        return found, found.screen

    def _tasks(self, machine: str) -> tuple[ServedMachine, Tasks]:
        found = self._found.machine(machine)
        if found.tasks is None:
            raise ControlError(
                Refusal.NOT_FOUND, f"machine {machine} has no tasks", hint="Ask for its status."
            )
        return found, found.tasks
