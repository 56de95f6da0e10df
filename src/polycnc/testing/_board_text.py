"""What a report says of an APCI board: what its tasks execute and where its axes are."""

from __future__ import annotations

from collections.abc import Iterator

from polycnc.controllers.apci import Board, BoardTasks
from polycnc.testing._text import number_text, table, time_text


def board_text(board: Board) -> str:
    """Return the lines about an APCI board; its positions are rp and dp."""
    status = board.status()
    lines = [time_text(status.time_s, status.cycle), *_tasks(board)]
    rows = [
        (
            board.config.axis_names[i],
            number_text(each.rp),
            number_text(each.dp),
            each.axst.name or "none",
            str(each.queued),
        )
        for i, each in enumerate(status.axes)
    ]
    return "\n".join([*lines, *table(("axis", "rp", "dp", "axst", "queued"), rows)])


def _tasks(board: Board) -> Iterator[str]:
    """Yield what the tasks of a board that have a program do."""
    if not isinstance(board.tasks, BoardTasks):
        return
    for task in board.tasks.each:
        if task.program is not None:
            doing = f"ended: {task.error}" if task.error else task.state.value
            yield f"task {task.number}: {task.program.name}:{task.status().csrcline}: {doing}"
