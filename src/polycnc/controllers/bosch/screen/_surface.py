"""What the dialog window holds: characters in cells, texts at pixels, and pixels of lines (Manual 003, 7.3 and 8)."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple, TypeAlias
from xml.sax.saxutils import escape

import numpy as np
import numpy.typing as npt

from polycnc.outputs import complete_or_absent, format_of

SCREEN_FORMATS = (".txt", ".svg", ".png")

COLUMNS, LINES = 79, 46
WIDTH, HEIGHT = 633, 415
CELL_WIDTH, CELL_HEIGHT = 8, 9
SOFTKEY_ROWS = 40
"""Pixel rows of the softkeys, below the graphics."""
SOFTKEYS, SOFTKEY_LINES, SOFTKEY_WIDTH = 8, 3, 9
_FIRST_SOFTKEY_LINE, _FIRST_SOFTKEY_COLUMN = 43, 4
Colour: TypeAlias = tuple[int, int, int]
_DARK: tuple[Colour, ...] = (
    (0, 0, 0), (255, 0, 0), (0, 255, 0), (255, 255, 0), (0, 0, 255), (255, 0, 255), (0, 255, 255), (255, 255, 255),
)  # fmt: skip


class Cell(NamedTuple):
    """A character with the codes of its colours."""

    character: str = " "
    colour: int = 2
    background: int = 0


class Font(NamedTuple):
    """What TFO selects: font, height and width in pixels (0: as the font has it), cut, angle in degrees."""

    font: int = 0
    height: int = CELL_HEIGHT
    width: int = 0
    cut: int = 0
    orientation_deg: int = 0


class Text(NamedTuple):
    """A text whose first character begins at a pixel, counted from the bottom left corner of the window."""

    x: int
    y: int
    text: str
    colour: int
    font: Font


class Surface:
    """The window: cells by (line, column) from 1 on, texts in other fonts or at pixels, and codes of colours by pixel.

    `pixels[y, x]` counts from the bottom left corner of the window, -1 where nothing is drawn; graphics begin
    SOFTKEY_ROWS above it.
    """

    def __init__(self) -> None:
        self.tables: dict[int, list[Colour]] = {1: list(_DARK), 2: list(_DARK[::-1]), 3: list(_DARK[::-1])}
        self.table = 1
        self.softkey_colours = (3, 4)
        self.clear()

    def clear(self) -> None:
        """Take everything off the window."""
        self.cells: dict[tuple[int, int], Cell] = {}
        self.texts: list[Text] = []
        self.pixels: npt.NDArray[np.int8] = np.full((HEIGHT, WIDTH), -1, np.int8)
        self.softkeys: tuple[str, ...] = ()

    def clear_window(self, left: int, right: int, bottom: int, top: int) -> None:
        """Take everything out of a rectangle of pixels (from the bottom left corner of the window)."""
        self.pixels[bottom : top + 1, left : right + 1] = -1
        self.texts = [t for t in self.texts if not (left <= t.x <= right and bottom <= t.y <= top)]
        for line, column in list(self.cells):
            x, y = (column - 1) * CELL_WIDTH, (LINES - line) * CELL_HEIGHT
            if left <= x and x + CELL_WIDTH - 1 <= right and bottom <= y and y + CELL_HEIGHT - 1 <= top:
                del self.cells[line, column]

    def write(self, line: int, column: int, text: str, colour: int, background: int) -> None:
        """Write a text into cells; what goes over the right border is cut off."""
        for offset, character in enumerate(text[: COLUMNS - column + 1]):
            self.cells[line, column + offset] = Cell(character, colour, background)

    def lines(self) -> list[str]:
        """Return the window as 46 lines of 79 characters, softkeys in lines 43 to 45."""
        rows = [[" "] * COLUMNS for _ in range(LINES)]
        for (line, column), cell in self.cells.items():
            rows[line - 1][column - 1] = cell.character if cell.character.isprintable() else " "
        for text in self.texts:
            line, column = LINES - text.y // CELL_HEIGHT, text.x // CELL_WIDTH
            for offset, character in enumerate(text.text):
                if 0 < line <= LINES and column + offset < COLUMNS and character.isprintable():
                    rows[line - 1][column + offset] = character
        for line, column, part in self._softkey_parts():
            rows[line - 1][column - 1 : column - 1 + len(part)] = part
        return ["".join(row) for row in rows]

    def save(self, path: Path) -> None:
        """Write the window to a .txt, .svg or .png file (the last needs matplotlib).

        Raises:
            UsageError: The file cannot be written.
        """
        extension = format_of(path, SCREEN_FORMATS)
        with complete_or_absent(path) as partial:
            if extension == ".txt":
                partial.write_text("".join(f"{line}\n" for line in self.lines()), "utf-8")
            elif extension == ".svg":
                partial.write_text(self.svg(), "utf-8")
            else:
                self._save_png(partial)

    def rgb(self, code: int) -> str:
        """Return a colour of the active table as #rrggbb."""
        return "#{:02x}{:02x}{:02x}".format(*self.tables[self.table][code])

    def svg(self) -> str:
        """Return the window as a drawing."""
        parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
            f'width="{WIDTH}" height="{HEIGHT}">',
            f'<rect width="{WIDTH}" height="{HEIGHT}" fill="{self.rgb(0)}"/>',
        ]
        for (line, column), cell in sorted(self.cells.items()):
            if cell.background:
                parts.append(
                    f'<rect x="{(column - 1) * CELL_WIDTH}" y="{(line - 1) * CELL_HEIGHT}" width="{CELL_WIDTH}" '
                    f'height="{CELL_HEIGHT}" fill="{self.rgb(cell.background)}"/>'
                )
        parts += self._svg_pixels()
        for (line, column), cell in sorted(self.cells.items()):
            if cell.character.strip() and cell.character.isprintable():
                x, y = (column - 1) * CELL_WIDTH, line * CELL_HEIGHT - 2
                parts.append(_svg_text(x, y, cell.character, self.rgb(cell.colour), Font()))
        parts += [_svg_text(t.x, HEIGHT - 1 - t.y, t.text, self.rgb(t.colour), t.font) for t in self.texts]
        colour, background = map(self.rgb, self.softkey_colours)
        for place, _ in enumerate(self.softkeys):
            x = (_FIRST_SOFTKEY_COLUMN - 1 + place * SOFTKEY_WIDTH) * CELL_WIDTH
            parts.append(
                f'<rect x="{x}" y="{HEIGHT - SOFTKEY_ROWS}" width="{SOFTKEY_WIDTH * CELL_WIDTH - 2}" '
                f'height="{SOFTKEY_ROWS - 2}" fill="{background}"/>'
            )
        parts += [
            _svg_text((column - 1) * CELL_WIDTH, line * CELL_HEIGHT, part, colour, Font())
            for line, column, part in self._softkey_parts()
        ]
        return "\n".join((*parts, "</svg>\n"))

    def _svg_pixels(self) -> Iterable[str]:
        for code in range(8):
            runs = []
            for y in np.flatnonzero((self.pixels == code).any(axis=1)):
                edges = np.flatnonzero(
                    np.diff(np.concatenate(([0], self.pixels[y] == code, [0])).astype(np.int8))
                )
                runs += [
                    f"M{begin} {HEIGHT - 1 - y}h{end - begin}v1h-{end - begin}z"
                    for begin, end in zip(edges[::2], edges[1::2], strict=True)
                ]
            if runs:
                yield f'<path fill="{self.rgb(code)}" d="{"".join(runs)}"/>'

    def _softkey_parts(self) -> list[tuple[int, int, str]]:
        """Return line, column and text of what stands on the softkeys, centred."""
        return [
            (
                _FIRST_SOFTKEY_LINE + row,
                _FIRST_SOFTKEY_COLUMN + place * SOFTKEY_WIDTH,
                part[:SOFTKEY_WIDTH].center(SOFTKEY_WIDTH),
            )
            for place, text in enumerate(self.softkeys)
            for row, part in enumerate(text.split("&")[:SOFTKEY_LINES])
            if part
        ]

    def _save_png(self, path: Path) -> None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        axes.set_xlim(-0.5, WIDTH - 0.5)
        axes.set_ylim(-0.5, HEIGHT - 0.5)
        image = np.array(self.tables[self.table], np.uint8)[np.maximum(self.pixels, 0)]
        for (line, column), cell in self.cells.items():
            y, x = HEIGHT - line * CELL_HEIGHT, (column - 1) * CELL_WIDTH
            block = image[y : y + CELL_HEIGHT, x : x + CELL_WIDTH]
            block[self.pixels[y : y + CELL_HEIGHT, x : x + CELL_WIDTH] < 0] = self.tables[self.table][
                cell.background
            ]
            if cell.character.strip() and cell.character.isprintable():
                axes.text(x, y + 1, cell.character, color=self.rgb(cell.colour), fontsize=6, family="monospace",
                          parse_math=False)  # fmt: skip
        axes.imshow(image, origin="lower", aspect="auto", interpolation="nearest")
        for text in self.texts:
            axes.text(text.x, text.y, text.text, color=self.rgb(text.colour), fontsize=text.font.height * 0.7,
                      rotation=text.font.orientation_deg, parse_math=False)  # fmt: skip
        for line, column, part in self._softkey_parts():
            axes.text((column - 1) * CELL_WIDTH, HEIGHT - line * CELL_HEIGHT, part, fontsize=6, family="monospace",
                      color=self.rgb(self.softkey_colours[0]), backgroundcolor=self.rgb(self.softkey_colours[1]),
                      parse_math=False)  # fmt: skip
        figure.savefig(path, format="png", metadata={"Software": None})


_FAMILIES = (
    "Lucida Console", "Arial", "Verdana", "Book Antiqua", "Times New Roman", "Bosch", "Impact", "Haettenschweiler",
    "Comic Sans MS", "Brush Script MT", "Wingdings",
)  # fmt: skip


def _svg_text(x: int, y: int, text: str, colour: str, font: Font) -> str:
    style = (' font-weight="bold"' if font.cut & 1 else "") + (' font-style="italic"' if font.cut & 2 else "")
    if font.orientation_deg:
        style += f' transform="rotate({-font.orientation_deg} {x} {y})"'
    if font.width:
        style += f' textLength="{font.width * len(text)}" lengthAdjust="spacingAndGlyphs"'
    return (
        f'<text x="{x}" y="{y}" fill="{colour}" font-family="{_FAMILIES[font.font]}, monospace" '
        f'font-size="{font.height}"{style} xml:space="preserve">{escape(text)}</text>'
    )
