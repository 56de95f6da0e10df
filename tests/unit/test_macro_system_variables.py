"""The system variables of macros by number: which there are, which can only be read, and what they hold."""

from __future__ import annotations

from datetime import datetime

import pytest

from polycnc.cnc import ProgramRun, RunOptions
from polycnc.machine import Machine, load_machine
from polycnc.nc import ProgramText, load_dialect
from polycnc.nc.macro import MacroError, MacroLanguage, MacroVariables, SystemVariables

AXES = 3
POSITIONS = (5001, 5021, 5041, 5061, 5081, 5101)
MODAL = (
    1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 22, 107, 109, 111, 113, 114, 115, 119, 120, 130,
)  # fmt: skip
READ_ONLY = (
    3007, 3011, 3012, *(base + axis for base in POSITIONS for axis in range(AXES)),
    *(base + code for base in (4000, 4200) for code in MODAL),
)  # fmt: skip
WRITABLE = (
    3001, 3002, 3005, 3901, 3902, 2001, 2200, 2201, 2400, 10_001, 10_999, 11_001, 12_999, 13_001, 13_999,
    5201, 5203, 5221, 5323, 2500, 2506, 2600, 2706, 7001, 7003, 7943, 14_001, 14_023, 19_983,
)  # fmt: skip
NONE = (
    999, 2000, 2401, 2507, 2599, 2800, 2907, 3000, 3006, 3008, 3013, 3900, 3903, 4000, 4004, 4018, 4106, 4121, 4131,
    4204, 5004, 5020, 5024, 5044, 5084, 5104, 5200, 5204, 5224, 5341, 7000, 7004, 7961, 10_000, 11_000, 13_000, 14_000,
    14_004, 20_001,
)  # fmt: skip


def attached(text: str = "M30\n") -> tuple[SystemVariables, ProgramRun]:
    """Return the variables at the end of a program."""
    system = SystemVariables(lambda: datetime(2031, 4, 27, 19, 6, 53))
    language = MacroLanguage(system=system)
    run = ProgramRun(
        Machine(load_machine(None)),
        ProgramText.from_text(text, "macro.tap"),
        load_dialect("fanuc"),
        language=language,
        options=RunOptions(stands_at_stops=False),
    )
    run.start()
    while run.active:
        run.advance(1_000_000)
    assert run.error is None, str(run.error)
    return system, run


@pytest.fixture(scope="module")
def plain() -> SystemVariables:
    return attached()[0]


@pytest.mark.parametrize("number", READ_ONLY)
def test_what_can_only_be_read_is_read_and_not_written(plain: SystemVariables, number: int) -> None:
    assert plain.has(number)
    before = plain.read(number)
    assert before is not None
    with pytest.raises(MacroError) as caught:
        plain.write(number, 7.25)
    assert caught.value.what == str(caught.value) == f"#{number} can only be read"
    assert caught.value.hint
    assert caught.value.code == "PS0116"
    assert plain.read(number) == before


@pytest.mark.parametrize("number", NONE)
def test_a_number_between_the_variables_is_none(plain: SystemVariables, number: int) -> None:
    assert not plain.has(number)
    with pytest.raises(MacroError) as read:
        plain.read(number)
    with pytest.raises(MacroError) as written:
        plain.write(number, 7.25)
    for caught in (read.value, written.value):
        assert caught.what == f"there is no variable #{number}"
        assert caught.code == "PS0115"


@pytest.mark.parametrize("number", WRITABLE)
def test_what_can_be_written_holds_it(number: int) -> None:
    system, _ = attached()
    assert system.has(number)
    system.write(number, -3.625)
    assert system.read(number) == -3.625
    others = [each for each in (*WRITABLE, *READ_ONLY) if each != number and each not in same_as(number)]
    assert all(system.read(each) != -3.625 for each in others)
    system.write(number, None)  # a vacant value counts as 0
    assert system.read(number) == 0.0


def same_as(number: int) -> set[int]:
    """Return the other numbers of the same offset."""
    twins = ((2001, 10_001), (2201, 11_001), (5201, 2500), (7001, 14_001), (7003, 14_003), (5323, 2706))
    return {two if one == number else one for one, two in twins if number in (one, two)}


