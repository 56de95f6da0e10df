"""Blocks put in by hand while those before them are executed (Manual 003, 4.14.2: MCOPS(4), 4096)."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from polycnc.cnc import ControlError, Refusal
from polycnc.nc import Pause, ProgramText, SourceItem, TextSpan

SIZE_BYTES = 4095
"""What the buffer holds of blocks with their line feeds, without the zero byte after them."""


class BlockBuffer:
    """The blocks of a channel that wait; `text` is what stands for all of them in the channel."""

    def __init__(self, text: ProgramText) -> None:
        self.text = text
        self.waiting: deque[str] = deque()

    def next(self) -> SourceItem | None:
        """Return the next block, a pause where none waits."""
        if not self.waiting:
            return Pause.PAUSE
        block = ProgramText.from_text(self.waiting.popleft(), self.text.name)
        return TextSpan(0, 1, len(block), text=block)

    def leave(self) -> bool:
        """Return False: no sub-program is entered here."""
        return False

    def failed(self) -> None:
        """Throw away what waits: a block before it is wrong."""
        self.waiting.clear()

    def close(self) -> None:
        """Throw away what waits: it was reset."""
        self.waiting.clear()


def check_room(blocks: Sequence[str]) -> None:
    """Make sure that blocks fit into the buffer.

    Raises:
        ControlError: They do not.
    """
    size = sum(len(block.encode("latin-1", "replace")) + 1 for block in blocks) - 1
    if size > SIZE_BYTES:
        raise ControlError(
            Refusal.FULL,
            f"the buffer has {SIZE_BYTES} bytes, not {size}",
            hint="Wait until blocks are executed.",
        )
