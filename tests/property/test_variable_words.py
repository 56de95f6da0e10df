"""Words with variables for numbers stay text; they mean what the same variables in brackets do, in statements."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Callable

import pytest

from polycnc.cnc import ProgramRun, RunOptions, RunSnapshot
from polycnc.errors import ProgramError
from polycnc.kernel import drop_queue
from polycnc.machine import Machine, Snapshot, load_machine
from polycnc.nc import Channel, ProgramText, load_dialect
from polycnc.nc.macro import MacroCalls, MacroLanguage
from support.often import often
from support.programs import FIVE, listing, prepare

_PROGRAMS = 60
_NUMBERS = (1, 7, 33, 100, 149, 500, 531)


def macro_program(chance: random.Random, lines: int = 30) -> str:
    """Return random words and assignments; `#n` stands for the numbers of some, with a tilde before each."""
    found = ["G21 G90 G1 F700", "#1=3.25", "#100=-7.5", "#500=1.00049", "#531=612.5"]
    loops = 0
    for _ in range(lines):
        kind = chance.randrange(14)
        if kind == 0:
            found.append(
                f"#{chance.choice(_NUMBERS)}={chance.choice(('#0', f'{chance.uniform(-9, 9):.5f}'))}"
            )
        elif kind == 1:
            found.append(
                chance.choice(
                    ("G20", "G21", "G91", "G90", "M8", "G0", "G4 P20", "(#1 IS NO WORD)", "/2 X1.5")
                )
            )
        elif kind == 2:
            loops += 1
            found += [f"#20=0\nN{loops} #20=#20+1", _words(chance), f"IF [#20 LT 3] GOTO {loops}"]
        elif kind == 3:
            found.append(f"N{chance.randrange(100, 900)} {_words(chance)} (AT #33)")
        else:
            found.append(_words(chance))
    return "\n".join([*found, "M30", ""])


def _words(chance: random.Random) -> str:
    words = []
    for letter in chance.sample("XYZFR" if chance.random() < 0.1 else "XYZF", chance.randrange(1, 4)):
        if chance.random() < 0.5:
            sign = chance.choice(("", "", "", "-")) if letter != "F" else ""
            number = chance.choice(_NUMBERS) if letter != "F" else 531
            words.append(f"{letter}{sign}~#{number}~")
        else:
            words.append(f"{letter}{chance.uniform(1, 200):.3f}")
    return " ".join((*chance.choice(((), ("G1",), ("g01",), ("G0",))), *words))


def as_words(program: str) -> str:
    """Return the program with bare variables after the letters."""
    return program.replace("~", "")


def as_statements(program: str) -> str:
    """Return the program with the same variables in brackets."""
    return program.replace("~#", "[#").replace("~", "]")


def prepared(program: str, *, ordinary_blocks: float = 0) -> tuple[Channel, list[object]]:
    """Return a channel that has prepared a program, and what it made of every block."""
    channel = prepare(
        program,
        config=FIVE,
        dialect="fanuc",
        ordinary_blocks=ordinary_blocks,
        collect_errors=True,
        language=MacroLanguage(),
    )
    state = channel.machine.state
    tags = [int(state.seg.row[k]["tag"]) for k in range(int(state.paths.row[0]["tail"]))]
    records = [channel.records.block(tag) for tag in tags]
    found: list[object] = [None if each is None else (each.line, each.modal) for each in records]
    return channel, found


@pytest.mark.parametrize("seed", often(range(_PROGRAMS), 25))
def test_a_variable_behind_a_letter_means_what_it_means_in_brackets(seed: int) -> None:
    program = macro_program(random.Random(seed))
    here, there = as_words(program), as_statements(program)
    assert here != there
    (words, blocks), (statements, others) = prepared(here), prepared(there)
    assert listing(words, lines=True) == listing(statements, lines=True)
    assert blocks == others
    assert [(each.what, line_of(each)) for each in words.errors] == [
        (each.what, line_of(each)) for each in statements.errors
    ]
    assert words.blocks == statements.blocks


def line_of(error: ProgramError) -> int | None:
    """Return the line of an error."""
    return None if error.position is None else error.position.line


@pytest.mark.parametrize("seed", often(range(20), 8))
def test_the_compiled_kernel_and_the_interpreter_give_variables_the_same_meaning(seed: int) -> None:
    program = as_words(macro_program(random.Random(1000 + seed), 60))
    compiled, blocks = prepared(program)
    ordinary, others = prepared(program, ordinary_blocks=1e9)
    assert listing(compiled, lines=True) == listing(ordinary, lines=True)
    assert blocks == others


@pytest.mark.parametrize("seed", often(range(10), 5))
def test_modal_calls_get_the_same_words(seed: int) -> None:
    chance = random.Random(seed)
    code = chance.choice(("G66", "G66.1"))
    body = "\n".join(_words(chance) for _ in range(12))
    program = f"G21 G90 F612\n#1=2.5\n#7=-4.25\n#531=700\nG0 X0\n{code} P9100\n{body}\nG67\nM30\n"
    macro = "O9100\n#501=#501+#24*3+#26\n#502=#502+#9\nG91 G0 Z0.125\nG90\nM99\n"
    found = []
    for text in (as_words(program), as_statements(program)):
        language = MacroLanguage()
        channel = prepare(
            f"{text}%\n{macro}", config=FIVE, dialect="fanuc", collect_errors=True, language=language
        )
        found.append(
            (listing(channel, lines=True), language.variables.permanent(), [e.what for e in channel.errors])
        )
    assert found[0] == found[1]


def test_a_variable_is_read_when_its_block_is_prepared() -> None:
    language = MacroLanguage()
    text = "#101=500.\nG21 G90\n" + "".join(f"G1 X{n % 7}.25 F#101\n" for n in range(40)) + "M30\n"
    machine = Machine(load_machine(None))
    channel = Channel(ProgramText.from_text(text), load_dialect("fanuc"), machine, language=language)
    channel.fill(12)
    language.variables.set(101, 725.5)
    while not channel.done:
        channel.fill(9)
    feeds = [float(machine.state.seg.row[n]["feed_mm_s"]) * 60.0 for n in range(40)]
    assert feeds[:11] == pytest.approx([500.0] * 11)  # the block before them counts as one
    assert feeds[11:] == pytest.approx([725.5] * 29)
    last = machine.state.paths.row[0]["tail"] - 1
    record = channel.records.block(int(machine.state.seg.row[last]["tag"]))
    first = channel.records.block(int(machine.state.seg.row[3]["tag"]))
    assert record is not None
    assert first is not None
    assert (first.modal.feed, record.modal.feed) == (500.0, 725.5)


def test_a_vacant_word_does_not_count_until_it_has_a_value() -> None:
    program = "G21 G90 G1 F612\nX2.5 Y#7\n#7=4.25\nX3.5 Y#7\n#7=#0\nX4.5 Y#7\nX#7\nM30\n"
    channel, _ = prepared(program)
    assert channel.errors == []
    assert listing(channel, lines=True) == listing(
        prepared(program.replace("Y#7", "Y[#7]").replace("X#7", "X[#7]"))[0], lines=True
    )


def test_codes_that_call_programs_are_no_plain_words() -> None:
    """G200 calls O9010, T a program, M98 a sub-program, also beside words with variables."""
    program = "#7=2.5\nF612 G1 X#7\nG200 Z#7\nX3.5 Y#7\nM98 P50\nT3\nM30\n%\n"
    program += "O9010\n#501=#26\nM99\n%\nO9000\n#502=#149\nM99\n%\nO50\n#503=#7\nM99\n"
    language = MacroLanguage(calls=MacroCalls(g={200.0: 9010}, t=9000))
    channel = prepare(program, dialect="fanuc", language=language)
    assert channel.errors == []
    assert language.variables.permanent() == {501: 2.5, 502: 3.0, 503: 2.5}


def test_a_run_that_stands_within_such_lines_goes_on_from_a_snapshot() -> None:
    text = (
        "#101=500.\n#102=2.5\nG21 G90\n"
        + "".join(f"G1 X{n % 7 * 0.125} Y#102 F#101\n" for n in range(40))
        + "#102=#102+1\nG0 Z#102\nM30\n"
    )

    def started() -> ProgramRun:
        machine = Machine(load_machine(None), segments=64)
        return ProgramRun(
            machine,
            ProgramText.from_text(text, "words.nc"),
            load_dialect("fanuc"),
            options=RunOptions(),
            language=MacroLanguage(),
        )

    def ended(run: ProgramRun) -> tuple[object, ...]:
        while run.active:
            run.advance(100_000)
        run.feed.blocks.pass_marks()
        return run.state, str(run.error), run.machine.snapshot(), run.snapshot()

    run = started()
    run.start()
    run.advance(700)
    assert run.active
    kept, machine = run.snapshot().to_bytes(), run.machine.snapshot().to_bytes()
    other = started()
    other.machine.restore(Snapshot.from_bytes(machine))
    other.restore(RunSnapshot.from_bytes(kept))
    assert ended(other) == ended(run)
    assert run.error is None


def _seconds(lines: int) -> float:
    chance = random.Random(lines)
    text = "#101=500.\nG21 G90\n" + "".join(
        f"N{n} G1 X{chance.uniform(1, 90):.3f} Y{chance.uniform(1, 90):.3f} F#101\n" for n in range(lines)
    )
    machine = Machine(load_machine(None))
    channel = Channel(
        ProgramText.from_text(f"{text}M30\n"), load_dialect("fanuc"), machine, language=MacroLanguage()
    )
    before = time.process_time()
    while not channel.done:
        machine.clock.tick(1)  # a control prepares so much in a cycle
        channel.fill()
        drop_queue(machine.state.seg, machine.state.paths, 0)
    assert channel.error is None
    return time.process_time() - before


def _assert_linear(seconds: Callable[[int], float], count: int) -> None:
    """Hold the time of `count` and of four times as many to an exponent of 1.2; others may run beside, so try again."""
    few = many = math.inf
    for _ in range(8):
        few, many = min(few, seconds(count)), min(many, seconds(4 * count))
        if math.log(many / few, 4.0) < 1.2:
            return
    raise AssertionError((few, many))


def test_the_time_of_such_lines_grows_no_faster_than_their_number() -> None:
    """Processor time of n and 4 n lines: an exponent of 1.2 at the most."""
    _seconds(2_000)  # compiled by then
    _assert_linear(_seconds, 5_000)


def test_many_programs_in_a_file_are_read_once() -> None:
    def seconds(programs: int) -> float:
        text = "".join(f"G65 P{n} A{n}.5\n" for n in range(1, programs + 1)) + "M30\n%\n"
        text += "".join(f"O{n}\n#500=#500+#1\nG1 X#1 F612\nM99\n" for n in range(1, programs + 1))
        language = MacroLanguage()
        channel = Channel(
            ProgramText.from_text(text), load_dialect("fanuc"), Machine(load_machine(None)), language=language
        )
        before = time.process_time()
        while not channel.done:
            channel.machine.clock.tick(1)
            channel.fill()
            drop_queue(channel.machine.state.seg, channel.machine.state.paths, 0)
        assert channel.error is None, str(channel.error)
        return time.process_time() - before

    _assert_linear(seconds, 100)
