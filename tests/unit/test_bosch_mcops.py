"""MCOPS: the process services of the NCS coupling, done by a partner control (Manual 003, 4.14)."""

from __future__ import annotations

import pytest

from polycnc.controllers.bosch.ncs import (
    Axis,
    Channel,
    Coordinate,
    Coupling,
    Image,
    Ipo,
    Mode,
    NcsError,
    NcsServer,
    Partner,
    Sav,
    Wait,
)
from polycnc.nc.cpl import BLOCKED, OMITTED, Box, Fault, Field

PART = """N10 G71 F1200
N50 G1 X100
G1X104
M7
N60 X40
N100 X55 (MSG,LAST CUT)
N110 M30"""


class Rig:
    """A partner with two channels and the calls of a program on channel 1 of another control."""

    def __init__(self, *, mode: Mode = Mode.AUTOMATIC, block_cycles: int = 2) -> None:
        axes = {1: Axis(1, "X", channel=2), 2: Axis(2, "Y", channel=1), 3: Axis(3, "W", channel=None)}
        axes[1].shifts = (3.5, 0.0, 0.0)
        channels = {
            1: Channel(1, mode=mode, coordinates=[Coordinate("Y", (2,))]),
            2: Channel(2, mode=mode, coordinates=[Coordinate("X", (1,))]),
        }
        self.image = Image(axes, {}, channels)
        programs = {"sect.cnc": PART, "/usr/user/p1.cnc": "G1 Y5\nM30", "loop.cnc": "10 A=1\nG1 X5\nM30"}
        self.partner = Partner(self.image, programs, block_cycles=block_cycles)
        self.server = NcsServer(self.partner)
        self.coupling = Coupling(self.server)
        self.channel = channels[2]
        self.station = self.partner.stations[2]

    def __call__(self, *arguments: object, cycles: int = 0) -> object:
        """Call MCOPS until it answers, a cycle of the partner between two questions; let cycles pass after it."""
        while (answer := self.coupling.mcops(*arguments)) is BLOCKED:
            self.partner.advance(1)
        self.partner.advance(cycles)
        return answer

    def state(self) -> tuple[int, int]:
        """Return what MCODS(32) says of channel 2."""
        buffer = Field("I", (2,))
        assert Coupling(self.server).mcods(32, 2, Box("V", "R", 0), buffer, 2) == 0
        return buffer[1], buffer[2]  # type: ignore[return-value]

    def select(self, *rest: object) -> None:
        assert self(4, 2, "sect.cnc", *rest, cycles=1) == 0

    def until(self, sav: Sav) -> None:
        for _ in range(60):
            if self.channel.sav == sav:
                return
            self.partner.advance(1)
        pytest.fail(f"state {sav} is not reached, it is {self.channel.sav!r}")


def test_the_unit_is_that_of_the_block_that_runs() -> None:
    rig = Rig()
    rig.partner.programs["sect.cnc"] = "N10 G70 F800\nN20 G1 X4\nN30 G71 F70\nN40 X9\nM30"
    assert rig(4, 2, "sect.cnc", cycles=1) == 0
    assert rig(6, 2) == 0
    seen: list[tuple[bool, float]] = []
    for _ in range(12):
        if not seen or seen[-1] != (rig.channel.inch, rig.channel.programmed_feed):
            seen.append((rig.channel.inch, rig.channel.programmed_feed))
        rig.partner.advance(1)
    assert [each for each in seen if each[1]] == [(True, 800.0), (False, 70.0)]


def test_what_was_done_is_done_anew_when_it_is_asked_for_again() -> None:
    rig = Rig()
    other = Coupling(rig.server)
    for _ in range(2):
        assert rig(4, 2, "sect.cnc", OMITTED, OMITTED, 2) == 0
        assert rig.channel.program == "sect.cnc"
        while other.mcops(2, 2, 2) is BLOCKED:
            rig.partner.advance(1)
        rig.partner.advance(1)
        assert rig.channel.program == ""


