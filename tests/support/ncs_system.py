"""A control with two channels, a gap among its axes and among its spindles, no value like another."""

from __future__ import annotations

from polycnc.controllers.bosch.ncs import (
    Axis,
    Channel,
    Coordinate,
    Drive,
    Image,
    Ipo,
    Mode,
    Sav,
    Spindle,
    SpindleMotion,
    ToolCompensation,
    Unit,
    Wait,
)


def system() -> Image:
    """Channel 1 has X and Y with a transformation (coordinates R, then X), channel 2 Z and the Hirth axis C."""
    x = Axis(
        1, "X", channel=1, logical_name="XL", default_logical_name="XD", setpoint=12.5, actual=12.25, preset=100.0,
        lag=0.25, shifts=(1.5, 0.25, -3.0), external_shift=0.125, end=40.0, cartesian=7.75, axis_coordinate=61.5,
        machine_coordinate=62.25, travel=True, referenced=True, jog_speed=2200.0, potentiometer=7300.0,
        interface_unit=Unit.INCH, drive=Drive("HSM01.1-FW", "DIAX04", "MKD071B", {51: 125000, 40: 4711}),
    )  # fmt: skip
    y = Axis(
        2, "YLONGNAME", channel=1, setpoint=-3.75, actual=-3.5, lag=None, shifts=(2.0, -0.5, 0.75), end=41.5,
        axis_coordinate=63.5, machine_coordinate=64.75, in_window=True, referenced=False, jog_speed=1800.0,
        feed_inhibit=True, potentiometer=7400.0,
    )  # fmt: skip
    z = Axis(
        3, "Z", channel=2, default_channel=1, setpoint=88.0, actual=87.5, shifts=(0.0, 6.0, 0.0), external_shift=5.5,
        end=-8.5, axis_coordinate=65.5, machine_coordinate=66.75, in_window=False, referenced=True, jog_speed=900.0,
        potentiometer=7500.0,
    )  # fmt: skip
    b = Axis(
        5, "B", "rotary", channel=None, default_channel=None, setpoint=359.5, actual=359.25, end=90.5,
        axis_coordinate=67.5, machine_coordinate=68.75, referenced=True, jog_speed=12.0, mode=Mode.JOG,
        potentiometer=7600.0,
    )  # fmt: skip
    s = Axis(
        6, "S", "spindle", channel=None, default_channel=None, mode=Mode.NONE, lag=1.75, potentiometer=7700.0
    )
    c = Axis(
        7, "C", "hirth", channel=2, default_channel=2, setpoint=15.0, actual=14.5, end=30.0, axis_coordinate=69.5,
        machine_coordinate=70.75, jog_speed=3.5, potentiometer=7800.0,
    )  # fmt: skip
    u = Axis(
        8, "U", channel=None, default_channel=2, setpoint=5.0625, actual=5.0, end=6.5, axis_coordinate=71.5,
        machine_coordinate=72.75, referenced=True, travel=True, jog_speed=650.0, mode=Mode.REFERENCE,
        feed_inhibit=True, potentiometer=7900.0, interface_unit=Unit.INCH,
    )  # fmt: skip
    first = Channel(
        1, mode=Mode.SINGLE_BLOCK, sav=Sav.READY, ipo=Ipo.RUNNING_DOWN, inch=True, inch_at_power_up=False,
        program="/usr/user/p1.cnc", message="TOOL 7 IS WORN", feeds=(1500.0, 1200.5, 1350.25), programmed_feed=1600.0,
        potentiometer=8250.0, length_number=14, length=73.25, radius_number=9, radius=6.35, tool_table="K4",
        shift_table="V2.npv", tool=ToolCompensation(5.5, 31.0, 11.0, 21.0, 45.5, 3), external_tool=(2.75, 18.5),
        return_how=2, return_where=3, recording=True, skip=(False, True), optional_stop=(True, False),
        reselection=True,
        coordinates=[
            Coordinate("X", (1,), False, Unit.METRIC, 21.5, 22.5, 23.5, 24.5, 25.5, 26.5, 0.75, False),
            Coordinate("R", (1, 2), True, Unit.DEGREE, 31.5, 32.5, 33.5, 34.5, 35.5, 36.5, 0.25, True),
        ],
    )  # fmt: skip
    second = Channel(
        2, mode=Mode.JOG, sav=Sav.INACTIVE, ipo=Ipo.STOPPED, inch_at_power_up=True, potentiometer=0.0, dwell=True,
        auxiliary_waits=True, transfer_inhibit=True,
        coordinates=[Coordinate("Z", (3,)), Coordinate("C", (7,), unit=Unit.DEGREE)],
    )  # fmt: skip
    spindles = {
        1: Spindle(
            programmed=3000.0, actual=2399.5, potentiometer=9000.0, limits=(50.0, 2400.0),
            gear_limits=(80.0, 5000.0), motion=SpindleMotion.CLOCKWISE_COOLANT, gear_range=42, group=3,
        ),
        3: Spindle(
            programmed=700.0, actual=640.5, cutting_m_min=180.0, potentiometer=5000.0, limits=(25.0, 6000.0),
            gear_limits=(20.0, 4500.0), motion=SpindleMotion.ORIENTATION, gear_range=48, group=1,
            automatic_gear=False, gear_switching=True,
        ),
    }  # fmt: skip
    image = Image(
        {axis.number: axis for axis in (x, y, z, b, s, c, u)}, spindles, {1: first, 2: second},
        cycle=1000, drives=6, interface_channels=5, all_channels=9, test_mode=True,
    )  # fmt: skip
    image.customer[1, 4660] = (1.5, 2.5)
    second.other_waits = Wait(0)
    return image
