"""What clients of later series ask a served control for beside the library's manual, against figures made by hand."""

from __future__ import annotations

import struct

import pytest

from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.fanuc.wire import (
    Frame,
    FrameReader,
    FrameType,
    Reply,
    Request,
    Value8,
    read_replies,
    write_requests,
)
from polycnc.servers.focas import PROFILES, FocasControl, Session, load_profile
from support.focas_scenes import ALL, open_session, r

LATER = ("16i", "0i-d", "31i")


def served(profile: str, program: str) -> tuple[PowerMate, Session]:
    """Return a control that has begun a program, and a session of it."""
    control = PowerMate(3)
    control.programs.register(77, program)
    control.select_program(77)
    session, _ = open_session(FocasControl(control, load_profile(profile)))
    return control, session


def ask(session: Session, *requests: Request) -> list[Reply]:
    (answer,) = FrameReader().feed(
        session.receive(bytes(Frame(FrameType.COMMANDS, write_requests(requests))))
    )
    return [reply for _, reply in read_replies(answer.body)]


def macros(session: Session, *numbers: int) -> list[float | None]:
    """Return variables, -1 for those that there are not."""
    found = ask(session, *(r(0x15, number, number) for number in numbers))
    return [Value8.from_wire(each.payload).number if each.status == 0 else -each.status for each in found]


PROGRAM = """O0077
N12 G90 G55 G1 X12.5 Y-3.25 F300 S400 M3 T7
#3901=19
#1102=1
N13 G43 H2 Z-4.5
N14 G91 G2 X100. I50.
M30
"""


@pytest.mark.parametrize("profile", LATER)
def test_system_variables_are_those_of_the_block_that_is_executed(profile: str) -> None:
    control, session = served(profile, PROGRAM)
    control.control.offsets.set("G55", {"X": 2.5})
    control.control.offsets.set("EXT", {"Y": 0.125})
    control.control.offsets.set("G54.P2", {"Z": -7.75})
    control.tool_offsets.set_all({2: 1500})
    assert macros(session, 4001, 4003, 4014, 4016, 4120, 5041, 5221) == [0, 90, 54, 69, 0, 0, 0]
    control.cycle_start()
    control.advance(9000)
    assert control.execution.sequence == 14
    assert macros(session, 4001, 4002, 4003, 4006, 4008, 4014) == [2, 17, 91, 21, 43, 55]
    assert macros(session, 4109, 4111, 4113, 4114, 4115, 4119, 4120) == [300, 2, 3, 14, 77, 400, 7]
    machine = control.status().axes
    found = macros(session, 5001, 5021, 5041, 5042, 5043, 5083, 5003)
    assert found == pytest.approx(
        [
            112.5,
            machine["X"].machine,
            machine["X"].machine - 2.5,
            machine["Y"].machine - 0.125,
            -4.5 + 1.5,
            1.5,
            -4.5,
        ],
        abs=0.0011,
    )
    assert macros(session, 5202, 5241, 7023, 10002, 1102, 3901, 3001) == [0.125, 2.5, -7.75, 1.5, 1, 19, 9000]
    assert macros(session, 3011, 3012) == [20000101, 9]
    assert macros(session, 9000, 5004, 4130, 13002, 5244) == [-3] * 5


def test_the_library_of_the_manual_reads_no_system_variables() -> None:
    _, session = served("power-mate", PROGRAM)
    assert macros(session, 3901, 4001, 5041, 5221, 10002) == [-3] * 5


def test_system_variables_as_doubles() -> None:
    control, session = served("31i", PROGRAM)
    control.control.parts.set(made=19, required=40)
    (found,) = ask(session, r(0xA7, 3901, 2))
    assert struct.unpack(">2d", found.payload) == (19.0, 40.0)


