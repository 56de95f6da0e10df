"""The words of one block, sorted by what they ask for, and refused when they contradict each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from polycnc.errors import ProgramError
from polycnc.nc._actions import GROUP_OF, Action, MAction
from polycnc.nc._dialect import Dialect
from polycnc.nc._scan_plain import Block, Word

Fail = Callable[[str, str, Word | None], ProgramError]


@dataclass(frozen=True, slots=True)
class GWord:
    """A G word and what it does in this dialect."""

    word: Word
    code: str
    action: Action


@dataclass(frozen=True, slots=True)
class MWord:
    """An M word and what it does in this dialect."""

    word: Word
    code: int
    action: MAction


@dataclass
class BlockWords:
    """Hold a block's G words by modal group, its M words in order, and all other words by address."""

    g: dict[str, GWord] = field(default_factory=dict)
    m: list[MWord] = field(default_factory=list)
    by_letter: dict[str, Word] = field(default_factory=dict)
    used: set[str] = field(default_factory=set)

    def take(self, letter: str) -> Word | None:
        """Return the word of `letter`, if there is one, and count it as used."""
        word = self.by_letter.get(letter)
        if word is not None:
            self.used.add(letter)
        return word

    def value(self, letter: str) -> float | None:
        """Return the number of the word of `letter`, if there is one, and count it as used."""
        word = self.take(letter)
        return None if word is None else word.value

    def unused(self) -> Iterator[Word]:
        """Yield the words that nothing has taken."""
        for letter, word in self.by_letter.items():
            if letter not in self.used:
                yield word


def code_text(value: float) -> str:
    """Return the number of a G or M word as it is usually written: 1, 54, 5.1."""
    return f"{value:.10g}"


def sort_words(block: Block, dialect: Dialect, fail: Fail) -> BlockWords:
    """Sort the words of `block`.

    Raises:
        ProgramError: an unknown G or M code, two words of one group, an address that stands twice.
    """
    sorted_words = BlockWords()
    groups_of_m: dict[str, MWord] = {}
    for word in block.words:
        if word.letter == "G" and word.index is None:
            _add_g(word, sorted_words, dialect, fail)
        elif word.letter == "M" and word.index is None:
            _add_m(word, sorted_words, groups_of_m, dialect, fail)
        else:
            _add_value(word, sorted_words, fail)
    return sorted_words


def _add_g(word: Word, words: BlockWords, dialect: Dialect, fail: Fail) -> None:
    action = dialect.g_action(word.value)
    code = code_text(word.value)
    if action is None:
        raise fail(
            f"G{code} is not known in dialect '{dialect.name}'",
            "Take it out, or choose the control's dialect.",
            word,
        )
    group = GROUP_OF[action]
    if group in words.g:
        other = words.g[group]
        raise fail(
            f"G{other.code} and G{code} are of one group and exclude each other", "Write one of them.", word
        )
    words.g[group] = GWord(word, code, action)


def _add_m(word: Word, words: BlockWords, groups: dict[str, MWord], dialect: Dialect, fail: Fail) -> None:
    if word.value != int(word.value) or word.value < 0:
        raise fail(f"M{code_text(word.value)} is not a whole number", "Write M0 to M99999.", word)
    code = int(word.value)
    action = dialect.m_action(code)
    if action is None:
        raise fail(
            f"M{code} is not known in dialect '{dialect.name}'",
            "Take it out, or choose the control's dialect.",
            word,
        )
    entry = MWord(word, code, action)
    group = action.group
    if group:
        if group in groups:
            raise fail(
                f"M{groups[group].code} and M{code} are of one group and exclude each other",
                "Write one of them.",
                word,
            )
        groups[group] = entry
    words.m.append(entry)


def _add_value(word: Word, words: BlockWords, fail: Fail) -> None:
    letter = word.letter if word.index is None else f"{word.letter}{word.index}"
    if letter in words.by_letter:
        raise fail(f"'{letter}' stands twice in this block", "Write each address once.", word)
    words.by_letter[letter] = word


def dwell_seconds(word: Word, unit: str) -> float:
    """Return the time of a dwell word in a unit of time: s, ms, or s_or_ms (seconds only with a decimal point)."""
    if unit == "ms" or (unit == "s_or_ms" and not word.point):
        return word.value / 1000.0
    return word.value
