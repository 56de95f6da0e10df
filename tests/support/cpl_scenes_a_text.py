"""Scenes of CPL's language as they are written down: a text is read, executed on a `Bench`, and written anew.

A scene is a text of sections. `== title` begins a program, `@ NAME` another file beside it; `=? title` begins a table
of expressions (`? EXPRESSION` after the lines that come before), each assigned to a variable of each type; `=! title`
one of statements (`! STATEMENT`), each a program of its own; `=* title` one of statements that are executed in other
surroundings too (`SURROUNDINGS`), of which stands what is other than in the first.

Lines of their own after a title say what stands around a program: `keys A B`, `cycles N`, `restart`, `channel N`,
`mode OCTAL FILE`, `client N FACTOR` (of MMC), `edit BLOCK`; `@ beside.npg` is executed in the other channel. Everything
that begins with `->` or stands after `=>` is what came of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from polycnc.controllers.bosch.ncs import Sent
from support.cpl_scenes_a import BESIDE, CYCLES, MAIN, Bench, numbered, shown


def _small(text: str) -> str:
    """Return a program in small letters; what stands in quotation marks stays."""
    return "".join(part if part[:1] == '"' else part.lower() for part in re.split(r'("[^"]*")', text))


def _dense(text: str) -> str:
    """Return a program without the blanks that are not needed."""
    parts = re.split(r'("[^"]*")', text)
    return "".join(
        part if part[:1] == '"' else re.sub(r" *([-+*/=<>(),;:\[\]]) *", r"\1", part) for part in parts
    )


def _wide(text: str) -> str:
    """Return a program with blanks and tabs wherever they may stand."""
    parts = re.split(r'("[^"]*"|<>|<=|>=)', text)
    return "".join(
        part if place % 2 else re.sub(r"([-+*/=(),;:\]])", " \t \\1  ", part)
        for place, part in enumerate(parts)
    )


SURROUNDINGS: dict[str, tuple[Callable[[str], str], str, int]] = {
    "alone": (str, "{}", 1),
    "small letters": (_small, "{}", 1),
    "no blanks": (_dense, "{}", 1),
    "many blanks": (_wide, "{}", 1),
    "in structures of a sub-program": (str, "FOR Q%=1 TO 2\nIF Q%=2 THEN\n{}\nENDIF\nNEXT", 1),
    "in channel 2": (str, "{}", 2),
}
"""How a statement is written, what stands around it, and in which channel."""


def _again(lines: list[str], bench: Bench) -> str:
    """Return what comes of a statement alone, and what is other elsewhere."""
    found: dict[str, str] = {}
    for name, (written, around, channel) in SURROUNDINGS.items():
        bench.forget(channel)
        body = written("\n".join(lines))
        program = numbered(around.format(body).split("\n"), 1, 1)
        if around != "{}":
            bench.write("AGAIN", program)
            program = "1 CALL AGAIN\n"
        told = " ; ".join(bench.execute(program, channel=channel))
        told = re.sub(r"(error|line|warning) (AGAIN:)?[\d:]+", r"\1", told) or "nothing"
        if told not in found.values():
            found[name] = told
        bench.pnc.reset(channel=channel)
    return " | ".join(told if name == "alone" else f"{name}: {told}" for name, told in found.items())


def rewritten(text: str, bench: Bench) -> str:
    """Return a scene with what comes of it now."""
    head, *sections = re.split(r"(?m)^(?==[=?!*] )", text)
    return head + "".join(_section(section, bench) for section in sections)


def _section(section: str, bench: Bench) -> str:
    lines = [line for line in section.rstrip("\n").split("\n") if not line.startswith("->")]
    kind = lines[0][:2]
    if kind == "==":
        told = list(_executed(lines[1:], bench))
        return "\n".join([*lines, *(f"-> {each}" for each in told or ["nothing"])]) + "\n\n"
    mark = "? " if kind == "=?" else "! "
    items = [line.partition(" => ")[0] for line in lines if line.startswith(mark)]
    before = [line for line in lines[1:] if not line.startswith(mark) and line]
    bodies = [item[2:].strip() for item in items]
    if kind == "=?":
        found = list(bench.evaluate(before, bodies))
    elif kind == "=*":
        found = [_again([*before, *body.split(" / ")], bench) for body in bodies]
    else:
        found = [
            " ; ".join(bench.execute(numbered([*before, *body.split(" / ")], 1, 1))) or "nothing"
            for body in bodies
        ]
    width = max(map(len, items))
    rows = [f"{item:{width}} => {each}" for item, each in zip(items, found, strict=True)]
    return "\n".join([lines[0], *before, *rows]) + "\n\n"


@dataclass
class _Program:
    """A program of a scene, and what stands around it."""

    files: dict[str, list[str]] = field(default_factory=lambda: {MAIN: []})
    keys: list[str] = field(default_factory=list)
    cycles: int = CYCLES
    channel: int = 1
    restart: bool = False
    modes: list[str] = field(default_factory=list)
    client: Client | None = None
    edit: str = ""

    def line(self, line: str, name: str) -> str:
        """Take a line, of the file of a name; return the name of the file that goes on."""
        word, _, rest = line.partition(" ")
        match word:
            case "@":
                name = rest
                self.files[name] = []
            case "keys":
                self.keys = rest.split()
            case "channel":
                self.channel = int(rest)
            case "cycles":
                self.cycles = int(rest)
            case "restart":
                self.restart = True
            case "mode":
                self.modes.append(rest)
            case "client":
                self.client = Client(*map(int, rest.split()))
            case "edit":
                self.edit = rest
            case _ if line:
                self.files[name].append(line)
        return name


class Client:
    """Who gets the variables of MMC: answers when asked for the `answers`th time, with each number times `factor`."""

    def __init__(self, answers: int, factor: int) -> None:
        self.answers = answers
        self.factor = factor
        self.told: list[str] = []

    def __call__(self, variables: Sequence[Sent]) -> bool:
        """Look at variables; tell whether they are answered."""
        self.told.append(
            "client " + " ".join(f"{each.name}={shown(each.name, each.value)}" for each in variables)
        )
        if len(self.told) < self.answers:
            return False
        for each in variables:
            if isinstance(each.value, int | float) and not isinstance(each.value, bool):
                each.value *= self.factor
        return True


def _executed(lines: list[str], bench: Bench) -> Iterator[str]:
    program, name = _Program(), MAIN
    for line in lines:
        name = program.line(line, name)
    files = program.files
    for name, content in files.items():
        if name != MAIN:
            bench.write(name, numbered(content))
    for mode in program.modes:
        octal, _, name = mode.partition(" ")
        (bench.folder / name).chmod(int(octal, 8))
    if program.restart:
        bench.restart()
    bench.pnc.system.clients.client = program.client
    if program.edit:
        yield from bench.edited(program.edit, program.keys)
    else:
        beside = numbered(files.get(BESIDE, []))
        yield from bench.execute(numbered(files[MAIN]), program.cycles, program.keys, program.channel, beside)
    if program.client:
        yield from dict.fromkeys(program.client.told)
    for name in files:
        if name != MAIN and (bench.folder / name).is_file():
            (bench.folder / name).unlink()
    bench.forget_files()
