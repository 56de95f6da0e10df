"""The NCS coupling and MMC from CPL programs: the manual's examples (Manual 003, 4.14.3 and chapter 9)."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pytest

from polycnc.controllers.bosch.ncs import (
    Channel,
    ClientError,
    Clients,
    Coupling,
    Image,
    Mmc,
    Mode,
    NcsServer,
    Partner,
    Sav,
    Sent,
    Wait,
)
from polycnc.errors import ProgramError
from polycnc.nc.cpl import BLOCKED, CharacterField, Fault, Item, text_of
from support.cpl_host import Ran, RecordingHost
from support.ncs_system import system


class Cell:
    """A control whose programs ask a partner; time passes for the partner while one waits."""

    def __init__(self, image: Image | None = None, programs: dict[str, str] | None = None) -> None:
        self.image = image or system()
        self.partner = Partner(self.image, programs)
        self.server = NcsServer(self.partner)
        self.coupling = Coupling(self.server)
        self.clients = Clients()
        self.printed: list[str] = []
        self.pauses = 0
        self.at_pause: dict[int, Callable[[], object]] = {}
        self.host = RecordingHost(
            {
                "MCODS": self._ticking(self.coupling.mcods),
                "MCOPS": self._ticking(self.coupling.mcops),
                "MMC": self._ticking(Mmc(self.clients).call),
                "PRN#": self._print,
                "SD": lambda group: {8: 2}[group],
                "AXP": lambda axis, position, kind: (f"A{axis}", None, float(position)),
            }
        )

    def run(self, text: str) -> Ran:
        return Ran(text, self.host)

    def _ticking(self, function: Callable[..., object]) -> Callable[..., object]:
        def call(*arguments: object, **named: object) -> object:
            answer = function(*arguments, **named)
            if answer is BLOCKED:
                self.pauses += 1
                assert self.pauses < 100
                self.at_pause.get(self.pauses, int)()
                self.partner.advance(1)
                self.server.look()
            return answer

        return call

    def _print(self, number: int, *items: Item, open: bool = False) -> None:
        assert (number, open) == (0, False)
        self.printed.append(
            "".join(str(text_of(item.value) if item.kind == "S" else item.value) for item in items)
        )


EXAMPLE_1 = """10 DIM BUF%(2)
20 VERSION = 0
30 ERR_VAR% = MCODS(32,2,VERSION,BUF%,2)
40 #SAV%=BUF%(1) : #IPO%=BUF%(2) : #V=VERSION : #E%=ERR_VAR%
"""


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.32", "cpl.MCODS.32.elem.1", "cpl.MCODS.32.elem.2")
def test_states_of_another_channel_are_read_at_once() -> None:
    cell = Cell()
    cell.image.channels[2].sav = Sav.PREPARING
    ran = cell.run(EXAMPLE_1)
    assert (ran["#SAV%"], ran["#IPO%"], ran["#E%"]) == (9, 3, 0)
    assert ran["#V"] not in (0, None)
    assert cell.pauses == 0


@pytest.mark.covers("cpl.MCODS", "cpl.MCODS.32", "cpl.MCODS.refresh.E")
def test_a_loop_waits_until_a_channel_is_inactive() -> None:
    cell = Cell()
    channel = cell.image.channels[2]
    channel.sav = Sav.ACTIVE

    def state(sav: Sav) -> Callable[[], None]:
        return lambda: setattr(channel, "sav", sav)

    cell.at_pause = {4: state(Sav.READY), 9: state(Sav.INACTIVE)}
    ran = cell.run(
        EXAMPLE_1
        + """50 INACTIVE = 1
60 WHILE BUF%(1) <> INACTIVE DO
70 ERR_VAR% = MCODS(32,2,VERSION,BUF%,2)
75 #N%=#N%+1 : #S%=#S%*100+BUF%(1)
80 END
""".replace("50 INACTIVE", "45 #N%=0 : #S%=0\n50 INACTIVE")
    )
    assert (ran["#N%"], ran["#S%"]) == (2, 201)
    assert cell.pauses == 9


@pytest.mark.covers("cpl.MCODS.33", "cpl.MCODS.45", "cpl.MCODS.45.elem.2", "cpl.ncs.101")
def test_names_of_the_axes_are_listed_but_not_of_those_that_are_none() -> None:
    cell = Cell()
    cell.run(
        """30 VERSION=0
