"""What carries a code out: a function of the block and the code, which says which actions are its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from types import ModuleType
from typing import TypeAlias

from polycnc.nc.blocks._block import BlockContext
from polycnc.nc.blocks._moves import QueueItem
from polycnc.nc.blocks._words import GWord
from polycnc.nc.modal._actions import Action, Group

Handler: TypeAlias = Callable[[BlockContext, GWord], Iterable[QueueItem] | None]
"""Changes the state after the block, and returns what goes into the queue."""

_MARK = "_carries_out"


def carries_out(*kinds: Action | Group) -> Callable[[Handler], Handler]:
    """Mark a function as the one that carries these actions out, or all of these groups."""

    def marked(handler: Handler) -> Handler:
        setattr(handler, _MARK, [each for each in Action if each in kinds or each.group in kinds])
        return handler

    return marked


def handlers(*modules: ModuleType) -> Iterator[tuple[Action, Handler]]:
    """Yield the actions that functions of these modules carry out, with the function."""
    for module in modules:
        for value in vars(module).values():
            for action in getattr(value, _MARK, ()):
                yield action, value


def refuse_compensation(block: BlockContext, g: GWord, *, side: bool = True, stage: bool = True) -> None:
    """Refuse a code with radius compensation: while a `side` is in force, and while the `stage` is active.

    Raises:
        ProgramError: it is.
    """
    if (side and block.after.side) or (stage and block.after.compensation.active):
        raise block.problem(
            f"G{g.code} while radius compensation is active", "Cancel it with G40 first.", g.word
        )
