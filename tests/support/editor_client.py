"""An editor as the Language Server Protocol knows it, over the standard input and output of `polycnc lsp`."""

from __future__ import annotations

import json
import queue
import subprocess
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

from support.command import COMMAND, environment

WAIT_S = 120.0


class Editor:
    """Speak to a server of its own, and keep what it publishes.

    A thread of its own reads, so that no wait is without end.
    """

    def __init__(self, *arguments: str, cwd: Path | None = None) -> None:
        self.process = subprocess.Popen(
            [*COMMAND, "lsp", *arguments],
            cwd=cwd,
            env=environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self._ids = 6
        self._versions: dict[str, int] = {}
        self._came: queue.Queue[dict[str, Any] | None] = queue.Queue()
        self.published: list[dict[str, Any]] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> Editor:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait(WAIT_S)
        self._reader.join(WAIT_S)
        for stream in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert stream is not None
            with suppress(BrokenPipeError):
                stream.close()

    def begin(self) -> dict[str, Any]:
        """Introduce itself; return what the server says of itself."""
        begun: dict[str, Any] = self.ask(
            "initialize", {"processId": None, "rootUri": None, "capabilities": {}}
        )
        self.notify("initialized", {})
        return begun

    def end(self) -> tuple[int, str]:
        """Leave in order; return the exit status and what was printed to standard error."""
        assert self.ask("shutdown", None) is None
        self.notify("exit", None)
        return self.leave()

    def leave(self) -> tuple[int, str]:
        """Close the connection; return the exit status and what was printed to standard error."""
        assert self.process.stdin is not None
        assert self.process.stderr is not None
        self.process.stdin.close()
        return self.process.wait(WAIT_S), self.process.stderr.read().decode()

    def open(self, uri: str, text: str, language: str = "gcode") -> list[dict[str, Any]]:
        """Show a text to the server; return its diagnostics."""
        self._versions[uri] = 3
        item = {"uri": uri, "languageId": language, "version": 3, "text": text}
        self.notify("textDocument/didOpen", {"textDocument": item})
        return self.diagnostics(uri)

    def change(self, uri: str, *changes: dict[str, Any]) -> int:
        """Change a text; return its version."""
        self._versions[uri] += 1
        document = {"uri": uri, "version": self._versions[uri]}
        self.notify("textDocument/didChange", {"textDocument": document, "contentChanges": list(changes)})
        return self._versions[uri]

    def diagnostics(self, uri: str) -> list[dict[str, Any]]:
        """Wait for the diagnostics of the last version of a text."""
        version = self._versions[uri]
        while True:
            for told in self.published:
                if told["uri"] == uri and told.get("version") == version:
                    self.published.remove(told)
                    found: list[dict[str, Any]] = told["diagnostics"]
                    return found
            self._take()

    def ask(self, method: str, params: Any) -> Any:
        """Return the result of a request."""
        answer = self._answer(method, params)
        assert "error" not in answer, answer["error"]
        return answer["result"]

    def refused(self, method: str, uri: str, line: int, character: int, **more: Any) -> str:
        """Return what the server says to a request that it refuses."""
        place = {"textDocument": {"uri": uri}, "position": {"line": line, "character": character}}
        said: str = self._answer(method, {**place, **more})["error"]["message"]
        return said

    def _answer(self, method: str, params: Any) -> dict[str, Any]:
        self._ids += 1
        self._send({"id": self._ids, "method": method, "params": params})
        while True:
            message = self._take()
            if message.get("id") == self._ids and "method" not in message:
                return message

    def ask_at(self, method: str, uri: str, line: int, character: int, **more: Any) -> Any:
        """Return the result of a request about a place."""
        place = {"textDocument": {"uri": uri}, "position": {"line": line, "character": character}}
        return self.ask(method, {**place, **more})

    def notify(self, method: str, params: Any) -> None:
        """Send a message that nothing answers."""
        self._send({"method": method, "params": params})

    def _send(self, message: dict[str, Any]) -> None:
        content = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(content), content))
        self.process.stdin.flush()

    def _take(self) -> dict[str, Any]:
        message = self._came.get(timeout=WAIT_S)
        assert message is not None, "the server has left"
        if message.get("method") == "textDocument/publishDiagnostics":
            self.published.append(message["params"])
        else:
            assert message.get("method") != "window/showMessage", message
        return message

    def _read(self) -> None:
        assert self.process.stdout is not None
        while line := self.process.stdout.readline():
            length = int(line.partition(b":")[2])
            while self.process.stdout.readline().strip():
                pass
            self._came.put(json.loads(self.process.stdout.read(length)))
        self._came.put(None)


def span(line: int, begin: int, end: int) -> dict[str, Any]:
    """Return a range within a line."""
    return {"start": {"line": line, "character": begin}, "end": {"line": line, "character": end}}
