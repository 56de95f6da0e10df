"""Public NC programs of CAM systems are prepared without an error, both ways alike."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.dialect._arc_settings import Arcs
from support.programs import LINEAR, channel_state, machine_config, prepare, queue_bytes

CONFIG = machine_config(LINEAR)
NAMES = (
    *("arc-ijk", "arc-xz-plane", "arc-yz-plane", "circle", "circle-inch"),
    *("helical-thread-milling", "jsdc", pytest.param("tball-pocket", marks=pytest.mark.long)),
)


@pytest.mark.parametrize("name", NAMES)
def test_a_public_program(name: str, data_nc: Path) -> None:
    text = ProgramText.from_path(data_nc / f"{name}.gcode")
    fast, ordinary = (
        prepare(text, config=CONFIG, segments=1 << 16, ordinary_blocks=blocks) for blocks in (0, math.inf)
    )
    assert fast.error is None
    assert ordinary.error is None
    assert fast.blocks == ordinary.blocks > 0
    assert queue_bytes(fast) == queue_bytes(ordinary)
    assert channel_state(fast) == channel_state(ordinary)


@pytest.mark.parametrize("name", ["arc-ijk", "arc-xz-plane", "arc-yz-plane", "circle", "circle-inch", "jsdc"])
def test_a_public_program_for_grbl_is_the_same_motion_there(name: str, data_nc: Path) -> None:
    text = ProgramText.from_path(data_nc / f"{name}.gcode")
    grbl = prepare(text, config=CONFIG, dialect="grbl", segments=1 << 14)
    assert grbl.error is None
    assert grbl.state.modal.position.tolist() == prepare(text, config=CONFIG).state.modal.position.tolist()


def test_the_engraving_with_an_arc_without_a_centre_is_refused_there(data_nc: Path) -> None:
    """Its line 11 is `N55 X.75` with G2 in force: its author left out a G1."""
    text = ProgramText.from_path(data_nc / "full-circle-without-xyz.gcode")
    channel = prepare(text, config=CONFIG)
    assert channel.error is not None
    assert channel.error.position is not None
    assert channel.error.position.line == 11
    straight = load_dialect("din").model_copy(update={"arcs": Arcs(no_center="line")})
    channel = prepare(text, config=CONFIG, dialect=straight)
    assert channel.error is None
    assert channel.blocks == 18
    assert [(message.line, message.count) for message in channel.messages.all()] == [(11, 2)]
    assert channel.state.modal.position.tolist() == [-4.75, -3.4, 0.2]


def test_plain_cam_programs_are_worth_no_message(data_nc: Path) -> None:
    for name in ("circle", "circle-inch", "jsdc", "tball-pocket"):
        channel = prepare(ProgramText.from_path(data_nc / f"{name}.gcode"), config=CONFIG, segments=1 << 16)
        assert channel.messages.all() == [], name
