"""What a channel holds at one cycle, as a value to go back to, and the classes that such values are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from polycnc.errors import ProgramError, SourcePosition
from polycnc.machine import Form
from polycnc.nc.blocks._channel_state import Cycle, Plain, SavedState
from polycnc.nc.blocks._compensation import Leads, RadiusCompensation, SavedCompensation
from polycnc.nc.blocks._coordinates import Coordinates
from polycnc.nc.blocks._corners import Corner
from polycnc.nc.blocks._cycles import CycleWords
from polycnc.nc.blocks._events import Event
from polycnc.nc.blocks._messages import Message, SavedMessages
from polycnc.nc.blocks._moves import Arc, Feed, Line, Spline, Stop, Wait
from polycnc.nc.blocks._nurbs_curve import Nurbs
from polycnc.nc.blocks._offset_geometry import Leg
from polycnc.nc.blocks._probe import Probe
from polycnc.nc.blocks._queue import WriterSnapshot
from polycnc.nc.blocks._tables import SavedTables
from polycnc.nc.blocks._tip import TipShift
from polycnc.nc.blocks._turning import Turning
from polycnc.nc.channel._preparation import SavedTurns
from polycnc.nc.channel._running import Back, SavedCall
from polycnc.nc.modal._actions import Family
from polycnc.nc.modal._frame import Frame, Polar, Rotation
from polycnc.nc.modal._modal_snapshot import ModalSnapshot, Spindle
from polycnc.nc.modal._placement import Placement, Shifts
from polycnc.nc.modal._suppressed import Suppressed
from polycnc.nc.records._block_records import Call, SavedRecords
from polycnc.nc.records._replay import RunBegin
from polycnc.nc.text._place import Place
from polycnc.nc.text._program import ProgramText


class ChannelSnapshot(NamedTuple):
    """Hold where a channel stood, to go back to; `language` is what its language says of itself."""

    state: SavedState
    tables: SavedTables
    calls: tuple[SavedCall, ...]
    place: Place
    text_end: int
    calls_within: tuple[Call, ...]
    blocks: int
    errors: tuple[ProgramError, ...]
    messages: SavedMessages
    flags: tuple[bool, bool]
    turns: SavedTurns
    suppressed: Suppressed
    writer: WriterSnapshot
    records: SavedRecords
    interpreter: tuple[int, ProgramText, ProgramText]
    language: object


CHANNEL_CLASSES: Sequence[type] = (
    Arc, Back, Call, ChannelSnapshot, Coordinates, Corner, Cycle, CycleWords, Event, Family, Feed, Frame, Leg, Line,
    Message, ModalSnapshot, Nurbs, Place, Placement, Plain, Polar, Probe, Rotation, RunBegin, SavedCall,
    Leads, SavedCompensation, SavedRecords, SavedState, SavedTables, SavedTurns, Shifts, SourcePosition, Spindle,
    Spline, Stop, Suppressed, TipShift, Turning, Wait, WriterSnapshot,
)  # fmt: skip
"""The classes of which a snapshot of a channel is made, beside those of its language."""


class Texts:
    """The program texts of a snapshot: each once, and named by its place among them."""

    def __init__(self, texts: Sequence[ProgramText] = ()) -> None:
        self.all = list(texts)
        self._places = {id(text): n for n, text in enumerate(self.all)}

    def forms(self) -> Mapping[type, Form]:
        """Return how texts and errors are kept."""
        return {
            ProgramText: Form(self._place, self._text),
            ProgramError: Form(_taken, _error),
            RadiusCompensation: Form(lambda stage: (stage.saved(),), RadiusCompensation.of),
        }

    def _place(self, text: ProgramText) -> tuple[int]:
        found = self._places.get(id(text))
        if found is None:
            found = next(
                (
                    n
                    for n, each in enumerate(self.all)
                    if each.name == text.name and each.content == text.content
                ),
                len(self.all),
            )
            if found == len(self.all):
                self.all.append(text)
            self._places[id(text)] = found
        return (found,)

    def _text(self, place: int) -> ProgramText:
        if not 0 <= place < len(self.all):
            raise ValueError(f"there is no text {place}")
        return self.all[place]


def _taken(error: ProgramError) -> tuple[object, ...]:
    return error.what, error.code, error.position, error.hint, error.limit


def _error(
    what: str, code: str, position: SourcePosition | None, hint: str, limit: tuple[str, bool, bool] | None
) -> ProgramError:
    made = ProgramError(what, code=code, position=position, hint=hint)
    made.limit = limit
    return made
