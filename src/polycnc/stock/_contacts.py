"""What goes wrong while a tool cuts: kinds, where it was, and one note of each for a block."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

Place = tuple[float, float, float]


class ContactKind(StrEnum):
    """What went wrong."""

    RAPID = "rapid through stock"
    HOLDER = "holder in stock"
    SHANK = "shank in stock"
    SPINDLE = "cut with the spindle at rest"
    DIRECTION = "cut with the spindle turning the wrong way"
    FLUTES = "cut deeper than the flutes are long"
    FIXTURE = "tool in fixture"
    FIXTURE_SHANK = "shank in fixture"
    FIXTURE_HOLDER = "holder in fixture"
    GOUGE = "gouge"


@dataclass(frozen=True, slots=True)
class Contact:
    """Say what went wrong in a block, the first time: number of the block, time, place and depth (mm)."""

    kind: ContactKind
    block: int
    t_s: float
    place: Place
    depth_mm: float


@dataclass(frozen=True, slots=True)
class Idle:
    """Say that a block feeds through air alone: number of the block, when it begins, for how long, and where to."""

    block: int
    t_s: float
    duration_s: float
    place: Place


class Contacts:
    """Keep one contact for each kind and block: when it began, and its greatest depth with the place of that."""

    def __init__(self) -> None:
        self._found: dict[tuple[ContactKind, int], Contact] = {}

    def note(self, contact: Contact) -> None:
        """Keep a contact, or what it adds to one that is known."""
        key = contact.kind, contact.block
        known = self._found.get(key)
        if known is None:
            self._found[key] = contact
        elif contact.depth_mm > known.depth_mm:
            self._found[key] = Contact(*key, known.t_s, contact.place, contact.depth_mm)

    def all(self) -> list[Contact]:
        """Return them in the order of time."""
        return sorted(self._found.values(), key=lambda each: each.t_s)
