"""Rows of G codes: each is carried out by something, and takes the words that its row names."""

from __future__ import annotations

import contextlib
import string
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from polycnc.errors import ProgramError
from polycnc.machine import Machine, load_machine
from polycnc.nc import DIALECTS, Channel, ProgramText, load_dialect
from polycnc.nc.blocks import _codes, _interpreter
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._codes import CODES, MOTION_MODES
from polycnc.nc.modal._actions import Action, Group
from polycnc.nc.text._scan_plain import scan_block

BY_STEPS = {  # of their own: other words ask for them too, or they only change how the block is read
    Group.CYCLE_CANCEL, Group.EXACT_STOP_BLOCK, Group.IGNORED, Group.LENGTH_COMPENSATION, Group.MOTION,
    Group.RADIUS_COMPENSATION, Group.SPINDLE_MODE,
}  # fmt: skip
ALWAYS = set("NODFHMST")  # any block may have them
MACHINES = {"fanuc-lathe": "lathe2", "fanuc-lathe-b": "lathe2", "linuxcnc": "vmc3"}


def test_every_code_is_carried_out_by_one_function() -> None:
    assert {action.group for action in Action if action not in CODES} == BY_STEPS
    assert not {action.group for action in CODES} & BY_STEPS
    marked = [
        action
        for module in vars(_codes).values()
        for function in getattr(module, "__dict__", {}).values()
        for action in getattr(function, "_carries_out", ())
        if getattr(function, "__module__", "") == getattr(module, "__name__", None)
    ]
    assert sorted(marked) == sorted(CODES)


def test_every_motion_has_a_mode() -> None:
    assert {action.family for action in Action if action.group is Group.MOTION} == set(MOTION_MODES)


def test_every_row_has_a_sentence_without_its_full_stop() -> None:
    assert all(action.sentence and action.sentence[-1] not in ".:;," for action in Action)
    assert all(action.sentence[0].isupper() or action.sentence[0].isdigit() for action in Action)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[BlockContext]:
    """Return the blocks that are executed from now on."""
    found: list[BlockContext] = []

    class Kept(BlockContext):
        def __init__(self, *args: Any) -> None:
            super().__init__(*args)
            found.append(self)

    monkeypatch.setattr(_interpreter, "BlockContext", Kept)
    return found


class Taker:
    """Execute blocks in a dialect, each from the same state, and say which words were taken."""

    def __init__(self, name: str, made: list[BlockContext]) -> None:
        self.dialect = load_dialect(name)
        begin = ProgramText.from_text("F100 S500 M3\nG0 X1 Z1\n")
        self.channel = Channel(begin, self.dialect, Machine(load_machine(MACHINES.get(name, "mill3"))))
        self.channel.fill()
        self.before = self.channel.state.copy()
        self.made = made
        lines = ("G1 X4. Z3.\n", "G1 X6. Z1.\n")  # of a sub-program whose profile is cut
        rules = self.dialect.text
        self.profile = tuple(scan_block(ProgramText.from_text(line), 0, 1, rules) for line in lines)
        self.axes = set(self.before.axis_names) | set(self.dialect.incremental)

    def taken(self, line: str) -> set[str]:
        """Return the addresses that a block takes, refused or not."""
        text = ProgramText.from_text(line)
        with contextlib.suppress(ProgramError):
            block = scan_block(text, 0, 1, self.dialect.text)
            self.channel.interpreter.execute(text, replace(block, profile=self.profile))
        self.channel.state.take(self.before)
        return self.made[-1].words.used & self.made[-1].words.by_letter.keys()

    def own(self, action: Action) -> set[str]:
        """Return the addresses that the row of a code names."""
        named = {"axes": self.axes, "time": set(self.dialect.dwell)}
        return set().union(*(named.get(each, {each}) for each in action.takes))

    def codes(self) -> Iterator[tuple[str, Action]]:
        """Yield the codes that do something with their words; without a motion axis words are refused."""
        for number, action in self.dialect.g_codes().items():
            if action.group is not Group.IGNORED and action is not Action.MOTION_OFF:
                yield f"G{number:g}", action


@pytest.mark.parametrize("name", DIALECTS)
def test_a_code_takes_no_words_but_those_of_its_row(name: str, made: list[BlockContext]) -> None:
    taker = Taker(name, made)
    for code, action in taker.codes():
        moves = action.group not in (Group.NON_MODAL, Group.MOTION, Group.DWELL)  # beside the motion in force
        allowed = taker.own(action) | (taker.axes if moves else set())
        for letter in sorted(set(string.ascii_uppercase) - {"G"} - ALWAYS):
            assert taker.taken(f"{code} {letter}2.") <= allowed, f"{code} ({action.title}) takes {letter}"


def test_a_row_names_no_words_that_its_code_never_takes(made: list[BlockContext]) -> None:
    never: dict[Action, set[str]] = {}
    for name in DIALECTS:
        taker = Taker(name, made)
        for code, action in taker.codes():
            own = sorted(taker.own(action))
            blocks = [code + "".join(f" {each}2." for each in own if each != other) for other in ("", *own)]
            beside = (
                " X2. Y3.", " I5.", " L10 P2", " L1 P1", " P2", " P2 Q2", " G18 Z-19. P2. I-1. J1. K3.",
                " G18 X2. Z5. Q1.",
            )  # fmt: skip
            blocks += [f"{code}{some} {each}2." for some in beside for each in own if each not in some]
            contour = "\nN2 G1 X2. Z2.\n"
            found = set().union(*(taker.taken(block + contour) for block in blocks))
            letters = {each for each in action.takes if len(each) == 1}
            never[action] = (never.get(action, letters)) - found
    assert {action.title: words for action, words in never.items() if words} == {}
