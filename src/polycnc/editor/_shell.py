"""The Language Server Protocol around what is found in a text. Needs `polycnc[editor]`."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from lsprotocol import types as lsp
from pygls.uris import to_fs_path

from polycnc.editor._codes import completions, hover, word
from polycnc.editor._document import Document, characters, units
from polycnc.editor._findings import Finding, findings
from polycnc.editor._newest import LONGEST_S, GoOn, Newest, Overtaken, TooLong, within
from polycnc.editor._outline import Symbol, outline
from polycnc.editor._place import Span
from polycnc.editor._protocol import EditorServer
from polycnc.editor._reading import held, taken, word_meaning
from polycnc.machine import MachineConfig, load_machine
from polycnc.nc import Dialect, ModalWords, ProgramText, choose_dialect
from polycnc.runner import Survey, holds_before, survey


class _Editor:
    """Keep the texts of an editor, and answer what it asks about them."""

    def __init__(self, server: EditorServer, machine: MachineConfig | None, dialect: Dialect | None) -> None:
        self._server = server
        self._machine = machine
        self._dialect = dialect
        self._config = load_machine(machine)
        self._newest, self._answers, self._times = Newest(), Newest(), Newest()
        self._surveys: dict[str, tuple[str, Survey | None]] = {}
        self._surveying: dict[str, asyncio.Future[None]] = {}
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
        self._surveys.pop(uri, None)
        self._server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))

    # ------------------------------------------------------------------ questions

    async def hover(self, params: lsp.HoverParams) -> lsp.Hover | None:
        document, dialect = self._read(params.text_document.uri)
        if dialect is None:
            return None
        uri, (line, character) = params.text_document.uri, _place(document, params.position)
        code = hover(document.lines, line, character, dialect)
        at = word(document.lines, line, character, dialect)
        if code is None and at is None:
            return None
        before = await self._answers.run(uri, lambda _: self._holds_before(uri, document, line, dialect))
        text, span = code or ("", at[1] if at else Span(line, character, character + 1))
        if not text and at and before:
            meaning = word_meaning(at[0], before[0], self._config, dialect)
            text = f"**{at[0]}** ({dialect.name}): {meaning}" if meaning else ""
        parts = [text, held(*before, self._config, dialect) if before else ""]
        known = self._surveys.get(uri)
        if known is not None and known[0] == document.text and known[1] is not None:
            time = known[1].lines.get(line + 1)
            parts.append(taken(time) if time or before else "")
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, "\n\n".join(filter(None, parts)))
        return lsp.Hover(content, _range(span, document)) if content.value else None

    def completion(self, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
        document, dialect = self._read(params.text_document.uri)
        line, character = _place(document, params.position)
        found = [] if dialect is None else completions(document.lines, line, character, dialect)
        kind = lsp.CompletionItemKind.Keyword
        return [
            lsp.CompletionItem(each.label, kind=kind, detail=each.detail, sort_text=f"{number:04}")
            for number, each in enumerate(found)
        ]

    async def symbols(self, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        uri = params.text_document.uri
        document, dialect = self._read(uri)
        if dialect is None:
            return []
        found = await self._survey(uri, document, dialect)
        return [_symbol(each, document) for each in outline(document.lines, dialect, found)]

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

        document, dialect = self._read(uri)
        if found is not None and dialect is not None:
            await self._survey(uri, document, dialect)

    async def _survey(self, uri: str, document: Document, dialect: Dialect) -> Survey | None:
        """Return the times of a program; None where it has changed meanwhile, or is not run."""
        text = document.text
        while (known := self._surveys.get(uri)) is None or known[0] != text:
            if self._document(uri).text != text:
                return None
            if uri in self._surveying:
                await asyncio.wait([self._surveying[uri]])
                continue
            self._surveying[uri] = asyncio.ensure_future(self._keep_survey(uri, text, dialect))
        return known[1]

    async def _keep_survey(self, uri: str, text: str, dialect: Dialect) -> None:
        name = _name(uri)

        def go_on() -> None:
            if self._document(uri).text is not text:
                raise Overtaken

        def work(_: GoOn) -> Survey | None:
            program = ProgramText.from_text(text, name)
            if program.endless_line() is not None:
                return None
            with suppress(Overtaken, TooLong):
                return survey(
                    program, self._config, dialect, root=_root(name), progress=within(LONGEST_S, go_on)
                )
            return None

        try:
            found = await self._times.run(uri, work)
        finally:
            self._surveying.pop(uri, None)
            self._surveys[uri] = (text, None)
        self._surveys[uri] = (text, found)

    def _holds_before(
        self, uri: str, document: Document, line: int, dialect: Dialect
    ) -> tuple[ModalWords, dict[str, float]] | None:
        program = ProgramText.from_text(document.text, _name(uri))
        if program.endless_line() is not None:
            return None
        return holds_before(program, line + 1, self._config, dialect, root=_root(program.name))

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
        server.feature(method, options)(partial(answer))  # a feature carries attributes, which methods cannot
    return server


def _name(uri: str) -> str:
    """Return the path of a document; of one that has not been saved yet what its address says."""
    return (to_fs_path(uri) if uri.startswith("file:") else None) or urlsplit(uri).path or uri


def _root(name: str) -> Path:
    """Return the folder in which a program looks for others: its own, if there is one."""
    folder = Path(name).parent
    return folder if folder.is_dir() else Path.cwd()


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
