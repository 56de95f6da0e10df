"""What is delivered: sdist and wheel, the steps of the image, the workflow that the how-to prints."""

from __future__ import annotations

import hashlib
import importlib
import re
import runpy
import shutil
import subprocess
import sys
import tarfile
from importlib import util
from pathlib import Path
from typing import Any

import pytest

import polycnc
from polycnc.cnc import Control
from polycnc.controllers.apci import Board
from polycnc.controllers.bosch import Pnc
from polycnc.controllers.fanuc import PowerMate
from polycnc.controllers.imc import Card
from support.command import environment
from support.pages import fences

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Build sdist and wheel as for a release, without a network."""
    for tool in ("build", "hatchling", "twine", "check_wheel_contents"):
        if util.find_spec(tool) is None:
            pytest.skip(f"no {tool}: pip install '.[test]'")
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(REPOSITORY)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return sorted(folder.iterdir())


def _tool(name: str) -> str:
    return shutil.which(name, path=str(Path(sys.executable).parent)) or name


def test_sdist_and_wheel_pass_the_checks_of_the_index(built: list[Path]) -> None:
    assert [path.suffix for path in built] == [".whl", ".gz"]
    both, wheel = [str(path) for path in built], str(built[0])
    for tool, *rest in (["twine", "check", "--strict", *both], ["check-wheel-contents", wheel]):
        done = subprocess.run([_tool(tool), *rest], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def test_the_wheel_has_everything_that_is_no_code(built: list[Path]) -> None:
    from zipfile import ZipFile

    names = set(ZipFile(built[0]).namelist())
    source = REPOSITORY / "src"
    wanted = {
        path.relative_to(source).as_posix()
        for path in source.rglob("*")
        if path.is_file() and path.suffix not in (".pyc", ".nbc")
    }
    assert wanted - names == set()
    assert "polycnc/conformance/data/not_applicable.toml" in names


def test_the_package_lists_its_public_names_alone() -> None:
    assert {name for name in dir(polycnc) if not name.startswith("__")} == set(polycnc.__all__)
    assert "__version__" in dir(polycnc)


@pytest.mark.parametrize("package", ["cnc", "machine", "runner", "nc.macro", "servers.focas"])
def test_a_package_shows_its_public_names_and_no_others(package: str) -> None:
    module = importlib.import_module(f"polycnc.{package}")
    assert {name for name in dir(module) if not name.startswith("__")} == set(module.__all__)


def test_devices_say_what_they_are_and_what_they_do(tmp_path: Path) -> None:
    pnc = Pnc(tmp_path)
    try:
        assert repr(pnc) == f"<Pnc in {tmp_path.resolve()}: <Control of mill3: auto, ready, 0.000 s>>"
    finally:
        pnc.close()
    control = Control("mill3")
    control.programs.create("P", "G1 X10 F600\nM30\n")
    control.select_program("P")
    control.cycle_start()
    control.advance(500)
    assert repr(control) == "<Control of mill3: auto, active, 0.500 s>"
    assert repr(PowerMate(2, "D")) == "<Power Mate-D, 2 axes: MEM, 0.000 s>"
    assert repr(Board()) == "<Board of 3 axes: 0.000 s>"
    assert repr(Card()) == "<Card of 4 axes: 0.000 s>"


PLUGIN_CONFTEST = """
import sys

def pytest_collection_finish():
    print("loaded:", *sorted(name for name in sys.modules if name.startswith(("polycnc", "numba", "numpy"))))
"""
PLUGIN_TEST = """
def test_card(card):
    card.advance(17)
    assert card.axes == 7
