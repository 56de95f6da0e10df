"""A living control on a bench: all that its services tell, written down where it has changed since the last look."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any, TypeAlias

from polycnc.cnc import ControlError, Script
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import DATA_SERVICES, Coupling
from polycnc.nc.cpl import BLOCKED, Box, CharacterField, Fault, Field
from support.living_pnc import AXIS, SERVO, Living

ROTARY = '[[axis]]\nname = "{}"\nkind = "rotary"\nvmax_deg_s = {}\namax_deg_s2 = {}\n'
BENCH = (
    'name = "bench"\n'
    + AXIS.format("X", 500) + SERVO.format(40)
    + AXIS.format("Y", 450)
    + AXIS.format("Z", 400) + SERVO.format(25)
    + ROTARY.format("B", 720, 9000).replace('"rotary"\n', '"rotary"\nmodulo = true\n')
    + AXIS.format("U", 350)
    + AXIS.format("X2", 300)
    + ROTARY.format("C2", 90, 400)
    + AXIS.format("V", 200)
    + AXIS.format("W", 150)
    + "[spindle]\nmax_rpm = 4000\nacceleration_rpm_s = 3000\n"
    + "[tools.3]\nlength_mm = 42.5\nradius_mm = 6.25\n[tools.48]\nlength_mm = -7.5\nradius_mm = 0.5\n"
)  # fmt: skip
CHANNELS = (("X", "Y", "Z", "B", "U"), ("X2", "C2", "V", "W"))
NUMBERS = (1, 2, 4, 5, 6, 8, 9, 10, 12)
"""Nine axes, of which 3, 7 and 11 are missing; W is in no channel (`bench`)."""
EXTRA = {42: (0,), 55: (12,), 56: (0,), 57: (9,), 62: (1, 51)}
UNSET = 77777.0
LEFT_OUT = "!INVALID_PARAMETER"
Reading: TypeAlias = tuple[str, Callable[[], object]]
Place: TypeAlias = tuple[object, ...]


def _places(*heads: Place, last: Iterable[int] = ()) -> list[Place]:
    """Return places, each with every last index."""
    return [(*head, each) for head in heads for each in last] if last else [*heads]


_EIGHT = range(1, 9)
_OWN, _ALL = range(1, 7), (1, 2, 4, 5, 6, 8, 9, 10, 12)
_NCF = (0, 17, 40, 54, 154, 254, 60, 37, 61, 64, 68, 70, 90, 93, 138, 145, 147, 160, 168, 268, 8, 14, 114, 6)
PLACES: list[tuple[str, list[Place]]] = [
    ("SD(2) overrides", _places((2, 1), (2, 3), (2, 4))),
    ("SDR(2) overrides", _places((2, 1), (2, 3), (2, 4))),
    ("SD(202) spindle overrides", _places((202,), last=_EIGHT)),
    ("SDR(202) spindle overrides", _places((202,), last=_EIGHT)),
    ("SD(5) feed, programmed feed, rapid", _places((5, 1, 1), (5, 1, 2), (5, 2, 1))),
    ("SD(5) speeds of two spindles", _places((5, 3), (5, 4), last=(1, 2, 3))),
    ("SD(205) speeds", _places((205, 1), (205, 2), (205, 3), last=_EIGHT)),
    ("SD(12) senses", _places((12,), last=range(1, 5))),
    ("SD(212) senses", _places((212, 1), (212, 2), last=_EIGHT)),
    ("SD(8) channel, SD(9) probe, SD(14) language", _places((8,), (9,), (14,))),
    ("SD(13) mode of machining, SD(15) test", _places((13,), (15,))),
    ("SD(10) drilling axes", _places((10, 1), (10, 2), last=(1, 2))),
    ("SD(11) plane, main axis and secondary", _places((11, 1, 1), (11, 2, 1), (11, 1, 2), (11, 2, 2))),
    (
        "SD(20) axes, SD(21) of channels",
        _places((20,), (20, 1), (20, 2), *(_places((21, 1), (21, 2), last=(1, 2)))),
    ),
    ("SD(22) logical axes", _places((22,), last=range(1, 14))),
    ("SD(22,m,2) logical axes", [(22, m, 2) for m in range(1, 14)]),
    ("SD(23) physical axes", _places((23,), last=range(1, 7))),
    ("SD(24) physical axes of channel 2", [(24, m, 2) for m in range(1, 6)]),
    ("SD(25) channels", _places((25,), last=range(1, 14))),
    ("SD(68) shifts", _places((68, 1), (68, 2), last=_EIGHT)),
    ("SDR(68) shifts", _places((68, 1), (68, 2), last=_EIGHT)),
    ("SDR(168) shifts", _places((168, 1), (168, 2), last=_EIGHT)),
    ("SDR(268) shifts", _places((268, 1), (268, 2), last=_EIGHT)),
    ("SDR(1) positions of the search", _places((1,), last=range(1, 7))),
    ("CPOS programmed", _places((), last=_OWN)),
    ("AXO G92", _places((), last=_OWN)),
    ("WPOS workpiece", [*_places((), last=_OWN), *((each, 0) for each in _ALL)]),
    ("MPOS machine", [*_places((), last=_OWN), *((each, 0) for each in _ALL)]),
    ("SPOS commanded", _places((), last=_ALL)),
    ("APOS actual", _places((), last=_ALL)),
    ("COF contour", _places((), last=_OWN)),
    ("DPC workpiece", _places((), last=range(7))),
    ("SCL angle, poles, factors", [(0,), *_places((1,), (2,), last=_OWN)]),
    ("FXC sums", _places((), last=_OWN)),
    ("TC of now", _places((), last=_EIGHT)),
    ("NCF last functions", [*((f"G{code}",) for code in _NCF), ("M3",), ("M8",)]),
]
WHAT = {"Z": "each cycle", "S": "each block", "E": "changes", "I": "at once", "R": "never"}


def number(value: float) -> str:
    """Return a number to seven digits, without a minus at 0."""
    text = str(value) if isinstance(value, int) else f"{value:.7g}"
    return "0" if text == "-0" or abs(value) < 1e-7 else text


def line(values: Iterable[object]) -> str:
    """Return values one after the other; what repeats more than twice stands once."""
    shown = [number(each) if isinstance(each, int | float) else str(each) for each in values]
    parts = []
    for text, same in groupby(shown):
        count = len(list(same))
        parts += [text] * count if count < 3 else [f"{text}*{count}"]
    return " ".join(parts)


def text(value: object) -> str:
    """Return whatever a function returns as text."""
    if isinstance(value, bool) or value is None:
        return {True: "TRUE", False: "FALSE", None: "NUL"}[value]
    if isinstance(value, int | float):
        return number(value)
    found = value.text if isinstance(value, CharacterField) else str(value)
    return '"' + (found or "").replace("\0", "|") + '"'


def refusal(fault: Fault) -> str:
    """Return why a function refuses, in a word: the number, or the text."""
    return f"!{fault.code}" if fault.code else f"!{fault.what.replace(' ', '_')}"


class Bench(Living):
    """X, Y, Z, B and U in channel 1, X2, C2 and V in channel 2, W in none; X and Z lag."""

    def __init__(
        self, folder: Path, machine: str = BENCH, *, script: Script | None = None, references: bool = False
    ) -> None:
        super().__init__(folder, machine, CHANNELS, NUMBERS, script=script, servo=True, references=references)
        self.pnc.transfer_axis("W", None)
        self.lines: list[str] = []
        self._known: dict[str, str] = {}
        self.seen: set[str] = set()
        """What was on the screen when it was written down last."""
        self.services = [*self._services()]
        self.system_data = [*self._system_data()]

    def restart(self, **how: Any) -> None:
        """Switch off and on, with other options of `Pnc` than before; nothing has been looked at."""
        self.pnc.close()
        self.pnc = Pnc(
            self.folder,
            self.folder / "machine.toml",
            **{"channels": CHANNELS, "numbers": NUMBERS, "servo": True, **how},
        )
        self.coupling = Coupling(self.pnc.ncs, None, 1)
        self._known.clear()

    # ------------------------------------------------------------------ what is written down

    def say(self, what: str) -> None:
        """Write a heading."""
        self.lines += ["", f"== {what}"]

    def note(self, what: str, value: object = "") -> None:
        """Write down an answer."""
        self.lines.append(f"{what}: {value}" if value != "" else what)

    def look(self, what: str, cycles: int = 0, readings: Sequence[Reading] = ()) -> None:
        """Let time pass, then write down what has changed since the last look."""
        self.pnc.advance(cycles)
        states = " ".join(self.pnc.run_state(channel).name for channel in (1, 2))
        self.say(f"{what}, cycle {self.pnc.clock.cycles}: {states}")
        self.lines += [f"alarm: {each.text}" for each in self.pnc.status().alarms]
        for name, read in readings or self.services:
            found = str(read())
            if self._known.get(name) != found:
                self._known[name] = found
                self.lines.append(f"{name}: {found}")
        self.pnc.ncs.ledger.unchanged.clear()

    def call(self, name: str, *arguments: object, channel: int = 1) -> str:
        """Return what a function of a channel's programs returns, or why it refuses."""
        host = self.pnc.hosts[channel - 1]
        try:
            return text(host.function(name)(*arguments))
        except Fault as fault:
            return refusal(fault)

    def set(self, name: str, value: object, *arguments: object, channel: int = 1) -> str:
        """Return "" for a value that was set, or why it was refused."""
        try:
            self.pnc.hosts[channel - 1].setter(name)(value, *arguments)
        except Fault as fault:
            return refusal(fault)
        return "set"

    def ask_all(self, name: str, places: Iterable[Place], channel: int = 1) -> None:
        """Write down what a function returns for each of some arguments, in the order of the answers."""
        found: dict[str, list[str]] = {}
        for place in places:
            found.setdefault(self.call(name, *place, channel=channel), []).append(shown_order(place))
        for answer, asked in found.items():
            self.note(f"{name} {answer}", " ".join(f"({each})" for each in asked))

    def set_all(self, name: str, places: Iterable[tuple[object, Place]], channel: int = 1) -> None:
        """Write down which values are set and which refused."""
        found: dict[str, list[str]] = {}
        for value, place in places:
            asked = f"({shown_order(place)})={shown_order([value])}"
            found.setdefault(self.set(name, value, *place, channel=channel), []).append(asked)
        for answer, done in found.items():
            self.note(f"{name} {answer}", " ".join(done))

    def run(self, program: str, cycles: int, channel: int = 1) -> None:
        """Select and start a program; it may go wrong."""
        self.write(f"main{channel}", program)
        self.attempt("select", lambda: self.pnc.select_program(f"main{channel}", channel=channel))
        self.attempt("start", lambda: self.pnc.cycle_start(channel=channel))
        self.pnc.advance(cycles)

    def attempt(self, what: str, act: Callable[[], object]) -> None:
        """Do what an operator does; write down why it is refused."""
        try:
            act()
        except ControlError as refused:
            self.note(what, f"refused: {refused.reason.name}")

    # ------------------------------------------------------------------ services

    def data(self, service: int, channel: int, *extra: int) -> str:
        """Return what a data service writes into a large variable, or its code."""
        row = DATA_SERVICES.get(service)
        kind, size = row.kind if row is not None else "I", 16
        buffer = CharacterField(160) if kind == "S" else Field("R" if kind == "X" else kind, (size,))
        if isinstance(buffer, Field):
            for place in range(1, size + 1):
                buffer[place] = UNSET
        self.version.value = 0.0
        asked = 160 if isinstance(buffer, CharacterField) else size
        answer = self.coupling.mcods(service, channel, self.version, buffer, asked, *extra)
        if answer != 0:
            return f"code {answer}"
        if isinstance(buffer, CharacterField):
            return text(buffer)
        return line(each for place in range(1, size + 1) if (each := buffer.get(place)) != UNSET)

    def _services(self) -> Iterator[tuple[str, Callable[[], object]]]:
        for service, row in DATA_SERVICES.items():
            channels = {"system": (-1,), "channel": (1, 2), "either": (-1, 1, 2)}[row.scope]
            for channel in channels:
                name = f"{service} {row.name} [{channel}]"
                yield name, partial(self.data, service, channel, *EXTRA.get(service, ()))
        yield "ready to start", lambda: " ".join(str(int(self.pnc.is_ready(channel))) for channel in (1, 2))

    # ------------------------------------------------------------------ system data and positions

    def each(self, channel: int, name: str, places: Iterable[tuple[object, ...]]) -> str:
        """Return what a function of a channel's programs returns for each of some arguments."""
        if self.pnc.control.channels[channel - 1].run is None:
            return "-"
        return line(self.call(name, *place, channel=channel) for place in places)

    def groups(self, channel: int, moment: int) -> str:
        """Return the G functions of the groups that have one."""
        if self.pnc.control.channels[channel - 1].run is None:
            return "-"
        found = {group: self.call("SD", 1, group, moment, channel=channel) for group in range(1, 49)}
        return " ".join(f"{group}:G{code}" for group, code in found.items() if code not in ("-1", LEFT_OUT))

    def _system_data(self) -> Iterator[Reading]:
        for channel in (1, 2):
            yield f"SD(1,g,1) active G functions [{channel}]", partial(self.groups, channel, 1)
            yield f"SD(1,g,2) last G functions [{channel}]", partial(self.groups, channel, 2)
            for name, places in PLACES:
                function = name.partition("(")[0].split()[0]
                yield f"{name} [{channel}]", partial(self.each, channel, function, places)


