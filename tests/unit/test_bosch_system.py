"""System functions of CPL: interface signals, PLC data, errors, time, tool data (Manual 003, chapter 4)."""

from __future__ import annotations

from collections.abc import Callable
from datetime import datetime
from functools import partial

import pytest

from polycnc.controllers.bosch.system import (
    ALL_CHANNELS,
    Category,
    ErrorList,
    Interface,
    PlcData,
    PlcRange,
    Signals,
    ToolDatabase,
    clock_ms,
    date_text,
    time_text,
)
from polycnc.errors import ProgramError
from polycnc.machine import Clock
from polycnc.nc.cpl import OMITTED, Fault, Field
from support.cpl_host import Ran, RecordingHost

ACTIVE = 2


class Control(RecordingHost):
    """A control with 3 channels, 5 axes and 2 spindles; programs run in channel 2."""

    def __init__(self) -> None:
        self.interface = Interface(3, 5, 2)
        self.plc = PlcData()
        self.errors = ErrorList(3)
        self.tools = ToolDatabase({1: 20, 2: 4})
        self.clock = Clock(0.004, datetime(2002, 7, 29, 12, 58, 1))
        self.setters: dict[str, Callable[..., None]] = {
            "IC": self._set_signal,
            "PLC": self.plc.write,
            "TDA": self.tools.write,
        }
        super().__init__(
            {
                "IC": partial(self.interface.read, ACTIVE),
                "PLC": self.plc.read,
                "GETERR": self.errors.read,
                "TDA": self.tools.read,
                "CLOCK": lambda: clock_ms(self.clock),
                "DATE": lambda: date_text(self.clock),
                "TIME": lambda: time_text(self.clock),
            }
        )

    def _set_signal(self, value: object, *place: object) -> None:
        self.interface.write(value, ACTIVE, *place)

    def setter(self, name: str) -> Callable[..., None]:
        return self.setters[name]


def failure(control: Control, line: str) -> ProgramError:
    with pytest.raises(ProgramError) as caught:
        Ran(f"10 DIM E%(2,3)\n20 {line}\n", control)
    assert caught.value.position is not None
    assert caught.value.position.line == 2
    return caught.value


GROUPS = [(0, 112, 0, 3), (1, 112, 1, 5), (2, 112, 1, 2), (3, 96, 0, 3), (4, 64, 1, 5), (5, 64, 1, 2), (6, 32, 1, 1),
          (7, 32, 1, 1), (8, 8, 1, 1), (9, 8, 1, 1)]  # fmt: skip


@pytest.mark.parametrize(
    ("group", "size", "first", "last"),
    [pytest.param(*row, marks=pytest.mark.covers(f"cpl.IC.group.{row[0]}", "cpl.IC")) for row in GROUPS],
)
def test_signals_of_each_group_are_read_with_their_ranges(
    group: int, size: int, first: int, last: int
) -> None:
    control = Control()
    default = ACTIVE if group in (0, 3) else 1
    control.interface.set_bit(Signals(group), last, size - 1, True)
    control.interface.set_bit(Signals(group), default, 5, True)
    ran = Ran(
        f"10 #A?=IC({size - 1},{group},{last}) : #B?=IC({size - 2},{group},{last}) : #C?=IC(5,{group})"
        f" : #D?=IC(5,{(group + 1) % 6},1)\n",
        control,
    )
    assert (ran["#A?"], ran["#B?"], ran["#C?"], ran["#D?"]) == (True, False, True, False)
    for place in (f"{size},{group}", f"-1,{group}", f"0,{group},{first - 1}", f"0,{group},{last + 1}"):
        assert "INVALID PARAMETER" in failure(control, f"A?=IC({place})").what
    assert Interface(3, 5, 2, pnc=False).sizes[9] == 6


@pytest.mark.covers("cpl.IC", "cpl.ex.2408")
def test_the_6th_input_of_the_2nd_axis_has_bit_5() -> None:
    control = Control()
    control.interface.set_bit(Signals.AXIS_INPUTS, 2, 5, True)
    ran = Ran("40 #A?=IC(5,1,2)\n50 #B?=IC(5,1,1)\n60 #C?=IC(4,1,2)\n", control)
    assert (ran["#A?"], ran["#B?"], ran["#C?"]) == (True, False, False)


