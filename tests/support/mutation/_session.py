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

from ._lines import forget_bytecode
from ._mutants import Mutant
from ._reach import Reach

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
PLAIN = "--assert=plain"  # polycnc comes with a plugin: pytest would load it past what notes the lines
PYTEST = ["-q", PLAIN, "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:benchmark", "-o", "timeout=0"]
REACH_LIMIT_S = 3600.0


@dataclass(frozen=True)
class Outcome:
    """What the tests said to a mutant: killed, timeout and crash notice it; survived and unreached do not.

    `by` is the test that noticed it, where one said so.
    """

    verdict: str
    tests: int
    by: str = ""

    @property
    def noticed(self) -> bool:
        """Return whether a test would have stopped the change."""
        return self.verdict in ("killed", "timeout", "crash")


class Session:
    """Holds the copy and processes that run tests there; with `jit` mutants run compiled.

    A change inside a function is tried in forked children of a process that has collected the tests; what an import
    runs, and all compiled code, is imported anew for each change.
    """

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
        self._jit = jit
        self._interpreted = self._worker("fresh", jit=False)
        self._mutated = self._worker("fresh", jit=True) if jit else self._interpreted
        self._ready: subprocess.Popen[str] | None = None

    def __enter__(self) -> Session:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        for worker in {self._interpreted, self._mutated, *([self._ready] if self._ready else [])}:
            worker.kill()
            worker.communicate()
        self._folder.cleanup()

    def reach(
        self,
        modules: Sequence[Path],
        tests: Sequence[Path],
        *,
        slowest_s: float = 0.0,
        limit_s: float = 120.0,
    ) -> Reach:
        """Run the test files once, interpreted, and return which tests run which lines.

        Tests that fail by that, such as those of compiled code alone, cannot tell anything and are left out; so are
        those that take more processor time than `slowest_s` where that is not 0. `limit_s` is for the tests of one
        change.

        Raises:
            RuntimeError: The tests cannot be run.
        """
        watched = {str(self._copied(module)): module for module in modules}
        answer = self._asked(
            self._interpreted,
            arguments=[*self._pytest(), *(str(self._copied(test)) for test in tests)],
            only=None,
            watch=list(watched),
            slowest_s=slowest_s,
            limit_s=REACH_LIMIT_S,
        )
        if answer["status"] not in (0, 1):
            said = self._output.read_text(encoding="utf-8", errors="replace").splitlines()
            raise RuntimeError("\n".join(["the tests cannot be run", *said[-20:]]))
        failed = set(answer["failed"])
        names = [*answer["tests"], ""]  # an import is the last
        lines = {
            str(watched[file]): {
                int(line): [name for test in tests if (name := names[test]) not in failed]
                for line, tests in seen.items()
            }
            for file, seen in answer["lines"].items()
        }
        times_s = {test: time_s for test, time_s in answer["times_s"].items() if test not in failed}
        return Reach(times_s, lines, sorted(failed), limit_s)

    def source(self, module: Path) -> bytes:
        """Return a module's text as it was when the copy was made."""
        return self._copied(module).read_bytes()

    def outcome(self, module: Path, mutant: Mutant, reach: Reach) -> Outcome:
        """Return what the tests that reach a mutant say to it."""
        tests = reach.of(str(module), mutant.lines)
        if not tests:
            return Outcome("unreached", 0)
        answer: dict[str, Any] = {"status": None}
        if not self._jit and not reach.imported(str(module), mutant.lines):
            answer = self._tried(module, mutant, tests, reach)
        if answer["status"] is None:
            answer = self._tried_anew(module, mutant, tests, reach)
        if by := answer.get("by", ""):
            reach.note(str(module), by)
        verdicts = {0: "survived", 5: "unreached", "timeout": "timeout", "crash": "crash"}
        return Outcome(verdicts.get(answer["status"], "killed"), len(tests), answer.get("by", ""))

    def _tried(self, module: Path, mutant: Mutant, tests: list[str], reach: Reach) -> dict[str, Any]:
        """Run tests with other functions in modules that are imported already."""
        if self._ready is None:
            self._ready = self._worker("ready", jit=False)
            files = sorted({str(self.copy / test.partition("::")[0]) for test in reach.reaching()})
            self._tell(self._ready, arguments=[*self._pytest(), *files])
        source = self.source(module)
        return self._asked(
            self._ready,
            file=str(self._copied(module)),
            before=source.decode(),
            after=mutant.applied(source).decode(),
            only=tests,
            times_s={test: reach.times_s.get(test, 0.0) for test in tests},
            limit_s=60.0 + 4 * sum(reach.times_s.get(test, 0.0) for test in tests),
        )

    def _tried_anew(self, module: Path, mutant: Mutant, tests: list[str], reach: Reach) -> dict[str, Any]:
        """Run tests in a process that imports the changed module."""
        place = self._copied(module)
        source = place.read_bytes()
        self._write(place, mutant.applied(source))
        try:
            return self._asked(
                self._mutated,
                arguments=[
                    *self._pytest(),
                    "-x",
                    *sorted({str(self.copy / test.partition("::")[0]) for test in tests}),
                ],
                only=tests,
                watch=[],
                slowest_s=0.0,
                limit_s=60.0 + 4 * sum(reach.times_s.get(test, 0.0) for test in tests),
            )
        finally:
            self._write(place, source)

    def _copied(self, path: Path) -> Path:
        return self.copy / path.relative_to(self._root)

    def _pytest(self) -> list[str]:
        return [*PYTEST, f"--basetemp={self.copy.parent / 'tmp'}"]

    def _write(self, place: Path, source: bytes) -> None:
        place.write_bytes(source)
        forget_bytecode(place)

    def _worker(self, kind: str, *, jit: bool) -> subprocess.Popen[str]:
        environment = {
            **os.environ,
            # The script itself is that of the repository, by a name that the copy's tests do not have.
            "PYTHONPATH": os.pathsep.join((str(self.copy / "src"), str(Path(__file__).parents[1]))),
            "NUMBA_DISABLE_JIT": "0" if jit else "1",
            "POLYCNC_CACHE_DIR": str(self.copy.parent / "cache"),
        }
        beside = self._root.parent / "shared" / "data"
        if beside.is_dir():
            environment.setdefault("POLYCNC_DATA", str(beside))
        return subprocess.Popen(
            [sys.executable, "-m", "mutation.worker", kind],
            cwd=self.copy,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def _tell(self, worker: subprocess.Popen[str], **request: object) -> None:
        assert worker.stdin is not None
        worker.stdin.write(json.dumps({"output": str(self._output), **request}) + "\n")
        worker.stdin.flush()

    def _asked(self, worker: subprocess.Popen[str], **request: object) -> dict[str, Any]:
        assert worker.stdout is not None
        self._tell(worker, **request)
        answer: dict[str, Any] = json.loads(worker.stdout.readline())
        return answer
