"""A client of the door `http` for commands: questions to one machine, refusals as errors."""

from __future__ import annotations

import http.client
import json
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import quote

from polycnc.errors import UsageError

T = TypeVar("T")
_WAIT_S = 60.0
_MOST_BYTES = 1 << 26
_START = "Start it with polycnc serve --doors http, and give the address that it prints."


class Asked:
    """The machines that a server at `url` serves; `token` is the file with its secret."""

    def __init__(self, url: str, token: Path | None = None) -> None:
        if not url.startswith(("http://", "https://")):
            raise UsageError(
                f"'{url[:80]}' is no address of a page", hint="Write it like http://127.0.0.1:8080."
            )
        self._url = url.rstrip("/")
        self._headers = {"Content-Type": "application/octet-stream"}
        if token is not None:
            try:
                self._headers["Authorization"] = f"Bearer {token.read_text('utf-8').strip()}"
            except (OSError, UnicodeDecodeError):
                raise UsageError(f"cannot read '{token}'", hint="Give the file with the secret.") from None

    def snapshot(self, machine: str | None) -> bytes:
        """Return the state of a machine as the contents of a file.

        Raises:
            UsageError: Nobody answers, or the question is refused.
        """
        return self._answer("GET", f"{self._named(machine)}/snapshot")

    def restore(self, content: bytes, machine: str | None) -> dict[str, Any]:
        """Let a machine go back to the state of a file; return its status then.

        Raises:
            UsageError: Nobody answers, or the state is not one of this machine.
        """
        answer = self._answer("PUT", f"{self._named(machine)}/snapshot", content)
        return self._understood(answer, lambda found: dict(found))

    def _named(self, machine: str | None) -> str:
        if machine is not None:
            return quote(machine, safe="")
        names = self._understood(self._answer("GET", ""), lambda found: [str(each["name"]) for each in found])
        if len(names) != 1:
            raise UsageError(f"{len(names)} machines are served", hint=f"Name one: {', '.join(names[:10])}.")
        return quote(names[0], safe="")

    def _understood(self, answer: bytes, read: Callable[[Any], T]) -> T:
        try:
            return read(json.loads(answer))
        except (ValueError, LookupError, TypeError, RecursionError):
            raise UsageError(f"what answers at {self._url} serves no machines", hint=_START) from None

    def _answer(self, method: str, path: str, body: bytes | None = None) -> bytes:
        at = f"{self._url}/api/machines/{path}".rstrip("/")
        try:
            request = urllib.request.Request(at, body, self._headers, method=method)
            with urllib.request.urlopen(request, timeout=_WAIT_S) as answer:
                return bytes(answer.read(_MOST_BYTES))
        except urllib.error.HTTPError as error:
            raise _refusal(error) from None
        except (OSError, ValueError, http.client.HTTPException) as error:
            why = getattr(error, "reason", error)
            raise UsageError(f"nobody answers at {self._url}: {why}", hint=_START) from None


def _refusal(error: urllib.error.HTTPError) -> UsageError:
    try:
        said = json.loads(error.read(1 << 16))
        return UsageError(str(said["detail"]), hint=str(said["hint"]))
    except (ValueError, LookupError, TypeError, OSError, http.client.HTTPException):
        return UsageError(f"the server answers {error.code}", hint=_START)