"""


def test_pytest_finds_the_plugin_of_the_wheel_and_loads_no_more_than_it_needs(
    built: list[Path], tmp_path: Path
) -> None:
    from zipfile import ZipFile

    ZipFile(built[0]).extractall(tmp_path / "site")
    (tmp_path / "conftest.py").write_text(PLUGIN_CONFTEST, "utf-8")
    (tmp_path / "test_card.py").write_text(PLUGIN_TEST, "utf-8")
    without = [f"-pno:{name}" for name in ("cacheprovider", "schemathesis", "hypothesispytest", "benchmark")]
    command = [sys.executable, "-m", "pytest", "-s", "-W", "error", *without, "test_card.py"]
    surroundings = environment(PYTHONPATH=str(tmp_path / "site"), POLYCNC_COMPILE_AT_ONCE="")
    done = subprocess.run(
        command, cwd=tmp_path, env=surroundings, capture_output=True, text=True, check=False
    )
    assert "loaded: polycnc polycnc.on_demand polycnc.testing\n" in done.stdout, done.stdout + done.stderr
    assert "polycnc: card" in done.stdout
    assert "(17 cycles)" in done.stdout


def test_a_release_lists_its_software_and_its_image_is_made_of_the_source_alone(
    built: list[Path], tmp_path: Path
) -> None:
    release = runpy.run_path(str(REPOSITORY / "scripts" / "_release.py"))
    wheels = [
        {"name": "polycnc", "version": "7.5.3", "license": "MIT"},
        {"name": "NumPy", "version": "2.9", "license_expression": "BSD-3-Clause"},
    ]
    listed = release["software"]({"install": [{"metadata": each} for each in wheels]})
    assert listed["metadata"]["component"]["purl"] == "pkg:pypi/polycnc@7.5.3"
    found = {each["purl"].rpartition("@")[0] for each in listed["components"]}
    assert found >= {"pkg:pypi/numpy", "pkg:npm/three", "pkg:npm/uplot"}
    assert all(each["licenses"] for each in listed["components"])
    context = tmp_path / "image.tgz"
    release["image_context"](built[1], (REPOSITORY / "Dockerfile").read_bytes(), context)
    with tarfile.open(context) as archive:
        names = archive.getnames()
    assert len(names) == len(set(names))
    assert {"Dockerfile", "pyproject.toml", "scripts/_wheel_tag.py", "src/polycnc/__init__.py"} <= set(names)
    (tmp_path / "b.whl").write_bytes(b"seven")
    assert release["checksums"](tmp_path.glob("b.*")) == f"{hashlib.sha256(b'seven').hexdigest()}  b.whl\n"


def test_the_image_is_made_of_steps_that_can_be_done_without_docker() -> None:
    text = (REPOSITORY / "Dockerfile").read_text("utf-8")
    words = [line.split()[0] for line in text.splitlines() if line and not line.startswith("#")]
    known = set(re.findall(r'case "([A-Z]+)"', (REPOSITORY / "scripts" / "_image.py").read_text("utf-8")))
    assert set(words) == known
    assert words.index("RUN") < words.index("USER")
    extras = re.findall(r"/src\[([\w,]+)\]", text)[0].split(",")
    declared = re.findall(r"^(\w+) = \[", (REPOSITORY / "pyproject.toml").read_text("utf-8"), re.MULTILINE)
    assert set(extras) <= set(declared)


def test_the_workflow_of_the_how_to_installs_what_its_reader_has_made(tmp_path: Path) -> None:
    yaml: Any = pytest.importorskip("yaml")
    page = REPOSITORY / "docs" / "how-to" / "check-programs-in-ci.md"
    (workflow,) = (fence.text for fence in fences(page) if fence.language == "yaml" and "jobs:" in fence.text)
    steps = yaml.safe_load(workflow)["jobs"]["programs"]["steps"]
    (built,) = (each.text for each in fences(page) if each.text.startswith("pip wheel"))
    assert built.split()[:4] == ["pip", "wheel", "--no-deps", "-w"]
    assert built.split()[4].rpartition("/")[2] == "wheels"
    checked_out = []
    ran = []
    (tmp_path / "parts").mkdir()
    shutil.copy(REPOSITORY / "examples" / "bracket.nc", tmp_path / "parts" / "a.nc")
    shutil.copy(REPOSITORY / "examples" / "my_machine.toml", tmp_path / "shop.toml")
    for step in steps:
        if step.get("uses", "").startswith("actions/checkout"):
            checked_out.append(step.get("with"))
        run = step.get("run", "")
        if run.startswith("pip install"):
            assert run == "pip install wheels/polycnc-*.whl"
            assert checked_out == [None]  # the reader's own repository, nobody else's
        elif run:
            command = run.replace("polycnc ", f"{sys.executable} -m polycnc.cli ", 1)
            done = subprocess.run(
                command, shell=True, cwd=tmp_path, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, done.stdout + done.stderr
            ran.append(run)
    assert ran == ["polycnc check --machine shop.toml parts/*.nc"]
