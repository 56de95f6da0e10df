"""Run or check many programs, on all cores or a cluster; a report that people can sort, a table for programs."""

from polycnc.runner.batches._batch import BatchCounts, BatchResult, batch, cores
from polycnc.runner.batches._child import BatchError, Limits, serve_jobs
from polycnc.runner.batches._job import ProgramReport
from polycnc.runner.batches._programs import find_programs, program_extensions
from polycnc.runner.batches._store import forget_done
from polycnc.runner.batches._sweep import SWEEPS, parse_sweep
from polycnc.runner.batches._thumbnail import picture, thumbnail
from polycnc.runner.batches._workers import ClusterWorkers
from polycnc.runner.batches._write import BATCH_FORMATS, check_batch_file

__all__ = [
    "BATCH_FORMATS",
    "SWEEPS",
    "BatchCounts",
    "BatchError",
    "BatchResult",
    "ClusterWorkers",
    "Limits",
    "ProgramReport",
    "batch",
    "check_batch_file",
    "cores",
    "find_programs",
    "forget_done",
    "parse_sweep",
    "picture",
    "program_extensions",
    "serve_jobs",
    "thumbnail",
]
