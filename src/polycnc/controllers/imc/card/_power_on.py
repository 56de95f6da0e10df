"""The card as it is switched on: default parameters, and the machine around its axes."""

from __future__ import annotations

import math

from polycnc.controllers.imc.card._config import AxisConfig, CardConfig
from polycnc.controllers.imc.core._parameters import parameter
from polycnc.controllers.imc.core._state import CardState, make_card_state
from polycnc.kernel import (
    LIMIT_HIGH,
    LIMIT_LOW,
    OTHER_SOURCE,
    PIDF,
    REFERENCE,
    KernelState,
    make_state,
    place_machine,
)

CYCLE_S = 0.001  # the control cycle: velocities are pulses per millisecond and per cycle alike
SYSTEM_CLOCK_HZ = 100_000_000
_TERMINALS = {"limit_positive": 1, "limit_negative": 2, "origin": 4}  # bits of aio

_HIGHEST = 32767.999984741211  # in S16.16
AXIS_DEFAULTS: dict[str, float] = {
    "encpfactor": 1.0,
    "encsfactor": 1.0,
    "poserrlim": 65535,
    "stopfilt": -1,
    "psoftlim": 2147483647,
    "nsoftlim": -2147483648,
    "breakp": 2147483647,
    "vellim": _HIGHEST,
    "accellim": _HIGHEST,
    "indexNum": 1,
    "haltmode": -1,
    "pathabs": -1,
}
READY: dict[str, float] = {
    "mcsmaxvel": 100.0,
    "mcsaccel": 1.0,
    "mcsdecel": 1.0,
    "pcsmaxvel": 100.0,
    "pcsaccel": 1.0,
    "pcsdecel": 1.0,
    "highvel": 10.0,
    "lowvel": 1.0,
    "ena": -1,
    "run": -1,
}
CARD_READY: dict[str, float] = {
    f"{name}{g}": 1.0 for g in (1, 2) for name in ("pathacc", "feedrate", "segtgvel")
}


def set_parameter(s: CardState, row: int, name: str, value: float) -> None:
    """Put a value into a parameter, without what a write sets off."""
    each = parameter(name)
    raw = each.to_raw(value)
    for k in range(each.words):
        word = raw >> (16 * k) & 0xFFFF
        s.memory[row, each.address + k] = word - 0x10000 if word & 0x8000 else word


def _card_values(config: CardConfig) -> dict[str, float]:
    values: dict[str, float] = {
        "naxis": config.number_of_axes,
        "fwversion": config.fwversion,
        "hwversion": config.hwversion,
        "clkdiv": 1,
        "sysclk": SYSTEM_CLOCK_HZ,
        "gin1": -1,
        "gin2": -1,
        "feedrate1": 1.0,
        "feedrate2": 1.0,
    }
    if config.ready:
        values |= CARD_READY
    return values | dict(config.parameters)


def make_machine(config: CardConfig, record_cycles: int) -> KernelState:
    """Make the drives, encoders and switches around the axes, at rest at 0."""
    n = config.number_of_axes
    kernel = make_state(n, cycle_s=CYCLE_S, segments=1, record_cycles=record_cycles, record_actual=True)
    for i, axis in enumerate(config.axes):
        place_machine(kernel, i, 0.0)
        _surround(kernel, i, axis)
    kernel.owner[:] = OTHER_SOURCE
    return kernel


def _surround(kernel: KernelState, i: int, axis: AxisConfig) -> None:
    if axis.lag_s > 0.0:
        kernel.servo.row[i]["mode"] = PIDF
        kernel.servo.row[i]["kp"] = axis.gain
        kernel.servo.row[i]["kfcv"] = 1.0
        kernel.plant.row[i]["lag_s"] = axis.lag_s
    switch, marks = kernel.switches.switch[i], kernel.switches.marks[i]
    if axis.limit_negative is not None:
        switch[LIMIT_LOW]["on_from"], switch[LIMIT_LOW]["on_to"] = -math.inf, axis.limit_negative
    if axis.limit_positive is not None:
        switch[LIMIT_HIGH]["on_from"], switch[LIMIT_HIGH]["on_to"] = axis.limit_positive, math.inf
    if axis.origin is not None:
        switch[REFERENCE]["on_from"], switch[REFERENCE]["on_to"] = axis.origin
    for j in (LIMIT_LOW, LIMIT_HIGH, REFERENCE):
        switch[j]["level"] = int(switch[j]["on_from"] <= 0.0 <= switch[j]["on_to"])
    if axis.index is not None:
        marks["index_origin"], marks["index_pitch"] = axis.index.first, axis.index.pitch


def make_card(config: CardConfig) -> CardState:
    """Make the card with its power-on parameters."""
    n = config.number_of_axes
    depths = config.depths
    s = make_card_state(n, (depths.ififo, depths.qfifo, depths.pfifo1, depths.pfifo2, depths.cfifo))
    s.card[0]["wrap_to_origin"] = int(config.overflow == "origin")
    s.card[0]["short_factor"] = int(config.scale_factor == "S16.16")
    s.card[0]["delay_step"] = 1000 if config.delay_unit == "us" else 1
    for name, value in _card_values(config).items():
        set_parameter(s, n, name, value)
    for i, axis in enumerate(config.axes):
        for name, value in (AXIS_DEFAULTS | (READY if config.ready else {}) | axis.parameters).items():
            set_parameter(s, i, name, value)
        row = s.axis[i]
        row["counts_per_pulse"] = axis.counts_per_pulse
        row["inverted"] = sum(_TERMINALS[name] for name in set(axis.low_when_on))
        wired = {name for name in _TERMINALS if getattr(axis, name) is not None}
        row["unwired"] = sum(bit for name, bit in _TERMINALS.items() if name not in wired)
        row["levels"] = row["inverted"] | row["unwired"]
        if axis.probe is not None:
            row["probe_origin"], row["probe_pitch"] = axis.probe.first, axis.probe.pitch
    return s