@pytest.mark.parametrize("profile", ["power-mate", *LATER])
def test_a_stop_in_a_macro_is_a_message_of_its_own_type(profile: str) -> None:
    control, session = served(profile, "O0077\nG1X2.F3000\n#3006=5(CHECK TOOL)\nM30\n")
    control.operator_message(2001, "OIL LOW")
    control.cycle_start()
    control.advance(4000)
    outside, stop, other = ask(session, r(0x34, 0), r(0x34, 4), r(0x34, 1))
    assert struct.unpack_from(">3i", outside.payload) == (2001, 0, 7)
    assert struct.unpack_from(">3i", stop.payload) == (3006, 4, 10)
    assert [len(each.payload) for each in (outside, stop, other)] == [268, 268, 0]
    assert stop.payload[12:23] == b"CHECK TOOL\0"


@pytest.mark.parametrize(("profile", "kind"), [("power-mate", 3), ("16i", 3), ("0i-d", 8), ("31i", 8)])
def test_the_alarm_of_a_macro_has_the_type_of_its_series(profile: str, kind: int) -> None:
    control, session = served(profile, "O0077\nG1X2.F3000\n#3000=12(TOOL BROKEN)\nM30\n")
    control.cycle_start()
    control.advance(4000)
    every, own, others, bits = ask(
        session, r(0x23, ALL, 10, 2, 64), r(0x23, kind, 10, 1, 32), r(0x23, 11 - kind, 10, 1, 32), r(0x1A)
    )
    assert struct.unpack_from(">4i", every.payload) == (3012, kind, 0, 11)
    assert (len(every.payload), len(own.payload), len(others.payload)) == (80, 48, 0)
    assert bits.payload == (1 << kind).to_bytes(4, "big")
    control.raise_alarm(417, axis=2)
    (both,) = ask(session, r(0x1A))
    assert both.payload == (1 << kind | 1 << 6).to_bytes(4, "big")


@pytest.mark.parametrize("profile", ["0i-d", "31i"])
def test_the_load_of_the_spindle_follows_its_speed(profile: str) -> None:
    control, session = served(profile, "O0077\nS1500M3\nG4X60.\nM30\n")
    control.cycle_start()
    control.advance(4000)
    meter, raw, most = ask(session, r(0x40, 4, ALL), r(0x40, 0, 1), r(0x40, 1, 1))
    loads = [Value8.from_wire(meter.payload[at : at + 8]).number for at in range(0, 64, 8)]
    assert loads == [25.0, *[0.0] * 7]
    assert Value8.from_wire(raw.payload).number == 25.0
    assert Value8.from_wire(most.payload).number == 6000.0


@pytest.mark.parametrize("profile", ["power-mate", *LATER])
def test_a_program_past_a_limit_is_an_overtravel_of_its_axis(profile: str) -> None:
    control, session = served(profile, "O0077\nG1X2.F3000\nX3.Y-7.51\nM30\n")
    control.parameters.set(1321, -7500, 2)
    control.cycle_start()
    control.advance(4000)
    found, bits = ask(session, r(0x23, ALL, 10, 1, 32), r(0x1A))
    assert struct.unpack_from(">4i", found.payload) == (501, 4, 2, 16)
    assert found.payload[16:33] == b"OVER TRAVEL : -Y\0"
    assert bits.payload == (1 << 4).to_bytes(4, "big")


@pytest.mark.parametrize("profile", ["power-mate", *LATER])
@pytest.mark.parametrize(
    ("asked", "status"),
    [
        (r(0x15, 100, 532), 3),  # some are not there
        (r(0x15, 100, 533), 2),  # more than any frame holds
        (r(0x15, 500, 999), 2),
        (r(0x15, 533, 532), 3),
        (r(0x23, 20, 10, 2, 64), 4),
        (r(0x23, -2, 10, 2, 64), 4),
        (r(0x23, ALL, 10, 3, 64), 4),
        (r(0x23, ALL, -1, 2, 64), 2),
        (r(0x23, ALL, 10, 2, 65), 2),
        (r(0x56, 0), 1),
        (r(0x56, 2), 1),
        (r(0x56, 3), 1),
        (r(0x56, 4), 4),
        (r(0x56, -1), 4),
        (r(0x120, 5), 3),
        (Request(0x24, path=2), 11),
        (Request(0x15, (500, 500, 0, 0), path=9), 11),
        (Request(0x7FF, path=2), 1),
    ],
)
def test_what_is_refused_is_refused_with_the_code_of_a_control(
    profile: str, asked: Request, status: int
) -> None:
    _, session = served(profile, PROGRAM)
    (found,) = ask(session, asked)
    assert (found.status, found.payload) == (status, b"")


