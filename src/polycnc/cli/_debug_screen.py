"""The terminal screen of the debugger: the program with its running line, and beside it what the control shows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from rich.segment import Segment
from rich.style import Style
from rich.table import Table
from rich.text import Text
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.geometry import Region, Size
from textual.scroll_view import ScrollView
from textual.strip import Strip
from textual.widgets import Footer, Header, Static

from polycnc.cnc import Emergency, RunState, Status, Step
from polycnc.errors import PolycncError
from polycnc.nc import ProgramText
from polycnc.runner import Debugger, Place

_TICK_S = 0.05
_OVERRIDE_STEP = 0.1
_LONGEST_VALUE = 40
_EXECUTED = Style(bgcolor="dark_green", color="white", bold=True)
_NEXT = Style(bgcolor="grey30")
_CURSOR = Style(underline=True)
_BREAK = Style(color="red", bold=True)
_NUMBER = Style(color="grey62")


class Listing(ScrollView, can_focus=True):
    """The lines of a program; only those that are seen are drawn, so its length does not matter."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "move(-1)", "Up", show=False),
        Binding("down", "move(1)", "Down", show=False),
        Binding("pageup", "move(-20)", "Page up", show=False),
        Binding("pagedown", "move(20)", "Page down", show=False),
    ]

    def __init__(self) -> None:
        super().__init__(id="listing")
        self.name_shown = ""
        self.cursor = 1
        self._lines: list[bytes] = []
        self._executed: int | None = None
        self._next: int | None = None
        self._breaks: frozenset[int] = frozenset()

    def show(
        self, text: ProgramText, executed: int | None, following: int | None, breaks: frozenset[int]
    ) -> None:
        """Show a program with its executed line, the next one, and the lines of its breakpoints."""
        if text.name != self.name_shown:
            self.name_shown = text.name
            self.border_title = Path(text.name).name
            self._lines = text.content.splitlines() or [b""]
            self.cursor = 1
            self._executed = None
            width = max(map(len, self._lines)) + 12
            self.virtual_size = Size(width, len(self._lines))
        if executed is not None and executed != self._executed:
            self.cursor = executed
            self.scroll_to_region(Region(0, max(executed - 1, 0), 1, 3), animate=False)
        self._executed, self._next, self._breaks = executed, following, breaks
        self.refresh()

    def action_move(self, lines: int) -> None:
        """Move the cursor."""
        self.cursor = min(max(self.cursor + lines, 1), max(len(self._lines), 1))
        self.scroll_to_region(Region(0, self.cursor - 1, 1, 1), animate=False)
        self.refresh()

    def render_line(self, y: int) -> Strip:
        """Draw one line that is seen."""
        x, top = self.scroll_offset
        number = top + y + 1
        width = self.size.width
        if number > len(self._lines):
            return Strip.blank(width)
        mark = "●" if number in self._breaks else " "
        arrow = "▶" if number == self._executed else "▷" if number == self._next else " "
        style = _EXECUTED if number == self._executed else _NEXT if number == self._next else Style()
        if number == self.cursor:
            style += _CURSOR
        text = self._lines[number - 1].decode("utf-8", "replace").expandtabs()
        text = "".join(char if char.isprintable() else "\N{REPLACEMENT CHARACTER}" for char in text)
        strip = Strip(
            [
                Segment(mark, _BREAK),
                Segment(f"{number:>6} ", _NUMBER),
                Segment(f"{arrow} ", style),
                Segment(text, style),
            ]
        )
        return strip.crop_extend(x, x + width, style if number == self._executed else Style())


