"""Set a board up from its system file: the simulated drives, the parameters, what terminals are used for."""

from __future__ import annotations

import math

from polycnc.controllers.apci.board._commanded import CommandedBoard
from polycnc.controllers.apci.board._system_file import InputFunction, SystemFile
from polycnc.controllers.apci.board._units import PositionUnit, TimeUnit
from polycnc.controllers.apci.core._registers import STROBE_INPUT_OF_AXIS, ErrorReg
from polycnc.controllers.apci.core._state import SMA, SMD, TOM
from polycnc.kernel import LIMIT_HIGH, LIMIT_LOW, OTHER_SOURCE, PIDF, REFERENCE, place_machine

_LIMIT_FUNCTIONS = {"none": 0, "TOM": TOM, "SMA": SMA, "SMD": SMD}
_INPUT_FUNCTIONS: tuple[InputFunction, ...] = (
    *("EO", "DR", "UI", "REF", "LP"),
    *("LSL_TOM", "LSL_SMA", "LSL_SMD", "LSR_TOM", "LSR_SMA", "LSR_SMD"),
)
_PARAMETERS = (
    *("jac", "jvl", "jtvl", "hac", "hvl", "sdec", "jerkrel", "MaxVel", "MaxAcc", "MDVEL"),
    *("kp", "ki", "kd", "kpl", "kfca", "kfcv", "ipw", "mpe"),
    *("sll", "slr", "gf", "slsp", "effradius"),
)


def set_up_plant(board: CommandedBoard) -> None:
    """Set up what stays with the board: drives, encoders, switches."""
    kernel = board.kernel
    for axis in board.axes:
        i, plant = axis.index, axis.setup.plant
        place_machine(kernel, i, 0.0)
        kernel.servo.row[i]["loop_closed"] = 0
        if plant.kind == "lag":
            kernel.servo.row[i]["mode"] = PIDF
            kernel.plant.row[i]["lag_s"] = plant.lag_s
        if plant.encoder == "counts":
            kernel.plant.row[i]["resolution"] = 1.0 / axis.setup.counts_per_unit
        kernel.plant.row[i]["backlash"] = plant.play
        # With a play that the board compensates the encoder is on the motor, or there would be none to compensate.
        kernel.plant.row[i]["motor_encoder"] = axis.setup.backlash > 0.0
        axis.row["backlash"] = axis.setup.backlash
        axis.row["stepper"] = axis.setup.motor == "stepper"
        axis.row["rotary"] = axis.setup.is_rotary
        switch, marks = kernel.switches.switch[i], kernel.switches.marks[i]
        if plant.limit_left is not None:
            switch[LIMIT_LOW]["on_from"], switch[LIMIT_LOW]["on_to"] = -math.inf, plant.limit_left
        if plant.limit_right is not None:
            switch[LIMIT_HIGH]["on_from"], switch[LIMIT_HIGH]["on_to"] = plant.limit_right, math.inf
        if plant.reference is not None:
            switch[REFERENCE]["on_from"], switch[REFERENCE]["on_to"] = plant.reference
        if plant.index is not None:
            marks["index_origin"] = plant.index
            marks["index_pitch"] = 1.0 / axis.setup.gf  # one pulse per turn of the motor
    kernel.owner[:] = OTHER_SOURCE


def load_parameters(board: CommandedBoard, system: SystemFile) -> None:
    """Take over the parameters and the planning of a system file."""
    board.planned = system
    for axis, setup in zip(board.axes, system.axes, strict=False):
        for name in _PARAMETERS:
            setattr(axis, name, getattr(setup, name))
        axis.row["soft_left"] = _LIMIT_FUNCTIONS[setup.soft_left]
        axis.row["soft_right"] = _LIMIT_FUNCTIONS[setup.soft_right]
        axis.row["cef"] = bool(system.differences(board.config))
        if not setup.mcp_limits_are_possible:
            board.raise_error(ErrorReg.LimitDefError)
        axis.update_filter()
        _plan_inputs(board, system, axis.index)
    variables, planned, row = board.variables, system.board, board.state.board[0]
    variables.pu = int(PositionUnit[planned.pu])
    variables.tu = int(TimeUnit[planned.tu])
    variables.trac, variables.trvl, variables.trtvl = planned.trac, planned.trvl, planned.trtvl
    row["trovrst"] = planned.trovrst
    row["mode_register"] = int(system.modereg)
    row["inverted"] = system.inverted_inputs
    row["inputs"] = row["external"] ^ row["inverted"]
    row["outputs"] = system.outputs_at_reset
    board.nfrax = system.nfrax


def _plan_inputs(board: CommandedBoard, system: SystemFile, i: int) -> None:
    plan = board.state.plan[i]
    for function in _INPUT_FUNCTIONS:
        plan[function] = system.inputs_for(function, i)
    plan["PAE"] = system.outputs_for(i)
    strobes = STROBE_INPUT_OF_AXIS
    plan["strobe"] = 1 << (strobes[i] - 1) if i < len(strobes) else 0
    plan["left_switch"] = plan["LSL_TOM"] | plan["LSL_SMA"] | plan["LSL_SMD"]
    plan["right_switch"] = plan["LSR_TOM"] | plan["LSR_SMA"] | plan["LSR_SMD"]
    plan["reference_switch"] = plan["REF"]
