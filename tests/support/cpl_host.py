"""A control that only notes what a CPL program asks of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from polycnc.nc.cpl import PAUSE, Event, Fault, Lines, Linker, NcValues, Run, Waiting


class RecordingHost:
    """Answer from tables: functions by name, sub-programs by name; note what was set, printed and inserted."""

    def __init__(
        self,
        functions: Mapping[str, Callable[..., object]] | None = None,
        programs: Mapping[str, str] | None = None,
        permanent: dict[str, Any] | None = None,
    ) -> None:
        self.functions = dict(functions or {})
        self.programs = dict(programs or {})
        self.permanent: dict[str, Any] = dict.fromkeys(f"@{number}" for number in range(1, 101))
        self.permanent |= permanent or {}
        self.set: list[tuple[object, ...]] = []

    def function(self, name: str) -> Callable[..., object]:
        if name not in self.functions:
            raise Fault(f"the control has no {name}")
        return self.functions[name]

    def setter(self, name: str) -> Callable[..., None]:
        return lambda *arguments: self.set.append((name, *arguments))

    def insert(self, value: object) -> tuple[tuple[str, int | None, float], ...]:
        if isinstance(value, str):
            return tuple((word[0], None, float(word[1:])) for word in value.split())
        if not isinstance(value, tuple):
            raise Fault("neither a text nor an axis word stands in the bracket")
        return (value,)

    def program(self, address: str, name: str) -> tuple[str, str] | None:
        text = self.programs.get(f"{address if address in ('G', 'M') else ''}{name}")
        return None if text is None else (name, text)


class Ran:
    """A program that ran to its end: `events` without pauses, `blocks` as texts, `run` with its globals."""

    def __init__(
        self, text: str, host: RecordingHost | None = None, *, wait: int = 1, stepping: bool = False
    ) -> None:
        self.host = host or RecordingHost()
        linker = Linker(self.host.program, stepping=stepping)
        main, errors = linker.link(text, "main.cpl")
        if main is None:
            raise errors[0]
        self.run = Run(main, linker, self.host)
        self.events: list[Event] = []
        self.locals: dict[str, object] = {}
        answer: object = None
        sources = {}
        while (event := self.run.step(answer)) is not None:
            answer = wait if isinstance(event, Waiting) else None
            if event is not PAUSE:
                sources[len(self.events)] = self.run.stack[-1].program.source
                self.events.append(event)
        self.blocks: list[str] = []
        for index, event in enumerate(self.events):
            if isinstance(event, Lines):
                self.blocks += [
                    sources[index].line(line).strip() for line in range(event.first, event.last + 1)
                ]
            elif isinstance(event, NcValues):
                self.blocks.append(
                    " ".join(
                        f"{word.address}{'' if word.extension is None else f'{word.extension}='}{word.value:g}"
                        for word in event.words
                    )
                )

    def __getitem__(self, name: str) -> object:
        return self.run.globals[name]
