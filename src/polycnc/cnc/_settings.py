"""Commands that set how a control works: modes, overrides, switches, limits of axes, the dialect."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import Any

from polycnc.cnc._control_checks import check_over, share_axes
from polycnc.cnc._control_data import Mode, OnModeChange
from polycnc.cnc._control_parts import ControlParts, live_config
from polycnc.cnc._refusal import ControlError, Refusal
from polycnc.cnc._stopping import break_off
from polycnc.errors import shown
from polycnc.machine import AnyAxis
from polycnc.nc import Dialect, language_for


class Settings:
    """Carry out the commands that set something."""

    def __init__(self, of: ControlParts) -> None:
        self._of = of

    def change_axes(self, axes: tuple[AnyAxis, ...]) -> None:
        """Let the axes have these speeds, accelerations and limits from now on.

        Raises:
            ControlError: A program is being executed or is interrupted, or axes move.
        """
        for channel in self._of.channels:
            check_over(channel)
        if self._of.manual.active:
            raise ControlError(Refusal.RUNNING, "axes are moved by hand", hint="Wait until they stop.")
        self._of.machine.change_axes(axes)
        self._of.manual.change_axes(axes)
        self._change_config()

    def share_axes(self, shares: Sequence[tuple[str, ...]]) -> None:
        """Share the axes out anew, one tuple a channel; refused while one executes a program that is to change."""
        share_axes(self._of.channels, shares)
        self._of.alarms.owners = {axis: n for n, axes in enumerate(shares) for axis in axes}
        for each in self._of.channels:
            self._of.manual.set_overrides(
                feed=each.overrides.feed, rapid=each.overrides.rapid, axes=each.axes
            )

    def change_dialect(self, dialect: Dialect) -> None:
        """Let programs be read in another dialect, or with other settings of it, from now on.

        Raises:
            ControlError: A program is being executed or is interrupted.
        """
        for channel in self._of.channels:
            check_over(channel)
        if dialect.language != self._of.dialect.language:
            for channel in self._of.channels:
                channel.runs.language = language_for(dialect)
        self._of.dialect = dialect
        self._change_config()

    def _change_config(self) -> None:
        of = self._of
        live = live_config(of.machine.config, of.tools, of.offsets)
        for channel in of.channels:
            channel.change_config(live, of.dialect)

    def select_mode(
        self, mode: Mode, *, channel: int | None = None, going: Collection[str] = frozenset()
    ) -> None:
        """Change the mode; manual motion of the old one brakes, but of the axes `going`, a foreground edit ends.

        What it does to a program that is executed is `ControlData.mode_change_while_running`.

        Raises:
            ControlError: No such mode, or a program is being executed and the control refuses to leave its mode then.
        """
        if mode not in list(Mode):
            raise ControlError(
                Refusal.DATA, f"there is no mode '{mode}'", hint=f"The modes are {', '.join(Mode)}."
            )
        mode = Mode(mode)
        changing = [each for each in self._of.chosen(channel) if each.mode is not mode]
        running = [each for each in changing if each.active]
        what = self._of.data.mode_change_while_running
        if running and what is OnModeChange.REFUSE:
            raise ControlError(
                Refusal.RUNNING,
                f"the mode cannot change to {mode} while a program is being executed",
                hint="Hold the program first (feed hold), or wait for its end.",
            )
        if what is OnModeChange.RESET:
            break_off(self._of, running)
        for each in changing:
            each.hold()
            self._of.manual.stop_all(axis for axis in each.axes if axis not in going)
            if each.mode is Mode.EDIT:
                self._of.edits.close_foreground()
            each.mode = mode
        self._of.clock.changes += 1

    def set_overrides(
        self,
        *,
        feed: float | None = None,
        rapid: float | None = None,
        spindle: float | None = None,
        channel: int | None = None,
    ) -> None:
        """Set overrides, 1 is 100 %; what is None stays. Those of all channels hold for axes without a channel too.

        Raises:
            ControlError: One is out of range.
        """
        given = {"feed": feed, "rapid": rapid, "spindle": spindle}
        changes = {name: each for name, each in given.items() if each is not None}
        chosen = self._of.channels if channel is None else (self._of.channel(channel),)
        wanted = [replace(each.overrides, **changes).checked(self._of.data) for each in chosen]
        for each, overrides in zip(chosen, wanted, strict=True):
            self._of.manual.set_overrides(feed=overrides.feed, rapid=overrides.rapid, axes=each.axes)
            if each.data.spindle:
                self._of.spindle.set_override(overrides.spindle)
            each.set_overrides(overrides)
        if channel is None:
            free = set(self._of.manual.names).difference(*(each.axes for each in chosen))
            if free:
                self._of.manual.set_overrides(feed=feed, rapid=rapid, axes=free)

    def set_switches(
        self,
        *,
        single_block: bool | None = None,
        optional_stop: bool | None = None,
        dry_run: bool | None = None,
        machine_lock: bool | None = None,
        block_delete: frozenset[int] | None = None,
        channel: int | None = None,
    ) -> None:
        """Switch single block and its like on or off; what is None stays.

        Raises:
            ControlError: A skip mark that is not from 1 to 9, a dry run without a feed, or the machine lock while a
                program is executed or interrupted, or axes still brake.
        """
        given: dict[str, Any] = {
            "single_block": single_block,
            "optional_stop": optional_stop,
            "dry_run": dry_run,
            "machine_lock": machine_lock,
            "block_delete": block_delete,
        }
        if block_delete is not None and not block_delete <= frozenset(range(1, 10)):
            raise ControlError(
                Refusal.DATA,
                f"{shown(sorted(block_delete))} are not skip marks",
                hint="Give numbers from 1 to 9.",
            )
        if dry_run and not self._of.data.dry_run_mm_min > 0.0:
            raise ControlError(
                Refusal.DATA, "there is no feed for a dry run", hint="Set one (dry_run_mm_min)."
            )
        chosen = self._of.chosen(channel)
        changes = {name: each for name, each in given.items() if each is not None}
        wanted = [replace(each.switches, **changes) for each in chosen]
        for each, switches in zip(chosen, wanted, strict=True):
            if switches.machine_lock != each.switches.machine_lock:
                check_over(each)
                each.check_rest()
        for each, switches in zip(chosen, wanted, strict=True):
            each.set_switches(switches)
