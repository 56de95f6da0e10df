"""A Power Mate: the control of the manual, with a machine that really moves (Manual 000).

It is a control without a vendor (`cnc.Control`) with this one's modes, alarms, parameters, program memory and data.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

from polycnc.cnc import Control, ControlError, Refusal, Script, Status, Step
from polycnc.controllers.fanuc.data._bindings import bound
from polycnc.controllers.fanuc.data._configuration import Configuration
from polycnc.controllers.fanuc.data._increment import Increment
from polycnc.controllers.fanuc.data._macro_variables import CommonRange, SharedMacros
from polycnc.controllers.fanuc.data._parameter_rows import ParameterRow
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.data._tool_offsets import ToolOffsets
from polycnc.controllers.fanuc.device._axis_motion import AxisMotion
from polycnc.controllers.fanuc.device._device_state import DeviceState, SignalState
from polycnc.controllers.fanuc.device._execution import Execution
from polycnc.controllers.fanuc.device._history import Histories
from polycnc.controllers.fanuc.device._machine_file import axes_of, default_names, defaults
from polycnc.controllers.fanuc.device._macros import OPTION as MACRO_OPTION
from polycnc.controllers.fanuc.device._macros import Macros, PowerMateVariables
from polycnc.controllers.fanuc.device._mdi import MdiProgram
from polycnc.controllers.fanuc.device._modal_data import ModalData
from polycnc.controllers.fanuc.device._modes import CONTROL_MODES, PowerMateMode, mode_of
from polycnc.controllers.fanuc.device._panel import Panel
from polycnc.controllers.fanuc.device._pmc_memory import PmcMemory
from polycnc.controllers.fanuc.device._positions import Positions
from polycnc.controllers.fanuc.device._power import Fitted, Power
from polycnc.controllers.fanuc.device._programs import Programs, memory_data, name_of
from polycnc.controllers.fanuc.device._remote_program import RemoteProgram
from polycnc.controllers.fanuc.device._signals import F0_PARAMETERS, Buttons, Signals
from polycnc.controllers.fanuc.device._skip_signal import SkipSignal
from polycnc.controllers.fanuc.device._snapshot import PowerMateSnapshot
from polycnc.controllers.fanuc.device._transfer import Transfer
from polycnc.controllers.fanuc.device._units import Units
from polycnc.machine import Clock, Machine, Snapshot, Store, copied, restore_state


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

    units: Units
    signals: Signals
    panel: Panel

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
        self.max_axis, self.axes = axes_of(model, increment, axes)
        self.options = options if isinstance(options, bool) else frozenset(options)
        self.store = store = memory if isinstance(memory, Store) else Store(memory)
        self.transfer: Transfer | None = None
        self.power_ups = 0  # how often it was switched off and on
        begun = defaults(default_names(self.axes, rotary), Increment(increment), inch_input, inch_output)
        elsewhere = bound(lambda: self.control, lambda: self.units)
        self.parameters = parameters = Parameters(
            store, self.axes, begun, elsewhere, lambda rows: _parameters_changed(self, rows)
        )
        self.state = state = DeviceState.of(self.max_axis, parameters.bit(0, 2))
        """What does not outlast switching off."""
        self.units = units = Units(parameters, state, lambda: self.machine.config)
        fitted = Fitted(script, servo, memory_data(characters, most_programs), self.has_option(MACRO_OPTION))
        self.power = power = Power(store, parameters, units, state, fitted)
        self.macros = SharedMacros(store, CommonRange.of(self.has_option))
        self.programs = Programs(store, power, parameters, state)
        self.mdi = MdiProgram(power, parameters, state.mdi)
        self.remote = RemoteProgram(lambda: self.mode, lambda: self.control)
        self.execution = Execution(power, self.programs, state)
        self.positions = Positions(power, units, state.axis_motion)
        self.skip = SkipSignal(power, self.positions, state, self.axes)
        self.tool_offsets = ToolOffsets(store, power, units, offsets)
        self.history = Histories(
            store, power, lambda letter, at: self.signals.byte(letter, at), state.sampling
        )
        note = self.history.note_signal
        ports = parameters, self.tool_offsets, state.signals, state.macros, note
        variables = partial(PowerMateVariables, power, *ports)
        self.custom_macros = Macros(self.macros, power, parameters, variables, state.macros)
        read = power, parameters, units, self.positions, self.custom_macros, state
        self.signals = Signals(*read, _buttons_of(self), lambda address: self.panel.image(address), note)
        self.panel = Panel(store, self.signals, state, self.select_mode)
        self.pmc = PmcMemory(store, self.signals, state.pmc, note, self.skip.give)
        self.axis_motion = AxisMotion(power, units, self.positions, state.signals, state.axis_motion)
        self.modal_data = ModalData(self.execution, self.programs, state.mdi, parameters, units)
        self.configuration = Configuration()
        self._switch_on(None)
        if self.programs.selected not in self.programs:
            self.programs.unselect()
        self._begin_signals()

    def __repr__(self) -> str:
        return f"<Power Mate-{self.model}, {self.axes} axes: {self.mode.name}, {self.clock.now_s:.3f} s>"

    # ------------------------------------------------------------------ what it is

    @property
    def control(self) -> Control:
        """The control without a vendor that it is within; another one after the power was off."""
        return self.power.control

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
        self.programs.select(number)

    def set_cursor(self, line: int) -> None:
        """Let the next start in MEM begin at a line of the selected program, from 0."""
        self.state.cursor = line

    def cycle_start(self, step: Step = Step.RUN, *, line: int | None = None) -> None:
        """Start the program of MEM, MDI or RMT (`remote`) at a line or the cursor; go on with what was stopped.

        Raises:
            ControlError: As `cnc.Control.cycle_start`; feed hold or reset is given; nothing sends a program in RMT.
        """
        self.power.take_over()
        _check_signals(self.state.signals)
        if self.axis_motion.has_gone_on():
            return
        channel = self.control.channels[0]
        self.remote.before_start(name_of(self.programs.selected) if self.programs.selected else None)
        if not channel.interrupted:
            self.custom_macros.begin()
            self.signals.apply_lock()
        start = self.mdi.state.start if self.state.mode is PowerMateMode.MDI else self.state.cursor
        usual = 1 if channel.interrupted else start + 1
        self.control.cycle_start(step=step, line=usual if line is None else line)
        self.state.cursor = 0

    def feed_hold(self) -> None:
        """Press the stop button: what moves brakes and stands, an open download is stopped."""
        if self.transfer is not None:
            self.transfer.stop()
        self.axis_motion.hold()
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
        self.skip.give(on)

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
        self.state.turn_key(on, key)

    def start_compare(self) -> None:
        """Begin to compare what `take` of the transfer gets with the registered programs, as on the screen.

        Raises:
            ControlError: A download or comparison is under way.
        """
        if self.transfer is not None:
            raise ControlError(Refusal.IN_USE, "a transfer is under way", hint="End it first.")
        self.begin_transfer(compare=True)

    def begin_transfer(self, *, compare: bool = False, owner: object = None) -> Transfer:
        """Begin to take programs, or to compare; `transfer` is None when nothing is under way."""
        self.transfer = Transfer(self.programs, self.parameters, compare=compare, owner=owner)
        return self.transfer

    def raise_alarm(self, number: int, text: str = "", *, axis: int | None = None) -> None:
        """Put an alarm on by its number.

        From 300 on it is APC, from 400 servo, from 500 overtravel, from 700 overheat, from 1000 external, else P/S.

        Raises:
            UsageError: The number is none, or there is no such axis.
        """
        self.power.raise_alarm(number, text, axis=axis)

    def power_cycle(self) -> None:
        """Switch off and on: durable data and the positions of the axes stay, everything else begins anew."""
        old = self.control
        old.timers.save()
        self.power_ups += 1
        self.transfer, self.state.cursor = None, 0
        self.skip.clear()
        self.mdi.clear()
        self.state.inch = self.parameters.bit(0, 2)
        self.custom_macros.switched_on()
        self._switch_on(old.machine)
        self.control.clock.go_back(old.clock.cycles, old.clock.epoch)
        self.state.mode = PowerMateMode.MEM
        if self.programs.selected:
            self.control.select_program(name_of(self.programs.selected))
        self._begin_signals()

    # ------------------------------------------------------------------ time and state

    def advance(self, cycles: int, *, until: int | Callable[[], bool] | None = None) -> int:
        """Let up to `cycles` control cycles pass; return how many did, see `cnc.Control.advance`."""
        self.power.take_over()
        channel = self.control.channels[0]
        active = channel.active
        done = self.axis_motion.advance(cycles, until)
        self.history.sample(force=False)
        self.custom_macros.keep()
        block = channel.executed if active else None
        if block is not None and block.modal.inch is not self.state.inch:
            self.parameters.set(0, self.parameters.value(0) ^ 4)
        self.power.take_over()
        return done

    def status(self) -> Status:
        """Return what the control is and does in the present cycle."""
        return self.control.status()

    def snapshot(self) -> PowerMateSnapshot:
        """Return the state of the present cycle; of what is durable, the variables of a program under way are in it."""
        return PowerMateSnapshot.of(self.control.snapshot(), copied(self.state))

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to a snapshot; what is durable stays as it is, but for the variables of a program under way.

        Raises:
            SnapshotError: It is of another control, axes have other limits now, or a program under way has been
                edited since; nothing has changed.
        """
        taken = PowerMateSnapshot.checked(snapshot)
        self.control.restore(taken.control)
        restore_state(self.state, taken.state)
        self.skip.restored()
        self.signals.restored()

    def close(self) -> None:
        """Switch off: save the timers and close the memory."""
        self.control.timers.save()
        self.store.close()

    def _begin_signals(self) -> None:
        """Let signals, panel and histories begin with the power."""
        self.history.switched_on()
        self.axis_motion.clear()
        self.signals.clear()
        self.pmc.clear()
        self.panel.switched_on()

    def _switch_on(self, before: Machine | None) -> None:
        languages = (self.custom_macros.language,) if self.has_option(MACRO_OPTION) else ()
        self.power.switch_on(before, languages, self.skip.noting())
        self.control.set_observer(self.history)


def _buttons_of(it: PowerMate) -> Buttons:
    return Buttons(
        start=it.cycle_start,
        hold=it.feed_hold,
        go_on=lambda: it.axis_motion.go_on(),
        reset=it.reset,
        emergency_stop=it.emergency_stop,
        select_mode=it.select_mode,
        protect=it.state.turn_key,
    )


def _check_signals(signals: SignalState) -> None:
    """Refuse a start while feed hold or external reset is given."""
    if signals.hold_is_on:
        raise ControlError(
            Refusal.HELD, "feed hold is given (*SP)", hint="Take feed hold away, at G8#5 or on the panel."
        )
    if signals.reset_is_on:
        raise ControlError(Refusal.HELD, "external reset is given (ERS)", hint="Take it away, at G8#7.")


def _parameters_changed(it: PowerMate, rows: tuple[ParameterRow, ...]) -> None:
    it.power.parameters_changed(rows)
    if any(row.number in F0_PARAMETERS for row in rows):
        it.signals.apply_overrides()


__all__ = ["PowerMate"]
