"""A copy of the repository in which modules are changed and tests are run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from support.mutation._mutants import Mutant
from support.mutation._reach import Reach

COPIED = (
    "src",
    "tests",
    "conformance",
    "docs",
    "examples",
    "benchmarks",
    "scripts",
    "pyproject.toml",
    "mkdocs.yml",
)
PYTEST = ["-q", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:benchmark"]
REACH_LIMIT_S = 3600.0


@dataclass(frozen=True)
class Outcome:
    """What the tests said to a mutant: killed, timeout and crash notice it; survived and unreached do not."""

    verdict: str
    tests: int

    @property
    def noticed(self) -> bool:
        """Return whether a test would have stopped the change."""
        return self.verdict in ("killed", "timeout", "crash")


class Session:
    """Holds the copy and two processes that run tests there; with `jit` mutants run compiled."""

    def __init__(self, root: Path, *, jit: bool = False) -> None:
        self._root = root
        self._folder = tempfile.TemporaryDirectory(prefix="polycnc-mutate-")
        self.copy = Path(self._folder.name).resolve() / root.name
        self._output = self.copy.parent / "output"
        for name in (*COPIED, *(path.name for path in root.glob("*.md"))):
            source = root / name
            if source.is_dir():
                shutil.copytree(
                    source, self.copy / name, ignore=shutil.ignore_patterns("__pycache__", "_compiled")
                )
            elif source.is_file():
                shutil.copy2(source, self.copy / name)
        self._interpreted = self._worker(jit=False)
        self._mutated = self._worker(jit=True) if jit else self._interpreted

    def __enter__(self) -> Session:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        for worker in {self._interpreted, self._mutated}:
            worker.kill()
            worker.communicate()
        self._folder.cleanup()

    def reach(self, modules: Sequence[Path], tests: Sequence[Path]) -> Reach:
        """Run the test files once, interpreted, and return which tests run which lines.

        Tests that fail by that, such as those of compiled code alone, cannot tell anything and are left out.

        Raises:
            RuntimeError: The tests cannot be run.
        """
        watched = {str(self.copy / module.relative_to(self._root)): module for module in modules}
        answer = self._asked(
            self._interpreted,
            arguments=[*PYTEST, *(str(self.copy / test.relative_to(self._root)) for test in tests)],
            only=None,
            trace=list(watched),
            limit_s=REACH_LIMIT_S,
        )
        if answer["status"] not in (0, 1):
            said = self._output.read_text(encoding="utf-8", errors="replace").splitlines()
            raise RuntimeError("\n".join(["the tests cannot be run", *said[-20:]]))
        failed = set(answer["failed"])
        lines = {
            str(watched[file]): {
                int(line): [each for each in tests if each not in failed] for line, tests in seen.items()
            }
            for file, seen in answer["lines"].items()
        }
        times_s = {test: time_s for test, time_s in answer["times_s"].items() if test not in failed}
        return Reach(times_s, lines, sorted(failed))

    def source(self, module: Path) -> bytes:
        """Return a module's text as it was when the copy was made."""
        return (self.copy / module.relative_to(self._root)).read_bytes()

    def outcome(self, module: Path, mutant: Mutant, reach: Reach) -> Outcome:
        """Return what the tests that reach a mutant say to it."""
        place = self.copy / module.relative_to(self._root)
        tests = reach.of(str(module), mutant.lines)
        if not tests:
            return Outcome("unreached", 0)
        source = place.read_bytes()
        self._write(place, mutant.applied(source))
        try:
            answer = self._asked(
                self._mutated,
                arguments=[
                    *PYTEST,
                    "-x",
                    *sorted({str(self.copy / test.partition("::")[0]) for test in tests}),
                ],
                only=tests,
                trace=[],
                limit_s=15.0 + 4 * sum(reach.times_s.get(test, 0.0) for test in tests),
            )
        finally:
            self._write(place, source)
        verdicts = {0: "survived", 5: "unreached", "timeout": "timeout", "crash": "crash"}
        return Outcome(verdicts.get(answer["status"], "killed"), len(tests))

    def _write(self, place: Path, source: bytes) -> None:
        place.write_bytes(source)
        for stale in (place.parent / "__pycache__").glob(f"{place.stem}.*.pyc"):
            stale.unlink()  # it is told from its source by size and second, and mutants share both

    def _worker(self, *, jit: bool) -> subprocess.Popen[str]:
        environment = {
            **os.environ,
            "PYTHONPATH": str(self.copy / "src"),
            "NUMBA_DISABLE_JIT": "0" if jit else "1",
            "POLYCNC_CACHE_DIR": str(self.copy.parent / "cache"),
        }
        beside = self._root.parent / "shared" / "data"
        if beside.is_dir():
            environment.setdefault("POLYCNC_DATA", str(beside))
        script = Path(__file__).with_name("worker.py")
        return subprocess.Popen(
            [sys.executable, str(script)],
            cwd=self.copy,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def _asked(self, worker: subprocess.Popen[str], **request: object) -> dict[str, Any]:
        assert worker.stdin is not None
        assert worker.stdout is not None
        worker.stdin.write(json.dumps({"output": str(self._output), **request}) + "\n")
        worker.stdin.flush()
        answer: dict[str, Any] = json.loads(worker.stdout.readline())
        return answer
