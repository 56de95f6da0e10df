"""Modal data of blocks that are executed and of those that come next (Manual 000, cnc_modal)."""

from __future__ import annotations

from typing import Any

import pytest

from polycnc.controllers.fanuc import PowerMate, fwlib
from polycnc.controllers.fanuc.device._modal_data import ADDRESSES


def executing(text: str, words: str, **more: Any) -> tuple[Any, int, PowerMate]:
    """Return library, handle and control in the middle of the block that begins with `words`."""
    control = PowerMate(**more)
    control.programs.memory.create("O0012", f"O0012\n{text}\n".encode())
    control.select_program(12)
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    control.cycle_start()
    for _ in range(4000):
        block = control.execution.block
        if block is not None and block.text.startswith(words):
            break
        control.advance(1)
    assert control.execution.block is not None
    assert control.execution.block.text.startswith(words)
    return session, handle, control


def g(library: Any, handle: int, group: int, block: int = 0) -> int:
    code, modal = library.cnc_modal(handle, group, block)
    assert (code, modal.datano, modal.type) == (0, group, block)
    return int(modal.modal.g_data)


@pytest.mark.covers(
    "fanuc.cnc_modal", "fanuc.example.cnc_modal", "fanuc.cnc_modal.block.0", "fanuc.cnc_modal.block.1",
    "fanuc.cnc_modal.block.2", "fanuc.ODBMDL.g_data.bit7", "fanuc.ODBMDL.g_data.bits6_0",
    "fanuc.cnc_modal.type.0_20",
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBMDL", "fanuc.ODBMDL.g_data")
def test_program_of_the_manual() -> None:
    library, handle, _ = executing(
        "N090 G18\nN100 G1 Z100. F3000\nN110 G17 G2 X10. Y-20. R12.\nN120 G91 G0 X1.", "N100"
    )
    assert [g(library, handle, 0, 0), g(library, handle, 0, 1)] == [0x81, 0x82]
    assert [g(library, handle, 1, 0), g(library, handle, 1, 1)] == [0x08, 0x80]
    assert [g(library, handle, 0, 2), g(library, handle, 2, 2), g(library, handle, 1, 2)] == [
        0x80,
        0x81,
        0x00,
    ]
    assert library.cnc_modal(handle, 103, 0)[1].modal.aux.aux_data == 3000


@pytest.mark.parametrize("inch", [False, True])
@pytest.mark.covers("fanuc.param.0000_2")
@pytest.mark.covers("fanuc.modal.G.5.0", "fanuc.modal.G.5.1")
def test_the_unit_at_power_on_is_that_of_the_setting(inch: bool) -> None:
    session = fwlib.Session()
    session.attach(0, PowerMate(inch_input=inch))
    assert g(session, session.cnc_allclibhndl()[1], 5) == (0 if inch else 1)  # before any program
    library, handle, control = executing("G1 X1. F40.", "G1", inch_input=inch)
    assert g(library, handle, 5, 0) == (0 if inch else 1)
    control.reset()
    assert g(library, handle, 5, 0) & 0x7F == (0 if inch else 1)


CODES = [
    (0, 0, "G0 X20.", "G0"),
    (0, 1, "G1 X20. F900", "G1"),
    (0, 2, "G2 X20. I10. F900", "G2"),
    (0, 3, "G3 X20. I10. F900", "G3"),
    (1, 0, "G18\nG17 G1 X20. F900", "G17"),
    (1, 4, "G19 G1 Y20. F900", "G19"),
    (1, 8, "G18 G1 Z20. F900", "G18"),
    (2, 0, "G91\nG90 G1 X20. F900", "G90"),
    (2, 1, "G91 G1 X20. F900", "G91"),
    (4, 0, "S500 M3\nG95\nG94 G1 X20. F900", "G94"),
    (4, 1, "S500 M3\nG95 G1 X20. F2.", "G95"),
    (5, 0, "G20 G1 X1. F40.", "G20"),
    (5, 1, "G21 G1 X20. F900", "G21"),
    (7, 0, "G49 G1 Z20. F900", "G49"),
    (7, 1, "G43 H2 G1 Z20. F900", "G43"),
    (7, 2, "G44 H2 G1 Z20. F900", "G44"),
]


@pytest.mark.parametrize(
    ("group", "value", "text", "words"),
    [
        pytest.param(*row, marks=pytest.mark.covers(f"fanuc.modal.G.{row[0]}.{row[1]}"), id=row[3])
        for row in CODES
    ],
)
@pytest.mark.covers("fanuc.ODBMDL.g_data", "fanuc.ODBMDL.g_rdata", "fanuc.cnc_modal.type.-1")
@pytest.mark.covers("fanuc.cnc_modal")
@pytest.mark.covers("fanuc.ODBMDL")
def test_a_code_has_its_number_and_stays_in_force(group: int, value: int, text: str, words: str) -> None:
    extra = "G1 X3. Y7. Z9. F800" if group else "X3. Y7. R50."
    library, handle, _ = executing(f"{text}\n{extra}", words)
    assert g(library, handle, group) == value | 0x80
    assert g(library, handle, group, 1) == value
    _, every = library.cnc_modal(handle, -1, 0)
    assert every.modal.g_rdata[group] == value | 0x80
    line = next(each for each in text.split("\n") if each.startswith(words))
    for begin, block in (("G4 P90", 2), ("G4 P80", 1)):  # in a block that comes next
        library, handle, _ = executing(f"G4 P90\nG4 P80\n{line}\n{extra}", begin)
        before = g(library, handle, group)
        assert before & 0x80 == 0
        assert g(library, handle, group, block) == value | 0x80
        if block == 2:
            assert g(library, handle, group, 1) == before
        else:
            assert g(library, handle, group, 2) == value


def _executes(control: PowerMate, block: str) -> bool:
    executed = control.execution.block
    return executed is not None and executed.text.startswith(block)


@pytest.mark.covers("fanuc.modal.G.11.1", "fanuc.modal.addr.102")
@pytest.mark.covers("fanuc.cnc_modal")
def test_a_modal_call_of_a_macro_and_the_argument_e() -> None:
    control = PowerMate()
    control.programs.register(1, "O0001\nG66P9000E7.25\nG1X3.F600\n#1=5\nG1X#1\nG67\nG4X1.\nM30\n")
    control.programs.register(9000, "O9000\n#500=#500+#8\nG4X0.1\nM99\n")
    library = fwlib.Session()
    library.attach(0, control)
    _, handle = library.cnc_allclibhndl()
    control.select_program(1)
    control.cycle_start()
    control.advance(100)
    assert g(library, handle, 11) == 1
    code, modal = library.cnc_modal(handle, 102, 0)
    assert (code, modal.modal.aux.aux_data) == (0, 7250)
    control.advance(2000, until=lambda: _executes(control, "G4X1."))
    assert g(library, handle, 11) == 0
    assert control.macros.get(500) == 14.5


@pytest.mark.covers("fanuc.modal.G.20.1")
def test_polar_interpolation_that_comes_next_has_its_number() -> None:
    library, handle, _ = executing("G1 X3. F600\nG12.1", "G1")
    assert g(library, handle, 20) == 0
    assert g(library, handle, 20, 1) == 1 | 0x80


@pytest.mark.covers(
    "fanuc.cnc_modal.type.-1", "fanuc.modal.G.undefined", "fanuc.modal.G.11.0", "fanuc.modal.G.20.0"
)
@pytest.mark.covers("fanuc.ODBMDL.datano", "fanuc.ODBMDL.g_rdata")
@pytest.mark.covers("fanuc.cnc_modal")
@pytest.mark.covers("fanuc.ODBMDL")
def test_all_groups_at_once_and_those_without_codes() -> None:
    library, handle, _ = executing("G91 G18\nG1 Z20. F900", "G1")
    code, modal = library.cnc_modal(handle, -1, 0)
    assert (code, modal.datano) == (0, -1)
    assert list(modal.modal.g_rdata) == [0x81, 8, 1, 0, 0, 1, *[0] * 15]


@pytest.mark.covers(
    "fanuc.ODBMDL.g_rdata", "fanuc.cnc_modal.type.-1", "fanuc.modal.G.undefined", "fanuc.modal.G.20.1"
)
@pytest.mark.covers("fanuc.cnc_modal.block.0", "fanuc.cnc_modal.block.1", "fanuc.cnc_modal.block.2")
@pytest.mark.covers(
    "fanuc.ODBMDL.datano", "fanuc.ODBMDL.type", "fanuc.ODBMDL.g_data.bit7", "fanuc.ODBMDL.g_data.bits6_0"
)
@pytest.mark.covers("fanuc.cnc_modal")
@pytest.mark.covers("fanuc.ODBMDL", "fanuc.ODBMDL.g_data")
def test_every_group_has_its_own_place_in_the_list_of_all() -> None:
    library, handle, _ = executing(
        "S700 M3\nG91 G95\nG18 G44 H2 G3 X8. Z8. R8. F.4\nG19 G12.1 G94 G20 G90 G49 G1\nG66 P9000", "G18"
    )
    groups = [0, 1, 2, 4, 5, 7, 11, 20]  # the others have no codes in the manual
    expected = {
        0: [0x83, 0x88, 1, 1, 1, 0x82, 0, 0],
        1: [0x81, 0x84, 0x80, 0x80, 0x80, 0x80, 0, 0x81],
        2: [1, 4, 0, 0, 0, 0, 0x81, 1],
    }
    for block, codes in expected.items():
        code, modal = library.cnc_modal(handle, -1, block)
        found = list(modal.modal.g_rdata)
        assert (code, modal.datano, modal.type, len(found)) == (0, -1, block, 21)
        assert [found[group] for group in groups] == codes
        assert not any(found[k] for k in range(21) if k not in groups)
        assert [g(library, handle, group, block) for group in groups] == codes


# ---------------------------------------------------------------------- addresses

NUMBERS = dict(
    enumerate(
        ("B", "D", "E", "F", "H", "L", "M", "S", "T", "R", "P", "Q", "A", "C", "I", "J", "K", "N", "O", "U", "V", "W",
         "X", "Y", "Z", "M2", "M3"),
        start=100,
    )
)  # fmt: skip


def test_addresses_are_in_the_manuals_order() -> None:
    assert list(ADDRESSES) == list(NUMBERS.values())


SINGLE = {
    "B": ("G1 B31.5 F500", 31500), "D": ("G1 X2. D9 F500", 9), "E": None, "F": ("G1 X2. F812.5", 8125),
    "H": ("G43 H6 G1 Z2. F500", 6), "L": ("G83 Z-2. R1. Q3. L4 F500", 4), "M": ("G1 X2. F500 M8 M51 M13", 8),
    "S": ("G1 X2. F500 S650", 650),
    "T": ("G1 X2. F500 T7", 7), "R": ("G2 X20. R40. F500", 40000), "P": ("G4 P125", 125),
    "Q": ("G83 Z-2. R1. Q3. F500", 3000), "A": ("G1 A4.5 F500", 4500), "C": ("G1 C7.25 F500", 7250),
    "I": ("G2 X20. I10. F500", 10000), "J": ("G2 Y-5. J-2.5 F500", -2500), "K": ("G18 G3 Z3. K1.5 F500", 1500),
    "N": ("N250 G1 X2. F500", 250), "O": ("G1 X2. F500", 12), "U": ("G1 U11. F500", 11000),
    "V": ("G1 V12.5 F500", 12500), "W": ("G1 W-3. F500", -3000), "X": ("G1 X51. F500", 51000),
    "Y": ("G1 Y-30. F500", -30000), "Z": ("G1 Z-8.125 F500", -8125), "M2": ("G1 X2. F500 M8 M51 M13", 51),
    "M3": ("G1 X2. F500 M8 M51 M13", 13),
}  # fmt: skip


@pytest.mark.covers("fanuc.cnc_modal.type.100_126", "fanuc.cnc_modal.type.-2")
@pytest.mark.parametrize(
    ("number", "text", "value"),
    [
        pytest.param(number, *found, marks=pytest.mark.covers(f"fanuc.modal.addr.{number}"), id=name)
        for number, name in NUMBERS.items()
        if (found := SINGLE[name]) is not None
    ],
)
@pytest.mark.covers("fanuc.ODBMDL.datano", "fanuc.ODBMDL.aux", "fanuc.ODBMDL.raux1")
@pytest.mark.covers("fanuc.cnc_modal")
@pytest.mark.covers("fanuc.ODBMDL")
def test_an_address_has_its_number_and_last_value(number: int, text: str, value: int) -> None:
    name = NUMBERS[number]
    control_axes = {"axes": 4, "rotary": (4,)} if name in "ABC" else {"axes": 4} if name in "UVW" else {}
    control = PowerMate(**control_axes)
    if name in (*"ABCUVW",):
        control.parameters.set(1020, ord(name), 4)
        control.power_cycle()
    control.programs.memory.create("O0012", f"O0012\n{text}\nG4 P9000\n".encode())
    control.select_program(12)
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    control.cycle_start()
    control.advance(3)
    code, modal = session.cnc_modal(handle, number, 0)
    assert (code, modal.datano, modal.modal.aux.aux_data) == (0, number, value)
    _, every = session.cnc_modal(handle, -2, 0)
    assert every.modal.raux1[number - 100].aux_data == value
    _, after = session.cnc_modal(handle, number, 1)
    again = 9000 if name == "P" else value
    assert after.modal.aux.aux_data == again


@pytest.mark.covers("fanuc.cnc_modal.type.200_205", "fanuc.cnc_modal.type.-3")
@pytest.mark.parametrize(
    ("number", "value"),
    [
        pytest.param(200 + k, value, marks=pytest.mark.covers(f"fanuc.modal.axis.{200 + k}"))
        for k, value in enumerate((51250, -3500, 4125, -17000, 61000, -72500))
    ],
)
@pytest.mark.covers("fanuc.cnc_modal")
def test_words_of_the_axes(number: int, value: int) -> None:
    names = "XYZABC"
    moves = " ".join(
        f"{name}{each}"
        for name, each in zip(names, ("51.25", "-3.5", "4.125", "-17.", "61.", "-72.5"), strict=True)
    )
    library, handle, control = executing(f"G1 {moves} F500", "G1", axes=6, rotary=(4, 5, 6))
    assert [control.units.axis_name(axis) for axis in range(1, 7)] == list(names)
    code, modal = library.cnc_modal(handle, number, 0)
    assert (code, modal.modal.aux.aux_data) == (0, value)
    _, every = library.cnc_modal(handle, -3, 0)
    assert every.modal.raux2[number - 200].aux_data == value


@pytest.mark.covers(
    "fanuc.ODBMDL.flag1.bit7", "fanuc.ODBMDL.flag1.bit6", "fanuc.ODBMDL.flag1.bit5", "fanuc.ODBMDL.flag1.bit4",
    "fanuc.ODBMDL.flag1.bits3_0", "fanuc.ODBMDL.flag2.bits2_0", "fanuc.ODBMDL.flag2.bits7_3",
)  # fmt: skip
@pytest.mark.covers("fanuc.ODBMDL.aux.flag2")
@pytest.mark.covers("fanuc.ODBMDL", "fanuc.ODBMDL.aux")
@pytest.mark.covers("fanuc.cnc_modal")
def test_what_is_known_about_a_word() -> None:
    library, handle, _ = executing("G1 X-12.5 F812.25\nY3.\nF60 X-20.", "G1")

    def flags(number: int, block: int) -> tuple[int, int]:
        aux = library.cnc_modal(handle, number, block)[1].modal.aux
        return aux.flag1, aux.flag2

    assert flags(103, 0) == (0x80 | 0x40 | 5, 2)
    assert flags(122, 0) == (0x80 | 0x20 | 3, 0)
    assert flags(103, 1) == (0x40 | 5, 2)
    assert flags(122, 1) == (0x20 | 3, 0)
    assert (flags(123, 0), flags(123, 1)) == ((0, 0), (0x80 | 1, 0))
    assert flags(103, 2) == (0x80 | 2, 0)
    library, handle, _ = executing("G1 X-12345.678 F1.23456", "G1")  # 8 digits, 5 decimals
    assert flags(122, 0) == (0x80 | 0x20 | 8, 0)
    assert flags(103, 0) == (0x80 | 0x40 | 6, 5)
    library, handle, _ = executing("G1 X12.5 Y-7. Z-.25 F812.25", "G1")
    assert [flags(address, 0)[0] for address in (122, 123, 124)] == [
        0x80 | 3,
        0x80 | 0x20 | 1,
        0x80 | 0x20 | 2,
    ]


@pytest.mark.covers("fanuc.cnc_modal")
@pytest.mark.covers("fanuc.param.3030")
def test_digits_of_m_are_those_of_the_parameter() -> None:
    library, handle, control = executing("G1 X9. F500 M8", "G1")
    assert library.cnc_modal(handle, 106, 0)[1].modal.aux.flag1 == 0x80 | 3
    control.parameters.set(3030, 5)
    assert library.cnc_modal(handle, 106, 0)[1].modal.aux.flag1 == 0x80 | 5
    for address in (125, 126):  # the second and third M code of a block
        assert library.cnc_modal(handle, address, 0)[1].modal.aux.flag1 == 5


@pytest.mark.parametrize(
    ("kind", "block", "code"),
    [
        (21, 0, "EW_NUMBER"),
        (99, 0, "EW_NUMBER"),
        (127, 1, "EW_NUMBER"),
        (206, 0, "EW_NUMBER"),
        (-4, 0, "EW_NUMBER"),
        (3, 3, "EW_ATTRIB"),
        (100, -1, "EW_ATTRIB"),
    ],
)
@pytest.mark.covers("fanuc.cnc_modal", "fanuc.cnc_modal.err.EW_ATTRIB", "fanuc.cnc_modal.err.EW_NUMBER")
def test_modal_data_are_refused(kind: int, block: int, code: str) -> None:
    control = PowerMate()
    session = fwlib.Session()
    session.attach(0, control)
    _, handle = session.cnc_allclibhndl()
    assert session.cnc_modal(handle, kind, block)[0] is fwlib.EW[code]
    assert session.cnc_modal(handle, -1, 2)[1].modal.g_rdata[5] == 1
