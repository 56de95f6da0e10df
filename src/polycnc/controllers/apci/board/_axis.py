"""One axis as programs see it: its parameters and registers by the manual's names, in the axis' own units."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from polycnc.controllers.apci.board._motor_command import MotorCommand
from polycnc.controllers.apci.board._parameter import Parameter
from polycnc.controllers.apci.board._system_file import SystemFile
from polycnc.controllers.apci.board._units import seconds
from polycnc.controllers.apci.core._command_port import write_command
from polycnc.controllers.apci.core._compiled_entries import change_override
from polycnc.controllers.apci.core._motion import profile_velocity
from polycnc.controllers.apci.core._registers import Axst, Digi, assigned_inputs
from polycnc.controllers.apci.core._state import MOVE, SPOOL_BYTES, SPOOL_ENTRIES, TABLE, BoardState
from polycnc.controllers.apci.core._status_word import status_word
from polycnc.kernel import ADDED, SHORT_OVERSHOOT, KernelState, move_to

_AT_ONCE = 1e9  # 1/s: how steep an offset that moves with a velocity of its own begins


class Axis:
    """Axis `index` of a board: `inputs` returns the board's, `units_changed` is called when its units change."""

    jvl = Parameter("jvl", 1)
    jtvl = Parameter("jtvl", 1)
    hac = Parameter("hac", 2)
    hvl = Parameter("hvl", 1)
    sdec = Parameter("sdec", 2)
    sll = Parameter("sll")
    slr = Parameter("slr")
    ipw = Parameter("ipw")
    mpe = Parameter("mpe")
    gf = Parameter("gf", units=True, above_zero=True)
    gfaux = Parameter("gfaux")
    slsp = Parameter("slsp", units=True, above_zero=True)
    effradius = Parameter("effradius", units=True)
    MaxVel = Parameter("MaxVel")  # these three in the units of interpolation, as they were written
    MaxAcc = Parameter("MaxAcc")
    MDVEL = Parameter("MDVEL")
    dvoffset = Parameter("dvoffset", 1)
    aux = Parameter("aux")
    tp = Parameter("tp")
    kp = Parameter("kp")
    ki = Parameter("ki")
    kd = Parameter("kd")
    kpl = Parameter("kpl")
    kfca = Parameter("kfca")
    kfcv = Parameter("kfcv")

    def __init__(
        self,
        config: SystemFile,
        state: BoardState,
        kernel: KernelState,
        index: int,
        inputs: Callable[[], int],
        units_changed: Callable[[], None],
    ) -> None:
        self.index = index
        self.setup = setup = config.axes[index]
        self.row: Any = state.axis[index]
        self.servo: Any = kernel.servo.row[index]
        self.time_unit_s = seconds(setup.velocity_time_unit, config.sample_time_s)
        self._config, self._state, self._kernel = config, state, kernel
        self._inputs, self._units_changed = inputs, units_changed
        self._motor = MotorCommand(self.row, self.servo, setup, self.time_unit_s, config.stepper_clock_hz)
        self.varint = np.zeros(100, np.int32)  # application-specific axis variables
        self.vardbl = np.zeros(100)
        self.ctrlparams = np.zeros((15, 15))
        self.zero_offsets = [0.0] * 5
        self.ControllerFlags = 0
        self.GCR = 0
        self._alarms = 0

    # ------------------------------------------------------------------ parameters with a meaning of their own

    @property
    def jac(self) -> float:
        """Jog acceleration; a negative one sets the slope of the braking ramp (Manual 002, 2.2.3)."""
        return float(self.row["jac"] * self.time_unit_s**2)

    @jac.setter
    def jac(self, value: float) -> None:
        if not math.isfinite(value):
            return
        rate = abs(value) / self.time_unit_s**2
        self.row["jdec"] = rate
        if value >= 0.0:
            self.row["jac"] = rate

    @property
    def jdec(self) -> float:
        """Slope of the jog braking ramp."""
        return float(self.row["jdec"] * self.time_unit_s**2)

    @property
    def jovr(self) -> float:
        """Jog override."""
        return float(self.row["jovr"])

    @jovr.setter
    def jovr(self, value: float) -> None:
        if value > 0.0 and math.isfinite(value):
            self.change_jog_override(value)

    @property
    def jerkrel(self) -> float:
        """Part of a ramp that is bent, 0 to 1 (Manual 002, 4.4.76.1)."""
        return float(self.row["jerkrel"])

    @jerkrel.setter
    def jerkrel(self, value: float) -> None:
        if not math.isnan(value):
            self.row["jerkrel"] = min(max(value, 0.0), 1.0)

    @property
    def dpoffset(self) -> float:
        """Offset added to the setpoint."""
        return float(self.row["dpoffset"])

    @dpoffset.setter
    def dpoffset(self, value: float) -> None:
        if math.isfinite(value):
            self.row["dpoffset"] = value
            self._move_offset()

    # ------------------------------------------------------------------ positions

    @property
    def origin(self) -> float:
        """Machine position of what is 0 for programs: machine zero and zero offset."""
        return float(self.row["zero"] + self.row["offset"])

    @property
    def rp(self) -> float:
        """Actual position; written with the loop open only, that shifts the machine zero (Manual 002, 4.4.167)."""
        return float(self._kernel.servo.actual[self.index] - self.row["shift"]) - self.origin

    @rp.setter
    def rp(self, position: float) -> None:
        if not self.row["closed"] and math.isfinite(position):
            self.row["zero"] = self.rp + float(self.row["zero"]) - position
            self.row["referenced"] = 0

    @property
    def dp(self) -> float:
        """Setpoint position; written with the loop closed only, the axis goes there at once (Manual 002, 4.4.140)."""
        return float(self._kernel.setpoint[self.index] - self.row["shift"]) - self.origin

    @dp.setter
    def dp(self, position: float) -> None:
        row = self.row
        if row["closed"] and row["pe"] and not row["past"] and math.isfinite(position):
            added = float(self._kernel.ptp.row[ADDED, self.index]["position"])
            self._kernel.base[self.index] = position + self.origin - added

    @property
    def rv(self) -> float:
        """Actual velocity."""
        return float(self.row["rv"] * self.time_unit_s)

    @property
    def dv(self) -> float:
        """Setpoint velocity of the profile generator."""
        return self.profile_velocity() * self.time_unit_s

    @property
    def PosErr(self) -> float:  # noqa: N802  the manual's name
        """Position error: setpoint less actual position."""
        return float(self.servo["following_error"])

    @property
    def counts_per_unit(self) -> float:
        """Encoder counts or steps in one unit of position."""
        return self.slsp * self.gf

    def displayed(self, position: float) -> float:
        """Return a position in the display unit."""
        return position * (self.setup.display_ratio(self.counts_per_unit) or 1.0)

    def profile_velocity(self) -> float:
        """Return the velocity of the profile (axis units/s)."""
        return float(profile_velocity(self._state, self.index))

    def change_jog_override(self, value: float) -> None:
        """Take another jog override, at once."""
        change_override(self._state, self.index, value)

    def change_units(self) -> None:
        """Take over what follows from the resolution, the gear factor or the effective radius."""
        self._motor.change_units(self.counts_per_unit)
        self._units_changed()

    def update_filter(self) -> None:
        """Hand the six filter coefficients to the position loop."""
        for name in ("kp", "ki", "kd", "kpl", "kfcv", "kfca"):
            self.servo[name] = getattr(self, name)

    def _move_offset(self) -> None:
        """Bring what is added to the setpoint to `dpoffset`, at once or with `dvoffset`."""
        row, ptp, i = self.row, self._kernel.ptp, self.index
        velocity = abs(float(row["dvoffset"]))
        if velocity > 0.0:
            rate = velocity * _AT_ONCE
            move_to(ptp, ADDED, i, float(row["dpoffset"]), 0.0, velocity, rate, rate, 0.0, SHORT_OVERSHOOT)
        else:
            ptp.row[ADDED, i]["active"] = 0
            ptp.row[ADDED, i]["position"] = row["dpoffset"]
            ptp.row[ADDED, i]["velocity"] = 0.0

    # ------------------------------------------------------------------ latches

    @property
    def lp(self) -> float:
        """Latched position; reading it clears lpsf."""
        self.row["lpsf"] = 0
        self.row["lp_source"] = 0
        return float(self.row["lp"] - self.row["offset"])

    @lp.setter
    def lp(self, value: float) -> None:
        if math.isfinite(value):
            self.row["lp"] = value + self.row["offset"]

    @property
    def lpndx(self) -> float:
        """Position latched at the encoder's index."""
        return float(self.row["lpndx"] - self.row["offset"])

    @lpndx.setter
    def lpndx(self, value: float) -> None:
        if math.isfinite(value):
            self.row["lpndx"] = value + self.row["offset"]

    # ------------------------------------------------------------------ motor command

    @property
    def mcp(self) -> int:
        """Motor command port; what is written lasts while the loop is open (Manual 002, 4.4.88 and 4.4.162)."""
        if not self.row["closed"]:
            return int(self.row["mcp"])
        return self._motor.counts_for(float(self.servo["output"]))

    @mcp.setter
    def mcp(self, counts: int) -> None:
        write_command(self._state, self._kernel, self.index, counts)

    def step_frequency_hz(self, mcp: int) -> float:
        """Return the signed step frequency of a stepper's motor command."""
        return self._motor.step_frequency_hz(mcp)

    # ------------------------------------------------------------------ status

    @property
    def axst(self) -> Axst:
        """Axis status word."""
        return Axst(self.status_word)

    @property
    def status_word(self) -> int:
        """Axis status word as a number, quickly: programs poll it."""
        self._inputs()  # an error in ifs takes them away
        return status_word(self._state, self.index)

    @property
    def alarms(self) -> int:
        """Alarms of an encoder that evaluates its signals, digi bits AEA to AES, on boards that have them."""
        return self._alarms

    @alarms.setter
    def alarms(self, bits: int) -> None:
        self._alarms = bits & assigned_inputs(self._config.type_number)

    @property
    def digi(self) -> Digi:
        """Digital inputs, and the encoder signals of this axis; reading leaves the latched bits (see rdigi)."""
        return Digi(self._inputs() | self.alarms | int(self.row["signals"]))

    def reset_signals(self) -> None:
        """Reset the signals of the encoder, bits 16 to 19 of digi (Manual 002, 4.4.72)."""
        self.row["signals"] = 0

    @property
    def relay(self) -> bool:
        """Enable relay: on while the position loop is closed."""
        return bool(self.row["closed"])

    @property
    def is_busy(self) -> bool:
        """Tell whether a profile is being run, or the queue works."""
        return not self.row["pe"]

    @property
    def queued(self) -> int:
        """Entries in the spooler."""
        return int(self.row["tail"] - self.row["head"])

    @property
    def lsm(self) -> int:
        """Free memory of the spooler, bytes (Manual 002, 4.4.84)."""
        return SPOOL_BYTES - int(self.row["used"])

    @property
    def MCiS(self) -> int:  # noqa: N802  the manual's name
        """Motion commands in the spooler (Manual 002, 4.4.87)."""
        state, row = self._state, self.row
        entries = (
            state.ring[self.index, k % SPOOL_ENTRIES] for k in range(int(row["head"]), int(row["tail"]))
        )
        return sum(state.entry[int(e)]["kind"] in (MOVE, TABLE) for e in entries)

    @property
    def PcapIndex(self) -> int:  # noqa: N802  the manual's name
        """Index of the spooled command that is being executed, -1 until one with an index has been."""
        return int(self.row["pcap_index"])

    @property
    def ZeroOffset(self) -> float:  # noqa: N802  the manual's name
        """Zero offset in force."""
        return float(self.row["offset"])
