"""CPL programs on a living control: their texts go in, and everything that they leave behind is written beside them.

What a scene is written like stands in `cpl_scenes_a_text`.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from polycnc.cnc import ControlError, RunState
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.screen import Surface
from polycnc.controllers.bosch.system import Tab
from polycnc.nc import ProgramText

AXIS = '[[axis]]\nname = "{}"\nvmax_mm_s = {}\namax_mm_s2 = 5000\n'
MACHINE = (
    'name = "scenes"\n' + AXIS.format("X", 500) + AXIS.format("Y", 400) + AXIS.format("Z", 300)
    + '[[axis]]\nname = "C"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 400\n' + AXIS.format("X2", 200)
    + "[spindle]\nmax_rpm = 4000\n"
)  # fmt: skip
_OURS = re.compile(r"cpl\.store|machine\.toml|main\.npg|.*\.l$|.*-(wal|shm|journal)$|\.")
_SINKS = {"%": "#I{}%", "R": "#R{}", "!": "#D{}!", "?": "#B{}?", "$": "#S{}$"}
CYCLES = 3000
MAIN, BESIDE = "main.npg", "beside.npg"
_TOGETHER = 9
_FONT = (0, 9, 0, 0, 0)
_COLOURS = (2, 0)


def shown(name: str, value: object) -> str:
    """Return a value as its variable has it: REAL with single precision, NUL, texts in quotation marks."""
    if value is None:
        return "NUL"
    if isinstance(value, bool):
        return str(value).upper()
    if isinstance(value, float):
        digits = f"{value:.15g}" if name[-1] == "!" else str(np.float32(value))
        return digits if re.search("[.e]", digits) else f"{digits}.0"
    if isinstance(value, str):
        return '"' + value.encode("unicode_escape").decode().replace('"', '\\"') + '"'
    if isinstance(value, dict):
        return "{" + " ".join(f"{_index(key)}:{shown(name, each)}" for key, each in value.items()) + "}"
    if isinstance(value, list | tuple) and len(value) > 20:
        known = (f"{index}:{shown(name, each)}" for index, each in enumerate(value) if each is not None)
        return f"({len(value)} elements, {' '.join(known)})"
    if isinstance(value, list | tuple):
        return "(" + " ".join(shown(name, each) for each in value) + ")"
    return str(value)


def _index(key: object) -> str:
    return ",".join(map(str, key)) if isinstance(key, tuple) else str(key)


def numbered(lines: Iterable[str], first: int = 10, step: int = 10) -> str:
    """Return a program whose lines have numbers where they have none, or a bar that says so."""
    return "".join(
        f"{line.removeprefix('|')}\n"
        if re.match(r"[Nn]?[0-9]|[/|(%]|M30|$", line)
        else f"{first + step * place} {line}\n"
        for place, line in enumerate(lines)
    )


class Bench:
    """A control of two channels that is looked at after each program: only what has changed is told."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "machine.toml").write_text(MACHINE)
        self._power_up()

    def _power_up(self) -> None:
        self.pnc = Pnc(self.folder, self.folder / "machine.toml", channels=[("X", "Y", "C"), ("Z", "X2")])
        self._permanent = self._variables("@")
        self._axes = self._places()
        self._files = self._contents()
        self._screens = {channel: Screen(self.pnc.screen(channel)) for channel in (1, 2)}

    def restart(self) -> None:
        """Switch the control off and on."""
        self.pnc.close()
        self._power_up()

    def close(self) -> None:
        """Switch the control off."""
        self.pnc.close()

    def write(self, name: str, text: str) -> None:
        """Put a file into the root; it is no news."""
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode("latin-1"))
        self._files = self._contents()

    def forget_files(self) -> None:
        """Take the files as they are as no news."""
        self._files = self._contents()

    def execute(
        self,
        text: str,
        cycles: int = CYCLES,
        keys: Iterable[str] = (),
        channel: int = 1,
        beside: str = "",
    ) -> Iterator[str]:
        """Execute a program, and `beside` in the other channel; yield how it ended and what is other than before."""
        pnc = self.pnc
        pnc.reset(channel=channel)
        self._axes = self._places()
        self.write("main.npg", text)
        pnc.hosts[channel - 1].keyboard.clear()
        pnc.select_program("main.npg", channel=channel)
        for key in keys:
            pnc.press(key, channel=channel)
        if beside:
            self.write(BESIDE, beside)
            pnc.reset(channel=3 - channel)
            pnc.select_program(BESIDE, channel=3 - channel)
            pnc.cycle_start(channel=3 - channel)
        try:
            pnc.cycle_start(channel=channel)
        except ControlError as error:
            yield f"start refused: {error.what}"
        pnc.advance(cycles, until=lambda: pnc.run_state(channel) is not RunState.ACTIVE)
        pnc.advance(200, until=self._at_rest)
        state = pnc.run_state(channel)
        if state not in (RunState.COMPLETED, RunState.ALARM):
            yield str(state)
        yield from self._errors()
        yield from self._messages(channel)
        yield from self.news(channel)

    def edited(self, block: str, keys: Iterable[str]) -> Iterator[str]:
        """Let the dialog program of the editor work on a block; yield what has become of it."""
        try:
            selected = self.pnc.edit_block(block)
        except ControlError as error:
            yield f"refused: {error.what}"
            return
        for key in keys:
            self.pnc.press(key)
        self.pnc.advance(CYCLES, until=lambda: self.pnc.run_state(1) is not RunState.ACTIVE)
        yield from self._errors()
        yield from self._messages(1)
        yield f"block {selected.text}"
        yield from self.news(1)

    def _at_rest(self) -> bool:
        return not any(axis.moving for axis in self.pnc.axes.values())

    def _errors(self) -> Iterator[str]:
        entries = {tab: self.pnc.information(tab) for tab in Tab}
        numbers = {columns[-1]: columns[0] for columns in entries[Tab.ERRORS]}
        for alarm in self.pnc.status().alarms:
            place, _, what = alarm.text.partition(": ")
            number = numbers.get(re.sub(r" \[\d+]$", "", what), "?")
            told = [place.removeprefix("main.npg:"), *([number] if number != "0" else ()), what]
            yield f"error {' '.join(told)}"
            numbers.pop(re.sub(r" \[\d+]$", "", what), None)
        yield from (f"present {number} {what}" for what, number in numbers.items())
        yield from (f"warning {columns[0]} {columns[-1]}" for columns in entries[Tab.WARNINGS])

    def _messages(self, channel: int) -> Iterator[str]:
        run = self.pnc.control.channels[channel - 1].run
        for message in () if run is None else run.channel.messages.all():
            times = f" ({message.count} times)" if message.count > 1 else ""
            yield f"line {message.line}: {message.text.encode('unicode_escape').decode()}{times}"

    def news(self, channel: int) -> Iterator[str]:
        """Yield what variables, axes, files and the screen have become."""
        found = {
            name: shown(name, value) for name, value in self.pnc.variables(channel).items() if name[0] == "#"
        }
        if found:
            yield " ".join(f"{name}={value}" for name, value in sorted(found.items()))
        permanent, axes, files, screen = (
            self._variables("@"), self._places(), self._contents(), Screen(self.pnc.screen(channel))
        )  # fmt: skip
        if changed := _difference(self._permanent, permanent):
            yield " ".join(f"{name}={value}" for name, value in changed.items())
        if changed := _difference(self._axes, axes):
            yield " ".join(f"{name} {value}" for name, value in changed.items())
        for name, value in _difference(self._files, files).items():
            yield f"file {name} {value}"
        yield from screen.news(self._screens[channel])
        self._permanent, self._axes, self._files = permanent, axes, files
        self._screens[channel] = screen

    def forget(self, channel: int) -> None:
        """Erase the screen and all files that programs have written; it is no news."""
        self.pnc.screen(channel).clear()
        self._screens[channel] = Screen(self.pnc.screen(channel))
        for name in self._contents():
            (self.folder / name).unlink()
        self.forget_files()

    def _variables(self, first: str) -> dict[str, str]:
        return {
            name: shown(name, value)
            for name, value in self.pnc.variables(1).items()
            if name[0] == first and name != "@_R"
        }

    def _places(self) -> dict[str, str]:
        return {name: f"{round(axis.machine, 6) + 0.0:g}" for name, axis in self.pnc.axes.items()}

    def _contents(self) -> dict[str, str]:
        return {
            str(path.relative_to(self.folder)): shown("$", path.read_bytes().decode("latin-1"))
            for path in sorted(self.folder.rglob("*"))
            if path.is_file() and not _OURS.match(path.name)
        }

    # ------------------------------------------------------------------ tables

    def evaluate(self, before: list[str], expressions: list[str]) -> Iterator[str]:
        """Yield what each expression is as each type, or why it is not."""
        for first in range(0, len(expressions), _TOGETHER):
            yield from self._evaluate(before, expressions[first : first + _TOGETHER])

    def _evaluate(self, before: list[str], expressions: list[str]) -> list[str]:
        found: dict[tuple[int, str], str] = {}
        lines = [
            (place, sink, f"{name.format(place)}={expression}")
            for place, expression in enumerate(expressions)
            for sink, name in _SINKS.items()
        ]
        dims = [f"DIM #S{place}$(90)" for place in range(len(expressions))]
        head = [*before, *dims]
        left = lines
        while errors := self.pnc.hosts[0].check(_program([*head, *(line for *_, line in left)])):
            for error in errors:  # the types are looked at when all can be read
                assert error.position is not None, error
                row = error.position.line
                assert row > len(head), error
                place, sink, line = left[row - 1 - len(head)]
                found.setdefault((place, sink), self._refused(row, error.position.column, error.what, line))
            left = [each for each in left if each[:2] not in found]
        while left:
            program = _program([*head, *(line for *_, line in left)])
            list(self.execute(program.content.decode("latin-1")))
            values = self.pnc.variables(1)
            alarms = self.pnc.status().alarms
            done = len(left)
            assert self.pnc.run_state(1) is not RunState.ACTIVE
            if alarms:
                where, _, what = alarms[0].text.partition(": ")
                row, column = map(int, where.split(":")[1:])
                done = row - 1 - len(head)
                assert done >= 0, alarms[0].text
                place, sink, line = left[done]
                found[place, sink] = self._refused(row, column, what, line)
            for place, sink, _ in left[:done]:
                name = _SINKS[sink].format(place)
                found[place, sink] = shown(name, values[name])
            left = left[done + 1 :] if alarms else []
        return [_row({sink: found[place, sink] for sink in _SINKS}) for place in range(len(expressions))]

    def _refused(self, row: int, column: int, what: str, line: str) -> str:
        at = column - len(f"{row} ") - line.index("=") - 1
        return f"{what} @{at}" if at > 0 else what


