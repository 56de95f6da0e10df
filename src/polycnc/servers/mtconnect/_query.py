"""Read what is asked: the place and the parameters of a request, each bounded before anything is done."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import parse_qsl, unquote

from polycnc.servers.mtconnect._errors import AgentError, Code

MOST_QUERY = 4096
MOST_PATH = 1024
_MOST_DIGITS = 20
_MOST_PARAMETERS = 16
_REQUESTS = ("probe", "current", "sample", "asset", "assets")
_KNOWN = {
    "probe": {"deviceType"},
    "current": {"deviceType", "at", "path", "interval"},
    "sample": {"deviceType", "from", "to", "count", "path", "interval", "heartbeat"},
    "asset": {"type", "count", "removed"},
    "assets": {"type", "count", "removed"},
}
# Agents have "pretty", and documents are indented anyway; pages pass their caches by "_".
_ALWAYS = {"pretty", "_"}
MOST_INTERVAL_MS = 2**31 - 1


@dataclass(frozen=True, slots=True)
class Asked:
    """What is asked: one of probe, current, sample, assets; `device` is its name or uuid, "" for all devices."""

    request: str
    device: str = ""
    ids: tuple[str, ...] = ()
    values: tuple[tuple[str, str], ...] = ()

    def text(self, name: str) -> str | None:
        """Return a parameter as it was given, None if it was not."""
        return dict(self.values).get(name)

    def number(self, name: str, low: int, high: int) -> int | None:
        """Return a whole number within its limits, None if it was not given.

        Raises:
            AgentError: It is none, or out of its range.
        """
        given = self.text(name)
        if given is None:
            return None
        digits = given.removeprefix("-")
        if not (digits.isascii() and digits.isdigit()):
            raise AgentError(
                Code.QUERY_ERROR, f"{name} is not a whole number: {given[:40]}", parameter=name, value=given
            )
        value = int(given) if len(digits) <= _MOST_DIGITS else None
        if value is None or not low <= value <= high:
            raise AgentError(
                Code.OUT_OF_RANGE,
                f"{name} is out of its range: {given[:40]}",
                hint=f"Give {low} to {high}.",
                parameter=name,
                value=given,
                limits=(low, high),
            )
        return value


def asked_of(path: str, query: bytes) -> Asked:
    """Return what a request asks; `path` as it was sent, with its escapes.

    Raises:
        AgentError: There is nothing at this place, or the query cannot be read.
    """
    if len(path) > MOST_PATH or len(query) > MOST_QUERY:
        raise AgentError(Code.INVALID_REQUEST, "the request is too long", hint=f"Send {MOST_QUERY} bytes.")
    parts = [unquote(part, errors="replace") for part in path.split("/") if part]
    request, device, ids = _place(parts)
    values = _values(query)
    names = [name for name, _ in values]
    for name in names:
        if name not in _KNOWN[request] | _ALWAYS:
            known = ", ".join(sorted(_KNOWN[request]))
            raise AgentError(Code.QUERY_ERROR, f"{request} has no {name[:40]}", hint=f"It has {known}.")
        if names.count(name) > 1:
            raise AgentError(Code.QUERY_ERROR, f"{name} is given twice", parameter=name)
    return Asked("assets" if request == "asset" else request, device, ids, values)


def _place(parts: list[str]) -> tuple[str, str, tuple[str, ...]]:
    """Return request, device and asset ids."""
    if not parts:
        return "probe", "", ()
    if parts[0] in ("asset", "assets") and len(parts) == 2:
        ids = tuple(filter(None, parts[1].split(";")))
        return "asset", "", ids or ("",)
    if len(parts) == 1:
        return (parts[0], "", ()) if parts[0] in _REQUESTS else ("probe", parts[0], ())
    if len(parts) == 2 and parts[1] in _REQUESTS:
        return parts[1], parts[0], ()
    raise AgentError(
        Code.INVALID_URI,
        f"there is nothing at /{'/'.join(parts)[:80]}",
        hint="Ask for /probe, /current, /sample or /assets, of one device after its name.",
    )


def _values(query: bytes) -> tuple[tuple[str, str], ...]:
    try:
        found = parse_qsl(
            query.decode("ascii", "replace"),
            keep_blank_values=True,
            max_num_fields=_MOST_PARAMETERS,
            errors="replace",
        )
    except ValueError:
        raise AgentError(
            Code.QUERY_ERROR, "too many parameters", hint=f"Give at most {_MOST_PARAMETERS}."
        ) from None
    return tuple(found)
