"""The page of the C libraries: exports, what lies behind pointers, codes when nobody is there, the protocol."""

# ruff: noqa: E501  a row of a table is a line

from collections.abc import Iterator

from polycnc.controllers.library.clib import PORT, CLibrary, Slot, Way
from polycnc.servers.calls import LIBRARIES, TARGETS, library_of

_HEAD = f"""# C libraries

`polycnc clib KIND` writes a library with the name and the exports of the maker's; programs that link against it or load
it reach a served machine through the door `calls`. The [tutorial](../tutorials/your-old-program.md) does it. The library
is C99 on sockets; nothing else of Python or polycnc is in the program's process.

| what | value |
| --- | --- |
| header | C11 and C++17; the sizes and offsets of all structures are asserted when it is compiled. `PC_LONG` has 32 bits: it is `long` where that has 32, else `int` |
| where the machine is | the environment variable `POLYCNC_CALLS=HOST:PORT`; else the line `calls = "HOST:PORT"` of `polycnc.toml` beside the program, else beside the library; else 127.0.0.1:{PORT} |
| names | exported as they are, without decoration, also in 32-bit Windows libraries, whose functions are `stdcall` |
| structures | packed as the manuals have them; for programs made with later headers of `fwlib32`, which pack to 4 bytes, the library is written with `--packing 4`. A length counts the program's bytes: ranges of macro variables are `8 + 8 * n` instead of `6 + 6 * n` |
| clients | one connection is one program of the library, with its own handles; calls of several threads are carried out one after the other |
| time | passes at the rate of the served machine; calls that follow each other closely find it as it was up to 5 ms before |
| waiting | 10 s for an answer, also where it comes in pieces; with `cnc_allclibhndl3` as long as the program says. Threads that call other controls do not wait meanwhile; those that open the same one share its outcome |
| the program's stack | 16 kB are enough for a call, 32 kB for one that opens |
| a fork | the child has no connection and no handle, and may open its own; calls of the parent's threads go on |
| null pointers | refused with a code; nothing is carried out. The password of `IMC_OpenUsePassword` may be null |
| refused calls | write nothing; others write never more than the length that the program passes, or one structure |

## Targets

| target | library | compiler |
| --- | --- | --- |
"""

_TAIL = """
## Other languages

Beside the header there are declarations for programs of other languages that use the same library:

| file | for | texts | records of several | null pointers |
| --- | --- | --- | --- | --- |
| `NAME.pas` | Delphi, Free Pascal: a unit | `PAnsiChar` | the first element | none |
| `NAME.cs` | C#: a class of `DllImport`, `Mcug3` for `mcug3` | `string`, what is written `StringBuilder` | an array | of arrays and texts |
| `mcug3.bas` | Visual Basic 6: a module | `String` | the first element | `vbNullString` of texts |

Names are those of C. One that is a word of the language, in Pascal and Visual Basic also one that is that of a type, has a `_` behind it
(`AS_`), in C# an `@` before it. Unions of C# are their `bytes`. A program of Pascal, of C#, of Visual Basic, and a C program
that loads the library by name while it runs are in `examples/`.

## In the program's own process

`polycnc clib KIND --in-process` (Linux of 64 bits, a Python with a shared library and its headers) builds the same library with the
machines in it: the interpreter that ran the command is loaded with the first call, `POLYCNC_PYTHON` names another one. Frames,
answers and bytes are the same; no server is needed, and `POLYCNC_CALLS` has no effect.

| what | value |
| --- | --- |
| machines | those of the library's kind in the file of `polycnc serve` that `POLYCNC_SERVED` names, else one as `polycnc calls KIND` has it; doors, programs, rates and scenarios of the file are left aside |
| time | passes only when the program reads the same again in the same cycle, a cycle each time: a program that spins ends at once, one that sleeps sees no time pass, and the same calls give the same bits |
| a fork | the child has no machines: what it calls answers as where nobody is |
| the interpreter | does not end before the program; signals stay the program's |

It is for tests and debuggers. A crash of the program takes the machine with it, and the first call takes a second or two.

## The protocol

Little-endian. The library says hello: `PNCCALL1`, width of a pointer, packing (0: as the manual has each structure), two zeros, then its
name, its version and a hash of its table, 16 bytes each. The answer is `PNCCALL1` and a code of 4 bytes, 0 if all is well. A
call is its length (4 bytes, of what follows), number and serial number (2 each), then the arguments: a number as it is, what
is read behind a pointer as a size (4 bytes, 0xFFFFFFFF: null) and the bytes, what is written as the room for it. The answer is
its length, number, serial number, state (4 bytes, 1: refused), the result (8 bytes), the sizes of all outputs, and the
outputs. No frame has more than 66,560 bytes. A frame that is none of these ends the connection; nothing of it is carried out.

## A trace

`polycnc calls KIND --trace FILE` writes a line of JSON for each call: `time_s` of the machine, `client` (the first is 1), `call`,
what went `in`, the `room` for what is written (null: a null pointer), the `code`, what came `out`. Numbers and texts are as they are,
structures hexadecimal bytes. `polycnc calls KIND --replay FILE` carries the calls out on a new machine, at the same machine times, and
lists those that answer otherwise; status 1 if there are any.

## Values that TSRP has no place for

`rdaux`, `wraux`, `rdlp`, `wrlp`, `rdlpndx`, `wrlpndx`, `rddv`, `rdsdec` and `wrsdec` use values that the record of the manual has no
place for. With a record of the manual they do nothing. A program that wants them passes the first part of a `TSRPX`, which
`MCUG3_EXTEND(&record)` has marked in its scratch words: then `aux`, `lp`, `dv` and `sdec` of that are read and written.

## Interrupts of a board

`MCUG3_SetBoardIntRoutine` has a thread of the library wait on a connection of its own, and call the routine with 1 when the selected
board interrupts the PC, about 10 ms later at most. The routine begins when no call is being carried out; calls that come meanwhile
wait for its end, for a second at most, and what the routine itself calls does not wait. `MCUG3_ResetBoardIntRoutine` returns when the
routine does not run any more. The routine stays installed when the server is lost: it is called again after the next successful
`InitMcuSystem`, `InitMcuSystem2` or `InitMcuSystem3`. A program may end without removing it; a child of `fork` has none. With
`--in-process` both functions answer 1 and do nothing.

On the wire the library calls `MCUG3_SetBoardIntRoutine` with 0, which answers the number of the selected board, and on a second connection
with that number plus 1. Interrupts come there unasked: length 8, number 0, serial number 0, the bits of the lines (4 bytes).

## What a program needs

`polycnc clib KIND --missing PROGRAM` reads the import tables of an .exe or a DLL (32 and 64 bits, delayed imports too), or
the undefined symbols of a Linux program, and lists which functions of the maker's library ours does not have. It sees
nothing of what a program loads by name while it runs; the trace does. A Linux program does not say from which library it
takes a name: names that begin as all of the library do are meant, and `mcug3`, whose names begin with nothing in common, is
refused.

## What there is not

No booting of a served board: `BootFile` answers 202, as of a board that cannot be reached at its addresses. No kernel drivers, and
no memory windows of an HSSB. Functions that no manual of these systems has, those of later FOCAS libraries among them, are not
exported: the loader names them, and `--missing` lists them beforehand. Nor are `cnc_rdpmacro` and `cnc_rdpmacror`, which the manual
names in a list and declares nowhere.
"""


