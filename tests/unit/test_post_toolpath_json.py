"""Tool paths in JSON: every object, its units and lines, and what is refused."""

from __future__ import annotations

import json

import pytest

from polycnc.errors import ProgramError
from polycnc.post import parse_tool_path
from polycnc.post.tool_path import _records as records
from polycnc.post.tool_path._json_path import DOINGS


def read(*doings: object, **more: object) -> list[records.Record]:
    """Return the records after the name of the part."""
    text = json.dumps({**more, "path": doings})
    return list(parse_tool_path(text))[1:]


OBJECTS: list[tuple[dict[str, object], list[records.Record]]] = [
    ({"do": "operation", "name": "rough"}, [records.Path(1, "rough")]),
    (
        {"do": "tool", "number": 3, "name": "D10", "diameter": 10.0, "h": 13},
        [records.ToolShape(1, "D10", 10.0, 0.0), records.Tool(1, 3, "D10", None, 13, None)],
    ),
    ({"do": "spindle", "speed": 1000}, [records.Spindle(1, "cw", 1000.0)]),
    ({"do": "spindle", "sense": "off"}, [records.Spindle(1, "off")]),
    ({"do": "feed", "feed": 0.2, "per_revolution": True}, [records.Feed(1, 0.2, True)]),
    ({"do": "from", "at": [1, 2, 3]}, [records.From(1, 1.0, 2.0, 3.0)]),
    ({"do": "rapid", "to": [1, 2, 3]}, [records.Rapid(1), records.Goto(1, 1.0, 2.0, 3.0)]),
    ({"do": "line", "to": [1, 2, 3], "axis": [0, 0, 2]}, [records.Goto(1, 1.0, 2.0, 3.0, (0.0, 0.0, 1.0))]),
    ({"do": "coolant", "mode": "mist"}, [records.Coolant(1, "mist")]),
    ({"do": "compensation", "side": "left", "d": 4}, [records.Compensation(1, "left", 4)]),
    ({"do": "dwell", "seconds": 1.5}, [records.Dwell(1, 1.5)]),
    ({"do": "stop", "optional": True}, [records.Stop(1, True)]),
    ({"do": "comment", "text": "hello"}, [records.Text(1, "comment", "hello")]),
    ({"do": "insert", "text": "M123"}, [records.Text(1, "insert", "M123")]),
    (
        {
            "do": "cycle",
            "kind": "deep",
            "points": [[1, 2, 3]],
            "depth": 9,
            "clearance": 2,
            "peck": 4,
            "feed": 80,
        },
        [
            records.Cycle(1, "deep", 9.0, 2.0, 2.0, 80.0, False, 4.0),
            records.Goto(1, 1.0, 2.0, 3.0),
            records.CycleOff(1),
        ],
    ),
]


@pytest.mark.parametrize(("doing", "wanted"), OBJECTS, ids=lambda value: str(value)[:40])
def test_an_object(doing: dict[str, object], wanted: list[records.Record]) -> None:
    assert read(doing) == wanted


def test_every_kind_of_object_is_shown_here() -> None:
    shown = {doing["do"] for doing, _ in OBJECTS} | {"arc"}
    kinds = {kind for model in DOINGS for kind in model.model_fields["do"].annotation.__args__}  # type: ignore[union-attr]
    assert kinds == shown
    assert all(model.__doc__ for model in DOINGS)


def test_an_arc_and_its_check() -> None:
    start = {"do": "from", "at": [10, 0, 0]}
    whole = {"do": "arc", "to": [10, 0, -5], "center": [0, 0, 0], "normal": [0, 0, -3], "turns": 2}
    assert read(start, whole)[1] == records.Circle(1, 10.0, 0.0, -5.0, (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), 2)
    with pytest.raises(ProgramError, match="an arc without a start point"):
        read(whole)
    with pytest.raises(ProgramError, match="1 mm off the circle"):
        read(start, {"do": "arc", "to": [0, 11, 0], "center": [0, 0, 0]})


def test_inches_and_the_part() -> None:
    path = parse_tool_path('{"units": "inch", "part": "P", "path": [{"do": "feed", "feed": 10}]}')
    assert list(path) == [records.Text(1, "part", "P"), records.Feed(1, 254.0)]


def test_lines_are_those_of_the_file() -> None:
    text = '{\n "path": [\n  {"do": "stop"}, {"do": "stop"},\n\n  {"do": "comment",\n'
    text += '   "text": "\\"path\\": ["}\n ]\n}\n'
    assert [record.line for record in parse_tool_path(text)] == [1, 3, 3, 5]


@pytest.mark.parametrize(
    ("text", "what", "line"),
    [
        ('{"path": [\n1,,2]}', "not valid JSON", 2),
        ('{"units": "mm"}', "an object with a list 'path'", 1),
        ('{"units": "km", "path": []}', "'units' must be mm or inch", 1),
        ('{"color": 1, "path": []}', "unknown key 'color'", 1),
        ('{"path": [\n {"do": "fly"}]}', "does not match any of the expected tags", 2),
        ('{"path": [{"do": "stop"},\n {"do": "rapid"}]}', "'to': Field required", 2),
        ('{"path": [{"do": "line", "to": [1, 2]}]}', "'to.2': Field required", 1),
        ('{"path": [{"do": "line", "to": [1, 2, "3"]}]}', "'to.2': Input should be a valid number", 1),
        ('{"path": [{"do": "stop", "when": 1}]}', "'when': Extra inputs are not permitted", 1),
        ('{"path": [{"do": "feed", "feed": 0}]}', "'feed': Input should be greater than 0", 1),
        (
            '{"path": [{"do": "cycle", "kind": "deep", "points": [], "depth": 1, "clearance": 1}]}',
            "a cycle deep without a peck",
            1,
        ),
    ],
)
def test_what_is_refused(text: str, what: str, line: int) -> None:
    with pytest.raises(ProgramError) as caught:
        list(parse_tool_path(text, "part.json"))
    assert what in caught.value.what
    assert caught.value.position is not None
    assert (caught.value.position.file, caught.value.position.line) == ("part.json", line)
