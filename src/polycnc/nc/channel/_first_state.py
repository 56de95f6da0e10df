"""The modal state that a channel begins with."""

from __future__ import annotations

from polycnc.machine import MachineConfig
from polycnc.nc.blocks._channel_state import ChannelState
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._modal import LINEAR_AXIS, MODULO_AXIS, ROTARY_AXIS, make_modal, set_diameters

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
    given = getattr(config.offsets, "at_start", None)
    begins = _START_OFFSET in config.offsets if given is None else given
    if begins or dialect.sets_work_offsets:
        state.place_zero(state.coordinates.with_work_offset(0, _START_OFFSET))
    return state