def _program(lines: list[str]) -> ProgramText:
    return ProgramText.from_text(numbered(lines, 1, 1), "main.npg")


def _row(values: dict[str, str]) -> str:
    """Return the values of one expression by type, those that are refused alike together."""
    told: dict[str, list[str]] = {}
    for sink, value in values.items():
        told.setdefault(value, []).append(sink)
    return " | ".join(f"{''.join(sinks)} {value}" for value, sinks in told.items())


def _difference(old: dict[str, str], new: dict[str, str]) -> dict[str, str]:
    return {name: new.get(name, "gone") for name in {**old, **new} if old.get(name) != new.get(name)}


class Screen:
    """What stands on a screen, in words."""

    def __init__(self, surface: Surface) -> None:
        self.lines = [line.rstrip() for line in surface.lines()]
        self.cells = dict(surface.cells)
        self.texts = tuple(surface.texts)
        self.pixels = surface.pixels.copy()
        self.other = {
            "table": str(surface.table),
            "softkey colours": str(surface.softkey_colours),
            "colours 3": " ".join("".join(f"{part:02x}" for part in colour) for colour in surface.tables[3]),
        }

    def news(self, old: Screen) -> Iterator[str]:
        """Yield what is other than on an older one."""
        for name, value in _difference(old.other, self.other).items():
            yield f"{name} {value}"
        for number, (line, before) in enumerate(zip(self.lines, old.lines, strict=True), 1):
            if line != before:
                softkeys = f"| softkeys {self.other['softkey colours']}" if number == 43 and line else ""
                yield f"{number:2}|{line}" + self._colours(number) + softkeys
        for text in self.texts:
            if text not in old.texts:
                font = "" if tuple(text.font) == _FONT else f" {tuple(text.font)}"
                yield f"text at {text.x},{text.y} in colour {text.colour}{font}: {text.text}"
        if not np.array_equal(self.pixels, old.pixels):
            for code in range(8):
                where = np.argwhere(self.pixels == code)
                if len(where):
                    (bottom, left), (top, right) = where.min(axis=0), where.max(axis=0)
                    total = zlib.crc32(where.astype("<u2").tobytes())
                    yield (
                        f"pixels of colour {code}: {len(where)}, x {left} to {right}, y {bottom} to {top} ({total:08x})"
                    )
            if (self.pixels < 0).all():
                yield "no pixels"

    def _colours(self, number: int) -> str:
        found = {
            (cell.colour, cell.background)
            for (line, _), cell in self.cells.items()
            if line == number and tuple(cell[1:]) != _COLOURS
        }
        return "".join(f"| {colour} on {background}" for colour, background in sorted(found))
