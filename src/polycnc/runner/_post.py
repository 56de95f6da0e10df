"""Post a tool path: from its file and a control file to a program, and to a proof of it if wanted."""

from __future__ import annotations

import io
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from polycnc.errors import ProgramError, UsageError
from polycnc.machine import MachineConfig
from polycnc.nc import ProgramText
from polycnc.outputs import check_output, is_special, keep_inputs
from polycnc.post import (
    NO_DIALECT,
    ArcAxis,
    BlockMap,
    ControlFile,
    PostSummary,
    ToolPath,
    load_control,
    open_tool_path,
    post_program,
    program_file,
)
from polycnc.runner._execution import Progress
from polycnc.runner._verify_post import PostVerification, verify_post


@dataclass(frozen=True, slots=True)
class PostResult:
    """What posting gave: the program's text or file, what it was made from, and its verification if wanted."""

    tool_path: str
    control: str
    summary: PostSummary
    output: Path | None
    text: str | None
    verification: PostVerification | None = None

    @property
    def ok(self) -> bool:
        """Whether the program is proven, or was not to be."""
        return self.verification is None or self.verification.ok

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for JSON, without the program's text."""
        summary = self.summary
        return {
            "tool_path": self.tool_path,
            "control": self.control,
            "output": None if self.output is None else str(self.output),
            "blocks": summary.blocks,
            "records": summary.records,
            "feed_mm": summary.feed_mm,
            "rapid_mm": summary.rapid_mm,
            "arcs": summary.arcs,
            "holes": summary.holes,
            "tools": summary.tools,
            "remarks": [{"text": r.text, "line": r.line, "count": r.count} for r in summary.remarks],
            "verification": None if self.verification is None else self.verification.as_dict(),
        }


def post_file(
    tool_path: str | Path | ToolPath,
    control: str | Path | ControlFile,
    output: str | Path | None = None,
    *,
    verify: bool = False,
    machine: str | MachineConfig | None = None,
    tolerance_mm: float | None = None,
    arc_axis: ArcAxis | None = None,
    progress: Progress | None = None,
) -> PostResult:
    """Turn a tool path into a program for a control, and with `verify` run it and compare both.

    `control` is the name of a control file that comes with polycnc, or a path. The program goes to `output`,
    which gets its name when it is complete, or into the result. `machine` stands for the one that the control
    file names, `arc_axis` for what it says about the axes of CIRCLE/ in a file of APT words.

    Raises:
        UsageError: no such file, control file or machine, `arc_axis` for JSON, the program cannot be written, or
            nothing reads its language to verify it.
        ConfigurationError: the control file is wrong.
        ProgramError: the tool path cannot be posted.
    """
    files = [each for each in (tool_path, control, machine) if isinstance(each, str | Path)]
    if output is not None:
        check_output(output, (), "a program")
        keep_inputs(output, files, "a program")
    chosen = control if isinstance(control, ControlFile) else load_control(control)
    if verify and chosen.parameters.dialect == NO_DIALECT:
        name = chosen.parameters.description or chosen.parameters.name or chosen.file
        raise UsageError(
            f"a program for {name} cannot be proven: nothing here reads its language",
            hint="Post it without verification, or prove the tool path with another control file.",
        )
    path = _path_of(tool_path, chosen, arc_axis)
    block_map = BlockMap() if verify else None
    summary, text = _write(path, chosen, output, block_map, progress)
    proof = None
    if block_map is not None:
        parameters = chosen.parameters
        written = (
            ProgramText.from_path(output)
            if output is not None and text is None
            else ProgramText.from_text(text or "", f"{path.name} posted")
        )
        proof = verify_post(
            written,
            path,
            block_map,
            machine or parameters.machine,
            parameters.dialect,
            tolerance_mm,
            progress,
            parameters,
        )
    return PostResult(
        tool_path=path.name,
        control=chosen.parameters.name or chosen.file,
        summary=summary,
        output=None if output is None else Path(output),
        text=text if output is None else None,
        verification=proof,
    )


def _path_of(tool_path: str | Path | ToolPath, control: ControlFile, arc_axis: ArcAxis | None) -> ToolPath:
    """Return the tool path, as the control file wants its plane and the axes of its arcs."""
    is_apt = not isinstance(tool_path, ToolPath) and Path(tool_path).suffix.lower() != ".json"
    if arc_axis is not None and not is_apt:
        raise UsageError(
            "a sense of rotation for the axes of arcs is for a file in APT words",
            hint="Arcs in JSON are by the right-hand rule: turn 'normal' round there.",
        )
    arcs = arc_axis or control.parameters.arc_axis
    path = tool_path if isinstance(tool_path, ToolPath) else open_tool_path(tool_path, arcs)
    return path.turned_from_xy() if control.parameters.turning_plane == "xy" else path


def _write(
    path: ToolPath,
    control: ControlFile,
    output: str | Path | None,
    block_map: BlockMap | None,
    progress: Progress | None,
) -> tuple[PostSummary, str | None]:
    """Write the program; return its text where it cannot be read again: without a file, and for proof of a pipe."""
    text = io.StringIO()
    with ExitStack() as stack:
        file = text if output is None else stack.enter_context(program_file(output, control.parameters))
        keeps = block_map is not None and output is not None and is_special(Path(output))

        def write(piece: str) -> None:
            file.write(piece)
            if keeps:
                text.write(piece)

        try:
            summary = post_program(
                path, control, write if keeps else file.write, progress=progress, block_map=block_map
            )
        except UnicodeEncodeError as error:
            raise ProgramError(
                f"the character '{error.object[error.start]}' cannot be written in {error.encoding}",
                hint="Use other characters in the tool path, or another 'encoding' in the control file.",
            ) from None
    return summary, text.getvalue() if output is None or keeps else None
