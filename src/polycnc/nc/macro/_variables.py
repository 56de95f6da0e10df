"""The variables of custom macros: local, common and permanent, each with a number, each a float or vacant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, Literal, NamedTuple, TypeAlias

from polycnc.language import Fault
from polycnc.machine import Store

Value: TypeAlias = float | None
"""What a variable holds: None is vacant (`<null>` on the control's screen)."""
MacroType: TypeAlias = Literal["a", "b", "c"]
Kind: TypeAlias = Literal["null", "local", "common", "permanent"]

LOCALS = 33
NO_VALUE = "a variable without a value counts as 0, and #1 to #33 have theirs from the call (G65)"
LEVELS = 4
"""How deep macros may be nested below the main program, each level with its own local variables."""
LARGEST = 2.0**159
"""Variables hold numbers below this: 31 bits with an exponent of up to 128, about 7.3e47."""

_RANGES: Final[Mapping[str, tuple[tuple[int, int], ...]]] = {
    "a": ((100, 149), (500, 531)),
    "b": ((100, 199), (500, 999)),
    "c": ((100, 199), (500, 699)),
}
_FIRST_PERMANENT = 500
_SIZE = 1000
_AREA = "nc.macro_variables"


class MacroError(Fault):
    """A statement that cannot be executed: what is wrong, what to do, and the control's alarm number."""


class SavedVariables(NamedTuple):
    """Hold variables to go back to: those of each level, the common ones, and `lasting` those from #500 on, or None."""

    levels: tuple[tuple[Value, ...], ...]
    common: tuple[Value, ...]
    lasting: tuple[Value, ...] | None
    names: dict[int, str]


class MacroVariables:
    """Hold the variables of one control; `common` is the macro type that the control has.

    Type "a" has #100 to #149 and #500 to #531, "b" #100 to #199 and #500 to #999, "c" #100 to #199 and #500 to
    #699. Those from #500 on outlast switching off in `store`, if there is one: what `set` and `set_all` write is
    there when they return. Programs write the lists directly; `save` keeps what they have written.
    """

    def __init__(self, common: MacroType = "b", *, store: Store | None = None) -> None:
        self.ranges = _RANGES[common]
        self.revision = 0
        self.common: list[Value] = [None] * _SIZE
        self._levels: list[list[Value]] = [_vacant()]
        self._store = store
        self._area = None if store is None else store.area(_AREA, float)
        if self._area is not None:
            for number, value in self._area.load().items():
                if isinstance(number, int) and self.kind(number) == "permanent":
                    self.common[number] = value
        self._kept = self.common[_FIRST_PERMANENT:]
        self.names: dict[int, str] = {}
        """Names of variables, by number (SETVN)."""

    @property
    def level(self) -> int:
        """How deep macros are nested now: 0 is the main program."""
        return len(self._levels) - 1

    @property
    def local(self) -> list[Value]:
        """The local variables of the macro that runs; the index is the number."""
        return self._levels[-1]

    def locals_of(self, level: int) -> list[Value]:
        """Return the local variables of a level; the index is the number."""
        return self._levels[level]

    def enter(self, values: Mapping[int, Value]) -> None:
        """Begin a macro with these local variables."""
        level = _vacant()
        for number, value in values.items():
            level[number] = value
        self._levels.append(level)

    def leave(self) -> None:
        """End the macro that was entered last: its local variables are gone."""
        if len(self._levels) > 1:
            self._levels.pop()

    def kind(self, number: int) -> Kind | None:
        """Return what sort of variable a number is, None if this control has none (or it is a system variable)."""
        if 0 <= number <= LOCALS:
            return "local" if number else "null"
        for first, last in self.ranges:
            if first <= number <= last:
                return "permanent" if number >= _FIRST_PERMANENT else "common"
        return None

    def get(self, number: int) -> Value:
        """Return a variable.

        Raises:
            MacroError: There is none of this number.
        """
        if 1 <= number <= LOCALS:
            return self._levels[-1][number]
        if number and self.kind(number) is None:
            raise no_variable(number)
        return self.common[number]

    def set(self, number: int, value: Value) -> None:
        """Give a variable a value, None to make it vacant.

        Raises:
            MacroError: There is none of this number, it is #0, or the value is beyond the control's range.
        """
        self.set_all({number: value})

    def set_all(self, values: Mapping[int, Value]) -> None:
        """Give variables values, all or none; see `set`.

        Raises:
            MacroError: As `set`; nothing has changed.
        """
        new: dict[int, Value] = {}
        for number, value in values.items():
            kind = self.kind(number)
            if kind is None:
                raise no_variable(number)
            if kind == "null":
                raise MacroError(
                    "#0 is always vacant and cannot be written", "Write another variable.", "PS0116"
                )
            new[number] = None if value is None else checked(float(value))
        self._keep({number: value for number, value in new.items() if number >= _FIRST_PERMANENT})
        for number, value in new.items():
            (self.local if number <= LOCALS else self.common)[number] = value
        self.revision += 1

    def save(self) -> None:
        """Keep durably what programs have written to the variables from #500 on."""
        now = self.common[_FIRST_PERMANENT:]
        if self._area is None or now == self._kept:
            return
        pairs = enumerate(zip(now, self._kept, strict=True), _FIRST_PERMANENT)
        self._keep({number: new for number, (new, old) in pairs if new != old})

    def _keep(self, values: Mapping[int, Value]) -> None:
        if self._area is None or self._store is None or not values:
            return
        with self._store.transaction():
            for number, value in values.items():
                if value is not None:
                    self._area[number] = value
                else:
                    self._area.pop(number, None)
        for number, value in values.items():
            self._kept[number - _FIRST_PERMANENT] = value

    def named(self, name: str) -> float:
        """Return the number of the variable that has a name, in capitals.

        Raises:
            MacroError: None has it.
        """
        for number, each in self.names.items():
            if each.upper() == name:
                return float(number)
        raise MacroError(f"no variable is named {name}", f"Name it first: SETVN 500[{name}].", "PS0115")

    def set_names(self, first: int, names: Sequence[str]) -> None:
        """Name variables from a number on.

        Raises:
            MacroError: A number is not of a variable from #500 on; none is named.
        """
        for number in (first, first + len(names) - 1):
            if self.kind(number) != "permanent":
                raise no_variable(number)
        self.names.update(enumerate(names, first))

    def clear_common(self) -> None:
        """Make #100 to #199 vacant, as switching the control on does."""
        self.common[:_FIRST_PERMANENT] = [None] * _FIRST_PERMANENT

    def clear_locals(self) -> None:
        """Leave all macros and make the local variables of the main program vacant, as a reset does."""
        self._levels[:] = [_vacant()]

    def leave_all(self) -> None:
        """Leave all macros; the local variables of the main program stay."""
        del self._levels[1:]

    def level_of(self, values: list[Value]) -> int | None:
        """Return the level of local variables, None if they are of none any more."""
        return next((n for n, each in enumerate(self._levels) if each is values), None)

    def saved(self, *, lasting: bool) -> SavedVariables:
        """Return all variables, to go back to; those that a store keeps only with `lasting`."""
        keeps = lasting or self._store is None
        return SavedVariables(
            tuple(map(tuple, self._levels)),
            tuple(self.common[:_FIRST_PERMANENT]),
            tuple(self.common[_FIRST_PERMANENT:]) if keeps else None,
            dict(self.names),
        )

    @staticmethod
    def fits(saved: SavedVariables) -> bool:
        """Tell whether there are as many variables as these."""
        sizes = {len(each) for each in saved.levels}
        lasting = saved.lasting is None or len(saved.lasting) == _SIZE - _FIRST_PERMANENT
        return (
            sizes == {LOCALS + 1}
            and len(saved.levels) <= LEVELS + 1
            and len(saved.common) == _FIRST_PERMANENT
            and lasting
        )

    def restore_state(self, saved: SavedVariables) -> None:
        """Go back to variables; a store keeps those from #500 on."""
        self._levels[:] = [list(each) for each in saved.levels]
        self.common[:_FIRST_PERMANENT] = saved.common
        if saved.lasting is not None:
            self.common[_FIRST_PERMANENT:] = saved.lasting
            self.save()
        self.names = dict(saved.names)
        self.revision += 1

    def permanent(self) -> dict[int, float]:
        """Return the variables from #500 on that are not vacant, to be kept."""
        return {
            number: value
            for number, value in enumerate(self.common)
            if number >= _FIRST_PERMANENT and value is not None
        }

    def restore(self, values: Mapping[int, float]) -> None:
        """Take over what `permanent` gave; all other variables from #500 on become vacant."""
        vacant: dict[int, Value] = {
            number: None
            for first, last in self.ranges
            if first >= _FIRST_PERMANENT
            for number in range(first, last + 1)
        }
        self.set_all(vacant | dict(values))


def no_variable(number: int) -> MacroError:
    """Return the error for a number that is no variable."""
    return MacroError(f"there is no variable #{number}", "See the table of variables.", "PS0115")


def checked(value: float) -> float:
    """Return a value that a variable can hold.

    Raises:
        MacroError: It is too large, or no number.
    """
    if not -LARGEST < value < LARGEST:
        raise MacroError("the value is too large for a variable", "Variables hold up to 7e47.", "PS0111")
    return value


def _vacant() -> list[Value]:
    return [None] * (LOCALS + 1)
