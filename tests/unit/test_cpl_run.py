"""CPL programs in a channel: what they compute moves the machine, WAIT sees where it is."""

from __future__ import annotations

import pytest

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.cpl import CplLanguage
from support.cpl_host import RecordingHost
from support.programs import MILL

AXES = ("X", "Y", "Z")


class Started:
    """A program in a run on a three-axis machine; the host answers MPOS and CLOCK from that machine."""

    def __init__(self, text: str, programs: dict[str, str] | None = None, **options: object) -> None:
        self.machine = Machine(MILL)
        self.host = RecordingHost(
            {"MPOS": self.position, "CLOCK": self.clock, "IC": self.interface}, programs
        )
        self.asked: list[float] = []
        self.open = False
        self.language = CplLanguage(self.host, skip_levels=options.pop("skip", frozenset()))  # type: ignore[arg-type]
        program = ProgramText.from_text(text, "main.cpl")
        chosen = RunOptions(**options)  # type: ignore[arg-type]
        self.run = ProgramRun(
            self.machine, program, load_dialect("bosch"), options=chosen, language=self.language
        )
        self.run.start()

    def position(self, axis: int) -> float:
        return self.machine.setpoints[AXES[axis - 1]]

    def clock(self) -> int:
        return round(self.machine.clock.cycles * self.machine.clock.cycle_s * 1000)

    def interface(self, bit: int) -> bool:
        self.asked.append(self.machine.setpoints["X"])
        return self.open or self.machine.setpoints["X"] > bit

    def to_the_end(self) -> Started:
        pieces = 0
        while self.run.active and pieces < 20_000:
            self.run.advance(50)
            pieces += 1
        assert self.run.error is None, str(self.run.error)
        assert not self.run.active
        return self


BOLTS = """\
10 DIM X(6) : DIM Y(6) : R=20.5
N10 G1 X5 Y5 F3000
20 FOR I%=1 TO 6
30 W!=60*I% : X(I%)=R*COS(W!) : Y(I%)=R*SIN(W!)
N20 G1 X[X(I%)] Y[Y(I%)]
40 NEXT
N30 G1 Z-2.5
N40 Z3.25
"""


def test_a_bolt_circle_moves_the_axes_where_the_program_reckons() -> None:
    started = Started(BOLTS)
    places: list[tuple[int, int | None]] = []
    while started.run.active:
        started.run.advance(20)
        record = started.run.reading.block
        if record is not None and (not places or places[-1] != (record.line, record.sequence)):
            places.append((record.line, record.sequence))
    assert places[0] == (2, 10)
    assert {place[0] for place in places} == {2, 5, 7, 8}
    assert places[-1] == (8, 40)
    assert started.machine.setpoints == {"X": 20.5, "Y": 0.0, "Z": 3.25}


@pytest.mark.covers("cpl.exec.lookahead", "cpl.ex.1219")
@pytest.mark.parametrize("waits", [True, False])
def test_positions_are_those_of_the_preparation_unless_the_program_waits(waits: bool) -> None:
    wait = "30 WAIT\n" if waits else ""
    text = (
        f"N10 G0 X0\nN20 G1 X150 F5000\n{wait}40 #XPOS = MPOS(1)-150\n"
        f"50 IF ABS(#XPOS) < 0.0001 THEN\nN60 (MSG,Position reached)\n70 ENDIF"
    )
    started = Started(text).to_the_end()
    assert started.language.globals["#XPOS"] == (0.0 if waits else -150.0)
    told = [message.text for message in started.run.channel.messages.all()]
    assert told == (["MSG: Position reached"] if waits else [])


@pytest.mark.covers("cpl.WAIT", "cpl.ex.1233", "cpl.ex.1234", "cpl.WAIT.result.1")
def test_wait_stands_for_its_duration() -> None:
    text = (
        "5 TIME%=170\nN10 G1 X20 F6000\n8 WAIT\n10 #A%=CLOCK\n20 WAIT(,1000,#E%)\n"
        "30 #B%=CLOCK\n40 WAIT(,TIME%)\n50 #C%=CLOCK\nN20 X30"
    )
    found = Started(text).to_the_end().language.globals
    assert found["#E%"] == 1
    assert (found["#B%"] - found["#A%"], found["#C%"] - found["#B%"]) == (1000, 170)


