"""The parts of a channel, alone and together: what is prepared does not depend on the portions that are asked for."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from polycnc.errors import ProgramError
from polycnc.machine import Machine
from polycnc.nc import Channel, ChannelOptions, ProgramText, load_dialect
from polycnc.nc.blocks._messages import Messages
from polycnc.nc.channel._errors import Errors
from polycnc.nc.channel._reader import Reader
from polycnc.nc.channel._running import Running
from polycnc.nc.channel._sub_programs import SubPrograms
from polycnc.nc.sources._block_source import EndSource
from polycnc.nc.text._place import Place
from polycnc.nc.text._scan import PERCENT, scan_rules
from polycnc.nc.text._scan_plain import Block, scan_block
from support.block_strategies import programs
from support.often import share
from support.programs import FIVE, channel_state, queue_bytes

FANUC = load_dialect("fanuc")
CALLS = "M98 P{} L{}\n{}M30\nO{}\nG91 G1 X-.37 F210\nY2.3\nM99\n"
portions = st.lists(st.tuples(st.integers(1, 7), st.booleans()), min_size=1, max_size=9)
with_calls = st.builds(
    lambda program, number, repeats: CALLS.format(number, repeats, program, number),
    programs,
    st.integers(2, 9998),
    st.integers(0, 5),
)


def channel_of(program: str, ordinary_blocks: float) -> Channel:
    options = ChannelOptions(collect_errors=True, ordinary_blocks=ordinary_blocks)
    return Channel(
        ProgramText.from_text(program, "t.nc"), FANUC, Machine(FIVE, segments=4096), options=options
    )


def fill(channel: Channel, blocks: int | None = None, *, compiled: bool = True) -> None:
    """Prepare blocks, with the next cycle where this one has had enough."""
    if channel.paused:
        channel.machine.clock.tick(1)
    channel.fill(blocks, compiled=compiled)


@settings(max_examples=share(60))
@given(st.one_of(programs, with_calls), portions, st.sampled_from([0, 3, 1000]))
def test_the_portions_in_which_blocks_are_prepared_do_not_matter(
    program: str, sizes: list[tuple[int, bool]], ordinary_blocks: int
) -> None:
    whole, cut = (channel_of(program, ordinary_blocks) for _ in range(2))
    fill(whole)
    while whole.paused:
        fill(whole)
    rounds = 0
    while not cut.done:
        size, compiled = sizes[rounds % len(sizes)]
        before = cut.blocks
        fill(cut, size, compiled=compiled)
        assert cut.blocks <= before + size
        rounds += 1
        assert rounds < 10_000
    assert whole.done
    assert queue_bytes(cut) == queue_bytes(whole)
    assert channel_state(cut) == channel_state(whole)
    assert (cut.blocks, list(map(str, cut.errors))) == (whole.blocks, list(map(str, whole.errors)))


def reader_of(text: ProgramText) -> Reader:
    rules = FANUC.text
    return Reader(text, rules, scan_rules(rules), frozenset({3}))


def said(read: Callable[[], Block | EndSource | None]) -> object:
    """Return a block, or why it is none; None for nothing that is to be executed."""
    try:
        block = read()
    except ProgramError as error:
        return str(error)
    return block if isinstance(block, Block) else None


@settings(max_examples=share(60))
@given(programs, st.data())
def test_a_reader_gives_the_blocks_of_a_text_from_any_line_on(program: str, data: st.DataObject) -> None:
    text = ProgramText.from_text(program, "t.nc")
    line = data.draw(st.integers(1, program.count("\n")))
    reader, running = reader_of(text), Running(Place(text))
    reader.jump(Place(text, text.line_start(line), line), len(text))
    found = []
    while not reader.at_end or reader.more():
        found.append(said(lambda: reader.take(running)))
    expected: list[object] = []
    begun = False
    for number in range(line, program.count("\n") + 1):
        block = said(partial(scan_block, text, text.line_start(number), number, FANUC.text))
        if not isinstance(block, Block):
            expected.append(block)
        elif not block.is_blank:
            ends = bool(block.flags & PERCENT or (begun and block.words and block.words[0].letter == "O"))
            executed = block.skip_level != 3 and not ends
            expected.append(block if executed else None)
            begun = begun or (executed and bool(block.words))
    assert [_key(each) for each in found] == [_key(each) for each in expected]


def _key(found: object) -> object:
    return (found.words, found.line, found.flags) if isinstance(found, Block) else found


def test_a_percent_sign_or_another_number_ends_a_program_that_has_begun_and_no_other() -> None:
    for end in ("%", "O12"):
        text = ProgramText.from_text(f"%\nO11\n/3 X7\nG1 X4 F130\n{end}\nX9\n", "t.nc")
        reader, running, found = reader_of(text), Running(Place(text)), []
        while not reader.at_end or reader.more():
            found.append(reader.take(running))
        kinds = [each if each is None or each is EndSource.RETURN else "block" for each in found]
        assert kinds == [None, "block", None, "block", EndSource.RETURN, "block"]
        assert reader.blocks == 4


def test_sub_programs_are_looked_for_here_then_in_the_main_program_the_library_and_beside_it(
    tmp_path: Path,
) -> None:
    for number in (31, 32, 33, 34):
        (tmp_path / f"O00{number}.nc").write_text(f"O{number} (file)\n")
    (tmp_path / "main.nc").write_text("M30\nO31\nM99\nO32\nM99\n")
    main = ProgramText.from_path(tmp_path / "main.nc")
    here = ProgramText.from_text("X1\nO31\nM99\n", "here")
    lent = {31: "lent 31", 32: "lent 32", 33: "lent 33"}
    found = SubPrograms(
        main, FANUC, lambda number: ProgramText.from_text("M99\n", lent[number]) if number in lent else None
    )
    names = [place.text.name for number in (31, 32, 33, 34) if (place := found.find(number, here))]
    assert names == ["here", main.name, "lent 33", str(tmp_path / "O0034.nc")]
    assert found.find(35, here) is None
    again = found.find(33, here)
    assert again is not None
    assert again.text is (found.find(33, main) or again).text


@pytest.mark.parametrize(("collects", "over"), [(True, False), (False, True)])
def test_an_error_is_noted_once_and_ends_preparation_unless_errors_are_collected(
    collects: bool, over: bool
) -> None:
    errors = Errors(Messages(), collects=collects)
    for _ in range(3):
        errors.note(ProgramError("a wrong word", hint="Write another."))
    assert [each.what for each in errors.all] == ["a wrong word"]
    assert errors.over is over
