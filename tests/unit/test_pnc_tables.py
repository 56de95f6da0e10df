"""Tables of shifts and compensations, signals and data on a living control, asked by its programs (Manual 003, 4).

Each table of cases is asked by one program; where a value moves an axis, it is asked where the axis went.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from polycnc.controllers.bosch.system import ALL_CHANNELS, Category, PlcRange, Signals
from support.living_pnc import MACHINE, Living, six
from support.told import stopped, told


def covered(prefix: str, rows: Any, *more: str) -> list[Any]:
    """Return rows as parameters that claim them."""
    return [
        pytest.param(row, marks=pytest.mark.covers(f"cpl.{prefix}{row}", *(f"cpl.{each}" for each in more)))
        for row in rows
    ]


@pytest.fixture(scope="module")
def living(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control with X, Z and C in channel 1, X2 in channel 2 and U in none."""
    folder = tmp_path_factory.mktemp("tables")
    (folder / "macoda.dat").write_text("2060 00100 = 98\n2060 00110 = 2\n")
    made = six(folder)
    yield made
    made.pnc.close()


# ---------------------------------------------------------------------- zero shifts

GROUPS = {53: range(54, 60), 153: range(154, 160), 253: range(254, 260)}
CODES = [code for group in GROUPS.values() for code in group]
EXTERNAL = (160, 260, 360)


def shift_of(code: int) -> float:
    return 1.25 * (code % 100 - 50) - code / 100 * 0.5


def asked_of(code: int) -> str:
    return f"M{code}!=MPOS(1) : S{code}!=FXC(1)"


@pytest.fixture(scope="module")
def shifts(living: Living) -> dict[int, tuple[float, float, float, float]]:
    """Return what each address reads of X and of Z, and where X1.5 goes and what is in force while it is."""
    lines = [
        f'1 FXC("X",{code},1)={shift_of(code)} : FXC(2,{code},1)={-2 * shift_of(code)}' for code in CODES
    ]
    lines += [
        f'1 FXC("X",{code},0)={shift_of(code)} : FXC("Z",{code},0)={-2 * shift_of(code)}' for code in EXTERNAL
    ]
    for off, group in GROUPS.items():
        lines += [f"N1 G{code}\nN2 G1 X1.5 F60000\n3 WAIT\n4 {asked_of(code)}" for code in group]
        lines += [f"N5 G{off}"]
    lines += [f"N1 G{code}\nN2 G1 X1.5 F60000\n3 WAIT\n4 {asked_of(code)}\nN5 G167" for code in EXTERNAL]
    table = dict.fromkeys(CODES, 1) | dict.fromkeys(EXTERNAL, 0)
    asked = []
    for code, number in table.items():
        asked += [f"FXC(1,{code},{number})", f'FXC("Z",{code},{number})', f"M{code}!", f"S{code}!"]
    found = told(living, "\n".join(lines), *asked)
    return {
        code: (found[n], found[n + 1], found[n + 2], found[n + 3])
        for n, code in zip(range(0, 132, 4), table, strict=False)
    }


@pytest.mark.parametrize("code", covered("FXC.G.", (*CODES, *EXTERNAL), "FXC"))
def test_each_shift_is_read_and_moves_its_axis_while_it_is_in_force(shifts: Any, code: int) -> None:
    value = shift_of(code)
    assert shifts[code] == pytest.approx((value, -2 * value, 1.5 + value, value))


@pytest.mark.covers("cpl.FXC", "cpl.FXC.table.1", "cpl.FXC.table.2", "cpl.FXC.table.3", "cpl.FXC.table.0")
@pytest.mark.covers("cpl.ex.1769", "cpl.ex.1773", "cpl.ex.1777")
def test_tables_of_shifts_are_selected_by_their_numbers(living: Living) -> None:
    found = told(
        living,
        '1 FXC(1,54,1)=10 : FXC("X",54,2)=20.5 : FXC(1,54,3)=33.25 : FXC(2,54,1)=80 : FXC("Z",160,0)=40\n'
        "N2 G54\nN3 G1 X1 F60000\n4 WAIT\n5 A!=MPOS(1)\nN6 G22 V2\nN7 G1 X1\n8 WAIT\n9 B!=MPOS(1)\nN10 G22 V3\n"
        'N11 G1 X1\n12 WAIT\n13 C!=MPOS(1) : D!=FXC("X",54)\nN14 G22 V1\nN15 G160\n16 E!=FXC("Z") : F!=FXC(1)\n'
        "N17 G53\n18 G!=FXC(2)\nN19 G167",
        "A!", "B!", "C!", "D!", "E!", "F!", "G!", "FXC(2,54,1)", 'FXC("Z",54,2)', 'FXC("Z",160,0)',
    )  # fmt: skip
    assert found == pytest.approx([11, 21.5, 34.25, 33.25, 120, 10 + shift_of(160), 40, 80, 0, 40])


