"""A FANUC Power Mate as it is served: modes, programs by number, parameters, macro variables, tool offsets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from polycnc.cnc import Mode, Step
from polycnc.controllers.fanuc import PowerMate, PowerMateMode
from polycnc.errors import UsageError
from polycnc.servers.focas import numbered
from polycnc.servers.machines import Made, MemoryPrograms
from polycnc.servers.process._fanuc_programs import FanucPrograms
from polycnc.servers.process._fanuc_signals import FanucSignals
from polycnc.servers.process._fanuc_values import FanucParameters, FanucVariables, set_offset, set_tool
from polycnc.servers.process._machinery import Machinery


def make_fanuc(wanted: Machinery) -> Made:
    """Make a Power Mate.

    Raises:
        UsageError: It has no machine file.
    """
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

    def of_channel(channel: int | None, do: Callable[[], object]) -> None:
        if channel is not None:
            mate.control.channel_status(channel)  # refuses a channel that there is not
        do()

    def select_program(*, program: str, channel: int) -> None:
        if program not in mate.control.programs:
            mate.control.select_program(program, channel=channel)  # refuses it
        of_channel(channel, lambda: mate.select_program(int(program.removeprefix("O"))))

    def cycle_start(*, step: str, line: int, channel: int) -> None:
        of_channel(channel, lambda: mate.cycle_start(Step(step), line=line if line > 1 else None))

    def set_switches(*, machine_lock: bool | None, block_delete: list[int] | None, **more: Any) -> None:
        marks = None if block_delete is None else frozenset(block_delete)
        mate.control.set_switches(machine_lock=machine_lock, block_delete=marks, **more)
        if machine_lock is not None:
            mate.signals.give_bits(44, 2, machine_lock << 1)

    own: dict[str, Callable[..., object]] = {
        "select_mode": lambda mode, channel: of_channel(channel, lambda: mate.select_mode(modes[Mode(mode)])),
        "select_program": select_program,
        "cycle_start": cycle_start,
        "feed_hold": lambda channel: of_channel(channel, mate.feed_hold),
        "reset": lambda channel: of_channel(channel, mate.reset),
        "emergency_stop": lambda on: mate.emergency_stop(on),
        "set_switches": set_switches,
        "set_tool": lambda number, values: set_tool(mate, number, values),
        "set_offset": lambda name, values, add: set_offset(mate, name, values, add=add),
    }

    def load(_: str, content: bytes) -> None:
        number, text = numbered(content)
        name = f"O{number:04d}"
        MemoryPrograms(lambda: mate.control).put(name, text)
        select_program(program=name, channel=0)

    parameters, variables = FanucParameters(mate), FanucVariables(mate)
    return Made(
        mate, lambda: mate.control, own, mate.close, load, parameters, variables, FanucSignals(mate),
        programs=FanucPrograms(mate),
    )  # fmt: skip
