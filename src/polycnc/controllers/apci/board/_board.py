"""The virtual board: what commands act on (`_commanded`), its time, and its state as a whole."""

from __future__ import annotations

from polycnc.controllers.apci.board._axis_commands import rs
from polycnc.controllers.apci.board._board_snapshot import restore_state, take_snapshot
from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._setup import load_parameters, set_up_plant
from polycnc.controllers.apci.board._status import BoardStatus, board_status
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.core._scan import INTERRUPT, NO_TURNS, PROFILE_END, RESET, run_scans
from polycnc.machine import PIECE_CYCLES, Snapshot, wait


class Board(CommandedBoard):
    """A board as its system file describes it, just booted: all loops open, nothing referenced.

    `record_scans` is the size of the recorder's buffer (`kernel.recorder`), 0 for none; a full one keeps what it has.
    """

    def __repr__(self) -> str:
        return f"<Board of {len(self.axes)} axes: {self.time_s:.3f} s>"

    def rebuild(self, config: SystemFile) -> None:
        """Be the board of another system file, just booted; what had been got from this one before is void."""
        self.is_described = True
        self._build(config)

    def _build(self, config: SystemFile) -> None:
        super()._build(config)
        set_up_plant(self)
        load_parameters(self, config)

    def load_parameters(self, system: SystemFile) -> None:
        """Take over the parameters and the planning of a system file, as loading system.dat does."""
        load_parameters(self, system)

    def update_filter(self, i: int) -> None:
        """Hand the six filter coefficients of an axis to its position loop."""
        self.axes[i].update_filter()

    # ------------------------------------------------------------------ time

    @property
    def time_s(self) -> float:
        """Time since the board was booted."""
        return self.clock.now_s

    def advance(self, cycles: int, *, until: int | None = None) -> int:
        """Run up to `cycles` scans; return how many were run.

        Fewer after a scan in which one of the attentions `until` happened (`_scan`).
        """
        done, wanted = 0, until or 0
        self.look_at_interface()
        while done < cycles:
            self._carry_out()
            mask = INTERRUPT | RESET | wanted
            piece = min(cycles - done, PIECE_CYCLES)
            turns = NO_TURNS if self.tasks is None else self.tasks.turns()
            if self.pending:
                piece = min(piece, max(self.pending[0].due - self.clock.cycles, 1))
            ran = int(run_scans(self.state, self.kernel, turns, piece, mask, self.clock.cycles))
            done += ran
            self.clock.tick(ran)
            if self._attend() & wanted:
                break
        self._carry_out()
        return done

    def _attend(self) -> int:
        """Do what the last scan asked for, and return it."""
        board = self.state.board[0]
        attention = int(board["attention"])
        board["attention"] = 0
        if attention & INTERRUPT:
            self.raise_interrupt(True)
        if attention & RESET:
            self.reset()
        return attention

    def raise_interrupt(self, active: bool) -> None:
        """Set or reset the interrupt request to the PC; setting it calls the routines that are installed."""
        rises = active and not self.variables.irqpc
        self.variables.irqpc = int(active)
        for routine in self.interrupts if rises else ():
            routine()

    def wait(self, axes: tuple[int, ...] | None = None, limit_s: float = 3600.0) -> None:
        """Run until the profiles of `axes` (all if None) have ended, at most `limit_s`."""
        chosen = [self.axes[i] for i in (range(len(self.axes)) if axes is None else axes)]
        wait(self, lambda: not any(axis.is_busy for axis in chosen), until=PROFILE_END, limit_s=limit_s)

    def reset(self) -> None:
        """Reset the whole system, as rs does."""
        rs(self)

    # ------------------------------------------------------------------ state

    def status(self) -> BoardStatus:
        """Return what the board is and does in the present scan."""
        return board_status(self)

    def snapshot(self) -> Snapshot:
        """Return the whole state of the board, its drives, its tasks, and commands on their way."""
        return take_snapshot(self)

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot of this board, or of one with the same system file.

        Raises:
            SnapshotError: It is of something else, or damaged; nothing has changed.
        """
        restore_state(self, snapshot)
