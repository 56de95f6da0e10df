"""Positions along a profile that is only read: while it lasts they are what its lines may ask for."""

from __future__ import annotations

from collections.abc import Mapping
from types import TracebackType

from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.modal._modal import ABSOLUTE, NO_AXIS

_WAYS = {"U": "X", "W": "Z"}


class ProfilePlaces:
    """Let the position of a channel be where a profile leads; it is as before afterwards."""

    def __init__(self, state: ChannelState) -> None:
        self._modal = state.modal
        self._before = state.modal.position.copy()

    def __enter__(self) -> ProfilePlaces:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._modal.position[:] = self._before

    def go_on(self, words: Mapping[str, float]) -> None:
        """Go where the words of a line lead."""
        modal = self._modal
        for letter in "XZUW":
            axis = int(modal.letter_axis[ord(_WAYS.get(letter, letter)) - ord("A")])
            if letter not in words or axis == NO_AXIS:
                continue
            way = words[letter] * float(modal.scale[axis])
            if letter in _WAYS or not modal.whole[ABSOLUTE]:
                modal.position[axis] += way
            else:
                modal.position[axis] = way + float(modal.offset[axis])
