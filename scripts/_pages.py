"""Write the documentation pages that are generated; run by scripts/reference, compared by a test."""

from collections.abc import Callable
from pathlib import Path

from polycnc import conformance

REPOSITORY = Path(__file__).resolve().parents[1]


def conformance_page() -> str:
    """Return the page that shows which rows of the manuals are tested."""
    return conformance.reference_page(conformance.load_conformance(REPOSITORY / "conformance"))


PAGES: dict[str, Callable[[], str]] = {
    "docs/reference/conformance.md": conformance_page,
}
"""Every generated page: its path in the repository, and what returns its text."""

if __name__ == "__main__":
    for path, text in PAGES.items():
        (REPOSITORY / path).write_text(text(), encoding="utf-8")
        print(f"wrote {path}")
