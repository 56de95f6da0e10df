"""The application: REST, stream, page, health and figures, behind the guard."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from prometheus_client import CollectorRegistry, Counter, Gauge, generate_latest
from starlette.exceptions import HTTPException
from starlette.responses import FileResponse
from starlette.routing import Match, Route

from polycnc import __version__
from polycnc.errors import PolycncError
from polycnc.servers.http._description import describe
from polycnc.servers.http._guard import COOKIE, Guard, TooLargeError
from polycnc.servers.http._lease import HeldError
from polycnc.servers.http._problem import of_error, problem
from polycnc.servers.http._routes import Api
from polycnc.servers.http._statuses import Statuses
from polycnc.servers.machines import Log, ServedMachine
from polycnc.web import served_files, served_text

METHOD_NOT_ALLOWED = 405
PAGE = Path(__file__).parent / "page"
_KINDS = {
    ".html": "text/html; charset=utf-8", ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8", ".svg": "image/svg+xml",
}  # fmt: skip
FILES = {each.name: _KINDS[each.suffix] for each in PAGE.iterdir() if each.suffix in _KINDS}
"""The files of the page with their kinds."""
_LOGIN = """<!doctype html><html lang="en"><meta charset="utf-8"><title>polycnc</title>
<form method="post" action="/login"><label>Secret <input type="password" name="token" autofocus></label>
<button>Log in</button></form></html>"""


def make_app(
    machines: Sequence[ServedMachine],
    *,
    token: str | None = None,
    log: Log | None = None,
    hosts: Iterable[str] = (),
) -> Guard:
    """Return the application that serves these machines."""
    by_name = {each.name: each for each in machines}
    log = log or Log()
    app = FastAPI(
        title="polycnc", version=__version__, docs_url=None, redoc_url=None, openapi_url="/openapi.json"
    )
    app.include_router(Api(by_name, log).router)
    describe(app, list(by_name))
    _add_errors(app, log)
    count = _add_figures(app, by_name)
    guard = Guard(Statuses(app, by_name), hosts=hosts, token=token, answered=count)
    _add_login(app, guard)

    @app.get("/web/{file}", include_in_schema=False)
    async def shared(file: str) -> Response:
        if file not in served_files():
            return problem(404, "there is nothing here", "The page is at /.")
        kind = "text/css" if file.endswith(".css") else "text/javascript"
        return Response(served_text(file), media_type=f"{kind}; charset=utf-8")

    @app.get("/{file}", include_in_schema=False)
    async def page(file: str) -> Response:
        if file not in FILES:
            return problem(404, "there is nothing here", "The page is at /.")
        return FileResponse(PAGE / file, media_type=FILES[file])

    app.get("/", include_in_schema=False)(_first_page)
    return guard


async def _first_page() -> Response:
    return FileResponse(PAGE / "index.html", media_type=FILES["index.html"])


def _add_errors(app: FastAPI, log: Log) -> None:
    @app.exception_handler(PolycncError)
    async def refused(_: Request, error: PolycncError) -> Response:
        return of_error(error)

    @app.exception_handler(HeldError)
    async def held(_: Request, error: HeldError) -> Response:
        return problem(409, error.what, error.hint, reason="held")

    @app.exception_handler(TooLargeError)
    async def too_large(_: Request, __: TooLargeError) -> Response:
        return problem(413, "the body is too large", "Send less.")

    @app.exception_handler(RequestValidationError)
    async def not_valid(_: Request, error: RequestValidationError) -> Response:
        places = [f"{'.'.join(map(str, each['loc']))}: {each['msg']}"[:200] for each in error.errors()[:20]]
        return problem(422, "the request cannot be meant", "See /openapi.json.", errors=places)

    @app.exception_handler(HTTPException)
    async def other(request: Request, error: HTTPException) -> Response:
        said = problem(error.status_code, str(error.detail), "See /openapi.json.")
        said.headers.update(error.headers or {})
        if error.status_code == METHOD_NOT_ALLOWED:
            said.headers["allow"] = ", ".join(sorted(_methods(app, request)))
        return said

    @app.exception_handler(Exception)
    async def internal(request: Request, error: Exception) -> Response:
        if _is_too_large(error):  # while the rest of it was not waited for
            return await too_large(request, TooLargeError())
        log.write("internal error", error=repr(error)[:500])
        return problem(503, "an internal error", "Please report it; it is in the log.")


def _is_too_large(error: BaseException | None) -> bool:
    """Tell whether an error is, holds or comes of a body that is too large."""
    while error is not None:
        if isinstance(error, TooLargeError):
            return True
        if isinstance(error, BaseExceptionGroup) and any(map(_is_too_large, error.exceptions)):
            return True
        error = error.__cause__ or error.__context__
    return False


def _methods(app: FastAPI, request: Request) -> set[str]:
    """Return the methods of all routes of a path."""
    found: set[str] = set()
    for route in app.routes:
        if isinstance(route, Route) and route.matches(dict(request.scope))[0] is not Match.NONE:
            found |= route.methods or set()
    return found


def _add_figures(app: FastAPI, machines: dict[str, ServedMachine]) -> Callable[[int], None]:
    """Add health and figures; return what counts an answer."""
    registry = CollectorRegistry()
    requests = Counter("polycnc_http_requests", "Requests by status.", ["status"], registry=registry)
    time_s = Gauge("polycnc_machine_time_seconds", "The time of a machine.", ["machine"], registry=registry)
    late_s = Gauge(
        "polycnc_machine_lateness_seconds",
        "The worst lateness of a machine's clock since it was asked.",
        ["machine"],
        registry=registry,
    )

    @app.get("/health")
    async def health() -> dict[str, str]:
        """Return "ok" as long as time passes in all machines."""
        if any(each.keeper.failed.done() for each in machines.values()):
            raise HTTPException(503, "a machine has failed")
        return {"status": "ok"}

    @app.get("/metrics", include_in_schema=False)
    async def metrics() -> Response:
        for each in machines.values():
            time_s.labels(each.name).set(each.served.clock.now_s)
            late_s.labels(each.name).set(each.keeper.take_lateness_s())
        return Response(generate_latest(registry), media_type="text/plain; version=0.0.4")

    return lambda status: requests.labels(status).inc()


def _add_login(app: FastAPI, guard: Guard) -> None:
    @app.get("/login", include_in_schema=False)
    async def form() -> Response:
        return Response(_LOGIN, media_type="text/html; charset=utf-8")

    @app.post("/login", include_in_schema=False)
    async def login(request: Request) -> Response:
        from urllib.parse import parse_qs

        body = (await request.body())[:8192].decode("latin-1")
        shown = parse_qs(body, max_num_fields=4).get("token", [""])[0]
        if not guard.is_token(shown):
            return problem(401, "this is not the secret", "Try again.")
        answer = Response(status_code=303, headers={"location": "/"})
        answer.set_cookie(COOKIE, shown, httponly=True, samesite="strict")
        return answer
