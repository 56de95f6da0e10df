"""How compiled code calls a function by its address."""

from __future__ import annotations

from typing import Any

from numba.core import types
from numba.extending import intrinsic

# numba's own annotations leave these out.
_types: Any = types
_intrinsic: Any = intrinsic


def _call(typing: Any, address: Any, places: Any, numbers: Any) -> Any:
    kinds = (*[_types.voidptr] * len(places), *numbers)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        convention = context.call_conv
        function = convention.get_function_type(_types.int64, kinds).as_pointer()
        pointer = context.get_value_type(_types.voidptr)
        passed = [builder.inttoptr(builder.extract_value(values[1], n), pointer) for n in range(len(places))]
        passed += [builder.extract_value(values[2], n) for n in range(len(numbers))]
        called = builder.inttoptr(values[0], function)
        return convention.call_function(builder, called, _types.int64, kinds, passed)[1]

    return _types.int64(address, places, numbers), generate


call: Any = _intrinsic(_call)
"""What `call_at` is to compiled code."""
