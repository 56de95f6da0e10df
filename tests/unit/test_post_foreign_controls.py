"""What the control files for Siemens and Heidenhain write, read back: moves, arcs, holes, tools, speeds, dwells."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import hypothesis.strategies as st
import pytest
from hypothesis import given, settings

from polycnc.errors import ConfigurationError, UsageError
from polycnc.post import load_control, parse_control, parse_tool_path, shipped_text
from polycnc.runner import post_file
from support.foreign_controls import Step, read_heidenhain, read_siemens
from support.post_recorder import calls_of

READERS: dict[str, Callable[[str], list[Step]]] = {
    "siemens-840d": read_siemens,
    "heidenhain": read_heidenhain,
}
HEAD = "PARTNO/PLATE 7\nLOADTL/3\nSPINDL/RPM,900,CLW\nCOOLNT/FLOOD\nRAPID\nGOTO/1.5,-3,5\nFEDRAT/300,MMPM\n"


def _circle(x: float, y: float, side: int, far: str) -> str:
    """Return an arc of radius 7 that begins below its centre: a quarter, half or nearly all of a turn."""
    end = {"X": f"{x + 7},{y}", "Y": f"{x},{y + 7}", "back": f"{x - 7},{y}"}[far]
    return f"GOTO/{x},{y - 7},-2\nCIRCLE/{x},{y},-2,0,0,{side},7\nGOTO/{end},-2"


def _row(kind: str, x: float, y: float, count: int) -> str:
    """Return a cycle with some holes."""
    words = {"DRILL": "DRILL,DEPTH,12", "DEEP": "DEEP,DEPTH,12,STEP,5", "DWELL": "DRILL,DEPTH,12,DWELL,0.5"}[
        kind
    ]
    holes = "\n".join(f"GOTO/{x + 9 * n},{y},{-n}" for n in range(count))
    return f"CYCLE/{words},MMPM,90,CLEAR,2\n{holes}\nCYCLE/OFF"


places = st.integers(-400, 400).map(lambda n: n / 8)
points = st.builds("GOTO/{},{},{}".format, places, places, places)
pieces = st.lists(
    st.one_of(
        points,
        points.map("RAPID\n{}".format),
        st.builds("FEDRAT/{},MMPM\n{}".format, st.sampled_from([90, 212.5, 1500]), points),
        st.builds(_circle, places, places, st.sampled_from([1, -1]), st.sampled_from(["X", "Y", "back"])),
        st.builds(_row, st.sampled_from(["DRILL", "DEEP", "DWELL"]), places, places, st.integers(1, 3)),
        st.sampled_from(
            [
                "DELAY/1.5",
                "STOP",
                "COOLNT/OFF",
                "LOADTL/12\nSPINDL/RPM,1250,CCLW\nRAPID\nGOTO/2,3,40",
                "SPINDL/OFF",
            ]
        ),
    ),
    min_size=1,
    max_size=12,
).map(lambda found: HEAD + "\n".join(found) + "\nFINI\n")


def meant(text: str, name: str) -> list[Step]:
    """Return what the events of a tool path mean, as the readers give it."""
    control = load_control(name)
    absent = [macro for macro in ("CYCLE_DRILL", "CYCLE_DEEP", "CYCLE_DWELL") if not control.has(macro)]
    absent += ["CYCLE_CHIP_BREAK", "CYCLE_TAP", "CYCLE_BORE"]
    settings = {key: getattr(control.parameters, key) for key in type(control.parameters).model_fields}
    steps: list[Step] = []
    fresh = False
    speed = 0.0
    for macro, words in calls_of(text, tuple(absent), **settings)[0]:
        w: dict[str, Any] = words
        end = tuple(round(w[axis], 3) for axis in "XYZ") if "X" in w else ()
        feed = round(w["F"], 4) if "F" in w else 0.0
        moves = macro in ("RAPID", "LINEAR") or macro.startswith("ARC")
        if fresh and moves:
            steps.append(("rapid", (*end[:2], None)))
        match macro:
            case "TOOL_CHANGE":
                steps += [("M", 9), ("spindle", 0.0), ("tool", w["T"])]
                steps += [("M", 6)] if name == "siemens-840d" else []
            case "SPINDLE_CW" | "SPINDLE_CCW":
                speed = w["S"] * (1 if macro == "SPINDLE_CW" else -1)
                steps.append(("spindle", speed))
            case "COOLANT_FLOOD":
                steps.append(("M", 8))
            case "RAPID":
                steps.append(("rapid", end))
            case "LINEAR":
                steps.append(("line", end, feed))
            case "ARC_CW" | "ARC_CCW":
                base = (
                    (w["STARTX"], w["STARTY"]) if control.parameters.arc_center == "relative" else (0.0, 0.0)
                )
                center = tuple(round(a + w[b], 3) for a, b in zip(base, "IJ", strict=True))
                steps.append(("arc", macro == "ARC_CW", end, center, feed))
            case "CYCLE_DRILL" | "CYCLE_DEEP" | "CYCLE_DWELL":
                peck, dwell = w.get("Q", 0.0), w.get("P", 0.0)
                steps.append(("hole", end[:2], w["R"], w["Z"], w["OUT"], peck, dwell, feed))
            case "DWELL":
                steps.append(("dwell", w["DWELL"]))
            case "STOP":
                steps.append(("M", 0))
        fresh = macro == "TOOL_CHANGE" or (fresh and not moves and not macro.startswith("CYCLE"))
    return steps


@pytest.mark.parametrize("name", READERS)
@settings(max_examples=12)
@given(pieces)
def test_what_is_written_is_what_the_tool_path_means(name: str, text: str) -> None:
    result = post_file(parse_tool_path(text, "part.cl"), name)
    assert result.text is not None
    assert essential(READERS[name](result.text)) == essential(meant(text, name))


def essential(steps: list[Step]) -> list[Step]:
    """Leave out modes that need not be written again (M5, M8, M9), the end, and rapids above the next hole."""
    found: list[Step] = []
    for step in steps:
        if step in (("M", 8), ("M", 9), ("M", 30), ("spindle", 0.0)):
            continue
        while step[0] == "hole" and found and found[-1][0] == "rapid" and found[-1][1][:2] == step[1]:
            found.pop()
        found.append(step)
    return found


@pytest.mark.parametrize("name", READERS)
def test_a_program_that_nothing_reads_is_said_not_to_be_verifiable(name: str) -> None:
    with pytest.raises(UsageError, match="cannot be proven: nothing here reads its language"):
        post_file(parse_tool_path(HEAD), name, verify=True)


def test_the_hint_for_an_unknown_dialect_names_the_way_without() -> None:
    text = shipped_text("heidenhain").replace('dialect = "none"', 'dialect = "heidenhain"')
    with pytest.raises(ConfigurationError) as error:
        parse_control(text, "mine.toml")
    assert 'Write "none" for a language that nothing here reads.' in (error.value.hint or "")


@pytest.mark.parametrize(
    ("name", "blocks"),
    [
        (
            "siemens-840d",
            ["; PLATE 7", "G710", "G17 G40 G90 G94", "G54", "M9", "M5", "G0 SUPA Z0 D0", "T3", "M6", "D1"],
        ),
        (
            "heidenhain",
            [
                "0 BEGIN PGM POSTED MM",
                "1 ; PLATE 7",
                "2 M9",
                "3 M5",
                "4 L Z+0 R0 FMAX M91",
                "5 TOOL CALL 3 Z",
            ],
        ),
    ],
)
def test_a_program_begins_as_its_control_wants(name: str, blocks: list[str]) -> None:
    text = post_file(parse_tool_path(HEAD), name).text or ""
    assert text.splitlines()[: len(blocks)] == blocks
