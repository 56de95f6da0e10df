"""In what a Power Mate counts: its increments, by axis, as its parameters and its machine say."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.controllers.fanuc.data._increment import Increment, Scale, scale
from polycnc.controllers.fanuc.data._parameters import Parameters
from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.machine import MachineConfig


class Units:
    """Axes count from 1; `config` is that of the present machine."""

    def __init__(
        self, parameters: Parameters, state: DeviceState, config: Callable[[], MachineConfig]
    ) -> None:
        self._parameters = parameters
        self._state = state
        self._config = config

    def switched_on(self) -> None:
        """Begin with the power: the units that parameters 1001 and 1004 say count until it is switched off."""
        self._state.increment = self._parameters.value(1004)
        self._state.inch_output = self._parameters.bit(1001, 0)

    @property
    def increment(self) -> Increment:
        """The increment system (parameter 1004)."""
        value = self._state.increment
        return Increment.IS_A if value & 1 else Increment.IS_C if value & 2 else Increment.IS_B

    @property
    def inch_input(self) -> bool:
        """Whether programs and positions are in inch now: G20 and G21 say so, and 0000#2 until one does."""
        return self._state.inch

    @property
    def inch_output(self) -> bool:
        """Whether the machine counts in inch (1001#0)."""
        return self._state.inch_output

    @property
    def axis_names(self) -> tuple[str, ...]:
        """The names of the axes."""
        return self._config().axis_names

    def axis_name(self, axis: int) -> str:
        """Return the name of an axis."""
        return self.axis_names[axis - 1]

    def is_rotary(self, axis: int) -> bool:
        """Whether an axis is rotary."""
        return self._config().axes[axis - 1].kind == "rotary"

    def input(self, *, linear: bool = True) -> Scale:
        """Return the scale of positions as programs see them."""
        return scale(self.increment, linear=linear, inch=self.inch_input)

    def output(self, *, linear: bool = True) -> Scale:
        """Return the scale of machine positions and stroke limits."""
        return scale(self.increment, linear=linear, inch=self.inch_output)

    def input_scale(self, axis: int) -> Scale:
        """Return the scale of positions of an axis as programs see them."""
        return self.input(linear=not self.is_rotary(axis))

    def output_scale(self, axis: int) -> Scale:
        """Return the scale of machine positions and stroke limits of an axis."""
        return self.output(linear=not self.is_rotary(axis))

    def by_kind(self) -> dict[str, tuple[Scale, Scale]]:
        """Return the scales of input and output of all axes by the unit of an axis: mm or deg."""
        increment, inch = self.increment, (self.inch_input, self.inch_output)
        turning = scale(increment, linear=False, inch=False)
        program, machine = (scale(increment, linear=True, inch=each) for each in inch)
        return {"mm": (program, machine), "deg": (turning, turning)}