@pytest.mark.covers("cpl.FXC", "cpl.FXC.unit.0", "cpl.FXC.unit.2", "cpl.FXC.table.file", "cpl.nc.G70_G71")
@pytest.mark.covers("cpl.ex.1770", "cpl.ex.1771", "cpl.ex.1772", "cpl.ex.1774", "cpl.ex.1775", "cpl.FXCR")
def test_shifts_are_added_to_and_given_in_mm_or_inch(living: Living) -> None:
    found = told(
        living,
        '1 DIM T$(30) : T$="/user/A1.npv" : FXCR(1,T$) : FXC(1,54,T$)=7\n'
        '1 FXC(1,54,T$)=20 : FXC(-1,54,T$)=2\n1 FXC("Z",54,T$,2)=10/25.4\n'
        '2 FXC("Z",254,T$)=5 : FXC("-Z",254,T$)=3 : FXC("-C",54,T$)=20 : FXC("-C",54,T$)=20 : FXC("C",55,T$,2)=30\n'
        '3 FXC(1,55,T$,0)=7.5 : FXC("X",59,1,2)=2 : FXC("X",58,1,0)=-7\n'
        '4 FXC(1,56,T$)=30 : FXC(-1,56,T$,2)=-2 : FXC("Z",57,1)=12 : FXC("-Z",57,1,2)=3 : FXC("-Z",57,1,0)=1',
        *(
            "FXC(1,54,T$)",
            "FXC(2,54,T$)",
            'FXC("Z",54,T$,2)',
            "FXC(2,254,T$)",
            "FXC(3,54,T$)",
            "FXC(3,55,T$,0)",
        ),
        *(
            "FXC(1,55,T$)",
            'FXC("X",59,1)',
            "FXC(1,59,1,2)",
            "FXC(1,59,1,0)",
            "FXC(1,58,1,2)*25.4",
            "FXC(1,54,T$,2)",
        ),
        "FXC(1,56,T$)",
        'FXC("Z",57,1)',
    )
    assert found == pytest.approx(
        [22, 10, 10 / 25.4, 8, 40, 30, 7.5, 50.8, 2, 50.8, -7, 22 / 25.4, 30 - 50.8, 89.2], abs=1e-5
    )
    lines = (living.folder / "user/A1.npv").read_text("latin-1").splitlines()
    assert lines[:3] == ["ZERO SHIFT TABLE MM", "AXES X Z C:ROTARY", f"G54 22.0 {lines[2].split()[2]} 40.0"]
    assert lines[3] == "G55 7.5 0.0 30.0"


@pytest.mark.covers("cpl.FXC", "cpl.err.FXC_FOREIGN", "cpl.FXC.table.0")
def test_external_shifts_follow_the_unit_of_the_channel_and_are_of_its_axes(living: Living) -> None:
    found = told(
        living,
        'N1 G70\n2 FXC("X",260,0)=2 : FXC("C",260,0)=90 : A!=FXC("X",260,0) : B!=FXC("C",260,0)\nN3 G71',
        *("A!", "B!", 'FXC("X",260,0)', 'FXC("C",260,0)', 'FXC("X",160,0)*0+FXC(1,360,0)'),
    )
    assert found == pytest.approx([2, 90, 50.8, 90, shift_of(360)])
    for statement in (
        'FXC("X2",160,0)=1', 'FXC("U",260,0)=1', "FXC(4,160,0)=1", "A=FXC(1,160,1)", "A=FXC(1,60,1)", "A=FXC(9,54,1)",
        'A=FXC(1,54,"NONE")', "A=FXC(1,54,4)",
    ):  # fmt: skip
        assert stopped(living, statement) == "INVALID PARAMETER", statement


@pytest.mark.covers(
    "cpl.FXCR", "cpl.FXDEL", "cpl.FXINS", "cpl.ex.1809", "cpl.FXCR.channel.0", "cpl.zs.overview"
)
@pytest.mark.covers("cpl.FXINS.type.0", "cpl.FXINS.type.1", "cpl.FXCR.class.0", "cpl.FXCR.class.1")
def test_tables_of_shifts_are_made_and_get_and_lose_columns(living: Living) -> None:
    told(
        living,
        '1 FXCR(2,"B2.npv") : FXCR(0,"ALL.npv",1) : FXCR("ALL.npv","COPY.npv") : FXCR(1,"ONE.npv",0)\n'
        '2 FXDEL("COPY.npv",2) : FXINS("COPY.npv",3,"R",0) : FXINS("COPY.npv","X2","L",1) : FXINS("COPY.npv","U","M")\n'
        '3 FXDEL("COPY.npv","C") : FXC("R",154,"COPY.npv")=12.5',
        "1",
    )
    heads = {
        name: (living.folder / name).read_text().splitlines()
        for name in ("B2.npv", "ALL.npv", "COPY.npv", "ONE.npv")
    }
    assert heads["B2.npv"][:2] == ["ZERO SHIFT TABLE MM", "AXES X2"]
    assert heads["ALL.npv"][:2] == ["ZERO SHIFT TABLE MM STRICT", "AXES X Z C:ROTARY X2 U"]
    assert heads["ONE.npv"][:2] == ["ZERO SHIFT TABLE MM", "AXES X Z C:ROTARY"]
    assert heads["COPY.npv"][1] == "AXES X R:ROTARY L X2 M U"
    assert "G154 0.0 12.5 0.0 0.0 0.0 0.0" in heads["COPY.npv"]


# ---------------------------------------------------------------------- tool compensations

EXTERNAL_TOOLS, GENERAL_TOOLS = range(145, 846, 100), range(147, 848, 100)


@pytest.fixture(scope="module")
def tools(living: Living) -> dict[int, tuple[float, ...]]:
    """Return what is read of each compensation, in force or not, and where Z2 goes while it is."""
    lines, asked = [], []
    for group in (*EXTERNAL_TOOLS, *GENERAL_TOOLS):
        lines += [
            f"1 TC(1,{group},0)={group / 100} : TC(-1,{group},0)=0.25 : TC(2,{group},0)=-{group / 1000}",
            f"N2 G{group}\nN3 G1 Z2 F60000\n4 WAIT\n5 M{group}!=MPOS(2) : L{group}!=TC(1) : R{group}!=TC(2)",
            "N6 G146" if group % 100 == 45 else "N6 G148",
        ]
        asked += [f"TC(1,{group},0)", f"TC(2,{group},0)", f"M{group}!", f"L{group}!", f"R{group}!"]
    found = told(living, "\n".join(lines), *asked)
    groups = (*EXTERNAL_TOOLS, *GENERAL_TOOLS)
    return {group: tuple(found[5 * n : 5 * n + 5]) for n, group in enumerate(groups)}


@pytest.mark.parametrize(
    "group", covered("TC.group.", (*EXTERNAL_TOOLS, *GENERAL_TOOLS), "TC", "TC.table.0", "TC.sel.1")
)
@pytest.mark.covers("cpl.ex.1887", "cpl.ex.1889", "cpl.ex.1892", "cpl.TC.sel.2")
def test_each_compensation_is_read_and_moves_the_tool_while_it_is_in_force(tools: Any, group: int) -> None:
    length, radius = group / 100 + 0.25, -group / 1000
    assert tools[group] == pytest.approx((length, radius, 2 + length, length, radius), abs=1e-5)


