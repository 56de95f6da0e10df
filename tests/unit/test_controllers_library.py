"""The façade desk on a library of no vendor: a reel of tape that is opened, wound and read."""

from __future__ import annotations

import ctypes
import inspect
import threading
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

import pytest

from polycnc.controllers.library import (
    IN,
    INOUT,
    INT,
    LONG,
    OUT,
    SHORT,
    USHORT,
    Bytes,
    Code,
    Coded,
    Facade,
    Handles,
    Header,
    Layout,
    LengthOf,
    Number,
    Out,
    Pointer,
    Real,
    Refused,
    Session,
    Text,
    Whole,
    layout,
    layouts,
    variant,
)
from polycnc.controllers.library._structures import Element, Table, lay_out
from polycnc.errors import UsageError


class Tape(Code):
    DONE = 0, "done"
    LENGTH = 2, "the length is wrong"
    NUMBER = 3, "there is no such place"
    HANDLE = -8, "this is no handle"


HEADER = Header(
    """
    typedef union { char byte; short word; long many[3]; } Value;
    #pragma pack(2)
    typedef struct { short place; Value value; text name[5]; } Entry;
    typedef struct { long note; } Entry_beside;
    typedef struct {
        unsigned short number;
        Entry entry[2];
        text titles[3][4];
        unsigned char flags[2][3];
        short tail[1];
    } Reel;
    """,
    __name__,
)
if TYPE_CHECKING:
    Value: TypeAlias = Any
    Entry: TypeAlias = Any
    Reel: TypeAlias = Any
else:
    Value, Entry, Reel = (HEADER.classes[name] for name in ("Value", "Entry", "Reel"))


class Machine:
    """What a session has open."""

    def __init__(self) -> None:
        self.values = [11, -22, 33, 44]
        self.busy = 0
        self.overlaps = 0


class Program(Session):
    def __init__(self) -> None:
        super().__init__()
        self.reels = {4: Machine()}
        self.open: Handles[Machine] = Handles(Tape.HANDLE, first=5, last=7)

    def find(self, handle: int) -> Machine:
        return self.open.find(handle)


FACADE = Facade("somewhere.tape", Program(), code="short")
session_call = FACADE.on(lambda session: session)
call = FACADE.through(Program.find, USHORT, name="hndl")
counting = FACADE.on(lambda session: session.open, refused=9)


@session_call
def tp_open(session: Program, number: LONG) -> tuple[Tape, Annotated[USHORT, Out("hndl")]]:
    """Open a reel."""
    if number not in session.reels:
        raise Refused(Tape.NUMBER)
    return Tape.DONE, session.open.add(session.reels[number])


@session_call
def tp_close(session: Program, hndl: USHORT) -> Tape:
    """Close it."""
    session.open.free(hndl)
    return Tape.DONE


@call
def tp_read(
    tape: Machine,
    s_no: Annotated[SHORT, INOUT],
    length: Annotated[SHORT, INOUT, LengthOf("data")],
    step: SHORT = 1,
) -> tuple[
    Tape,
    int,
    int,
    Annotated[list[int], LONG, Out("data", before="step")],
    Annotated[int, Number("char", ctypes.c_int8), Out("more")],
]:
    """Read from a place on; how many there were and where it ended comes back."""
    if not 0 <= s_no < len(tape.values):
        raise Refused(Tape.NUMBER)
    found = tape.values[s_no : s_no + length * step : step]
    return Tape.DONE, s_no + len(found), len(found), found, int(s_no + len(found) < len(tape.values))


@call
def tp_describe(
    tape: Machine, reel: Annotated[Reel, OUT], what: Annotated[str | None, Text(null=True)]
) -> None:
    """Fill a structure in place."""
    reel.number = len(tape.values)
    reel.titles[2].value = (what or "-").encode()


@call
def tp_count(tape: Machine) -> INT:
    """Return a number that is no code."""
    return len(tape.values)


@call
def tp_state(tape: Machine) -> Annotated[int, INT, Coded()]:
    """Return a plain number that is a code."""
    return 1


@call
def tp_entry(
    tape: Machine, place: Annotated[int, Whole("short", ctypes.c_int16, 1, 2, Tape.NUMBER)]
) -> tuple[Tape, Annotated[Entry, Out("entry")]]:
    """Return a structure."""
    return Tape.DONE, Entry(place=place)