def test_a_range_is_as_long_as_the_frames_of_the_series() -> None:
    for profile, most in (("16i", (1450 - 2 - 16) // 8), ("31i", (2910 - 2 - 16) // 8)):
        control, session = served(profile, PROGRAM)
        control.macros.set(500 + most - 1, -7.5)
        whole, longer = (ask(session, r(0x15, 500, 500 + count - 1))[0] for count in (most, most + 1))
        assert (whole.status, len(whole.payload), longer.status) == (0, 8 * most, 2)
        assert Value8.from_wire(whole.payload[-8:]).number == -7.5


@pytest.mark.parametrize("profile", ["power-mate", *LATER])
def test_the_fifth_timer_is_that_of_an_external_signal(profile: str) -> None:
    control, session = served(profile, PROGRAM)
    control.parameters.set(6755, 12345)
    control.parameters.set(6756, 678)
    (found,) = ask(session, r(0x120, 4))
    assert struct.unpack("<2i", found.payload) == (678, 12345)


def test_a_later_series_holds_more_programs() -> None:
    assert [load_profile(name).program_characters for name in PROFILES] == [
        128_000,
        128_000,
        128_000,
        1_000_000,
    ]


@pytest.mark.parametrize("profile", LATER)
def test_modal_codes_are_read_as_one_range(profile: str) -> None:
    control, session = served(profile, PROGRAM)
    alone = [macros(session, number)[0] for number in range(4001, 4023)]
    (together,) = ask(session, r(0x15, 4001, 4022))
    assert together.status == 0
    assert [Value8.from_wire(together.payload[at : at + 8]).number for at in range(0, 8 * 22, 8)] == alone
    control.cycle_start()
    control.advance(200)
    (together,) = ask(session, r(0x15, 4001, 4022))
    found = [Value8.from_wire(together.payload[at : at + 8]).number for at in range(0, 8 * 22, 8)]
    assert found[:3] == [1.0, 17.0, 90.0]
    assert (found[13], found[3], found[21]) == (55.0, 0.0, 0.0)


_FIELDS = "number size array unit dimension input display others"


@pytest.mark.parametrize("profile", ["0i-d", "31i"])
def test_what_parameters_and_diagnosis_data_are(profile: str) -> None:
    _, session = served(profile, PROGRAM)
    (found,) = ask(session, r(0xA0, 1319, 3))
    before, behind, *rows = struct.unpack(">2i" + "i7h2x" * 3, found.payload)
    assert (before, behind) == (1301, 1402)
    assert [rows[k : k + 3] for k in (0, 8, 16)] == [[1320, 4, 3], [1321, 4, 3], [1401, 0, 0]]
    numbers = [rows[k] for k in (0, 8, 16)]
    types = ask(session, *(r(0x8D, number, number, ALL) for number in numbers))
    assert [struct.unpack_from(">ih", each.payload)[0] for each in types] == numbers
    (found,) = ask(session, r(0xA2, 302, 3))
    before, behind, *rows = struct.unpack(">2i" + "i7h2x" * 3, found.payload)
    assert (before, behind) == (301, 403)
    assert [rows[k : k + 3] for k in (0, 8, 16)] == [[308, 1, 3], [309, 1, 3], [400, 0, 0]]
    refused = ask(session, r(0xA0, 1, 0), r(0xA0, 32_000, 1), r(0xA2, 1, -1), r(0xA2, 32_000, 1))
    assert [each.status for each in refused] == [2, 3, 2, 3]
    old, _ = ask(served("16i", PROGRAM)[1], r(0xA0, 1, 1), r(0xA2, 1, 1))
    assert old.status == 1


@pytest.mark.parametrize("profile", ["power-mate", *LATER])
def test_executed_blocks_are_counted(profile: str) -> None:
    def count() -> int:
        (found,) = ask(session, r(0x35))
        return int.from_bytes(found.payload, "big")

    program = (
        "O0077\nN1G1X1.F6000\nN2X2.\nX2.\n#1=3\nWHILE[#1GT0]DO1\nG91Y1.\n#1=#1-1\nEND1\nG4X0.01\nM8\nM30\n"
    )
    control, session = served(profile, program)
    assert count() == 0
    control.cycle_start()
    seen = []
    while control.control.channels[0].active:
        control.advance(1)
        seen.append(count())
    assert seen == sorted(seen)
    assert seen[-1] == len(["N1", "N2", "Y", "Y", "Y", "G4", "M8", "M30"])
    control.cycle_start()
    control.advance(3)
    assert count() == 0


def test_the_language_of_the_display_and_data_of_spindle_and_motors() -> None:
    control, session = served("31i", "O0077\nS1500M3\nG4X60.\nM30\n")
    (language,) = ask(session, r(0x8D, 3281, 3281))
    assert struct.unpack_from(">ihh", language.payload) == (3281, 0, 1)
    control.cycle_start()
    control.advance(4000)
    rows = {}
    for number in (308, 309, 400, 403, 408, 410, 411, 418, 425, 710, 712):
        (found,) = ask(session, r(0x93, number, number, ALL))
        assert found.status == 0, number
        rows[number] = Value8.from_wire(found.payload[8:16]).number
    assert (rows[308], rows[309], rows[403], rows[410], rows[411]) == (25.0, 25.0, 25.0, 25.0, 1500.0)
    assert not any(rows[number] for number in (400, 408, 418, 425, 710, 712))
    assert [each.status for each in ask(session, r(0x93, 417, 417, ALL), r(0x93, 4901, 4901, ALL))] == [3, 3]


@pytest.mark.parametrize("profile", LATER)
def test_offsets_that_are_written_as_variables_act(profile: str) -> None:
    control, session = served(profile, "O0077\nG55G43H2G1Z1.F6000\nX0\nM30\n")
    values = {2002: 2.5, 5241: 7.25, 5243: -1.0, 500: 4.0}
    for number, value in values.items():
        (found,) = ask(session, r(0x16, number, number, data=bytes(Value8.of(value, 3))))
        assert found.status == 0, number
    assert macros(session, *values) == list(values.values())
    assert control.tool_offsets.get(2) == 2500
    control.cycle_start()
    control.advance(3000)
    assert control.machine.actual == {"X": 7.25, "Y": 0.0, "Z": 2.5}


@pytest.mark.parametrize("profile", LATER)
@pytest.mark.parametrize(
    ("first", "values", "status"),
    [
        (2001, (1.0, 1e6), 5),
        (5221, (1.0, 2.0, 1e6), 5),
        (5221, (1.0, 2.0, 3.0, 4.0), 3),  # there are three axes
        (5041, (1.0,), 3),
        (4001, (1.0,), 3),
        (2099, (1.0, 2.0), 3),  # there are 99
    ],
)
def test_offsets_that_are_refused_change_nothing(
    profile: str, first: int, values: tuple[float, ...], status: int
) -> None:
    control, session = served(profile, PROGRAM)
    data = b"".join(bytes(Value8.of(value, 3)) for value in values)
    (found,) = ask(session, r(0x16, first, first + len(values) - 1, data=data))
    assert found.status == status
    assert not len(control.control.tools)
    assert not control.control.offsets.get("G54", {})
