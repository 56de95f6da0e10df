"""Program text to running code, for every language here: source, tokens, expressions, Python that knows its places."""

from polycnc.language._expression import Chain, Infix, Link, Operators, Prefix, Tree, Unary, read_expression
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
    "Chain",
    "Emitter",
    "Flaw",
    "Frame",
    "Infix",
    "Lexicon",
    "Link",
    "Operators",
    "Prefix",
    "Python",
    "Source",
    "Token",
    "Tokens",
    "Traced",
    "Tree",
    "Unary",
    "clipped",
    "frame_of",
    "infix",
    "inner_of",
    "line_of",
    "names_of",
    "prefix",
    "read_expression",
    "real_value",
    "resumed",
    "whole_value",
    "without_collection",
]
