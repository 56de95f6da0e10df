"""A session with a virtual iMC card: home, drive an electronic line shaft, interpolate, stop and recover, draw.

The calls are those of the card's function library; a program for the real card does the same in the same order.
"""

from collections.abc import Callable
from pathlib import Path

from polycnc.controllers.imc import Card, imclib, parse_card
from polycnc.controllers.imc.imclib import SEL_IFIFO, SEL_PFIFO1, SEL_QFIFO, EventInfo, PFIFOSegData
from polycnc.machine import Poll

CARD = """
number_of_axes = 6
ready = true
[[axis]]                 # the master, with an origin switch
origin = [3000, 3300]
"""
ONE = 65536  # 1 in S16.16: velocities are pulses per millisecond
AXES = range(6)
SHAFT = {1: 1.0, 2: 0.5, 3: -1.0, 4: 2.0}  # slaves and their ratios
CUTTER = 5
STOP = 0x10  # bit of emstop and error


class Client:
    """An open card, and what has been seen of it."""

    def __init__(self) -> None:
        imclib.attach(Card(parse_card(CARD)), clock=Poll(4))
        status, adapters = imclib.IMC_FindNetCard(imclib.NIC_INFO())
        status, handle = imclib.IMC_Open(0, 0)
        assert handle is not None, status.text
        self.handle = handle
        self.seen: list[tuple[int, ...]] = []  # ticks, velocities and positions of all axes
        print(f"{adapters} adapter, card 0 with {handle.axis_count} axes")

    def do(self, call: Callable[..., imclib.IMC_STATUS], *arguments: object) -> None:
        """Call a function; try again while its queue is full."""
        while (status := call(self.handle, *arguments)) == imclib.IMC_FIFO_FULL:
            self.look()
        assert status == imclib.IMC_OK, status.text

    def set16(self, at: int, value: int, axis: int = 0) -> None:
        """Write a word at once."""
        self.do(imclib.IMC_SetParam16, at, value, axis, SEL_IFIFO)

    def set32(self, at: int, value: int, axis: int = 0) -> None:
        """Write two words at once."""
        self.do(imclib.IMC_SetParam32, at, value, axis, SEL_IFIFO)

    def look(self) -> tuple[int, ...]:
        """Read what there is to see."""
        of = imclib.WR_MUL_DES.of
        elements = [of(imclib.ticksLoc, 0, 2)]
        elements += [of(at, axis, 2) for at in (imclib.curvelLoc, imclib.curposLoc) for axis in AXES]
        assert imclib.IMC_GetMulParam(self.handle, elements, len(elements)) == imclib.IMC_OK
        self.seen.append(tuple(each.value for each in elements))
        return self.seen[-1]

    def velocity(self, axis: int) -> float:
        """Return a velocity in pulses per ms."""
        return self.look()[1 + axis] / ONE

    def position(self, axis: int) -> int:
        """Return a command position in pulses."""
        return self.look()[1 + len(AXES) + axis]

    def flag(self, at: int, axis: int = 0) -> bool:
        """Return whether a flag is set."""
        self.look()
        return imclib.IMC_GetParam16(self.handle, at, axis)[1] != 0

    def wait_for_rest(self) -> None:
        """Poll until nothing moves."""
        while any(self.flag(imclib.movingLoc, axis) for axis in AXES):
            pass


def home(client: Client) -> None:
    """Jog the master, then search its origin switch."""
    client.do(imclib.IMC_MoveVelocity, 8 * ONE, 0, SEL_IFIFO)
    while client.position(0) < 500:
        pass
    client.do(imclib.IMC_MoveVelocity, 0, 0, SEL_IFIFO)
    client.wait_for_rest()
    client.do(imclib.IMC_HomeSwitch2, 0, 1, 0, 0, SEL_QFIFO)
    client.do(imclib.IMC_WaitParam, imclib.gohomeLoc, 0, 0, 0, SEL_QFIFO)
    client.do(imclib.IMC_MoveAbsolute, 0, 0, SEL_QFIFO)
    while not client.flag(imclib.homedLoc):
        pass
    client.wait_for_rest()
    print(f"homed, the master is at {client.position(0)}")


def line_shaft(client: Client) -> None:
    """Let four slaves follow the master, trim one, and let an event start a cutter when the master passes 12000."""
    for axis, ratio in SHAFT.items():
        client.do(imclib.IMC_GearFree, ratio, 0, 0, axis, SEL_IFIFO)
    client.do(imclib.IMC_GearInDist, 1.0, 0, 0, 0, 0, 4000, CUTTER, SEL_IFIFO)
    events = [
        EventInfo.of(imclib.CMD_CMP32i, src1=(imclib.curposLoc, 0), src2=12_000),
        EventInfo.of(imclib.CMD_SET16, imclib.IMC_Edge_GreatEqu, src2=-1, dest=(imclib.startsynLoc, CUTTER)),
    ]
    client.do(imclib.IMC_InstallEvent, events, len(events), SEL_IFIFO)
    client.do(imclib.IMC_MoveVelocity, 20 * ONE, 0, SEL_IFIFO)
    while client.position(0) < 8000:
        pass
    client.do(imclib.IMC_MoveSuperimposed, 600, 3, SEL_IFIFO)
    while client.velocity(CUTTER) < 20:
        pass
    print(f"the cutter runs with the master, {client.position(0) - client.position(CUTTER)} pulses behind")
    client.do(imclib.IMC_MoveVelocity, 0, 0, SEL_IFIFO)
    client.wait_for_rest()
    seen = client.look()[1 + len(AXES) :]
    print(f"slaves by pulse of the master: {[round(seen[axis] / seen[0], 2) for axis in SHAFT]}")
    for axis in (*SHAFT, CUTTER):
        client.set16(imclib.gearoutmodLoc, -1, axis)
        client.set16(imclib.engearLoc, 0, axis)
    client.set16(imclib.eventsLoc, 0)


