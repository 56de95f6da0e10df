"""A machine file says what is cut and what holds it; arguments overrule it."""

from __future__ import annotations

from typing import Any

import pytest

import polycnc
from polycnc import runner
from polycnc.errors import UsageError
from polycnc.machine import MachineConfig, parse_machine, preset_text

SLOT = """(T1 D=10. CR=0. - flat end mill)
T1 M6
S5000 M3
G0 X-10 Y16 Z20
Z-4
G1 X70 F1500
G0 Z20
M30
"""
STOCK = '[stock]\nform = "box=0,0,-20,60,42,0"\nresolution_mm = 0.5\n'
CLAMP = '[[fixture]]\nform = "box=20,11.5,-20,30,14,15"\n'


def machine(lines: str) -> MachineConfig:
    return parse_machine(f"{preset_text('mill3')}\n{lines}", "m.toml")


@pytest.mark.parametrize(
    ("lines", "arguments", "cell_mm", "kinds"),
    [
        (STOCK, {}, 0.5, []),
        (STOCK + CLAMP, {}, 0.5, ["tool in fixture"]),
        (STOCK + CLAMP, {"resolution_mm": 0.25}, 0.25, ["tool in fixture"]),
        (STOCK + CLAMP, {"fixtures": ["box=0,30,-20,5,40,3"]}, 0.5, []),
        (STOCK, {"stock": "box=0,0,-20,60,42,-4", "resolution_mm": 1.0}, 1.0, None),
        (CLAMP, {"stock": "box=0,0,-20,60,42,0", "resolution_mm": 0.5}, 0.5, ["tool in fixture"]),
    ],
)
def test_the_machine_file_says_what_is_cut(
    lines: str, arguments: dict[str, Any], cell_mm: float, kinds: list[str] | None
) -> None:
    result = polycnc.run(SLOT, machine(lines), "fanuc", **arguments)
    assert result.machined is not None
    assert result.machined.stock.cell_mm == cell_mm
    assert result.removed_mm3 == (0.0 if kinds is None else pytest.approx(60.0 * 10.0 * 4.0, rel=0.06))
    assert [str(each.kind) for each in result.collisions] == (kinds or [])


@pytest.mark.parametrize(
    ("told", "tool", "width_mm"),
    [
        ("(Tool: end mill 10 mm)", "", 10.0),
        ("(6 mm end mill)\n(then a drill of 3 mm)", "", 0.0),
        ("(T7 D=8. CR=0. - flat end mill)", "", 8.0),
        ("", "[tools.3]\nradius_mm = 4\n", 8.0),
        ("(T7 D=8. CR=0. - flat end mill)\n(T8 D=9. CR=0. - flat end mill)", "", 0.0),
        ("T5\n(end mill 10 mm)", "", 0.0),
        ("(finish)", "", 0.0),
    ],
)
def test_a_program_that_changes_no_tool_has_its_only_one(told: str, tool: str, width_mm: float) -> None:
    program = "\n".join((told, *SLOT.splitlines()[2:]))
    result = polycnc.run(program, machine(tool + STOCK), "fanuc")
    assert result.machined is not None
    assert result.removed_mm3 == pytest.approx(60.0 * width_mm * 4.0, rel=0.1)


def test_a_check_looks_at_the_stock_of_the_machine_file() -> None:
    report = runner.inspect(SLOT, machine(STOCK + CLAMP), "fanuc")
    assert [(each.key, each.position.line if each.position else 0) for each in report.remarks] == [
        ("fixture", 6)
    ]
    assert polycnc.run(SLOT, machine(CLAMP), "fanuc").machined is None


@pytest.mark.parametrize(
    ("lines", "wrong"),
    [
        ('[stock]\nform = "vice"\n', "stock of 'mill3': 'vice'"),
        (STOCK + '[[fixture]]\nform = "auto"\n', "stock of 'mill3': 'auto' is no fixture"),
    ],
)
def test_a_form_of_the_machine_file_that_cannot_be_is_refused(lines: str, wrong: str) -> None:
    with pytest.raises(UsageError, match=wrong) as refused:
        polycnc.run(SLOT, machine(lines), "fanuc")
    assert refused.value.hint