@pytest.mark.parametrize("selection", covered("TC.sel.", (1, 2, 3, 4, 5, 7, 8), "TC"))
def test_values_of_a_general_compensation_are_apart_and_added_to(living: Living, selection: int) -> None:
    others = [each for each in (1, 2, 3, 4, 5, 7, 8) if each != selection]
    cleared = " : ".join(f"TC({each},347,0)={each * 10}" for each in (1, 2, 3, 4, 5, 7, 8))
    found = told(
        living,
        f"1 {cleared}\n2 TC({selection},347,0)=4.5 : TC(-{selection},347,0)=1.25\nN3 G347\n4 N!=TC({selection})\n"
        f"N5 G70\n6 I!=TC({selection},347,0)\nN7 G71\nN8 G148",
        f"TC({selection},347,0)", "N!", "I!", *(f"TC({each},347,0)" for each in others),
    )  # fmt: skip
    assert found[:2] == [5.75, 5.75]
    assert found[2] == pytest.approx(5.75 / 25.4 if selection < 5 else 5.75, abs=1e-6)
    assert found[3:] == [each * 10 for each in others]


@pytest.mark.covers("cpl.TC", "cpl.TC.sel.6")
def test_the_type_of_compensation_is_what_the_operator_entered(living: Living) -> None:
    living.pnc.system.tools.values[447, 6] = 4.0
    assert told(living, "N1 G447\n2 A=TC(6)\nN3 G148", "TC(6,447,0)", "A", "TC(6,347,0)") == [4, 4, 0]
    for statement in (
        "TC(6,447,0)=2",
        "TC(-6,447,0)=2",
        "TC(9,447,0)=1",
        "TC(3,445,0)=1",
        "TC(1,146,0)=1",
        "TC(1,445,4)=1",
    ):
        assert stopped(living, statement) == "INVALID PARAMETER", statement


@pytest.mark.covers(
    "cpl.TC", "cpl.TC.group.1-48", "cpl.TC.table.4", "cpl.TC.table.5", "cpl.TC.table.file", "cpl.TC.sel.1"
)
@pytest.mark.covers(
    "cpl.ex.1881", "cpl.ex.1882", "cpl.ex.1883", "cpl.ex.1884", "cpl.ex.1885", "cpl.ex.1886", "cpl.ex.1893"
)
@pytest.mark.covers("cpl.TC.sel.2")
def test_standard_compensations_of_both_tables_and_of_a_file(living: Living) -> None:
    (living.folder / "GK33").write_text("TOOL COMPENSATION TABLE INCH\n39 1.5 0.25\n")
    found = told(
        living,
        "1 TC(1,10,5)=31.5 : TC(2,10,5)=6.25 : TC(1,11,5,2)=1 : TC(1,10,4)=1.25 : TC(-1,10,4)=31.5 : TC(-2,10,4)=6.5\n"
        '2 TC(1,48,4)=8.5 : TC(2,1,4)=3.5 : TC(-1,39,"GK33")=0.25\nN3 H10\nN4 G1 Z2 F60000\n5 WAIT\n'
        "6 A!=MPOS(2) : B!=TC(1)\nN7 G22 K5\nN8 H10\nN9 G1 Z2\n10 WAIT\n"
        "11 C!=MPOS(2) : D!=TC(1)\nN12 H11\n13 E!=TC(1) : TC(1,17)=7.75\n"
        "N14 G18 G41 D10 G1 X3 F60000\nN15 G1 X9\n16 F!=TC(2)\nN17 G40 G1 X20\nN18 H0\nN19 G22 K4",
        *(
            "TC(1,10,5)",
            "TC(2,10,5)",
            "TC(1,11,5)",
            "TC(1,11,5,0)",
            "TC(1,10,4)",
            "TC(2,10,4)",
            "TC(1,48,4)",
            "TC(2,1,4)",
        ),
        *(
            "TC(2,2,4)",
            'TC(2,39,"GK33")',
            'TC(2,39,"GK33",0)',
            'TC(1,39,"GK33",2)',
            "A!",
            "B!",
            "C!",
            "D!",
            "E!",
        ),
        *("TC(1,17,5)", "TC(1,17,4)", "F!", "TC(1,10,5,2)"),
    )
    assert found == pytest.approx(
        [31.5, 6.25, 25.4, 25.4, 32.75, 6.5, 8.5, 3.5, 0, 0.25, 6.35, 1.75, 34.75, 32.75, 33.5, 31.5, 25.4, 7.75, 0,
         6.25, 31.5 / 25.4], abs=1e-5,
    )  # fmt: skip
    for statement in (
        "TC(1,49,4)=1",
        "TC(1,0,4)=1",
        "TC(3,1,4)=1",
        "TC(0,1,4)=1",
        "TC(1,1,6)=1",
        "TC(1,1,4,1)=1",
        'A=TC(1,1,"NO")',
    ):
        assert stopped(living, statement) == "INVALID PARAMETER", statement


# ---------------------------------------------------------------------- signals, PLC, errors, tool data

GROUP_NAMES = (
    "CHANNEL_INPUTS", "AXIS_INPUTS", "SPINDLE_INPUTS", "CHANNEL_OUTPUTS", "AXIS_OUTPUTS", "SPINDLE_OUTPUTS",
    "GLOBAL_INPUTS", "GLOBAL_OUTPUTS", "FAST_INPUTS", "FAST_OUTPUTS",
)  # fmt: skip
"""The groups of signals from 0 on."""
SIGNALS = {
    0: (112, 2), 1: (112, 5), 2: (112, 2), 3: (96, 2), 4: (64, 5), 5: (64, 2), 6: (32, 1), 7: (32, 1), 8: (8, 1),
    9: (8, 1),
}  # fmt: skip


