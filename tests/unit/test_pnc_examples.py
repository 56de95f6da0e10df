"""The manual's examples of MCODS, MCOPS and MMC in programs of a living control (Manual 003, 4.14.3 and chapter 9)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from polycnc.cnc import RunState
from polycnc.controllers.bosch.ncs import ClientError, Ipo, Mode, Sav, Sent
from support.living_pnc import AXIS, Living

MACHINE = 'name = "two"\n' + "".join(AXIS.format(name, 400) for name in ("X", "Y", "Q2", "U"))
PART = "N10 G1 U10 F60000\nN50 U20\nN60 U27\nN100 U30\nN110 U40\nM30\n"


def made(folder: Path) -> Living:
    """Return a control with X and Y in channel 1, Q2 and U in channel 2; there is no axis 3."""
    living = Living(folder, MACHINE, [("X", "Y"), ("Q2", "U")], (1, 2, 4, 5))
    living.write("sect.cnc", PART)
    (folder / "usr" / "user").mkdir(parents=True)
    living.write("usr/user/p1.cnc", "N1 G1 U7 F6000\n")
    return living


@pytest.fixture
def two(tmp_path: Path) -> Iterator[Living]:
    living = made(tmp_path)
    yield living
    living.pnc.close()


def run(living: Living, program: str, cycles: int = 3000, channel: int = 1) -> dict[str, object]:
    """Execute a program to its end; return the global and permanent variables of its channel."""
    living.start(program, 1, channel)
    living.until_over(channel, cycles)
    assert living.pnc.run_state(channel) in (RunState.COMPLETED, RunState.RESET)
    return living.pnc.variables(channel)


# ---------------------------------------------------------------------- MCODS


@pytest.mark.covers("cpl.MCODS.32", "cpl.MCODS.39")
@pytest.mark.covers("cpl.ex.3234", "cpl.ncs.return", "cpl.MCODS.constants", "cpl.MCODS.buffertype")
@pytest.mark.covers("cpl.MCODS")
def test_states_of_another_channel_are_read_at_once(two: Living) -> None:
    two.start("N1 G1 U300 F600\n", 40, channel=2)
    found = run(
        two,
        "10 DIM BUF%(2)\n20 VERSION = 0\n30 ERR_VAR% = MCODS(32,2,VERSION,BUF%,2)\n"
        "40 #SAV%=BUF%(1) : #IPO%=BUF%(2) : #V=VERSION : #E%=ERR_VAR%\n"
        "50 FCT%=32 : CHAN%=2 : SIZE%=2 : DIM REAL!(2) : VERSION=0\n60 #F%=MCODS(FCT%,CHAN%,VERSION,REAL!,SIZE%)\n"
        "70 #R=REAL!(1)*10+REAL!(2)\n80 VERSION=0 : STATE=0 : #G%=MCODS(39,2,VERSION,STATE,1)\n"
        "90 VERSION=0 : #H%=MCODS(39,5,VERSION,STATE,1)\n",
        200,
    )
    assert [found[name] for name in ("#SAV%", "#IPO%", "#E%", "#F%", "#R", "#G%")] == [3, 1, 0, 0, 31, 0]
    assert found["#H%"] == 1  # there is no channel 5
    assert found["#V"] not in (0, None)


@pytest.mark.covers("cpl.MCODS.buffertype", "cpl.ncs.return")
@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("E%=MCODS(7,1,V,W%,1)", "INVALID PARAMETER"),  # REAL data do not go into an INTEGER
        ("E%=MCODS(3,1,V,B(1),3)", "INVALID FIELD LIMIT"),  # an element is no field
        ("E%=MCODS(3,1,V,B,4)", "INVALID FIELD LIMIT"),
        ("E%=MCODS(28,1,V,B,3)", "INVALID PARAMETER"),
        ("E%=MCODS(32,1,V,T$,2)", "INVALID PARAMETER"),
    ],
)
@pytest.mark.covers("cpl.MCODS")
def test_a_variable_that_does_not_fit_stops_the_program(two: Living, line: str, what: str) -> None:
    two.write("main1", f"10 V=0 : W%=0 : DIM B(3) : DIM T$(9)\n20 {line}\n30 #A%=1\n")
    two.pnc.select_program("main1")
    two.pnc.cycle_start()
    two.pnc.advance(20)
    (alarm,) = two.pnc.status().alarms
    assert "main1:2" in alarm.text
    assert what in alarm.text
    assert two.pnc.variables().get("#A%") is None


@pytest.mark.covers("cpl.MCODS.32")
@pytest.mark.covers("cpl.ex.3251")
@pytest.mark.covers("cpl.MCODS")
def test_a_loop_ends_when_the_other_channel_is_inactive(two: Living) -> None:
    two.start("N1 G1 U3 F6000\nN2 M0\nN3 U5\n", 3, channel=2)
    two.start(
        "10 DIM BUF%(2)\n20 VERSION = 0\n30 ERR_VAR% = MCODS(32,2,VERSION,BUF%,2)\n40 #S%=BUF%(1) : #N%=0\n"
        "50 INACTIVE = 1\n60 WHILE BUF%(1) <> INACTIVE DO\n70 ERR_VAR% = MCODS(32,2,VERSION,BUF%,2)\n"
        "75 IF BUF%(1)<>#S% THEN\n76 #S%=BUF%(1) : #N%=#N%*100+#S%\n77 ENDIF\n80 END\n90 #T%=CLOCK\n",
        150,
    )
    assert two.pnc.variables()["#N%"] == 2
    assert two.pnc.run_state(1) is RunState.ACTIVE
    two.pnc.cycle_start(channel=2)
    two.until_over(2, 500)
    two.until_over(1, 20)
    assert two.pnc.variables()["#N%"] == 20301  # ready at M0, active, inactive


@pytest.mark.covers("cpl.MCODS.33", "cpl.MCODS.45")
@pytest.mark.covers("cpl.ex.3257")
@pytest.mark.covers("cpl.MCODS")
def test_names_of_the_axes_are_listed(two: Living) -> None:
    two.start(
        "30 VERSION=0\n40 DIM AXNAME$(512)\n60 ERR=MCODS(33,-1,VERSION,AXNAME$,512)\n70 IF ERR=0 THEN\n"
        "90 DIM AXNMB%(3)\n100 VERSION=0\n110 ERR=MCODS(45,-1,VERSION,AXNMB%,3)\n120 ANZ=AXNMB%(2)\n130 ENDIF\n"
        '140 IF ERR<>0 THEN\n150 PRN#(0,"Error occurred: ",ERR)\n160 ELSE\n170 DIM NAME$(8)\n'
        '175 OPENW(1,"LIST",500) : REWRITE(1) : LJUST\n'
        "180 FOR I%=0 TO ANZ\n190 NAME$=MID$(AXNAME$,I%*9+1,8)\n200 IF ASC(NAME$)<>0 THEN\n"
        '220 PRN#(1,I%+1,". Axis name: ",NAME$)\n230 ENDIF\n240 NEXT\n245 CLOSE(1)\n250 ENDIF\nN260 M30\n',
        20,
    )
    lines = (two.folder / "LIST").read_text("latin-1").partition("\x03")[0].split("\n")
    assert [line.split() for line in lines if line.strip()] == [
        ["1.", "Axis", "name:", "X"],
        ["2.", "Axis", "name:", "Y"],
        ["4.", "Axis", "name:", "Q2"],
        ["5.", "Axis", "name:", "U"],
    ]


@pytest.mark.covers("cpl.ex.3298", "cpl.MCODS.87", "cpl.MCODS.87.bit.0", "cpl.MCODS.7")
@pytest.mark.covers("cpl.MCODS")
def test_waiting_states_are_told_apart_by_masks(two: Living) -> None:
    two.start("N1 G1 U3 F6000\nN2 U90\n", 30, channel=2)
    two.pnc.control.set_overrides(feed=0.0, channel=1)
    two.pnc.feed_hold(channel=2)
    two.pnc.advance(200)
    waits(two, [3, 5])  # a feed of 0, and feed hold
    two.pnc.reset(channel=2)
    two.pnc.control.set_overrides(feed=1.2, channel=1)
    assert two.read(7, 2) == [12000]
    two.start("N1 G4 F90\n", 30, channel=2)
    waits(two, [0])


def waits(two: Living, bits: list[int]) -> None:
    """Make sure that the manual's program finds these reasons to wait."""
    labels = "".join(f"{90 + bit} LABEL {2**bit}: #N%=#N%*100+{bit}\n" for bit in range(14))
    found = run(
        two,
        "10 CHAN%=2 : #N%=0\n20 VERSION%=0\n30 STATES%=0\n40 ERR=MCODS(87,CHAN%,VERSION%,STATES%,1)\n50 IF ERR=0 THEN\n"
        f"60 MASK%=1\n70 WHILE MASK% <= STATES% DO\n80 CASE (STATES% AND MASK%) OF\n{labels}240 ENDCASE\n"
        "250 MASK%=MASK%*2\n260 END\n270 ENDIF\nM30\n",
    )
    assert found["#N%"] == int("".join(f"{bit:02d}" for bit in bits))