class Waiters:
    """Clients that always wait for what is new of a service, each with a version of its own."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.asked = [
            (service, row.name, channel)
            for service, row in DATA_SERVICES.items()
            for channel in {"system": (-1,), "channel": (1, 2), "either": (-1, 1)}[row.scope]
            if service not in (34, 42)
        ]
        self.clients = [Coupling(bench.pnc.ncs, None, 1) for _ in self.asked]
        self.versions = [Box("V", "R", 0.0) for _ in self.asked]

    def pass_cycles(self, cycles: int) -> None:
        """Let cycles pass one by one; write down how often each service was answered."""
        answered = [0] * len(self.asked)
        for _ in range(cycles):
            for place, (service, _, channel) in enumerate(self.asked):
                row = DATA_SERVICES[service]
                buffer = CharacterField(160) if row.kind == "S" else Field(row.kind, (16,))
                size = 160 if row.kind == "S" else 16
                arguments = (service, channel, self.versions[place], buffer, size, *EXTRA.get(service, ()))
                answer = self.clients[place].mcods(*arguments)
                answered[place] += answer is not BLOCKED
            self.bench.pnc.advance(1)
        found: dict[int, list[str]] = {}
        for (service, _, channel), count in zip(self.asked, answered, strict=True):
            found.setdefault(count, []).append(f"{service}[{channel}]")
        for count, names in sorted(found.items(), reverse=True):
            self.bench.note(f"new {count} times in {cycles} cycles", " ".join(names))


def shown_order(order: Sequence[object]) -> str:
    """Return an order as text; a long one is told by its length."""
    parts = [
        each if not isinstance(each, str) else f'"{each}"' if len(each) < 25 else f"text of {len(each)}"
        for each in order
    ]
    return ",".join(str(each) for each in parts).replace("\n", "|")


SCENES: dict[str, Callable[[Bench], None]] = {}


REFERENCES = {"references"}
"""The scenes whose axes have to be referenced after power-up."""


def scene(act: Callable[[Bench], None]) -> Callable[[Bench], None]:
    """Make a function a scene of a control."""
    SCENES[act.__name__] = act
    return act
