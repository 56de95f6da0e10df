"""What a machinist would remark on a program: read off the queue that it fills, however its blocks were read."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isnan

import numpy as np
import numpy.typing as npt

from polycnc.errors import SourcePosition
from polycnc.kernel import RAPID, WAIT, WAIT_EVENT
from polycnc.machine import MachineConfig
from polycnc.nc import CODE_SYSTEM, NAMED_END, NOT_EXECUTED, Channel, Dialect, MAction, ProgramText, line_of

Floats = npt.NDArray[np.float64]
_TURNS = {
    MAction.SPINDLE_CW: True, MAction.SPINDLE_CCW: True, MAction.SPINDLE_STOP: False, MAction.SPINDLE_ORIENT: False,
}  # fmt: skip
_ACROSS = "XY"
_SEEN_BY_CHECK = ((NAMED_END, "unread"), (NOT_EXECUTED, "not_executed"), (CODE_SYSTEM, "code_system"))
"""Endings of messages that are remarks too, and their keys."""
HOMING = re.compile(r"[Gg]0*(?:28|30|53)(?![0-9.])")
"""Words that go to a position of the machine."""
_SOMETHING = re.compile(rb"[^% \t\r\n\0]")


@dataclass(frozen=True, slots=True)
class Remark:
    """Something that is no error and seldom meant: a stable key, the text, the first place, in how many blocks."""

    key: str
    text: str
    position: SourcePosition
    count: int = 1

    def __str__(self) -> str:
        times = f" ({self.count} times)" if self.count > 1 else ""
        return f"{self.position}: {self.text}{times}"


@dataclass(frozen=True, slots=True)
class _Function:
    """What an auxiliary function does: whether the spindle turns, which tool comes (0: unknown), whether it stops."""

    word: str
    turns: bool | None
    tool: int | None
    stops: bool

    def changes(self, turning: bool) -> bool:
        """Tell whether anything is another one after it."""
        return self.stops or self.tool is not None or self.turns not in (None, turning)


@dataclass
class MachiningWatch:
    """Look at all that a channel puts into its queue.

    Remarked are: cutting with the spindle at rest, cutting without a tool, rapids across the part at a level where it
    has been cut, and program stops. `look` is to be called whenever the channel has filled the queue.
    """

    channel: Channel
    _seen: int = 0
    _turning: bool = False
    _tool: int = 0
    _clear: float = np.inf  # Z from which the tool was fed in last
    _top: float = -np.inf  # highest Z at which it has cut across
    _rapid_end: float = np.nan  # Z after the last segment, if that was a rapid
    _first: dict[str, tuple[str, SourcePosition]] = field(default_factory=dict)
    _counts: Counter[str] = field(default_factory=Counter)
    _functions: dict[str, _Function] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._state = self.channel.machine.state
        self._row = self._state.paths.row[self.channel.path]
        self._seen = int(self._row["tail"])
        self._turning = self.channel.machine.config.spindle.laser  # a laser that is off cuts nothing
        dialect: Dialect = self.channel.dialect
        self._changes_tools = dialect.has_tool_change
        names = self.channel.machine.config.axis_names
        self._z = names.index("Z") if "Z" in names else -1
        self._home = self.channel.machine.config.axes[self._z].home if self._z >= 0 else np.nan
        self._across = [names.index(name) for name in _ACROSS if name in names]

    @property
    def remarks(self) -> list[Remark]:
        """Everything remarked so far, in the order in which it first came up."""
        return [Remark(key, text, at, self._counts[key]) for key, (text, at) in self._first.items()]

    def look(self) -> None:
        """Look at what has been put into the queue since."""
        tail = int(self._row["tail"])
        numbers = np.arange(self._seen, tail)
        self._seen = tail
        if not len(numbers):
            return
        slots = int(self._row["base"]) + numbers % int(self._row["capacity"])
        seg = self._state.seg
        waits = seg.row[slots]["kind"] == WAIT
        places = np.flatnonzero(waits)
        events = seg.geo[slots[places], WAIT_EVENT].astype(np.int64)
        places, events = places[events >= 0], events[events >= 0]
        pending = self.channel.writer.events
        codes = pending.m_codes(events)
        speaks = ~(codes < 0.0)  # S alone changes nothing here
        begin = 0
        for index, number, code in zip(
            places[speaks].tolist(), events[speaks].tolist(), codes[speaks].tolist(), strict=True
        ):
            function = self._function(pending[number].word if isnan(code) else f"M{code:.0f}")
            if function.changes(self._turning):
                self._moves(slots[begin:index][~waits[begin:index]])
                self._take(function, int(seg.row[slots[index]]["tag"]))
                begin = index
        self._moves(slots[begin:][~waits[begin:]])

    def _function(self, word: str) -> _Function:
        """Return what an auxiliary function does, by its words."""
        if word not in self._functions:
            code, _, rest = word[1:].partition(" ")
            action = self.channel.dialect.m_action(int(code)) if word[:1] == "M" and code.isdigit() else None
            tool = None
            if word.startswith("T"):  # a turret turns with T alone
                tool = int(word[1:]) // 100
            elif action is MAction.TOOL_CHANGE:
                tool = int(rest[1:]) if rest.startswith("T") and rest[1:].isdigit() else 0
            turns = None if action is None else _TURNS.get(action)
            self._functions[word] = _Function(word, turns, tool, stops=action is MAction.PROGRAM_STOP)
        return self._functions[word]

    def _take(self, function: _Function, tag: int) -> None:
        if function.turns is not None:
            self._turning = function.turns
        if function.tool is not None:
            self._change(function.tool)
        if function.stops:
            text = f"{function.word} stops the program until the operator starts it again"
            self._note("program_stop", text, [tag])

    def _change(self, tool: int) -> None:
        self._tool = tool or self._tool
        self._clear, self._top, self._rapid_end = np.inf, -np.inf, np.nan

    def _moves(self, slots: npt.NDArray[np.int64]) -> None:
        if not len(slots):
            return
        seg = self._state.seg
        lines = seg.row[slots]["tag"]
        rapid = (seg.row[slots]["flags"] & RAPID) != 0
        cuts = lines[~rapid]
        if len(cuts):
            if not self._turning:
                self._note("spindle_off", "cuts with the spindle at rest", cuts)
            if self._tool == 0 and self._changes_tools:
                self._note("no_tool", "cuts without a tool in the spindle", cuts)
        if self._z >= 0 and len(self._across) == len(_ACROSS):
            self._levels(slots, rapid, lines)

    def _levels(
        self, slots: npt.NDArray[np.int64], rapid: npt.NDArray[np.bool_], tags: npt.NDArray[np.int64]
    ) -> None:
        seg = self._state.seg
        start, end = seg.start[slots], seg.end[slots]
        low: Floats = np.minimum(start[:, self._z], end[:, self._z])
        across = (start[:, self._across] != end[:, self._across]).any(axis=1) | (seg.row[slots]["kind"] != 0)
        # From where each cut was fed in: the end of the rapid right before it; later moves remember the last.
        before = np.concatenate(([self._rapid_end], np.where(rapid, end[:, self._z], np.nan)[:-1]))
        fed = np.where(~rapid & ~np.isnan(before), before, np.nan)
        clear = _carried(fed, self._clear)
        tops = np.maximum.accumulate(np.concatenate(([self._top], np.where(~rapid & across, low, -np.inf))))
        wrong = rapid & across & (low < clear) & (low <= tops[:-1])
        for at in np.flatnonzero(
            wrong & (low == self._home)
        ).tolist():  # where a part at zero has no known home
            record = self.channel.records.block(int(tags[at]))
            wrong[at] = record is None or HOMING.search(record.text) is None
        if wrong.any():
            first = int(np.flatnonzero(wrong)[0])
            text = f"goes across at rapid at Z{_number(low[first])} (machine), where the part has been cut"
            self._note("rapid_in_material", text, tags[wrong])
        self._clear, self._top = float(clear[-1]), float(tops[-1])
        self._rapid_end = float(end[-1, self._z]) if rapid[-1] else np.nan

    def _position(self, tag: int) -> SourcePosition:
        record = self.channel.records.block(tag)
        if record is None:
            return SourcePosition("", line_of(tag), 1, "")
        text = record.text.rstrip()
        return SourcePosition(record.program, record.line, len(text) - len(text.lstrip()) + 1, text)

    def _note(self, key: str, text: str, tags: npt.NDArray[np.int64] | list[int]) -> None:
        if key not in self._first:
            self._first[key] = (text, self._position(int(tags[0])))
        self._counts[key] += len(np.unique(np.asarray(tags)))


def _carried(values: Floats, first: float) -> Floats:
    """Return the values with each gap (NaN) filled by the last one before it, `first` at the beginning."""
    with_first = np.concatenate(([first], values))
    known = np.where(np.isnan(with_first), 0, np.arange(len(with_first)))
    filled: Floats = with_first[np.maximum.accumulate(known)]
    return filled[1:]


def _number(value: float) -> str:
    return f"{value:.3f}".rstrip("0").rstrip(".")


def empty_remark(program: ProgramText) -> Remark | None:
    """Return what to say of a program in which nothing stands but blanks and the signs of a tape's ends."""
    if _SOMETHING.search(program.content):  # which copies nothing: programs are long
        return None
    return Remark("empty", "the program is empty", SourcePosition(program.name, 1, 1, ""))


