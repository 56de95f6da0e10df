"""Sub-programs of LinuxCNC's language in the folder of `--root`."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from polycnc.cli._app import app


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_sub_program_is_found_in_root(command: str, tmp_path: Path) -> None:
    folder = tmp_path / "library"
    folder.mkdir()
    (folder / "part.ngc").write_text("O<part> SUB\nG0 X5\nO<part> ENDSUB\n")
    program = tmp_path / "main.ngc"
    program.write_text("O<part> CALL\nM2\n")
    runner = CliRunner()
    assert runner.invoke(app, [command, str(program)]).exit_code != 0
    found = runner.invoke(app, [command, str(program), "--root", str(folder)])
    assert found.exit_code == 0, found.output