@pytest.mark.covers("cpl.MCOPS", "cpl.MCOPS.4", "cpl.MCOPS.6")
def test_a_program_is_selected_started_and_executed() -> None:
    rig = Rig()
    assert rig.state() == (1, 3)
    assert rig(4, 2, "sect.cnc") == 0
    assert rig.state() == (9, 3)
    rig.partner.advance(1)
    assert rig.state() == (11, 3)
    assert rig.channel.program == "sect.cnc"
    assert rig(6, 2) == 0
    assert rig.state() == (3, 1)
    rig.partner.advance(4)
    assert (rig.channel.programmed_feed, rig.channel.blocks) == (1200.0, 2)
    rig.until(Sav.INACTIVE)
    assert rig.state() == (1, 3)
    assert (rig.channel.message, rig.image.axes[1].setpoint) == ("LAST CUT", 58.5)
    assert rig.channel.program == ""


@pytest.mark.covers("cpl.MCOPS.6", "cpl.ncs.9", "cpl.ncs.10")
def test_only_what_is_selected_and_ready_starts() -> None:
    rig = Rig()
    assert rig(6, 2) == 10
    assert rig(4, 2, "sect.cnc") == 0
    assert rig(6, 2, cycles=1) == 9
    assert rig(6, 2) == 0
    assert rig(6, 2) == 9


@pytest.mark.covers(
    "cpl.MCOPS",
    "cpl.ncs.1",
    "cpl.MCOPS.1",
    "cpl.MCOPS.2",
    "cpl.MCOPS.3",
    "cpl.MCOPS.4",
    "cpl.MCOPS.5",
    "cpl.MCOPS.6",
    "cpl.MCOPS.7",
    "cpl.MCOPS.8",
)
@pytest.mark.parametrize("call", [(1,), (2,), (3,), (4,), (5,), (6,), (7,), (8,), (9,)])
@pytest.mark.parametrize("channel", [0, 3, -1, -2])
def test_services_need_a_channel_that_exists(call: tuple[int], channel: int) -> None:
    more = {4: ("sect.cnc",), 7: (5,), 8: (1, 1)}.get(call[0], ())
    expected = 0 if (call[0], channel) == (2, -2) else 1
    assert Rig()(call[0], channel, *more) == expected


@pytest.mark.covers("cpl.ncs.3", "cpl.MCODS.32.sav.8")
def test_nothing_is_accepted_while_a_control_reset_is_under_way() -> None:
    rig = Rig()
    assert rig(2, 2) == 0
    assert rig.state() == (8, 3)
    for call in (
        (1, 2),
        (2, 2),
        (3, 2),
        (4, 2, "sect.cnc"),
        (5, 2, 0),
        (6, 2),
        (7, 2, 5),
        (8, 2, 1, 1),
        (9, 2),
    ):
        assert rig(*call) == 3
    rig.partner.advance(1)
    assert rig.state() == (1, 3)
    assert rig(7, 2, 4) == 0


@pytest.mark.covers("cpl.MCOPS.2", "cpl.MCOPS.2.type.2", "cpl.ncs.18")
def test_a_control_reset_leaves_the_program_and_clears_errors() -> None:
    rig = Rig()
    rig.channel.reselection = True
    rig.channel.inch_at_power_up = True
    rig.station.changed["1020 00001"] = 245.5
    rig.partner.programs["sect.cnc"] = PART.replace("M7", "M=7")
    rig.select()
    assert rig(6, 2, cycles=7) == 0
    assert (rig.state(), rig.station.errors) == ((6, 3), ["sect.cnc:4: M=7"])
    assert (rig.channel.inch, rig(2, 2, cycles=1)) == (False, 0)
    assert rig.state() == (11, 3)  # selected again
    assert rig.channel.program == "sect.cnc"
    assert rig.station.errors == []
    assert rig.station.reset_executed
    assert rig.station.adopted == {"1020 00001": 245.5}
    assert rig.channel.inch
    assert rig(2, 2, 2, cycles=1) == 0
    assert rig.state() == (1, 3)
    assert rig.channel.program == ""
    assert rig(2, 2, 1) == 18


@pytest.mark.covers("cpl.MCOPS.2")
def test_a_system_reset_is_one_of_all_channels() -> None:
    rig = Rig()
    assert rig(4, 1, "/usr/user/p1.cnc", cycles=1) == 0
    rig.select()
    assert rig(2, -2) == 0
    assert {channel.sav for channel in rig.image.channels.values()} == {Sav.RESET}
    rig.partner.advance(1)
    assert {channel.sav for channel in rig.image.channels.values()} == {Sav.INACTIVE}


