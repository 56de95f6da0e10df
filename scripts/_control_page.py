"""The reference page of the control as a library: its commands, what they refuse, what its status holds."""

import ast
import inspect
import re
import types
from collections.abc import Iterator
from enum import Enum
from typing import Any, get_type_hints

from polycnc import cnc
from polycnc.cnc import Control
from polycnc.cnc._control_parts import ControlParts
from polycnc.cnc._control_snapshot import Keeping
from polycnc.cnc._manual_commands import ManualCommands
from polycnc.cnc._program_commands import ProgramCommands
from polycnc.cnc._program_edit import ProgramEdits
from polycnc.cnc._settings import Settings

_HEAD = """# A control

<!-- Written by scripts/reference. -->

`polycnc.cnc.Control` is a numerical control without a vendor, on a machine of its own. Its time stands still but in
`advance`, so a test or a program decides when anything happens. A command is carried out or refused whole: a refused
one raises `ControlError` with a `reason`, a text and a `hint`, and nothing has changed.

```python
from polycnc.cnc import Control, ControlError, ControlEvent, Mode

control = Control("mill3")
control.programs.create("PLATE", "G1 X42.5 F3000\\nM30\\n")
try:
    control.cycle_start()
except ControlError as refused:
    print(refused.reason, "-", refused)
control.select_program("PLATE")
control.cycle_start()
while control.status().channel.active:
    control.advance(100_000, until=ControlEvent.RUN_STATE)
print(control.status().axes["X"].machine, control.status().channel.run_state, control.mode is Mode.AUTO)
```

```text title="output"
not_found - no program is selected
Select a program.
42.5 completed True
```

Lengths are in mm, angles in degree, times in s; an override of 1 is 100 %. `channel` counts from 0. Where a command
takes one and gets a number that there is not, it is refused (`data`).
"""
_CARRIED_OUT_BY = (Settings, ProgramCommands, ManualCommands, Keeping)
_PARTS = (
    "machine",
    "clock",
    "channels",
    "programs",
    "tools",
    "offsets",
    "alarms",
    "messages",
    "timers",
    "parts",
)
_MORE_PARTS = ("spindle", "plc", "functions", "manual")
_ROWS = (
    "Status",
    "ChannelStatus",
    "AxisStatus",
    "Feed",
    "ToolInUse",
    "WorkOffset",
    "SpindleState",
    "Handwheel",
)
_WORDS = ("BlockRecord", "ModalWords")
_DATA = ("Alarm", "OperatorMessage", "Parts", "Overrides", "Switches")
_ENUMS = ("Mode", "RunState", "Motion", "Emergency", "Timer", "ControlEvent", "Refusal")


def page() -> str:
    """Return the page."""
    return "\n".join((_HEAD, *_making(), *_attributes(), *_commands(), *_status(), *_words())) + "\n"


def _making() -> Iterator[str]:
    signature = inspect.signature(Control.__init__)
    yield "## Making one\n"
    yield f"```text\nControl({_arguments(signature)})\n```\n"
    yield (inspect.getdoc(Control) or "").split("\n\n")[1].replace("\n", " ") + "\n"


def _attributes() -> Iterator[str]:
    yield "## What it has\n\n| attribute | type | what it is |\n| --- | --- | --- |"
    hints = get_type_hints(ControlParts)
    for name in (*_PARTS, *_MORE_PARTS):
        of = hints[name]
        first = getattr(of, "__args__", (of,))[0]
        yield f"| `{name}` | `{_shown(of)}` | {_first_line(first)} |"
    for name, each in vars(Control).items():
        if isinstance(each, property) and not name.startswith("_"):
            of = inspect.signature(each.fget).return_annotation if each.fget else ""
            yield f"| `{name}` | `{_shown(of)}` | {_first_line(each)} |"


def _commands() -> Iterator[str]:
    yield "\n## Commands and readings"
    for name, each in vars(Control).items():
        if inspect.isfunction(each) and not name.startswith("_"):
            signature = inspect.signature(each)
            returned = _written(signature.return_annotation)
            yield f"\n### {name}\n"
            yield f"```text\n{name}({_arguments(signature)}) -> {returned}\n```\n"
            yield _first_line(each)
            if refused := _refused(name, each):
                yield f"\nRefused: {refused}"


