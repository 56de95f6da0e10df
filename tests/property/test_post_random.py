"""Random tool paths through random control files: whatever is written, the machine sweeps what was meant."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from polycnc.post import parse_tool_path
from polycnc.runner import post_file
from support.often import share
from support.post_controls import control

DECIMALS = 5  # so that rounding stays far below the tolerance
TOLERANCE_MM = 1e-3
Settings = tuple[dict[str, str | int | float | bool], dict[str, str]]

coordinate = st.integers(-2000, 2000).map(lambda n: n / 100.0)
angle = st.integers(5, 360)


@dataclass
class Writer:
    """Write statements and follow where they lead, so that arcs have a start."""

    lines: list[str] = field(
        default_factory=lambda: ["UNITS/MM", "FROM/0,0,35", "RAPID", "GOTO/0,0,30", "FEDRAT/30000"]
    )
    here: tuple[float, float, float] = (0.0, 0.0, 30.0)

    def goto(self, point: tuple[float, float, float]) -> None:
        self.here = point
        self.lines.append("GOTO/" + ",".join(f"{value:.9f}" for value in point))

    def arc(self, center: tuple[float, float], axis: int, sense: int, degrees: float, rise: float) -> None:
        """Turn about an axis through the point `center` away from here."""
        p, q = (axis + 1) % 3, (axis + 2) % 3
        middle = list(self.here)
        middle[p] += center[0]
        middle[q] += center[1]
        turn = math.radians(degrees) * sense
        end = list(middle)
        end[p] += -center[0] * math.cos(turn) + center[1] * math.sin(turn)
        end[q] += -center[0] * math.sin(turn) - center[1] * math.cos(turn)
        end[axis] += rise
        if degrees == 360:
            end[p], end[q] = self.here[p], self.here[q]
        normal = [0, 0, 0]
        normal[axis] = sense
        numbers = [*middle, *normal, math.hypot(*center)]
        self.lines.append("CIRCLE/" + ",".join(f"{value:.9f}" for value in numbers))
        self.goto((end[0], end[1], end[2]))


@st.composite
def tool_paths(draw: st.DrawFn) -> str:
    """Draw a tool path of lines, rapids, arcs, helices, holes and tool changes."""
    writer = Writer()
    for _ in range(draw(st.integers(1, 8))):
        kind = draw(st.sampled_from(["line", "line", "rapid", "arc", "arc", "holes", "tool", "delta"]))
        if kind in ("line", "rapid"):
            if kind == "rapid":
                writer.lines.append("RAPID")
            writer.goto((draw(coordinate), draw(coordinate), draw(coordinate)))
        elif kind == "delta":
            writer.lines.append("GODLTA/0,0,1.5")
            writer.here = (writer.here[0], writer.here[1], writer.here[2] + 1.5)
        elif kind == "arc":
            center = draw(st.tuples(coordinate, coordinate).filter(lambda c: math.hypot(*c) > 0.5))
            writer.arc(
                center,
                draw(st.integers(0, 2)),
                draw(st.sampled_from([1, -1])),
                draw(angle),
                draw(st.sampled_from([0.0, 0.0, -3.0])),
            )
        elif kind == "holes":
            cycle = draw(
                st.sampled_from(
                    ["DRILL", "DRILL,DWELL,.01", "DEEP,STEP,3", "BRKCHP,STEP,3", "BORE", "DEEP,STEP,20"]
                )
            )
            level = draw(st.sampled_from(["", ",RAPTO,1", ",RETURN,9", ",RETURN,0"]))
            writer.lines.append(f"CYCLE/{cycle},DEPTH,{draw(st.integers(1, 9))},CLEAR,2{level},MMPM,30000")
            for _ in range(draw(st.integers(1, 3))):
                point = (draw(coordinate), draw(coordinate), draw(st.sampled_from([0.0, -1.0, 4.0])))
                writer.goto(point)
            writer.lines.append("CYCLE/OFF")
            writer.lines.append("RAPID")
            writer.goto((draw(coordinate), draw(coordinate), 30.0))
        else:
            writer.lines.append(f"LOADTL/{draw(st.integers(1, 99))}")
            writer.lines.append("RAPID")
            writer.goto((draw(coordinate), draw(coordinate), 30.0))
    return "\n".join([*writer.lines, "FINI"]) + "\n"


@st.composite
def controls(draw: st.DrawFn) -> Settings:
    """Draw a control file: every way to make arcs and cycles, units, numbers, order of words."""
    parameters: dict[str, str | int | float | bool] = {
        "arcs": draw(st.sampled_from(["arcs", "arcs", "lines"])),
        "arc_split": draw(st.sampled_from(["none", "half", "quadrant"])),
        "helix": draw(st.sampled_from(["arcs", "lines"])),
        "cycles": draw(st.sampled_from(["macros", "moves"])),
        "arc_max_radius_mm": draw(st.sampled_from([100_000.0, 10.0])),
        "arc_min_radius_mm": draw(st.sampled_from([0.0, 5.0])),
        "sequence_place": draw(st.sampled_from([0, 1, 2])),
        "separator": draw(st.sampled_from(["", " "])),
        "units": draw(st.sampled_from(["mm", "mm", "inch"])),
    }
    macros = {}
    if parameters["units"] == "inch":
        macros["PROGRAM_START"] = "!G90!!G94!!G40!\n@0@G20"
    if draw(st.booleans()):
        macros["RAPID"] = "<OUTPUTORDER=1>!-G00!$X$$Y$$Z$"
    # A radius says little about the centre of an arc near half a turn: rounding would move it by far.
    if parameters["arc_split"] == "quadrant" and draw(st.booleans()):
        for name, code in (("ARC_CW", "G02"), ("ARC_CCW", "G03")):
            by_radius = "\n".join(
                f"{test}\n!-{plane}!!-{code}!$X$$Y$$Z$$RADIUS$$F$"
                for test, plane in (("IF(PLANE==17)", "G17"), ("ELSE IF(PLANE==18)", "G18"), ("ELSE", "G19"))
            )
            macros[name] = f"<RADIUS=R>\n{by_radius}\nENDIF"
    return parameters, macros


@settings(max_examples=share(40))
@given(tool_paths(), controls())
def test_the_machine_sweeps_what_the_tool_path_means(text: str, settings: Settings) -> None:
    used = control(*settings, decimals=DECIMALS)
    result = post_file(parse_tool_path(text, "part.cl"), used, verify=True, tolerance_mm=TOLERANCE_MM)
    proof = result.verification
    assert proof is not None
    assert proof.run.alarms == []
    said = (proof.off_path, proof.missed, proof.rapid_cuts, result.text)
    assert result.ok or proof.arc_remark, said  # random arcs may turn back at both ends
    assert proof.deviation_mm <= TOLERANCE_MM, said
    assert not proof.rapid_cuts, said
    assert proof.run.cutting_path_mm >= proof.path_feed_mm - 0.01 * (1 + result.summary.blocks)


@settings(max_examples=15)
@given(tool_paths(), st.sampled_from(["bosch-pnc", "din", "fanuc-mill"]))
def test_shipped_control_files_keep_their_rounding(text: str, name: str) -> None:
    # Three decimals: ends and centres of arcs are rounded by 0.0005 mm in each axis.
    result = post_file(parse_tool_path(text, "part.cl"), name, verify=True, tolerance_mm=0.005)
    proof = result.verification
    assert proof is not None
    assert proof.run.alarms == []
    assert result.ok, (name, proof.off_path, proof.missed, result.text)


@settings(max_examples=share(40))
@given(tool_paths())
def test_posting_twice_gives_the_same_text(text: str) -> None:
    used = control()
    first, second = (post_file(parse_tool_path(text), used).text for _ in range(2))
    assert first == second