@pytest.mark.covers("cpl.MCOPS.1", "cpl.ncs.8", "cpl.ncs.10")
def test_cancelled_blocks_are_prepared_anew_but_their_values_are_not() -> None:
    rig = Rig(block_cycles=4)
    assert rig(1, 2) == 10
    rig.select("N50", "N50")
    rig.station.job.last = 4  # type: ignore[union-attr]
    rig.station.job.blocks[3] = "X77"  # type: ignore[union-attr, index]
    assert rig(1, 2) == 2
    assert rig(6, 2, cycles=1) == 0  # X100 is under way in quarters, X104 and X77 are prepared
    assert rig.channel.coordinates[0].end_shifted == 103.5
    assert rig.channel.coordinates[0].to_go == 75.0
    rig.image.axes[1].shifts = (4.5, 0.0, 0.0)
    rig.station.job.blocks[1] = "N50 G1 X999"  # type: ignore[union-attr, index]
    rig.partner.advance(1)
    assert rig.channel.coordinates[0].end_shifted == 103.5
    assert rig(1, 2) == 0
    assert rig.state() == (10, 2)
    assert rig(1, 2) == 2
    rig.partner.advance(1)
    assert rig.state() == (2, 3)
    x = rig.channel.coordinates[0]
    assert (x.workpiece, x.end, x.to_go) == (50.0, 50.0, 0.0)
    assert rig(6, 2, cycles=1) == 0
    assert (x.end, x.end_shifted) == (100.0, 104.5)
    rig.until(Sav.INACTIVE)
    rig.channel.mode = Mode.JOG
    rig.station.job = object()  # type: ignore[assignment]
    assert rig(1, 2) == 8


SEARCH = ["  N5 G0", "\tN50X100", "G1X100", "G1X10 F5", "50A=1", "50A =1", "N100X3", "N10X1", "M30"]


@pytest.mark.covers("cpl.MCOPS.3", "cpl.ncs.14")
@pytest.mark.parametrize(
    ("wanted", "index", "code"),
    [
        ("N5", 0, 0), ("50", 4, 0), ("N50", 1, 0), ("G1X10", 3, 0), ("50A", 5, 0), ("N100", 6, 0), ("10", 7, 0),
        ("G1X1", 0, 14), ("M", 0, 14), ("", 0, 0), ("X100", 0, 14),
    ],
)  # fmt: skip
def test_a_block_is_found_by_its_beginning(wanted: str, index: int, code: int) -> None:
    rig = Rig()
    rig.partner.programs["sect.cnc"] = "\n".join(SEARCH)
    rig.select()
    assert rig(3, 2, wanted, "M30") == code
    job = rig.station.job
    assert job is not None
    assert (job.at, job.last) == (index, 8)
    assert rig.state() == (2, 3)


@pytest.mark.covers("cpl.MCOPS.3", "cpl.ncs.15", "cpl.ncs.10", "cpl.ncs.2", "cpl.ncs.14")
def test_the_search_is_refused_once_the_program_runs() -> None:
    rig = Rig()
    assert rig(3, 2, "N50") == 10
    rig.partner.programs["sect.cnc"] = "N10 X1\nN20 M0\nN30 X7\nM30"
    rig.select()
    assert rig(3, 2, "N10", "N25") == 14
    assert rig.station.job.last == 3  # type: ignore[union-attr]
    assert rig(6, 2) == 0
    assert rig(3, 2, "N30") == 2
    rig.until(Sav.READY)
    assert rig.channel.other_waits == Wait.PROGRAM_STOP
    assert rig(3, 2, "N30") == 15
    assert rig(6, 2) == 0
    assert not rig.channel.other_waits & Wait.PROGRAM_STOP


