"""The addresses that compiled code knows, as plain integers, and what a write to them sets off."""

from __future__ import annotations

from polycnc.controllers.imc.core._parameters import PARAMETERS, WORDS, address

# A coordinate system: the second one lies PCS words further.
PCS = address("pcsvel") - address("mcsvel")
VEL = address("mcsvel")
TGVEL = address("mcstgvel")
SLOPE = address("mcsslope")
POS_FRACTION = address("mcspos") - 1  # 16 bits below the position, as of 48 bits in all
TGPOS = address("mcstgpos")
DIST = address("mcsdist")
MAXVEL = address("mcsmaxvel")
ACCEL = address("mcsaccel")
DECEL = address("mcsdecel")
TRACK = address("mcstrack")
GO = address("mcsgo")
SYSTEM_MOVING = address("mcsmoving")

ENCPFACTOR = address("encpfactor")
ENCPVEL = address("encpvel")
ENCP_FRACTION = address("encp") - 1
ENCSFACTOR = address("encsfactor")
ENCSVEL = address("encsvel")
ENCS_FRACTION = address("encs") - 1
RUN = address("run")
STATUS = address("status")
ERROR = address("error")
POSERRLIM = address("poserrlim")
SMOOTH = address("smooth")
TRACKWIN = address("trackwin")
SETTLEWIN = address("settlewin")
SETTLEN = address("settlen")
STOPFILT = address("stopfilt")
STOPMODE = address("stopmode")
EXITFILT = address("exitfilt")
PSOFTLIM = address("psoftlim")
NSOFTLIM = address("nsoftlim")
BREAKP = address("breakp")
HOMEPOS = address("homepos")
LOWVEL = address("lowvel")
HIGHVEL = address("highvel")
HOMESEQ = address("homeseq")
GOHOME = address("gohome")
SETHOME = address("sethome")
HOMED = address("homed")
INDEX_NUM = address("indexNum")
CLEAR = address("clear")
VELLIM = address("vellim")
ACCELLIM = address("accellim")
HOMESTPOS = address("homestpos")
MOVEINPATH = (address("moveinpath1"), address("moveinpath2"))
HALTSTEP = address("haltstep")
HALTMODE = address("haltmode")
MASTER = address("master")
GEARSRC = address("gearsrc")
ENGEAR = address("engear")
GEAROUTMOD = address("gearoutmod")
SHIFTMASTER = address("shiftmaster")
GEARRATIO = address("gearratio")
GEAROUTVEL = address("gearoutvel")
CIRPOS = address("cirpos")
CIRAXIS = address("ciraxis")
BICIRAXIS = address("biciraxis")
ENASYN = address("enasyn")
STARTSYN = address("startsyn")
SYNTYPE = address("syntype")
SYNSRC = address("synsrc")
SYNAXIS = address("synaxis")
SYNSRCVAR = address("synsrcvar")
SLAVEDIST = address("slavedist")
SLAVEABS = address("slaveabs")
SEGSTART = address("segstart")
SEGEND = address("segend")
PATHABS = address("pathabs")
CIRSWAP = address("cirswap")
PROFILING = address("profiling")
SMOOTHING = address("smoothing")
CONTOURING = address("contouring")
MOVING = address("moving")
MOTION = address("motion")
OUTSETTLE = address("outsettle")
OUTTRACK = address("outtrack")
POSERR = address("poserr")
CURPOS_FRACTION = address("curpos") - 1
CURVEL = address("curvel")
CAPPOS = address("cappos")
ENCPCTR = address("encpctr")
COUNTER = address("counter")
ENA = address("ena")
AIO = address("aio")
AIOCTR = address("aioctr")
AIOLAT = address("aiolat")
CAPFIFO = address("capfifo")
CAPFIFOCNT = address("capfifocnt")

