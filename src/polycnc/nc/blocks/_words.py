"""The words of one block, sorted by what they ask for, and refused when they contradict each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from polycnc.errors import ProgramError
from polycnc.nc.dialect._dialect import Dialect
from polycnc.nc.modal._actions import Action, Group, MAction
from polycnc.nc.text._scan_plain import Block, Word

Fail = Callable[[str, str, Word | None], ProgramError]

LARGEST_M = 99999
MOST_WORDS = 1000
"""Words of a block: far more than any control reads. A file of one line would take hours otherwise."""
_OF_MOVES = range(40, 50)  # offsets, behind which axis words are still a move
_NOT_YET = "What it does would be left out: take it out, or post the program without it."
_OTHER_DIALECT = "Take it out, or name the dialect of the control that the program is for."
_COOLANT_ON = (MAction.COOLANT_MIST, MAction.COOLANT_FLOOD)


@dataclass(frozen=True, slots=True)
class GWord:
    """A G word and what it does in this dialect."""

    word: Word
    code: str
    action: Action

    @property
    def value(self) -> int:
        """The value of its group in the modal state."""
        assert self.action.sets is not None
        return self.action.sets


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
    leave out, `takes_words` says that the words beside them go with them.
    """

    g: dict[Group, GWord] = field(default_factory=dict)
    ignored: list[GWord] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    m: list[MWord] = field(default_factory=list)
    by_letter: dict[str, Word] = field(default_factory=dict)
    increment: float = 0.0
    takes_words: bool = False
    _used: set[str] = field(default_factory=set)

    def take(self, letter: str) -> Word | None:
        """Return the word of `letter`, if there is one that nothing has taken, and take it."""
        word = self.by_letter.get(letter)
        if word is None or letter in self._used:
            return None
        self._used.add(letter)
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
        return word.value * self.increment if self.increment and not word.point else word.value

    def take_all(self) -> None:
        """Take every word that nothing has taken."""
        self._used.update(self.by_letter)

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

    def unused(self) -> Iterator[tuple[str, Word]]:
        """Yield address and word of all that nothing has taken."""
        for letter, word in self.by_letter.items():
            if letter not in self._used:
                yield letter, word


def code_text(value: float) -> str:
    """Return a number as it is usually written in a program: 1, 54, 5.1, 12000."""
    return f"{value:.0f}" if value.is_integer() and abs(value) < 1e16 else f"{value:.10g}"


def sort_words(block: Block, dialect: Dialect, fail: Fail, count: Callable[[str], int]) -> BlockWords:
    """Sort the words of `block`; `count` tells in how many blocks of the program a G code stands.

    Raises:
        ProgramError: an unknown G or M code, two words of one group, an address that stands twice.
    """
    words = BlockWords()
    if len(block.words) > MOST_WORDS:
        raise fail(
            f"a block with {len(block.words)} words",
            f"No block has more than {MOST_WORDS}: check the line ends.",
            block.words[MOST_WORDS],
        )
    for word in block.words:
        if word.letter == "G" and word.index is None:
            _add_g(word, words, dialect, fail, count)
        elif word.letter == "M" and word.index is None:
            _add_m(word, words, dialect, fail)
        else:
            _add_value(word, words, fail)
    return words


def _add_g(word: Word, words: BlockWords, dialect: Dialect, fail: Fail, count: Callable[[str], int]) -> None:
    action = dialect.g_action(word.value)
    code = code_text(word.value)
    if action is None:
        raise fail(f"G{code} is not known in dialect '{dialect.name}'", _OTHER_DIALECT, word)
    group = action.group
    entry = GWord(word, code, action)
    if group is Group.IGNORED:
        if action is Action.UNSUPPORTED:
            blocks = count(code)
            where = "1 block has it" if blocks == 1 else f"{blocks} blocks have it"
            raise fail(f"G{code} is not supported yet ({where})", _NOT_YET, word)
        if action is Action.LEFT_OUT:
            words.left_out.append(f"G{code}")
            words.takes_words = words.takes_words or int(word.value) not in _OF_MOVES
            return
        words.ignored.append(entry)
        return
    if group in words.g:
        raise _exclude(f"G{words.g[group].code}", f"G{code}", group, word, fail)
    words.g[group] = entry


def _add_m(word: Word, words: BlockWords, dialect: Dialect, fail: Fail) -> None:
    if not word.value.is_integer() or not 0 <= word.value <= LARGEST_M:
        raise fail(f"there is no M{code_text(word.value)}", f"M codes are M0 to M{LARGEST_M}.", word)
    code = int(word.value)
    action = dialect.m_action(code)
    if action is None:
        raise fail(f"M{code} is not known in dialect '{dialect.name}'", _OTHER_DIALECT, word)
    if action is MAction.UNSUPPORTED:
        raise fail(f"M{code} is not supported yet", _NOT_YET, word)
    if action is MAction.LEFT_OUT:
        words.left_out.append(f"M{code}")
        return
    for other in words.m:
        if other.code == code or (action.group and other.action.group == action.group):
            raise _exclude(f"M{other.code}", f"M{code}", action.group, word, fail)
        if MAction.COOLANT_OFF in (action, other.action) and (
            action in _COOLANT_ON or other.action in _COOLANT_ON
        ):
            raise _exclude(f"M{other.code}", f"M{code}", "coolant", word, fail)
    words.m.append(MWord(word, code, action))


def _exclude(first: str, second: str, group: str, word: Word, fail: Fail) -> ProgramError:
    if first == second:
        return fail(f"{first} stands twice in this block", "Write it once.", word)
    name = group.replace("_", " ")
    return fail(f"{first} and {second} exclude each other (group '{name}')", "Write one of them.", word)


def _add_value(word: Word, words: BlockWords, fail: Fail) -> None:
    letter = word.letter if word.index is None else f"{word.letter}{word.index}"
    if letter in words.by_letter:
        raise fail(f"'{letter}' stands twice in this block", "Write each address once.", word)
    words.by_letter[letter] = word


def dwell_seconds(word: Word, unit: str) -> float:
    """Return the time of a dwell word in a unit of time: s, ms, or s_or_ms (seconds only with a point)."""
    if unit == "ms" or (unit == "s_or_ms" and not word.point):
        return word.value / 1000.0
    return word.value