def unread_remarks(channel: Channel, program: ProgramText) -> list[Remark]:
    """Return what to say of a program that has been prepared, and of which a part was not read or not executed."""
    found = [(_key_of(each.text), each) for each in channel.messages.all()]
    return [Remark(key, each.text, program.line_position(each.line)) for key, each in found if key]


def _key_of(message: str) -> str:
    return next((key for ending, key in _SEEN_BY_CHECK if message.endswith(ending)), "")


def added_axes_remark(config: MachineConfig) -> str:
    """Return what to say of a machine that nobody has named and that has axes added, empty if it has none."""
    preset, _, added = config.name.partition("+")
    if not added:
        return ""
    axes = f"axis {added}" if len(added) == 1 else f"axes {', '.join(added)}"
    return f"no machine is named: it is {preset} with {axes}, which the program has words for"


def times_remark(config: MachineConfig, dialect: Dialect, words: Mapping[str, int]) -> str:
    """Return what to say of functions that counted 0 s in a run, empty if none did.

    `words` are its events, with how often each came.
    """
    times = config.times
    spindle_counts = times.spindle_start_s > 0.0 or config.spindle.acceleration_rpm_s is not None
    counts = Counter[str]()
    for word, times_met in words.items():
        code = word[1:].partition(" ")[0]
        action = dialect.m_action(int(code)) if word.startswith("M") and code.isdigit() else None
        is_change = action is MAction.TOOL_CHANGE or word.startswith("T")
        if is_change and times.tool_change_s == 0.0:
            counts["tool change"] += times_met
        elif action in _STARTS and not spindle_counts:
            counts["spindle start"] += times_met
        elif action in _OTHERS and times.auxiliary_s == 0.0:
            counts["other function"] += times_met
    if not counts:
        return ""
    parts = [f"{count} {what}{'s' if count > 1 else ''}" for what, count in counts.items()]
    listed = " and ".join(filter(None, (", ".join(parts[:-1]), parts[-1])))
    return f"{listed} counted 0 s: a machine file says in [times] how long they take (preset vmc3 does)"


_STARTS = (MAction.SPINDLE_CW, MAction.SPINDLE_CCW, MAction.SPINDLE_ORIENT)
_OTHERS = (
    MAction.AUXILIARY,
    MAction.COOLANT_FLOOD,
    MAction.COOLANT_MIST,
    MAction.COOLANT_OFF,
    MAction.SPINDLE_STOP,
)
