"""What has been prepared: the queue of one path, the records of its blocks, and what preparation waits for."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from math import copysign

from polycnc.machine import Machine, MachineConfig
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.blocks._events import EventRun
from polycnc.nc.blocks._moves import Feed, Line
from polycnc.nc.blocks._queue import QueueWriter
from polycnc.nc.channel._options import ChannelOptions
from polycnc.nc.dialect._dialect import Dialect, DialectTables
from polycnc.nc.fast._carried import NONE, Carried
from polycnc.nc.fast._plain_blocks import run_plain
from polycnc.nc.fast._work import begin_run, carried_by, carry, events_made, make_fast_work, marked, with_room
from polycnc.nc.modal._modal import LINEAR_AXIS, MODULO_AXIS, ORDINARY, ROTARY_AXIS, make_modal, set_diameters
from polycnc.nc.records._block_records import BlockRecords, Call
from polycnc.nc.records._replay import Feeds, RunBegin, coolant_after
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan import ScanRules, WordColumns

CHUNK_BLOCKS = 1 << 14  # blocks of a text that are scanned, and prepared by the compiled kernel, together
LEAST_BLOCKS = 1 << 8  # that there is room for, however short a text is


class Prepared:
    """Keep the queue, the records and the modal state of a path, as far as preparation has come.

    `before` is what has been prepared for the path until now: queue and records go on, and with `keeps_modal` the modal
    state. `row` is the path in the kernel. `axes` are the names of the machine's axes in programs.
    """

    _tables: DialectTables

    def __init__(
        self,
        dialect: Dialect,
        rules: ScanRules,
        machine: Machine,
        path: int,
        *,
        config: MachineConfig,
        axes: Sequence[str] | None,
        options: ChannelOptions,
        before: Prepared | None,
        keeps_modal: bool,
    ) -> None:
        kernel = machine.state
        self._kernel = kernel
        self.row = kernel.paths.row[path]
        self._path = path
        self._dialect = dialect
        if before is not None and before._dialect is dialect:
            self._tables = before._tables
        else:
            self._tables = dialect.tables()
        if before is None:
            self.writer = QueueWriter(kernel.seg, kernel.paths, kernel.limits, path)
            self.records = BlockRecords(
                dialect, rules, self._tables, CHUNK_BLOCKS, laser=config.spindle.laser
            )
        else:
            self.writer, self.records = before.writer, before.records
        if before is not None and keeps_modal:
            self.state: ChannelState = before.state
        else:
            self.state = first_state(config, dialect, tuple(axes or config.axis_names))
        if before is not None:
            self.state.tool = before.state.tool
        self._fast_work = make_fast_work(
            self.state.modal,
            self._tables,
            LEAST_BLOCKS,
            marks=options.marks,
            feed_needs_point=dialect.numbers.feed_least_input > 0.0,
            machine=config,
            answers=options.answers,
        )
        remapped = any(code[0] in "SM" for code in config.programs.remaps)
        self._functions_are_plain = (config.spindle.laser or not options.answers) and not remapped
        self.writer.stands_at_stops = options.stands_at_stops
        self.writer.answers = options.answers
        self.writer.marks = deque() if options.marks else None

    @property
    def is_plain(self) -> bool:
        """Whether the modal state is one that the compiled kernel knows."""
        return not self.state.modal.whole[ORDINARY]

    def take_tolerance(self) -> None:
        """Let the path have the tolerances that are in force."""
        self.writer.set_tolerance(self.state.path_tolerance_mm, self.state.merge_mm)

    def plain_blocks(
        self,
        words: WordColumns,
        first: int,
        after: int,
        text: ProgramText,
        calls: tuple[Call, ...],
        feeds: Feeds | None,
    ) -> tuple[int, int]:
        """Let the compiled kernel prepare blocks `first` up to `after`; return the next one, and why it stopped.

        `feeds` are the numbers of F words that have a variable for theirs; None where no words have.
        """
        self.state.take_changes()
        begin = RunBegin(int(words.offset[first]), int(words.line[first]), feeds)
        base = self.records.run_base(text, calls, self.state.snapshot(), begin)
        kernel = self._kernel
        before = self._carried()
        self._fast_work = with_room(self._fast_work, after - first)
        carry(self._fast_work, before)
        spindle = self.state.spindle
        plain = self._functions_are_plain and not (spindle.surface_speed or spindle.oriented)
        begin_run(self._fast_work, self.writer.next_event, functions=plain)
        stopped: tuple[int, int] = run_plain(
            words,
            first,
            after,
            base,
            self._tables,
            self.state.modal,
            kernel.seg,
            kernel.paths,
            self._path,
            kernel.limits,
            self._fast_work,
        )
        if (carried := carried_by(self._fast_work)) != before:
            self._take(carried)
            self.records.note_spoken(base)
        if (events := events_made(self._fast_work)) is not None:
            self._take_events(events)
        if self.writer.marks is not None:
            self.writer.marks.extend(marked(self._fast_work))
        return stopped

    def _carried(self) -> Carried:
        """Return what is in force of the words that the compiled kernel takes note of."""
        state = self.state
        length, radius = state.length_said_again(), state.compensation_tool
        return Carried(
            state.spindle.speed if state.spindle.speed_said else -0.0,  # equal to S0, until that is said
            float(state.spindle.direction),
            NONE,
            float(state.selected_tool),
            NONE if radius is None else float(radius),
            NONE if length is None else float(length),
        )

    def _take_events(self, events: EventRun) -> None:
        """Note the events of the compiled kernel, and the coolant that they have switched."""
        self.writer.note_run(events)
        spindle, senses = self.state.spindle, self._tables.m_sense
        coolant = coolant_after(spindle.coolant, events.code, senses)
        self.state.spindle = replace(spindle, coolant=coolant)

    def _take(self, carried: Carried) -> None:
        """Put in force what the compiled kernel has taken note of."""
        state = self.state
        state.selected_tool = int(carried.tool)
        if carried.radius_tool != NONE:
            state.compensation_tool = int(carried.radius_tool)
        state.spindle = replace(
            state.spindle, speed=abs(carried.speed), speed_said=copysign(1.0, carried.speed) > 0.0
        )
        if carried.m_code != NONE:
            state.spindle = replace(state.spindle, direction=int(carried.sense), oriented=False)
            state.m_codes = (int(carried.m_code),)

    def go_straight(self, position: tuple[float, ...], line: int, tag: int) -> None:
        """Go straight at rapid to a position (machine coordinates), as part of the block on `line`."""
        modal = self.state.modal
        start = tuple(modal.position.tolist())
        self.writer.put(Line(start, position, Feed(), rapid=True, exact_stop=True, line=line, tag=tag))
        modal.position[:] = position


_START_OFFSET = "G54"


def first_state(config: MachineConfig, dialect: Dialect, names: tuple[str, ...]) -> ChannelState:
    """Return the state of a channel whose programs call the axes by these names."""
    limits = [axis.soft_limits for axis in config.axes]
    modal = make_modal(
        names,
        [
            LINEAR_AXIS if axis.kind == "linear" else MODULO_AXIS if axis.modulo else ROTARY_AXIS
            for axis in config.axes
        ],
        [low for low, _ in limits],
        [high for _, high in limits],
        min(axis.vmax for axis in config.axes),
    )
    modal.position[:] = config.start_positions
    dialect.set_initial_state(modal)
    named = dialect.diameter_axes
    set_diameters(
        modal, [index for index, axis in enumerate(config.axes) if axis.is_diameter or axis.name in named]
    )
    state = ChannelState(config, modal)
    state.path_tolerance_mm = dialect.path_tolerance_mm(config.path)
    state.axis_names = names
    state.cycle = replace(state.cycle, retract_to_initial=dialect.initial.retract == "initial")
    given = getattr(config.offsets, "at_start", None)
    begins = _START_OFFSET in config.offsets if given is None else given
    if begins or dialect.sets_work_offsets:
        state.place_zero(state.coordinates.with_work_offset(0, _START_OFFSET))
    return state
