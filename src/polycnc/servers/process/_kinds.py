"""The kinds of machines that can be served; what only one of them needs is loaded with it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from polycnc.cnc import ChannelData, Control
from polycnc.servers.machines import Made, MemoryPrograms
from polycnc.servers.process._io_values import IoValues
from polycnc.servers.process._machinery import Machinery
from polycnc.servers.process._plain_values import MacroValues, PlainParameters


def _plain(wanted: Machinery) -> Made:
    channels = [ChannelData(axes, spindle=number == 0) for number, axes in enumerate(wanted.channels)]
    control = Control(wanted.file, channels=channels, memory=wanted.memory)

    def end() -> None:
        control.timers.save()
        control.machine.memory.close()

    def load(name: str, content: bytes) -> None:
        MemoryPrograms(lambda: control).put(name, content)
        control.select_program(name)

    parameters, variables = PlainParameters(control), MacroValues(lambda: control)
    return Made(control, lambda: control, {}, end, load, parameters, variables, IoValues(lambda: control))


def _fanuc(wanted: Machinery) -> Made:
    from polycnc.servers.process._fanuc import make_fanuc

    return make_fanuc(wanted)


def _bosch(wanted: Machinery) -> Made:
    from polycnc.servers.process._bosch import make_bosch

    return make_bosch(wanted)


def _apci(wanted: Machinery) -> Made:
    from polycnc.controllers.apci import Board, load_system_file
    from polycnc.servers.process._apci_tasks import ApciTasks

    board = Board(None if wanted.file is None else load_system_file(wanted.file))
    return Made(board, tasks=ApciTasks(board))


def _imc(wanted: Machinery) -> Made:
    from polycnc.controllers.imc import Card, load_card
    from polycnc.servers.process._imc_values import ImcParameters

    card = Card(None if wanted.file is None else load_card(wanted.file))
    return Made(card, parameters=ImcParameters(card))


KINDS: Mapping[str, Callable[[Machinery], Made]] = {
    "plain": _plain,
    "fanuc": _fanuc,
    "bosch": _bosch,
    "apci": _apci,
    "imc": _imc,
}
"""The kinds by name."""
