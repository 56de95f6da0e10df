"""State by reference: compiled functions take a named tuple of arrays as a pointer to it.

By value each array of a state is seven words, and each call of an internal function passes them all. A reference is one
word, and a member is loaded where it is used. Once all is one function, the pointers are gone again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from typing import Any

import numba
from numba.core import cgutils, types
from numba.core.imputils import impl_ret_borrowed, lower_cast, lower_getattr_generic
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.extending import models, register_model

# numba's own annotations leave these out.
_types: Any = types
_typeof: Any = numba.typeof
_Type: Any = types.Type
_cgutils: Any = cgutils
_lower_cast: Any = lower_cast
_lower_getattr: Any = lower_getattr_generic
_borrowed: Any = impl_ret_borrowed
_NAMED: Any = types.BaseNamedTuple
_AttributeTemplate: Any = AttributeTemplate
_PrimitiveModel: Any = models.PrimitiveModel


def described(argument: Any) -> Iterator[str]:
    """Describe the type of an argument; numba's text for a named tuple leaves out which class it is."""
    yield str(argument)
    if isinstance(argument, _NAMED):
        yield f"{argument.instance_class.__module__}.{argument.instance_class.__qualname__}{argument.fields}"
        for each in argument:
            yield from described(each)


class StateRef(_Type):  # type: ignore[misc]
    """A reference to a named tuple."""

    def __init__(self, state: Any) -> None:
        self.state = state
        digest = hashlib.blake2b("\n".join(described(state)).encode(), digest_size=8).hexdigest()
        super().__init__(f"StateRef({state.instance_class.__name__},{digest})")

    @property
    def key(self) -> Any:
        """What makes two references the same type."""
        return self.state

    def member(self, name: str) -> tuple[int, Any]:
        """Return where a member is, and its type in the tuple."""
        index = self.state.fields.index(name)
        return index, self.state[index]


_known: dict[Any, StateRef] = {}


def by_reference(argument: Any) -> Any:
    """Return the type by which an argument of this type is passed."""
    if not isinstance(argument, _NAMED):
        return argument
    if argument not in _known:
        _known[argument] = StateRef(argument)
    return _known[argument]


def types_of(states: tuple[object, ...], numbers: int) -> tuple[Any, ...]:
    """Return the types of states and of so many integers after them."""
    return (*map(_typeof, states), *[_types.int64] * numbers)


@register_model(StateRef)
class _StateRefModel(_PrimitiveModel):  # type: ignore[misc]
    def __init__(self, dmm: Any, fe_type: StateRef) -> None:
        super().__init__(dmm, fe_type, dmm.lookup(fe_type.state).get_value_type().as_pointer())


@infer_getattr
class _StateRefAttributes(_AttributeTemplate):  # type: ignore[misc]
    key = StateRef

    def generic_resolve(self, reference: StateRef, name: str) -> Any:
        if name not in reference.state.fields:
            return None
        return by_reference(reference.member(name)[1])


def _load_member(context: Any, builder: Any, reference: StateRef, pointer: Any, name: str) -> Any:
    index, member = reference.member(name)
    place = _cgutils.gep_inbounds(builder, pointer, 0, index)
    if isinstance(member, _NAMED):
        return place
    return _borrowed(context, builder, member, builder.load(place))


def _refer(context: Any, builder: Any, given: Any, wanted: StateRef, value: Any) -> Any:
    return _cgutils.alloca_once_value(builder, value)


_lower_getattr(StateRef)(_load_member)
_lower_cast(types.BaseNamedTuple, StateRef)(_refer)
