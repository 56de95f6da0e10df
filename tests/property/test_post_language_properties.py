"""Random macros: compiled, they write what a slow interpreter writes; random text never crashes the loader."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.errors import ConfigurationError, ProgramError
from polycnc.post import parse_control
from support.often import share
from support.post_cases import control_with
from support.post_models import MACROS, Node, Slow, macro_text


@given(
    macros=st.lists(MACROS, min_size=1, max_size=3),
    place=st.sampled_from((0, 1, 2)),
    separator=st.sampled_from(("", " ", "--")),
)
@settings(deadline=None, max_examples=share(40))
def test_compiled_macros_write_what_a_slow_interpreter_writes(
    macros: list[list[Node]], place: int, separator: str
) -> None:
    names = ("RAPID", "LINEAR", "STOP")[: len(macros)]
    texts = {name: macro_text(macro) for name, macro in zip(names, macros, strict=True)}
    control = control_with(texts, sequence_place=place, separator=separator)
    written: list[str] = []
    run = control.start(written.append)
    slow = Slow(place, separator)
    for _ in range(2):  # state lasts from call to call
        for name, macro in zip(names, macros, strict=True):
            run.call(name)
            slow.run(macro)
    assert written == slow.blocks


@given(st.text(alphabet="!$@&<>\"',*-+/=()|.0159AGXxIFELSND \n\té", max_size=60))
@settings(deadline=None, max_examples=share(100))
def test_any_text_is_a_macro_or_refused_with_its_place(macro: str) -> None:
    if "''" in macro or macro.endswith("'"):
        macro = macro.replace("'", "")
    tables = '[g_code]\nG01 = {}\n[function_variables]\nX = { format = "X%g" }\n'
    error = _first_error(f"{tables}[nc_macros]\nRAPID = '''\n{macro}'''\n")
    if error is not None:
        assert "[nc_macros] RAPID, line" in error.what
        assert error.position is not None
        assert error.position.line >= 7
        assert error.position.text.startswith(macro.split("\n")[error.position.line - 7])


def _first_error(text: str) -> ConfigurationError | ProgramError | None:
    written: list[str] = []
    try:
        parse_control(text).start(written.append).call("RAPID", {"X": 1.5})
    except (ConfigurationError, ProgramError) as error:
        return error
    finally:
        assert all(block.endswith("\n") for block in written)
    return None


@pytest.mark.parametrize("separator", ["", " "])
def test_the_slow_interpreter_knows_the_manuals_example(separator: str) -> None:
    line: Node = ("line", [("order", 1), ("code", "", "G00"), ("ordered", "/", -200), ("number", True)])
    slow = Slow(2, separator)
    slow.run([line])
    assert slow.blocks == [f"/{separator}N10{separator}G00\n"]
