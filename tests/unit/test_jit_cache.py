"""What is compiled again, and what is not: after changes near and far, moves, damage, and by two processes at once."""

from __future__ import annotations

import importlib
import logging
import os
import pickle
import pkgutil
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import cast

import llvmlite.binding
import pytest

import polycnc
from polycnc.jit import COMPILING, FILES, Files, Fingerprints, NotKnownError, compiled, versions
from support.command import environment

# A package of two cores above one kernel. Its entries are called with 3 and 2.5, and say how they came about.
KERNEL = '''"""Below both."""
from polycnc.jit import compiled

FACTOR = 3

@compiled
def scaled(x: float) -> float:
    """Scale."""
    return x * FACTOR

def untouched() -> int:
    return 41
'''
CORE = '''"""A core."""
from polycnc.jit import entry
from twocores.kernel import scaled

@entry
def run(n: int, x: float) -> float:
    """Add up."""
    total = 0.25
    for _ in range(n):
        total += scaled(x)
    return total
'''
SCRIPT = """
import sys, logging
logging.basicConfig(format="%(message)s")
sys.path.insert(0, sys.argv[1])
from twocores import left, right
for name, core in (("left", left), ("right", right)):
    value = core.run(3, 2.5)
    made = "compiled" if core.run.stats.cache_misses else "loaded"
    print(name, made, value)
"""
BOTH_COMPILED = "left compiled 22.75\nright compiled 22.75\n"
BOTH_LOADED = "left loaded 22.75\nright loaded 22.75\n"


def _make(folder: Path) -> Path:
    package = folder / "twocores"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "kernel.py").write_text(KERNEL)
    (package / "left.py").write_text(CORE)
    (package / "right.py").write_text(CORE)
    return folder


def _start(folder: Path, cache: Path, **more: str) -> subprocess.Popen[str]:
    at_once = {"POLYCNC_COMPILE_AT_ONCE": "1"}
    variables = environment(POLYCNC_CACHE_DIR=str(cache), PYTHONDONTWRITEBYTECODE="1", **at_once, **more)
    command = [sys.executable, "-W", "error", "-c", SCRIPT, str(folder)]
    return subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _end(process: subprocess.Popen[str]) -> tuple[str, str]:
    """Return what a process printed and remarked, without the line that it is compiling: that one goes with it."""
    said, remarks = process.communicate(timeout=240)
    assert remarks.count(f"{COMPILING}\n") == ("compiled" in said), remarks
    return said, remarks.replace(f"{COMPILING}\n", "")


def _run(folder: Path, cache: Path) -> tuple[str, str]:
    return _end(_start(folder, cache))


