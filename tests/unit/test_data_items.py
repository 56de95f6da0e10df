"""The one table of facts: what the page says of the places of other doors, against a control that runs."""

from __future__ import annotations

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("asyncua", reason="pip install 'polycnc[opcua]'")
pytest.importorskip("fastapi", reason="pip install 'polycnc[serve]'")

from polycnc.cnc import Control, Mode
from polycnc.servers.http._documents import as_json
from polycnc.servers.machines import MemoryPrograms
from polycnc.servers.plant import FACTS, Scope, Unit, see

PLACES = runpy.run_path(str(Path(__file__).parents[2] / "scripts" / "_data_items_page.py"))["STATUS"]
PROGRAM = "N10 G91 G1 X3.25 Y-2.75 F1230 S830 M3\nN20 G1 Y7 F640\nM30\n"


@pytest.fixture(scope="module")
def running() -> Control:
    control = Control("mill3")
    MemoryPrograms(lambda: control).put("PART", PROGRAM.encode())
    control.select_mode(Mode.AUTO)
    control.select_program("PART")
    control.set_overrides(feed=0.63, rapid=0.25, spindle=0.82)
    control.cycle_start()
    control.advance(180)
    return control


def at(document: Any, place: str) -> Any:
    for key in place.split("."):
        document = document[int(key)] if isinstance(document, list) else document[key]
    return document


@pytest.mark.parametrize("name", sorted(PLACES))
def test_a_fact_is_at_its_place_of_the_status(name: str, running: Control) -> None:
    seen, fact = see(lambda: running)(), FACTS[name]
    status = seen.status
    of: Any = {Scope.CHANNEL: status.channel, Scope.AXIS: status.axes["X"]}.get(fact.scope)
    value, shown = fact.read(seen, of), at(json.loads(as_json(status)), PLACES[name])
    if name == "execution":
        assert (value, shown) == ("active", "active")
    elif fact.unit is Unit.PERCENT and name != "load":
        assert value == pytest.approx(100 * shown)
        assert shown not in (0.0, 1.0)
    elif fact.unit is Unit.SECOND:
        assert value == int(shown)
    elif name.endswith("spindle_speed"):
        assert value == abs(shown) != 0
    else:
        assert value == shown or (not value and not shown)
