"""What a control has read already: what changes, in any state, counts for all that is not prepared yet."""

from __future__ import annotations

import pytest

from polycnc.cnc import Answer, Control, Function, RunState
from polycnc.controllers.fanuc import PowerMate
from polycnc.nc import load_dialect
from support.cnc_machine import cnc_machine

KINDS = ("power mate", "fanuc", "fanuc macros", "bosch", "din")
PROGRAM = "G54 G1 X1. F6000\nX2.\n{call}X3.\nX4.\nX5.\nM30\n"


def control(kind: str, text: str, script: dict[tuple[Function, int | None], Answer] | None = None) -> Control:
    """Return a control of a kind with a selected program."""
    if kind == "power mate":
        power_mate = PowerMate(2, script=script)
        power_mate.programs.register(1, f"O0001\n{text}")
        power_mate.select_program(1)
        return power_mate.control
    dialect = load_dialect(kind.split()[0])
    if "macros" in kind:
        dialect = dialect.model_copy(update={"language": "macro"})
    made = Control(cnc_machine(), dialect=dialect, script=script)
    made.programs.create("P", text)
    made.select_program("P")
    return made


def shift(made: Control, x_mm: float) -> None:
    made.offsets.set("G54", {"X": x_mm})


def ended(made: Control) -> float:
    """Run to the next stop or end; return where X is."""
    for _ in range(400):
        if not made.channels[0].active:
            break
        made.advance(50)
    return round(made.status().axes["X"].machine, 6)


@pytest.mark.parametrize("kind", KINDS)
def test_in_single_block_what_changes_counts_for_the_next_block(kind: str) -> None:
    made = control(kind, PROGRAM.format(call=""))
    made.set_switches(single_block=True)
    seen = []
    for number in range(1, 8):
        made.cycle_start()
        seen.append(ended(made))
        if made.channels[0].run_state is RunState.COMPLETED:
            break
        assert made.channels[0].run_state is RunState.STOPPED_AT_BLOCK
        shift(made, 10.0 * number)
    moved = seen[seen.index(next(each for each in seen if each)) :]
    first = moved[0] - 1.0  # the O word is a block of its own on a Power Mate
    assert moved[:5] == [first + k * 11.0 + 1.0 for k in range(5)]


@pytest.mark.parametrize("kind", KINDS)
def test_single_block_switched_on_prepares_no_more_blocks(kind: str) -> None:
    made = control(kind, PROGRAM.format(call="M8\n"))
    made.cycle_start()
    made.advance(4)
    made.set_switches(single_block=True)
    stops = []
    for _ in range(12):
        stops.append(ended(made))
        if made.channels[0].run_state is RunState.COMPLETED:
            break
        shift(made, 10.0)
        made.cycle_start()
    assert stops[-1] == 15.0
    assert 13.0 in stops  # after M8 nothing was prepared


CALLS: dict[str, tuple[dict[tuple[Function, int | None], Answer], str]] = {
    "M8": ({(Function.M, 8): Answer(None)}, "M8\n"),
    "M6": ({(Function.M, 6): Answer(None)}, "T2 M6\n"),
    "S": ({(Function.S, None): Answer(None)}, "S500\n"),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("call", CALLS)
def test_while_a_function_waits_for_the_plc_nothing_behind_it_is_prepared(kind: str, call: str) -> None:
    script, words = CALLS[call]
    made = control(kind, PROGRAM.format(call=words), script)
    made.cycle_start()
    made.advance(3000)
    if not made.waiting_functions(0):
        pytest.skip(f"{call} is no function in this dialect")
    assert made.status().axes["X"].machine == 2.0
    shift(made, 20.0)
    made.advance(500)
    made.plc.answer()
    assert ended(made) == 25.0


@pytest.mark.parametrize("kind", KINDS)
def test_in_feed_hold_what_changes_counts_for_what_is_not_prepared(kind: str) -> None:
    made = control(kind, "G54 G1 X1. F600\nX2.\nX3.\nX4.\nX5.\nM8\nX6.\nM30\n")
    made.cycle_start()
    made.advance(60)
    made.feed_hold()
    made.advance(500)
    assert made.channels[0].run_state is RunState.HOLD
    prepared = made.channels[0].prepared
    executed = made.channels[0].executed
    assert prepared is not None
    assert executed is not None
    shift(made, 10.0)
    made.advance(50)
    assert made.channels[0].prepared == prepared
    made.cycle_start()
    ahead = prepared.line - executed.line
    assert ahead == (1 if kind == "power mate" else 5)  # M8 is as far as it goes
    reached: dict[int, float] = {}
    for _ in range(20_000):
        if not made.channels[0].active:
            break
        made.advance(1)
        block = made.channels[0].executed
        if block is not None:
            reached[block.line - executed.line] = round(made.status().axes["X"].machine, 6)
    ends = [reached[place] for place in range(5)]
    assert ends == pytest.approx([1.0 + k + (10.0 if k > ahead else 0.0) for k in range(5)], abs=0.05)
    assert made.status().axes["X"].machine == 16.0


@pytest.mark.parametrize("kind", ["power mate", "fanuc macros"])
def test_a_macro_in_single_block_reads_what_is_there_when_its_block_is_started(kind: str) -> None:
    text = "G1 X1. F6000\n#100=#5041+1\nG1 X#100\nX[#101*2]\nG90\nX[#5041+#101]\nM30\n"
    made = control(kind, text)
    made.set_switches(single_block=True)
    language = made.channels[0].run.language if made.channels[0].run else None
    assert language is None
    stops = []
    for number in range(1, 9):
        made.cycle_start()
        stops.append(ended(made))
        if made.channels[0].run_state is RunState.COMPLETED:
            break
        made.channels[0].runs.language.variables.set(101, float(number))  # type: ignore[union-attr]
    moves = [stop for place, stop in enumerate(stops) if stop not in stops[:place]]
    assert moves[-4:-2] == [1.0, 2.0]
    assert moves[-2] == 2.0 * (stops.index(moves[-2]))
    assert moves[-1] == moves[-2] + stops.index(moves[-1])


@pytest.mark.parametrize("step", [1, 7, 5000])
def test_stops_of_single_block_do_not_depend_on_who_looks(step: int) -> None:
    text = "G1 X1. F6000\n#1=#5041\nG17\nX[#5041+1]\nM8\nG4 X0.02\nX5.\nG91\nX1.\n"
    made = control("power mate", text)
    made.set_switches(single_block=True)
    seen = []
    for _ in range(12):
        made.cycle_start()
        for _ in range(20_000):
            if not made.channels[0].active:
                break
            made.advance(step, until=1)
        seen.append((made.clock.cycles, made.status().axes["X"].machine))
        if made.channels[0].run_state is RunState.COMPLETED:
            break
    assert made.channels[0].run_state is RunState.COMPLETED
    other = control("power mate", text)
    other.set_switches(single_block=True)
    for cycles, x in seen:
        other.cycle_start()
        for _ in range(20_000):
            if not other.channels[0].active:
                break
            other.advance(3, until=1)
        assert (other.clock.cycles, other.status().axes["X"].machine) == (cycles, x)


def test_what_a_pc_writes_during_a_block_counts_for_the_next_but_one() -> None:
    made = PowerMate(2)
    made.programs.register(1, "O0001\nG1 X10. F600\nX20.\nX[#500]\nM30\n")
    made.macros.set(500, 7.0)
    made.select_mode("MEM")
    made.select_program(1)
    made.cycle_start()
    made.advance(20)
    made.macros.set(500, 33.0)
    made.advance(9000)
    assert made.status().axes["X"].machine == 33.0
