"""The functions and commands of CPL by their names (Manual 003, annex A.2): its own, and those of the control.

One of its own is a Python function with `@function` in `_numbers` or `_strings`, and needs nothing else. One of the
control is a row here; a `Host` says what it does.
"""

from __future__ import annotations

from polycnc.nc.cpl import _numbers, _strings
from polycnc.nc.cpl._function import Function, functions_of

_F = Function
MOST_OF_MMC = 20
"""How many variables MMC shows."""
POSITIONS = (
    _F("AXO(axis[,type])", "D", "Return the last G92 shift of a coordinate."),
    _F("CPOS(axis[,type])", "D", "Return the last programmed position of a coordinate."),
    _F("CPROBE(axis[,type])", "D", "Return the measured value of a coordinate."),
    _F("PPOS(axis[,type])", "D", "Return where an axis was when the probe switched, with its shifts."),
    _F(
        "PROBE(axis[,type])",
        "D",
        "Return where an axis was when the probe switched, from the machine's zero.",
    ),
    _F("WPOS(axis[,type[,channel]])", "D", "Return the command position of a coordinate."),
    _F("MPOS(axis[,type[,channel]])", "D", "Return the command position of an axis from the machine's zero."),
    _F("APOS(axis)", "D", "Return the actual position of a physical axis from the machine's zero."),
    _F("SPOS(axis)", "D", "Return the command position of a physical axis from the machine's zero."),
    _F("COF(axis[,type])", "D", "Return the last contour shift (G60) of a coordinate."),
    _F(
        "DPC(axis[,type])",
        "D",
        "Return the last workpiece position compensation (G138): a shift, 0 the angle.",
    ),
    _F(
        "SCL(selection[,axis[,type]])",
        "D",
        "Return the angle, pole or factor that G37 or G38 programmed last.",
    ),
)
SYSTEM = (
    _F("FXC(axis[,G address[,table[,unit]]])", "D", "Return an axis zero shift, or set it.", settable=True),
    _F("FXCR(channel or layout,table[,classification])", "I", "Make a table of zero shifts."),
    _F("FXDEL(table,axis)", "I", "Delete a column of a table of zero shifts."),
    _F("FXINS(table,position,axis name[,axis type])", "I", "Insert a column into a table of zero shifts."),
    _F("TC(selection[,group[,table[,unit]]])", "D", "Return a tool compensation, or set it.", settable=True),
    _F("TDA(sector,place,field[,table])", "X", "Return a field of the tool database, or set it.", settable=True),
    _F("MCA(block,index[,channel])", "X", "Return a value of a MACODA parameter."),
    _F("NCF(NC function)", "S", "Return the NC function of the same modal group that was programmed last.",
       new_text=True),
    _F("SCS(axis,type,number[,result])", "X", "Return a parameter of a drive.", results=(3,)),
    _F("SCSL(axis,type,number,file[,result])", "I", "Write a list of a drive into a file.", results=(4,)),
    _F("SD(group[,index[,index[,index]]])", "I", "Return system data that are INTEGER."),
    _F("SDR(group[,index[,index]])", "D", "Return system data that are REAL."),
    _F("AXP(axis,position[,axis type])", "X", "Return the word of an axis that is selected by its index."),
    _F("IC(bit[,group[,index]])", "B", "Return a signal of the interface to the PLC, or set it.", settable=True),
    _F("PLC(type,module,address,size)", "I", "Return data of the PLC, or set them.", least=3, settable=True),
    _F("CLOCK", "I", "Return the time of the control in ms."),
    _F("DATE", "S", "Return the date as DD.MM."),
    _F("TIME", "S", "Return the time as HH.MM.SS."),
    _F("GETERR(channel,[category],field[,number])", "I", "Put present errors into a field; return how many.",
       results=(2,)),
    _F("MCODS(type,channel,version,buffer,size[,axis][,ID][,P1])", "I", "Read data of a channel into a variable.",
       results=(2, 3), waiting=True),
    _F("MCOPS(function,channel[,P1[,P2[,P3[,P4]]]])", "I", "Have a channel do something.", waiting=True),
    _F("MMC(variable{,variable})", "I", "Show variables to a client, and wait until it has them.",
       most=MOST_OF_MMC, results=(0,), listed=True, waiting=True, named=True),
)  # fmt: skip
FILES = (
    _F("OPENW(number,name[,length][,remark][,record length])", "I", "Open a file to write at its end.", command=True),
    _F("OPENR(number,name[,record length])", "I", "Open a file for reading.", command=True),
    _F("PRN#(number,{value}[;])", "I", "Write values into a file; 0 shows them as a message.",
       least=1, listed=True, command=True),
    _F("INP#(number,{variable}[;])", "I", "Read variables from a file.", results=(1,), listed=True, command=True),
    _F("REWRITE(number)", "I", "Discard what is in a file.", command=True),
    _F("CLOSE(number)", "I", "Close a file.", command=True),
    _F("EOF(number)", "B", "Tell whether the end of a file is reached."),
    _F("FILEPOS(number[,mode])", "I", "Return the place in a file: 1 the byte, 2 the record, 3 the byte in it."),
    _F("SEEK(number,place[,offset])", "I", "Go to a place in a file.", command=True),
    _F("FILESIZE(number[,k])", "I", "Return the size of a file: 1 and 2 in bytes, 3 and 4 in records."),
    _F("ERASE(name)", "I", "Erase a file; 0 done, 1 it is not there, 2 protected, 3 in use."),
    _F("FILEACCESS(name)", "I", "Return -1 for no file, else 1 execute, 2 write, 4 read, 8 folder, 16 in use."),
    _F("FILEDATE(name[,mode])", "S", "Return the date of a file, or (2) its time."),
    _F("LJUST", "I", "Write numbers without blanks before them from here on.", command=True),
    _F("NJUST", "I", "Write numbers in their formats again.", command=True),
)  # fmt: skip
SCREEN = (
    _F("DSP(line,column,{value})", "I", "Show values from a line and column on.", listed=True, command=True),
    _F("PRN(line,column,text[,variable])", "I", "Show a text, with a place for a variable.",
       results=(3,), listed=True, command=True),
    _F("INP(variable)", "I", "Have a variable put in at its place.",
       results=(0,), listed=True, command=True, waiting=True),
    _F("INKEY", "I", "Return the code of a key that was pressed, 0 without one."),
    _F("SFK(variable,[text],...)", "I", "Show softkeys, and wait for one.",
       least=1, most=9, results=(0,), command=True, waiting=True),
    _F("CSF", "I", "Delete the softkeys.", command=True),
    _F("DLF", "I", "Bring the dialog window to the front.", command=True),
    _F("CLG", "I", "Clear the area for CPL, and move its window to the background.", command=True),
    _F("CLR", "I", "Clear the graphic window.", command=True),
    _F("CLS", "I", "Clear the whole screen.", command=True),
    _F("ENDDLG", "I", "End a dialog.", command=True),
    _F("DLG", "I", "Begin a dialog, in which PRN and INP are allowed.", command=True),
    _F("TFO(font,size,cut,orientation)", "I", "Select the font of texts.", least=1, command=True),
    _F("COL([graphics],[text],[background],[table],[softkeys],[background])", "I", "Select colours.",
       least=1, command=True),
    _F("RGB(code,red,green,blue)", "I", "Set a colour of table 3.", command=True),
    _F("GMD(line type)", "I", "Select the type of lines.", command=True),
    _F("GWD(left,right,bottom,top)", "I", "Set the graphic window, in pixels.", command=True),
    _F("MWD(left,right,bottom,top)", "I", "Set the coordinates of the graphic window's edges.", command=True),
    _F("LIN([x,y,]x,y)", "I", "Draw a line.", command=True),
    _F("CIR(x,y,radius)", "I", "Draw a circle, or an arc by start, end and centre.", least=1, most=6, command=True),
    _F("FIL(x,y,pattern,colour[,contour colour])", "I", "Fill a closed contour.", command=True),
    _F("GPR(x,y,text)", "I", "Write a text at a pixel.", command=True),
    _F("BMP(x,y,file[,copy type])", "I", "Show a bitmap.", command=True),
)  # fmt: skip