@pytest.mark.covers("cpl.ex.3340")
def test_axes_of_the_own_channel_go_to_0_and_to_its_number(two: Living) -> None:
    two.start("N1 G1 X7 Y9 F6000\n", 300)
    two.start(
        "50 CHAN=SD(8)\n60 IDCHAX=43\n70 IDMAXAX=45\n80 DIM BUF(16)\n90 SIZE=16\n100 ANZ=0\n130 VERSION=0\n"
        "140 A=MCODS(IDCHAX,CHAN,VERSION,BUF,SIZE)\n150 VERSION=0\n160 A=MCODS(IDMAXAX,CHAN,VERSION,ANZ,1)\n"
        "170 FOR I%=1 TO ANZ\n180 IF BUF(I%) = CHAN THEN\nN190 F1000 [AXP(I%,0,0)]\n200 ENDIF\n210 NEXT\nN215 M0\n"
        "220 FOR I%=1 TO ANZ\n230 IF BUF(I%) = CHAN THEN\nN250 WAIT\nN260 F1000 [AXP(I%,CHAN,0)]\n270 ENDIF\n280 NEXT\n"
        "N290 M30\n",
        1500,
    )
    assert two.pnc.run_state(1) is RunState.PROGRAM_STOP
    assert [two.pnc.axes[name].setpoint for name in "XYU"] == [0, 0, 0]
    two.pnc.cycle_start()
    two.until_over()
    assert [two.pnc.axes[name].setpoint for name in "XYU"] == [1, 1, 0]


