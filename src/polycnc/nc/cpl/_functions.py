"""The functions and commands of CPL: how many arguments they take and what they return (Manual 003, annex A.2)."""

from __future__ import annotations

from dataclasses import dataclass

from polycnc.nc.cpl._variables import Kind

MANY = 1000


@dataclass(frozen=True, slots=True)
class Function:
    """A function or command.

    `count` is the least and the most of its arguments, `results` the places of those that are variables which it
    sets (from `results[0]` on, if `listed`). What `listed` functions get tells its type, and a semicolon may end it.
    `own` functions are CPL's, the others are the control's. A `waiting` one may have to wait for its answer;
    a `named` one gets the names of its variables too, as `names`.
    """

    name: str
    kind: Kind
    count: tuple[int, int]
    usage: str
    results: tuple[int, ...] = ()
    own: bool = False
    waiting: bool = False
    listed: bool = False
    settable: bool = False
    command: bool = False
    named: bool = False


def _rows() -> list[Function]:
    f = Function
    own = [
        *(f(name, "R", (1, 1), f"{name}(angle)", own=True) for name in ("SIN", "COS", "TAN")),
        *(f(name, "R", (1, 1), f"{name}(value)", own=True) for name in ("ASIN", "ACOS", "ATAN", "SQRT")),
        f("ABS", "X", (1, 1), "ABS(value)", own=True),
        f("INT", "I", (1, 1), "INT(value)", own=True),
        f("ROUND", "I", (1, 1), "ROUND(value)", own=True),
        f("BCD", "I", (1, 1), "BCD(binary value)", own=True),
        f("BIN", "I", (1, 1), "BIN(BCD value)", own=True),
        f("LEN", "I", (1, 1), "LEN(text)", own=True),
        f("INSTR", "I", (2, 3), "INSTR(wanted,text[,start])", own=True),
        f("ASC", "I", (1, 1), "ASC(text)", own=True),
        f("CHR$", "S", (1, 1), "CHR$(code)", own=True),
        f("STR$", "S", (1, 2), "STR$([format,]value)", own=True),
        f("VAL", "X", (1, 1), "VAL(text)", own=True),
        f("MID$", "S", (2, 3), "MID$(text,start[,number])", own=True, settable=True),
        f("TRIM$", "S", (1, 2), 'TRIM$(text[,"L" or "R"])', own=True),
    ]
    positions = [
        *(
            f(name, "D", (1, 2), f"{name}(axis[,type])")
            for name in ("AXO", "CPOS", "CPROBE", "PPOS", "PROBE")
        ),
        *(f(name, "D", (1, 3), f"{name}(axis[,type[,channel]])") for name in ("WPOS", "MPOS")),
        *(f(name, "D", (1, 1), f"{name}(axis)") for name in ("APOS", "SPOS")),
        f("COF", "D", (1, 2), "COF(axis[,type])"),
        f("DPC", "D", (1, 2), "DPC(axis[,type])"),
        f("SCL", "D", (1, 3), "SCL(selection[,axis[,type]])"),
    ]
    system = [
        f("FXC", "D", (1, 4), "FXC(axis[,G address[,table[,unit]]])", settable=True),
        f("FXCR", "I", (2, 3), "FXCR(channel or layout,table[,classification])"),
        f("FXDEL", "I", (2, 2), "FXDEL(table,axis)"),
        f("FXINS", "I", (3, 4), "FXINS(table,position,axis name[,axis type])"),
        f("TC", "D", (1, 4), "TC(selection[,group[,table[,unit]]])", settable=True),
        f("TDA", "X", (3, 4), "TDA(sector,place,field[,table])", settable=True),
        f("MCA", "X", (2, 3), "MCA(block,index[,channel])"),
        f("NCF", "S", (1, 1), "NCF(NC function)"),
        f("SCS", "X", (3, 4), "SCS(axis,type,number[,result])", results=(3,)),
        f("SCSL", "I", (4, 5), "SCSL(axis,type,number,file[,result])", results=(4,)),
        f("SD", "I", (1, 4), "SD(group[,index[,index[,index]]])"),
        f("SDR", "D", (1, 3), "SDR(group[,index[,index]])"),
        f("AXP", "X", (2, 3), "AXP(axis,position[,axis type])"),
        f("IC", "B", (1, 3), "IC(bit[,group[,index]])", settable=True),
        f("PLC", "I", (3, 4), "PLC(type,module,address,size)", settable=True),
        f("CLOCK", "I", (0, 0), "CLOCK"),
        f("DATE", "S", (0, 0), "DATE"),
        f("TIME", "S", (0, 0), "TIME"),
        f("GETERR", "I", (3, 4), "GETERR(channel,[category],field[,number])", results=(2,)),
        f(
            "MCODS",
            "I",
            (5, 8),
            "MCODS(type,channel,version,buffer,size[,axis][,ID][,P1])",
            results=(2, 3),
            waiting=True,
        ),
        f("MCOPS", "I", (2, 6), "MCOPS(function,channel[,P1[,P2[,P3[,P4]]]])", waiting=True),
        f(
            "MMC",
            "I",
            (1, 20),
            "MMC(variable{,variable})",
            results=(0,),
            listed=True,
            waiting=True,
            named=True,
        ),
    ]
    files = [
        f("OPENW", "I", (2, 5), "OPENW(number,name[,length][,remark][,record length])", command=True),
        f("OPENR", "I", (2, 3), "OPENR(number,name[,record length])", command=True),
        f("PRN#", "I", (1, MANY), "PRN#(number,{value}[;])", listed=True, command=True),
        f("INP#", "I", (2, MANY), "INP#(number,{variable}[;])", results=(1,), listed=True, command=True),
        f("REWRITE", "I", (1, 1), "REWRITE(number)", command=True),
        f("CLOSE", "I", (1, 1), "CLOSE(number)", command=True),
        f("EOF", "B", (1, 1), "EOF(number)"),
        f("FILEPOS", "I", (1, 2), "FILEPOS(number[,mode])"),
        f("SEEK", "I", (2, 3), "SEEK(number,place[,offset])", command=True),
        f("FILESIZE", "I", (1, 2), "FILESIZE(number[,k])"),
        f("ERASE", "I", (1, 1), "ERASE(name)"),
        f("FILEACCESS", "I", (1, 1), "FILEACCESS(name)"),
        f("FILEDATE", "S", (1, 2), "FILEDATE(name[,mode])"),
        f("LJUST", "I", (0, 0), "LJUST", command=True),
        f("NJUST", "I", (0, 0), "NJUST", command=True),
    ]
    screen = [
        f("DSP", "I", (3, MANY), "DSP(line,column,{value})", listed=True, command=True),
        f("PRN", "I", (3, 4), "PRN(line,column,text[,variable])", results=(3,), listed=True, command=True),
        f("INP", "I", (1, 1), "INP(variable)", results=(0,), listed=True, command=True, waiting=True),
        f("INKEY", "I", (0, 0), "INKEY"),
        f(
            "SFK",
            "I",
            (1, 9),
            "SFK(variable,[text],...)",
            results=(0,),
            command=True,
            waiting=True,
        ),
        *(f(name, "I", (0, 0), name, command=True) for name in ("CSF", "DLF", "CLG", "CLR", "CLS", "ENDDLG")),
        f("DLG", "I", (0, 0), "DLG", command=True),
        f("TFO", "I", (1, 4), "TFO(font,size,cut,orientation)", command=True),
        f(
            "COL",
            "I",
            (1, 6),
            "COL([graphics],[text],[background],[table],[softkeys],[background])",
            command=True,
        ),
        f("RGB", "I", (4, 4), "RGB(code,red,green,blue)", command=True),
        f("GMD", "I", (1, 1), "GMD(line type)", command=True),
        f("GWD", "I", (4, 4), "GWD(left,right,bottom,top)", command=True),
        f("MWD", "I", (4, 4), "MWD(left,right,bottom,top)", command=True),
        f("LIN", "I", (2, 4), "LIN([x,y,]x,y)", command=True),
        f("CIR", "I", (1, 6), "CIR(x,y,radius)", command=True),
        f("FIL", "I", (4, 5), "FIL(x,y,pattern,colour[,contour colour])", command=True),
        f("GPR", "I", (3, 3), "GPR(x,y,text)", command=True),
        f("BMP", "I", (3, 4), "BMP(x,y,file[,copy type])", command=True),
    ]
    return [*own, *positions, *system, *files, *screen]


FUNCTIONS: dict[str, Function] = {function.name: function for function in _rows()}
"""Every function and command by its name."""
