"""Write a machine file from facts."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping

from polycnc.runner.machine_sources._facts import AxisFacts, Facts

WIDTH = 110


def machine_text(facts: Facts, name: str, source: str) -> str:
    """Return the machine file of `facts`; `source` is the file they come from."""
    return "\n".join(_lines(facts, name, source)) + "\n"


def _lines(facts: Facts, name: str, source: str) -> Iterator[str]:
    yield f"# Made from {facts.control}: {_one_line(source)}"
    if facts.left_out:
        yield "#"
        yield "# Left out:"
        for left in facts.left_out:
            yield from textwrap.wrap(
                _one_line(f"{left.name}: {left.why}"),
                WIDTH,
                initial_indent="# - ",
                subsequent_indent="#   ",
                break_on_hyphens=False,
            )
    yield ""
    yield f"name = {json.dumps(name)}"
    yield f"description = {json.dumps(f'Made from {facts.control}')}"
    if facts.cycle_s is not None:
        yield f"cycle_s = {_number(facts.cycle_s)}"
    for axis in facts.axes:
        yield ""
        yield "[[axis]]"
        yield from _axis(axis)
    yield from _table("path", facts.path)
    yield from _table("spindle", facts.spindle)
    if facts.offsets:
        yield ""
        yield "[offsets]"
        for offset, values in facts.offsets.items():
            inside = ", ".join(f"{axis} = {_number(value)}" for axis, value in values.items())
            yield f"{offset} = {{ {inside} }}"

    yield from _tools(facts)
    yield from _programs(facts)


def _tools(facts: Facts) -> Iterator[str]:
    for number, tool in sorted(facts.tools.items()):
        yield ""
        yield f"[tools.{number}]"
        for key, value in tool.items():
            yield f"{key} = {json.dumps(_one_line(value)) if isinstance(value, str) else _number(value)}"


def _programs(facts: Facts) -> Iterator[str]:
    if facts.programs:
        yield ""
        yield "[programs]"
        for key, value in facts.programs.items():
            yield f"{key} = {json.dumps(value)}"
    if facts.remaps:
        yield ""
        yield "[programs.remaps]"
        yield from (
            f"{json.dumps(code)} = {json.dumps(_one_line(where))}" for code, where in facts.remaps.items()
        )
    if facts.settings:
        yield ""
        yield "[programs.settings]"
        for section, values in facts.settings.items():
            inside = ", ".join(f"{json.dumps(name)} = {_number(value)}" for name, value in values.items())
            yield f"{json.dumps(section)} = {{ {inside} }}"


def _axis(axis: AxisFacts) -> Iterator[str]:
    unit = axis.unit
    yield f"name = {json.dumps(axis.name)}"
    if unit == "deg":
        yield 'kind = "rotary"'
    yield f"vmax_{unit}_s = {_number(axis.speed)}"
    yield f"amax_{unit}_s2 = {_number(axis.acceleration)}"
    if axis.jump is not None:
        yield f"jump_{unit}_s = {_number(axis.jump)}"
    if axis.limits is not None:
        low, high = axis.limits
        yield f"soft_limits_{unit} = [{_number(low)}, {_number(high)}]"
    if axis.home:
        yield f"home_{unit} = {_number(axis.home)}"


def _table(name: str, values: Mapping[str, float | bool | str]) -> Iterator[str]:
    if values:
        yield ""
        yield f"[{name}]"
        for key, value in values.items():
            yield f"{key} = {json.dumps(value) if isinstance(value, str | bool) else _number(value)}"


def _number(value: float) -> str:
    rounded = round(value, 9) + 0.0  # no negative zero
    return str(int(rounded)) if rounded == int(rounded) and abs(rounded) < 1e15 else repr(rounded)


def _one_line(text: str) -> str:
    return "".join(char if char.isprintable() else "?" for char in text)
