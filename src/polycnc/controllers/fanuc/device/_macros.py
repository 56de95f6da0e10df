"""Custom macros on a Power Mate: its language, the codes that call programs, and its own system variables."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.cnc import RunState, Timer
from polycnc.controllers.fanuc.data._macro_variables import SharedMacros
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.data._tool_offsets import ToolOffsets
from polycnc.controllers.fanuc.device._device_state import MacroState, SignalState
from polycnc.controllers.fanuc.device._history import Note
from polycnc.controllers.fanuc.device._power import Power
from polycnc.machine import Clock
from polycnc.nc.macro import MacroCalls, MacroError, MacroLanguage, MacroVariables, SystemVariables, Value

OPTION = "custom_macro"
_JUMPS_PER_CYCLE = 500
_MOST_PRINTED = 1 << 16
_G_CALLS = {6050 + k: 9010 + k for k in range(10)}
_SUB_CALLS = {6070 + k: 9000 + k for k in range(1, 10)}
_M_CALLS = {6080 + k: 9020 + k for k in range(10)}
_TOOL_PROGRAM = 9000
_INPUTS, _INPUT_WORD, _INPUT_BYTES = range(1000, 1016), 1032, (54, 55)
_OUTPUTS, _OUTPUT_WORD, OUTPUT_BYTES = range(1100, 1116), 1132, (54, 55)
_HOURS, _SETTINGS, _PARTS, _PARTS_REQUIRED = 3002, 3005, 3901, 3902
_AT_REST = frozenset({3001, 3002, 3003, 3004, 3005, 3011, 3012, 3901, 3902})
_ALL_BITS = 0xFFFF
_OFFSET_BASES = (2000, 10_000)
_FIRST_FEW = 200


class Macros:
    """The macro language of a Power Mate, whose variables are those that programs on a PC read and write."""

    def __init__(
        self,
        shared: SharedMacros,
        power: Power,
        parameters: Parameters,
        new_system: Callable[[], PowerMateVariables],
        state: MacroState,
    ) -> None:
        self._power = power
        self._parameters = parameters
        self._new_system = new_system
        self.state = state
        self._variables = shared.variables
        self._turns = 0
        self.printed = bytearray()
        """The last that programs have put out (DPRNT, BPRNT)."""
        self.language = self._new_language()

    def _new_language(self) -> MacroLanguage:
        language = MacroLanguage(
            self._variables,
            system=self._new_system(),
            main_repeats=True,
            endless_loops=True,
            pause_jumps=_JUMPS_PER_CYCLE,
        )
        language.output.sink = self._put_out
        return language

    def _put_out(self, data: bytes) -> None:
        self.printed += data
        del self.printed[:-_MOST_PRINTED]

    @property
    def variables(self) -> MacroVariables:
        """The variables of programs."""
        return self._variables

    def local(self, number: int) -> Value:
        """Return a local variable of the macro that is being executed, of the main program at rest."""
        channel = self._power.control.channel_status()
        going = channel.active or channel.interrupted or channel.run_state is RunState.ALARM
        block = channel.block if going else None
        return self.language.locals_of(() if block is None else block.stack)[number]

    def at_rest(self, number: int) -> Value:
        """Return a system variable that has a value without a program: timers, counters, signals, tool offsets.

        Raises:
            KeyError: It is none of them.
        """
        system = self.language.system
        if number in _AT_REST or PowerMateVariables.is_signal(number):
            return system.read(number)
        if _of_offset_memory(number) and system.has(number):
            return system.read(number)
        raise KeyError(number)

    def tool_offset(self, number: int, value: float) -> tuple[int, int] | None:
        """Return the tool offset that a variable is, and the increments of a value; None for other variables.

        Raises:
            MacroError: The value is out of range.
        """
        return self._new_system().offset_counts(number, value)

    def switched_on(self) -> None:
        """Begin with the power: what does not outlast it is vacant, timers count from 0."""
        self._variables.clear_common()
        self._variables.clear_locals()
        self.state.user_outputs = 0
        self.language = self._new_language()

    def reset(self) -> None:
        """Do what parameter 6001 says of a reset: #7 keeps local variables, #6 those from #100 to #199."""
        if not self._parameters.bit(6001, 6):
            self._variables.clear_common()
        if not self._parameters.bit(6001, 7):
            self._variables.clear_locals()

    def begin(self) -> None:
        """Take over what parameters say of macros, before a program begins."""
        self.language.output.bare = self._parameters.bit(6001, 1)
        value = self._parameters.value
        self.language.calls = MacroCalls(
            g={float(value(number)): program for number, program in _G_CALLS.items() if value(number)},
            m={value(number): program for number, program in _M_CALLS.items() if value(number)},
            m_sub={value(number): program for number, program in _SUB_CALLS.items() if value(number)},
            t=_TOOL_PROGRAM if self._parameters.bit(6001, 5) else None,
        )

    def keep(self) -> None:
        """Keep durably what programs have written since this was asked last."""
        if self.language.turns != self._turns:
            self._turns = self.language.turns
            self._variables.save()


