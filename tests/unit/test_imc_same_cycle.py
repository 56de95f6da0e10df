"""Commands that an axis is given in one control cycle: the last one counts, and leaving a motion takes none back."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from polycnc.controllers.imc import imclib as lib
from support.imc_card import shows
from support.imc_network import Program

IF, Q, P1, P2, C = lib.FIFO_SEL
ONE = 65536  # pulse per ms


@pytest.fixture
def program() -> Iterator[Program]:
    yield Program()
    lib.detach()


def follow(program: Program) -> None:
    """Let axis 1 follow axis 0, which goes at 10 pulses per ms."""
    program.ok(lib.IMC_MoveVelocity, 10 * ONE, 0, IF)
    program.ok(lib.IMC_GearFree, 1.0, 0, 0, 1, IF)
    program.run(200)
    assert program.get("curvel", 1) == 10 * ONE


@shows("curvel enasyn engear gearratio gearsrc master mcstgvel syntype")
@pytest.mark.parametrize("velocity", [0, -5 * ONE])
@pytest.mark.covers("imc.IMC_MoveVelocity")
def test_a_velocity_beside_the_end_of_the_gear_counts(program: Program, velocity: int) -> None:
    follow(program)
    program.set("engear", 0, 1)
    program.ok(lib.IMC_MoveVelocity, velocity, 1, IF)
    program.run(200)
    assert (program.get("curvel", 1), program.get("mcstgvel", 1)) == (velocity, velocity)


def end_gear(program: Program) -> None:
    follow(program)
    program.set("engear", 0, 1)


def end_homing(program: Program) -> None:
    program.set("highvel", 4 * ONE, 1)
    program.ok(lib.IMC_HomeSwitch1, 0, 1, 0, 1, IF)
    program.run(50)
    program.set("gohome", 0, 1)


def end_synchronous_motion(program: Program) -> None:
    program.ok(lib.IMC_MoveInTime, 100, 500, 1, IF)
    program.set("startsyn", -1, 1)
    program.run(50)
    program.set("startsyn", 0, 1)


@shows(
    "curpos curvel enasyn engear gearratio gearsrc gohome highvel homeseq master mcsdist "
    "mcsgo mcstgpos mcstgvel slaveabs slavedist startsyn synaxis synsrc synsrcvar syntype"
)
@pytest.mark.parametrize("end", [end_gear, end_homing, end_synchronous_motion])
@pytest.mark.covers("imc.IMC_MoveAbsolute")
def test_a_move_beside_the_end_of_another_motion_is_not_lost(
    program: Program, end: Callable[[Program], None]
) -> None:
    end(program)
    assert program.get("curpos", 1) != -300
    program.ok(lib.IMC_MoveAbsolute, -300, 1, IF)
    program.rest(1, limit=5000)
    assert (program.get("curpos", 1), program.get("mcsgo", 1)) == (-300, 0)


@shows("curvel enasyn engear gearratio gearsrc master mcsdist mcsgo mcstgpos mcstgvel syntype")
@pytest.mark.parametrize("before", [lib.IMC_MoveVelocity, lib.IMC_MoveAbsolute, lib.IMC_MoveRelative])
@pytest.mark.covers("imc.IMC_GearFree")
@pytest.mark.covers("imc.IMC_MoveRelative")
def test_a_gear_behind_a_move_of_the_same_cycle_counts(
    program: Program, before: Callable[..., object]
) -> None:
    program.ok(lib.IMC_MoveVelocity, 10 * ONE, 0, IF)
    program.run(100)
    program.ok(before, 3 * ONE, 1, IF)
    program.ok(lib.IMC_GearFree, 1.0, 0, 0, 1, IF)
    program.run(200)
    assert (program.get("curvel", 1), program.get("engear", 1)) == (10 * ONE, -1)
    assert (program.get("mcsgo", 1), program.get("mcsdist", 1)) == (0, 0)


@shows("curvel gohome highvel homeseq mcstgvel")
@pytest.mark.covers("imc.IMC_HomeSwitch1")
def test_homing_behind_a_velocity_of_the_same_cycle_counts(program: Program) -> None:
    program.set("highvel", 4 * ONE, 1)
    program.ok(lib.IMC_MoveVelocity, -3 * ONE, 1, IF)
    program.ok(lib.IMC_HomeSwitch1, 0, 1, 0, 1, IF)
    program.run(100)
    assert (program.get("curvel", 1), program.get("gohome", 1)) == (4 * ONE, -1)


@shows(
    "curpos enasyn mcsdist mcsgo mcstgpos mcstgvel slaveabs slavedist startsyn synaxis synsrc "
    "synsrcvar syntype"
)
@pytest.mark.parametrize("before", [lib.IMC_MoveVelocity, lib.IMC_MoveAbsolute])
@pytest.mark.covers("imc.IMC_MoveTP")
def test_the_start_of_a_synchronous_motion_behind_a_move_of_the_same_cycle_counts(
    program: Program, before: Callable[..., object]
) -> None:
    program.ok(lib.IMC_MoveInTime, 100, 500, 2, IF)
    program.run(1)
    program.ok(before, -4000, 2, IF)
    program.set("startsyn", -1, 2)
    program.run(150)
    assert program.get("curpos", 2) == 500


@shows("curvel enasyn engear gearratio gearsrc master mcstgvel synaxis synsrc synsrcvar syntype")
@pytest.mark.covers("imc.IMC_GearInTime")
def test_a_velocity_stays_until_a_gear_that_waits_for_its_start(program: Program) -> None:
    program.ok(lib.IMC_MoveVelocity, 3 * ONE, 1, IF)
    program.ok(lib.IMC_GearInTime, 1.0, 0, 0, 50, 1, IF)
    program.run(100)
    assert program.get("curvel", 1) == 3 * ONE
