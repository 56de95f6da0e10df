"""The OpenAPI document: what fastapi makes of the routes, with schemas that answers refer to, names and links."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI

from polycnc.servers.http._documents import schemas
from polycnc.servers.http._found import PROBLEM_SCHEMA

_ONE = "/api/machines/{machine}"
_OF_A_NAME = ("programs", "parameters", "variables", "signals")


def describe(app: FastAPI, machines: list[str]) -> None:
    """Let the description of an application have what its answers refer to; `machines` are the names that there are."""
    made = app.openapi

    def described() -> dict[str, Any]:
        if app.openapi_schema is None:
            _complete(made(), machines)
        assert app.openapi_schema is not None
        return app.openapi_schema

    app.openapi = described  # type: ignore[method-assign]


def _complete(document: dict[str, Any], machines: list[str]) -> None:
    components = document.setdefault("components", {}).setdefault("schemas", {})
    components.update(schemas() | {"Problem": PROBLEM_SCHEMA})
    for operation in (each for path in document["paths"].values() for each in path.values()):
        for parameter in operation.get("parameters", ()):
            if parameter["name"] == "machine":
                parameter["schema"]["enum"] = machines
    paths = document["paths"]
    for part in _OF_A_NAME:
        one = paths[f"{_ONE}/{part}/{{name}}"]
        same = {"machine": "$request.path.machine", "name": "$request.path.name"}
        for code in {"200", "201", "204"} & set(one["put"]["responses"]):
            one["put"]["responses"][code]["links"] = {
                method: {"operationId": one[method]["operationId"], "parameters": same}
                for method in ("get", "delete")
                if method in one
            }
    forget = paths[f"{_ONE}/snapshots/{{name}}"]["delete"]["operationId"]
    paths[f"{_ONE}/snapshot"]["post"]["responses"]["200"]["links"] = {
        "forget": {
            "operationId": forget,
            "parameters": {"machine": "$request.path.machine", "name": "$response.body#/name"},
        }
    }
