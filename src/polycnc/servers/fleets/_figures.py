"""The page of figures of a fleet, as Prometheus reads it."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any

from prometheus_client import CollectorRegistry, Gauge, generate_latest
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

_ROWS = (
    ("time_s", "polycnc_machine_time_seconds", "The time of a machine."),
    ("late_s", "polycnc_machine_lateness_seconds", "The worst lateness of a machine's clock since it was asked."),
    ("lives", "polycnc_machine_up", "Whether time passes in a machine."),
)  # fmt: skip
Figures = Callable[[], Awaitable[list[tuple[int, dict[str, Any]]]]]


def figures_app(figures: Figures) -> Starlette:
    """Return the application: `/metrics` and `/health`."""

    async def metrics(_: Request) -> Response:
        registry = CollectorRegistry()
        gauges = [
            (key, Gauge(name, what, ["machine", "process"], registry=registry)) for key, name, what in _ROWS
        ]
        for number, row in await figures():
            for key, gauge in gauges:
                gauge.labels(row["machine"], number).set(row[key])
        return Response(generate_latest(registry), media_type="text/plain; version=0.0.4")

    async def health(_: Request) -> Response:
        rows = await figures()
        lives = bool(rows) and all(row["lives"] for _, row in rows)
        said = {"status": "ok" if lives else "a machine has failed", "machines": len(rows)}
        return JSONResponse(said, 200 if lives else 503)

    return Starlette(routes=[Route("/metrics", metrics), Route("/health", health)])
