"""Arguments that callers mean, for functions that anything at random is hardly ever right for."""

from __future__ import annotations

import random
import struct
from typing import Any

from polycnc.controllers.apci import pcap
from polycnc.controllers.imc import imclib
from support.c_hold import Meant

_PATH = {"path_no": 1, "nmod": 0, "axis": 1}

FANUC = Meant(
    {
        "cnc_abspoint": {**_PATH, "feed": 100, "idb": struct.pack("<hi", 1, 300)},
        "cnc_incpoint": {**_PATH, "feed": 100, "idb": struct.pack("<hi", 1, 300)},
        "cnc_coordre": {**_PATH, "idb": struct.pack("<hi", 1, 0)},
        "cnc_dwell": {**_PATH, "idb": struct.pack("<hi", 1, 20)},
        "cnc_absolute": {"axis": 2, "length": 8},
        "cnc_machine": {"axis": -1, "length": 20},
        "cnc_rdalmhistry": {"s_no": 1, "e_no": 2, "length": 6 + 48 * 2},
        "cnc_rdophistry": {"s_no": 1, "e_no": 2, "length": 6 + 8 * 2},
        "cnc_rdalminfo": {"type": 0, "alm_type": 8, "length": 6},
        "cnc_rdopmsg": {"type": 0, "length": 262},
        "cnc_rdparam": {"number": 1420, "axis": 2, "length": 8},
        "cnc_rdproginfo": {"type": 0, "length": 12},
        "cnc_rdmacro": {"number": 503, "length": 10},
        "cnc_wrmacro": {"number": 503, "length": 10, "mcr_val": 271, "dec_val": 2},
        "cnc_rdmacror": {"s_number": 500, "e_number": 502, "length": 24},
        "cnc_wrmacror": {"length": 18, "macror": struct.pack("<hhhihih", 500, 0, 501, 31, 1, 42, 0)},
        "cnc_wrparas": {"length": 8, "param": struct.pack("<hhi", 1420, 2, 14000)},
        "cnc_wrparam": {"length": 8, "param": struct.pack("<hhi", 1420, 2, 13000)},
        "cnc_wrsets": {"length": 8, "set": struct.pack("<hhi", 6711, 0, 37)},
        "cnc_clearophis": {"slct": 0},
        "cnc_diagnosr": {"s_number": 300, "axis": 1, "e_number": 300, "length": 8},
        "cnc_rdtofs": {"number": 2, "type": 0, "length": 8},
        "cnc_wrtofs": {"number": 2, "type": 0, "length": 8, "data": 35},
        "cnc_rdtofsr": {"s_number": 1, "type": 0, "e_number": 3, "length": 18},
        "cnc_wrtofsr": {"length": 14, "tofsr": struct.pack("<hhhii", 1, 0, 2, 70, 80)},
        "cnc_delete": {"number": 8},
        "cnc_search": {"number": 7},
        "cnc_upstart": {"number": 7},
        "cnc_upload": {"number": 12},
        "cnc_seqsrch": {"seq_no": 20},
        "cnc_wrmdiprog": {"length": 6, "data": b"G4X1;\n"},
        "cnc_wrmdipntr": {"crntpntr": 0},
        "cnc_wrrelpos": {"length": 8, "wrrelpos": struct.pack("<hhi", 0, 2, 500)},
        "cnc_wrhissgnl": {"sig": struct.pack("<hhhhBB", 0, 1, 1, 43, 2, 0xFF) + bytes(114)},
        "pmc_rdpmcrng": {"adr_type": 9, "data_type": 0, "s_number": 10, "e_number": 13, "length": 12},
        "pmc_wrpmcrng": {"length": 10, "buf": struct.pack("<hhhhBB", 9, 0, 10, 11, 3, 4)},
    }
)
FANUC_MODES = ("MEM", "EDIT", "MDI")
PROGRAM = "O0007\nN10G4X0.02\nN20M99\n"


def _segment(dice: random.Random) -> Any:
    made = imclib.PFIFOSegData(datanum=2, CenterX=100, CenterY=0, dir=1)
    made.SegEndData[0] = made.SegEndData[1] = dice.randrange(50, 90)
    return made


def _segment_info(dice: random.Random) -> Any:
    return imclib.PFIFOSegInfo(SegTgVel=200_000, SegEndVel=0, data=_segment(dice))


def _described(dice: random.Random) -> Any:
    made = imclib.WR_MUL_DES(addr=imclib.mcstgposLoc, axis=dice.randrange(3), len=2)
    made.data[0] = dice.randrange(90)
    return made


def _event(dice: random.Random) -> Any:
    made = imclib.EventInfo(EventCMD=imclib.CMD_SET16, Src1_loc=imclib.mcstgposLoc, dest_loc=imclib.mcsgoLoc)
    made.Src2.data16.data = dice.randrange(9)
    return made


_FEW = {
    "IMC_GetMulParam": {"NumofArr": 3},
    "IMC_SetMulParam": {"ArrNum": 3, "fifoSel": imclib.SEL_IFIFO},
    "IMC_InstallEvent": {"EventNum": 2, "fifoSel": imclib.SEL_IFIFO},
}
IMC = Meant(
    _FEW
    | {
        "IMC_AddSpiral": {"fifoSel": imclib.SEL_PFIFO1, "dir": 1},
        "IMC_AddSpiralWithVel": {"fifoSel": imclib.SEL_PFIFO1, "dir": 1},
        "IMC_WaitParamBit": {
            "paramloc": imclib.runLoc,
            "bit": 1,
            "val": 0,
            "timeout": 1,
            "axis": 0,
            "fifoSel": imclib.SEL_QFIFO,
        },
    }
    | {
        name: {"fifoSel": imclib.SEL_PFIFO1}
        for name in ("IMC_AddArcLine", "IMC_AddArcLineWithVel", "IMC_AddLineN", "IMC_AddLineNWithVel")
    },
    {
        "PFIFOSegData": _segment,
        "PFIFOSegInfo": _segment_info,
        "WR_MUL_DES": _described,
        "EventInfo": _event,
    },
)


def _axes(dice: random.Random) -> Any:
    return pcap.AS.of(*dice.sample(range(3), dice.randint(1, 3)))


def _move(dice: random.Random) -> Any:
    made = pcap.LMP(ac=300.0, vl=20.0, tvl=0.0)
    for k in range(3):
        made.dtm[k] = dice.randrange(-3, 4)
    return made


def _turn(kind: Any) -> Any:
    def make(dice: random.Random) -> Any:
        made = kind(ac=300.0, vl=20.0, tvl=0.0, phi=dice.choice((90.0, -45.0)), dtca1=2.0, dtca2=1.0)
        if hasattr(made, "pn3"):
            made.pn3 = 1.0
        return made

    return make


def _record(dice: random.Random) -> Any:
    return pcap.TSRP(
        an=dice.randrange(3), tp=dice.randrange(-3, 4), jac=300.0, jvl=20.0, gf=1.0, jovr=1.0, mcp=5
    )


APCI = Meant(
    {},
    {
        "AS": _axes,
        "LMP": _move,
        "CMP": _turn(pcap.CMP),
        "HMP": _turn(pcap.HMP),
        "HMP3D": _turn(pcap.HMP3D),
        "TSRP": _record,
    },
)
