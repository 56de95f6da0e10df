"""``polycnc batch``: whole folders of programs, on all cores or a cluster."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from polycnc.cli._output import bold, print_json, progress_bar, say
from polycnc.cli._run import DIALECT, MACHINE, ROOT
from polycnc.errors import UsageError

if TYPE_CHECKING:
    from polycnc.runner.batches import BatchResult

_MOST_TOLD = 20  # errors that are printed; the report has them all


def batch_command(
    paths: Annotated[list[Path], typer.Argument(help="Programs, and folders of them.", metavar="PATH")],
    machine: Annotated[str | None, MACHINE] = None,
    dialect: Annotated[str | None, DIALECT] = None,
    check: Annotated[bool, typer.Option("--check", help="Report errors only; run nothing.")] = False,
    jobs: Annotated[
        int | None,
        typer.Option("--jobs", "-j", help="Processes (default: one for each core).", metavar="N", min=1),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            help="Run on the Dask cluster of this scheduler, like tcp://host:8786.", metavar="ADDRESS"
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The report: .html, .parquet or .csv.", metavar="FILE"),
    ] = None,
    sweep: Annotated[
        list[str] | None,
        typer.Option(
            help="Vary override=80:120:5 (percent), tolerance=0,0.05 (mm) or machine=A,B; may be repeated.",
            metavar="NAME=VALUES",
        ),
    ] = None,
    pattern: Annotated[
        list[str] | None,
        typer.Option(help="Programs of a folder, like '*.txt' (default: the usual endings).", metavar="GLOB"),
    ] = None,
    root: Annotated[Path | None, ROOT] = None,
    timeout: Annotated[
        float, typer.Option(help="Seconds that one program may take; 0: any.", metavar="S", min=0.0)
    ] = 600.0,
    memory: Annotated[
        float, typer.Option(help="Memory that one program may take, MB; 0: any.", metavar="MB", min=0.0)
    ] = 4096.0,
    done: Annotated[
        Path | None,
        typer.Option(
            help="Keep here what is done, and do it not again (default: the report's name and .done).",
            metavar="FILE",
        ),
    ] = None,
    again: Annotated[bool, typer.Option("--again", help="Do everything again.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of text.")] = False,
) -> None:
    """Run or check many programs; one that is broken or hangs stops no other."""
    from polycnc.runner import batches

    if cluster is not None and jobs is not None:
        raise UsageError(
            "--jobs and --cluster", hint="A cluster has as many workers as it has; leave --jobs out."
        )
    swept: dict[str, tuple[float | str, ...]] = {}
    for text in sweep or ():
        name, values = batches.parse_sweep(text)
        if name in swept:
            raise UsageError(f"--sweep {name} stands twice", hint=f"Write all values in one: {name}=A,B,C.")
        swept[name] = values
    given = [Path(each) for each in (machine, dialect) if each is not None]
    if output is not None:
        batches.check_batch_file(output, [*batches.find_programs(paths, pattern or ()), *given])
        done = done or output.with_name(output.name + ".done")
    if again and done is not None:
        _forget(done)
    with ExitStack() as stack:
        client = None
        if cluster is not None:
            workers = batches.ClusterWorkers.at(cluster)
            stack.callback(workers.close)
            client = workers.client
        bar = stack.enter_context(progress_bar("programs"))
        result = stack.enter_context(
            batches.batch(
                paths,
                machine,
                dialect,
                check_only=check,
                detail=output is not None and output.suffix.lower() in (".html", ".htm") and not check,
                sweep=swept,
                jobs=jobs,
                client=client,
                patterns=pattern or (),
                root=root,
                timeout_s=timeout,
                memory_mb=memory,
                done=done,
                progress=None if bar is None else (lambda seen, total: bar(seen / total)),
            )
        )
        if output is not None:
            result.save(output)
        if as_json:
            _print_json(result)
        else:
            _tell(result, output)
        status = 0 if result.ok else 1
    sys.exit(status)


def _forget(done: Path) -> None:
    """Remove what was kept, if it is that."""
    from polycnc.runner.batches import forget_done

    forget_done(done)


def _print_json(result: BatchResult) -> None:
    counts = result.counts
    print_json(
        {
            "programs": counts.total,
            "ok": counts.ok,
            "done_before": counts.earlier,
            "reports": [{k: v for k, v in report.as_dict().items() if k != "thumbnail"} for report in result],
        }
    )


def _tell(result: BatchResult, output: Path | None) -> None:
    from polycnc.runner import counted, time_text

    told = 0
    time_s = 0.0
    for report in result:
        time_s += report.time_s or 0.0
        if not report.ok and told < _MOST_TOLD:
            told += 1
            more = len(report.errors) - 1
            say(report.errors[0] if report.errors else f"{report.program}: {report.status}")
            if more > 0:
                say(f"... and {counted(more, 'more error')} in {report.program}")
    counts = result.counts
    failed = counts.total - counts.ok
    if failed > told:
        say(f"... and {counted(failed - told, 'more run')} with errors")
    say(lead=bold(f"{counted(counts.total, 'run')}, {failed:,} with errors"))
    if counts.earlier:
        say(f"done before and unchanged: {counts.earlier:,}")
    if time_s:
        say(f"machine time  {time_text(time_s)}")
    if output is not None:
        say(f"wrote         {output}")
