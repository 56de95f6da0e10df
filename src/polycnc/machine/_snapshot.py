"""The state of a device at one cycle: compared bit for bit, written to a file, and put back only where it fits.

The arrays that compiled code works on are kept as their bytes; what Python holds beside them is plain data, written
in one canonical form, so that equal states are equal snapshots.
"""

from __future__ import annotations

import hashlib
import json
import struct
import zlib
from base64 import b64decode, b64encode
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any, Self, TypeAlias

import numpy as np
import numpy.typing as npt

from polycnc.errors import UsageError

Array: TypeAlias = npt.NDArray[Any]
Plain: TypeAlias = Mapping[str, Any]
"""Text, numbers, booleans, None, bytes, arrays of numbers, and lists and dictionaries of these."""

MAGIC = b"polycnc snapshot\n"
VERSION = 2
_MOST_BYTES = 1 << 28
_HEAD = struct.Struct("<I32sQ")  # version, SHA-256 of the rest, its length


class SnapshotError(UsageError):
    """A snapshot of something else, or a file that is none or is damaged."""


@dataclass(frozen=True, slots=True)
class Block:
    """The bytes of one array, and what they are."""

    layout: str
    shape: tuple[int, ...]
    content: bytes


@dataclass(frozen=True, slots=True)
class Snapshot:
    """The state of a device at cycle `cycle`; `made_from` tells apart devices that were not made alike."""

    device: str
    made_from: str
    cycle: int
    blocks: tuple[Block, ...]
    beside: str

    @classmethod
    def take(
        cls, device: str, made_from: str, cycle: int, arrays: Iterable[Array], beside: Plain | None = None
    ) -> Self:
        """Keep `arrays`, and what stands beside them, of a device."""
        blocks = tuple(Block(_layout(each), each.shape, each.tobytes()) for each in arrays)
        return cls(device, fingerprint(made_from), cycle, blocks, _encoded(beside or {}))

    def data(self) -> dict[str, Any]:
        """Return what stands beside the arrays.

        Raises:
            SnapshotError: It is not what a device writes.
        """
        try:
            found = json.loads(self.beside, object_hook=_decoded)
        except (ValueError, TypeError, LookupError, OverflowError, RecursionError) as error:
            raise damaged_snapshot(error, self.device) from error
        if not isinstance(found, dict):
            raise damaged_snapshot(device=self.device)
        return found

    def moment(self, name: str) -> datetime:
        """Return a date and time that stands beside the arrays.

        Raises:
            SnapshotError: There is none of this name.
        """
        try:
            return datetime.fromisoformat(self.data()[name])
        except (KeyError, TypeError, ValueError) as error:
            raise damaged_snapshot(error, self.device) from error

    def check(self, device: str, made_from: str, arrays: Iterable[Array]) -> None:
        """Make sure that this is a snapshot of a device like that one.

        Raises:
            SnapshotError: It is not.
        """
        if self.device != device:
            raise SnapshotError(
                f"this is a snapshot of a {self.device}, not of a {device}",
                hint="restore it where it was taken",
            )
        mine = tuple((_layout(each), each.shape, each.nbytes) for each in arrays)
        if self.made_from != fingerprint(made_from) or mine != tuple(
            (each.layout, each.shape, len(each.content)) for each in self.blocks
        ):
            raise SnapshotError(
                f"this is a snapshot of another {device}", hint="make one of the same configuration and size"
            )

    def restore_state(self, arrays: Iterable[Array]) -> None:
        """Fill the arrays of a device that has been checked."""
        for array, block in zip(arrays, self.blocks, strict=True):
            array[...] = np.frombuffer(block.content, array.dtype).reshape(array.shape)

    def to_bytes(self) -> bytes:
        """Return the snapshot as the contents of a file."""
        head = {
            "device": self.device,
            "made_from": self.made_from,
            "cycle": self.cycle,
            "blocks": [[each.layout, each.shape, len(each.content)] for each in self.blocks],
            "beside": self.beside,
        }
        text = json.dumps(head).encode()
        body = zlib.compress(
            b"".join((struct.pack("<Q", len(text)), text, *(each.content for each in self.blocks))), 1
        )
        return MAGIC + _HEAD.pack(VERSION, hashlib.sha256(body).digest(), len(body)) + body

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Return the snapshot that `to_bytes` has written.

        Raises:
            SnapshotError: The contents are not a snapshot, from a newer polycnc, or damaged.
        """
        start = len(MAGIC) + _HEAD.size
        if not content.startswith(MAGIC):
            raise SnapshotError("this is not a snapshot", hint="give a file that was written from one")
        if len(content) < start:
            raise damaged_snapshot("it is cut off")
        version, digest, size = _HEAD.unpack(content[len(MAGIC) : start])
        if version != VERSION:
            raise SnapshotError(
                f"the snapshot has version {version}, and this polycnc knows version {VERSION}",
                hint="use the polycnc that wrote it",
            )
        body = content[start:]
        if len(body) != size or hashlib.sha256(body).digest() != digest:
            raise damaged_snapshot("its check sum is wrong")
        try:
            return cls._read(_decompressed(body))
        except (
            ValueError,
            TypeError,
            LookupError,
            OverflowError,
            RecursionError,
            struct.error,
            zlib.error,
        ) as error:
            raise damaged_snapshot(error) from error

    @classmethod
    def _read(cls, body: bytes) -> Self:
        (length,) = struct.unpack_from("<Q", body)
        at = 8 + length
        head = json.loads(body[8:at])
        blocks = []
        for layout, shape, size in head["blocks"]:
            blocks.append(Block(str(layout), tuple(map(int, shape)), body[at : at + size]))
            at += size
        if at != len(body):
            raise ValueError(f"{len(body) - at} bytes are left over")
        return cls(
            str(head["device"]),
            str(head["made_from"]),
            int(head["cycle"]),
            tuple(blocks),
            str(head["beside"]),
        )


def _decompressed(body: bytes) -> bytes:
    unpacking = zlib.decompressobj()
    content = unpacking.decompress(body, _MOST_BYTES)
    if not unpacking.eof:
        raise ValueError("it is larger than any device's state, or cut off")
    return content


def arrays_of(value: object) -> list[Array]:
    """Return all arrays in nested tuples, in a fixed order."""
    if isinstance(value, np.ndarray):
        return [value]
    return [array for item in value for array in arrays_of(item)] if isinstance(value, tuple) else []


def fingerprint(text: str) -> str:
    """Return a short text that is another one for every other text."""
    return hashlib.sha256(text.encode()).hexdigest()


def damaged_snapshot(why: object = "", device: str = "") -> SnapshotError:
    """Return the error of a snapshot, of a device of this kind, that is damaged."""
    what = f"the snapshot of a {device} is damaged" if device else "the snapshot is damaged"
    return SnapshotError(f"{what}: {why}" if why else what, hint="use another one")


def _layout(array: Array) -> str:
    return repr(array.dtype.descr) if array.dtype.names else array.dtype.str


def _encoded(data: Plain) -> str:
    return json.dumps(data, default=_tagged, sort_keys=True, separators=(",", ":"))


def _tagged(value: object) -> object:
    if isinstance(value, bytes | bytearray):
        return {"$bytes": b64encode(value).decode()}
    if isinstance(value, np.ndarray):
        return {"$array": value.dtype.str, "shape": value.shape, "bytes": b64encode(value.tobytes()).decode()}
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a snapshot cannot hold a {type(value).__name__}")


def _decoded(pairs: dict[str, Any]) -> Any:
    if "$bytes" in pairs:
        return b64decode(pairs["$bytes"], validate=True)
    if "$array" in pairs:
        content = b64decode(pairs["bytes"], validate=True)
        return np.frombuffer(content, np.dtype(pairs["$array"])).reshape(pairs["shape"]).copy()
    return pairs
