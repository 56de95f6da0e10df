"""Machine, board and card as devices: the same verbs, frozen status, snapshots that are whole and fit nowhere else."""

from __future__ import annotations

import dataclasses
import hashlib
import zlib
from collections.abc import Callable
from datetime import datetime
from typing import Any

import numpy as np
import pytest

from polycnc.controllers.apci import Board, BoardTasks, parse_system_file
from polycnc.controllers.apci.board._axis_commands import cl
from polycnc.controllers.apci.board._jog_commands import ja, jhi, jhl, jr
from polycnc.controllers.apci.board._move_commands import Speeds, mca3d, mha, mlr
from polycnc.controllers.apci.sap import compile_program
from polycnc.controllers.imc import Card, CardConfig
from polycnc.machine import Clock, Device, Machine, Snapshot, SnapshotError, load_machine

SAP = """program counting;
var n: longint; level: double;
begin
  n := 0; level := 0.5;
  while n < 2000000 do begin n := n + 1; level := level + 0.25; ci[7] := n end
end.
"""


def machine() -> Machine:
    return Machine(load_machine("mill3"), segments=64)


def moving_machine() -> Machine:
    made = machine()
    made.move("Y", 31.7, speed=9.0)
    made.io["O3"] = 1
    made.clock.set_now(datetime(2031, 5, 17, 13, 7, 11))
    return made


def board(axes: int = 3) -> Board:
    return Board(parse_system_file(f"number_of_axes = {axes}"))


def moving_board() -> Board:
    made = board()
    cl(made, (0, 1, 2))
    made.advance(3)
    for axis in made.axes:
        axis.jac, axis.jvl = 400.0, 70.0
    made.axes[2].zero_offsets[3] = 4.75
    made.axes[1].varint[17] = -5
    made.variables.trvl = 12.5
    made.variables.buffers[2][11] = 0xA7
    made.variables.interface.report_to_hardware(0xFFFF)
    made.sysvardbl[600] = 2.25
    ja(made, (0,), (17.3,))
    return made


def board_with_tasks() -> Board:
    made = moving_board()
    tasks = BoardTasks(made)
    tasks.load(compile_program(SAP, task=2))
    tasks.startcnct(2)
    return made


def card() -> Card:
    return Card(CardConfig(number_of_axes=3, ready=True))


def moving_card() -> Card:
    made = card()
    made.write("mcstgpos", 8_765, 1)
    made.write("mcsgo", -1, 1)
    made.write("gout1", 0x1234)
    return made


MAKERS: dict[str, tuple[Callable[[], Any], Callable[[], Any]]] = {
    "machine": (machine, moving_machine),
    "board": (board, moving_board),
    "card": (card, moving_card),
}
all_kinds = pytest.mark.parametrize("kind", MAKERS)


@all_kinds
def test_the_verbs_are_the_same(kind: str) -> None:
    device: Device[Any] = MAKERS[kind][1]()
    begun = device.clock.cycles
    assert isinstance(device.clock, Clock)
    assert device.advance(41) == 41
    assert device.advance(0) == 0
    assert device.clock.cycles == begun + 41
    status = device.status()
    assert (status.cycle, status.time_s) == (begun + 41, device.clock.now_s)
    with pytest.raises(dataclasses.FrozenInstanceError):
        status.cycle = 5
    device.advance(30)
    assert status.cycle == begun + 41
    assert device.status() != status


def test_what_a_status_says_of_a_machine() -> None:
    made = moving_machine()
    made.advance(150)
    status = made.status()
    y = status.axes["Y"]
    assert (y.setpoint, y.actual) == (made.setpoints["Y"], made.actual["Y"])
    assert 0.0 < y.setpoint < 31.7
    assert y.velocity == pytest.approx(9.0)
    assert (status.outputs[3], sum(status.outputs), sum(status.inputs)) == (1, 1, 0)
    assert status.now == datetime(2031, 5, 17, 13, 7, 11, 150_000)
    with pytest.raises(TypeError):
        status.axes["Y"] = y  # type: ignore[index]


def test_what_a_status_says_of_a_board() -> None:
    made = moving_board()
    made.set_input(5, True)
    made.advance(150)
    status = made.status()
    assert (status.axes[0].rp, status.axes[0].axst) == (made.axes[0].rp, made.axes[0].axst)
    assert status.axes[0].dp > 1.0
    assert status.axes[0].dv == pytest.approx(70.0)
    assert status.inputs == 1 << 4