# ---------------------------------------------------------------------- MCOPS


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.3", "cpl.MCOPS.6")
@pytest.mark.covers("cpl.ex.3200", "cpl.ex.3175", "cpl.ex.3201", "cpl.MCODS.constants")
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_programs_are_selected_searched_and_started(two: Living) -> None:
    found = run(two, '10 #A%=MCOPS(4,2,"sect.cnc","N50","N100",1)\n20 N%=6 : C%=2 : #B%=MCOPS(N%,C%)\n')
    two.until_over(2)
    assert (found["#A%"], found["#B%"], two.pnc.axes["U"].setpoint) == (0, 0, 30)
    found = run(two, '10 #A%=MCOPS(4,2,"sect.cnc")\n20 #B%=MCOPS(3,2,"N60","N60")\n30 #C%=MCOPS(6,2)\n')
    two.until_over(2)
    assert [found[name] for name in ("#A%", "#B%", "#C%")] == [0, 0, 0]
    assert two.pnc.axes["U"].setpoint == 27
    found = run(two, '10 #A%=MCOPS(4,2,"/usr/user/p1.cnc")\n20 #B%=MCOPS(6,2)\n')
    two.until_over(2)
    assert (found["#A%"], found["#B%"], two.pnc.axes["U"].setpoint) == (0, 0, 7)


@pytest.mark.covers("cpl.MCOPS.4", "cpl.MCOPS.6", "cpl.MCOPS.5", "cpl.MCOPS.2")
@pytest.mark.covers(
    "cpl.ex.3202", "cpl.ex.3228", "cpl.ex.3209", "cpl.ex.3165", "cpl.MCOPS.7", "cpl.MCOPS.7.mode.4"
)
@pytest.mark.covers("cpl.MCOPS")
def test_blocks_by_hand_leaving_and_resetting(two: Living) -> None:
    shown = two.pnc.system.shown
    found = run(two, '10 #A%=MCOPS(7,2,4)\n20 #B%=MCOPS(4,2,"F6000G1U5",,,32)\n30 #C%=MCOPS(6,2)\n')
    two.until_over(2)
    assert [found[name] for name in ("#A%", "#B%", "#C%")] == [0, 0, 0]
    assert (two.pnc.axes["U"].setpoint, shown.renew().channels[2].mode) == (5, Mode.MDI)
    found = run(two, '10 #A%=MCOPS(7,2,5)\n20 #B%=MCOPS(4,2,"sect.cnc")\n30 #C%=MCOPS(5,2,2)\n')
    assert [found[name] for name in ("#A%", "#B%", "#C%")] == [0, 0, 0]
    assert (shown.renew().channels[2].mode, shown.image.channels[2].sav) == (Mode.AUTOMATIC, Sav.INACTIVE)
    two.start("N1 G1 U300 F600\n", 40, channel=2)
    assert run(two, "10 #A%=MCOPS(2,2,2)\n")["#A%"] == 0
    two.pnc.advance(200)
    now = shown.renew().channels[2]
    assert (now.sav, now.ipo, two.pnc.run_state(2)) == (Sav.INACTIVE, Ipo.STOPPED, RunState.RESET)


