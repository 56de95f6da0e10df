"""The scripts a newcomer starts with: they parse, can be started from anywhere, and do what they name."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
_NAMES = ("build_cache", "check_wheel", "demo", "mutate", "reference", "release", "test", "test_long")
SCRIPTS = [REPOSITORY / "scripts" / name for name in _NAMES]


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_script_is_executable_posix_shell(script: Path) -> None:
    assert os.access(script, os.X_OK)
    assert script.read_text(encoding="utf-8").startswith("#!/bin/sh\n#")
    checked = subprocess.run(["sh", "-n", str(script)], capture_output=True, text=True, check=False)
    assert (checked.returncode, checked.stderr) == (0, "")


def test_scripts_name_files_that_exist() -> None:
    for script in SCRIPTS:
        for name in re.findall(
            r"(?:examples|scripts|tests|conformance)/[\w./]*\w", script.read_text(encoding="utf-8")
        ):
            path = REPOSITORY / name
            assert path.exists() or name == "conformance/claims.tsv", f"{script.name} names {name}"


def test_demo_from_elsewhere_with_an_environment_that_is_set_up(tmp_path: Path) -> None:
    """Give a copy an environment whose `polycnc` only writes down how it was called."""
    copy = tmp_path / "checkout"
    (copy / ".venv" / "bin").mkdir(parents=True)
    shutil.copytree(REPOSITORY / "scripts", copy / "scripts")
    shutil.copytree(REPOSITORY / "examples", copy / "examples")
    shutil.copy(REPOSITORY / "pyproject.toml", copy)
    for name, text in (("python", "exit 0"), ("polycnc", 'pwd; printf "%s\\n" "$@"')):
        program = copy / ".venv" / "bin" / name
        program.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
        program.chmod(0o755)
    text = (copy / "pyproject.toml").read_text(encoding="utf-8")
    stamp = subprocess.run(["cksum"], input=text, capture_output=True, text=True, check=True)
    (copy / ".venv" / "polycnc-installed-plot").write_text(stamp.stdout, encoding="utf-8")
    (copy / ".venv" / "polycnc-home").write_text(f"{copy}\n", encoding="utf-8")
    done = subprocess.run(
        ["sh", str(copy / "scripts" / "demo")], cwd="/", capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    called = done.stdout.splitlines()
    assert called[:3] == [str(copy), "run", "examples/bracket.nc"]
    assert "--plot" in called
    assert f"{copy}/demo_output/part.png" in done.stdout
