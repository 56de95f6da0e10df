"""What a run meets on its way: its auxiliary functions, with their times, and the operations that they begin."""

from __future__ import annotations

from polycnc.cnc import ProgramRun
from polycnc.nc import Event, MAction, ProgramText, Stop
from polycnc.runner._operations import Operation, OperationCollector


class EventLog:
    """Keep the events of a run in `found`, each with its time (s); say what becomes of program stops.

    `refused_s` is when the path came to the first refused block.
    """

    def __init__(self, text: ProgramText) -> None:
        self.found: list[tuple[float, Event]] = []
        self.refused_s: float | None = None
        self._operations = OperationCollector(text)

    def note(self, event: Event, run: ProgramRun) -> None:
        """Take an event in the cycle in which the path comes to it."""
        if event.stop is Stop.REFUSED:
            self.refused_s = run.machine.time_s if self.refused_s is None else self.refused_s
            return
        self.found.append((run.machine.time_s, event))
        records = run.channel.records
        if records.program(event.tag) == run.program.name and records.depth(event.tag) == 0:
            tool = records.tool(event.tag)
            changes = _changes_tool(event, run)
            self._operations.function(event.line, tool, changes, run.machine.time_s, run.path_times)
        if event.stop in (Stop.PROGRAM, Stop.OPTIONAL):
            what = "the run stops here" if run.stands_at(event.stop) else "passed without stopping"
            run.channel.messages.note(f"{event.word}: {event.stop.value}, {what}", event.line)

    def operations(self, run: ProgramRun) -> list[Operation]:
        """Return the operations of the program that has been run."""
        return self._operations.operations(run.machine.time_s, run.path_times)


def _changes_tool(event: Event, run: ProgramRun) -> bool:
    code = event.word[1:].partition(" ")[0]
    action = run.dialect.m_action(int(code)) if event.word[:1] == "M" and code.isdigit() else None
    return action is MAction.TOOL_CHANGE or event.word[:1] == "T"
