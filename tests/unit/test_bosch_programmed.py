"""COF, DPC, SCL, NCF and MCA (Manual 003, 4.7 and 4.8)."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from polycnc.controllers.bosch.system import LastFunctions, Macoda, ProgrammedShifts
from polycnc.errors import ProgramError
from support.cpl_host import Ran, RecordingHost


class Control(RecordingHost):
    """A channel with the coordinates R X Y; X is the physical axis 2, Y the rotary one 5, also named YP."""

    def __init__(self) -> None:
        self.shifts = ProgrammedShifts(
            ("R", "X", "Y"), {2: 2, 5: 3}, {"YP": 3}, frozenset((3,)), contour={1: 1.5, 2: 2.5, 3: 45.0},
            position={1: 11.5, 2: 50.8, 3: 13.0}, position_angle_deg=-17.25, plane_angle_deg=33.5,
            poles={2: 127.0, 3: 7.0}, factors={2: 1.25},
        )  # fmt: skip
        groups = (frozenset(("G0", "G1", "G2")), frozenset(("G90", "G91")))
        self.last = LastFunctions(groups)
        self.macoda = Macoda(
            2, 3, {(100300004, -1): [5, 6.5], (100300004, 2): [7, 8.5], (302000012, -1): ["K4.geo"]}
        )
        shifts = self.shifts
        functions: dict[str, Callable[..., object]] = {
            "COF": shifts.cof,
            "DPC": shifts.dpc,
            "SCL": shifts.scl,
        }
        functions |= {"NCF": self.last.ncf, "MCA": self.macoda.mca}
        super().__init__(functions)

    def value(self, expression: str) -> float:
        found = Ran(f"10 #V!={expression}\n", self)["#V!"]
        assert isinstance(found, float)
        return found

    def refuses(self, expression: str) -> bool:
        with pytest.raises(ProgramError) as caught:
            self.value(expression)
        return caught.value.what == "INVALID PARAMETER"


@pytest.mark.covers("cpl.COF", "cpl.ex.1985", "cpl.err.SHIFT_FOREIGN")
def test_contour_shifts_are_asked_by_coordinate_or_axis() -> None:
    control = Control()
    values = {
        "COF(3)": 45.0,
        'COF("X")': 2.5,
        "COF(2,0)": 2.5,
        "COF(2,1)": 2.5,
        "COF(5,0)": 45.0,
        'COF("YP")': 45.0,
    }
    assert {each: control.value(each) for each in values} == values
    for wrong in ("COF(0)", "COF(4)", 'COF("Z")', "COF(1,0)", "COF(1,2)"):
        assert control.refuses(wrong)
    control.shifts.inch = True
    control.shifts.contour[2] = 50.8
    assert control.value("COF(2)") == pytest.approx(2.0)
    assert control.value("COF(3)") == 45.0


@pytest.mark.covers("cpl.DPC", "cpl.DPC.sel.0", "cpl.DPC.sel.n", "cpl.ex.2013", "cpl.err.SHIFT_FOREIGN")
def test_position_compensation_has_shifts_and_an_angle() -> None:
    control = Control()
    values = {"DPC(1)": 11.5, 'DPC("X")': 50.8, "DPC(3)": 13.0, "DPC(5,0)": 13.0, "DPC(0)": -17.25}
    assert {each: control.value(each) for each in values} == values
    assert control.refuses("DPC(4)")
    assert control.refuses('DPC("Z")')
    control.shifts.inch = True
    assert control.value("DPC(2)") == pytest.approx(2.0)
    assert control.value("DPC(0)") == -17.25


@pytest.mark.covers(
    "cpl.SCL", "cpl.SCL.sel.0", "cpl.SCL.sel.1", "cpl.SCL.sel.2", "cpl.ex.2040", "cpl.err.SHIFT_FOREIGN"
)
def test_rotation_poles_and_factors() -> None:
    control = Control()
    values = {
        "SCL(0)": 33.5,
        "SCL(1,2)": 127.0,
        "SCL(2,2,1)": 1.25,
        'SCL(2,"X")': 1.25,
        "SCL(2,1)": 1.0,
        "SCL(1,5,0)": 7.0,
    }
    assert {each: control.value(each) for each in values} == values
    for wrong in ("SCL(0,1)", "SCL(1)", "SCL(2)", "SCL(3,1)", 'SCL(1,"Z")', "SCL(2,4)"):
        assert control.refuses(wrong)
    control.shifts.inch = True
    assert control.value("SCL(1,2)") == pytest.approx(5.0)
    assert control.value("SCL(2,2)") == 1.25


@pytest.mark.covers("cpl.NCF", "cpl.err.NCF_SYNTAX")
def test_the_word_programmed_last_is_told_by_any_of_its_group() -> None:
    control = Control()
    for word in ("G1", "G91", "G2"):
        control.last.program(word)
    ran = Ran('10 DIM A$(4)\n20 A$=NCF("G0") : #A?=A$="G2"\n30 A$=NCF("G90") : #B?=A$="G91"\n', control)
    assert (ran["#A?"], ran["#B?"]) == (True, True)
    with pytest.raises(ProgramError, match="INVALID PARAMETER"):
        Ran('10 DIM A$(4)\n20 A$=NCF("G3")\n', control)


@pytest.mark.covers("cpl.MCA", "cpl.err.RUNTIME_MCA")
def test_machine_parameters_have_a_number_an_index_and_a_channel() -> None:
    control = Control()
    values = {
        "MCA(100300004,0)": 7.0,
        "MCA(100300004,1)": 8.5,
        "MCA(100300004,1,-1)": 6.5,
        "MCA(100300004,0,3)": 5.0,
    }
    assert {each: control.value(each) for each in values} == values
    ran = Ran("10 DIM A$(20)\n20 A$=MCA(302000012,0) : #L%=LEN(A$)\n", control)
    assert ran["#L%"] == 6
    for wrong in (
        "MCA(100300005,0)",
        "MCA(100300004,2)",
        "MCA(100300004,-1)",
        "MCA(100300004,0,4)",
        "MCA(100300004,0,0)",
    ):
        assert control.refuses(wrong)
    with pytest.raises(ProgramError, match="INVALID ASSIGNMENT"):
        Ran("10 A%=MCA(302000012,0)\n", control)
