"""A Power Mate: the control of the manual, with a machine that really moves (Manual 000).

It is a control without a vendor (`cnc.Control`) with this one's modes, alarms, parameters, program memory and data.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from polycnc.cnc import (
    AfterManual,
    Control,
    ControlData,
    ControlError,
    ManualData,
    OnModeChange,
    Refusal,
    Script,
    Status,
    Step,
)
from polycnc.controllers.fanuc.data._bindings import bind
from polycnc.controllers.fanuc.data._configuration import Configuration
from polycnc.controllers.fanuc.data._increment import Increment, Scale, scale
from polycnc.controllers.fanuc.data._macro_variables import CommonRange, SharedMacros
from polycnc.controllers.fanuc.data._parameter_rows import Attribute, ParameterRow
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.data._tool_offsets import ToolOffsets
from polycnc.controllers.fanuc.device._alarms import (
    NAME_ALARM,
    POWER_MATE_ALARMS,
    PREFIX,
    AlarmBit,
    alarm_bits,
)
from polycnc.controllers.fanuc.device._axis_motion import AxisMotion, AxisMotionState
from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.controllers.fanuc.device._execution import Execution
from polycnc.controllers.fanuc.device._history import Histories
from polycnc.controllers.fanuc.device._machine_file import (
    AxisSetting,
    axis_of,
    default_names,
    machine_of,
    usable_names,
)
from polycnc.controllers.fanuc.device._macros import OPTION as MACRO_OPTION
from polycnc.controllers.fanuc.device._macros import Macros
from polycnc.controllers.fanuc.device._mdi import MdiProgram
from polycnc.controllers.fanuc.device._modal_data import ModalData
from polycnc.controllers.fanuc.device._modes import CONTROL_MODES, PowerMateMode, mode_of
from polycnc.controllers.fanuc.device._panel import Panel
from polycnc.controllers.fanuc.device._pmc_memory import PmcMemory
from polycnc.controllers.fanuc.device._positions import Positions
from polycnc.controllers.fanuc.device._programs import Programs, memory_data, name_of
from polycnc.controllers.fanuc.device._remote_program import RemoteProgram
from polycnc.controllers.fanuc.device._signals import MOST_FEED_PERCENT, Signals, SignalState
from polycnc.controllers.fanuc.device._snapshot import DEVICE, PowerMateSnapshot
from polycnc.controllers.fanuc.device._transfer import Transfer
from polycnc.errors import UsageError
from polycnc.machine import AnyAxis, Clock, Machine, Snapshot, SnapshotError, Store, copied, restore_state
from polycnc.nc import Dialect, load_dialect

MOST_AXES = {"H": 6, "D": 2}
_STATE = "fanuc.state"
_MM_PER_MIN = 60.0
_BLOCKS_AHEAD = 1  # Manual 000, cnc_modal: the next block, and the next but one at the most
_ACT_ON_MOTION = frozenset({0, 1301, 1320, 1321, 1420, 1423, 1620, 1825, 1828, 3401})
_ALL_KEYS = frozenset({1, 2, 3, 4})


def _axes_of(model: str, increment: str, axes: int | None) -> tuple[int, int]:
    """Return how many axes a model has at the most, and how many it gets.

    Raises:
        UsageError: There is no such model, increment system, or number of axes.
    """
    if model not in MOST_AXES:
        raise UsageError(f"there is no Power Mate-{model}", hint="Models are H and D.")
    if increment not in set(Increment):
        raise UsageError(
            f"there is no increment system '{increment}'", hint=f"There are {', '.join(Increment)}."
        )
    most = MOST_AXES[model]
    given = min(3, most) if axes is None else axes
    if not 1 <= given <= most:
        raise UsageError(f"a Power Mate-{model} has no {given} axes", hint=f"Give 1 to {most}.")
    return most, given


class PowerMate:
    """A Power Mate-H or -D.

    `axes` are 3, on a Power Mate-D 2, if not said otherwise; `rotary` are the numbers of rotary axes, from 1.
    `increment` is "IS-A", "IS-B" or "IS-C". `options` are the names of the options that are fitted, True: all.
    `memory` is the file of everything that outlasts switching off; what it holds goes before the other arguments.
    `script` says how the PMC answers M, S and T functions (None: at once), `servo` simulates the position loops,
    `offsets` is the number of tool offsets, `characters` and `most_programs` the size of the program memory.

    Raises:
        UsageError: There is no such model, increment system, number of axes, or rotary axis.
    """

    def __init__(
        self,
        axes: int | None = None,
        model: str = "H",
        increment: str = "IS-B",
        inch_input: bool = False,
        inch_output: bool = False,
        rotary: Sequence[int | str] = (),
        options: bool | Iterable[str] = True,
        *,
        memory: str | Path | Store | None = None,
        script: Script | None = None,
        servo: bool = False,
        offsets: int = 99,
        characters: int = 128_000,
        most_programs: int = 125,
    ) -> None:
        self.model = model
        self.max_axis, self.axes = _axes_of(model, increment, axes)
        self.options = options if isinstance(options, bool) else frozenset(options)
        self.store = memory if isinstance(memory, Store) else Store(memory)
        self.transfer: Transfer | None = None
        self.power_ups = 0
        """How often it was switched off and on."""
        self._script = script
        self._servo = servo
        self._sizes = characters, most_programs
        self._state = self.store.area(_STATE, int)
        self._stale = False  # parameters have changed that the control could not take over yet
        names = default_names(self.axes, rotary)
        self.parameters = Parameters(
            self.store, self.axes, _defaults(names, Increment(increment), inch_input, inch_output)
        )
        self.state = DeviceState(
            SignalState([255] * self.max_axis), AxisMotionState.of(self.max_axis), self.parameters.bit(0, 2)
        )
        """What does not outlast switching off."""
        self.macros = SharedMacros(self.store, self._common_range())
        self.programs = Programs(self)
        self.mdi = MdiProgram(self, self.state.mdi)
        self.remote = RemoteProgram(lambda: self.mode, lambda: self.control)
        self.execution = Execution(self)
        self.positions = Positions(self)
        self.tool_offsets = ToolOffsets(self, offsets)
        self.signals = Signals(self, self.state.signals)
        self.panel = Panel(self)
        self.pmc = PmcMemory(self, self.state.pmc)
        self.history = Histories(self, self.state.sampling)
        self.axis_motion = AxisMotion(self, self.state.axis_motion)
        self.modal_data = ModalData(self)
        self.configuration = Configuration()
        bind(self)
        self.parameters.on_change = self._parameters_changed
        self.custom_macros = Macros(self, self.macros, self.state.macros)
        self.control = self._switched_on(None)
        self.control.set_observer(self.history)
        if self.selected not in self.programs:
            self.unselect()
        self._begin_signals()

    # ------------------------------------------------------------------ what it is

    @property
    def clock(self) -> Clock:
        """The clock that `advance` lets go on."""
        return self.control.clock

    @property
    def machine(self) -> Machine:
        """The machine that moves."""
        return self.control.machine

    def has_option(self, name: str) -> bool:
        """Whether an option is fitted; the empty name is no option and always there."""
        return not name or self.options is True or (self.options is not False and name in self.options)

    @property
    def increment(self) -> Increment:
        """The increment system (parameter 1004)."""
        value = self.parameters.value(1004)
        return Increment.IS_A if value & 1 else Increment.IS_C if value & 2 else Increment.IS_B

    def is_rotary(self, axis: int) -> bool:
        """Whether an axis (from 1) is rotary."""
        return self.control.machine.config.axes[axis - 1].kind == "rotary"

    @property
    def inch_input(self) -> bool:
        """Whether programs and positions are in inch now: G20 and G21 say so, and 0000#2 until one does."""
        return self.state.inch

    @property
    def inch_output(self) -> bool:
        """Whether the machine counts in inch (1001#0)."""
        return self.parameters.bit(1001, 0)

    def input_scale(self, axis: int) -> Scale:
        """Return the scale of positions as programs see them; axes count from 1."""
        return scale(self.increment, linear=not self.is_rotary(axis), inch=self.inch_input)

    def output_scale(self, axis: int) -> Scale:
        """Return the scale of machine positions and stroke limits; axes count from 1."""
        return scale(self.increment, linear=not self.is_rotary(axis), inch=self.inch_output)

    def axis_name(self, axis: int) -> str:
        """Return the name of an axis, which counts from 1."""
        return self.control.machine.config.axis_names[axis - 1]

    # ------------------------------------------------------------------ what the operator does

    @property
    def mode(self) -> PowerMateMode:
        """The mode."""
        return self.state.mode

    def select_mode(self, mode: PowerMateMode | str) -> None:
        """Change the mode, by name: MDI MEM EDIT HND JOG T-JOG T-HND INC REF RMT; a running program is held.

        Raises:
            UsageError: There is no such mode.
        """
        wanted = mode_of(mode)
        self.control.select_mode(CONTROL_MODES[wanted], going=self.axis_motion.moving)
        self.state.mode = wanted
        self.signals.mode_changed()

    def select_program(self, number: int) -> None:
        """Select a program for MEM and EDIT.

        Raises:
            ControlError: There is no such program, or one is being executed or interrupted.
        """
        self.control.select_program(name_of(number))
        self._state["selected"] = number
        self.state.cursor = 0

    @property
    def selected(self) -> int:
        """The number of the selected program, 0 for none."""
        return self._state.get("selected", 0)

    def unselect(self) -> None:
        """Have no program selected."""
        self._state["selected"] = 0
        self.state.cursor = 0
        self.control.channels[0].select(None)

    @property
    def cursor(self) -> int:
        """The line of the selected program at which a start begins, from 0."""
        return self.state.cursor

    def set_cursor(self, line: int) -> None:
        """Let the next start in MEM begin at a line of the selected program, from 0."""
        self.state.cursor = line

    def cycle_start(self, step: Step = Step.RUN) -> None:
        """Start the program of MEM, MDI or RMT (`remote`), or go on where one is interrupted.

        Raises:
            ControlError: As `cnc.Control.cycle_start`; feed hold is given; nothing sends a program in RMT.
        """
        self._take_over()
        if self.signals.hold_is_on:
            raise ControlError(
                Refusal.HELD, "feed hold is given (*SP)", hint="Take feed hold away, at G8#5 or on the panel."
            )
        channel = self.control.channels[0]
        self.remote.before_start(name_of(self.selected) if self.selected else None)
        if not channel.interrupted:
            self.custom_macros.begin()
            self.signals.apply_lock()
        start = self.mdi.state.start if self.state.mode is PowerMateMode.MDI else self.state.cursor
        self.control.cycle_start(step=step, line=start + 1)
        self.state.cursor = 0

    def feed_hold(self) -> None:
        """Press the stop button: what moves brakes and stands, an open download is stopped."""
        if self.transfer is not None:
            self.transfer.stop()
        try:
            self.control.feed_hold()
        except ControlError as error:
            if error.reason is not Refusal.IDLE:  # the button can be pressed at any time
                raise

    def reset(self) -> None:
        """Press RESET: break off what is being executed, clear alarms, stop an open download."""
        if self.transfer is not None:
            self.transfer.stop()
        self.axis_motion.drop()
        self.control.reset()
        self.state.cursor = 0
        self.custom_macros.reset()

    def emergency_stop(self, on: bool = True) -> None:
        """Press or release the emergency stop."""
        if on:
            self.axis_motion.drop()
        self.control.emergency_stop(on)

    def optional_stop(self, on: bool = True) -> None:
        """Switch the optional stop (M01) on or off."""
        self.control.set_switches(optional_stop=on)

    def skip_signal(self, on: bool = True) -> None:
        """Give the skip signal, or take it away; its rising edge notes where the axes are.

        While it is on it ends skip moves (G31): the axes brake, and the next block goes on from there.
        """
        if on and not self.state.skip:
            self._note_skip()
        self.state.skip = on
        self.control.channels[0].set_skip_signal(on)

    def _note_skip(self) -> None:
        self.state.skip_positions = tuple(each.absolute for each in self.positions.read())

    @property
    def skip_is_on(self) -> bool:
        """Whether the skip signal is on."""
        return self.state.skip

    @property
    def skip_positions(self) -> tuple[int, ...]:
        """Where the axes were at the last rising edge of the skip signal, in increments; zeros before the first."""
        return self.state.skip_positions or (0,) * self.axes

    def operator_message(self, number: int, text: str) -> None:
        """Show a message to the operator.

        Raises:
            ControlError: The number is negative, or the text is empty, too long or of several lines.
        """
        self.control.messages.show(number, text)

    def protect_key(self, on: bool = True, *, key: int | None = None) -> None:
        """Turn a memory protection key (1 to 4, None: all), on is protected.

        Raises:
            UsageError: There is no such key.
        """
        if key is not None and key not in _ALL_KEYS:
            raise UsageError(f"there is no key {key}", hint="Keys are 1 to 4.")
        keys = _ALL_KEYS if key is None else frozenset({key})
        self.state.protection_keys = (
            self.state.protection_keys | keys if on else self.state.protection_keys - keys
        )

    def local_variable(self, number: int) -> float | None:
        """Return local variable #1 to #33 of the macro that is being executed; None is vacant, as without a macro."""
        return self.custom_macros.local(number)

    def start_compare(self) -> None:
        """Begin to compare what `take` of the transfer gets with the registered programs, as on the screen.

        Raises:
            ControlError: A download or comparison is under way.
        """
        if self.transfer is not None:
            raise ControlError(Refusal.IN_USE, "a transfer is under way", hint="End it first.")
        self.transfer = Transfer(self, compare=True)

    def raise_alarm(self, number: int, text: str = "", *, axis: int | None = None) -> None:
        """Put an alarm on by its number.

        From 300 on it is APC, from 400 servo, from 500 overtravel, from 700 overheat, from 1000 external, else P/S.

        Raises:
            UsageError: The number is none, or there is no such axis.
        """
        if not 0 <= number <= 5999 or (axis is not None and not 1 <= axis <= self.axes):
            raise UsageError(f"there is no alarm {number} of axis {axis}", hint="Numbers are 0 to 5999.")
        name = None if axis is None else self.axis_name(axis)
        self.control.put_alarm(f"{PREFIX}{number}", axis=name, detail=text)

    @property
    def alarm_bits(self) -> AlarmBit:
        """The groups of the alarms that are on."""
        return alarm_bits(self.control.alarms.active)

    @property
    def transfers_blocked(self) -> bool:
        """Whether alarm 000 or 101 keeps programs from being moved."""
        return bool(self.alarm_bits & (AlarmBit.PS000 | AlarmBit.PS101))

    def power_cycle(self) -> None:
        """Switch off and on: durable data and the positions of the axes stay, everything else begins anew."""
        old = self.control
        old.timers.save()
        self.power_ups += 1
        self.transfer = None
        self.state.skip, self.state.skip_positions, self.state.cursor = False, (), 0
        self.mdi.clear()
        self.state.inch = self.parameters.bit(0, 2)
        self.custom_macros.switched_on()
        self.control = self._switched_on(old.machine)
        self.control.set_observer(self.history)
        self.control.clock.go_back(old.clock.cycles, old.clock.epoch)
        self.state.mode = PowerMateMode.MEM
        if self.selected:
            self.control.select_program(name_of(self.selected))
        self._begin_signals()

    # ------------------------------------------------------------------ time and state

    def advance(self, cycles: int, *, until: int | Callable[[], bool] | None = None) -> int:
        """Let up to `cycles` control cycles pass; return how many did, see `cnc.Control.advance`."""
        if self._stale:
            self._take_over()
        channel = self.control.channels[0]
        active = channel.active
        done = self._pass(cycles, until)
        self.custom_macros.keep()
        block = channel.executed if active else None
        if block is not None and block.modal.inch is not self.state.inch:
            self.parameters.set(0, self.parameters.value(0) ^ 4)
        if self._stale:
            self._take_over()
        return done

    def _pass(self, cycles: int, until: int | Callable[[], bool] | None) -> int:
        """Let time pass, in stretches that end where direct commands have to be looked at."""
        events = 0 if until is None or callable(until) else int(until)
        done = 0
        while done < cycles:
            self.axis_motion.look()
            step = min(cycles - done, self.axis_motion.horizon())
            watch = until if callable(until) else events | self.axis_motion.EVENTS
            busy = self.axis_motion.busy
            passed = self.control.advance(step, until=watch if busy else until)
            done += passed
            over = callable(until) and until()
            is_over = over or self.control.has_enough or (passed < step and not busy) or not passed
            if is_over or self.control.raised & events:
                break
        self.axis_motion.look()
        self.history.sample(force=False)
        return done

    def status(self) -> Status:
        """Return what the control is and does in the present cycle."""
        return self.control.status()

    def snapshot(self) -> PowerMateSnapshot:
        """Return the state of the present cycle; of what is durable, the variables of a program under way are in it."""
        control = self.control.snapshot()
        return PowerMateSnapshot(
            device=DEVICE,
            made_from=control.made_from,
            cycle=control.cycle,
            blocks=(),
            beside="",
            control=control,
            state=copied(self.state),
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot; what is durable stays as it is, but for the variables of a program under way.

        Raises:
            SnapshotError: It is of another control, axes have other limits now, or a program under way has been
                edited since; nothing has changed.
        """
        if not isinstance(snapshot, PowerMateSnapshot):
            raise SnapshotError(
                f"this is a snapshot of {snapshot.device}, not of a Power Mate",
                hint="restore it where it was taken",
            )
        self.control.restore(snapshot.control)
        restore_state(self.state, snapshot.state)
        self.control.channels[0].set_skip_signal(self.state.skip)
        self.signals.restored()

    def close(self) -> None:
        """Switch off: save the timers and close the memory."""
        self.control.timers.save()
        self.store.close()

    # ------------------------------------------------------------------ within

    def _begin_signals(self) -> None:
        """Let signals, panel and histories begin with the power."""
        self.axis_motion.clear()
        self.signals.clear()
        self.pmc.clear()
        self.panel.switched_on()
        self.history.switched_on()

    def _common_range(self) -> CommonRange:
        if self.has_option("macro_variables_600"):
            return CommonRange.LARGE
        return CommonRange.MIDDLE if self.has_option("macro_variables_300") else CommonRange.SMALL

    def _switched_on(self, before: Machine | None) -> Control:
        """Return the control as it is when power comes on; encoders are absolute."""
        axes = self._axes()
        characters, most_programs = self._sizes
        names = [axis.name for axis in axes]
        start = (
            dict.fromkeys(names, 0.0)
            if before is None
            else dict(zip(names, before.actual.values(), strict=True))
        )
        control = Control(
            machine_of(axes, start),
            memory=self.store,
            dialect=self._dialect(),
            script=self._script,
            servo=self._servo,
            languages=self.custom_macros.languages,
            data=ControlData(
                memory=memory_data(characters, most_programs),
                alarms=POWER_MATE_ALARMS,
                mode_change_while_running=OnModeChange.HOLD,
                after_manual=AfterManual.RETURN,
                dry_run_mm_min=float(self.parameters.value(1410)),
                most_feed_override=MOST_FEED_PERCENT / 100.0,
                sub_program_names=("O{number:04d}",),
                manual=ManualData(jog_speeds=self._jog_speeds(axes)),
                emergency_needs_reset=False,
            ),
        )

        def note_skip() -> None:  # a function, not a method: a copy of the run shares it
            self._note_skip()

        control.channels[0].on_skip = note_skip
        control.change_axes(axes)
        for axis, name in enumerate(names, 1):
            if self.parameters.value(1020, axis) != ord(name):
                control.put_alarm(
                    f"{PREFIX}{NAME_ALARM}", axis=name, detail=f"PARAMETER 1020 OF AXIS {axis}: {name}"
                )
        return control

    def _dialect(self) -> Dialect:
        data = load_dialect("fanuc").model_dump()
        data["name"] = "power mate"
        data["blocks_ahead"] = _BLOCKS_AHEAD
        data["soft_limits"] = "before" if self.parameters.bit(1301, 7) else "at_limit"
        data["language"] = "macro" if self.has_option(MACRO_OPTION) else "none"
        data["numbers"] = {
            "decimal_point": "calculator" if self.parameters.bit(3401, 0) else "least_input",
            "least_input": 10.0**-self.increment.decimals,
        }
        data["initial"]["units"] = "inch" if self.state.inch else "metric"
        return Dialect.model_validate(data)

    def _axes(self) -> tuple[AnyAxis, ...]:
        """Return the axes as the parameters describe them."""
        value = self.parameters.value
        numbers = range(1, self.axes + 1)
        turning = [self.parameters.bit(1006, 0, axis) for axis in numbers]
        names = usable_names([value(1020, axis) for axis in numbers], turning)
        made = []
        for axis, name, rotary in zip(numbers, names, turning, strict=True):
            units = scale(self.increment, linear=not rotary, inch=self.inch_output)
            vmax = self._speed(value(1420, axis), units)
            high, low = value(1320, axis), value(1321, axis)
            kp = value(1825, axis) / 100.0 if self._servo else None
            made.append(
                axis_of(
                    AxisSetting(
                        name=name,
                        rotary=rotary,
                        vmax=vmax,
                        amax=vmax / (value(1620, axis) / 1000.0),
                        soft_limits=(units.value(low), units.value(high)) if low < high else None,
                        servo_kp=kp,
                        error_limit=units.step * value(1828, axis) if kp and value(1828, axis) else None,
                    )
                )
            )
        return tuple(made)

    @staticmethod
    def _speed(value: int, units: Scale) -> float:
        """Return a speed parameter (mm/min, deg/min; on an inch machine 0.1 inch/min) per second."""
        return value / _MM_PER_MIN * (2.54 if units.inch else 1.0)

    def _jog_speeds(self, axes: tuple[AnyAxis, ...]) -> dict[str, float]:
        return {
            each.name: self._speed(
                self.parameters.value(1423, axis),
                scale(self.increment, linear=each.kind == "linear", inch=self.inch_output),
            )
            for axis, each in enumerate(axes, 1)
        }

    def _parameters_changed(self, rows: tuple[ParameterRow, ...]) -> None:
        if any(Attribute.POWER_OFF in row.attributes for row in rows):
            self.raise_alarm(0)
        if any(row.number == 0 for row in rows):
            self.state.inch = self.parameters.bit(0, 2)
        if any(row.number in _ACT_ON_MOTION for row in rows):
            self._stale = True
            self._take_over()

    def _take_over(self) -> None:
        """Let the control have what parameters say now, as soon as nothing moves; axes and units wait for the power."""
        if not self._stale or self.alarm_bits & AlarmBit.PS000:
            return
        axes = self._axes()
        try:
            self.control.change_axes(axes)
            self.control.change_dialect(self._dialect())
        except (ControlError, UsageError):
            return  # something moves; tried again when time has passed
        self.control.manual.data = replace(self.control.manual.data, jog_speeds=self._jog_speeds(axes))
        self._stale = False


def _defaults(
    names: Sequence[tuple[str, bool]], increment: Increment, inch_input: bool, inch_output: bool
) -> dict[tuple[int, int], int]:
    """Return the values of parameters that the arguments of a control say."""
    made: dict[tuple[int, int], int] = {
        (0, 0): 4 if inch_input else 0,
        (1001, 0): int(inch_output),
        (1004, 0): {Increment.IS_A: 1, Increment.IS_B: 0, Increment.IS_C: 2}[increment],
        (1010, 0): len(names),
    }
    for axis, (name, rotary) in enumerate(names, 1):
        made |= {
            (1006, axis): int(rotary),
            (1020, axis): ord(name),
            (1022, axis): axis if axis <= 3 and not rotary else 0,
            (1023, axis): axis,
        }
    return made


__all__ = ["PowerMate"]
