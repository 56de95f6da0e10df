"""Scenes in which a control goes from state to state: run, held, stopped, by hand, in alarm, asked by others."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from polycnc.cnc import Mode as ControlMode
from polycnc.controllers.bosch.ncs import Mode
from support.cpl_scenes_b import Bench, Waiters, scene, shown_order
from support.cpl_scenes_b_asked import Orders

PART = """1 FXC("X",54,1)=3 : FXC("Y",154,1)=-0.5 : FXC("B",254,1)=12 : FXC("U",160,0)=40.25 : FXC("Z",160,0)=-8
N1 G54 (MSG,CLAMP THE PART)
N1 G154
N1 G254
N2 G160
N3 H3 S1500 M3 M8
N4 G92 X-1.25
N5 G1 X20 Y-12.5 Z7 B-30 U6 F6000
N6 G4 F0.1
N7 M0
N8 M1 X22
N9 H0 G53 M5 M9
N9 G153
N9 G253
N10 G167
N11 X0 Y0 Z0 B0 U0
"""


@scene
def states(b: Bench) -> None:
    """A program runs, is held, goes on, dwells, stops at M0 and M1, ends; then single blocks, MDI, jog, alarm."""
    control = b.pnc.control
    b.look("power on")
    b.write("main1", PART)
    b.pnc.select_program("main1")
    b.look("selected", 1)
    b.pnc.cycle_start()
    b.look("started", 1)
    b.look("in N3, the spindle speeds up", 160)
    b.pnc.advance(2000, until=lambda: b.pnc.axes["X"].velocity > 25.0)
    b.pnc.feed_hold(channel=1)
    b.look("held: it runs down", 4)
    b.look("held: stopped", 200)
    b.pnc.cycle_start()
    b.look("goes on", 50)
    control.set_overrides(feed=0.3)
    b.look("feed override 30 %", 100)
    control.set_overrides(feed=0.005)
    b.look("feed override 0.5 %", 20)
    control.set_overrides(feed=0.0)
    b.look("feed override 0 %", 100)
    control.set_overrides(feed=1.5, spindle=1.2)
    b.look("feed override 150 %, spindle override 120 %", 40)
    b.pnc.advance(2000, until=lambda: b.data(39, 1) == "1")
    b.look("in N6, the dwell")
    b.look("in N7, M0", 200)
    control.set_switches(optional_stop=True, block_delete=frozenset({1}), channel=0)
    b.pnc.cycle_start()
    b.look("in N8, M1", 200)
    b.pnc.cycle_start()
    b.look("in N11, back", 60)
    b.pnc.reset(channel=1)
    b.look("reset on the way", 1)
    b.look("reset: stopped", 300)
    control.set_overrides(feed=1.0, spindle=1.0)
    control.set_switches(optional_stop=False, block_delete=frozenset(), channel=0)
    b.look("overrides as before", 1)


@scene
def modes(b: Bench) -> None:
    """Every mode, by hand, by blocks put in, one after the other, and after a search; then what goes wrong."""
    control, pnc = b.pnc.control, b.pnc
    b.look("power on")
    control.set_overrides(feed=0.25, channel=1)
    control.set_overrides(spindle=0.75)
    control.set_switches(optional_stop=True, block_delete=frozenset({2}), machine_lock=True, channel=1)
    b.look("overrides and switches of channel 2 before its first program", 1)
    control.set_overrides(feed=1.0, spindle=1.0)
    control.set_switches(optional_stop=False, block_delete=frozenset(), machine_lock=False)
    for mode in (
        Mode.PROGRAM_BLOCK,
        Mode.SINGLE_STEP,
        Mode.SINGLE_BLOCK,
        Mode.DEBUG_BLOCK,
        Mode.DEBUG_AUTOMATIC,
    ):
        pnc.select_mode(mode, channel=2)
        b.look(f"mode {mode.name} of channel 2", 1)
    pnc.select_mode(Mode.SINGLE_BLOCK, channel=2)
    b.run("N1 G70 X2=0.5 C2=20 F100\nN2 X2=1 (MSG,SECOND)\nN3 X2=0", 3, channel=2)
    b.look("channel 2, one block in inches", 100)
    b.look("channel 2 stands after the block", 10_000)
    pnc.cycle_start(channel=2)
    b.look("channel 2, the next block", 300)
    pnc.reset(channel=2)
    b.look("channel 2, reset while it moves", 1)
    b.look("channel 2 stands", 500)
    pnc.select_mode(Mode.MDI, channel=1)
    b.look("MDI", 1)
    pnc.select_blocks("N1 G1 X7.5 B-10 F3000")
    b.look("MDI, a block put in", 1)
    pnc.cycle_start()
    b.look("MDI, under way", 60)
    b.look("MDI, over", 1500)
    pnc.select_mode(Mode.JOG)
    b.look("jog", 1)
    control.jog("X", -1)
    control.jog("W", 1, rapid=True)
    control.jog("C2", 1)
    b.look("jog of X, W and C2", 200)
    control.jog("X", None)
    control.jog("W", None)
    control.jog("C2", None)
    b.look("jog over", 500)
    control.select_mode(ControlMode.INC)
    control.increment("Z", 1, 0.1)
    b.look("a step of Z", 15)
    control.select_mode(ControlMode.HANDLE)
    control.handwheel("U", -3, 0.01)
    b.look("three pulses of U back", 15)
    for selected in ControlMode:
        control.select_mode(selected)
        b.note(f"{selected.name} at the control within", f"{b.data(31, 1)} {b.data(31, 2)}")
    pnc.select_mode(Mode.REFERENCE)
    b.look("reference", 1)
    control.reference("Y")
    b.look("Y searches its reference point", 10)
    b.look("Y is there", 3000)
    pnc.select_mode(Mode.AUTOMATIC)
    b.write("main1", "N1 G1 X10 F6000\nN2 X20 (MSG,TWO)\nN3 M4 S900 X30\nN4 X40\nN5 X50")
    pnc.select_program("main1")
    pnc.search_block("N3", "N4")
    b.look("a search for N3", 1)
    pnc.cycle_start()
    b.look("on the way to N3", 40)
    b.look("over after N4", 20_000)
    control.set_switches(machine_lock=True)
    b.run("N1 G0 X5", 5)
    b.look("test without motion", 30)
    pnc.reset()
    pnc.advance(500)
    control.set_switches(machine_lock=False)
    pnc.advance(500)
    b.run("N1 G1 X50 F6000\n2 A=SD(999)", 900)
    b.look("an error of the program")
    pnc.reset()
    pnc.advance(500)
    b.run("N1 S500 M3\nN2 G1 X100 F6000", 500)
    control.emergency_stop()
    b.look("emergency stop on the way", 2)
    b.look("emergency stop, it stands", 1000)
    b.attempt("start", lambda: pnc.cycle_start())
    control.emergency_stop(False)
    b.look("emergency stop released", 10)
    pnc.reset()
    b.look("reset", 10)
    b.run("N1 G1 X-60 F9000", 50)
    control.put_alarm("following_error", axis="X")
    b.look("alarm of X on the way", 2)
    b.look("alarm, it stands", 1000)
    pnc.reset()
    b.look("reset", 10)


@scene
def new(b: Bench) -> None:
    """How often what waits for new data is answered, while nothing happens and while blocks are executed."""
    waiters = Waiters(b)
    b.say("power on")
    waiters.pass_cycles(1)
    waiters.pass_cycles(6)
    b.say("a program of three short blocks")
    b.run("".join(f"N{k} G1 X{k / 2} F60000\n" for k in range(1, 4)), 0)
    waiters.pass_cycles(34)
    b.say("channel 2: a message, a dwell, M8, inches, H3")
    b.run("N1 (MSG,A)\nN2 G4 F0.01\nN3 M8\nN4 G70\nN5 H3\nN6 X2=1 F100", 0, channel=2)
    waiters.pass_cycles(18)
    b.say("overrides, switches, modes")
    b.pnc.reset()
    b.pnc.advance(400)
    waiters.pass_cycles(1)
    b.pnc.control.set_overrides(feed=0.5, spindle=0.5)
    waiters.pass_cycles(2)
    b.pnc.control.set_switches(optional_stop=True, block_delete=frozenset({1}), machine_lock=True)
    waiters.pass_cycles(2)
    b.pnc.select_mode(Mode.JOG)
    waiters.pass_cycles(2)
    b.pnc.transfer_axis("W", 2)
    waiters.pass_cycles(2)
    b.pnc.control.jog("Y", 1)
    waiters.pass_cycles(10)


PARTS = {
    "PART": "N1 G1 X2=1 F6000\nN2 X2=2\nN3 X2=3\nN4 X2=4\nM30\n",
    "WRONG": "N1 G1 X2=1 F600\n20 IF A\n",
    "main2": "N1 G1 X2=20 F600\nN2 X2=30\nN3 M0\nN4 X2=0\n",
    "stop": "N1 M0\nN2 G1 X2=30 F600\nN3 X2=40\n",
}


@scene
def orders(b: Bench) -> None:
    """What a channel does when another control asks for process services, in every state of its own."""
    pnc = b.pnc
    for name, program in PARTS.items():
        b.write(name, program)
    given = Orders(b)
    given.give_all("nothing selected")
    for channel in (-3, -2, -1, 0, 1, 3):
        given.channel = channel
        b.note(
            f"channel {channel}",
            " ".join(given.give(order) for order in ((6,), (5,), (7, 5), (8, 1, 1), (9,), (1,))),
        )
    given.channel = 2
    pnc.select_program("main2", channel=2)
    given.give_all("selected")
    pnc.cycle_start(channel=2)
    pnc.advance(300)
    given.give_all("under way")
    pnc.feed_hold(channel=2)
    pnc.advance(100)
    pnc.reset(channel=2)
    pnc.advance(100)
    pnc.select_program("stop", channel=2)
    pnc.cycle_start(channel=2)
    pnc.advance(20)
    given.give_all("at M0")
    pnc.reset(channel=2)
    pnc.advance(20)
    pnc.select_mode(Mode.MDI, channel=2)
    given.give_all("MDI")
    pnc.select_blocks("G1 X2=30 F600", channel=2)
    pnc.cycle_start(channel=2)
    pnc.advance(100)
    given.give_all("MDI, under way")
    pnc.reset(channel=2)
    pnc.advance(200)
    pnc.select_mode(Mode.JOG, channel=2)
    given.give_all("jog")
    pnc.select_mode(Mode.REFERENCE, channel=2)
    pnc.select_mode(Mode.AUTOMATIC, channel=2)
    pnc.control.emergency_stop()
    given.give_all("emergency stop")


def shown_variables(variables: Mapping[str, object]) -> str:
    return " ".join(f"{name}={value}" for name, value in variables.items() if not name.startswith("@"))


@scene
def waits(b: Bench) -> None:
    """What channels wait for, buffered blocks, programs that ask, and channels whose axes go one after the other."""
    pnc = b.pnc
    b.run("1 WAIT(,80)\nN2 M4 M8 S600\nN3 G1 X1 F600", 5)
    b.look("WAIT for a time")
    b.look("M4 with coolant", 300)
    b.look("X moves", 60)
    b.run(
        "1 DIM T$(80) : DIM A%(3) : V%=0 : W=0 : #C%=0\n2 E%=MCODS(28,1,V%,T$,80)\n3 #C%=1 : #E%=MCODS(28,1,V%,T$,80)\n"
        "4 #C%=2 : #F%=MCODS(31,1,W,A%,3) : #A%=A%(1) : #G%=MCODS(31,3,W,A%,3)\n5 #H%=MCOPS(7,1,4) : #I%=MCOPS(6,2)\n"
        "6 #K%=MCOPS(2,1,2) : #L%=MCOPS(4,1,\"PART\",,,130) : #C%=3\n7 DSP(3,4,T$)\n8 #M%=MCOPS(5,2)\n9 #C%=4\n",
        60, channel=2,
    )  # fmt: skip
    b.write("PART", "N1 G1 X9 F600 (MSG,PART)\nN2 X12\n")
    b.look("channel 2 waits for a message of channel 1")
    b.note("variables of channel 2", shown_variables(pnc.variables(2)))
    pnc.reset(channel=1)
    pnc.advance(100)
    b.run("N1 (MSG,HELLO)\nN2 G1 X5 F600", 10)
    b.look("channel 2 has told channel 1 to leave, and started another program there", 300)
    b.note("variables of channel 2", shown_variables(pnc.variables(2)))
    b.note("screen of channel 2", repr(pnc.screen(2).lines()[2].rstrip()))
    pnc.reset()
    pnc.advance(300)
    pnc.select_mode(Mode.MDI, channel=2)
    given = Orders(b)
    for order in ((4, "G1 X2=3 F6000\nX2=4", "", "", 4128), (6,), (4, "X2=2\nX2=1", "", "", 4128)):
        b.note(shown_order(order), f"{given.give(order)}: {given.state()}")
    b.look("the buffer under way", 20)
    b.look("the buffer is empty", 600)
    b.note("one more block", f"{given.give((4, 'X2=7', '', '', 4128))}: {given.state()}")
    b.look("and it is empty again", 600)
    pnc.reset()
    pnc.advance(20)
    pnc.select_mode(Mode.AUTOMATIC)
    for axis, channel in (("X2", None), ("V", 1), ("W", 2), ("X2", 2), ("C2", None), ("W", 1), ("C2", 1)):
        pnc.transfer_axis(axis, channel)
        b.look(f"axis {axis} goes to channel {channel}", 1)
    b.pnc.control.set_overrides(feed=0.5, channel=0)
    b.run("N1 G70 G1 V0.25 C2=7 W1 F300\nN2 M0", 300)
    b.look("channel 1 moves V, C2 and W, which were others'", 0)
    b.look("the same as data", 0, b.system_data)


@scene
def references(b: Bench) -> None:
    """Axes are referenced one after the other; a program starts when those of its channel are."""
    pnc, given = b.pnc, Orders(b)
    b.write("main2", "N1 G1 X2=1 F600\n")
    b.look("power on")
    for axis in ("W", "X2", "C2", "V", "X"):
        pnc.select_mode(Mode.AUTOMATIC)
        pnc.select_program("main2", channel=2)
        b.note("select and start", f"{given.give((6,))}: {given.state()}")
        b.attempt("start of channel 2", lambda: pnc.cycle_start(channel=2))
        pnc.reset()
        pnc.advance(100)
        pnc.select_mode(Mode.REFERENCE)
        b.attempt("reference", partial(pnc.control.reference, axis))
        b.look(f"{axis} searches its reference point", 1)
        b.look(f"{axis} is referenced", 8000)