@pytest.mark.parametrize(
    ("number", "tool", "name"),
    [
        (2007, 7, "wear_length_mm"), (2207, 7, "length_mm"), (10_431, 431, "wear_length_mm"),
        (11_431, 431, "length_mm"), (12_431, 431, "wear_radius_mm"), (13_431, 431, "radius_mm"),
    ],
)  # fmt: skip
def test_a_tool_has_its_numbers_in_the_unit_of_the_program(number: int, tool: int, name: str) -> None:
    system, run = attached()
    system.write(number, 2.375)
    assert getattr(run.channel.state.tables.tool(tool), name) == 2.375
    system, run = attached("G20\nM30\n")
    system.write(number, 2.375)
    assert getattr(run.channel.state.tables.tool(tool), name) == pytest.approx(2.375 * 25.4)
    assert system.read(number) == pytest.approx(2.375)


def test_offsets_and_positions_are_in_the_unit_of_the_program() -> None:
    system, run = attached("G20\n#5222=-1.5\nG54 G0 X0.7 Y2.3 Z-0.4\nM30\n")
    assert run.channel.state.tables.work_offset("G54")[1] == pytest.approx(-38.1)
    assert [system.read(number) for number in (5001, 5002, 5003)] == pytest.approx([0.7, 2.3, -0.4])
    assert [system.read(number) for number in (5021, 5022, 5023)] == pytest.approx([0.7, 0.8, -0.4])
    assert [system.read(number) for number in (5041, 5042, 5043)] == pytest.approx([0.7, 2.3, -0.4])
    assert [system.read(number) for number in (5101, 5102, 5103)] == pytest.approx([0.0, 0.0, 0.0])


def test_a_length_in_force_is_in_no_position_of_the_program() -> None:
    system, _ = attached("G0 X3.5 Y-1.25\n#11004=7.5\nG43 H4 Z2.25\nM30\n")
    assert [system.read(number) for number in (5081, 5082, 5083)] == [0.0, 0.0, 7.5]
    assert system.read(5023) == pytest.approx(9.75)
    assert system.read(5043) == pytest.approx(9.75)  # with the length, as the manual's picture has it
    assert system.read(5063) == system.read(5043)  # without a skip: where it stands


def test_date_and_time_are_those_of_the_clock() -> None:
    system, _ = attached()
    assert system.read(3011) == 20310427.0
    assert system.read(3012) == 190653.0


def test_timers_count_from_what_was_written() -> None:
    system, run = attached()
    system.write(3001, 1700.0)
    system.write(3002, 2.5)
    machine = run.channel.machine
    before = machine.clock.now_s
    machine.advance(450)
    passed = machine.clock.now_s - before
    assert passed > 0.0
    assert system.read(3001) == pytest.approx(1700.0 + 1000.0 * passed)
    assert system.read(3002) == pytest.approx(2.5 + passed / 3600.0)


@pytest.mark.parametrize(("number", "most"), [(3003, 3), (3004, 7)])
def test_what_is_suppressed_is_a_sum_of_bits(number: int, most: int) -> None:
    system, run = attached()
    for value in range(most + 1):
        system.write(number, float(value))
        assert system.read(number) == value
        now = run.channel.suppressed
        bits = (now.single_block, now.answers) if number == 3003 else (now.hold, now.override)
        assert bits == (bool(value & 1), bool(value & 2))
    for wrong in (-1.0, 0.5, most + 1.0):
        with pytest.raises(MacroError) as caught:
            system.write(number, wrong)
        assert caught.value.code == "PS0119"
        assert f"#{number} cannot be {wrong:g}" in caught.value.what
        assert system.read(number) == most


