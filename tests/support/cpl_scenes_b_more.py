"""Scenes of the second channel, of every modal function, of dialogs, and of controls with other settings."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from polycnc.cnc import RunState
from polycnc.controllers.bosch.ncs import Coupling, Mode
from polycnc.controllers.bosch.system import Category, Signals, Tab
from polycnc.nc.cpl import OMITTED, Box, Field
from support.cpl_scenes_b import Bench, scene
from support.cpl_scenes_b_asked import Orders

PART = """1 FXC("X2",55,1)=3 : FXC("C2",157,1)=-12 : FXC("V",259,1)=0.5 : FXC("V",260,0)=40.25 : FXC("X2",260,0)=-8
2 TC(1,345,0)=2.5 : TC(2,345,0)=0.125 : TC(1,247,0)=-7
N1 G55 G94 (MSG,SECOND)
N1 G157
N1 G259
N2 G260 G90 G55
N3 M3 M8 S1500
N3 G345
N3 G247
N4 G92 X2=-1.25
N5 G1 G94 X2=20 C2=-30 V-6 F6000
N6 G4 F0.1
N7 M0
N8 M1 X2=22
N9 G53 M5 M9
N9 G153
N9 G253
N10 G167
N11 G91 G70 X2=-0.5 V0.25 F10
N12 X2=-1
"""


@scene
def second(b: Bench) -> None:
    """Channel 2 runs, is held, dwells, waits, stops, is reset and alarmed as channel 1 elsewhere; system data too."""
    control, pnc = b.pnc.control, b.pnc
    b.run('1 FXC("X",54,1)=-4\nN2 G54 G18 G160 S300 M4\nN3 G1 X2 Z1 F900\nN4 M0', 400)
    b.write("main2", PART)
    pnc.select_program("main2", channel=2)
    b.look("channel 1 at M0, a program selected in channel 2", 1)
    pnc.cycle_start(channel=2)
    both = (*b.services, *b.system_data)
    b.look("both, in N3", 160, both)
    pnc.advance(4000, until=lambda: pnc.axes["X2"].velocity > 25.0)
    pnc.feed_hold(channel=2)
    b.look("held: it runs down", 3, both)
    b.look("held: stopped", 300, both)
    pnc.cycle_start(channel=2)
    control.set_overrides(feed=0.3, rapid=0.25, channel=1)
    b.look("goes on with 30 %, rapid 25 %", 60, both)
    control.set_overrides(feed=0.0, channel=1)
    b.look("0 %", 300, both)
    control.set_overrides(feed=0.009, channel=1)
    b.look("0.9 %", 60)
    control.set_overrides(feed=1.2, rapid=1.0, spindle=0.5, channel=1)
    control.set_switches(optional_stop=True, block_delete=frozenset({1}), machine_lock=False, channel=1)
    b.look("120 %, spindle 50 %, optional stop", 10, both)
    pnc.advance(9000, until=lambda: b.data(39, 2) == "1")
    b.look("in N6, the dwell", 0, both)
    b.look("in N7, M0", 300, both)
    pnc.reset(channel=1)
    b.look("channel 1 is reset", 40, both)
    pnc.cycle_start(channel=2)
    b.look("in N8, M1", 400)
    pnc.cycle_start(channel=2)
    b.look("in N11, inches and increments", 200, both)
    control.put_alarm("following_error", axis="X2")
    b.look("alarm of X2 on the way", 2, both)
    b.look("alarm, it stands", 1000)
    pnc.reset(channel=1)
    b.look("reset of channel 1: the alarm stays", 2)
    pnc.reset(channel=2)
    b.look("reset of channel 2", 2, both)
    control.emergency_stop()
    b.look("emergency stop at rest", 2, both)
    control.emergency_stop(False)
    pnc.reset()
    control.set_switches(machine_lock=True, channel=1)
    b.look("machine lock of channel 2", 2, both)
    selections(b)


def selections(b: Bench) -> None:
    """Ask with every kind of axis, selection type and channel, in either channel."""
    axes = (
        -1,
        0,
        1,
        3,
        4,
        5,
        6,
        9,
        12,
        13,
        64,
        1.0,
        1.5,
        True,
        "X",
        "V",
        "W",
        "C2",
        "x",
        "Q",
        "",
        "-X",
        OMITTED,
    )
    kinds = (
        (),
        (0,),
        (1,),
        (2,),
        (-1,),
        (True,),
        (OMITTED,),
        (1, 1),
        (1, 2),
        (1, 3),
        (0, 1),
        (OMITTED, 2),
        (1, True),
    )
    for channel in (1, 2):
        b.say(f"selections of axes in channel {channel}")
        for name in ("WPOS", "MPOS", "AXO", "CPOS", "COF", "DPC"):
            b.ask_all(
                name,
                ((axis, *kind) for axis in axes for kind in kinds[: 13 if name in ("WPOS", "MPOS") else 7]),
                channel,
            )
        for name in ("SPOS", "APOS"):
            b.ask_all(name, ((axis,) for axis in axes), channel)
        b.ask_all(
            "SCL",
            (
                (which, *axis)
                for which in range(-1, 4)
                for axis in ((), (1,), (6, 0), (9, 0), ("X",), ("V", 1))
            ),
            channel,
        )
        b.ask_all("SD", ((22, axis, *kind) for axis in axes for kind in ((), (1,), (2,), (3,))), channel)
        b.ask_all("SD", ((23, axis, *kind) for axis in axes for kind in ((), (2,))), channel)
        b.ask_all(
            "SD",
            ((24, axis, *kind) for axis in axes for kind in ((1,), (2,), (2, 1), (1, 2), (3,), (0,))),
            channel,
        )
        b.ask_all("SD", ((25, axis) for axis in axes), channel)


WORDS = (
    "G0", "G5", "G2 X4 Y0 R3", "G3 X0 Y0 R3", "G70", "G71", "G91", "G90", "G63", "G66", "G95 S100 M3", "G94", "G93",
    "G42 D3 G1 X50 F500", "G42 D0 X8", "G41 D3 X60", "G40 X70", "G7", "G6", "G18", "G19", "G17", "G20 X0 Y0", "G9",
    "G8", "G15", "G14", "G54", "G59", "G53", "G154", "G159", "G153", "G254", "G259", "G253", "G168 X1", "G268 X1",
    "G167", "G160", "G260", "G360", "G60 X1", "G67", "G38 X2", "G39", "G61", "G62", "G65", "G64", "G68", "G69",
    "G145", "G245", "G845", "G645", "G146", "G147", "G847", "G114", "G115", "G92 X1", "G96 S50 M4", "G97 S200 M3",
    "G196 S40 M3", "D3", "H3", "H48", "M19", "M8", "G73 X1", "G70 G95 F0.5 S60 M3", "G70 G93 F2", "G70 G96 S90 M3",
    "G70 G54 G160", "G70 G145", "G70 G147 H3", "G4 F0.01 M9",
)  # fmt: skip
OF_CHANNEL_2 = (
    "G0", "G70", "G91", "G5", "G95 S60 M4", "G18", "G55", "G156", "G257", "G60 X2=1", "G38 X2=2", "G345", "G447",
    "G360", "G168 X2=1", "G268 V1", "H3", "G61", "G8",
)  # fmt: skip
SERVICES = (9, 10, 11, 12, 13, 14, 15, 18, 24, 25, 51, 52, 54, 63)


def stands(b: Bench, channel: int) -> bool:
    """Tell whether a channel is not under way."""
    return b.pnc.run_state(channel) is not RunState.ACTIVE


@scene
def functions(b: Bench) -> None:
    """Each modal function in turn: SD(1) of its group, NCF of its kind, and what data services tell of it."""
    b.run("""1 FOR G%=54 TO 59 : FXC(1,G%,1)=G%/8 : FXC(1,G%+100,1)=G%/4 : FXC(1,G%+200,1)=G%/2 : NEXT
