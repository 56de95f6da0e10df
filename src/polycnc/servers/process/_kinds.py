"""The kinds of machines that can be served: what each is made of, and what its operator does in its own way."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from polycnc.cnc import Control, ControlError, Mode, Refusal, Step
from polycnc.errors import UsageError
from polycnc.machine import Device


@dataclass(frozen=True, slots=True)
class Machinery:
    """What a machine is to be made of: `file` is its machine, system or card file, None for the kind's own default."""

    name: str = "machine"
    file: str | Path | None = None
    memory: Path | None = None
    axes: int = 3
    characters: int = 128_000


@dataclass(frozen=True, slots=True)
class Made:
    """A device with its control and what its operator does in its own way."""

    device: Device[Any]
    find_control: Callable[[], Control] | None = None
    own: Mapping[str, Callable[..., object]] = field(default_factory=dict)
    end: Callable[[], None] = lambda: None


def _plain(wanted: Machinery) -> Made:
    control = Control(wanted.file, memory=wanted.memory)

    def end() -> None:
        control.timers.save()
        control.machine.memory.close()

    return Made(control, lambda: control, {}, end)


def _fanuc(wanted: Machinery) -> Made:
    from polycnc.controllers.fanuc import PowerMate, PowerMateMode

    if wanted.file is not None:
        raise UsageError(
            f"a FANUC control has no machine file: {wanted.file}",
            hint="It is described by its parameters: keep them with --memory.",
        )
    mate = PowerMate(wanted.axes, memory=wanted.memory, characters=wanted.characters)
    modes = {
        Mode.AUTO: PowerMateMode.MEM, Mode.MDI: PowerMateMode.MDI, Mode.JOG: PowerMateMode.JOG,
        Mode.INC: PowerMateMode.INC, Mode.HANDLE: PowerMateMode.HND, Mode.REF: PowerMateMode.REF,
        Mode.EDIT: PowerMateMode.EDIT,
    }  # fmt: skip

    def select_program(*, program: str, channel: int) -> None:
        if program not in mate.control.programs:
            mate.control.select_program(program, channel=channel)  # refuses it
        mate.select_program(int(program.removeprefix("O")))

    def cycle_start(*, step: str, line: int, channel: int) -> None:
        mate.control.channel_status(channel)  # refuses a channel that there is not
        if mate.mode is PowerMateMode.MEM and line > 1:
            mate.set_cursor(line - 1)
        mate.cycle_start(step=Step(step))

    def set_switches(*, machine_lock: bool | None, block_delete: list[int] | None, **more: Any) -> None:
        marks = None if block_delete is None else frozenset(block_delete)
        mate.control.set_switches(machine_lock=machine_lock, block_delete=marks, **more)
        if machine_lock is not None:
            mate.signals.give_bits(44, 2, machine_lock << 1)

    own: dict[str, Callable[..., object]] = {
        "select_mode": lambda mode, channel: mate.select_mode(modes[Mode(mode)]),
        "select_program": select_program,
        "cycle_start": cycle_start,
        "feed_hold": lambda channel: mate.feed_hold(),
        "reset": lambda channel: mate.reset(),
        "emergency_stop": lambda on: mate.emergency_stop(on),
        "set_switches": set_switches,
    }
    return Made(mate, lambda: mate.control, own, mate.close)


def _bosch(wanted: Machinery) -> Made:
    from polycnc.controllers.bosch import Pnc
    from polycnc.controllers.bosch.ncs import Mode as BoschMode

    if wanted.memory is None:
        raise UsageError("a Bosch control keeps its files in a folder", hint="Name one with --memory.")
    wanted.memory.mkdir(parents=True, exist_ok=True)
    pnc = Pnc(wanted.memory, wanted.file)
    modes = {
        Mode.AUTO: BoschMode.AUTOMATIC, Mode.MDI: BoschMode.MDI, Mode.JOG: BoschMode.JOG,
        Mode.REF: BoschMode.REFERENCE,
    }  # fmt: skip

    def at(channel: int | None) -> int | None:
        if channel is not None:
            pnc.control.channel_status(channel)
        return None if channel is None else channel + 1

    def select_mode(*, mode: str, channel: int | None) -> None:
        chosen = modes.get(Mode(mode))
        if chosen is None:
            hint = f"Modes are {', '.join(modes)}."
            raise ControlError(Refusal.DATA, f"this control has no mode {mode}", hint=hint)
        pnc.select_mode(chosen, channel=at(channel))

    def cycle_start(*, step: str, line: int, channel: int) -> None:
        if step != Step.RUN.value or line > 1:
            raise ControlError(Refusal.DATA, "this start begins and goes on only", hint="Search the block.")
        pnc.cycle_start(channel=at(channel) or 1)

    own: dict[str, Callable[..., object]] = {
        "select_mode": select_mode,
        "select_program": lambda program, channel: pnc.select_program(program, channel=at(channel) or 1),
        "set_mdi": lambda text, channel: pnc.select_blocks(text, channel=at(channel) or 1),
        "cycle_start": cycle_start,
        "reset": lambda channel: pnc.reset(channel=at(channel)),
    }
    return Made(pnc, lambda: pnc.control, own, pnc.close)


def _apci(wanted: Machinery) -> Made:
    from polycnc.controllers.apci import Board, load_system_file

    return Made(Board(None if wanted.file is None else load_system_file(wanted.file)))


def _imc(wanted: Machinery) -> Made:
    from polycnc.controllers.imc import Card, load_card

    return Made(Card(None if wanted.file is None else load_card(wanted.file)))


KINDS: Mapping[str, Callable[[Machinery], Made]] = {
    "plain": _plain,
    "fanuc": _fanuc,
    "bosch": _bosch,
    "apci": _apci,
    "imc": _imc,
}
"""The kinds by name."""