@pytest.mark.parametrize("group", covered("IC.group.", SIGNALS, "IC"))
def test_programs_read_each_group_of_signals(living: Living, group: int) -> None:
    size, index = SIGNALS[group]
    interface, bits = living.pnc.system.interface, (size - 1, size // 2, 3)
    asked = [f"?IC({bit},{group},{index})" for bit in (*bits, size - 2)]
    first = 1 if group not in (0, 3) else 0
    near = [other for other in range(10) if other != group and bits[1] < SIGNALS[other][0]]
    others = [f"?IC({bits[1]},{other},1)" for other in near]
    others += [f"?IC({bits[1]},{group},{first})"] if index != first else []
    for value in (True, False):
        for bit in bits:
            interface.set_bit(Signals[GROUP_NAMES[group]], index, bit, value)
        found = told(living, "", *asked, *others)
        assert found[:4] == [value, value, value, False]
        assert not any(found[4:])
    for place in (f"{size},{group}", f"0,{group},{first - 1}"):
        assert stopped(living, f"A?=IC({place})") == "INVALID PARAMETER"


@pytest.mark.covers("cpl.IC", "cpl.IC.group.0", "cpl.IC.group.3", "cpl.ex.2414", "cpl.ex.2408")
def test_outputs_81_to_96_of_a_channel_are_set_through_its_inputs(living: Living) -> None:
    told(
        living, "1 IC(80,0,1)=TRUE : IC(95)=TRUE : IC(94,0,2)=TRUE : IC(83,0,2)=TRUE : IC(83,0,2)=FALSE", "1"
    )
    bit, outputs = living.pnc.system.interface.bit, Signals.CHANNEL_OUTPUTS
    found = [
        (channel, place) for channel in (1, 2) for place in range(80, 96) if bit(outputs, channel, place)
    ]
    assert found == [(1, 80), (1, 95), (2, 94)]
    assert told(living, "1 IC(80,0,1)=FALSE", "?IC(80,3,1)", "?IC(95,3)", "?IC(94,3,2)", "?IC(80,0,1)") == [
        0,
        1,
        1,
        0,
    ]
    for statement in (
        "IC(79,0,1)=TRUE",
        "IC(96,0,1)=TRUE",
        "IC(80,3,1)=TRUE",
        "IC(80,1,1)=TRUE",
        "IC(80,0,3)=TRUE",
    ):
        assert stopped(living, statement) == "INVALID PARAMETER"


RANGES = {
    1: PlcRange.INPUT, 2: PlcRange.OUTPUT, 3: PlcRange.MARKER, 5: PlcRange.DATA_BUFFER, 6: PlcRange.DATA_FIELD,
    9: PlcRange.SPECIAL_MARKER, 10: PlcRange.SYSTEM, 11: PlcRange.EXTENDED_INPUT, 12: PlcRange.EXTENDED_OUTPUT,
}  # fmt: skip


@pytest.fixture(scope="module")
def plc(living: Living) -> dict[str, float]:
    """Return what programs read of a PLC in which each range has bytes of its own."""
    data = living.pnc.system.plc
    for kind, name in RANGES.items():
        data.ranges[name][8:16] = bytes(16 * kind + place for place in range(8))
    data.timers_ms[3], data.counters[3], data.counters[4] = 70_250, 815, 7
    data.modules[98][0:8] = b"\xff\xfe\x34\x12\xff\xff\xff\xff"
    asked = [
        f"PLC({kind},,{address},{size})" for kind in RANGES for address, size in ((9, 1), (10, 2), (12, 4))
    ]
    asked += [
        "PLC(7,,3,1)",
        "PLC(8,,3,4)",
        "PLC(8,,4)",
        "PLC(4,98,2,2)",
        "PLC(4,98,0,1)",
        "PLC(4,98,4,4)",
        "PLC(4,98,0,2)",
    ]
    return dict(zip(asked, told(living, "", *asked), strict=True))


@pytest.mark.parametrize(
    "kind", covered("PLC.type.", RANGES, "PLC", "PLC.size.1", "PLC.size.2", "PLC.size.4", "ex.2462")
)
def test_each_range_of_the_plc_is_read_by_byte_in_three_sizes(plc: dict[str, float], kind: int) -> None:
    first = 16 * kind
    assert plc[f"PLC({kind},,9,1)"] == first + 1
    assert plc[f"PLC({kind},,10,2)"] == (first + 3) * 256 + first + 2
    double = int.from_bytes(bytes(first + 4 + place for place in range(4)), "little", signed=True)
    assert plc[f"PLC({kind},,12,4)"] == double


@pytest.mark.covers(
    "cpl.PLC", "cpl.PLC.type.4", "cpl.PLC.type.7", "cpl.PLC.type.8", "cpl.ex.2465", "cpl.PLC.size.4"
)
@pytest.mark.covers("cpl.PLC.size.1", "cpl.PLC.size.2", "cpl.param.2060_00100", "cpl.param.2060_00110")
def test_timers_counters_and_data_modules_are_read_and_released_ones_written(
    living: Living, plc: dict[str, float]
) -> None:
    assert [*plc.values()][-7:] == [70_250, 815, 7, 0x1234, 255, -1, 0xFEFF]
    modules = living.pnc.system.plc.modules
    told(living, "1 PLC(4,98,2,2)=65534 : PLC(4,98,0,1)=7 : PLC(4,98,4,4)=-2 : PLC(4,99,9,1)=200", "1")
    assert (bytes(modules[98][:8]), bytes(modules[99][8:11])) == (
        b"\x07\xfe\xfe\xff\xfe\xff\xff\xff",
        b"\x00\xc8\x00",
    )
    wrong = ["PLC(4,97,0,1)=1", "PLC(4,100,0,1)=1", "PLC(4,98,0,1)=256", "PLC(4,98,0,2)=-1", "PLC(1,,0,1)=1"]
    for statement in (
        *wrong,
        *(f"A%=PLC({each})" for each in ("13,,0,1", "0,,0,1", "1,,0,3", "4,,0,1", "1,3,0,1")),
    ):
        assert stopped(living, statement) == "INVALID PARAMETER", statement


CATEGORIES = {
    1: Category.MINOR_SYSTEM, 2: Category.CONTROL_OR_DRIVE, 3: Category.INTERPOLATOR, 4: Category.HARDWARE,
    5: Category.PLC, 6: Category.PART_PROGRAM, 8: Category.MSD_ERROR, 9: Category.MSD_WARNING,
    10: Category.MSD_MESSAGE,
}  # fmt: skip


@pytest.fixture
def faulty(living: Living) -> Iterator[Living]:
    """Return it with an error of each category in channel 1, two in channel 2 and one of all channels."""
    errors = living.pnc.system.errors
    before = list(errors.errors)
    errors.errors[:] = []
    for category in (6, 1, 2, 3, 4, 5, 8, 9, 10):
        errors.add(2000 + category, 1, CATEGORIES[category])
    errors.add(2101, 2, Category.PART_PROGRAM)
    errors.add(2102, 2, Category.CONTROL_OR_DRIVE)
    errors.add(1938, 2, Category.PART_PROGRAM)
    errors.add(2201, ALL_CHANNELS, Category.HARDWARE)
    yield living
    errors.errors[:] = before


@pytest.mark.parametrize(
    "category", covered("GETERR.cat.", (1, 2, 3, 4, 5, 6, 8, 9, 10), "GETERR", "GETERR.ret.n")
)
@pytest.mark.covers("cpl.GETERR.elem.1", "cpl.GETERR.elem.2", "cpl.GETERR.elem.3", "cpl.GETERR")
def test_programs_read_the_errors_of_each_category(faulty: Living, category: int) -> None:
    found = told(
        faulty, f"1 DIM F%(4,3)\n2 G%=GETERR(1,{category},F%,3)", *("G%", "F%(1,1)", "F%(1,2)", "F%(1,3)"),
        *("?F%(2,1)=2201", "?F%(2,2)=-1", "?F%(3,1)>0"),
    )  # fmt: skip
    hardware = category == 4
    assert found == [1 + hardware, 2000 + category, 1, category, hardware, hardware, False]


@pytest.mark.covers(
    "cpl.GETERR", "cpl.GETERR.cat.0", "cpl.GETERR.use", "cpl.GETERR.ret.n", "cpl.GETERR.ret.-1"
)
@pytest.mark.covers(
    "cpl.ex.2594", "cpl.GETERR.elem.1", "cpl.GETERR.elem.2", "cpl.GETERR.elem.3", "cpl.ex.2550"
)
def test_programs_read_errors_of_a_channel_and_of_all_in_their_order(faulty: Living) -> None:
    found = told(
        faulty,
        "1 DIM F%(20,3) : DIM P%(20,3) : DIM Q%(2,3)\n2 A%=GETERR(2,,F%,20) : B%=GETERR(2,6,P%,9)\n"
        "3 C%=GETERR(-1,0,Q%,20) : D%=GETERR(3,0,F%,1) : E%=GETERR(1,11,F%,1) : H%=GETERR(1,0,F%,0)",
        *(
            "A%",
            "F%(1,1)",
            "F%(2,1)",
            "F%(3,1)",
            "F%(4,1)",
            "F%(4,2)",
            "F%(4,3)",
            "B%",
            "P%(1,1)",
            "P%(2,1)",
            "P%(2,2)",
        ),
        *("P%(2,3)", "C%", "Q%(1,1)", "Q%(2,1)", "D%", "E%"),
    )
    assert found == [4, 2101, 2102, 1938, 2201, -1, 4, 2, 2101, 1938, 2, 6, 13, 2006, 2001, -1, -1]


FIELDS = (*range(3, 8), *range(9, 49))


def raw(field: int) -> int:
    return -312000 - field


@pytest.fixture(scope="module")
def tool_data(living: Living) -> list[float]:
    """Return what a program reads of the numbers of tool 3 in sector 2, before and after it has set each."""
    lines = [f"1 O{field}=TDA(2,3,{field})\n2 TDA(2,3,{field},1)={raw(field)}" for field in FIELDS]
    return told(living, "\n".join(lines), *(f"O{field}*100000000+TDA(2,3,{field})" for field in FIELDS))


@pytest.mark.parametrize("field", covered("TDA.field.", FIELDS, "TDA", "ex.1963"))
def test_each_number_of_the_tool_data_is_kept_raw(living: Living, tool_data: list[float], field: int) -> None:
    assert tool_data[FIELDS.index(field)] == raw(field)
    assert living.pnc.system.tool_data.data[2, 3][field] == raw(field)


@pytest.mark.parametrize("field", covered("TDA.field.", (8, 49), "TDA", "ex.1963"))
def test_texts_of_the_tool_data_have_31_characters(living: Living, field: int) -> None:
    text = "CENTRE DRILL 6.3 MM, LEFT HAND."
    found = told(
        living,
        f'1 DIM A$(40)\n2 TDA(1,20,{field})="{text}" : A$=TDA(1,20,{field})',
        "LEN(A$)",
        f'?A$="{text}"',
    )
    assert found == [31, 1]
    assert stopped(living, f'TDA(1,20,{field})="{text}."').startswith("inconsistent data")
    assert stopped(living, f"TDA(1,20,{field})=5").startswith("inconsistent data")


@pytest.mark.parametrize("field", covered("TDA.field.", (1, 2), "TDA"))
def test_sector_and_place_are_not_read_nor_set(living: Living, field: int) -> None:
    assert stopped(living, f"A%=TDA(1,1,{field})").startswith("INVALID PARAMETER")
    assert stopped(living, f"TDA(1,1,{field})=1").startswith("INVALID PARAMETER")


# ---------------------------------------------------------------------- system data, programmed shifts

NOT_IN_USE = {
    "SD.1.i.3": "SD(1,2,3)", "SD.2.2": "SD(2,2)", "SD.3.1": "SD(3,1)", "SD.3.2": "SD(3,2)", "SD.4.1": "SD(4,1)",
    "SD.4.2": "SD(4,2)", "SD.6": "SD(6,3)", "SD.7.1": "SD(7,1)", "SD.7.2": "SD(7,2)", "SD.7.3": "SD(7,3)",
    "SD.16": "SD(16,0)", "SD.17": "SD(17,5)", "SDR.2.2": "SDR(2,2)", "SDR.4": "SDR(4,1)", "SDR.5": "SDR(5,1)",
    "SDR.12": "SDR(12,1)",
}  # fmt: skip


@pytest.mark.parametrize(
    ("row", "data"),
    [pytest.param(*each, marks=pytest.mark.covers(f"cpl.{each[0]}")) for each in NOT_IN_USE.items()],
)
@pytest.mark.covers("cpl.SD", "cpl.SDR")
def test_system_data_that_are_not_in_use_stop_a_program(living: Living, row: str, data: str) -> None:
    assert stopped(living, f"A={data}") == "INVALID PARAMETER"


EMPTY = (6, 12, 14, 15, 16, 23, 24, 27, *range(31, 49))


@pytest.fixture(scope="module")
def no_groups(living: Living) -> dict[int, tuple[float, float]]:
    """Return what SD(1) tells of groups without a function while others hold."""
    asked = [f"SD(1,{group},{index})" for group in EMPTY for index in (1, 2)]
    found = told(living, "N1 G18 G91 G2 X3 Z4 R50 F3000\nN2 G54\nN3 G15\n4 WAIT", *asked)
    return {group: (found[2 * n], found[2 * n + 1]) for n, group in enumerate(EMPTY)}


@pytest.mark.parametrize("group", covered("SD.group.", EMPTY, "SD"))
def test_groups_without_a_function_tell_none(no_groups: Any, group: int) -> None:
    assert no_groups[group] == (-1, -1)


@pytest.fixture(scope="module")
def turned(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Living]:
    """Return a control whose channel has the coordinates Z, C and X, the physical axes 1, 2 and 4."""
    _, x, z, c, x2, u = MACHINE.split("[[axis]]")
    machine = "[[axis]]".join(('name = "turned"\n', z, c, x, x2, u))
    made = Living(tmp_path_factory.mktemp("turned"), machine, [("Z", "C", "X"), ("X2", "U")], (1, 2, 4, 5, 7))
    yield made
    made.pnc.close()


@pytest.mark.covers("cpl.COF", "cpl.ex.1985", "cpl.err.SHIFT_FOREIGN", "cpl.nc.G60_G67")
def test_contour_shifts_are_told_by_coordinate_axis_and_name(turned: Living) -> None:
    found = told(
        turned,
        "N1 G18 G60 X25.4 Z-2.5 C7\nN2 G70\n3 A!=COF(3) : B!=COF(2)\nN4 G71",
        *(
            "COF(3)",
            'COF("X")',
            "COF(2,0)",
            "COF(1)",
            'COF("Z")',
            "COF(2)",
            "COF(4,0)",
            "COF(1,1)",
            "COF(1,0)",
            "A!",
            "B!",
        ),
    )
    assert found == pytest.approx([25.4, 25.4, 7, -2.5, -2.5, 7, 25.4, -2.5, -2.5, 1, 7])
    for wrong in ("COF(0)", "COF(4)", 'COF("X2")', "COF(5,0)", "COF(3,0)", "COF(1,2)"):
        assert stopped(turned, f"A={wrong}", "N1 G60 X3") == "INVALID PARAMETER", wrong


@pytest.mark.covers(
    "cpl.DPC", "cpl.DPC.sel.0", "cpl.DPC.sel.n", "cpl.ex.2013", "cpl.err.SHIFT_FOREIGN", "cpl.nc.G138"
)
def test_shifts_of_the_workpiece_are_told_by_coordinate_axis_and_name(turned: Living) -> None:
    found = told(
        turned,
        "N1 G18\nN2 G138 X50.8 Z11.5 R-17.25\nN3 G70\n4 A!=DPC(3) : B!=DPC(0)\nN5 G71",
        *("DPC(1)", 'DPC("X")', "DPC(3)", "DPC(2,0)", "DPC(1,0)", "DPC(0)", "DPC(2)", "A!", "B!"),
    )
    assert found == pytest.approx([11.5, 50.8, 50.8, 0, 11.5, -17.25, 0, 2, -17.25])
    for wrong in ("DPC(9)", "DPC(4)", 'DPC("U")', "DPC(5,0)"):
        assert stopped(turned, f"A={wrong}", "N1 G139") == "INVALID PARAMETER", wrong


@pytest.mark.covers(
    "cpl.SCL", "cpl.SCL.sel.0", "cpl.SCL.sel.1", "cpl.SCL.sel.2", "cpl.ex.2040", "cpl.err.SHIFT_FOREIGN"
)
@pytest.mark.covers("cpl.nc.G37_G38")
def test_angle_poles_and_factors_are_told_by_coordinate_axis_and_name(turned: Living) -> None:
    found = told(
        turned,
        "N1 G18\nN2 G37 X127 Z-7\nN3 G38 X1.25 Z-2 R33.5\nN4 G70\n5 A!=SCL(1,3) : B!=SCL(2,3)\nN6 G71",
        *(
            "SCL(0)",
            "SCL(1,3)",
            "SCL(1,1)",
            "SCL(2,3,1)",
            'SCL(2,"X")',
            "SCL(2,2,0)",
            'SCL(1,"Z")',
            "SCL(2,2)",
        ),
        *("SCL(1,2)", "A!", "B!"),
    )
    assert found == pytest.approx([33.5, 127, -7, 1.25, 1.25, 1, -7, 1, 0, 5, 1.25])
    for wrong in ("SCL(0,1)", "SCL(1)", "SCL(2)", "SCL(3,1)", 'SCL(1,"X2")', "SCL(2,4)"):
        assert stopped(turned, f"A={wrong}", "N1 G39") == "INVALID PARAMETER", wrong


@pytest.mark.covers("cpl.err.NCF_SYNTAX", "cpl.err.RUNTIME_MCA", "cpl.NCF", "cpl.MCA")
def test_functions_and_parameters_that_are_not_there_stop_a_program(turned: Living) -> None:
    for statement in ('A$=NCF("G999")', 'A$=NCF("X")', 'A$=NCF("M77")', 'A$=NCF("")'):
        assert stopped(turned, statement, "10 DIM A$(4)") == "INVALID PARAMETER", statement
    for call in ("100399999,0", "100300004,7", "100300004,-1", "100300004,0,4", "100300004,0,0"):
        assert stopped(turned, f"A%=MCA({call})") == "INVALID PARAMETER", call
    assert stopped(turned, "A%=MCA(100300001,0)") == "INVALID ASSIGNMENT"
    assert stopped(turned, 'A%=NCF("G1")') == "INVALID ASSIGNMENT"
    assert told(
        turned, "", "MCA(100300004,0)", "MCA(100300004,1)", "MCA(100300004,2)", "MCA(100300004,1,-1)"
    ) == [1, 2, 0, 2]
    found = told(
        turned,
        '1 DIM A$(4)\nN2 G2 G18 X1 Z1 R5 F900\nN3 G91\n4 A$=NCF("G0")',
        '?A$="G2"',
        '?NCF("G90")="G91"',
        '?NCF("G17")="G18"',
    )
    assert found == [1, 1, 1]


@pytest.mark.covers(
    "cpl.SD", "cpl.SDR", "cpl.SD.5.4.2", "cpl.SD.5.4.3", "cpl.SD.5.4.1", "cpl.SD.12.4", "cpl.SDR.2.4"
)
@pytest.mark.covers(
    "cpl.SD.10.1.1", "cpl.SD.10.1.2", "cpl.SD.10.2.1", "cpl.SD.10.2.2", "cpl.SD.8", "cpl.SD.12.3"
)
@pytest.mark.covers(
    "cpl.SD.2.4", "cpl.SD.5.2.1", "cpl.SD.2.1", "cpl.SD.2.3", "cpl.SDR.2.1", "cpl.SDR.2.3", "cpl.SD.5.3.1"
)
def test_the_drilling_axis_the_first_spindle_and_none_are_told_apart(turned: Living) -> None:
    turned.pnc.control.set_overrides(feed=0.625, channel=0)
    turned.pnc.control.set_overrides(spindle=0.875)
    asked = {
        "SD(10,1,1)": 1, "SD(10,1,2)": 1, "SD(10,2,1)": 1, "SD(10,2,2)": 1, "SD(5,3,2)": 700, "SD(5,4,2)": 0,
        "SD(5,4,3)": 0, "SD(5,4,1)": 0, "SD(12,2)": 3, "SD(12,4)": -1, "SD(12,3)": -1, "SD(2,4)": 0, "SDR(2,4)": 0,
        "SD(8)": 1, "SD(5,2,1)": 30000, "SD(2,1)": 63, "SDR(2,1)": 62.5, "SD(2,3)": 88, "SDR(2,3)": 87.5,
        "SD(5,3,1)": 613, "SD(5,1,1)": 1000, "SD(5,1,2)": 1600,
    }  # fmt: skip
    found = told(turned, "N1 S700 M3\nN2 G1 X1 F1600\n3 WAIT", *asked)
    turned.pnc.control.set_overrides(feed=1.0, channel=0)
    turned.pnc.control.set_overrides(spindle=1.0)
    assert dict(zip(asked, found, strict=True)) == asked


@pytest.mark.covers(
    "cpl.WAIT", "cpl.WAIT.result.0", "cpl.WAIT.result.1", "cpl.WAIT.result.2", "cpl.CLOCK", "cpl.IC"
)
@pytest.mark.covers("cpl.WAIT.nc", "cpl.IC.group.6")
def test_a_wait_tells_whether_it_ended_by_its_signal_or_its_time(living: Living) -> None:
    signal = living.pnc.system.interface
    signal.set_bit(Signals(6), 1, 3, False)
    living.write(
        "main1",
        "10 S%=CLOCK\n20 WAIT(IC(3,6,1),900,E%)\n30 #A%=E% : #B%=CLOCK-S%\n40 WAIT(,250,E%)\n"
        "50 #C%=E% : #D%=CLOCK-S%-#B%\n60 WAIT(NOT IC(3,6,1),70,E%)\n70 #E%=E% : #F%=CLOCK-S%-#B%-#D%\n"
        "80 WAIT(IC(3,6,1)=TRUE,70,E%)\n90 #G%=E%\n"
        "100 #H%=CLOCK-S%-#B%-#D%-#F%\nN110 G1 X3 F6000\nN120 WAIT\n130 #I!=MPOS(1)\n"
        "140 WAIT(IC(3,6,1)=FALSE)\n150 #J%=CLOCK-S%",
    )  # fmt: skip
    living.pnc.select_program("main1")
    living.pnc.cycle_start()
    living.pnc.advance(123)
    signal.set_bit(Signals(6), 1, 3, True)
    living.pnc.advance(900)
    assert living.pnc.variables()["#J%"] is None
    signal.set_bit(Signals(6), 1, 3, False)
    living.until_over()
    found = living.pnc.variables()
    assert [found[f"#{name}%"] for name in "ACEG"] == [2, 1, 1, 0]
    assert [found[f"#{name}%"] for name in "BDFH"] == pytest.approx([123, 250, 70, 0], abs=4)
    assert found["#I!"] == 3
    assert int(str(found["#J%"])) == pytest.approx(1023, abs=4)


WORDS = (
    "G139",
    "G138 R9",
    "G169",
    "G168 X1",
    "G269",
    "G268 X1",
    "G148",
    "G147",
    "G247",
    "G847",
    "G647",
    "M9",
    "M7",
    "M8",
)
UNTOUCHED = {17: 53, 18: 153, 19: 253, 20: 67, 21: 39, 28: 146, 30: 167, 3: 71, 4: 90, 7: 94, 8: 40}


@pytest.mark.covers("cpl.NCF", "cpl.ex.2108", "cpl.SD.1.i.1", "cpl.SD.1.i.2", "cpl.SD")
@pytest.mark.covers(*(f"cpl.SD.group.{group}" for group in UNTOUCHED))
def test_what_was_programmed_last_of_each_group_is_told_by_any_of_it(living: Living) -> None:
    asked = [f"SD(1,{group},{index})" for group in UNTOUCHED for index in (1, 2)]
    assert told(living, "N1 G1 X3 F9000\n2 WAIT", *asked) == [
        code for code in UNTOUCHED.values() for _ in (1, 2)
    ]
    groups = {
        "G13": ("G138", "G139"),
        "G16": ("G168", "G169"),
        "G26": ("G268", "G269"),
        "M": ("M7", "M8", "M9"),
    }
    lines, checks = ["1 DIM A$(5)", "N2 G18"], list[str]()
    for place, word in enumerate(WORDS):
        name = word.split()[0]
        others = next(
            (each for begin, each in groups.items() if name.startswith(begin)), ("G147", "G148", "G747")
        )
        lines.append(f"N3 {word}")
        for number, other in enumerate(others):
            lines.append(f'4 A$=NCF("{other}") : C{place}N{number}?=A$="{name}"')
            checks.append(f"?C{place}N{number}?")
    assert told(living, "\n".join([*lines, "N5 M5"]), *checks) == [1.0] * len(checks)


@pytest.mark.covers(
    "cpl.seltype.0",
    "cpl.seltype.1",
    "cpl.COF",
    "cpl.DPC",
    "cpl.SCL",
    "cpl.CPOS",
    "cpl.AXO",
    "cpl.WPOS",
    "cpl.MPOS",
)
def test_an_index_is_one_of_the_channel_unless_the_type_says_physical(turned: Living) -> None:
    """X is coordinate 3 and physical axis 4; there is no coordinate 4 and no physical axis 3."""
    before = "N1 G18 G92 X-7\nN2 G60 X25.4\nN3 G138 X50.8 R0\nN4 G38 X1.25\nN5 G1 X5 F9000\n6 WAIT"
    functions = {"COF": "", "DPC": "", "SCL": "2,", "CPOS": "", "AXO": "", "WPOS": "", "MPOS": ""}
    given = [("3", "3,1", "4,0", '"X"')] * len(functions)
    calls = [
        f"{name}({functions[name]}{each})"
        for name, kinds in zip(functions, given, strict=True)
        for each in kinds
    ]
    found = told(turned, before, *calls)
    for place, name in enumerate(functions):
        values = found[4 * place : 4 * place + 4]
        assert values == [values[0]] * 4, name
        assert values[0] not in (0, 1), name
        for wrong in ("3,0", "4"):
            what = stopped(turned, f"A={name}({functions[name]}{wrong})")
            assert what.removesuffix(" [1938]") == "INVALID PARAMETER", (name, wrong)


@pytest.mark.covers(
    "cpl.param.1003_00001", "cpl.param.1003_00002", "cpl.param.1003_00012", "cpl.param.1015_00100"
)
@pytest.mark.covers(
    "cpl.param.7010_00010", "cpl.param.7010_00020", "cpl.param.1020_00001", "cpl.MCA", "cpl.ex.2077"
)
@pytest.mark.covers("cpl.param.1001_00004", "cpl.param.7060_00010", "cpl.param.7060_00020")
def test_parameters_of_axes_have_an_element_for_each_physical_axis(living: Living) -> None:
    texts = {"100300001": ("X", "Z", "", "C", "X2", "", "U"), "701000010": ("X", "Z", "C"),
             "701000020": ("X", "Z", "C", "X2", "U"), "706000010": ("G1", "G17", "G40", "G53", "G71", "G90", "G94"),
             "706000020": ("G1", "G17", "G40", "G53", "G71", "G90", "G94")}  # fmt: skip
    numbers = {"100300002": (1, 1, 0, 1, 2, 0, 2), "100300004": (1, 1, 0, 2, 1, 0, 1),
               "100300012": (1, 1, 0, 1, 1, 0, 1)}  # fmt: skip
    lines = ["1 DIM N$(40)"]
    for number, names in texts.items():
        lines += [f'2 N$=MCA({number},{k}) : C{number[-6:]}{k}?=N$="{name}"' for k, name in enumerate(names)]
    asked = [f"?C{number[-6:]}{k}?" for number, names in texts.items() for k in range(len(names))]
    more = [f"MCA({number},{k})" for number, values in numbers.items() for k in range(len(values))]
    found = told(living, "\n".join(lines), *asked, *more)
    assert found[: len(asked)] == [1.0] * len(asked)
    assert found[len(asked) :] == [value for values in numbers.values() for value in values]


@pytest.mark.covers(
    "cpl.WPOS", "cpl.MPOS", "cpl.SPOS", "cpl.APOS", "cpl.ex.1493", "cpl.posfn.types", "cpl.cs.WCS"
)
@pytest.mark.covers("cpl.cs.MCS", "cpl.arg.coordsel", "cpl.arg.axissel")
def test_positions_of_another_channel_are_in_its_workpiece_coordinates(living: Living) -> None:
    """Each channel has a shift of its own; an axis that no channel has shows the machine's coordinates."""
    living.write("main2", '1 FXC("X2",59,3)=4.5\nN2 G22 V3\nN3 G59\nN4 G1 X2=10 F6000\nN5 G4 F60\n')
    living.pnc.select_program("main2", channel=2)
    living.pnc.cycle_start(channel=2)
    living.pnc.advance(400)
    found = told(
        living,
        '1 FXC("X",58,3)=-2.25\nN2 G22 V3\nN3 G58\nN4 G1 X3 F6000\n5 WAIT',
        *(
            "WPOS(1,1,2)",
            "MPOS(1,1,2)",
            'WPOS("X2")',
            'SPOS("X2")',
            "APOS(5)",
            "WPOS(1)",
            "MPOS(1)",
            'SPOS("X")',
            "APOS(1)",
        ),
        *('WPOS("U")', "SPOS(7)"),
    )
    living.pnc.reset(channel=2)
    u = living.pnc.axes["U"].setpoint
    assert found == pytest.approx([10, 14.5, 10, 14.5, 14.5, 3, 0.75, 0.75, 0.75, u, u])
