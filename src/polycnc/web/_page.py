"""One file out of a page: style, modules and data within it, so that it opens from anywhere and loads nothing."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

from polycnc.web._vendor import BARE, VENDOR, folder, libraries

_IMPORT = re.compile(r"""\b(?:from|import)\s*["']([^"']+)["']""")
_OWN = "js"


@dataclass(frozen=True)
class Page:
    """A page: what is in its body and its style, and modules by file name, of which `entry` exports `start(data)`.

    Modules import from those of this package and from each other by file name, as a server would give them.
    """

    body: str
    style: str
    entry: str
    modules: Mapping[str, str]
    generator: str

    def html(self, title: str, data: Mapping[str, bytes]) -> str:
        """Return the page as one file; `start` gets each piece of `data` as an ArrayBuffer by its name."""
        boot = _asset("boot.js")
        style = _library_text("uPlot.min.css") + "\n" + _asset("base.css") + self.style
        return _filled(
            _asset("shell.html"),
            TITLE=html.escape(title),
            GENERATOR=html.escape(self.generator),
            POLICY=_policy(boot, style),
            STYLE=style,
            BODY=self.body,
            NOTICE=_notice(),
            MODULES=_compressed_modules(self.entry, tuple(self.modules.items())),
            DATA="\n".join(
                f'<script type="text/plain" class="data" id="{html.escape(name)}">{compressed(piece)}</script>'
                for name, piece in data.items()
            ),
            BOOT=boot,
        )


def compressed(data: bytes) -> str:
    """Return bytes as a page holds them: gzip, as Base64."""
    return base64.b64encode(gzip.compress(data, 6, mtime=0)).decode("ascii")


def _policy(boot: str, style: str) -> str:
    """Allow the one script and the one style that are in the page, and modules that this script makes of its data."""
    script, look = (
        base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in (boot, style)
    )
    return (
        f"default-src 'none'; script-src 'sha256-{script}' blob:; style-src 'sha256-{look}'; "
        "base-uri 'none'; form-action 'none'"
    )


@cache
def _compressed_modules(entry: str, own: tuple[tuple[str, str], ...]) -> str:
    return compressed(json.dumps(_in_order(entry, dict(own))).encode())


def _in_order(entry: str, own: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return names and texts of all modules that an entry needs, each after those that it imports."""
    found: dict[str, str] = {}

    def take(name: str) -> None:
        if name in found:
            return
        text = own[name] if name in own else module_text(name)
        for wanted in _IMPORT.findall(text):
            if wanted in BARE or wanted.startswith("./"):
                take(BARE.get(wanted, wanted.removeprefix("./")))
        found[name] = text

    take(entry)
    return [*((name, text) for name, text in found.items())]


def module_text(name: str) -> str:
    """Return the text of a module or library."""
    if name in {each.file for each in libraries()}:
        return _library_text(name)
    return (folder(_OWN) / name).read_text("utf-8")


@cache
def _library_text(name: str) -> str:
    return (folder(VENDOR) / name).read_text("utf-8")


def _notice() -> str:
    """Name the libraries in a page, as their licences ask for."""
    packages = {each.package: each for each in libraries()}.values()
    lines = [f"{each.package} {each.version}, {each.licence} licence" for each in packages]
    texts = {each.licence_file for each in packages}
    return "\n\n".join(
        ["With " + "; ".join(lines) + ".", *(_library_text(text).strip() for text in sorted(texts))]
    )


@cache
def _asset(name: str) -> str:
    return (folder(_OWN) / name).read_text("utf-8")


def _filled(template: str, **parts: str) -> str:
    """Return the template with its places filled in one pass, so that no filled text is looked at again."""
    pieces = template.split("%%")
    return "".join(parts[piece] if i % 2 else piece for i, piece in enumerate(pieces))
