"""Try polycnc with the interpreters that there are: install it, run a program, hold the results against each other."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[1]
VERSIONS = ("3.11", "3.12", "3.13")
ASK = "import platform, sys; print(sys.implementation.name, platform.python_version())"


def interpreters() -> dict[str, Path]:
    """Return one interpreter for each version, where there is one."""
    named = [Path(each) for each in os.environ.get("POLYCNC_PYTHONS", "").split()]
    on_path = [Path(found) for version in VERSIONS if (found := shutil.which(f"python{version}"))]
    kept = [
        *Path.home().glob(".pyenv/versions/3.1[123].*/bin/python"),
        *Path("/opt").glob("python*/bin/python3"),
    ]
    found: dict[str, Path] = {}
    for path in (*named, *kept, *on_path):
        asked = subprocess.run([path, "-c", ASK], capture_output=True, text=True, check=False)
        name, _, version = asked.stdout.strip().partition(" ")
        if name == "cpython":
            found.setdefault(".".join(version.split(".")[:2]), path)
    return {version: found[version] for version in VERSIONS if version in found}


def tried(python: Path, wheel: Path, folder: Path, tests: list[str]) -> str:
    """Install the wheel and run a program; return what came out."""
    subprocess.run([python, "-m", "venv", folder], check=True)
    inside = folder / "bin" / "python"
    quiet = [inside, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    subprocess.run([*quiet, f"{wheel}[test]" if tests else str(wheel)], check=True)
    program = [folder / "bin" / "polycnc", "run", REPOSITORY / "examples" / "bracket.nc", "--json"]
    said = subprocess.run(program, check=True, capture_output=True, text=True, cwd=folder).stdout
    if tests:
        subprocess.run(
            [inside, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests], check=True, cwd=REPOSITORY
        )
    return said


def main() -> None:
    """Try every version, and say which there are not."""
    found = interpreters()
    if not found:
        raise SystemExit(f"there is no CPython {', '.join(VERSIONS)} here; POLYCNC_PYTHONS can name some")
    with tempfile.TemporaryDirectory(prefix="polycnc-pythons-") as name:
        folder = Path(name)
        wheel_of = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", folder, REPOSITORY]
        subprocess.run(wheel_of, check=True)
        (wheel,) = folder.glob("*.whl")
        results = {}
        for version, python in found.items():
            print(f"{version}: {python}", flush=True)
            results[version] = tried(python, wheel, folder / version, sys.argv[1:])
    for version in VERSIONS:
        print(f"{version}: {'runs' if version in results else 'not found here, so not tried'}")
    if len(set(results.values())) > 1:
        raise SystemExit("the versions give different results")
    if len(results) > 1:
        print("all of them with the same bits")


if __name__ == "__main__":
    main()
