"""The file of parameters that outlive a program: number and value, one a line, in the order of the numbers.

Source: LinuxCNC, "G-code Overview", "Parameters File", and what `rs274` refuses.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from pathlib import Path

from polycnc.errors import SourcePosition, UsageError, shown

LAST = 5601
LARGEST_BYTES = 1_000_000
_LINE = re.compile(r"\s*([0-9]{1,9})\s+([-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?)")
ALWAYS = (
    *range(5161, 5170),
    *range(5181, 5190),
    *range(5210, 5220),
    *range(5220, 5391),
)
"""What every file has: reference positions, the shift of G92, work offsets."""


def read_parameters(path: str | Path) -> dict[int, float]:
    """Return the parameters of a file; lines that do not begin with a number and a value are remarks.

    Raises:
        UsageError: the file cannot be read or is too large, a number is none of a parameter, or out of order.
    """
    try:
        with Path(path).open("rb") as file:
            content = file.read(LARGEST_BYTES + 1)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise UsageError(
            f"the parameters in {path} cannot be read: {why}",
            hint="See parameter_file in [programs] of the machine file.",
        ) from None
    if len(content) > LARGEST_BYTES:
        raise UsageError(f"{path} is too large for parameters", hint="Name another file.")
    found: dict[int, float] = {}
    last = 0
    for number, line in enumerate(content.decode("latin-1").splitlines(), 1):
        if (match := _LINE.match(line)) is None:
            continue
        index = int(match[1])
        if not 0 < index <= LAST:
            raise _wrong(path, number, line, f"there is no parameter #{index}", f"Numbers are 1 to {LAST}.")
        if index <= last:
            raise _wrong(path, number, line, f"#{index} is out of order", "Sort the lines by their numbers.")
        if not math.isfinite(value := float(match[2])):
            raise _wrong(
                path, number, line, f"{shown(match[2], 40)} is too large for #{index}", "Correct the line."
            )
        last, found[index] = index, value
    return found


def parameters_text(numbers: Iterable[int], value: Callable[[int], float]) -> str:
    """Return the text of a file with some parameters and those that every file has."""
    return "".join(f"{number}\t{value(number):.6f}\n" for number in sorted({*numbers, *ALWAYS}))


def _wrong(path: str | Path, number: int, line: str, what: str, hint: str) -> UsageError:
    position = SourcePosition(str(path), number, 1, line)
    return UsageError(f"{position}: {what}", hint=hint)
