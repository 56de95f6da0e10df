"""The layers are checked by a tool; this checks that the tool refuses what it is there to refuse."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
LINT = "from importlinter.cli import lint_imports; import sys; sys.exit(lint_imports(no_cache=True))"


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy of the sources with the contracts, to spoil."""
    root = tmp_path_factory.mktemp("contracts")
    shutil.copytree(REPOSITORY / "src", root / "src", ignore=shutil.ignore_patterns("__pycache__"))
    (root / "tests" / "support").mkdir(parents=True)
    shutil.copy(REPOSITORY / "tests" / "support" / "import_contracts.py", root / "tests" / "support")
    shutil.copy(REPOSITORY / "pyproject.toml", root)
    return root


@pytest.mark.parametrize(
    ("module", "line", "contract"),
    [
        (
            "controllers/imc/card/_config.py",
            "import polycnc.controllers.apci",
            "controllers stand on the library and never import each other",
        ),
        (
            "nc/blocks/_moves.py",
            "from polycnc.kernel._path import slot",
            "no private module of another package",
        ),
        ("machine/_io.py", "import polycnc.conformance", "imports go only downwards"),
        (
            "nc/dialect/_cycle_settings.py",
            "from polycnc.nc.blocks._probe import Probe",
            "part programs: each part stands on those below it",
        ),
    ],
)
def test_forbidden_imports_are_refused(copy: Path, module: str, line: str, contract: str) -> None:
    path = copy / "src" / "polycnc" / module
    text = path.read_text(encoding="utf-8")
    path.write_text(f"{text}\n{line}\n", encoding="utf-8")
    try:
        done = subprocess.run(
            [sys.executable, "-c", f"import sys; sys.path[:0] = ['src', '.']\n{LINT}"],
            cwd=copy,
            capture_output=True,
            text=True,
            check=False,
        )
    finally:
        path.write_text(text, encoding="utf-8")
    assert done.returncode == 1, done.stderr
    assert f"{contract} BROKEN" in " ".join(done.stdout.split())
    assert done.stdout.count("BROKEN") == 1
