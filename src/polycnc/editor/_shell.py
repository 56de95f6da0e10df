"""The Language Server Protocol around what is found in a text. Needs `polycnc[editor]`."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcException

from polycnc.editor._about import about_name
from polycnc.editor._codes import completions, hover, word
from polycnc.editor._document import Document, characters, units
from polycnc.editor._findings import Finding, findings
from polycnc.editor._format import formatted
from polycnc.editor._kinds import Kind
from polycnc.editor._names import BLOCK, PROGRAM, Name, Role, givers, name_at, names_of, program_file, same
from polycnc.editor._newest import LONGEST_S, GoOn, Newest, Overtaken, TooLong, within
from polycnc.editor._outline import Symbol, outline
from polycnc.editor._place import Span
from polycnc.editor._protocol import EditorServer
from polycnc.editor._quick import Checked, quick_findings
from polycnc.editor._reading import held, taken, word_meaning
from polycnc.editor._rename import check_renaming, renamed
from polycnc.editor._stand_alone import sap_completions, sap_hover, sap_outline
from polycnc.editor._tables import key_completions, key_hover, table_outline
from polycnc.editor._texts import Texts, name_of
from polycnc.errors import UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import Dialect, ModalWords, ProgramText
from polycnc.runner import Survey, holds_before, machine_for, survey


class _Editor:
    """Keep the texts of an editor, and answer what it asks about them."""

    def __init__(self, server: EditorServer, machine: MachineConfig | None, dialect: Dialect | None) -> None:
        self._server = server
        self._machine = machine
        self._dialect = dialect
        self._newest, self._answers, self._times = Newest(), Newest(), Newest()
        self._checked: dict[str, Checked] = {}
        self._surveys: dict[str, tuple[str, Survey | None]] = {}
        self._surveying: dict[str, asyncio.Future[None]] = {}
        self._texts = Texts(dialect)
        self._under_way: set[asyncio.Task[None]] = set()

    # ------------------------------------------------------------------ texts

    def opened(self, params: lsp.DidOpenTextDocumentParams) -> None:
        item = params.text_document
        self._texts.put(item.uri, Document(item.text, item.version))
        self._begin(self._check(item.uri))

    def changed(self, params: lsp.DidChangeTextDocumentParams) -> None:
        uri, document = params.text_document.uri, self._texts.document(params.text_document.uri)
        for change in params.content_changes:
            if isinstance(change, lsp.TextDocumentContentChangePartial):
                begin, end = change.range.start, change.range.end
                document = document.changed(
                    (begin.line, begin.character), (end.line, end.character), change.text
                )
            else:
                document = Document(change.text)
        self._texts.put(uri, Document(document.text, params.text_document.version))
        self._begin(self._check(uri))

    def saved(self, params: lsp.DidSaveTextDocumentParams) -> None:
        # Another file of the folder may have changed since.
        self._begin(self._check(params.text_document.uri))

    def closed(self, params: lsp.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        self._newest.drop(uri)
        self._texts.drop(uri)
        self._surveys.pop(uri, None)
        self._checked.pop(uri, None)
        self._server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))

    # ------------------------------------------------------------------ questions

    async def hover(self, params: lsp.HoverParams) -> lsp.Hover | None:
        uri = params.text_document.uri
        document, kind, dialect = self._texts.read(uri)
        line, character = _place(document, params.position)
        if kind is Kind.STAND_ALONE:
            found = sap_hover(document.lines, line, character)
        elif dialect is None:
            found = key_hover(document.lines, line, character, kind)
        else:
            found = await self._word(uri, document, line, character, dialect)
        if found is None:
            return None
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, found[0])
        return lsp.Hover(content, _range(found[1], document))

    async def _word(
        self, uri: str, document: Document, line: int, character: int, dialect: Dialect
    ) -> tuple[str, Span] | None:
        """Return what a word of a program means, what holds before its line and how long that takes, and its place."""
        if 0 <= line < len(document.lines) and (found := self._about(uri, line, character, dialect)):
            return found
        code = hover(document.lines, line, character, dialect)
        at = word(document.lines, line, character, dialect)
        if code is None and at is None:
            return None
        before = await self._answers.run(uri, lambda _: self._holds_before(uri, document, line, dialect))
        text, span = code or ("", at[1] if at else Span(line, character, character + 1))
        config = machine_for(self._machine, dialect, ProgramText.from_text(document.text, name_of(uri)))
        if not text and at and before:
            meaning = word_meaning(at[0], before[0], config, dialect)
            text = f"**{at[0]}** ({dialect.name}): {meaning}" if meaning else ""
        parts = [text, held(*before, config, dialect) if before else ""]
        known = self._surveys.get(uri)
        if known is not None and known[0] == document.text and known[1] is not None:
            time = known[1].lines.get(line + 1)
            parts.append(taken(time) if time or before else "")
        content = "\n\n".join(filter(None, parts))
        return (content, span) if content else None

    def _about(self, uri: str, line: int, character: int, dialect: Dialect) -> tuple[str, Span] | None:
        """Return what the name at a place is, and where it stands; None where none stands."""
        own = list(names_of([self._texts.document(uri).lines[line]], dialect))
        at = name_at(own, 0, character)
        if at is None or at.kind == BLOCK:
            return None
        named = self._texts.named(uri)
        found = name_at(named.names, line, character)
        assert found is not None
        place = None
        if found.kind == PROGRAM and not givers(named.names, found):
            place = program_file(found.key, named.document.text, name_of(uri), dialect)
        file = place[0] if place else None
        return about_name(named.names, named.document.lines, found, dialect, file), found.span

    def completion(self, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
        document, kind, dialect = self._texts.read(params.text_document.uri)
        line, character = _place(document, params.position)
        if kind is Kind.STAND_ALONE:
            found = sap_completions(document.text)
        elif dialect is None:
            found = key_completions(document.lines, line, character, kind)
        else:
            names = self._texts.named(params.text_document.uri).names if dialect.language == "rs274" else []
            found = completions(document.lines, line, character, dialect, names)
        item = lsp.CompletionItemKind.Keyword
        return [
            lsp.CompletionItem(each.label, kind=item, detail=each.detail, sort_text=f"{number:04}")
            for number, each in enumerate(found)
        ]

    async def symbols(self, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        uri = params.text_document.uri
        document, kind, dialect = self._texts.read(uri)
        if kind is Kind.STAND_ALONE:
            found = sap_outline(document.text, len(document.lines))
        elif dialect is not None:
            survey = await self._survey(uri, document, dialect)
            found = outline(document.lines, dialect, survey)
        else:
            found = [] if kind in (Kind.PROGRAM, Kind.UNKNOWN) else table_outline(document.lines)
        return [_symbol(each, document) for each in found]

    # ------------------------------------------------------------------ names

    def definition(self, params: lsp.DefinitionParams) -> list[lsp.Location]:
        uri = params.text_document.uri
        named = self._texts.named(uri)
        found = named.at(*_place(named.document, params.position))
        if found is None:
            return []
        given = givers(named.names, found)
        _, _, dialect = self._texts.read(uri)
        if given or found.kind != PROGRAM or dialect is None:
            return _locations(uri, named.document, given)
        place = program_file(found.key, named.document.text, name_of(uri), dialect)
        if place is None:
            return []
        start = lsp.Position(place[1], 0)
        return [lsp.Location(place[0].resolve().as_uri(), lsp.Range(start, start))]

    def references(self, params: lsp.ReferenceParams) -> list[lsp.Location]:
        uri = params.text_document.uri
        named = self._texts.named(uri)
        found = named.at(*_place(named.document, params.position))
        asked = [] if found is None else same(named.names, found)
        if not params.context.include_declaration:
            asked = [each for each in asked if each.role is Role.USED]
        return _locations(uri, named.document, asked)

    def can_rename(self, params: lsp.PrepareRenameParams) -> lsp.Range | None:
        named = self._texts.named(params.text_document.uri)
        found = named.at(*_place(named.document, params.position))
        if found is None:
            return None
        with _refusals():
            check_renaming(named.names, found, named.language)
        return _range(found.span, named.document)

    def rename(self, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
        uri = params.text_document.uri
        named = self._texts.named(uri)
        found = named.at(*_place(named.document, params.position))
        if found is None:
            return None
        with _refusals():
            changes = renamed(named.names, named.document.lines, found, params.new_name, named.language)
        edits = [lsp.TextEdit(_range(span, named.document), text) for span, text in changes]
        return lsp.WorkspaceEdit({uri: edits})

    def format(self, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        document, _, dialect = self._texts.read(params.text_document.uri)
        if dialect is None:
            return []
        lines = document.lines
        return [
            lsp.TextEdit(_range(Span(number, 0, len(before)), document), after)
            for number, (before, after) in enumerate(zip(lines, formatted(lines, dialect), strict=True))
            if before != after
        ]

    # ------------------------------------------------------------------ checks

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.ensure_future(work)
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)

    async def _check(self, uri: str) -> None:
        document, name, loop = self._texts.document(uri), name_of(uri), asyncio.get_running_loop()
        before = self._checked.get(uri)

        def work(go_on: GoOn) -> list[Finding]:
            if before is not None:
                first = quick_findings(before, document, name, self._machine, self._dialect, go_on)
                if first is not None:
                    go_on()
                    loop.call_soon_threadsafe(self._publish, uri, document, first)
            return findings(document, name, self._machine, self._dialect, go_on)

        try:
            found = await self._newest.run(uri, work)
        except Exception as error:  # whatever it is, it is ours: nobody is shown a traceback
            what = f"internal error, the mistake is not yours: {type(error).__name__}: {error}"
            found = [Finding(Span(0, 0, 1), f"{what}\nPlease report it, with this text.", "", True)]
        if found is not None and uri in self._texts:
            self._checked[uri] = Checked(document, found)
            self._publish(uri, document, found)

        document, _, dialect = self._texts.read(uri)
        if found is not None and dialect is not None:
            await self._survey(uri, document, dialect)

    async def _survey(self, uri: str, document: Document, dialect: Dialect) -> Survey | None:
        """Return the times of a program; None where it has changed meanwhile, or is not run."""
        text = document.text
        while (known := self._surveys.get(uri)) is None or known[0] != text:
            if uri not in self._texts or self._texts.document(uri).text != text:
                return None
            if uri in self._surveying:
                await asyncio.wait([self._surveying[uri]])
                continue
            self._surveying[uri] = asyncio.ensure_future(self._keep_survey(uri, text, dialect))
        return known[1]

    async def _keep_survey(self, uri: str, text: str, dialect: Dialect) -> None:
        name = name_of(uri)

        def go_on() -> None:
            if self._texts.document(uri).text is not text:
                raise Overtaken

        def work(_: GoOn) -> Survey | None:
            program = ProgramText.from_text(text, name)
            if program.endless_line() is not None:
                return None
            with suppress(Overtaken, TooLong):
                return survey(
                    program,
                    machine_for(self._machine, dialect, program),
                    dialect,
                    root=_root(name),
                    progress=within(LONGEST_S, go_on),
                )
            return None

        found = None
        try:
            found = await self._times.run(uri, work)
        finally:
            self._surveying.pop(uri, None)
            if uri in self._texts:  # else it has been closed meanwhile
                self._surveys[uri] = (text, found)

    def _holds_before(
        self, uri: str, document: Document, line: int, dialect: Dialect
    ) -> tuple[ModalWords, dict[str, float]] | None:
        program = ProgramText.from_text(document.text, name_of(uri))
        if program.endless_line() is not None:
            return None
        return holds_before(
            program,
            line + 1,
            machine_for(self._machine, dialect, program),
            dialect,
            root=_root(program.name),
        )

    def _publish(self, uri: str, document: Document, found: list[Finding]) -> None:
        if self._texts.document(uri) is document:
            shown = [_diagnostic(each, document) for each in found]
            self._server.text_document_publish_diagnostics(
                lsp.PublishDiagnosticsParams(uri, shown, document.version)
            )


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
        (
            lsp.TEXT_DOCUMENT_COMPLETION,
            editor.completion,
            lsp.CompletionOptions(["G", "M", "#", "<", "[", "="]),
        ),
        (lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL, editor.symbols, None),
        (lsp.TEXT_DOCUMENT_DEFINITION, editor.definition, None),
        (lsp.TEXT_DOCUMENT_REFERENCES, editor.references, None),
        (lsp.TEXT_DOCUMENT_RENAME, editor.rename, lsp.RenameOptions(prepare_provider=True)),
        (lsp.TEXT_DOCUMENT_PREPARE_RENAME, editor.can_rename, None),
        (lsp.TEXT_DOCUMENT_FORMATTING, editor.format, None),
    ):
        server.feature(method, options)(partial(answer))  # a feature carries attributes, which methods cannot
    return server


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


@contextmanager
def _refusals() -> Iterator[None]:
    """Send what is refused as the answer to a request."""
    try:
        yield
    except UsageError as error:
        raise JsonRpcException(str(error), int(lsp.LSPErrorCodes.RequestFailed)) from None


def _locations(uri: str, document: Document, names: list[Name]) -> list[lsp.Location]:
    return [lsp.Location(uri, _range(each.span, document)) for each in names]


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
