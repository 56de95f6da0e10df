"""Program text to running code, for every language here.

A language brings its words; the kit has the rest:

1. `Source`, `Lexicon`, `Tokens`, `read_expression`: text with positions, tokens, expressions by precedence.
2. Statements in lists, of which the flow is the kit's: subclasses of `Choice` and `Loop`, `Mark`, `Jump`, `Leave`,
   `Again`.
3. A compiler that is `Words`: it writes its statements and conditions with an `Emitter`; `Flow` writes what is around
   them: structures, jumps, pauses. The lines make one function `program`, a generator; `Emitter.compile` makes it
   `Traced`.
4. `Execution`: one run of it. `next` gives what it yields, errors have their places, `standing` and `go_on` let it go
   on where it stood. What goes wrong in its functions is a `Fault`.
"""

from polycnc.language._execution import Execution, Fault, standing
from polycnc.language._expression import Chain, Infix, Link, Operators, Prefix, Tree, Unary, read_expression
from polycnc.language._flow import Flow, Words
from polycnc.language._flow_tree import Again, Choice, Jump, Leave, Loop, Mark, every
from polycnc.language._python import (
    Emitter,
    Frame,
    Python,
    Traced,
    frame_of,
    infix,
    prefix,
    without_collection,
)
from polycnc.language._resume import INNER, inner_of, line_of, names_of, resumed
from polycnc.language._source import Flaw, Source
from polycnc.language._tokens import END, Lexicon, Token, Tokens, clipped, real_value, whole_value

__all__ = [
    "END",
    "INNER",
    "Again",
    "Chain",
    "Choice",
    "Emitter",
    "Execution",
    "Fault",
    "Flaw",
    "Flow",
    "Frame",
    "Infix",
    "Jump",
    "Leave",
    "Lexicon",
    "Link",
    "Loop",
    "Mark",
    "Operators",
    "Prefix",
    "Python",
    "Source",
    "Token",
    "Tokens",
    "Traced",
    "Tree",
    "Unary",
    "Words",
    "clipped",
    "every",
    "frame_of",
    "infix",
    "inner_of",
    "line_of",
    "names_of",
    "prefix",
    "read_expression",
    "real_value",
    "resumed",
    "standing",
    "whole_value",
    "without_collection",
]