40 DIM AXNAME$(512)
60 ERR=MCODS(33,-1,VERSION,AXNAME$,512)
70 IF ERR=0 THEN
90 DIM AXNMB%(3)
100 VERSION=0
110 ERR=MCODS(45,-1,VERSION,AXNMB%,3)
120 ANZ=AXNMB%(2)
130 ENDIF
140 IF ERR<>0 THEN
150 PRN#(0,"Error occurred: ",ERR)
160 ELSE
180 FOR I%=0 TO (ANZ-1)
190 NAME$=MID$(AXNAME$,I%*9+1,8)
200 IF ASC(NAME$)<>0 THEN
220 PRN#(0,I%+1,". Axis name: ",NAME$)
230 ENDIF
240 NEXT
250 ENDIF
N260 M30
"""
    )
    assert [line.rstrip() for line in cell.printed] == [
        "1. Axis name: X",
        "2. Axis name: YLONGNAM",
        "3. Axis name: Z",
        "5. Axis name: B",
        "6. Axis name: S",
        "7. Axis name: C",
    ]
    cell.server.connected = False
    cell.printed.clear()
    cell.run(
        """30 VERSION=0
40 DIM AXNAME$(512)
60 ERR%=MCODS(33,-1,VERSION,AXNAME$,512)
150 PRN#(0,"Error occurred: ",ERR%)
"""
    )
    assert cell.printed == ["Error occurred: 101"]


REASONS = ["dwell", "auxiliary", "transfer", "zero", "M0", "hold", "inhibit", "customer", "ASTOP", "G511", "WPV",
           "WAITA", "WAIT", "MCODS"]  # fmt: skip


@pytest.mark.covers("cpl.MCODS.87", "cpl.MCODS.87.bit.0", "cpl.MCODS.87.bit.5", "cpl.MCODS.87.bit.13")
def test_waiting_states_are_told_apart_by_masks() -> None:
    cell = Cell(Image({}, {}, {1: Channel(1)}))
    cell.image.channels[1].other_waits = Wait.DWELL | Wait.FEED_HOLD | Wait.AXIS_EXCHANGE | Wait.DATA_SERVICE
    labels = "\n".join(f'{90 + bit} LABEL {2**bit}:PRN#(0,"{text}")' for bit, text in enumerate(REASONS))
    cell.run(
        f"""10 CHAN%=1
20 VERSION%=0
30 STATES%=0
40 ERR=MCODS(87,CHAN%,VERSION%,STATES%,1)
50 IF ERR=0 THEN
60 MASK%=1
70 WHILE MASK% <= STATES% DO
80 CASE (STATES% AND MASK%) OF
{labels}
240 ENDCASE
250 MASK%=MASK%*2
260 END
270 ENDIF
M30
"""
    )
    assert cell.printed == ["dwell", "hold", "G511", "MCODS"]


@pytest.mark.covers("cpl.MCODS.43", "cpl.MCODS.constants")
def test_axes_of_the_own_channel_are_found_and_moved() -> None:
    ran = Cell().run(
        """50 CHAN=SD(8)
