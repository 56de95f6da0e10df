"""The guard of the door http under 10,000 requests: whatever comes is refused with a reason, or handed on bounded."""

from __future__ import annotations

import random
from collections.abc import Coroutine, MutableMapping
from typing import Any

import pytest

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

from polycnc.servers.http._guard import MOST_BODY_BYTES, Guard, TooLargeError

HOSTS = (
    b"localhost",
    b"127.0.0.1:8080",
    b"[::1]:80",
    b"plant.example",
    b"",
    b"[",
    b"localhost:",
    b"::1",
    b"a@localhost",
    b"\xff",
)
ORIGINS = (
    b"null",
    b"http://localhost",
    b"http://evil.example",
    b"http://[",
    b"",
    b"\x00",
    b"http://127.0.0.1:8080",
)
LENGTHS = (b"0", b"12", b"-1", b"1e9", b"9" * 400, b"16777217", b"16777216", b"\xb2", b"+3", b"")
SHOWN = (
    b"Bearer s3cret",
    b"bearer s3cret",
    b"Bearer",
    b"Bearer s3cre",
    b"Basic czNjcmV0",
    b"",
    b"Bearer \xff",
)
COOKIES = (
    b"polycnc=s3cret",
    b"polycnc=",
    b'polycnc="s3cret',
    b";;=;",
    b"polycnc=s3cret; polycnc=x",
    b"\xff=\xff",
)
ROWS = (
    (b"host", HOSTS),
    (b"origin", ORIGINS),
    (b"content-length", LENGTHS),
    (b"authorization", SHOWN),
    (b"cookie", COOKIES),
)
LOCAL = frozenset({b"localhost", b"127.0.0.1:8080", b"[::1]:80", b"localhost:"})


def _scope(dice: random.Random) -> dict[str, Any]:
    headers = [] if dice.random() < 0.1 else [(b"host", dice.choice(HOSTS[:3]))]
    for _ in range(dice.randrange(4)):
        name, values = dice.choice(ROWS)
        headers.append((name, dice.choice(values)))
    if dice.random() < 0.02:
        headers.append((b"x", b"y" * dice.randrange(8000, 8400)))
    path = dice.choice(
        ("/", "/login", "/health", "/api/machines/m/status", "/" + "../" * 9, "/\x00", "/login/")
    )
    kind = dice.choice(("http", "http", "http", "websocket"))
    return {"type": kind, "method": "GET", "path": path, "headers": headers, "query_string": b""}


def _run(coroutine: Coroutine[Any, Any, None]) -> None:
    with pytest.raises(StopIteration):
        coroutine.send(None)  # nothing in it waits


def _requests(seed: int, count: int) -> tuple[int, int]:
    """Ask so many times; return how many were handed on, and how many bodies ended as too large."""
    dice, handed, large = random.Random(seed), list[dict[str, Any]](), 0

    async def app(scope: Any, receive: Any, send: Any) -> None:
        nonlocal large
        handed.append(scope)
        try:
            while (await receive())["more_body"]:
                pass
        except TooLargeError:
            large += 1
        await send({"type": "http.response.start", "status": 200, "headers": []})

    guards = (Guard(app), Guard(app, token="s3cret"))
    piece = bytes(MOST_BODY_BYTES // 3)
    for _ in range(count):
        scope, sent, left = _scope(dice), list[MutableMapping[str, Any]](), dice.choice((0, 0, 0, 2, 3))

        async def receive() -> dict[str, Any]:
            nonlocal left
            left -= 1
            return {"type": "http.request", "body": piece, "more_body": left >= 0}

        async def send(message: MutableMapping[str, Any]) -> None:
            sent.append(message)  # noqa: B023

        guard, before = dice.choice(guards), len(handed)
        _run(guard(scope, receive, send))
        names = [name for name, _ in scope["headers"]]
        values = dict(reversed(scope["headers"]))
        if len(handed) > before:
            assert names.count(b"host") == 1
            assert guard is guards[1] or values[b"host"] in LOCAL
            assert sum(map(len, (part for pair in scope["headers"] for part in pair))) <= 8192
            assert values.get(b"origin", b"") in (b"", b"http://" + values[b"host"])
            if guard is guards[1] and scope["path"] not in ("/login", "/health"):
                assert b"s3cret" in values.get(b"authorization", b"") + values.get(b"cookie", b"")
            assert sent[0]["status"] == 200
        elif scope["type"] == "http":
            assert sent[0]["status"] in (401, 403, 413, 421, 431)
        else:
            assert (sent[0]["type"], sent[0]["code"]) == ("websocket.close", 1008)
    return len(handed), large


def test_10_000_requests_are_refused_with_a_reason_or_handed_on_bounded() -> None:
    handed, large = _requests(3, 10_000)
    assert 1000 < handed < 9000
    assert large > 100


@pytest.mark.long
def test_a_million_requests() -> None:
    _requests(4, 1_000_000)
