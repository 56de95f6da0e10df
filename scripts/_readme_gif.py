"""Film a view: run a part, open the page, let the slider cut it, keep the pictures as a GIF."""

from __future__ import annotations

import io
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import sync_playwright

REPOSITORY = Path(__file__).resolve().parents[1]
TARGET = REPOSITORY / "docs" / "images" / "view.gif"
SIZE = {"width": 1280, "height": 760}
SHOWN = (960, 570)
FRAMES = 48
FRAME_MS = 120
COLOURS = 64
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--enable-unsafe-swiftshader",
    "--use-gl=angle",
    "--use-angle=swiftshader",
]


def pictures(page_file: Path) -> list[Image.Image]:
    """Open a view and take pictures while the time slider goes from end to end."""
    program = next(
        found for name in ("chromium", "chromium-browser", "google-chrome") if (found := shutil.which(name))
    )
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=ARGUMENTS)
        page = browser.new_page(viewport=SIZE, color_scheme="light")
        page.goto(page_file.as_uri())
        page.wait_for_selector("html[data-ready=yes]", timeout=120_000)
        page.locator("#colour").select_option("tool")
        found = []
        for frame in range(FRAMES):
            page.evaluate(
                "share => { const s = document.getElementById('slider'); s.value = share * s.max; s.oninput(); }",
                (frame + 0.5) / FRAMES,
            )
            page.wait_for_timeout(150)
            found.append(
                Image.open(io.BytesIO(page.screenshot()))
                .convert("RGB")
                .resize(SHOWN, Image.Resampling.LANCZOS)
            )
        browser.close()
    return found


def main() -> None:
    """Make the GIF."""
    command = [sys.executable, "-m", "polycnc.cli"]
    with tempfile.TemporaryDirectory() as name:
        page = Path(name) / "view.html"
        part = str(REPOSITORY / "examples" / "bracket.nc")
        subprocess.run([*command, "view", part, "--stock", "auto", "-o", str(page)], check=True)
        found = pictures(page)
    palette = found[len(found) // 2].quantize(COLOURS)
    frames = [each.quantize(COLOURS, palette=palette, dither=Image.Dither.NONE) for each in found]
    frames[0].save(TARGET, save_all=True, append_images=frames[1:], duration=FRAME_MS, loop=0, optimize=True)
    found[len(found) // 2].save(Path(tempfile.gettempdir()) / "readme_gif-middle.png")
    print(f"wrote {TARGET}, {TARGET.stat().st_size // 1024} kB")


if __name__ == "__main__":
    main()