def page() -> str:
    """Return the text of the page."""
    targets = "".join(
        f"| `{name}` | `{row.made.format(name='NAME')}` | {', '.join(row.compilers)} |\n"
        for name, row in TARGETS.items()
    )
    parts = [_HEAD, targets, *(_library(library_of(kind)) for kind in LIBRARIES), _TAIL]
    return "".join(parts)


def _library(library: CLibrary) -> str:
    lines = [
        f"\n## {library.name}\n",
        f"`polycnc clib {library.kind}`: {len(library.functions)} functions"
        + (f" and {len(library.aliases)} other names of them" if library.aliases else "")
        + ". The code of a call is",
        "",
        "| when | code |",
        "| --- | --- |",
        f"| nobody is there when the library is opened | {library.nobody:d} |",
        f"| the connection is lost, or nobody is there at another call | {library.lost:d} |",
        f"| a pointer is null, or a call larger than a frame | {library.null:d} |",
        f"| library and server do not belong together | {library.version:d} |",
    ]
    lines += [
        f"| any of these, in `{name}` | {code:d} |"
        for name, code in sorted(library.failures.items())
        if name not in library.left_out
    ]
    lines += ["", "How many bytes lie behind a pointer, where it is not one structure or number:", ""]
    lines += ["| function | argument | bytes |", "| --- | --- | --- |", *_rows(library)]
    if library.left_out:
        lines += ["", "Exported, but without effect:", "", "| function | why |", "| --- | --- |"]
        lines += [f"| `{name}` | {reason} |" for name, reason in sorted(library.left_out.items())]
    return "\n".join(lines) + "\n"


def _rows(library: CLibrary) -> Iterator[str]:
    for call in library.calls:
        for slot in call.slots:
            if slot.way is not Way.VALUE and (bytes_ := _bytes(slot)):
                yield f"| `{call.function.name}` | `{slot.argument.name}` | {bytes_} |"


def _bytes(slot: Slot) -> str:
    said = slot.size if slot.reads else slot.room
    inner = said.partition("(")[2].removesuffix(")")
    if said.startswith("pc_least"):
        inner, _, most = inner.rpartition(", ")
        return f"`{inner}`, at most `{most}`"
    if inner == f"sizeof({slot.element.__name__})" or inner == str(slot.width):
        return ""
    if slot.way is Way.TEXT and slot.reads:
        return "a text with its zero" + (
            f", written: `{slot.room.removeprefix('pc_size')}`" if slot.writes else ""
        )
    plain = inner.replace("(int64_t)", "").replace("(int)", "")
    return f"`{plain.replace('(18)', '18').replace('(6)', '6')}`"
