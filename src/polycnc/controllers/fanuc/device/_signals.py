"""The operation signals: G addresses that a PMC gives the control and what they do, F addresses that show its state.

Addresses are the usual ones of this family of controls. What a signal shares with a switch of the control has one
state only: reading an address shows what holds, whoever has set it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from polycnc.cnc import ControlError, Emergency, Mode, Overrides
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._device_state import AT_POWER_ON, ERS, ESP, SERVO_OFF, SP, DeviceState
from polycnc.controllers.fanuc.device._history import Note
from polycnc.controllers.fanuc.device._macros import Macros
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._output_signals import Seen, output_byte
from polycnc.controllers.fanuc.device._positions import Positions
from polycnc.controllers.fanuc.device._power import Power
from polycnc.controllers.fanuc.device._units import Units

_M = PowerMateMode
_MD, _DNCI, _ZRN = 0x07, 0x20, 0x80
_MODE_SIGNALS = {
    _M.MDI: 0,
    _M.MEM: 1,
    _M.RMT: 1 | _DNCI,
    _M.NONE: 2,
    _M.EDIT: 3,
    _M.HND: 4,
    _M.JOG: 5,
    _M.REF: 5 | _ZRN,
    _M.T_JOG: 6,
    _M.T_HND: 7,
}
_HANDLE = 4  # the handle or, where there is none, increments
_JOGS = frozenset({_M.JOG, _M.T_JOG, _M.INC})
RAPID_STEPS = {0: 1.0, 1: 0.5, 2: 0.25}
F0 = 3
F0_PARAMETERS = frozenset({1420, 1421})
_INCREMENTS = (1, 10, 100, 1000)
_FIN, _ST = 1 << 3, 1 << 2
_RT = 1 << 7
_MLK = 2
_UINT = 8


class Buttons(NamedTuple):
    """What signals press at the control, as its operator does."""

    start: Callable[[], None]
    hold: Callable[[], None]
    go_on: Callable[[], None]
    reset: Callable[[], None]
    emergency_stop: Callable[[bool], None]
    select_mode: Callable[[PowerMateMode], None]
    protect: Callable[[bool, int], None]


class Signals:
    """Read and give the operation signals of a Power Mate; `state.battery_low` is a condition that a test can set.

    `device` is the state of the whole control; `panel` returns the byte of an F address that shows the panel.
    """

    def __init__(
        self,
        power: Power,
        parameters: Parameters,
        units: Units,
        positions: Positions,
        macros: Macros,
        device: DeviceState,
        buttons: Buttons,
        panel: Callable[[int], int | None],
        note: Note,
    ) -> None:
        self._power = power
        self._parameters = parameters
        self._units = units
        self._positions = positions
        self._macros = macros
        self._device = device
        self._buttons = buttons
        self._panel = panel
        self._note = note
        self.state = device.signals
        self._applied = Overrides()
        self._handlers: dict[int, Callable[[int, int], None]] = {
            4: self._finish,
            7: self._start,
            8: self._stops,
            10: self._jog_override_changed,
            11: self._jog_override_changed,
            12: lambda old, new: self.set_feed_override(255 - new),
            14: lambda old, new: self.set_rapid_override(new & 3),
            43: lambda old, new: self._select(new),
            44: self._delete_and_lock,
            46: self._switches,
            53: self._interrupt,
            100: lambda old, new: self._jog_keys(old, new, 1),
            102: lambda old, new: self._jog_keys(old, new, -1),
            SERVO_OFF: lambda old, new: self._servo_off(new),
        }

    def clear(self) -> None:
        """Let all signals be as they are when the power comes on."""
        state = self.state
        state.given = AT_POWER_ON.copy()
        state.feed, state.rapid, state.jog = 100, 0, 100.0
        state.torque_mode = 0
        self.set_torque_override(0, 255)
        self._applied = Overrides()
        _offered_f0(self._power, self._parameters)

    def restored(self) -> None:
        """Take note that the state and the control behind it have gone back."""
        self._applied = self._power.control.overrides

    def byte(self, letter: str, address: int) -> int:
        """Return the byte of a G or F address."""
        return self.g(address) if letter == "G" else self.f(address)

    # ------------------------------------------------------------------ G addresses

    def g(self, address: int) -> int:
        """Return the byte of a G address, with the switches as they are."""
        switches = self._power.control.switches
        given = self.state.given.get(address, 0)
        match address:
            case 8:
                on = self._power.control.emergency is Emergency.ON
                return given & ~ESP | (0 if on else ESP)
            case 10 | 11:
                return self._jog_complement >> (8 * (address - 10)) & 0xFF
            case 12:
                return 255 - self.feed_override
            case 14:
                return given & ~3 | self.rapid_override
            case 43:
                return given & ~(_MD | _DNCI | _ZRN) | _MODE_SIGNALS.get(self._device.mode, _HANDLE)
            case 44:
                return given & ~1 | (1 in switches.block_delete)
            case 46:
                keys = sum(1 << 2 + key for key in range(1, 5) if key not in self._device.protection_keys)
                return given & 0x05 | switches.single_block << 1 | keys | switches.dry_run << 7
            case _:
                return given

    def give(self, address: int, value: int) -> None:
        """Give the control a byte of signals; what it does not let happen now does not happen."""
        old = self.g(address)
        self.state.given[address] = value
        handler = self._handlers.get(address)
        if handler is not None and (old != value or address in (10, 11)):
            handler(old, value)
        new = self.g(address)
        if new != old:
            self._note("G", address, old, new)

    def give_bits(self, address: int, mask: int, value: int) -> None:
        """Give some bits of an address; the others stay."""
        self.give(address, self.g(address) & ~mask | value & mask)

    # ------------------------------------------------------------------ overrides

    @property
    def feed_override(self) -> int:
        """The feed override that is given (%)."""
        self._adopt()
        return self.state.feed

    def set_feed_override(self, percent: int) -> None:
        """Give a feed override, 0 to 254 %; 255 is all signals off: 0 %."""
        self._adopt()
        self.state.feed = 0 if percent == 255 else percent
        self.apply_overrides()

    @property
    def rapid_override(self) -> int:
        """The rapid override: 0 100 %, 1 50 %, 2 25 %, 3 F0 (parameter 1421)."""
        self._adopt()
        return self.state.rapid

    def set_rapid_override(self, code: int) -> None:
        """Give a rapid override by its code."""
        self._adopt()
        self.state.rapid = code
        self.apply_overrides()

    @property
    def jog_override(self) -> float:
        """The override of jogging (%)."""
        return self.state.jog

    def set_jog_override(self, percent: float) -> None:
        """Give an override of jogging (%), in steps of 0.01 %."""
        self._adopt()
        self.state.jog = percent
        self.apply_overrides()

    @property
    def _jog_complement(self) -> int:
        return 0xFFFF - round(self.state.jog * 100.0)

    def apply_overrides(self) -> None:
        """Let the control have the overrides; with a servo off nothing is fed."""
        control = self._power.control
        rapid = RAPID_STEPS.get(self.state.rapid, _offered_f0(self._power, self._parameters))
        feed = self.state.feed / 100.0
        interlock = bool(self.state.given.get(SERVO_OFF))
        control.set_overrides(feed=0.0 if interlock else feed, rapid=0.0 if interlock else rapid)
        self._applied = control.overrides
        self.mode_changed()

    def mode_changed(self) -> None:
        """Let manual motion have the override of its mode: that of jogging, or the feed override."""
        control = self._power.control
        by_hand = self._device.mode in _JOGS and not self.state.given.get(SERVO_OFF)
        control.manual.set_overrides(feed=self.state.jog / 100.0 if by_hand else control.overrides.feed)

    def _adopt(self) -> None:
        """Take over overrides that were set at the control itself."""
        there = self._power.control.overrides
        if there == self._applied:
            return
        if there.feed != self._applied.feed:
            self.state.feed = round(100.0 * there.feed)
        if there.rapid != self._applied.rapid:
            self.state.rapid = next((code for code, share in RAPID_STEPS.items() if share == there.rapid), F0)
        self._applied = there

    def torque_override(self, axis: int) -> float:
        """Return how much of its torque an axis (from 1) may give (%)."""
        return self.state.torque_override[axis - 1] / 255.0 * 100.0

    def set_torque_override(self, axis: int, value: int) -> None:
        """Let an axis (from 1, 0: all) give value/255 of its torque."""
        for k in range(len(self.state.torque_override)) if axis == 0 else (axis - 1,):
            self.state.torque_override[k] = value

    # ------------------------------------------------------------------ what signals do

    def _press(self, button: Callable[[], None]) -> None:
        """Press a button: what is not possible now does not happen."""
        try:
            button()
        except ControlError:
            return

    def _finish(self, old: int, new: int) -> None:
        if new & ~old & _FIN:
            self._press(lambda: self._power.control.plc.answer())

    def _start(self, old: int, new: int) -> None:
        if old & ~new & _ST:
            self._press(self._buttons.start)

    def _stops(self, old: int, new: int) -> None:
        if (old ^ new) & ESP:
            self._buttons.emergency_stop(not new & ESP)
        if old & ~new & SP:
            self._buttons.hold()
        if new & ~old & SP:
            self._buttons.go_on()
        if new & ~old & ERS:
            self._buttons.reset()

    def _jog_override_changed(self, old: int, new: int) -> None:
        low = self.state.given.get(10, self._jog_complement & 0xFF)
        high = self.state.given.get(11, self._jog_complement >> 8)
        counts = 0xFFFF - (high << 8 | low)
        self.set_jog_override(0.0 if counts == 0xFFFF else counts / 100.0)

    def _select(self, value: int) -> None:
        wanted = value & (_MD | _ZRN | _DNCI)
        code = wanted & _MD
        if code == _HANDLE:
            mode = _M.INC if self._device.mode is _M.INC else _M.HND
        else:
            mode = next(
                (mode for mode, signals in _MODE_SIGNALS.items() if signals == wanted),
                next(mode for mode, signals in _MODE_SIGNALS.items() if signals == code),
            )
        self._buttons.select_mode(mode)
        self._hold_keys()

    def _interrupt(self, old: int, new: int) -> None:
        if new & ~old & _UINT:
            self._macros.language.interrupt()

    def _delete_and_lock(self, old: int, new: int) -> None:
        self._power.control.set_switches(block_delete=frozenset({1} if new & 1 else ()))
        self.apply_lock()

    def apply_lock(self) -> None:
        """Let the machine lock be as its signal is, within a program not before the next start."""
        lock = bool(self.state.given.get(44, 0) & _MLK)
        if lock is not self._power.control.switches.machine_lock:
            self._press(lambda: self._power.control.set_switches(machine_lock=lock))

    def _switches(self, old: int, new: int) -> None:
        self._power.control.set_switches(single_block=bool(new & 2), dry_run=bool(new & 0x80))
        for key in range(1, 5):
            self._buttons.protect(not new >> 2 + key & 1, key)

    # ------------------------------------------------------------------ axes

    def _jog_keys(self, old: int, new: int, direction: int) -> None:
        for axis in range(1, self._parameters.axes + 1):
            bit = 1 << axis - 1
            if (old ^ new) & bit:
                self._jog_key(axis, direction, bool(new & bit))

    def _jog_key(self, axis: int, direction: int, on: bool) -> None:
        control, name = self._power.control, self._units.axis_name(axis)
        rapid = bool(self.state.given.get(19, 0) & _RT)
        if on and self.state.servo_is_off(axis):
            return
        if control.mode is Mode.REF and on:
            self._press(lambda: control.reference(name))
        elif control.mode is Mode.INC and on:
            size = self._units.output_scale(axis).value(_INCREMENTS[self.state.given.get(19, 0) >> 4 & 3])
            self._press(lambda: control.increment(name, direction, size, rapid=rapid))
        else:
            self._press(lambda: control.jog(name, direction if on else None, rapid=rapid))

    def _hold_keys(self) -> None:
        """Let keys that are held down act in the mode that has come."""
        if self._power.control.mode is Mode.JOG:
            self._jog_keys(0, self.state.given.get(100, 0), 1)
            self._jog_keys(0, self.state.given.get(102, 0), -1)

    def _servo_off(self, new: int) -> None:
        for axis in range(1, self._parameters.axes + 1):
            if new >> axis - 1 & 1:
                self._power.control.manual.stop(self._units.axis_name(axis))
        self._adopt()
        self.apply_overrides()

    # ------------------------------------------------------------------ F addresses

    def f(self, address: int) -> int:
        """Return the byte of an F address."""
        panel = self._panel(address)
        if panel is not None:
            return panel
        seen = Seen(
            self._power.control.status(),
            self._device.mode,
            self._device.inch,
            self.state.reset_is_on,
            bool(self.g(44) & _MLK),
            self.state.battery_low,
            self._device.macros.user_outputs,
            lambda: [each.machine == 0 for each in self._positions.read()],
        )
        return output_byte(address, seen)


def _offered_f0(power: Power, parameters: Parameters) -> float:
    """Give the control the steps of its rapid override, from the power on; return the one of F0."""
    f0 = min(1.0, parameters.value(1421, 1) / parameters.value(1420, 1))
    power.control.data = replace(power.control.data, rapid_overrides=(0.0, *RAPID_STEPS.values(), f0))
    return f0