@pytest.mark.covers("cpl.IC", "cpl.ex.2414", "cpl.IC.group.0")
def test_ic_sets_outputs_81_to_96_of_a_channel_through_group_0() -> None:
    control = Control()
    Ran("40 IC(80,0,1)=TRUE : IC(95)=TRUE : IC(94,0,3)=TRUE : IC(94,0,3)=FALSE\n", control)
    outputs = [
        (channel, bit)
        for channel in range(4)
        for bit in range(96)
        if control.interface.bit(Signals.CHANNEL_OUTPUTS, channel, bit)
    ]
    assert outputs == [(1, 80), (2, 95)]
    ran = Ran("10 #A?=IC(80,3,1) : #B?=IC(80,0,1)\n", control)
    assert (ran["#A?"], ran["#B?"]) == (True, False)
    for line in (
        "IC(79,0,1)=TRUE",
        "IC(96,0,1)=TRUE",
        "IC(80,3,1)=TRUE",
        "IC(80,1,1)=TRUE",
        "IC(80,0,4)=TRUE",
    ):
        assert "INVALID PARAMETER" in failure(control, line).what


RANGES = [(1, "INPUT"), (2, "OUTPUT"), (3, "MARKER"), (5, "DATA_BUFFER"), (6, "DATA_FIELD"), (9, "SPECIAL_MARKER"),
          (10, "SYSTEM"), (11, "EXTENDED_INPUT"), (12, "EXTENDED_OUTPUT")]  # fmt: skip


@pytest.mark.parametrize(
    ("kind", "name"),
    [pytest.param(*row, marks=pytest.mark.covers(f"cpl.PLC.type.{row[0]}")) for row in RANGES],
)
@pytest.mark.covers("cpl.PLC")
def test_ranges_of_the_plc_are_read_by_byte_address(kind: int, name: str) -> None:
    control = Control()
    control.plc.ranges = {each: bytearray(range(100, 120)) for each in PlcRange}
    control.plc.ranges[PlcRange[name]] = bytearray(range(1, 17))
    ran = Ran(f"10 #A%=PLC({kind},,10,1) : #B%=PLC({kind},,14,2) : #C%=PLC({kind},,12,4)\n", control)
    assert (ran["#A%"], ran["#B%"], ran["#C%"]) == (11, 0x100F, 0x100F0E0D)
    for line in (f"A%=PLC({kind},,16,1)", f"A%=PLC({kind},,13,4)", f"A%=PLC({kind},,-1,1)", f"A%=PLC({kind},3,0,1)",
                 f"A%=PLC({kind},,0,3)", f"PLC({kind},,0,1)=5"):  # fmt: skip
        assert "INVALID PARAMETER" in failure(control, line).what


@pytest.mark.covers(
    "cpl.PLC.size.1", "cpl.PLC.size.2", "cpl.PLC.size.4", "cpl.PLC.type.4", "cpl.ex.2465", "cpl.PLC"
)
def test_data_modules_are_read_and_those_released_written_in_three_sizes() -> None:
    control = Control()
    control.plc.modules = {97: bytearray(6), 98: bytearray(b"\xff\xfe\x34\x12\xff\xff\xff\xff")}
    control.plc.first_writable, control.plc.writable = 98, 1
    ran = Ran("90 #J%=PLC(4,98,2,2) : #K%=PLC(4,98,0,1) : #L%=PLC(4,98,4,4) : #M%=PLC(4,98,0,2)\n", control)
    assert [ran[name] for name in ("#J%", "#K%", "#L%", "#M%")] == [0x1234, 255, -1, 0xFEFF]
    Ran("10 PLC(4,98,2,2)=65535 : PLC(4,98,0,1)=7 : PLC(4,98,4,4)=-2\n", control)
    assert control.plc.modules[98] == b"\x07\xfe\xff\xff\xfe\xff\xff\xff"
    for line in ("PLC(4,97,0,1)=1", "PLC(4,99,0,1)=1", "PLC(4,98,0,1)=256", "PLC(4,98,0,2)=-1", "PLC(4,98,7,2)=1",
                 "A%=PLC(4,,0,1)", "A%=PLC(13,,0,1)", "A%=PLC(0,,0,1)"):  # fmt: skip
        assert "INVALID PARAMETER" in failure(control, line).what
    assert control.plc.modules[97] == bytes(6)


@pytest.mark.covers("cpl.PLC", "cpl.ex.2462")
def test_byte_10_of_the_inputs_is_read_with_an_empty_module() -> None:
    control = Control()
    control.plc.ranges[PlcRange.INPUT] = bytearray(10) + b"\xa5"
    assert Ran("40 #I%=PLC(1,,10,1)\n", control)["#I%"] == 165


