"""The lines of an adapter without sockets: what changed, what everything is, and the answers to commands."""

from __future__ import annotations

from collections.abc import Iterable

from polycnc.servers.mtconnect import Change, DeviceModel, Looked, Recorder, Version, asset_text
from polycnc.servers.plant import Seen

PONG_MS = 10_000
"""How often an agent shall ask whether the adapter still lives, in ms."""
_MOST_COMMAND = 1024
_MULTILINE = "--multiline--POLYCNC"
_SPECIAL = frozenset({"ASSET_CHANGED", "ASSET_REMOVED", "ASSET_COUNT"})  # the agent makes these of assets


def _text(value: str) -> str:
    """Return a value as a field: one with a bar is put in quotes, its bars escaped."""
    return f'"{value}"'.replace("|", "\\|") if "|" in value else value


def line_of(time: str, changes: Iterable[Change]) -> str:
    """Return changes of one time as lines: simple values on one, conditions and messages on their own."""
    fields, lines = [time], []
    for each in changes:
        name = each.item.name
        if each.item.about is not None:
            parts = (name, each.value, each.code, "", each.qualifier.upper(), _text(each.text))
            lines.append("|".join((time, *parts)))
        elif each.item.type == "MESSAGE":
            lines.append("|".join((time, name, each.code, _text(each.value))))
        elif each.item.type not in _SPECIAL:
            fields += [name, _text(each.value)]
    if len(fields) > 1:
        lines.insert(0, "|".join(fields))
    return "".join(line + "\n" for line in lines)


class Adapter:
    """One machine: `look` returns the lines of what has changed, `everything` those that a new agent gets."""

    def __init__(self, device: DeviceModel, version: Version) -> None:
        self._recorder = Recorder(device)
        self._version = version
        self._time = ""
        self._values: dict[str, Change] = {}
        self._troubles: dict[tuple[str, str], Change] = {}

    def look(self, seen: Seen) -> bytes:
        """Return the lines of what has changed."""
        looked = self._recorder.look(seen)
        self._time = looked.time
        for change in looked.changes:
            self._keep(change)
        return (line_of(looked.time, looked.changes) + self._tools(looked)).encode()

    def everything(self) -> bytes:
        """Return the lines of what holds, and of all tools."""
        changes = [*self._values.values(), *self._troubles.values()]
        tools = Looked(self._time, [], self._recorder.assets.all())
        return (line_of(self._time, changes) + self._tools(tools)).encode()

    def _keep(self, change: Change) -> None:
        """Hold a value; of a condition that of each trouble, in place of NORMAL."""
        name = change.item.name
        if not change.key:
            self._troubles = {key: each for key, each in self._troubles.items() if key[0] != name}
            self._values[name] = change
        elif change.value == "NORMAL":
            self._troubles.pop((name, change.key), None)
        else:
            self._values.pop(name, None)
            self._troubles[name, change.key] = change

    def _tools(self, looked: Looked) -> str:
        lines = []
        for tool in looked.tools:
            if tool.removed:
                lines.append(f"{looked.time}|@REMOVE_ASSET@|{tool.id}\n")
            else:
                text = asset_text(tool, self._version)
                lines.append(
                    f"{looked.time}|@ASSET@|{tool.id}|CuttingTool|{_MULTILINE}\n{text}\n{_MULTILINE}\n"
                )
        return "".join(lines)


class Session:
    """What one agent sends: commands that begin with a star, cut anywhere; only PING is answered."""

    def __init__(self) -> None:
        self._held = b""
        self._skips = False

    def receive(self, data: bytes) -> bytes:
        """Take bytes, return the answers; a line that is too long is skipped to its end."""
        *lines, self._held = (self._held + data).split(b"\n")
        if self._skips and lines:
            del lines[0]
            self._skips = False
        if self._skips or len(self._held) > _MOST_COMMAND:
            self._held, self._skips = b"", True
        pings = sum(line.strip() == b"* PING" for line in lines if len(line) <= _MOST_COMMAND)
        return b"* PONG %d\n" % PONG_MS * pings
