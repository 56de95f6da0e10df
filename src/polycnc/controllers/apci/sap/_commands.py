"""The words of the board: commands with the shape of their arguments, system variables, axis qualifiers.

The printed manual shows three shapes, ``mlr (X := 25, C := 60)``, ``ssf (A1, 1001, 1)`` and plain numbers.
Which shape a command has follows from what the function of the same name gets: a value per axis, an axis
list, one axis, no axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

INTEGER = "i"
DOUBLE = "d"
BOOLEAN = "b"
TABLE = "t"  # a whole array of double

COMMON_COUNT = 1000


class Axes(Enum):
    """How a command names its axes."""

    NONE = "none"
    ONE = "one axis first"
    LIST = "axes, then numbers"
    NAMED = "axis := value, then numbers"


@dataclass(frozen=True, slots=True)
class Command:
    """A command: how it names axes, how many it takes at least and at most, and the numbers after them.

    `numbers` are (name, type); the last `optional` of them may be left out, all or none.
    """

    name: str
    axes: Axes
    numbers: tuple[tuple[str, str], ...] = ()
    optional: int = 0
    least: int = 1
    most: int = 18
    path: bool = False


@dataclass(frozen=True, slots=True)
class Register:
    """A system variable or axis qualifier; `indexed` ones are fields, `count` is their size where fixed."""

    name: str
    kind: str
    writable: bool = True
    indexed: bool = False
    count: int | None = None


_PHI = ("phi", DOUBLE)
_NORMAL = (("pn1", DOUBLE), ("pn2", DOUBLE), ("pn3", DOUBLE))
_END_POINT = (("dtm1", DOUBLE), ("dtm2", DOUBLE))
_POINTS = (("size", INTEGER), ("points", TABLE))
_INDEX = (("pcapindex", INTEGER),)


def _moves(prefix: str) -> list[Command]:
    moves: list[Command] = []
    for ending in "ar":
        moves += [
            Command(f"{prefix}ml{ending}", Axes.NAMED, path=True),
            Command(f"{prefix}mc{ending}", Axes.NAMED, (_PHI,), least=2, most=2, path=True),
            Command(f"{prefix}mc{ending}3d", Axes.NAMED, (*_NORMAL, _PHI), least=3, most=3, path=True),
            Command(f"{prefix}mh{ending}", Axes.NAMED, (_PHI, *_END_POINT), optional=2, least=2, path=True),
        ]
    return moves


_ALL = [
    *_moves(""),
    *_moves("s"),
    *(Command(name, Axes.NAMED) for name in ("ja", "jr", "jhi", "shp")),
    *(Command(name, Axes.LIST) for name in ("jhl", "jhr", "js", "ms", "cl", "clv", "ol", "ra", "uf")),
    *(Command(name, Axes.LIST) for name in ("utrovr", "RPtoDP", "ssms", "sstps", "sdels", "rdigi", "rifs")),
    Command("sstvl", Axes.LIST, (("tvl", DOUBLE),)),
    Command("ssf", Axes.ONE, (("command", INTEGER), ("value", DOUBLE))),
    Command("spd", Axes.ONE, _POINTS),
    Command("spda", Axes.ONE, _POINTS + _INDEX, optional=1),
    Command("spdr", Axes.ONE, _POINTS + _INDEX, optional=1),
    Command("lps", Axes.ONE, (("mst", INTEGER),)),
    Command("szpa", Axes.ONE, (("position", DOUBLE),)),
    Command("szpr", Axes.ONE, (("position", DOUBLE),)),
    Command("azo", Axes.NONE, (("set", INTEGER),)),
    Command("rs", Axes.NONE),
    Command("ClearCI99", Axes.NONE),
]

_SYSTEM = [
    *(
        Register(name, INTEGER)
        for name in ("pu", "tu", "modereg", "nfrax", "irqpc", "ledgn", "ledrd", "ledyl")
    ),
    *(Register(name, DOUBLE) for name in ("trac", "trvl", "trtvl", "trovr", "trovrst")),
    Register("errorreg", INTEGER, writable=False),
    Register("sysvarint", INTEGER, indexed=True),
    Register("sysvardbl", DOUBLE, indexed=True),
    Register("ci", INTEGER, indexed=True, count=COMMON_COUNT),
    Register("cd", DOUBLE, indexed=True, count=COMMON_COUNT),
]

_AXIS_DOUBLES = (
    "jac jvl jtvl jovr hac hvl sdec kp ki kd kpl kfca kfcv sll slr ipw mpe gf gfaux slsp effradius MaxVel MaxAcc "
    "MDVEL jerkrel dpoffset dvoffset aux tp rp dp lp lpndx"
)
_AXIS = [
    *(Register(name, DOUBLE) for name in _AXIS_DOUBLES.split()),
    *(Register(name, DOUBLE, writable=False) for name in ("rv", "dv", "PosErr", "ZeroOffset")),
    *(Register(name, INTEGER) for name in ("GCR", "ControllerFlags", "mcp", "digo")),
    *(
        Register(name, INTEGER, writable=False)
        for name in ("axst", "digi", "ifs", "lsm", "MCiS", "PcapIndex")
    ),
    Register("varint", INTEGER, indexed=True),
    Register("vardbl", DOUBLE, indexed=True),
]

COMMANDS = {command.name.lower(): command for command in _ALL}
SYSTEM_VARIABLES = {register.name.lower(): register for register in _SYSTEM}
AXIS_QUALIFIERS = {register.name.lower(): register for register in _AXIS}

TASK_COMMANDS = ("startcnct", "stopcnct", "contcnct")
BUFFER_LETTERS = {"b": ("B", INTEGER), "i": ("<i", INTEGER), "d": ("<d", DOUBLE)}  # how struct spells them
"""Letters x of RDCBx and WRCBx: byte, integer (4 bytes), double (8 bytes), the lowest byte first."""

STATEMENTS = {
    *("write", "writeln", "wt", "stop", "abort"),
    *TASK_COMMANDS,
    *(f"wrcb{letter}" for letter in BUFFER_LETTERS),
}


def common_variable(name: str) -> tuple[Register, int] | None:
    """Return register and index of CI0..CI999 or CD0..CD999; an index that does not exist too."""
    register = SYSTEM_VARIABLES.get(name[:2].lower())
    if register is None or register.count is None or not name[2:].isdecimal():
        return None
    return register, int(name[2:])
