"""Take the pictures of the documentation from real pages: what `polycnc view` writes, in a browser."""

from __future__ import annotations

import runpy
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

REPOSITORY = Path(__file__).resolve().parents[1]
IMAGES = REPOSITORY / "docs" / "images"
ARGUMENTS: list[str] = runpy.run_path(str(REPOSITORY / "scripts" / "_readme_gif.py"))["ARGUMENTS"]
PICTURES = (  # image, program, what is given with it, moment, what is chosen
    ("view-stock.png", "bracket.nc", ("--stock", "auto"), 0.86, {"#colour": "tool"}),
    ("view-section.png", "bracket.nc", ("--stock", "auto"), 1.0, {"#colour": "tool", "#section": "1"}),
    ("view-lathe.png", "lathe_shaft.nc", ("-m", "lathe2"), 0.75, {"#colour": "tool"}),
    ("view-five-axes.png", "five_axis.nc", ("-m", "mill5"), 0.93, {"#frame": "machine"}),
)
MOVE = "s => { const e = document.getElementById('slider'); e.value = s * e.max; e.oninput(); }"


def main() -> None:
    """Take all pictures."""
    program = next(found for name in ("chromium", "google-chrome") if (found := shutil.which(name)))
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        for image, part, given, share, chosen in PICTURES:
            page_file = Path(name) / "view.html"
            source = str(REPOSITORY / "examples" / part)
            command = [sys.executable, "-m", "polycnc.cli", "view", source, *given, "-o", str(page_file)]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            page = browser.new_page(viewport={"width": 1280, "height": 760}, color_scheme="light")
            page.goto(page_file.as_uri())
            page.wait_for_selector("html[data-ready=yes]", timeout=120_000)
            page.evaluate(MOVE, share)
            for which, value in chosen.items():
                page.locator(which).select_option(value)
            page.wait_for_timeout(500)
            page.screenshot(path=IMAGES / image)
            page.close()
            print(f"wrote {IMAGES / image}")
        browser.close()


if __name__ == "__main__":
    main()
