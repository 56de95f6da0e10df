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
from polycnc.language._source import Flaw, Source
from polycnc.language._tokens import END, Lexicon, Token, Tokens, clipped, real_value, whole_value

__all__ = [
    "END",
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
    "prefix",
    "read_expression",
    "real_value",
    "whole_value",
    "without_collection",
]
