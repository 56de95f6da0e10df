"""A real browser for pages that polycnc writes: Debian's Chromium, driven by Playwright; without a network."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

_NAMES = ("chromium", "chromium-browser", "google-chrome")
_ARGUMENTS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--enable-unsafe-swiftshader",
    "--use-gl=angle",
    "--use-angle=swiftshader",
)


@contextmanager
def browser() -> Iterator[Any]:
    """Yield a running browser; skip the test where there is none."""
    sync_api = pytest.importorskip(
        "playwright.sync_api", reason="no Playwright: pip install playwright", exc_type=ImportError
    )
    program = next((found for name in _NAMES if (found := shutil.which(name))), None)
    if program is None:
        pytest.skip("no Chromium on the PATH: apt-get install chromium")
    with sync_api.sync_playwright() as playwright:
        running = playwright.chromium.launch(executable_path=program, args=list(_ARGUMENTS))
        try:
            yield running
        finally:
            running.close()


_DRAWS_NOTHING = """
for (const name of ['drawArrays', 'drawElements', 'drawArraysInstanced', 'drawElementsInstanced'])
  WebGL2RenderingContext.prototype[name] = () => {};
"""


def new_page(running: Any, *, draws: bool = False, **settings: Any) -> Any:
    """Return a new page; without `draws` nothing is drawn in its three-dimensional pictures.

    Without a graphics card a picture costs ten times what the page does for it, and few tests look at pictures.
    """
    page = running.new_page(**{"viewport": {"width": 1280, "height": 800}, **settings})
    page.set_default_timeout(60_000)
    if not draws:
        page.add_init_script(_DRAWS_NOTHING)
    return page
