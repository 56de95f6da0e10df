"""Motion, at once and into the spoolers: jogs, searches, stops, lines, circles, helices (Manual 002, 4.4.19 to 4.4.39).

Speeds and distances of interpolation are in the units of ctru; a jog takes those of its axis.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, TypeVar

from polycnc.controllers.apci.board import _jog_commands as jogs
from polycnc.controllers.apci.board._move_commands import MOVES, Kind, Speeds, go, queue
from polycnc.controllers.apci.board._path_units import trajectory_units
from polycnc.controllers.apci.board._records import AS, CMP, HMP, HMP3D, LMP, TSRP
from polycnc.controllers.apci.library._call import LONG, Records, SelectedRecords, axes_call, axes_order
from polycnc.controllers.apci.library._session import UNKNOWN_ERROR, Selection
from polycnc.controllers.library import Refused, named
from polycnc.errors import UsageError

Jog: TypeAlias = Callable[[AS, Records], None]

# ---------------------------------------------------------------------- single axes


def _jog(command: Callable[..., None], what: str, section: int, note: str = "") -> Jog:
    """Make the function of a jog: each of the selected axes by itself, with the number in its record."""

    def order(asel: Selection, tsrp: Records) -> None:
        if isinstance(tsrp, TSRP) or max(asel.axes) >= len(tsrp):
            raise UsageError(
                "there is no TSRP record for every selected axis", hint="pass all records: tsrp_array()"
            )
        asel.order(command, [tsrp[axis].tp for axis in asel.axes])

    text = f"{what} (Manual 002, 4.4.{section}).\n\n{note}{_NO_RECORD}"
    arguments = {"asel": Selection, "tsrp": SelectedRecords}
    return axes_call(named(order, command.__name__, text, arguments))


_NO_RECORD = "Raises:\n    UsageError: `tsrp` has no record for a selected axis."
_RECORDS_OF_ALL = (
    "`tsrp` is the whole sequence of records, indexed by axis number; accelerations and velocities are those that\n"
    "wrjac, wrjvl and wrjtvl wrote.\n\n"
)

# fmt: off
ja  = _jog(jogs.ja,  "Jog the selected axes to `tsrp[axis].tp`, each by itself", 19, _RECORDS_OF_ALL)
jr  = _jog(jogs.jr,  "Jog the selected axes by `tsrp[axis].tp`, each by itself", 23)
jhi = _jog(jogs.jhi, "Search the encoder's index over the distance `tsrp[axis].tp`", 20)
jhl = axes_order(jogs.jhl, "Search the reference switches to the left", 21)
jhr = axes_order(jogs.jhr, "Search the reference switches to the right", 22)
js  = axes_order(jogs.js,  "Stop each selected axis by itself with its stop deceleration; queues are rejected", 24)
# fmt: on


@axes_call
def ms(asel: Selection) -> None:
    """Stop the selected axes along their path; queues are rejected (Manual 002, 4.4.39).

    With MODEREG bit MS_DECEL the deceleration is TRAC.
    """
    _, acceleration_unit = trajectory_units(asel.board)
    asel.order(jogs.ms_of_pc, asel.board.variables.trac * acceleration_unit)


# ---------------------------------------------------------------------- interpolation

M = TypeVar("M", LMP, CMP, HMP, HMP3D)
Move: TypeAlias = Callable[[AS, M], None]


def _of_line(lmp: LMP, axes: Sequence[int]) -> tuple[Any, ...]:
    return ([lmp.dtm[axis] for axis in axes],)


def _of_circle(cmp: CMP, axes: Sequence[int]) -> tuple[Any, ...]:
    return (cmp.dtca1, cmp.dtca2), cmp.phi


def _of_helix(hmp: HMP, axes: Sequence[int]) -> tuple[Any, ...]:
    return (hmp.dtca1, hmp.dtca2), hmp.phi, [hmp.dtm[axis] for axis in axes]


def _of_space(hmp3d: HMP3D, axes: Sequence[int]) -> tuple[Any, ...]:
    return (hmp3d.dtca1, hmp3d.dtca2, hmp3d.dtca3), (hmp3d.pn1, hmp3d.pn2, hmp3d.pn3), hmp3d.phi


_RECORDS: dict[type, tuple[Callable[..., tuple[Any, ...]], int, int | None]] = {
    LMP: (_of_line, 1, None),
    CMP: (_of_circle, 2, 2),
    HMP: (_of_helix, 2, None),
    HMP3D: (_of_space, 3, 3),
}
"""What a record gives to its shape, the fewest axes that it takes, and how many of them."""


def _order(
    asel: Selection, record: Any, kind: Kind, relative: bool, verb: Callable[..., None], *index: int
) -> None:
    numbers_of, fewest, most = _RECORDS[type(record)]
    if len(asel.axes) < fewest:
        raise Refused(UNKNOWN_ERROR)
    axes = asel.axes[:most]
    shape = kind(*numbers_of(record, axes), relative=relative)
    verb(asel.board, axes, shape, Speeds(record.ac, record.vl, record.tvl), *index)


def _moves(stem: str, record: type[M], what: str, section: int) -> tuple[Move[M], Move[M]]:
    """Make the function that moves at once, and the one that queues the same."""

    def at_once(asel: Selection, moved: Any) -> None:
        _order(asel, moved, *MOVES[stem], go)

    def queued(asel: Selection, moved: Any) -> None:
        _order(asel, moved, *MOVES[stem], queue)

    argument = {"asel": Selection, record.__name__.lower(): record}
    source = f"(Manual 002, 4.4.{section})."
    return (
        axes_call(named(at_once, stem, f"Move {what} {source}", argument)),
        axes_call(named(queued, f"s{stem}", f"Queue a move {what} {source}", argument)),
    )


# fmt: off
#                       stem    record  what                                                                 section
mla, smla     = _moves("mla",   LMP,   "on a straight line to the targets `lmp.dtm[axis]`",                       37)
mlr, smlr     = _moves("mlr",   LMP,   "on a straight line by the distances `lmp.dtm[axis]`",                     38)
mca, smca     = _moves("mca",   CMP,   "on a circle of the first two selected axes about an absolute centre",     28)
mcr, smcr     = _moves("mcr",   CMP,   "on a circle of the first two selected axes, centre from where it begins", 29)
mha, smha     = _moves("mha",   HMP,   "on a helix to `hmp.dtm[axis]`, or by `hmp.phi` if it is an angle",        35)
mhr, smhr     = _moves("mhr",   HMP,   "on a helix, centre and distances from where it begins",                   36)
mca3d, smca3d = _moves("mca3d", HMP3D, "on a circle in space about an absolute centre",                           30)
mcr3d, smcr3d = _moves("mcr3d", HMP3D, "on a circle in space, centre from where it begins",                       31)
# fmt: on


@axes_call
def smlai(asel: Selection, lmp: LMP, PcapIndex: LONG) -> None:  # noqa: N803
    """Queue a straight line to targets, with an index; only named in the manual (Manual 002, 4.4.94)."""
    _order(asel, lmp, *MOVES["mla"], queue, PcapIndex)


@axes_call
def smlri(asel: Selection, lmp: LMP, PcapIndex: LONG) -> None:  # noqa: N803
    """Queue a straight line by distances, with an index; only named in the manual (Manual 002, 4.4.94)."""
    _order(asel, lmp, *MOVES["mlr"], queue, PcapIndex)


# fmt: off
__all__ = [
    "ja", "jhi", "jhl", "jhr", "jr", "js", "mca", "mca3d", "mcr", "mcr3d", "mha", "mhr", "mla", "mlr",
    "ms", "smca", "smca3d", "smcr", "smcr3d", "smha", "smhr", "smla", "smlai", "smlr", "smlri",
]
# fmt: on
