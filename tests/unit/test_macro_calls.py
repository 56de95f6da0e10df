"""Nested modal calls, calls for every block, interrupts, outputs, names, spaced words, and what programs suppress."""

from __future__ import annotations

import pytest

from polycnc.cnc import ProgramRun, RunOptions, RunState
from polycnc.machine import Machine, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.macro import MacroLanguage
from support.power_mate import attached, registered, running


def made(text: str, *, sink: bytearray | None = None, bare: bool = False) -> tuple[ProgramRun, MacroLanguage]:
    language = MacroLanguage()
    if bare:
        language.output.bare = True
    if sink is not None:
        language.output.sink = sink.extend
    run = ProgramRun(
        Machine(load_machine(None)),
        ProgramText.from_text(text, "macro.tap"),
        load_dialect("fanuc"),
        language=language,
        options=RunOptions(stands_at_stops=False),
    )
    run.start()
    return run, language


def ended(text: str, *, sink: bytearray | None = None) -> MacroLanguage:
    run, language = made(text, sink=sink)
    for _ in range(100):
        if not run.active:
            break
        run.advance(50_000)
    assert run.error is None, str(run.error)
    assert run.state is RunState.COMPLETED
    return language


def values(language: MacroLanguage, *numbers: int) -> list[float | None]:
    return [language.variables.get(number) for number in numbers]


def test_modal_calls_nest_and_g67_cancels_the_last_one() -> None:
    """The moves of the macro that is called last call the one before."""
    language = ended(
        "G66 P9001\nG66 P9002\nG0 X1\nG67\nG0 X2\nG67\nG0 X3\nM30\n"
        "O9001\n#101=#101+1\nM99\nO9002\n#102=#102+1\nG0 Y#102\nM99\n"
    )
    assert values(language, 101, 102) == [2.0, 1.0]  # by the move of O9002, by X2


def test_a_skipped_move_calls_nothing_and_one_of_another_level_does() -> None:
    text = "G66 P9001 A2.5\nG0 X1\n/3 X2\n/2 X3\nX#1 Y4\n/3 X#1 Z5\n/2 Z6\nG67\nM30\n"
    language = MacroLanguage()
    run = ProgramRun(
        Machine(load_machine(None)),
        ProgramText.from_text(f"{text}O9001\n#101=#101+#1\nM99\n", "macro.tap"),
        load_dialect("fanuc"),
        language=language,
        options=RunOptions(block_delete=frozenset({3})),
    )
    run.start()
    run.advance(100_000)
    assert run.state is RunState.COMPLETED, run.error
    assert values(language, 101) == [10.0]  # X1, X3, Y4, Z6
    assert run.reading.position == {"X": 3.0, "Y": 4.0, "Z": 6.0}


def test_five_modal_calls_are_too_many() -> None:
    run, language = made("G66 P9001\n" * 5 + "M30\nO9001\nM99\n")
    run.advance(1000)
    assert run.error is not None
    assert (run.error.code, run.error.position.line if run.error.position else 0) == ("PS0122", 5)
    del language


def test_every_block_becomes_a_call_with_its_words() -> None:
    language = ended(
        "#1=7\nG66.1 P9001\nG1 X2.5 Y-3 F200 L4\nN20 X#1 M8\nN30\n/2 X99\nG67\nG0 X1\nM30\n"
        "O9001\n#100=#100+1\n#[100+10*#100]=#24\n#[101+10*#100]=#25\n#[102+10*#100]=#10\n"
        "#[103+10*#100]=#12\n#[104+10*#100]=#13\n#[105+10*#100]=#14\nM99\n".replace("/2 X99\n", "")
    )
    assert values(language, 100, 110, 111, 112, 113, 114, 115) == [2.0, 2.5, -3.0, 1.0, 4.0, None, None]
    assert values(language, 120, 121, 122, 124) == [7.0, None, None, 8.0]


def test_spaced_and_zero_padded_words_are_the_same_words() -> None:
    language = ended(
        "G065 P9001 A2\nG 65 P 9001 A 3\ng0065p9001a4\nM 98 P9002\nN7 M098 P9003\n#110=9\nN50 #111=5\nM30\n"
        "O9001\n#100=#100+#1\nM99\nO9002\n#101=1\nM 99\nO9003\nM099 P50\n"
    )
    assert values(language, 100, 101, 110, 111) == [9.0, 1.0, None, 5.0]


# ---------------------------------------------------------------------- interrupts

