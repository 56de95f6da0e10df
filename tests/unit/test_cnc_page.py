"""The reference page of the control: everything public of it is there, with what it refuses."""

from __future__ import annotations

import inspect
import re
import runpy
from collections.abc import Callable
from pathlib import Path

import pytest

from polycnc.cnc import AxisStatus, ChannelStatus, Control, ControlError, Mode, Refusal, Status

REPOSITORY = Path(__file__).resolve().parents[2]
PAGE = runpy.run_path(str(REPOSITORY / "scripts" / "_control_page.py"))["page"]()
SECTIONS = dict(re.findall(r"^### (\w+)\n(.*?)(?=^##|\Z)", PAGE, re.MULTILINE | re.DOTALL))
COMMANDS = [name for name, each in vars(Control).items() if inspect.isfunction(each) and name[0] != "_"]


@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_has_its_arguments_and_its_line(name: str) -> None:
    function = getattr(Control, name)
    assert all(
        f"{each}: " in SECTIONS[name] for each in inspect.signature(function).parameters if each != "self"
    )
    assert (inspect.getdoc(function) or "nothing").partition("\n")[0] in SECTIONS[name]


def test_everything_a_control_has_is_on_the_page() -> None:
    made = Control("mill3")
    attributes = {*vars(made), *(name for name, each in vars(Control).items() if isinstance(each, property))}
    assert [name for name in attributes if name[0] != "_" and f"| `{name}` |" not in PAGE] == []


@pytest.mark.parametrize("row", [Status, ChannelStatus, AxisStatus])
def test_every_field_of_a_status_is_on_the_page(row: type[Status]) -> None:
    assert [name for name in row._fields if f"| `{name}` |" not in SECTIONS[row.__name__]] == []


def test_every_reason_is_explained() -> None:
    for reason in Refusal:
        assert re.search(rf"^\| `{reason.name}` \| `{reason.value}` \| \w.* \|$", PAGE, re.MULTILINE), reason


def test_what_the_page_says_is_refused_is_refused() -> None:
    made = Control("mill3")
    refused: dict[str, Callable[[], object]] = {
        "set_mdi": lambda: made.set_mdi("G0 X1"),  # not in MDI
        "jog": lambda: made.jog("X", 1),  # not in JOG
        "feed_hold": made.feed_hold,  # nothing moves
        "select_program": lambda: made.select_program("none"),
        "edit": lambda: made.edit("none"),
    }
    for name, call in refused.items():
        assert "\nRefused: " in SECTIONS[name]
        with pytest.raises(ControlError):
            call()
    made.select_mode(Mode.JOG)
    with pytest.raises(ControlError):
        made.jog("Q", 1)
    assert "No such axis or direction" in SECTIONS["jog"]
