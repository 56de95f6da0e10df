"""Run a part program from Python: read the result, look into the trace, compare two machines, draw a plot."""

from pathlib import Path

import polycnc

HERE = Path(__file__).parent
PROGRAM = HERE / "bracket.nc"


def main() -> None:
    """Do it."""
    result = polycnc.run(PROGRAM, trace=True)
    print(f"{result.blocks} blocks take {result.time_s:.3f} s, {result.cutting_time_s:.3f} s of them cutting")

    trace = result.trace
    assert trace is not None
    row = trace.setpoint[:, trace.axes.index("Z")].argmin()
    print(f"deepest at {trace.t_s[row]:.3f} s: {trace.setpoint[row]} mm, line {trace.block[row]}")

    # Every cycle keeps the limits of the machine.
    assert polycnc.verify_trace(trace, polycnc.load_machine("mill3")) == []

    workshop = polycnc.run(PROGRAM, machine=HERE / "my_machine.toml")
    print(f"on {workshop.machine}: {workshop.time_s:.3f} s, {workshop.waiting_time_s:.0f} s of them waiting")

    polycnc.plot(result, "bracket.png")
    print("wrote bracket.png")


if __name__ == "__main__":
    main()
