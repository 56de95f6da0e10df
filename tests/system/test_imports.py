"""What a command loads: what it does not use costs every start."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
LOADED = """
import sys
from polycnc.cli import main
sys.argv = ["polycnc", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
print("\\n".join(["", "LOADED", *sorted(sys.modules)]))
"""
NO_RUN = {
    *("asyncio", "sqlite3", "ssl", "http", "multiprocessing.pool"),
    *("matplotlib", "pandas", "pyarrow", "textual", "distributed", "PIL", "IPython"),
    *("scipy.interpolate", "scipy.optimize", "scipy.linalg"),
    *("polycnc.controllers", "polycnc.servers", "polycnc.post", "polycnc.language", "polycnc.conformance"),
    *("polycnc.cnc._control", "polycnc.cnc._manual", "polycnc.cnc._alarms", "polycnc.cnc._program_memory"),
    *("polycnc.machine._store", "polycnc.machine._host", "polycnc.machine._describe"),
    *("polycnc.nc.cpl", "polycnc.nc.macro._language"),
    *("polycnc.runner.plots", "polycnc.runner._debugger", "polycnc.runner.view", "polycnc.runner.batches"),
}
COMPILER = "numba.np.arraymath"
NO_HELP = NO_RUN | {
    "numba",
    "numpy",
    "pydantic",
    "polycnc.kernel",
    "polycnc.machine",
    "polycnc.nc",
    "polycnc.cnc",
}


def loaded(*arguments: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", LOADED, *arguments], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return set(done.stdout.partition("\nLOADED\n")[2].splitlines())


@pytest.mark.parametrize(
    ("arguments", "spared"),
    [
        (("run", "examples/bracket.nc", "--dialect", "din", "--machine", "vmc3"), NO_RUN),
        (("run", "examples/bracket.nc", "--dialect", "din", "--machine", "vmc3", "--json"), NO_RUN),
        (("check", "examples/bracket.nc", "--dialect", "din"), NO_RUN),
        (("--help",), NO_HELP),
        (("run", "--help"), NO_RUN),
    ],
)
def test_a_command_loads_what_it_uses(arguments: tuple[str, ...], spared: set[str]) -> None:
    found = loaded(*arguments)
    if COMPILER in found:  # something had to be compiled; now it is there
        found = loaded(*arguments)
    assert COMPILER not in found
    assert "polycnc.cli._run" in found
    assert not found & spared


def test_names_that_are_loaded_later_are_there() -> None:
    code = (
        "import importlib\n"
        "for package in ('polycnc', 'polycnc.cnc', 'polycnc.machine', 'polycnc.nc.macro', 'polycnc.runner'):\n"
        "    module = importlib.import_module(package)\n"
        "    for name in module.__all__:\n"
        "        assert getattr(module, name) is getattr(module, name)\n"
        "        assert name in vars(module)\n"
        "    try:\n"
        "        module.not_there\n"
        "    except AttributeError as error:\n"
        "        assert str(error) == f\"module '{package}' has no attribute 'not_there'\"\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
