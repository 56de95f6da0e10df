"""Who may ask: Host and Origin are checked, bodies are bounded and a secret is asked for, before anything is parsed."""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Callable, Iterable
from http.cookies import CookieError, SimpleCookie
from urllib.parse import urlsplit

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from polycnc.servers.asgi import Again, Said, again_of, answers_again
from polycnc.servers.http._problem import problem

MOST_BODY_BYTES = 16 << 20
MOST_HEADER_BYTES = 8192
COOKIE = "polycnc"
OPEN = frozenset({"/login", "/health"})
_CONTENT = (
    (b"content-security-policy", b"default-src 'self'; frame-ancestors 'none'; base-uri 'none'"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cache-control", b"no-store"),
)


class Guard:
    """Let only those requests through that may be answered; `hosts` are names besides those of loopback.

    `answered` gets the status of every answer.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        hosts: Iterable[str] = (),
        token: str | None = None,
        answered: Callable[[int], object] = lambda status: None,
    ) -> None:
        self._app = app
        self._answered = answered
        self._hosts = frozenset(hosts) | {"localhost"}
        self._any_address = token is not None
        self._token = token

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or hand on."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        refusal = self._refusal(scope)
        if refusal is not None:
            if scope["type"] == "websocket":
                await receive()
                await send({"type": "websocket.close", "code": 1008, "reason": refusal[1]})
            else:
                self._answered(refusal[0])
                await problem(*refusal)(scope, receive, send)
            return
        await self._app(scope, _bounded(receive), self._with_headers(send))
        if (again := again_of(scope)) is not None:
            answers_again(scope, lambda: self._again(again))

    async def warm(self) -> None:
        """Ask for the health, unseen: the first question has the application get ready, which takes long."""
        scope = {
            "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "GET", "scheme": "http",
            "path": "/health", "raw_path": b"/health", "root_path": "", "query_string": b"", "headers": [],
        }  # fmt: skip

        async def receive() -> Message:
            return {"type": "http.request"}

        async def send(_: Message) -> None:
            pass

        await self._app(scope, receive, send)

    def _again(self, again: Again) -> Said | None:
        if (said := again()) is not None:
            self._answered(200)
            said.headers.extend(_CONTENT)
        return said

    def _with_headers(self, send: Send) -> Send:
        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._answered(message["status"])
                message["headers"] = [*message.get("headers", ()), *_CONTENT]
            await send(message)

        return sent

    def _refusal(self, scope: Scope) -> tuple[int, str, str] | None:
        headers = scope["headers"]
        names = [name for name, _ in headers]
        if sum(len(name) + len(value) for name, value in headers) > MOST_HEADER_BYTES:
            return 431, "the headers are too large", "Send fewer."
        if names.count(b"host") != 1 or not self._knows(_header(scope, b"host")):
            return 421, "this host is not served here", "Ask by the address that the door was said to have."
        origin = _header(scope, b"origin")
        if origin and _place_of(origin) != _header(scope, b"host"):
            return 403, "a page of another origin cannot ask", "Open the page of this server."
        length = _header(scope, b"content-length")
        if length and (not length.isdecimal() or len(length) > 12 or int(length) > MOST_BODY_BYTES):
            return 413, "the body is too large", f"Send at most {MOST_BODY_BYTES} bytes."
        if self._token is not None and scope["path"] not in OPEN and not self._shows_token(scope):
            return 401, "a secret is asked for", "Send `Authorization: Bearer ...`, or log in at /login."
        return None

    def _knows(self, host: str) -> bool:
        if "@" in host:  # a user has no place there
            return False
        try:
            name = urlsplit(f"//{host}").hostname or ""
            if name in self._hosts:
                return True
            address = ipaddress.ip_address(name)
        except ValueError:
            return False
        return address.is_loopback or self._any_address

    def _shows_token(self, scope: Scope) -> bool:
        kind, _, shown = _header(scope, b"authorization").partition(" ")
        if kind.lower() != "bearer":
            try:
                found = SimpleCookie(_header(scope, b"cookie")).get(COOKIE)
            except CookieError:
                found = None
            shown = "" if found is None else found.value
        return self.is_token(shown)

    def is_token(self, shown: str) -> bool:
        """Tell whether this is the secret, in a time that does not tell how near it is."""
        return self._token is not None and hmac.compare_digest(shown.encode(), self._token.encode())


def _header(scope: Scope, name: bytes) -> str:
    return next((value.decode("latin-1") for key, value in scope["headers"] if key == name), "")


def _place_of(origin: str) -> str | None:
    """Return host and port of an origin; None of what has none."""
    try:
        return urlsplit(origin).netloc or None
    except ValueError:  # a bracket that is not closed
        return None


def _bounded(receive: Receive) -> Receive:
    """Take no more of a body than is allowed, whatever its header says."""
    taken = 0

    async def bounded() -> Message:
        nonlocal taken
        message = await receive()
        if message["type"] == "http.request":
            taken += len(message.get("body", b""))
            if taken > MOST_BODY_BYTES:
                raise TooLargeError
        return message

    return bounded


class TooLargeError(Exception):
    """A body without a length that grows too large."""