def _replace(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.fixture(scope="module")
def compiled_once(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Return a tree and its warm cache; tests copy what they change."""
    folder = tmp_path_factory.mktemp("jit")
    tree, cache = _make(folder / "tree"), folder / "cache"
    assert _run(tree, cache) == (BOTH_COMPILED, "")
    return tree, cache


@pytest.fixture
def tree(compiled_once: tuple[Path, Path], tmp_path: Path) -> Path:
    """Return a copy of the tree at another place, with files as new as a fresh installation."""
    return Path(shutil.copytree(compiled_once[0], tmp_path / "elsewhere", copy_function=shutil.copyfile))


@pytest.fixture
def cache(compiled_once: tuple[Path, Path], tmp_path: Path) -> Path:
    """Return a copy of the warm cache."""
    return Path(shutil.copytree(compiled_once[1], tmp_path / "cache", copy_function=shutil.copyfile))


def test_another_place_new_times_comments_and_what_nothing_reaches_compile_nothing(
    tree: Path, cache: Path
) -> None:
    package = tree / "twocores"
    _replace(package / "kernel.py", "Below both.", "Below both of them, on one more line.\n")
    _replace(package / "kernel.py", "@compiled", "# Why three.\n@compiled")
    _replace(package / "kernel.py", '"""Scale."""', '"""Scale by a factor."""')
    _replace(package / "kernel.py", "41", "42")
    _replace(package / "left.py", "    for _", "    # Again and again.\n    for _")
    assert _run(tree, cache) == (BOTH_LOADED, "")


def test_what_is_kept_is_machine_code_without_the_code_that_it_was_made_of(
    tree: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(tree))
    folder = cache / "polycnc" / "compiled"
    for path in sorted(folder.glob("*.nbc")):
        data = Files(folder).read(path.stem)
        assert data is not None
        (_, kind, (machine_code, module)), *_ = pickle.loads(data)
        assert kind == "object"
        assert machine_code.startswith(b"\x7fELF") == (sys.platform == "linux")
        functions = list(llvmlite.binding.parse_bitcode(module).functions)
        assert any("run" in each.name for each in functions)
        code = [
            str(step).strip() for each in functions for block in each.blocks for step in block.instructions
        ]
        assert code == ["ret void"] * len(functions)


def test_a_line_of_one_core_compiles_that_core(tree: Path, cache: Path) -> None:
    _replace(tree / "twocores" / "right.py", "0.25", "0.5")
    assert _run(tree, cache) == ("left loaded 22.75\nright compiled 23.0\n", "")


def test_a_constant_that_both_reach_compiles_both_and_the_old_ones_are_kept(tree: Path, cache: Path) -> None:
    _replace(tree / "twocores" / "kernel.py", "FACTOR = 3", "FACTOR = 7")
    assert _run(tree, cache) == ("left compiled 52.75\nright compiled 52.75\n", "")
    _replace(tree / "twocores" / "kernel.py", "FACTOR = 7", "FACTOR = 3")
    assert _run(tree, cache) == (BOTH_LOADED, "")


@pytest.mark.parametrize("damages", [("cut", "empty"), ("garbage", "strange")])
def test_a_damaged_file_is_compiled_anew_with_one_remark(
    tree: Path, cache: Path, damages: tuple[str, str]
) -> None:
    kept = sorted((cache / "polycnc" / "compiled").glob("*.nbc"))
    assert [path.name.partition("-")[0] for path in kept] == ["twocores.left.run", "twocores.right.run"]
    for path, damage in zip(kept, damages, strict=True):
        content = path.read_bytes()
        if damage == "strange":  # whole, but not a compiled function
            Files(path.parent).write(path.stem, "twocores", b"\x80\x05K\x07.")
        else:
            path.write_bytes({"cut": content[:-9], "garbage": b"garbage" * 99, "empty": b""}[damage])
    said, remarks = _run(tree, cache)
    assert said == BOTH_COMPILED
    assert remarks.count("\n") == 1
    assert "compiled anew" in remarks
    assert _run(tree, cache) == (BOTH_LOADED, "")


def test_a_cache_that_cannot_be_written_means_compiling_with_one_remark(tree: Path, tmp_path: Path) -> None:
    (tmp_path / "cache").write_text("a file where a folder should be")
    said, remarks = _run(tree, tmp_path / "cache")
    assert said == BOTH_COMPILED
    assert remarks.count("\n") == 1
    assert "cannot be written" in remarks
    assert "POLYCNC_CACHE_DIR" in remarks


def test_processes_that_start_at_once_compile_once(tree: Path, tmp_path: Path) -> None:
    started = [_start(tree, tmp_path / "cold") for _ in range(3)]
    said = [_end(each) for each in started]
    assert [remarks for _, remarks in said] == ["", "", ""]
    assert [sum(f"{side} compiled" in text for text, _ in said) for side in ("left", "right")] == [1, 1]


def test_opening_the_internals_compiles_no_entry_again(tree: Path, cache: Path) -> None:
    opened = _end(_start(tree, cache, POLYCNC_OPEN_INTERNALS="1"))
    assert opened == (BOTH_LOADED, "")


def test_what_came_with_the_package_is_loaded_and_not_kept_again(
    tree: Path, tmp_path: Path, compiled_once: tuple[Path, Path]
) -> None:
    package = shutil.copytree(
        Path(polycnc.__file__).parent / "jit",
        tmp_path / "site" / "polycnc" / "jit",
        copy_function=shutil.copyfile,
    ).parent
    (package / "__init__.py").touch()
    site = str(package.parent)
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "PYTHONPATH": site}
    assert _end(_start(tree, tmp_path / "made", **generic)) == (BOTH_COMPILED, "")
    shutil.move(tmp_path / "made" / "polycnc" / "compiled", package / "_compiled")
    assert _end(_start(tree, tmp_path / "kept", PYTHONPATH=site)) == (BOTH_LOADED, "")
    assert not (tmp_path / "kept").exists()


def test_old_versions_are_swept_and_what_was_used_last_stays(tmp_path: Path) -> None:
    files = Files(tmp_path)
    for number in range(24):
        files.write(f"some.run-{number:02}", "some.run", b"content")
        os.utime(tmp_path / f"some.run-{number:02}.nbc", (1000 + number, 1000 + number))
    files.write("some.run_more-1", "some.run_more", b"another")
    assert files.read("some.run-00") == b"content"
    files.write("some.run-24", "some.run", b"content")
    left = {path.stem for path in tmp_path.glob("*.nbc")}
    assert left == {"some.run_more-1", *(f"some.run-{number:02}" for number in range(25) if number != 1)}


def test_the_remark_of_a_folder_is_made_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "file").touch()
    files = Files(tmp_path / "file" / "folder")
    with caplog.at_level(logging.WARNING, "polycnc"):
        files.write("a-1", "a", b"content")
        files.lock("a-1").release()
    assert len(caplog.records) == 1
    assert files.read("a-1") is None
    assert FILES.read("no such stem") is None


def test_every_entry_of_the_package_has_a_content_that_can_be_told() -> None:
    for each in pkgutil.walk_packages(polycnc.__path__, "polycnc."):
        if not each.name.startswith(("polycnc.cli", "polycnc.__main__")):
            importlib.import_module(each.name)
    names = {version.rpartition("-")[0].rpartition(".")[2] for version in versions()}
    assert names >= {"advance", "run_plain", "run_scans", "run_cycles", "scan_edges"}


def test_what_cannot_be_told_is_refused() -> None:
    namespace: dict[str, object] = {"__name__": "polycnc.example", "THING": object()}
    exec("def odd(x):\n    return x if THING else 0\n", namespace)  # a value that numba could not take either
    odd = compiled(cast("Callable[[int], int]", namespace["odd"]))
    with pytest.raises(NotKnownError, match="cannot be told"):
        Fingerprints().of(odd)


def test_a_constant_named_by_its_module_counts() -> None:
    addresses = ModuleType("polycnc.example_addresses")
    namespace: dict[str, object] = {"__name__": "polycnc.example", "addr": addresses}
    exec("def moved(x):\n    return x + addr.BASE\n", namespace)

    def digest(base: int, other: int) -> str:
        vars(addresses).update(BASE=base, OTHER=other)
        return Fingerprints().of(compiled(cast("Callable[[int], int]", namespace["moved"])))

    assert digest(17, 2) == digest(17, 3)
    assert digest(17, 2) != digest(18, 2)
