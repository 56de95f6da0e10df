"""``polycnc post``: a tool path in, a program for a control out, proven on the virtual machine if wanted."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from polycnc.cli import _options as options
from polycnc.cli._output import bold, bold_red, echo, print_json, progress_bar, say, say_error
from polycnc.errors import UsageError

if TYPE_CHECKING:
    from polycnc.post import ArcAxis
    from polycnc.runner import PostResult, PostVerification


def post_command(
    tool_path: options.ToolPath = None,
    control: options.Control = None,
    output: options.PostOutput = None,
    verify: options.Verify = False,
    tolerance: options.PostTolerance = None,
    machine: options.PostMachine = None,
    arc_axis: options.ArcSense = None,
    as_json: options.PostAsJson = False,
    show_control: options.ShowControl = False,
) -> None:
    """Turn a tool path into a program for a control, and show with --verify that it cuts what was meant."""
    from polycnc import post, runner

    if control is None:
        raise UsageError(
            "no control file", hint=f"Name one with --control: {', '.join(post.CONTROLS)}, or a file."
        )
    if show_control:
        echo(post.shipped_text(control), nl=False)
        return
    if tool_path is None:
        raise UsageError("no tool path", hint="Name the file of a tool path.")
    if arc_axis not in (None, "auto", "clockwise", "counterclockwise"):
        raise UsageError(
            f"'{arc_axis}' is no sense of rotation", hint="Write --arc-axis clockwise or counterclockwise."
        )
    if as_json and output is None:
        raise UsageError("--json needs --output", hint="Name a file for the program, with -o.")
    with progress_bar(tool_path.name) as bar:
        result = runner.post_file(
            tool_path,
            control,
            output,
            verify=verify,
            machine=machine,
            tolerance_mm=tolerance,
            arc_axis=cast("ArcAxis | None", arc_axis),
            progress=bar,
        )
    if as_json:
        print_json(result.as_dict())
    else:
        _report(result)
    sys.exit(0 if result.ok else 1)


def _report(result: PostResult) -> None:
    """Print the program, if it has no file, to standard output, and then the summary to standard error."""
    from polycnc.runner import counted

    summary = result.summary
    tell: Callable[..., None] = say
    if result.text is not None:
        echo(result.text, nl=False)
        tell = say_error
    tell(f"tool path  {result.tool_path}")
    tell(f"           {counted(summary.records, 'record')}, {counted(summary.tools, 'tool')}, "
         f"{counted(summary.arcs, 'arc')}, {counted(summary.holes, 'hole')}")  # fmt: skip
    tell(f"program    {counted(summary.blocks, 'block')}, control {result.control}")
    tell(f"path       feed {summary.feed_mm:,.3f} mm, rapid {summary.rapid_mm:,.3f} mm")
    for remark in summary.remarks:
        times = f" ({remark.count} times)" if remark.count > 1 else ""
        place = f"line {remark.line}: " if remark.line else ""
        tell(f"remark     {place}{remark.text}{times}")
    if result.verification is not None:
        _report_proof(result.verification, tell)
    if result.output is not None:
        tell(f"wrote      {result.output}")


def _report_proof(proof: PostVerification, tell: Callable[..., None]) -> None:
    from polycnc.runner import time_text

    run = proof.run
    tell(f"run        {time_text(run.time_s)} on {run.machine}, feed {run.cutting_path_mm:,.3f} mm, "
         f"rapid {run.rapid_path_mm:,.3f} mm")  # fmt: skip
    for alarm in run.alarms:
        tell(str(alarm), lead=bold_red("alarm: "))
    if run.alarms:
        return
    for what, found in (("off path", proof.off_path), ("missed", proof.missed)):
        at = (
            f" at line {found.block} of the program, line {found.line} of the tool path"
            if found.block
            else ""
        )
        tell(f"{what:<10} {found.mm:.6f} mm{at}")
    tell(f"compared   {proof.compared}")
    if proof.tool_axis_deg > 0.0:
        tell(f"tool axis  {proof.tool_axis_deg:.4f} degree at line {proof.tool_axis_line} of the tool path")
    if proof.rapid_cuts:
        tell(f"rapids     where the tool path has feed: {proof.rapid_cuts} records")
    if proof.arc_remark:
        tell(proof.arc_remark, lead=bold_red("arcs       "))
    if proof.deviation_mm <= proof.tolerance_mm and proof.arc_remark and not proof.rapid_cuts:
        tell(
            f": the arcs of {proof.run.program} and its tool path seem to turn the wrong way",
            lead=bold_red("not proven"),
        )
        return
    verdict = bold("verified") if proof.ok else bold_red("deviates")
    if proof.ok:
        tell(f" within {proof.tolerance_mm:g} mm", lead=verdict)
    elif proof.deviation_mm > proof.tolerance_mm or proof.rapid_cuts:
        tell(f": more than {proof.tolerance_mm:g} mm", lead=verdict)
    else:
        tell(f": the tool axis, by {proof.tool_axis_deg:.4f} degree", lead=verdict)