SELECTED = [1, 2, 4, 5, 6, 7, 10, 12, 13]
ONE_BLOCK = (6, 7, 10, 12)


@pytest.mark.covers("cpl.MCODS.31")
@pytest.mark.covers("cpl.MCOPS.7")
@pytest.mark.parametrize(
    "mode", [pytest.param(mode, marks=pytest.mark.covers(f"cpl.MCOPS.7.mode.{mode}")) for mode in SELECTED]
)
@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS")
def test_the_mode_is_selected_by_its_number_and_blocks_stop_as_it_says(two: Living, mode: int) -> None:
    found = run(two, f"10 #A%=MCOPS(7,2,{mode})\n20 DIM B%(1) : V=0 : E=MCODS(31,2,V,B%,1) : #B%=B%(1)\n")
    assert (found["#A%"], found["#B%"]) == (0, mode)
    if mode < 5:
        return
    two.start("N1 G1 U3 F6000\nN2 U7\nN3 U9\n", 400, channel=2)
    stops = [3, 7, 9] if mode in ONE_BLOCK else [9]
    for at in stops:
        assert two.pnc.axes["U"].setpoint == at
        if at != 9:
            assert two.pnc.run_state(2) is RunState.STOPPED_AT_BLOCK
            two.pnc.cycle_start(channel=2)
            two.pnc.advance(400)


HOW = {1: "auto", 2: "single", 3: "manual"}
WHERE = {1: "start", 3: "break"}


@pytest.mark.covers("cpl.MCOPS")
@pytest.mark.covers("cpl.MCOPS.8", "cpl.MCODS.46.rec.off", "cpl.MCODS.46")
@pytest.mark.parametrize(
    ("how", "where"),
    [
        pytest.param(
            how,
            where,
            marks=pytest.mark.covers(
                f"cpl.MCOPS.8.how.{how}",
                f"cpl.MCOPS.8.where.{where}",
                f"cpl.MCODS.46.mode.{HOW[how]}",
                *([f"cpl.MCODS.46.point.{WHERE[where]}"] if where in WHERE else []),
            ),
        )
        for how, where in ((1, 3), (2, 1), (3, 2), (1, 2), (3, 1))
    ],
)
@pytest.mark.covers("cpl.MCODS")
def test_the_strategy_of_the_return_is_that_of_the_channel(two: Living, how: int, where: int) -> None:
    read = "20 DIM B%(3) : DIM C%(3)\n30 V=0 : E=MCODS(46,2,V,B%,3) : V=0 : E=MCODS(46,1,V,C%,3)\n"
    shown = "40 #B%=B%(1)*100+B%(2)*10+B%(3) : #C%=C%(1)*100+C%(2)*10+C%(3)\n"
    found = run(
        two, f"10 #A%=MCOPS(8,2,{how},{where}) : #D%=MCOPS(8,2,4,1) : #E%=MCOPS(8,2,1,0)\n{read}{shown}"
    )
    assert [found[name] for name in ("#A%", "#D%", "#E%", "#B%", "#C%")] == [
        0,
        18,
        18,
        100 * how + 10 * where,
        110,
    ]


# ---------------------------------------------------------------------- MMC

