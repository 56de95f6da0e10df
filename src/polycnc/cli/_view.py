"""``polycnc view``: a run as a page that moves."""

from __future__ import annotations

import sys
from pathlib import Path

from polycnc.cli import _options as options
from polycnc.cli._output import bold_red, progress_bar, say, say_error
from polycnc.cli._summary import Units


def view_command(
    program: options.Program,
    output: options.Page = None,
    open_page: options.OpenPage = False,
    machine: options.Machine = None,
    dialect: options.Dialect = None,
    units: options.PageUnits = None,
    stock: options.Stock = None,
    resolution: options.Resolution = None,
    tools: options.Tools = None,
) -> None:
    """Run a part program and write a page that shows it: path, time, blocks, tools, speed."""
    from polycnc.runner import check_view_file, open_in_browser, program_text, time_text, view_program
    from polycnc.stock import file_of

    inputs = [program, *(Path(each) for each in (machine, dialect, options.file_of_tools(tools)) if each)]
    if stock is not None and (body := file_of(stock)) is not None:
        inputs.append(body)
    text = program_text(program)
    target = check_view_file(
        output or Path(program.stem + ".html"), inputs, replaces_views_only=output is None
    )
    inch = None if units is None else units is Units.INCH
    with progress_bar(program.name) as bar:
        view = view_program(
            text,
            machine,
            dialect,
            inch=inch,
            stock=stock,
            resolution_mm=resolution,
            tools=tools,
            progress=bar,
        )
    view.save(target)
    say(f"time       {time_text(view.result.time_s)}")
    say(f"wrote      {target}")
    if view.result.machined is not None:
        for message in view.result.machined.messages[1:]:
            say(f"message    {message}")
    for alarm in view.result.alarms:
        say(str(alarm), lead=bold_red("alarm: "))
    if open_page and not open_in_browser(target):
        say_error(f"no browser was found; open {target} yourself.")
    for collision in view.result.collisions:
        say(f"line {collision.line}: {collision}", lead=bold_red("collision: "))
    sys.exit(0 if view.result.ok and not view.result.collisions else 1)