@pytest.mark.covers("cpl.WAIT.result.0", "cpl.WAIT.result.2", "cpl.WAIT")
def test_wait_tells_whether_its_condition_held_at_once() -> None:
    started = Started("N10 G1 X20 F6000\n20 WAIT(IC(7)=TRUE,,#E%)\nN30 X30").to_the_end()
    assert started.language.globals["#E%"] == 0
    assert started.asked == [20.0]
    started = Started("10 WAIT(IC(7),300,#E%)\n20 WAIT(NOT IC(7),300,#F%)").to_the_end()
    assert (started.language.globals["#E%"], started.language.globals["#F%"]) == (1, 0)
    started = Started("10 WAIT(IC(7),9000,#E%)\nN20 G1 X5 F6000")
    for _ in range(5):
        started.run.advance(50)
    assert started.language.globals.get("#E%") is None
    started.open = True
    started.to_the_end()
    assert started.language.globals["#E%"] == 2
    assert started.machine.setpoints["X"] == 5.0


def test_sub_programs_run_in_the_channel_and_show_on_its_stack() -> None:
    programs = {"DRILL": "1 DEPTH=P1\nN1 G1 Z[DEPTH] F2000\nN2 Z2", "PLAIN": "N5 G1 Y7.5\nN6 X1.5"}
    started = Started(
        "10 FOR I%=1 TO 2\nN10 G1 X[I%*10] F3000\n20 CALL DRILL[-I%]\n30 NEXT\n40 CALL PLAIN\nN50 Z9",
        programs,
    )
    seen: list[tuple[str, int, tuple[tuple[str, int], ...]]] = []
    while started.run.active:
        started.run.advance(20)
        record = started.run.reading.block
        if record is not None:
            entry = (record.program, record.line, tuple((call.program, call.line) for call in record.stack))
            if not seen or seen[-1] != entry:
                seen.append(entry)
    assert started.run.error is None
    assert seen == [
        ("main.cpl", 2, ()), ("DRILL", 2, (("main.cpl", 3),)), ("DRILL", 3, (("main.cpl", 3),)),
        ("main.cpl", 2, ()), ("DRILL", 2, (("main.cpl", 3),)), ("DRILL", 3, (("main.cpl", 3),)),
        ("PLAIN", 1, (("main.cpl", 5),)), ("PLAIN", 2, (("main.cpl", 5),)), ("main.cpl", 6, ()),
    ]  # fmt: skip
    assert started.machine.setpoints == {"X": 1.5, "Y": 7.5, "Z": 9.0}
    assert started.language.running == []


def test_m30_in_the_midst_ends_the_program_and_its_global_variables_stay_readable() -> None:
    started = Started("10 #A=2.5\nN10 G1 X[#A] F2000\nN20 M30\n20 #A=7").to_the_end()
    assert started.language.globals["#A"] == 2.5
    assert started.machine.setpoints["X"] == 2.5


def test_blocks_of_a_level_are_left_out() -> None:
    started = Started("10 A=5\n/2 N10 G1 X[A] F2000\n/3 N20 G1 Y[A] F2000", skip=frozenset({2})).to_the_end()
    assert started.machine.setpoints == {"X": 0.0, "Y": 5.0, "Z": 0.0}


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        ("10 A=1\n20 A=A/0", "main.cpl:2:4", "division by zero"),
        ("10 A=", "main.cpl:1:6", "a value is missing before the end"),
        ("10 A=1\nN10 G1 X5 Q[A] F500", "main.cpl:2:11", ""),
        ("10 CALL SP", "SP:1:4", "= MISSING"),
    ],
)
def test_errors_of_a_program_stop_its_preparation(text: str, place: str, what: str) -> None:
    started = Started(text, {"SP": "1 A"})
    for _ in range(100):
        if started.run.active:
            started.run.advance(50)
    error = started.run.error
    assert error is not None
    assert str(error.position).startswith(place.rpartition(":")[0] if not what else place)
    assert what in error.what
