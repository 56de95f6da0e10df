"""The records against the layouts that a C compiler gives the manual's tables (ctypes, 4-byte alignment)."""

import ctypes
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from polycnc.controllers.apci.board import _records as records
from polycnc.controllers.apci.board._declared import HEADER
from polycnc.controllers.apci.board._records import (
    AS,
    CDBUF,
    CIBUF,
    CTRLPARAMS,
    HMP,
    LMP,
    MAXAXIS,
    ROSI,
    SPDBUF,
    TSRP,
    pack_all,
)
from polycnc.controllers.library import Structure, layout
from polycnc.errors import UsageError

INT, DOUBLE = ctypes.c_int32, ctypes.c_double


def names(text: str) -> list[str]:
    return text.split()


RAMP = "ac vl tvl"
# Elements in order: DOUBLE unless another type is given.
TABLES: dict[str, tuple[int, list[Any]]] = {
    "AS": (76, [("unoa", INT), ("san", INT * 18)]),
    "TSRP": (
        208,
        [("an", INT)]
        + names("kp ki kd kpl kfca kfcv jac jvl jtv jovr hac hvl rp dp tp sll slr ipw mpe gf")
        + [(name, INT) for name in names("mcp axst lsm epc digi digo ifs")]
        + [("scratch", INT * 4)],
    ),
    "TRU": (8, [("pu", INT), ("tu", INT)]),
    "LMP": (168, [*names(RAMP), ("dtm", DOUBLE * 18)]),
    "CMP": (48, names(f"{RAMP} phi dtca1 dtca2")),
    "HMP": (192, [*names(f"{RAMP} phi dtca1 dtca2"), ("dtm", DOUBLE * 18)]),
    "HMP3D": (224, [*names(f"{RAMP} phi dtca1 dtca2 dtca3 pn1 pn2 pn3"), ("dtm", DOUBLE * 18)]),
    "ROSI": (88, [("revision", ctypes.c_char * 80), ("number_axis", INT), ("sysfile_loaded", INT)]),
    "CBCNCT": (
        12,
        [("task_number", INT), ("size", INT), ("buffer", ctypes.c_uint32)],
    ),  # a pointer of 32 bits
    "CNCTS": (20, [(name, INT) for name in names("errnum errline stackfree running csrcline")]),
    "CDBUF": (8000, [("cd", DOUBLE * 1000)]),
    "CIBUF": (4000, [("ci", INT * 1000)]),
    "SPDBUF": (8000, [("position", DOUBLE * 1000)]),
    "CTRLPARAMS": (1800, [("parameters", DOUBLE * 225)]),
    "CppString": (1024, [("text", ctypes.c_char * 1024)]),
}
# Rows of records that are nothing but their layout; the others say what a command does with them.
CLAIMS = {name: f"apci.{name}" for name in names("TRU LMP HMP3D ROSI CDBUF CIBUF CTRLPARAMS")}


def c_struct(name: str) -> type[ctypes.Structure]:
    fields = [(each, DOUBLE) if isinstance(each, str) else each for each in TABLES[name][1]]
    return type(name, (ctypes.Structure,), {"_pack_": 4, "_layout_": "ms", "_fields_": fields})


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.covers(CLAIMS[name]) if name in CLAIMS else ()) for name in TABLES],
)
def test_a_record_has_the_elements_and_the_memory_of_its_table(name: str) -> None:
    size, table = TABLES[name]
    record: Any = vars(records).get(name, HEADER.classes[name])
    compiled = c_struct(name)
    stated = layout(record)
    assert records.STRUCTURES[name] == stated
    assert stated.size == size == ctypes.sizeof(compiled) == ctypes.sizeof(record)
    assert [each.name for each in stated.fields] == [
        each if isinstance(each, str) else each[0] for each in table
    ]
    assert [each.offset for each in stated.fields] == [
        getattr(compiled, each.name).offset for each in stated.fields
    ]
    assert record().pack() == bytes(size)
    assert record.unpack(record().pack()) == record()