2 FXC(1,160,0)=2 : FXC(1,260,0)=3 : FXC(1,360,0)=4
3 FOR G%=1 TO 8 : TC(1,G%*100+45,0)=G%+0.125 : TC(2,G%*100+45,0)=G%+0.25 : NEXT
4 FOR G%=1 TO 8 : FOR S%=1 TO 5 : TC(S%,G%*100+47,0)=G%+S%/16 : NEXT : NEXT
""", 0)  # fmt: skip
    b.pnc.advance(3000, until=partial(stands, b, 1))
    b.note("alarms", " ".join(each.text for each in b.pnc.status().alarms))
    heads = list(dict.fromkeys(word.split()[0] for word in WORDS if word[0] == "G"))
    for channel, words in ((1, WORDS), (2, OF_CHANNEL_2)):
        base: dict[str, str] = {}
        for word in ("G1 F600", *words):
            b.run(f"N1 G1 F600\nN2 {word}\nN3 M0", 0, channel)
            b.pnc.advance(400, until=partial(stands, b, channel))
            now = {f"SD({k}),{each}": each for k in (1, 2) for each in b.groups(channel, k).split()}
            now |= {f"NCF({each})": b.call("NCF", each, channel=channel).strip('"') for each in heads}
            now |= {f"{k}": b.data(k, -1 if k in (25, 63) else channel) for k in SERVICES}
            now |= {"alarm": " ".join(each.text for each in b.pnc.status().alarms)}
            b.pnc.ncs.ledger.unchanged.clear()
            changed = {name: value for name, value in now.items() if base.get(name) != value}
            gone = [name for name in base if name not in now]
            base = base or now
            found: dict[str, list[str]] = {}
            for name, value in changed.items():
                found.setdefault(value, []).append(name)
            b.note(f"{word} [{channel}]", f"no {' '.join(gone)}" if gone else "")
            b.lines += [f"  {' '.join(names)}: {value}" for value, names in found.items()]
            b.pnc.reset(channel=channel)
            b.pnc.advance(60)


# ---------------------------------------------------------------------- dialogs

SOFTKEYS = '1 SFK(#K%,"A",,"C&C2",,,,,"H") : #N%=1\nN2 M0\n'
TEXT_KEYS = '1 DIM #T$(9) : SFK(#T$,"ONE",,,,,,,"EIGHT") : #N%=2\nN2 M0\n'
NUMBERS = """10 #A=7.25 : #B%=3 : #D!=0.5
20 DLG
30 PRN(3,4,"WIDTH: ###.### MM",#A)
40 PRN(5,4,"COUNT: ###",#B%)
50 PRN(7,4,"DEPTH: ##.##",#D!)
60 PRN(9,4,"NEW: ####",#E%)
70 INP(#A) : INP(#B%) : INP(#D!) : INP(#E%)
80 ENDDLG
90 #N%=3
N100 M0
"""
EDITED = (
    "N10 Q900[12.25, 4,TRUE ,-0.125]",
    "q 900 [1]",
    'N10 P SP["a,b",3]',
    "P sp",
    "N10 X5 Y3",
    "",
    "Q901[1,2]",
    "P SPX[1]",
    "Q900[1.,-4.5,FALSE,.5]",
    "Q900[+3,-7,true,-.25]",
    "Q900[ , ,X,1e3]",
    "Q900[--1,4.,FALSEX,5",
)


TYPED = (
    "1 2 . 5 ENTER 9 ENTER ENTER 4 ENTER",
    "CURSOR_DOWN 8 CURSOR_UP - 3 ENTER CURSOR_DOWN CURSOR_DOWN CURSOR_DOWN 7 ENTER",
    "DELETE ENTER DELETE CURSOR_DOWN 1 DELETE 6 ENTER 0 ENTER",
    "1 2 3 4 5 . 6 7 8 9 ENTER + 5 ENTER . 2 5 ENTER x 1 ENTER",
    "LEVEL_RETURN",
    "SOFTKEY1 ENTER ENTER ENTER ENTER",
    "1 CURSOR_RIGHT 2 CURSOR_LEFT 3 ENTER 4 . 5 ENTER LEVEL_RETURN",
)
"""What is typed into the four fields, one key after the other."""


FOLDERS = ("", "usrfep/", "fep/")
DIALOGS = '3080 00005 = 2\n3080 00006 = "SP", "Q900"\n3080 00007 = "other.dlg", "width.dlg"\n'


def type_keys(b: Bench, keys: Sequence[str], channel: int = 1) -> None:
    """Press keys one by one, with a cycle between them."""
    for key in keys:
        b.pnc.press(key, channel=channel)
        b.pnc.advance(2)


def told(b: Bench, channel: int = 1) -> str:
    """Return the global variables of a channel, its state and errors."""
    found = " ".join(f"{n}={v}" for n, v in sorted(b.pnc.variables(channel).items()) if n[0] == "#")
    alarms = " ".join(alarm.text for alarm in b.pnc.status().alarms)
    return f"{b.pnc.run_state(channel).name} {found} {alarms}".rstrip()


def written(b: Bench, channel: int = 1) -> str:
    """Return the lines that stand on a channel's screen."""
    lines = enumerate(b.pnc.screen(channel).lines(), 1)
    return " | ".join(f"{n}: {' '.join(each.split())}" for n, each in lines if each.strip())


@scene
def dialogs(b: Bench) -> None:
    """Softkeys, inputs and keys on either channel, dialog programs of each area and of blocks in the editor."""
    for channel in (1, 2):
        for name, program in (("numbers of softkeys", SOFTKEYS), ("texts of softkeys", TEXT_KEYS)):
            for keys in (
                *((f"SOFTKEY{n}",) for n in range(1, 9)), ("LEVEL_RETURN",), ("ENTER", "A", "CURSOR_UP", "SOFTKEY3"),
            ):  # fmt: skip
                if channel == 1 or keys == ("SOFTKEY8",):
                    b.run(program, 6, channel)
                    before = written(b, channel)
                    type_keys(b, keys, channel)
                    b.note(f"{name} {' '.join(keys)} [{channel}]", f"{told(b, channel)} | {before}")
                    b.pnc.reset(channel=channel)
                    b.pnc.advance(3)
        for typed in TYPED:
            b.run(NUMBERS, 6, channel)
            type_keys(b, typed.split(), channel)
            b.note(f"inputs {typed} [{channel}]", told(b, channel))
            b.note("  screen", written(b, channel))
            b.pnc.reset(channel=channel)
            b.pnc.advance(3)
    in_front(b)
    dialog_programs(b)
    edited_blocks(b)


def in_front(b: Bench) -> None:
    """Write down what INKEY gets before and behind CLG and DLF."""
    b.say("INKEY before and behind CLG and DLF")
    for word in ("CLG", "DLF", "CLS", "CLG : DLF", "DLF : CLG", 'SFK(#K%,"A") : CSF'):
        b.run(f"1 {word}\n2 REPEAT\n3 #C%=INKEY\n4 UNTIL #C%<>0\nN5 M0", 6)
        type_keys(b, ("SOFTKEY1", "x"))
        b.note(word, f"{told(b)} | {written(b)}")
        b.pnc.reset()
        b.pnc.advance(3)


def dialog_programs(b: Bench) -> None:
    """Call the dialog program of each area, in channel 1 and in the one that a parameter names."""
    b.say("dialog programs of the areas")
    for folder in FOLDERS[1:]:
        (b.folder / folder).mkdir()
    for shift, text in enumerate(("", DIALOGS, "")):
        for number in range(1, 6):
            for place, folder in enumerate(FOLDERS):
                path = f"{folder}cpldlg0{number}.dlg"
                (b.folder / path).unlink(missing_ok=True)
                if place >= (number + shift) % 3:  # the first one counts
                    b.write(path, f"1 #N%={number * 10 + place} : #C%=SD(8)\n")
        b.write("macoda.dat", text)
        b.restart()
        b.note("areas", " ".join(b.pnc.dialogs))
        for area in (*b.pnc.dialogs, "none"):
            b.attempt(f"call {area}", partial(b.pnc.call_dialog, area))
            b.pnc.advance(9)
            b.note(area, " / ".join(told(b, channel) for channel in (1, 2)))
    b.run("N1 G1 V400 F600\n", 20, 2)
    b.attempt("a call while the channel is under way", partial(b.pnc.call_dialog, "manual"))
    b.pnc.reset()
    b.pnc.advance(300)


def edited_blocks(b: Bench) -> None:
    """Let dialog programs read and write a block of the editor."""
    b.say("blocks in the editor")
    read = "10 INP#(0,W,N%,B?,D!)\n20 #W=W : #N%=N% : #B?=B? : #D!=D!\n"
    b.write("width.dlg", read + '30 PRN#(0,"N10 Q900[",W,",",N%*2,"]")\n40 PRN#(0,"SECOND")')
    b.write("other.dlg", read + '30 PRN#(0,"  other";)\n31 PRN#(0,"##.#",2.5)')
    b.write("cpldlg05.dlg", read)
    b.write("macoda.dat", DIALOGS)
    b.restart()
    for text in EDITED:
        block = b.pnc.edit_block(text)
        b.pnc.advance(30)
        b.note(repr(text), f"{told(b, 2)} -> {block.text!r}")
        b.pnc.reset()
        b.pnc.advance(3)


# ---------------------------------------------------------------------- other settings


PARAMETERS = (
    100300001, 100300002, 100300004, 100300012, 101500100, 102000001, 206000100, 206000110, 308000001, 308000004,
    308000005, 308000006, 308000007, 308000200, 501000001, 501000002, 600100020, 601000010, 701000010, 701000020,
    706000010, 706000020, 708000010, 902000010, 903000002, 100100004,
)  # fmt: skip
OTHERWISE = """; of the maker
1003 00001 = "XX", "YY"
1015 00100 = 0.5,  -2.25 , 7
2060 00100 = 40
2060 00110 = 3
3080 00200 = ".zst"
5010 00001 [1] = 3, 2.5, "TEXT"
5010 00001 [2] = 9
5010 00002 = 1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17
6001 00020 = 1
6010 00010 = 49
7010 00010 [2] = "Q"
7060 00010 = "G0", "G18"
7080 00010 = "STOP.SUB"
9020 00010 = 1
9030 00002 = 2
"""


def parameters(b: Bench) -> None:
    """Write down every element of every parameter, in either channel."""
    for channel in (1, 2):
        for number in PARAMETERS:
            ends = [(number, index) for index in (-2, -1, *range(18))]
            b.ask_all("MCA", ends, channel)
    b.ask_all(
        "MCA",
        [
            (each, 0, channel)
            for each in (701000010, 501000001, 706000010)
            for channel in (-2, -1, 0, 1, 2, 3)
        ],
    )


@scene
def settings(b: Bench) -> None:
    """Parameters of every number, drives, kinds of tools, errors of each category, programs that are selected again."""
    b.write("macoda.dat", "")
    machine = b.folder / "machine.toml"
    for name, limits in (
        ("W", "mm = [-90.0, -12.5]\nhome_mm = -20.5"),
        ("V", "mm = [-1.0, 812.25]"),
        ("C2", "deg = [-720.5, 360.5]"),
    ):
        head = f'name = "{name}"\n'
        machine.write_text(machine.read_text().replace(head, f"{head}soft_limits_{limits}\n"))
    b.restart()
    b.run("N1 G1 X1.2345 B-30 F6000\nN2 M0", 400)
    b.run("N1 G1 X2=3 F6000\nN2 M0", 400, 2)
    b.say("parameters of the machine")
    parameters(b)
    drives(b)
    kinds_of_tools(b)
    categories(b)
    b.say("parameters of the root")
    b.write("macoda.dat", OTHERWISE)
    b.restart(reselects=True)
    parameters(b)
    b.run("N1 G1 X1 F6000", 100)
    b.note("power-up condition", b.groups(1, 1))
    b.set_all("PLC", ((200, (4, module, 0, 1)) for module in (39, 40, 42, 43)))
    b.note("table of inches", b.call("FXCR", 1, "A.zst"))
    b.note("A.zst", (b.folder / "A.zst").read_text().replace("\n", "/"))
    selected_again(b)
    coupling(b)


def drives(b: Bench) -> None:
    """Read parameters and lists of drives, with their service channel locked and not."""
    b.say("drives")
    numbers = (17, 30, 40, 47, 51, 140, 141, 187, 189, 999)
    for locked in (True, False, True):  # at first nothing has been read
        b.pnc.system.drives.locked = locked
        error = Box("E%", "I", None)
        for axis in (1, 5, 8, 3, 12, "X", "B", "X2", "W", "Q"):
            found: dict[str, list[str]] = {}
            for n in numbers:
                error.value = None
                answer = b.call("SCS", axis, "S", n, error)
                found.setdefault(f"{answer} ({error.value})", []).append(str(n))
            b.note(f"SCS({axis})", ", ".join(f"{answer}: {' '.join(each)}" for answer, each in found.items()))
        for number in (51, 47, 40):
            b.note(
                f"SCSL {number}", f"{b.call('SCSL', 'X2', 'S', number, f'L{number}', error)} {error.value}"
            )
        for name in ("LIST", "DIR"):
            (b.folder / "DIR").mkdir(exist_ok=True)
            error.value = None
            b.note(f"SCSL {name}", f"{b.call('SCSL', 1, 'S', 187, name, error)} {error.value}")
            b.note(f"SCSL {name} alone", b.call("SCSL", "B", "S", 17, name))
            path = b.folder / name
            b.note(name, path.read_text().replace("\n", " ") if path.is_file() else "no file")
    b.pnc.system.drives.locked = False
    values: dict[tuple[str, int], float | list[float]] = {("P", 9): 7.5, ("P", 32767): [1, 2]}
    b.pnc.system.drives.read = lambda axis, ident: values.get(ident)
    for kind in ("P", "S", "p", "", "PS"):
        b.ask_all("SCS", ((2, kind, number) for number in (9, 8, 32767, 32768, -1)))
    b.note("SCSL P", b.call("SCSL", 2, "P", 32767, "P"))
    b.note("P", (b.folder / "P").read_text().replace("\n", " "))


def kinds_of_tools(b: Bench) -> None:
    """Read the kind of the tool of general compensations."""
    b.say("kinds of tools")
    b.pnc.reset()
    b.pnc.advance(20)
    for group, code in ((147, "G147"), (347, "G347"), (847, "G847")):
        for kind in range(6):
            b.pnc.system.tools.values[group, 6] = float(kind)
            b.run(f"N1 {code}\nN2 G1 F600\nN3 M0", 6)
            b.note(f"{code} {kind}", f"{b.data(54, 1)}, TC {b.call('TC', 6, group, 0)} {b.call('TC', 6)}")
            b.pnc.reset()
            b.pnc.advance(3)


def categories(b: Bench) -> None:
    """Read errors of each category and channel."""
    b.say("errors of each category")
    errors = b.pnc.system.errors
    for category in Category:
        for channel in (1, 2, -1):
            errors.add(120000 + 10 * category + channel, channel, category, f"category {category.name}")
    for channel in (-1, 1, 2):
        for kind in range(12):
            field = Field("I", (12, 3))
            answer = b.call("GETERR", channel, kind, field, 12)
            b.note(
                f"GETERR({channel},{kind}) {answer}",
                " ".join("/".join(str(field[n, k]) for k in (1, 2, 3)) for n in (1, 2, 3)),
            )
    for tab in Tab:
        b.note(f"window of {tab.name}", " / ".join(" ".join(each) for each in b.pnc.information(tab)))
    b.pnc.reset(channel=2)
    b.note("after a reset of channel 2", " ".join(str(each.number) for each in errors.errors))
    b.pnc.reset()
    b.note("after a reset of both", " ".join(str(each.number) for each in errors.errors))


def selected_again(b: Bench) -> None:
    """Leave and reset a program that is selected again unless that is suppressed."""
    b.write("PART", "N1 G1 X2=1 F6000\nN2 X2=2\nN3 M0\nN4 X2=4\n")
    given = Orders(b)
    start = (4, "PART", "", "", 128)
    for order in (
        start,
        (5,),
        (6,),
        (5, 2),
        (6,),
        start,
        (2,),
        (6,),
        (2, 2),
        (6,),
        start,
        (5, 0),
        (2, 0),
        (6,),
    ):
        b.note(str(order), f"{given.give(order)}: {given.state()}, selected again {b.data(70, 2)}")
        b.pnc.advance(300)
        b.note("  later", given.state())
    b.say("searched, then started")
    for ends in (
        ("N2", "N2"),
        ("N2",),
        ("", "N2"),
        ("N4",),
        ("N9", "N2"),
        ("N2", "N9"),
        ("N4", "N2"),
        ("N9", "N8"),
    ):
        b.note(
            str(ends),
            " ".join(given.give(order) for order in ((5, 2), (4, "PART", "", "", 0), (3, *ends), (6,))),
        )
        for cycles in (5, 300):
            b.pnc.advance(cycles)
            b.note("  state", given.state())


def coupling(b: Bench) -> None:
    """Ask over a broken coupling, a strange one, by two in one cycle, and for a mode that the PLC sets."""
    given = Orders(b)
    b.say("the coupling")
    b.pnc.ncs.connected = False
    b.note("broken", f"{b.data(7, 1)} {given.give((6,))} {given.give((99,))}")
    b.pnc.ncs.connected = True
    b.note("strange", f"{Coupling(b.pnc.ncs, None, 1, magic=4711).mcops(6, 1)}")
    b.note("as before", f"{b.data(7, 1)} {given.give((6,))} {b.data(64, -1)} {b.data(66, -1)}")
    first, other = (Coupling(b.pnc.ncs, None, 1) for _ in range(2))
    b.pnc.reset()
    b.pnc.advance(30)
    b.pnc.select_mode(Mode.MDI, channel=2)
    answers = [first.mcops(4, 2, "X2=3", "", "", 4128), other.mcops(4, 2, "X2=4", "", "", 4128)]
    b.pnc.advance(1)
    b.note(
        "two write in one cycle",
        " ".join(str(each.mcops(4, 2, f"X2={n}", "", "", 4128)) for n, each in ((3, first), (4, other))),
    )
    assert answers
    b.note("left", given.give((5, 2)))
    b.pnc.advance(300)
    bit = Signals.CHANNEL_INPUTS, 2, 24
    b.pnc.system.interface.set_bit(*bit, True)
    b.note("the PLC sets the mode", " ".join(given.give((7, mode)) for mode in (1, 4, 5, 11, 99)))
    b.pnc.system.interface.set_bit(*bit, False)
    b.note("and no more", " ".join(given.give((7, mode)) for mode in (1, 4, 5, 11, 99)))
