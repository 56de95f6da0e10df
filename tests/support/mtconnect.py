"""What tests of MTConnect share: an agent of a control, documents as trees, and the schemas where they lie."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from polycnc.cnc import Control
from polycnc.servers.mtconnect import VERSIONS, Agent, Answer, device_model
from polycnc.servers.plant import see, shape_of

_ROOT = Path(__file__).resolve().parents[2]


@cache
def _schema(kind: str, version: str) -> Any:
    etree = pytest.importorskip("lxml.etree", reason="pip install lxml")
    data = Path(os.environ.get("POLYCNC_DATA", _ROOT.parent / "shared" / "data"))
    path = data / "mtconnect" / f"MTConnect{kind}_{version}_1.0.xsd"
    if not path.exists():
        pytest.skip(f"no MTConnect schemas of {version}: put them into mtconnect/ of POLYCNC_DATA")
    return etree.XMLSchema(etree.parse(path))


def assert_valid(document: bytes, version: str) -> None:
    """Compare a document with the schema of its kind and version."""
    kind = ElementTree.fromstring(document).tag.rpartition("}MTConnect")[2]
    schema = _schema(kind, version)
    from lxml import etree

    if not schema.validate(etree.fromstring(document)):
        raise AssertionError(f"{schema.error_log}\n{document.decode()[:4000]}")


def plain(tag: str) -> str:
    """Return a tag without its namespace."""
    return tag.rpartition("}")[2]


@dataclass
class Rig:
    """A control, and an agent that observes it as its only device."""

    machine: str = "mill3"
    version: str = "2.7"
    size: int = 1 << 16
    control: Control = field(init=False)
    agent: Agent = field(init=False)

    def __post_init__(self) -> None:
        self.control = Control(self.machine)
        version = VERSIONS[self.version]
        self.device = device_model("mill", shape_of(self.control.status()), version)
        self.agent = Agent([self.device], version, 17, size=self.size)
        self._see = see(lambda: self.control)

    def observe(self) -> None:
        self.agent.observe(0, self._see())

    def get(self, path: str, query: str = "") -> Answer:
        answer = self.agent.get(path, query.encode())
        assert isinstance(answer, Answer)
        return answer

    def tree(self, path: str, query: str = "") -> ElementTree.Element:
        answer = self.get(path, query)
        assert answer.status == 200, answer.document
        return ElementTree.fromstring(answer.document)

    def values(self, query: str = "") -> dict[str, str]:
        """Return what `current` shows, by name; of a condition its level."""
        return values_of(self.tree("/current", query))


def values_of(tree: ElementTree.Element) -> dict[str, str]:
    """Return the observations of a document by name, the last of each; of conditions their level."""
    found = {}
    for each in tree.iter():
        if "dataItemId" in each.attrib:
            condition = plain(each.tag) in ("Normal", "Warning", "Fault")
            found[each.attrib["name"]] = plain(each.tag) if condition else "".join(each.itertext())
    return found


def header_of(document: bytes) -> dict[str, str]:
    """Return the attributes of a header."""
    return dict(ElementTree.fromstring(document)[0].attrib)
