"""Everything that README, docs/ and examples/ show runs, prints what they say, and links to what exists."""

from __future__ import annotations

import inspect
import re
import shutil
from pathlib import Path

import pytest

import polycnc
from polycnc.conformance import load_conformance
from support.command import python
from support.pages import PAGES, REPOSITORY, run_page, steps

EXAMPLES = REPOSITORY / "examples"
MACHINES = {"lathe_shaft": "lathe2", "five_axis": "mill5"}
NO_TOOLS = "the machine has no tool table: lengths and radii of all tools are 0 mm"
_LINK = re.compile(r"\[[^]]*\]\(([^)\s]+)\)")


def _name(page: Path) -> str:
    return str(page.relative_to(REPOSITORY))


# Pages that need a server, or change polycnc itself, run by a test of their own.
ELSEWHERE = {
    "docs/tutorials/a-machine-for-your-collector.md",
    "docs/tutorials/a-machine-with-a-page.md",
    "docs/tutorials/a-machine-with-seven-doors.md",
    "docs/tutorials/test-your-collector.md",
    "docs/tutorials/your-old-program.md",
    "docs/tutorials/your-sender.md",
    "docs/how-to/read-a-machine-with-your-agent.md",
    "docs/how-to/run-a-fleet.md",
    "docs/how-to/add-a-g-code.md",
    "docs/how-to/add-a-cpl-function.md",
    "docs/how-to/add-a-library-function.md",
    "docs/how-to/add-a-dialect.md",
    "docs/how-to/add-a-planner-rule.md",
    "docs/how-to/add-a-controller.md",
}


def _runs_something(page: Path) -> bool:
    return _name(page) not in ELSEWHERE and any(step.kind != "file" for step in steps(page))


@pytest.mark.parametrize("page", [page for page in PAGES if _runs_something(page)], ids=_name)
def test_what_a_page_shows_runs(page: Path, tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES, tmp_path / "examples")
    run_page(page, tmp_path)


def test_readme_and_tutorial_have_something_to_run() -> None:
    running = {_name(page) for page in PAGES if _runs_something(page)}
    assert {"docs/tutorials/a-bad-day-at-the-plant.md"} <= running
    assert {"README.md", "docs/tutorials/first-program.md", "docs/reference/command-line.md"} <= running


@pytest.mark.parametrize("program", sorted(EXAMPLES.glob("*.nc")), ids=lambda path: path.stem)
def test_example_programs_run_clean_and_keep_the_limits(program: Path) -> None:
    machine = polycnc.load_machine(MACHINES.get(program.stem, "mill3"))
    result = polycnc.run(program, machine, trace=True)
    assert result.ok
    assert {message.text for message in result.messages if "counted 0 s" not in message.text} <= {NO_TOOLS}
    assert 10.0 < result.time_s < 600.0
    assert result.trace is not None
    assert polycnc.verify_trace(result.trace, machine) == []
    assert polycnc.check(program, machine) == []


def test_bracket_runs_on_the_example_machine_too() -> None:
    machine = polycnc.load_machine(EXAMPLES / "my_machine.toml")
    result = polycnc.run(EXAMPLES / "bracket.nc", machine, trace=True, servo=True)
    assert result.trace is not None
    assert polycnc.verify_trace(result.trace, machine) == []
    # Zero of the part is the work offset; three tool changes, and the spindle starts or stops four times.
    assert result.end_position_mm == {"X": 120.0, "Y": 100.0, "Z": -100.0}
    assert result.waiting_time_s == pytest.approx(3 * 8.0 + 4 * 2.0)
    assert result.trace.actual is not None
    lag = abs(result.trace.setpoint - result.trace.actual).max()
    assert 0.0 < lag < 3.0


SCRIPTS = {  # each example script: what it says, what it draws
    "run_and_plot.py": ("82 blocks take 109.321 s", "bracket.png"),
    "apci_session.py": ("stopped at 151.41 mm by the limit: True\nrecovered: True", "apci_session.png"),
    "imc_session.py": (
        "paused 2476 pulses up the slot\nemergency stop, axis 1 in run: False\nrecovered: True",
        "imc_session.png",
    ),
}


