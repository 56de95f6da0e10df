"""The software operator's panel: switches on the screen, whose signals the PMC passes on to the control.

Ruling: the PMC of this control passes them on as they are, when they are written and when the power comes on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from polycnc.controllers.fanuc.device._device_state import DeviceState
from polycnc.controllers.fanuc.device._modes import PowerMateMode
from polycnc.controllers.fanuc.device._signals import Signals
from polycnc.machine import Store

JOG_PERCENT = (
    0.0, 0.1, 0.14, 0.2, 0.27, 0.37, 0.52, 0.72, 1.0, 1.4, 2.0, 2.7, 3.7, 5.2, 7.2, 10.0, 14.0, 20.0, 27.0, 37.0,
    52.0, 72.0, 100.0, 140.0, 200.0,
)  # fmt: skip
MEMBERS: Mapping[int, tuple[str, int]] = MappingProxyType({
    0: ("mode", 5),
    3: ("rpd_ovrd", 3),
    4: ("jog_ovrd", 24),
    5: ("feed_ovrd", 20),
    7: ("blck_del", 1),
    8: ("sngl_blck", 1),
    9: ("machn_lock", 1),
    10: ("dry_run", 1),
    11: ("mem_prtct", 1),
    12: ("feed_hold", 1),
})  # fmt: skip
"""Signals by their bit in the selection, each with its largest value."""

_MODES = (
    PowerMateMode.MDI,
    PowerMateMode.MEM,
    PowerMateMode.EDIT,
    PowerMateMode.HND,
    PowerMateMode.JOG,
    PowerMateMode.REF,
)
_MODE_BYTES = (0x00, 0x01, 0x03, 0x04, 0x05, 0x15)  # MD1O MD2O MD4O, ZRNO
_DEFAULTS = {"mode": 1, "jog_ovrd": 22, "feed_ovrd": 10}
GENERAL = 8
NAME_LENGTH = 8
_BLANK = " " * NAME_LENGTH


class Panel:
    """Hold the signals of the software operator's panel, durably."""

    def __init__(
        self, store: Store, signals: Signals, state: DeviceState, select: Callable[[PowerMateMode], None]
    ) -> None:
        self._store = store
        self._signals = signals
        self._state = state
        self._select = select
        self._area = store.area("fanuc.panel", int)
        self._names = store.area("fanuc.panel_names", str)

    def value(self, name: str) -> int:
        """Return a signal by its name in `MEMBERS`."""
        return self._area.get(name, _DEFAULTS.get(name, 0))

    def set(self, values: Mapping[str, int]) -> None:
        """Set signals that have been checked, and let the control have them."""
        with self._store.transaction():
            for name, value in values.items():
                self._area[name] = value
        self._pass_on(values)

    def switched_on(self) -> None:
        """Let the control have what was set before it was switched off."""
        self._pass_on({name: self._area[name] for name, _ in MEMBERS.values() if name in self._area})

    def _pass_on(self, values: Mapping[str, int]) -> None:
        signals = self._signals
        for name, value in values.items():
            match name:
                case "mode":
                    if not (value == 3 and self._state.mode is PowerMateMode.INC):
                        self._select(_MODES[value])
                case "rpd_ovrd":
                    signals.give_bits(14, 3, value)
                case "jog_ovrd":
                    signals.set_jog_override(JOG_PERCENT[value])
                case "feed_ovrd":
                    signals.give(12, 255 - 10 * value)
                case "blck_del":
                    signals.give_bits(44, 1, value)
                case "machn_lock":
                    signals.give_bits(44, 2, value << 1)
                case "sngl_blck":
                    signals.give_bits(46, 2, value << 1)
                case "dry_run":
                    signals.give_bits(46, 0x80, value << 7)
                case "mem_prtct":
                    signals.give_bits(46, 0x78, 0 if value else 0x78)
                case "feed_hold":
                    signals.give_bits(8, 0x20, 0 if value else 0x20)

    # ------------------------------------------------------------------ general-purpose signals

    @property
    def general(self) -> int:
        """The general-purpose signals, signal 1 in bit 0."""
        return self._area.get("general", 0)

    def set_general(self, mask: int, value: int) -> None:
        """Set some of the general-purpose signals."""
        self._area["general"] = self.general & ~mask | value & mask

    def name(self, signal: int) -> str:
        """Return the name of a general-purpose signal, 1 to 8: 8 characters."""
        return self._names.get(str(signal), _BLANK)

    def set_names(self, names: Mapping[int, str]) -> None:
        """Name general-purpose signals."""
        with self._store.transaction():
            for signal, name in names.items():
                self._names[str(signal)] = name

    # ------------------------------------------------------------------ F addresses

    def image(self, address: int) -> int | None:
        """Return the byte of an F address that shows the panel to the PMC; None for others."""
        value = self.value
        match address:
            case 72:
                return self.general
            case 73:
                return _MODE_BYTES[value("mode")]
            case 75:
                names = ("blck_del", "sngl_blck", "machn_lock", "dry_run", "mem_prtct", "feed_hold")
                return sum(value(name) << 2 + k for k, name in enumerate(names))
            case 76:
                return value("rpd_ovrd") << 4
            case 78:
                return 255 - 10 * value("feed_ovrd")
            case 79 | 80:
                return (0xFFFF - round(100.0 * JOG_PERCENT[value("jog_ovrd")])) >> 8 * (address - 79) & 0xFF
            case _:
                return None
