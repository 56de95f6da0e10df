"""A session with a virtual APCI-8001: boot, home, run a contour from the spooler, hit a limit, recover, draw.

The calls are those of the board's function library; a program for the real board does the same in the same order.
"""

import tempfile
from pathlib import Path

import numpy as np

from polycnc.controllers.apci import Board, InstalledBoard, pcap
from polycnc.controllers.apci.pcap import AS, CMP, HMP, LMP, ROSI

SYSTEM_FILE = Path(__file__).with_name("apci_system.dat")
XY, XYZ = AS.of(0, 1), AS.of(0, 1, 2)
PROFILE_END, LEFT_OF_SLR, REFERENCED = 13, 7, 18  # bits of axst, counted from 1


def wait_for_profile_end(*axes: int) -> None:
    """Poll until the profiles of `axes` have ended."""
    while not all(pcap.rdaxstb(axis, PROFILE_END) for axis in axes):
        pass


def boot(folder: Path) -> list[pcap.TSRP]:
    """Boot and initialise the board."""
    (folder / "rwmos.elf").write_bytes(b"\x7fELF, stands for the board's operating system")
    (folder / "system.dat").write_bytes(SYSTEM_FILE.read_bytes())
    pcap.attach(InstalledBoard(record_scans=1 << 16), booted=False, folder=folder)
    assert pcap.BootFile("rwmos.elf", 0) == 0
    tsrp, rosi = pcap.tsrp_array(), ROSI()
    code, board_type = pcap.InitMcuSystem3(tsrp, rosi, 0, "system.dat")
    assert code == 0, code
    print(f"board type {board_type}, {rosi.number_axis} axes, {rosi.revision}")
    return tsrp


def home(tsrp: list[pcap.TSRP]) -> None:
    """Search the reference switches to the left, then the next index pulse to the right: that is zero."""
    pcap.cl(XYZ)
    pcap.jhl(XYZ)
    wait_for_profile_end(0, 1, 2)
    for axis in range(3):
        tsrp[axis].tp = 15.0
    pcap.jhi(XYZ, tsrp)
    wait_for_profile_end(0, 1, 2)
    for axis in range(3):
        pcap.rdlpndx(tsrp[axis])
        pcap.rdrp(tsrp[axis])
        tsrp[axis].tp = tsrp[axis].rp - tsrp[axis].lp  # so far beyond the pulse does it stand
        pcap.shp(tsrp[axis])
        assert pcap.rdaxstb(axis, REFERENCED)
    print("homed")


def contour() -> None:
    """Spool lines, an arc and a helix that go into one another, and change the override on the way."""

    def line(x: float, y: float, tvl: float = 60.0) -> LMP:
        lmp = LMP(ac=400.0, vl=60.0, tvl=tvl)
        lmp.dtm[0], lmp.dtm[1] = x, y
        return lmp

    for x, y in ((20.0, 0.0), (40.0, 0.2), (60.0, 0.0)):
        pcap.smla(XYZ, line(x, y))
    pcap.smca(XYZ, CMP(ac=400.0, vl=60.0, tvl=60.0, phi=180.0, dtca1=60.0, dtca2=25.0))
    pcap.smla(XYZ, line(30.0, 50.0))
    helix = HMP(ac=400.0, vl=60.0, tvl=0.0, phi=180.0, dtca1=30.0, dtca2=25.0)
    helix.dtm[2] = 12.0
    pcap.smha(XYZ, helix)
    pcap.ssms(XYZ)
    pcap.board().advance(400)
    pcap.wrtrovrst(1.0)
    pcap.wrtrovr(0.5)
    pcap.utrovr(XYZ)
    wait_for_profile_end(0, 1, 2)
    assert pcap.rdErrorReg() == 0, pcap.rdErrorReg()


def hit_the_limit_and_recover(tsrp: list[pcap.TSRP]) -> None:
    """Run X against its software limit, which brakes it, and back."""
    tsrp[0].tp = 400.0
    pcap.ja(AS.of(0), tsrp)
    wait_for_profile_end(0)
    pcap.rdrp(tsrp[0])
    print(f"stopped at {tsrp[0].rp:.2f} mm by the limit: {bool(pcap.rdaxstb(0, LEFT_OF_SLR))}")
    tsrp[0].tp = 0.0
    pcap.ja(AS.of(0), tsrp)
    wait_for_profile_end(0)
    print(f"recovered: {not pcap.rdaxstb(0, LEFT_OF_SLR)}")


def draw(board: Board, path: Path) -> None:
    """Draw where X and Y should be and where they are, and how far the two differ."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    rows = board.kernel.recorder.rows[: int(board.kernel.recorder.filled[0])]
    time_s, setpoint, actual = rows[:, 0], rows[:, 4:6], rows[:, 7:9]
    figure, (plan, error) = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
    for points, label, width in ((setpoint, "setpoint", 2.5), (actual, "actual", 0.9)):
        plan.plot(points[:, 0], points[:, 1], label=label, linewidth=width)
    plan.set(xlabel="X in mm (machine)", ylabel="Y in mm (machine)", title="Contour", aspect="equal")
    plan.legend()
    for axis, name in enumerate("XY"):
        error.plot(time_s, (setpoint - actual)[:, axis], label=name, linewidth=0.9)
    error.set(xlabel="time in s", ylabel="position error in mm", title="Position error")
    error.legend()
    figure.savefig(path, dpi=110)
    print(f"wrote {path.name}, greatest error {np.abs(setpoint - actual).max():.3f} mm")


def main() -> None:
    """Do it."""
    with tempfile.TemporaryDirectory() as folder:
        tsrp = boot(Path(folder))
        home(tsrp)
        contour()
        hit_the_limit_and_recover(tsrp)
        draw(pcap.board(), Path("apci_session.png"))


if __name__ == "__main__":
    main()
