"""CPL programs that must be refused, by the link step or while they run, and what is said about each.

`cpl_errors/program.txt` is what is said about `cpl_errors/program.npg`; its first line is the exact error. Programs
named `run_...` link and fail while they run; those that they call lie in `called`. After a wanted change:
`pytest tests/golden --update-goldens`, and read the difference.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from polycnc.errors import ProgramError
from polycnc.nc.cpl import Linker, Run, undeclared
from support.cpl_host import RecordingHost

HERE = Path(__file__).parent / "cpl_errors"
CALLED = {path.name: path.read_text(encoding="utf-8") for path in (HERE / "called").iterdir()}
PROGRAMS = sorted(HERE.glob("*.npg"))
STEPS = 50


def refusals(program: Path) -> tuple[list[ProgramError], bool]:
    """Return what is wrong with a program, and whether it linked."""
    host = RecordingHost(programs=CALLED)
    linker = Linker(host.program)
    main, errors = linker.link(program.read_text(encoding="utf-8"), program.name)
    if main is None:
        return errors, False
    found = undeclared(main, host.permanent)
    if found:
        return found, True
    run = Run(main, linker, host)
    with pytest.raises(ProgramError) as caught:
        list(zip(range(STEPS), iter(run.step, None), strict=False))
    assert run.stack == []  # nothing continues after an error
    return [caught.value], True


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_refusal(program: Path, request: pytest.FixtureRequest) -> None:
    errors, linked = refusals(program)
    assert linked == program.stem.startswith("run_")
    found = "".join(f"{error}\n" for error in errors)
    golden = program.with_suffix(".txt")
    if request.config.getoption("update_goldens"):
        golden.write_text(found, encoding="utf-8")
    assert golden.is_file(), "run pytest tests/golden --update-goldens, then read what it wrote"
    assert found.splitlines()[0] == golden.read_text(encoding="utf-8").splitlines()[0]
    assert found == golden.read_text(encoding="utf-8")


def test_every_expected_error_has_its_program() -> None:
    assert {path.stem for path in HERE.glob("*.txt")} == {path.stem for path in PROGRAMS}