@pytest.mark.covers("cpl.MCOPS.3", "cpl.MCOPS.4")
def test_only_the_searched_part_is_machined_with_its_last_block() -> None:
    rig = Rig()
    rig.select("N60", "N100", 1)
    assert rig(6, 2) == 0
    rig.until(Sav.INACTIVE)
    assert rig.channel.blocks == 2
    assert rig.channel.programmed_feed == 0.0
    assert rig.image.axes[1].setpoint == 58.5
    assert rig.station.errors == []


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.4.code.2", "cpl.ncs.6")
def test_a_missing_program_is_told_at_once_only_with_code_2() -> None:
    rig = Rig()
    assert rig(4, 2, "nothing.cnc", cycles=1) == 0
    assert rig.state() == (6, 3)
    assert rig.station.errors == ["nothing.cnc: no such program"]
    assert rig(2, 2, cycles=1) == 0
    assert rig(4, 2, "nothing.cnc", OMITTED, OMITTED, 2) == 6
    assert rig(5, 2, 0) == 0
    assert rig(4, 2, "sect.cnc", OMITTED, OMITTED, 2) == 0
    assert rig.state() == (11, 3)  # answered when it was ready


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.4.code.1")
def test_cpl_runs_only_from_a_link_table() -> None:
    rig = Rig()
    assert rig(4, 2, "loop.cnc", cycles=1) == 0
    assert rig(6, 2) == 0
    assert rig.state() == (6, 3)
    assert rig.station.errors == ["loop.cnc: no link table"]
    assert rig(5, 2, 0) == 0
    assert rig(4, 2, "loop.cnc", OMITTED, OMITTED, 1, cycles=1) == 0
    assert rig.partner.linked == {"loop.cnc"}
    assert rig(6, 2) == 0
    assert rig.state() == (3, 1)
    assert rig(4, 1, "/usr/user/p1.cnc", cycles=1) == 0
    assert rig(6, 1) == 0


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.4.code.64", "cpl.MCOPS.4.code.2048", "cpl.ncs.11")
def test_another_program_waits_until_the_active_one_is_left_or_replaced() -> None:
    rig = Rig()
    rig.select()
    assert rig(6, 2, cycles=3) == 0
    assert rig.channel.programmed_feed == 1200.0
    assert rig(4, 2, "/usr/user/p1.cnc") == 11
    assert rig.channel.program == "sect.cnc"
    assert rig(4, 2, "/usr/user/p1.cnc", OMITTED, OMITTED, 2048, cycles=1) == 0
    assert (rig.channel.program, rig.channel.programmed_feed) == ("/usr/user/p1.cnc", 1200.0)
    assert rig.state() == (11, 3)
    assert rig(4, 2, "sect.cnc", OMITTED, OMITTED, 64, cycles=1) == 0
    assert (rig.channel.program, rig.channel.programmed_feed) == ("sect.cnc", 0.0)


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.4.code.32", "cpl.ncs.8", "cpl.ncs.2", "cpl.ncs.18")
def test_a_manual_block_needs_its_mode_and_is_started_by_the_next_call() -> None:
    rig = Rig()
    assert rig(4, 2, "F1000G1X500", OMITTED, OMITTED, 32) == 8
    assert rig(7, 2, 4) == 0
    assert rig(4, 2, "sect.cnc") == 8
    assert rig(4, 2, "F1000G1X500", "N1", "N2", 32) == 0
    assert rig.state() == (11, 3)
    assert rig(4, 2, "G1X7", OMITTED, OMITTED, 32) == 2
    assert rig(4, 2, "X" + "1" * 511, OMITTED, OMITTED, 32) == 18
    assert rig(6, 2) == 0
    rig.until(Sav.INACTIVE)
    assert rig.image.axes[1].setpoint == 503.5
    assert rig.channel.blocks == 1


@pytest.mark.covers("cpl.MCOPS.4.code.32", "cpl.MCOPS.4.code.2048")
def test_a_manual_block_is_replaced() -> None:
    rig = Rig(mode=Mode.MDI)
    assert rig(4, 2, "X500", OMITTED, OMITTED, 32) == 0
    assert rig(4, 2, "X20", OMITTED, OMITTED, 32 + 2048) == 0
    assert rig(6, 2) == 0
    rig.until(Sav.INACTIVE)
    assert rig.image.axes[1].setpoint == 23.5


@pytest.mark.covers("cpl.MCOPS.4.code.128", "cpl.ncs.25")
def test_a_manual_block_that_starts_at_once_is_read_before() -> None:
    rig = Rig(mode=Mode.MDI)
    assert rig(4, 2, "G1 X=", OMITTED, OMITTED, 32 + 128) == 25
    assert rig.state() == (1, 3)
    assert rig(4, 2, "G1 X30", OMITTED, OMITTED, 32 + 128) == 0
    assert rig.state() == (3, 1)
    rig.until(Sav.INACTIVE)
    assert rig.image.axes[1].setpoint == 33.5


