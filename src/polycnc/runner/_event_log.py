"""What a run meets on its way: its auxiliary functions, with their times, and the operations that they begin."""

from __future__ import annotations

from collections import Counter

from polycnc.cnc import Passed, PassedRun, ProgramRun, ToolTime
from polycnc.nc import Event, MAction, ProgramText, Stop
from polycnc.runner._operations import Operation, OperationCollector
from polycnc.runner._run_events import RunEvents


class EventLog:
    """Keep the events of a run, each with its time; say what becomes of program stops.

    `refused_s` is when the path came to the first refused block.
    """

    def __init__(self, text: ProgramText) -> None:
        self.refused_s: float | None = None
        self._events = RunEvents()
        self._operations = OperationCollector(text)

    @property
    def counts(self) -> Counter[str]:
        """How often each event has come, by its words."""
        return self._events.counts()

    def events(self) -> RunEvents:
        """Return everything met so far."""
        return self._events

    def note(self, event: Event, run: ProgramRun) -> None:
        """Take an event in the cycle in which the path comes to it."""
        if event.stop is Stop.REFUSED:
            self.refused_s = run.machine.time_s if self.refused_s is None else self.refused_s
            return
        self._note(event, run.machine.time_s, run.reading.path_times, run)
        if event.stop in (Stop.PROGRAM, Stop.OPTIONAL):
            what = "the run stops here" if run.events.stands_at(event.stop) else "passed without stopping"
            run.channel.messages.note(f"{event.word}: {event.stop.value}, {what}", event.line)

    def note_passed(self, passed: Passed | PassedRun, run: ProgramRun) -> None:
        """Take events that the path has passed."""
        if isinstance(passed, Passed):
            self._note(passed.event, passed.time_s, passed.moved, run)
            return
        events = passed.events
        self._events.add_run(passed.time_s, events)
        first, last, program = passed[0], passed[-1], run.program.name
        records = run.channel.records
        if records.depth(first.event.tag) or records.program(first.event.tag) != program:
            return
        tool = records.tool(first.event.tag)
        remarked = self._operations.has_remark(last.event.line)
        for each in (passed[at] for at in range(len(events))) if remarked else (first, last):
            self._operations.function(each.event.line, tool, False, each.time_s, each.moved)

    def _note(self, event: Event, time_s: float, moved: ToolTime, run: ProgramRun) -> None:
        self._events.add(time_s, event.line, event.word)
        records = run.channel.records
        if records.depth(event.tag) == 0 and records.program(event.tag) == run.program.name:
            tool = records.tool(event.tag)
            changes = _changes_tool(event, run)
            self._operations.function(event.line, tool, changes, time_s, moved)

    def operations(self, run: ProgramRun) -> list[Operation]:
        """Return the operations of the program that has been run."""
        return self._operations.operations(run.machine.time_s, run.reading.path_times)


def _changes_tool(event: Event, run: ProgramRun) -> bool:
    code = event.word[1:].partition(" ")[0]
    action = run.dialect.m_action(int(code)) if event.word[:1] == "M" and code.isdigit() else None
    return action is MAction.TOOL_CHANGE or event.word[:1] == "T"
