"""Arcs as CATIA and Autodesk's posts write them: round a cylinder in space, by an angle, by words."""

from __future__ import annotations

import pytest

from polycnc.errors import ProgramError
from polycnc.post.tool_path._records import Circle
from support.tool_paths import records, senses

CYLINDER = """GOTO/20,7,-3
INDIRV/0,0,{way}
TLON,GOFWD/ (CYLNDR / 20.00000,    7.00000,    9.00000, 0.000000,-1.000000,$
             0.000000,   12.00000),ON,$
            (PLANE/PERPTO,(PLANE/(POINT/ 20.00000,  7.00000,  9.00000),PERPTO,$
            (VECTOR/ 0.000000,-1.000000, 0.000000)),(POINT/ 20.00000,  7.00000,  9.00000),$
            (POINT/ {end},  7.00000,  9.00000))
"""


@pytest.mark.parametrize(("way", "end", "sense"), [("1", "32", 1.0), ("-1", "32", -1.0), ("1", "8", 1.0)])
def test_an_arc_in_space_of_catia_goes_round_its_cylinder(way: str, end: str, sense: float) -> None:
    # It begins beside the axis, at X8, so that INDIRV along Z says which way it goes.
    text = CYLINDER.format(way=way, end=end).replace("GOTO/20,7,-3", "GOTO/8,7,9")
    arc = records(text)[-1]
    assert isinstance(arc, Circle)
    assert (arc.center, arc.x, arc.y, arc.z) == ((20.0, 7.0, 9.0), float(end), 7.0, 9.0)
    assert arc.normal == (0.0, sense, 0.0)


QUARTERS = "GOTO/6,0,0\nMOVARC/0,0,0,0,0,{axis},6,ANGLE,{angle}\nGOTO/0,6,0\n"


@pytest.mark.parametrize(
    ("axis", "angle", "sense"),
    [
        (1, 90, 1.0),
        (-1, 90, 1.0),
        (1, 270, -1.0),
        (-1, 270, -1.0),
        (1, 450, 1.0),
        (-1, 450.2, 1.0),
        (1, -90, 1.0),
    ],
)
def test_the_angle_says_which_way_an_arc_turns_where_the_axis_does_not(
    axis: int, angle: float, sense: float
) -> None:
    arc = records(QUARTERS.format(axis=axis, angle=angle))[-1]
    assert isinstance(arc, Circle)
    assert (arc.normal[2], arc.turns) == (sense, 2 if abs(angle) > 360 else 1)


def test_an_angle_that_fits_no_way_is_refused() -> None:
    with pytest.raises(ProgramError, match="ANGLE,120 of an arc whose points are 90 degree apart"):
        records(QUARTERS.format(axis=1, angle=120))
    # Said on purpose, the sense of the axes counts.
    assert senses(QUARTERS.format(axis=1, angle=270), "clockwise") == [-1.0]


HALF = "MOVARC/-6,6,0,0,0,1,6,ANGLE,180\nGOTO/-12,6,0\n"


@pytest.mark.parametrize("text", [QUARTERS + HALF, "GOTO/0,6,0\n" + HALF + QUARTERS])
def test_half_a_turn_is_refused_where_axes_do_not_tell_the_sense(text: str) -> None:
    assert len(senses(text.format(axis=1, angle=90))) == 2
    with pytest.raises(ProgramError, match="an arc that may turn either way") as caught:
        records(text.format(axis=-1, angle=90))
    assert caught.value.position is not None
    assert "180" in caught.value.position.text


def test_an_arc_by_its_words() -> None:
    text = "GOTO/6,0,0\nMOVARC/ CENTER, 0, 0, 0, AXIS, 0, 0, -1, RADIUS, 6, TIMES, 2\nGOTO/0,6,0\n"
    assert records(text)[-1] == Circle(2, 0.0, 6.0, 0.0, (0.0, 0.0, 0.0), (-0.0, -0.0, -1.0), 2)
