"""The lines of a profile: a sub-program that is carried out for a cycle, and moves nothing by itself."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import TracebackType

from polycnc.language import Traced
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.modal._modal import ABSOLUTE, NO_AXIS
from polycnc.nc.rs274._functions import NumberError
from polycnc.nc.rs274._parameters import LAST_LOCAL
from polycnc.nc.rs274._program import profile_label
from polycnc.nc.sources._block_source import WordsBlock
from polycnc.nc.text._scan import PLAIN
from polycnc.nc.text._scan_plain import Block

_MOST_LINES = 10_000
_LARGEST = 1e9
_WAYS = {"U": "X", "W": "Z"}


def profile_of(
    functions: Mapping[str, Traced[int]],
    loaded: Callable[[Traced[int]], Callable[[list[float], dict[str, float]], Iterator[object]]],
    state: ChannelState,
    words: Sequence[tuple[str, float, int]],
) -> tuple[Block, ...] | None:
    """Return the lines of the sub-program that Q among the `words` of a cycle names; None if there is none.

    Positions that it asks for are those along the profile, from X, Z of the cycle.

    Raises:
        NumberError: it gives more than lines of words, or too many of them.
    """
    begin = {letter: value for letter, value, _ in words}
    if not abs(number := begin.get("Q", math.inf)) < _LARGEST:
        return None
    traced = functions.get(profile_label(str(round(number))))
    if traced is None:
        return None
    run = loaded(traced)([0.0] * (LAST_LOCAL + 1), {})
    lines: list[Block] = []
    with ProfilePlaces(state) as places:
        places.go_on({letter: value for letter, value in begin.items() if letter in "XZ"})
        for item in run:
            if not isinstance(item, WordsBlock):
                raise NumberError("a profile with a call, a wait or a loop without end", "Let it hold moves.")
            lines.append(Block(item.words, PLAIN, 0, item.offset, item.line))
            places.go_on({word.letter: word.value for word in item.words})
            if len(lines) > _MOST_LINES:
                raise NumberError(f"a profile of more than {_MOST_LINES} lines", "Check its loops.")
    return tuple(lines)


class ProfilePlaces:
    """Let the position of a channel be where a profile leads; it is as before afterwards."""

    def __init__(self, state: ChannelState) -> None:
        self._state = state
        self._before = state.modal.position.copy()

    def __enter__(self) -> ProfilePlaces:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._state.modal.position[:] = self._before

    def go_on(self, words: Mapping[str, float]) -> None:
        """Go where the words of a line lead."""
        modal = self._state.modal
        for letter in "XZUW":
            axis = self._state.axis(_WAYS.get(letter, letter))
            if letter not in words or axis == NO_AXIS:
                continue
            way = words[letter] * float(modal.scale[axis])
            if letter in _WAYS or not modal.whole[ABSOLUTE]:
                modal.position[axis] += way
            else:
                modal.position[axis] = way + float(modal.offset[axis])
