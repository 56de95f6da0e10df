"""Languages inside programs: blocks that come as values, text in between, drains, calls and returns."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from polycnc.errors import ProgramError
from polycnc.nc import (
    Call,
    CallProgram,
    Channel,
    Drain,
    EndSource,
    Group,
    Pause,
    ProgramText,
    SourceItem,
    Statement,
    TextSpan,
    Word,
    WordsBlock,
    load_dialect,
)
from support.runs import program_run, stands, to_the_end

TEXT = "#1=4\nG1 X[#1] F600\nX5 Y1\nX6 Y2\nWAIT\nX[POS+1]\nG65 P7 A3\nX9\n"
MACRO = "O7\nX[#1]\nM99\n"
PROGRAM = ProgramText.from_text(TEXT + MACRO, "lang.nc")

Items = Iterator[SourceItem]


def line_start(line: int) -> int:
    return PROGRAM.line_start(line)


def block(line: int, *words: tuple[str, float]) -> WordsBlock:
    offset = line_start(line)
    return WordsBlock(
        tuple(Word(letter, float(value), offset, True) for letter, value in words), line, offset
    )


def span(first: int, after: int) -> TextSpan:
    return TextSpan(line_start(first), first, line_start(after))


class Source:
    """A source that a generator gives the items of."""

    def __init__(
        self, items: Items, closed: Callable[[], None], failed: Callable[[], None] = lambda: None
    ) -> None:
        self._items = items
        self._closed = closed
        self.failed = failed

    def next(self) -> SourceItem | None:
        return next(self._items, None)

    def leave(self) -> bool:
        return False

    def close(self) -> None:
        self._closed()


class Language:
    """A language whose programs are generators by the line that they begin on."""

    def __init__(self, programs: dict[int, Callable[[object], Items]]) -> None:
        self.programs = programs
        self.closed: list[int] = []
        self.failed: list[int] = []

    def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> Source | None:
        if line not in self.programs:
            return None
        return Source(
            self.programs[line](arguments), lambda: self.closed.append(line), lambda: self.failed.append(line)
        )


def test_words_reach_the_interpreter_as_values_and_records_point_at_the_line() -> None:
    # A third is no number that text could carry: the end point is the very double.
    def main(_: object) -> Items:
        yield block(2, ("G", 1), ("X", 4 + 1 / 3), ("F", 600))
        yield span(3, 5)

    run = program_run(PROGRAM, language=Language({1: main}))
    seen: list[tuple[int, str]] = []
    run.start()
    while run.active:
        run.advance(1)
        record = run.reading.block
        assert record is not None
        if not seen or seen[-1] != (record.line, record.text):
            seen.append((record.line, record.text))
            if record.line == 2:
                assert run.reading.distance_to_go["X"] + run.reading.position["X"] == pytest.approx(
                    4 + 1 / 3, abs=1e-15
                )
    assert seen == [(2, "G1 X[#1] F600"), (3, "X5 Y1"), (4, "X6 Y2")]
    assert run.machine.setpoints == {"X": 6.0, "Y": 2.0, "Z": 0.0}


def test_a_drain_lets_the_source_read_what_has_been_executed() -> None:
    read: list[float] = []

    def main(_: object) -> Items:
        yield block(2, ("G", 1), ("X", 4), ("F", 600))
        read.append(run.reading.position["X"])  # without a drain: prepared ahead
        yield Drain(5)
        read.append(run.reading.position["X"])
        yield block(6, ("X", run.reading.position["X"] + 1.5))

    run = program_run(PROGRAM, language=Language({1: main}))
    run.start()
    to_the_end(run)
    assert read == [0.0, 4.0]
    assert run.machine.setpoints["X"] == 5.5
    assert stands(run) == "COMPLETED"


def test_a_drain_gives_out_what_radius_compensation_holds_back() -> None:
    read: list[float] = []

    def main(_: object) -> Items:
        yield block(2, ("G", 1), ("G", 41), ("D", 1), ("X", 4), ("F", 600))
        yield block(3, ("X", 9))
        yield Drain(5)
        read.append(run.reading.position["X"])
        yield block(6, ("X", 15))
        yield block(8, ("G", 40), ("X", 20))

    run = program_run(PROGRAM, language=Language({1: main}))
    run.start()
    to_the_end(run)
    assert run.error is None
    assert read == [9.0]


def test_a_pause_is_asked_again_while_time_passes() -> None:
    asked: list[int] = []

    def main(_: object) -> Items:
        while len(asked) < 5:
            asked.append(run.machine.clock.cycles)
            yield Pause.PAUSE
        yield block(2, ("G", 1), ("X", 4), ("F", 600))

    run = program_run(PROGRAM, language=Language({1: main}))
    run.start()
    to_the_end(run)
    assert asked[-1] - asked[1] >= 3
    assert run.machine.setpoints["X"] == 4.0


@pytest.mark.parametrize("closed_form", [True, False])
def test_a_pause_does_not_stop_the_clock_in_closed_form(closed_form: bool) -> None:
    def main(_: object) -> Items:
        while run.machine.clock.cycles < 37:
            yield Pause.PAUSE
        yield block(2, ("G", 1), ("X", 4), ("F", 600))

    run = program_run(PROGRAM, language=Language({1: main}))
    run.start()
    while run.active:
        if closed_form:
            run.skip()
        else:
            run.advance(100)
    assert run.machine.setpoints["X"] == 4.0
    assert run.machine.clock.cycles == 37 + 402


def test_calls_hand_arguments_over_and_sources_are_closed_once() -> None:
    def main(_: object) -> Items:
        yield block(2, ("G", 1), ("X", 4), ("F", 600))
        yield CallProgram(7, 7, line_start(7), 2, {"A": 3.25})
        yield block(8, ("X", 9))

    def macro(arguments: object) -> Items:
        assert isinstance(arguments, dict)
        yield block(10, ("X", arguments["A"]))
        yield EndSource.RETURN

    language = Language({1: main, 9: macro})
    run = program_run(PROGRAM, language=language)
    run.step_into()
    to_the_end(run)
    found = []
    while run.state.value != "completed":
        run.step_into()
        to_the_end(run)
        record = run.reading.block
        assert record is not None
        found.append((record.line, record.stack))
    assert found == [
        (10, (Call("lang.nc", 7, 1),)),
        (10, (Call("lang.nc", 7, 2),)),
        (8, ()),
    ]
    assert language.closed == [9, 9, 1]


def test_a_return_in_words_ends_the_macro_and_the_caller_goes_on() -> None:
    def main(_: object) -> Items:
        yield block(7, ("M", 98), ("P", 7))
        yield block(8, ("G", 1), ("X", 9), ("F", 600))

    def macro(_: object) -> Items:
        yield block(10, ("G", 1), ("Y", 2), ("F", 600))
        yield block(11, ("M", 99))
        raise AssertionError("not asked any more")

    run = program_run(PROGRAM, language=Language({1: main, 9: macro}))
    run.start()
    to_the_end(run)
    assert run.machine.setpoints == {"X": 9.0, "Y": 2.0, "Z": 0.0}


def test_a_source_that_calls_by_itself_names_text_and_calls() -> None:
    other = ProgramText.from_text("G91 X2\nM99\n", "other.nc")
    left: list[int] = []

    class Nested(Source):
        def leave(self) -> bool:
            left.append(1)
            return len(left) == 1

    def main(_: object) -> Items:
        calls = (Call("lang.nc", 7),)
        yield block(2, ("G", 1), ("X", 4), ("F", 600))
        yield TextSpan(0, 1, len(other), other, calls)
        yield block(8, ("X", 5))

    class Nesting(Language):
        def source(self, text: ProgramText, offset: int, line: int, arguments: object) -> Source | None:
            return Nested(main(arguments), lambda: self.closed.append(line))

    language = Nesting({})
    run = program_run(PROGRAM, language=language)
    run.start()
    run.advance(
        100_000, until=lambda: run.reading.block is not None and run.reading.block.program == "other.nc"
    )
    record = run.reading.block
    assert record is not None
    assert (record.line, record.text, record.stack) == (1, "G91 X2", (Call("lang.nc", 7),))
    assert record.modal.g[Group.DISTANCE] == "G91"
    to_the_end(run)
    assert run.machine.setpoints["X"] == 11.0
    assert left == [1]
    assert language.closed == [1]


def test_statements_are_stepped_to() -> None:
    def main(_: object) -> Items:
        yield Statement(1)
        yield block(2, ("G", 1), ("X", 4), ("F", 600))
        yield Statement(5)

    run = program_run(PROGRAM, language=Language({1: main}))
    found = []
    while run.state.value != "completed":
        run.step_into()
        to_the_end(run)
        assert run.reading.block is not None
        found.append(run.reading.block.line)
    assert found == [1, 2, 5]


def test_an_error_of_a_source_is_an_error_of_the_program() -> None:
    def main(_: object) -> Items:
        yield block(2, ("G", 1), ("X", 4), ("F", 600))
        raise ProgramError("the axis is not there", position=PROGRAM.line_position(6), hint="Name another.")

    language = Language({1: main})
    run = program_run(PROGRAM, language=language)
    run.start()
    to_the_end(run)
    assert stands(run) == "ALARM"
    assert run.machine.setpoints["X"] == 4.0
    assert str(run.error).splitlines()[0] == "lang.nc:6:1: the axis is not there"
    assert (language.failed, language.closed) == ([1], [])
    run.reset()
    assert (language.failed, language.closed) == ([1], [1])


def test_wrong_words_point_at_their_place() -> None:
    def main(_: object) -> Items:
        offset = line_start(6)
        yield WordsBlock((Word("G", 987.0, offset + 2, True),), 6, offset)

    language = Language({1: main})
    run = program_run(PROGRAM, language=language)
    run.start()
    to_the_end(run)
    assert run.error is not None
    assert run.error.position is not None
    assert (run.error.position.line, run.error.position.column) == (6, 3)
    assert language.failed == [1]


def test_block_delete_holds_for_words_too() -> None:
    def main(_: object) -> Items:
        made = block(2, ("G", 1), ("X", 4), ("F", 600))
        yield made
        yield WordsBlock(made.words, 3, line_start(3), skip_level=2)

    run = program_run(PROGRAM, language=Language({1: main}), block_delete=frozenset({2}))
    run.start()
    to_the_end(run)
    assert run.channel.blocks == 2
    assert run.machine.state.paths.row[0]["tail"] == 1


def test_a_program_without_a_source_is_read_as_text() -> None:
    machine_run = program_run("G1 X3 F600\nX5\n", language=Language({}))
    machine_run.start()
    to_the_end(machine_run)
    assert machine_run.machine.setpoints["X"] == 5.0
    assert isinstance(machine_run.channel, Channel)
    assert load_dialect("din").blocks_ahead is None
