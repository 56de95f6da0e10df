"""Find a machine by the name in a path, and its control."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from polycnc.cnc import Control, ControlError, Refusal
from polycnc.servers.http._problem import Problem
from polycnc.servers.machines import Log, Programs, ServedMachine

JSON = "application/json"
NUMBER_HEADER = "polycnc-number"
ONE = "/{machine}"
REFUSALS: dict[int | str, dict[str, Any]] = {
    code: {
        "description": "Refused.",
        "content": {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}},
    }
    for code in (400, 401, 403, 404, 405, 409, 413, 421, 422, 431, 503)
}
"""What may be answered besides, for any question."""
PROBLEM_SCHEMA = Problem.model_json_schema()
STATUS = {"anyOf": [{"$ref": f"#/components/schemas/{name}"} for name in ("Status", "DeviceStatus")]}
"""A status is that of a control, or of a device without one."""


class Found:
    """The machines of the process by name, the log of what was asked, and numbers for what is told."""

    def __init__(self, machines: Mapping[str, ServedMachine], log: Log) -> None:
        self.machines = machines
        self.log = log
        self._told = 0

    def next_number(self) -> int:
        """Return the number of what is told now: of two the larger one was told later, whichever arrives first."""
        self._told += 1
        return self._told

    def machine(self, name: str) -> ServedMachine:
        """Return a machine.

        Raises:
            ControlError: There is none of this name.
        """
        found = self.machines.get(name)
        if found is None:
            hint = f"Machines are {', '.join(list(self.machines)[:10])}."
            raise ControlError(Refusal.NOT_FOUND, "there is no such machine", hint=hint)
        return found

    def operated(self, name: str) -> tuple[ServedMachine, Callable[[], Control]]:
        """Return a machine and what finds its control.

        Raises:
            ControlError: There is none of this name, or it has no control.
        """
        found = self.machine(name)
        if found.find_control is None:
            raise ControlError(
                Refusal.NOT_FOUND, f"machine {name} has no control", hint="Ask for its status."
            )
        return found, found.find_control

    def programs(self, name: str) -> tuple[ServedMachine, Programs]:
        """Return a machine and its programs.

        Raises:
            ControlError: There is none of this name, or it has no control.
        """
        found, _ = self.operated(name)
        assert found.programs is not None
        return found, found.programs


def body(schema: dict[str, Any], kind: str = JSON, *, required: bool = True) -> dict[str, Any]:
    """Return how a body is described; one that is not `required` may be empty."""
    return {"requestBody": {"required": required, "content": {kind: {"schema": schema}}}}


def answer(schema: dict[str, Any], kind: str = JSON, code: int = 200) -> dict[int | str, dict[str, Any]]:
    """Return how an answer is described."""
    return {code: {"description": "Answered.", "content": {kind: {"schema": schema}}}}
