"""The words of one block, sorted by what they ask for, and refused when they contradict each other."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import partial

from polycnc.errors import ProgramError
from polycnc.nc.dialect._dialect import DIALECTS, Dialect, load_dialect
from polycnc.nc.modal._actions import Action, Group, MAction
from polycnc.nc.text._program import ProgramText
from polycnc.nc.text._scan_plain import Block, Word

Fail = Callable[[str, str, Word | None], ProgramError]

LARGEST_M = 99999
LARGEST_NUMBER = 99_999_999
_LARGEST_ANGLE_DEG = 360_000.0
NUMBERS = "NO:"
"""The letters of block and program numbers."""
MOST_WORDS = 1000
"""Words of a block: far more than any control reads. A file of one line would take hours otherwise."""
_OF_MOVES = range(40, 50)  # offsets, after which axis words are still a move
_NOT_YET = (
    "What it does would be left out: post the program without it, or remove it if the part does not need it."
)
_CYCLE_OF_A = 90.0
_SYSTEM_A = {91.0: "U and W are incremental", 95.0: "feed per revolution is G99"}
_SYSTEM_B = "fanuc-lathe-b"
"""What codes of other code systems for lathes are in system A, which has a cycle for their absolute positions."""
_REMARKS = re.compile(rb"\([^)\r\n]*\)")
_COOLANT_ON = (MAction.COOLANT_MIST, MAction.COOLANT_FLOOD)
_BOTH_COOLANTS = set(_COOLANT_ON)


@dataclass(frozen=True, slots=True)
class GWord:
    """A G word and what it does in this dialect; `value` is that of its group, 0 where no number tells it."""

    word: Word
    code: str
    action: Action
    value: int


@dataclass(frozen=True, slots=True)
class MWord:
    """An M word and what it does in this dialect."""

    word: Word
    code: int
    action: MAction


@dataclass
class BlockWords:
    """Hold a block's G words by modal group, its M words in order, and all other words by address.

    Each word of an address is for one function: who takes it first has it. `increment` is the size of a
    length without a decimal point, 0 if such numbers are as they stand. `left_out` are codes that the user told to
    leave out, `takes_words` says that the words beside them go with them. `remarks` are to be reported.
    """

    g: dict[Group, GWord] = field(default_factory=dict)
    ignored: list[GWord] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    m: list[MWord] = field(default_factory=list)
    by_letter: dict[str, Word] = field(default_factory=dict)
    increment: float = 0.0
    takes_words: bool = False
    used: set[str] = field(default_factory=partial(set, NUMBERS))

    def lengths(self, letters: Iterable[str]) -> list[tuple[str, float]]:
        """Return letter and number of those of `letters` that are there, which are lengths or angles; take them."""
        found = []
        for letter in letters:
            word = self.by_letter.get(letter)
            if word is not None and letter not in self.used:
                self.used.add(letter)
                found.append(
                    (letter, word.value if word.point or not self.increment else word.value * self.increment)
                )
        return found

    def take(self, letter: str) -> Word | None:
        """Return the word of `letter`, if there is one that nothing has taken, and take it."""
        word = self.by_letter.get(letter)
        if word is None or letter in self.used:
            return None
        self.used.add(letter)
        return word

    def value(self, letter: str) -> float | None:
        """Return the number of the word of `letter` and take it."""
        word = self.take(letter)
        return None if word is None else word.value

    def length(self, letter: str) -> float | None:
        """Return the number of the word of `letter`, which is a length or an angle, and take it."""
        word = self.take(letter)
        if word is None:
            return None
        return word.value if word.point or not self.increment else word.value * self.increment

    def take_all(self) -> None:
        """Take every word that nothing has taken."""
        self.used.update(self.by_letter)

    def first(self, *letters: str) -> Word | None:
        """Return the word of the first of `letters` that stands in the block, taken or not."""
        for letter in letters:
            if letter in self.by_letter:
                return self.by_letter[letter]
        return None

    def g_word(self, group: Group) -> Word | None:
        """Return the word of a modal group, to show its place."""
        g = self.g.get(group)
        return None if g is None else g.word

    @property
    def has_codes(self) -> bool:
        """Whether there are G or M words, such as do nothing among them."""
        return bool(self.g or self.m or self.ignored or self.left_out)

    def unused(self) -> Iterator[tuple[str, Word]]:
        """Yield address and word of all that nothing has taken."""
        for letter, word in self.by_letter.items():
            if letter not in self.used:
                yield letter, word


def _other_dialects(word: Word, own: Dialect) -> str:
    """Return what to do with a code that the dialect does not know; it names the shipped dialects that carry it out."""
    if word.letter == "G" and word.value in _SYSTEM_A and own.g_action(_CYCLE_OF_A) is Action.TURN_CYCLE:
        return f"The dialect is G code system A: {_SYSTEM_A[word.value]}. System B is dialect {_SYSTEM_B}."
    having = []
    for name in DIALECTS:
        dialect = load_dialect(name)
        if word.letter == "G":
            known = dialect.g_action(word.value) not in (None, Action.UNSUPPORTED)
        else:
            known = dialect.m_action(int(word.value)) not in (None, MAction.UNSUPPORTED)
        having += [name] * known
    having_it = f" ({', '.join(having)} {'has' if len(having) == 1 else 'have'} it)" if having else ""
    return f"Remove it, or name the dialect of the control that the program is for{having_it}."


def code_text(value: float) -> str:
    """Return a number as it is usually written in a program: 1, 54, 5.1, 12000."""
    return f"{value:.0f}" if value.is_integer() and abs(value) < 1e16 else f"{value:.10g}"


class WordSorter:
    """Sort the words of blocks by what they ask for in a dialect."""

    def __init__(self, dialect: Dialect) -> None:
        self._dialect = dialect
        self._codes = dialect.g_codes()

    def sort(self, words: BlockWords, block: Block, text: ProgramText, fail: Fail) -> None:
        """Sort the words of a block of `text` into `words`.

        Raises:
            ProgramError: an unknown G or M code, two words of one group, an address that stands twice.
        """
        if len(block.words) > MOST_WORDS:
            raise fail(
                f"a block with {len(block.words)} words",
                f"No block has more than {MOST_WORDS}: check the line ends.",
                block.words[MOST_WORDS],
            )
        for word in block.words:
            if word.letter == "G" and word.index is None:
                self._add_g(word, words, text, fail)
            elif word.letter == "M" and word.index is None:
                self._add_m(word, words, fail)
            else:
                if word.letter == "N" and "N behind words" in self._dialect.refuses:
                    _refuse_late_number(word, block, fail)
                _add_value(word, words, fail, two_tools=self._dialect.two_tools)

    def _add_g(self, word: Word, words: BlockWords, text: ProgramText, fail: Fail) -> None:
        action = self._codes.get(word.value) or self._dialect.g_action(word.value)
        code = code_text(word.value)
        if action is None:
            raise fail(
                f"G{code} is not known in dialect '{self._dialect.name}'",
                _other_dialects(word, self._dialect),
                word,
            )
        group = action.group
        entry = GWord(word, code, action, action.sets or 0)
        if group is Group.IGNORED:
            if action is Action.UNSUPPORTED:
                blocks = _blocks_with(code, text)
                where = "1 block has it" if blocks == 1 else f"{blocks} blocks have it"
                raise fail(f"G{code} is not supported yet ({where})", _NOT_YET, word)
            if action is Action.LEFT_OUT:
                words.left_out.append(f"G{code}")
                words.takes_words = words.takes_words or int(word.value) not in _OF_MOVES
                return
            words.ignored.append(entry)
            return
        if (
            group is Group.MOTION
            and group in words.g
            and Action.MOTION_OFF in (action, words.g[group].action)
        ):
            if action is Action.MOTION_OFF:
                return
            del words.g[group]
        if group in words.g:
            self._override(f"G{words.g[group].code}", f"G{code}", group, word, words, fail)
        words.g[group] = entry

    def _add_m(self, word: Word, words: BlockWords, fail: Fail) -> None:
        if not word.value.is_integer() or not 0 <= word.value <= LARGEST_M:
            raise fail(f"there is no M{code_text(word.value)}", f"M codes are M0 to M{LARGEST_M}.", word)
        code = int(word.value)
        action = self._dialect.m_action(code)
        if action is None:
            raise fail(
                f"M{code} is not known in dialect '{self._dialect.name}'",
                _other_dialects(word, self._dialect),
                word,
            )
        if action is MAction.UNSUPPORTED:
            raise fail(f"M{code} is not supported yet", _NOT_YET, word)
        if action is MAction.LEFT_OUT:
            words.left_out.append(f"M{code}")
            return
        for other in list(words.m):
            pair = {action, other.action}
            if other.code == code or (action.group and other.action.group == action.group):
                group = action.group
            elif self._are_coolants(pair):
                group = "coolant"
            else:
                continue
            self._override(f"M{other.code}", f"M{code}", group, word, words, fail)
            words.m.remove(other)
        words.m.append(MWord(word, code, action))

    def _are_coolants(self, pair: set[MAction]) -> bool:
        """Tell whether two coolant codes exclude each other."""
        switched_off = MAction.COOLANT_OFF in pair and not pair.isdisjoint(_COOLANT_ON)
        return switched_off or (pair == _BOTH_COOLANTS and "two coolants" in self._dialect.refuses)

    def _override(
        self, first: str, second: str, group: str, word: Word, words: BlockWords, fail: Fail
    ) -> None:
        """Let the last of two codes that exclude each other count, where the dialect says so.

        Raises:
            ProgramError: the dialect refuses them.
        """
        twice = first == second
        what = f"{first} is given twice in this block"
        if not twice:
            what = f"{first} and {second} exclude each other (group '{group.replace('_', ' ')}')"
        if self._dialect.same_group == "error":
            raise fail(what, "Write it once." if twice else "Write one of them.", word)
        words.remarks.append(f"{what}: the last one counts")


def _blocks_with(code: str, text: ProgramText) -> int:
    """Return in how many blocks of a text a G code stands."""
    pattern = rb"[Gg][ \t]*0*" + re.escape(code.encode()) + rb"(?![0-9.])"
    content = _REMARKS.sub(lambda found: b" " * len(found[0]), text.content)
    return len({content.rfind(b"\n", 0, found.start()) for found in re.finditer(pattern, content)})


def _refuse_late_number(word: Word, block: Block, fail: Fail) -> None:
    if word is not block.words[0]:
        raise fail("the block number N stands behind other words", "A block number begins its line.", word)


def _add_value(word: Word, words: BlockWords, fail: Fail, *, two_tools: bool) -> None:
    letter = word.letter if word.index is None else f"{word.letter}{word.index}"
    if two_tools and letter == "T" and letter in words.by_letter:
        letter = NEXT_TOOL
    if letter in words.by_letter:
        raise fail(
            f"'{letter.removesuffix(',')}' is given twice in this block", "Write each address once.", word
        )
    if letter == "O" and (words.by_letter.keys() - {"N"} or words.has_codes):
        raise fail(
            "the letter O stands behind other words",
            "A program number begins its block. In a number, write the digit 0.",
            word,
        )
    words.by_letter[letter] = word


NEXT_TOOL = "T,"
"""The address of a second T beside a tool change: the tool after the one that comes now."""


def dwell_seconds(word: Word, unit: str) -> float:
    """Return the time of a dwell word in a unit of time: s, ms, or s_or_ms (seconds only with a point)."""
    if unit == "ms" or (unit == "s_or_ms" and not word.point):
        return word.value / 1000.0
    return word.value


def whole_number(word: Word, what: str, fail: Fail, largest: int = LARGEST_NUMBER) -> int:
    """Return the number of a word that counts or names something.

    Raises:
        ProgramError: it is negative, too large or not whole.
    """
    if not word.value.is_integer() or not 0 <= word.value <= largest:
        text = f"{word.letter}{code_text(word.value)}"
        raise fail(f"{text} is not {what}", f"Write a whole number from 0 to {largest}.", word)
    return int(word.value)


def check_angle(angle_deg: float, word: Word | None, fail: Fail) -> None:
    """Refuse the angle of an R word that is absurdly large, infinite or no number."""
    if not abs(angle_deg) <= _LARGEST_ANGLE_DEG:
        raise fail(f"the angle R{code_text(angle_deg)} is too large", "Write up to a turn.", word)