STARTGROUP = address("startgroup")
GROUPNUM = address("groupnum")
GROUP = address("group_x")
GROUPSMOOTH = address("groupsmooth")
TIMER = address("timer")
EVENTS = address("events")
EMSTOP = address("emstop")
HPAUSE = address("hpause")
TICKS = address("ticks")
DELAY = address("delayus")
GIN = address("gin1")
GINLAT = address("gin1lat")
COUNTS = tuple(address(name) for name in ("ififocnt", "qfifocnt", "PFIFOcnt1", "PFIFOcnt2", "cfifocnt"))
WAIT_TIMES = (0, address("qwaittime"), address("pwaittime1"), address("pwaittime2"), 0)

# A path space: the second one lies SPACE words further.
SPACE = address("startpath2") - address("startpath1")
STARTPATH = address("startpath1")
PATHMOVING = address("pathmoving1")
ARCDIR = address("arcdir1")
ASSEGLEN = address("asseglen1")
PATHVEL = address("pathvel1")
PATHACC = address("pathacc1")
PATHAXISNUM = address("pathaxisnum1")
FEEDRATE = address("feedrate1")
SEGMAP = address("segmap_x1")
SEGTGVEL = address("segtgvel1")
SEGENDVEL = address("segendvel1")
SEGID = address("segID1")
SEGLEN = address("seglen1")
RADIUS = address("radius1")

# What a write to a word sets off. Up to DO_ENASYN it is a command that the axis takes in its next turn.
STORE = 0
DO_RUN, DO_GO_MCS, DO_GO_PCS, DO_TGVEL_MCS, DO_TGVEL_PCS = 1, 2, 3, 4, 5
DO_GOHOME, DO_SETHOME, DO_CLEAR, DO_ENGEAR, DO_STARTSYN, DO_SYNSRCVAR, DO_ENASYN = 6, 7, 8, 9, 10, 11, 12
REFUSE = 13
DO_CLEAR_FIFO, DO_CLEARIMC, DO_EVENTS = 14, 15, 16
DO_CAPTURE, DO_POPCAP, DO_CLRCAP, DO_ZERO, DO_CLRENCS, DO_CLEAR_BITS = 17, 18, 19, 20, 21, 22

_ACTIONS = {
    "run": DO_RUN,
    "mcsgo": DO_GO_MCS,
    "pcsgo": DO_GO_PCS,
    "mcstgvel": DO_TGVEL_MCS,
    "pcstgvel": DO_TGVEL_PCS,
    "gohome": DO_GOHOME,
    "sethome": DO_SETHOME,
    "clear": DO_CLEAR,
    "engear": DO_ENGEAR,
    "startsyn": DO_STARTSYN,
    "enasyn": DO_ENASYN,
    "synsrcvar": DO_SYNSRCVAR,
    "clrififo": DO_CLEAR_FIFO,
    "clrqfifo": DO_CLEAR_FIFO,
    "clrPFIFO1": DO_CLEAR_FIFO,
    "clrPFIFO2": DO_CLEAR_FIFO,
    "clrCFIFO": DO_CLEAR_FIFO,
    "clearimc": DO_CLEARIMC,
    "events": DO_EVENTS,
    "capture": DO_CAPTURE,
    "capture2": DO_CAPTURE,
    "popcapfifo": DO_POPCAP,
    "clrcapfifo": DO_CLRCAP,
    "counter": DO_ZERO,
    "clrencs": DO_CLRENCS,
    "aiolat": DO_CLEAR_BITS,
    "gin1lat": DO_CLEAR_BITS,
    "gin2lat": DO_CLEAR_BITS,
}


def word_table() -> list[tuple[int, int]]:
    """Return for every address whether it is the card's (1) or an axis' (0), and what a write does."""
    table = [(0, STORE)] * WORDS
    for each in PARAMETERS.values():
        shared = 1 if each.scope == "G" else 0
        action = REFUSE if each.access == "ro" else _ACTIONS.get(each.name, STORE)
        for word in range(each.address, each.address + each.words):
            table[word] = (shared, max(action, table[word][1]))
    return table
