"""Moves written many at a time have the text that they have one by one: any numbers, any format."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.post import (
    CONTROLS,
    BlockMap,
    ControlFile,
    load_control,
    parse_control,
    parse_tool_path,
    post_program,
)
from polycnc.post.tool_path import _source
from support.post_controls import control_text

HEAD = "LOADTL/3\nSPINDL/RPM,900,CLW\nFEDRAT/700,MMPM\nRAPID\nGOTO/1,0,3\nGOTO/1,0,2\n"
# Ties of three decimals, numbers that are nearly ties, whole ones, what rounds to 0, and long ones.
NUMBERS = st.one_of(
    st.integers(-40_000, 40_000).map(lambda n: n / 16.0),
    st.integers(-40_000_000, 40_000_000).map(lambda n: n / 10_000.0),
    st.sampled_from(
        [0.0, -0.0, 0.0004, -0.0004, 0.0005, -0.0005, 2.675, 1.0005, 999999.5, 2147.4836475, 1e-9]
    ),
    st.floats(-3000.0, 3000.0, allow_subnormal=False),
)
FORMATS = {
    "keep": 'format = "X%.3f"',
    "trim": 'format = "X%.4f"\nzeros = "trim"',
    "point": 'format = "X%.1f"\nzeros = "point"\nscale = 0.1',
    "whole": 'format = "X%d"\nscale = 1000.0',
    "six": 'format = "X%f mm"',
    "always": 'format = "X%.2f"\nmodal = false',
    "signed": 'format = "X%+.2f"',
    "general": 'format = "X%g"',
}


def posted(used: ControlFile, text: str, long_bytes: int) -> tuple[str, list[int], list[int]]:
    """Post a tool path, together from so many bytes on."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_source, "_LONG_BYTES", long_bytes)
        out: list[str] = []
        blocks = BlockMap()
        summary = post_program(parse_tool_path(text), used, out.append, block_map=blocks)
    written = "".join(out)
    assert written.count("\n") == summary.blocks
    return written, list(blocks.last_block), list(blocks.line)


def path_of(points: list[list[float]]) -> str:
    """Return a tool path whose points come often enough to be taken together."""
    lines = [f"GOTO/{x:.10f},{y:.10f},{z:.10f}\n" for x, y, z in points]
    return HEAD + "".join(lines * (140 // len(lines) + 1)) + "GOTO/1,0,2\nRAPID\nGOTO/1,0,9\n" + "FINI\n"


@settings(max_examples=25, deadline=None)
@given(
    points=st.lists(st.lists(NUMBERS, min_size=3, max_size=3), min_size=1, max_size=30),
    name=st.sampled_from([each for each in CONTROLS if each != "fanuc-lathe"]),
)
def test_shipped_controls_write_rows_as_single_moves(points: list[list[float]], name: str) -> None:
    used, text = load_control(name), path_of(points)
    assert posted(used, text, 0) == posted(used, text, 1 << 30)


@pytest.mark.parametrize("form", FORMATS)
@settings(max_examples=10, deadline=None)
@given(points=st.lists(st.lists(NUMBERS, min_size=3, max_size=3), min_size=2, max_size=30))
def test_every_format_is_written_as_by_python(form: str, points: list[list[float]]) -> None:
    used = with_format(FORMATS[form])
    text = path_of(points)
    assert posted(used, text, 0) == posted(used, text, 1 << 30)


MACRO = '!-G01!$X$$Y$"/"$Z$$F$\n  $X$ $Y$  \n@0@(at $X$)  '
"""Lines of moves with a text among them, of blanks and what is left out if it is the same, and of text."""


def with_format(form: str) -> ControlFile:
    """Return a control file that numbers its blocks up to 90 and writes X in a format."""
    parameters = {"sequence_place": 1, "sequence_step": 7, "sequence_start": 3, "sequence_highest": 90}
    text = control_text({**parameters, "separator": "  "}, {"LINEAR": MACRO})
    plain = 'format = "X%.3f"\nmodal = true'
    assert plain in text
    return parse_control(
        text.replace(plain, form).replace("[g_code", "[nc_code.Y]\nseparator = false\n[g_code", 1)
    )


def test_numbers_are_written_by_their_exact_value() -> None:
    values = [0.0005, 0.0015, 1.0005, 2.6755, 1234.5675, -0.0625 / 50, 5.0015]
    text = HEAD + "".join(f"GOTO/{value},{n},1\n" for n, value in enumerate(values * 20)) + "FINI\n"
    written, *_ = posted(load_control("fanuc-mill"), text, 0)
    found = [line.split()[-2][1:] for line in written.splitlines() if " Y" in line or line.startswith("X")]
    wanted = [f"{value:.3f}".rstrip("0") for value in values]
    assert found[-len(values) :] == wanted


def test_long_numbers_on_the_way_are_written_too() -> None:
    points = np.arange(300.0).reshape(100, 3)
    points[40, 0] = 3_500.25  # more than nine digits with six decimals
    used = with_format('format = "X%.6f"')
    text = path_of(points.tolist())
    assert posted(used, text, 0) == posted(used, text, 1 << 30)
    lines = posted(used, text, 0)[0].splitlines()
    assert sum("X3500.250000" in line for line in lines) >= 1
    assert all(a != b for a, b in pairwise(lines))