class DebugScreen(App[None]):
    """A debugger on a terminal; `rate` machine seconds pass in a second, 0 lets time pass by `pass_time` only."""

    TITLE = "polycnc debug"
    CSS = """
    Screen { layout: vertical; }
    #listing { width: 1fr; border: round $primary; }
    #side { width: 58; padding: 0 1; }
    #side Static { height: auto; margin-bottom: 1; }
    #remark { height: auto; color: $warning; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("space", "run_or_hold", "Run/hold"),
        Binding("s", "step('into')", "Step"),
        Binding("n", "step('over')", "Over"),
        Binding("o", "step('out')", "Out"),
        Binding("b", "breakpoint", "Breakpoint"),
        Binding("plus,equals_sign", "override(1)", "Feed +", key_display="+"),
        Binding("minus", "override(-1)", "Feed -", key_display="-"),
        Binding("r", "reset", "Reset"),
        Binding("q", "quit", "Quit"),
    ]

    def __init__(self, debugger: Debugger, *, rate: float = 1.0) -> None:
        super().__init__()
        self.debugger = debugger
        self.cycles_per_tick = round(rate * _TICK_S / debugger.control.clock.cycle_s)

    def compose(self) -> ComposeResult:
        """Lay the screen out."""
        yield Header()
        with Horizontal():
            yield Listing()
            with VerticalScroll(id="side", can_focus=False):
                yield Static(id="state")
                yield Static(id="positions")
                yield Static(id="words")
                yield Static(id="variables")
                yield Static(id="alarms")
        yield Static(id="remark", markup=False)
        yield Footer()

    def on_mount(self) -> None:
        """Begin to let time pass."""
        self.query_one(Listing).focus()
        self.refresh_status()
        if self.cycles_per_tick:
            self.set_interval(_TICK_S, self._tick)

    def _tick(self) -> None:
        if self.is_running and self.query("#state") and (self.debugger.running or self._moves()):
            self.pass_time(self.cycles_per_tick)

    def _moves(self) -> bool:
        return any(axis.moving for axis in self.debugger.status.axes.values())

    def pass_time(self, cycles: int) -> None:
        """Let control cycles pass and show where that led."""
        left = cycles - self.debugger.pass_time(cycles)
        if left > 0 and self._moves():
            # Held: the axes still brake.
            self.debugger.control.advance(left, until=lambda: not self._moves())
        self.refresh_status()

    # ------------------------------------------------------------------ keys

    def action_run_or_hold(self) -> None:
        """Run the program, or hold it."""
        self._do(self.debugger.hold if self.debugger.running else self.debugger.run)

    def action_step(self, step: str) -> None:
        """Execute one block, into, over or out of sub-programs."""
        self._do(lambda: self.debugger.step(Step(step)))

    def action_reset(self) -> None:
        """Break the program off."""
        self._do(self.debugger.reset)

    def action_override(self, direction: int) -> None:
        """Change the feed override by a step."""
        self._do(lambda: self.debugger.change_feed_override(direction * _OVERRIDE_STEP))

    def action_breakpoint(self) -> None:
        """Set a breakpoint at the cursor, or take it away."""
        listing = self.query_one(Listing)
        self._do(lambda: self.debugger.toggle_breakpoint(Place(listing.name_shown, listing.cursor)))

    def _do(self, command: Callable[[], object]) -> None:
        """Carry a command out, or say why it was refused."""
        remark = ""
        try:
            command()
        except PolycncError as error:
            remark = " ".join(str(error).splitlines())
        self.query_one("#remark", Static).update(remark)
        self.refresh_status()

    # ------------------------------------------------------------------ what is shown

    def refresh_status(self) -> None:
        """Show the present cycle."""
        debugger = self.debugger
        status = debugger.status
        executed, following = debugger.executed, debugger.next
        name = executed.program if executed is not None else debugger.program.name
        self.query_one(Listing).show(
            debugger.text(name),
            None if executed is None else executed.line,
            following.line if following is not None and following.program == name else None,
            frozenset(place.line for place in debugger.breakpoints if place.program == name),
        )
        self.query_one("#state", Static).update(_state(status))
        self.query_one("#positions", Static).update(_positions(status))
        self.query_one("#words", Static).update(_words(status))
        self.query_one("#variables", Static).update(_variables(debugger.variables()))
        self.query_one("#alarms", Static).update(_alarms(status))


def _state(status: Status) -> Table:
    channel, overrides = status.channel, status.overrides
    state = channel.run_state.value
    if channel.run_state is RunState.ACTIVE and channel.functions:
        state += f", waits for {' '.join(channel.functions)}"
    if status.emergency is not Emergency.OFF:
        state = f"emergency stop {status.emergency.value}"
    spindle = status.spindle
    table = Table.grid(padding=(0, 2))
    table.add_row("state", Text(state, style="bold"))
    table.add_row("time", f"{status.time_s:.3f} s")
    table.add_row(
        "feed", f"{channel.feed.actual:.1f} of {channel.feed.commanded:.1f} mm/min, {overrides.feed:.0%}"
    )
    table.add_row("spindle", f"{spindle.actual_rpm:.0f} of {spindle.commanded_rpm:.0f} rpm")
    stack = () if channel.block is None else channel.block.stack
    for call in stack:
        table.add_row("called by", Text(f"{Path(call.program).name}:{call.line}, round {call.repeat}"))
    return table


def _positions(status: Status) -> Table:
    table = Table(box=None, padding=(0, 1), header_style="bold")
    table.add_column("axis")
    for title in ("work", "machine", "to go"):
        table.add_column(title, justify="right")
    for axis in status.axes.values():
        table.add_row(axis.name, f"{axis.work:.3f}", f"{axis.machine:.3f}", f"{axis.to_go:.3f}")
    return table


def _words(status: Status) -> Text:
    modal = status.channel.modal
    if modal is None:
        return Text("no block executed yet", style="dim")
    others = [f"F{modal.feed:g}", f"S{modal.speed:g}", f"T{modal.tool}", f"H{modal.h}"]
    others += [] if modal.d is None else [f"D{modal.d}"]
    others += [f"M{code}" for code in modal.m]
    return Text(" ".join(sorted(modal.g.values())) + "\n" + " ".join(others))


def _variables(variables: dict[str, object]) -> Text:
    """Show variables one a line, NUL as the language calls it."""
    lines = [f"{name} = {'NUL' if value is None else _short(value)}" for name, value in variables.items()]
    return Text("\n".join(lines))


def _short(value: object) -> str:
    shown = f"{value:g}" if isinstance(value, float) else str(value)
    return shown if len(shown) <= _LONGEST_VALUE else f"{shown[: _LONGEST_VALUE - 1]}…"


def _alarms(status: Status) -> Text:
    return Text("\n".join(f"{alarm.number} {alarm.text}" for alarm in status.alarms), style="bold red")
