"""Explain captured bytes of the protocol: every field with its offset, and what is not known said to be unknown."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.wire import (
    AREAS,
    CNC,
    LAYOUTS,
    PMC,
    PMC_WIDTHS,
    VALUE8_SIZE,
    Frame,
    FrameReader,
    FrameType,
    Layout,
    Part,
    Request,
    read_replies,
    read_requests,
    read_status,
    record,
)
from polycnc.errors import ProtocolError

HEADER = 10
SYNC = b"\xa0" * 4
_WIDTH = 16
_TARGETS = {CNC: "CNC", PMC: "PMC"}
_CHANNELS = {1: "programs", 2: "commands"}
_VERSIONS = {
    1: "client", 2: "16i/18i/21i family", 3: "30i family or 0i", 4: "30i family or 0i", 5: "30i family or 0i-F"
}  # fmt: skip
_ALARM_SIZE_AT = 3


@dataclass(frozen=True, slots=True)
class Field:
    """Some bytes of a frame: where they begin in it, and what they are."""

    at: int
    data: bytes
    meaning: str

    def lines(self) -> Iterator[str]:
        """Yield the lines that show it, sixteen bytes in each."""
        for at in range(0, max(len(self.data), 1), _WIDTH):
            piece = self.data[at : at + _WIDTH].hex(" ")
            yield f"  {self.at + at:04x}  {piece:<{3 * _WIDTH - 1}}  {self.meaning if not at else ''}".rstrip()


class _Fields:
    """Cut bytes into fields."""

    def __init__(self, data: bytes, at: int) -> None:
        self.data, self.at = data, at
        self.made: list[Field] = []

    def take(self, size: int, meaning: str) -> bytes:
        data, self.data = self.data[:size], self.data[size:]
        if data:
            self.made.append(Field(self.at, data, meaning))
        self.at += len(data)
        return data

    def number(self, size: int, meaning: str) -> int:
        """Take a whole number; `{}` in the meaning is where it stands."""
        value = int.from_bytes(self.data[:size], "big", signed=size == 4)
        self.take(size, meaning.format(value))
        return value

    def rest(self, meaning: str) -> None:
        self.take(len(self.data), meaning)


@dataclass
class Dissector:
    """Explain the frames of one connection, in the order of their time; replies are read with their requests."""

    _asked: list[Request] = field(default_factory=list)

    def explain(self, frame: Frame) -> list[Field]:
        """Return the fields of a frame."""
        whole = bytes(frame)
        fields = _Fields(whole, 0)
        fields.take(4, "sync")
        fields.number(2, f"version {{}}: {_VERSIONS.get(frame.version, 'unknown')}")
        fields.take(
            2, f"type {frame.name}" if not frame.name.startswith("0x") else f"type {frame.name}: unknown"
        )
        fields.number(2, "body of {} bytes")
        body = _BODIES.get(frame.type)
        if body is not None:
            body(self, fields)
        fields.rest("unknown")
        return fields.made

    # ------------------------------------------------------------------ bodies

    def open(self, fields: _Fields) -> None:
        value = int.from_bytes(fields.data[:2], "big")
        fields.take(2, f"channel {value}: {_CHANNELS.get(value, 'unknown')}")

    def opened(self, fields: _Fields) -> None:
        old = len(fields.data) < 40
        names = _OLD_OPENING if old else _OPENING
        paths = 0
        for name in names:
            value = int.from_bytes(fields.data[:2], "big")
            fields.take(2, f"{name} {value}" if name != "unknown" else "unknown")
            paths = value if name == "path records" else paths
        for path in range(1, paths + 1):
            if not any(fields.data):
                break
            for name in _OLD_PATH if old else _PATH:
                size = 16 if name == "unknown rest" else 2
                data = fields.data[:size]
                shown = (
                    repr(data.decode("latin-1")) if name == "machine type" else int.from_bytes(data, "big")
                )
                fields.take(size, "unknown" if name.startswith("unknown") else f"path {path}: {name} {shown}")
        if fields.data and not any(fields.data):
            fields.rest("unused paths")

    def status(self, fields: _Fields) -> None:
        try:
            code, detail, number = read_status(fields.data)
        except ProtocolError:
            return
        fields.take(2, "unknown")
        fields.take(2, f"code {code} {_code_name(code)}")
        fields.take(2, f"detail {detail}")
        fields.take(2, f"data number {number}")

    def start(self, fields: _Fields) -> None:
        fields.take(1, "unknown")
        fields.number(1, "kind {}, 0 is a program")
        fields.take(2, "unknown")
        name = fields.data.split(b"\0")[0].decode("latin-1")
        fields.rest(f"name {name!r}" if name else "name empty: the current folder")

    def started(self, fields: _Fields) -> None:
        fields.take(2, "unknown")
        code = int.from_bytes(fields.data[:2], "big", signed=True)
        fields.take(2, f"code {code} {_code_name(code)}")
        if fields.data and not any(fields.data):
            fields.rest("unknown, all zero")

    def text(self, fields: _Fields) -> None:
        fields.rest("text of the program")

    def commands(self, fields: _Fields) -> None:
        try:
            self._asked = read_requests(fields.data)
        except ProtocolError as error:
            self._asked = []
            fields.rest(f"no commands: {error}")
            return
        fields.number(2, "{} command blocks")
        for number, request in enumerate(self._asked, 1):
            layout = _head(fields, number, request)
            names = layout.arguments.split() if layout else []
            for k, value in enumerate(request.arguments):
                name = names[k] if k < len(names) else "argument" if layout is None else "unused argument"
                fields.take(4, _argument(request, name, value))
            fields.take(2, f"tag {request.tag}")
            fields.take(2, f"data of {len(request.data)} bytes")
            if request.data:
                self._data(fields, request, layout)

    def _data(self, fields: _Fields, request: Request, layout: Layout | None) -> None:
        if layout is None or not (layout.data or layout.data_each):
            fields.take(len(request.data), "unknown")
            return
        end = fields.at + len(request.data)
        _read(fields, layout.data, end)
        while layout.data_each and fields.at < end:
            before = fields.at
            _read(fields, layout.data_each, end)
            if fields.at == before:
                break
        fields.take(end - fields.at, "unknown")

    def answers(self, fields: _Fields) -> None:
        try:
            found = read_replies(fields.data)
        except ProtocolError as error:
            fields.rest(f"no answers: {error}")
            return
        version = int.from_bytes(fields.made[1].data, "big")
        fields.number(2, "{} answer blocks")
        for number, (echo, reply) in enumerate(found, 1):
            asked = self._asked[number - 1] if number <= len(self._asked) else None
            if asked is not None and (asked.command, asked.target) != (echo.command, echo.target):
                asked = None
            layout = _head(fields, number, echo)
            fields.take(2, f"status {reply.status} {_code_name(reply.status)}")
            fields.take(2, f"detail {reply.detail}")
            fields.take(2, f"detail {reply.detail2}")
            fields.take(2, f"payload of {len(reply.payload)} bytes")
            end = fields.at + len(reply.payload)
            if layout is not None:
                _payload(fields, layout, asked or echo, end, 8 if version <= 2 else 32)
            fields.take(end - fields.at, "unknown")


def _head(fields: _Fields, number: int, request: Request) -> Layout | None:
    fields.number(2, f"block {number}: {{}} bytes")
    fields.take(2, f"target {_TARGETS.get(request.target, str(request.target) + ': unknown')}")
    fields.take(2, f"path {request.path}")
    layout = LAYOUTS.get((request.target, request.command))
    fields.take(2, f"command 0x{request.command:02X} {layout.function if layout else ': unknown'}")
    return layout


def _argument(request: Request, name: str, value: int) -> str:
    if request.target == PMC and name == "area" and 0 <= value < len(AREAS):
        return f"area {value}: {AREAS[value]}"
    if name in ("axis", "spindle", "type") and value == -1:
        return f"{name} -1: all"
    return f"{name} {value}"


def _payload(fields: _Fields, layout: Layout, asked: Request, end: int, axes: int) -> None:
    _read(fields, layout.head, end, asked, axes)
    record = 0
    while layout.each and fields.at < end:
        record += 1
        before = fields.at
        _read(fields, layout.each, end, asked, axes, f" ({record})")
        if fields.at == before:
            break


def _read(
    fields: _Fields, declared: str, end: int, asked: Request | None = None, axes: int = 32, suffix: str = ""
) -> None:
    """Take the fields of a record, as far as there are bytes."""
    text_size = asked.arguments[_ALARM_SIZE_AT] if asked is not None and any(asked.arguments) else None
    for part, data in record(declared).cut(fields.data[: end - fields.at], text_size=text_size):
        if part.slot:
            each = Part(part.name, "8" if part.slot == VALUE8_SIZE else "i")
            for axis in range(1, min(axes, len(data) // part.slot) + 1):
                slot = fields.data[: part.slot]
                fields.take(part.slot, f"axis {axis}{suffix}: {each.shown(slot)}")
        elif part.code == "*":
            _bytes(fields, part.name, len(data), asked)
        else:
            fields.take(
                len(data), "unknown" if part.name == "unknown" else f"{part.name}{suffix} {part.shown(data)}"
            )


def _bytes(fields: _Fields, name: str, left: int, asked: Request | None) -> None:
    width = None
    if asked is not None and asked.target == PMC and any(asked.arguments):
        width = dict(enumerate(PMC_WIDTHS)).get(asked.arguments[3])
    if asked is None or width is None or name == "unknown":
        fields.take(left, name)
        return
    letter = AREAS[asked.arguments[2]] if 0 <= asked.arguments[2] < len(AREAS) else "?"
    for k in range(left // width):
        data = fields.data[:width]
        fields.take(width, f"{letter}{asked.arguments[0] + k * width} = {int.from_bytes(data, 'big')}")


_NAMES = {int(code): code.name for code in fwlib.EW}
_NAMES[-17] = "EW_PROTOCOL"
_NAMES[-16] = "EW_SOCKET"


def _code_name(code: int) -> str:
    return _NAMES.get(code, "unknown code")


# fmt: off
_OPENING = (
    "unknown", "unknown", "unknown", "most axes", "most spindles", "path records", "unknown", "unknown", "axes", "axes",
    "unknown", "spindles", "spindles", "unknown", "paths", "unknown", "unknown", "unknown", "unknown", "unknown",
)
_PATH = (
    "machine type", "used", "unknown", "axes", "axes", "unknown", "spindles", "spindles", "unknown rest",
)
_OLD_OPENING = ("unknown", "unknown", "unknown", "most axes", "path records", "unknown", "axes", "spindles")
_OLD_PATH = ("machine type", "used", "axes", "spindles")
_BODIES: dict[int, Callable[[Dissector, _Fields], None]] = {
    FrameType.OPEN: Dissector.open,
    FrameType.OPENED: Dissector.opened,
    FrameType.OPEN_REFUSED: Dissector.status,
    FrameType.COMMANDS: Dissector.commands,
    FrameType.ANSWERS: Dissector.answers,
    FrameType.COMMANDS_REFUSED: Dissector.status,
    FrameType.DOWNLOAD_START: Dissector.start,
    FrameType.DOWNLOAD_START_STATUS: Dissector.status,
    FrameType.DOWNLOAD_DATA: Dissector.text,
    FrameType.DOWNLOAD_END_STATUS: Dissector.status,
    FrameType.UPLOAD_START: Dissector.start,
    FrameType.UPLOAD_STARTED: Dissector.started,
    FrameType.UPLOAD_START_STATUS: Dissector.status,
    FrameType.UPLOAD_DATA: Dissector.text,
    FrameType.UPLOAD_END_STATUS: Dissector.status,
}
# fmt: on


def dissect(data: bytes, dissector: Dissector | None = None) -> Iterator[str]:
    """Yield the lines that explain a stream of frames; what is no frame is said at its place.

    Requests and replies may stand in one stream, in the order of their time.
    """
    stream = Stream(dissector or Dissector())
    yield from stream.feed(data)
    yield from stream.end()


class Stream:
    """Explain the bytes of one direction as they come; both directions of a connection share a dissector."""

    def __init__(self, dissector: Dissector) -> None:
        self._dissector = dissector
        self._bytes = b""
        self._at = 0

    def feed(self, data: bytes) -> Iterator[str]:
        """Take bytes and yield what explains the frames that are whole now."""
        self._bytes += data
        while self._bytes:
            try:
                frame = next(FrameReader().feed(self._bytes), None)
            except ProtocolError as error:
                begin = self._bytes.find(SYNC, 1)
                size = len(self._bytes) if begin < 0 else begin
                yield f"no frame at {self._at}: {error}"
                yield from Field(0, self._cut(size), "unknown").lines()
                continue
            if frame is None:
                return
            yield f"frame at {self._at}, {_side(frame.type)}: {frame.name}"
            self._cut(HEADER + len(frame.body))
            for each in self._dissector.explain(frame):
                yield from each.lines()

    def end(self) -> Iterator[str]:
        """Yield what explains the bytes that are left."""
        if self._bytes:
            yield f"unfinished frame at {self._at}: {len(self._bytes)} bytes"
            yield from Field(0, self._cut(len(self._bytes)), "unknown").lines()

    def _cut(self, size: int) -> bytes:
        data, self._bytes = self._bytes[:size], self._bytes[size:]
        self._at += size
        return data


_FROM_CONTROL = frozenset(
    {
        FrameType.OPENED,
        FrameType.OPEN_REFUSED,
        FrameType.CLOSED,
        FrameType.ANSWERS,
        FrameType.COMMANDS_REFUSED,
    }
    | {FrameType.DOWNLOAD_STARTED, FrameType.DOWNLOAD_START_STATUS, FrameType.DOWNLOAD_ENDED}
    | {FrameType.DOWNLOAD_END_STATUS, FrameType.UPLOAD_STARTED, FrameType.UPLOAD_START_STATUS}
    | {FrameType.UPLOAD_DATA, FrameType.UPLOAD_FINISHED, FrameType.UPLOAD_END_STATUS}
)
_ALL_TYPES = frozenset(FrameType)


def _side(kind: int) -> str:
    if kind not in _ALL_TYPES:
        return "unknown side"
    return "control" if kind in _FROM_CONTROL else "client"