MMC = """10 DIM PROGNAME$(50)
20 PROGNAME$ = "WinProg"
30 INTPAR% = 1
40 REALPAR = 1.5
50 I% = MMC(PROGNAME$, INTPAR%, REALPAR)
60 IF I% = 0 THEN
70 IF INTPAR% = 2 THEN
N80 G1 X[REALPAR] F6000
90 ENDIF
100 ENDIF
110 #I%=I% : #INT%=INTPAR% : #REAL=REALPAR : #LEN%=LEN(PROGNAME$)
"""


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.1")
def test_without_a_client_mmc_answers_1_at_once(two: Living) -> None:
    found = run(two, MMC, 20)
    assert [found[name] for name in ("#I%", "#INT%", "#REAL", "#LEN%")] == [1, 1, 1.5, 7]


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.0", "cpl.ex.5209")
def test_a_program_waits_until_its_client_answers_and_goes_on_with_its_values(two: Living) -> None:
    seen: list[list[tuple[str, object]]] = []
    answer: list[float] = []

    def client(variables: Sequence[Sent]) -> bool:
        seen.append([(each.name, each.value) for each in variables])
        if answer:
            variables[0].value = "ready"
            variables[1].value, variables[2].value = 2, answer[0]
        return bool(answer)

    two.pnc.system.clients.client = client
    two.start(MMC, 50)
    assert (two.pnc.run_state(1), two.pnc.variables().get("#I%")) == (RunState.ACTIVE, None)
    assert set(map(tuple, seen)) == {(("PROGNAME$", "WinProg"), ("INTPAR%", 1), ("REALPAR", 1.5))}
    answer.append(2.75)
    two.until_over(1, 500)
    found = two.pnc.variables()
    assert [found[name] for name in ("#I%", "#INT%", "#REAL", "#LEN%")] == [0, 2, 2.75, 5]
    assert two.pnc.axes["X"].setpoint == 2.75


@pytest.mark.covers("cpl.MMC")
def test_at_most_20_variables_are_sent(two: Living) -> None:
    sent: list[int] = []

    def client(variables: Sequence[Sent]) -> bool:
        sent.append(len(variables))
        return True

    two.pnc.system.clients.client = client
    some = ",".join(f"V{k}" for k in range(20))
    assert run(two, f"10 #I%=MMC({some})\n", 50)["#I%"] == 0
    two.start("10 #A%=MMC(V0)\n20 #B%=1\n", 50)
    two.write("many", f"10 #C%=MMC({some},V20)\n")
    two.pnc.select_program("many")
    two.pnc.cycle_start()
    two.pnc.advance(5)
    assert sent == [20, 1]
    assert two.pnc.status().alarms[0].text.startswith("many:1:")


@pytest.mark.covers("cpl.SD.8", "cpl.changed.SD_8", "cpl.err.SDR_AXIS", "cpl.SDR")
@pytest.mark.covers("cpl.SD")
def test_each_channel_has_its_number_and_its_axes(two: Living) -> None:
    for channel in (2, 1):
        assert run(two, "10 #A%=SD(8) : #B=SDR(1,2)\n", 50, channel)["#A%"] == channel
        two.write("wrong", "10 #C=SDR(1,3)\n")
        two.pnc.select_program("wrong", channel=channel)
        two.pnc.cycle_start(channel=channel)
        two.pnc.advance(5)
        assert "INVALID PARAMETER" in two.pnc.status().alarms[0].text
        two.pnc.reset(channel=channel)
        two.pnc.advance(1)


@pytest.mark.covers("cpl.MCODS.48", "cpl.MCODS.31", "cpl.MCODS.31.val.4", "cpl.MCODS.31.val.5")
@pytest.mark.covers("cpl.MCODS")
def test_axes_have_the_mode_of_their_channel(two: Living) -> None:
    assert run(two, "10 #E%=MCOPS(7,2,4)\n", 50)["#E%"] == 0
    assert [two.read(31, 1), two.read(31, 2)] == [[5], [4]]
    assert two.read(48, -1, 5) == [5, 5, 0, 4, 4]
    assert [two.read(48, 1, 2), two.read(48, 2, 2)] == [[5, 5], [4, 4]]


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.0")
def test_each_call_sends_what_its_variables_are_then(two: Living) -> None:
    sent: list[object] = []

    def client(variables: Sequence[Sent]) -> bool:
        sent.append(variables[0].value)
        variables[0].value = 10 * len(sent)
        return True

    two.pnc.system.clients.client = client
    found = run(two, "10 A%=3 : #I%=MMC(A%)\n20 #A%=A% : A%=A%+4 : #J%=MMC(A%)\n30 #B%=A%\n", 50)
    assert (sent, [found[name] for name in ("#I%", "#A%", "#J%", "#B%")]) == ([3, 14], [0, 10, 0, 20])


@pytest.mark.covers("cpl.MMC.ret.2", "cpl.MMC")
def test_an_error_in_the_client_changes_nothing(two: Living) -> None:
    def client(variables: Sequence[Sent]) -> bool:
        variables[1].value = 2
        raise ClientError("no")

    two.pnc.system.clients.client = client
    found = run(two, MMC, 50)
    assert [found[name] for name in ("#I%", "#INT%", "#REAL")] == [2, 1, 1.5]
    assert two.pnc.axes["X"].setpoint == 0
