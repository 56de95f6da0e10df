"""The state of a Power Mate in the numbers of cnc_statinfo (Manual 000)."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.cnc import Emergency, Motion, RunState
from polycnc.controllers.fanuc.device._alarms import shown
from polycnc.controllers.fanuc.device._power_mate import PowerMate

_RUN = {
    RunState.ACTIVE: 4,
    RunState.HOLD: 2,
    RunState.STOPPED_AT_BLOCK: 1,
    RunState.PROGRAM_STOP: 1,
    RunState.OPTIONAL_STOP: 1,
    RunState.ALARM: 1,
}
_MOTION = {Motion.NONE: 0, Motion.MOVING: 1, Motion.DWELL: 3}
_ALARM, _BATTERY = 1, 2
_EMERGENCY, _RESET = 1, 2
_EDIT, _OUTPUT, _INPUT, _COMPARE, _LABEL_SKIP = 1, 3, 4, 5, 6


@dataclass(frozen=True, slots=True)
class State:
    """Each element is a code of the manual; 0 is the state of rest."""

    aut: int
    run: int
    motion: int
    mstb: int
    emergency: int
    alarm: int
    edit: int


def read_state(power_mate: PowerMate, *, uploading: bool = False) -> State:
    """Return the state in the present cycle; `uploading` says whether a program is going out."""
    control = power_mate.control
    channel = control.channel_status()
    reset = power_mate.signals.state.reset_is_on or control.emergency is Emergency.RESET_NEEDED
    stopped = control.emergency is Emergency.ON
    battery = _BATTERY if power_mate.signals.state.battery_low else 0
    return State(
        aut=int(power_mate.mode),
        run=_RUN.get(channel.run_state, 0),
        motion=_MOTION[channel.motion],
        mstb=int(bool(channel.functions)),
        emergency=_EMERGENCY if stopped else _RESET if reset else 0,
        alarm=_ALARM if shown(control.alarms.active) else battery,
        edit=_edit(power_mate, uploading),
    )


def _edit(power_mate: PowerMate, uploading: bool) -> int:
    transfer = power_mate.transfer
    if transfer is not None:
        if not transfer.begun:
            return _LABEL_SKIP
        return _COMPARE if transfer.compare else _INPUT
    if uploading:
        return _OUTPUT
    return _EDIT if power_mate.control.is_editing else 0
