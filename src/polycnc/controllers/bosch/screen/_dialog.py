"""Output, input and softkeys of the dialog window (Manual 003, 7.3, 8.1, 8.7 to 8.9)."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from polycnc.controllers.bosch.files import as_output
from polycnc.controllers.bosch.screen._bitmap import COPY_TYPES, Image, paint
from polycnc.controllers.bosch.screen._drawing import Drawing, colour_code, number
from polycnc.controllers.bosch.screen._keys import KEYS, Keyboard
from polycnc.controllers.bosch.screen._surface import (
    CELL_HEIGHT,
    CELL_WIDTH,
    COLUMNS,
    HEIGHT,
    LINES,
    SOFTKEY_ROWS,
    SOFTKEYS,
    WIDTH,
    Font,
    Surface,
    Text,
)  # fmt: skip
from polycnc.nc.cpl import (
    BLOCKED,
    OMITTED,
    Box,
    CharacterField,
    Fault,
    Item,
    default_format,
    groups,
    number_in,
    text_of,
)

OLD_SOFTKEYS = 5
_LONGEST_TEXT = 77
_LONGEST_BITMAP = 70
_TABLES = {1: 1, 7: 2, 10: 3}
_SKIPS = {KEYS[name] for name in KEYS if name.startswith("CURSOR")}


class Dialog:
    """The dialog of one program: its window, and the keys that are pressed.

    `left` tells whether numbers are put out left-justified, `bitmap` returns the picture of a name, `say` takes
    messages, `few_keys` tells whether the program is one of older controls, whose panels have 5 softkeys.
    """

    def __init__(
        self,
        keyboard: Keyboard,
        left: Callable[[], bool] = lambda: False,
        bitmap: Callable[[str], Image | None] = lambda name: None,
        say: Callable[[str], None] = lambda text: None,
        few_keys: Callable[[], bool] = lambda: False,
    ) -> None:
        self._few_keys = few_keys
        self.surface = Surface()
        self.in_front = True
        self._keyboard = keyboard
        self._left = left
        self._bitmap = bitmap
        self._say = say
        self._drawing = Drawing(self.surface)
        self._font = Font()
        self._text_colours = (2, 0)
        self._prompts: list[tuple[int, int, str, Box | None]] = []
        self._in_dialog = False
        self._shown = 0
        self._typing = "", False  # into a field of INP that waits for a key, and whether DELETE was pressed
        self.functions: Mapping[str, Callable[..., object]] = {
            **self._drawing.functions,
            "DSP": self._dsp, "DLG": self._dlg, "ENDDLG": self._enddlg, "PRN": self._prn, "INP": self._inp,
            "INKEY": self._inkey, "SFK": self._sfk, "CSF": self._csf, "TFO": self._tfo, "COL": self._col,
            "RGB": self._rgb, "CLS": self._cls, "CLG": self._clg, "DLF": self._dlf, "GPR": self._gpr,
            "BMP": self._bmp,
        }  # fmt: skip

    @property
    def is_open(self) -> bool:
        """Whether the program has opened a dialog."""
        return self._in_dialog

    def finish(self) -> None:
        """End the program: dialog and softkeys go, the font is the default one again, nothing is half typed."""
        self._in_dialog, self._prompts, self._shown = False, [], 0
        self._typing = "", False
        self.surface.softkeys = ()
        self._font = Font()

    # ------------------------------------------------------------------ output

    def _dsp(self, line: object, column: object, *items: object) -> int:
        at = _place(line, column)
        output = as_output(items, left=self._left())
        if any(len(piece) > _LONGEST_TEXT for piece in output.pieces):
            raise Fault("maximum string length exceeded", f"a text has at most {_LONGEST_TEXT} characters")
        if output.misfits:
            raise Fault("format not permitted", f"the number does not fit {output.misfits[0]}")
        self._write(*at, output.text)
        return 0

    def _write(self, line: int, column: int, text: str) -> None:
        if self._font == Font():
            self.surface.write(line, column, text, *self._text_colours)
        else:
            x, y = (column - 1) * CELL_WIDTH, HEIGHT - line * CELL_HEIGHT
            self.surface.texts.append(Text(x, y, text, self._text_colours[0], self._font))

    def _gpr(self, x: object, y: object, text: object) -> int:
        place = round(number(x)), round(number(y))
        if not (0 <= place[0] < WIDTH and 0 <= place[1] < HEIGHT):
            raise Fault("INVALID PARAMETER", f"pixels are 0 to {WIDTH - 1} and 0 to {HEIGHT - 1}")
        self.surface.texts.append(Text(*place, text_of(text) or "", self._text_colours[0], self._font))
        return 0

    def _bmp(self, x: object, y: object, file: object, copy_type: object = OMITTED) -> int:
        at = round(number(x)), round(number(y))
        if not (0 <= at[0] < WIDTH and 0 <= at[1] < HEIGHT - SOFTKEY_ROWS):
            raise Fault("INVALID PARAMETER", "a bitmap begins at 0 to 632 and 0 to 374")
        name = text_of(file) or ""
        if len(name) > _LONGEST_BITMAP:
            raise Fault("INVALID FILE NAME", f"the name of a bitmap has at most {_LONGEST_BITMAP} characters")
        how = _within(copy_type, len(COPY_TYPES) - 1, "copy types", 0)
        image = self._bitmap(name)
        if image is None:
            self._say(f"cplbmp\\{name}.bmp is not existing")
            return 0
        paint(self.surface, *at, image, how)
        return 0

    def _tfo(
        self, font: object, size: object = OMITTED, cut: object = OMITTED, orientation: object = OMITTED
    ) -> int:
        chosen = [
            _within(value, most, name, old)
            for value, most, name, old in (
                (font, 10, "fonts", self._font.font),
                (size, 500_500, "sizes", self._font.height + 1000 * self._font.width),
                (cut, 3, "cuts", self._font.cut),
                (orientation, 360, "orientations", self._font.orientation_deg),
            )
        ]
        width, height = divmod(chosen[1], 1000)
        if chosen[1] and not (1 <= height <= 500 and width <= 500):
            raise Fault("INVALID PARAMETER", "a font is 1 to 500 pixels high and wide")
        angle = 0 if chosen[0] == 5 else chosen[3] % 360
        self._font = Font(chosen[0], height or CELL_HEIGHT, width, chosen[2], angle)
        return 0

    def _col(self, *codes: object) -> int:
        given = [*codes, *[OMITTED] * (6 - len(codes))]
        table = given.pop(3)
        if table is not OMITTED and (isinstance(table, bool) or table not in _TABLES):
            raise Fault("INVALID PARAMETER", "tables of colours are 1, 7 (table 2) and 10 (table 3)")
        now = (self._drawing.colour, *self._text_colours, *self.surface.softkey_colours)
        new = [old if code is OMITTED else colour_code(code) for code, old in zip(given, now, strict=True)]
        self._drawing.colour = new[0]
        self._text_colours = new[1], new[2]
        self.surface.softkey_colours = new[3], new[4]
        if isinstance(table, int):
            self.surface.table = _TABLES[table]
            self.surface.clear()
        return 0

    def _rgb(self, code: object, *portions: object) -> int:
        red, green, blue = (_within(portion, 255, "portions of a colour", 0) for portion in portions)
        self.surface.tables[3][colour_code(code)] = (red, green, blue)
        return 0

    def _cls(self) -> int:
        self.surface.clear()
        return 0

    def _clg(self) -> int:
        self.surface.clear()
        self.in_front = False
        return 0

    def _dlf(self) -> int:
        self.in_front = True
        return 0

    # ------------------------------------------------------------------ keys

    def _inkey(self) -> int:
        return self._keyboard.poll() if self.in_front else 0

    def _csf(self) -> int:
        self.surface.softkeys = ()
        return 0

    def _sfk(self, variable: object, *texts: object) -> object:
        shown = [(text_of(text) or "") if text is not OMITTED else "" for text in texts]
        keys = OLD_SOFTKEYS if self._few_keys() else SOFTKEYS
        shown = [*shown[:keys], *[""] * (SOFTKEYS - min(len(shown), keys))]
        self.surface.softkeys = tuple(shown)
        while (key := self._keyboard.wait()) != KEYS["LEVEL_RETURN"]:
            if key is None:
                return BLOCKED
            number_of_key = key - KEYS["SOFTKEY1"] + 1
            if not 1 <= number_of_key <= keys:
                continue
            if isinstance(variable, CharacterField):
                variable.assign(shown[number_of_key - 1])
            elif isinstance(variable, Box):
                variable.value = shown[number_of_key - 1] if variable.kind == "S" else number_of_key
            break
        return 0

    # ------------------------------------------------------------------ input

    def _dlg(self) -> int:
        self._in_dialog, self._prompts, self._shown = True, [], 0
        return 0

    def _enddlg(self) -> int:
        self._show_prompts()
        self._in_dialog = False
        return 0

    def _prn(self, line: object, column: object, text: object, variable: object = None) -> int:
        wanted = text_of(text.value if isinstance(text, Item) else text) or ""
        box = variable if isinstance(variable, Box) else None
        if isinstance(variable, CharacterField):
            wanted += variable.text or ""
        self._prompts.append((*_place(line, column), wanted, box))
        if not self._in_dialog:
            self._show_prompts()
        return 0

    def _show_prompts(self) -> None:
        for line, column, text, box in self._prompts[self._shown :]:
            self.surface.write(line, column, _prompt(text, box), *self._text_colours)
        self._shown = len(self._prompts)

    def _inp(self, variable: object) -> object:
        self._show_prompts()
        if not isinstance(variable, Box) or variable.kind not in ("I", "R", "D"):
            return 0
        found = next(
            (prompt for prompt in self._prompts[::-1] if prompt[3] and prompt[3].name == variable.name), None
        )
        if not self._in_dialog or found is None:
            raise Fault("INP WITHOUT PRN", f"write PRN(line,column,text,{variable.name}) before, after DLG")
        line, column, text, _ = found
        begin, end = (groups(text) or [(len(text), len(text) + 9)])[0]
        (typed, deleted), self._typing = self._typing, ("", False)
        while (key := self._keyboard.wait()) not in (KEYS["ENTER"], KEYS["LEVEL_RETURN"], *_SKIPS):
            if key is None:
                self._typing = typed, deleted
                return BLOCKED
            if key == KEYS["DELETE"]:
                typed, deleted = "", True
            elif chr(key) in "0123456789.-+" and _fits(typed + chr(key), text[begin:end], variable.kind):
                typed += chr(key)
            self.surface.write(line, column + begin, typed.ljust(end - begin), *self._text_colours)
        if key == KEYS["ENTER"]:
            if typed.strip("+-."):
                variable.value = int(typed) if variable.kind == "I" else float(typed)
            elif deleted:
                variable.value = None
        self.surface.write(line, column, _prompt(text, variable), *self._text_colours)
        return 0


def _fits(typed: str, group: str, kind: str) -> bool:
    """Tell whether a number that is being typed keeps to its format."""
    digits = typed.lstrip("+-")
    _, point, decimals = digits.partition(".")
    if any(sign in digits for sign in "+-") or len(typed) - len(digits) > 1 or "." in decimals:
        return False
    if kind == "I" and point:
        return False
    if not group:
        return len(typed) <= 9
    most, _, most_decimals = group.partition(".")
    return len(typed) - len(point + decimals) <= len(most) and len(decimals) <= len(most_decimals)


def _prompt(text: str, box: Box | None) -> str:
    """Return a prompt with the value of its variable, with the format where there is none."""
    if box is None or not isinstance(box.value, int | float) or isinstance(box.value, bool):
        return text
    places = groups(text)
    if not places:
        return text + default_format(box.kind, box.value)
    begin, end = places[0]
    return text[:begin] + (number_in(text[begin:end], box.value) or text[begin:end]) + text[end:]


def _place(line: object, column: object) -> tuple[int, int]:
    values = [each.value if isinstance(each, Item) else each for each in (line, column)]
    at = [int(number(value) + 0.5) for value in values]
    if not (1 <= at[0] <= LINES and 1 <= at[1] <= COLUMNS):
        raise Fault(
            "Invalid line or column number in CPL command", f"lines are 1 to {LINES}, columns 1 to {COLUMNS}"
        )
    return at[0], at[1]


def _within(value: object, most: int, name: str, old: int) -> int:
    if value is OMITTED:
        return old
    if type(value) is not int or not 0 <= value <= most:
        raise Fault("INVALID PARAMETER", f"{name} are 0 to {most}")
    return value