@call
def tp_speed(tape: Machine, speed_: Annotated[float, Real()]) -> Annotated[float, Real(), Out("speed")]:
    """Return what a function without a code writes through a pointer."""
    tape.busy += 1
    tape.overlaps += tape.busy > 1
    threading.Event().wait(0.001)
    tape.busy -= 1
    return 2.5 * speed_


@call
def tp_write(
    tape: Machine, data: Annotated[Any, Bytes("char *")], length: Annotated[SHORT, LengthOf("data")]
) -> Tape:
    """Store bytes."""
    tape.values = list(data[:length])
    return Tape.DONE


@counting
def tp_opened(opened: Handles[Machine]) -> INT:
    """Return how many are open, and 9 instead of a code."""
    if not len(opened):
        raise Refused(Tape.NUMBER)
    return len(opened)


@pytest.fixture
def program() -> Program:
    return Program()


def test_the_table_has_the_prototypes_that_the_annotations_say() -> None:
    assert [each.prototype for each in FACADE.functions.values()] == [
        "short tp_open(long number, unsigned short *hndl)",
        "short tp_close(unsigned short hndl)",
        "short tp_read(unsigned short hndl, short *s_no, short *length, long *data, short step, char *more)",
        "void tp_describe(unsigned short hndl, Reel *reel, char *what)",
        "int tp_count(unsigned short hndl)",
        "int tp_state(unsigned short hndl)",
        "short tp_entry(unsigned short hndl, short place, Entry *entry)",
        "void tp_speed(unsigned short hndl, double speed, double *speed)",
        "short tp_write(unsigned short hndl, char *data, short length)",
        "int tp_opened(void)",
    ]


def test_every_argument_has_its_direction_and_says_whether_python_has_it() -> None:
    read = FACADE.functions["tp_read"]
    assert [
        (each.name, each.direction, each.passed, each.returned, each.length_of) for each in read.arguments
    ] == [
        ("hndl", IN, True, False, ""),
        ("s_no", INOUT, True, True, ""),
        ("length", INOUT, True, True, "data"),
        ("data", OUT, False, True, ""),
        ("step", IN, True, False, ""),
        ("more", OUT, False, True, ""),
    ]
    assert [each.name for each in FACADE.functions["tp_describe"].passed] == ["hndl", "reel", "what"]
    assert not any(each.returned for each in FACADE.functions["tp_describe"].arguments)


def test_what_c_writes_through_pointers_comes_back_behind_the_code_in_the_manuals_order(
    program: Program,
) -> None:
    code, handle = program.tp_open(4)
    assert (code, handle) == (Tape.DONE, 5)
    assert program.tp_read(handle, 1, 2) == (Tape.DONE, 3, 2, [-22, 33], 1)
    assert program.tp_read(handle, s_no=0, length=9, step=3) == (Tape.DONE, 2, 2, [11, 44], 1)
    assert program.tp_speed(handle, 3) == 7.5
    assert program.tp_count(handle) == 4
    assert program.tp_entry(handle, 2)[1].place == 2


def test_a_refused_call_answers_with_the_code_and_what_was_not_read_is_zero(program: Program) -> None:
    assert program.tp_open(5) == (Tape.NUMBER, 0)
    assert program.tp_open(5)[0].text == "there is no such place"
    assert program.tp_read(5, 1, 2) == (Tape.HANDLE, 1, 2, [], 0)  # what went in comes back
    _, handle = program.tp_open(4)
    assert program.tp_read(handle, 4, 2) == (Tape.NUMBER, 4, 2, [], 0)
    assert program.tp_entry(handle, 3) == (Tape.NUMBER, Entry())
    assert program.tp_count(6) == 0
    assert program.tp_speed(6, 3.0) == 0.0
    assert program.tp_state(6) == Tape.HANDLE
    assert program.tp_describe(6, Reel(), "x") is None
    program.tp_close(handle)
    assert program.tp_opened() == 0  # no code: nothing is read


def test_a_structure_is_filled_in_place_and_can_lie_in_the_callers_memory(program: Program) -> None:
    _, handle = program.tp_open(4)
    memory = bytearray(ctypes.sizeof(Reel))
    program.tp_describe(handle, Reel.from_buffer(memory), b"ab\0cd")
    assert memory[:2] == b"\4\0"
    assert Reel.unpack(bytes(memory)).titles[2].value == b"ab"
    program.tp_describe(handle, variant(Reel, tail=9)(), None)
    with pytest.raises(UsageError, match=r"tp_describe: reel cannot be .*Entry"):
        program.tp_describe(handle, Entry(), "x")


