"""FXC and TC: zero shift and tool tables (Manual 003, 4.3 and 4.4)."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.controllers.bosch._live_tables import LiveTools
from polycnc.controllers.bosch.system import Column, ShiftTable, ToolCompensations, ToolTable, ZeroShifts
from polycnc.errors import ProgramError
from support.cpl_host import Ran, RecordingHost

NPV = "/usr/user/NPV1.npv"


class Control(RecordingHost):
    """Channel 1 has X, Z and the rotary axis U_CH1, channel 2 Y2 and B2; the table NPV is in mm, INCH in inch."""

    def __init__(self) -> None:
        axes = [
            Column("X"),
            Column("Z"),
            Column("U_CH1", rotary=True),
            Column("Y2"),
            Column("B2", rotary=True),
        ]
        self.shifts = ZeroShifts(1, axes, {1: ("X", "Z", "U_CH1"), 2: ("Y2", "B2")})
        self.shifts.tables[NPV] = ShiftTable([Column("X"), Column("Z"), Column("U_CH1", rotary=True)])
        self.shifts.tables["INCH"] = ShiftTable([Column("X"), Column("U_CH1", rotary=True)], inch=True)
        self.tools = ToolCompensations()
        self.setters: dict[str, Callable[..., None]] = {"FXC": self.shifts.set_fxc, "TC": self.tools.write}
        shifts = self.shifts
        super().__init__(
            {
                "FXC": shifts.fxc,
                "FXCR": shifts.fxcr,
                "FXDEL": shifts.fxdel,
                "FXINS": shifts.fxins,
                "TC": self.tools.read,
            }
        )

    def setter(self, name: str) -> Callable[..., None]:
        return self.setters[name]

    def run(self, *lines: str) -> Ran:
        first = [f'1 DIM TAB$(30) : TAB$="{NPV}"']
        return Ran(
            "\n".join([*first, *(f"{10 + place} {line}" for place, line in enumerate(lines))]) + "\n", self
        )

    def value(self, expression: str) -> float:
        found = self.run(f"#V!={expression}")["#V!"]
        assert isinstance(found, float)
        return found

    def refuses(self, line: str) -> bool:
        with pytest.raises(ProgramError) as caught:
            self.run(line)
        return caught.value.what == "INVALID PARAMETER"


ADDRESSES = [*range(54, 60), *range(154, 160), *range(254, 260)]


@pytest.mark.parametrize(
    "code",
    [pytest.param(each, marks=pytest.mark.covers(f"cpl.FXC.G.{each}", "cpl.FXC")) for each in ADDRESSES],
)
def test_each_g_address_is_an_entry_of_its_own(code: int) -> None:
    control = Control()
    control.run(f"FXC(2,{code},TAB$)=80.25")
    assert {other: control.value(f"FXC(2,{other},TAB$)") for other in ADDRESSES} == {
        other: 80.25 if other == code else 0.0 for other in ADDRESSES
    }
    assert control.value(f"FXC(1,{code},TAB$)") == 0.0
    assert control.shifts.tables[NPV].columns[1].shifts == {code: 80.25}
    first, after = code // 100 * 100 + 53, code // 100 * 100 + 60
    assert control.refuses(f"FXC(2,{first},TAB$)=1")
    assert control.refuses(f"FXC(2,{after},TAB$)=1")


@pytest.mark.parametrize(
    "table", [pytest.param(each, marks=pytest.mark.covers(f"cpl.FXC.table.{each}")) for each in (1, 2, 3)]
)
@pytest.mark.covers("cpl.ex.1769")
@pytest.mark.covers("cpl.FXC")
def test_database_tables_have_numbers(table: int) -> None:
    control = Control()
    control.run(f"FXC(2,54,{table})=80")
    assert {
        name: each.columns[1].shifts for name, each in control.shifts.tables.items() if name[0] == "V"
    } == {f"V{number}": {54: 80.0} if number == table else {} for number in (1, 2, 3)}


@pytest.mark.covers(
    "cpl.FXC", "cpl.FXC.table.file", "cpl.ex.1770", "cpl.ex.1771", "cpl.ex.1774", "cpl.ex.1775"
)
def test_a_minus_adds_to_what_is_there() -> None:
    control = Control()
    control.run(
        "FXC(1,54,TAB$)=20", "FXC(-1,54,TAB$)=2", 'FXC("Z",254,TAB$)=5', 'FXC("-Z",254,TAB$)=3',
        'FXC("-U_CH1",54,TAB$)=20', 'FXC("-U_CH1",54,TAB$)=20',
    )  # fmt: skip
    table = control.shifts.tables[NPV]
    assert [column.shifts for column in table.columns] == [{54: 22.0}, {254: 8.0}, {54: 40.0}]
    assert control.value("FXC(-1,54,TAB$)") == 22.0


@pytest.mark.covers("cpl.FXC.unit.0", "cpl.FXC.unit.2", "cpl.ex.1772")
@pytest.mark.covers("cpl.FXC")
def test_values_are_converted_between_the_table_and_the_unit_that_is_given() -> None:
    control = Control()
    control.run('FXC("Z",54,TAB$,2)=10/25.4', "FXC(1,55,TAB$,0)=7.5", 'FXC("U_CH1",54,TAB$,2)=30')
    assert control.value('FXC("Z",54,TAB$)') == pytest.approx(10.0, abs=1e-5)
    assert control.value('FXC("Z",54,TAB$,2)') == pytest.approx(0.3937008, abs=1e-6)
    assert control.value("FXC(1,55,TAB$)") == 7.5
    assert control.value('FXC("U_CH1",54,TAB$,0)') == 30.0
    control.run('FXC(1,54,"INCH",0)=50.8', 'FXC(1,55,"INCH")=3', 'FXC(2,54,"INCH",0)=45')
    assert control.shifts.tables["INCH"].columns[0].shifts == {54: pytest.approx(2.0), 55: 3.0}
    assert control.shifts.tables["INCH"].columns[1].shifts == {54: 45.0}
    assert control.value('FXC(1,55,"INCH",0)') == pytest.approx(76.2)
    assert control.refuses('FXC(1,54,"INCH",1)=5')


@pytest.mark.parametrize(
    "code", [pytest.param(each, marks=pytest.mark.covers(f"cpl.FXC.G.{each}")) for each in (160, 260, 360)]
)
@pytest.mark.covers("cpl.FXC.table.0", "cpl.ex.1773", "cpl.err.FXC_FOREIGN")
@pytest.mark.covers("cpl.FXC")
def test_external_shifts_have_the_unit_of_g70_or_g71_and_axes_of_the_channel(code: int) -> None:
    control = Control()
    control.run(f'FXC("Z",{code},0)=40', f'FXC("-Z",{code},0)=2')
    assert control.shifts.external == {(code, "Z"): 42.0}
    control.shifts.inch = True
    control.run(f"FXC(1,{code},0)=2", f"FXC(3,{code},0)=90")
    assert control.shifts.external[code, "X"] == pytest.approx(50.8)
    assert control.shifts.external[code, "U_CH1"] == 90.0
    assert control.value(f"FXC(1,{code},0)") == pytest.approx(2.0)
    for line in (f'FXC("Y2",{code},0)=1', f"FXC(4,{code},0)=1", f"FXC(1,{code},1)=1", f"FXC(1,{code},0,0)=1"):
        assert control.refuses(line)


@pytest.mark.covers("cpl.FXC", "cpl.ex.1776", "cpl.ex.1777")
def test_without_a_table_the_active_one_is_meant_and_the_axis_alone_gives_the_sum() -> None:
    control = Control()
    control.shifts.active = NPV
    control.run(
        'FXC("Z",255)=40', 'FXC("X",54)=1.5', 'FXC("X",155)=20', 'FXC("X",56)=300', 'FXC("X",260,0)=4000'
    )
    assert control.shifts.tables[NPV].columns[1].shifts == {255: 40.0}
    control.shifts.functions = frozenset((54, 155, 260))
    assert control.value('FXC("X")') == 4021.5
    control.shifts.inch = True
    assert control.value("FXC(1)") == pytest.approx(4021.5 / 25.4)
    # A table in inch, of which a rotary axis has degrees all the same.
    control.shifts.active = "INCH"
    control.run("FXC(1,54)=2.5", "FXC(1,155)=0.75", "FXC(2,54)=33")
    assert control.value("FXC(1)") == pytest.approx(3.25 + 4000 / 25.4)
    assert control.value("FXC(2)") == 33.0
    control.shifts.inch = False
    assert control.value("FXC(1)") == pytest.approx(3.25 * 25.4 + 4000)
    for line in ("A=FXC(9,54)", "A=FXC(0,54)", "A=FXC(1,60)", 'A=FXC("Q",54)', 'A=FXC(1,54,"NONE")', "A=FXC(1,54,4)",
                 "FXC(1,53)=1"):  # fmt: skip
        assert control.refuses(line)


@pytest.mark.covers(
    "cpl.FXCR",
    "cpl.FXDEL",
    "cpl.FXINS",
    "cpl.ex.1809",
    "cpl.FXCR.channel.0",
    "cpl.FXINS.type.0",
    "cpl.FXINS.type.1",
)
def test_tables_are_made_for_channels_and_their_columns_changed() -> None:
    control = Control()
    control.shifts.new_inch = True
    control.run(
        'A=FXCR(2,"K2.npv")', 'A=FXCR(0,"ALL.npv")', 'A=FXCR("ALL.npv","COPY.npv")', 'FXC(1,54,"K2.npv")=7'
    )
    tables = control.shifts.tables

    def columns(name: str) -> list[tuple[str, bool]]:
        return [(each.name, each.rotary) for each in tables[name].columns]

    everything = [("X", False), ("Z", False), ("U_CH1", True), ("Y2", False), ("B2", True)]
    assert columns("K2.npv") == [("Y2", False), ("B2", True)]
    assert columns("ALL.npv") == everything == columns("COPY.npv")
    assert tables["K2.npv"].inch
    control.run('A=FXDEL("COPY.npv",2)', 'A=FXINS("COPY.npv",3,"U",0)', 'A=FXINS("COPY.npv","U","V")',
                'A=FXDEL("COPY.npv","B2")')  # fmt: skip
    assert columns("COPY.npv") == [("X", False), ("U_CH1", True), ("V", False), ("U", True), ("Y2", False)]
    assert columns("ALL.npv") == everything
    for line in ('A=FXCR(3,"N")', 'A=FXCR("NONE","N")', 'A=FXDEL("K2.npv",3)', 'A=FXDEL("NONE",1)',
                 'A=FXINS("K2.npv",1,"B2")', 'A=FXINS("K2.npv",5,"W")', 'A=FXINS("K2.npv",1,"W",2)'):  # fmt: skip
        assert control.refuses(line)
    assert columns("K2.npv") == [("Y2", False), ("B2", True)]
    assert tables["K2.npv"].columns[0].shifts == {54: 7.0}


@pytest.mark.parametrize(
    ("text", "strict"),
    [
        pytest.param("", False, marks=pytest.mark.covers("cpl.FXCR.class.0")),
        pytest.param(",0", False, marks=pytest.mark.covers("cpl.FXCR.class.0")),
        pytest.param(",1", True, marks=pytest.mark.covers("cpl.FXCR.class.1")),
    ],
)
@pytest.mark.covers("cpl.FXCR")
def test_tables_are_classified(text: str, strict: bool) -> None:
    control = Control()
    control.run(f'A=FXCR(1,"N"{text})')
    assert control.shifts.tables["N"].strict == strict
    assert control.refuses('A=FXCR(1,"N",2)')


@pytest.mark.covers("cpl.TC", "cpl.TC.group.1-48", "cpl.TC.table.4", "cpl.TC.table.5", "cpl.TC.sel.1", "cpl.TC.sel.2",
                    "cpl.ex.1881", "cpl.ex.1882", "cpl.ex.1883", "cpl.ex.1884")  # fmt: skip
def test_standard_compensations_stand_in_their_tables() -> None:
    control = Control()
    control.run("A=31.5 : B=6.25", "TC(1,10,5)=A", "TC(2,10,5)=B", "TC(1,10,5,0)=25.4", "TC(1,11,5,2)=1",
                "TC(1,10,4)=1.25 : TC(-1,10,4)=A", "TC(-2,10,4)=B", "TC(1,48,4)=8.5", "TC(2,1,4)=3.5")  # fmt: skip
    k5 = control.tools.tables["K5"].values
    assert k5 == {(10, 1): pytest.approx(25.4), (10, 2): 6.25, (11, 1): pytest.approx(25.4)}
    assert control.tools.tables["K4"].values == {(10, 1): 32.75, (10, 2): 6.25, (48, 1): 8.5, (1, 2): 3.5}
    assert (control.value("TC(1,48,4)"), control.value("TC(2,1,4)"), control.value("TC(2,2,4)")) == (
        8.5,
        3.5,
        0.0,
    )
    assert control.value("TC(1,10,5,2)") == pytest.approx(1.0)
    for line in ("TC(1,49,4)=1", "TC(1,0,4)=1", "TC(3,1,4)=1", "TC(0,1,4)=1", "TC(1,1,6)=1", "TC(1,1,4,1)=1"):
        assert control.refuses(line)


@pytest.mark.covers("cpl.TC.table.file", "cpl.ex.1885", "cpl.ex.1893", "cpl.TC")
def test_tables_by_name_and_the_one_selected_last() -> None:
    control = Control()
    control.tools.tables["/usr/user/GK33"] = ToolTable(inch=True, values={(39, 2): 0.25})
    assert control.value('TC(2,39,"/usr/user/GK33")') == 0.25
    assert control.value('TC(2,39,"/usr/user/GK33",0)') == pytest.approx(6.35)
    control.tools.selected = "/usr/user/GK33"
    control.run("TC(1,17)=4.5")
    assert control.tools.tables["/usr/user/GK33"].values[17, 1] == 4.5
    assert control.refuses('A=TC(1,1,"NONE")')


GROUPS = [*range(145, 846, 100), *range(147, 848, 100)]


@pytest.mark.parametrize(
    "group", [pytest.param(each, marks=pytest.mark.covers(f"cpl.TC.group.{each}")) for each in GROUPS]
)
@pytest.mark.covers("cpl.TC.table.0", "cpl.ex.1887", "cpl.ex.1889", "cpl.ex.1892")
@pytest.mark.covers("cpl.TC")
def test_external_and_general_compensations_have_the_unit_of_g70_or_g71(group: int) -> None:
    control = Control()
    control.run(f"TC(1,{group},0)=12.5", f"TC(-1,{group},0)=0.25")
    assert control.tools.values == {(group, 1): 12.75}
    control.tools.inch = True
    control.run(f"TC(2,{group},0)=2")
    assert control.tools.values[group, 2] == pytest.approx(50.8)
    assert control.value(f"TC(2,{group},0)") == pytest.approx(2.0)
    for line in (
        f"TC(1,{group},4)=1",
        f"TC(1,{group},0,0)=1",
        f"TC(1,{group},1)=1",
        f"TC(9,{group},0)=1",
        "TC(1,945,0)=1",
        "TC(1,146,0)=1",
    ):
        assert control.refuses(line)
    general = group % 100 == 47
    if not general:
        assert control.refuses(f"TC(3,{group},0)=1")
        return
    control.run(f"TC(3,{group},0)=-3", f"TC(4,{group},0)=0.5", f"TC(5,{group},0)=7")
    assert [control.tools.values[group, each] for each in (3, 4, 5)] == pytest.approx([-76.2, 12.7, 7.0])


@pytest.mark.parametrize(
    ("selection", "length"),
    [
        pytest.param(each, each < 5, marks=pytest.mark.covers(f"cpl.TC.sel.{each}"))
        for each in (1, 2, 3, 4, 5, 7, 8)
    ],
)
@pytest.mark.covers("cpl.TC")
def test_general_compensations_have_lengths_and_angles(selection: int, length: bool) -> None:
    control = Control()
    control.tools.inch = True
    control.run(f"TC({selection},347,0)=3", f"TC(-{selection},347,0)=1")
    assert control.tools.values == {(347, selection): pytest.approx(4 * 25.4 if length else 4.0)}
    assert control.value(f"TC({selection},347,0)") == pytest.approx(4.0)
    control.tools.groups = {"general": 347}
    assert control.value(f"TC({selection})") == pytest.approx(4.0)


def test_compensations_that_nobody_has_set_shift_nothing() -> None:
    tools = ToolCompensations()
    tools.values = {(847, 1): 0.25, (847, 3): -4.5, (245, 1): 7.0, (245, 2): 1.5}
    assert LiveTools(tools).shift([847, 345]) == [0.25, -4.5, 0.0]
    assert LiveTools(tools).shift([245, 747]) == [7.0, 0.0, 0.0]
    assert LiveTools(tools).radius([245, 345]) == 1.5


@pytest.mark.covers("cpl.TC.sel.6")
@pytest.mark.covers("cpl.TC")
def test_the_type_of_compensation_is_only_read() -> None:
    control = Control()
    control.tools.values[347, 6] = 3.0
    control.tools.inch = True
    assert control.value("TC(6,347,0)") == 3.0
    assert control.refuses("TC(6,347,0)=2")
    assert control.refuses("TC(-6,347,0)=2")


@pytest.mark.covers("cpl.TC", "cpl.ex.1886")
def test_the_selection_alone_gives_what_is_in_force() -> None:
    control = Control()
    control.tools.tables["K5"] = ToolTable(inch=True, values={(10, 1): 2.0, (11, 2): 0.5, (10, 2): 99.0})
    control.tools.selected = "K5"
    control.tools.groups = {"length": 10, "radius": 11, "external": 245, "general": 847}
    control.tools.values = {(245, 1): 4.0, (847, 1): 0.25, (245, 2): 1.0, (345, 2): 500.0}
    assert control.value("TC(1)") == pytest.approx(55.05)
    assert control.value("TC(2)") == pytest.approx(13.7)
    control.tools.inch = True
    assert control.value("TC(2)") == pytest.approx(13.7 / 25.4)
