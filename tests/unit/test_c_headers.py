"""Structures are C text: their layout is the recorded one, a C compiler's one, and what the type stubs say."""

from __future__ import annotations

import ctypes
import json
import re
import runpy
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from polycnc.controllers.apci import pcap
from polycnc.controllers.apci.board import _declared as apci
from polycnc.controllers.fanuc import fwlib
from polycnc.controllers.fanuc.library import _structs as fanuc
from polycnc.controllers.imc import imclib
from polycnc.controllers.imc.library import _declared as imc
from polycnc.controllers.library import Bytes, Header, layout

REPOSITORY = Path(__file__).resolve().parents[2]
GOLDEN: dict[str, dict[str, Any]] = json.loads(
    (REPOSITORY / "tests" / "golden" / "structures.json").read_text("utf-8")
)
HEADERS = {"fanuc": fanuc.HEADER, "apci": apci.HEADER, "imc": imc.HEADER}
CASES = [
    *((vendor, pack) for vendor in HEADERS for pack in (None, 4)),
    ("fanuc", 8),
]


_AS_OF_OLD = """typedef long long __int64;
#define long int
#define __counted_by(n)
"""


def shown(cls: type) -> list[Any]:
    made = layout(cls)
    fields = [f"{each.offset}+{each.size} {each.declaration}" for each in made.fields]
    return [made.size, "union" if made.union else "struct", fields]


@pytest.mark.parametrize("vendor", HEADERS)
def test_every_structure_lies_as_it_always_did(vendor: str) -> None:
    header = HEADERS[vendor]
    found = {name: shown(cls) for name, cls in header.classes.items()}
    expected = {name: each for name, each in GOLDEN[vendor].items() if " of " not in name}
    assert found == expected


@pytest.mark.parametrize("name", [each for each in GOLDEN["fanuc"] if " of " in each])
def test_another_length_reaches_the_structures_inside(name: str) -> None:
    structure, _, count = name.partition(" of ")
    made = fanuc.HEADER.make(structure, ALARMS=int(count), PMC_ITEMS=int(count))
    assert shown(made) == GOLDEN["fanuc"][name]
    assert made.variant_of is fanuc.HEADER.classes[structure]
    assert made is fanuc.HEADER.make(structure, ALARMS=int(count), PMC_ITEMS=int(count))