@pytest.mark.covers("apci.def.alignment", "apci.TSRP", "apci.TSRP.scratch", "apci.MAXAXIS")
def test_the_tsrp_of_all_axes_lie_directly_behind_each_other() -> None:
    array = records.tsrp_array()
    assert len(array) == MAXAXIS == 18
    for axis, record in enumerate(array):
        record.an, record.kp, record.gf, record.mcp, record.ifs = (
            axis,
            axis + 0.5,
            -axis * 2.0,
            -axis,
            axis << 16,
        )
        record.scratch[:] = [axis, 2, 3, -4]
    memory = (c_struct("TSRP") * 18).from_buffer_copy(pack_all(array))
    for axis, seen in enumerate(memory):
        assert (seen.an, seen.kp, seen.gf, seen.mcp, seen.ifs) == (
            axis,
            axis + 0.5,
            -axis * 2.0,
            -axis,
            axis << 16,
        )
        assert list(seen.scratch) == [axis, 2, 3, -4] == list(array[axis].scratch)
    assert TSRP.unpack(bytes(memory)[17 * 208 :]) == array[17]
    assert ctypes.sizeof(ctypes.c_int) * 4 == 208 - layout(TSRP).fields[-1].offset  # scratch ends the record


def test_what_stands_in_no_table_is_not_in_the_memory() -> None:
    assert TSRP(aux=1.0, lp=2.0, dv=3.0, sdec=4.0).pack() == bytes(208)
    with pytest.raises(AttributeError):
        TSRP().jvll = 1.0


@pytest.mark.covers("apci.LONGINT")
def test_longint_has_32_bits_and_a_sign() -> None:
    for value in (-(2**31), 2**31 - 1):
        assert AS.unpack(AS(value).pack()).unoa == value
        assert int.from_bytes(AS(value).pack()[:4], "little", signed=True) == value
    for value in (-(2**31) - 1, 2**31):
        with pytest.raises(UsageError, match=r"AS\.unoa does not hold"):
            AS(value).pack()


@pytest.mark.covers("apci.AS", "apci.AS.unoa", "apci.AS.san")
def test_the_first_and_third_axis_are_selected_in_their_order() -> None:
    selection = AS()
    selection.unoa, selection.san[0], selection.san[1] = 2, 0, 2  # the manual's example
    assert selection == AS.of(0, 2)
    assert selection.axes() == (0, 2)
    assert AS.of(2, 0).axes() == (2, 0)
    assert AS.of(*range(18)).axes() == tuple(range(18))
    assert not selection.names_an_axis_twice
    selection.unoa = 3  # san[2] is still 0
    assert selection.axes() == (0, 2, 0)
    assert selection.names_an_axis_twice


@pytest.mark.parametrize(
    ("unoa", "san", "axes"), [(-1, [], 18), (19, [], 18), (1, [18], 18), (1, [-1], 18), (2, [0, 3], 3)]
)
def test_a_selection_of_axes_that_are_not_there_is_refused(unoa: int, san: list[int], axes: int) -> None:
    with pytest.raises(UsageError, match=r"unoa is|no axis"):
        AS(unoa, san + [0] * (18 - len(san))).axes(axes)
    with pytest.raises(UsageError):
        AS.of(*range(19))


@pytest.mark.covers("apci.LMP.dtm")
def test_dtm_is_indexed_by_axis_number_not_by_place_in_the_selection() -> None:
    lmp = LMP()
    lmp.dtm[4], lmp.dtm[1] = 5.5, -2.0  # axis 4 is the fifth
    assert lmp.distances(AS.of(4)) == (5.5,)
    assert lmp.distances(AS.of(4, 0, 1)) == (5.5, 0.0, -2.0)


@pytest.mark.covers("apci.const.phithreshold")
def test_an_angle_up_to_the_threshold_means_the_target_point() -> None:
    assert HMP(phi=1e-100).ends_at_target
    assert HMP(phi=-1e-100).ends_at_target
    assert HMP(phi=0.0).ends_at_target
    assert not HMP(phi=1.01e-100).ends_at_target
    assert not HMP(phi=-1.01e-100).ends_at_target
    assert [HMP(phi=phi).turns_clockwise for phi in (-90.0, -1e-101, 0.0, 1e-101)] == [
        True,
        True,
        False,
        False,
    ]


