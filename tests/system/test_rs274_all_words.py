"""Random blocks with all words of the dialect `linuxcnc` beside LinuxCNC's `rs274`: the same steps, the same refusals.

What the two do differently on purpose stands in `KNOWN`, in `docs/reference/linuxcnc-language.md`, and in what the
generator leaves out.
"""

from __future__ import annotations

import math
import re
from itertools import zip_longest
from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.kernel import give_to_path
from polycnc.machine import Machine, MachineConfig, parse_toml, validate
from polycnc.nc import Channel, ProgramText, language_for, load_dialect
from support import rs274
from support.canonical import Feed, Function, Step, Traverse, Turn, first_difference, queued_steps
from support.random_all_words import FRESH, RESET, AllWords, tagged

pytestmark = pytest.mark.skipif(rs274.COMMAND is None, reason="rs274 (LinuxCNC) is not installed")

TOLERANCE_MM = 8e-3  # four decimals of each shift and each inch
COMPENSATED_MM = 0.13  # LinuxCNC leaves corners of less than 0.05 rad open
LEAST_MM = 2.5e-3
TOOLS = (
    "[programs]\nparameters_inch = true\n[tools]\n1 = {length_mm = 10.0, radius_mm = 3.0}\n"
    "2 = {x_mm = 1.0, length_mm = 20.0, radius_mm = 4.0}\n"
    "3 = {x_mm = 2.0, length_mm = 30.0, radius_mm = 2.0, tip = 2}\n"
)
TABLE = "T1 P1 Z10 D6\nT2 P2 X1 Z20 D8\nT3 P3 X2 Z30 D4 Q3\n"
KNOWN = (
    "with the spindle at rest",  # LinuxCNC waits for ever
    "run backwards",  # compensation: LinuxCNC may go on
    "has no place for the tool",  # compensation begins with an arc: the same
    "G92.1 while radius",
    "G92.2 while radius",
    "G92.3 while radius",
    "a turning cycle while radius",  # LinuxCNC takes G33 and G33.1 there
    "a polar position outside",  # LinuxCNC: of X and Y all the same
    "an arc outside the plane that",  # LinuxCNC: as if nothing were turned
    "in turned coordinates",  # G76: the same
    "the tapers are longer",  # LinuxCNC: they overlap
    "starts again before its lead-out",
    "moves along Z, not",  # G76: LinuxCNC goes there at its end
)
"""Refusals of polycnc that LinuxCNC does not have."""
KNOWN_OF_RS274 = ("entry arc", "read current position")
"""Refusals that polycnc does not have: a whole circle as a lead-in, #5420 in compensation."""
_IGNORED = re.compile(r"M(6 |61|19|4[89]|5[0123]|7[0123])")
_IN_STEP = re.compile(r"M6[237] ")
_CYCLES = re.compile(r"G(7[34]|8[1-9])")
_OUTPUT = re.compile(r"(M6[78]) (?:E(\S+) Q(\S+)|Q(\S+) E(\S+))")


def _config() -> MachineConfig:
    axes = "".join(f'[[axis]]\nname = "{name}"\nvmax_mm_s = 5000\namax_mm_s2 = 20000\n' for name in "XYZ")
    axes += "".join(
        f'[[axis]]\nname = "{name}"\nkind = "rotary"\nvmax_deg_s = 90\namax_deg_s2 = 900\n' for name in "ABC"
    )
    return validate(MachineConfig, *parse_toml(f'name = "endless"\n{axes}{TOOLS}', "endless.toml"))


CONFIG = _config()
DIALECT = load_dialect("linuxcnc")


def prepare(blocks: list[str]) -> tuple[list[Step], ProgramError | None]:
    """Return what polycnc queues for the blocks of a sequence, and what it refuses."""
    machine = Machine(CONFIG, segments=1 << 9)
    text = ProgramText.from_text("\n".join((*FRESH, *blocks)))
    channel = Channel(text, DIALECT, machine, language=language_for(DIALECT))
    give_to_path(machine.state, channel.path)
    channel.fill()
    while not channel.done:
        machine.clock.tick(1)  # more is prepared with the next cycle
        channel.fill()
    steps = queued_steps(machine, channel)
    first = next(index for index, step in enumerate(steps) if isinstance(step, Traverse))
    return steps[first:], channel.error


def comparable(steps: list[Step]) -> list[Step]:
    """Return steps as both can have them: functions between two moves in one order, without those that rs274 hides."""
    found: list[Step] = []
    functions: list[Function] = []
    for step, after in zip_longest(steps, steps[1:]):
        if not isinstance(step, Function):
            found += [*sorted(functions, key=lambda each: each.word), step]
            functions.clear()
        elif not (step.word == "M5" and isinstance(after, Function) and after.word.startswith("M6 ")):
            word = "M0" if step.word == "M60" else step.word
            if output := _OUTPUT.fullmatch(word):
                number, value = output[2] or output[5], float(output[3] or output[4])
                word = f"{output[1]} E{number} Q{value:g}"
            if not _IGNORED.match(word):
                functions.append(Function(word))
    return [*found, *sorted(functions, key=lambda each: each.word)]


