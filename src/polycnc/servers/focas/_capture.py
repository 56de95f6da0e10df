"""Captured bytes in files: hex as text, raw bytes, and what packet sniffers write (pcap, pcapng)."""

from __future__ import annotations

import io
import re
import socket
from collections.abc import Iterator
from dataclasses import dataclass, field
from struct import error as struct_error
from typing import Any

from polycnc.errors import UsageError
from polycnc.servers.focas._dissect import Dissector, Stream, dissect

_PCAP = {bytes.fromhex(magic) for magic in ("d4c3b2a1", "a1b2c3d4", "4d3cb2a1", "a1b23c4d")}
_PCAPNG = bytes.fromhex("0a0d0d0a")
_OFFSET = re.compile(r"^\s*(?:[0-9A-Fa-f]{4,8}:|000[0-9A-Fa-f]{5}\s{2})\s*")
_NOTE = re.compile(r"\[[^\]]*\]|<[^>]*>|#.*|;.*")
_SIDE = re.compile(r"^\s*(?:[<>]|->|<-|C:|S:)\s*")
_HEX = re.compile(r"(?:0[xX])?([0-9A-Fa-f]+)")
_MOST_BYTES = 64 << 20
_HALF = 1 << 31


def explain_capture(data: bytes, name: str = "the capture", port: int = 8193) -> Iterator[str]:
    """Yield the lines that explain a captured file; `port` is the control's in files of packets.

    Raises:
        UsageError: It is neither hex nor a file of packets, or too large.
    """
    if len(data) > _MOST_BYTES:
        raise UsageError(
            f"{name} has {len(data)} bytes", hint=f"At most {_MOST_BYTES} are explained at once."
        )
    if data[:4] in _PCAP or data[:4] == _PCAPNG:
        yield from _explain_packets(data, name, port)
    elif data[:4] == b"\xa0" * 4:
        yield from dissect(data)
    else:
        yield from dissect(from_hex(data, name))


def from_hex(data: bytes, name: str = "the capture") -> bytes:
    """Return the bytes that a text of hex digits says, with offsets and notes in [], <> or after # left out.

    Raises:
        UsageError: It is no text, or a line has something else than hex digits.
    """
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        raise UsageError(
            f"{name} is neither hex as text nor a file of packets",
            hint="Give hex digits, raw bytes that begin with a0 a0 a0 a0, pcap or pcapng.",
        ) from None
    made = bytearray()
    for number, line in enumerate(text.splitlines(), 1):
        line = _NOTE.sub(" ", _OFFSET.sub("", _SIDE.sub("", line)))
        for word in line.replace(",", " ").split():
            found = _HEX.fullmatch(word)
            if found is None or len(found[1]) % 2:
                raise UsageError(
                    f"{name}:{number}: '{word[:20]}' is no byte in hex",
                    hint="Write bytes as pairs of hex digits; notes go into [] or after #.",
                )
            made += bytes.fromhex(found[1])
    return bytes(made)


# ---------------------------------------------------------------------- packets


@dataclass
class _Half:
    """One direction of a connection: puts segments in order and leaves out what came twice."""

    stream: Stream
    expected: int | None = None
    early: dict[int, bytes] = field(default_factory=dict)

    def take(self, sequence: int, data: bytes, *, begins: bool) -> bytes:
        if begins:
            self.expected, self.early = (sequence + 1) & 0xFFFFFFFF, {}
            return b""
        if not data:
            return b""
        if self.expected is None:
            self.expected = sequence  # the capture began in the middle
        self.early[sequence] = max(self.early.get(sequence, b""), data, key=len)
        made = b""
        while True:
            at = next((each for each in self.early if (self.expected - each) & 0xFFFFFFFF < _HALF), None)
            if at is None:
                return made
            piece = self.early.pop(at)
            new = piece[(self.expected - at) & 0xFFFFFFFF :]
            made += new
            self.expected = (self.expected + len(new)) & 0xFFFFFFFF


def _explain_packets(data: bytes, name: str, port: int) -> Iterator[str]:
    try:
        import dpkt
    except ImportError:
        raise UsageError(
            "reading files of packets needs dpkt", hint="Install it: pip install 'polycnc[capture]'."
        ) from None
    connections: dict[tuple[str, int, str], tuple[_Half, _Half]] = {}
    try:
        reader = (dpkt.pcapng if data[:4] == _PCAPNG else dpkt.pcap).Reader(io.BytesIO(data))
        packets = iter(reader)
        link = reader.datalink()
        while (packet := next(packets, None)) is not None:
            found = _tcp(dpkt, link, packet[1])
            if found is None or port not in (found[1].sport, found[1].dport):
                continue
            ip, tcp = found
            ends = (_address(ip.src), tcp.sport), (_address(ip.dst), tcp.dport)
            to_control = tcp.dport == port
            client, control = ends if to_control else ends[::-1]
            key = (*client, control[0])
            if key not in connections:
                dissector = Dissector()
                connections[key] = _Half(Stream(dissector)), _Half(Stream(dissector))
                yield f"connection of {client[0]}:{client[1]} to {control[0]}:{port}"
            half = connections[key][0 if to_control else 1]
            new = half.take(tcp.seq, bytes(tcp.data), begins=bool(tcp.flags & dpkt.tcp.TH_SYN))
            lines = list(half.stream.feed(new)) if new else []
            if lines and len(connections) > 1:
                yield f"{client[0]}:{client[1]}"
            yield from lines
    except (dpkt.Error, ValueError, struct_error) as error:
        yield f"{name} breaks off: {error or type(error).__name__}"
    for key, halves in connections.items():
        for half in halves:
            if half.early:
                yield f"{key[0]}:{key[1]}: {sum(map(len, half.early.values()))} bytes after a gap"
            yield from half.stream.end()
    if not connections:
        yield f"no connection to port {port}"


def _tcp(dpkt: Any, link: int, packet: bytes) -> tuple[Any, Any] | None:
    """Return the IP packet and the TCP segment in a packet of a link, None if there is none."""
    kinds = {
        dpkt.pcap.DLT_EN10MB: dpkt.ethernet.Ethernet,
        dpkt.pcap.DLT_LINUX_SLL: dpkt.sll.SLL,
        276: dpkt.sll2.SLL2,
        dpkt.pcap.DLT_NULL: dpkt.loopback.Loopback,
    }
    try:
        if link in kinds:
            ip = kinds[link](packet).data
        else:
            ip = (dpkt.ip6.IP6 if packet[0] >> 4 == 6 else dpkt.ip.IP)(packet)
    except (dpkt.Error, IndexError, struct_error):
        return None  # not ours
    if not isinstance(ip, (dpkt.ip.IP, dpkt.ip6.IP6)) or not isinstance(ip.data, dpkt.tcp.TCP):
        return None
    return ip, ip.data


def _address(packed: bytes) -> str:
    return socket.inet_ntop(socket.AF_INET if len(packed) == 4 else socket.AF_INET6, packed)