def start_path(client: Client) -> None:
    """Prepare path space 1: axes 1 and 2 are X and Y, positions count from where they are now."""
    client.set16(imclib.clrPFIFO1Loc, -1)
    client.set16(imclib.segmap_x1Loc, 1)
    client.set16(imclib.segmap_y1Loc, 2)
    for axis in (1, 2):
        client.set16(imclib.pathabsLoc, 0, axis)
    client.set32(imclib.pathacc1Loc, ONE // 2)
    client.set32(imclib.feedrate1Loc, ONE)
    client.set16(imclib.startpath1Loc, -1)


def send_path(client: Client) -> None:
    """Send a slot: two lines and two half circles that go into one another."""
    speed, last = 20 * ONE, (0, -4000)
    for x, y in ((0, 4000), (-3000, 0), last, (3000, 0)):
        end = 0 if (x, y) == (3000, 0) else speed
        data = PFIFOSegData.of(x, y, center=(x // 2, 0), direction=-1)
        call = imclib.IMC_AddArcLineWithVel if y == 0 else imclib.IMC_AddLineNWithVel
        client.do(call, imclib.PFIFOSegInfo.of(speed, end, data), SEL_PFIFO1)


def interpolate(client: Client) -> int:
    """Run the slot with a pause on the way; return from which sample on."""
    first = len(client.seen)
    start_path(client)
    send_path(client)
    start = client.position(2)
    while client.position(2) - start < 2000:
        pass
    client.set32(imclib.feedrate1Loc, 0)
    while client.flag(imclib.pathvel1Loc) or client.velocity(2) != 0:
        pass
    print(f"paused {client.position(2) - start} pulses up the slot")
    client.set32(imclib.feedrate1Loc, ONE)
    client.wait_for_rest()
    return first


def stop_and_recover(client: Client) -> None:
    """Stop everything in the middle of the slot; switch on again and go back."""
    home_of_slot = client.position(1), client.position(2)
    send_path(client)
    for _ in range(120):
        client.look()
    client.set16(imclib.emstopLoc, STOP)
    client.set16(imclib.clrPFIFO1Loc, -1)
    client.wait_for_rest()
    print(f"emergency stop, axis 1 in run: {client.flag(imclib.runLoc, 1)}")
    client.set16(imclib.emstopLoc, 0)
    for axis in AXES:
        for at, value in ((imclib.errorLoc, 0), (imclib.enaLoc, -1), (imclib.runLoc, -1)):
            client.set16(at, value, axis)
    go = [
        imclib.WR_MUL_DES.of(at, axis, words, value)
        for axis, place in zip((1, 2), home_of_slot, strict=True)
        for at, words, value in ((imclib.mcstgposLoc, 2, place), (imclib.mcsgoLoc, 1, -1))
    ]
    client.do(imclib.IMC_SetMulParam, go, len(go), SEL_QFIFO)
    client.look()
    client.wait_for_rest()
    print(f"recovered: {(client.position(1), client.position(2)) == home_of_slot}")


def draw(client: Client, first: int, path: Path) -> None:
    """Draw the velocities of all axes over time, and the slot in its plane."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (speeds, plan) = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained", width_ratios=[2, 1])
    time_s = [row[0] / 1000 for row in client.seen]
    for axis in AXES:
        speeds.plot(time_s, [row[1 + axis] / ONE for row in client.seen], label=f"axis {axis}", linewidth=0.9)
    speeds.set(xlabel="time in s", ylabel="velocity in pulses per ms", title="All axes")
    speeds.legend(ncols=3, fontsize="small")
    rows = client.seen[first:]
    x, y = ([row[1 + len(AXES) + axis] for row in rows] for axis in (1, 2))
    plan.plot(x, y, linewidth=1.2)
    plan.set(xlabel="axis 1 in pulses", ylabel="axis 2 in pulses", title="Path", aspect="equal")
    figure.savefig(path, dpi=110)
    print(f"wrote {path.name}")


def main() -> None:
    """Do it."""
    client = Client()
    home(client)
    line_shaft(client)
    first = interpolate(client)
    stop_and_recover(client)
    draw(client, first, Path("imc_session.png"))
    imclib.IMC_Close(client.handle)


if __name__ == "__main__":
    main()
