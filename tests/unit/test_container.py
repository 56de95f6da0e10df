"""The image and the plant made of it, without docker: what is in its context, its paths, users, ports and commands."""

from __future__ import annotations

import asyncio
import fnmatch
import re
import runpy
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest

from polycnc.servers.machines import Wanted
from polycnc.servers.process import DOORS, Machinery
from polycnc.servers.setup import Flags, plan_of
from support.http_app import served_machine

pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")
yaml: Any = pytest.importorskip("yaml", reason="pip install 'polycnc[yaml]'")

REPOSITORY = Path(__file__).parents[2]
FOLDER = REPOSITORY / "examples" / "containers"
STEPS = [
    (word, rest)
    for line in (REPOSITORY / "Dockerfile").read_text("utf-8").splitlines()
    if line and not line.startswith("#")
    for word, _, rest in (line.partition(" "),)
]


def ports_of(text: str) -> set[int]:
    """Return the ports of `7878-7880 8080`."""
    spans = [[int(each) for each in part.split("-")] for part in text.split()]
    return {port for span in spans for port in range(span[0], span[-1] + 1)}


def step(word: str) -> str:
    """Return what stands after the only instruction of a kind."""
    (rest,) = (rest for each, rest in STEPS if each == word)
    return rest


def test_the_context_has_what_is_installed_and_nothing_of_this_computer() -> None:
    left_out = (REPOSITORY / ".dockerignore").read_text("utf-8").split()
    kept = {
        each.name for each in REPOSITORY.iterdir()
        if not any(fnmatch.fnmatch(each.name, pattern) for pattern in left_out)
    }  # fmt: skip
    project = (REPOSITORY / "pyproject.toml").read_text("utf-8")
    readme = re.findall(r'^readme = "([^"]+)"', project, re.M)
    assert {"pyproject.toml", "src", "LICENSE", *readme} <= kept
    assert not kept & {".git", ".venv", ".hypothesis", ".pytest_cache", ".mypy_cache", ".ruff_cache", "dist"}
    assert step("COPY").split() == [".", "/src"]


def test_the_image_serves_as_any_user_with_all_systems_compiled() -> None:
    runs = [rest for word, rest in STEPS if word == "RUN"]
    words = [word for word, _ in STEPS]
    work = step("WORKDIR")
    assert any("polycnc warmup all" in each and "chmod -R a+rX /opt/polycnc-cache" in each for each in runs)
    assert f"mkdir -p {work} && chmod 1777 {work}" in runs, "whoever runs it can write there"
    assert (
        max(at for at, word in enumerate(words) if word == "RUN")
        < words.index("USER")
        < words.index("WORKDIR")
    )
    assert re.fullmatch(r"[1-9]\d*:[1-9]\d*", step("USER")), "by number, and not root"
    assert {row.port for row in DOORS.values()} <= ports_of(step("EXPOSE"))
    extras = set(re.findall(r"/src\[([\w,]+)\]", runs[0])[0].split(","))
    assert {"serve", "opcua"} <= extras


def test_the_plant_of_the_compose_file_can_be_served(tmp_path: Path) -> None:
    """Its file, its command and its places are those of the image; nothing is written beside `/work` and `/tmp`."""
    compose = yaml.safe_load((FOLDER / "compose.yaml").read_text("utf-8"))
    plant, collector = (compose["services"][name] for name in ("plant", "collector"))
    assert (FOLDER / plant["build"]).resolve() == REPOSITORY
    assert plant["image"] == collector["image"]
    for service in (plant, collector):
        assert re.fullmatch(r"[1-9]\d*:[1-9]\d*", service["user"])
        assert service["read_only"]
        assert ".:/plant:ro" in service["volumes"]
    assert f"memory:{step('WORKDIR')}" in plant["volumes"]
    assert "memory" in compose["volumes"]
    assert (FOLDER / Path(collector["entrypoint"][-1]).relative_to("/plant")).is_file()
    shutil.copytree(FOLDER, tmp_path / "plant")
    command, file, *options = shlex.split(plant["command"])
    here = tmp_path / "plant" / Path(file).relative_to("/plant")
    assert command == "serve"
    given = dict(zip(options[::2], options[1::2], strict=True))
    assert set(given) == {"--expose", "--insecure", "--token"}
    kinds = dict.fromkeys(("fanuc", "plain", "bosch", "apci", "imc"))
    plan = plan_of(Flags(here, kinds))
    assert {each.machinery.memory.parent for each in plan.machines if each.machinery.memory} == {
        Path("/work")
    }
    doors = [(row, port) for machine in (*plan.machines,) for row, port in machine.doors] + list(plan.shared)
    published = {
        port for each in plant["ports"] for port in ports_of(each.split(":")[-1])
    }  # fmt: skip
    assert published == {wanted.port for _, wanted in doors}
    assert published <= ports_of(step("EXPOSE"))
    open_ones = {row.name for row, _ in doors if not row.knows_token}
    assert open_ones == set(given["--insecure"].split(","))
    asked = re.findall(r"127\.0\.0\.1:(\d+)", plant["healthcheck"]["test"][-1])
    assert {int(each) for each in asked} <= published
    assert all(f":{port}" in collector["command"][0] for port in asked)


def test_the_collector_of_the_compose_file_reads_a_machine(capsys: pytest.CaptureFixture[str]) -> None:
    collect = runpy.run_path(str(FOLDER / "collect.py"))["collect"]

    async def run() -> None:
        machine = served_machine("plain", Machinery("m", "mill3"))
        door = DOORS["mtconnect"].open_door([machine], Wanted(port=0))
        await door.start()
        try:
            await asyncio.to_thread(collect, door.said, 2, 0.0)
        finally:
            await door.close()
            machine.close()

    asyncio.run(run())
    assert capsys.readouterr().out == "machine,execution,program,parts\nm,READY,UNAVAILABLE,0\n"
