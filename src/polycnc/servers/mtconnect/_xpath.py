"""Choose components and data items by a path: the part of XPath that clients of MTConnect write, in bounded time."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from polycnc.errors import PolycncError
from polycnc.servers.mtconnect._device import Component, DeviceModel, Item

MOST_CHARACTERS, MOST_STEPS, MOST_TERMS = 1024, 24, 24
_TOKEN = re.compile(
    r"\s*(?:(//|/|\||\[|\]|\(|\)|=|!=|\*|@|,|\.\.|\.)|\"([^\"]*)\"|'([^']*)'|([A-Za-z_][\w.-]*(?::[A-Za-z_][\w.-]*)?)|(\d{1,9}))"
)


class PathError(PolycncError):
    """A path that cannot be read, or that reaches nothing."""


@dataclass(slots=True, eq=False)
class Node:
    """An element of the description: its tag, attributes, and the elements in it; `item` of a data item."""

    tag: str
    attributes: dict[str, str]
    parts: list[Node]
    item: Item | None = None

    def below(self) -> Iterator[Node]:
        """Return all elements in it."""
        for part in self.parts:
            yield part
            yield from part.below()


def tree_of(devices: list[DeviceModel]) -> Node:
    """Return the description of devices as elements, above them all one without a name."""
    made = [_of_component(device.root, device) for device in devices]
    return Node("", {}, [Node("MTConnectDevices", {}, [Node("Devices", {}, made)])])


def _of_component(component: Component, device: DeviceModel | None = None) -> Node:
    attributes = {"id": component.id, "name": component.name}
    if device is not None:
        attributes["uuid"] = device.uuid
    parts = []
    if component.items:
        parts.append(Node("DataItems", {}, list(map(_of_item, component.items))))
    if component.parts:
        parts.append(Node("Components", {}, list(map(_of_component, component.parts))))
    return Node(component.tag, attributes, parts)


def _of_item(item: Item) -> Node:
    return Node("DataItem", attributes_of(item), [], item)


def attributes_of(item: Item) -> dict[str, str]:
    """Return the attributes of a data item as a description has them."""
    found = {
        "category": item.category, "id": item.id, "name": item.name, "type": item.type, "subType": item.subtype,
        "units": item.units, "nativeUnits": item.units, "coordinateSystem": item.system,
        "representation": item.representation, "discrete": "true" if item.discrete else "",
    }  # fmt: skip
    return {name: value for name, value in found.items() if value}


def choose(path: str, tree: Node) -> frozenset[Item]:
    """Return the data items of the elements that a path reaches, and of all that is in them.

    Raises:
        PathError: It cannot be read, is too long, or reaches nothing.
    """
    if len(path) > MOST_CHARACTERS:
        raise PathError(f"the path is longer than {MOST_CHARACTERS} characters", hint="Write a shorter one.")
    reader = _Reader(_tokens(path))
    chosen: set[Item] = set()
    reached = False
    for steps in reader.union():
        for node in _walk(steps, tree):
            reached = True
            if node.item is not None:
                chosen.add(node.item)
            chosen.update(each.item for each in node.below() if each.item is not None)
    if not reached:
        raise PathError(f"the path reaches nothing: {path[:80]}", hint="Compare it with /probe.")
    return frozenset(chosen)


_Test = Callable[[Node], bool]


@dataclass(frozen=True, slots=True)
class _Step:
    deep: bool
    tag: str
    tests: tuple[_Test, ...]

    def of(self, nodes: list[Node]) -> list[Node]:
        """Return what this step reaches from these elements, each once."""
        found: dict[int, Node] = {}
        seen: set[int] = set()
        for node in nodes:
            candidates = self._deep(node, seen) if self.deep else iter(node.parts)
            for each in candidates:
                if self.tag in ("*", each.tag) and all(test(each) for test in self.tests):
                    found[id(each)] = each
        return list(found.values())

    def _deep(self, node: Node, seen: set[int]) -> Iterator[Node]:
        """Return all elements in one, without those that were looked at already."""
        if id(node) in seen:
            return
        seen.add(id(node))
        for part in node.parts:
            yield part
            yield from self._deep(part, seen)


def _walk(steps: list[_Step], tree: Node) -> list[Node]:
    nodes = [tree]
    for step in steps:
        nodes = step.of(nodes)
    return nodes


def _tokens(path: str) -> list[tuple[str, str]]:
    found, at = [], 0
    end = len(path.rstrip())
    while at < end:
        match = _TOKEN.match(path, at)
        if match is None:
            raise PathError(f"the path cannot be read at character {at + 1}: {path[at : at + 20]}")
        sign, double, single, name, digits = match.groups()
        if sign is not None:
            found.append((sign, sign))
        elif name is not None:
            found.append(("name", name.rpartition(":")[2]))
        elif digits is not None:
            found.append(("number", digits))
        else:
            found.append(("text", double if double is not None else single))
        at = match.end()
    return found


class _Reader:
    """Read a path: steps with conditions on attributes, joined by `and`, `or`, `not()`, and unions."""

    def __init__(self, tokens: list[tuple[str, str]]) -> None:
        self._tokens = [*tokens, ("end", "")]
        self._at = 0
        self._steps = self._terms = 0

    def union(self) -> list[list[_Step]]:
        """Return the paths of a union."""
        made = [self._path()]
        while self._take("|"):
            made.append(self._path())
        self._need("end")
        return made

    def _path(self) -> list[_Step]:
        if self._kind not in ("/", "//"):
            raise self._error("a path begins with / or //")
        steps = []
        while self._kind in ("/", "//"):
            deep = self._next()[0] == "//"
            tag = "*" if self._take("*") else self._need("name")
            self._steps += 1
            if self._steps > MOST_STEPS:
                raise PathError(f"the path has more than {MOST_STEPS} steps", hint="Write fewer.")
            tests = []
            while self._take("["):
                tests.append(self._either())
                self._need("]")
            steps.append(_Step(deep, tag, tuple(tests)))
        return steps

    def _either(self) -> _Test:
        tests = [self._both()]
        while self._word("or"):
            tests.append(self._both())
        return tests[0] if len(tests) == 1 else lambda node: any(test(node) for test in tests)

    def _both(self) -> _Test:
        tests = [self._term()]
        while self._word("and"):
            tests.append(self._term())
        return tests[0] if len(tests) == 1 else lambda node: all(test(node) for test in tests)

    def _term(self) -> _Test:
        self._terms += 1
        if self._terms > MOST_TERMS:
            raise PathError(f"the path has more than {MOST_TERMS} conditions", hint="Write fewer.")
        if self._take("("):
            inner = self._either()
            self._need(")")
            return inner
        if self._kind == "name":
            return self._function()
        self._need("@")
        name = self._need("name")
        if self._take("="):
            value = self._need("text")
            return lambda node: node.attributes.get(name) == value
        if self._take("!="):
            value = self._need("text")
            return lambda node: name in node.attributes and node.attributes[name] != value
        return lambda node: name in node.attributes

    def _function(self) -> _Test:
        function = self._need("name")
        self._need("(")
        if function == "not":
            inner = self._either()
            self._need(")")
            return lambda node: not inner(node)
        if function not in ("contains", "starts-with"):
            raise PathError(f"the path uses {function}()", hint="Use not(), contains() or starts-with().")
        self._need("@")
        name = self._need("name")
        self._need(",")
        value = self._need("text")
        self._need(")")
        if function == "contains":
            return lambda node: value in node.attributes.get(name, "")
        return lambda node: node.attributes.get(name, "").startswith(value)

    # ------------------------------------------------------------------ tokens

    @property
    def _kind(self) -> str:
        return self._tokens[self._at][0]

    def _next(self) -> tuple[str, str]:
        token = self._tokens[self._at]
        self._at += 1
        return token

    def _take(self, kind: str) -> bool:
        if self._kind != kind:
            return False
        self._at += 1
        return True

    def _word(self, word: str) -> bool:
        if self._tokens[self._at] != ("name", word):
            return False
        self._at += 1
        return True

    def _need(self, kind: str) -> str:
        if self._kind != kind:
            raise self._error(f"{kind} is missing")
        return self._next()[1]

    def _error(self, what: str) -> PathError:
        found = self._tokens[self._at][1] or "its end"
        return PathError(f"the path cannot be read: {what} before {found[:20]}", hint="See the manual page.")