@pytest.mark.covers("cpl.MCOPS.4.code.1024", "cpl.MCOPS.4.code.128", "cpl.ncs.25")
def test_a_machine_function_runs_beside_the_program() -> None:
    rig = Rig()
    rig.select()
    assert rig(6, 2) == 0
    assert rig(4, 2, "M8 W12.5", OMITTED, OMITTED, 32 + 128) == 0  # active: a machine function by itself
    assert rig.station.functions == ["M8 W12.5"]
    assert rig.image.axes[3].setpoint == 12.5
    assert rig(4, 2, "M8 X3", OMITTED, OMITTED, 32 + 128 + 1024) == 25
    assert rig(4, 2, "G1 W3", OMITTED, OMITTED, 32 + 128 + 1024) == 25
    assert rig.station.functions == ["M8 W12.5"]
    assert rig.state() == (3, 1)
    assert rig(4, 1, "M5", OMITTED, OMITTED, 32 + 128 + 1024) == 0
    assert rig.image.channels[1].sav == Sav.INACTIVE


@pytest.mark.parametrize(
    ("mode", "code", "other"),
    [
        pytest.param(mode, code, other, marks=pytest.mark.covers("cpl.MCOPS.4", f"cpl.MCOPS.4.code.{code}"))
        for mode, code, other in ((1, 256, 512), (14, 256, 512), (2, 512, 256))
    ],
)
def test_axes_move_by_hand_only_after_the_selection_for_it(mode: int, code: int, other: int) -> None:
    rig = Rig()
    axis = rig.image.axes[1]
    assert rig(4, 2, OMITTED, OMITTED, OMITTED, code) == 8
    assert rig(7, 2, mode) == 0
    with pytest.raises(NcsError, match="not in this operation mode"):
        rig.partner.move_by_hand(2, axis, 5.5)
    assert rig(4, 2, OMITTED, OMITTED, OMITTED, other) == 8
    assert rig(4, 2, OMITTED, OMITTED, OMITTED, code) == 0
    rig.partner.move_by_hand(2, axis, 5.5)
    assert axis.actual == 5.5
    assert axis.referenced == (mode == 2)


@pytest.mark.covers("cpl.MCOPS.4.code.4096", "cpl.ncs.26", "cpl.MCODS.32.sav.12")
def test_blocks_are_entered_while_others_are_executed() -> None:
    rig = Rig(mode=Mode.MDI)
    assert rig(4, 2, "G1 X10\nX20", OMITTED, OMITTED, 32 + 4096) == 0
    assert rig.state() == (11, 3)
    assert rig(6, 2, cycles=2) == 0
    assert rig(4, 2, "X30", OMITTED, OMITTED, 32 + 4096) == 0
    assert rig.channel.sav == Sav.ACTIVE
    rig.until(Sav.BUFFER_EMPTY)
    assert rig.state() == (12, 3)
    assert rig.channel.blocks == 3
    assert rig.image.axes[1].setpoint == 33.5
    assert rig(4, 2, "X" + "0" * 4095, OMITTED, OMITTED, 32 + 4096) == 26
    assert rig(4, 2, "X" + "0" * 4093 + "8", OMITTED, OMITTED, 32 + 4096) == 0
    rig.until(Sav.ACTIVE)
    rig.until(Sav.BUFFER_EMPTY)
    assert rig.image.axes[1].setpoint == 11.5


@pytest.mark.covers("cpl.MCOPS.4.code.4096", "cpl.ncs.7")
def test_two_clients_cannot_write_into_the_buffer_in_the_same_cycle() -> None:
    rig = Rig(mode=Mode.MDI)
    other = Coupling(rig.server, channel=2)
    mine = (4, 2, "X10", OMITTED, OMITTED, 32 + 4096)
    theirs = (4, 2, "X77", OMITTED, OMITTED, 32 + 4096)
    assert rig.coupling.mcops(*mine) is BLOCKED
    assert other.mcops(*theirs) is BLOCKED
    rig.partner.advance(1)
    assert rig.coupling.mcops(*mine) == 7
    assert other.mcops(*theirs) == 0
    assert rig.station.job.blocks == ["X77"]  # type: ignore[union-attr]


