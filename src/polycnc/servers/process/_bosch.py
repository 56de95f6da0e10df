"""A Bosch PNC as it is served: channels from 1, its own modes, blocks put in by hand."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.cnc import ControlError, Mode, Refusal, Step
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.bosch.ncs import Mode as BoschMode
from polycnc.errors import UsageError
from polycnc.nc import ProgramText
from polycnc.servers.machines import Made, ReadValues
from polycnc.servers.process._bosch_screen import BoschScreen
from polycnc.servers.process._io_values import IoValues
from polycnc.servers.process._machinery import Machinery


def make_bosch(wanted: Machinery) -> Made:
    """Make a PNC in its folder.

    Raises:
        UsageError: No folder is named.
    """
    if wanted.memory is None:
        raise UsageError("a Bosch control keeps its files in a folder", hint="Name one with --memory.")
    wanted.memory.mkdir(parents=True, exist_ok=True)
    pnc = Pnc(wanted.memory, wanted.file, channels=wanted.channels)
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

    def select_program(*, program: str, channel: int) -> None:
        number = at(channel) or 1
        if program in pnc.control.programs:  # that doors have put in; else of the root
            pnc.control.select_program(program, channel=channel)
            pnc.system.reset_signal(number, False)
        else:
            pnc.select_program(program, channel=number)

    def cycle_start(*, step: str, line: int, channel: int) -> None:
        if step != Step.RUN.value or line > 1:
            raise ControlError(Refusal.DATA, "this start begins and goes on only", hint="Search the block.")
        pnc.cycle_start(channel=at(channel) or 1)

    own: dict[str, Callable[..., object]] = {
        "select_mode": select_mode,
        "select_program": select_program,
        "set_mdi": lambda text, channel: pnc.select_blocks(text, channel=at(channel) or 1),
        "cycle_start": cycle_start,
        "reset": lambda channel: pnc.reset(channel=at(channel)),
    }

    def load(name: str, content: bytes) -> None:
        pnc.control.select_program(ProgramText(name, content))

    variables = ReadValues("variable", pnc.variables)
    parameters = ReadValues("parameter", pnc.system.all_parameters)
    return Made(
        pnc, lambda: pnc.control, own, pnc.close, load, parameters, variables,
        IoValues(lambda: pnc.control), BoschScreen(pnc), folder=wanted.memory,
    )  # fmt: skip
