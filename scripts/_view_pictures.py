"""Take the pictures of the documentation from real pages: of `polycnc view` and of a served machine, in a browser."""

from __future__ import annotations

import re
import runpy
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import httpx
from playwright.sync_api import Browser, sync_playwright

REPOSITORY = Path(__file__).resolve().parents[1]
IMAGES = REPOSITORY / "docs" / "images"
ARGUMENTS: list[str] = runpy.run_path(str(REPOSITORY / "scripts" / "_readme_gif.py"))["ARGUMENTS"]
PICTURES = (  # image, program, what is given with it, moment, what is chosen
    ("view-stock.png", "bracket.nc", ("--stock", "auto"), 0.86, {"#colour": "tool"}),
    ("view-section.png", "bracket.nc", ("--stock", "auto"), 1.0, {"#colour": "tool", "#section": "1"}),
    ("view-lathe.png", "lathe_shaft.nc", ("-m", "lathe2"), 0.75, {"#colour": "tool"}),
    (
        "view-lathe-stock.png",
        "lathe_shaft.nc",
        ("-m", "lathe2", "--stock", "cylinder=30,-75,0"),
        0.8,
        {"#colour": "tool", "button": "3-D"},
    ),
    (
        "view-five-axes-stock.png",
        "five_axis.nc",
        ("-m", "mill5", "--stock", "cylinder=82,0,26"),
        1.0,
        {"#colour": "tool"},
    ),
    ("view-cut-width.png", "bracket.nc", ("--stock", "auto"), 1.0, {"#colour": "radial"}),
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
                if which == "button":
                    page.get_by_role("button", name=value, exact=True).click()
                else:
                    page.locator(which).select_option(value)
            page.wait_for_timeout(500)
            page.screenshot(path=IMAGES / image)
            page.close()
            print(f"wrote {IMAGES / image}")
        operate(browser)
        browser.close()


def operate(browser: Browser) -> None:
    """Take the page of a machine that executes a program."""
    command = [sys.executable, "-m", "polycnc.cli", "serve", "--plain", "mill3", "--doors", "http=0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as served:
        assert served.stdout is not None
        found = re.search(r"http://\S+", served.stdout.readline())
        assert found
        program = (REPOSITORY / "examples" / "bracket.nc").read_bytes()
        with httpx.Client(base_url=f"{found[0]}/api/machines/machine", timeout=60) as machine:
            machine.put("/programs/BRACKET", content=program).raise_for_status()
            for asked in (
                {"command": "select_mode", "mode": "auto"},
                {"command": "select_program", "program": "BRACKET"},
                {"command": "cycle_start"},
            ):
                machine.post("/commands", json=asked).raise_for_status()
        page = browser.new_page(viewport={"width": 1280, "height": 800}, color_scheme="light")
        page.goto(found[0])
        page.wait_for_timeout(20_000)
        page.screenshot(path=IMAGES / "operate.png")
        print(f"wrote {IMAGES / 'operate.png'}")
        served.terminate()


if __name__ == "__main__":
    main()
