"""`polycnc lsp` as editors start it: a process of its own, spoken to by the client of pygls."""

from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

from support.command import COMMAND, environment

WRONG = "T1 M6\nS900 M3\n(\U0001f600) G1 X10\nG1 X25.5 F300\nM30\n"
RIGHT = WRONG.replace("X10", "X10 F200")


async def _scene(uri: str) -> None:
    client = LanguageClient("test", "1")
    published: asyncio.Queue[lsp.PublishDiagnosticsParams] = asyncio.Queue()
    client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)(partial(published.put_nowait))
    await client.start_io(*COMMAND, "lsp", "--dialect", "fanuc", env=environment())
    begun = await client.initialize_async(lsp.InitializeParams(lsp.ClientCapabilities()))
    assert begun.server_info is not None
    assert begun.server_info.name == "polycnc"
    client.initialized(lsp.InitializedParams())

    client.text_document_did_open(lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(uri, "gcode", 3, WRONG)))
    told = await published.get()
    assert (told.uri, told.version) == (uri, 3)
    error = next(each for each in told.diagnostics if "without a feed" in each.message)
    # The face counts two units in the protocol.
    assert error.range == lsp.Range(lsp.Position(2, 5), lsp.Position(2, 7))
    assert error.severity == lsp.DiagnosticSeverity.Error
    assert error.message.endswith("Program F in this or an earlier block.")

    changed = lsp.VersionedTextDocumentIdentifier(version=4, uri=uri)
    whole = lsp.TextDocumentContentChangeWholeDocument(RIGHT)
    client.text_document_did_change(lsp.DidChangeTextDocumentParams(changed, [whole]))
    told = await published.get()
    assert (told.version, list(told.diagnostics)) == (4, [])

    document = lsp.TextDocumentIdentifier(uri)
    about = await client.text_document_hover_async(lsp.HoverParams(document, lsp.Position(2, 6)))
    assert about is not None
    assert isinstance(about.contents, lsp.MarkupContent)
    assert "Group: motion" in about.contents.value
    outline = await client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
    assert outline is not None
    assert [each.name for each in outline] == ["T1"]
    await client.shutdown_async(None)
    client.exit(None)
    await client.stop()
    server = client._server
    assert server is not None
    assert server.returncode == 0


def test_an_editor_sees_an_error_mends_it_and_asks_what_a_code_does(tmp_path: Path) -> None:
    asyncio.run(asyncio.wait_for(_scene((tmp_path / "part.nc").as_uri()), 60.0))
