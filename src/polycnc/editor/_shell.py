"""The Language Server Protocol around what is found in a text. Needs `polycnc[editor]`."""

from __future__ import annotations

from functools import partial
from urllib.parse import urlsplit

from lsprotocol import types as lsp
from pygls.lsp.server import LanguageServer
from pygls.uris import to_fs_path

from polycnc import __version__
from polycnc.editor._codes import completions, hover
from polycnc.editor._findings import Finding, findings
from polycnc.editor._newest import Newest
from polycnc.editor._outline import Symbol, outline
from polycnc.editor._place import Span, lines_of
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ProgramText, choose_dialect


class _Editor:
    """Answer an editor; it sends whole texts, so no change can be applied at a wrong place."""

    def __init__(
        self, server: LanguageServer, machine: MachineConfig | None, dialect: Dialect | None
    ) -> None:
        self._server = server
        self._machine = machine
        self._dialect = dialect
        self._newest = Newest()

    async def opened(self, params: lsp.DidOpenTextDocumentParams) -> None:
        await self._check(params.text_document.uri)

    async def changed(self, params: lsp.DidChangeTextDocumentParams) -> None:
        await self._check(params.text_document.uri)

    async def saved(self, params: lsp.DidSaveTextDocumentParams) -> None:
        await self._check(params.text_document.uri)  # another file of the folder may have changed since

    def closed(self, params: lsp.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        self._newest.drop(uri)
        self._server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))

    def hover(self, params: lsp.HoverParams) -> lsp.Hover | None:
        text, dialect = self._read(params.text_document.uri)
        line, character = _place(text, params.position)
        found = None if dialect is None else hover(text, line, character, dialect)
        if found is None:
            return None
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, found[0])
        return lsp.Hover(content, _range(found[1], lines_of(text)))

    def completion(self, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
        text, dialect = self._read(params.text_document.uri)
        line, character = _place(text, params.position)
        found = [] if dialect is None else completions(text, line, character, dialect)
        kind = lsp.CompletionItemKind.Keyword
        return [
            lsp.CompletionItem(each.label, kind=kind, detail=each.detail, sort_text=f"{number:04}")
            for number, each in enumerate(found)
        ]

    def symbols(self, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        text, dialect = self._read(params.text_document.uri)
        lines = lines_of(text)
        return [] if dialect is None else [_symbol(each, lines) for each in outline(text, dialect)]

    async def _check(self, uri: str) -> None:
        document = self._server.workspace.get_text_document(uri)
        text, version = document.source, document.version
        found = await self._newest.run(uri, lambda: findings(text, _name(uri), self._machine, self._dialect))
        if found is None:
            return
        lines = lines_of(text)
        shown = [_diagnostic(each, lines) for each in found]
        self._server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, shown, version))

    def _read(self, uri: str) -> tuple[str, Dialect | None]:
        """Return a text and its dialect, None for a language that nobody reads here."""
        text = self._server.workspace.get_text_document(uri).source
        chosen = choose_dialect(ProgramText.from_text(text, _name(uri)), self._dialect)
        return text, None if chosen.problem else chosen.dialect


def editor_server(machine: MachineConfig | None, dialect: Dialect | None) -> LanguageServer:
    """Return a server that has not begun."""
    server = LanguageServer("polycnc", __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Full)
    editor = _Editor(server, machine, dialect)
    # A feature must be able to carry attributes, which methods cannot.
    server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)(partial(editor.opened))
    server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)(partial(editor.changed))
    server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)(partial(editor.saved))
    server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)(partial(editor.closed))
    server.feature(lsp.TEXT_DOCUMENT_HOVER)(partial(editor.hover))
    server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(["G", "M"]))(
        partial(editor.completion)
    )
    server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)(partial(editor.symbols))
    return server


def _name(uri: str) -> str:
    """Return the path of a document; of one that has not been saved yet what its address says."""
    return (to_fs_path(uri) if uri.startswith("file:") else None) or urlsplit(uri).path or uri


def _units(text: str) -> int:
    return len(text.encode("utf-16-le", "surrogatepass")) // 2  # as the protocol counts


def _place(text: str, at: lsp.Position) -> tuple[int, int]:
    """Return line and character of a position."""
    lines = lines_of(text)
    if not 0 <= at.line < len(lines):
        return at.line, at.character
    before = lines[at.line].encode("utf-16-le", "surrogatepass")[: 2 * at.character]
    return at.line, len(before.decode("utf-16-le", "ignore"))


def _range(span: Span, lines: list[str]) -> lsp.Range:
    line = lines[span.line]
    return lsp.Range(
        lsp.Position(span.line, _units(line[: span.begin])), lsp.Position(span.line, _units(line[: span.end]))
    )


def _diagnostic(found: Finding, lines: list[str]) -> lsp.Diagnostic:
    severity = lsp.DiagnosticSeverity.Error if found.is_error else lsp.DiagnosticSeverity.Warning
    code = found.code or None
    return lsp.Diagnostic(_range(found.span, lines), found.text, severity, code, source="polycnc")


def _symbol(symbol: Symbol, lines: list[str]) -> lsp.DocumentSymbol:
    own = _range(Span(symbol.line, 0, len(lines[symbol.line])), lines)
    end = _range(Span(symbol.last, 0, len(lines[symbol.last])), lines).end
    kind = lsp.SymbolKind.Function if symbol.is_program else lsp.SymbolKind.Event
    children = [_symbol(each, lines) for each in symbol.children]
    whole = lsp.Range(own.start, end)
    return lsp.DocumentSymbol(symbol.name, kind, whole, own, detail=symbol.detail or None, children=children)