def test_what_a_status_says_of_a_card() -> None:
    made = moving_card()
    made.set_input(18, True)
    made.advance(60)
    status = made.status()
    assert status.axes[1].command == made.read("curpos", 1) > 100
    assert [axis.is_moving for axis in status.axes] == [False, True, False]
    assert (status.outputs, status.inputs) == (0x1234, 0xFFFFFFFF & ~(1 << 17))


# --- snapshots


@all_kinds
def test_the_same_way_from_a_snapshot_is_the_same_to_the_last_bit(kind: str) -> None:
    device = MAKERS[kind][1]()
    device.advance(37)
    saved = device.snapshot()
    assert saved == device.snapshot()
    device.advance(83)
    there = device.snapshot()
    assert there != saved
    device.restore(saved)
    assert device.snapshot() == saved
    device.advance(83)
    assert device.snapshot() == there
    assert hash(device.snapshot()) == hash(there)


@all_kinds
def test_a_snapshot_goes_through_a_file_into_a_device_that_was_made_alike(kind: str) -> None:
    make, move = MAKERS[kind]
    device = move()
    device.advance(37)
    content = device.snapshot().to_bytes()
    assert content == device.snapshot().to_bytes()
    device.advance(83)
    other = make()
    other.restore(Snapshot.from_bytes(content))
    other.advance(83)
    assert other.snapshot() == device.snapshot()
    assert other.clock.now == device.clock.now


@all_kinds
def test_two_devices_made_alike_are_equal_bit_for_bit(kind: str) -> None:
    one, two = MAKERS[kind][1](), MAKERS[kind][1]()
    one.advance(20)
    for _ in range(20):
        two.advance(1)
    assert one.snapshot() == two.snapshot()


@all_kinds
@pytest.mark.parametrize("other", MAKERS)
def test_a_snapshot_of_something_else_is_refused_before_anything_changes(kind: str, other: str) -> None:
    if kind == other:
        others: dict[str, Any] = {
            "machine": Machine(load_machine("lathe2"), segments=64),
            "board": board(4),
            "card": Card(CardConfig(number_of_axes=3, ready=True, fwversion=321)),
        }
        another = others[kind]
    else:
        another = MAKERS[other][1]()
    another.advance(5)
    device = MAKERS[kind][1]()
    before = device.snapshot()
    with pytest.raises(SnapshotError, match=r"this is a snapshot of (a|another) (machine|board|card)\b"):
        device.restore(another.snapshot())
    assert device.snapshot() == before


def test_a_machine_of_another_size_is_another_machine() -> None:
    device = machine()
    with pytest.raises(SnapshotError, match="another machine"):
        device.restore(Machine(load_machine("mill3"), segments=128).snapshot())
    with pytest.raises(SnapshotError, match="another machine"):
        device.restore(Machine(load_machine("mill3"), segments=64, servo=True, record_cycles=5).snapshot())


# --- a board's direct commands and programs


@pytest.mark.parametrize(
    "command",
    [
        lambda b: jr(b, (1,), (-2.75,)),
        lambda b: jhi(b, (2,), (3.5,)),
        lambda b: jhl(b, (1, 2)),
        lambda b: mlr(b, (1, 2), (1.5, np.float64(-2.5)), Speeds(50.0, 20.0, 1.0)),
        lambda b: mha(b, (1, 2), (3.0, 4.5), 77.0, (6.0, 7.0), Speeds(50.0, 20.0)),
        lambda b: mca3d(b, (0, 1, 2), (3.0, 4.5, 2.0), (0.3, 0.4, 0.5), 77.0, Speeds(50.0, 20.0)),
    ],
    ids=["jr", "jhi", "jhl", "mlr", "mha", "mca3d"],
)
def test_a_command_on_its_way_is_in_the_snapshot(command: Callable[[Board], None]) -> None:
    device = moving_board()
    device.advance(5)
    for axis in device.axes:
        axis.hac, axis.hvl = 300.0, 21.0
    device.variables.pu = 0
    command(device)
    assert device.pending
    device.advance(1)
    content = device.snapshot().to_bytes()
    device.advance(60)
    other = board()
    other.restore(Snapshot.from_bytes(content))
    assert other.snapshot().to_bytes() == content
    other.advance(60)
    assert other.snapshot() == device.snapshot()
    assert any(each.row["motion"] for each in device.axes[1:])


