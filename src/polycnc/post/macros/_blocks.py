"""How the pieces of a block are joined: in the written order or in that of the NC codes, with blanks between words.

Which pieces a line has, and in which order, is known when a macro is compiled; only whether a piece is empty is
not. So nothing is sorted while a program is written.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace


@dataclass(frozen=True, slots=True)
class Piece:
    """A part of a block: a `constant`, or else the name of the Python variable that holds its text.

    A word (code, function variable, sequence number) begins with the separator. A constant that is not `sure` is
    blanks: they make no block alone.
    """

    order: int
    constant: str = ""
    variable: str = ""
    is_word: bool = False
    sure: bool = False

    def inside(self, separator: str = "") -> str:
        """Return the piece as a part of an f-string."""
        if self.variable:
            return f"{{{self.variable}}}"
        return escaped((separator if self.is_word else "") + self.constant)


def is_empty_test(pieces: Sequence[Piece]) -> str:
    """Return the Python condition that something is to be written; "" if it always is."""
    if any(piece.sure for piece in pieces):
        return ""
    return " or ".join(piece.variable for piece in pieces if piece.variable) or "False"


def by_order(pieces: Sequence[Piece]) -> tuple[Piece, ...]:
    """Return the pieces in ascending order, equal ones as they were."""
    return tuple(sorted(pieces, key=lambda piece: piece.order))


def joined(pieces: Sequence[Piece], separator: str) -> tuple[str, str]:
    """Return the inside of an f-string with all pieces, and how many characters too many stand at its begin.

    These are a separator before the first word: a number or a Python condition, "" for none.
    """
    if not separator or not pieces:
        return "".join(piece.inside() for piece in pieces), ""
    first, *others = pieces
    rest = "".join(piece.inside(separator) for piece in others)
    if first.constant:  # known to come first, so its separator can be left out here
        return replace(first, is_word=False).inside() + rest, ""
    surplus = _surplus(pieces, len(separator))
    return first.inside(separator) + rest, "" if surplus == "0" else surplus


def text_follows(pieces: Sequence[Piece]) -> str:
    """Return Python for "the first piece that is not empty is text"; "" if it never is."""
    test = ""
    for piece in reversed(pieces):
        if piece.sure or piece.constant:
            test = "" if piece.is_word else "True"
        elif not piece.is_word:
            test = f"({piece.variable} or {test})" if test else piece.variable
        elif test:
            test = f"(not {piece.variable} and {test})"
    return test


def escaped(text: str) -> str:
    """Return text as it stands inside an f-string in double quotes."""
    return json.dumps(text, ensure_ascii=False)[1:-1].replace("{", "{{").replace("}", "}}")


def _surplus(pieces: Sequence[Piece], length: int) -> str:
    """Return Python for the length of the separator before the first piece that is not empty."""
    answers: list[tuple[str, str]] = []
    for piece in pieces:
        answers.append((piece.variable, str(length) if piece.is_word else "0"))
        if piece.sure or piece.constant:
            break
    while len(answers) > 1 and answers[-1][1] == answers[-2][1]:
        answers.pop()
    *tests, (_, last) = answers
    return "".join(f"{answer} if {test} else " for test, answer in tests) + last