INTERRUPTED = (
    "M96 P9001\nG1 X1 F600\nX2\nX3\nM97\nX4\nX5\n#110=#100\nM30\n"
    "O9001\n#100=#100+1\n#[100+#100]=#5041\n#1=3\nM99\n"
)


def test_an_interrupt_calls_its_program_behind_the_block() -> None:
    run, language = made(INTERRUPTED)
    run.advance(1_000_000, until=lambda: run.reading.position["X"] > 1.4)
    language.interrupt()
    run.advance(1_000_000, until=lambda: run.reading.position["X"] > 4.4)
    language.interrupt()  # M97: nobody listens
    run.advance(1_000_000)
    assert run.state is RunState.COMPLETED, run.error
    assert values(language, 110, 101, 1) == [1.0, 2.0, None]


def test_an_interrupt_program_is_called_by_no_move_and_hears_no_signal() -> None:
    run, language = made(
        "#1=9001\nG66 P9002 A2.5\nM96 P#1\nG1 X1 F600\nX2\nG67\nX3\nM97\nM30\n"
        "O9001\n#101=#101+1\nG1 Y1.5\nY3\n#2=#5042\nM99\nO9002\n#102=#102+#1\nM99\n"
    )
    run.advance(1_000_000, until=lambda: run.reading.position["X"] > 0.5)
    language.interrupt()
    run.advance(1_000_000, until=lambda: run.reading.position["Y"] > 0.5)
    language.interrupt()
    run.advance(1_000_000)
    assert run.state is RunState.COMPLETED, run.error
    assert values(language, 101, 102) == [1.0, 5.0]


def test_an_interrupt_program_may_return_to_another_block() -> None:
    run, language = made("M96 P9001\nG1 X1 F600\nX2\nX3\n#105=1\nN80 #106=2\nM97\nM30\nO9001\nM99 P80\n")
    run.advance(1_000_000, until=lambda: run.reading.position["X"] > 0.5)
    language.interrupt()
    run.advance(1_000_000)
    assert run.state is RunState.COMPLETED, run.error
    assert values(language, 105, 106) == [None, 2.0]
    assert run.reading.position["X"] == 1.0