def _refused(name: str, command: Any) -> str:
    """Return what a command refuses, of the docstring of the part that carries it out."""
    if name == "edit":
        return f"In the foreground, no channel is in EDIT. {_raises(ProgramEdits.open)}"
    parts = [getattr(part, name) for part in _CARRIED_OUT_BY if hasattr(part, name)]
    text = " ".join(filter(None, map(_raises, (command, *parts))))
    if found := re.search(r",? or as `ManualMotion\.(\w+)`\.", text):
        same = _raises(getattr(cnc.ManualMotion, found[1]))
        text = f"{text[: found.start()]}. {same}"
    return text


def _raises(function: Any) -> str:
    """Return what the section `Raises:` of a docstring says, without the error's name."""
    _, _, section = (inspect.getdoc(function) or "").partition("Raises:\n")
    text = " ".join(line.strip() for line in section.splitlines())
    return re.sub(r"\b[A-Z]\w+Error: ", "", text)


def _status() -> Iterator[str]:
    yield "\n## Status\n"
    yield "What `status()` returns is frozen, and all of one cycle. `pydantic.TypeAdapter(Status).dump_json` writes it."
    for name in (*_ROWS, *_DATA, *_WORDS):
        of = _named(name)
        fields = of._fields if hasattr(of, "_fields") else of.__dataclass_fields__
        yield f"\n### {name}\n\n{_prose(of)}\n\n| field | type, or what it tells |\n| --- | --- |"
        for field in fields:
            yield f"| `{field}` | `{_shown(of.__annotations__[field])}` |"
        for field, each in vars(of).items():
            if isinstance(each, property):
                yield f"| `{field}` | {_first_line(each)} |"


def _words() -> Iterator[str]:
    yield "\n## Words"
    for name in _ENUMS:
        of = _named(name)
        comments = dict(re.findall(r"^    (\w+) = .*?  # (.*)$", inspect.getsource(of), re.MULTILINE))
        yield f"\n### {name}\n\n{_prose(of)}\n\n| name | value | |\n| --- | --- | --- |"
        for member in of:
            yield f"| `{member.name}` | `{member.value}` | {comments.get(member.name, '')} |"


def _named(name: str) -> Any:
    from polycnc import nc

    return getattr(cnc, name, None) or getattr(nc, name)


def _arguments(signature: inspect.Signature) -> str:
    """Return parameters as they are written in a call, one a line where they are many."""
    parts: list[str] = []
    for each in (each for each in signature.parameters.values() if each.name != "self"):
        if each.kind is each.KEYWORD_ONLY and "*" not in parts:
            parts.append("*")
        default = "" if each.default is each.empty else f" = {_default(each.default)}"
        parts.append(f"{each.name}: {_written(each.annotation)}{default}")
    joined = ", ".join(parts)
    return joined if len(joined) < 90 else "\n    " + ",\n    ".join(parts) + ",\n"


def _default(value: object) -> str:
    if isinstance(value, Enum):
        return f"{type(value).__name__}.{value.name}"
    return "frozenset()" if value == frozenset() else repr(value)


def _shown(annotation: Any) -> str:
    """Return an annotation for a table."""
    return _written(annotation).replace("|", "or")


def _written(annotation: Any) -> str:
    """Return an annotation as it is written, without modules."""
    text = annotation if isinstance(annotation, str) else ""
    if not text:
        plain = isinstance(annotation, type) and not isinstance(annotation, types.GenericAlias)
        text = annotation.__name__ if plain else str(annotation)
    if found := re.fullmatch(r"ForwardRef\((.*?)(, module=.*)?\)", text):
        text = ast.literal_eval(found[1])
    return re.sub(r"\b(?:\w+\.)+(\w+)", r"\1", text)


def _first_line(of: Any) -> str:
    return (inspect.getdoc(of) or "").partition("\n\n")[0].replace("\n", " ").replace("|", "or")


def _prose(of: Any) -> str:
    return (inspect.getdoc(of) or "").partition("\n\nRaises:")[0]
