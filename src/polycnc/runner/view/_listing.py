"""The listing beside the path: the lines of each program that was executed, and what is said about them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.nc import ProgramText
from polycnc.runner._blocks import Blocks
from polycnc.runner._outcome import RunOutcome
from polycnc.runner.view._track import Track

_MOST_LINES = 250_000  # of a listing; of longer programs only the lines that the path shows are listed
_MOST_COLUMNS = 400  # of a listed line


class Listing:
    """The lines beside the path: of each program that was executed, the main program first."""

    def __init__(self, result: RunOutcome, track: Track, texts: dict[str, ProgramText]) -> None:
        if result.source is not None:
            texts = {result.source.name: result.source, **texts}
        self.whole = sum(text.content.count(b"\n") + 1 for text in texts.values()) <= _MOST_LINES
        self.texts: list[str] = []
        self._shown: dict[str, tuple[npt.NDArray[np.int64], int]] = {}  # lines, and the row of the first one
        lines: list[npt.NDArray[np.int64]] = []  # 0 for the name of a program
        executed = track.blocks.program[track.number], track.blocks.line[track.number]
        for name, text in texts.items():
            if len(texts) > 1:
                lines.append(np.zeros(1, np.int64))
                self.texts.append(name)
            if self.whole:
                rows = _lines(text)
                shown = np.arange(1, len(rows) + 1)
            else:
                number = track.blocks.names.index(name) if name in track.blocks.names else -1
                shown = np.unique(executed[1][executed[0] == number]).astype(np.int64)
                shown = shown[shown >= 1]
                rows = [text.line(text.line_start(line)) for line in shown.tolist()]
            self._shown[name] = shown, len(self.texts)
            lines.append(shown)
            self.texts += [row[:_MOST_COLUMNS] for row in rows]
        self.lines = np.concatenate([np.zeros(0, np.int64), *lines])
        self._main = next(iter(texts), "")

    def rows_of(self, blocks: Blocks) -> npt.NDArray[np.int32]:
        """Return the row of each block, -1 for one that is not listed."""
        found = np.full(len(blocks), -1, np.int32)
        for number, name in enumerate(blocks.names):
            here = blocks.program == number
            found[here] = self._rows(name, blocks.line[here])
        return found

    def row_of(self, line: int, name: str | None = None) -> int:
        """Return the row of a line of a program, or of the main one; -1 where it is not listed."""
        return int(self._rows(self._main if name is None else name, np.array([line]))[0])

    def _rows(self, name: str, lines: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
        shown, first = self._shown.get(name, (np.zeros(0, np.int64), 0))
        if not len(shown):
            return np.full(len(lines), -1)
        place = np.minimum(np.searchsorted(shown, lines), len(shown) - 1)
        return np.where(shown[place] == lines, first + place, -1)

    def remarks(self, result: RunOutcome) -> list[dict[str, Any]]:
        """Return alarms and remarks with the rows that they are about, -1 where there is none."""
        alarms = [
            {
                "kind": "alarm",
                "text": alarm.text,
                "hint": alarm.hint,
                "line": alarm.line,
                "row": self.row_of(alarm.line, alarm.file or None),
                "time_s": alarm.time_s,
            }
            for alarm in result.alarms
        ]
        remarks = [
            {
                "kind": "remark",
                "text": message.text + (f" ({message.count} times)" if message.count > 1 else ""),
                "line": message.line,
                "row": self.row_of(message.line),
                "time_s": None,
            }
            for message in result.messages
        ]
        collisions = [
            {
                "kind": "collision",
                "text": str(each),
                "line": each.line,
                "row": self.row_of(each.line, each.program or None),
                "time_s": each.t_s,
            }
            for each in result.collisions
        ]
        return alarms + collisions + remarks


def _lines(text: ProgramText) -> list[str]:
    try:
        decoded = text.content.decode("utf-8")
    except UnicodeDecodeError:
        decoded = text.content.decode("latin-1")
    return decoded.replace("\r\n", "\n").replace("\r", "\n").removesuffix("\n").split("\n")
