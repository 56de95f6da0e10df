"""What a program run shows at one cycle: its block, its calls, where its path stands, what is left of it."""

from __future__ import annotations

from polycnc.cnc._path_runner import Floats, PathRunner
from polycnc.cnc._run_state import RunState
from polycnc.cnc._tool_times import ToolTime, path_times
from polycnc.nc import BlockRecord, Call, ModalWords


class RunReading:
    """Read what a path does with its program."""

    def __init__(self, runner: PathRunner) -> None:
        self._runner = runner
        self._machine = runner.machine
        self._path = runner.path

    @property
    def state(self) -> RunState:
        """What the run is doing."""
        return self._runner.moment.state

    @property
    def locked(self) -> bool:
        """Whether the path is executed without its axes."""
        return self._runner.moment.locked

    @property
    def starved(self) -> bool:
        """Whether the path rests because nothing more of a program that is still coming has come."""
        runner = self._runner
        if runner.moment.state is not RunState.ACTIVE or runner.moment.unanswered or not runner.at_rest:
            return False
        return bool(runner.row["head"] >= runner.row["tail"]) and runner.channel.starved

    @property
    def tag(self) -> int:
        """The tag of the block that is executed, or was last."""
        return self._runner.executed_tag

    @property
    def block(self) -> BlockRecord | None:
        """The block that is executed, or was last; None before the first."""
        return self._runner.channel.records.block(self._runner.executed_tag)

    @property
    def stack(self) -> tuple[Call, ...]:
        """The calls that led to the executed block, the outermost first."""
        record = self.block
        return () if record is None else record.stack

    @property
    def modal(self) -> ModalWords | None:
        """The modal words in force with the executed block."""
        record = self.block
        return None if record is None else record.modal

    @property
    def blocks_done(self) -> int:
        """How many blocks have been executed since the start, of those that move, dwell or hand out functions."""
        return int(self._runner.row["blocks"])

    @property
    def queued(self) -> int:
        """How many moves and waits are queued that have not been executed."""
        return int(self._runner.row["tail"] - self._runner.row["head"])

    @property
    def position(self) -> dict[str, float]:
        """Where the path stands (machine coordinates, mm or degree)."""
        return self._by_axis(self._machine.state.paths.position[self._path])

    @property
    def distance_to_go(self) -> dict[str, float]:
        """What is left to the end of the executed block (mm or degree); 0 where none is being executed."""
        return self._by_axis(self.to_go)

    @property
    def to_go(self) -> Floats:
        """What `distance_to_go` tells, by the place of the axis."""
        return self._runner.to_go

    @property
    def tool_times(self) -> dict[int, ToolTime]:
        """How long each tool has cut and positioned so far; tool 0 is an empty spindle."""
        return self._runner.moment.tool_times.until(self.path_times)

    @property
    def path_times(self) -> ToolTime:
        """How long the path has cut and positioned so far, with whatever tool."""
        return path_times(self._machine, self._path)

    def _by_axis(self, values: Floats) -> dict[str, float]:
        return {
            name: float(value) for name, value in zip(self._machine.config.axis_names, values, strict=True)
        }