@pytest.mark.covers("cpl.MCOPS.6", "cpl.ncs.5")
def test_axes_without_reference_points_keep_a_channel_from_starting() -> None:
    rig = Rig()
    rig.partner.references_needed.add(2)
    rig.select()
    assert rig(6, 2) == 5
    rig.image.axes[1].referenced = True
    assert rig(6, 2) == 0


@pytest.mark.covers("cpl.MCOPS", "cpl.MCOPS.4", "cpl.MCOPS.5", "cpl.MCOPS.7", "cpl.MCOPS.8", "cpl.ncs.18")
@pytest.mark.parametrize(
    "call",
    [(7, 2), (7, 2, 3), (7, 2, 0), (7, 2, 5, 1), (8, 2, 1), (8, 2, 4, 1), (8, 2, 1, 0), (6, 2, 1),
     (4, 2), (4, 2, "x" * 101), (4, 2, "sect.cnc", OMITTED, OMITTED, 4), (4, 2, "sect.cnc", OMITTED, OMITTED, 8192),
     (5, 2, 3)],
)  # fmt: skip
def test_parameters_that_a_service_does_not_know_are_refused(call: tuple[object, ...]) -> None:
    rig = Rig()
    assert rig(*call) == 18
    assert (rig.channel.mode, rig.channel.return_how, rig.channel.sav) == (5, 1, 1)


@pytest.mark.covers("cpl.MCOPS", "cpl.MCOPS.7", "cpl.ncs.102", "cpl.MCODS.constants")
def test_parameters_have_their_types() -> None:
    rig = Rig()
    assert rig(7.0, 2.0, 4.0) == 0
    assert rig.channel.mode == Mode.MDI
    for call in ((7, 2, "5"), (7, 2, 5.5), (4, 2, 5), ("7", 2, 5)):
        with pytest.raises(Fault):
            rig(*call)
    assert rig(99, 2) == 102
    assert rig(0, 2) == 102


MODES = [(1, "JOG"), (2, "REFERENCE"), (4, "MDI"), (5, "AUTOMATIC"), (6, "PROGRAM_BLOCK"), (7, "SINGLE_STEP"),
         (10, "SINGLE_BLOCK"), (11, "RETURN_TO_PATH"), (12, "DEBUG_BLOCK"), (13, "DEBUG_AUTOMATIC"),
         (14, "JOG_WORKPIECE")]  # fmt: skip


@pytest.mark.parametrize(
    ("number", "name"),
    [
        pytest.param(
            number,
            name,
            marks=pytest.mark.covers(
                "cpl.MCOPS.7", *([] if number in (11, 14) else [f"cpl.MCOPS.7.mode.{number}"])
            ),
        )
        for number, name in MODES
    ],
)
def test_the_mode_is_switched_by_its_number(number: int, name: str) -> None:
    rig = Rig(mode=Mode.NONE)
    assert rig(7, 2, number) == 0
    assert rig.channel.mode is Mode[name]
    buffer = Field("I", (1,))
    assert rig.coupling.mcods(31, 2, Box("V", "R", 0), buffer, 1) == 0
    assert buffer[1] == number


@pytest.mark.covers("cpl.MCOPS.7", "cpl.ncs.13")
def test_a_selected_program_or_the_plc_keeps_the_mode() -> None:
    rig = Rig()
    rig.select()
    for number in (1, 2, 4, 11, 12, 13, 14):
        assert rig(7, 2, number) == 13
        assert rig.channel.mode == Mode.AUTOMATIC
    for number in (6, 7, 10, 5):
        assert rig(7, 2, number) == 0
        assert rig.channel.mode == number
    assert rig(5, 2, 0) == 0
    rig.partner.mode_by_plc.add(2)
    assert rig(7, 2, 6) == 13
    assert rig(7, 1, 6) == 0


@pytest.mark.covers("cpl.MCOPS.6", "cpl.MCOPS.7")
@pytest.mark.parametrize("mode", [6, 7, 10, 12])
def test_single_blocks_stop_one_after_the_other(mode: int) -> None:
    rig = Rig()
    assert rig(7, 2, mode) == 0
    rig.select()
    for number in range(1, 4):
        assert rig(6, 2) == 0
        rig.until(Sav.READY)
        assert rig.channel.blocks == number


