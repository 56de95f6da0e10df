"""Random sequences of commands never break a board: no leaks, no numbers that are none, no jumps out of nothing."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from polycnc.controllers.apci.board._axis_commands import cl, clv, ol, ra, utrovr
from polycnc.controllers.apci.board._jog_commands import ja, jhi, jhl, jr, js, ms
from polycnc.controllers.apci.board._move_commands import Speeds, mca, mcr, mcr3d, mhr, mla, mlr
from polycnc.controllers.apci.board._spool_commands import sdels, spd, ssf, ssms, sstps, sstvl
from polycnc.controllers.apci.core._state import IDLE, MOVE, SPOOL_ENTRIES, TABLE, WAITING
from support.apci_bits import Axst, ModeReg
from support.apci_rig import SCAN_S, Rig
from support.often import often

Random = np.random.Generator
SYSTEM = """
number_of_axes = 3
[inputs]
1 = { functions = ["REF"] }
2 = { functions = ["LSR_SMD"], axes = ["A1"] }
3 = { functions = ["LSL_SMA"], axes = ["A2"] }
4 = { functions = ["LSR_TOM"], axes = ["A3"] }
[[axis]]
soft_left = "SMD"
sll = -60
slr = 500
"""


def _axes(random: Random) -> tuple[int, ...]:
    return tuple(int(i) for i in random.permutation(3)[: random.integers(1, 4)])


def _numbers(random: Random, count: int, size: float = 10.0) -> list[float]:
    values = random.uniform(-size, size, count)
    values[random.random(count) < 0.1] = 0.0
    return [float(value) for value in values]


def _speeds(random: Random) -> Speeds:
    vl = float(random.uniform(5.0, 100.0))
    return Speeds(
        float(random.uniform(100.0, 5000.0)),
        vl,
        float(random.choice([0.0, vl, 0.5 * vl, -0.3 * vl, 2.0 * vl])),
    )


def _path(rig: Rig, random: Random) -> None:
    axes, speeds, spool = _axes(random), _speeds(random), bool(random.random() < 0.7)
    which = random.integers(6)
    if which < 3 or len(axes) < 2:
        command = mlr if which else mla
        command(
            rig.board,
            axes,
            _numbers(random, len(axes), 10.0 if spool else 0.02 if which == 1 else 10.0),
            speeds,
            spool=spool,
        )
    elif which == 3:
        mcr(rig.board, axes[:2], _numbers(random, 2), float(random.uniform(-400, 400)), speeds, spool=spool)
    elif which == 4 or len(axes) < 3:
        if spool:
            phi = float(random.choice([1e-101, 45.0]))
            mhr(rig.board, axes, _numbers(random, 2), phi, _numbers(random, len(axes)), speeds, spool=True)
        else:
            mca(rig.board, axes[:2], _numbers(random, 2), 90.0, speeds)
    else:
        mcr3d(
            rig.board,
            axes,
            _numbers(random, 3),
            _numbers(random, 3),
            float(random.uniform(-200, 200)),
            speeds,
            spool=spool,
        )


def _table(rig: Rig, random: Random) -> None:
    spd(
        rig.board, int(random.integers(3)), _numbers(random, int(random.integers(1, 50)), 0.01), relative=True
    )


def _function(rig: Rig, random: Random) -> None:
    command = int(random.choice([5, 1000, 1001, 1003, 1004, 1006, 1025, 1101, 1201, 2001, 10005, 20003]))
    ssf(rig.board, int(random.integers(3)), command, float(random.choice([0.0, 1.0, 3.0, 60.0])))


def _parameters(rig: Rig, random: Random) -> None:
    axis = rig.board.axes[int(random.integers(3))]
    axis.jvl, axis.jtvl = float(random.uniform(5, 100)), float(random.choice([0.0, 10.0, -10.0, 150.0]))
    axis.jac = float(random.uniform(-2000, 2000)) or 1.0
    axis.sdec = float(random.choice([0.0, 300.0, 5000.0]))
    axis.jerkrel = float(random.random())
    axis.MDVEL = float(random.choice([0.0, 5.0]))


def _override(rig: Rig, random: Random) -> None:
    rig.board.trovrst = float(random.choice([0.0, 0.1]))
    rig.board.trovr = float(random.uniform(0.05, 2.0))
    utrovr(rig.board, rig.all if random.random() < 0.7 else _axes(random))
    rig.board.axes[0].jovr = float(random.uniform(0.05, 2.0))


def _mode(rig: Rig, random: Random) -> None:
    bits = (ModeReg.lookahead, ModeReg.SProfile, ModeReg.maxcheck, ModeReg.JSatSAF)
    rig.board.modereg = sum(int(bit) for bit in bits if random.random() < 0.4)


def _input(rig: Rig, random: Random) -> None:
    rig.board.set_input(int(random.integers(1, 5)), bool(random.random() < 0.3))


def _on(command: Callable[..., None], weight: int = 1) -> list[Callable[[Rig, Random], None]]:
    return [lambda rig, random: command(rig.board, _axes(random))] * weight


STEPS: list[Callable[[Rig, Random], None]] = [
    *[_path] * 14,
    *[_table] * 2,
    *[_function] * 4,
    *[_parameters, _override, _input, _mode] * 2,
    *_on(ssms, 6),
    *[step for command in (js, ms, sstps, sdels, jhl) for step in _on(command)],
    *[lambda rig, random: jr(rig.board, (a := _axes(random)), _numbers(random, len(a)))] * 3,
    lambda rig, random: ja(rig.board, (a := _axes(random)), _numbers(random, len(a))),
    lambda rig, random: jhi(rig.board, (a := _axes(random)), _numbers(random, len(a))),
    lambda rig, random: sstvl(rig.board, _axes(random), float(random.uniform(0, 50))),
]
LOOPS = [step for command in (cl, clv, ol, ra) for step in _on(command)]


def consistent(rig: Rig) -> None:
    """Check everything that must hold between two scans."""
    state = rig.board.state
    used: dict[int, int] = {}
    for i, row in enumerate(state.axis):
        queued = [int(state.ring[i, k % SPOOL_ENTRIES]) for k in range(int(row["head"]), int(row["tail"]))]
        for e in queued:
            used[e] = used.get(e, 0) + 1
            assert state.entry[e]["mask"] >> i & 1
        if row["direct"]:
            used[int(row["entry"])] = used.get(int(row["entry"]), 0) + 1
            assert row["motion"] == MOVE
        if row["motion"] in (MOVE, TABLE) and not row["direct"]:
            assert queued[0] == row["entry"]
        assert 145_000 - rig.board.axes[i].lsm == sum(145 + 8 * int(state.entry[e]["points"]) for e in queued)
        assert row["pe"] == (
            not row["commanded"] and not row["running"] and (row["motion"] == IDLE or bool(row["past"]))
        )
        assert row["closed"] or row["motion"] == IDLE
        assert row["motion"] != WAITING or queued
    assert all(state.entry[e]["refs"] == count for e, count in used.items())
    free = int(state.board[0]["free"])
    pool = state.free[:free]
    assert free + len(used) == len(state.free)
    assert len(set(pool.tolist())) == free
    assert not set(used) & set(pool.tolist())
    for numbers in (rig.board.kernel.setpoint, rig.board.kernel.base, rig.board.kernel.servo.actual):
        assert np.isfinite(numbers).all()


def session(seed: int, steps: int, *, loops: bool = True) -> Rig:
    """Give random commands with scans in between, checking after each."""
    random = np.random.default_rng(seed)
    rig = Rig(SYSTEM, keep=0)
    for _ in range(steps):
        source = LOOPS if loops and random.random() < 0.05 else STEPS
        source[int(random.integers(len(source)))](rig, random)
        rig.board.advance(int(random.integers(0, 80)))
        consistent(rig)
        closed = [i for i in rig.all if not rig.bits(i) & Axst.cl]
        if closed and random.random() < 0.5:
            cl(rig.board, closed)
    return rig


@pytest.mark.parametrize("seed", often(range(40), 12))
def test_random_commands_leave_the_board_consistent(seed: int) -> None:
    rig = session(seed, 120)
    js(rig.board, rig.all)
    rig.board.set_input(1, True)
    for axis in rig.board.axes:
        axis.sdec = 1000.0
    js(rig.board, rig.all)
    rig.board.advance(3000)
    consistent(rig)
    assert all(rig.bits(i) & Axst.pe for i in rig.all)
    assert rig.free_entries() == len(rig.board.state.free)  # nothing leaks


@pytest.mark.parametrize("seed", range(15))
def test_the_setpoint_of_a_jog_only_steps_where_a_stop_without_ramp_lets_it(seed: int) -> None:
    random = np.random.default_rng(seed)
    rig = Rig()
    highest = 0.0
    for axis in rig.board.axes:
        axis.sdec = 1500.0
    for _ in range(60):
        a = int(random.integers(3))
        axis = rig.board.axes[a]
        axis.jvl = float(random.uniform(5, 100))
        axis.jac = float(random.uniform(200, 2000))
        axis.jac = -float(random.uniform(200, 2000))
        # Far enough to brake from whatever it does; the numbers that are legal for jogs.
        jr(rig.board, (a,), (float(random.choice([-1.0, 1.0]) * random.uniform(60, 200)),))
        if random.random() < 0.2:
            js(rig.board, (a,))
        if random.random() < 0.3:
            axis.jovr = float(random.uniform(0.3, 1.5))
        rig.board.advance(int(random.integers(1, 400)))
        highest = max(highest, 1500.0, 1.5 * axis.jac, 1.5 * axis.jdec)  # with the highest override
    for a in rig.all:
        steps = np.abs(np.diff(rig.setpoints(a), 2)) / SCAN_S**2
        assert steps.max() <= highest * 1.001


def digest(rig: Rig) -> list[list[float]]:
    """Return numbers in which any difference of two sessions shows."""
    kernel, row = rig.board.kernel, rig.board.state.axis
    numbers = (kernel.setpoint, kernel.servo.actual, kernel.velocity, row["place"], row["tovr"], row["pe"])
    return [each.tolist() for each in numbers]


SCRIPT = """
import json, sys
sys.path.insert(0, sys.argv[1])
from property_session import digest, session
rig = session(int(sys.argv[2]), 25)
print(json.dumps(digest(rig)))
"""


@pytest.mark.parametrize("seed", [3, 11])
def test_compiled_equals_uncompiled(seed: int, tmp_path: Path) -> None:
    rig = session(seed, 25)
    (tmp_path / "property_session.py").write_text(
        Path(__file__).read_text(encoding="utf-8"), encoding="utf-8"
    )
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(tmp_path), str(seed)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert json.loads(done.stdout) == digest(rig)