def test_the_signal_of_the_pmc_interrupts() -> None:
    control, _ = attached()
    registered(control, O1="\nM96P9001\nG1X2.F600\nX4.\nM97\nM30\n", O9001="\n#500=#500+1\nM99\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 500)
    control.signals.give(53, 8)
    control.signals.give(53, 8)  # still on: an edge counts
    control.advance(3000)
    assert control.macros.get(500) == 1.0


@pytest.mark.parametrize(
    ("block", "code", "column"),
    [("M96", "PS0076", 1), ("M96 P1 X2", "PS0125", 8), ("M97 P1", "PS0125", 1), ("G66.1", "PS0076", 1),
     ("G66.1 P1 X2", "PS0125", 10)],
)  # fmt: skip
def test_wrong_calls_are_refused(block: str, code: str, column: int) -> None:
    run, _ = made(f"{block}\nM30\n")
    run.advance(10)
    assert run.error is not None
    assert run.error.position is not None
    assert (run.error.code, run.error.position.column) == (code, column)


# ---------------------------------------------------------------------- output, names


def test_text_is_put_out_in_the_controls_form() -> None:
    out = bytearray()
    ended(
        "#2=128.47398\n#5=-91.2\n#30=123.456\nPOPEN\nDPRNT[X#2[53]*Y#5[53]T#30[20]]\nDPRNT[DONE*#0[11]]\nPCLOS\nM30\n",
        sink=out,
    )
    lines = bytes(out).split(b"\n")
    assert lines[0] == b"\x12X   128.474 Y-   91.200T 23"
    assert lines[1:] == [b"DONE  0.0", b"\x14"]


def test_bare_text_has_no_blanks() -> None:
    out = bytearray()
    run, _ = made("#2=128.47398\n#5=-91.2\nG4 P1\nPOPEN\nDPRNT[X#2[53]Y#5[53]]\nM30\n", sink=out, bare=True)
    run.advance(1000)
    assert bytes(out) == b"\x12X128.474Y-91.200\n"


def test_digits_that_do_not_fit_are_cut_off_and_nothing_is_negative() -> None:
    out = bytearray()
    ended(
        "#1=12345.678\n#2=-0.004\nPOPEN\nDPRNT[A#1[22]B#2[32]C#2[33]D#1[03]]\nPCLOS\nM30\n",
        sink=out,
    )
    assert bytes(out) == b"\x12A 45.68B   0.00C-  0.004D .678\n\x14"


def test_the_first_200_lines_are_told_and_a_device_is_closed_at_the_beginning() -> None:
    text = "POPEN\nWHILE[#1LT203]DO1\n#1=#1+1\nDPRNT[#1[30]]\nEND1\nM30\n"
    run, language = made(text)
    run.advance(1000)
    found = [each.text for each in run.channel.messages.all() if "DPRNT" in each.text]
    assert [found[0], found[-1], len(found)] == ["DPRNT:    1", "DPRNT:  200", 200]
    assert language.output.is_open
    language.output.attach(run.channel)
    assert not language.output.is_open


def test_bytes_are_put_out() -> None:
    out = bytearray()
    ended("#1=0.40596\n#2=-1638.4\nPOPEN\nBPRNT[C*#1[4]*X#2[3]]\nPCLOS\nM30\n", sink=out)
    assert bytes(out) == b"\x12C \x00\x00\x0f\xdc X\xff\xe7\x00\x00\n\x14"


def test_without_a_sink_the_messages_tell_the_lines() -> None:
    run, _ = made("POPEN\n#1=2\nWHILE [#1 GT 0] DO1\nDPRNT[PASS*#1[10]]\n#1=#1-1\nEND1\nPCLOS\nM30\n")
    run.advance(1000)
    found = [(each.text, each.line) for each in run.channel.messages.all() if "DPRNT" in each.text]
    assert found == [("DPRNT: PASS  2", 4), ("DPRNT: PASS  1", 4)]


@pytest.mark.parametrize(
    ("block", "code"),
    [("DPRNT[A]", "PS0113"), ("DPRNT[#1]", "PS0125"), ("DPRNT[A", "PS0125"), ("DPRNT A", "PS0125"),
     ("DPRNT[#1[90]]", "PS0125"), ("DPRNT[%]", "PS0125"), ("POPEN\nBPRNT[#1[9]]", "PS0119"),
     ("SETVN 100[A]", "PS0115"), ("SETVN 500[ABCDEFGHI]", "PS0125"), ("SETVN[A]", "PS0125"),
     ("DPRNT[#[#1]", "PS0125"), ("DPRNT[#1[", "PS0125")],
)  # fmt: skip
def test_wrong_outputs_and_names_are_refused(block: str, code: str) -> None:
    run, _ = made(f"#1=5000000\n{block}\nM30\n")
    run.advance(10)
    assert run.error is not None
    assert run.error.code == code, str(run.error)


def test_variables_get_names() -> None:
    language = ended("SETVN 510[DEPTH, WIDTH]\n#510=3\nSETVN 517[ANGLE]\nSETVN 511[HEIGHT,TURN]\nM30\n")
    assert language.variables.names == {510: "DEPTH", 511: "HEIGHT", 512: "TURN", 517: "ANGLE"}


def test_variables_are_read_and_written_by_their_names() -> None:
    language = ended(
        "SETVN 510[DEPTH, WIDTH]\n#[DEPTH]=3\n#[ WIDTH ]=#[depth]*2+#[#514+510]\n#1=511\n"
        "G1X#[DEPTH]F600\nIF[#[WIDTH]EQ9]THEN #520=-#[DEPTH]\nSETVN 510[OLD,DEPTH]\n#[DEPTH]=#[DEPTH]+1\nM30\n"
    )
    read = language.variables.get
    assert (read(510), read(511), read(520)) == (3.0, 10.0, -3.0)


@pytest.mark.parametrize("block", ["#[DEPTH]=1", "#500=#[DEPTH]", "G1X#[DEPTH]F100", "IF[#[DEPTH]EQ1]GOTO1"])
def test_a_name_that_no_variable_has_is_refused(block: str) -> None:
    run, _ = made(f"SETVN 500[WIDTH]\n{block}\nN1M30\n")
    run.advance(10)
    assert run.error is not None
    assert run.error.code == "PS0115"
    assert "no variable is named DEPTH" in str(run.error)


def test_a_power_mate_keeps_what_was_put_out() -> None:
    control, _ = attached()
    registered(control, O1="\n#1=-2.5\nPOPEN\nDPRNT[X#1[22]]\nPCLOS\nM30\n")
    running(control, 1)
    control.advance(100)
    assert bytes(control.custom_macros.printed) == b"\x12X- 2.50\n\x14"
    control.parameters.set(6001, 64 | 2)
    running(control, 1)
    control.advance(100)
    assert bytes(control.custom_macros.printed).endswith(b"\x12X-2.50\n\x14")


# ---------------------------------------------------------------------- what a program suppresses


def test_single_block_is_suppressed_between() -> None:
    control, _ = attached()
    registered(control, O1="\nG1X1.F6000\n#3003=1\nX2.\nX3.\n#3003=0\nX4.\nX5.\nM30\n")
    control.control.set_switches(single_block=True)
    stands = []
    running(control, 1)
    for _ in range(12):
        control.advance(3000, until=lambda: control.status().channel.run_state is not RunState.ACTIVE)
        stands.append(control.positions.read()[0].absolute)
        if control.status().channel.run_state is RunState.COMPLETED:
            break
        control.cycle_start()
    assert list(dict.fromkeys(stands)) == [1000, 4000, 5000]


def test_a_feed_hold_comes_when_the_program_lets_it() -> None:
    control, _ = attached()
    registered(control, O1="\n#3004=1\nG1X2.F600\n#3004=0\nX9.\nM30\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 500)
    control.feed_hold()
    control.advance(1000)
    at = control.positions.read()[0].absolute
    assert (control.status().channel.run_state, 2000 <= at < 2300) == (RunState.HOLD, True)
    control.cycle_start()
    control.advance(3000)
    assert control.positions.read()[0].absolute == 9000


def test_an_alarm_stops_the_axes_whatever_the_program_suppresses() -> None:
    control, _ = attached()
    registered(control, O1="\n#3004=3\nG1X50.F600\nM30\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 500)
    control.raise_alarm(401, "SERVO", axis=1)
    control.advance(300)
    at = control.positions.read()[0].absolute
    control.advance(300)
    assert (control.positions.read()[0].absolute, control.status().channel.run_state) == (at, RunState.ALARM)


def test_a_hold_that_never_came_is_forgotten_with_its_program() -> None:
    control, _ = attached()
    text = "\n#3004=1\nG1X2.F600\nM30\n"
    registered(control, O1=text, O2="\n#3004=1\nG1X4.F600\n#3004=0\nX6.\nM30\n")
    running(control, 1, lambda: control.positions.read()[0].absolute > 500)
    control.feed_hold()
    control.advance(2000)
    assert control.status().channel.run_state is RunState.COMPLETED
    running(control, 2)
    control.advance(2000)
    assert control.status().channel.run_state is RunState.COMPLETED


def test_the_feed_override_is_suppressed_and_acts_again() -> None:
    def took(text: str, override: float) -> int:
        run, _ = made(text)
        run.overrides.feed = override
        run.advance(1_000_000)
        assert run.state is RunState.COMPLETED
        assert run.overrides.feed == override
        return run.machine.clock.cycles

    moves = "G1 X5 F600\n{}\nX10\n{}\nX15\nM30\n"
    plain = moves.format("#3004=0", "#3004=0")
    half, full = took(plain, 0.5), took(plain, 1.0)
    between = took(moves.format("#3004=2", "#3004=0"), 0.5)
    assert between == pytest.approx(full + (half - full) * 2 / 3, abs=30)


@pytest.mark.parametrize("stops", ["G61", "G9"])
def test_exact_stops_are_suppressed_and_act_again(stops: str) -> None:
    def took(text: str) -> int:
        run, _ = made(text)
        run.advance(1_000_000)
        assert run.state is RunState.COMPLETED
        return run.machine.clock.cycles

    rest, inner = ("", stops) if stops == "G9" else (stops, "")
    moves = f"{{}}\n{rest}\nG1 X5 F600\n{inner} X13\n{{}}\n{inner} X17\nX24\nM30\n"
    through, stopping = (
        took(moves.replace("G61", "").replace("G9", "").format("", "")),
        took(moves.format("", "")),
    )
    assert stopping > through + 3
    assert took(moves.format("#3004=4", "")) == through
    rested = took(moves.format("#3004=4", "#3004=4"))  # each write waits until the axes rest
    assert rested < took(moves.format("#3004=4", "#3004=0")) <= stopping


def test_a_reset_lets_everything_act_again() -> None:
    control, _ = attached()
    registered(control, O1="\n#3004=3\nG1X5.F600\nM30\n", O2="\nG1X50.F600\nM30\n")
    control.control.set_overrides(feed=0.5)
    running(control, 1, lambda: control.positions.read()[0].absolute > 500)
    control.reset()
    control.advance(300)
    running(control, 2)
    control.advance(500)
    begin = control.positions.read()[0].absolute
    control.advance(1000)
    assert control.positions.read()[0].absolute - begin == pytest.approx(5000, abs=60)
    control.feed_hold()
    control.advance(300)
    assert control.status().channel.run_state is RunState.HOLD
