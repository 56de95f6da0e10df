"""Arguments and options that commands have in common, each declared once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypedDict

import typer

from polycnc.cli._programs import dialect_names, machine_names
from polycnc.cli._summary import Units

Programs = Annotated[
    list[Path], typer.Argument(help="The part programs; - is standard input.", metavar="PROGRAM")
]
Program = Annotated[Path, typer.Argument(help="The part program.", metavar="PROGRAM")]
Machine = Annotated[
    str | None,
    typer.Option(
        "--machine",
        "-m",
        help="The machine: a preset or a TOML file (default: mill3, of lathe dialects lathe2).",
        metavar="FILE|PRESET",
        autocompletion=machine_names,
    ),
]
Dialect = Annotated[
    str | None,
    typer.Option(
        "--dialect",
        "-d",
        help="The dialect: din, fanuc, haas, linuxcnc, ... or a TOML file "
        "(default: by the program's extension, else by what it says, else din).",
        metavar="FILE|NAME",
        autocompletion=dialect_names,
    ),
]
Root = Annotated[
    Path | None,
    typer.Option(
        "--root",
        help="The control's folder: sub-programs, files and permanent variables (default: the program's).",
        metavar="DIR",
    ),
]
Ignore = Annotated[
    list[str] | None,
    typer.Option(
        "--ignore",
        help="Codes that count as if they were not there, like G43.4,M198; each is named in the messages.",
        metavar="CODE,...",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")]


# ---------------------------------------------------------------------- of a run

AsJsonSummary = Annotated[bool, typer.Option("--json", help="Print one JSON object instead of the summary.")]
SummaryUnits = Annotated[
    Units, typer.Option(help="Units of lengths and feeds in the summary.", metavar="mm|inch")
]
Trace = Annotated[
    Path | None,
    typer.Option(help="Write one row per control cycle to a .csv, .npz or .parquet file.", metavar="FILE"),
]
Plot = Annotated[
    Path | None, typer.Option(help="Draw path and speed to a .png, .svg or .pdf file.", metavar="FILE")
]
Servo = Annotated[
    bool, typer.Option("--servo", help="Simulate the position loops; the trace gets actual positions.")
]
Skip = Annotated[
    list[int] | None,
    typer.Option(
        help="Leave out blocks marked /N, as with block delete on; / alone is 1.", metavar="N", min=1, max=9
    ),
]
StopAtM0 = Annotated[
    bool, typer.Option("--stop-at-m0", help="End the run at the first M0 instead of passing it.")
]
Keys = Annotated[
    Path | None,
    typer.Option(help="The keys that are pressed when a program asks, one a line.", metavar="FILE"),
]
Screen = Annotated[
    Path | None,
    typer.Option(help="Write what the program shows to a .txt, .svg or .png file.", metavar="FILE"),
]
Stock = Annotated[
    str | None,
    typer.Option(
        help="Cut stock: auto, box=X0,Y0,Z0,X1,Y1,Z1, cylinder=D,Z0,Z1 (work coordinates, mm) or an STL file.",
        metavar="auto|FORM|FILE",
    ),
]
Fixtures = Annotated[
    list[str] | None,
    typer.Option(
        "--fixture",
        help="What tools must not touch: box=X0,Y0,Z0,X1,Y1,Z1 (as for --stock) or an STL file; may be repeated.",
        metavar="BOX|FILE",
    ),
]
Tools = Annotated[
    str | None,
    typer.Option(
        help="Tools of a LinuxCNC table (.tbl) or a list with a heading (.csv), in place of the machine's; "
        "inch=FILE where lengths in it are inches.",
        metavar="FILE",
    ),
]
Target = Annotated[
    str | None,
    typer.Option(help="What is to come out: an STL file, as the stock lies.", metavar="FILE"),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        help="How far the part may differ from the target (0.02 mm).", metavar="MM", min=0.001, max=10.0
    ),
]
Resolution = Annotated[
    float | None,
    typer.Option(
        help="Width of a cell of the stock (mm; default: by its size).", metavar="MM", min=1e-6, max=1e6
    ),
]
SaveStock = Annotated[
    Path | None, typer.Option(help="Write what is left of the stock to an .stl or .3mf file.", metavar="FILE")
]
SaveParameters = Annotated[
    Path | None,
    typer.Option(
        help="Write the parameters of LinuxCNC that outlive the program to a .var file, at its end.",
        metavar="FILE",
    ),
]
LoopLimit = Annotated[
    float | None,
    typer.Option(
        help="How long a CPL loop may go round without a block or a WAIT (10 s of the machine's time).",
        metavar="S",
        min=0.0,
        max=1e9,
    ),
]
Strict = Annotated[bool, typer.Option("--strict", help="Let remarks on the machining be errors.")]

# ---------------------------------------------------------------------- of a view

Page = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        help="The page, an .html file (default: the program's name with .html, here).",
        metavar="FILE",
    ),
]
PageUnits = Annotated[
    Units | None,
    typer.Option("--units", help="Units of lengths in the page (default: the program's).", metavar="mm|inch"),
]
OpenPage = Annotated[bool, typer.Option("--open", help="Open the page in the browser.")]

# ---------------------------------------------------------------------- of a batch

Paths = Annotated[list[Path], typer.Argument(help="Programs, and folders of them.", metavar="PATH")]
CheckOnly = Annotated[bool, typer.Option("--check", help="Report errors only; run nothing.")]
Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs", "-j", help="Processes (default: one for each core).", metavar="N", min=1, max=4096
    ),
]
Cluster = Annotated[
    str | None,
    typer.Option(help="Run on the Dask cluster of this scheduler, like tcp://host:8786.", metavar="ADDRESS"),
]
Report = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="The report: .html, .parquet or .csv.", metavar="FILE"),
]
Sweep = Annotated[
    list[str] | None,
    typer.Option(
        help="Vary override=80:120:5 (percent), tolerance=0,0.05 (mm) or machine=A,B; may be repeated.",
        metavar="NAME=VALUES",
    ),
]
Pattern = Annotated[
    list[str] | None,
    typer.Option(help="Programs of a folder, like '*.txt' (default: the usual endings).", metavar="GLOB"),
]
Timeout = Annotated[
    float, typer.Option(help="Seconds that one program may take; 0: any.", metavar="S", min=0.0, max=1e9)
]
Memory = Annotated[
    float, typer.Option(help="Memory that one program may take, MB; 0: any.", metavar="MB", min=0.0, max=1e9)
]
Done = Annotated[
    Path | None,
    typer.Option(
        help="Keep here what is done, and do it not again (default: the report's name and .done).",
        metavar="FILE",
    ),
]
Again = Annotated[bool, typer.Option("--again", help="Do everything again.")]

# ---------------------------------------------------------------------- of posting

ToolPath = Annotated[
    Path | None,
    typer.Argument(help="The tool path: APT words (ISO 4343), or JSON (.json).", metavar="TOOLPATH"),
]
Control = Annotated[
    str | None,
    typer.Option(
        "--control",
        "-c",
        help="The control file: bosch-pnc, bosch-pnc-cpl, din, fanuc-5axis, fanuc-lathe, fanuc-mill, grbl, haas-mill, "
        "linuxcnc-mill or a file.",
        metavar="FILE|NAME",
    ),
]
PostOutput = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Write the program to a file, not to the screen.", metavar="FILE"),
]
Verify = Annotated[
    bool, typer.Option("--verify", help="Run the program and compare its path with the tool path.")
]
PostTolerance = Annotated[
    float | None,
    typer.Option(
        help="Greatest deviation that --verify accepts, in mm; without it what rounding to the "
        "decimals of the control file may cost, and at least 0.001.",
        metavar="MM",
        min=1e-6,
        max=10.0,
    ),
]
PostMachine = Annotated[
    str | None,
    typer.Option(
        "--machine",
        "-m",
        help="Machine for --verify: a preset or a TOML file (default: the control file's).",
        metavar="FILE|PRESET",
    ),
]
ArcSense = Annotated[
    str | None,
    typer.Option(
        help="What the axes of CIRCLE/ are for: counterclockwise (right-hand rule) or clockwise; "
        "default: clockwise in a CLSF of NX.",
        metavar="SENSE",
    ),
]
PostAsJson = Annotated[
    bool, typer.Option("--json", help="Print one JSON object instead of text; needs --output.")
]
ShowControl = Annotated[
    bool, typer.Option("--show-control", help="Print the control file, to start one's own from.")
]


class Body(TypedDict):
    """What is cut, as settings of a run have it."""

    stock: str | None
    resolution_mm: float | None
    fixtures: tuple[str, ...]
    target: str | None
    tolerance_mm: float | None
    tools: str | None


def body_of(
    stock: str | None,
    resolution: float | None,
    fixtures: list[str] | None,
    target: str | None,
    tolerance: float | None,
    tools: str | None,
) -> Body:
    """Return what the options say of stock and tools."""
    return Body(
        stock=stock,
        resolution_mm=resolution,
        fixtures=tuple(fixtures or ()),
        target=target,
        tolerance_mm=tolerance,
        tools=tools,
    )


def file_of_tools(tools: str | None) -> str | None:
    """Return the file of tools, which no output may replace."""
    if tools is None:
        return None
    from polycnc.runner.machine_sources import tools_file

    return str(tools_file(tools))


def codes_of(texts: list[str] | None) -> tuple[str, ...]:
    """Return the codes of all --ignore options."""
    return tuple(code for text in texts or () for code in text.replace(",", " ").split())