GROUPS: dict[str, tuple[Function, ...]] = {
    "Numbers": tuple(functions_of(vars(_numbers))),
    "Texts": tuple(functions_of(vars(_strings))),
    "Positions": POSITIONS,
    "Data of the control": SYSTEM,
    "Files": FILES,
    "Dialogs and graphics": SCREEN,
}
"""Every function and command, by what it is about."""

STEADY = frozenset(
    """
    AXO CPOS CPROBE PPOS PROBE WPOS MPOS APOS SPOS COF DPC SCL FXC TC TDA MCA NCF SD SDR AXP IC PLC EOF FILEPOS FILESIZE
    FILEACCESS FILEDATE GETERR
    """.split()  # noqa: SIM905 (a list of words in quotes is no easier to read)
)
"""Functions that only read, and what they read stays as it is while axes stand and no other channel works."""
TIMED = frozenset(
    {"CLOCK", "DATE", "TIME", "IC", "PLC", "WPOS", "MPOS", "APOS", "SPOS", "SD", "SDR", "INKEY"}
)
"""Functions whose answers change with the control's cycles, if the program does nothing."""
_WORK, _WORK_OF_FILES, _WORK_OF_OPENING = 200, 1000, 2500

FUNCTIONS: dict[str, Function] = {row.name: row for rows in GROUPS.values() for row in rows}
"""Every function and command by its name."""
PATIENT = frozenset(name for name, row in FUNCTIONS.items() if row.waiting) | (TIMED - STEADY)
"""Functions that something else than the program may answer otherwise, in time."""
OWN = {row.run.__name__: row.run for row in FUNCTIONS.values() if row.run is not None}
"""What running programs know of Python for CPL's own functions."""


def python_name(name: str) -> str:
    """Return a name that Python can have."""
    return name.replace("#", "_n").replace("$", "_s")


_WORKS = (
    {python_name(row.name): _WORK_OF_FILES for row in (*FILES, *SCREEN)}
    | dict.fromkeys(("OPENW", "OPENR", "ERASE", "REWRITE", "FILEACCESS", "FILEDATE", "BMP"), _WORK_OF_OPENING)
    | dict.fromkeys(("EOF", "FILEPOS", "FILESIZE", "INKEY"), _WORK)
    | {"LIN": 4 * _WORK_OF_FILES, "CIR": 20 * _WORK_OF_FILES, "FIL": 20 * _WORK_OF_FILES}
)


def work_of(python: str) -> int:
    """Return how much a function of the control does, in assignments, by its `python_name`."""
    return _WORKS.get(python, _WORK)