def with_motions(steps: list[Step]) -> list[Step]:
    """Return steps with outputs in step at the motion that they come with; without one they do nothing."""
    found: list[Step] = []
    waiting: list[Step] = []
    for step in steps:
        if isinstance(step, Function) and _IN_STEP.match(step.word):
            waiting.append(step)
            continue
        if isinstance(step, Traverse | Feed | Turn):
            found += waiting
            waiting = []
        found.append(step)
    return found


def ways_joined(steps: list[Step]) -> list[Step]:
    """Return steps with each series of rapid moves as one: rs274 goes aslant to holes between which R changes."""
    return [
        step
        for step, after in zip_longest(steps, steps[1:])
        if not (isinstance(step, Traverse) and isinstance(after, Traverse))
    ]


def difference(blocks: list[str], number: int, theirs: rs274.Sequences) -> str:
    """Return how a sequence differs between the two; '' if it does not, or in a known way."""
    own = blocks[len(RESET) :]
    ours, error = prepare(own)
    if error is not None and any(known in error.what for known in KNOWN):
        return ""
    place = None
    if error is not None:
        assert error.position is not None
        place = error.position.line - 1 - len(FRESH) + len(RESET)
    at, message = theirs.refused.get(number, (None, ""))
    if any(known in message for known in KNOWN_OF_RS274):
        return ""
    if place != at:
        return f"refused\n  ours   {place}: {error}\n  theirs {at}: {message}"
    steps = [
        step
        for block in range(len(RESET) - 1, len(blocks) if at is None else at)
        for step in theirs.steps.get((number, block), [])
    ]
    steps = with_motions(steps)
    compensated = any("G41" in block or "G42" in block for block in own)
    if compensated and error is not None:
        steps = steps[: len(ours)]  # rs274 has made the last move before a refusal already
    tolerance = COMPENSATED_MM if compensated else TOLERANCE_MM
    here, there = comparable(ours), comparable(steps)
    found = first_difference(here, there, tolerance)
    if found and any(_CYCLES.search(block) for block in own):
        found = first_difference(ways_joined(here), ways_joined(there), tolerance)
    text = "\n".join(own)
    if found and "G96" in text and "G95" in text:
        return ""  # the speed of constant surface speed is not printed
    if found and _CYCLES.search(text) and re.search(r"G4 P\S+ [@^]", text):
        return ""  # rs274 takes P of G4 for that of the cycle, too
    return found


def differing(first: int, count: int, folder: Path) -> list[str]:
    """Compare `count` sequences from the seed `first`; return those that differ, with how."""
    sequences = [AllWords(first + number).sequence() for number in range(count)]
    theirs = rs274.interpret_tagged(tagged(sequences), folder, 6, TABLE, LEAST_MM)
    found = []
    for number, blocks in enumerate(sequences):
        if what := difference(blocks, number, theirs):
            text = "\n".join(f"{place} {block}" for place, block in enumerate(blocks))
            found.append(f"seed {first + number}: {what}\n{text}")
    return found


def test_random_words_of_all_kinds_ask_for_the_same(tmp_path: Path) -> None:
    found = differing(0, 200, tmp_path)
    assert not found, f"{len(found)} of 200\n" + "\n\n".join(found[:2])


@pytest.mark.long
@pytest.mark.parametrize("first", range(10_000, 15_000, 500))
def test_many_random_words_of_all_kinds_ask_for_the_same(first: int, tmp_path: Path) -> None:
    found = [text for start in (first, first + 250) for text in differing(start, 250, tmp_path)]
    assert not found, f"{len(found)} of 500\n" + "\n\n".join(found)


def test_the_random_words_say_enough() -> None:
    """The comparison is only worth what it holds: words of all kinds, most of them taken."""
    texts = [AllWords(seed).sequence()[len(RESET) :] for seed in range(300)]
    together = "\n".join(block for blocks in texts for block in blocks)
    codes = "0 1 2 3 4 7 8 10 17 18 19 20 21 28 30 33 33.1 40 41 41.1 42 42.1 43 43.1 43.2 49 52 53 55 59.1 59.3 61"
    codes += " 61.1 73 76 80 81 82 83 84 85 86 89 90 90.1 91 91.1 92 92.1 92.2 92.3 93 94 95 96 97 98 99"
    missing = [code for code in codes.split() if not re.search(rf"\bG{re.escape(code)}\b", together)]
    assert not missing
    assert math.isclose(len(together.splitlines()) / 300, 8.5, rel_tol=0.2)
    steps = [step for blocks in texts[:20] for step in prepare(blocks)[0]]
    assert {type(step) for step in steps} >= {Traverse, Feed, Turn, Function}
