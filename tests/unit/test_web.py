"""Libraries that pages bring along: files as their table says, with their licences in it and in the package."""

from __future__ import annotations

import hashlib
import re
from pathlib import Path

import polycnc.web
from polycnc.web import Page, libraries, served_files, served_text
from polycnc.web._page import _in_order

VENDOR = Path(polycnc.web.__file__).parent / "vendor"


def test_files_are_those_of_the_table() -> None:
    table = {each.file: each for each in libraries()}
    licences = {each.licence_file for each in table.values()}
    assert {path.name for path in VENDOR.iterdir()} == {*table, *licences, "licences.tsv"}
    for name, each in table.items():
        assert hashlib.sha256((VENDOR / name).read_bytes()).hexdigest() == each.sha256
        assert f"{each.licence} License" in (VENDOR / each.licence_file).read_text("utf-8")


def test_a_page_has_its_modules_in_order_and_names_its_libraries() -> None:
    modules = {"entry.js": 'import { one } from "./one.js";', "one.js": 'import uPlot from "uplot";'}
    html = Page("<p>it</p>", "p { margin: 0; }", "entry.js", modules, "test").html("a < b", {"data": b"x"})
    assert "<title>a &lt; b</title>" in html
    assert "uplot 1.6" in html
    assert "Permission is hereby granted" in html
    assert [name for name, _ in _in_order("entry.js", modules)] == ["uPlot.esm.js", "one.js", "entry.js"]


def test_a_server_gives_every_file_that_its_files_import() -> None:
    wanted = {
        name: re.findall(
            r"""\b(?:from|import)\s*["']([^"'\s]+)["']""", re.sub(r"(?m)^\s*\*.*", "", served_text(name))
        )
        for name in served_files()
        if name.endswith(".js")
    }
    assert {"stage.js", "OrbitControls.js", "uPlot.esm.js"} <= set(wanted)
    for name, imports in wanted.items():
        assert {each.removeprefix("./") for each in imports} <= served_files(), name
        assert all(each.startswith("./") for each in imports), name