class PowerMateVariables(SystemVariables):
    """The system variables of a Power Mate; every signal and counter is read when the blocks before are executed."""

    def __init__(
        self,
        power: Power,
        parameters: Parameters,
        offsets: ToolOffsets,
        signals: SignalState,
        state: MacroState,
        note: Note,
    ) -> None:
        super().__init__()
        self._power = power
        self._parameters = parameters
        self._offsets = offsets
        self._signals = signals
        self._state = state
        self._note = note

    @property
    def machine_clock(self) -> Clock:
        """The clock of the control, before its first program too."""
        return self._power.control.clock

    def has(self, number: int) -> bool:
        """Tell whether there is a variable."""
        if _of_offset_memory(number):
            return self._offset_number(number) is not None
        return self.is_signal(number) or super().has(number)

    def waits(self, number: int) -> bool:
        """Tell whether reading or writing waits until all blocks before have been executed."""
        return self.is_signal(number) or number == _SETTINGS or super().waits(number)

    def read(self, number: int) -> Value:
        """Return a variable.

        Raises:
            MacroError: There is none of this number.
        """
        control = self._power.control
        if number in _INPUTS:
            return float(self._inputs() >> number - _INPUTS.start & 1)
        if number in _OUTPUTS:
            return float(self._state.user_outputs >> number - _OUTPUTS.start & 1)
        match number:
            case 1032:
                return float(self._inputs())
            case 1132:
                return float(self._state.user_outputs)
            case 3002:
                return control.timers.seconds(Timer.OPERATING) / 3600.0
            case 3005:
                return float(self._parameters.value(0))
            case 3901:
                return float(control.parts.parts.made)
            case 3902:
                return float(control.parts.parts.required)
        if (offset := self._offset_number(number)) is not None:
            return self._offsets.get(offset) * 10.0**-self._offsets.decimals
        return super().read(number)

    def write(self, number: int, value: Value) -> None:
        """Set a variable; a vacant value counts as 0.

        Raises:
            MacroError: There is none of this number, it can only be read, or it does not take the value.
        """
        control = self._power.control
        new = 0.0 if value is None else value
        if number in _OUTPUTS:
            if new not in (0.0, 1.0):
                raise _wrong(number, new, "0 or 1")
            bit = 1 << number - _OUTPUTS.start
            self._give(self._state.user_outputs & ~bit | (bit if new else 0))
        elif number == _OUTPUT_WORD:
            self._give(_whole(number, new, _ALL_BITS))
        elif number == _HOURS:
            if not 0.0 <= new < 1e6:
                raise _wrong(number, new, "0 to 1000000")
            control.timers.set_seconds(Timer.OPERATING, new * 3600.0)
        elif number == _SETTINGS:
            self._parameters.set(0, _whole(number, new, 0xFF))
        elif number == _PARTS:
            control.parts.set(made=_whole(number, new, 99_999_999))
        elif number == _PARTS_REQUIRED:
            control.parts.set(required=_whole(number, new, 99_999_999))
        elif (offset := self.offset_counts(number, new)) is not None:
            self._offsets.set_all(dict([offset]))
        elif self.is_signal(number):
            raise MacroError(f"#{number} can only be read", "Write another variable.", "PS0116")
        else:
            super().write(number, value)

    def offset_counts(self, number: int, value: float) -> tuple[int, int] | None:
        """Return the tool offset that a variable is, and the increments of a value; None for other variables.

        Raises:
            MacroError: The value is out of range.
        """
        offset = self._offset_number(number)
        if offset is None:
            return None
        counts = round(value * 10.0**self._offsets.decimals)
        if abs(counts) > self._offsets.limit:
            raise _wrong(number, value, "tool offsets in their range")
        return offset, counts

    @staticmethod
    def is_signal(number: int) -> bool:
        """Tell whether a variable is one of the signals between macros and the PMC."""
        return number in _INPUTS or number in _OUTPUTS or number in (_INPUT_WORD, _OUTPUT_WORD)

    def _inputs(self) -> int:
        low, high = (self._signals.given.get(address, 0) for address in _INPUT_BYTES)
        return low | high << 8

    def _give(self, outputs: int) -> None:
        old, self._state.user_outputs = self._state.user_outputs, outputs
        for place, address in enumerate(OUTPUT_BYTES):
            before, after = old >> 8 * place & 0xFF, outputs >> 8 * place & 0xFF
            if before != after:
                self._note("F", address, before, after)

    def _offset_number(self, number: int) -> int | None:
        """Return the number of the tool offset that is a variable: #2001 to #2200, or #10001 on."""
        for base in _OFFSET_BASES:
            offset = number - base
            if 1 <= offset <= self._offsets.count and (base != 2000 or offset <= _FIRST_FEW):
                return offset
        return None


def _of_offset_memory(number: int) -> bool:
    return 2001 <= number <= 2400 or 10_001 <= number <= 13_999


def _whole(number: int, value: float, most: int) -> int:
    if value != int(value) or not 0 <= value <= most:
        raise _wrong(number, value, f"whole numbers from 0 to {most}")
    return int(value)


def _wrong(number: int, value: float, takes: str) -> MacroError:
    return MacroError(f"#{number} cannot be {value:g}", f"It takes {takes}.", "PS0119")


__all__ = ["OPTION", "OUTPUT_BYTES", "Macros", "PowerMateVariables"]
