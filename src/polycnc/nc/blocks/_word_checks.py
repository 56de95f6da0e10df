"""What cannot stand in one block: functions that exclude each other, and words that nothing uses."""

from __future__ import annotations

from collections.abc import Mapping

from polycnc.errors import ProgramError
from polycnc.machine import ADDED_AXES
from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._channel_state import of_another_channel
from polycnc.nc.blocks._words import GWord, code_text
from polycnc.nc.modal._actions import Action, Family, Group
from polycnc.nc.text._scan_plain import Word

_CURVED = (Family.SPLINE, Family.CURVE)
_AXIS_LETTERS = "XYZABCUVW"
# What the words belong to that need a function beside them.
_BELONGS_TO = {
    "I": "an arc (G2, G3) or a drilling cycle",
    "J": "an arc (G2, G3) or a drilling cycle",
    "K": "an arc (G2, G3) or a drilling cycle",
    "R": "an arc (G2, G3) or a drilling cycle",
    "Q": "a drilling cycle",
    "P": "a dwell, a sub-program call, an arc or a drilling cycle",
    "L": "a sub-program call or a drilling cycle",
    "D": "radius compensation",
    "H": "tool length compensation (G43, G44)",
    "F": "a dwell that has its time already, or a feed",
}
_WAYS = {"U": "X", "V": "Y", "W": "Z"}
"""The axes whose ways have addresses of their own where no mode says what positions are."""
_WORDS_OF_THEIR_OWN = (Group.MOTION, Group.NON_MODAL, Group.DWELL, Group.ROTATION)
_NUMBER_ENDS = frozenset(bytes((each,)) for each in b"0123456789.")


def leave_out(block: BlockContext) -> None:
    """Say which codes are left out, and leave out the words that belong to them.

    Axis words belong to the block's own motion word, if it has one.
    """
    for code in block.words.left_out:
        block.note(f"{code} is left out, as told")
    if block.words.takes_words and block.words.g.keys().isdisjoint(_WORDS_OF_THEIR_OWN):
        block.words.take_all()


def refuse_remaps(block: BlockContext, remaps: Mapping[str, str]) -> None:
    """Refuse codes that the control defines anew: words alone (T) and codes (M6, G88.1).

    Raises:
        ProgramError: there is one.
    """
    for word in block.block.words:
        for code in (word.letter, f"{word.letter}{code_text(word.value)}"):
            if code in remaps:
                raise block.problem(
                    f"{code} is remapped on this control: {remaps[code]}",
                    f"Remaps are not carried out. Remove {code} from [programs] remaps of the machine file to have it "
                    "as the language has it.",
                    word,
                )


def refuse_contradictions(block: BlockContext) -> None:
    """Refuse functions of different groups that cannot share a block."""
    g = block.words.g
    non_modal, dwell, motion = g.get(Group.NON_MODAL), g.get(Group.DWELL), g.get(Group.MOTION)
    alone = "axis codes beside a motion" in block.dialect.refuses
    if dwell and non_modal:
        _exclude(block, f"G{dwell.code}", f"G{non_modal.code}", "both need their own block", non_modal.word)
    if motion is None:
        return
    is_straight = motion.action in (Action.RAPID, Action.LINEAR)
    if motion.action is Action.MOTION_OFF and alone:
        return
    if non_modal and (
        (alone and "axes" in non_modal.action.takes and non_modal.action is not Action.MACHINE_COORDINATES)
        or non_modal.action in (Action.SET_POSITION, Action.SET_SHIFT)
        or motion.action.family in _CURVED
        or (non_modal.action is not Action.MACHINE_COORDINATES and not is_straight)
    ):
        _exclude(block, f"G{non_modal.code}", f"G{motion.code}", "both use the axis words", motion.word)
    cancel = g.get(Group.CYCLE_CANCEL)
    if cancel and motion.action.sets is None:
        _exclude(block, f"G{cancel.code}", f"G{motion.code}", "one ends what the other begins", motion.word)


def _exclude(block: BlockContext, first: str, second: str, why: str, word: Word) -> None:
    raise block.problem(f"{first} and {second} exclude each other: {why}", "Write them in two blocks.", word)


def take_parameters(block: BlockContext) -> None:
    """Take what is left of words that are no axes: it belonged to codes that are left out."""
    for letter, word in list(block.words.unused()):
        if letter not in block.after.axis_names and word.letter not in _AXIS_LETTERS:
            block.words.take(letter)


def refuse_unused(block: BlockContext) -> None:
    """Refuse words that nothing in the block has used."""
    for name, word in block.words.unused():
        if name in block.dialect.ignored_addresses:
            block.note(f"'{name}' has no effect here and is ignored")
        elif name in block.after.axis_names:
            raise block.problem(
                f"'{name}' cannot be combined with this function",
                "Write the move in a block of its own.",
                word,
            )
        elif of_another_channel(name) in block.after.axis_names:
            raise block.problem(
                f"axis '{name}' belongs to another channel",
                "Remove the word, or execute the program in that channel.",
                word,
            )
        elif word.letter in _AXIS_LETTERS:
            raise _no_axis(block, name, word)
        elif name in _BELONGS_TO:
            raise block.problem(
                f"'{name}' has no meaning in this block", f"It belongs to {_BELONGS_TO[name]}.", word
            )
        elif word.letter == "E" and block.text.content[max(0, word.place - 1) : word.place] in _NUMBER_ENDS:
            raise block.problem(
                "numbers are written without an exponent", "Write it out, like 0.00001 for 1e-05.", word
            )
        else:
            value = code_text(word.value)
            raise block.problem(
                f"the address '{name}' is not known in dialect '{block.dialect.name}'",
                f"Take {name}{'=' if word.index is not None else ''}{value} out, or list '{name}' in the "
                "dialect's ignored_addresses.",
                word,
            )


def refuse_rest(block: BlockContext, g: GWord) -> None:
    """Refuse what is left in the block before anything is written that cannot be taken back."""
    for name, word in block.words.unused():
        if name in block.dialect.ignored_addresses:
            continue
        if word.letter in _AXIS_LETTERS and name not in block.after.axis_names:
            raise _no_axis(block, name, word)
        raise block.problem(f"'{name}' cannot be combined with G{g.code}", "Remove it.", word)


def _no_axis(block: BlockContext, name: str, word: Word) -> ProgramError:
    names = ", ".join(block.after.axis_names)
    like = f", like mill3+{name}" if name in ADDED_AXES and not block.dialect.diameter_axes else ""
    hint = f"Its axes are {names}; remove the word, or choose another machine{like}."
    axes = block.dialect.incremental or block.dialect.language == "rs274"  # its lathes have U and W as axes
    if _WAYS.get(name) in block.after.axis_names and not axes:
        hint = (
            f"The dialect has ways by G91: write G91 and {_WAYS[name]}, then G90."
            if block.dialect.diameter_axes
            else f"Its axes are {names}; choose another machine, or for a lathe, where {name} goes along "
            f"{_WAYS[name]}, --dialect fanuc-lathe."
        )
    return block.problem(f"there is no axis '{name}' on machine '{block.after.machine.name}'", hint, word)
