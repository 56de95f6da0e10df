"""Scenarios: triggers, actions and ends at their cycles, however time is cut; ten bad days give the same bits twice."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import pytest

from polycnc.errors import UsageError
from polycnc.machine import Wall
from polycnc.servers.machines import Keeper, ServedDevice, ServedMachine, Treatment
from polycnc.servers.process import KINDS, Machinery, rehearse
from polycnc.servers.scenarios import ACTIONS, Script, Story, load_script

R = TypeVar("R")
EXAMPLES = Path(__file__).parents[2] / "examples" / "scenarios"
PROGRAM = b"O0012\nN10 G90 G1 F2400 X40 S820 M3\nN20 Y31\nN30 X3\nN40 Y0\nM30\n"


class Still(Wall):
    """A wall clock that does not move."""

    def now_s(self) -> float:
        return 0.0


def with_machine(kind: str, visit: Callable[[ServedMachine], R], *, runs: bool = True) -> R:
    """Visit a machine that is served; with `runs` it runs a program again and again."""

    async def run() -> R:
        made = KINDS[kind](Machinery("m", None if kind != "plain" else "mill3"))
        served: ServedDevice[Any] = ServedDevice(made.device, made.find_control)
        keeper = Keeper(served, Still())
        made.programs = None  # those of its memory as they come
        machine = ServedMachine(**made.all(), name="m", kind=kind, served=served, keeper=keeper)
        try:
            control = machine.control
            assert control is not None
            assert machine.programs is not None
            machine.programs.put("O0012", PROGRAM)
            select = made.own.get("select_program", control.select_program)
            select(program="O0012", channel=0)
            own = made.own.get("cycle_start")

            def again() -> None:
                if own is None:
                    control.cycle_start()
                else:
                    own(step="run", line=1, channel=0)

            if runs:
                served.again = again
                again()
            return visit(machine)
        finally:
            machine.close()

    return asyncio.run(run())


def story_of(machine: ServedMachine, *steps: dict[str, Any]) -> Story:
    """Let a machine follow these steps."""
    story = Story(Script.model_validate({"step": tuple(steps)}, strict=False), machine)
    machine.served.scenario = story
    story.look(machine.device)
    return story


def told(story: Story) -> list[tuple[int, str, str]]:
    return [(each.cycle, each.step, each.what) for each in story.happened]


def test_a_step_begins_and_ends_in_its_very_cycle_and_follows_another_one() -> None:
    def visit(machine: ServedMachine) -> None:
        story = story_of(
            machine,
            {"name": "slow", "at_s": 0.217, "do": "set_overrides", "with": {"feed": 0.4}, "for_s": 0.133},
            {
                "name": "note",
                "after": "slow",
                "at_s": 0.05,
                "do": "message",
                "with": {"number": 3, "text": "x"},
            },
        )
        machine.served.advance(1000)
        assert told(story) == [(217, "slow", "began"), (267, "note", "began"), (350, "slow", "ended")]
        control = machine.control
        assert control is not None
        assert control.overrides.feed == 1.0
        assert control.status().messages[0].text == "x"

    with_machine("plain", visit)


def test_repeats_come_at_their_distance_and_no_more_often() -> None:
    def visit(machine: ServedMachine) -> None:
        story = story_of(machine, {"name": "part", "at_s": 0.03, "do": "part", "times": 4, "every_s": 0.125})
        machine.served.advance(2000)
        assert [each[0] for each in told(story)] == [30, 155, 280, 405]
        control = machine.control
        assert control is not None
        assert control.status().parts.made >= 4

    with_machine("plain", visit)


def test_a_condition_and_a_line_begin_a_step() -> None:
    def visit(machine: ServedMachine) -> None:
        story = story_of(
            machine,
            {"name": "far", "when": {"value": "axes.X.machine", "above": 20.0}, "do": "part"},
            {"name": "third", "at_line": 3, "program": "O0012", "do": "part"},
            {"name": "other", "at_line": 3, "program": "O0099", "do": "part"},
        )
        control = machine.control
        assert control is not None
        seen: dict[str, tuple[float, Any]] = {}
        for _ in range(300):
            machine.served.advance(10)
            for each in story.happened:
                status = control.status()
                block = status.channel.block
                seen.setdefault(each.step, (status.axes["X"].machine, block and block.line))
        assert set(seen) == {"far", "third"}
        assert 20.0 < seen["far"][0] < 23.0  # found within 20 cycles at 40 mm/s
        assert seen["third"][1] == 3

    with_machine("plain", visit)


def test_requests_begin_and_end_steps_and_tell_the_door_what_to_do() -> None:
    def visit(machine: ServedMachine) -> None:
        story_of(
            machine,
            {"name": "lost", "at_request": 3, "door": "opcua", "do": "drop", "for_requests": 2},
            {"name": "late", "at_request": 2, "door": "opcua", "do": "latency", "with": {"delay_s": 0.4}},
            {"name": "other", "at_request": 1, "door": "focas", "do": "drop"},
        )
        treated = [machine.treat("opcua") for _ in range(6)]
        assert [each.drop for each in treated] == [False, False, True, True, False, False]
        assert [each.delay_s for each in treated] == [0.0, 0.4, 0.4, 0.4, 0.4, 0.4]

    with_machine("plain", visit)


def test_the_end_of_a_hold_starts_nothing_that_is_not_held() -> None:
    def visit(machine: ServedMachine) -> None:
        story = story_of(
            machine,
            {"name": "operator", "at_s": 0.1, "do": "feed_hold", "for_s": 0.9},
            {"name": "reset", "at_s": 0.6, "do": "reset"},
        )
        machine.served.again = None
        machine.served.advance(1500)
        assert [each[2] for each in told(story)] == ["began", "began", "ended"]
        control = machine.control
        assert control is not None
        assert not control.channels[0].active

    with_machine("plain", visit)


def test_what_the_control_refuses_is_told_and_the_rest_goes_on() -> None:
    def visit(machine: ServedMachine) -> None:
        story = story_of(
            machine,
            {"name": "jog", "at_s": 0.1, "do": "select_mode", "with": {"mode": "jog"}},
            {"name": "part", "at_s": 0.2, "do": "part"},
        )
        machine.served.advance(300)
        (_, jog, why), part = told(story)
        assert jog == "jog"
        assert why.startswith("refused: ")
        assert part == (200, "part", "began")

    with_machine("plain", visit)


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"do": "fly"}, "nothing is called 'fly'"),
    ({"do": "set_overrides", "with": {"feed": 50.0}}, "feed: "),
    ({"do": "set_overrides", "with": {"speed": 0.5}}, "speed: "),
    ({"do": "alarm", "with": {"number": 9}}, "this control has no alarm 9"),
    ({"do": "alarm", "with": {"axis": "Q"}}, "there is no axis Q"),
    ({"do": "drop"}, "drop happens to a door"),
    ({"do": "drop", "door": "ftp"}, "requests of the door 'ftp' are not counted"),
    ({"do": "half", "door": "opcua"}, "half does not happen to opcua"),
    ({"do": "latency", "door": "opcua"}, ""),
    ({"do": "part", "for_s": 1.0}, "part has no end"),
    ({"do": "input", "with": {"point": "I99"}}, "there is no I/O point 'I99'"),
    ({"do": "power_cut"}, "a power cut is for a fanuc"),
    (
        {"do": "part", "at_s": None, "when": {"value": "axes.Q.machine", "above": 1.0}},
        "the status has no value",
    ),
    ({"do": "part", "at_s": None, "when": {"value": "__class__", "above": 1.0}}, "the status has no value"),
]


def test_what_cannot_be_is_refused_before_anything_happens() -> None:
    def visit(machine: ServedMachine) -> None:
        control = machine.control
        assert control is not None
        before = repr(control.status())
        for step, said in REFUSED:
            with pytest.raises(UsageError) as refused:
                story_of(machine, {"name": "a", "at_s": 1.0, **step})
            assert str(refused.value).startswith(f"step 'a': {said}")
            assert machine.treat("opcua") == Treatment()
            assert repr(control.status()) == before

    with_machine("plain", visit, runs=False)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "add the line [[step]]"), ('[[step]]\nname="a"\ndo="part"\n', "begins at one of"),
        ('[[step]]\nname="a"\ndo="part"\nat_s=1.0\nat_line=3\n', "begins at one of"),
        ('[[step]]\nname="a"\ndo="part"\nat_s=1.0\nwhat=3\n', "what"),
        ('[[step]]\nname="a"\ndo="part"\nat_s=1.0\ntimes=3\n', "`times` and `every_s`"),
        ('[[step]]\nname="a"\ndo="part"\nat_s=1.0\nafter="b"\n', "day.toml:5:1: step a: no step before it is called b"),
        ('[[step]]\nname="a"\ndo="part"\nat_s=nan\n', "at_s"),
        ('[[step]]\nname="a"\ndo="part"\nat_request=3\n', "door"),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_meant_is_refused_with_its_place(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "day.toml"
    path.write_text(text)
    with pytest.raises(UsageError) as refused:
        load_script(path)
    assert said in str(refused.value)
    assert "day.toml" in str(refused.value)


def _replay(path: Path, cuts: Callable[[], int]) -> tuple[list[Any], list[Any]]:
    """Return what a machine shows at every 250th cycle of a bad day, and what has happened."""
    script = load_script(path)
    text = path.read_text()
    kind = "fanuc" if "focas" in text or "power_cut" in text else "plain"

    def visit(machine: ServedMachine) -> tuple[list[Any], list[Any]]:
        story = Story(script, machine)
        machine.served.scenario = story
        shown = []
        for look in range(34):
            left = 250
            while left:
                left -= machine.served.advance(min(left, cuts()))
            treatment = machine.treat("focas")
            control = machine.control
            assert control is not None
            if look % 3 == 0:
                shown.append((repr(control.status()), treatment, story.faults.active))
        return shown, told(story)

    return with_machine(kind, visit)


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_bad_day_gives_the_same_bits_however_time_is_cut(path: Path) -> None:
    chosen = random.Random(7)
    first = _replay(path, lambda: 250)
    second = _replay(path, lambda: chosen.randint(1, 90))
    assert first == second
    names = {each.name for each in load_script(path).step}
    assert {step for _, step, _ in first[1]} == names - (
        {"nothing listens"} if path.stem.startswith("network") else set()
    )


def test_the_refusal_that_the_tutorial_shows(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs/tutorials/a-bad-day-at-the-plant.md").read_text(
        encoding="utf-8"
    )
    path = tmp_path / "wrong.toml"
    path.write_text(page.partition('title="wrong.toml"\n')[2].partition("```")[0])
    with pytest.raises(UsageError) as refused:
        rehearse("plain", Machinery(file="mill3"), load_script(path), 0.0)
    assert f"```text\nerror: {refused.value.what}\n{refused.value.hint}\n```" in page


def test_there_are_ten_bad_days_and_the_page_has_every_action() -> None:
    assert len(list(EXAMPLES.glob("*.toml"))) >= 10
    page = (Path(__file__).parents[2] / "docs/reference/scenarios.md").read_text(encoding="utf-8")
    for name in ACTIONS:
        assert f"`{name}`" in page, name
