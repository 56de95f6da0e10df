"""A block in which numbers stand in brackets does what it does without them (Manual 003, 2.1.1)."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.errors import ProgramError
from polycnc.nc import ProgramText
from polycnc.runner import RunResult, run
from support.often import share
from support.programs import MILL

_NUMBERS = re.compile(r"(?<=[A-MO-Z])[0-9.-]+(?![^(]*\))")
_AXES = st.tuples(st.sampled_from("XYZ"), st.sampled_from(["7", "-12.5", ".25", "31.75", "-4."]))
_WORDS = st.one_of(
    _AXES.map("".join),
    st.sampled_from(["G0", "G1", "G90", "G91", "G4", "F600", "F1250.5", "S800", "M3", "M5", "M8", "T2"]),
)
_REMARKS = st.sampled_from(
    [
        "",
        "",
        " ",
        "(to hole)",
        "(MSG,GO)",
        "( msg , at [A] )",
        "(X5 [B])",
        "(MSG,one) (two)",
        "(MSG,one)(MSG,two)",
        "()",
    ]
)
_HEADS = st.sampled_from(["", "N20", "N30 ", "/N40", "/2 N50 ", "/3", " "])


@st.composite
def _blocks(draw: st.DrawFn) -> str:
    words = draw(st.lists(_WORDS, min_size=1, max_size=5))
    return draw(_HEADS) + "".join(f"{word}{draw(_REMARKS)}" for word in words) + draw(_REMARKS)


def _run(blocks: list[str], root: Path) -> RunResult | str:
    text = ProgramText.from_text("\n".join(["N1 F500", *blocks, "M30"]) + "\n", "main.npg")
    try:
        return run(text, MILL, "bosch", root=root, skip_levels=(2,))
    except ProgramError as error:
        return error.what


@settings(max_examples=share(60), deadline=None)
@given(st.lists(_blocks(), min_size=1, max_size=4), st.data())
def test_a_number_in_brackets_is_that_number(
    tmp_path_factory: pytest.TempPathFactory, blocks: list[str], data: st.DataObject
) -> None:
    root = tmp_path_factory.getbasetemp()

    def bracketed(found: re.Match[str]) -> str:
        return data.draw(st.sampled_from(("[{}]", "[ {}]", "[0+{}]", "{}"))).format(found[0])

    plain = _run(blocks, root)
    other = _run([_NUMBERS.sub(bracketed, block) for block in blocks], root)
    if isinstance(plain, str) or isinstance(other, str):
        assert plain == other
        return
    assert plain.end_position_mm == other.end_position_mm
    assert plain.time_s == other.time_s
    assert [(each.line, each.text) for each in plain.messages] == [
        (each.line, each.text) for each in other.messages
    ]
    assert [(each.line, each.word) for each in plain.events] == [
        (each.line, each.word) for each in other.events
    ]