@pytest.mark.covers("cpl.MCOPS.5", "cpl.MCOPS.5.type.2", "cpl.ncs.10")
def test_a_program_is_left_and_selected_again_if_the_channel_does_that() -> None:
    rig = Rig()
    assert rig(5, 2, 2) == 10
    rig.channel.reselection = True
    rig.select()
    assert rig(6, 2, cycles=3) == 0
    assert rig(5, 2, 0) == 0
    assert rig.state() == (11, 3)
    assert rig.channel.program == "sect.cnc"
    assert rig(5, 2, 2) == 0
    assert rig.state() == (1, 3)
    assert rig.channel.program == ""


RETURNS = [(1, 1), (2, 2), (3, 3), (1, 3)]


@pytest.mark.covers(
    "cpl.MCOPS.8",
    "cpl.MCODS.46",
    "cpl.MCODS.46.elem.1",
    "cpl.MCODS.46.elem.2",
    "cpl.MCOPS.8.how.1",
    "cpl.MCOPS.8.how.2",
    "cpl.MCOPS.8.how.3",
    "cpl.MCOPS.8.where.1",
    "cpl.MCOPS.8.where.2",
    "cpl.MCOPS.8.where.3",
)
@pytest.mark.parametrize(("how", "where"), RETURNS)
def test_the_return_strategy_is_shown(how: int, where: int) -> None:
    rig = Rig()
    assert rig(8, 2, how, where) == 0
    buffer = Field("I", (3,))
    assert rig.coupling.mcods(46, 2, Box("V", "R", 0), buffer, 3) == 0
    assert [buffer[1], buffer[2], buffer[3]] == [how, where, 0]


def test_jog_movements_are_recorded_for_the_return_until_that_is_stopped() -> None:
    rig = Rig()
    buffer, version = Field("I", (3,)), Box("V", "R", 0)
    assert rig(7, 2, 11) == 0
    assert rig.coupling.mcods(46, 2, version, buffer, 3) == 0
    assert buffer[3] == 1
    assert rig(9, 2) == 0
    stopped = Field("I", (3,))
    assert rig.coupling.mcods(46, 2, version, stopped, 3) == 0
    assert stopped[3] == 0


@pytest.mark.covers("cpl.MCODS.32.ipo.2", "cpl.MCODS.32.elem.2", "cpl.MCODS.87.bit.5")
def test_the_interpolator_runs_down_when_the_feed_is_held() -> None:
    rig = Rig(block_cycles=6)
    rig.select("N50", "N50")
    assert rig(6, 2, cycles=2) == 0
    assert rig.state() == (3, 1)
    rig.partner.hold(2)
    assert rig.state() == (3, 2)
    rig.partner.advance(1)
    assert rig.state() == (3, 3)
    held = rig.image.axes[1].setpoint
    rig.partner.advance(5)
    assert rig.image.axes[1].setpoint == held
    assert rig.channel.other_waits == Wait.FEED_HOLD
    rig.partner.hold(2, False)
    assert rig.state() == (3, 1)
    rig.until(Sav.INACTIVE)
    assert rig.image.axes[1].setpoint == 103.5


@pytest.mark.covers("cpl.MCODS.39")
def test_a_dwell_is_shown_while_it_lasts() -> None:
    rig = Rig(mode=Mode.MDI, block_cycles=3)
    assert rig(4, 2, "G4 F2", OMITTED, OMITTED, 32 + 128, cycles=1) == 0
    assert rig.channel.dwell
    rig.until(Sav.INACTIVE)
    assert not rig.channel.dwell


def test_an_abandoned_call_does_not_answer_another_one() -> None:
    rig = Rig()
    waiting = (4, 2, "sect.cnc", OMITTED, OMITTED, 2)
    assert rig.coupling.mcops(*waiting) is BLOCKED
    assert rig.coupling.mcops(4, 2, "nothing.cnc", OMITTED, OMITTED, 2) == 11
    assert rig.coupling.mcops(2, 2) == 0
    rig.partner.advance(1)
    assert rig.coupling.mcops(*waiting) is BLOCKED
    rig.partner.advance(1)
    assert rig.coupling.mcops(*waiting) == 0
    assert rig.state() == (11, Ipo.STOPPED)