@pytest.mark.covers("apci.SPDBUF", "apci.const.spdsize")
def test_a_table_of_setpoints_has_1_to_1000_positions() -> None:
    buffer = SPDBUF([float(number) for number in range(1000)])
    assert buffer.points(1) == (0.0,)
    assert buffer.points(1000)[999] == 999.0
    for size in (0, 1001, -1):
        with pytest.raises(UsageError, match="positions"):
            buffer.points(size)


@pytest.mark.covers("apci.const.cncount")
def test_there_are_1000_common_variables_of_each_kind() -> None:
    assert (len(CIBUF().ci), len(CDBUF().cd)) == (1000, 1000)
    integers, doubles = CIBUF(), CDBUF()
    integers.ci[999], doubles.cd[999] = -7, 0.1
    assert CIBUF.unpack(integers.pack()).ci[999] == -7
    assert CDBUF.unpack(doubles.pack()).cd[999] == 0.1


def test_a_long_array_or_text_and_a_large_number_do_not_fit() -> None:
    for record, value, what in (
        (CDBUF, [1.0] * 1001, r"CDBUF\.cd .*\n.*double\[1000\]"),
        (ROSI, "x" * 80, r"ROSI\.revision .*79 characters"),
        (CTRLPARAMS, [[1.0]] * 16, r"double\[15\]\[15\]"),
        (CTRLPARAMS, [[1.0] * 15] * 14 + [[1.0] * 16], r"double\[15\]\[15\]"),
        (AS, "high", r"AS\.unoa"),
        (CIBUF, [2**31] + [0] * 999, r"CIBUF\.ci .*too large"),
    ):
        with pytest.raises(UsageError, match=what):
            record(value)
    assert list(LMP(dtm=[2.5, -1.0]).dtm) == [2.5, -1.0, *[0.0] * 16]  # as C fills up
    axis = TSRP(kp=5.5)
    with pytest.raises(UsageError, match=r"TSRP\.kp"):
        axis.kp = "high"  # type: ignore[assignment]
    assert axis == TSRP(kp=5.5)
    with pytest.raises(UsageError, match="TRU has 8 bytes, not 7"):
        records.TRU.unpack(bytes(7))


def test_a_record_is_its_memory() -> None:
    memory = bytearray(208 * 18)
    array = (TSRP * 18).from_buffer(memory)
    array[17].jac = 2.5
    array[17].aux = 3.5  # beside the memory
    assert memory[208 * 17 + 52 : 208 * 17 + 60] == array[17].pack()[52:60] == b"\0\0\0\0\0\0\x04@"
    memory[208 * 17 : 208 * 17 + 4] = (5).to_bytes(4, "little")
    assert (array[17].an, TSRP().aux) == (5, 0.0)
    transfer = records.CBCNCT(1, 3, bytearray(b"abc"))
    transfer.buffer[1:2] = b"x"
    assert (bytes(transfer.buffer), transfer.pack()) == (b"axc", b"\1\0\0\0\3\0\0\0\0\0\0\0")
    assert transfer != records.CBCNCT(1, 3)


def test_text_and_tables_come_back() -> None:
    assert ROSI.unpack(ROSI("V2.5.3.88", 3, 1).pack()) == ROSI("V2.5.3.88", 3, 1)
    parameters = CTRLPARAMS([[row + column / 16 for column in range(15)] for row in range(15)])
    assert CTRLPARAMS.unpack(parameters.pack()) == parameters


@given(st.data())
def test_any_numbers_come_back_from_memory(data: st.DataObject) -> None:
    def fill(record: Structure) -> None:
        for each in layout(type(record)).fields:
            number = st.integers(-(2**31), 2**31 - 1) if each.c == "LONGINT" else st.floats(allow_nan=False)
            if each.counts:
                length = each.counts[0]
                setattr(record, each.name, data.draw(st.lists(number, min_size=length, max_size=length)))
            else:
                setattr(record, each.name, data.draw(number))

    record = data.draw(st.sampled_from([AS, TSRP, LMP, HMP, records.CNCTS]))()
    fill(record)
    assert type(record).unpack(record.pack()) == record
    seen = c_struct(type(record).__name__).from_buffer_copy(record.pack())
    for each in layout(type(record)).fields:
        value, mine = getattr(seen, each.name), getattr(record, each.name)
        assert list(value) == list(mine) if each.counts else value == mine
