"""Which tests reach which lines: candidates by what a test file names, then by running them once and looking."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain, zip_longest
from pathlib import Path

FOLDERS = (
    "unit",
    "golden",
    "property",
    "conformance",
)  # tests of commands run in processes of their own, which nothing sees


@dataclass(frozen=True)
class Reach:
    """The time of each test in seconds and, for each file, the tests that ran each line, with "" for imports.

    `failed` are tests that fail although nothing is changed; they are left out everywhere. `limit_s` is what the tests
    for one change may take together, as long as they took when nothing was changed.
    """

    times_s: dict[str, float]
    tests: dict[str, dict[int, list[str]]]
    failed: list[str]
    limit_s: float
    noticed: dict[str, Counter[str]] = field(default_factory=lambda: defaultdict(Counter))

    def of(self, file: str, lines: range) -> list[str]:
        """Return the tests that ran one of a file's lines, those first that are most likely to tell.

        These are the ones that noticed other changes of the file (`note`), the most of them in the least time; then
        the test files with the module's name, then the others, the quickest first. Where there are more than `limit_s`
        allows, each test file first gives what quickly runs what few others run.
        """
        seen = self.tests.get(file, {})
        found = {test for line in lines for test in seen.get(line, ()) if test}
        telling: set[str] = set()
        if not found and any(
            line in seen for line in lines
        ):  # an import ran it: the module's tests may tell, or any
            telling = {test for tests in seen.values() for test in tests if test}
            found = set(self.times_s)
        by_file = defaultdict[str, list[str]](list)
        for test in sorted(found, key=lambda test: (self.times_s.get(test, 0.0), test)):
            by_file[test.partition("::")[0]].append(test)
        chosen = self._chosen(seen, list(by_file.values()))
        own = Path(file).stem.strip("_")
        files = sorted(
            by_file.items(),
            key=lambda each: (own not in each[0], sum(self.times_s.get(test, 0.0) for test in each[1])),
        )
        return sorted(
            (test for _, tests in files for test in tests if test in chosen),
            key=lambda test: (
                -self.noticed[file][test] / (0.05 + self.times_s.get(test, 0.0)),
                test not in telling,
            ),
        )

    def note(self, file: str, test: str) -> None:
        """Remember that a test noticed a change of a file."""
        self.noticed[file][test] += 1

    def _chosen(self, seen: dict[int, list[str]], files: list[list[str]]) -> set[str]:
        rare = defaultdict[str, float](float)
        for tests in seen.values():
            for test in tests:
                rare[test] += 1.0 / len(tests)
        ranked = [
            sorted(tests, key=lambda test: -rare[test] / (0.05 + self.times_s.get(test, 0.0)))
            for tests in files
        ]
        left_s, chosen = self.limit_s, set[str]()
        for test in chain.from_iterable(zip_longest(*ranked)):  # one of each file, then the next of each
            if test is not None and (left_s > 0.0 or not chosen):
                chosen.add(test)
                left_s -= self.times_s.get(test, 0.0)
        return chosen

    def imported(self, file: str, lines: range) -> bool:
        """Return whether an import ran one of a file's lines."""
        seen = self.tests.get(file, {})
        return any("" in seen.get(line, ()) for line in lines)

    def reaching(self) -> set[str]:
        """Return the tests that reach anything."""
        return {test for seen in self.tests.values() for tests in seen.values() for test in tests if test}


def candidate_tests(root: Path, modules: Iterable[Path]) -> list[Path]:
    """Return the test files that name a module's package, or use a support module that does."""
    wanted = {".".join(_package(root, module)) for module in modules}
    naming = {path for path in root.glob("tests/**/*.py") if _names(path, wanted)}
    helpers = {f"support.{path.stem}" for path in naming if path.parent.name == "support"}
    files = [path for folder in FOLDERS for path in sorted((root / "tests" / folder).glob("test_*.py"))]
    return [path for path in files if path in naming or _names(path, helpers)]


def _package(root: Path, module: Path) -> tuple[str, ...]:
    parts = module.relative_to(root / "src").with_suffix("").parts
    return parts[: 3 if parts[1] == "controllers" else 2]


def _names(path: Path, dotted: Iterable[str]) -> bool:
    text = path.read_text(encoding="utf-8")
    return any(name in text for name in dotted)