@pytest.mark.covers("cpl.PLC.type.7", "cpl.PLC.type.8")
@pytest.mark.covers("cpl.PLC")
def test_timers_give_ms_and_counters_their_value_whatever_the_size() -> None:
    control = Control()
    control.plc.timers_ms[3] = 70_250
    control.plc.counters[3] = 815
    ran = Ran("10 #T%=PLC(7,,3,1) : #C%=PLC(8,,3,4) : #D%=PLC(8,,3)\n", control)
    assert (ran["#T%"], ran["#C%"], ran["#D%"]) == (70_250, 815, 815)
    assert "INVALID PARAMETER" in failure(control, "A%=PLC(7,,4,1)").what


@pytest.mark.covers("cpl.CLOCK", "cpl.ex.2476")
def test_differences_of_clock_are_ms() -> None:
    control = Control()
    control.clock.tick(100)
    before = Ran("10 #S%=CLOCK\n", control)["#S%"]
    control.clock.tick(377)
    assert before == 400
    assert Ran("10 #S%=CLOCK\n", control)["#S%"] == 1908
    control.clock.tick(2**31 // 4 - 477)
    assert clock_ms(control.clock) == 0


@pytest.mark.covers("cpl.DATE", "cpl.TIME", "cpl.ex.2494", "cpl.ex.2502")
def test_date_and_time_are_texts() -> None:
    control = Control()
    control.clock.tick(250 * 64)
    ran = Ran('10 DIM A$(20)\n20 A$=DATE : #A?=A$="29.07."\n30 A$=TIME : #B?=A$="12.59.05"\n', control)
    assert (ran["#A?"], ran["#B?"]) == (True, True)


def errors() -> ErrorList:
    """The errors of the manual's information dialog, and one of all channels and another channel."""
    found = ErrorList(3)
    found.add(1856, 2, Category.CONTROL_OR_DRIVE)
    found.add(777, 3, Category.PART_PROGRAM)
    found.add(1938, 2, Category.PART_PROGRAM)
    found.add(555, ALL_CHANNELS, Category.HARDWARE)
    found.add(1971, 2, Category.PART_PROGRAM)
    found.add(444, 2)
    return found


@pytest.mark.covers(
    "cpl.GETERR", "cpl.ex.2594", "cpl.GETERR.elem.1", "cpl.GETERR.elem.2", "cpl.GETERR.elem.3"
)
def test_the_first_part_program_error_of_a_channel_is_read() -> None:
    control = Control()
    control.errors.errors = errors().errors
    ran = Ran(
        """10 DIM ERRNO%(5,3)
30 CHAN%=2:CATEGORY%=6
40 #ERG%=GETERR(CHAN%,CATEGORY%,ERRNO%,1)
50 #A%=ERRNO%(1,1) : #B%=ERRNO%(1,2) : #C%=ERRNO%(1,3) : #D%=ERRNO%(2,1)
""",
        control,
    )
    assert [ran[name] for name in ("#ERG%", "#A%", "#B%", "#C%", "#D%")] == [2, 1938, 2, 6, 0]


@pytest.mark.covers(
    "cpl.GETERR.ret.n", "cpl.GETERR.use", "cpl.GETERR.elem.2", "cpl.GETERR.elem.3", "cpl.GETERR"
)
def test_errors_come_in_the_order_of_their_time() -> None:
    found = errors()
    field = Field("I", (6, 3))
    assert found.read(2, OMITTED, field, 6) == 5
    assert [field[row, 1] for row in range(1, 7)] == [1856, 1938, 555, 1971, 444, 0]
    assert [field[row, 2] for row in range(1, 7)] == [2, 2, -1, 2, 2, 0]
    assert [field[row, 3] for row in range(1, 7)] == [2, 6, 4, 6, 0, 0]
    assert found.read(-1, 0, field, 6) == 6
    assert [field[row, 1] for row in range(1, 7)] == [1856, 777, 1938, 555, 1971, 444]
    assert found.read(1, OMITTED, field) == 1
    assert [field[row, 1] for row in range(1, 3)] == [555, 0]
    assert found.read(2, OMITTED, field) == 5  # one is read where no number is given
    assert [field[row, 1] for row in range(1, 4)] == [1856, 0, 0]
    found.clear(2)
    assert found.read(-1, OMITTED, field) == 2


@pytest.mark.parametrize(
    "category", [pytest.param(each, marks=pytest.mark.covers(f"cpl.GETERR.cat.{each}")) for each in range(11)]
)
@pytest.mark.covers("cpl.GETERR")
def test_errors_are_chosen_by_category(category: int) -> None:
    found = ErrorList(2)
    for each in range(11):
        found.add(2000 + each, 1, Category(each))
    field = Field("I", (12, 3))
    count = found.read(1, category, field, 12)
    assert count == (11 if category == 0 else 1)
    assert field[1, 1] == 2000 + category
    assert field[1, 3] == category


@pytest.mark.covers("cpl.ex.2550", "cpl.GETERR")
def test_more_errors_than_the_field_holds_are_not_read() -> None:
    found = ErrorList(1)
    for number in range(1, 121):
        found.add(number, 1)
    field = Field("I", (100, 3))
    assert found.read(1, OMITTED, field, 120) == 120
    assert field[100, 1] == 100
    assert len(field) == 101 * 4


@pytest.mark.covers("cpl.GETERR", "cpl.GETERR.ret.-1")
def test_what_cannot_be_asked_gives_minus_1() -> None:
    found = errors()
    field = Field("I", (2, 3))
    for channel, category, number in ((0, 0, 1), (4, 0, 1), (-2, 0, 1), (2, 11, 1), (2, -1, 1), (2, 0, 0)):
        assert found.read(channel, category, field, number) == -1
    assert field[1, 1] is None
    for wrong in (Field("I", (5,)), Field("I", (5, 2)), Field("R", (5, 3)), 5):
        with pytest.raises(Fault, match="INVALID PARAMETER"):
            found.read(2, 0, wrong)


@pytest.mark.parametrize(
    "field",
    [
        pytest.param(each, marks=pytest.mark.covers(f"cpl.TDA.field.{each}"))
        for each in (*range(3, 8), *range(9, 49))
    ],
)
@pytest.mark.covers("cpl.TDA")
def test_numbers_of_the_tool_database_are_raw(field: int) -> None:
    control = Control()
    ran = Ran(
        f"70 #N%=TDA(2,4,{field})\n80 TDA(2,4,{field})=312000+{field}\n90 #A%=TDA(2,4,{field},1)\n", control
    )
    assert (ran["#N%"], ran["#A%"]) == (0, 312000 + field)
    assert control.tools.data == {(2, 4): {field: 312000 + field}}
    for value in ('"312"', "312.5", "TRUE"):
        assert "inconsistent data" in failure(control, f"TDA(2,4,{field})={value}").what


@pytest.mark.parametrize(
    "field", [pytest.param(each, marks=pytest.mark.covers(f"cpl.TDA.field.{each}")) for each in (8, 49)]
)
@pytest.mark.covers("cpl.TDA")
def test_texts_of_the_tool_database_have_31_characters_at_most(field: int) -> None:
    control = Control()
    text = "CENTRE DRILL 6.3 MM, LEFT HAND."
    ran = Ran(
        f'10 DIM A$(40)\n20 TDA(1,20,{field})="{text}"\n30 A$=TDA(1,20,{field}) : #L%=LEN(A$)\n', control
    )
    assert ran["#L%"] == 31
    assert control.tools.read(1, 20, field) == text
    for value in (f'"{text}."', "5"):
        assert "inconsistent data" in failure(control, f"TDA(1,20,{field})={value}").what
    assert control.tools.read(1, 20, field) == text


@pytest.mark.covers("cpl.TDA.field.1", "cpl.TDA.field.2")
@pytest.mark.parametrize("field", [1, 2])
@pytest.mark.covers("cpl.TDA")
def test_sector_and_place_cannot_be_accessed(field: int) -> None:
    control = Control()
    assert "no access" in str(failure(control, f"A%=TDA(1,1,{field})"))
    assert "no access" in str(failure(control, f"TDA(1,1,{field})=1"))


@pytest.mark.covers("cpl.TDA", "cpl.ex.1963", "cpl.ex.1950")
def test_examples_of_the_tool_database() -> None:
    control = Control()
    control.tools.data[2, 1] = {3: 4242}
    ran = Ran(
        """10 DIM NAME$(31)
20 NAME$="DRILL 8"
70 TDA(1,1,9,1)=20000
75 TDA(2,3,8,1)=NAME$
80 #A%=TDA(2,1,3)
90 #L=TDA(1,1,9)/1000 : TDA(1,1,10)=ROUND(312.0004*1000)
""",
        control,
    )
    assert control.tools.data[1, 1] == {9: 20000, 10: 312000}
    assert control.tools.data[2, 3] == {8: "DRILL 8"}
    assert (ran["#A%"], ran["#L"]) == (4242, 20.0)
    for place in ("3,1,9", "1,21,9", "2,0,9", "2,1,50", "2,1,0", "2,1,9,2"):
        assert "INVALID PARAMETER" in failure(control, f"A%=TDA({place})").what
    with pytest.raises(Fault, match="no tool database"):
        ToolDatabase({}).read(1, 1, 9)
