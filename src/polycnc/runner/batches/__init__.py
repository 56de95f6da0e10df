"""Run or check many programs, on all cores or a cluster; a report that people can sort, a table for programs."""

from polycnc.runner.batches._batch import BatchCounts, BatchResult, batch
from polycnc.runner.batches._child import BatchError, Limits, serve_jobs
from polycnc.runner.batches._job import ProgramReport
from polycnc.runner.batches._programs import find_programs
from polycnc.runner.batches._store import forget_done
from polycnc.runner.batches._sweep import parse_sweep
from polycnc.runner.batches._workers import ClusterWorkers
from polycnc.runner.batches._write import check_batch_file

__all__ = [
    "BatchCounts",
    "BatchError",
    "BatchResult",
    "ClusterWorkers",
    "Limits",
    "ProgramReport",
    "batch",
    "check_batch_file",
    "find_programs",
    "forget_done",
    "parse_sweep",
    "serve_jobs",
]