def test_every_example_script_is_known() -> None:
    assert {path.name for path in EXAMPLES.glob("*.py")} == set(SCRIPTS)


@pytest.mark.parametrize("script", SCRIPTS)
def test_example_script_runs(script: str, tmp_path: Path) -> None:
    said, drawn = SCRIPTS[script]
    assert said in python(EXAMPLES / script, cwd=tmp_path).stdout
    assert (tmp_path / drawn).stat().st_size > 10_000


@pytest.mark.parametrize("page", PAGES, ids=_name)
def test_links_lead_somewhere(page: Path) -> None:
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for link in _LINK.findall(text):
        if "://" in link or link.startswith("mailto:"):
            continue
        target, _, anchor = link.partition("#")
        path = (page.parent / target).resolve() if target else page
        assert path.exists(), f"{_name(page)} links to {link}"
        if anchor and path.suffix == ".md":
            assert anchor in _anchors(path), f"{_name(page)} links to {link}"


def _anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def test_every_page_is_in_the_navigation() -> None:
    named = set(re.findall(r"[\w/.-]+\.md", (REPOSITORY / "mkdocs.yml").read_text(encoding="utf-8")))
    pages = {str(page.relative_to(REPOSITORY / "docs")) for page in REPOSITORY.glob("docs/**/*.md")}
    assert named == pages


def test_library_page_names_everything_public() -> None:
    text = (REPOSITORY / "docs" / "reference" / "library.md").read_text(encoding="utf-8")
    missing = [name for name in polycnc.__all__ if f"`{name}" not in text]
    assert missing == []


@pytest.mark.parametrize(
    "name", [name for name in polycnc.__all__ if inspect.isfunction(getattr(polycnc, name))]
)
def test_library_page_has_every_function_as_it_is_called(name: str) -> None:
    text = (REPOSITORY / "docs" / "reference" / "library.md").read_text(encoding="utf-8")
    whole = inspect.signature(getattr(polycnc, name))
    bare = whole.replace(
        parameters=[each.replace(annotation=inspect.Parameter.empty) for each in whole.parameters.values()],
        return_annotation=inspect.Signature.empty,
    )
    assert f"### `{name}{bare}`" in text
    section = text.partition(f"### `{name}")[2].partition("\n")[2].partition("\n#")[0]
    obvious = {
        "a",
        "b",
        "path",
        "paths",
        "source",
        "trace",
        "result",
        "program",
        "machine",
        "dialect",
        "machine_b",
        "dialect_b",
    }
    unsaid = [each for each in whole.parameters if each not in obvious and f"`{each}`" not in section]
    assert unsaid == []


def test_result_page_names_every_field() -> None:
    text = (REPOSITORY / "docs" / "reference" / "result-and-trace.md").read_text(encoding="utf-8")
    result = polycnc.run("G1 X1 F100\n", trace=True)
    missing = [name for name in result.as_dict() if f"`{name}`" not in text]
    assert missing == []
    assert [name for name in polycnc.Trace.__dataclass_fields__ if f"`{name}`" not in text] == []
    assert [name for name in polycnc.Alarm.__dataclass_fields__ if f"`{name}`" not in text] == ["error"]


def test_readme_counts_the_rows_of_the_manuals() -> None:
    rows = load_conformance().total().rows
    assert f"{rows:,} statements" in (REPOSITORY / "README.md").read_text(encoding="utf-8")


def test_the_picture_is_small_and_no_page_names_this_machine() -> None:
    assert (REPOSITORY / "docs" / "images" / "demo.png").stat().st_size <= 300_000
    for page in [*PAGES, *EXAMPLES.iterdir()]:
        if page.is_file():
            text = page.read_text(encoding="utf-8")
            assert str(REPOSITORY) not in text, page