60 IDCHAX=43
70 IDMAXAX=45
80 DIM BUF(16)
90 SIZE=16
100 ANZ=0
130 VERSION=0
140 A=MCODS(IDCHAX,CHAN,VERSION,BUF,SIZE)
150 VERSION=0
160 A=MCODS(IDMAXAX,CHAN,VERSION,ANZ,1)
165 ANZ=ANZ+1
170 FOR I%=1 TO ANZ
180 IF BUF(I%) = CHAN THEN
N190 F1000 [AXP(I%,0,0)]
200 ENDIF
210 NEXT
220 FOR I%=1 TO ANZ
230 IF BUF(I%) = CHAN THEN
N240 M0
N250 WAIT
N260 F1000 [AXP(I%,CHAN,0)]
270 ENDIF
280 NEXT
N290 M30
"""
    )
    moves = [block for block in ran.blocks if "A" in block]
    assert moves == ["F1000 A3=0", "F1000 A7=0", "F1000 A3=2", "F1000 A7=2"] or moves == [
        "F1000 A30",
        "F1000 A70",
        "F1000 A32",
        "F1000 A72",
    ]


def channels(mode: Mode) -> Image:
    return Image({}, {}, {1: Channel(1, mode=mode), 2: Channel(2, mode=mode)})


PROGRAMS = {"sect.cnc": "N10 F1\nN50 F2\nN100 F3\nM30", "/usr/user/p1.cnc": "F7\nM30"}


@pytest.mark.covers(
    "cpl.MCOPS.4", "cpl.MCOPS.3", "cpl.MCOPS.4.code.1", "cpl.MCOPS.4.code.2", "cpl.MCOPS.4.code.64"
)
def test_examples_select_and_search_programs() -> None:
    cell = Cell(channels(Mode.AUTOMATIC), PROGRAMS)
    ran = cell.run(
        """10 #A%=MCOPS(4,1,"sect.cnc","N50","N100",1)
20 #B%=MCOPS(4,2,"sect.cnc",,,2)
30 #C%=MCOPS(3,2,"N50","N100")
40 #D%=MCOPS(4,1,"/usr/user/p1.cnc",,,64)
"""
    )
    assert [ran[name] for name in ("#A%", "#B%", "#C%", "#D%")] == [0, 0, 0, 0]
    assert cell.partner.linked == {"sect.cnc"}
    job = cell.partner.stations[2].job
    assert job is not None
    assert (job.at, job.last) == (1, 2)
    assert cell.image.channels[1].program == "/usr/user/p1.cnc"


@pytest.mark.covers("cpl.MCOPS.2", "cpl.MCOPS.5", "cpl.MCOPS.7", "cpl.MCOPS.2.type.2", "cpl.MCOPS.5.type.2")
def test_examples_reset_leave_and_switch_channels() -> None:
    cell = Cell(channels(Mode.MDI), PROGRAMS)
    for channel in cell.image.channels.values():
        channel.reselection = True
    ran = cell.run(
        """10 #A%=MCOPS(4,1,"F1000",,,32)