def test_numbers_are_converted_as_c_does(program: Program) -> None:
    _, handle = program.tp_open(4.9)
    assert program.tp_read(handle + 65536, 65537, 1) == (Tape.DONE, 2, 1, [-22], 1)
    assert program.tp_read(handle, True, 1.9) == (Tape.DONE, 2, 1, [-22], 1)
    for bad in ("1", None, float("nan"), float("inf")):
        with pytest.raises(UsageError, match="s_no cannot be") as told:
            program.tp_read(handle, bad, 1)
        assert "short *s_no" in str(told.value.hint)
    with pytest.raises(UsageError, match=r"tp_read: .*s_no") as told:
        program.tp_read(handle)
    assert "tp_read(" in str(told.value.hint)


@pytest.mark.parametrize(
    ("given", "values"),
    [("Ab", [65, 98]), (b"\0\xff", [0, 255]), (Entry(place=258), [2, 1]), ([Entry(place=3)] * 2, [3, 0])],
)
def test_memory_may_be_bytes_text_or_structures(program: Program, given: object, values: list[int]) -> None:
    _, handle = program.tp_open(4)
    assert program.tp_write(handle, given, 2) == Tape.DONE
    assert program.reels[4].values == values
    for bad in (None, 3):
        with pytest.raises(UsageError, match="data cannot be"):
            program.tp_write(handle, bad, 2)


def test_a_null_pointer_is_refused_where_there_is_a_code_for_it() -> None:
    assert Pointer("Reel *", Reel).take(given := Reel(), None) is given
    with pytest.raises(TypeError):
        Pointer("Reel *", Reel).take(None, None)
    with pytest.raises(Refused) as refused:
        Pointer("Reel *", Reel, Tape.NUMBER).take(None, None)
    assert refused.value.code is Tape.NUMBER


def test_two_sessions_know_nothing_of_each_other(program: Program) -> None:
    other = Program()
    _, handle = program.tp_open(4)
    program.tp_write(handle, b"\7", 1)
    assert other.tp_count(handle) == 0
    _, same = other.tp_open(4)
    assert (same, other.tp_count(same), program.tp_count(handle)) == (handle, 4, 1)
    assert tp_count(handle) == 0  # the functions of the module have a session of their own
    assert tp_open(4) == (Tape.DONE, handle)
    assert tp_count(handle) == 4
    assert tp_close(handle) == Tape.DONE
    assert "tp_close" in dir(program)
    with pytest.raises(AttributeError, match="'Program' has no attribute 'tp_colse'"):
        _ = program.tp_colse


