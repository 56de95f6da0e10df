"""The protocol with texts of our own: those of pygls end lines at signs that end none in the protocol."""

from __future__ import annotations

from collections.abc import Callable, Generator
from functools import partial
from typing import Any

from lsprotocol import types as lsp
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol, lsp_method

from polycnc import __version__

Handler = Generator[tuple[Callable[..., Any], tuple[Any, ...], None], Any, None]


class _Protocol(LanguageServerProtocol):
    """Leave the texts to the handlers, which keep them."""

    @lsp_method(lsp.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: lsp.DidOpenTextDocumentParams) -> Handler:
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_OPEN], (params,), None

    @lsp_method(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: lsp.DidChangeTextDocumentParams) -> Handler:
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_CHANGE], (params,), None

    @lsp_method(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: lsp.DidCloseTextDocumentParams) -> Handler:
        yield self.fm.features[lsp.TEXT_DOCUMENT_DID_CLOSE], (params,), None


class EditorServer(LanguageServer):
    """A server that knows whether it was shut down before the editor left."""

    def __init__(self) -> None:
        super().__init__(
            "polycnc",
            __version__,
            text_document_sync_kind=lsp.TextDocumentSyncKind.Incremental,
            protocol_cls=_Protocol,
        )
        self.was_shut_down = False
        self.feature(lsp.SHUTDOWN)(partial(self._shut_down))  # a feature carries attributes

    def _shut_down(self, _: None = None) -> None:
        self.was_shut_down = True