20 #B%=MCOPS(7,2,5)
30 #C%=MCOPS(4,2,"sect.cnc",,,2)
40 #D%=MCOPS(5,2,2)
"""
    )
    assert [ran[name] for name in ("#A%", "#B%", "#C%", "#D%")] == [0, 0, 0, 0]
    job = cell.partner.stations[1].job
    assert job is not None
    assert job.blocks == ["F1000"]
    second = cell.image.channels[2]
    assert (second.mode, second.sav, second.program) == (Mode.AUTOMATIC, Sav.INACTIVE, "")
    ran = cell.run('10 #C%=MCOPS(4,2,"sect.cnc",,,2)\n20 #A%=MCOPS(2,2,2)\n')
    assert [ran["#C%"], ran["#A%"]] == [0, 0]
    cell.partner.advance(1)
    assert (second.sav, second.program) == (Sav.INACTIVE, "")


@pytest.mark.covers("cpl.MCODS", "cpl.MCOPS", "cpl.MCODS.buffertype", "cpl.MCODS.constants")
@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("E%=MCODS(7,1,0,B,1)", "a variable is needed"),
        ("E%=MCODS(3,1,V,B,3)", "INVALID FIELD LIMIT"),
        ("E%=MCODS(3,1,U,B,1)", "INVALID PARAMETER"),
        ('E%=MCODS(3,1,V,B,"1")', "INVALID"),
        ("E%=MCOPS(7)", "MCOPS"),
        ("E%=MCOPS(7,2,)", "INVALID PARAMETER"),
        ("E%=MCOPS(7,2,5.5)", "INVALID PARAMETER"),
    ],
)
def test_calls_that_are_wrong_stop_the_program_with_their_place(line: str, what: str) -> None:
    with pytest.raises(ProgramError) as caught:
        Cell().run(f"10 V=0\n20 DIM B(2)\n30 {line}\n")
    assert what in caught.value.what
    assert caught.value.position is not None
    assert caught.value.position.line == 3


MMC = """10 DIM PROGNAME$(50)
20 PROGNAME$ = "WinProg"
30 INTPAR% = 1
40 REALPAR = 1.1
50 I% = MMC(PROGNAME$, INTPAR%, REALPAR)
60 #I%=I% : #INT%=INTPAR% : #REAL=REALPAR
70 #LEN%=LEN(PROGNAME$)
"""


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.1")
def test_without_a_client_mmc_answers_1_at_once() -> None:
    cell = Cell()
    ran = cell.run(MMC)
    assert (ran["#I%"], ran["#INT%"], ran["#LEN%"], cell.pauses) == (1, 1, 7, 0)


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.0")
def test_a_client_gets_names_and_values_and_the_program_waits_for_its_answer() -> None:
    cell = Cell()
    seen: list[list[tuple[str, object]]] = []

    def client(variables: Sequence[Sent]) -> bool:
        seen.append([(each.name, each.value) for each in variables])
        if len(seen) < 4:
            return False
        variables[0].value = "ready"
        variables[1].value = 2
        variables[2].value = 2.7
        return True

    cell.clients.client = client
    ran = cell.run(MMC)
    assert seen == [[("PROGNAME$", "WinProg"), ("INTPAR%", 1), ("REALPAR", 1.100000023841858)]] * 4
    assert (ran["#I%"], ran["#INT%"], ran["#REAL"], ran["#LEN%"]) == (0, 2, 2.700000047683716, 5)
    assert cell.pauses == 3


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.2")
@pytest.mark.parametrize("value", [None, "x", True, 2.5, 2**31])
def test_an_error_in_the_client_changes_nothing(value: object) -> None:
    cell = Cell()

    def client(variables: Sequence[Sent]) -> bool:
        variables[2].value = 9.0
        if value is None:
            raise ClientError("no")
        variables[1].value = value
        return True

    cell.clients.client = client
    ran = cell.run(MMC)
    assert (ran["#I%"], ran["#INT%"], ran["#REAL"]) == (2, 1, 1.100000023841858)


@pytest.mark.covers("cpl.MMC", "cpl.MMC.ret.0")
def test_fields_truth_values_and_nul_can_be_sent_20_variables_at_most() -> None:
    cell = Cell()
    seen: list[object] = []

    def client(variables: Sequence[Sent]) -> bool:
        seen.extend(each.value for each in variables)
        field = variables[0].value
        assert isinstance(field, dict)
        field[2] = 7
        variables[1].value = None
        variables[2].value = False
        return True

    cell.clients.client = client
    ran = cell.run(
        "10 DIM A%(3)\n20 A%(1)=5\n30 B?=TRUE\n40 C=3\n50 #E%=MMC(A%,C,B?)\n"
        "60 #A%=A%(1)*10+A%(2) : #B?=B? : #N?=C=NUL\n"
    )
    assert seen[1:] == [3.0, True]
    assert (ran["#E%"], ran["#A%"], ran["#B?"], ran["#N?"]) == (0, 57, False, True)
    with pytest.raises(ProgramError, match="MMC"):
        cell.run(f"10 E%=MMC({','.join(f'V{number}' for number in range(21))})\n")
    many = ",".join(f"V{number}" for number in range(20))

    def counting(variables: Sequence[Sent]) -> bool:
        for number, each in enumerate(variables):
            each.value = number + 0.5
        return len(variables) == 20

    cell.clients.client = counting
    ran = cell.run(f"10 #E%=MMC({many})\n20 #A=V0 : #B=V18 : #C=V19\n")
    assert [ran[name] for name in ("#E%", "#A", "#B", "#C")] == [0, 0.5, 18.5, 19.5]


@pytest.mark.covers("cpl.MMC")
def test_a_field_of_texts_comes_and_goes_as_texts() -> None:
    clients = Clients()
    text = CharacterField(4)
    text.assign("ABCD")

    def client(variables: Sequence[Sent]) -> bool:
        variables[0].value = "EFGHIJ"
        return True

    clients.client = client
    assert Mmc(clients).call(text, names=("T$",)) == 0
    assert text.text == "EFGH"
    with pytest.raises(Fault):
        Mmc(clients).call(text, names=("T$",), open=True)
