"""Make the gallery while the documentation is built: pages of `polycnc view`, a drawing, and a report."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY / "scripts"))

from _gallery_programs import bear, bottle, burnt, carved  # noqa: E402

LASER = 'name = "laser"\n[spindle]\nlaser = true\nmax_rpm = 1000\n' + "".join(
    f'[[axis]]\nname = "{name}"\nvmax_mm_s = {speed}\namax_mm_s2 = {10 * speed}\n'
    for name, speed in (("X", 200), ("Y", 200), ("Z", 20))
)
WRITTEN = {
    "bear.nc": lambda: carved("A bear's head, ball end mills", bear, (32.0, 30.0), 4.0, 14.0),
    "mould.nc": lambda: carved("Half a mould for a bottle", bottle, (40.0, 18.0), 4.0, 20.0),
    "laser.gcode": burnt,
    "laser.toml": lambda: LASER,
}
VIEWS = {  # the page, and what is given to `polycnc view`
    "bear": ("bear.nc", "--stock", "auto", "--resolution", "0.2"),
    "mould": ("mould.nc", "--stock", "auto", "--resolution", "0.2"),
    "lathe-shaft": ("lathe_shaft.nc", "-m", "lathe2", "--stock", "cylinder=30,-75,0"),
    "five-axes": ("five_axis.nc", "-m", "mill5", "--stock", "cylinder=82,0,26"),
    "laser": ("laser.gcode", "-m", "laser.toml", "-d", "grbl"),
}
REPORT = "<!-- the report -->"
_SIZE, _EDGE = (760, 300), 40
_COLOURS = ("#1f77b4", "#d62728", "#2ca02c", "#9467bd")


def make(folder: Path) -> dict[str, Path]:
    """Make the files of the gallery in a folder; return them by their names."""
    for name, text in WRITTEN.items():
        (folder / name).write_text(text(), encoding="utf-8")
    for name in ("lathe_shaft.nc", "five_axis.nc", "flange.npg", "flange.toml"):
        shutil.copy(REPOSITORY / "examples" / name, folder)
    for name, arguments in VIEWS.items():
        _run(folder, "view", *arguments, "-o", f"{name}.html")
    _run(folder, "run", "flange.npg", "-m", "flange.toml")
    (folder / "gear-line.svg").write_text(_gear_line(), encoding="utf-8")
    return {
        name: folder / name for name in (*(f"{view}.html" for view in VIEWS), "gear-line.svg", "flange.txt")
    }


def _run(folder: Path, *arguments: str) -> None:
    command = [sys.executable, "-m", "polycnc.cli", *arguments]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)


def _gear_line() -> str:
    """Draw the speeds of a master and of what follows it by gears, one of them trimmed on the way."""
    from polycnc.controllers.imc import Card, imclib, parse_card

    card = Card(parse_card("number_of_axes = 4\nready = true"))
    imclib.attach(card)
    imclib.IMC_FindNetCard(imclib.NIC_INFO())
    _, handle = imclib.IMC_Open(0, 0)
    assert handle is not None
    for axis, ratio in ((1, 0.5), (2, -1.0), (3, 2.0)):
        imclib.IMC_GearFree(handle, ratio, 0, 0, axis, imclib.SEL_IFIFO)
    speeds: list[list[float]] = []
    for pulses_ms, trimmed, steps in ((20, 0, 150), (20, 1500, 150), (35, 0, 150), (0, 0, 150)):
        imclib.IMC_MoveVelocity(handle, pulses_ms * 65536, 0, imclib.SEL_IFIFO)
        if trimmed:
            imclib.IMC_MoveSuperimposed(handle, trimmed, 2, imclib.SEL_IFIFO)
        for _ in range(steps):
            card.advance(2)
            read = (imclib.IMC_GetParam32(handle, imclib.curvelLoc, axis)[1] for axis in range(4))
            speeds.append([each / 65536.0 for each in read])
    imclib.IMC_Close(handle)
    return _drawn(speeds, ("master", "half of it", "the other way, trimmed", "twice"))


def _drawn(rows: list[list[float]], names: tuple[str, ...]) -> str:
    """Return lines over time as SVG."""
    (width, height), low, high = _SIZE, min(map(min, rows)), max(map(max, rows))
    scale = (height - 2 * _EDGE) / (high - low)
    zero = _EDGE + high * scale
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}"'
        ' font-family="sans-serif" font-size="12">',
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
        f'<path d="M{_EDGE} {zero:.1f}H{width - _EDGE}" stroke="#999999" fill="none"/>',
    ]
    for number, (name, colour) in enumerate(zip(names, _COLOURS, strict=True)):
        places = " ".join(
            f"{_EDGE + at * (width - 2 * _EDGE) / len(rows):.1f},{zero - row[number] * scale:.1f}"
            for at, row in enumerate(rows)
        )
        parts.append(f'<polyline points="{places}" stroke="{colour}" fill="none" stroke-width="1.5"/>')
        parts.append(f'<text x="{_EDGE + 170 * number}" y="20" fill="{colour}">{name}</text>')
    parts.append(
        f'<text x="{_EDGE}" y="{height - 12}">speed (pulses/ms) over {2 * len(rows)} ms</text></svg>'
    )
    return "\n".join(parts) + "\n"


class _Made:
    """Hold what one build has made, until it has been copied."""

    folder: tempfile.TemporaryDirectory[str] | None = None


def on_files(files: Any, config: Any) -> Any:
    """Add what the gallery shows to the files of the documentation."""
    from mkdocs.structure.files import File

    if _Made.folder is None:
        _Made.folder = tempfile.TemporaryDirectory()
        make(Path(_Made.folder.name))
    for name in (*(f"{view}.html" for view in VIEWS), "gear-line.svg"):
        path = str(Path(_Made.folder.name) / name)
        files.append(File.generated(config, f"gallery/{name}", abs_src_path=path))
    return files


def on_page_markdown(markdown: str, *, page: Any, **_: Any) -> str:
    """Put the report that the CPL program has written into the page of the gallery."""
    if REPORT not in markdown or _Made.folder is None:
        return markdown
    report = (Path(_Made.folder.name) / "flange.txt").read_text(encoding="utf-8").rstrip()
    return markdown.replace(REPORT, f"```text\n{report}\n```")