MODES = [
    ("G2 X4 Y0 R3 F200", {1: 2}), ("G18", {2: 18}), ("G19", {2: 19}), ("G91", {3: 91}),
    ("G95 F.2", {5: 95, 109: 0.2}),
    ("G93 G1 X1 F30", {5: 93, 1: 1}), ("G20", {6: 20}), ("G43 H7 Z9", {8: 43, 111: 7}), ("G44 H9 Z9", {8: 44, 111: 9}),
    ("G51 X0 Y0 P500", {11: 51}), ("G96 S150", {13: 96, 119: 150}), ("G57", {14: 57}),
    ("G54.1 P31", {14: 54.1, 130: 31}),
    ("G61", {15: 61}), ("G68 X0 Y0 R20", {16: 68}), ("G51.1 X3", {22: 51.1}),
    ("G99 G81 X5 Z-2 R1 F99", {9: 81, 10: 99}),
    ("G41 D8 G1 X30 F500", {7: 41, 107: 8}), ("G42 D5 G1 X30 F500", {7: 42, 107: 5}),
    ("S731 M3", {13: 97, 119: 731, 113: 3}),
    ("T12", {120: 12}), ("F321.5", {109: 321.5}), ("G0 X1", {1: 0, 2: 17, 3: 90, 5: 94, 6: 21, 7: 40, 8: 49, 10: 98,
     11: 50, 12: 67, 13: 97, 14: 54, 15: 64, 16: 69, 17: 15, 22: 50.1, 107: 0, 111: 0, 113: 0, 120: 0, 130: 0}),
]  # fmt: skip


@pytest.mark.parametrize(("block", "codes"), MODES, ids=[block for block, _ in MODES])
def test_modal_codes_are_told_by_their_group(block: str, codes: dict[int, float]) -> None:
    reads = "".join(f"#{500 + place}=#{4000 + code}\n" for place, code in enumerate(codes))
    later = "".join(f"#{550 + place}=#{4200 + code}\n" for place, code in enumerate(codes))
    language = MacroLanguage(MacroVariables("b"))
    run = ProgramRun(
        Machine(load_machine(None)),
        ProgramText.from_text(f"O77\nG21 G90 G17 G94\nF400\n{block}\n{reads}{later}M30\n", "macro.tap"),
        load_dialect("fanuc"),
        language=language,
        options=RunOptions(stands_at_stops=False),
    )
    run.start()
    while run.active:
        run.advance(1_000_000)
    assert run.error is None, str(run.error)
    for first in (500, 550):
        found = {code: language.variables.get(first + place) for place, code in enumerate(codes)}
        assert found == {code: pytest.approx(value) for code, value in codes.items()}


def test_waiting_variables_are_those_of_what_is_executed(plain: SystemVariables) -> None:
    waiting = (5021, 5041, 5061, 5101, 3001, 3002, 3011, 3012, 3901, 3902, 3003, 3004, 4201, 4330)
    assert all(plain.waits(number) for number in waiting)
    assert not any(plain.waits(number) for number in (5001, 5081, 3005, 3007, 2001, 5221, 4001, 4130, 7001))


@pytest.mark.parametrize(
    ("kind", "there", "not_there"),
    [
        ("a", (1, 33, 100, 149, 500, 531), (34, 99, 150, 199, 499, 532, 999)),
        ("b", (1, 33, 100, 199, 500, 999), (34, 99, 200, 499, 1000)),
        ("c", (1, 33, 100, 199, 500, 699), (34, 99, 200, 499, 700, 999)),
    ],
)
def test_each_kind_of_variables_has_its_ranges(
    kind: str, there: tuple[int, ...], not_there: tuple[int, ...]
) -> None:
    variables = MacroVariables(kind)  # type: ignore[arg-type]
    for number in there:
        variables.set(number, number + 0.5)
    assert [variables.get(number) for number in there] == [number + 0.5 for number in there]
    for number in not_there:
        with pytest.raises(MacroError) as read:
            variables.get(number)
        with pytest.raises(MacroError) as written:
            variables.set(number, 1.0)
        assert {read.value.code, written.value.code} == {"PS0115"}
    with pytest.raises(MacroError):
        variables.set_all({there[2]: 3.0, not_there[0]: 4.0})
    assert variables.get(there[2]) == there[2] + 0.5  # nothing half done
    variables.clear_common()
    assert [variables.get(number) for number in there] == [
        None if 100 <= number < 500 else number + 0.5 for number in there
    ]
