"""Declarations of a library for other languages: a unit of Pascal, a class of C#, a module of Visual Basic.

One table says what each type of C is called there. What a language has no form for is as many bytes as it takes: unions
in C# and Visual Basic, and elements that Visual Basic would lay out elsewhere.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from polycnc.controllers.library._c_types import Opaque
from polycnc.controllers.library._functions import Argument, Direction, Function
from polycnc.controllers.library.clib._slots import CLibrary, Way, slot_of

_RESULTS = {"short": ctypes.c_int16, "double": ctypes.c_double}
_WRITTEN = "Written by polycnc clib"


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


@dataclass(frozen=True, slots=True)
class _Language:
    """How a language calls the types of C, and which words of it are no names."""

    types: Mapping[Any, str]
    words: frozenset[str]
    mark: str = "{}_"
    """How a name is written that is a word of the language, or that of a type or function."""
    cases: bool = False
    """Whether upper and lower case differ."""

    def of(self, ctype: Any) -> str:
        """Return the name of a number or structure."""
        return self.types.get(ctype) or self.names([ctype.__name__], frozenset())[0]

    def names(self, given: list[str], taken: frozenset[str]) -> list[str]:
        """Return names as they may be written where others are taken."""
        return [
            self.mark.format(name)
            if (key := name if self.cases else name.lower()) in self.words or key in taken
            else name
            for name in given
        ]


_PASCAL = _Language(
    {
        ctypes.c_char: "AnsiChar", ctypes.c_int8: "ShortInt", ctypes.c_uint8: "Byte", ctypes.c_int16: "SmallInt",
        ctypes.c_uint16: "Word", ctypes.c_int32: "LongInt", ctypes.c_uint32: "LongWord", ctypes.c_int64: "Int64",
        ctypes.c_double: "Double",
    },
    _words("""
        and array as asm begin case class const div do else end except exit false file finally for function goto if
        in inline interface is label mod nil not object of on or out packed procedure program property raise record
        repeat set shl shr string then to true type unit until uses var while with word xor
    """),
)  # fmt: skip
_CSHARP = _Language(
    {
        ctypes.c_char: "byte", ctypes.c_int8: "sbyte", ctypes.c_uint8: "byte", ctypes.c_int16: "short",
        ctypes.c_uint16: "ushort", ctypes.c_int32: "int", ctypes.c_uint32: "uint", ctypes.c_int64: "long",
        ctypes.c_double: "double",
    },
    _words("""
        as base bool break byte case char checked class const decimal default delegate do double else event false
        fixed float for foreach goto if in int is lock long new null object out params private public ref return
        short sizeof static string struct switch this true try typeof uint ulong ushort using void while
    """),
    mark="@{}",
    cases=True,
)  # fmt: skip
_BASIC = _Language(
    {
        ctypes.c_char: "Byte", ctypes.c_int8: "Byte", ctypes.c_uint8: "Byte", ctypes.c_int16: "Integer",
        ctypes.c_uint16: "Integer", ctypes.c_int32: "Long", ctypes.c_uint32: "Long", ctypes.c_double: "Double",
    },
    _words("""
        and any as boolean byref byte byval call case close const currency date declare dim do double each else end
        enum erase exit false for function get global gosub goto if imp in input integer is let lib like line lock
        long loop lset me mod name new next not nothing null on open option optional or print private property
        public put rem resume return rset seek select set single static step stop string sub tab then time to true
        type until variant wend while with write xor
    """),
)  # fmt: skip


def _taken(library: CLibrary, language: _Language) -> frozenset[str]:
    """Return the names of types and functions, which arguments must not have."""
    names = [*library.classes, *library.functions, *library.aliases]
    return frozenset(names if language.cases else map(str.lower, names))


def _constants(library: CLibrary, language: _Language) -> Iterator[tuple[str, int]]:
    names = language.names(list(library.constants), _taken(library, language))
    seen = set[str]()
    for name, value in zip(names, library.constants.values(), strict=True):
        key = name if language.cases else name.lower()
        if key not in seen:  # two that differ in nothing else than case
            seen.add(key)
            yield name, value


def _functions(library: CLibrary, language: _Language) -> Iterator[tuple[str, Function]]:
    seen = set() if language.cases else {each.lower() for each in library.functions}
    others = {a: library.functions[b] for a, b in library.aliases.items() if a.lower() not in seen}
    yield from sorted({**library.functions, **others}.items())


def _result(function: Function) -> Any:
    return None if function.result == "void" else _RESULTS.get(function.result, ctypes.c_int32)


def _is_union(cls: Any) -> bool:
    return issubclass(cls, ctypes.Union)


# ---------------------------------------------------------------------- Pascal


def write_pascal(library: CLibrary) -> str:
    """Return a unit for Delphi and Free Pascal."""
    language, taken = _PASCAL, _taken(library, _PASCAL)
    name = library.name
    convention = "{$IFDEF MSWINDOWS}stdcall{$ELSE}cdecl{$ENDIF}" if library.stdcall else "cdecl"
    lines = [
        f"{{ {name}: constants, records and functions. {_WRITTEN} {library.kind}. }}",
        f"unit {name};", "", "{$IFDEF FPC}{$MODE DELPHI}{$ENDIF}", "", "interface", "", "const",
        *(f"  {each} = {value};" for each, value in _constants(library, language)),
        "", "type",
    ]  # fmt: skip
    if "IMC_HANDLE" in library.declarations:
        lines.append("  IMC_HANDLE = Pointer;")
    for cls in library.classes.values():
        pack = cls._table_.pack or 8
        lines.append(f"  {{$IFDEF FPC}}{{$PACKRECORDS {pack}}}{{$ELSE}}{{$A{pack}}}{{$ENDIF}}")
        lines.append(f"  {language.of(cls)} = record")
        elements = list(cls._table_.elements.items())
        if _is_union(cls):
            lines.append("    case Integer of")
        for number, (member, element) in enumerate(elements):
            (member,) = language.names([member], frozenset())
            kind = "Pointer" if element.held else language.of(element.ctype)
            for count in reversed(element.counts):
                kind = f"array[0..{count - 1}] of {kind}"
            lines.append(
                f"      {number}: ({member}: {kind});" if _is_union(cls) else f"    {member}: {kind};"
            )
        lines += ["  end;", ""]
    for each, function in _functions(library, language):
        names = language.names([argument.name for argument in function.arguments], taken)
        given = "; ".join(
            _pascal_argument(library, name, argument)
            for name, argument in zip(names, function.arguments, strict=True)
        )
        result = _result(function)
        head = (
            f"procedure {each}({given})"
            if result is None
            else f"function {each}({given}): {language.of(result)}"
        )
        lines.append(
            f"{head}; {convention}; external {{$IFDEF MSWINDOWS}}'{name}.dll'{{$ELSE}}'{name}'{{$ENDIF}} name '{each}';"
        )
    return "\n".join((*lines, "", "implementation", "", "end.", ""))


def _pascal_argument(library: CLibrary, name: str, argument: Argument) -> str:
    way, element = slot_of(library, argument)
    if isinstance(argument.type, Opaque):
        return f"{'' if way is Way.VALUE else 'var '}{name}: IMC_HANDLE"
    if getattr(argument.type, "of", None) is callable:
        return f"{name}: Pointer"
    if way is Way.VALUE:
        return f"{name}: {_PASCAL.of(element)}"
    if way is Way.TEXT:
        return f"{name}: PAnsiChar"
    if way is Way.MEMORY:
        return f"{name}: Pointer"
    return f"var {name}: {_PASCAL.of(element)}"


# ---------------------------------------------------------------------- C#


def write_csharp(library: CLibrary) -> str:
    """Return a class of functions imported from the library, with its constants and structures."""
    language, name = _CSHARP, library.name
    lines = [
        f"// {name}: constants, structures and functions. {_WRITTEN} {library.kind}.",
        "using System;", "using System.Runtime.InteropServices;", "using System.Text;", "",
        f"public static class {name.capitalize()}", "{",
        *(f"    public const int {each} = {value};" for each, value in _constants(library, language)), "",
    ]  # fmt: skip
    for cls in library.classes.values():
        lines += [*_csharp_structure(cls), ""]
    for each, function in _functions(library, language):
        names = language.names([argument.name for argument in function.arguments], frozenset())
        given = ", ".join(
            _csharp_argument(library, argument_name, argument)
            for argument_name, argument in zip(names, function.arguments, strict=True)
        )
        result = _result(function)
        kind = "void" if result is None else language.of(result)
        convention = "Winapi" if library.stdcall else "Cdecl"
        lines.append(
            f'    [DllImport("{name}", CallingConvention = CallingConvention.{convention}, CharSet = CharSet.Ansi)]'
        )
        lines.append(f"    public static extern {kind} {each}({given});")
    return "\n".join((*lines, "}", ""))


def _csharp_structure(cls: Any) -> Iterator[str]:
    """Return a structure whose elements lie as in C once it is passed; arrays have to be made before they are read."""
    yield f"    [StructLayout(LayoutKind.Sequential, Pack = {cls._table_.pack or 8})]"
    yield f"    public struct {_CSHARP.of(cls)}"
    yield "    {"
    if _is_union(cls):
        yield f"        // one of: {', '.join(cls._table_.elements)}"
        yield f"        {_array(ctypes.sizeof(cls))}public byte[] bytes;"
    for member, element in () if _is_union(cls) else cls._table_.elements.items():
        (written,) = _CSHARP.names([member], frozenset())
        kind = "IntPtr" if element.held else _CSHARP.of(element.ctype)
        if element.counts:
            yield f"        {_array(math.prod(element.counts))}public {kind}[] {written};"
        else:
            yield f"        public {kind} {written};"
    yield "    }"


def _array(count: int) -> str:
    return f"[MarshalAs(UnmanagedType.ByValArray, SizeConst = {count})] "


def _csharp_argument(library: CLibrary, name: str, argument: Argument) -> str:
    way, element = slot_of(library, argument)
    counted = bool(argument.many)
    if isinstance(argument.type, Opaque):
        return f"{'' if way is Way.VALUE else 'out '}IntPtr {name}"
    if getattr(argument.type, "of", None) is callable:
        return f"IntPtr {name}"  # of a delegate, which has to outlive the call
    if way is Way.VALUE:
        return f"{_CSHARP.of(element)} {name}"
    if way is Way.TEXT:
        return f"{'string' if argument.direction is Direction.IN else 'StringBuilder'} {name}"
    if way is Way.MEMORY:
        return f"[In, Out] byte[] {name}"
    if counted or way is Way.RECORDS:
        return f"[In, Out] {_CSHARP.of(element)}[] {name}"
    return f"ref {_CSHARP.of(element)} {name}"


# ---------------------------------------------------------------------- Visual Basic

_BASIC_PACK = 4


def write_basic(library: CLibrary) -> str:
    """Return a module for Visual Basic 6 and VBA of 32 bits."""
    language, taken, name = _BASIC, _taken(library, _BASIC), library.name
    lines = [
        f'Attribute VB_Name = "{name}"',
        f"' {name}: constants, types and functions. {_WRITTEN} {library.kind}.", "Option Explicit", "",
        *(f"Public Const {each} As Long = {value}" for each, value in _constants(library, language)), "",
    ]  # fmt: skip
    for cls in library.classes.values():
        lines += [*_basic_type(cls), ""]
    for each, function in _functions(library, language):
        names = language.names([argument.name for argument in function.arguments], taken)
        given = ", ".join(
            _basic_argument(library, argument_name, argument)
            for argument_name, argument in zip(names, function.arguments, strict=True)
        )
        result = _result(function)
        head, tail = ("Sub", "") if result is None else ("Function", f" As {language.of(result)}")
        lines.append(f'Public Declare {head} {each} Lib "{name}.dll" ({given}){tail}')
    return "\r\n".join((*lines, ""))


def _basic_type(cls: Any) -> Iterator[str]:
    yield f"Public Type {_BASIC.of(cls)}"
    if _is_union(cls):
        yield f"    ' one of: {', '.join(cls._table_.elements)}"
        yield f"    bytes(0 To {ctypes.sizeof(cls) - 1}) As Byte"
    at = 0
    for member, element in () if _is_union(cls) else cls._table_.elements.items():
        (written,) = _BASIC.names([member], frozenset())
        place = getattr(cls, member)
        unit = 4 if element.held else ctypes.sizeof(element.ctype)
        align = min(_BASIC_PACK, unit) if element.held or hasattr(element.ctype, "_type_") else 1
        count = math.prod(element.counts)
        fits = place.offset == -(-at // align) * align and (element.held or element.ctype in _BASIC.types)
        at = place.offset + (4 if element.held else place.size)
        if element.ctype is ctypes.c_char and element.counts:
            yield f"    {written} As String * {count}"
        elif element.held:
            yield f"    {written} As Long ' an address"
        elif hasattr(element.ctype, "_fields_"):
            yield f"    {written}{f'(0 To {count - 1})' if element.counts else ''} As {_BASIC.of(element.ctype)}"
        elif fits:
            bounds = f"(0 To {count - 1})" if element.counts else ""
            yield f"    {written}{bounds} As {_BASIC.of(element.ctype)}"
        else:
            yield f"    {written}(0 To {place.size - 1}) As Byte"
    yield "End Type"


def _basic_argument(library: CLibrary, name: str, argument: Argument) -> str:
    way, element = slot_of(library, argument)
    if isinstance(argument.type, Opaque):
        return f"{'ByVal' if way is Way.VALUE else 'ByRef'} {name} As Long"
    if getattr(argument.type, "of", None) is callable:
        return f"ByVal {name} As Long"  # AddressOf
    if way is Way.VALUE:
        return f"ByVal {name} As {_BASIC.of(element)}"
    if way is Way.TEXT:
        return f"ByVal {name} As String"
    if way is Way.MEMORY:
        return f"ByRef {name} As Any"
    return f"ByRef {name} As {_BASIC.of(element)}"
