"""Somebody who presses anything at a control at any time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from polycnc.cnc import (
    AfterManual,
    Answer,
    ChannelData,
    Control,
    ControlData,
    ControlError,
    Function,
    Mode,
    Motion,
    OnModeChange,
    RunState,
)
from support.cnc_machine import cnc_machine

Floats = npt.NDArray[np.float64]

CONFIG = cnc_machine()
CYCLE_S = CONFIG.cycle_s
MOST_CYCLES = 60_000

# The dwell in the beginning parts the way there from what has to be the same after every disturbance.
FIRST = """G90 G21 G0 X10.5 Y-7.25
G4 P0.05
M3 S1500
G1 X31.5 Y4 F4200
M8
M98 P7 L2
G90 G2 X33 Y9.5 R41 F1900
M0
G0 X-4.25
G4 P0.12
G91 G1 X3.5 Y0.4
G90 Y-2.5 F777
M9
M30
"""
SECOND = """G90 G21 G0 Z-3.5 B20
G4 P0.04
G1 Z-12.5 F1500
M1
B95 F6000
G0 Z1.5
M30
"""
CALLED = "G91 G1 X1.25 F2600\nY1.75\nG4 P0.03\nM99\n"
DATA = [
    ControlData(mode_change_while_running=what, after_manual=after, answer_limit_s=limit_s)
    for what in OnModeChange
    for after in AfterManual
    for limit_s in (None, 0.9)
]


@dataclass
class Desk:
    """A control under somebody's hands, and every setpoint it had."""

    control: Control
    rng: np.random.Generator
    points: list[Floats] = field(default_factory=list)
    log: list[str] = field(default_factory=list)

    def advance(self, cycles: int) -> None:
        for _ in range(cycles):
            if self.control.advance(1) == 0:
                break
            self.points.append(self.control.machine.state.setpoint.copy())

    def press(self, name: str, call: Callable[[], object]) -> None:
        """Do something; if it is refused, nothing may have changed."""
        before = self.control.status()
        self.log.append(f"{self.control.clock.cycles}: {name}")
        try:
            call()
        except ControlError as error:
            self.log[-1] += f" refused: {error.what}"
            unchanged = bool(error.hint) and self.control.status() == before
        else:
            unchanged = True
        assert unchanged, self.log[-1]

    def anything(self) -> None:
        rng, control = self.rng, self.control
        channel = int(rng.integers(0, len(control.channels)))
        every = None if rng.integers(0, 2) else channel
        axis = str(rng.choice(["X", "Y", "Z", "B"]))
        way = int(rng.choice((-1, 1)))
        match int(rng.integers(0, 22)):
            case 0 | 1:
                mode = Mode(rng.choice([str(each) for each in Mode]))
                self.press(f"mode {mode} of {every}", lambda: control.select_mode(mode, channel=every))
            case 2 | 3 | 4 | 5:
                self.press(f"start {channel}", lambda: control.cycle_start(channel=channel))
            case 6:
                self.press(f"hold {every}", lambda: control.feed_hold(channel=every))
            case 7:
                self.press(f"reset {every}", lambda: control.reset(channel=every))
            case 8:
                self.press(
                    "select", lambda: control.select_program(("FIRST", "SECOND")[channel], channel=channel)
                )
            case 9:
                feed, rapid = float(rng.choice((0.0, 0.31, 1.0, 1.9))), float(rng.choice((0.0, 0.25, 1.0)))
                self.press(
                    f"override {feed} {rapid} of {every}",
                    lambda: control.set_overrides(feed=feed, rapid=rapid, channel=every),
                )
            case 10:
                word = str(rng.choice(["single_block", "optional_stop", "dry_run", "machine_lock"]))
                on: Any = bool(rng.integers(0, 2))
                self.press(
                    f"{word} {on} of {every}", lambda: control.set_switches(**{word: on}, channel=every)
                )
            case 11 | 12:
                self.press(f"jog {axis} {way}", lambda: control.jog(axis, way, rapid=way > 0))
            case 13:
                self.press(f"jog {axis} off", lambda: control.jog(axis, None))
            case 14:
                self.press(f"increment {axis} {way}", lambda: control.increment(axis, way, 0.75))
            case 15:
                self.press(f"handwheel {axis} {way}", lambda: control.handwheel(axis, 7 * way, 0.1))
            case 16:
                self.press(f"reference {axis}", lambda: control.reference(axis))
            case 17:
                self.press("emergency", lambda: control.emergency_stop(bool(rng.integers(0, 3) == 0)))
            case 18:
                self.press("answer", control.plc.answer)
            case 19:
                text = str(rng.choice(["G1 X7 F500\n", "G4 P0.1\nM8\n", "G91 G0 Y-2\n", "X9 X9\n"]))
                self.press(f"mdi {text!r} {channel}", lambda: control.set_mdi(text, channel=channel))
            case 20:
                line = int(rng.integers(1, 12))
                calculate = bool(rng.integers(0, 2))
                self.press(
                    f"search {line} {calculate} {channel}",
                    lambda: control.search(line=line, calculate=calculate, channel=channel),
                )
            case 21:
                self.press(f"alarm on {axis}", lambda: control.put_alarm("following_error", axis=axis))

    def some_time(self) -> None:
        for _ in range(int(self.rng.integers(15, 70))):
            self.anything()
            self.advance(int(self.rng.choice((0, 1, 3, 17, 60, 150))))

    def to_rest(self) -> None:
        """Put everything back as one who comes to the machine would."""
        control = self.control
        control.emergency_stop(False)
        control.reset()
        self.advance(3000)
        control.reset()
        control.set_overrides(feed=1.0, rapid=1.0, spindle=1.0)
        control.set_switches(
            single_block=False,
            optional_stop=False,
            dry_run=False,
            machine_lock=False,
            block_delete=frozenset(),
        )
        control.select_mode(Mode.REF)
        for axis in ("Z", "X", "Y", "B"):
            control.reference(axis)
            while control.manual.active:
                self.advance(1)
                assert len(self.points) < MOST_CYCLES
        control.select_mode(Mode.AUTO)
        self.advance(2)
        status = control.status()
        assert status.alarms == ()
        assert status.messages == ()
        assert {each.run_state for each in status.channels} <= {RunState.READY, RunState.RESET}
        assert all(each.motion is Motion.NONE and not each.functions for each in status.channels)
        assert not any(axis.moving or axis.to_go for axis in status.axes.values())

    def parts(self) -> Floats:
        """Execute the programs and return the setpoints of the end, from the first dwell on."""
        control, begin = self.control, len(self.points)
        for channel, name in enumerate(("FIRST", "SECOND")[: len(control.channels)]):
            control.select_program(name, channel=channel)
            control.cycle_start(channel=channel)
            while control.channels[channel].run_state is not RunState.COMPLETED:
                if control.channels[channel].run_state is RunState.PROGRAM_STOP:
                    control.cycle_start(channel=channel)
                if any(each.due_cycle is None or each.timed_out for each in control.plc.pending):
                    control.plc.answer()
                self.advance(1)
                assert control.channels[channel].run_state is not RunState.ALARM, control.status().alarms
                assert len(self.points) - begin < MOST_CYCLES, self.log
        return np.array(self.points[begin:])


def desk(seed: int) -> Desk:
    rng = np.random.default_rng(seed)
    shares = (ChannelData(("X", "Y"), spindle=True), ChannelData(("Z", "B")))
    control = Control(
        CONFIG,
        channels=shares if seed % 2 else (),
        data=DATA[seed % len(DATA)],
        script={(Function.M, 8): Answer(None)} if seed % 3 == 0 else None,
    )
    for name, text in (("FIRST", FIRST), ("SECOND", SECOND), ("O0007", CALLED)):
        control.programs.create(name, text)
    return Desk(control, rng)
