"""A plugin of pytest: a control, a Power Mate, a board and a card for tests of machine code.

pytest finds it by itself. Each test that names `cnc`, `power_mate`, `board` or `card` gets a new one; its time passes
in `advance` alone. When a test fails, its report shows what they execute and where their axes are. Nothing is loaded
until a fixture is used, and a fixture of your own with the same name goes before these.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from polycnc.cnc import Control
    from polycnc.controllers.apci import Board
    from polycnc.controllers.fanuc import PowerMate
    from polycnc.controllers.imc import Card

_shown = pytest.StashKey[dict[str, "Callable[[], str]"]]()  # by the fixture's name: what a report says of it


@pytest.fixture
def cnc(request: pytest.FixtureRequest) -> Iterator[Control]:
    """A control without a vendor on the machine "mill3"; a parameter names another machine or machine file."""
    from polycnc.cnc import Control
    from polycnc.machine import Store
    from polycnc.testing._control_text import control_text

    store = Store()
    made = Control(getattr(request, "param", "mill3"), memory=store)
    with _reported(request, lambda: control_text(made.status())):
        yield made
    store.close()


@pytest.fixture
def power_mate(request: pytest.FixtureRequest) -> Iterator[PowerMate]:
    """A FANUC Power Mate, switched on; a parameter is a dict of what `PowerMate` takes."""
    from polycnc.controllers.fanuc import PowerMate
    from polycnc.machine import Store
    from polycnc.testing._control_text import control_text

    store = Store()
    made = PowerMate(**{"memory": store, **getattr(request, "param", {})})
    with _reported(request, lambda: control_text(made.status())):
        yield made
    made.store.close()
    store.close()


@pytest.fixture
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    """An APCI-8001 board, just booted; a parameter is the text of its system file."""
    from polycnc.controllers.apci import Board, parse_system_file
    from polycnc.testing._board_text import board_text

    made = Board(parse_system_file(request.param)) if hasattr(request, "param") else Board()
    with _reported(request, lambda: board_text(made)):
        yield made


@pytest.fixture
def card(request: pytest.FixtureRequest) -> Iterator[Card]:
    """An iMC card, just switched on; a parameter is the text of its card file."""
    from polycnc.controllers.imc import Card, parse_card
    from polycnc.testing._card_text import card_text

    made = Card(parse_card(request.param)) if hasattr(request, "param") else Card()
    with _reported(request, lambda: card_text(made.status())):
        yield made


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, Any, None]:
    """Add what the devices of a failed test execute and where they are to its report."""
    outcome = yield
    report: pytest.TestReport = outcome.get_result()
    if report.failed:
        report.sections += [
            (f"polycnc: {name}", _readable(text)) for name, text in item.stash.get(_shown, {}).items()
        ]


@contextmanager
def _reported(request: pytest.FixtureRequest, text: Callable[[], str]) -> Iterator[None]:
    """Have a device in the reports of its test, while it lasts."""
    shown = request.node.stash.setdefault(_shown, {})
    shown[request.fixturename] = text
    yield
    del shown[request.fixturename]


def _readable(text: Callable[[], str]) -> str:
    """Return the text of a device; one that cannot be read must not hide why its test failed."""
    try:
        return text()
    except Exception as problem:
        return f"its state cannot be read: {problem}"
