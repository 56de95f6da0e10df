"""Where the values of a CPL program go: its variables in Python, stored as their types are, boxes for functions."""

from __future__ import annotations

from collections.abc import Callable

from polycnc.language import Emitter, Flaw, Python
from polycnc.nc.cpl._faults import INVALID_ASSIGNMENT
from polycnc.nc.cpl._functions import STEADY, TIMED, python_name
from polycnc.nc.cpl._operators import Typed
from polycnc.nc.cpl._reader import single
from polycnc.nc.cpl._syntax import Dim, Expression, Name
from polycnc.nc.cpl._values import Values, is_text
from polycnc.nc.cpl._variables import KIND_NAMES, Variable

_NUMBER = "+-0123456789"
_TIMED_WORK = 2000
"""What asking for something that changes with time counts, in assignments: a cycle knows one answer."""
_CONVERSIONS = {"I": "to_integer", "R": "to_real", "D": "to_double", "B": "to_boolean"}


class Stores:
    """Write assignments into `out`.

    `variables` are those used so far, each with the first place, `hosts` the functions of the control by their names in
    Python. Boxes are variables as arguments that a function may set. Where `hot` is not 0 what is written may run many
    times.
    """

    def __init__(self, out: Emitter[int]) -> None:
        self.variables: dict[Variable, int] = {}
        self.hosts: dict[str, tuple[str, int]] = {}
        self.values = Values(self.use, self.host, self._box, self.temporary)
        self.hot = 0
        self.changes = 0
        """How much has been written that changes something."""
        self._out = out
        self._pythons: dict[Variable, str] = {}
        self._boxes: list[tuple[str, Name]] = []
        self._count = 0

    def use(self, variable: Variable, at: int) -> str:
        python = self._pythons.get(variable)
        if python is None:
            self.variables[variable] = at
            self._pythons[variable] = python = variable.python
        return python

    def host(self, name: str, at: int, door: str = "function") -> str:
        python = f"{door}_{python_name(name)}"
        self.hosts.setdefault(python, (f"host.{door}({name!r})", at))
        timed = name in TIMED and door == "function"
        if timed and self.hot:
            self._out.put(f"n -= {_TIMED_WORK}")
        self.changes += not timed and (door == "setter" or name not in STEADY)
        return python

    def _box(self, name: Name) -> str:
        self._count += 1
        self._boxes.append((f"b{self._count}", name))
        return f"b{self._count}"

    def temporary(self) -> str:
        self._count += 1
        return f"t{self._count}"

    def new_boxes(self) -> list[tuple[str, Name]]:
        """Return where the variables are collected that functions set in what is turned into Python next."""
        self._boxes = []
        return self._boxes

    def open_boxes(self, boxes: list[tuple[str, Name]]) -> None:
        for python, name in boxes:
            place, index = self.values.element(name)
            now = f"{place}[{index}]" if index else place
            variable = name.variable
            self._out.put(f"{python} = handed({variable.name!r}, {variable.kind!r}, {now})")

    def close_boxes(self, boxes: list[tuple[str, Name]]) -> None:
        self.changes += len(boxes)
        for python, name in boxes:
            with self._out.block(f"if {python}.__class__ is Box and {python}.is_set:"):
                self.store(name, Typed(Python(f"{python}.value"), "X", leaf=True))

    def store(self, target: Name, typed: Typed, place: tuple[str, str] | None = None) -> None:
        """Assign a value to a variable that is no text; `place` is its element where that is known."""
        kind, given = target.variable.kind, typed.kind
        if kind == "S":
            python, index = place or self.values.element(target)
            whole = f"{python}[{index}]" if index else python
            self.guard(target, whole)
            self._out.put(f"{whole} = put({whole}, {typed.python.text})")
            return
        if given == "S" or ((given == "B") != (kind == "B") and given not in ("X", "N")):
            raise Flaw(
                target.at, INVALID_ASSIGNMENT.what, f"{target.variable.name} takes no {KIND_NAMES[given]}"
            )
        python, index = place or self.values.element(target)
        if index:
            key = self.temporary()
            self._out.put(f"{key} = {index}", f"{python}[{key}]")  # so that a wrong index is found first
            index = key
        whole = f"{python}[{index}]" if index else python
        self.guard(target, whole)
        if target.variable.scope == "permanent":
            if given == "N":
                raise Flaw(target.at, INVALID_ASSIGNMENT.what, "a permanent variable cannot be deleted")
            if typed.leaf:
                typed = typed._replace(python=Python(f"kept({typed.python.text})"))
        direct = target.variable.scope in ("local", "parameter") and not index
        self._put_value(whole, direct, kind, typed)

    def guard(self, target: Name, place: str) -> None:
        """Write that a field of the whole control or program, which another text may declare, is not replaced."""
        if target.variable.scope in ("permanent", "global") and not target.indices:
            self._out.put(f"if {place}.__class__ is Field: raise index_needed({target.variable.name!r})")

    def _put_value(self, place: str, direct: bool, kind: str, typed: Typed) -> None:
        put, text, given = self._out.put, typed.python.text, typed.kind
        constant = _constant(text)
        if given == "N":
            put(f"{place} = None")
        elif constant is not None and kind in ("R", "D") and given in ("I", "R", "D"):
            put(f"{place} = {single(constant) if kind == 'R' else float(constant)!r}")
        elif _fits(kind, typed, constant):
            put(f"{place} = {text}")
        elif typed.leaf or (kind == "I" and given != "I") or not self.hot:
            put(f"{place} = {_CONVERSIONS[kind]}({text})")
        else:
            self._put_checked(place, direct, kind, text)

    def _put_checked(self, place: str, direct: bool, kind: str, text: str) -> None:
        """Assign what was computed: bring it to its type and see that it is in range."""
        name = place if direct else self.temporary()
        if kind == "I":
            self._out.put(
                f"{name} = {text}", f"if not -2147483648 <= {name} <= 2147483647: raise OverflowError"
            )
        elif kind == "R":
            self._out.put(f"F[0] = {text}", f"{name} = F[0]", f"if {name} - {name}: raise OverflowError")
        else:
            self._out.put(f"{name} = ({text}) * 1.0", f"if {name} - {name}: raise OverflowError")
        if not direct:
            self._out.put(f"{place} = {name}")

    def dimension(self, statement: Dim) -> None:
        """Write DIM or PDIM."""
        variable, sizes = statement.variable, statement.sizes
        place = self.use(variable, statement.at)
        if statement.parameter:
            self._out.put(f"{place} = parameter_field(arguments, {variable.name!r}, {sizes[0]})")
        elif variable.kind == "S" and len(sizes) == 1:
            self._out.put(f"{place} = dimension({place}, {sizes[0]})")
        else:
            self._out.put(f"{place} = dimension_field({place}, {variable.kind!r}, {sizes!r})")

    def passed(self, tree: Expression) -> str:
        if is_text(tree):
            return self.values.text(tree)
        return self.values.rounded(self.values.value(tree)).text

    def tested(self, make: Callable[[], str]) -> str:
        """Write what a condition needs before it, and return it."""
        boxes = self.new_boxes()
        text = make()
        if not boxes:
            return text
        self.open_boxes(boxes)
        name = self.temporary()
        self._out.put(f"{name} = {text}")
        self.close_boxes(boxes)
        return name


def _fits(kind: str, typed: Typed, constant: float | None) -> bool:
    """Tell whether a value can be stored as it is, with nothing to convert and nothing to check."""
    given = typed.kind
    if kind == "B":
        return given == "B"
    if kind == "I" and given == "I" and constant is not None:
        return abs(constant) < 1 << 31
    return typed.leaf and (given == kind or (kind == "D" and given == "R"))


def _constant(text: str) -> float | None:
    if text[0] not in _NUMBER:  # most of what is stored begins with a name
        return None
    try:
        return float(text)
    except ValueError:
        return None
