"""Where programmed positions lie, beside work offsets: shifts, a pole with scale and angle, a turned workpiece."""

from __future__ import annotations

from dataclasses import dataclass, field

from polycnc.nc.modal._frame import Rotation

Vector = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Placement:
    """Hold what a program has said about this; vectors have one value per axis (mm or degree) or are empty for none.

    `contour`, `program` and `additive` shift programmed positions; `poles` and `factors` scale and `angle_deg` turns
    them; `position` and `position_deg` place and turn the workpiece on the machine. `offsets` are the codes of
    external offsets in force, `compensations` those of external tool data. `codes` are the G codes that were
    programmed, the latest last; motion and distance are not among them. `once` is the code of a function that holds for
    the last block alone, 0 if it had none; `plane` the axes of a plane that was selected by their names.
    """

    contour: Vector = ()
    program: Vector = ()
    additive: Vector = ()
    poles: dict[int, float] = field(default_factory=dict, hash=False)
    factors: dict[int, float] = field(default_factory=dict, hash=False)
    angle_deg: float = 0.0
    position: Vector = ()
    position_deg: float = 0.0
    offsets: tuple[str, ...] = ()
    compensations: tuple[int, ...] = ()
    codes: tuple[int, ...] = ()
    once: int = 0
    plane: tuple[int, int] | None = None

    def turn(self, plane: tuple[int, int]) -> Rotation | None:
        """Return how the workpiece is turned on the machine, about its zero."""
        return Rotation(*plane, 0.0, 0.0, self.position_deg) if self.position_deg else None


@dataclass(frozen=True, slots=True)
class Shifts:
    """Hold how program zero lies beside work offsets and tools; vectors are empty for none.

    `preset` is what G92 shifts, `own` all that the program shifts, turned as `turn` turns the workpiece.
    """

    preset: Vector = ()
    own: Vector = ()
    turn: Rotation | None = None

    def back(self, found: list[float]) -> list[float]:
        """Return distances from program zero in the coordinates of the turned workpiece; `found` becomes them."""
        if (turn := self.turn) is not None:
            found[turn.p], found[turn.q] = turn.turned(found[turn.p], found[turn.q], -1.0)
        return found


NO_PLACEMENT = Placement()
NO_SHIFTS = Shifts()
"""Where positions lie when a program has said nothing of it."""


def total(axes: int, *vectors: Vector) -> list[float]:
    """Return the sum of vectors, empty ones being zero."""
    found = [0.0] * axes
    for vector in vectors:
        for index, value in enumerate(vector):
            found[index] += value
    return found
