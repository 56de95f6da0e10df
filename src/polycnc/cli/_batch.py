"""``polycnc batch``: whole folders of programs, on all cores or a cluster."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from polycnc.cli import _options as options
from polycnc.cli._output import bold, print_json, progress_bar, say
from polycnc.errors import UsageError
from polycnc.outputs import keep_inputs

if TYPE_CHECKING:
    from polycnc.runner.batches import BatchResult

_MOST_TOLD = 20  # errors that are printed; the report has them all


def batch_command(
    paths: options.Paths,
    machine: options.Machine = None,
    dialect: options.Dialect = None,
    check: options.CheckOnly = False,
    jobs: options.Jobs = None,
    cluster: options.Cluster = None,
    output: options.Report = None,
    sweep: options.Sweep = None,
    pattern: options.Pattern = None,
    root: options.Root = None,
    stock: options.Stock = None,
    fixture: options.Fixtures = None,
    resolution: options.Resolution = None,
    timeout: options.Timeout = 600.0,
    memory: options.Memory = 4096.0,
    done: options.Done = None,
    again: options.Again = False,
    as_json: options.AsJson = False,
) -> None:
    """Run or check many programs; one that is broken or hangs stops no other."""
    from polycnc.runner import batches

    _check_workers(cluster, jobs)
    swept = _swept(sweep or ())
    inputs = [Path(each) for each in (machine, dialect) if each is not None]
    if output is not None or done is not None:
        inputs += batches.find_programs(paths, pattern or ())
    done = _done_beside(output, done, inputs)
    if again and done is not None:
        batches.forget_done(done)
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
                stock=stock,
                fixtures=fixture or (),
                resolution_mm=resolution,
                timeout_s=timeout,
                memory_mb=memory,
                done=done,
                progress=None if bar is None else (lambda seen, total: bar(seen / total)),
            )
        )
        status = _finish(result, output, as_json=as_json)
    sys.exit(status)


def _check_workers(cluster: str | None, jobs: int | None) -> None:
    if cluster is not None and jobs is not None:
        raise UsageError(
            "--jobs and --cluster", hint="A cluster has as many workers as it has; leave --jobs out."
        )


def _done_beside(output: Path | None, done: Path | None, inputs: list[Path]) -> Path | None:
    """Return the file of what is done, which lies beside the report if none is named.

    Raises:
        UsageError: the report or that file cannot be written, or they are one file or one of the inputs.
    """
    from polycnc.runner import batches

    if output is not None:
        batches.check_batch_file(output, inputs)
        if done is not None and done.resolve() == output.resolve():
            raise UsageError(f"{done} for the report and for what is done", hint="Name two files.")
        done = done or output.with_name(output.name + ".done")
    keep_inputs(done, inputs, "what is done")
    return done


def _swept(sweeps: Iterable[str]) -> dict[str, tuple[float | str, ...]]:
    """Return what all --sweep options vary."""
    from polycnc.runner.batches import parse_sweep

    swept: dict[str, tuple[float | str, ...]] = {}
    for text in sweeps:
        name, values = parse_sweep(text)
        if name in swept:
            raise UsageError(f"--sweep {name} is given twice", hint=f"Write all values in one: {name}=A,B,C.")
        swept[name] = values
    return swept


def _finish(result: BatchResult, output: Path | None, *, as_json: bool) -> int:
    """Write the report and say what came out; return the exit status."""
    if output is not None:
        result.save(output)
    if as_json:
        _print_json(result)
    else:
        _tell(result, output)
    return 0 if result.ok else 1


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
