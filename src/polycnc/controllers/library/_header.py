"""C header text, read into structures: the one place where a vendor's records are declared.

Read is as much of C as the manuals print::

    #define MAX_AXIS 6
    #pragma pack(2)
    typedef short IMC16;
    /* One value per axis. */
    typedef struct { short dummy, type; long data[MAX_AXIS]; } ODBAXIS;
    typedef struct { short size; void *buffer __counted_by(size); } BLOCK;

A comment is the docstring of what follows it. `long` has 32 bits; a `char` is a number, `octet` one that counts from 0,
`text` one or more characters. `__counted_by` says how many elements of an array count, or how many bytes a pointer
leads to. `NAME_beside` declares what is held beside the memory of `NAME`.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.resources import files
from typing import Any

from polycnc.controllers.library._structures import Element, Layout, Table, lay_out, layouts

_STATEMENT = re.compile(
    r"""/\*\s*(?P<comment>.*?)\s*\*/
    | \#define\ +(?P<constant>\w+)\ +(?P<value>\d+)
    | \#pragma\ pack\((?P<pack>\d*)\)
    | typedef\ (?P<kind>struct|union)\ \{(?P<body>[^}]*)\}\ (?P<name>\w+);
    | typedef\ (?P<old>[\w ]+)\ (?P<new>\w+);
    | \s+ | (?P<wrong>.+)""",
    re.VERBOSE | re.DOTALL,
)
_ELEMENTS = re.compile(r"\s*((?:unsigned )?\w+) (.*)", re.DOTALL)
_ITEM = re.compile(r"\s*(\*?)(\w+)((?:\[\w+\])*)(?: __counted_by\((.*)\))?\s*", re.DOTALL)
_NUMBERS: dict[str, tuple[str, Any]] = {
    "char": ("char", ctypes.c_int8), "octet": ("char", ctypes.c_uint8), "text": ("char", ctypes.c_char),
    "unsigned char": ("unsigned char", ctypes.c_uint8), "short": ("short", ctypes.c_int16),
    "unsigned short": ("unsigned short", ctypes.c_uint16), "long": ("long", ctypes.c_int32),
    "unsigned long": ("unsigned long", ctypes.c_uint32), "__int64": ("__int64", ctypes.c_int64),
    "double": ("double", ctypes.c_double),
}  # fmt: skip
_BESIDE = "_beside"


@dataclass(frozen=True, slots=True)
class _Item:
    name: str
    type: str
    sizes: tuple[str, ...]
    pointer: bool
    counted_by: str


@dataclass(frozen=True, slots=True)
class _Declaration:
    document: str
    union: bool
    pack: int
    items: tuple[_Item, ...]


@dataclass
class Header:
    """Structures and constants of C text; with `checked` a number that does not fit is refused, not cut.

    `module` is where programs find the classes, `characters` what a text is in Python: `bytes` or `str`.

    Raises:
        ValueError: Something is not understood.
    """

    text: str
    module: str
    characters: type = bytes
    checked: bool = False
    constants: dict[str, int] = field(default_factory=dict)
    classes: dict[str, Any] = field(default_factory=dict)
    typedefs: dict[str, str] = field(default_factory=dict)
    _declared: dict[str, _Declaration] = field(default_factory=dict)
    _numbers: dict[str, tuple[str, Any]] = field(default_factory=lambda: dict(_NUMBERS))
    _varied: dict[tuple[Any, ...], Any] = field(default_factory=dict)

    @classmethod
    def beside(cls, module: str, name: str = "structures.h", **how: Any) -> Header:
        """Return the header that lies in the package of a module."""
        return cls(files(module.rpartition(".")[0]).joinpath(name).read_text("utf-8"), module, **how)

    def __post_init__(self) -> None:
        pack, document = 0, ""
        for each in _STATEMENT.finditer(self.text):
            if each["comment"]:
                document = each["comment"]
            elif each["constant"]:
                self.constants[each["constant"]] = int(each["value"])
            elif each["pack"] is not None:
                pack = int(each["pack"] or 0)
            elif each["new"]:
                if each["new"] not in _NUMBERS:
                    self.typedefs[each["new"]] = each["old"]
                self._numbers.setdefault(each["new"], (each["new"], self._numbers[each["old"]][1]))
            elif each["name"]:
                items = tuple(_items(each["body"]))
                self._declared[each["name"]] = _Declaration(document, each["kind"] == "union", pack, items)
                document = ""
            elif each["wrong"]:
                raise ValueError(f"{self.module}: not understood: {each['wrong'][:60]}")
        for name in self._declared:
            if not name.endswith(_BESIDE):
                self.classes[name] = self._made(name, None, {})

    @property
    def names(self) -> dict[str, Any]:
        """Return all classes and constants by name."""
        return {**self.constants, **self.classes}

    @property
    def layouts(self) -> dict[str, Layout]:
        """Return what lies where, by the structure's name."""
        return layouts(*self.classes.values())

    def make(self, name: str, *, pack: int | None = None, **constants: int) -> Any:
        """Return a structure with other values of constants, or packed otherwise; it is a kind of that name."""
        key = name, pack, *sorted(constants.items())
        if key not in self._varied:
            self._varied[key] = self._made(name, pack, constants)
        return self._varied[key]

    def packed(self, pack: int) -> dict[str, Any]:
        """Return all structures packed otherwise, by name."""
        return {name: self.make(name, pack=pack) for name in self.classes}

    def _made(self, name: str, pack: int | None, constants: dict[str, int]) -> Any:
        declared = self._declared[name]
        elements = {each.name: self._element(each, pack, constants) for each in declared.items}
        held = self._declared.get(name + _BESIDE)
        beside = {each.name: _python_of(self._numbers[each.type][1]) for each in held.items} if held else {}
        table = Table(elements, beside, declared.pack if pack is None else pack, self.checked)
        more = {"variant_of": self.classes[name]} if name in self.classes else {}
        document = declared.document or None
        return lay_out(name, declared.union, table, __module__=self.module, __doc__=document, **more)

    def _element(self, item: _Item, pack: int | None, constants: dict[str, int]) -> Element:
        counts = tuple(int({**self.constants, **constants}.get(each, each)) for each in item.sizes)
        if item.pointer:
            return Element(f"{item.type} *", ctypes.c_uint32, bytearray, (), True, item.counted_by)
        if item.type in self._numbers:
            c, ctype = self._numbers[item.type]
            python = _python_of(ctype)
            if item.type == "text":
                python = self.characters if len(counts) == 1 else object
            return Element(c, ctype, python, counts, False, item.counted_by)
        if item.type not in self._declared:
            raise ValueError(f"{self.module}: there is no type {item.type}")
        varied = constants or pack is not None
        inner = self.make(item.type, pack=pack, **constants) if varied else self.classes[item.type]
        return Element(item.type, inner, inner, counts, False, item.counted_by)


def _python_of(ctype: Any) -> type:
    return float if ctype is ctypes.c_double else int


def _items(body: str) -> Iterator[_Item]:
    *parts, rest = body.split(";")
    if rest.strip():
        raise ValueError(f"not understood: {rest.strip()}")
    for part in parts:
        kind, items = _groups(_ELEMENTS, part)
        for each in items.split(","):
            pointer, name, sizes, counted_by = _groups(_ITEM, each)
            yield _Item(name, kind, tuple(re.findall(r"\w+", sizes)), bool(pointer), counted_by or "")


def _groups(pattern: re.Pattern[str], text: str) -> tuple[Any, ...]:
    found = pattern.fullmatch(text)
    if found is None:
        raise ValueError(f"not understood: {text.strip()}")
    return found.groups()


__all__ = ["Header"]