@pytest.mark.parametrize(("vendor", "pack"), CASES)
def test_a_c_compiler_lays_them_out_alike(vendor: str, pack: int | None, tmp_path: Path) -> None:
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("no gcc: install it to have layouts compared with those of a C compiler")
    header = HEADERS[vendor]
    text = (
        header.text if pack is None else re.sub(r"#pragma pack\(\d*\)", f"#pragma pack({pack})", header.text)
    )
    asserts = []
    for name, cls in (header.classes if pack is None else header.packed(pack)).items():
        made = layout(cls)
        asserts.append(f"_Static_assert(sizeof({name}) == {made.size}, {json.dumps(name)});")
        for each in made.fields:
            place = f"__builtin_offsetof({name}, {each.name}) == {each.offset}"
            size = f"sizeof((({name} *)0)->{each.name}) == {each.size}"
            asserts.append(f"_Static_assert({place} && {size}, {json.dumps(f'{name}.{each.name}')});")
    source = tmp_path / "layout.c"
    text = text.replace("void *", "unsigned int ")  # an address of 32 bits, whatever this machine has
    source.write_text("\n".join([_AS_OF_OLD, text, *asserts, ""]), "utf-8")
    done = subprocess.run(
        [compiler, "-std=gnu11", "-Werror", "-fsyntax-only", str(source)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr[:2000]


def test_later_headers_pack_a_range_of_macro_variables_to_eight_bytes() -> None:
    later = fanuc.PACKINGS["later"]
    for count in (1, 3, 17):
        assert ctypes.sizeof(fanuc.HEADER.make("IODBMR", MAX_MACROS=count)) == 6 + 6 * count
        assert ctypes.sizeof(fanuc.HEADER.make("IODBMR", pack=later, MAX_MACROS=count)) == 8 + 8 * count


def test_what_counts_in_an_array_or_lies_at_a_pointer_is_declared() -> None:
    counted = {
        f"{name}.{each.name}": each.counted_by
        for header in HEADERS.values()
        for name, made in header.layouts.items()
        for each in made.fields
        if each.counted_by
    }
    assert counted["CBCNCT.buffer"] == "size"
    assert counted["IODBMR.data"] == "datano_e - datano_s + 1"
    fields = {
        name: {each.name for each in made.fields}
        for h in HEADERS.values()
        for name, made in h.layouts.items()
    }
    for place, terms in counted.items():
        structure = place.partition(".")[0]
        assert set(re.findall(r"[a-z]\w*", terms)) <= fields[structure], place


def test_every_pointer_says_how_much_it_leads_to() -> None:
    for header in HEADERS.values():
        for cls in header.classes.values():
            for name, each in cls._table_.elements.items():
                assert not each.held or each.counted_by, (cls, name)


LIBRARIES = {"fanuc": fwlib, "apci": pcap, "imc": imclib}


@pytest.mark.parametrize("vendor", LIBRARIES)
def test_every_argument_has_a_type_of_c(vendor: str) -> None:
    for function in LIBRARIES[vendor].FUNCTIONS.values():
        for each in function.arguments:
            known = getattr(each.type, "ctype", None) or getattr(each.type, "of", None)
            assert known is not None, (function.prototype, each.name)


@pytest.mark.parametrize("vendor", LIBRARIES)
def test_every_array_says_how_many_elements_c_passes(vendor: str) -> None:
    constants = HEADERS[vendor].constants
    for function in LIBRARIES[vendor].FUNCTIONS.values():
        counted = {each.length_of for each in function.arguments}
        names = {each.name for each in function.arguments}
        for each in function.arguments:
            elements = getattr(each.type, "of", None)
            array = elements not in (None, callable) or isinstance(each.type, Bytes) or each.zero() == []
            assert bool(each.many) == (array and each.name not in counted), (function.prototype, each.name)
            terms = set(re.findall(r"[A-Za-z]\w*(?=\.|\b)", re.sub(r"\.\w+", "", each.many))) - {"max"}
            assert terms <= names | set(constants), (function.prototype, each.many)


PAGES: dict[str, Any] = runpy.run_path(str(REPOSITORY / "scripts" / "_pages.py"))
STUBS: dict[str, Callable[[], str]] = PAGES["STUBS"]


@pytest.mark.parametrize("path", STUBS)
def test_a_stub_has_what_the_header_declares(path: str) -> None:
    assert (REPOSITORY / path).read_text("utf-8") == STUBS[path]()


@pytest.mark.parametrize(
    "wrong",
    [
        "struct { short a; } A;",
        "typedef struct { short a } A;",
        "typedef struct { short a; short; } A;",
        "typedef struct { short a[]; } A;",
        "#pragma pack(push, 2)",
        "typedef struct { unheard a; } A;",
        "typedef struct { short a[MANY]; } A;",
    ],
)
def test_c_that_the_reader_does_not_know_is_refused(wrong: str) -> None:
    with pytest.raises(ValueError, match=r"not understood|no type|MANY"):
        Header(wrong, __name__)


def test_a_header_declares_constants_types_and_what_lies_beside() -> None:
    header = Header(
        """
        #define DEPTH 3
        typedef unsigned short WORD;
        #pragma pack(2)
        /* A tape. */
        typedef struct { char mark; WORD wound[DEPTH], end; text name[5], titles[2][4]; } TAPE;
        typedef struct { double length; long turns; } TAPE_beside;
        #pragma pack()
        typedef union { TAPE tape[2]; double any; } EITHER;
        """,
        __name__,
        characters=str,
        checked=True,
    )
    tape = header.classes["TAPE"]
    assert tape.__doc__ == "A tape."
    made = tape(-3, [7, 8], 9, "abc")
    assert (made.wound, made.name, made.length, made.turns) == ([7, 8, 0], "abc", 0.0, 0)
    assert made.pack() == b"\xfd\0\7\0\x08\0\0\0\x09\0abc\0\0" + bytes(9)
    assert (header.constants, list(header.classes)) == ({"DEPTH": 3}, ["TAPE", "EITHER"])
    assert ctypes.sizeof(header.classes["EITHER"]) == 48
    assert [each.declaration for each in header.layouts["TAPE"].fields][1:3] == ["WORD wound[3]", "WORD end"]


def test_without_a_word_about_packing_c_aligns_and_cuts() -> None:
    made = Header("typedef struct { char a; long b; } LOOSE;", __name__).classes["LOOSE"]
    assert (ctypes.sizeof(made), made.b.offset) == (8, 4)
    assert made(b=2**32 + 5).b == 5