def test_a_running_program_is_in_the_snapshot() -> None:
    device = board_with_tasks()
    device.advance(11)
    content = device.snapshot().to_bytes()
    at = int(device.state.ci[7])
    assert at > 5
    device.advance(13)
    assert device.state.ci[7] > at
    other = board()
    BoardTasks(other)
    other.restore(Snapshot.from_bytes(content))
    other.advance(13)
    assert other.state.ci[7] == device.state.ci[7]
    assert other.snapshot() == device.snapshot()


def test_a_board_without_tasks_refuses_programs() -> None:
    device = board()
    before = device.snapshot()
    with pytest.raises(SnapshotError, match="another board"):
        device.restore(board_with_tasks().snapshot())
    assert device.snapshot() == before


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"name":"jog"', '"name":"exec"'),
        ('"zero_offsets"', '"offsets"'),
        ('"planned":"', '"planned":"]'),
        ('"epoch":"2000', '"epoch":"20OO'),
        ('"orders":[', '"orders":["x",'),
        ('"$bytes":"', '"$bytes":"?'),
        (
            "{",
            "",
        ),
    ],
)
def test_a_forged_state_is_refused_before_anything_changes(old: str, new: str) -> None:
    device = moving_board()
    saved = device.snapshot()
    assert old in saved.beside
    forged = dataclasses.replace(saved, beside=saved.beside.replace(old, new, 1))
    before = device.snapshot()
    with pytest.raises(SnapshotError, match="the snapshot of a board is damaged"):
        device.restore(forged)
    assert device.snapshot() == before


# --- files


def test_damaged_files_are_refused() -> None:
    content = moving_machine().snapshot().to_bytes()
    middle = len(content) // 2
    for broken in (
        content[:-1],
        content[:middle],
        content[:30],
        content + b"\0",
        content[:middle] + bytes([content[middle] ^ 0x10]) + content[middle + 1 :],
        content[:25] + bytes([content[25] ^ 0x01]) + content[26:],
    ):
        with pytest.raises(SnapshotError, match="the snapshot is damaged"):
            Snapshot.from_bytes(broken)
    for foreign in (b"", b"polycnc", b"\x7fELF" + content):
        with pytest.raises(SnapshotError, match="this is not a snapshot"):
            Snapshot.from_bytes(foreign)


def test_a_newer_file_says_so() -> None:
    content = bytearray(moving_machine().snapshot().to_bytes())
    content[len(b"polycnc snapshot\n")] = 9
    with pytest.raises(SnapshotError, match="has version 9, and this polycnc knows version 2"):
        Snapshot.from_bytes(bytes(content))


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"\xff" * 8,
        b"\x02" + b"\0" * 7 + b"{}",
        b"\x01" + b"\0" * 7 + b"7",
        b"\xe8\x03" + b"\0" * 6 + b"[" * 1000,
    ],
)
def test_a_file_with_the_right_check_sum_and_nothing_in_it_is_damaged(body: bytes) -> None:
    packed = zlib.compress(body)
    head = b"\x02\0\0\0" + hashlib.sha256(packed).digest() + len(packed).to_bytes(8, "little")
    with pytest.raises(SnapshotError, match="the snapshot is damaged"):
        Snapshot.from_bytes(b"polycnc snapshot\n" + head + packed)


def test_what_stands_beside_the_arrays_comes_back_as_it_was() -> None:
    beside = {
        "text": "Öl",
        "bytes": bytes(range(256)),
        "numbers": [0.1, -0.0, 1e-310, float("inf"), 2**70, True, None, np.float64(1 / 3), np.int32(-7)],
        "array": np.array([[1.5, -2.5, 3.25]], np.float32),
    }
    data = Snapshot.take("a thing", "x", 5, (), beside).data()
    assert data["numbers"] == [0.1, -0.0, 1e-310, float("inf"), 2**70, True, None, 1 / 3, -7]
    assert np.copysign(1.0, data["numbers"][1]) == -1.0
    assert (data["text"], data["bytes"]) == ("Öl", bytes(range(256)))
    assert (data["array"].dtype, data["array"].tolist()) == (np.float32, [[1.5, -2.5, 3.25]])
    with pytest.raises(TypeError, match="a snapshot cannot hold a Clock"):
        Snapshot.take("a thing", "x", 5, (), {"clock": Clock(0.001)})
