"""The Language Server Protocol around what is found in a text. Needs `polycnc[editor]`."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from functools import partial
from typing import Any, TypeVar
from urllib.parse import urlsplit

from lsprotocol import types as lsp
from pygls.uris import to_fs_path

from polycnc.editor._codes import completions, hover
from polycnc.editor._document import Document, characters, units
from polycnc.editor._findings import Finding, findings
from polycnc.editor._newest import GoOn, Newest
from polycnc.editor._outline import Symbol, outline
from polycnc.editor._place import Span
from polycnc.editor._protocol import EditorServer
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText, choose_dialect

P = TypeVar("P")
R = TypeVar("R")


class _Editor:
    """Keep the texts of an editor, and answer what it asks about them."""

    def __init__(self, server: EditorServer, machine: MachineConfig | None, dialect: Dialect | None) -> None:
        self._server = server
        self._machine = machine
        self._dialect = dialect
        self._newest = Newest()
        self._documents: dict[str, Document] = {}
        self._under_way: set[asyncio.Task[None]] = set()

    # ------------------------------------------------------------------ texts

    def opened(self, params: lsp.DidOpenTextDocumentParams) -> None:
        item = params.text_document
        self._documents[item.uri] = Document(item.text, item.version)
        self._begin(self._check(item.uri))

    def changed(self, params: lsp.DidChangeTextDocumentParams) -> None:
        uri, document = params.text_document.uri, self._document(params.text_document.uri)
        for change in params.content_changes:
            if isinstance(change, lsp.TextDocumentContentChangePartial):
                begin, end = change.range.start, change.range.end
                document = document.changed(
                    (begin.line, begin.character), (end.line, end.character), change.text
                )
            else:
                document = Document(change.text)
        self._documents[uri] = Document(document.text, params.text_document.version)
        self._begin(self._check(uri))

    def saved(self, params: lsp.DidSaveTextDocumentParams) -> None:
        self._begin(
            self._check(params.text_document.uri)
        )  # another file of the folder may have changed since

    def closed(self, params: lsp.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        self._newest.drop(uri)
        self._documents.pop(uri, None)
        self._server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))

    # ------------------------------------------------------------------ questions

    def hover(self, params: lsp.HoverParams) -> lsp.Hover | None:
        document, dialect = self._read(params.text_document.uri)
        line, character = _place(document, params.position)
        found = None if dialect is None else hover(document.lines, line, character, dialect)
        if found is None:
            return None
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, found[0])
        return lsp.Hover(content, _range(found[1], document))

    def completion(self, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
        document, dialect = self._read(params.text_document.uri)
        line, character = _place(document, params.position)
        found = [] if dialect is None else completions(document.lines, line, character, dialect)
        kind = lsp.CompletionItemKind.Keyword
        return [
            lsp.CompletionItem(each.label, kind=kind, detail=each.detail, sort_text=f"{number:04}")
            for number, each in enumerate(found)
        ]

    def symbols(self, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        document, dialect = self._read(params.text_document.uri)
        return (
            [] if dialect is None else [_symbol(each, document) for each in outline(document.lines, dialect)]
        )

    # ------------------------------------------------------------------ checks

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)

    async def _check(self, uri: str) -> None:
        document = self._document(uri)

        def work(go_on: GoOn) -> list[Finding]:
            return findings(document, _name(uri), self._machine, self._dialect, go_on)

        found = await self._newest.run(uri, work)
        if found is not None:
            shown = [_diagnostic(each, document) for each in found]
            self._server.text_document_publish_diagnostics(
                lsp.PublishDiagnosticsParams(uri, shown, document.version)
            )

    def _document(self, uri: str) -> Document:
        return self._documents.get(uri) or Document("")

    def _read(self, uri: str) -> tuple[Document, Dialect | None]:
        """Return a text and its dialect, None for a language that nobody reads here."""
        document = self._document(uri)
        chosen = choose_dialect(ProgramText.from_text(document.text, _name(uri)), self._dialect)
        return document, None if chosen.problem else chosen.dialect


def editor_server(machine: MachineConfig | None, dialect: Dialect | None) -> EditorServer:
    """Return a server that has not begun."""
    server = EditorServer()
    editor = _Editor(server, machine, dialect)
    for method, answer, options in (
        (lsp.TEXT_DOCUMENT_DID_OPEN, editor.opened, None),
        (lsp.TEXT_DOCUMENT_DID_CHANGE, editor.changed, None),
        (lsp.TEXT_DOCUMENT_DID_SAVE, editor.saved, None),
        (lsp.TEXT_DOCUMENT_DID_CLOSE, editor.closed, None),
        (lsp.TEXT_DOCUMENT_HOVER, editor.hover, None),
        (lsp.TEXT_DOCUMENT_COMPLETION, editor.completion, lsp.CompletionOptions(["G", "M"])),
        (lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, editor.symbols, None),
    ):
        server.feature(method, options)(partial(_bounded, answer))
    return server


def _bounded(answer: Callable[[P], R], params: P) -> R:
    # A feature must be able to carry attributes, which methods cannot.
    return answer(params)


def _name(uri: str) -> str:
    """Return the path of a document; of one that has not been saved yet what its address says."""
    return (to_fs_path(uri) if uri.startswith("file:") else None) or urlsplit(uri).path or uri


def _place(document: Document, at: lsp.Position) -> tuple[int, int]:
    """Return line and character of a position."""
    if not 0 <= at.line < len(document.lines):
        return at.line, at.character
    return at.line, characters(document.lines[at.line], at.character)


def _range(span: Span, document: Document) -> lsp.Range:
    line = document.lines[span.line]
    return lsp.Range(
        lsp.Position(span.line, units(line[: span.begin])), lsp.Position(span.line, units(line[: span.end]))
    )


def _diagnostic(found: Finding, document: Document) -> lsp.Diagnostic:
    severity = lsp.DiagnosticSeverity.Error if found.is_error else lsp.DiagnosticSeverity.Warning
    return lsp.Diagnostic(
        _range(found.span, document), found.text, severity, found.code or None, source="polycnc"
    )


def _symbol(symbol: Symbol, document: Document) -> lsp.DocumentSymbol:
    own = _range(Span(symbol.line, 0, len(document.lines[symbol.line])), document)
    end = _range(Span(symbol.last, 0, len(document.lines[symbol.last])), document).end
    kind = lsp.SymbolKind.Function if symbol.is_program else lsp.SymbolKind.Event
    children = [_symbol(each, document) for each in symbol.children]
    whole = lsp.Range(own.start, end)
    return lsp.DocumentSymbol(symbol.name, kind, whole, own, detail=symbol.detail or None, children=children)
