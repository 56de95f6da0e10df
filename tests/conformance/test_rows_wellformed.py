"""The project's own rows, claims and generated pages are complete, well formed and up to date."""

from __future__ import annotations

import re
import runpy
from collections import Counter
from pathlib import Path

import pytest

from polycnc import conformance

REPOSITORY = Path(__file__).resolve().parents[2]
ROWS = conformance.read_rows(REPOSITORY / "conformance")
KINDS = {
    "concept", "constant", "enum", "error_code", "file_format", "function", "operator", "option", "parameter",
    "program", "register_bit", "statement", "struct", "variable",
}  # fmt: skip
PAGES = runpy.run_path(str(REPOSITORY / "scripts" / "_pages.py"))["PAGES"]


@pytest.mark.parametrize("system", conformance.SYSTEMS)
def test_every_field_is_written_as_agreed(system: str) -> None:
    for row in (row for row in ROWS.values() if row.system == system):
        fields = (row.group, row.name, row.kind, row.signature, row.lines, row.behaviour, row.errors)
        assert all(text == text.strip() for text in fields), row.id
        assert all((row.group, row.name, row.behaviour)), row.id
        assert row.kind in KINDS, row.id
        assert re.fullmatch(r"[A-Za-z0-9_.$#@-]+", row.id), row.id
        assert re.fullmatch(r"\d+(-\d+)?(,\d+(-\d+)?)*( \([\d.]+\))?", row.lines), row.id


def test_the_library_has_the_manuals_91_functions() -> None:
    counted = Counter(row.system for row in ROWS.values() if row.kind == "function")
    assert counted["fanuc"] == 91


def test_reasons_are_sentences() -> None:
    reasons = conformance.load_conformance(REPOSITORY / "conformance").reasons
    assert all(reason[0].isupper() and reason.endswith(".") for reason in reasons.values())


def test_claims_are_up_to_date(collected_claims: list[tuple[str, str]]) -> None:
    written = (REPOSITORY / "conformance" / "claims.tsv").read_text(encoding="utf-8")
    assert written == conformance.claims_text(collected_claims), "run scripts/reference"


@pytest.mark.parametrize("page", PAGES)
def test_generated_pages_are_up_to_date(page: str) -> None:
    assert (REPOSITORY / page).read_text(encoding="utf-8") == PAGES[page](), "run scripts/reference"
