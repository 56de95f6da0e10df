"""Where events become blocks: macros are called, blocks collected, and what a control file lacks is remarked."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from polycnc.errors import ProgramError
from polycnc.post.macros._control_file import ControlFile
from polycnc.post.macros._format import decimal
from polycnc.post.tool_path._tool_path import ToolPath
from polycnc.units import MM_PER_INCH

Words = Mapping[str, float | str]
_NOTHING: Words = {}
_MANY = 64
_NEEDED = {
    "COMP_LEFT": "the control is to compensate the radius of the tool",
    "COMP_RIGHT": "the control is to compensate the radius of the tool",
    "INSERT": "a block for the control",
}


class Output:
    """One program in the making."""

    def __init__(self, control: ControlFile, tool_path: ToolPath, out: Callable[[str], object]) -> None:
        self.control = control
        self.parameters = control.parameters
        self.scale = 1.0 / MM_PER_INCH if control.parameters.units == "inch" else 1.0
        self._tool_path = tool_path
        self._out = out
        self._lines: list[str] = []
        self._written = 0
        self._run = control.start(self._lines.append)
        self.call = self._run.call
        self._keeps = not control.parameters.strict

    @property
    def blocks(self) -> int:
        """How many blocks there are so far."""
        return self._written + len(self._lines)

    def flush(self) -> None:
        """Hand on the blocks collected."""
        self._written += len(self._lines)
        self._out("".join(self._lines))
        self._lines.clear()

    def call_along(
        self, rows: npt.NDArray[np.float64], feed: float, mode: float, counts: bool
    ) -> npt.NDArray[np.intc]:
        """Call LINEAR for each row of X, Y, Z, and of where the move starts if the control file wants that.

        Returns:
            With `counts` how many blocks there are after each.
        """
        done, together = 0, self._tool_path.is_long
        behind = np.zeros(len(rows) if counts else 0, np.intc)
        while done < len(rows):
            # One row makes modal what is: then the next ones may differ in nothing but their ends.
            together = together and len(rows) - done >= _MANY
            piece = rows[done : done + 1] if together else rows[done:]
            calls = self._run.call_along(zip(*piece.T.tolist(), strict=True), feed, mode)
            if counts:
                behind[done : done + len(piece)] = [self.blocks for _ in calls]
            else:
                deque(calls, maxlen=0)
            done += len(piece)
            ready = self._run.rows() if together else None
            if ready is None:
                together = False
            else:
                self.flush()
                after = np.zeros(len(rows) - done, np.int64)
                text, blocks, wrote = self._run.write_rows(ready, rows[done:], after)
                self._out(text)
                if counts:
                    behind[done : done + wrote] = self._written + after[:wrote]
                self._written += blocks
                done += wrote
        return behind

    def frame(self, macro: str, words: Words = _NOTHING) -> None:
        """Call a macro that a control file may leave out."""
        self.call(macro, words)

    def state(self, macro: str, line: int, words: Words = _NOTHING) -> None:
        """Call a macro whose absence is remarked, or an error where another part would be cut without it.

        Raises:
            ProgramError: it is so.
        """
        if not self.control.has(macro):
            if macro in _NEEDED:
                raise self.fail(
                    line,
                    f"{_NEEDED[macro]}, and the control file has no macro {macro}",
                    f"Add {macro} to [nc_macros] of the control file, or take the statement out of the tool path.",
                )
            self._tool_path.remarks.add(
                line, f"the control file has no macro {macro}, so nothing was written"
            )
        self.call(macro, words)

    def keep(self, **words: float) -> None:
        """Set words that hold in every macro from here on; with `strict` there are none."""
        if self._keeps:
            self._run.keep(words)

    def forget(self, *names: str) -> None:
        """Let the next output of function variables not be omitted."""
        self._run.forget(names)

    def formatted(self, variable: str, value: float) -> str:
        """Return a number as the control writes it after an address, plainly if it has no such address."""
        if variable in self.control.variables:
            return self._run.formatted(variable, value)
        return f"{variable}{decimal(value)}"

    def remark(self, line: int, text: str) -> None:
        """Remark something about a line of the tool path."""
        self._tool_path.remarks.add(line, text)

    def fail(self, line: int, what: str, hint: str) -> ProgramError:
        """Return the error for a line of the tool path."""
        return ProgramError(what, position=self._tool_path.position(line), hint=hint)
