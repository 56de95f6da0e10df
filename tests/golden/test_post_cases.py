"""The worked cases of the macro language: every one gives the blocks, or the error, that the table says."""

from __future__ import annotations

import pytest

from polycnc.errors import ConfigurationError, ProgramError
from support.post_cases import Case, blocks_of, cases, check_every_way, rows_of

CASES = list(cases())


def shown_by(case: Case) -> list[str]:
    """Return the rows that the statements of a case show; a refused one shows no more than it says."""
    if "error" in case.parts:
        return []
    return rows_of(*case.part("setup"), *case.part("macro"), place=case.place)


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=case.name, marks=pytest.mark.covers(*{*case.part("covers"), *shown_by(case)}))
        for case in CASES
    ],
)
def test_worked_case(case: Case) -> None:
    macros = ["\n".join(case.part("setup")), "\n".join(case.part("macro"))]
    words = {"TOOLCHANGE": "T03"}
    if "error" in case.parts:
        with pytest.raises((ConfigurationError, ProgramError)) as error:
            blocks_of(*macros, words=words, sequence_place=case.place)
        assert isinstance(error.value, ConfigurationError | ProgramError)
        assert error.value.position is not None
        line = error.value.what.removeprefix("[nc_macros] RAPID, ")
        assert [f"{error.value.position.column}: {line}"] == case.part("error")
    else:
        assert blocks_of(*macros, words=words, sequence_place=case.place) == case.parts["gives"]
        check_every_way(*macros, words=words, sequence_place=case.place)


def test_all_cases_are_there() -> None:
    names = [case.name for case in CASES]
    assert names == [f"S{n:02d}" for n in range(1, 32)] + [f"D{n:02d}" for n in range(1, 63)]
    assert all(case.part("macro") for case in CASES)