def test_calls_of_several_threads_are_carried_out_one_at_a_time(program: Program) -> None:
    _, handle = program.tp_open(4)
    threads = [threading.Thread(target=program.tp_speed, args=(handle, k)) for k in range(8)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert (program.reels[4].busy, program.reels[4].overlaps) == (0, 0)


def test_handles_are_not_given_twice_and_come_to_an_end() -> None:
    handles: Handles[str] = Handles(Tape.HANDLE, first=5, last=7)
    assert [handles.add(each) for each in "abc"] == [5, 6, 7]
    with pytest.raises(Refused):
        handles.add("d")
    assert handles.free(6) == "b"
    with pytest.raises(Refused):
        handles.find(6)
    assert (handles.add("e"), handles.find(6), len(handles)) == (6, "e", 3)
    handles.clear()
    assert handles.add("f") == 7  # not the one that was given last


def test_the_public_function_looks_like_what_a_program_calls() -> None:
    assert list(inspect.signature(tp_read).parameters) == ["tape", "s_no", "length", "step"]
    assert (tp_read.__name__, tp_read.__module__) == ("tp_read", "somewhere.tape")
    assert (tp_read.__doc__ or "").startswith("Read from a place on")
    assert FACADE.alias("tp_raed", tp_read) is tp_read
    assert Program().tp_raed(1, 2, 3) == (Tape.HANDLE, 2, 3, [], 0)


@pytest.mark.parametrize("wrong", ["no_type", "too_many", "nothing_to_count", "no_result", "unknown_place"])
def test_annotations_that_do_not_say_all_are_refused_when_the_library_is_written(wrong: str) -> None:
    def no_type(session: Program, number: int) -> None: ...
    def too_many(session: Program, number: LONG) -> tuple[Tape, int]: ...  # type: ignore[empty-body]
    def nothing_to_count(session: Program, number: Annotated[LONG, LengthOf("data")]) -> None: ...
    def no_result(session: Program) -> int: ...  # type: ignore[empty-body]
    def unknown_place(session: Program) -> tuple[Tape, Annotated[LONG, Out("x", before="y")]]: ...  # type: ignore[empty-body]

    with pytest.raises((TypeError, ValueError)):
        Facade("x", Program(), code="short").on(lambda session: session)(locals()[wrong])


# ---------------------------------------------------------------------- structures


def test_a_structure_lies_in_memory_as_its_table_says() -> None:
    assert ctypes.sizeof(Value) == 12
    table = layouts(Entry, Reel, Value)
    assert table["Entry"].size == 2 + 12 + 5 + 1  # filled up to 2
    assert [(each.name, each.offset, each.size) for each in table["Entry"].fields] == [
        ("place", 0, 2),
        ("value", 2, 12),
        ("name", 14, 5),
    ]
    reel = table["Reel"]
    assert [(each.declaration, each.offset) for each in reel.fields] == [
        ("unsigned short number", 0),
        ("Entry entry[2]", 2),
        ("char titles[3][4]", 42),
        ("unsigned char flags[2][3]", 54),
        ("short tail[1]", 60),
    ]
    assert (reel.size, reel.union, table["Value"].union) == (62, False, True)
    assert isinstance(reel, Layout)


def test_a_structure_takes_its_arrays_however_many_other_structures_there_are() -> None:
    first, *_ = (
        lay_out(f"T{count}", False, Table({"at": Element("short", ctypes.c_short, int, (count,))}))
        for count in range(1, 300)
    )
    made = first()
    made.at = [7]
    assert made.at[0] == 7


def test_members_of_a_union_are_the_same_memory() -> None:
    entry = Entry()
    entry.value.many[0] = 0x01020380
    assert (entry.value.word, entry.value.byte) == (0x0380, -128)
    assert entry.pack()[2:6] == b"\x80\x03\x02\x01"
    assert Entry.unpack(entry.pack()) == entry != Entry()
    assert hash(Entry.unpack(entry.pack())) == hash(entry)
    assert entry != 3
    assert repr(entry) == "Entry(place=0, value=Value(byte=-128, word=896, many=[16909184, 0, 0]), name=b'')"
    with pytest.raises(UsageError, match="Entry has 20 bytes, not 3"):
        Entry.unpack(b"abc")
    with pytest.raises(AttributeError):
        entry.plcae = 3


def test_an_element_without_a_c_type_is_beside_the_memory() -> None:
    entry = Entry()
    entry.note = 1 << 40
    assert (entry.note, entry.pack()) == (1 << 40, bytes(20))


def test_a_variant_has_other_lengths_or_packing_and_the_same_elements() -> None:
    longer = variant(Reel, tail=6)
    assert longer is variant(Reel, tail=6)
    assert ctypes.sizeof(longer) == 62 + 5 * 2
    made = longer(number=3)
    made.tail[5] = -9
    assert made.pack()[-2:] == b"\xf7\xff"
    assert layout(longer).fields[-1].counts == (6,)
    loose = HEADER.make("Entry", pack=4)
    assert (loose.value.offset, ctypes.sizeof(loose)) == (4, 24)
    assert (Entry.value.offset, loose.__name__, ctypes.sizeof(variant(Entry))) == (2, "Entry", 20)


def test_codes_are_numbers_with_a_text() -> None:
    assert (Tape(3), Tape.NUMBER + 1, Tape.HANDLE.text) == (Tape.NUMBER, 4, "this is no handle")


@pytest.mark.parametrize("size", [400, 5000], ids=str)  # Python writes no number of over 4,300 digits
@pytest.mark.parametrize("number", [1, -1], ids=["positive", "negative"])
def test_a_number_of_any_length_is_refused_in_a_sentence(program: Program, number: int, size: int) -> None:
    _, handle = program.tp_open(4)
    long = number * 10**size
    for call, given in (
        (program.tp_write, (handle, long, 2)),
        (program.tp_describe, (handle, long, "x")),
        (program.tp_describe, (handle, Reel(), long)),
        (program.tp_read, (handle, [long], 1)),
    ):
        with pytest.raises(UsageError, match="cannot be") as told:
            call(*given)
        assert len(str(told.value)) < 700
