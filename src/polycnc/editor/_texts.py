"""The texts of an editor, with what has been read of them: what they are, their dialects, their names."""

from __future__ import annotations

from dataclasses import dataclass
from urllib.parse import urlsplit

from pygls.uris import to_fs_path

from polycnc.editor._document import Document
from polycnc.editor._kinds import Kind, kind_of
from polycnc.editor._names import Name, name_at, names_of
from polycnc.editor._place import MOST_LINE
from polycnc.editor._rename import CONTROL, STAND_ALONE
from polycnc.editor._stand_alone import sap_names
from polycnc.editor._tables import control_names
from polycnc.nc import Dialect, ProgramText, choose_dialect

_NOTHING = Document("")


@dataclass(frozen=True, slots=True)
class Named:
    """A text with its names, and what they are names in."""

    document: Document
    names: list[Name]
    language: str

    def at(self, line: int, character: int) -> Name | None:
        """Return the name at a place."""
        return name_at(self.names, line, character)


class Texts:
    """Keep texts by their addresses; what has been read of one is kept until it changes."""

    def __init__(self, dialect: Dialect | None) -> None:
        self._dialect = dialect
        self._documents: dict[str, Document] = {}
        self._readings: dict[str, tuple[Document, Document, Kind, Dialect | None]] = {}
        self._names: dict[str, tuple[Document, Named]] = {}

    def __contains__(self, uri: str) -> bool:
        return uri in self._documents

    def put(self, uri: str, document: Document) -> None:
        """Keep a text."""
        self._documents[uri] = document

    def drop(self, uri: str) -> None:
        """Forget a text."""
        for kept in (self._documents, self._readings, self._names):
            kept.pop(uri, None)

    def document(self, uri: str) -> Document:
        """Return a text, an empty one if there is none."""
        return self._documents.get(uri, _NOTHING)

    def read(self, uri: str) -> tuple[Document, Kind, Dialect | None]:
        """Return a text, what it is, and the dialect of a program; None for a language that nobody reads here."""
        document = self.document(uri)
        known = self._readings.get(uri)
        if known is None or known[0] is not document:
            known = (document, *self._read(document, name_of(uri)))
            if uri in self:
                self._readings[uri] = known
        return known[1:]

    def named(self, uri: str) -> Named:
        """Return a text with its names, and what they are names in."""
        document, kind, dialect = self.read(uri)
        known = self._names.get(uri)
        if known is None or known[0] is not document:
            known = document, _named(document, kind, dialect)
            if uri in self:
                self._names[uri] = known
        return known[1]

    def _read(self, document: Document, name: str) -> tuple[Document, Kind, Dialect | None]:
        # Nobody writes such lines: they are looked at by the check alone.
        if any(len(line) > MOST_LINE for line in document.lines):
            return Document(""), Kind.UNKNOWN, None
        kind = kind_of(name, document.text)
        if kind is not Kind.PROGRAM:
            return document, kind, None
        chosen = choose_dialect(ProgramText.from_text(document.text, name), self._dialect)
        return document, kind, None if chosen.problem else chosen.dialect


def name_of(uri: str) -> str:
    """Return the path of a document; of one that has not been saved yet what its address says."""
    return (to_fs_path(uri) if uri.startswith("file:") else None) or urlsplit(uri).path or uri


def _named(document: Document, kind: Kind, dialect: Dialect | None) -> Named:
    if dialect is not None:
        return Named(document, list(names_of(document.lines, dialect)), dialect.language)
    if kind is Kind.STAND_ALONE:
        return Named(document, sap_names(document.text), STAND_ALONE)
    return Named(document, control_names(document.lines) if kind is Kind.CONTROL else [], CONTROL)
